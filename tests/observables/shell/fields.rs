use jamscope::observe::angular::Leakage;
use jamscope::observe::shell::synthetic::{DirectionLayout, SyntheticSettings, SyntheticShell, gaussian_shells};
use jamscope::observe::shell::{ShellSpectrum, ShellSpectrumSettings};

use super::up_to;

fn shells(settings: SyntheticSettings, count: usize, spectrum: impl Fn(f64) -> f64) -> Vec<SyntheticShell> {
    gaussian_shells(&settings, count, spectrum).expect("sound settings")
}

fn spectra(shells: &[SyntheticShell], settings: ShellSpectrumSettings) -> Vec<ShellSpectrum> {
    shells.iter().map(|made| ShellSpectrum::of(&made.shell, &settings).expect("enough spheres")).collect()
}

/// Mean of a number over samples, and the standard error of the mean.
fn mean(samples: &[ShellSpectrum], number: impl Fn(&ShellSpectrum) -> f64) -> (f64, f64) {
    let count = samples.len() as f64;
    let mean = samples.iter().map(&number).sum::<f64>() / count;
    let square: f64 = samples.iter().map(|sample| (number(sample) - mean).powi(2)).sum();
    (mean, (square / (count - 1.0) / count).sqrt())
}

#[test]
fn the_mean_over_fields_is_the_spectrum_at_every_degree() {
    let lorentzian = |l: f64| 1.0 / (1.0 + (l / 4.0).powf(1.5));
    let layouts = [DirectionLayout::Random, DirectionLayout::Even, DirectionLayout::Clustered(0.5)];
    let laws: [&dyn Fn(f64) -> f64; 3] = [&lorentzian, &|l| l.powf(-2.5), &|l| l.powf(-1.5)];
    for (case, layout) in layouts.into_iter().enumerate() {
        for (law, spectrum) in laws.into_iter().enumerate() {
            let seed = 100 + 10 * case as u64 + law as u64;
            let settings = SyntheticSettings { disk_count: 300, layout, highest_degree: 8, noise: 0.5, seed };
            let found = spectra(&shells(settings, 400, spectrum), up_to(8, Leakage::Removed));
            // Fields without degrees above ℓ_max: unbiased for any directions. Four standard errors of the mean, measured;
            // 81 such numbers: one of 200 seeds fails by chance.
            for degree in 1..=8 {
                let (power, error) = mean(&found, |sample| sample.power[degree]);
                let exact = spectrum(degree as f64);
                assert!((power - exact).abs() < 4.0 * error, "{seed}, {degree}: {power} ± {error}, {exact}");
                assert!(error < 0.06 * (exact + 0.05), "{seed}, {degree}: {error}");
                // The stated error of one shell against the scatter, which 400 samples tell to 3.5 %, for P_1 with its three
                // modes to 7 %. Its mean square is (1 + 2/(2ℓ+1)) of the square of its mean. What other degrees leak is not in it.
                let (square, _) = mean(&found, |sample| sample.standard_errors[degree].powi(2));
                let ratio = square.sqrt() / (error * 20.0);
                println!(
                    "{seed}, {degree}: {:.2} standard errors off, stated error over scatter {ratio:.2}",
                    (power - exact) / error
                );
                assert!((0.65..1.7).contains(&ratio), "{seed}, {degree}: stated over found {ratio}");
            }
            let (noise, error) = mean(&found, |sample| sample.unresolved);
            assert!((noise - 0.25).abs() < 4.0 * error, "{seed}: ρ = {noise} ± {error}");
        }
    }
}

#[test]
fn degrees_above_the_range_count_as_single_spheres() {
    // Degrees up to 40, a range up to 8: at random directions the power above is white but for 1/n.
    let spectrum = |l: f64| 1.0 / (1.0 + (l / 4.0).powf(1.5));
    let settings = SyntheticSettings { disk_count: 300, highest_degree: 40, seed: 5, ..SyntheticSettings::default() };
    let found = spectra(&shells(settings, 400, spectrum), ShellSpectrumSettings::default());
    let above: f64 = (9..=40).map(|l| (2 * l + 1) as f64 * spectrum(f64::from(l))).sum();
    assert_eq!(found[0].degree_limit(), 8);
    for degree in 1..=8 {
        let (power, error) = mean(&found, |sample| sample.power[degree]);
        // Four standard errors, and the variance above over n².
        let (exact, beyond) = (spectrum(degree as f64), above / 9e4);
        assert!((power - exact).abs() < 4.0 * error + beyond, "{degree}: {power} ± {error}, {exact}");
    }
    let (noise, error) = mean(&found, |sample| sample.unresolved);
    assert!((noise - above).abs() < 4.0 * error + above / 300.0, "ρ = {noise} ± {error}, {above}");
    // The powers with leakage have a white floor of all variance over n.
    let kept = spectra(&shells(settings, 400, spectrum), up_to(8, Leakage::Kept));
    let (power, error) = mean(&kept, |sample| sample.power[8]);
    let all = above + (1..=8).map(|l| (2 * l + 1) as f64 * spectrum(f64::from(l))).sum::<f64>();
    assert!((power - spectrum(8.0) - all / 300.0).abs() < 4.0 * error + 0.05 * spectrum(8.0), "{power}, {error}");
}

#[test]
fn a_field_of_one_degree_has_nothing_elsewhere() {
    for layout in [DirectionLayout::Random, DirectionLayout::Clustered(0.5)] {
        let settings = SyntheticSettings { disk_count: 200, layout, highest_degree: 7, noise: 0.0, seed: 77 };
        let made = shells(settings, 400, |l| if l == 4.0 { 1.0 / 9.0 } else { 0.0 });
        let (removed, kept) = (spectra(&made, up_to(7, Leakage::Removed)), spectra(&made, up_to(7, Leakage::Kept)));
        for degree in 1..=7 {
            let (power, error) = mean(&removed, |sample| sample.power[degree]);
            let exact = if degree == 4 { 1.0 / 9.0 } else { 0.0 };
            // Four standard errors: 14 numbers, one of 1000 seeds fails by chance.
            assert!((power - exact).abs() < 4.0 * error, "{layout:?} {degree}: {power} ± {error}");
            let (with, error) = mean(&kept, |sample| sample.power[degree]);
            // V/n = 1/200 leaks everywhere without the removal.
            assert!(degree == 4 || with > 1.0 / 400.0 + 4.0 * error, "{layout:?} {degree}: {with} ± {error}");
        }
        assert!(removed.iter().all(|sample| (sample.power[4] - 1.0 / 9.0).abs() < 0.3));
        assert!(removed.iter().any(|sample| sample.negative_count > 0), "negative powers are kept");
    }
}

#[test]
fn each_shell_has_the_power_of_its_own_field() {
    // 2500 even spheres and degrees up to 10: the power of the realisation itself, to the Riemann sums' ℓ²/n.
    let settings =
        SyntheticSettings { disk_count: 2500, layout: DirectionLayout::Even, highest_degree: 10, noise: 0.0, seed: 9 };
    for made in shells(settings, 5, |l| l.powf(-1.5)) {
        let found = ShellSpectrum::of(&made.shell, &up_to(12, Leakage::Removed)).expect("enough spheres");
        for degree in 1..=10 {
            assert!((found.power[degree] / made.power[degree] - 1.0).abs() < 0.05, "{degree}");
        }
    }
}
