//! Runs and studies of spheres: what they write, what they refuse, the same bytes on one thread and two.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

pub fn jamscope(folder: &Path, arguments: &str) -> Output {
    let program = Command::new(env!("CARGO_BIN_EXE_jamscope")).args(arguments.split(' ')).current_dir(folder).output();
    program.expect("the program starts")
}

pub fn done(folder: &Path, arguments: &str) -> String {
    let output = jamscope(folder, arguments);
    assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("Unicode")
}

fn refused(folder: &Path, scene: &str, part: &str) {
    std::fs::write(folder.join("wrong.toml"), scene).expect("written");
    let output = jamscope(folder, "run wrong.toml");
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{scene}: {message}");
    assert!(message.contains(part), "no `{part}` in: {message}");
}

pub fn text(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The files of two reports have the same bytes, wall times apart.
pub fn same_files(one: &Path, two: &Path) {
    for entry in std::fs::read_dir(one).expect("a folder") {
        let name = entry.expect("an entry").file_name();
        if name != "timings.json" {
            let [first, second] = [one, two].map(|it| std::fs::read(it.join(&name)).expect("a file"));
            assert!(first == second, "{name:?}");
        }
    }
}

const SCENE: &str = "dimension = 3\ndisk_count = 2000\nprotocol = \"fire\"\n[[sample]]\nname = \"dense\"\nsource = { pressure = 2000.0 }\n";

#[test]
fn a_run_of_spheres_has_its_page_its_tables_and_the_same_bytes_on_two_threads() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("scene.toml"), SCENE).expect("written");
    done(folder.path(), "run scene.toml --threads 1 --out one");
    let printed = done(folder.path(), "run scene.toml --threads 2 --out two");
    assert!(printed.contains("spheres within the shell, N") && printed.contains("[force/length^2]"), "{printed}");
    let one = folder.path().join("one");
    same_files(&one, &folder.path().join("two"));
    let page = text(&one.join("report.html"));
    for title in ["slice of r²·d_r", "d_r on a shell", "radial profile", "angular correlation"] {
        assert!(page.contains(&format!("dense: {title}")), "no {title}");
    }
    let report: Value = serde_json::from_str(&text(&one.join("report.json"))).expect("JSON");
    let sample = &report["samples"][0]["done"];
    assert_eq!(
        (report["scene"]["dimension"].as_u64(), sample["packing"]["box_sides"].as_array().map(Vec::len)),
        (Some(3), Some(3))
    );
    let shell = &sample["shell_correlation"]["measured"];
    let powers = shell["spectrum"]["power"].as_array().expect("powers").len();
    // Columns of spheres: three coordinates, r² d_r.
    assert_eq!(text(&one.join("dense.shell_spectrum.csv")).lines().count(), 2 + powers - 1);
    let head = |name: &str| text(&one.join(name)).lines().take(2).map(str::to_owned).collect::<Vec<_>>().join("\n");
    assert!(head("dense.contact_changes.csv").starts_with("change,first,second,x,y,z,distance\n"));
    assert!(head("dense.radial_profile.csv").contains("length^3"));
    let field = head("dense.displacement.xyz");
    assert!(field.contains("displacement:R:3:radial:R:1:counted:R:1") && !field.contains("transverse"), "{field}");
    // What is written is a packing of spheres again, at rest.
    done(folder.path(), "inspect one/dense.packing.xyz --dimension 3");
    done(folder.path(), "run --packing one/dense.packing.xyz --dimension 3 --out again");
    let again: Value = serde_json::from_str(&text(&folder.path().join("again/report.json"))).expect("JSON");
    let pressure = |report: &Value| report["samples"][0]["done"]["packing"]["pressure"].as_f64().expect("a pressure");
    assert!((pressure(&again) / pressure(&report) - 1.0).abs() < 1e-6);
}

#[test]
fn a_study_of_spheres_is_merged() {
    let folder = tempfile::tempdir().expect("a folder");
    let study = "targets = [{ pressure = 500.0 }, { reduced_pressure = 1e6 }]\nrelaxers = [{ fire = {} }]\nseeds = { first = 1, count = 1 }\n\
                 [scene]\ndimension = 3\ndisk_count = 2000\n";
    std::fs::write(folder.path().join("study.toml"), study).expect("written");
    done(folder.path(), "study study.toml --out s");
    done(folder.path(), "merge s");
    let summary = text(&folder.path().join("s/summary.csv"));
    let names: Vec<&str> = summary.lines().next().expect("names").split(',').collect();
    let place = |name: &str| names.iter().position(|&other| other == name).expect(name);
    let means = |number: &str| -> Vec<f64> {
        let rows = summary.lines().skip(1).map(|row| row.split(',').collect::<Vec<_>>());
        let rows = rows.filter(|row| row[place("number")] == number);
        rows.map(|row| row[place("mean")].parse().expect("a number")).collect()
    };
    // p̂ = p N for Hertzian spheres: N of the 2000 are in a ball of radius 0.48 of the side.
    let (reduced, pressures) = (means("reduced_pressure"), means("pressure"));
    assert_eq!((reduced.len(), pressures.len()), (2, 2), "{summary}");
    let mobile = 4.0 / 3.0 * std::f64::consts::PI * 0.48f64.powi(3) * 2000.0;
    for (reduced, pressure) in reduced.iter().zip(&pressures) {
        assert!((reduced / pressure / mobile - 1.0).abs() < 1e-12, "{reduced} and {pressure}");
    }
    assert_eq!(means("anticorrelation").len(), 2, "{summary}");
    // Mean curves of the shell, r² d_r, and nothing that was published for disks.
    let page = text(&folder.path().join("s/report.html"));
    for word in ["2000 spheres", "r²·dᵣ", "G(γ), 2000", "S(ℓ), 2000", "γ* / π", "(r ΔZ)²"] {
        assert!(page.contains(word), "{word}");
    }
    for word in ["2000 disks", "of disks", "rings", ") r ΔZ /", "r·dᵣ", "θ*", "Published", "published", "f^−1.5"]
    {
        assert!(!page.contains(word), "{word}");
    }
    #[cfg(feature = "fit")]
    {
        let transition: Value = serde_json::from_str(&text(&folder.path().join("s/transition.json"))).expect("JSON");
        assert_eq!(transition["comparisons"], serde_json::json!([]));
        let methods = transition["series"][0]["estimates"].as_array().expect("methods");
        let names: Vec<_> = methods.iter().map(|one| one["method"].as_str().expect("a name")).collect();
        // κ too, where two cells have a fit. G*, γ* and S(ℓ) have no known level.
        assert!(names.contains(&"pressure_change"), "{names:?}");
        assert!(names.iter().all(|name| ["wavenumber", "pressure_change"].contains(name)), "{names:?}");
    }
}

#[cfg(feature = "linear")]
#[test]
fn relaxers_of_spheres_share_a_minimum_far_from_jamming() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = SCENE.replace("disk_count = 2000", "disk_count = 1200");
    let settings = "[observables.shell_correlation]\n[observables.protocol]\nfraction = 1.0\n";
    std::fs::write(folder.path().join("scene.toml"), scene + settings).expect("written");
    let printed = done(folder.path(), "run scene.toml --out run");
    assert!(printed.contains("scatter of minima: Δp [force/length^2]"), "{printed}");
    let report: Value = serde_json::from_str(&text(&folder.path().join("run/report.json"))).expect("JSON");
    let sample = &report["samples"][0]["done"];
    let protocol = &sample["protocol"]["measured"];
    let endings = protocol["endings"].as_array().expect("endings");
    assert_eq!((protocol["minimum_count"].as_u64(), endings.len()), (Some(1), 7), "{protocol}");
    // G* of the shell is that of the run, whose relaxer stops at a residual of 10⁻⁸ of the mean force, the ending 10⁻¹⁰.
    let own = sample["shell_correlation"]["measured"]["correlation"]["anticorrelation"]["value"].as_f64().expect("G*");
    for ending in endings {
        let found = ending["response"]["anticorrelation"].as_f64().expect("G*");
        assert!((found - own).abs() < 1e-4, "{found} and {own}: {ending}");
    }
    let table = text(&folder.path().join("run/dense.protocol.csv"));
    assert_eq!(table.lines().count(), 2 + 7);
    assert!(table.lines().nth(1).expect("units").contains(",force/length^2,"), "{table}");
}

#[test]
fn what_belongs_to_another_dimension_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    refused(folder.path(), "dimension = 4\n", "dimension = 4: must be 2 or 3");
    refused(folder.path(), "dimension = 3\n[observables.multipoles]\n", "observables.multipoles: with dimension = 3");
    refused(folder.path(), "[observables.shell_correlation]\n", "observables.shell_correlation: is of spheres");
    std::fs::write(folder.path().join("scene.toml"), SCENE).expect("written");
    let output = jamscope(folder.path(), "run scene.toml --dimension 2");
    assert!(String::from_utf8_lossy(&output.stderr).contains("--dimension 2: the scene has dimension = 3"));
}
