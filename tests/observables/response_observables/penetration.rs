use jamscope::observe::penetration_length::{Penetration, PenetrationError, PenetrationLength, PenetrationSettings};
use jamscope::observe::{RadialProfile, Ring};
use jamscope::reference::{Annulus, RadialSolution, elastic::Elastic, screened::Screened};

fn profile(radii: impl Iterator<Item = f64>, value: impl Fn(f64) -> f64) -> RadialProfile {
    let ring = |radius: f64| Ring { radius, disk_count: 10, mean: value(radius), spread: 0.0, standard_error: 0.0 };
    RadialProfile { rings: radii.map(ring).collect() }
}

fn at(profile: &RadialProfile, threshold: f64) -> Penetration {
    let settings = PenetrationSettings { thresholds: vec![threshold] };
    PenetrationLength::of(profile, &settings).expect("sound settings")[0].penetration
}

/// Rings of one length from 1 to 39.
fn radii() -> impl Iterator<Item = f64> {
    (1..40).map(f64::from)
}

/// How far interpolation on a straight line in ln |d| may be off between two rings one length apart: (1/8) max |y''|/min
/// |y'| there, both by differences of the exact curve.
fn interpolation_error(value: impl Fn(f64) -> f64, ring: f64) -> f64 {
    let y = |r: f64| value(r).abs().ln();
    let step = 1e-3;
    let samples = (1..100).map(|k| ring + f64::from(k) / 100.0);
    let [mut bend, mut slope] = [0.0f64, f64::INFINITY];
    for r in samples {
        bend = bend.max(((y(r + step) - 2.0 * y(r) + y(r - step)) / (step * step)).abs());
        slope = slope.min(((y(r + step) - y(r - step)) / (2.0 * step)).abs());
    }
    bend / slope / 8.0
}

#[test]
fn an_exponential_profile_is_exact_at_every_threshold() {
    let decay = 2.3;
    let profile = profile(radii(), |r| 0.1 * (-r / decay).exp());
    let lengths = PenetrationLength::of(&profile, &PenetrationSettings::default()).expect("sound settings");
    assert_eq!(lengths.iter().map(|length| length.threshold).collect::<Vec<_>>(), [1e-3, 1e-4, 1e-5, 1e-6]);
    for length in lengths {
        let exact = decay * (0.1 / length.threshold).ln();
        // ln to 10⁻¹⁶ of values up to 17, over a difference of 1/2.3.
        assert!((length.penetration.radius().expect("it falls") - exact).abs() < 1e-13);
        let Penetration::FallsAt { last_above, first_below, .. } = length.penetration else { panic!("it falls") };
        assert!(last_above <= exact && exact < first_below && first_below == last_above + 1.0);
    }
}

#[test]
fn the_elastic_profile_falls_where_its_formula_says() {
    let (inner, outer, amplitude) = (0.5, 40.0, 0.1);
    let medium = Elastic::<2>::new(Annulus::new(inner, outer).expect("an annulus"), amplitude).expect("finite");
    let profile = profile(radii(), |r| medium.value(r));
    for threshold in [1e-2, 3e-3, 1e-3, 1e-4] {
        // K (R²/r − r) = d_th with K = d_0 a/(R² − a²), a quadratic in r.
        let half = 0.5 * threshold * (outer * outer - inner * inner) / (amplitude * inner);
        let exact = outer * outer / (half + (half * half + outer * outer).sqrt());
        let found = at(&profile, threshold).radius().expect("it falls before the last ring");
        let tolerance = interpolation_error(|r| medium.value(r), exact.floor());
        assert!((found - exact).abs() < tolerance, "{found} is not {exact} to {tolerance}");
    }
    // At r = 39 it is still 0.1 · 0.5 (1/39 − 39/1600): 6·10⁻⁵.
    assert_eq!(at(&profile, 1e-5), Penetration::ReachesRim { outermost: 39.0 });
}

#[test]
fn a_screened_profile_counts_from_its_last_swing() {
    let annulus = Annulus::new(0.5, 40.0).expect("an annulus");
    let medium = Screened::<2>::new(annulus, 0.1, 0.22).expect("no pole");
    let profile = profile(radii(), |r| medium.value(r));
    let threshold = 2e-3;
    // From the rim inwards to the first place where |d| is at the threshold.
    let step = 1e-3;
    let above = |r: f64| medium.value(r).abs() >= threshold;
    let mut r = 40.0;
    while !above(r) {
        r -= step;
    }
    let (mut low, mut high) = (r, r + step);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if above(middle) { low = middle } else { high = middle }
    }
    // It crosses zero before: what counts is the last swing.
    assert!((1..low as usize).any(|r| medium.value(r as f64) * medium.value(r as f64 + 1.0) < 0.0));
    let found = at(&profile, threshold).radius().expect("it falls");
    let tolerance = interpolation_error(|r| medium.value(r), low.floor());
    assert!((found - low).abs() < tolerance, "{found} is not {low} to {tolerance}");
}

#[test]
fn what_has_no_length_says_why() {
    let still = profile(radii(), |_| 0.0);
    assert_eq!(at(&still, 1e-3), Penetration::NeverAbove { largest: Some(0.0) });
    assert_eq!(at(&RadialProfile { rings: Vec::new() }, 1e-3), Penetration::NeverAbove { largest: None });
    let front = profile(radii(), |r| if r < 7.5 { -0.01 } else { 0.0 });
    // Nothing moves beyond r = 7: ξ is there, whatever the threshold; and |⟨d_r⟩| counts, not its sign.
    for threshold in [0.01, 1e-3, 1e-6] {
        assert_eq!(at(&front, threshold), Penetration::FallsAt { radius: 7.0, last_above: 7.0, first_below: 8.0 });
    }
    let refused = |thresholds: Vec<f64>| PenetrationLength::of(&still, &PenetrationSettings { thresholds });
    assert_eq!(refused(vec![1e-3, 0.0]), Err(PenetrationError::ThresholdNotPositive { index: 1, threshold: 0.0 }));
    assert!(refused(vec![f64::NAN]).is_err());
    let broken = profile(radii(), |r| if r == 5.0 { f64::INFINITY } else { 0.0 });
    assert_eq!(
        PenetrationLength::of(&broken, &PenetrationSettings::default()),
        Err(PenetrationError::RingNotFinite { ring: 4, radius: 5.0, mean: f64::INFINITY })
    );
}
