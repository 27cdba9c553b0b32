//! Several relaxers from one start: one minimum where there is but one, two where inertia throws a disk through a gap, and what
//! a scene and its report make of it.

use jamscope::inflation::{Boundary, Inflation, inflate_with};
use jamscope::io::read_packing;
use jamscope::law::Hookean;
use jamscope::law::damping::{ConstantDamping, DampingChoice};
use jamscope::network::ContactNetwork;
use jamscope::packing::{Domain, Packing};
use jamscope::protocol::{Compared, Protocol, ProtocolSettings, ProtocolSummary, Spread, chosen};
use jamscope::relax::{
    Fire, ForceLimit, GradientFlow, ImplicitDynamics, Newton, QuasiNewton, Relaxer, RelaxerChoice, Staged, Stop,
};
use jamscope::report::table::terminal_table;
use jamscope::report::write;
use jamscope::run::{Report, SampleOutcome, run};
use jamscope::scene::{Observables, Sample, Scene, Source};
use jamscope::vector::{Vector, norm};

use crate::scenes::laws::hertzian;

const STIFF: Hookean = Hookean { stiffness: 1.0 };

/// Disks of radius 1/2: the first `mobile_count` can move.
fn disks(mobile_count: usize, positions: Vec<Vector<2>>) -> Packing<2> {
    let count = positions.len();
    Packing::new(Domain::Open, positions, vec![0.5; count])
        .and_then(|packing| packing.with_held((0..count).map(|disk| disk >= mobile_count).collect()))
        .expect("a packing")
}

fn compare(start: &Packing<2>, protocols: &[Protocol]) -> Compared<2> {
    let pressure = |network: &ContactNetwork<2>| network.pressure(1.0);
    Compared::of_start(start, &STIFF, protocols, &ProtocolSettings::default(), 0.0, pressure, &mut ())
        .expect("disks apart")
}

fn all() -> Vec<Protocol> {
    Protocol::all(&RelaxerChoice::default())
}

fn implicit(rate: f64) -> Protocol {
    let damping = DampingChoice::Constant(ConstantDamping { rate });
    let relaxer = RelaxerChoice::Implicit(ImplicitDynamics { damping, ..ImplicitDynamics::default() });
    Protocol { name: format!("rate {rate}"), relaxer }
}

/// Two disks in a row between walls at ±1.4, each between a held disk above it and one below, 0.95 away.
///
/// By symmetry they stand at ±x with equal overlaps along the row: 1 − (1.4 − x) = 1 − 2x, so x = 7/15.
#[test]
fn two_disks_between_walls_have_one_minimum_and_every_relaxer_finds_it() {
    let x = 7.0 / 15.0;
    let held = [[-1.4, 0.0], [1.4, 0.0], [-x, 0.95], [-x, -0.95], [x, 0.95], [x, -0.95]];
    let start = disks(2, [[-x - 0.03, 0.02], [x - 0.04, -0.01]].into_iter().chain(held).collect());
    let compared = compare(&start, &all());
    let found = &compared.sensitivity;
    assert_eq!(found.minimum_count, 1);
    assert_eq!(found.nearest_between, None);
    assert_eq!(found.endings.len(), 7, "FIRE is the scene's own and not done twice");
    // Residual 10⁻¹⁰ of a mean force 0.06 over a stiffness of at least 1.
    let tolerance = 1e-11;
    let overlap = 1.0 - 2.0 * x;
    // Three contacts along the row, four across.
    let energy = 0.5 * (3.0 * overlap * overlap + 4.0 * 0.05 * 0.05);
    let mean = (3.0 * overlap + 4.0 * 0.05) / 7.0;
    assert!((found.mean_overlap - mean).abs() < tolerance, "{}", found.mean_overlap);
    for (ending, state) in found.endings.iter().zip(&compared.states) {
        let state = state.as_ref().expect("at rest").packing.get();
        for (disk, place) in [[-x, 0.0], [x, 0.0]].into_iter().enumerate() {
            for axis in 0..2 {
                let error = (state.positions()[disk][axis] - place[axis]).abs();
                assert!(error < tolerance, "{}: disk {disk} is {error:e} off", ending.relaxer);
            }
        }
        assert!((ending.energy - energy).abs() < tolerance, "{}: {}", ending.relaxer, ending.energy);
        assert_eq!((ending.minimum, ending.contact_difference_count), (Some(1), Some(0)), "{}", ending.relaxer);
        assert!(ending.distance.expect("at rest") < tolerance && ending.differing.is_empty());
    }
    assert!(found.farthest_within < 1e-9);
}

/// Where a disk comes to rest above a gap between held disks at (±0.95, 0), pressed by a held one at (0, 1.25).
///
/// ```text
/// y − 0.25 = 2 (1 − r) y/r        r = √(0.95² + y²)        (stiffness 1)
/// ```
fn above_the_gap() -> f64 {
    let net = |y: f64| {
        let r = y.hypot(0.95);
        y - 0.25 - 2.0 * (1.0 - r) * y / r
    };
    let (mut low, mut high) = (0.25, 0.31);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if net(middle) < 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Pressed half-way into the disk above it, a disk is thrown at the gap. Without inertia it stays above (the top contact ends at
/// y = 0.25, and the gap pushes back from 0.31 on). Lightly damped (a quarter of critical) it keeps some 0.7 of its speed 0.25
/// at the end of the contact: 0.015 of kinetic energy against a barrier of 2 · 0.05²/2 = 0.0025. It comes back from the disk
/// below with 0.4 of that speed at most, too slow to pass again.
#[test]
fn a_disk_thrown_through_a_gap_makes_two_minima_and_is_named() {
    let well = |x: f64| [[x - 0.95, 0.0], [x + 0.95, 0.0], [x, 0.95], [x, -0.95]];
    let gap = [[-0.95, 0.0], [0.95, 0.0], [0.0, 1.25], [0.0, -1.25]];
    // A disk in a well of its own stands by.
    let positions = [[10.02, -0.03], [0.0, 0.5]].into_iter().chain(gap).chain(well(10.0)).collect();
    let labels = (100..110).collect();
    let start = disks(2, positions).with_labels(labels).expect("distinct");
    let flow = Protocol::new(RelaxerChoice::GradientFlow(GradientFlow::default()));
    let protocols = [flow, implicit(50.0), implicit(0.5), implicit(20.0)];
    let compared = compare(&start, &protocols);
    let found = &compared.sensitivity;
    let minima: Vec<_> = found.endings.iter().map(|ending| ending.minimum.expect("at rest")).collect();
    assert_eq!(minima, [1, 1, 2, 1]);
    assert_eq!((found.minimum_count, found.reference), (2, Some(0)));
    let thrown = &found.endings[2];
    assert_eq!(thrown.differing, [101]);
    // The contact with the disk above for that with the disk below.
    assert_eq!(thrown.contact_difference_count, Some(2));
    // Softest stiffness here 0.05 at least, residual 10⁻¹⁰ of forces below 0.05.
    let distance = 2.0 * above_the_gap();
    assert!((thrown.distance.expect("at rest") - distance).abs() < 1e-9, "{thrown:?}, not {distance}");
    assert_eq!(found.largest_distance, thrown.distance.expect("at rest"));
    assert!((found.nearest_between.expect("two") - distance / found.mean_overlap).abs() < 1e-6);
    assert!(found.farthest_within < 1e-7);
    // Mirror images: equal energies, so no spread there.
    let energy = found.spreads.energy.expect("at rest");
    assert_eq!(energy.count, 4);
    assert!(energy.standard_deviation < 1e-11);
}

#[test]
fn what_does_not_come_to_rest_or_has_no_contacts_is_in_no_minimum() {
    let held = [[-0.95, 0.0], [0.95, 0.0], [0.0, 0.95], [0.0, -0.95]];
    let start = disks(1, [[0.03, 0.02]].into_iter().chain(held).collect());
    let hasty = Fire { step_limit: 1, ..Fire::default() };
    let protocols =
        [Protocol::new(RelaxerChoice::Fire(hasty)), Protocol::new(RelaxerChoice::Newton(Newton::default()))];
    let compared = compare(&start, &protocols);
    let (found, hasty) = (&compared.sensitivity, &compared.sensitivity.endings[0]);
    assert_eq!((hasty.stop, hasty.finish, hasty.minimum), (Stop::StepLimit, None, None));
    assert!(!hasty.at_rest() && compared.states[0].is_none());
    assert_eq!((found.reference, found.minimum_count), (Some(1), 1));
    assert_eq!(found.spreads.pressure_change.map(|spread| spread.count), Some(1));

    let apart = disks(1, vec![[0.0, 0.0], [0.9, 0.0]]);
    let found = compare(&apart, &all()).sensitivity;
    assert_eq!((found.reference, found.minimum_count), (None, 0));
    for ending in &found.endings {
        assert!(ending.at_rest() && ending.minimum.is_none() && ending.distance.is_none(), "{ending:?}");
        assert_eq!(ending.pressure, 0.0);
    }
}

/// At p = 800 no contact is near to opening: in the circle every relaxer ends in the same minimum; nothing held, as well.
#[test]
fn far_from_jamming_all_relaxers_share_a_minimum() {
    let packing = read_packing::<2>("fixtures/packings/hertz_N1000_p800.xyz").expect("readable");
    let (law, staged) = (hertzian(), Staged::default());
    let two = [
        Protocol::new(RelaxerChoice::Fire(Fire::default())),
        Protocol::new(RelaxerChoice::QuasiNewton(QuasiNewton::default())),
    ];
    for (boundary, protocols) in [(Boundary::default(), all()), (Boundary::Periodic, two.to_vec())] {
        let inflation = Inflation { boundary, ..Inflation::default() };
        let inflated = inflate_with(&inflation, &packing, &law, &staged, 1, &mut ()).expect("at rest");
        let settings = ProtocolSettings::default();
        let compared =
            Compared::of_inflation(&inflated, &inflation, &law, &protocols, &settings, &mut ()).expect("disks apart");
        let found = &compared.sensitivity;
        assert_eq!(found.minimum_count, 1);
        // 10⁻¹⁰ of ⟨F⟩ over a softest stiffness of 10⁻⁴ of that of a contact.
        assert!(found.farthest_within < 1e-6, "{}", found.farthest_within);
        // Δp as the inflation itself has it, which is at rest to 10⁻⁸.
        let expected = inflated.after.pressure - inflated.before.pressure;
        let change = found.spreads.pressure_change.expect("at rest");
        assert_eq!(change.count, protocols.len());
        assert!((change.mean - expected).abs() < 1e-6 * expected.abs(), "{} for {expected}", change.mean);
        assert!(change.standard_deviation < 1e-8 * expected.abs());
    }
}

#[cfg(feature = "fit")]
#[test]
fn fits_of_endings_spread_as_their_minima_do() {
    use jamscope::fit::profile::ProfileFitSettings;
    let packing = read_packing::<2>("fixtures/packings/hertz_N1000_p100.xyz").expect("readable");
    let (law, staged, inflation) = (hertzian(), Staged::default(), Inflation::default());
    let inflated = inflate_with(&inflation, &packing, &law, &staged, 2, &mut ()).expect("at rest");
    let implicit = ImplicitDynamics::default();
    let protocols =
        [RelaxerChoice::Staged(staged), RelaxerChoice::Fire(Fire::default()), RelaxerChoice::Implicit(implicit)];
    let protocols = protocols.map(Protocol::new);
    let settings = ProtocolSettings::default();
    let mut compared =
        Compared::of_inflation(&inflated, &inflation, &law, &protocols, &settings, &mut ()).expect("disks apart");
    compared.fit(&inflated, 1.0, &ProfileFitSettings::default());
    let found = &compared.sensitivity;
    let amplitudes: Vec<f64> = found.endings.iter().map(|it| it.fit.expect("a fit").elastic_amplitude).collect();
    let spread = found.spreads.elastic_amplitude.expect("fits");
    assert_eq!(Some(spread), Spread::of(amplitudes.iter().copied()));
    for (one, first) in found.endings.iter().zip(&amplitudes) {
        for (two, second) in found.endings.iter().zip(&amplitudes) {
            let same = (first - second).abs() < 1e-9 * first.abs();
            assert_eq!(same, one.minimum == two.minimum, "{} and {}", one.relaxer, two.relaxer);
        }
    }
}

#[test]
fn a_spread_is_the_standard_deviation_of_a_sample() {
    let spread = Spread::of([1.0, 2.0, 6.0].into_iter()).expect("three values");
    // ((−2)² + (−1)² + 3²)/2 = 7.
    assert_eq!(spread, Spread { count: 3, mean: 3.0, standard_deviation: 7f64.sqrt() });
    assert_eq!(Spread::of([4.0].into_iter()).map(|spread| spread.standard_deviation), Some(0.0));
    assert_eq!(Spread::of(std::iter::empty()), None);
    assert_eq!(ProtocolSummary::of(3, &[]), None);
}

#[test]
fn a_fraction_takes_the_same_samples_whatever_their_order_and_a_larger_one_those_too() {
    let samples: Vec<(String, u64)> = (0..40).map(|index| (format!("s{index}"), 1 + index % 3)).collect();
    let named = |samples: &[(String, u64)], fraction: f64| -> Vec<String> {
        let list: Vec<(&str, u64)> = samples.iter().map(|(name, seed)| (name.as_str(), *seed)).collect();
        let taken = chosen(&list, fraction);
        let mut names: Vec<String> =
            list.iter().zip(taken).filter(|(_, taken)| *taken).map(|((name, _), _)| (*name).to_owned()).collect();
        names.sort();
        names
    };
    let backwards: Vec<(String, u64)> = samples.iter().rev().cloned().collect();
    let mut before: Vec<String> = Vec::new();
    for (fraction, count) in [(0.001, 1), (0.1, 4), (0.3, 12), (0.5, 20), (0.99, 40), (1.0, 40)] {
        let taken = named(&samples, fraction);
        assert_eq!(taken.len(), count, "{fraction}");
        assert_eq!(taken, named(&backwards, fraction));
        assert!(before.iter().all(|name| taken.contains(name)));
        before = taken;
    }
    let others: Vec<(String, u64)> = samples.iter().map(|(name, seed)| (name.clone(), seed + 10)).collect();
    assert_ne!(named(&samples, 0.5), named(&others, 0.5), "seeds count");
}

/// A triangular lattice in a periodic box, pressed by 0.03, with a small disk in a vacancy, pressed into a neighbour: it is pushed
/// away and ends anywhere in its cage, and the lattice, whose centre of mass moves against it, elsewhere by a 36th of that.
#[test]
fn where_nothing_is_held_a_rattler_does_not_make_a_minimum() {
    let (spacing, side) = (0.97, 6usize);
    let row = spacing * 0.75f64.sqrt();
    let lattice = (0..side * side).map(|index| {
        let (i, j) = ((index % side) as f64, index / side);
        [spacing * (i + 0.5 * (j % 2) as f64), row * j as f64]
    });
    let mut positions: Vec<Vector<2>> = lattice.collect();
    let mut radii = vec![0.5; side * side];
    positions[0] = [0.25, 0.05];
    radii[0] = 0.3;
    let domain = Domain::rectangular([0.0; 2], [spacing * side as f64, row * side as f64]);
    let start = Packing::new(domain, positions, radii).expect("a packing");
    let protocols = [Protocol::new(RelaxerChoice::GradientFlow(GradientFlow::default())), implicit(0.2)];
    let compared = compare(&start, &protocols);
    let states: Vec<_> = compared.states.iter().map(|state| state.as_ref().expect("at rest")).collect();
    assert!(states.iter().all(|state| !state.backbone[0]), "a rattler");
    // The premise: the rattlers are apart, and with them the lattices.
    let apart = |disk: usize| {
        let [one, two] = [states[0], states[1]].map(|state| state.packing.get());
        norm(domain.separation(one.centre(disk), two.centre(disk)))
    };
    assert!(apart(0) > 0.01 && apart(20) > 1e-4, "{} {}", apart(0), apart(20));
    let found = &compared.sensitivity;
    assert_eq!(found.minimum_count, 1);
    assert!(found.farthest_within < 1e-7, "{}", found.farthest_within);
}

/// Four small dense packings.
fn scene(protocol: Option<ProtocolSettings>) -> Scene {
    let sample = |seed: u64| Sample {
        name: format!("s{seed}"),
        seed,
        source: Source::Pressure(3000.0),
        relaxer: RelaxerChoice::default(),
    };
    let observables = Observables { protocol, ..Observables::default() };
    Scene { disk_count: 120, observables, sample: (1..=4).map(sample).collect(), ..Scene::default() }
}

fn json(report: &Report) -> serde_json::Value {
    serde_json::to_value(report).expect("serialisable")
}

/// The names of the samples with a comparison.
fn compared(report: &Report) -> Vec<String> {
    let has = |outcome: &SampleOutcome| matches!(outcome, SampleOutcome::Done(it) if it.protocol.is_some());
    report.samples.iter().filter(|sample| has(&sample.result)).map(|sample| sample.name.clone()).collect()
}

#[test]
fn a_scene_compares_the_fraction_asked_for_and_nothing_changes_where_it_does_not() {
    let half = Some(ProtocolSettings { fraction: 0.5, ..ProtocolSettings::default() });
    let [report, again, without] = [half, half, None].map(|protocol| run(&scene(protocol), &()).expect("sense"));
    assert_eq!(compared(&report).len(), 2);
    assert_eq!(json(&report), json(&again));
    assert!(compared(&without).is_empty());

    let folder = tempfile::tempdir().expect("a temporary folder");
    let files = |report: &Report, name: &str| -> Vec<(String, String)> {
        let paths = write(report, &folder.path().join(name)).expect("written");
        let text = |path: &std::path::PathBuf| std::fs::read_to_string(path).expect("text");
        let name = |path: &std::path::PathBuf| path.file_name().expect("a file").to_string_lossy().into_owned();
        paths.iter().map(|path| (name(path), text(path))).collect()
    };
    let plain = files(&without, "without");
    assert!(plain.iter().all(|(name, text)| !name.contains("protocol") && !text.contains("rotocol")));
    assert!(!terminal_table(&without).contains("rotocol"));

    // Taken out again, what is left is the report without.
    let mut left = json(&report);
    let all = left.as_object_mut().expect("a table");
    let summary = all.remove("protocol").expect("a summary");
    assert_eq!((&summary["sample_count"], &summary["compared_count"]), (&4.into(), &2.into()));
    all["scene"]["observables"].as_object_mut().expect("a table").remove("protocol").expect("named");
    for sample in all["samples"].as_array_mut().expect("samples") {
        sample["done"].as_object_mut().expect("done").remove("protocol");
    }
    assert_eq!(left, json(&without));

    let with = files(&report, "with");
    for name in compared(&report) {
        let (_, text) = with.iter().find(|(file, _)| *file == format!("{name}.protocol.csv")).expect("a file");
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 2 + 7, "names, units, an ending a line");
        assert!(lines[2].starts_with("\"FIRE\",at rest,1,0,0,0,"), "{}", lines[2]);
    }
    assert_eq!(with.iter().filter(|(file, _)| file.ends_with("protocol.csv")).count(), 2);
    let table = terminal_table(&report);
    for text in ["\nProtocols\n", "  minima ", "scatter of minima: Δp", "Protocols: 2 of 4 samples compared, "] {
        assert!(table.contains(text), "{text}\n{table}");
    }
    if cfg!(feature = "plot") {
        let (_, page) = with.iter().find(|(file, _)| file == "report.html").expect("a page");
        assert_eq!(page.matches("Minima reached by other relaxers").count(), 2);
    }
}

#[test]
fn a_fraction_or_a_tolerance_that_makes_no_sense_is_refused_by_name() {
    for fraction in [0.0, -0.5, 1.5, f64::NAN] {
        let settings = ProtocolSettings { fraction, ..ProtocolSettings::default() };
        let message = scene(Some(settings)).check().expect_err("refused").to_string();
        assert_eq!(message, format!("observables.protocol.fraction = {fraction}: must be above 0 and at most 1"));
    }
    let settings = ProtocolSettings { same_minimum: 1.0, ..ProtocolSettings::default() };
    let message = scene(Some(settings)).check().expect_err("refused").to_string();
    assert_eq!(message, "observables.protocol.same_minimum = 1: must be above 0 and below 1");
    let unknown = serde_json::from_str::<ProtocolSettings>("{ \"share\": 0.5 }");
    assert!(unknown.expect_err("no such field").to_string().contains("unknown field `share`"));
}

#[test]
fn the_own_relaxer_stands_first_and_once() {
    let names = |own: RelaxerChoice| Protocol::all(&own).into_iter().map(|it| it.name).collect::<Vec<_>>();
    let own = names(RelaxerChoice::Implicit(ImplicitDynamics::default()));
    assert_eq!((own[0].as_str(), own.len()), ("implicit, constant", 7));
    let fine = Fire { limit: ForceLimit::Relative(1e-9), ..Fire::default() };
    assert_eq!(names(RelaxerChoice::Fire(fine)).len(), 8, "other settings, another protocol");
    // The states are those of the relaxer itself.
    let start = disks(1, vec![[0.03, 0.02], [-0.95, 0.0], [0.95, 0.0], [0.0, 0.95], [0.0, -0.95]]);
    let alone = fine.relax(start.clone(), &STIFF, &mut ()).expect("disks apart");
    let compared = compare(&start, &[Protocol::new(RelaxerChoice::Fire(fine))]);
    assert_eq!(compared.sensitivity.endings[0].cost.step_count, alone.cost.step_count);
}
