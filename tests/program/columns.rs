//! Columns of what the program writes: in the book with their units, of each disk under its label, and the same in both formats.

use std::collections::BTreeMap;
#[cfg(all(feature = "fit", feature = "linear"))]
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

use jamscope::io::{read_packing, write_packing};
use jamscope::packing::Packing;
use jamscope::preparation::Target;
use jamscope::{Inflation, Preparation, inflate, prepare};

/// The program with these arguments, split at blanks, in a folder; what it prints.
fn done(folder: &Path, arguments: &str) -> String {
    let program = Command::new(env!("CARGO_BIN_EXE_jamscope")).args(arguments.split(' ')).current_dir(folder).output();
    let output = program.expect("the program starts");
    assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("Unicode")
}

fn text(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The columns of extended XYZ with their values, disk by disk.
fn xyz_columns(path: &Path) -> BTreeMap<String, Vec<f64>> {
    let text = text(path);
    let mut lines = text.lines().skip(1);
    let layout = lines.next().expect("a comment").split("Properties=").nth(1).expect("columns");
    let layout: Vec<&str> = layout.split(' ').next().expect("columns").split(':').collect();
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(' ').collect()).collect();
    let (mut start, mut columns) = (0, BTreeMap::new());
    for property in layout.chunks(3) {
        let end = start + property[2].parse::<usize>().expect("a width");
        if property[1] != "S" {
            let values = rows.iter().flat_map(|row| &row[start..end]);
            columns.insert(property[0].to_string(), values.map(|word| word.parse().expect("a number")).collect());
        }
        start = end;
    }
    columns
}

/// The arrays of doubles of a NumPy archive, which are stored: shape and values.
fn npz_columns(path: &Path) -> BTreeMap<String, (String, Vec<f64>)> {
    let bytes = std::fs::read(path).expect("an archive");
    let starts = (0..bytes.len()).filter(|&at| bytes[at..].starts_with(b"\x93NUMPY"));
    let array = |at: usize| {
        // The name of a member is before it, after the 30 bytes of its record.
        let head = (0..at).rev().find(|&head| bytes[head..].starts_with(b"PK\x03\x04")).expect("a member");
        let name = std::str::from_utf8(&bytes[head + 30..at]).expect("a name").trim_end_matches(".npy").to_string();
        let data = at + 10 + usize::from(u16::from_le_bytes([bytes[at + 8], bytes[at + 9]]));
        let header = std::str::from_utf8(&bytes[at + 10..data]).expect("text");
        let shape = header.split('(').nth(1)?.split(')').next()?.to_string();
        let count: usize = shape.split(',').filter_map(|side| side.trim().parse::<usize>().ok()).product();
        header.contains("'<f8'").then(|| {
            let values = bytes[data..data + 8 * count].chunks(8);
            (name, (shape, values.map(|it| f64::from_le_bytes(it.try_into().expect("eight"))).collect()))
        })
    };
    starts.filter_map(array).collect()
}

/// Every column of `names` has the same bits in both files.
fn assert_same(xyz: &Path, npz: &Path, names: &[&str]) {
    let (xyz, npz) = (xyz_columns(xyz), npz_columns(npz));
    for name in names {
        let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&npz[*name].1), bits(&xyz[*name]), "{name}");
    }
}

const FIXTURE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/packings/hertz_N1000_p100.xyz");

#[test]
fn an_archive_has_the_columns_of_extended_xyz_to_the_bit() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let names = ["contacts", "rattler", "net_force", "virial"];
    done(folder.path(), &format!("inspect {FIXTURE} --write a.xyz"));
    done(folder.path(), &format!("inspect {FIXTURE} --write a.npz"));
    assert_same(&path("a.xyz"), &path("a.npz"), &names);
    let arrays = npz_columns(&path("a.npz"));
    assert_eq!((arrays["contacts"].0.as_str(), arrays["virial"].0.as_str()), ("1000,", "1000, 4"));
    // What is written is a packing again, with its law.
    assert_eq!(read_packing::<2>(path("a.npz")).expect("readable"), read_packing::<2>(FIXTURE).expect("readable"));
    assert_eq!(done(folder.path(), "inspect a.npz"), done(folder.path(), "inspect a.xyz"));
    for command in ["relax", "compress --pressure 120"] {
        done(folder.path(), &format!("{command} {FIXTURE} --out b.xyz"));
        done(folder.path(), &format!("{command} a.npz --out b.npz"));
        assert_same(&path("b.xyz"), &path("b.npz"), &names);
    }
}

#[cfg(feature = "linear")]
#[test]
fn the_vectors_of_modes_are_columns_and_rattlers_do_not_move() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    for name in ["a.xyz", "a.npz"] {
        done(folder.path(), &format!("inspect {FIXTURE} --modes 3 --write {name}"));
    }
    assert_same(&path("a.xyz"), &path("a.npz"), &["mode_1", "mode_2", "mode_3"]);
    let columns = xyz_columns(&path("a.xyz"));
    assert!(!columns.contains_key("mode_4"));
    let rattlers: Vec<usize> = (0..1000).filter(|&disk| columns["rattler"][disk] == 1.0).collect();
    assert!(!rattlers.is_empty());
    for first in 1..=3 {
        let mode = &columns[&format!("mode_{first}")];
        assert!(rattlers.iter().all(|&disk| mode[2 * disk] == 0.0 && mode[2 * disk + 1] == 0.0));
        // Unit vectors, orthogonal: to the residual 10⁻¹³ over the distance of the eigenvalues from each other, 10⁻³ of the norm.
        for second in 1..=3 {
            let other = &columns[&format!("mode_{second}")];
            let product: f64 = mode.iter().zip(other).map(|(a, b)| a * b).sum();
            assert!((product - f64::from(u8::from(first == second))).abs() < 1e-9, "{first}, {second}: {product}");
        }
    }
}

/// A packing before and after an inflation, with labels that are no rows.
fn states(folder: &Path) {
    let target = Target::Pressure(1000.0);
    let prepared = prepare(&Preparation { disk_count: 300, target, ..Preparation::default() }).expect("prepared");
    let inflated = inflate(&Inflation::default(), prepared.packing.get()).expect("inflated");
    for (name, rest) in [("before", &inflated.before), ("after", &inflated.after)] {
        let packing = rest.packing.get().clone();
        let labels = packing.labels().iter().map(|label| 1000 + 7 * label).collect();
        let packing = packing.with_labels(labels).expect("a label per disk");
        write_packing(folder.join(format!("{name}.xyz")), &packing, &[], &[]).expect("written");
    }
}

#[test]
fn the_response_of_each_disk_is_written_with_the_state_after() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    states(folder.path());
    let printed = done(folder.path(), "analyse before.xyz after.xyz --write response.xyz");
    assert!(printed.contains("the response of each disk in response.xyz"), "{printed}");
    done(folder.path(), "analyse before.xyz after.xyz --write response.npz");
    let names = ["displacement", "radial", "transverse", "counted", "rattler"];
    assert_same(&path("response.xyz"), &path("response.npz"), &names);
    let [before, after, written] = ["before.xyz", "after.xyz", "response.npz"].map(|name| {
        let packing: Packing<2> = read_packing(path(name)).expect("readable");
        packing
    });
    assert_eq!((written.radii(), written.labels()), (after.radii(), after.labels()));
    let columns = xyz_columns(&path("response.xyz"));
    let centre = (0..before.len()).find(|&disk| before.radii()[disk] != after.radii()[disk]).expect("one grew");
    let mut moved = 0;
    for disk in 0..before.len() {
        let of = |name: &str| [columns[name][2 * disk], columns[name][2 * disk + 1]];
        let displacement = of("displacement");
        if before.held()[disk] || disk == centre {
            assert_eq!((displacement, columns["rattler"][disk], columns["counted"][disk]), ([0.0; 2], 0.0, 0.0));
            continue;
        }
        moved += 1;
        let arm = before.separation(disk, centre);
        let distance = arm[0].hypot(arm[1]);
        let radial = (arm[0] * displacement[0] + arm[1] * displacement[1]) / distance;
        // Sums of two products of numbers below 1: the rounding of each is 10⁻¹⁶.
        assert!((radial - columns["radial"][disk]).abs() < 1e-15);
        let difference = [0, 1].map(|axis| after.positions()[disk][axis] - before.positions()[disk][axis]);
        // Coordinates up to 20, with a rounding of 4·10⁻¹⁵, and corrections.
        assert!((0..2).all(|axis| (difference[axis] - displacement[axis]).abs() < 1e-14), "{disk}");
        // A jammed packing: what does not count is a rattler before or after.
        assert_eq!(columns["counted"][disk] + columns["rattler"][disk], 1.0);
        #[cfg(feature = "linear")]
        if columns["counted"][disk] == 1.0 {
            let (linear, plastic) = (of("linear"), of("plastic"));
            assert!((0..2).all(|axis| (linear[axis] + plastic[axis] - displacement[axis]).abs() < 1e-15), "{disk}");
        }
    }
    assert!(moved > 100);
    #[cfg(feature = "linear")]
    {
        // The norm over the norm of the displacement, as a run of the same disk has it: a share of the response.
        let norm = |name: &str| columns[name].iter().map(|value| value * value).sum::<f64>().sqrt();
        let share = norm("plastic") / norm("displacement");
        assert!(norm("linear") > 0.0 && share > 0.0 && share < 2.0, "{share}");
    }
}

#[test]
fn contacts_and_bonds_have_the_labels_of_the_packing_that_was_read() {
    let folder = tempfile::tempdir().expect("a folder");
    states(folder.path());
    done(folder.path(), "analyse before.xyz after.xyz --out out");
    let [packing, after] = ["before.xyz", "after.xyz"].map(|name| {
        let packing: Packing<2> = read_packing(folder.path().join(name)).expect("readable");
        packing
    });
    let mut places: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
    packing.labels().iter().enumerate().for_each(|(disk, &label)| places.entry(label).or_default().push(disk));
    for (name, first) in [("contact_changes", 1), ("bond_changes", 0)] {
        let table = text(&folder.path().join(format!("out/before.{name}.csv")));
        let rows: Vec<Vec<&str>> = table.lines().skip(2).map(|row| row.split(',').collect()).collect();
        assert!(!rows.is_empty(), "{name}");
        for row in rows {
            let disks = [0, 1].map(|end| {
                let label: u64 = row[first + end].parse().expect("a whole number");
                places.get(&label).unwrap_or_else(|| panic!("{name}: no disk {label}"))
            });
            // Contacts made exist after the inflation, all others before. The images of a disk in the rim repeat its label.
            let state = if name == "contact_changes" && row[0] == "1" { &after } else { &packing };
            let touches = |a: usize, b: usize| {
                let separation = state.separation(a, b);
                separation[0].hypot(separation[1]) < state.radii()[a] + state.radii()[b]
            };
            let near = disks[0].iter().any(|&a| disks[1].iter().any(|&b| touches(a, b)));
            assert!(near, "{name}: {row:?}");
        }
    }
}

/// File, column and unit of the tables in the book.
#[cfg(all(feature = "fit", feature = "linear"))]
fn described() -> BTreeSet<[String; 3]> {
    let book = text(&Path::new(env!("CARGO_MANIFEST_DIR")).join("book/src/columns.md"));
    let (mut file, mut all) = (String::new(), BTreeSet::new());
    for line in book.lines().filter(|line| line.starts_with("| ") && line.contains(" | `")) {
        let cells: Vec<&str> = line.trim_matches('|').split(" | ").map(str::trim).collect();
        if !cells[0].trim_matches('|').trim().is_empty() {
            file = cells[0].trim_matches(|c: char| c == '|' || c == '`' || c == ' ').to_string();
        }
        let (cells, unit) = (&cells[cells.len() - 3..], cells[cells.len() - 1].trim());
        let unit = if unit == "|" { "" } else { unit.trim_matches('|').trim() };
        let column = cells[0].trim_matches(|c: char| c == '|' || c == '`' || c == ' ');
        assert!(all.insert([file.clone(), column.into(), unit.into()]), "{file}: {column} is described twice");
    }
    all
}

/// The columns of a table: names, and units if its second row has them.
#[cfg(all(feature = "fit", feature = "linear"))]
fn columns_of(file: &str, table: &str, has_units: bool) -> Vec<[String; 3]> {
    let mut lines = table.lines();
    let names = lines.next().expect("names").split(',');
    let units: Vec<&str> = if has_units { lines.next().expect("units").split(',').collect() } else { Vec::new() };
    names
        .enumerate()
        .map(|(at, name)| {
            // A threshold is part of the name.
            let name = name.split_once("_at_").map_or(name.to_string(), |(name, _)| format!("{name}_at_X"));
            [file.into(), name, units.get(at).copied().unwrap_or_default().into()]
        })
        .collect()
}

#[cfg(all(feature = "fit", feature = "linear"))]
#[test]
fn every_column_of_a_table_is_in_the_book_and_the_reverse() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("written");
    let sample = "disk_count = 600\n[[sample]]\nname = \"dense\"\nseed = 1\nsource = { pressure = 3000.0 }\n";
    write("all.toml", sample);
    write("protocol.toml", &format!("{sample}[observables.protocol]\n"));
    write("drive.toml", &format!("{sample}[inflation]\ndrive = {{ point_force = {{ force_over_mean = 0.1 }} }}\n"));
    std::fs::create_dir(folder.path().join("shear")).expect("a folder");
    write("small.toml", &sample.replace("600", "100"));
    let study = "targets = [{ pressure = 500.0 }]\nincreases = [0.1]\nseeds = { first = 1, count = 3 }\n";
    write("study.toml", &format!("{study}[scene]\ndisk_count = 100\n"));
    for arguments in [
        "run all.toml --out all",
        "run protocol.toml --out protocol",
        "run drive.toml --out drive",
        "precision small.toml --out precision",
        "study study.toml --out study",
        "merge study",
        "strain all/dense.packing.xyz --shear 0.001 --steps 1 --limit 1e-5 --out shear/dense.sheared.xyz",
    ] {
        done(folder.path(), arguments);
    }
    let mut found = BTreeSet::new();
    for (place, has_units) in
        [("all", true), ("protocol", true), ("drive", true), ("precision", true), ("study", false), ("shear", true)]
    {
        for entry in std::fs::read_dir(folder.path().join(place)).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.extension().is_some_and(|extension| extension == "csv") {
                let name = path.file_name().expect("a name").to_string_lossy().replace("dense.", "NAME.");
                found.extend(columns_of(&name, &text(&path), has_units && name != "choices.csv"));
            }
        }
    }
    let scene = "dimension = 3\ndisk_count = 2000\nprotocol = \"fire\"\n[observables]\nradial_profile = {}\nshell_correlation = {}\n";
    write("spheres.toml", &format!("{scene}[[sample]]\nname = \"spheres\"\nsource = {{ pressure = 3000.0 }}\n"));
    done(folder.path(), "run spheres.toml --out spheres");
    for name in ["shell_correlation.csv", "shell_spectrum.csv"] {
        let table = text(&folder.path().join(format!("spheres/spheres.{name}")));
        found.extend(columns_of(&format!("NAME.{name}"), &table, true));
    }
    for (name, arguments) in [
        ("exact profile", ""),
        ("exact amplitude", ""),
        ("exact poles", ""),
        ("exact mode", " --mode 2 --poisson 0.3 --radial 1 --wavenumber 0.01"),
        ("exact lorentzian", " --frequency 3"),
        ("exact lorentzian --frequency inf", ""),
        ("exact lorentzian --spectrum", " 3 --frequency 3"),
        ("exact lorentzian --thresholds", " 0.1 --frequency 3"),
        ("exact lorentzian --frequency inf --thresholds", " 0.1"),
        ("exact bessel", " --order 0 --kind j --arguments 1"),
    ] {
        found.extend(columns_of(name, &done(folder.path(), &format!("{name}{arguments}")), true));
    }
    let described = described();
    let missing: Vec<_> = found.difference(&described).collect();
    assert!(missing.is_empty(), "not in book/src/columns.md, or with another unit: {missing:#?}");
    let unknown: Vec<_> = described.difference(&found).collect();
    assert!(unknown.is_empty(), "in book/src/columns.md, but written by no command: {unknown:#?}");
}
