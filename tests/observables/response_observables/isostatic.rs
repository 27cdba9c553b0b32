use jamscope::inflation::{Inflation, inflate_with};
use jamscope::io::read_packing;
use jamscope::law::Hertzian;
use jamscope::observe::bond_changes::BondSet;
use jamscope::observe::fluctuations::{FluctuationRing, Fluctuations};
use jamscope::observe::isostatic::{
    IsostaticError, IsostaticLength, IsostaticOutcome, IsostaticRule, IsostaticSettings, Normalisation, Scale, Tail,
};
use jamscope::relax::Fire;

/// Rings at 0.5, 1.5, … 39.5 with h by a function of r.
fn rings(fluctuation: impl Fn(f64) -> f64) -> Fluctuations {
    let ring = |k: u32| {
        let radius = f64::from(k) + 0.5;
        let fluctuation = fluctuation(radius);
        FluctuationRing { radius, count: 100, mean: 0.0, fluctuation, standard_error: 0.1 * fluctuation }
    };
    Fluctuations { rings: (0..40).map(ring).collect() }
}

const EXCESS: f64 = 0.5;

/// h r constant from `from` on and h constant before: y = 2 x up to a plateau of 2 · 0.5 · 12 = 12.
fn plateau(radius: f64) -> f64 {
    if radius < 12.0 { 2.0 } else { 24.0 / radius }
}

fn found(fluctuations: &Fluctuations, settings: &IsostaticSettings) -> IsostaticLength {
    IsostaticLength::of(fluctuations, Some(EXCESS), 0.1, 40.0, settings).expect("sound settings")
}

#[test]
fn a_crossing_between_two_rings_is_where_it_was_put() {
    let rings = rings(plateau);
    for (normalisation, unit) in
        [(Normalisation::Length, 1.0), (Normalisation::Increase, 0.1), (Normalisation::NearCentre { radius: 3.3 }, 2.0)]
    {
        // y = (2/unit) 0.5 r on a straight line up to r = 12: the threshold at r = 7.3.
        let threshold = 2.0 / unit * EXCESS * 7.3;
        let settings = IsostaticSettings {
            normalisation,
            rule: IsostaticRule::Threshold(threshold),
            ..IsostaticSettings::default()
        };
        let found = found(&rings, &settings);
        assert_eq!((found.excess, found.unit, found.threshold), (Some(EXCESS), Some(unit), Some(threshold)));
        let IsostaticOutcome::Reached { length, product, between } = found.outcome else { panic!("{found:?}") };
        assert!((length - 7.3).abs() < 1e-14 && (product - 3.65).abs() < 1e-14);
        assert_eq!(between, [6.5, 7.5]);
        // Rings from r = 1.5 on: the innermost holds the contacts of the inflated disk.
        assert_eq!(found.curve[0].radius, 1.5);
        let point = found.curve[19];
        assert_eq!((point.radius, point.scaled_radius), (20.5, 20.5 * EXCESS));
        assert!((point.scaled_fluctuation - 12.0 / unit).abs() < 1e-12);
        assert!((point.standard_error / point.scaled_fluctuation - 0.1).abs() < 1e-15);
    }
}

#[test]
fn the_plateau_sets_the_threshold_itself() {
    // Bent down near the rim, as a held rim does; the plateau between 0.4 and 0.7 R is 12, whatever the rest does.
    let rings = rings(|r| plateau(r) * if r > 30.0 { 0.2 } else { 1.0 });
    let rule = IsostaticRule::Plateau { from: 0.4, to: 0.7, share: 0.5 };
    let settings = IsostaticSettings { normalisation: Normalisation::Length, rule, ..IsostaticSettings::default() };
    let result = found(&rings, &settings);
    assert!((result.threshold.expect("a plateau") - 6.0).abs() < 1e-14);
    // y = r/2 · 2 = 6 at r = 6.
    let IsostaticOutcome::Reached { length, .. } = result.outcome else { panic!("{result:?}") };
    assert!((length - 6.0).abs() < 1e-14);
    let nowhere = IsostaticRule::Plateau { from: 0.9995, to: 1.0, share: 0.5 };
    assert_eq!(found(&rings, &IsostaticSettings { rule: nowhere, ..settings }).outcome, IsostaticOutcome::NoPlateau);
}

#[test]
fn with_the_tail_of_a_free_disk_what_falls_as_the_inverse_square_is_level() {
    // h = 24/r² beyond r = 12 and constant before: y = h (r/2)² up to a plateau of 6.
    let rings = rings(|r| if r < 12.0 { 24.0 / 144.0 } else { 24.0 / (r * r) });
    let rule = IsostaticRule::Plateau { from: 0.4, to: 0.9, share: 0.25 };
    let settings = IsostaticSettings { normalisation: Normalisation::Length, rule, ..IsostaticSettings::default() };
    let result = found(&rings, &IsostaticSettings { tail: Tail::InverseSquare, ..settings });
    assert_eq!(result.tail, Tail::InverseSquare);
    assert!((result.threshold.expect("a plateau") - 1.5).abs() < 1e-14);
    assert!(result.curve.iter().skip(12).all(|point| (point.scaled_fluctuation - 6.0).abs() < 1e-13));
    // y = r²/24 = 1.5 at r = 6; on the straight line between rings at 5.5 and 6.5 at 5.5 + (1.5 − 30.25/24)·24/12.
    let IsostaticOutcome::Reached { length, .. } = result.outcome else { panic!("{result:?}") };
    assert!((length - (5.5 + (36.0 - 30.25) / 12.0)).abs() < 1e-13, "{length}");
    // With the other tail the same curve is never level: its median, 12/26, says nothing, and a quarter of it is less than y = r/12
    // in the first ring.
    assert_eq!(found(&rings, &settings).outcome, IsostaticOutcome::AboveFromTheStart { innermost: 1.5 });
}

#[test]
fn by_the_root_of_the_excess_lengths_collapse_that_follow_it() {
    // h = 1 up to ℓ = 6/√ΔZ and falls as (ℓ/r)² beyond: x = r √ΔZ and y = h x² is 36 beyond x = 6 whatever ΔZ, so that y = 36 share at
    // x = 6 √share = 4.8. Before ℓ, y = x² is taken as a straight line between two rings √ΔZ apart: off by at most ΔZ/4, on a slope of at least
    // 2 · 4.8 − √ΔZ.
    let rule = IsostaticRule::Plateau { from: 0.7, to: 0.95, share: 0.64 };
    let settings = IsostaticSettings {
        normalisation: Normalisation::Length,
        tail: Tail::InverseSquare,
        scale: Scale::RootExcess,
        rule,
        ..IsostaticSettings::default()
    };
    for excess in [0.09, 0.16, 0.49, 1.0] {
        let end = 6.0 / f64::sqrt(excess);
        let rings = rings(|r| if r < end { 1.0 } else { (end / r).powi(2) });
        let found = IsostaticLength::of(&rings, Some(excess), 0.1, 40.0, &settings).expect("sound settings");
        assert_eq!((found.scale, found.excess), (Scale::RootExcess, Some(excess)));
        assert!((found.threshold.expect("a plateau") - 36.0 * 0.64).abs() < 1e-12);
        let IsostaticOutcome::Reached { length, product, .. } = found.outcome else { panic!("{found:?}") };
        assert!((product - 4.8).abs() <= 0.25 * excess / (9.6 - excess.sqrt()), "{excess}: {product}");
        assert!((product - length * excess.sqrt()).abs() < 1e-14);
        // By the excess itself the same length is another number at every ΔZ.
        let settings = IsostaticSettings { scale: Scale::Excess, ..settings };
        let other = IsostaticLength::of(&rings, Some(excess), 0.1, 40.0, &settings).expect("sound settings");
        let IsostaticOutcome::Reached { length: same, product, .. } = other.outcome else { panic!("{other:?}") };
        assert!((same / length - 1.0).abs() < 1e-14 && (product - same * excess).abs() < 1e-14);
    }
}

#[test]
fn what_has_no_length_says_why() {
    let settings = IsostaticSettings { normalisation: Normalisation::Length, ..IsostaticSettings::default() };
    let with = |excess: Option<f64>, fluctuations: &Fluctuations| {
        IsostaticLength::of(fluctuations, excess, 0.1, 40.0, &settings).expect("sound settings").outcome
    };
    assert_eq!(with(None, &rings(plateau)), IsostaticOutcome::NoBackbone);
    assert_eq!(with(Some(-0.01), &rings(plateau)), IsostaticOutcome::NoExcess { excess: -0.01 });
    assert_eq!(with(Some(0.5), &Fluctuations { rings: Vec::new() }), IsostaticOutcome::TooFewRings);
    assert_eq!(with(Some(0.5), &rings(|_| 10.0)), IsostaticOutcome::AboveFromTheStart { innermost: 1.5 });
    assert_eq!(with(Some(0.5), &rings(|r| 1.0 / r)), IsostaticOutcome::NeverReached { largest: 0.5 });
    assert_eq!(with(Some(0.5), &rings(|_| f64::NAN)), IsostaticOutcome::NoScale);
    let near = IsostaticSettings::default();
    assert_eq!(found(&rings(|_| 0.0), &near).outcome, IsostaticOutcome::NoScale);

    let refused = |settings: IsostaticSettings| {
        IsostaticLength::of(&rings(plateau), Some(0.5), 0.1, 40.0, &settings).expect_err("no sense")
    };
    assert_eq!(
        refused(IsostaticSettings { ring_width: 0.0, ..near }),
        IsostaticError::RingWidthNotPositive { ring_width: 0.0 }
    );
    assert_eq!(refused(IsostaticSettings { from: -1.0, ..near }), IsostaticError::FromNegative { from: -1.0 });
    assert_eq!(
        refused(IsostaticSettings { normalisation: Normalisation::NearCentre { radius: -1.0 }, ..near }),
        IsostaticError::RadiusNotPositive { radius: -1.0 }
    );
    assert_eq!(
        refused(IsostaticSettings { rule: IsostaticRule::Threshold(0.0), ..near }),
        IsostaticError::ThresholdNotPositive { value: 0.0 }
    );
    assert_eq!(
        refused(IsostaticSettings { rule: IsostaticRule::Plateau { from: 0.7, to: 0.4, share: 1.0 }, ..near }),
        IsostaticError::PlateauOutOfRange { from: 0.7, to: 0.4 }
    );
    let written = serde_json::to_string(&near).expect("plain data");
    assert_eq!(serde_json::from_str::<IsostaticSettings>(&written).expect("the same"), near);
    assert!(serde_json::from_str::<IsostaticSettings>(r#"{"width": 1.0}"#).is_err());
}

#[test]
fn an_inflation_has_the_curve_of_its_bonds() {
    let packing = read_packing::<2>("fixtures/packings/hertz_N1000_p800.xyz").expect("a fixture");
    let law = Hertzian::default();
    let inflated =
        inflate_with(&Inflation::default(), &packing, &law, &Fire::default(), 1, &mut ()).expect("an inflation");
    let settings = IsostaticSettings { bonds: BondSet::Before, ..IsostaticSettings::default() };
    let length = IsostaticLength::of_inflation(&inflated, &law, &settings).expect("sound settings");
    // ΔZ of the circle is near that of the box, 0.893; contacts with the rim have one end in it.
    assert!((length.excess.expect("jammed") - 0.893).abs() < 0.05);
    let last = length.curve.last().expect("rings");
    assert!(last.radius < inflated.outer_radius && last.radius > inflated.outer_radius - 1.0);
    assert!(length.curve.iter().all(|point| point.scaled_fluctuation > 0.0 && point.standard_error > 0.0));
}
