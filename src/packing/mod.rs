//! [`Packing<D>`]: centres, radii, the domain, and which disks are held.
//!
//! A centre is an unevaluated sum of a position and a much smaller correction. Readers and writers use the position;
//! the mechanics uses both, which lowers the rounding floor of the residual by orders of magnitude. A single number per
//! coordinate is known to 10⁻¹⁴ in a box of side 100, but two touching disks need 10⁻¹⁶.

pub mod domain;
mod error;
pub mod mixture;

use std::f64::consts::PI;

pub use domain::Domain;
pub use error::{LARGEST_RADIUS, PackingError, SMALLEST_RADIUS};
pub use mixture::{Component, Mixture};

use crate::vector::{Vector, dot, extended_sum, two_sum};

/// What a packing of this dimension consists of: disks or spheres.
pub fn particles(dimension: usize) -> &'static str {
    if dimension == 3 { "spheres" } else { "disks" }
}

/// Disks (D = 2) or spheres (D = 3) in a domain.
#[derive(Debug, Clone, PartialEq)]
pub struct Packing<const D: usize> {
    domain: Domain<D>,
    positions: Vec<Vector<D>>,
    corrections: Vec<Vector<D>>,
    radii: Vec<f64>,
    held: Vec<bool>,
    labels: Vec<u64>,
    sites: Option<Vec<(Vector<D>, Vector<D>)>>,
    loads: Option<Vec<Vector<D>>>,
}

impl<const D: usize> Packing<D> {
    /// Disks in a domain, none held, labelled 0, 1, 2, …
    ///
    /// # Shape
    /// `positions` and `radii` have one entry per disk.
    ///
    /// # Errors
    /// [`PackingError`] with the disk and the value.
    pub fn new(domain: Domain<D>, positions: Vec<Vector<D>>, radii: Vec<f64>) -> Result<Self, PackingError> {
        let count = positions.len();
        if count == 0 {
            return Err(PackingError::NoDisks);
        }
        if count != radii.len() {
            return Err(PackingError::LengthsDiffer { positions: count, radii: radii.len() });
        }
        if count > u32::MAX as usize {
            return Err(PackingError::TooManyDisks { count });
        }
        domain.check()?;
        for (disk, (position, &radius)) in positions.iter().zip(&radii).enumerate() {
            if let Some(axis) = position.iter().position(|value| !value.is_finite()) {
                return Err(PackingError::PositionNotFinite { disk, axis, value: position[axis] });
            }
            check_radius(disk, radius)?;
        }
        Ok(Packing {
            domain,
            corrections: vec![[0.0; D]; count],
            positions,
            radii,
            held: vec![false; count],
            labels: (0..count as u64).collect(),
            sites: None,
            loads: None,
        })
    }

    /// The same packing with the low parts of its centres: centre = position + correction.
    ///
    /// # Errors
    /// There must be one correction per disk, all finite.
    pub fn with_corrections(mut self, corrections: Vec<Vector<D>>) -> Result<Self, PackingError> {
        if corrections.len() != self.len() {
            return Err(PackingError::LengthsDiffer { positions: corrections.len(), radii: self.len() });
        }
        for (disk, correction) in corrections.iter().enumerate() {
            if let Some(axis) = correction.iter().position(|value| !value.is_finite()) {
                return Err(PackingError::PositionNotFinite { disk, axis, value: correction[axis] });
            }
        }
        for (disk, correction) in corrections.iter().enumerate() {
            self.corrections[disk] = [0.0; D];
            self.displace(disk, *correction);
        }
        Ok(self)
    }

    /// The same packing with these labels. A label is an arbitrary number of the caller for each disk; repeats are
    /// allowed.
    ///
    /// # Errors
    /// There must be one label per disk.
    pub fn with_labels(mut self, labels: Vec<u64>) -> Result<Self, PackingError> {
        if labels.len() != self.len() {
            return Err(PackingError::LengthsDiffer { positions: labels.len(), radii: self.len() });
        }
        self.labels = labels;
        Ok(self)
    }

    /// The same packing with these disks held: they push others and are never moved.
    ///
    /// # Errors
    /// There must be one flag per disk.
    pub fn with_held(mut self, held: Vec<bool>) -> Result<Self, PackingError> {
        if held.len() != self.len() {
            return Err(PackingError::LengthsDiffer { positions: held.len(), radii: self.len() });
        }
        self.held = held;
        Ok(self)
    }

    /// The same packing with the site of every disk at its present position, see
    /// [`OnSite`](crate::law::on_site::OnSite).
    #[must_use]
    pub fn with_sites_here(mut self) -> Self {
        self.sites = Some(self.positions.iter().copied().zip(self.corrections.iter().copied()).collect());
        self
    }

    /// The same packing with these sites, given as position and correction.
    ///
    /// # Errors
    /// There must be one site per disk, all finite.
    pub fn with_sites(mut self, sites: Vec<(Vector<D>, Vector<D>)>) -> Result<Self, PackingError> {
        if sites.len() != self.len() {
            return Err(PackingError::LengthsDiffer { positions: sites.len(), radii: self.len() });
        }
        for (disk, (site, rest)) in sites.iter().enumerate() {
            if let Some(axis) = (0..D).find(|&axis| !(site[axis].is_finite() && rest[axis].is_finite())) {
                return Err(PackingError::PositionNotFinite { disk, axis, value: site[axis] + rest[axis] });
            }
        }
        self.sites = Some(sites);
        Ok(self)
    }

    /// The same packing without sites. The next relaxation with sites puts them at the positions of the disks.
    #[must_use]
    pub fn without_sites(mut self) -> Self {
        self.sites = None;
        self
    }

    /// The same packing with a constant force on every disk \[force\]. Their energy is −Σ f·u, u the displacement of a disk
    /// from its site; the next relaxation puts sites at the positions of the disks if there are none. Forces on held disks
    /// have no effect.
    ///
    /// # Errors
    /// There must be one force per disk, all finite.
    pub fn with_loads(mut self, loads: Vec<Vector<D>>) -> Result<Self, PackingError> {
        if loads.len() != self.len() {
            return Err(PackingError::LengthsDiffer { positions: loads.len(), radii: self.len() });
        }
        for (disk, load) in loads.iter().enumerate() {
            if let Some(axis) = load.iter().position(|value| !value.is_finite()) {
                return Err(PackingError::LoadNotFinite { disk, axis, value: load[axis] });
            }
        }
        self.loads = Some(loads);
        Ok(self)
    }

    /// The same packing without loads; it keeps its sites.
    #[must_use]
    pub fn without_loads(mut self) -> Self {
        self.loads = None;
        self
    }

    /// The same packing with another radius for one disk.
    ///
    /// # Errors
    /// The radius must lie between [`SMALLEST_RADIUS`] and [`LARGEST_RADIUS`].
    ///
    /// # Panics
    /// If the index is out of range.
    pub fn with_radius(mut self, disk: usize, radius: f64) -> Result<Self, PackingError> {
        check_radius(disk, radius)?;
        self.radii[disk] = radius;
        Ok(self)
    }

    /// Number of disks, including held ones.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Never true: a packing has at least one disk.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// The domain.
    pub fn domain(&self) -> &Domain<D> {
        &self.domain
    }

    /// Centres, rounded to one number per coordinate \[length\].
    pub fn positions(&self) -> &[Vector<D>] {
        &self.positions
    }

    /// Low parts of the centres, lost by rounding to [`Packing::positions`] \[length\].
    pub fn corrections(&self) -> &[Vector<D>] {
        &self.corrections
    }

    /// The centre of a disk as position and correction.
    #[inline]
    pub fn centre(&self, disk: usize) -> (Vector<D>, Vector<D>) {
        (self.positions[disk], self.corrections[disk])
    }

    /// Radii \[length\].
    pub fn radii(&self) -> &[f64] {
        &self.radii
    }

    /// The largest radius \[length\].
    pub fn largest_radius(&self) -> f64 {
        self.radii.iter().copied().fold(0.0, f64::max)
    }

    /// Which disks are held in place.
    pub fn held(&self) -> &[bool] {
        &self.held
    }

    /// The labels of the disks.
    pub fn labels(&self) -> &[u64] {
        &self.labels
    }

    /// The site of each disk as position and correction; none unless a law with sites has relaxed the packing.
    pub fn sites(&self) -> Option<&[(Vector<D>, Vector<D>)]> {
        self.sites.as_deref()
    }

    /// The constant force on each disk, if there are any \[force\].
    pub fn loads(&self) -> Option<&[Vector<D>]> {
        self.loads.as_deref()
    }

    /// Exact vector from the site of a disk (its centre, if there are no sites) to a point.
    pub(crate) fn vector_from_site(&self, disk: usize, point: Vector<D>) -> [(f64, f64); D] {
        let (site, rest) = self.sites.as_ref().map_or(self.centre(disk), |sites| sites[disk]);
        std::array::from_fn(|d| extended_sum(two_sum(point[d], -site[d]), -rest[d]))
    }

    /// From disk `second` to disk `first` along the nearest image.
    pub fn separation(&self, first: usize, second: usize) -> Vector<D> {
        self.domain.separation(self.centre(first), self.centre(second))
    }

    /// Moves a disk by `displacement`; the sum is exact for small displacements.
    pub(crate) fn displace(&mut self, disk: usize, displacement: Vector<D>) {
        for d in 0..D {
            let (high, low) = two_sum(self.positions[disk][d], displacement[d]);
            (self.positions[disk][d], self.corrections[disk][d]) = two_sum(high, low + self.corrections[disk][d]);
        }
    }

    /// Sets the centre of a disk to `position + correction`.
    pub(crate) fn place(&mut self, disk: usize, position: Vector<D>, correction: Vector<D>) {
        for d in 0..D {
            (self.positions[disk][d], self.corrections[disk][d]) = two_sum(position[d], correction[d]);
        }
    }

    /// The same disks in a periodic box scaled by `factor` in all directions together with the positions; radii are
    /// kept, sites and loads dropped.
    pub(crate) fn rescaled(self, factor: f64) -> Self {
        let mut packing = self.without_loads().without_sites();
        packing.rescale(factor);
        packing
    }

    fn rescale(&mut self, factor: f64) {
        if let Domain::Periodic { corner, edges } = &mut self.domain {
            for value in edges.iter_mut().flatten().chain(corner) {
                *value *= factor;
            }
        }
        for (position, correction) in self.positions.iter_mut().zip(&mut self.corrections) {
            for d in 0..D {
                (position[d], correction[d]) = two_sum(position[d] * factor, correction[d] * factor);
            }
        }
    }

    /// The same disks with box and centres deformed by r → (1 + G) r; radii are kept, sites and loads dropped. G_ab must be 0 for
    /// a > b, so that edges remain triangular. Also returns the gradient of the displacement, which differs from G by
    /// the rounding of the edges.
    pub(crate) fn deformed(&self, gradient: &[Vector<D>; D]) -> (Self, [Vector<D>; D]) {
        let mut deformed = self.clone().without_loads().without_sites();
        let (mut exact, mut corner) = (*gradient, [0.0; D]);
        if let Domain::Periodic { corner: start, edges } = &mut deformed.domain {
            corner = *start;
            // Edges are triangular, so the gradient follows column by column.
            for d in 0..D {
                let edge = edges[d];
                for axis in 0..D {
                    let moved = edge[axis] + dot(gradient[axis], edge);
                    edges[d][axis] = moved;
                    let known: f64 = (0..d).map(|along| exact[axis][along] * edge[along]).sum();
                    exact[axis][d] = ((moved - edge[axis]) - known) / edge[d];
                }
            }
        }
        for disk in 0..self.len() {
            let (high, low) = self.centre(disk);
            let from: Vector<D> = std::array::from_fn(|d| (high[d] - corner[d]) + low[d]);
            deformed.displace(disk, std::array::from_fn(|d| dot(exact[d], from)));
        }
        (deformed, exact)
    }

    /// Volume of all disks over the volume of the box \[1\]; `None` in the open plane.
    ///
    /// ```text
    /// φ = Σ π R_i² / (L_x L_y)          D = 3: Σ (4/3) π R_i³ / (L_x L_y L_z)
    /// ```
    pub fn packing_fraction(&self) -> Option<f64> {
        let solid: f64 = self.radii.iter().map(|&radius| ball_volume::<D>(radius)).sum();
        self.domain.volume().map(|volume| solid / volume)
    }
}

/// Displacement of a disk, exact to the rounding of that distance (positions are sums of two numbers).
pub(crate) fn displacement<const D: usize>(before: &Packing<D>, after: &Packing<D>, disk: usize) -> [f64; D] {
    let ((a, a_low), (b, b_low)) = (after.centre(disk), before.centre(disk));
    std::array::from_fn(|d| (a[d] - b[d]) + (a_low[d] - b_low[d]))
}

fn check_radius(disk: usize, radius: f64) -> Result<(), PackingError> {
    // False for NaN.
    let possible = (SMALLEST_RADIUS..=LARGEST_RADIUS).contains(&radius);
    if possible { Ok(()) } else { Err(PackingError::RadiusOutOfRange { disk, radius }) }
}

/// Area of a disk (D = 2) or volume of a ball (D = 3) \[length^D\].
///
/// # Panics
/// For other D.
pub fn ball_volume<const D: usize>(radius: f64) -> f64 {
    match D {
        2 => PI * radius * radius,
        3 => 4.0 / 3.0 * PI * radius * radius * radius,
        _ => panic!("the mechanics is defined for two and three dimensions, not {D}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_disks_are_named() {
        let domain = Domain::<2>::cube(10.0);
        assert_eq!(Packing::new(domain, vec![], vec![]), Err(PackingError::NoDisks));
        assert_eq!(
            Packing::new(domain, vec![[1.0, 1.0]], vec![-0.5]),
            Err(PackingError::RadiusOutOfRange { disk: 0, radius: -0.5 })
        );
        let nan = Packing::new(domain, vec![[1.0, f64::NAN]], vec![0.5]);
        assert!(matches!(nan, Err(PackingError::PositionNotFinite { disk: 0, axis: 1, .. })));
    }

    #[test]
    fn a_displacement_below_the_rounding_of_the_position_is_kept() {
        let mut packing = Packing::new(Domain::<2>::cube(100.0), vec![[64.0, 1.0]], vec![0.5]).expect("valid");
        let tiny = (-55f64).exp2();
        for _ in 0..8 {
            packing.displace(0, [tiny, 0.0]);
        }
        assert_eq!(packing.centre(0), ([64.0, 1.0], [8.0 * tiny, 0.0]));
    }
}
