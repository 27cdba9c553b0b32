//! Whether radii and pressures of a scene can be resolved above rounding: [`Scene::check_scales`].
//!
//! A relaxation whose result is below rounding does not fail; it runs to its step limit. Such a scene is therefore
//! refused.

use crate::law::choice::LawChoice;
use crate::law::pair_law::PairLaw;
use crate::scene::SceneError;
use crate::scene::definition::Scene;
use crate::scene::source::Source;
use crate::vector::larger;

/// Largest ratio of two radii. Contact forces scale as the square of radii. Beyond this ratio those of small disks are
/// below the rounding, 10⁻¹⁶, of those of large ones, and residuals do not show whether small disks are at rest.
const LARGEST_RADIUS_RATIO: f64 = 1e8;

/// Smallest overlap over the radius for a target pressure. Distances are known to 10⁻¹⁶ of a radius, so four digits of
/// the overlap remain, as the tolerance of a pressure requires.
const LEAST_OVERLAP: f64 = 1e-12;

impl Scene {
    /// Checks that radii do not differ too much, and that the overlaps at the pressures are above rounding.
    pub(super) fn check_scales(&self) -> Result<(), SceneError> {
        let radii = || self.mixture.components.iter().map(|component| component.radius);
        let (smallest, largest) = (radii().fold(f64::INFINITY, f64::min), radii().fold(0.0, larger));
        if largest / smallest > LARGEST_RADIUS_RATIO {
            return Err(SceneError::RadiiTooFarApart { smallest, largest, limit: LARGEST_RADIUS_RATIO });
        }
        for sample in &self.sample {
            let Source::Pressure(pressure) = sample.source else { continue };
            let overlap = relative_overlap(&self.law, largest, pressure);
            if overlap < LEAST_OVERLAP {
                let (name, limit) = (sample.name.clone(), LEAST_OVERLAP);
                return Err(SceneError::PressureBelowRounding { name, pressure, overlap, radius: largest, limit });
            }
        }
        Ok(())
    }
}

/// δ/R of disks of radius R at a pressure, up to a factor of order one: p 2R = F(R) (δ/R)^(α−1).
fn relative_overlap(law: &LawChoice, radius: f64, pressure: f64) -> f64 {
    libm::pow(2.0 * pressure / law.force_scale(radius) * radius, 1.0 / (law.exponent() - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::packing::{Component, Mixture};

    /// The built-in scene with these radii and this pressure.
    fn scene(radii: &[f64], pressure: f64) -> Scene {
        let components = radii.iter().map(|&radius| Component { radius, share: 1.0 }).collect();
        let mut scene = Scene { mixture: Mixture { components }, ..Scene::default() };
        scene.sample.truncate(1);
        scene.sample[0].source = Source::Pressure(pressure);
        scene
    }

    #[test]
    fn radii_and_pressures_below_rounding_are_refused() {
        assert_eq!(scene(&[0.5, 0.7], 1e-4).check(), Ok(()));
        assert_eq!(scene(&[0.5, 500.0], 10.0).check(), Ok(()));
        let apart = scene(&[0.5, 1e15], 10.0).check().expect_err("2·10¹⁵ apart").to_string();
        assert!(apart.contains("mixture") && apart.contains("1e15") && apart.contains("1e8"), "{apart}");
        // p 2R/F(R) = 2·10/(2·10⁵ √(1/2) 10¹⁵) = 1.4·10⁻¹⁹, to the power of 2/3: 2.7·10⁻¹³.
        let below = scene(&[1e15], 10.0).check().expect_err("overlaps below rounding").to_string();
        assert!(below.contains("source.pressure = 10") && below.contains("2.7e-13"), "{below}");
        // The same packing with another unit of pressure.
        assert_eq!(scene(&[1e15], 1e9).check(), Ok(()));
    }
}
