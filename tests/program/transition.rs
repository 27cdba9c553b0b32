//! What a study says of the transition, on studies made up with a known answer.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use jamscope::fit::ensemble::DivergenceOutcome;
use jamscope::inflation::Boundary;
use jamscope::law::damping::{ConstantDamping, DampingChoice, ViscoelasticDamping};
use jamscope::law::{Hertzian, LawChoice};
use jamscope::observe::angular::synthetic::{SyntheticSettings, gaussian_rings};
use jamscope::observe::angular::{PowerSpectrum, SpectrumSettings};
use jamscope::relax::{DampedDynamics, NetForce, RelaxerChoice};
use jamscope::study::{Cell, CellSamples, Merged, PhaseCounts, Study, Target};
use jamscope::transition::{
    CannotTell, ExponentOutcome, Method, MethodEstimate, Transition, TransitionPressure, Verdict,
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Of every cell.
const SAMPLES: usize = 60;

/// R/L.
const RATIO: f64 = 0.48;

fn cell(disk_count: usize, target: Target, increase: f64) -> Cell {
    Cell {
        dimension: 2,
        law: LawChoice::Hertzian(Hertzian::default()),
        disk_count,
        target,
        increase,
        relaxer: RelaxerChoice::default(),
        boundary: Boundary::HeldRim { outer_radius_over_side: RATIO },
        centre_held: true,
    }
}

/// A cell with these numbers and powers, one a sample.
fn samples(cell: Cell, numbers: &[(&str, Vec<f64>)], powers: Vec<Vec<f64>>) -> CellSamples {
    CellSamples {
        cell,
        done_count: numbers.first().map_or(SAMPLES, |(_, values)| values.len()),
        failures: BTreeMap::new(),
        phases: PhaseCounts::default(),
        evidence: Default::default(),
        numbers: numbers.iter().map(|(name, values)| ((*name).into(), values.clone())).collect(),
        powers,
        stretching: Vec::new(),
        curves: BTreeMap::new(),
        singles: Vec::new(),
    }
}

fn merged(samples: Vec<CellSamples>) -> Merged {
    Merged {
        study: Study::default(),
        sample_count: samples.len() * SAMPLES,
        record_count: samples.len() * SAMPLES,
        records_by_vectors: BTreeMap::from([("avx2".into(), samples.len() * SAMPLES)]),
        damaged: Vec::new(),
        foreign: Vec::new(),
        cells: samples.iter().map(CellSamples::statistics).collect(),
        samples,
        files: Vec::new(),
    }
}

/// p̂ = p N^(3/2), N disks in the circle by area.
fn mobile(disk_count: usize) -> f64 {
    PI * RATIO * RATIO * disk_count as f64
}

/// A standard normal number, by Box and Muller.
fn normal(generator: &mut Pcg64) -> f64 {
    let (u, v): (f64, f64) = (generator.random(), generator.random());
    (-2.0 * (1.0 - u).ln()).sqrt() * (2.0 * PI * v).cos()
}

/// What rises from 0 to 0.6 with x, 0.3 at x = 1.
fn rising(x: f64) -> f64 {
    0.6 * x.sqrt() / (1.0 + x.sqrt())
}

/// Every method's truth: p̂_c = 3·10⁷.
const CRITICAL: f64 = 3e7;

/// One series of 4016 disks in the circle, whose transition every method sees at [`CRITICAL`].
fn one_series(seed: u64) -> Vec<CellSamples> {
    let mut generator = Pcg64::seed_from_u64(seed);
    let disks = 5548;
    let reduced = [1e6, 3e6, 1e7, 2e7, 5e7, 1e8, 3e8, 1e9];
    let cells = reduced.map(|reduced: f64| {
        let pressure = reduced / mobile(disks).powf(1.5);
        let ratio = reduced / CRITICAL;
        let mut draw =
            |of: &mut dyn FnMut(&mut Pcg64) -> f64| (0..SAMPLES).map(|_| of(&mut generator)).collect::<Vec<f64>>();
        let scale = 0.292_893 / 0.3;
        let depth = draw(&mut |g| scale * rising(ratio) + 0.1 * normal(g));
        let angle = draw(&mut |g| 0.303_004 * PI / 0.3 * rising(ratio) + 0.1 * normal(g));
        // Plastic with probability 1/(1 + p̂/p̂_c).
        let kappa = draw(&mut |g| if g.random::<f64>() < 1.0 / (1.0 + ratio) { 5.0 / 40.0 } else { 0.0 });
        let change = draw(&mut |g| if g.random::<f64>() < 1.0 / (1.0 + ratio) { -1.0 } else { 0.1 });
        // Exponential powers about f^(−s), s = 1.5 at the transition and 0.25 more a factor of ten.
        let slope = 1.5 + 0.25 * ratio.log10();
        let powers = (0..SAMPLES)
            .map(|_| (1..=30).map(|f| -(1.0 - generator.random::<f64>()).ln() * f64::from(f).powf(-slope)).collect())
            .collect();
        let numbers = [
            ("pressure", vec![pressure; SAMPLES]),
            ("reduced_pressure", vec![reduced; SAMPLES]),
            ("outer_radius", vec![40.0; SAMPLES]),
            ("anticorrelation", depth),
            ("correlation_angle_at_0.1", angle),
            ("wavenumber", kappa),
            ("pressure_change", change),
        ];
        samples(cell(disks, Target::ReducedPressure(reduced), 0.1), &numbers, powers)
    });
    cells.to_vec()
}

#[test]
fn every_method_finds_the_transition_it_was_given() {
    let transition = Transition::of(&merged(one_series(1)));
    assert_eq!(transition.series.len(), 1);
    let series = &transition.series[0];
    assert_eq!(series.points.len(), 8);
    let methods: Vec<Method> = series.estimates.iter().map(|it| it.method).collect();
    assert_eq!(methods.len(), 7);
    for estimate in &series.estimates {
        if estimate.method == Method::Crossover {
            // Slopes below 1.5 look like Lorentzians, above they do not. f† of a slope s a little below 1.5 is some power of 1.5 − s,
            // and 0.25 a factor of ten is little against its scatter: within a factor of three.
            let TransitionPressure::Found(found) = estimate.pressure else { panic!("{estimate:?}") };
            assert!((CRITICAL / 3.0..3.0 * CRITICAL).contains(&found.best), "{:.2e}", found.best);
            continue;
        }
        let TransitionPressure::Found(found) = estimate.pressure else { panic!("{estimate:?}") };
        let error = found.standard_error.expect("an interval") / found.best;
        // Linear in ln p̂ between cells a factor of two apart, what is crossed errs by the curvature of the truth: below 0.02
        // in ln p̂ for all of these. Then four standard errors, which six methods exceed once in 2600 seeds.
        let away = (found.best / CRITICAL).ln().abs();
        assert!(away < 4.0 * error + 0.02, "{:?}: {:.3e}, {away} of {error}", estimate.method, found.best);
        assert!(error < 0.5, "{:?}: {error}", estimate.method);
        let [low, high] = found.interval.expect("an interval");
        assert!(low < found.best && found.best < high);
    }
    let at = series.at_transition.expect("the slope passes 1.5");
    let depth = at.anticorrelation.expect("every cell has G*");
    assert!((depth.found.best - 0.293).abs() < 0.06, "{}", depth.found.best);
    let at = series.at_published.expect("10⁸ is within the series");
    for slope in [at.slope, at.likelihood_slope] {
        let slope = slope.expect("spectra");
        assert_eq!(slope.sample_count, SAMPLES);
        // s = 1.5 + 0.25 log₁₀(10/3) = 1.631 at p̂ = 10⁸.
        let (best, error) = (slope.found.best, slope.found.standard_error.expect("samples"));
        assert!((best - 1.631).abs() < 4.0 * error, "{best}");
    }
    // Both slopes of every cell, with their intervals.
    for spectrum in &series.spectra {
        let [line, likely] = [spectrum.slope, spectrum.likelihood_slope].map(|it| it.expect("a slope"));
        assert!(line.interval.is_some() && likely.interval.is_some());
        let error = line.standard_error.expect("samples").hypot(likely.standard_error.expect("samples"));
        assert!((line.best - likely.best).abs() < 4.0 * error, "{line:?} {likely:?}");
    }
}

/// The first samples of every cell.
fn shortened(cells: &[CellSamples], count: usize) -> Vec<CellSamples> {
    let mut cells = cells.to_vec();
    for cell in &mut cells {
        cell.done_count = count;
        cell.powers.truncate(count);
        cell.numbers.values_mut().for_each(|values| values.truncate(count));
    }
    cells
}

fn estimate(transition: &Transition, method: Method) -> MethodEstimate {
    let all = &transition.series[0].estimates;
    *all.iter().find(|it| it.method == method).expect("every cell has the observable")
}

#[test]
fn three_samples_a_cell_tell_nothing() {
    let study = merged(shortened(&one_series(1), 3));
    let transition = Transition::of(&study);
    let reason = CannotTell::FewSamples;
    assert_eq!(transition.series[0].estimates.len(), 7);
    for estimate in &transition.series[0].estimates {
        assert_eq!(estimate.pressure, TransitionPressure::Uninformative { reason }, "{:?}", estimate.method);
        assert_eq!((estimate.sample_count, estimate.measured), (3, None));
    }
    assert!(transition.series[0].at_transition.is_none() && transition.pressure_laws.is_empty());
    // Numbers at 10⁸ have values and intervals, but say nothing.
    assert!(transition.comparisons.len() > 7);
    for one in &transition.comparisons {
        assert_eq!((one.verdict, one.reason, one.sample_count), (Verdict::Uninformative, Some(reason), 3), "{one:?}");
    }
    // The files say so too.
    let folder = tempfile::tempdir().expect("a temporary folder");
    jamscope::report::write_study(&study, &transition, folder.path()).expect("written");
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).expect("written");
    let rows = read("transition.csv");
    let told = rows.lines().filter(|row| row.ends_with(",cannot tell,3,fewer than 8 samples in a cell"));
    assert_eq!(told.count(), transition.comparisons.len());
    #[cfg(feature = "plot")]
    {
        let page = read("report.html");
        assert!(page.contains("cannot tell: fewer than 8 samples in a cell") && !page.contains("differs by"));
        assert!(page.contains("Slope of S(f)") && page.contains("not fitted: 0 of 5 cells"));
    }
}

#[test]
fn cells_of_few_samples_leave_the_others_to_tell() {
    let mut cells = one_series(2);
    // The two cells about the transition, p̂ = 2·10⁷ and 5·10⁷, are cut to seven samples: others on either side remain.
    for place in [3, 4] {
        cells[place] = shortened(&cells[place..=place], 7).remove(0);
    }
    let found = estimate(&Transition::of(&merged(cells)), Method::Anticorrelation);
    assert_eq!((found.sample_count, found.measured), (SAMPLES, Some([1e6, 1e9])));
    let best = found.pressure.best().expect("six cells");
    assert!((1e7..1e8).contains(&best), "{best:.2e}");
}

#[test]
fn the_order_of_cells_and_samples_changes_nothing_but_the_draws() {
    let mut cells = one_series(2);
    let best = |cells: &[CellSamples]| -> Vec<(Method, f64)> {
        let transition = Transition::of(&merged(cells.to_vec()));
        // f† comes from a search, to its tolerance and no further.
        let estimates = transition.series[0].estimates.iter().filter(|it| it.method != Method::Crossover);
        estimates.filter_map(|it| Some((it.method, it.pressure.best()?))).collect()
    };
    let before = best(&cells);
    cells.reverse();
    for cell in &mut cells {
        cell.powers.reverse();
        cell.numbers.values_mut().for_each(|values| values.reverse());
    }
    for ((method, a), (_, b)) in before.iter().zip(best(&cells)) {
        // Sums of 60 values in another order. The slope by likelihood is searched: the minimum of a function is found to the root of its
        // rounding, 10⁻⁸, and ln p̂ changes by nine times as much (the slope by 0.25 a factor of ten).
        let tolerance = if *method == Method::SpectrumLikelihood { 1e-6 } else { 1e-10 };
        assert!((a / b - 1.0).abs() < tolerance, "{a} {b}");
    }
}

#[test]
fn series_that_do_not_reach_the_transition_bound_it() {
    let cells = one_series(3);
    let of = |range: std::ops::Range<usize>| Transition::of(&merged(cells[range].to_vec())).series[0].estimates.clone();
    let depth = |estimates: &[MethodEstimate]| {
        estimates.iter().find(|it| it.method == Method::Anticorrelation).expect("G*").pressure
    };
    assert_eq!(depth(&of(0..3)), TransitionPressure::Above(1e7));
    assert_eq!(depth(&of(5..8)), TransitionPressure::Below(1e8));
    let transition = Transition::of(&merged(cells[0..3].to_vec()));
    let found = transition.comparisons.iter().find(|it| it.quantity == "p̂_c by G*").expect("Hertzian, d_0 = 0.1");
    assert_eq!((found.value, found.verdict), (None, Verdict::Beyond));
    // One of two cells short of the level: the mean of the last one is less than two standard errors away.
    let mut near = cells[0..3].to_vec();
    let scatter = |i: usize| if i.is_multiple_of(2) { 0.1 } else { -0.1 };
    near[2].numbers.insert("anticorrelation".into(), (0..SAMPLES).map(|i| 0.285 + scatter(i)).collect());
    let reason = CannotTell::EndUndecided;
    assert_eq!(
        estimate(&Transition::of(&merged(near)), Method::Anticorrelation).pressure,
        TransitionPressure::Uninformative { reason }
    );
}

/// G* of three sizes and three inflations, p_c = critical N^(−a) d_0^b.
fn several_series(seed: u64, critical: f64, relaxer: RelaxerChoice) -> Vec<CellSamples> {
    let mut generator = Pcg64::seed_from_u64(seed);
    let (a, b) = (1.5, 0.75);
    let mut cells = Vec::new();
    for disks in [1387, 5548, 22184] {
        for increase in [0.02, 0.1, 0.5] {
            for step in 0..7 {
                // The scaled pressure, a tenth to ten times that of the transition.
                let x = 10f64.powf(f64::from(step) / 3.0 - 1.0);
                let pressure = critical * x * mobile(disks).powf(-a) * f64::powf(increase, b);
                let depth: Vec<f64> = (0..SAMPLES).map(|_| rising(x) + 0.05 * normal(&mut generator)).collect();
                let numbers = [
                    ("pressure", vec![pressure; SAMPLES]),
                    ("reduced_pressure", vec![pressure * mobile(disks).powf(1.5); SAMPLES]),
                    ("anticorrelation", depth),
                ];
                let cell = Cell { relaxer, ..cell(disks, Target::Pressure(pressure), increase) };
                cells.push(samples(cell, &numbers, Vec::new()));
            }
        }
    }
    cells
}

#[test]
fn curves_of_several_sizes_and_inflations_give_their_exponents() {
    let (a, b) = (1.5, 0.75);
    let transition = Transition::of(&merged(several_series(4, 1e8, RelaxerChoice::default())));
    assert_eq!(transition.series.len(), 9);
    let scaling = &transition.scaling[0];
    assert_eq!((scaling.observable, scaling.curve_count), ("anticorrelation", 9));
    for (outcome, truth) in [(scaling.size_exponent, a), (scaling.inflation_exponent, b)] {
        let Some(ExponentOutcome::Found(found)) = outcome else { panic!("{outcome:?}") };
        let error = found.standard_error.expect("an interval");
        assert!((found.best - truth).abs() < 4.0 * error && error < 0.05, "{} ± {error}, not {truth}", found.best);
    }
    // Curves agree: S is a mean over 63 points of a ratio whose mean is near 1, with a scatter of √(2/63) = 0.18.
    let quality = scaling.published_quality.expect("overlap").quality;
    assert!((0.4..1.8).contains(&quality), "{quality}");
    // p_c = 10⁸ N^(−3/2) d_0^(3/4), so N³ p_c = 10⁸ (N² d_0)^(3/4).
    let law = transition.pressure_laws.iter().find(|it| it.method == Method::Anticorrelation).expect("G*");
    assert_eq!(law.points.len(), 9);
    let exponent = law.fit.expect("nine points").exponent;
    assert!((exponent.value - 0.75).abs() < 4.0 * exponent.standard_error + 0.01, "{exponent:?}");
}

/// The scaling and the published values are those around a held disk.
#[test]
fn strips_and_free_centres_have_no_scaling_and_nothing_published_to_compare_with() {
    let strip = Boundary::HeldWalls { distance_over_side: 0.45, length_over_side: 1.0 };
    let changes: [fn(&mut Cell, Boundary); 3] =
        [|_, _| {}, |cell, strip| cell.boundary = strip, |cell, _| cell.centre_held = false];
    let counts = changes.map(|change| {
        let mut all = several_series(1, CRITICAL, RelaxerChoice::default());
        all.iter_mut().for_each(|samples| change(&mut samples.cell, strip));
        let transition = Transition::of(&merged(all));
        assert!(!transition.series.is_empty());
        (transition.scaling.len(), transition.pressure_laws.len(), transition.comparisons.len())
    });
    assert!(counts[0].0 > 0 && counts[0].2 > 0, "{counts:?}");
    assert_eq!(counts[1..], [(0, 0, 0); 2]);
}

fn damped(damping: DampingChoice) -> RelaxerChoice {
    RelaxerChoice::Damped(DampedDynamics { damping, ..DampedDynamics::default() })
}

#[test]
fn series_of_several_relaxers_share_no_law() {
    // Two relaxers whose transitions are a factor of 100 apart: one curve through both has no good exponents.
    let viscoelastic = damped(DampingChoice::Viscoelastic(ViscoelasticDamping { rate: 500.0 }));
    let mut cells = several_series(4, 1e8, RelaxerChoice::default());
    cells.extend(several_series(5, 1e6, viscoelastic));
    let transition = Transition::of(&merged(cells));
    assert_eq!((transition.series.len(), transition.scaling.len()), (18, 2));
    for (scaling, relaxer) in transition.scaling.iter().zip([RelaxerChoice::default(), viscoelastic]) {
        assert_eq!((scaling.relaxer, scaling.curve_count, scaling.sample_count), (relaxer, 9, SAMPLES));
        let quality = scaling.published_quality.expect("overlap").quality;
        assert!((0.4..1.8).contains(&quality), "{quality}");
    }
    let laws: Vec<_> = transition.pressure_laws.iter().map(|it| (it.relaxer, it.points.len())).collect();
    assert_eq!(laws, [(RelaxerChoice::default(), 9), (viscoelastic, 9)]);
    let mut names: Vec<String> = transition.series.iter().map(|it| it.name()).collect();
    names.sort();
    names.dedup();
    assert_eq!(names.len(), 18);
    let of: Vec<&String> = transition.comparisons.iter().map(|it| &it.of).collect();
    assert!(of.iter().any(|of| of.contains("FIRE")) && of.iter().any(|of| of.contains("viscoelastic 500")));
}

#[test]
fn relaxers_are_described_by_their_damping_law_and_rate() {
    let constant = DampingChoice::Constant(ConstantDamping { rate: 30.0 });
    assert_eq!(damped(constant).description(), "constant damping 30, explicit");
    let total = DampedDynamics { damping: constant, net_force: NetForce::Total, ..DampedDynamics::default() };
    assert_eq!(RelaxerChoice::Damped(total).description(), "constant damping 30, total force, explicit");
    assert_eq!(RelaxerChoice::default().description(), "FIRE");
    #[cfg(feature = "linear")]
    {
        use jamscope::relax::{ImplicitDynamics, Newton, Staged};
        let damping = DampingChoice::Viscoelastic(ViscoelasticDamping { rate: 500.0 });
        let implicit = ImplicitDynamics { damping, ..ImplicitDynamics::default() };
        assert_eq!(RelaxerChoice::Implicit(implicit).description(), "viscoelastic 500");
        assert_eq!(RelaxerChoice::Staged(Staged::default()).description(), "FIRE and Newton");
        assert_eq!(RelaxerChoice::Newton(Newton::default()).description(), "Newton");
    }
}

/// The slope a study gives for rings of a field whose spectrum is f^(−s), as records keep their powers.
fn slope_of_field(disk_count: usize, exponent: f64, count: usize) -> f64 {
    let settings = SyntheticSettings { disk_count, ..SyntheticSettings::default() };
    let rings = gaussian_rings(&settings, count, |f| f.powf(-exponent)).expect("enough disks");
    let powers = rings.iter().map(|ring| {
        let spectrum = PowerSpectrum::of(&ring.ring, &SpectrumSettings::default()).expect("enough disks");
        spectrum.power[1..].iter().map(|power| power / spectrum.variance).collect()
    });
    let numbers = [("pressure", vec![1.0; SAMPLES]), ("reduced_pressure", vec![1.0; SAMPLES])];
    let transition =
        Transition::of(&merged(vec![samples(cell(5548, Target::Pressure(1.0), 0.1), &numbers, powers.collect())]));
    transition.series[0].spectra[0].slope.expect("a slope").best
}

#[test]
fn the_slope_of_a_scale_free_field_is_off_by_less_than_four_hundredths() {
    // Two biases, which work against each other: powers over the variance of their own sample flatten (−0.04 to −0.09), and leakage
    // of what lies above n/8 taken as white steepens at few disks (+0.01 to +0.08). 600 rings scatter by 0.01.
    for (disks, expected) in [(240, 1.524), (1000, 1.470)] {
        let found = slope_of_field(disks, 1.5, 600);
        assert!((found - expected).abs() < 0.03 && (found - 1.5).abs() < 0.055, "{disks} disks: {found}");
    }
    // Far from 1.5 too: what is steeper is called steeper.
    let (flat, steep) = (slope_of_field(240, 1.0, 300), slope_of_field(240, 2.0, 300));
    assert!((flat - 1.086).abs() < 0.05 && (steep - 1.984).abs() < 0.05, "{flat}, {steep}");
}

#[test]
fn penetration_lengths_give_their_divergence() {
    let mut generator = Pcg64::seed_from_u64(5);
    let cells = [0.74, 0.77, 0.79, 0.80, 0.81, 0.82, 0.83].map(|fraction: f64| {
        let truth = 0.5 * (0.842 - fraction).powf(-0.8);
        let lengths = (0..SAMPLES).map(|_| truth * (1.0 + 0.1 * normal(&mut generator))).collect();
        let numbers = [("penetration_length_at_0.001", lengths), ("outer_radius", vec![60.0; SAMPLES])];
        samples(cell(5548, Target::PackingFraction(fraction), 0.1), &numbers, Vec::new())
    });
    let transition = Transition::of(&merged(cells.to_vec()));
    // No pressure, so no series of the transition.
    assert!(transition.series.is_empty());
    assert_eq!(transition.jamming.len(), 1);
    let jamming = &transition.jamming[0];
    let fit = jamming.at_jamming.expect("seven points");
    assert!((fit.exponent.value - 0.8).abs() < 4.0 * fit.exponent.standard_error, "{:?}", fit.exponent);
    assert!(fit.exponent.standard_error < 0.05);
    let Some(DivergenceOutcome::Found(free)) = jamming.free else { panic!("{:?}", jamming.free) };
    assert!(free.critical.holds(0.842), "{:?}", free.critical);
}
