//! [`RadialProfile`]: the mean radial displacement in rings around the inflated disk.
//!
//! ```text
//! ⟨d_r⟩_k = (1/n_k) Σ_{i in ring k} d_r,i        ring k: a + k w ≤ r_i < a + (k+1) w,  up to R
//! ```

use serde::{Deserialize, Serialize};

use crate::displacement::DisplacementField;

/// One ring of a radial profile.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Ring {
    /// Mean distance of the disks of the ring from the centre \[length\].
    pub radius: f64,
    /// Number of disks in the ring.
    pub disk_count: usize,
    /// Mean radial displacement ⟨d_r⟩ \[length\].
    pub mean: f64,
    /// Standard deviation of d_r within the ring \[length\].
    pub spread: f64,
    /// Standard error of the mean, spread/√n, for independent disks \[length\].
    pub standard_error: f64,
}

/// Mean radial displacement against distance from the centre, ring by ring from the inside out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RadialProfile {
    /// The rings that hold at least one disk.
    pub rings: Vec<Ring>,
}

impl RadialProfile {
    /// The profile of a field in rings of this width \[length\], from the disks that count.
    ///
    /// # Panics
    /// If the width is not positive.
    pub fn of<const D: usize>(field: &DisplacementField<D>, ring_width: f64) -> Self {
        assert!(ring_width > 0.0, "a ring has a positive width, not {ring_width}");
        let last = ((field.outer_radius - field.inner_radius) / ring_width).ceil().max(1.0);
        let ring_of = |distance: f64| ((distance - field.inner_radius) / ring_width).floor();
        let counted = field.counted().map(|disk| (ring_of(disk.distance), (disk.distance, disk.radial)));
        let mut members: Vec<(f64, (f64, f64))> = counted.filter(|(ring, _)| (0.0..last).contains(ring)).collect();
        // A stable sort: within a ring the disks keep their order. Only rings with disks are visited, so narrow rings
        // cost no more than wide ones.
        members.sort_by(|a, b| a.0.total_cmp(&b.0));
        let rings = members.chunk_by(|a, b| a.0 == b.0);
        let rings = rings.filter_map(|ring| Ring::of(&ring.iter().map(|&(_, disk)| disk).collect::<Vec<_>>()));
        RadialProfile { rings: rings.collect() }
    }
}

impl Ring {
    /// Statistics of (distance, radial displacement) pairs; `None` for an empty ring.
    fn of(disks: &[(f64, f64)]) -> Option<Self> {
        let count = disks.len() as f64;
        if disks.is_empty() {
            return None;
        }
        let radius = disks.iter().map(|disk| disk.0).sum::<f64>() / count;
        let mean = disks.iter().map(|disk| disk.1).sum::<f64>() / count;
        let squares: f64 = disks.iter().map(|disk| (disk.1 - mean) * (disk.1 - mean)).sum();
        let spread = if disks.len() > 1 { (squares / (count - 1.0)).sqrt() } else { 0.0 };
        Some(Ring { radius, disk_count: disks.len(), mean, spread, standard_error: spread / count.sqrt() })
    }
}
