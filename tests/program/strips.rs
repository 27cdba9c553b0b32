//! Runs and studies of strips and of free centres: what they write, what they refuse, the same bytes on one thread and two.

use serde_json::Value;

use crate::spheres::{done, jamscope, same_files, text};

const SCENE: &str = "disk_count = 1600\nprotocol = \"fire-newton\"\n[inflation]\nincrease = 0.05\n\
    boundary = { held_walls = { distance_over_side = 0.43, length_over_side = 2.0 } }\n\
    [[sample]]\nname = \"dense\"\nsource = { pressure = 1000.0 }\n[[sample]]\nname = \"loose\"\nsource = { packing_fraction = 0.8 }\n";

#[test]
fn a_run_of_a_strip_has_its_page_its_tables_and_the_same_bytes_on_two_threads() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("scene.toml"), SCENE).expect("written");
    done(folder.path(), "run scene.toml --threads 1 --out one");
    let printed = done(folder.path(), "run scene.toml --threads 2 --out two");
    assert!(printed.contains("distance of the walls, H [length]"), "{printed}");
    // In a strip a positive Δp and many changed contacts are no evidence of a phase.
    assert!(printed.contains("by the radial profile") && !printed.contains("by the sign of Δp"), "{printed}");
    let one = folder.path().join("one");
    same_files(&one, &folder.path().join("two"));
    let report: Value = serde_json::from_str(&text(&one.join("report.json"))).expect("JSON");
    let sample = &report["samples"][0]["done"];
    let sides: Vec<f64> = serde_json::from_value(sample["packing"]["box_sides"].clone()).expect("two sides");
    assert!((sides[0] / sides[1] - 2.0).abs() < 1e-12, "{sides:?}");
    let wall = sample["inflation"]["outer_radius"].as_f64().expect("H");
    assert!((wall / sides[1] - 0.43).abs() < 1e-12);
    #[cfg(feature = "fit")]
    {
        // A strip at p = 1000 is stretched evenly: 99 % of the variance of the profile.
        let fit = &sample["profile_fit"]["measured"];
        assert_eq!(fit["decision"], "elastic");
        assert!(fit["elastic"]["share_described"].as_f64().expect("a share") > 0.98, "{fit}");
        assert!(printed.contains("κ/κ_1 below"), "{printed}");
    }
    #[cfg(feature = "linear")]
    {
        // Far from jamming the linear response of the row gives most of Δp.
        let plastic = &sample["plastic_part"]["measured"];
        let ratio = plastic["linear_pressure_change"].as_f64().expect("Δp")
            / sample["inflation"]["pressure_change"].as_f64().expect("Δp");
        assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
    }
    #[cfg(feature = "plot")]
    {
        let page = text(&one.join("report.html"));
        assert!(page.contains("a row in the middle of a strip between held walls"), "the introduction");
        for title in ["map of d_r", "radial profile", "angular correlation", "angular profiles"] {
            assert!(page.contains(&format!("dense: {title}")), "no {title}");
        }
        assert!(page.contains("2x/L") && !page.contains("map of r·d_r"));
    }
    // The row is held in the file of the state before.
    let held = |line: &&str| line.split(' ').nth(6) == Some("1");
    let before = text(&one.join("dense.before.xyz"));
    assert!(before.lines().skip(2).filter(held).count() > 100, "walls and row are marked");
}

#[test]
fn what_a_strip_does_not_have_is_refused_by_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let refused = |start: &str, boundary: &str, rest: &str, part: &str| {
        let scene = format!(
            "{start}\ndisk_count = 400\n[inflation]\nboundary = {boundary}\n{rest}\n[[sample]]\nname = \"a\"\nsource = {{ pressure = 100.0 }}\n"
        );
        std::fs::write(folder.path().join("wrong.toml"), &scene).expect("written");
        let output = jamscope(folder.path(), "run wrong.toml");
        let message = String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout);
        assert_eq!(output.status.code(), Some(1), "{scene}: {message}");
        assert!(message.contains(part), "no `{part}` in: {message}");
    };
    let walls = |distance: f64, length: f64| {
        format!("{{ held_walls = {{ distance_over_side = {distance:?}, length_over_side = {length:?} }} }}")
    };
    refused("", &walls(0.6, 1.0), "", "held_walls.distance_over_side = 0.6: must be above 0 and below 0.5");
    refused("", &walls(0.4, 0.0), "", "held_walls.length_over_side = 0: must be between 1e-3 and 1e3");
    refused("", &walls(0.49, 1.0), "", "wall distance");
    refused("dimension = 3", &walls(0.4, 1.0), "", "held_walls: a row of disks is inflated in two dimensions");
    for observable in ["multipoles", "bond_changes", "isostatic_length"] {
        let of = format!("observables.{observable}: is of the disks around one that is inflated");
        refused("", &walls(0.4, 1.0), &format!("[observables.{observable}]"), &of);
    }
}

#[test]
fn a_study_holds_and_frees_the_centre_of_the_same_packings() {
    let folder = tempfile::tempdir().expect("a folder");
    let study = "disk_counts = [300]\ncentres_held = [true, false]\nprotocol = \"fire\"\nseeds = { first = 1, count = 2 }\n\
        targets = [{ pressure = 2000.0 }]\n[scene.observables]\nradial_profile = {}\nmultipoles = {}\nangular_correlation = {}\n";
    std::fs::write(folder.path().join("study.toml"), study).expect("written");
    done(folder.path(), "study study.toml --out out");
    let records: Vec<Value> = text(&folder.path().join("out/records.jsonl"))
        .lines()
        .map(|line| serde_json::from_str(line).expect("a record"))
        .collect();
    assert_eq!(records.len(), 4);
    let number = |record: &Value, name: &str| record["outcome"]["done"]["numbers"][name].as_f64().expect("a number");
    for seed in [1, 2] {
        let of = |held: bool| {
            let found = records.iter().find(|it| {
                it["seed"] == seed && it["cell"].get("centre_held").and_then(Value::as_bool).unwrap_or(true) == held
            });
            found.unwrap_or_else(|| panic!("seed {seed}, held {held}"))
        };
        let (held, free) = (of(true), of(false));
        assert_eq!(number(held, "pressure"), number(free, "pressure"), "one packing");
        // The dipole of the held disk: far from jamming the free one has next to none.
        assert!(number(free, "share_dipole") < 0.5 * number(held, "share_dipole"), "seed {seed}");
    }
    std::fs::write(folder.path().join("twice.toml"), study.replace("[true, false]", "[true, true]")).expect("written");
    let output = jamscope(folder.path(), "study twice.toml --out twice");
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success() && message.contains("centres_held: true occurs twice"), "{message}");
}
