//! The structure of the crate: data goes one way, so no room and no file imports itself through others.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Longest file \[lines\].
const LONGEST_FILE: usize = 450;

/// Longer than that: a table of numbers.
const LONG: [&str; 1] = ["reference::bessel::modified_tables"];

/// Names of files that are standard terms of physics, mathematics, numerical computing or programming.
const STANDARD: [&str; 168] = [
    "analyse",
    "angular",
    "archive",
    "array",
    "atomic",
    "bessel",
    "bootstrap",
    "chart",
    "check",
    "coefficients",
    "columns",
    "compare",
    "complex",
    "components",
    "conjugate_gradients",
    "contents",
    "continuum",
    "contour",
    "convergence",
    "correlation",
    "csv",
    "curve",
    "cusp",
    "cylindrical",
    "damped",
    "damping",
    "data_file",
    "decompress",
    "definition",
    "descent",
    "detail",
    "dimension",
    "displacement",
    "divergence",
    "dynamics",
    "elastic",
    "elasticity",
    "ensemble",
    "error",
    "estimates",
    "estimators",
    "exact",
    "execute",
    "exponential",
    "extended_xyz",
    "factorisation",
    "figure",
    "file_arguments",
    "files",
    "fits",
    "for_each_pair",
    "force_dipole",
    "force_distribution",
    "forces",
    "fourier",
    "gauss",
    "grid",
    "heat_map",
    "hessian",
    "implicit",
    "incomplete_beta",
    "input",
    "inspection",
    "integration",
    "interval",
    "io",
    "iterative",
    "lammps_data",
    "lammps_dump",
    "lanczos",
    "lanes",
    "lbfgs",
    "least_squares",
    "lengths",
    "likelihood",
    "limits",
    "line_search",
    "linear",
    "lock",
    "log_axes",
    "main",
    "manifest",
    "map",
    "measure",
    "measurement",
    "memory",
    "merge",
    "minimise",
    "modes",
    "moduli",
    "motion",
    "multipoles",
    "neighbours",
    "newton",
    "node_solution",
    "npz",
    "number",
    "observables",
    "observe",
    "output",
    "page",
    "pairs",
    "palette",
    "parallel",
    "plane",
    "plastic",
    "plot",
    "point_force",
    "polynomial",
    "power_law",
    "power_spectrum",
    "precision",
    "pressure",
    "processor",
    "profile",
    "progress",
    "radial",
    "radii",
    "read_error",
    "read_warning",
    "real",
    "relax",
    "report",
    "response",
    "restart",
    "results",
    "roots",
    "rounding",
    "run",
    "scale",
    "scaling",
    "screened_source",
    "search",
    "section",
    "settings",
    "shell_map",
    "significance",
    "simd",
    "size",
    "slice_map",
    "slope",
    "solution",
    "source",
    "source_series",
    "sparse",
    "spectra",
    "spectrum",
    "spherical",
    "state",
    "state_file",
    "statistics",
    "step",
    "store_error",
    "strain",
    "strip_modes",
    "study_input",
    "subset",
    "synthetic",
    "table",
    "threads",
    "toml_text",
    "trajectory",
    "units",
    "vector",
    "verlet",
    "window",
    "write_lammps_data",
    "write_packing",
];

/// All source files by the path of their module, "" for `lib.rs`.
fn all_sources() -> BTreeMap<String, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let (mut files, mut folders) = (BTreeMap::new(), vec![root.clone()]);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            if path.extension().is_none_or(|extension| extension != "rs") {
                continue;
            }
            let parts: Vec<String> = path
                .strip_prefix(&root)
                .expect("below src")
                .with_extension("")
                .iter()
                .map(|part| part.to_string_lossy().into_owned())
                .filter(|part| part != "mod" && part != "lib")
                .collect();
            files.insert(parts.join("::"), std::fs::read_to_string(&path).expect("text"));
        }
    }
    files
}

/// The source files of the library.
fn sources() -> BTreeMap<String, String> {
    let mut files = all_sources();
    // The program is a crate of its own, and imports the library by its name.
    files.retain(|module, _| !matches!(room(module), "main" | "cli"));
    files
}

/// A term in the form in which terms are compared: lower case, blanks for underscores and hyphens, singular.
fn term(text: &str) -> String {
    let text = text.to_lowercase().replace(['_', '-'], " ");
    text.split_whitespace().map(|word| word.trim_end_matches('s')).collect::<Vec<_>>().join(" ")
}

/// The terms of the glossary: what is bold in the first column of its tables.
fn glossary() -> BTreeSet<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("book/src/glossary.md");
    let text = std::fs::read_to_string(path).expect("the glossary");
    let first_column = text.lines().filter_map(|line| line.strip_prefix("| ")?.split(" | ").next());
    first_column.flat_map(|cell| cell.split("**").skip(1).step_by(2)).map(term).collect()
}

/// The code of a file: no comments, no tests.
fn code(text: &str) -> String {
    let tests = text.find("#[cfg(test)]\nmod tests").unwrap_or(text.len());
    text[..tests].lines().map(|line| line.split("//").next().unwrap_or("")).collect::<Vec<_>>().join("\n")
}

/// All paths of a `use` tree.
fn paths(tree: &str) -> Vec<String> {
    let Some(open) = tree.find('{') else { return vec![tree.trim().into()] };
    let (prefix, body) = (tree[..open].trim(), &tree[open + 1..tree.rfind('}').unwrap_or(tree.len())]);
    let (mut depth, mut item, mut items) = (0, String::new(), Vec::new());
    for letter in body.chars().chain([',']) {
        match letter {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        if letter == ',' && depth == 0 {
            items.extend(paths(&std::mem::take(&mut item)));
        } else {
            item.push(letter);
        }
    }
    items.retain(|item| !item.is_empty());
    items.into_iter().map(|item| format!("{prefix}{item}")).collect()
}

/// Paths that a file names, from the root of the crate.
fn named(module: &str, code: &str) -> Vec<String> {
    let mut all = Vec::new();
    for (at, _) in code.match_indices("use ") {
        // At the beginning of a line, and not a word of a text.
        let before = code[..at].rsplit('\n').next().unwrap_or("").trim();
        if !(before.is_empty() || before == "pub" || before.starts_with("pub(")) {
            continue;
        }
        let tree = code[at + 4..].split(';').next().unwrap_or("");
        let reexport = before.starts_with("pub");
        all.extend(paths(tree).into_iter().map(|path| match path.split("::").next() {
            Some("crate" | "super" | "self") => path,
            _ if reexport => format!("self::{path}"),
            _ => String::new(),
        }));
    }
    for start in ["crate::", "super::"] {
        for (at, _) in code.match_indices(start) {
            let end = code[at..].find(|letter: char| !letter.is_alphanumeric() && !"_:".contains(letter));
            all.push(code[at..end.map_or(code.len(), |end| at + end)].trim_end_matches(':').into());
        }
    }
    let own: Vec<&str> = module.split("::").filter(|part| !part.is_empty()).collect();
    let absolute = |path: &String| {
        let parts: Vec<&str> = path.split("::").collect();
        let up = parts.iter().take_while(|&&part| part == "super").count();
        let base = match parts[0] {
            "crate" => &[][..],
            "self" => &own[..],
            "super" => &own[..own.len().saturating_sub(up)],
            _ => return None,
        };
        Some([base, &parts[up.max(1)..]].concat().join("::"))
    };
    all.iter().filter_map(absolute).collect()
}

/// Which files each file imports from.
fn imports(files: &BTreeMap<String, String>) -> BTreeMap<&str, BTreeSet<&str>> {
    let owner = |path: &str| {
        let mut path = path;
        loop {
            if let Some((owner, _)) = files.get_key_value(path).filter(|_| !path.is_empty()) {
                return Some(owner.as_str());
            }
            path = &path[..path.rfind("::")?];
        }
    };
    let of = |(module, text): (&'_ String, &'_ String)| -> BTreeSet<&str> {
        let named = named(module, &code(text));
        named.iter().filter_map(|path| owner(path)).filter(|other| other != module).collect()
    };
    files.iter().map(|file| (file.0.as_str(), of(file))).collect()
}

/// What can be reached from a file.
fn reached<'a>(from: &str, imports: &BTreeMap<&'a str, BTreeSet<&'a str>>) -> BTreeSet<&'a str> {
    let (mut found, mut open) = (BTreeSet::new(), vec![from]);
    while let Some(next) = open.pop() {
        for &other in imports.get(next).into_iter().flatten() {
            if found.insert(other) {
                open.push(other);
            }
        }
    }
    found
}

/// The room of a file.
fn room(module: &str) -> &str {
    module.split("::").next().unwrap_or(module)
}

#[test]
fn no_room_imports_itself_through_others() {
    let files = sources();
    let mut rooms: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (file, others) in imports(&files) {
        let others = others.into_iter().map(room).filter(|&other| other != room(file));
        rooms.entry(room(file)).or_default().extend(others);
    }
    assert!(rooms["forces"].contains("neighbours") && rooms["relax"].contains("forces"), "the files are read");
    let circles: Vec<&str> = rooms.keys().filter(|&&one| reached(one, &rooms).contains(one)).copied().collect();
    assert!(circles.is_empty(), "in a circle of imports: {circles:?}");
}

#[test]
fn no_file_imports_itself_through_others() {
    let files = sources();
    let imports = imports(&files);
    let circles: Vec<&str> = imports.keys().filter(|&&file| reached(file, &imports).contains(file)).copied().collect();
    assert!(circles.is_empty(), "in a circle of imports: {circles:?}");
}

#[test]
fn files_are_read_in_one_sitting() {
    let files = all_sources();
    let long = files.iter().filter(|(module, _)| !LONG.contains(&module.as_str()));
    let long: Vec<_> = long.filter(|(_, text)| text.lines().count() > LONGEST_FILE).map(|(module, _)| module).collect();
    assert!(long.is_empty(), "longer than {LONGEST_FILE} lines: {long:?}");
    for (module, text) in &files {
        assert!(text.starts_with("//!"), "{module} says what it is for");
    }
}

#[test]
fn file_names_are_in_the_glossary_or_standard_terms() {
    assert!(STANDARD.is_sorted(), "the standard terms are sorted");
    let (mut files, glossary) = (all_sources(), glossary());
    files.remove("");
    let name = |module: &str| term(module.rsplit("::").next().unwrap_or(module));
    let names: BTreeSet<String> = files.keys().map(|module| name(module)).collect();
    let standard: BTreeSet<String> = STANDARD.iter().copied().map(term).collect();
    let is_known = |name: &String| glossary.contains(name) || standard.contains(name);
    let unknown: Vec<&String> = files.keys().filter(|module| !is_known(&name(module))).collect();
    assert!(unknown.is_empty(), "neither in the glossary nor a standard term: {unknown:?}");
    let unused: Vec<&String> =
        standard.iter().filter(|&term| !names.contains(term) || glossary.contains(term)).collect();
    assert!(unused.is_empty(), "not the name of a file, or already in the glossary: {unused:?}");
}

#[test]
fn examples_are_short_and_named_by_the_crate() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut names = Vec::new();
    for entry in std::fs::read_dir(root.join("examples")).expect("a folder") {
        let path = entry.expect("an entry").path();
        let text = std::fs::read_to_string(&path).expect("text");
        assert!(text.lines().count() <= 50, "{} has at most 50 lines", path.display());
        names.push(path.file_stem().expect("a name").to_string_lossy().into_owned());
    }
    let book = std::fs::read_to_string(root.join("book/src/library.md")).expect("the chapter");
    assert_eq!(names.len(), 13);
    for name in names {
        assert!(book.contains(&format!("`{name}`")), "the chapter As a library names {name}");
    }
}

#[test]
fn a_circle_is_seen() {
    let file = |name: &str, text: &str| (name.to_string(), text.to_string());
    let files = BTreeMap::from([
        file("a", "pub use b::{One, c::Two};\nmod b;"),
        file("a::b", "//! one\nuse crate::d::E;\n// use crate::a::Two;\npub struct One;"),
        file("a::b::c", "use super::One;"),
        file("d", "fn f() -> crate::a::One { todo!() }"),
    ]);
    let imports = imports(&files);
    assert_eq!(imports["a"], BTreeSet::from(["a::b", "a::b::c"]));
    assert_eq!((imports["a::b"].len(), imports["a::b::c"].len()), (1, 1));
    let circles: Vec<&str> = imports.keys().filter(|&&file| reached(file, &imports).contains(file)).copied().collect();
    assert_eq!(circles, ["a", "a::b", "a::b::c", "d"]);
}
