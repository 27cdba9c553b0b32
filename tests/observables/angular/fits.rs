//! Slopes and crossovers of fields that are known.

use jamscope::fit::angular::{
    CrossoverOutcome, CrossoverSettings, ExponentChoice, HighestFrequency, SingleDiskNoise, SlopeOutcome,
    SpectrumFitError, SpectrumWindowSettings, fit_crossover, fit_slope,
};
use jamscope::observe::angular::RingSample;
use jamscope::observe::angular::synthetic::{AngleLayout, SyntheticSettings, gaussian_rings};

use super::{even_angles, ring};

const LAYOUTS: [AngleLayout; 2] = [AngleLayout::Random, AngleLayout::Jittered(0.8)];

/// Half of the trials at angles anywhere, half at jittered ones.
fn fields(disk_count: usize, trials: usize, spectrum: impl Fn(f64) -> f64) -> Vec<RingSample> {
    let of = |layout| {
        let settings = SyntheticSettings { disk_count, layout, seed: 2026, ..SyntheticSettings::default() };
        gaussian_rings(&settings, trials / 2, &spectrum).expect("enough disks")
    };
    LAYOUTS.into_iter().flat_map(of).map(|synthetic| synthetic.ring).collect()
}

/// Two standard errors hold 95.45 % of the time: of n trials 0.9545 n ± 3 √(0.9545·0.0455 n), an interval left by 0.3 % of seeds.
/// From above only where there is no interval to fail: an undetermined one holds every value.
fn least(trials: usize) -> usize {
    let expected = 0.9545 * trials as f64;
    (expected - 3.0 * (0.0455 * expected).sqrt()).floor() as usize
}

fn slopes(disk_count: usize, trials: usize) {
    let (mut held, mut open, mut sum) = (0, 0, 0.0);
    for ring in fields(disk_count, trials, |f| f.powf(-1.5)) {
        let fit = fit_slope(&[ring], &SpectrumWindowSettings::default()).expect("enough powers");
        held += usize::from(fit.exponent.holds(1.5));
        match fit.exponent.estimate() {
            Some(estimate) => sum += estimate.value,
            None => open += 1,
        }
    }
    println!("n = {disk_count}: {held} of {trials} hold, {open} open, mean {}", sum / (trials - open) as f64);
    assert!(held >= least(trials), "n = {disk_count}: {held} of {trials} hold −1.5");
}

fn crossovers(disk_count: usize, trials: usize, crossover: f64) {
    let (mut held, mut found) = (0, 0);
    for ring in fields(disk_count, trials, |f| 1.0 / (1.0 + (f / crossover).powf(1.5))) {
        let fit = fit_crossover(&[ring], &CrossoverSettings::default()).expect("enough powers");
        held += usize::from(fit.outcome.holds(crossover));
        found += usize::from(matches!(fit.outcome, CrossoverOutcome::Found { .. }));
    }
    println!("n = {disk_count}, f† = {crossover}: {held} of {trials} hold, {found} found");
    assert!(held >= least(trials), "n = {disk_count}: {held} of {trials} hold f† = {crossover}");
}

#[test]
fn slopes_of_60_disks_lie_within_two_standard_errors() {
    slopes(60, 1000);
}

/// 95 % themselves, where powers are fewest: 20 000 trials tell 95.45 from 95.0 % by three times their scatter of 0.15 %.
#[test]
#[ignore = "20 000 trials: the weekly tier runs it"]
fn slopes_of_60_disks_lie_within_their_error_95_times_in_100() {
    let holds = |ring: RingSample| {
        fit_slope(&[ring], &SpectrumWindowSettings::default()).expect("enough powers").exponent.holds(1.5)
    };
    let held = fields(60, 20_000, |f| f.powf(-1.5)).into_iter().filter(|ring| holds(ring.clone())).count();
    println!("{held} of 20000");
    assert!(held >= 19_000, "{held} of 20000");
}

#[test]
fn slopes_of_1000_disks_lie_within_two_standard_errors() {
    slopes(1000, 1000);
}

#[test]
fn slopes_of_4000_disks_lie_within_two_standard_errors() {
    // 1000 trials take half a minute: `cargo run --release --features measurements --example angular_coverage` has them.
    slopes(4000, 200);
}

#[test]
fn crossovers_of_60_disks_lie_within_two_standard_errors() {
    crossovers(60, 1000, 3.0);
}

#[test]
fn crossovers_of_1000_disks_lie_within_two_standard_errors() {
    crossovers(1000, 1000, 10.0);
}

#[test]
fn crossovers_of_4000_disks_lie_within_two_standard_errors() {
    crossovers(4000, 200, 20.0);
}

#[test]
fn power_law_interval_of_few_powers_holds_two_standard_errors() {
    // Five powers, even angles and no frequency above n/2: independent exponential variates, the hardest case for the correction.
    let settings =
        SyntheticSettings { disk_count: 64, layout: AngleLayout::Even, frequencies_per_disk: 1, ..Default::default() };
    let rings = gaussian_rings(&settings, 4000, |f| if f < 32.0 { f.powf(-1.5) } else { 0.0 }).expect("enough disks");
    let window =
        SpectrumWindowSettings { highest: HighestFrequency::Fixed(5), frequencies_per_disk: 1.0, ..Default::default() };
    let holds = |ring: &RingSample| fit_slope(std::slice::from_ref(ring), &window).expect("powers").exponent.holds(1.5);
    let held = rings.iter().filter(|synthetic| holds(&synthetic.ring)).count();
    println!("{held} of 4000");
    assert!((3779..=3857).contains(&held), "{held} of 4000 hold, 3818 ± 3·13 expected");
}

#[test]
fn powers_above_a_sixteenth_claim_too_much() {
    // Angles anywhere, 1000 disks: the scatter of s over its stated error, known to 1/√398 = 5 %.
    let settings = SyntheticSettings { seed: 14, ..SyntheticSettings::default() };
    let rings = gaussian_rings(&settings, 200, |f| f.powf(-1.5)).expect("enough disks");
    let ratio = |highest: HighestFrequency| {
        let window = SpectrumWindowSettings { highest, ..SpectrumWindowSettings::default() };
        let fit = |ring: &RingSample| fit_slope(std::slice::from_ref(ring), &window).expect("enough powers");
        let found: Vec<_> =
            rings.iter().map(|synthetic| fit(&synthetic.ring).exponent.estimate().expect("closed")).collect();
        let mean = found.iter().map(|s| s.value).sum::<f64>() / 200.0;
        let scatter = (found.iter().map(|s| (s.value - mean).powi(2)).sum::<f64>() / 199.0).sqrt();
        scatter / (found.iter().map(|s| s.standard_error).sum::<f64>() / 200.0)
    };
    let (sixteenth, eighth) = (ratio(HighestFrequency::Resolved), ratio(HighestFrequency::Fixed(125)));
    println!("scatter over stated error: n/16 {sixteenth}, n/8 {eighth}");
    assert!(sixteenth < 1.15 && eighth > 1.15, "n/16 {sixteenth}, n/8 {eighth}");
}

#[test]
fn refusals_have_their_names() {
    let settings = SyntheticSettings { disk_count: 4000, seed: 5, ..SyntheticSettings::default() };
    let of = |noise: f64, spectrum: &dyn Fn(f64) -> f64| {
        let settings = SyntheticSettings { noise, ..settings };
        vec![gaussian_rings(&settings, 1, spectrum).expect("enough disks").remove(0).ring]
    };
    let crossover = |rings: &[RingSample]| fit_crossover(rings, &CrossoverSettings::default()).expect("powers").outcome;
    let scale_free = of(0.0, &|f| f.powf(-1.5));
    let CrossoverOutcome::ScaleFree { largest, smallest_angle } = crossover(&scale_free) else {
        panic!("{:?}", crossover(&scale_free))
    };
    // A crossover at f = 5 flattens the first powers beyond doubt.
    assert!(largest < 5.0 && (smallest_angle * largest - 1.681333697987038).abs() < 1e-12);
    let white = of(1.0, &|_| 0.0);
    assert!(matches!(crossover(&white), CrossoverOutcome::White { .. }), "{:?}", crossover(&white));
    let window = SpectrumWindowSettings::default();
    assert_eq!(fit_slope(&white, &window).expect("powers").outcome, SlopeOutcome::Flat);
    assert_eq!(fit_slope(&scale_free, &window).expect("powers").outcome, SlopeOutcome::Sloped);
    // Twelve disks have three powers, which tell nothing.
    let few = vec![ring(&even_angles(12), |angle| angle.cos() + 0.3 * (2.0 * angle).sin() + 0.2 * (3.0 * angle).cos())];
    assert_eq!(crossover(&few), CrossoverOutcome::Undetermined);
    // A dipole alone is no power law: the scatter about it says so.
    let dipole = vec![ring(&even_angles(1000), |angle| angle.cos() + 1e-3 * (40.0 * angle).cos())];
    assert!(fit_slope(&dipole, &window).expect("powers").dispersion > 5.0);

    assert_eq!(fit_slope(&[], &window), Err(SpectrumFitError::NoRing));
    let still = ring(&even_angles(100), |_| 0.5);
    assert_eq!(fit_slope(&[still], &window), Err(SpectrumFitError::NoPower { ring: 0 }));
    let dipole = &dipole[0];
    let with = |lowest, highest| SpectrumWindowSettings { lowest, highest, ..window };
    let fit = |settings: &SpectrumWindowSettings| fit_slope(std::slice::from_ref(dipole), settings);
    assert!(matches!(
        fit(&with(61, HighestFrequency::Resolved)),
        Err(SpectrumFitError::TooFewPowers { power_count: 2, .. })
    ));
    assert!(matches!(fit(&with(0, HighestFrequency::Resolved)), Err(SpectrumFitError::WindowOutOfRange { .. })));
    assert!(matches!(fit(&with(1, HighestFrequency::Fixed(501))), Err(SpectrumFitError::WindowOutOfRange { .. })));
    let bad = CrossoverSettings { angle_factor: f64::NAN, ..CrossoverSettings::default() };
    assert!(matches!(fit_crossover(&scale_free, &bad), Err(SpectrumFitError::SettingOutOfRange { .. })));
    let bad = CrossoverSettings { exponent: ExponentChoice::Fixed(0.0), ..CrossoverSettings::default() };
    assert!(matches!(fit_crossover(&scale_free, &bad), Err(SpectrumFitError::SettingOutOfRange { .. })));
}

#[test]
fn noise_of_single_disks_biases_a_slope_unless_it_is_fitted() {
    // 30 % of the standard deviation, Σ f^(−1.5) = 2.6.
    let settings = SyntheticSettings { noise: 0.3 * 2.6f64.sqrt(), seed: 8, ..SyntheticSettings::default() };
    let rings: Vec<RingSample> = gaussian_rings(&settings, 40, |f| f.powf(-1.5))
        .expect("enough disks")
        .into_iter()
        .map(|synthetic| synthetic.ring)
        .collect();
    let fit = |noise| fit_slope(&rings, &SpectrumWindowSettings { noise, ..Default::default() }).expect("powers");
    let (without, with) = (fit(SingleDiskNoise::None), fit(SingleDiskNoise::Fitted));
    assert!(!without.exponent.holds(1.5), "{without:?}");
    assert!(with.exponent.holds(1.5) && with.noise > 0.0, "{with:?}");
    assert_eq!(with.power_count, 40 * 62);
    assert!((with.dispersion - 1.0).abs() < 0.2, "{with:?}");
}

#[test]
fn a_free_exponent_is_found_beside_the_crossover() {
    let settings = SyntheticSettings { disk_count: 4000, seed: 4, ..SyntheticSettings::default() };
    let rings: Vec<RingSample> = gaussian_rings(&settings, 4, |f| 1.0 / (1.0 + (f / 20.0).powf(2.0)))
        .expect("enough disks")
        .into_iter()
        .map(|synthetic| synthetic.ring)
        .collect();
    let settings = CrossoverSettings { exponent: ExponentChoice::Free, ..CrossoverSettings::default() };
    let fit = fit_crossover(&rings, &settings).expect("powers");
    assert!(fit.outcome.holds(20.0) && matches!(fit.outcome, CrossoverOutcome::Found { .. }), "{fit:?}");
    // 1000 powers over 2.5 e-folds beyond the crossover.
    assert!((fit.exponent - 2.0).abs() < 0.3, "{fit:?}");
}

#[test]
fn the_exponent_of_a_flat_spectrum_stays_the_one_asked_for() {
    for ring in fields(240, 4, |_| 1.0) {
        let fit = fit_crossover(&[ring], &CrossoverSettings::default()).expect("enough powers");
        assert!(matches!(fit.outcome, CrossoverOutcome::White { .. }), "{:?}", fit.outcome);
        assert_eq!(fit.exponent, 1.5);
    }
}
