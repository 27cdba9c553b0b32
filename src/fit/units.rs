//! The units of a fit: powers of two near the lengths and displacements of the profile. So squares neither overflow nor
//! underflow in any units of the profile, and the conversion is exact.

use crate::fit::dimension::Dimension;
use crate::fit::profile_fit::{ElasticFit, ProfileFit, ScreenedFit};
use crate::fit::{Estimate, FitError};
use crate::observe::radial_profile::Ring;
use crate::reference::{Annulus, ReferenceError};

/// Displacements below this share of their errors count as zero: their squares would vanish beside those of the errors.
const LEAST_DISPLACEMENT: f64 = 1e-100;

/// Above this, d_0^eff, which is larger by up to (R/a)^(D−1), might overflow \[length\].
const LARGEST_DISPLACEMENT: f64 = 1e200;

/// Units of length and of displacement \[length\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Units {
    length: f64,
    displacement: f64,
}

/// 2^k with `2^k ≤ value < 2^(k+1)`, for a positive normal number.
fn power_of_two(value: f64) -> f64 {
    f64::from_bits(value.to_bits() & (0x7ff << 52))
}

impl Units {
    /// The units of the rings of an annulus with `from` ≤ r ≤ `to`.
    ///
    /// # Errors
    /// A ring with invalid numbers; displacements that are negligible compared with the errors.
    pub(crate) fn of(rings: &[Ring], annulus: Annulus, [from, to]: [f64; 2]) -> Result<Self, FitError> {
        for (index, ring) in rings.iter().enumerate() {
            let usable = ring.radius > 0.0
                && ring.radius.is_finite()
                && ring.mean.abs() <= LARGEST_DISPLACEMENT
                && (0.0..=LARGEST_DISPLACEMENT).contains(&ring.standard_error)
                && ring.disk_count > 0;
            if !usable {
                return Err(FitError::RingUnusable {
                    ring: index,
                    radius: ring.radius,
                    mean: ring.mean,
                    standard_error: ring.standard_error,
                    disk_count: ring.disk_count,
                });
            }
        }
        let used = || rings.iter().filter(|ring| from <= ring.radius && ring.radius <= to);
        let mean = used().fold(0.0, |most: f64, ring| most.max(ring.mean.abs()));
        let error = used().fold(0.0, |most: f64, ring| most.max(ring.standard_error));
        if mean < LEAST_DISPLACEMENT * error {
            return Err(FitError::NoDisplacement { ring_count: used().count() });
        }
        let displacement = power_of_two(mean.max(error).max(f64::MIN_POSITIVE));
        Ok(Units { length: power_of_two(annulus.outer_radius().max(f64::MIN_POSITIVE)), displacement })
    }

    /// Converts rings to these units.
    pub(crate) fn rings(&self, rings: &[Ring]) -> Vec<Ring> {
        let scaled = |ring: &Ring| Ring {
            radius: ring.radius / self.length,
            mean: ring.mean / self.displacement,
            spread: ring.spread / self.displacement,
            standard_error: ring.standard_error / self.displacement,
            ..*ring
        };
        rings.iter().map(scaled).collect()
    }

    /// Converts the annulus to these units; an error if a radius is out of range there.
    pub(crate) fn annulus(&self, annulus: Annulus) -> Result<Annulus, ReferenceError> {
        Annulus::new(annulus.inner_radius() / self.length, annulus.outer_radius() / self.length)
    }

    /// Converts an error from these units to those of the caller.
    pub(crate) fn error(&self, error: FitError) -> FitError {
        match error {
            FitError::TooFewRings { ring_count, needed, from, to } => {
                FitError::TooFewRings { ring_count, needed, from: from * self.length, to: to * self.length }
            }
            other => other,
        }
    }

    /// Converts a fit from these units to those of the caller. χ² has units only if the rings have no errors.
    pub(crate) fn fit(&self, fit: ProfileFit, dimension: Dimension, errors_known: bool) -> ProfileFit {
        let estimate = |value: Estimate, unit: f64| Estimate {
            value: value.value * unit,
            standard_error: value.standard_error * unit,
        };
        let square = if errors_known { 1.0 } else { (dimension.rescaling(self.length) * self.displacement).powi(2) };
        ProfileFit {
            elastic: ElasticFit {
                amplitude: estimate(fit.elastic.amplitude, self.displacement),
                wavenumber_bound: fit.elastic.wavenumber_bound.map(|bound| bound / self.length),
                chi_squared: fit.elastic.chi_squared * square,
                ..fit.elastic
            },
            screened: fit.screened.map(|screened| ScreenedFit {
                amplitude: estimate(screened.amplitude, self.displacement),
                wavenumber: estimate(screened.wavenumber, 1.0 / self.length),
                chi_squared: screened.chi_squared * square,
                ..screened
            }),
            range: fit.range.map(|radius| radius * self.length),
            largest_wavenumber: fit.largest_wavenumber / self.length,
            ..fit
        }
    }
}
