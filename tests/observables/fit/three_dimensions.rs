//! Fits in three dimensions: the same claims as in the plane, for spheres in a shell.

use super::*;

/// R of the shell; a = 0.5, rings half a diameter wide.
const RIM: f64 = 20.0;

/// Largest r²·d_r of a sample, that of an elastic one with d_0^eff = 0.05 at its inner edge.
const LARGEST: f64 = 0.0125;

/// A sphere scatters by five times the signal: shells hold up to 2700 of them.
const WHITE: Noise = Noise { disk: 5.0 * LARGEST, ring: 0.0, memory: 0.0 };
const CORRELATED: Noise = Noise { disk: 5.0 * LARGEST, ring: 0.12 * LARGEST, memory: 0.5 };

fn shell() -> Annulus {
    Annulus::new(0.5, RIM).expect("radii are in order")
}

/// First pole, κ_1 R = 4.4934… for a ≪ R.
fn first() -> f64 {
    pole::<3>(shell(), 1)
}

fn radii() -> impl Iterator<Item = f64> {
    (2..39).map(|index| 0.5 * f64::from(index) + 0.75)
}

/// The rings of a sample with the mean displacement `rescaled(r)/r²`, as `profile` in the plane. The mean and the
/// variance of a ring are drawn from their distributions, for n above 30 normal.
fn profile(rescaled: impl Fn(f64) -> f64, noise: Noise, random: &mut Pcg64Mcg) -> RadialProfile {
    let mut shared = noise.ring * normal(random);
    let rings = radii().map(|radius| {
        // 1.2 spheres in the unit of volume, 0.64 of it filled.
        let disk_count = (1.2 * 0.5 * 4.0 * std::f64::consts::PI * radius * radius).round() as usize;
        let count = disk_count as f64;
        let mean = rescaled(radius) + shared + noise.disk / count.sqrt() * normal(random);
        shared = noise.memory * shared + noise.ring * (1.0 - noise.memory * noise.memory).sqrt() * normal(random);
        let variance = 1.0 + (2.0 / (count - 1.0)).sqrt() * normal(random);
        let spread = noise.disk * larger(variance, 0.0).sqrt() / (radius * radius);
        Ring { radius, disk_count, mean: mean / (radius * radius), spread, standard_error: spread / count.sqrt() }
    });
    RadialProfile { rings: rings.collect() }
}

/// r² d_r of a medium.
fn medium(amplitude: f64, wavenumber: f64) -> impl Fn(f64) -> f64 {
    let medium = Screened::<3>::new(shell(), amplitude, wavenumber).expect("no pole");
    move |radius| radius * radius * medium.value(radius)
}

fn fit(profile: &RadialProfile) -> ProfileFit {
    fit_radial_profile::<3>(profile, shell(), &ProfileFitSettings::default()).expect("a profile that can be fitted")
}

/// d_0 for which r²·d_r has [`LARGEST`] as its largest size on the rings.
fn amplitude(wavenumber: f64) -> f64 {
    let solution = RimSolution::<3>::new(shell(), wavenumber).expect("valid");
    let largest = radii().map(|r| (r * r * solution.value(r)).abs()).fold(0.0, larger);
    LARGEST / largest * solution.value(0.5)
}

fn count<const N: usize>(
    wavenumber: f64,
    noise: Noise,
    sample_count: usize,
    claims: [&dyn Fn(&ProfileFit) -> bool; N],
) -> [usize; N] {
    let medium = medium(amplitude(wavenumber), wavenumber);
    counted(20_261_128, sample_count, |random| fit(&profile(&medium, noise, random)), claims)
}

#[test]
fn exact_profiles_of_a_shell_are_recovered_in_every_branch() {
    let mut random = Pcg64Mcg::seed_from_u64(1);
    let largest = fit(&profile(medium(0.05, 0.2), QUIET, &mut random)).largest_wavenumber;
    let mut worst = [0.0; 2];
    for step in 1..60 {
        let wavenumber = 0.98 * largest * f64::from(step) / 60.0;
        let found = fit(&profile(medium(0.05, wavenumber), QUIET, &mut random));
        let solution = found.screened.expect("screened");
        let off = [solution.wavenumber.value / wavenumber - 1.0, solution.amplitude.value / 0.05 - 1.0].map(f64::abs);
        worst = [larger(worst[0], off[0]), larger(worst[1], off[1])];
        // As in the plane: Brent to 1.5·10⁻⁸, squared by one step; rounding times the condition κ_n/(κ − κ_n).
        assert!(off[0] < 1e-10 && off[1] < 1e-8, "{wavenumber}: {solution:?}");
        assert!(solution.wavenumber.standard_error < 1e-10 * wavenumber);
        assert_eq!(found.decision, Decision::Screened);
        let below = (1..20).take_while(|&n| pole::<3>(shell(), n) < wavenumber).count();
        assert_eq!(solution.branch, below);
    }
    println!("largest relative errors of κ and d_0: {worst:?}");
}

#[test]
fn exact_elastic_profile_of_a_shell_is_recovered() {
    let found = fit(&profile(medium(0.05, 0.0), QUIET, &mut Pcg64Mcg::seed_from_u64(1)));
    assert_eq!(found.decision, Decision::Elastic);
    // 12·2⁻⁵³ of the profile, and as much of the fit.
    assert!((found.elastic.amplitude.value / 0.05 - 1.0).abs() < 3e-15, "{found:?}");
    assert!(found.elastic.share_described > 1.0 - 1e-15);
    // χ²/χ²_0 = 10⁻³² allows a (κR)⁴/100 of that size, times the number of rings.
    assert!(found.elastic.wavenumber_bound.expect("a bound") * RIM < 1e-6, "{found:?}");
}

#[test]
fn poles_of_a_shell_are_passed_smoothly() {
    // B = 0.001 throughout: d_0 = B v(a; κ) is linear in κ across the pole, and 0 at it.
    let slope = RimSolution::<3>::new(shell(), first()).expect("valid").wavenumber_derivative(0.5);
    for share in [-1e-3, -1e-6, 0.0, 1e-6, 1e-3] {
        let wavenumber = first() * (1.0 + share);
        let solution = RimSolution::<3>::new(shell(), wavenumber).expect("valid");
        let response = profile(|r| 0.001 * r * r * solution.value(r), QUIET, &mut Pcg64Mcg::seed_from_u64(1));
        let found = fit(&response);
        let screened = found.screened.expect("screened");
        assert_eq!(found.decision, Decision::Screened);
        assert!((screened.wavenumber.value / wavenumber - 1.0).abs() < 1e-10, "{share}: {screened:?}");
        // v(a) of the elastic solution is R³/3a² = 10⁴: an error of κ of 10⁻¹⁰ and rounding leave 10⁻⁹ of it.
        let expected = 0.001 * slope * first() * share;
        let allowed = 0.02 * expected.abs() + 1e-8;
        assert!((screened.amplitude.value - expected).abs() < allowed, "{share}: {screened:?}, not {expected}");
        assert!(share == 0.0 || screened.branch == usize::from(share > 0.0), "{share}: {screened:?}");
    }
}

#[test]
fn standard_errors_of_a_shell_cover_the_truth() {
    // As in the plane: 68 % to 79 %, ± 8 % for 300 samples.
    let covered = |share: usize| (0.60..0.87).contains(&(share as f64 / 300.0));
    for share in [0.6, 0.8, 1.1, 1.3, 1.7, 2.4] {
        let wavenumber = share * first();
        let truth = amplitude(wavenumber);
        let within = |estimate: Estimate, truth: f64, errors: f64| {
            (estimate.value - truth).abs() < errors * estimate.standard_error
        };
        let screened = |fit: &ProfileFit| fit.screened.expect("screened");
        let [by_wavenumber, by_amplitude, three] = count(
            wavenumber,
            WHITE,
            300,
            [
                &|fit| within(screened(fit).wavenumber, wavenumber, 1.0),
                &|fit| within(screened(fit).amplitude, truth, 1.0),
                &|fit| within(screened(fit).wavenumber, wavenumber, 3.0),
            ],
        );
        println!("κ = {share} κ_1: {by_wavenumber} and {by_amplitude} of 300 within one error, {three} within three");
        assert!(covered(by_wavenumber) && covered(by_amplitude), "{share} κ_1: {by_wavenumber}, {by_amplitude}");
        assert!(three >= 295, "{three} at {share} κ_1");
    }
    let truth = amplitude(0.0);
    let [elastic] = count(
        0.0,
        WHITE,
        300,
        [&|fit| (fit.elastic.amplitude.value - truth).abs() < fit.elastic.amplitude.standard_error],
    );
    println!("elastic: {elastic} of 300 within one error");
    assert!(covered(elastic), "{elastic}");
}

#[test]
fn samples_of_a_shell_are_decided_as_they_were_made() {
    for noise in [WHITE, CORRELATED] {
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
    for share in [1.05, 1.3, 1.6, 1.8] {
        let [found] = count(share * first(), CORRELATED, 200, [&|fit| fit.decision == Decision::Screened]);
        println!("{found} of 200 screened at {share} κ_1");
        assert!(found >= 190, "{found} of 200 at {share} κ_1");
    }
}

#[test]
fn units_scale_exactly_in_a_shell() {
    let mut random = Pcg64Mcg::seed_from_u64(9);
    // With errors of the rings χ² has no units; without, those of (r² d_r)².
    for (noise, unit) in [(CORRELATED, 1.0), (Noise { ring: 1e-3, ..QUIET }, (64.0_f64 * 4.0).powi(2))] {
        let one = profile(medium(amplitude(1.3 * first()), 1.3 * first()), noise, &mut random);
        let found = fit(&one);
        let rings = one.rings.iter().map(|ring| Ring {
            radius: 8.0 * ring.radius,
            mean: -4.0 * ring.mean,
            spread: 4.0 * ring.spread,
            standard_error: 4.0 * ring.standard_error,
            ..*ring
        });
        let other = RadialProfile { rings: rings.collect() };
        let scaled_shell = Annulus::new(4.0, 8.0 * RIM).expect("valid");
        let scaled = fit_radial_profile::<3>(&other, scaled_shell, &ProfileFitSettings::default()).expect("fits");
        assert_eq!(scaled.decision, found.decision);
        assert_eq!(scaled.elastic.amplitude.value, -4.0 * found.elastic.amplitude.value);
        assert_eq!(scaled.elastic.chi_squared, unit * found.elastic.chi_squared);
        let (scaled, found) = (scaled.screened.expect("screened"), found.screened.expect("screened"));
        assert_eq!(8.0 * scaled.wavenumber.value, found.wavenumber.value);
        assert_eq!(scaled.chi_squared, unit * found.chi_squared);
        assert_eq!(scaled.amplitude.standard_error, 4.0 * found.amplitude.standard_error);
    }
}
