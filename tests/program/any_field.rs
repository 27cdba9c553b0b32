//! Scenes and studies with any value in any field: refused, or written and read back as they were.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::LazyLock;

use crate::seeds::config;
use jamscope::law::{Hertzian, LawChoice, PowerLaw};
use jamscope::observe::angular::{CorrelationEstimator, FrequencyLimit, SpectrumEstimator};
use jamscope::observe::isostatic::{IsostaticRule, Normalisation};
use jamscope::relax::{DampedDynamics, Fire, NonlinearConjugateGradients, QuasiNewton, RelaxerChoice, TimeStep};
use jamscope::scene::{NotWritable, Observables, Sample, Scene, SceneError, Source, TomlError, finite_numbers};
use jamscope::study::{Part, Seeds, Study, Target};
use proptest::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;
use toml::Value;

/// Every kind of relaxer, so that their fields are tried too.
fn relaxers() -> Vec<RelaxerChoice> {
    let fixed = DampedDynamics { time_step: TimeStep::Fixed(1e-4), ..DampedDynamics::default() };
    let all = vec![
        RelaxerChoice::Fire(Fire::default()),
        RelaxerChoice::Damped(DampedDynamics::default()),
        RelaxerChoice::Damped(fixed),
        RelaxerChoice::ConjugateGradients(NonlinearConjugateGradients::default()),
        RelaxerChoice::QuasiNewton(QuasiNewton::default()),
    ];
    #[cfg(feature = "linear")]
    let all = {
        let linear = [
            RelaxerChoice::Implicit(Default::default()),
            RelaxerChoice::GradientFlow(Default::default()),
            RelaxerChoice::Newton(Default::default()),
            RelaxerChoice::Staged(Default::default()),
        ];
        [all, linear.to_vec()].concat()
    };
    all
}

/// A scene that names every observable and every relaxer, with numbers where the default has none.
fn full_scene() -> Scene {
    let mut observables = Observables::default();
    #[cfg(feature = "linear")]
    {
        observables.protocol = Some(Default::default());
    }
    #[cfg(feature = "fit")]
    if let Some(modes) = &mut observables.elastic_modes {
        modes.poisson_ratio = Some(0.3);
    }
    if let Some(angular) = &mut observables.angular_correlation {
        angular.spectrum.frequency_limit = FrequencyLimit::Fixed(3);
        angular.spectrum.estimator = SpectrumEstimator::Interpolated { points_per_disk: 4.0 };
        angular.correlation.estimator = CorrelationEstimator::Pairs { bin_count: 90 };
    }
    if let Some(isostatic) = &mut observables.isostatic_length {
        isostatic.normalisation = Normalisation::NearCentre { radius: 2.0 };
        isostatic.rule = IsostaticRule::Plateau { from: 0.3, to: 0.6, share: 0.5 };
    }
    let law = LawChoice::PowerLaw(PowerLaw { energy_scale: 1e5, exponent: 2.5 });
    let mut scene = Scene { law, observables, ..Scene::default() };
    scene.inflation.on_site_coupling = Some(0.0);
    let sample = |(index, relaxer): (usize, RelaxerChoice)| {
        let source = if index % 2 == 0 { Source::Pressure(800.0) } else { Source::PackingFraction(0.9) };
        Sample { name: format!("sample_{index}"), seed: index as u64, source, relaxer }
    };
    scene.sample = relaxers().into_iter().enumerate().map(sample).collect();
    scene
}

fn full_study() -> Study {
    let scene = Scene { sample: Vec::new(), ..full_scene() };
    let targets = vec![Target::Pressure(100.0), Target::ReducedPressure(1e7), Target::PackingFraction(0.9)];
    let part = Part {
        disk_counts: vec![70],
        increases: vec![0.05],
        seeds: Some(Seeds { first: 9, count: 2 }),
        ..Part::default()
    };
    Study {
        scene,
        disk_counts: vec![300, 400],
        targets,
        increases: vec![0.1, 0.02],
        centres_held: vec![true, false],
        laws: vec![LawChoice::Hertzian(Hertzian::default())],
        relaxers: relaxers(),
        seeds: Seeds { first: 1, count: 3 },
        parts: vec![Part::default(), part],
        time_limit: Some(60.0),
    }
}

/// The places of all numbers in a value.
fn numbers(value: &Value, path: &str, found: &mut Vec<String>) {
    match value {
        Value::Float(_) | Value::Integer(_) => found.push(path.to_string()),
        Value::Table(table) => {
            for (name, inner) in table {
                let dot = if path.is_empty() { "" } else { "." };
                numbers(inner, &format!("{path}{dot}{name}"), found);
            }
        }
        Value::Array(list) => {
            for (index, inner) in list.iter().enumerate() {
                numbers(inner, &format!("{path}[{index}]"), found);
            }
        }
        _ => {}
    }
}

/// The value at a place.
fn at<'a>(value: &'a mut Value, path: &str) -> &'a mut Value {
    path.split(['.', '[']).fold(value, |value, step| match step.strip_suffix(']') {
        Some(index) => &mut value[index.parse::<usize>().expect("an index")],
        None => &mut value[step],
    })
}

/// What a scene and a study have in common here.
trait Settings: Serialize + DeserializeOwned + PartialEq + std::fmt::Debug {
    fn text(&self) -> String;
    fn read(text: &str) -> Result<Self, TomlError>;
}

impl Settings for Scene {
    fn text(&self) -> String {
        self.to_toml().expect("it passed, so it has a form")
    }

    fn read(text: &str) -> Result<Self, TomlError> {
        Scene::from_toml(text)
    }
}

impl Settings for Study {
    fn text(&self) -> String {
        self.to_toml().expect("it passed, so it has a form")
    }

    fn read(text: &str) -> Result<Self, TomlError> {
        Study::from_toml(text)
    }
}

/// As a table of values, and from one.
fn table(settings: &impl Settings) -> Value {
    Value::Table(toml::from_str(&settings.text()).expect("a table"))
}

fn of_table<T: Settings>(value: &Value) -> Result<T, TomlError> {
    T::read(&toml::to_string(value).expect("plain data"))
}

/// What is in a file again, by both formats.
fn read_back<T: Settings>(settings: &T) {
    let json = serde_json::to_string(settings).expect("it passed, so it has a form");
    assert_eq!(&serde_json::from_str::<T>(&json).expect("it passed, so it can be read"), settings);
    assert_eq!(&T::read(&settings.text()).expect("it passed, so it can be read"), settings);
}

/// Sets a number; where the field is an integer, a value that is one.
fn set(value: &mut Value, path: &str, number: f64) {
    let place = at(value, path);
    *place = match place {
        Value::Integer(_) => Value::Integer(number as i64),
        _ => Value::Float(number),
    };
}

#[test]
fn nan_and_infinity_are_refused_in_every_field_of_scene_and_study() {
    let whole = table(&full_scene());
    let mut paths = Vec::new();
    numbers(&whole, "", &mut paths);
    let mut floats = 0;
    for path in &paths {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut value = whole.clone();
            if !at(&mut value, path).is_float() {
                continue;
            }
            floats += 1;
            set(&mut value, path, bad);
            let scene: Scene = of_table(&value).expect("a number is a number");
            let said = scene.check().expect_err(path).to_string();
            assert!(said.contains("NaN") || said.contains("inf"), "{path}: {said}");
            // The check of all fields alone names the very field.
            match finite_numbers::check(&scene) {
                Err(NotWritable::NotFinite { field, .. }) => assert_eq!(field, *path),
                other => panic!("{path}: {other:?}"),
            }
        }
    }
    // 9 relaxers, 15 observables.
    assert!(floats > 3 * 50, "{floats} numbers");
    let whole = table(&full_study());
    let mut paths = Vec::new();
    numbers(&whole, "", &mut paths);
    for path in &paths {
        let mut value = whole.clone();
        if at(&mut value, path).is_float() {
            set(&mut value, path, f64::NAN);
            let study: Study = of_table(&value).expect("a number is a number");
            assert!(study.check().is_err(), "{path}");
        }
    }
}

#[test]
fn a_path_that_is_no_text_is_refused_before_the_work() {
    #[cfg(unix)]
    {
        use std::os::unix::ffi::OsStrExt;
        let mut scene = full_scene();
        assert_eq!(scene.check(), Ok(()));
        scene.sample[1].source = Source::File(std::ffi::OsStr::from_bytes(b"\xff.xyz").into());
        let said = scene.check().expect_err("no Unicode");
        assert!(matches!(&said, SceneError::NotWritable(NotWritable::NoForm { .. })), "{said}");
        assert!(said.to_string().contains("sample[1].source.file"), "{said}");
    }
}

static WHOLE_SCENE: LazyLock<Value> = LazyLock::new(|| table(&full_scene()));
static WHOLE_STUDY: LazyLock<Value> = LazyLock::new(|| table(&full_study()));

/// Numbers people write, by accident or not.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => any::<f64>(),
        4 => (-30f64..30.0, any::<bool>()).prop_map(|(ten, up)| if up { libm::exp10(ten) } else { -libm::exp10(ten) }),
        4 => (0i64..100).prop_map(|it| it as f64),
        4 => 0.0..1.0,
        1 => prop::sample::select(vec![f64::NAN, f64::INFINITY, f64::MAX, f64::MIN_POSITIVE, -0.0, 5e-324, 9e18]),
    ]
}

proptest! {
    // Debug builds check in a third of a millisecond.
    #![proptest_config(config(2000, 20))]

    #[test]
    fn a_scene_that_passes_is_written_and_read_back(changes in prop::collection::vec((any::<prop::sample::Index>(), any_number()), 1..4)) {
        let mut value = WHOLE_SCENE.clone();
        let mut paths = Vec::new();
        numbers(&value, "", &mut paths);
        changes.iter().for_each(|(place, number)| set(&mut value, &paths[place.index(paths.len())], *number));
        // A negative count is refused by the reader.
        if let Ok(scene) = of_table::<Scene>(&value) {
            let checked = catch_unwind(AssertUnwindSafe(|| scene.check()));
            if checked.expect("no panic").is_ok() {
                read_back(&scene);
            }
        }
    }

    #[test]
    fn a_study_that_passes_is_written_and_read_back(changes in prop::collection::vec((any::<prop::sample::Index>(), any_number()), 1..4)) {
        let mut value = WHOLE_STUDY.clone();
        let mut paths = Vec::new();
        numbers(&value, "", &mut paths);
        changes.iter().for_each(|(place, number)| set(&mut value, &paths[place.index(paths.len())], *number));
        if let Ok(study) = of_table::<Study>(&value) {
            let checked = catch_unwind(AssertUnwindSafe(|| study.check()));
            if checked.expect("no panic").is_ok() {
                read_back(&study);
            }
        }
    }
}

#[test]
fn the_full_scene_and_study_pass() {
    assert_eq!(full_scene().check(), Ok(()));
    assert_eq!(full_study().check(), Ok(()));
    read_back(&full_scene());
    read_back(&full_study());
}
