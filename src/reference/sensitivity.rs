//! [`Sensitivity`]: the derivative of a profile with respect to κ, without the cancellations of the direct formula.
//!
//! ```text
//! κ ∂d/∂κ = r d' − a d'(a) d/d_0 − R d'(R) w(r)        w(a) = 0, w(R) = 1
//! ```
//!
//! follows from the scaling of the equation. It loses all digits as κ → 0 (the left side is of order κ², each term on
//! the right is not), as κa → 0, as r → a and as r → R. There are therefore three methods, connected by two numbers:
//!
//! 1. Near a: `∂(d/d_0)/∂κ = u(r) ∂β/∂κ + h(r)` with β = d'(a)/d_0, u(a) = 0, u'(a) = 1, and h = ∂f/∂κ at fixed β,
//!    which begins as (r − a)²; both by [`LocalSeries`].
//! 2. Near R: `(d/d_0) [∂ ln v(r)/∂κ − Λ]` with Λ = ∂ ln v(a)/∂κ; the first term begins as (R − r)², by
//!    [`LocalSeries`].
//! 3. Between: for small κR power series in κ² ([`Pair`]); otherwise modulus and phase ([`Wave`]), or I and K
//!    ([`Decay`]).
//!
//! ∂β/∂κ, and Λ if the rim is far, are determined where two methods overlap.
//!
//! With Φ(r) the phase from r to R, Φ° = κ ∂Φ/∂κ and m as in [`Wave`], method 3 is
//!
//! ```text
//! κ ∂(d/d_0)/∂κ = [m(r) − m(a)] d/d_0 + (M(κr)/M(κa)) [Φ°(a) sin(Φ(a) − Φ(r)) − (Φ°(a) − Φ°(r)) cos Φ(r) sin Φ(a)] / sin² Φ(a)
//! ```
//!
//! where 1/r of the singular solution, the largest term for r ≪ R, cancels analytically in m.

use crate::reference::Annulus;
use crate::reference::exponential::Decay;
use crate::reference::local_series::{LocalSeries, Sign, rim_reach};
use crate::reference::oscillating::{Turn, Wave, rim_factor};
use crate::reference::small_wavenumber::{Pair, SMALL_BELOW};

/// ∂v/∂κ of the rim solution.
#[derive(Debug, Clone)]
pub(crate) struct RimResponse<const D: usize> {
    wavenumber: f64,
    outer_radius: f64,
    series: LocalSeries,
    series_from: f64,
    far: FarFromRim,
}

#[derive(Debug, Clone, Copy)]
enum FarFromRim {
    Small(Pair),
    Wave(Wave),
}

impl<const D: usize> RimResponse<D> {
    /// For the screened solution at `wavenumber` κ > 0.
    pub(crate) fn new(outer_radius: f64, wavenumber: f64) -> Self {
        let argument = wavenumber * outer_radius;
        let series = rim_series::<D>(Sign::Screened, outer_radius, wavenumber);
        let far = if argument < SMALL_BELOW {
            FarFromRim::Small(Pair::new::<D>(Sign::Screened, wavenumber, outer_radius, outer_radius))
        } else {
            FarFromRim::Wave(Wave::new::<D>(wavenumber, outer_radius))
        };
        RimResponse { wavenumber, outer_radius, series_from: series.end(), series, far }
    }

    /// ∂v/∂κ at `radius`; `value` is the rim solution there.
    pub(crate) fn at(&self, radius: f64, value: f64) -> f64 {
        if radius >= self.series_from {
            return self.series.response(self.wavenumber, radius);
        }
        match &self.far {
            FarFromRim::Small(rim) => {
                let here = Pair::new::<D>(Sign::Screened, self.wavenumber, self.outer_radius, radius);
                self.wavenumber * here.rim_solution_response::<D>(rim, self.outer_radius)
            }
            FarFromRim::Wave(rim) => {
                let here = Wave::new::<D>(self.wavenumber, radius);
                let turn = here.turn_to(self.wavenumber, rim);
                let height = rim_factor::<D>(self.wavenumber, self.outer_radius) * here.modulus * rim.modulus;
                let growth = here.growth + rim.growth - D as f64;
                (value * growth + height * turn.rate * turn.cosine) / self.wavenumber
            }
        }
    }
}

fn rim_series<const D: usize>(sign: Sign, outer_radius: f64, wavenumber: f64) -> LocalSeries {
    let argument = wavenumber * outer_radius;
    LocalSeries::with_response::<D>(sign, argument, outer_radius, rim_reach(argument), (0.0, -1.0))
}

/// The solution to differentiate: d/d_0, its slope at a, and its equation.
pub(crate) struct Profile<F: Fn(f64) -> f64> {
    pub sign: Sign,
    pub annulus: Annulus,
    pub wavenumber: f64,
    /// d(r)/d_0.
    pub ratio: F,
    /// d'(a)/d_0.
    pub inner_slope: f64,
}

/// ∂(d/d_0)/∂κ.
#[derive(Debug, Clone)]
pub(crate) struct Sensitivity<const D: usize> {
    annulus: Annulus,
    wavenumber: f64,
    /// f and h, and u, near a.
    profile: LocalSeries,
    rise: LocalSeries,
    near_inner_until: f64,
    /// ∂β/∂κ.
    slope_response: f64,
    /// v and ∂v/∂κ near R.
    rim: LocalSeries,
    near_rim_from: f64,
    /// Λ.
    inner_response: f64,
    between: Between,
}

#[derive(Debug, Clone, Copy)]
enum Between {
    Small { sign: Sign, inner: Pair, rim: Pair },
    Wave { inner: Wave, rim: Wave, across: Turn },
    Decay { inner: Decay, rim: Decay },
}

impl<const D: usize> Sensitivity<D> {
    /// For κ > 0 that is not a pole.
    pub(crate) fn new<F: Fn(f64) -> f64>(solution: &Profile<F>) -> Self {
        let (sign, annulus, wavenumber) = (solution.sign, solution.annulus, solution.wavenumber);
        let (inner_radius, outer_radius) = (annulus.inner_radius(), annulus.outer_radius());
        let argument = wavenumber * inner_radius;
        let reach = inner_reach(sign, argument);
        let profile = LocalSeries::with_response::<D>(sign, argument, inner_radius, reach, (1.0, solution.inner_slope));
        let rise = LocalSeries::new::<D>(sign, argument, inner_radius, reach, (0.0, 1.0));
        let rim = rim_series::<D>(sign, outer_radius, wavenumber);
        let between = if wavenumber * outer_radius < SMALL_BELOW {
            let [inner, rim] = [inner_radius, outer_radius].map(|r| Pair::new::<D>(sign, wavenumber, outer_radius, r));
            Between::Small { sign, inner, rim }
        } else if sign == Sign::Screened {
            let [inner, rim] = [inner_radius, outer_radius].map(|r| Wave::new::<D>(wavenumber, r));
            Between::Wave { inner, rim, across: inner.turn_to(wavenumber, &rim) }
        } else {
            let [inner, rim] = [inner_radius, outer_radius].map(|r| Decay::new::<D>(wavenumber, r));
            Between::Decay { inner, rim }
        };
        let mut sensitivity = Sensitivity {
            annulus,
            wavenumber,
            near_inner_until: profile.end().min(inner_radius + (outer_radius - inner_radius) / 3.0),
            profile,
            rise,
            slope_response: 0.0,
            near_rim_from: rim.end(),
            rim,
            inner_response: 0.0,
            between,
        };
        sensitivity.inner_response = sensitivity.rim_logarithm(&solution.ratio);
        let meeting = sensitivity.near_inner_until;
        let outside = sensitivity.outside(meeting, (solution.ratio)(meeting));
        let inside = sensitivity.profile.response(wavenumber, meeting);
        sensitivity.slope_response = (outside - inside) / sensitivity.rise.value(meeting);
        sensitivity
    }

    /// ∂(d/d_0)/∂κ at `radius`; `ratio` is d/d_0 there.
    pub(crate) fn at(&self, radius: f64, ratio: f64) -> f64 {
        if radius <= self.near_inner_until {
            let response = self.profile.response(self.wavenumber, radius);
            return self.rise.value(radius) * self.slope_response + response;
        }
        self.outside(radius, ratio)
    }

    /// Methods 2 and 3.
    fn outside(&self, radius: f64, ratio: f64) -> f64 {
        if radius >= self.annulus.outer_radius() {
            return 0.0;
        }
        if radius >= self.near_rim_from {
            return ratio * (self.near_rim_logarithm(radius) - self.inner_response);
        }
        self.between(radius, ratio)
    }

    /// ∂ ln v/∂κ near the rim.
    fn near_rim_logarithm(&self, radius: f64) -> f64 {
        self.rim.response(self.wavenumber, radius) / self.rim.value(radius)
    }

    /// Λ.
    fn rim_logarithm(&self, ratio: &impl Fn(f64) -> f64) -> f64 {
        let (inner_radius, meeting) = (self.annulus.inner_radius(), self.near_rim_from);
        if inner_radius >= meeting {
            return self.near_rim_logarithm(inner_radius);
        }
        if let Between::Small { inner, rim, .. } = &self.between {
            let outer_radius = self.annulus.outer_radius();
            let response = inner.rim_solution_response::<D>(rim, outer_radius);
            return self.wavenumber * response / inner.rim_solution::<D>(rim, outer_radius);
        }
        // Far from a the antiscreened d/d_0 may underflow, but not its logarithm.
        let between = match &self.between {
            Between::Decay { inner, rim } => self.decay_logarithm(inner, rim, meeting),
            _ => self.between(meeting, ratio(meeting)) / ratio(meeting),
        };
        self.near_rim_logarithm(meeting) - between
    }

    fn between(&self, radius: f64, ratio: f64) -> f64 {
        let wavenumber = self.wavenumber;
        match &self.between {
            Between::Small { sign, inner, rim } => {
                let here = Pair::new::<D>(*sign, wavenumber, self.annulus.outer_radius(), radius);
                wavenumber * here.profile_response(inner, rim)
            }
            Between::Wave { inner, rim, across } => {
                let here = Wave::new::<D>(wavenumber, radius);
                let (from_inner, to_rim) = (inner.turn_to(wavenumber, &here), here.turn_to(wavenumber, rim));
                // The same number in two forms, each accurate at its end.
                let swing = if from_inner.rate < to_rim.rate {
                    across.rate * from_inner.sine - from_inner.rate * to_rim.cosine * across.sine
                } else {
                    to_rim.rate * to_rim.cosine * across.sine - across.rate * across.cosine * to_rim.sine
                };
                let height = here.modulus / inner.modulus / across.sine;
                ((here.growth - inner.growth) * ratio + height * (swing / across.sine)) / wavenumber
            }
            Between::Decay { inner, rim } => ratio * self.decay_logarithm(inner, rim, radius),
        }
    }

    /// ∂ ln(d/d_0)/∂κ of the antiscreened profile between the series.
    fn decay_logarithm(&self, inner: &Decay, rim: &Decay, radius: f64) -> f64 {
        let here = Decay::new::<D>(self.wavenumber, radius);
        let reflections = inner.reflection(self.wavenumber, rim) - here.reflection(self.wavenumber, rim);
        (reflections - inner.decline_to(self.wavenumber, &here)) / self.wavenumber
    }
}

/// Range of the series near a in ln(r/a): to 2a, and at most one radian, or half a decay length.
fn inner_reach(sign: Sign, argument: f64) -> f64 {
    let distance = match sign {
        Sign::Screened => 1.0,
        Sign::Antiscreened => 0.5,
    };
    libm::log1p(distance / argument).min(std::f64::consts::LN_2)
}
