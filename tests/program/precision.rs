//! What accuracy costs: runs, errors, references and files of a measurement.

use std::path::Path;
use std::sync::OnceLock;

use jamscope::precision::ladder::{Method, Varied, rungs};
use jamscope::precision::minima::SAME;
use jamscope::precision::{PrecisionError, PrecisionReport, PrecisionSettings, Run, SamplePrecision, measure, write};
use jamscope::relax::{RelaxerChoice, Stop};
use jamscope::scene::{Observables, Sample, Scene, Source};
use serde_json::Value;

fn scene() -> Scene {
    let relaxer = RelaxerChoice::default();
    let sample = Sample { name: "dense".into(), seed: 1, source: Source::Pressure(1000.0), relaxer };
    Scene { disk_count: 200, sample: vec![sample], ..Scene::default() }
}

fn settings() -> PrecisionSettings {
    PrecisionSettings {
        force_limits: vec![1e-2, 1e-4, 1e-6, 1e-8, 1e-10],
        time_steps: vec![0.45],
        tolerances: vec![0.1, 0.01],
        explicit_step_limit: 3000,
        ..PrecisionSettings::default()
    }
}

/// The measurement, made once.
fn report() -> &'static PrecisionReport {
    static REPORT: OnceLock<PrecisionReport> = OnceLock::new();
    REPORT.get_or_init(|| measure(&scene(), &settings(), &()).expect("a packing at p = 1000"))
}

fn sample() -> &'static SamplePrecision {
    &report().samples[0]
}

fn ladder(method: Method) -> Vec<&'static Run> {
    sample().runs.iter().filter(|run| (run.method, run.varied) == (method, Varied::ForceLimit)).collect()
}

#[test]
fn every_rung_is_a_run_in_its_order() {
    let rungs = rungs(&settings(), Default::default());
    let asked: Vec<_> = rungs.iter().map(|rung| (rung.method, rung.varied, rung.value)).collect();
    let made: Vec<_> = sample().runs.iter().map(|run| (run.method, run.varied, run.value)).collect();
    assert_eq!(made, asked);
    // Five limits for seven relaxers, of FIRE, then Newton the three below its hand-over; a time step; two tolerances each of two.
    assert_eq!(made.len(), 7 * 5 + 3 + 1 + 2 * 2);
    for method in Method::ALL {
        assert!(made.iter().any(|run| run.0 == method), "{}", method.name());
    }
}

#[test]
fn both_references_are_one_minimum_far_from_jamming() {
    let references = &sample().references;
    assert!(references.same_minimum);
    // Both at rest to 10⁻¹³ of the mean force. An error of force f moves the softest mode by f over its stiffness: some 10⁻²
    // of the stiffness of a contact, whose overlap is 0.05 here, so 0.05 · 10⁻¹³ · 10² and a tenfold margin.
    assert!(references.residuals.iter().all(|&residual| residual <= 1e-13), "{references:?}");
    assert!(references.errors.displacement <= 5e-12, "{references:?}");
    assert_eq!(references.errors.contacts, 0);
    assert_eq!((sample().minima[0].label.as_str(), sample().minima[0].distance), ("A", 0.0));
}

#[test]
fn tighter_limits_have_smaller_errors_in_one_minimum() {
    for method in [Method::Fire, Method::FireStepBack, Method::ConjugateGradients, Method::QuasiNewton, Method::Newton]
    {
        let runs = ladder(method);
        for pair in runs.windows(2) {
            let [loose, tight] = [pair[0], pair[1]];
            assert!(matches!(tight.stop, Stop::Converged(_)), "{}: {:?}", method.name(), tight.stop);
            assert!(tight.residual <= tight.value && tight.residual <= loose.residual);
            if loose.minimum == tight.minimum {
                // Two orders of the limit between them; a residual may undershoot its limit by as much.
                let [first, second] = [loose.errors.displacement, tight.errors.displacement];
                assert!(second <= first, "{} at {:e}: {first:e}, then {second:e}", method.name(), tight.value);
            }
        }
        let (first, last) = (runs[0], runs[runs.len() - 1]);
        assert_eq!(first.minimum, last.minimum, "{}: one minimum at p = 1000", method.name());
        assert!(last.errors.displacement < 1e-4 * first.errors.displacement, "{}", method.name());
        assert!(last.errors.energy <= Some(1e-12) && last.errors.pressure <= Some(1e-8), "{:?}", last.errors);
        assert_eq!(last.errors.contacts, 0);
    }
}

#[test]
fn a_run_without_steps_left_is_told_and_its_energy_error_is_positive() {
    let damped = ladder(Method::Damped);
    let last = damped[damped.len() - 1];
    assert_eq!(last.stop, Stop::StepLimit);
    assert_eq!(last.cost.step_count, 3000);
    // 3000 steps of about 10⁻⁴ do not bring the softest modes to 10⁻¹⁰.
    assert!(last.residual > last.value && last.errors.displacement > 0.0);
}

#[test]
fn another_minimum_is_no_error_of_precision() {
    for run in &sample().runs {
        let minimum = sample().minima.iter().find(|minimum| minimum.label == run.minimum).expect("a known minimum");
        assert_eq!(minimum.distance, run.minimum_distance);
        let reference = minimum.label == "A" || (minimum.label == "B" && !sample().references.same_minimum);
        assert_eq!(reference, run.minimum_distance == 0.0);
        assert!(reference || run.minimum_distance > SAME);
        // At a tight limit the error is small in whatever minimum the run is.
        if run.residual <= 1e-8 {
            assert!(run.errors.displacement <= SAME, "{run:?}");
        }
    }
}

#[test]
fn spheres_are_measured_like_disks() {
    let scene = Scene { dimension: 3, disk_count: 500, observables: Observables::of_dimension(3), ..scene() };
    let settings = PrecisionSettings { force_limits: vec![1e-2, 1e-6, 1e-10], ..settings() };
    let report = measure(&scene, &settings, &()).expect("a packing at p = 1000");
    let sample = &report.samples[0];
    // 237 of 500 spheres lie in a ball of 0.48 of the side.
    assert!(
        (sample.mobile_count as f64 / (4.0 / 3.0 * std::f64::consts::PI * 0.48f64.powi(3) * 500.0) - 1.0).abs() < 0.1
    );
    // Limits as for disks: see `both_references_are_one_minimum_far_from_jamming`.
    assert!(sample.references.same_minimum && sample.references.errors.displacement <= 5e-12, "{sample:?}");
    for method in [Method::Fire, Method::ConjugateGradients, Method::QuasiNewton, Method::Newton] {
        let runs: Vec<&Run> =
            sample.runs.iter().filter(|run| (run.method, run.varied) == (method, Varied::ForceLimit)).collect();
        let (first, last) = (runs[0], runs[runs.len() - 1]);
        assert!(last.residual <= 1e-10 && last.errors.contacts == 0, "{last:?}");
        assert!(last.errors.displacement < 1e-4 * first.errors.displacement, "{first:?}, {last:?}");
    }
    let table = |name: &str| sample.choices.iter().find(|table| table.name == name);
    assert!(table("angular_estimator").is_none(), "a ring belongs to the plane");
    assert!(table("time_step").is_some() && table("skin").is_some());
    // κR = 2 and 2·10⁻², κa ten times smaller: as a difference j_1 has the relative error 10⁻¹⁶ (κa)⁻³, at most 10⁻⁹.
    let routes = table("bessel_route").expect("an annulus");
    assert!(routes.rows[..2].iter().all(|row| row.values[0].is_some_and(|error| error < 1e-9)), "{routes:?}");
}

/// A report without its seconds.
fn timeless(report: &PrecisionReport) -> Value {
    let mut value = serde_json::to_value(report).expect("JSON");
    for sample in value["samples"].as_array_mut().expect("samples") {
        for run in sample["runs"].as_array_mut().expect("runs") {
            assert!(run["seconds"].take().as_f64().expect("seconds") >= 0.0);
        }
        for table in sample["choices"].as_array_mut().expect("choices") {
            let columns: Vec<bool> = table["columns"].as_array().expect("columns").iter().skip(1).map(timed).collect();
            for row in table["rows"].as_array_mut().expect("rows") {
                let values = row["values"].as_array_mut().expect("values").iter_mut();
                values.zip(&columns).filter(|(_, timed)| **timed).for_each(|(value, _)| *value = Value::Null);
            }
        }
    }
    value
}

fn timed(column: &Value) -> bool {
    let name = column.as_str().expect("a name");
    name == "seconds" || name.contains("(s a point)")
}

#[test]
fn a_second_measurement_differs_in_seconds_only() {
    let again = measure(&scene(), &settings(), &()).expect("as before");
    assert_eq!(timeless(&again), timeless(report()));
}

#[test]
fn files_are_written_whole_and_parse() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let inner = folder.path().join("not").join("there");
    let files = write(report(), &inner).expect("written");
    let mut names: Vec<String> =
        files.iter().map(|file| file.file_name().expect("a file").to_string_lossy().into_owned()).collect();
    names.sort();
    let mut found: Vec<String> = std::fs::read_dir(&inner)
        .expect("the folder is there")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .filter(|name| name != ".precision.files.json")
        .collect();
    found.sort();
    assert_eq!(names, found, "no temporary file is left");
    let json: Value = serde_json::from_str(&read(&inner, "precision.json")).expect("JSON");
    assert_eq!(json["samples"][0]["runs"].as_array().expect("runs").len(), sample().runs.len());
    let csv = read(&inner, "precision.csv");
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines.len(), 2 + sample().runs.len());
    // Names of methods hold a comma and stand in quotes.
    let cells = |line: &str| {
        line.split('"')
            .enumerate()
            .map(|(i, part)| if i % 2 == 0 { part.matches(',').count() } else { 0 })
            .sum::<usize>()
    };
    assert!(lines.iter().all(|line| cells(line) == cells(lines[0])), "{csv}");
    let choices = read(&inner, "choices.csv");
    assert!(choices.contains("dense,time_step,0.5,"), "{choices}");
    #[cfg(feature = "plot")]
    {
        let page = read(&inner, "precision.html");
        assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>\n"));
        assert!(!page.contains("NaN") && !page.contains("inf\""), "a place in a plot is not a number");
        let plot = read(&inner, "dense.displacement_seconds.svg");
        assert!(
            plot.contains("wall time on one core (s)") && plot.contains("largest error of a displacement (length)")
        );
        for method in Method::ALL {
            assert!(plot.contains(&format!(">{}</text>", method.name())), "{} is in the legend", method.name());
        }
    }
}

fn read(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join(name)).expect("a file of the report")
}

#[test]
fn shorter_time_steps_have_errors_of_nearly_second_order() {
    let table = sample().choices.iter().find(|table| table.name == "time_step").expect("the time step is measured");
    let orders: Vec<f64> = table.rows.iter().filter_map(|row| row.values[2]).collect();
    assert_eq!(orders.len(), 3);
    // Two between events. A contact that opens or closes within a step has a kink in its stiffness and a jump in its damping,
    // a local error of first order or second, so single halvings fall short (2.0, 0.9 and 1.8 here); all three together must
    // divide the error by well over the 8 of first order.
    let all: f64 = orders.iter().sum();
    assert!(all > 4.0 && all < 7.0, "{orders:?}");
}

#[test]
fn ladders_that_make_no_sense_are_refused_by_name() {
    let refused = |settings| measure(&scene(), &settings, &()).expect_err("refused").to_string();
    let said = refused(PrecisionSettings { force_limits: vec![1e-3, -1.0], ..PrecisionSettings::default() });
    assert_eq!(said, "force_limits = -1: must be a positive, finite number");
    let said = refused(PrecisionSettings { force_limits: Vec::new(), ..PrecisionSettings::default() });
    assert_eq!(said, "force_limits is empty");
    let mut missing = scene();
    missing.sample[0].source = Source::File("no such file".into());
    let error = measure(&missing, &settings(), &()).expect_err("no file");
    assert!(matches!(&error, PrecisionError::Sample { name, .. } if name == "dense"), "{error}");
    assert!(error.to_string().contains("no such file"), "{error}");
}
