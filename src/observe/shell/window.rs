//! [`ShellWindow`]: the expected power of sums over irregular directions, for a given spectrum.
//!
//! Let d_r be an isotropic random field with ⟨d_r d_r'⟩ = Σ_g (2g+1) S_g P_g(n·n'), plus independent values of single
//! spheres with variance ρ. The expected power P_ℓ = n⁻² Σ_ij δ_i δ_j P_ℓ(n_i·n_j), δ = d_r − ⟨d_r⟩, is
//!
//! ```text
//! ⟨P_ℓ⟩ = Σ_g K_ℓg S_g + ρ N_ℓ                 b_ℓ(i) = n⁻¹ Σ_j P_ℓ(n_i·n_j),  B_ℓ = n⁻¹ Σ_i b_ℓ(i)
//! K_ℓg = (2g+1) [Σ_k (2k+1) (ℓ g k; 0 0 0)² B_k − 2 n⁻¹ Σ_i b_ℓ(i) b_g(i) + B_ℓ B_g]       N_ℓ = (1 − B_ℓ)/n
//! ⟨V⟩ = Σ_g (2g+1) S_g (1 − B_g) + ρ (1 − 1/n)         V = ⟨δ²⟩
//! ```
//!
//! with the squares of Wigner's 3j symbols, from P_ℓ P_g = Σ_k (2k+1) (ℓ g k; 0 0 0)² P_k. This is exact for any
//! directions. Many evenly distributed ones have B = 0, K = 1 and N = 0.
//!
//! # Source
//! Hivon et al. (2002), Astrophys. J. 567, 2 (the coupling matrix); Adams (1878), Proc. R. Soc. 27, 63 (the product of
//! two Legendre polynomials).

use serde::Serialize;

use crate::observe::shell::error::ShellError;
use crate::observe::shell::harmonics::HarmonicSums;
use crate::observe::shell::limits::{MOST_DEGREES, at_most};
use crate::observe::shell::sample::ShellSample;
use crate::simd::lanes::dot_product;

/// The coupling of spectrum and power at the directions of a shell.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShellWindow {
    /// Highest ℓ.
    degree_limit: usize,
    /// Highest g.
    source_limit: usize,
    /// K_ℓg, ℓ = 1, … and g = 1, …; row ℓ − 1.
    coupling: Vec<f64>,
    /// B at its index.
    mean_polynomials: Vec<f64>,
    disk_count: usize,
}

impl ShellWindow {
    /// The window of a shell for ℓ = 1, …, `degree_limit`, with sources g up to `source_limit` ≥ `degree_limit`.
    ///
    /// # Errors
    /// More than [`MOST_DEGREES`] degrees of both kinds.
    ///
    /// # Cost
    /// n (`degree_limit` + `source_limit`)² steps of a recursion.
    pub fn new(shell: &ShellSample, degree_limit: usize, source_limit: usize) -> Result<Self, ShellError> {
        let source_limit = source_limit.max(degree_limit);
        let highest = degree_limit.saturating_add(source_limit);
        at_most(MOST_DEGREES).check("degrees", highest, 16.0 * highest as f64)?;
        let (directions, disk_count) = (shell.directions(), shell.disk_count());
        let count = disk_count as f64;
        let sums = HarmonicSums::of(directions, &vec![1.0 / count; disk_count], highest);
        let mean_polynomials = sums.power();
        // n⁻¹ Σ_i b_ℓ(i) b_g(i).
        let mut products = vec![0.0; degree_limit * source_limit];
        let first = HarmonicSums::of(directions, &vec![1.0 / count; disk_count], source_limit);
        first.for_each_block(directions, |parts, _, inside| {
            for (degree, row) in (1..).zip(products.chunks_exact_mut(source_limit)) {
                let own = &parts[degree][..inside];
                for (product, other) in row.iter_mut().zip(&parts[1..]) {
                    *product += own.iter().zip(other).map(|(a, b)| a * b).sum::<f64>() / count;
                }
            }
        });
        let symbols = Symbols::up_to(highest);
        let b = &mean_polynomials;
        let mut coupling = products;
        for (degree, row) in (1..).zip(coupling.chunks_exact_mut(source_limit)) {
            for (source, entry) in (1..).zip(row) {
                let weight = (2 * source + 1) as f64;
                *entry = weight * (symbols.product(degree, source, b) - 2.0 * *entry + b[degree] * b[source]);
            }
        }
        Ok(ShellWindow { degree_limit, source_limit, coupling, mean_polynomials, disk_count })
    }

    /// Highest ℓ.
    pub fn degree_limit(&self) -> usize {
        self.degree_limit
    }

    /// Highest g.
    pub fn source_limit(&self) -> usize {
        self.source_limit
    }

    /// K_ℓg \[1\].
    ///
    /// # Panics
    /// If a degree is 0 or above its limit.
    pub fn coupling(&self, degree: usize, source: usize) -> f64 {
        self.row(degree)[source - 1]
    }

    /// K_ℓg for g = 1, …
    pub(super) fn row(&self, degree: usize) -> &[f64] {
        &self.coupling[(degree - 1) * self.source_limit..degree * self.source_limit]
    }

    /// N_ℓ \[1\], the expected power of independent values of single spheres over their variance.
    pub fn white(&self, degree: usize) -> f64 {
        (1.0 - self.mean_polynomials[degree]) / self.disk_count as f64
    }

    /// The share of (2g+1) S_g in the variance, 1 − B_g \[1\].
    pub fn variance_share(&self, source: usize) -> f64 {
        1.0 - self.mean_polynomials[source]
    }

    /// Σ_g K_ℓg S_g for ℓ = 1, … of the powers of the sources g = 1, …, and ρ N_ℓ for variance `beyond` of higher
    /// degrees and of single spheres.
    ///
    /// # Panics
    /// If there are not as many powers as sources.
    pub fn expected(&self, power: &[f64], beyond: f64) -> Vec<f64> {
        assert_eq!(power.len(), self.source_limit, "one power for each source");
        let one = |degree| dot_product(self.row(degree), power) + beyond * self.white(degree);
        (1..=self.degree_limit).map(one).collect()
    }
}

/// Squares of 3j symbols with zero orders.
struct Symbols {
    /// A_k = (2k)!/(4^k k!²), which falls slowly: no overflow.
    ratios: Vec<f64>,
}

impl Symbols {
    fn up_to(highest: usize) -> Self {
        let mut ratios = vec![1.0];
        for k in 1..=highest {
            ratios.push(ratios[k - 1] * (2 * k - 1) as f64 / (2 * k) as f64);
        }
        Symbols { ratios }
    }

    /// Σ_k (2k+1) (ℓ g k; 0 0 0)² B_k.
    fn product(&self, degree: usize, source: usize, means: &[f64]) -> f64 {
        let a = &self.ratios;
        // k = ℓ + g − 2r.
        let term = |r: usize| {
            let (k, half) = (degree + source - 2 * r, degree + source - r);
            let square = a[r] * a[degree - r] * a[source - r] / a[half] / (2 * half + 1) as f64;
            (2 * k + 1) as f64 * square * means[k]
        };
        (0..=degree.min(source)).map(term).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observe::shell::harmonics::legendre;

    #[test]
    fn the_product_of_two_polynomials_is_the_sum_over_their_symbols() {
        let symbols = Symbols::up_to(80);
        // The largest (2 1 1; 0 0 0)² and (1 1 0; 0 0 0)²: 2/15 and 1/3.
        assert!((symbols.product(1, 1, &[1.0, 0.0, 0.0]) - 1.0 / 3.0).abs() < 1e-15);
        assert!((symbols.product(1, 1, &[0.0, 0.0, 1.0]) - 5.0 * 2.0 / 15.0).abs() < 1e-15);
        for cosine in [-1.0, -0.73, 0.0, 0.2, 0.999, 1.0] {
            let values = legendre(cosine, 80);
            for (degree, source) in [(1, 1), (3, 7), (12, 5), (40, 40), (2, 78)] {
                // Up to 41 terms of at most 1, each after some 240 products with rounding 10⁻¹⁶.
                let error = symbols.product(degree, source, &values) - values[degree] * values[source];
                assert!(error.abs() < 1e-12, "{degree} {source} {cosine}: {error}");
            }
        }
    }
}
