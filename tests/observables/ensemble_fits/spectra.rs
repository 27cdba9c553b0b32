use jamscope::fit::angular::CrossoverOutcome;
use jamscope::fit::ensemble::{
    EnsembleFitError, LeastSquaresSlope, LikelihoodSlope, MeanCrossover, MeanCrossoverSettings, MeanSlope,
    crossover_interval, crossover_of_mean, slope_interval, slope_of_mean,
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::expected;

/// Powers at f = 1, …, `count`.
fn powers(count: u32, spectrum: impl FnMut(f64) -> f64) -> Vec<f64> {
    (1..=count).map(f64::from).map(spectrum).collect()
}

fn lorentzian(crossover: f64) -> impl Fn(f64) -> f64 {
    move |f| 1.0 / (1.0 + (f / crossover).powf(1.5))
}

fn views(samples: &[Vec<f64>]) -> Vec<&[f64]> {
    samples.iter().map(Vec::as_slice).collect()
}

fn crossover(samples: &[&[f64]], window: [usize; 2]) -> MeanCrossover {
    crossover_of_mean(samples, window, &MeanCrossoverSettings::default()).expect("usable")
}

fn outcome(fit: MeanCrossover) -> CrossoverOutcome {
    let MeanCrossover::Fitted { outcome, .. } = fit else { panic!("{fit:?}") };
    outcome
}

#[test]
fn expected_powers_give_back_slope_and_crossover() {
    // −2 ln L is least at the truth: ln E + E_0/E is least at E = E_0. Brent's method places it to about the root of 2⁻⁵².
    for scale in [1.0, 1e-9] {
        for exponent in [-0.5, 0.0, 0.3, 1.5, 2.7] {
            let mean = powers(30, |f| scale * f.powf(-exponent));
            let fit = slope_of_mean(&[&mean, &mean], [2, 25]).expect("usable");
            let MeanSlope { least_squares: LeastSquaresSlope::Found { exponent: line, amplitude: a }, .. } = fit else {
                panic!()
            };
            let LikelihoodSlope::Found { exponent: found, amplitude } = fit.likelihood else { panic!("{fit:?}") };
            assert!((line.value - exponent).abs() < 1e-13 && (a / scale - 1.0).abs() < 1e-12, "{fit:?}");
            assert!((found.best - exponent).abs() < 1e-6 && (amplitude / scale - 1.0).abs() < 1e-5, "{fit:?}");
        }
        for truth in [1.0, 3.0, 10.0] {
            let mean = powers(30, |f| scale * lorentzian(truth)(f));
            let fit = crossover(&vec![mean.as_slice(); 100], [1, 30]);
            assert!((fit.found().expect("a crossover") / truth - 1.0).abs() < 1e-6, "{fit:?}");
            let CrossoverOutcome::Found { crossover, angle } = outcome(fit) else { panic!("{fit:?}") };
            assert!((angle.best * crossover.best / MeanCrossoverSettings::default().angle_factor - 1.0).abs() < 1e-15);
        }
    }
}

#[test]
fn the_interval_of_the_likelihood_ends_where_it_has_risen_by_four() {
    // The slow twin: −2 ln L written out.
    let mut random = Pcg64::seed_from_u64(8);
    let samples: Vec<Vec<f64>> = (0..5).map(|_| powers(20, |f| -random.random::<f64>().ln() / f)).collect();
    let LikelihoodSlope::Found { exponent, .. } = slope_of_mean(&views(&samples), [1, 20]).expect("usable").likelihood
    else {
        panic!()
    };
    let mean: Vec<f64> = (0..20).map(|f| samples.iter().map(|sample| sample[f]).sum::<f64>() / 5.0).collect();
    let deviance = |s: f64| {
        let shape = powers(20, |f| f.powf(-s));
        let amplitude = mean.iter().zip(&shape).map(|(p, e)| p / e).sum::<f64>() / 20.0;
        10.0 * mean.iter().zip(&shape).map(|(p, e)| (amplitude * e).ln() + p / (amplitude * e)).sum::<f64>()
    };
    for end in [exponent.lower, exponent.upper] {
        assert!((deviance(end.expect("closed")) - deviance(exponent.best) - 4.0).abs() < 1e-5);
    }
    assert!((-20..=20).all(|i| deviance(exponent.best + 0.05 * f64::from(i)) >= deviance(exponent.best)));
}

#[test]
fn intervals_of_independent_powers_cover() {
    // 50 samples of 20 exponential powers: −2 ln L is that of the truth. 95.4 %, and 94 to 96 allowed for the 2 of 1000 degrees of
    // freedom; the bootstrap has 1/50 less variance: 93.5 to 95.5 %.
    let ensembles = 300;
    let mut random = Pcg64::seed_from_u64(12);
    let mut held = [0; 4];
    for _ in 0..ensembles {
        let mut draw = |spectrum: &dyn Fn(f64) -> f64| -> Vec<Vec<f64>> {
            (0..50).map(|_| powers(20, |f| -(1.0 - random.random::<f64>()).ln() * spectrum(f))).collect()
        };
        let (sloped, bent) = (draw(&|f| f.powf(-1.5)), draw(&lorentzian(5.0)));
        let LikelihoodSlope::Found { exponent, .. } =
            slope_of_mean(&views(&sloped), [1, 20]).expect("usable").likelihood
        else {
            panic!()
        };
        let [by_squares, by_likelihood] = slope_interval(&views(&sloped), [1, 20], 100).expect("usable");
        let all = [
            exponent.holds(1.5),
            by_squares.expect("positive").holds(1.5),
            by_likelihood.expect("positive").holds(1.5),
            outcome(crossover(&views(&bent), [1, 20])).holds(5.0),
        ];
        all.iter().zip(&mut held).for_each(|(holds, count)| *count += usize::from(*holds));
    }
    println!("likelihood, squares, bootstrap, crossover: {held:?} of {ensembles}");
    for (count, probability) in held.iter().zip([[0.94, 0.96], [0.93, 0.955], [0.93, 0.955], [0.94, 0.96]]) {
        assert!(expected(ensembles, probability).contains(count), "{held:?}");
    }
}

#[test]
fn every_outcome_has_its_data() {
    let hundred = |mean: &[f64]| outcome(crossover(&vec![mean; 100], [1, 20]));
    assert!(matches!(hundred(&powers(20, |f| f.powf(-1.5))), CrossoverOutcome::ScaleFree { .. }));
    assert!(matches!(hundred(&powers(20, |_| 0.3)), CrossoverOutcome::White { .. }));
    // Steeper than any Lorentzian, and rising: the limits.
    let best = |mean: Vec<f64>| {
        let fit = crossover(&vec![mean.as_slice(); 100], [1, 20]);
        let MeanCrossover::Fitted { crossover, .. } = fit else { panic!("{fit:?}") };
        crossover
    };
    assert_eq!([best(powers(20, |f| f.powi(-3))), best(powers(20, |f| f))], [0.0, f64::INFINITY]);
    let one = powers(3, lorentzian(2.0));
    assert_eq!(outcome(crossover(&[&one], [1, 3])), CrossoverOutcome::Undetermined);

    // One mean that is negative: no logarithm, but a likelihood.
    let mut dipped = powers(20, |f| f.powf(-1.5));
    dipped[16] = -0.002;
    let fit = slope_of_mean(&vec![dipped.as_slice(); 100], [1, 20]).expect("usable");
    assert_eq!(fit.least_squares, LeastSquaresSlope::NonPositivePower { frequency: 17 });
    assert!(fit.likelihood.exponent().is_some_and(|s| (s - 1.5).abs() < 0.2), "{fit:?}");
    let [by_squares, by_likelihood] = slope_interval(&vec![dipped.as_slice(); 100], [1, 20], 20).expect("usable");
    assert!(by_squares.is_none() && by_likelihood.is_some_and(|found| found.standard_error < Some(1e-9)));
    // One of 0.04·17^1.5 = 2.8 beside 19 of 1, 13 % of all, is refused.
    dipped[16] = -0.04;
    let fit = slope_of_mean(&[&dipped], [1, 20]).expect("usable");
    assert_eq!(fit.likelihood, LikelihoodSlope::NegativePowers);
    assert_eq!(crossover(&[&dipped], [1, 20]), MeanCrossover::NegativePowers);
    // Too many that are.
    let mut broken = powers(20, |f| f.powf(-1.5));
    broken.iter_mut().skip(8).for_each(|power| *power = -*power);
    let fit = slope_of_mean(&[&broken], [1, 20]).expect("usable");
    assert_eq!(fit.likelihood, LikelihoodSlope::NegativePowers);
    assert_eq!(crossover(&[&broken], [1, 20]), MeanCrossover::NegativePowers);
    assert_eq!(
        slope_of_mean(&[&powers(20, |f| -f)], [1, 20]).expect("usable").likelihood,
        LikelihoodSlope::NegativePowers
    );
    let steep = slope_of_mean(&[&powers(20, |f| f.powi(-9))], [1, 20]).expect("usable");
    assert_eq!(steep.likelihood, LikelihoodSlope::Undetermined);
}

#[test]
fn what_cannot_be_used_is_refused() {
    let (mean, window) = (powers(10, |f| 1.0 / f), [1, 10]);
    assert_eq!(slope_of_mean(&[], window), Err(EnsembleFitError::NoSample));
    for bad in [[0, 5], [1, 11], [4, 5], [5, 4], [usize::MAX, usize::MAX]] {
        let refused = slope_of_mean(&[&mean], bad);
        assert!(matches!(refused, Err(EnsembleFitError::WindowOutOfRange { .. })), "{bad:?}");
    }
    let differ = EnsembleFitError::SamplesDiffer { sample: 1, power_count: 9, expected: 10 };
    assert_eq!(slope_of_mean(&[&mean, &mean[1..]], window), Err(differ));
    let mut broken = mean.clone();
    broken[4] = f64::NAN;
    let refused = EnsembleFitError::PowerNotFinite { sample: 1, frequency: 5 };
    assert_eq!(slope_interval(&[&mean, &broken], window, 5), Err(refused));
    for bad in [0.0, f64::NAN, 101.0] {
        let settings = MeanCrossoverSettings { exponent: bad, ..MeanCrossoverSettings::default() };
        let refused = crossover_interval(&[&mean], window, &settings, 5);
        assert!(matches!(refused, Err(EnsembleFitError::SettingOutOfRange { setting: "exponent", .. })));
    }
}
