//! [`Fluctuations`]: the standard deviation of a quantity in rings, h(r).
//!
//! ```text
//! h(r)² = Σ (x − ⟨x⟩)²/(n − 1)        over the n bonds or disks of the ring around r
//! ```
//!
//! x = d_∥ of the bonds gives h_∥, x = d_r of the disks h_r. The standard error of h² follows from the fourth moment m₄ for any
//! distribution: var h² = (m₄ − h⁴ (n − 3)/(n − 1))/n.
//!
//! # Source
//! Ellenbroek, Somfai, van Hecke, van Saarloos (2006), Phys. Rev. Lett. 97, 258001. Variance of s²: Cramér (1946),
//! Mathematical Methods of Statistics, ch. 27.

use serde::{Deserialize, Serialize};

use crate::displacement::DisplacementField;
use crate::observe::bond_changes::BondChanges;

/// One ring.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FluctuationRing {
    /// Mean distance of the members from the centre \[length\].
    pub radius: f64,
    /// Number of bonds or disks in the ring, at least two.
    pub count: usize,
    /// ⟨x⟩ \[length\].
    pub mean: f64,
    /// h \[length\].
    pub fluctuation: f64,
    /// Standard error of h, for independent members \[length\].
    pub standard_error: f64,
}

/// h against r, ring by ring from the inside out; rings with fewer than two members are left out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fluctuations {
    /// The rings.
    pub rings: Vec<FluctuationRing>,
}

/// The quantity of a bond.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BondMeasure {
    /// d_∥ \[length\].
    #[default]
    Parallel,
    /// The change of length \[length\].
    LengthChange,
}

impl Fluctuations {
    /// h_∥ in rings of this width \[length\], from radius 0 up to `outer_radius`; bonds are located by their midpoints.
    ///
    /// # Panics
    /// If the width is not positive.
    pub fn of_bonds<const D: usize>(
        changes: &BondChanges<D>,
        measure: BondMeasure,
        outer_radius: f64,
        ring_width: f64,
    ) -> Self {
        let bonds = changes.bonds.iter().map(|bond| {
            let value = match measure {
                BondMeasure::Parallel => bond.parallel,
                BondMeasure::LengthChange => bond.length_change,
            };
            (bond.distance, value)
        });
        Self::of(bonds, outer_radius, ring_width)
    }

    /// h_r in rings of this width \[length\], from radius 0 up to R, of the disks that count.
    ///
    /// # Panics
    /// If the width is not positive.
    pub fn of_radial<const D: usize>(field: &DisplacementField<D>, ring_width: f64) -> Self {
        Self::of(field.counted().map(|disk| (disk.distance, disk.radial)), field.outer_radius, ring_width)
    }

    /// h of (distance, value) pairs in rings of this width \[length\], from radius 0 up to `outer_radius`.
    ///
    /// The result does not depend on the order of the pairs.
    ///
    /// # Panics
    /// If the width is not positive.
    pub fn of(pairs: impl Iterator<Item = (f64, f64)>, outer_radius: f64, ring_width: f64) -> Self {
        assert!(ring_width > 0.0, "a ring has a positive width, not {ring_width}");
        let ring_of = |distance: f64| (distance / ring_width).floor();
        let mut members: Vec<(f64, (f64, f64))> = pairs
            .filter(|&(distance, _)| distance < outer_radius)
            .map(|(distance, value)| (ring_of(distance), (distance, value)))
            .collect();
        // By ring, distance and value, so that sums have a fixed order.
        members.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.0.total_cmp(&b.1.0)).then(a.1.1.total_cmp(&b.1.1)));
        let rings = members.chunk_by(|a, b| a.0 == b.0);
        let rings =
            rings.filter_map(|ring| FluctuationRing::of(&ring.iter().map(|&(_, pair)| pair).collect::<Vec<_>>()));
        Fluctuations { rings: rings.collect() }
    }
}

impl FluctuationRing {
    fn of(pairs: &[(f64, f64)]) -> Option<Self> {
        if pairs.len() < 2 {
            return None;
        }
        let count = pairs.len() as f64;
        let radius = pairs.iter().map(|pair| pair.0).sum::<f64>() / count;
        let mean = pairs.iter().map(|pair| pair.1).sum::<f64>() / count;
        let squares: f64 = pairs.iter().map(|pair| (pair.1 - mean).powi(2)).sum();
        let variance = squares / (count - 1.0);
        let fluctuation = variance.sqrt();
        // Fourth moment relative to the variance, so that it neither underflows nor overflows.
        let standard_error = if fluctuation > 0.0 {
            let kurtosis = pairs.iter().map(|pair| ((pair.1 - mean) / fluctuation).powi(4)).sum::<f64>() / count;
            let relative = (kurtosis - (count - 3.0) / (count - 1.0)).max(0.0) / count;
            0.5 * fluctuation * relative.sqrt()
        } else {
            0.0
        };
        Some(FluctuationRing { radius, count: pairs.len(), mean, fluctuation, standard_error })
    }
}
