//! [`ForceDistribution`]: the distribution of the contact forces of the backbone over their mean.
//!
//! ```text
//! P(x) dx: share of contacts with x ≤ F/⟨F⟩ < x + dx          Σ P Δx = 1
//! ```

use serde::Serialize;

use crate::network::ContactNetwork;

/// Width of a bin of P in F/⟨F⟩ \[1\].
pub const BIN_WIDTH: f64 = 0.1;

/// The percentiles reported.
pub const PERCENTILES: [u8; 5] = [5, 25, 50, 75, 95];

/// Largest number of bins; larger forces are in the last one.
const BIN_LIMIT: usize = 10_000;

/// The contact forces of a backbone, over their mean.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ForceDistribution {
    /// Number of contacts.
    pub contact_count: usize,
    /// Mean contact force \[force\].
    pub mean_contact_force: f64,
    /// Smallest force over the mean contact force \[1\].
    pub smallest: f64,
    /// Largest force over the mean contact force \[1\].
    pub largest: f64,
    /// Percentiles [`PERCENTILES`] of the forces over the mean contact force, by linear interpolation between the order statistics
    /// \[1\].
    pub percentiles: [f64; 5],
    /// Width of a bin of the force over the mean contact force \[1\].
    pub bin_width: f64,
    /// P of the force over the mean contact force, in bins from 0 to the last bin that is not empty \[1\].
    pub density: Vec<f64>,
}

impl ForceDistribution {
    /// The forces of a network; none without contacts on the backbone, or with a force that is NaN.
    pub fn of<const D: usize>(network: &ContactNetwork<D>) -> Option<Self> {
        Self::of_forces(network.backbone_contacts().map(|contact| contact.force).collect())
    }

    fn of_forces(mut forces: Vec<f64>) -> Option<Self> {
        let contact_count = forces.len();
        let mean = forces.iter().sum::<f64>() / contact_count as f64;
        // NaN without contacts, or with a force that is NaN.
        if !(mean.is_finite() && mean > 0.0) {
            return None;
        }
        forces.iter_mut().for_each(|force| *force /= mean);
        forces.sort_unstable_by(f64::total_cmp);
        let percentiles = PERCENTILES.map(|percent| {
            let at = f64::from(percent) / 100.0 * (contact_count - 1) as f64;
            let (below, share) = (at.floor() as usize, at - at.floor());
            let above = (below + 1).min(contact_count - 1);
            forces[below] + share * (forces[above] - forces[below])
        });
        let bin = |force: f64| ((force / BIN_WIDTH) as usize).min(BIN_LIMIT - 1);
        let (smallest, largest) = (forces[0], forces[contact_count - 1]);
        let mut density = vec![0.0; bin(largest) + 1];
        forces.iter().for_each(|&force| density[bin(force)] += 1.0);
        density.iter_mut().for_each(|value| *value /= contact_count as f64 * BIN_WIDTH);
        Some(ForceDistribution {
            contact_count,
            mean_contact_force: mean,
            smallest,
            largest,
            percentiles,
            bin_width: BIN_WIDTH,
            density,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_in_arithmetic_progression_have_their_percentiles_and_bins() {
        // 0, 1, …, 20 over their mean 10: the p-th percentile is p/50, two forces per bin of 0.2.
        let found = ForceDistribution::of_forces((0..21).rev().map(f64::from).collect()).expect("forces");
        assert_eq!(
            (found.contact_count, found.mean_contact_force, found.smallest, found.largest),
            (21, 10.0, 0.0, 2.0)
        );
        for (value, percent) in found.percentiles.iter().zip(PERCENTILES) {
            // Interpolated between numbers up to 2.
            assert!((value - f64::from(percent) / 50.0).abs() < 1e-15);
        }
        assert_eq!(found.density.len(), 21);
        assert!((found.density.iter().sum::<f64>() * found.bin_width - 1.0).abs() < 1e-14);
        assert_eq!(ForceDistribution::of_forces(Vec::new()), None);
        assert_eq!(ForceDistribution::of_forces(vec![1.0, f64::NAN]), None);
        assert_eq!(ForceDistribution::of_forces(vec![0.0, 0.0]), None);
    }
}
