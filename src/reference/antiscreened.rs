//! [`Antiscreened`]: a medium on an elastic foundation.

use std::sync::OnceLock;

use crate::reference::bessel::{modified, spherical};
use crate::reference::elastic::Elastic;
use crate::reference::local_series::{LocalSeries, Sign, rim_reach};
use crate::reference::rim::{ELASTIC_BELOW, checked_wavenumber};
use crate::reference::rim_distance::RimDistance;
use crate::reference::sensitivity::{Profile, Sensitivity};
use crate::reference::{Annulus, RadialSolution, ReferenceError};

/// Radial displacement of a medium on an elastic foundation: the screened equation with the opposite sign of κ².
///
/// ```text
/// d'' + (D−1) d'/r − (D−1) d/r² − κ² d = 0        d(a) = d_0,  d(R) = 0
///
/// D = 2:  d(r) = d_0 [K_1(κr) I_1(κR) − I_1(κr) K_1(κR)] / [K_1(κa) I_1(κR) − I_1(κa) K_1(κR)]
/// D = 3:  the same with the spherical i_1 and k_1
/// ```
///
/// It describes a lattice whose disks are each held by a spring, of positive stiffness Γ per area: κ² = Γ/(λ+2μ). It
/// has no poles. The displacement falls monotonically, as e^(−κr) far from both ends, and may underflow to 0. κ = 0 is
/// exactly elastic, and so is κR ≤ 10⁻⁸ ([`ELASTIC_BELOW`]).
///
/// # Units
/// Radii and displacement in lengths, κ in 1/length.
///
/// # Source
/// The equation: springs of stiffness Γ per area exert a force −Γd, so the balance of a radial, curl-free field is
/// (λ+2μ) ∇(∇·u) − Γu = 0. Its solutions: Abramowitz & Stegun (1964), 9.6.1 (with ν = 1) and 10.2.1 (with n = 1).
///
/// # Accuracy
/// Relative error of d and d' below 3.2·10⁻¹⁵ (largest found: 1.9·10⁻¹⁵), for R/a from 1.001 to 10⁷ and κR from 10⁻⁸ to
/// 10⁶, if they exceed 10⁻²⁹⁰; d(a) = d_0 and d(R) = 0 exactly
/// (`reference::antiscreened::antiscreened_profiles_and_both_derivatives_have_their_digits_in_two_dimensions` and the
/// same in three).
///
/// # Cost
/// See `cargo bench --features measurements --bench reference -- antiscreened`.
///
/// # Example
/// ```
/// use jamscope::reference::{Annulus, RadialSolution, antiscreened::Antiscreened};
/// let annulus = Annulus::new(0.5, 30.0)?;
/// let medium = Antiscreened::<2>::new(annulus, 0.1, 0.2)?;
/// assert_eq!((medium.value(0.5), medium.value(30.0)), (0.1, 0.0));
/// // A stiffer foundation gives a smaller displacement.
/// let stiffer = Antiscreened::<2>::new(annulus, 0.1, 0.4)?;
/// assert!(stiffer.value(5.0) < medium.value(5.0) && medium.wavenumber_derivative(5.0) < 0.0);
/// // κR = 10⁶: nothing overflows.
/// let stiff = Antiscreened::<2>::new(annulus, 0.1, 1e6 / 30.0)?;
/// assert!((stiff.value(0.5 + 1e-5) / 0.1 - (-1e6 / 30.0 * 1e-5_f64).exp()).abs() < 1e-4);
/// # Ok::<(), jamscope::reference::ReferenceError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Antiscreened<const D: usize> {
    annulus: Annulus,
    amplitude: f64,
    wavenumber: f64,
    form: Form<D>,
    sensitivity: OnceLock<Box<Sensitivity<D>>>,
}

#[derive(Debug, Clone)]
enum Form<const D: usize> {
    Elastic(Elastic<D>),
    Decaying {
        rim: DecayingRim<D>,
        /// `e^(−κ(R−a)) v(a)`.
        inner_value: f64,
    },
}

impl<const D: usize> Antiscreened<D> {
    /// The medium in `annulus` whose inner edge is displaced by `amplitude` d_0 \[length\], at `wavenumber` κ ≥ 0.
    ///
    /// # Errors
    /// An amplitude that is not finite; a wavenumber that is negative or not finite.
    pub fn new(annulus: Annulus, amplitude: f64, wavenumber: f64) -> Result<Self, ReferenceError> {
        let elastic = Elastic::new(annulus, amplitude)?;
        let argument = checked_wavenumber(annulus, wavenumber)?;
        let form = if argument <= ELASTIC_BELOW {
            Form::Elastic(elastic)
        } else {
            let rim = DecayingRim::new(wavenumber, annulus.outer_radius());
            let inner_value = rim.value(annulus.inner_radius());
            Form::Decaying { rim, inner_value }
        };
        Ok(Antiscreened { annulus, amplitude, wavenumber, form, sensitivity: OnceLock::new() })
    }

    /// Displacement d_0 of the inner edge \[length\].
    pub fn amplitude(&self) -> f64 {
        self.amplitude
    }

    /// Wavenumber κ of the foundation \[1/length\].
    pub fn wavenumber(&self) -> f64 {
        self.wavenumber
    }

    /// ∂d/∂κ \[length²\] at `radius` \[length\], NaN outside the annulus: 0 at a and R and at κ = 0, otherwise −κ times
    /// a positive number.
    ///
    /// # Accuracy
    /// Relative error below 3.2·10⁻¹⁵, in the range and by the tests of the profile. Nothing oscillates, so no digits
    /// are lost, also for κ → 0, r → a and r → R.
    pub fn wavenumber_derivative(&self, radius: f64) -> f64 {
        if !self.annulus.contains(radius) {
            return f64::NAN;
        }
        if self.wavenumber == 0.0 {
            return 0.0;
        }
        let sensitivity = self.sensitivity.get_or_init(|| {
            let inner_slope = self.relative_derivative(self.annulus.inner_radius());
            Box::new(Sensitivity::new(&Profile {
                sign: Sign::Antiscreened,
                annulus: self.annulus,
                wavenumber: self.wavenumber,
                ratio: |radius| self.relative(radius),
                inner_slope,
            }))
        });
        self.amplitude * sensitivity.at(radius, self.relative(radius))
    }

    /// d/d_0.
    fn relative(&self, radius: f64) -> f64 {
        match &self.form {
            Form::Elastic(elastic) => elastic.relative(radius),
            Form::Decaying { rim, inner_value } => rim.value(radius) / inner_value * self.decay(radius),
        }
    }

    /// d'/d_0.
    fn relative_derivative(&self, radius: f64) -> f64 {
        match &self.form {
            Form::Elastic(elastic) => elastic.relative_derivative(radius),
            Form::Decaying { rim, inner_value } => rim.derivative(radius) / inner_value * self.decay(radius),
        }
    }

    /// e^(−κ(r−a)), 1 at a.
    fn decay(&self, radius: f64) -> f64 {
        RimDistance::new(self.wavenumber, radius, self.annulus.inner_radius()).decay()
    }
}

impl<const D: usize> RadialSolution for Antiscreened<D> {
    fn value(&self, radius: f64) -> f64 {
        if !self.annulus.contains(radius) {
            return f64::NAN;
        }
        self.amplitude * self.relative(radius)
    }

    fn derivative(&self, radius: f64) -> f64 {
        if !self.annulus.contains(radius) {
            return f64::NAN;
        }
        self.amplitude * self.relative_derivative(radius)
    }
}

/// The solution with slope −1 at the rim, divided by its growth e^δ inwards, δ = κ(R − r).
///
/// ```text
/// D = 2:  v = R [K_1(x) I_1(y) − I_1(x) K_1(y)]
/// D = 3:  v = [x y sinh δ + δ² i_1(δ)]/(κ x²)
/// ```
///
/// In two dimensions near the rim, where the two products are nearly equal, v is a power series ([`LocalSeries`]).
/// Elsewhere the second product is less than a seventh of the first.
#[derive(Debug, Clone)]
struct DecayingRim<const D: usize> {
    wavenumber: f64,
    outer_radius: f64,
    /// `e^(−y) I_1(y)` and `e^y K_1(y)` at y = κR (two dimensions).
    rim_values: (f64, f64),
    series: LocalSeries,
    /// The radius at which the series ends; above R in three dimensions, where it is not needed.
    series_from: f64,
}

impl<const D: usize> DecayingRim<D> {
    fn new(wavenumber: f64, outer_radius: f64) -> Self {
        let argument = wavenumber * outer_radius;
        let series =
            LocalSeries::new::<D>(Sign::Antiscreened, argument, outer_radius, rim_reach(argument), (0.0, -1.0));
        DecayingRim {
            wavenumber,
            outer_radius,
            rim_values: (modified::i1_scaled(argument), modified::k1_scaled(argument)),
            series_from: if D == 2 { series.end() } else { f64::INFINITY },
            series,
        }
    }

    /// `e^(−δ) v`.
    fn value(&self, radius: f64) -> f64 {
        let distance = RimDistance::new(self.wavenumber, self.outer_radius, radius);
        if radius >= self.series_from {
            return self.series.value(radius) * distance.decay();
        }
        let x = self.wavenumber * radius;
        if D == 2 {
            return self.bracket(modified::k1_scaled(x), -modified::i1_scaled(x), distance);
        }
        let delta = distance.value();
        let rest = delta * delta * spherical::i1_scaled(delta);
        // Two divisions by x: x² would underflow long before x does.
        (self.wavenumber * self.outer_radius * half_sine(delta) / x + rest / x / x) / self.wavenumber
    }

    /// `e^(−δ) v'`.
    fn derivative(&self, radius: f64) -> f64 {
        let distance = RimDistance::new(self.wavenumber, self.outer_radius, radius);
        if radius >= self.series_from {
            return self.series.derivative(radius) * distance.decay();
        }
        let x = self.wavenumber * radius;
        let rest = (D as f64 - 1.0) * self.value(radius) / radius;
        if D == 2 {
            // K_1' = −K_0 − K_1/x, I_1' = I_0 − I_1/x.
            return -self.wavenumber * self.bracket(modified::k0_scaled(x), modified::i0_scaled(x), distance) - rest;
        }
        // v' = (sinh δ − y cosh δ)/x − 2 v/r.
        let delta = distance.value();
        let half_cosine = 0.5 * (1.0 + libm::exp(-2.0 * delta));
        half_sine(delta) / x - self.outer_radius / radius * half_cosine - rest
    }

    /// `R [k I_1(y) + i K_1(y)]`, divided by e^δ.
    fn bracket(&self, k: f64, i: f64, distance: RimDistance) -> f64 {
        let decay = distance.decay();
        self.outer_radius * (k * self.rim_values.0 + i * self.rim_values.1 * decay * decay)
    }
}

/// e^(−δ) sinh δ.
fn half_sine(delta: f64) -> f64 {
    -0.5 * libm::expm1(-2.0 * delta)
}
