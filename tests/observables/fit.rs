//! Fits of profiles whose answer is known.

mod strip;
mod three_dimensions;

use jamscope::fit::profile::{Decision, ProfileFit, ProfileFitSettings, fit_radial_profile};
use jamscope::fit::{Estimate, FitError};
use jamscope::observe::radial_profile::{RadialProfile, Ring};
use jamscope::reference::poles::pole;
use jamscope::reference::rim::RimSolution;
use jamscope::reference::screened::Screened;
use jamscope::reference::{Annulus, RadialSolution};
use jamscope::vector::larger;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// The circle of 4016 disks: a = 0.5, R = 42, rings one diameter wide.
const RIM: f64 = 42.0;

fn annulus() -> Annulus {
    Annulus::new(0.5, RIM).expect("radii are in order")
}

/// First pole.
fn first() -> f64 {
    pole::<2>(annulus(), 1)
}

fn normal(random: &mut Pcg64Mcg) -> f64 {
    // Box and Muller; 1 − u is never 0.
    let (u, v) = (random.random::<f64>(), random.random::<f64>());
    (-2.0 * (1.0 - u).ln()).sqrt() * (2.0 * std::f64::consts::PI * v).cos()
}

/// What is added to the displacement of a medium.
#[derive(Clone, Copy)]
struct Noise {
    /// Standard deviation of r·d_r of a disk, independent of the others.
    disk: f64,
    /// Standard deviation of r·d_r of a ring as a whole, which its disks do not show.
    ring: f64,
    /// Correlation of that between neighbouring rings.
    memory: f64,
}

const QUIET: Noise = Noise { disk: 0.0, ring: 0.0, memory: 0.0 };
/// r·d_r of an elastic sample is 0.025 at the disk: a disk scatters as much, a ring by a tenth of it.
const WHITE: Noise = Noise { disk: 0.025, ring: 0.0, memory: 0.0 };
const CORRELATED: Noise = Noise { disk: 0.025, ring: 0.003, memory: 0.5 };

/// The rings of a sample in which disk i is displaced by `rescaled(r)/r` and noise.
fn profile(rescaled: impl Fn(f64) -> f64, noise: Noise, random: &mut Pcg64Mcg) -> RadialProfile {
    let mut shared = noise.ring * normal(random);
    let rings = (1..41)
        .map(|index| {
            let radius = f64::from(index) + 0.5;
            // 0.73 disks in the unit of area.
            let disk_count = (0.73 * 2.0 * std::f64::consts::PI * radius).round() as usize;
            let expected = rescaled(radius) + shared;
            shared = noise.memory * shared + noise.ring * (1.0 - noise.memory * noise.memory).sqrt() * normal(random);
            let disks: Vec<f64> = (0..disk_count).map(|_| (expected + noise.disk * normal(random)) / radius).collect();
            let mean = disks.iter().sum::<f64>() / disk_count as f64;
            let square = disks.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / (disk_count as f64 - 1.0);
            let spread = if noise.disk > 0.0 { square.sqrt() } else { 0.0 };
            Ring { radius, disk_count, mean, spread, standard_error: spread / (disk_count as f64).sqrt() }
        })
        .collect();
    RadialProfile { rings }
}

fn screened(amplitude: f64, wavenumber: f64) -> impl Fn(f64) -> f64 {
    let medium = Screened::<2>::new(annulus(), amplitude, wavenumber).expect("no pole");
    move |radius| radius * medium.value(radius)
}

fn fit(profile: &RadialProfile) -> ProfileFit {
    fit_radial_profile::<2>(profile, annulus(), &ProfileFitSettings::default()).expect("a profile that can be fitted")
}

/// d_0 for which r·d_r has 0.025 as its largest size on the rings, as in an elastic sample with d_0^eff = 0.05.
fn amplitude(wavenumber: f64) -> f64 {
    let solution = RimSolution::<2>::new(annulus(), wavenumber).expect("valid");
    let largest = (1..41).map(|i| f64::from(i) + 0.5).map(|r| (r * solution.value(r)).abs()).fold(0.0, larger);
    0.025 / largest * solution.value(0.5)
}

/// How many of `sample_count` samples of a medium satisfy each of the claims.
fn count<const N: usize>(
    wavenumber: f64,
    noise: Noise,
    sample_count: usize,
    claims: [&dyn Fn(&ProfileFit) -> bool; N],
) -> [usize; N] {
    let medium = screened(amplitude(wavenumber), wavenumber);
    counted(20_261_121, sample_count, |random| fit(&profile(&medium, noise, random)), claims)
}

/// How many of `sample_count` fits satisfy each of the claims.
fn counted<const N: usize>(
    seed: u64,
    sample_count: usize,
    sample: impl Fn(&mut Pcg64Mcg) -> ProfileFit,
    claims: [&dyn Fn(&ProfileFit) -> bool; N],
) -> [usize; N] {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut counts = [0; N];
    for _ in 0..sample_count {
        let found = sample(&mut random);
        for (count, claim) in counts.iter_mut().zip(claims) {
            *count += usize::from(claim(&found));
        }
    }
    counts
}

#[test]
fn exact_profiles_are_recovered_in_every_branch() {
    let mut random = Pcg64Mcg::seed_from_u64(1);
    let largest = fit(&profile(screened(0.05, 0.1), QUIET, &mut random)).largest_wavenumber;
    for step in 1..60 {
        let wavenumber = 0.98 * largest * f64::from(step) / 60.0;
        let found = fit(&profile(screened(0.05, wavenumber), QUIET, &mut random));
        let solution = found.screened.expect("screened");
        // Brent to 1.5·10⁻⁸, one step of Gauss and Newton squares that; rounding 10⁻¹⁵ times the condition κ_n/(κ − κ_n).
        assert!((solution.wavenumber.value / wavenumber - 1.0).abs() < 1e-10, "{wavenumber}: {solution:?}");
        assert!((solution.amplitude.value / 0.05 - 1.0).abs() < 1e-8, "{wavenumber}: {solution:?}");
        // The errors of exact data are those of rounding.
        assert!(solution.wavenumber.standard_error < 1e-10 * wavenumber);
        assert_eq!(found.decision, Decision::Screened);
        let below = (1..20).take_while(|&n| pole::<2>(annulus(), n) < wavenumber).count();
        assert_eq!(solution.branch, below);
    }
}

#[test]
fn exact_elastic_profile_is_recovered() {
    let found = fit(&profile(screened(0.05, 0.0), QUIET, &mut Pcg64Mcg::seed_from_u64(1)));
    assert_eq!(found.decision, Decision::Elastic);
    assert!((found.elastic.amplitude.value - 0.05).abs() < 1e-15);
    assert!(found.elastic.share_described > 1.0 - 1e-15);
    // χ²/χ²_0 = 10⁻³² allows a (κR)⁴/64 of that size, times the number of rings.
    assert!(found.elastic.wavenumber_bound.expect("a bound") * RIM < 1e-6, "{found:?}");
}

#[test]
fn pole_itself_is_fitted_with_a_vanishing_amplitude() {
    // The response of a medium at κ_1: displacement without any at the disk.
    let solution = RimSolution::<2>::new(annulus(), first()).expect("valid");
    let found = fit(&profile(|r| 0.001 * r * solution.value(r), QUIET, &mut Pcg64Mcg::seed_from_u64(1)));
    let screened = found.screened.expect("screened");
    assert_eq!(found.decision, Decision::Screened);
    assert!((screened.wavenumber.value / first() - 1.0).abs() < 1e-10);
    // v is up to 10³ lengths at the disk in the elastic case; here it is 10⁻¹⁰ of that.
    assert!(screened.amplitude.value.abs() < 1e-9, "{screened:?}");
}

#[test]
fn standard_errors_cover_the_truth() {
    // 300 samples: one standard deviation of a share of 68 % is 2.7 %, three are 8 %. The errors are scaled up by
    // √(χ²/(n_eff − 2)) but never down, which moves 68 % to between 68 % and P(|z| < 1.25) = 79 %.
    let covered = |share: usize| (0.60..0.87).contains(&(share as f64 / 300.0));
    for share in [0.5, 0.8, 1.1, 1.3, 1.7, 2.4] {
        let wavenumber = share * first();
        let truth = amplitude(wavenumber);
        let off = |fit: &ProfileFit| {
            let screened = fit.screened.expect("screened");
            let deviation = |estimate: Estimate, truth: f64| (estimate.value - truth).abs() / estimate.standard_error;
            [deviation(screened.wavenumber, wavenumber), deviation(screened.amplitude, truth)]
        };
        let [by_wavenumber, by_amplitude, far] = count(
            wavenumber,
            WHITE,
            300,
            [&|fit| off(fit)[0] < 1.0, &|fit| off(fit)[1] < 1.0, &|fit| off(fit)[0] > 3.0],
        );
        println!("κ = {share} κ_1: {by_wavenumber} and {by_amplitude} of 300 within one error, {far} beyond three");
        assert!(covered(by_wavenumber) && covered(by_amplitude), "{share} κ_1: {by_wavenumber}, {by_amplitude}");
        // 0.3 % if the errors are right and normal: of 300 at most 5 (Poisson, 0.1 %).
        assert!(far <= 5, "{far} at {share} κ_1");
    }
    let truth = amplitude(0.0);
    let [elastic] = count(
        0.0,
        WHITE,
        300,
        [&|fit| (fit.elastic.amplitude.value - truth).abs() < fit.elastic.amplitude.standard_error],
    );
    assert!(covered(elastic), "{elastic}");
}

#[test]
fn correlated_rings_widen_the_errors() {
    // Half of the noise of a ring is shared with the next. Counting all rings would cover 50 %; the estimate of n_eff
    // from 38 rings misses some of the correlation, so 68 % is not quite reached.
    let wavenumber = 1.5 * first();
    let [covered, fewer] = count(
        wavenumber,
        CORRELATED,
        300,
        [
            &|fit| fit.screened.is_some_and(|s| (s.wavenumber.value - wavenumber).abs() < s.wavenumber.standard_error),
            &|fit| fit.screened.is_some_and(|s| s.effective_ring_count < 0.9 * fit.ring_count as f64),
        ],
    );
    println!("covered {covered} of 300");
    // 64 % ± 8 %.
    assert!((0.56..0.80).contains(&(covered as f64 / 300.0)), "{covered}");
    assert!(fewer > 200, "{fewer}");
}

#[test]
fn elastic_samples_are_called_elastic() {
    for noise in [WHITE, CORRELATED, Noise { disk: 0.05, ring: 0.005, memory: 0.5 }] {
        let [elastic, bounded] = count(
            0.0,
            noise,
            300,
            [&|fit| fit.decision == Decision::Elastic, &|fit| {
                fit.elastic.wavenumber_bound.is_some_and(|bound| bound > 0.0)
            }],
        );
        println!("{elastic} of 300 elastic");
        assert!(elastic >= 285, "{elastic} of 300");
        assert_eq!(bounded, 300);
    }
}

#[test]
fn screened_samples_between_the_poles_are_called_screened() {
    for share in [1.05, 1.3, 1.6, 1.8] {
        let [found] = count(share * first(), CORRELATED, 200, [&|fit| fit.decision == Decision::Screened]);
        // The effect is a tenfold of the noise: 95 % is what is claimed.
        assert!(found >= 190, "{found} of 200 at {share} κ_1");
    }
}

#[test]
fn weak_screening_is_called_elastic_with_a_bound_above_it() {
    for share in [0.1, 0.2, 0.3] {
        let wavenumber = share * first();
        let [elastic, held] = count(
            wavenumber,
            WHITE,
            300,
            [&|fit| fit.decision == Decision::Elastic, &|fit| {
                fit.elastic.wavenumber_bound.is_some_and(|bound| bound > wavenumber && bound < first())
            }],
        );
        assert!(elastic >= 270, "{elastic} of 300 at {share} κ_1");
        // One-sided 95 %: 285 of 300 within three binomial deviations, 3·√(300·0.05·0.95) = 11.
        assert!(held >= 274, "{held} of 300 at {share} κ_1");
    }
}

#[test]
fn short_ranged_response_is_neither() {
    // What an unjammed packing does: a blob of range r < 10, nothing beyond, with and without scatter inside.
    for range in [6.0, 8.0, 10.0] {
        for noise in [QUIET, Noise { disk: 0.002, ring: 0.0, memory: 0.0 }, WHITE] {
            let shapes: [&dyn Fn(f64) -> f64; 3] = [&|r| (-r / 3.0).exp(), &|r| 0.1 * (1.0 - r / range), &|_| 0.05];
            for shape in shapes {
                let blob = |r: f64| if r < range { shape(r) } else { 0.0 };
                let found = fit(&profile(blob, noise, &mut Pcg64Mcg::seed_from_u64(1)));
                assert_eq!(found.decision, Decision::Neither, "range {range}: {found:?}");
            }
        }
    }
}

#[test]
fn noise_is_neither() {
    let mut random = Pcg64Mcg::seed_from_u64(5);
    // Five times the signal of a sample, ring by ring; and with a memory of a few rings.
    for memory in [0.0, 0.3] {
        let noise = Noise { disk: 0.025, ring: 0.1, memory };
        let neither =
            (0..300).filter(|_| fit(&profile(|_| 0.0, noise, &mut random)).decision == Decision::Neither).count();
        println!("{neither} of 300 neither");
        assert!(neither >= 294, "{neither} of 300 with memory {memory}");
    }
}

#[test]
fn units_and_signs_scale_exactly() {
    let mut random = Pcg64Mcg::seed_from_u64(9);
    for wavenumber in [0.0, 1.3 * first()] {
        let one = profile(screened(amplitude(wavenumber), wavenumber), CORRELATED, &mut random);
        let found = fit(&one);
        // Lengths in units of 1/8, displacements in units of −1/2 of those: powers of two, hence no rounding.
        let rings = one.rings.iter().map(|ring| Ring {
            radius: 8.0 * ring.radius,
            mean: -4.0 * ring.mean,
            spread: 4.0 * ring.spread,
            standard_error: 4.0 * ring.standard_error,
            ..*ring
        });
        let other = RadialProfile { rings: rings.collect() };
        let scaled_annulus = Annulus::new(4.0, 8.0 * RIM).expect("valid");
        let scaled = fit_radial_profile::<2>(&other, scaled_annulus, &ProfileFitSettings::default()).expect("fits");
        assert_eq!(scaled.decision, found.decision);
        assert_eq!(scaled.elastic.amplitude.value, -4.0 * found.elastic.amplitude.value);
        assert_eq!(scaled.elastic.amplitude.standard_error, 4.0 * found.elastic.amplitude.standard_error);
        assert_eq!(scaled.elastic.wavenumber_bound.map(|k| 8.0 * k), found.elastic.wavenumber_bound);
        assert_eq!(scaled.screened.is_some(), found.screened.is_some());
        if let (Some(scaled), Some(found)) = (scaled.screened, found.screened) {
            assert_eq!(8.0 * scaled.wavenumber.value, found.wavenumber.value);
            assert_eq!(scaled.amplitude.value, -4.0 * found.amplitude.value);
            assert_eq!(scaled.chance_of_elastic, found.chance_of_elastic);
            // The step of the difference quotient is a decimal fraction of a length: the same after scaling.
            assert_eq!(scaled.amplitude.standard_error, 4.0 * found.amplitude.standard_error);
        }
    }
}

#[test]
fn order_of_the_rings_does_not_matter() {
    let mut random = Pcg64Mcg::seed_from_u64(9);
    let mut one = profile(screened(0.05, 1.3 * first()), WHITE, &mut random);
    let found = fit(&one);
    one.rings.reverse();
    assert_eq!(fit(&one), found);
}

#[test]
fn rings_of_few_disks_have_finite_weight() {
    let mut random = Pcg64Mcg::seed_from_u64(2);
    let mut one = profile(screened(0.05, 1.3 * first()), WHITE, &mut random);
    let found = fit(&one);
    // One ring in eight holds one disk or two alike, far off, which by their own spread would be exact.
    for (index, ring) in one.rings.iter_mut().step_by(8).enumerate() {
        let mean = ring.mean + 0.02 / ring.radius;
        *ring = Ring { disk_count: 1 + index % 2, mean, spread: 0.0, standard_error: 0.0, ..*ring };
    }
    let spoiled = fit(&one);
    let (found, spoiled) = (found.screened.expect("screened"), spoiled.screened.expect("screened"));
    let shift = (found.wavenumber.value - spoiled.wavenumber.value).abs();
    assert!(shift < found.wavenumber.standard_error, "{shift}: {found:?}, {spoiled:?}");
}

#[test]
fn results_survive_a_report() {
    let found = fit(&profile(screened(0.05, 0.13), WHITE, &mut Pcg64Mcg::seed_from_u64(4)));
    let text = serde_json::to_string(&found).expect("plain numbers");
    assert!(text.contains("\"decision\":\"screened\""), "{text}");
    assert_eq!(serde_json::from_str::<ProfileFit>(&text).expect("reads back"), found);
}

#[test]
fn what_cannot_be_fitted_is_named() {
    let mut random = Pcg64Mcg::seed_from_u64(1);
    let good = profile(screened(0.05, 0.0), WHITE, &mut random);
    let settings = ProfileFitSettings::default();
    let refusal = |profile: &RadialProfile, settings: &ProfileFitSettings| {
        fit_radial_profile::<2>(profile, annulus(), settings).expect_err("a refusal")
    };
    // Ring i is at i + 1.5 and the range begins at 2.5.
    let few = RadialProfile { rings: good.rings[..8].to_vec() };
    assert!(matches!(refusal(&few, &settings), FitError::TooFewRings { ring_count: 7, needed: 8, .. }));
    assert!(matches!(refusal(&RadialProfile { rings: Vec::new() }, &settings), FitError::TooFewRings { .. }));
    let still = profile(|_| 0.0, QUIET, &mut random);
    assert!(matches!(refusal(&still, &settings), FitError::NoDisplacement { .. }));
    let spoilers: [fn(&mut Ring); 6] = [
        |ring| ring.mean = f64::NAN,
        |ring| ring.radius = f64::INFINITY,
        |ring| ring.radius = -1.0,
        |ring| ring.standard_error = -1.0,
        |ring| ring.standard_error = f64::NAN,
        |ring| ring.disk_count = 0,
    ];
    for spoil in spoilers {
        let mut bad = good.clone();
        spoil(&mut bad.rings[17]);
        let error = refusal(&bad, &settings);
        assert!(matches!(error, FitError::RingUnusable { ring: 17, .. }), "{error}");
    }
    let bad_settings = [
        ProfileFitSettings { inner_margin: -1.0, ..settings },
        ProfileFitSettings { rim_margin: f64::NAN, ..settings },
        ProfileFitSettings { inner_margin: 50.0, ..settings },
        ProfileFitSettings { rings_per_wavelength: 1.0, ..settings },
        ProfileFitSettings { significance: 0.0, ..settings },
        ProfileFitSettings { least_share: 1.0, ..settings },
    ];
    let errors = bad_settings.map(|settings| refusal(&good, &settings));
    assert!(matches!(
        errors,
        [
            FitError::MarginNegative { .. },
            FitError::MarginNegative { .. },
            FitError::RangeEmpty { .. },
            FitError::WavelengthUnresolved { .. },
            FitError::LevelOutOfRange { .. },
            FitError::LevelOutOfRange { .. },
        ]
    ));
}

#[test]
fn rings_that_cannot_tell_give_no_wavenumber() {
    let ring = Ring { radius: 20.0, disk_count: 1, mean: 0.001, spread: 0.0, standard_error: 0.0 };
    let found = fit(&RadialProfile { rings: vec![ring; 9] });
    assert!(found.screened.is_none_or(|s| s.wavenumber.standard_error.is_finite()), "{found:?}");
    assert_ne!(found.decision, Decision::Screened);
    // A sliver of the annulus: the search must end.
    let narrow = ProfileFitSettings { inner_margin: 40.0, rim_margin: 1.5 - 1e-9, ..ProfileFitSettings::default() };
    let rings = (0..9).map(|i| Ring { radius: 40.5 + 1e-10 * f64::from(i), ..ring }).collect();
    let found = fit_radial_profile::<2>(&RadialProfile { rings }, annulus(), &narrow);
    assert!(found.is_ok_and(|fit| fit.decision != Decision::Screened));
}
