//! `Straight`: the screened solution of a strip, D = 1, in which a row of disks is displaced and a straight wall is held.
//!
//! ```text
//! v = sin κ(R−r)/κ        v' = −cos κ(R−r)        ∂v/∂κ = −(R−r)² j_1(κ(R−r))
//! ```

use crate::reference::Annulus;
use crate::reference::bessel::spherical::j1;
use crate::reference::rim_distance::RimDistance;

/// The solution with v(R) = 0, v'(R) = −1 at one κ > 0.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Straight {
    wavenumber: f64,
    outer_radius: f64,
}

impl Straight {
    pub(crate) fn new(wavenumber: f64, outer_radius: f64) -> Self {
        Straight { wavenumber, outer_radius }
    }

    fn sine_cosine(self, radius: f64) -> (f64, f64) {
        RimDistance::new(self.wavenumber, self.outer_radius, radius).sine_cosine(0.0)
    }

    pub(crate) fn value(self, radius: f64) -> f64 {
        self.sine_cosine(radius).0 / self.wavenumber
    }

    pub(crate) fn derivative(self, radius: f64) -> f64 {
        -self.sine_cosine(radius).1
    }
}

/// ∂v/∂κ.
pub(crate) fn rim_response(wavenumber: f64, outer_radius: f64, radius: f64) -> f64 {
    let gap = outer_radius - radius;
    -gap * gap * j1(wavenumber * gap)
}

/// ∂(d/d_0)/∂κ of d/d_0 = sin κg/sin κ(g+s), g = R − r, s = r − a:
///
/// ```text
/// κ g s [S(κs) − S(κg) cos κ(g+s)]/sin² κ(g+s)        S(x) = sin x/x
/// S(κs) − S(κg) cos κ(g+s) = T(κg) − T(κs) + 2 S(κg) sin² κ(g+s)/2        T = 1 − S
/// ```
///
/// In the second form, for κ(R−a) ≤ 1, the last term is the largest, so nothing cancels.
pub(crate) fn profile_response(annulus: Annulus, wavenumber: f64, radius: f64) -> f64 {
    let (inner, outer) = (annulus.inner_radius(), annulus.outer_radius());
    let (gap, depth) = (outer - radius, radius - inner);
    let whole = RimDistance::new(wavenumber, outer, inner);
    let (sine, cosine) = whole.sine_cosine(0.0);
    let difference = if whole.value() > 1.0 {
        let share = |from: f64, to: f64| {
            let phase = RimDistance::new(wavenumber, from, to);
            if phase.value() > 0.0 { phase.sine_cosine(0.0).0 / phase.value() } else { 1.0 }
        };
        share(radius, inner) - share(outer, radius) * cosine
    } else {
        let (of_gap, of_depth) = (sine_defect(wavenumber * gap), sine_defect(wavenumber * depth));
        let half = libm::sin(0.5 * whole.value());
        of_gap - of_depth + 2.0 * (1.0 - of_gap) * half * half
    };
    wavenumber * gap * depth * (difference / sine / sine)
}

/// T(x) = 1 − sin x/x for 0 ≤ x ≤ 1, with relative accuracy.
fn sine_defect(x: f64) -> f64 {
    // x²/6 − x⁴/120 + …; the first term left out is x¹⁸/19!, 5·10⁻¹⁷ of the first at x = 1.
    let square = x * x;
    let (mut term, mut sum) = (square / 6.0, 0.0);
    for k in 2..10 {
        sum += term;
        term *= -square / f64::from(2 * k * (2 * k + 1));
    }
    sum
}

#[cfg(test)]
mod tests {
    use crate::reference::elastic::Elastic;
    use crate::reference::poles::{pole, pole_count_below};
    use crate::reference::rim::RimSolution;
    use crate::reference::screened::Screened;
    use crate::reference::{Annulus, RadialSolution, ReferenceError};

    /// a, R, r, κ, then d/d_0, d', ∂d/∂κ of the strip, computed with 60 digits: `fixtures/reference/strip.py`.
    const VALUES: [[f64; 7]; 6] = [
        [0.5, 20.5, 3.0, 1e-6, 0.8750000000136718, -0.049999999995677086, 2.734375000171468e-05],
        [0.5, 20.5, 10.25, 0.05, 0.5827385485407968, -0.05178558466122492, 3.132602474784405],
        [0.5, 20.5, 20.0, 0.3, -0.5348240646523077, 1.061613708949065, -38.526241807097435],
        [0.5, 340.0, 1.0, 0.01, 0.9806806677121435, -0.03866334263838852, 25.07441250813083],
        [0.5, 340.0, 200.0, 7.5, 0.650394790981444, -5.697553364943786, 103.95939943572127],
        [1.0, 1.001, 1.0003, 2000.5, 1.0840620645725885, -373.2628728366355, 0.0006273942561700361],
    ];

    #[test]
    fn the_strip_has_its_values() {
        for [inner, outer, radius, wavenumber, value, slope, response] in VALUES {
            let annulus = Annulus::new(inner, outer).expect("an interval");
            let medium = Screened::<1>::new(annulus, 1.0, wavenumber).expect("no pole");
            // The phases are exact to 2⁻⁵², so only a few roundings are left, each magnified by 1/sin κ(R−a), below 30
            // for these rows.
            let close = |found: f64, exact: f64, what: &str| {
                let scale = exact.abs().max(1e-3);
                assert!((found - exact).abs() <= 2e-14 * scale, "{what} at κ = {wavenumber}: {found} and {exact}");
            };
            close(medium.value(radius), value, "d");
            close(medium.derivative(radius), slope, "d'");
            close(medium.wavenumber_derivative(radius) / outer, response / outer, "∂d/∂κ");
            assert_eq!((medium.value(inner), medium.value(outer)), (1.0, 0.0));
        }
    }

    #[test]
    fn without_screening_the_strip_is_stretched_evenly() {
        let annulus = Annulus::new(0.5, 20.5).expect("an interval");
        let (elastic, weak) = (Elastic::<1>::new(annulus, 0.1), Screened::<1>::new(annulus, 0.1, 1e-6));
        let (elastic, weak) = (elastic.expect("finite"), weak.expect("no pole"));
        for radius in [0.5, 3.0, 10.5, 20.0] {
            // The error of κ = 0 is (κR)²/6, 10⁻¹⁰; its slope is −d_0/(R−a).
            assert!((elastic.value(radius) - 0.1 * (20.5 - radius) / 20.0).abs() < 1e-16);
            assert!((weak.value(radius) - elastic.value(radius)).abs() < 1e-11);
            assert!((elastic.derivative(radius) + 0.005).abs() < 1e-18);
        }
        let rim = RimSolution::<1>::new(annulus, 0.0).expect("elastic");
        assert_eq!((rim.value(0.5), rim.derivative(3.0)), (20.0, -1.0));
    }

    #[test]
    fn poles_of_the_strip_are_multiples_of_pi() {
        let annulus = Annulus::new(0.5, 20.5).expect("an interval");
        for index in 1..50 {
            let exact = index as f64 * std::f64::consts::PI / 20.0;
            assert!((pole::<1>(annulus, index) - exact).abs() <= 4.0 * f64::EPSILON * exact);
            assert_eq!(pole_count_below::<1>(annulus, exact * (1.0 + 1e-12)), index);
            assert_eq!(pole_count_below::<1>(annulus, exact * (1.0 - 1e-12)), index - 1);
            let refused = Screened::<1>::new(annulus, 0.1, pole::<1>(annulus, index));
            assert!(matches!(refused, Err(ReferenceError::AtPole { .. })));
        }
    }

    #[test]
    fn the_rim_solution_and_its_derivative_in_kappa() {
        let annulus = Annulus::new(0.5, 20.5).expect("an interval");
        // Central differences of step h have errors of order h² (R−r)³/κ⁰, 10⁻⁷ here.
        let h = 1e-5;
        for wavenumber in [1e-3, 0.05, 0.3, 2.0] {
            let at = |k: f64| RimSolution::<1>::new(annulus, k).expect("valid").value(4.0);
            let rim = RimSolution::<1>::new(annulus, wavenumber).expect("valid");
            let difference = (at(wavenumber + h) - at(wavenumber - h)) / (2.0 * h);
            assert!((rim.wavenumber_derivative(4.0) - difference).abs() < 1e-6, "κ = {wavenumber}");
        }
    }
}
