//! What a report writes: the files asked for, every number to the bit, pages that stand alone.

mod estimators;
mod kernels;
#[cfg(feature = "plot")]
mod pictures;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::OnceLock;

use jamscope::displacement::DisplacementField;
use jamscope::io::read_packing;
#[cfg(feature = "plot")]
use jamscope::observe::RadialProfile;
use jamscope::packing::Packing;
use jamscope::relax::RelaxerChoice;
use jamscope::report::table::{WIDTH, terminal_table};
use jamscope::report::write;
use jamscope::run::{Report, SampleOutcome, SampleResult, run};
use jamscope::scene::{Observables, Sample, Scene, Source};

/// No such file, and a name that would end an element or start an entity.
const MISSING: &str = "no <b>such</b> & \"file\".xyz";

fn sample(name: &str, source: Source) -> Sample {
    Sample { name: name.into(), seed: 1, source, relaxer: RelaxerChoice::default() }
}

/// 600 disks, enough rings for a fit, loose and dense, deflated again, and a sample that fails.
fn scene() -> Scene {
    let mut scene = Scene {
        disk_count: 600,
        sample: vec![
            sample("loose", Source::PackingFraction(0.8)),
            sample("dense", Source::Pressure(3000.0)),
            sample("missing", Source::File(MISSING.into())),
        ],
        ..Scene::default()
    };
    scene.inflation.deflate = true;
    scene
}

/// The report of that scene, made once.
fn report() -> &'static Report {
    static REPORT: OnceLock<Report> = OnceLock::new();
    REPORT.get_or_init(|| run(&scene(), &()).expect("the scene makes sense"))
}

fn result(name: &str) -> &'static SampleResult {
    let sample = report().samples.iter().find(|sample| sample.name == name).expect("a sample of the scene");
    match &sample.result {
        SampleOutcome::Done(result) => result,
        SampleOutcome::Failed(reason) => panic!("{name} failed: {reason}"),
    }
}

/// All files of a folder.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    std::fs::read_dir(folder)
        .expect("the folder is there")
        .map(|entry| {
            let entry = entry.expect("an entry");
            let name = entry.file_name().into_string().expect("plain names");
            (name, std::fs::read(entry.path()).expect("a file"))
        })
        .collect()
}

fn written(report: &Report) -> BTreeMap<String, Vec<u8>> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    // Not there yet, nor is what it stands in.
    let inner = folder.path().join("reports").join("first");
    let paths = write(report, &inner).expect("written");
    let mut files = contents(&inner);
    // The list of them stands beside them, hidden, and is no result.
    let list = String::from_utf8(files.remove(".report.files.json").expect("a list")).expect("Unicode");
    let named: BTreeSet<String> =
        paths.iter().map(|path| path.file_name().expect("a file").to_string_lossy().into_owned()).collect();
    assert_eq!(
        named,
        files.keys().cloned().collect(),
        "the paths returned are the files there, no temporary ones left"
    );
    assert_eq!(named.len(), paths.len(), "each file is named once");
    assert!(named.iter().all(|name| list.contains(&format!("\"{name}\""))), "{list}");
    files
}

fn text(files: &BTreeMap<String, Vec<u8>>, name: &str) -> String {
    String::from_utf8(files[name].clone()).expect("text")
}

#[test]
fn the_files_are_those_asked_for() {
    let always = ["report.json", "timings.json"];
    let page: &[&str] = if cfg!(feature = "plot") { &["report.html"] } else { &[] };
    let (all, nothing) = (Observables::default(), Observables::none());
    let cases: Vec<(Observables, &[&str], &[&str])> = vec![
        (nothing.clone(), &[], &[]),
        (
            Observables { radial_profile: all.radial_profile, ..nothing.clone() },
            &["radial_profile.csv"],
            &["radial profile"],
        ),
        (
            Observables { angular_profiles: all.angular_profiles.clone(), ..nothing.clone() },
            &["angular_profiles.csv"],
            &["angular profiles"],
        ),
        (
            Observables { angular_correlation: all.angular_correlation.clone(), ..nothing.clone() },
            &["angular_correlation.csv", "power_spectrum.csv"],
            &["angular correlation<", "angular power spectrum"],
        ),
        (
            Observables { radial_dependence: all.radial_dependence.clone(), ..nothing.clone() },
            &["radial_dependence.csv"],
            &["angular correlation by distance"],
        ),
        (
            Observables { multipoles: all.multipoles, ..nothing.clone() },
            &["multipoles.csv"],
            &["angular modes, radial"],
        ),
        // An unjammed packing has no contacts, no bonds and no isostatic length to draw.
        (Observables { contact_changes: all.contact_changes, ..nothing.clone() }, &["contact_changes.csv"], &[]),
        (Observables { bond_changes: all.bond_changes, ..nothing.clone() }, &["bond_changes.csv"], &[]),
        (Observables { isostatic_length: all.isostatic_length, ..nothing.clone() }, &["isostatic_length.csv"], &[]),
        (
            Observables { displacement_field: all.displacement_field, ..nothing.clone() },
            &["packing.xyz", "before.xyz", "displacement.xyz"],
            &["map of"],
        ),
        (
            all,
            &[
                "radial_profile.csv",
                "angular_profiles.csv",
                "angular_correlation.csv",
                "power_spectrum.csv",
                "radial_dependence.csv",
                "multipoles.csv",
                "contact_changes.csv",
                "bond_changes.csv",
                "isostatic_length.csv",
                "packing.xyz",
                "before.xyz",
                "displacement.xyz",
            ],
            &[
                "radial profile",
                "angular profiles",
                "angular correlation<",
                "angular power spectrum",
                "angular correlation by distance",
                "angular modes, radial",
                "map of",
            ],
        ),
    ];
    let every = cases.last().map_or(&[] as &[&str], |case| case.2);
    for (observables, names, pictures) in cases {
        let mut scene = Scene { observables, ..scene() };
        scene.inflation.deflate = false;
        scene.sample.truncate(1);
        let files = written(&run(&scene, &()).expect("the scene makes sense"));
        let mut expected: BTreeSet<String> = always.iter().chain(page).map(|name| (*name).to_string()).collect();
        expected.extend(names.iter().map(|ending| format!("loose.{ending}")));
        assert_eq!(files.keys().cloned().collect::<BTreeSet<_>>(), expected);
        if cfg!(feature = "plot") {
            let page = text(&files, "report.html");
            for picture in every {
                let there = page.contains(&format!("<title>loose: {picture}"));
                assert_eq!(there, pictures.contains(picture), "{picture} on the page of {names:?}");
            }
            assert_eq!(page.matches("<svg").count(), pictures.len());
        }
    }
}

#[test]
fn a_deflation_leaves_a_file_of_its_own() {
    let files = written(report());
    assert!(files.contains_key("dense.deflated.xyz"));
    assert!(!files.keys().any(|name| name.starts_with("missing")), "a sample that failed has no files");
}

#[test]
fn json_has_every_number_to_the_bit_and_no_wall_time() {
    let json = text(&written(report()), "report.json");
    assert!(!json.contains("seconds"));
    let read: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(read, serde_json::to_value(report()).expect("serialisable"));
    let dense = &read["samples"][1]["done"];
    let bits = |value: &serde_json::Value| value.as_f64().expect("a number").to_bits();
    assert_eq!(bits(&dense["packing"]["pressure"]), result("dense").packing.pressure.to_bits());
    let rings = &result("dense").response.radial_profile.as_ref().expect("asked for").rings;
    for (index, ring) in rings.iter().enumerate() {
        let read = &dense["radial_profile"]["rings"][index];
        assert_eq!(bits(&read["mean"]), ring.mean.to_bits());
        assert_eq!(bits(&read["standard_error"]), ring.standard_error.to_bits());
    }
    assert!(read["samples"][2]["failed"].as_str().expect("a reason").contains(MISSING));
}

#[test]
fn timings_have_the_stages_of_each_sample() {
    let timings: serde_json::Value = serde_json::from_str(&text(&written(report()), "timings.json")).expect("JSON");
    let entries = timings.as_array().expect("one entry a sample");
    assert_eq!(entries.len(), 2, "a sample that failed took no time that is known");
    let cost = result("dense").inflation.after.rest.cost;
    assert_eq!(entries[1]["sample"], "dense");
    assert_eq!(entries[1]["after_inflation_seconds"].as_f64(), Some(cost.seconds));
    assert!(entries[1]["after_deflation_seconds"].is_number());
}

/// Names, units and numbers of a CSV file; all rows of one length.
fn csv(files: &BTreeMap<String, Vec<u8>>, name: &str) -> (Vec<String>, Vec<Vec<f64>>) {
    let text = text(files, name);
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    assert!(rows.iter().all(|row| row.len() == rows[0].len()), "{name}: rows of one length");
    assert!(rows[1].iter().all(|unit| ["1", "rad", "length", "length^2"].contains(unit)), "{name}: {:?}", rows[1]);
    let number = |text: &&str| text.parse().unwrap_or_else(|_| panic!("{name}: {text} is not a number"));
    let numbers = rows[2..].iter().map(|row| row.iter().map(number).collect()).collect();
    (rows[0].iter().map(|&name| name.into()).collect(), numbers)
}

#[cfg(feature = "linear")]
#[test]
fn the_plastic_part_is_in_the_report_where_there_is_a_linear_response() {
    use jamscope::response::Measurement;
    let files = written(report());
    let Some(Measurement::Refused(reason)) = &result("loose").plastic_part else { panic!("unjammed") };
    // The table breaks lines; the reason is there in its words.
    let table = terminal_table(report()).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(table.contains(&format!("loose, no linear response: {reason}")), "{table}");
    assert!(!files.contains_key("loose.plastic_profile.csv"));
    let Some(Measurement::Measured(plastic)) = &result("dense").plastic_part else { panic!("jammed") };
    assert_eq!(plastic.negative_eigenvalue_count, 0);
    assert!(plastic.share > 0.0 && plastic.participation_ratio > 0.0 && plastic.participation_ratio <= 1.0);
    let (names, rows) = csv(&files, "dense.plastic_profile.csv");
    assert_eq!(names[2], "plastic_radial_displacement");
    let means: Vec<f64> = plastic.radial_profile.rings.iter().map(|ring| ring.mean).collect();
    assert_eq!(rows.iter().map(|row| row[2]).collect::<Vec<_>>(), means);
}

#[test]
fn csv_profiles_have_names_units_and_the_numbers_to_the_bit() {
    let files = written(report());
    for sample in ["loose", "dense"] {
        let rings = &result(sample).response.radial_profile.as_ref().expect("asked for").rings;
        let (names, rows) = csv(&files, &format!("{sample}.radial_profile.csv"));
        assert_eq!(names[..3], ["radius", "disk_count", "radial_displacement"]);
        assert_eq!(rows.len(), rings.len());
        for (row, ring) in rows.iter().zip(rings) {
            assert_eq!(row[0].to_bits(), ring.radius.to_bits());
            assert_eq!(row[1], ring.disk_count as f64);
            assert_eq!(row[2].to_bits(), ring.mean.to_bits());
            assert_eq!(row[5].to_bits(), (ring.radius * ring.mean).to_bits());
        }
        let profiles = result(sample).response.angular_profiles.as_ref().expect("asked for");
        let (_, rows) = csv(&files, &format!("{sample}.angular_profiles.csv"));
        let angles: Vec<f64> = profiles.iter().flat_map(|profile| profile.angles.iter().copied()).collect();
        assert_eq!(rows.iter().map(|row| row[1].to_bits()).collect::<Vec<_>>(), angles.map_bits());
        assert!(rows.iter().all(|row| row[4] == row[2] * row[3]));
    }
}

trait MapBits {
    fn map_bits(&self) -> Vec<u64>;
}

impl MapBits for [f64] {
    fn map_bits(&self) -> Vec<u64> {
        self.iter().map(|value| value.to_bits()).collect()
    }
}

#[cfg(feature = "fit")]
#[test]
fn fitted_solutions_stand_beside_the_profile() {
    use jamscope::reference::{Annulus, RadialSolution, elastic::Elastic};
    use jamscope::response::Measurement;

    let result = result("dense");
    let Some(Measurement::Measured(fit)) = &result.response.profile_fit else {
        panic!("no fit: {:?}", result.response.profile_fit)
    };
    let annulus = Annulus::new(result.inflation.inner_radius, result.inflation.outer_radius).expect("an annulus");
    let elastic = Elastic::<2>::new(annulus, fit.elastic.amplitude.value).expect("finite");
    let (names, rows) = csv(&written(report()), "dense.radial_profile.csv");
    let column = |wanted: &str| names.iter().position(|name| name == wanted);
    let (fitted, curve) = (column("fitted").expect("a fit"), column("elastic").expect("a fit"));
    assert_eq!(column("screened").is_some(), fit.screened.is_some());
    assert_eq!(rows.iter().filter(|row| row[fitted] == 1.0).count(), fit.ring_count);
    for row in &rows {
        assert_eq!(row[curve].to_bits(), (row[0] * elastic.value(row[0])).to_bits());
    }
}

fn check_same(read: &Packing<2>, packing: &Packing<2>) {
    assert_eq!(read.positions(), packing.positions());
    assert_eq!(read.corrections(), packing.corrections());
    assert_eq!(read.radii(), packing.radii());
    assert_eq!(read.held(), packing.held());
    assert_eq!(read.labels(), packing.labels());
    assert_eq!(read.domain(), packing.domain());
}

/// Rows of an extended XYZ file under the names of their columns, `name:R:2` counted twice.
fn check_field(path: &Path, field: &DisplacementField<2>) {
    let text = std::fs::read_to_string(path).expect("a file");
    let mut lines = text.lines().skip(1);
    let comment = lines.next().expect("a comment line");
    for key in ["jamscope_version=", "sample=", "law=\"Hertzian contacts", "seed=1", "pressure=", "state="] {
        assert!(comment.contains(key), "{key} in {comment}");
    }
    assert!(comment.contains(":displacement:R:2:radial:R:1:transverse:R:1:counted:R:1"), "{comment}");
    let layout: Vec<&str> = comment.split("Properties=").nth(1).expect("columns").split([':', ' ']).collect();
    let columns = layout.chunks(3).take_while(|column| column[0] != "displacement");
    let start: usize = columns.map(|column| column[2].parse::<usize>().expect("a width")).sum();
    let numbers =
        |line: &str| line.split(' ').skip(start).take(5).map(|word| word.parse().expect("a number")).collect();
    let rows: Vec<Vec<f64>> = lines.map(numbers).collect();
    let mut seen = vec![false; rows.len()];
    for disk in &field.disks {
        let counted = f64::from(u8::from(disk.counted));
        let [x, y] = disk.displacement;
        assert_eq!(rows[disk.disk].map_bits(), [x, y, disk.radial, disk.transverse(), counted].map_bits());
        seen[disk.disk] = true;
    }
    for (row, _) in rows.iter().zip(seen).filter(|(_, seen)| !seen) {
        assert_eq!(row, &[0.0; 5], "disks that are held, and the centre");
    }
}

#[test]
fn packings_are_read_back_to_the_same_bits() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    write(report(), folder.path()).expect("written");
    for sample in ["loose", "dense"] {
        let result = result(sample);
        let path = |ending: &str| folder.path().join(format!("{sample}.{ending}"));
        check_same(
            &read_packing(path("packing.xyz")).expect("readable"),
            &result.states.plane().expect("of the plane").prepared,
        );
        check_same(
            &read_packing(path("before.xyz")).expect("readable"),
            result.states.plane().expect("of the plane").inflated.before.packing.get(),
        );
        let after = result.states.plane().expect("of the plane").inflated.after.packing.get();
        check_same(&read_packing(path("displacement.xyz")).expect("readable"), after);
        check_field(&path("displacement.xyz"), &result.response.detail.plane().expect("of the plane").field);
        let deflated =
            result.states.plane().expect("of the plane").inflated.deflated.as_ref().expect("deflated").packing.get();
        check_same(&read_packing(path("deflated.xyz")).expect("readable"), deflated);
        check_field(
            &path("deflated.xyz"),
            result.states.plane().expect("of the plane").cycle_field.as_ref().expect("deflated"),
        );
    }
}

#[test]
fn two_runs_write_the_same_bytes_but_for_the_wall_times() {
    let (mut first, mut second) = (written(report()), written(&run(&scene(), &()).expect("the scene makes sense")));
    let timings = (first.remove("timings.json").expect("written"), second.remove("timings.json").expect("written"));
    assert_ne!(timings.0, timings.1, "nanoseconds of several relaxations do not repeat");
    assert!(first == second, "files differ");
}

#[test]
fn a_second_report_replaces_the_first() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("report.json"), "old").expect("written");
    std::fs::write(folder.path().join("notes.txt"), "mine").expect("written");
    write(report(), folder.path()).expect("written");
    let files = contents(folder.path());
    assert_eq!(files["notes.txt"], b"mine");
    assert!(files["report.json"].len() > 1000);
}

#[test]
fn a_folder_that_cannot_be_made_is_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("taken");
    std::fs::write(&file, "").expect("written");
    let message = write(report(), &file.join("inner")).expect_err("a file is in the way").to_string();
    assert!(message.contains("taken"), "{message}");
}

#[test]
fn the_table_fits_a_terminal_and_has_every_sample() {
    let mut report = report().clone();
    let table = terminal_table(&report);
    assert!(table.lines().all(|line| line.chars().count() <= WIDTH), "{table}");
    for word in ["loose", "dense", "missing failed:", "FIRE", "no contacts", "relative force", "wall time [s]"] {
        assert!(table.contains(word), "{word} in\n{table}");
    }
    #[cfg(feature = "fit")]
    assert!(table.contains("κ/κ_1"), "{table}");
    #[cfg(feature = "linear")]
    assert!(table.contains("at a minimum") && table.contains("plastic share"), "{table}");
    #[cfg(feature = "fit")]
    {
        use jamscope::response::Measurement;
        let SampleOutcome::Done(dense) = &mut report.samples[1].result else { panic!("dense has a result") };
        dense.response.profile_fit = Some(Measurement::Refused("too few rings".into()));
        assert!(terminal_table(&report).contains("\ndense, no fit: too few rings\n"));
    }
    // More samples than stand side by side, and a name that fits no column.
    report.samples.push(report.samples[1].clone());
    report.samples[3].name = "long".repeat(10);
    let table = terminal_table(&report);
    assert!(table.lines().all(|line| line.chars().count() <= WIDTH), "{table}");
    assert_eq!(table.matches("\nPacking\n").count(), 2);
}
