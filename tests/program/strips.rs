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

/// The page, `precision` and the comparison of protocols see the same strip as the run.
#[cfg(all(feature = "fit", feature = "linear", feature = "plot"))]
#[test]
fn every_part_of_a_report_sees_the_strip() {
    use jamscope::inflation::{Boundary, Inflation};
    use jamscope::precision::{PrecisionSettings, measure};
    use jamscope::protocol::ProtocolSettings;
    use jamscope::relax::RelaxerChoice;
    use jamscope::report::figures::heat_map::heat_map;
    use jamscope::report::figures::map::MapFrame;
    use jamscope::run::{SampleOutcome, run};
    use jamscope::scene::{Observables, ProtocolChoice, Sample, Scene, Source};

    let relaxer: RelaxerChoice = ProtocolChoice::FireNewton.relaxer();
    let boundary = Boundary::HeldWalls { distance_over_side: 0.45, length_over_side: 2.0 };
    let sample = Sample { name: "dense".into(), seed: 1, source: Source::Pressure(3000.0), relaxer };
    let observables = Observables {
        protocol: Some(ProtocolSettings { fraction: 1.0, ..Default::default() }),
        ..Observables::of_strip()
    };
    let inflation = Inflation { increase: 0.002, boundary, ..Inflation::default() };
    let scene = Scene { disk_count: 1600, inflation, observables, sample: vec![sample], ..Scene::default() };
    let report = run(&scene, &()).expect("a scene");
    let SampleOutcome::Done(result) = &report.samples[0].result else { panic!("it runs") };
    let response = &result.response;
    let fit = response.profile_fit.as_ref().and_then(|it| it.measured()).expect("a fit");

    // Far from jamming all protocols end in the minimum of the run.
    let compared = result.protocol.as_ref().and_then(|it| it.measured()).expect("compared");
    assert_eq!(compared.minimum_count, 1);
    for ending in &compared.endings {
        let change = ending.pressure_change.expect("at rest");
        assert!((change / result.inflation.pressure_change - 1.0).abs() < 1e-6, "{ending:?}");
        let amplitude = ending.fit.as_ref().expect("a fit").elastic_amplitude;
        assert!((amplitude / fit.elastic.amplitude.value - 1.0).abs() < 1e-6, "{ending:?}");
    }

    let settings = PrecisionSettings {
        force_limits: vec![1e-4],
        time_steps: Vec::new(),
        tolerances: Vec::new(),
        ..Default::default()
    };
    let precision = measure(&scene, &settings, &()).expect("measured");
    let fitted = precision.samples[0].minima[0].measured.fitted.as_ref().expect("a fit");
    assert!((fitted.elastic_amplitude / fit.elastic.amplitude.value - 1.0).abs() < 1e-6, "{fitted:?}");

    // The map has d_r, not r d_r.
    let field = &response.detail.plane().expect("of the plane").field;
    let frame = MapFrame::new(boundary, field.outer_radius, [40.0, 20.0], 0.7);
    let map = heat_map("dense", field, result.states.radii(), &frame);
    let largest = field.counted().map(|disk| disk.radial.abs()).fold(0.0, f64::max);
    let told = map.description.split("the largest has ").nth(1).expect("the largest");
    let told: f64 = told.split([')', ';']).next().expect("a number").trim().parse().expect("a plain number");
    assert!((told / largest - 1.0).abs() < 0.01, "{} and {largest}", map.description);
}
