//! Random annuli, wavenumbers and radii over the whole range claimed, and the scales errors are measured in.

use std::cell::RefCell;

use jamscope::reference::Annulus;
use jamscope::reference::poles::{pole, pole_count_below};
use proptest::prelude::*;
use proptest::test_runner::TestRunner;

use crate::Worst;
use crate::precise_bessel::rounded;
use crate::precise_profile::Point;
use crate::seeds::config;

/// An annulus with a = 1/2, κ, and radii inside it.
#[derive(Debug, Clone)]
pub struct Case {
    pub annulus: Annulus,
    pub wavenumber: f64,
    pub radii: Vec<f64>,
}

impl Case {
    /// κR.
    pub fn argument(&self) -> f64 {
        self.wavenumber * self.annulus.outer_radius()
    }
}

/// R/a from 1.001 to 10⁷, dense at both ends.
pub fn annuli() -> impl Strategy<Value = Annulus> {
    let gap = prop_oneof![-3.0..0.0f64, 0.0..7.0f64];
    gap.prop_map(|exponent| {
        let ratio =
            if exponent < 0.0 { (1.0 + 10f64.powf(exponent)).max(1.001) } else { 10f64.powf(exponent).max(1.001) };
        Annulus::new(0.5, 0.5 * ratio).expect("a positive gap")
    })
}

/// Where in the annulus: from a by a share of the gap, from R by one, or by the logarithm of r.
#[derive(Debug, Clone, Copy)]
enum Place {
    FromInner(f64),
    FromRim(f64),
    Logarithmic(f64),
}

/// `count` radii an annulus, κR from 10⁻⁸ to 10⁶ and often between 0.3 and 100, where the routes change.
pub fn cases(count: usize) -> impl Strategy<Value = Case> {
    let argument = prop_oneof![-8.0..6.0f64, -0.5..2.0f64].prop_map(|exponent| 10f64.powf(exponent));
    let share = || prop_oneof![(-15.0..0.0f64).prop_map(|exponent| 10f64.powf(exponent)), 0.0..1.0f64];
    let place = prop_oneof![
        share().prop_map(Place::FromInner),
        share().prop_map(Place::FromRim),
        (0.0..1.0f64).prop_map(Place::Logarithmic),
    ];
    (annuli(), argument, proptest::collection::vec(place, count)).prop_map(|(annulus, argument, places)| {
        let (inner, outer) = (annulus.inner_radius(), annulus.outer_radius());
        let radius = |place: &Place| match *place {
            Place::FromInner(share) => inner + (outer - inner) * share,
            Place::FromRim(share) => outer - (outer - inner) * share,
            Place::Logarithmic(share) => inner * (outer / inner).powf(share),
        };
        let radii = places.iter().map(radius).filter(|&radius| radius > inner && radius < outer).collect();
        Case { annulus, wavenumber: argument / outer, radii }
    })
}

/// Runs `check` on `count` random cases from a fixed seed; it returns, for every quantity it looks at, its error in units of
/// what is allowed. A failure prints the smallest case found; the worst one is printed in any case.
pub fn holds<S: Strategy>(name: &str, count: u32, strategy: S, check: impl Fn(&S::Value) -> Vec<f64>) {
    let config = ProptestConfig { source_file: Some(file!()), ..config(count, 20) };
    let worst = RefCell::new(Worst::default());
    let compared = RefCell::new(0);
    let result = TestRunner::new(config).run(&strategy, |case| {
        let shares = check(&case);
        for &share in &shares {
            *compared.borrow_mut() += 1;
            worst.borrow_mut().take(share, || format!("{case:?}"));
            prop_assert!(share <= 1.0, "{share} times what is allowed, all: {shares:?}");
        }
        Ok(())
    });
    if let Err(error) = result {
        panic!("{name}: {error}");
    }
    let compared = compared.into_inner();
    assert!(compared >= count, "{name}: {compared} comparisons for {count} cases");
    worst.into_inner().finish(name, compared as usize);
}

/// 1 + κ_n/|κ − κ_n|, summed over the poles on both sides: the condition of a profile in κ.
pub fn condition<const D: usize>(case: &Case) -> f64 {
    let below = pole_count_below::<D>(case.annulus, case.wavenumber);
    let term = |index| {
        let pole = pole::<D>(case.annulus, index);
        pole / (case.wavenumber - pole).abs()
    };
    1.0 + (below.max(1)..=below + 1).map(term).sum::<f64>()
}

/// What errors of v, v' and ∂v/∂κ are measured in.
///
/// For κR < 2, where nothing has a node, and next to the rim the values themselves. Elsewhere the amplitude of the oscillation the
/// value is a point of: in r its quarter wave is ℓ = 1/κ, or r where r is smaller; in κ it is 1/(R − r).
pub fn rim_scales(case: &Case, radius: f64, point: &Point) -> [f64; 3] {
    let [value, slope, response] = point.rim.each_ref().map(rounded);
    let length = radius.min(1.0 / case.wavenumber);
    let gap = case.annulus.outer_radius() - radius;
    if case.argument() < 2.0 {
        [value.abs(), slope.abs(), response.abs()]
    } else if gap < 0.5 * length {
        [value.abs(), slope.hypot(value / length), response.abs()]
    } else {
        let amplitude = value.hypot(length * slope).hypot(response / gap);
        [amplitude, amplitude / length, response.hypot(gap * value)]
    }
}
