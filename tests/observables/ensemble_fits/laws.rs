use jamscope::fit::ensemble::{
    DivergenceOutcome, EnsembleFitError, MeasuredPoint, fit_divergence, fit_divergence_at, fit_power_law,
};
use rand::SeedableRng;
use rand_pcg::Pcg64;

use super::{expected, normal};

/// Points of a law with a relative error.
fn points(at: impl IntoIterator<Item = f64>, law: impl Fn(f64) -> f64, relative: f64) -> Vec<MeasuredPoint> {
    at.into_iter().map(|x| MeasuredPoint { x, y: law(x), error: relative * law(x) }).collect()
}

fn tenths(count: i32) -> impl Iterator<Item = f64> {
    (0..count).map(|i| 0.1 * f64::from(i))
}

#[test]
fn power_laws_are_exact() {
    // Sums of ten terms of size 10: rounding below 1e-14; A at x = 1 is e^(50) times the scatter of b at the most.
    for (amplitude, exponent) in [(3.0, -0.5), (1e-7, 2.0), (40.0, 0.0), (1.0, -1.0 / 3.0)] {
        let at = (0..10).map(|i| 1e3 * 1.7f64.powi(i));
        let fit = fit_power_law(&points(at, |x| amplitude * x.powf(exponent), 0.02)).expect("usable");
        assert!((fit.exponent.value - exponent).abs() < 1e-13, "{fit:?}");
        assert!((fit.amplitude.value / amplitude - 1.0).abs() < 1e-12 && fit.chi_squared < 1e-20, "{fit:?}");
        assert_eq!(fit.freedom, 8);
    }
}

#[test]
fn two_points_have_the_errors_of_the_textbook() {
    // b = ln(y_2/y_1)/ln 2 and A = y_1, with relative errors 3 and 4 %.
    let pair = [(1.0, 5.0, 0.15), (2.0, 10.0, 0.4)].map(|(x, y, error)| MeasuredPoint { x, y, error });
    let fit = fit_power_law(&pair).expect("usable");
    assert!((fit.exponent.standard_error - 0.05 / 2f64.ln()).abs() < 1e-14);
    assert!((fit.amplitude.standard_error - 0.15).abs() < 1e-14 && fit.freedom == 0);
}

#[test]
fn divergences_with_a_given_critical_point_are_exact() {
    let given = points(tenths(8), |x| 0.3 * (0.85 - x).powf(-1.2), 0.05);
    let fit = fit_divergence_at(&given, 0.85).expect("usable");
    assert!((fit.exponent.value - 1.2).abs() < 1e-12 && (fit.amplitude.value / 0.3 - 1.0).abs() < 1e-12, "{fit:?}");
    let refused = fit_divergence_at(&given, 0.65);
    assert!(matches!(refused, Err(EnsembleFitError::NotBelowCritical { point: 7, .. })));
}

#[test]
fn divergences_with_a_free_critical_point_are_exact() {
    // Brent's method places a minimum of χ² to about the root of 2⁻⁵² of what χ² is; here it is 0 there, to 1e-8 in the logarithm.
    for (critical, exponent) in [(0.85, 1.2), (0.71, 0.5), (1.5, 3.0), (0.701, 1.0)] {
        for scale in [1.0, 1e-4] {
            let law = |x: f64| 0.3 * (critical - x / scale).powf(-exponent);
            let fit = fit_divergence(&points(tenths(8).map(|x| scale * x), law, 0.01)).expect("usable");
            let DivergenceOutcome::Found(fit) = fit else { panic!("{critical} {exponent}: {fit:?}") };
            assert!((fit.critical.best / scale - critical).abs() < 1e-6, "{critical} {exponent}: {fit:?}");
            assert!((fit.exponent.value - exponent).abs() < 1e-5, "{critical} {exponent}: {fit:?}");
            assert!(fit.critical.holds(scale * critical) && fit.chi_squared < 1e-8 && fit.freedom == 5);
        }
    }
}

#[test]
fn errors_of_a_divergence_cover() {
    // Errors of 1 % at 12 points: χ² is quadratic within them. 95.4 % for two standard errors, 94 to 96.5 % allowed for curvature.
    let (critical, exponent, amplitude, ensembles) = (1.3, 1.2, 0.3, 500);
    let mut random = Pcg64::seed_from_u64(9);
    let mut held = [0; 3];
    for _ in 0..ensembles {
        let mut drawn = points(tenths(12), |x| amplitude * (critical - x).powf(-exponent), 0.01);
        drawn.iter_mut().for_each(|point| point.y += point.error * normal(&mut random));
        let DivergenceOutcome::Found(fit) = fit_divergence(&drawn).expect("usable") else { panic!() };
        let within = |of: jamscope::fit::Estimate, truth: f64| (of.value - truth).abs() <= 2.0 * of.standard_error;
        let all = [fit.critical.holds(critical), within(fit.exponent, exponent), within(fit.amplitude, amplitude)];
        all.iter().zip(&mut held).for_each(|(holds, count)| *count += usize::from(*holds));
    }
    println!("x_c, mu, A: {held:?} of {ensembles}");
    assert!(held.iter().all(|count| expected(ensembles, [0.94, 0.965]).contains(count)), "{held:?}");
}

#[test]
fn what_does_not_diverge_is_unbounded() {
    for relative in [0.01, 0.2] {
        let exponential = fit_divergence(&points(tenths(10), |x| 2.0 * (1.5 * x).exp(), relative)).expect("usable");
        assert!(matches!(exponential, DivergenceOutcome::Unbounded { .. }), "{exponential:?}");
        // Slower than an exponential: concave ln y.
        let slower = fit_divergence(&points(tenths(10), |x| 1.0 + x, relative)).expect("usable");
        assert!(matches!(slower, DivergenceOutcome::Unbounded { .. }), "{slower:?}");
    }
    // A weak curvature: the best x_c is finite, but infinity is within the errors.
    let weak = fit_divergence(&points(tenths(10), |x| 1.0 / (10.0 - x), 0.1)).expect("usable");
    let DivergenceOutcome::Found(weak) = weak else { panic!("{weak:?}") };
    assert!(weak.critical.upper.is_none() && weak.exponential_rise < 4.0, "{weak:?}");
    // Only the last point stands out.
    let step = fit_divergence(&points(tenths(10), |x| if x > 0.85 { 5.0 } else { 1.0 }, 0.1)).expect("usable");
    assert!(matches!(step, DivergenceOutcome::AtLastPoint { largest: Some(_) }), "{step:?}");
}

#[test]
fn what_cannot_be_used_is_refused() {
    let good = points(tenths(5).map(|x| x + 1.0), |x| x, 0.1);
    let with = |point: MeasuredPoint| [&good[..], &[point]].concat();
    for (y, error) in [(0.0, 1.0), (-1.0, 1.0), (1.0, 0.0), (1.0, f64::NAN), (f64::INFINITY, 1.0), (1e-320, 1.0)] {
        let all = with(MeasuredPoint { x: 2.0, y, error });
        assert!(matches!(fit_power_law(&all), Err(EnsembleFitError::PointUnusable { point: 5, .. })), "{y} {error}");
        assert!(matches!(fit_divergence(&all), Err(EnsembleFitError::PointUnusable { point: 5, .. })), "{y} {error}");
    }
    let few = EnsembleFitError::TooFewPoints { point_count: 1, needed: 2 };
    assert_eq!(fit_power_law(&[good[0], good[0]]), Err(few));
    assert_eq!(fit_divergence(&good[..3]), Err(EnsembleFitError::TooFewPoints { point_count: 3, needed: 4 }));
}
