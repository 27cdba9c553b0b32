use jamscope::fit::angular::{
    CrossoverOutcome, ExponentChoice, HighestFrequency, ShellCrossoverSettings, ShellFitSettings, SlopeOutcome,
    SpectrumFitError, fit_shell_crossover, fit_shell_slope,
};
use jamscope::observe::shell::ShellSample;
use jamscope::observe::shell::synthetic::{SyntheticSettings, gaussian_shells};

fn shells(disk_count: usize, seed: u64, count: usize, spectrum: impl Fn(f64) -> f64) -> Vec<ShellSample> {
    let highest_degree = 2 * disk_count.isqrt();
    let settings = SyntheticSettings { disk_count, seed, highest_degree, noise: 0.3, ..SyntheticSettings::default() };
    let made = gaussian_shells(&settings, count, spectrum).expect("sound settings");
    made.into_iter().map(|made| made.shell).collect()
}

#[test]
fn slopes_lie_within_two_standard_errors() {
    for (disk_count, exponent, powers) in [(500, 2.5, 7), (500, 1.5, 7), (1500, 2.5, 13)] {
        let shells = shells(disk_count, 7, 100, |l| l.powf(-exponent));
        let settings = ShellFitSettings::default();
        let fits = shells.iter().map(|shell| {
            let fit = fit_shell_slope(std::slice::from_ref(shell), &settings).expect("enough spheres");
            assert_eq!((fit.power_count, fit.window), (powers, [1, powers]));
            fit
        });
        let fits: Vec<_> = fits.collect();
        // 95.45 % expected: 100 trials give fewer than 89 in one of 200 seeds.
        let held = fits.iter().filter(|fit| fit.exponent.holds(exponent)).count();
        assert!(held >= 89, "{disk_count} {exponent}: {held}");
        let sloped = fits.iter().filter(|fit| fit.outcome == SlopeOutcome::Sloped).count();
        println!("{disk_count} spheres, s = {exponent}: {held} of 100 within, {sloped} closed intervals");
        // Σ h (P/E − 1)² per degree of freedom has the mean 1.
        let dispersion = fits.iter().map(|fit| fit.dispersion).sum::<f64>() / 100.0;
        assert!((0.8..1.25).contains(&dispersion), "{dispersion}");
    }
}

#[test]
fn twenty_shells_together_tell_slope_and_crossover() {
    let shells = shells(800, 3, 20, |l| l.powf(-2.5));
    let fit = fit_shell_slope(&shells, &ShellFitSettings::default()).expect("enough spheres");
    let estimate = fit.exponent.estimate().expect("closed");
    assert!(fit.exponent.holds(2.5) && estimate.standard_error < 0.15, "{fit:?}");
    // ρ is the noise, 0.09, and the degrees from 11 to 56; V all degrees.
    let sum = |degrees: std::ops::RangeInclusive<u32>| {
        degrees.map(|l| f64::from(2 * l + 1) * f64::from(l).powf(-2.5)).sum::<f64>()
    };
    let exact = (sum(11..=56) + 0.09) / (sum(1..=56) + 0.09);
    // One shell: V scatters by 40 %, as P_1 does.
    assert!((fit.noise / exact).ln().abs() < 1.0, "{} {exact}", fit.noise);
}

#[test]
fn crossovers_are_found_where_they_are() {
    for (seed, crossover, exponent) in [(11, 3.0, 1.5), (12, 6.0, 1.5), (13, 3.0, 3.0)] {
        let shells = shells(600, seed, 160, |l| 1.0 / (1.0 + (l / crossover).powf(exponent)));
        let settings =
            ShellCrossoverSettings { exponent: ExponentChoice::Fixed(exponent), ..ShellCrossoverSettings::default() };
        let fit = |four: &[ShellSample]| fit_shell_crossover(four, &settings).expect("enough spheres").outcome;
        let outcomes: Vec<_> = shells.chunks_exact(4).map(fit).collect();
        let held = outcomes.iter().filter(|outcome| outcome.holds(crossover)).count();
        let found = outcomes.iter().filter(|outcome| matches!(outcome, CrossoverOutcome::Found { .. })).count();
        println!("ℓ† = {crossover}, s = {exponent}: {held} of 40 within, {found} found");
        // 95.45 % expected: 40 trials give fewer than 34 in one of 250 seeds.
        assert!(held >= 34, "{crossover} {exponent}: {held}");
    }
    let steep = |l: f64| 1.0 / (1.0 + (l / 5.0).powf(3.0));
    let shells = shells(1500, 13, 10, steep);
    let exponent = ExponentChoice::Fixed(3.0);
    let settings = ShellCrossoverSettings { exponent, ..ShellCrossoverSettings::default() };
    let fit = fit_shell_crossover(&shells, &settings).expect("enough spheres");
    let CrossoverOutcome::Found { crossover, angle } = fit.outcome else { panic!("{fit:?}") };
    assert!(crossover.holds(5.0) && angle.holds(0.2), "{crossover:?}");
    let width = crossover.estimate().expect("closed").standard_error;
    assert!(width < 0.5, "{width}");
    let free = ShellCrossoverSettings { exponent: ExponentChoice::Free, ..settings };
    let fit = fit_shell_crossover(&shells, &free).expect("enough spheres");
    assert!(fit.outcome.holds(5.0) && (fit.exponent - 3.0).abs() < 1.0, "{fit:?}");
}

#[test]
fn power_laws_and_white_spectra_have_their_names() {
    let scale_free = shells(800, 5, 10, |l| l.powf(-1.5));
    let fit = fit_shell_crossover(&scale_free, &ShellCrossoverSettings::default()).expect("enough spheres");
    assert!(matches!(fit.outcome, CrossoverOutcome::ScaleFree { .. }), "{fit:?}");
    let shell = || shells(500, 6, 1, |l| l.powf(-1.5)).remove(0);
    let refused = |settings: ShellFitSettings| fit_shell_slope(&[shell()], &settings).expect_err("no sense");
    let usual = ShellFitSettings::default();
    assert_eq!(fit_shell_slope(&[], &usual), Err(SpectrumFitError::NoRing));
    assert_eq!(
        refused(ShellFitSettings { lowest: 6, ..usual }),
        SpectrumFitError::TooFewPowers { power_count: 2, lowest: 6, highest: 7, disk_count: 500 }
    );
    assert_eq!(
        refused(ShellFitSettings { highest: HighestFrequency::Fixed(22), ..usual }),
        SpectrumFitError::WindowOutOfRange { lowest: 1, highest: 22, disk_count: 500 }
    );
}
