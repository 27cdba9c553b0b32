//! The rings used in a fit, their rescaled displacements r^(D−1) d_r and the errors of these.

use crate::fit::FitError;
use crate::fit::dimension::Dimension;
use crate::observe::radial_profile::Ring;

/// Degrees of freedom of the pooled variance mixed into that of each ring, equivalent to four more disks with the
/// common spread. It has little effect on a ring of a hundred disks but dominates one of two. The value four is a
/// choice.
const PRIOR_FREEDOM: f64 = 4.0;

/// Rescaled displacements in the order of their radii.
#[derive(Debug, Clone)]
pub(crate) struct Rings {
    /// Radii r_i \[length\], rising.
    pub radii: Vec<f64>,
    /// `r_i^(D−1) ⟨d_r⟩_i` \[length^D\].
    pub rescaled: Vec<f64>,
    /// Standard error of it \[length^D\]; 1/√(number of disks), with unknown unit, if no ring has any spread.
    pub errors: Vec<f64>,
    /// Whether `errors` are errors, or only relative to each other.
    pub errors_known: bool,
}

impl Rings {
    /// The rings with `from` ≤ r ≤ `to`.
    ///
    /// The error of a ring is moderated. The variance s_i² of r^(D−1) d_r within a ring of n_i disks is uncertain for small
    /// n_i (and zero for one disk, or if nothing moves). It is therefore shrunk towards the pooled one S²,
    ///
    /// ```text
    /// σ_i² = [ (n_i − 1) s_i² + ν S² ] / (n_i − 1 + ν) / n_i        S² = Σ (n_i − 1) s_i² / Σ (n_i − 1),  ν = 4
    /// ```
    ///
    /// so no ring has infinite weight. Source: Smyth (2004), Stat. Appl. Genet. Mol. Biol. 3, 3, eq. for the moderated
    /// variance, with fixed ν.
    pub(crate) fn new(
        rings: &[Ring],
        [from, to]: [f64; 2],
        dimension: Dimension,
        needed: usize,
    ) -> Result<Self, FitError> {
        let mut used: Vec<&Ring> = rings.iter().filter(|ring| from <= ring.radius && ring.radius <= to).collect();
        used.sort_by(|a, b| a.radius.total_cmp(&b.radius));
        if used.len() < needed {
            return Err(FitError::TooFewRings { ring_count: used.len(), needed, from, to });
        }
        if used.iter().all(|ring| ring.mean == 0.0) {
            return Err(FitError::NoDisplacement { ring_count: used.len() });
        }
        let freedom = |ring: &Ring| ring.disk_count as f64 - 1.0;
        let factor = |ring: &Ring| dimension.rescaling(ring.radius);
        let variance = |ring: &Ring| (factor(ring) * ring.standard_error).powi(2) * ring.disk_count as f64;
        let total: f64 = used.iter().map(|ring| freedom(ring)).sum();
        let pooled = used.iter().map(|ring| freedom(ring) * variance(ring)).sum::<f64>() / total;
        // No ring with two disks, or no spread in any: 0/0 or 0. In the units of the fit the largest number is about 1,
        // and an error of 10⁻¹⁰⁰ counts as zero.
        let errors_known = pooled > 1e-200;
        let error = |ring: &Ring| {
            let moderated = if errors_known {
                (freedom(ring) * variance(ring) + PRIOR_FREEDOM * pooled) / (freedom(ring) + PRIOR_FREEDOM)
            } else {
                1.0
            };
            (moderated / ring.disk_count as f64).sqrt()
        };
        Ok(Rings {
            radii: used.iter().map(|ring| ring.radius).collect(),
            rescaled: used.iter().map(|ring| factor(ring) * ring.mean).collect(),
            errors: used.iter().map(|ring| error(ring)).collect(),
            errors_known,
        })
    }

    pub(crate) fn len(&self) -> usize {
        self.radii.len()
    }

    /// `Σ a_i b_i / σ_i²`.
    pub(crate) fn weighted(&self, a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).zip(&self.errors).map(|((a, b), error)| (a / error) * (b / error)).sum()
    }
}
