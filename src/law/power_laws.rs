//! The common contact laws: Hertzian, Hookean, and the dimensionless power law.
//!
//! Every law here is a power of the overlap δ, with a coefficient c that depends on the two radii alone:
//!
//! ```text
//! F(δ) = c δ^(α−1)      u(δ) = F δ / α      F'(δ) = (α − 1) F / δ      for δ > 0, all 0 otherwise
//! ```
//!
//! | law | α | c |
//! |---|---|---|
//! | [`Hertzian`] | 5/2 | k' √R_ij, R_ij = R_i R_j / (R_i + R_j) |
//! | [`Hookean`] | 2 | k' |
//! | [`PowerLaw`] | any ≥ 2 | ε / σ_ij^α, σ_ij = R_i + R_j |

use pulp::{Simd, WithSimd};
use serde::{Deserialize, Serialize};

use crate::law::damping::{ContactDamping, MassDamping, ViscoelasticDamping, effective_radius};
use crate::law::pair_law::{PairLaw, combine};
use crate::processor::{self, Processor};
use crate::simd::roots::square_roots;

/// Hertzian contact.
///
/// ```text
/// F = k' √(δ R_ij) δ        u = (2/5) F δ        R_ij = R_i R_j / (R_i + R_j)
/// ```
///
/// # Source
/// Johnson, Contact Mechanics (1985), §4.2; in this form LAMMPS `pair_style gran/hertz`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hertzian {
    /// Stiffness constant k' \[force / length²\].
    pub stiffness: f64,
}

/// Hookean contact, `F = k' δ`, `u = k' δ² / 2`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hookean {
    /// Stiffness constant k' \[force / length\].
    pub stiffness: f64,
}

/// The dimensionless power law, `u = (ε/α) (1 − r/σ_ij)^α` with `σ_ij = R_i + R_j`.
///
/// α = 2 is the harmonic law and α = 5/2 the "Hertzian" one of much of the jamming literature; neither equals
/// [`Hookean`] or [`Hertzian`], whose coefficients depend on the radii in another way.
///
/// # Source
/// O'Hern, Silbert, Liu, Nagel (2003), Phys. Rev. E 68, 011306.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PowerLaw {
    /// Energy scale ε \[energy\].
    pub energy_scale: f64,
    /// Exponent α ≥ 2 \[1\].
    pub exponent: f64,
}

/// Default stiffness k' of both laws in the units of the model. Source: the published study, k' = 2·10⁵.
pub const MODEL_STIFFNESS: f64 = 2e5;

impl Default for Hertzian {
    fn default() -> Self {
        Hertzian { stiffness: MODEL_STIFFNESS }
    }
}

impl Default for Hookean {
    fn default() -> Self {
        Hookean { stiffness: MODEL_STIFFNESS }
    }
}

impl PairLaw for Hertzian {
    fn is_power(&self) -> bool {
        true
    }

    fn viscoelastic(&self, rate: f64) -> ContactDamping {
        ContactDamping::Viscoelastic(ViscoelasticDamping { rate })
    }
    #[inline(always)]
    fn coefficient(&self, first_radius: f64, second_radius: f64) -> f64 {
        self.stiffness * effective_radius(first_radius, second_radius).sqrt()
    }
    #[inline(always)]
    fn coefficient_growth(&self, first_radius: f64, second_radius: f64) -> f64 {
        // ln c = (ln R_i + ln R_j − ln(R_i + R_j))/2 + constant.
        0.5 * second_radius / (first_radius * (first_radius + second_radius))
    }
    #[inline(always)]
    fn force(&self, coefficient: f64, overlap: f64) -> f64 {
        coefficient * overlap * overlap.sqrt()
    }
    fn forces(&self, coefficients: &[f64], overlaps: &[f64], forces: &mut [f64]) {
        processor::dispatch(HertzianForces { coefficients, overlaps, forces });
    }
    fn forces_in_single(&self, coefficients: &[f32], overlaps: &[f32], forces: &mut [f32]) {
        processor::dispatch(SingleHertzianForces { coefficients, overlaps, forces });
    }
    #[inline(always)]
    fn exponent(&self) -> f64 {
        2.5
    }
}

impl PairLaw for Hookean {
    fn is_power(&self) -> bool {
        true
    }
    fn has_one_coefficient(&self) -> bool {
        true
    }

    fn viscoelastic(&self, rate: f64) -> ContactDamping {
        ContactDamping::Mass(MassDamping { rate })
    }
    #[inline(always)]
    fn coefficient(&self, _first_radius: f64, _second_radius: f64) -> f64 {
        self.stiffness
    }
    #[inline(always)]
    fn coefficient_growth(&self, _first_radius: f64, _second_radius: f64) -> f64 {
        0.0
    }
    #[inline(always)]
    fn force(&self, _coefficient: f64, overlap: f64) -> f64 {
        // The same for every pair, so the loop need not load it.
        self.stiffness * overlap
    }
    fn forces_in_single(&self, coefficients: &[f32], overlaps: &[f32], forces: &mut [f32]) {
        // The same for every pair, so the column is not read.
        let coefficient = coefficients.first().copied().unwrap_or_default();
        combine([overlaps, overlaps], forces, |overlap, _| coefficient * overlap);
    }
    #[inline(always)]
    fn exponent(&self) -> f64 {
        2.0
    }
}

impl PairLaw for PowerLaw {
    fn is_power(&self) -> bool {
        true
    }

    fn viscoelastic(&self, rate: f64) -> ContactDamping {
        ContactDamping::Mass(MassDamping { rate })
    }
    #[inline(always)]
    fn coefficient(&self, first_radius: f64, second_radius: f64) -> f64 {
        self.energy_scale * libm::pow(first_radius + second_radius, -self.exponent)
    }
    #[inline(always)]
    fn coefficient_growth(&self, first_radius: f64, second_radius: f64) -> f64 {
        -self.exponent / (first_radius + second_radius)
    }
    #[inline(always)]
    fn force(&self, coefficient: f64, overlap: f64) -> f64 {
        coefficient * libm::pow(overlap, self.exponent - 1.0)
    }
    #[inline(always)]
    fn exponent(&self) -> f64 {
        self.exponent
    }
}

/// c δ √δ for two vectors of pairs at a time, one pair per lane, with the bits of [`Hertzian::force`].
struct HertzianForces<'a> {
    coefficients: &'a [f64],
    overlaps: &'a [f64],
    forces: &'a mut [f64],
}

impl WithSimd for HertzianForces<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let whole = self.forces.len() / (2 * S::F64_LANES) * 2 * S::F64_LANES;
        let (coefficients, last_coefficients) = self.coefficients.split_at(whole);
        let (overlaps, last_overlaps) = self.overlaps.split_at(whole);
        let (forces, last_forces) = self.forces.split_at_mut(whole);
        let forces = S::as_mut_simd_f64s(forces).0.as_chunks_mut::<2>().0;
        let count = forces.len();
        let coefficients = &S::as_simd_f64s(coefficients).0.as_chunks::<2>().0[..count];
        let overlaps = &S::as_simd_f64s(overlaps).0.as_chunks::<2>().0[..count];
        let roots = Processor::here().roots();
        for k in 0..count {
            let ([c, d], [a, b]) = (coefficients[k], overlaps[k]);
            let [a_root, b_root] = square_roots(simd, roots, [a, b]);
            forces[k] = [simd.mul_f64s(simd.mul_f64s(c, a), a_root), simd.mul_f64s(simd.mul_f64s(d, b), b_root)];
        }
        let count = last_forces.len();
        let (coefficients, overlaps) = (&last_coefficients[..count], &last_overlaps[..count]);
        for k in 0..count {
            last_forces[k] = coefficients[k] * overlaps[k] * overlaps[k].sqrt();
        }
    }
}

/// The same in single precision, one vector at a time.
struct SingleHertzianForces<'a> {
    coefficients: &'a [f32],
    overlaps: &'a [f32],
    forces: &'a mut [f32],
}

impl WithSimd for SingleHertzianForces<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let (coefficients, last_coefficients) = S::as_simd_f32s(self.coefficients);
        let (overlaps, last_overlaps) = S::as_simd_f32s(self.overlaps);
        let (forces, last_forces) = S::as_mut_simd_f32s(self.forces);
        let count = forces.len();
        let (coefficients, overlaps) = (&coefficients[..count], &overlaps[..count]);
        for k in 0..count {
            forces[k] = simd.mul_f32s(simd.mul_f32s(coefficients[k], overlaps[k]), simd.sqrt_f32s(overlaps[k]));
        }
        let count = last_forces.len();
        let (coefficients, overlaps) = (&last_coefficients[..count], &last_overlaps[..count]);
        for k in 0..count {
            last_forces[k] = coefficients[k] * overlaps[k] * overlaps[k].sqrt();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::choice::LawChoice;
    use crate::law::on_site::OnSite;
    use crate::law::pair_law::ShareLaw;

    fn check_law(law: &dyn PairLaw) {
        let coefficient = law.coefficient(0.5, 0.7);
        assert_eq!(law.force(coefficient, 0.0), 0.0);
        assert!(law.force(coefficient, f64::NAN).is_nan());
        for overlap in [1e-3, 0.05, 0.3] {
            let energy = |x: f64| law.energy(law.force(coefficient, x), x);
            let h = 1e-5 * overlap;
            let slope = (energy(overlap + h) - energy(overlap - h)) / (2.0 * h);
            let force = law.force(coefficient, overlap);
            // Central difference: truncation (h/δ)² ≈ 1e-10, rounding ε/(h/δ) ≈ 2e-11; a few of each.
            assert!((slope / force - 1.0).abs() < 1e-9, "{law:?} force at {overlap}");
            let slope = (law.force(coefficient, overlap + h) - law.force(coefficient, overlap - h)) / (2.0 * h);
            assert!((slope / law.stiffness(force, overlap) - 1.0).abs() < 1e-9, "{law:?} stiffness at {overlap}");
        }
        let h = 1e-5;
        let slope = (law.coefficient(0.5 + h, 0.7) - law.coefficient(0.5 - h, 0.7)) / (2.0 * h);
        // Truncation h² times a third derivative below 10² of c, rounding ε/h = 2e-11.
        assert!((slope / coefficient - law.coefficient_growth(0.5, 0.7)).abs() < 1e-8, "{law:?} growth");
    }

    #[test]
    fn force_and_stiffness_are_derivatives() {
        check_law(&Hertzian::default());
        check_law(&Hookean::default());
        check_law(&PowerLaw { energy_scale: 3.0, exponent: 2.0 });
        check_law(&PowerLaw { energy_scale: 3.0, exponent: 3.7 });
    }

    fn check_columns(law: &dyn PairLaw) {
        let some = [0.0, 1e-20, 1e-9, 3e-3, 0.01, 0.1, 0.3, f64::NAN];
        // Two pairs of vectors of eight, and a rest.
        let overlaps: [f64; 37] = std::array::from_fn(|pair| some[(pair + pair / 8) % 8]);
        let coefficients: [f64; 37] = std::array::from_fn(|pair| law.coefficient(0.3 + 0.1 * pair as f64, 0.5));
        for processor in Processor::all() {
            let mut found = [0.0; 37];
            processor.run(|| law.forces(&coefficients, &overlaps, &mut found));
            for ((force, coefficient), overlap) in found.iter().zip(coefficients).zip(overlaps) {
                let alone = law.force(coefficient, overlap);
                let same = force.to_bits() == alone.to_bits() || overlap.is_nan() && force.is_nan();
                assert!(same, "{law:?} at {overlap}, {processor:?}");
            }
            let [mut energies, mut stiffnesses] = [[0.0; 37]; 2];
            processor.run(|| law.energies(&found, &overlaps, &mut energies));
            processor.run(|| law.stiffnesses(&found, &overlaps, &mut stiffnesses));
            for (pair, (force, overlap)) in found.into_iter().zip(overlaps).enumerate() {
                let alone = [law.energy(force, overlap), law.stiffness(force, overlap)];
                for (of_column, alone) in [energies[pair], stiffnesses[pair]].into_iter().zip(alone) {
                    assert!(of_column.to_bits() == alone.to_bits() || of_column.is_nan() && alone.is_nan());
                }
            }
        }
    }

    #[test]
    fn the_forces_of_a_column_are_those_of_its_pairs() {
        check_columns(&Hertzian::default());
        check_columns(&Hookean::default());
        check_columns(&PowerLaw { energy_scale: 3.0, exponent: 2.5 });
        check_columns(&LawChoice::default());
        check_columns(&LawChoice::Hookean(Hookean::default()));
        check_columns(&OnSite { law: LawChoice::default().shared(), coupling: -0.5 });
    }

    #[test]
    fn forces_in_single_precision_are_the_power_of_the_overlap() {
        fn check(law: &dyn PairLaw) {
            let some = [0.0, 1e-12, 1e-9, 3e-3, 0.01, 0.1, 0.3, f32::NAN];
            let overlaps: [f32; 37] = std::array::from_fn(|pair| some[(pair + pair / 8) % 8]);
            let differing = if law.has_one_coefficient() { 0.0 } else { 0.1 };
            let coefficients: [f32; 37] = std::array::from_fn(|pair| 0.3 + differing * pair as f32);
            let [mut found, mut again] = [[0.0; 37]; 2];
            law.forces_in_single(&coefficients, &overlaps, &mut found);
            for processor in Processor::all() {
                processor.run(|| law.forces_in_single(&coefficients, &overlaps, &mut again));
                let bits = |forces: &[f32]| forces.iter().map(|force| force.to_bits()).collect::<Vec<_>>();
                assert_eq!(bits(&again), bits(&found), "{law:?}, {processor:?}");
            }
            for ((force, c), overlap) in found.into_iter().zip(coefficients).zip(overlaps) {
                let expected = f64::from(c) * f64::from(overlap).powf(law.exponent() - 1.0);
                // Two products and a root, half a unit each.
                let near = (f64::from(force) - expected).abs() <= 3.0 * 0.5 * f64::from(f32::EPSILON) * expected;
                assert!(near || overlap.is_nan() && force.is_nan(), "{law:?} at {overlap}: {force}");
            }
        }
        check(&Hertzian::default());
        check(&Hookean::default());
        check(&PowerLaw { energy_scale: 3.0, exponent: 2.7 });
    }

    #[test]
    fn the_power_law_is_the_formula_of_its_source() {
        // r = 1.1, σ = 1.2, α = 5/2, ε = 1: u = 0.4 (1 − r/σ)^2.5, to rounding times the powers taken.
        let law = PowerLaw { energy_scale: 1.0, exponent: 2.5 };
        let overlap = 0.1;
        let energy = law.energy(law.force(law.coefficient(0.5, 0.7), overlap), overlap);
        assert!((energy / (0.4 * (overlap / 1.2f64).powf(2.5)) - 1.0).abs() < 1e-14);
    }
}
