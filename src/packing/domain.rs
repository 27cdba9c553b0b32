//! The domain of a packing: a periodic box, rectangular or tilted, or the open plane; and the image of a pair.

use crate::packing::error::PackingError;
use crate::vector::{Vector, extended_sum, two_sum};

/// The space a packing fills.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Domain<const D: usize> {
    /// A box repeated in every direction.
    ///
    /// Edge d has components along the axes 0 to d only, as in LAMMPS: `edges = [[L_x, 0], [xy, L_y]]` in two
    /// dimensions. The box is rectangular if the tilts `xy` (`xz`, `yz`) are 0. They may have any size.
    Periodic {
        /// The corner from which the edges start \[length\].
        corner: Vector<D>,
        /// The edges \[length\].
        edges: [Vector<D>; D],
    },
    /// The infinite plane (or space); held disks confine the packing.
    Open,
}

impl<const D: usize> Domain<D> {
    /// A periodic rectangular box with its smallest coordinates at `corner`, and these sides.
    pub fn rectangular(corner: Vector<D>, lengths: Vector<D>) -> Self {
        let edges = std::array::from_fn(|d| std::array::from_fn(|axis| if axis == d { lengths[d] } else { 0.0 }));
        Domain::Periodic { corner, edges }
    }

    /// A periodic cube (a square for D = 2) of side `length` with its corner at the origin.
    pub fn cube(length: f64) -> Self {
        Domain::rectangular([0.0; D], [length; D])
    }

    /// Area (D = 2) or volume (D = 3) of the box \[length^D\]; `None` in the open plane.
    pub fn volume(&self) -> Option<f64> {
        self.lengths().map(|lengths| lengths.iter().product())
    }

    /// The length of each edge along its own axis, L_x, L_y, …; `None` in the open plane. These are the sides of a
    /// rectangular box, and the sides of a rectangle (a brick) that holds every disk once in a tilted box.
    pub fn lengths(&self) -> Option<Vector<D>> {
        self.edges().map(|edges| std::array::from_fn(|d| edges[d][d]))
    }

    /// The edges; `None` in the open plane.
    pub fn edges(&self) -> Option<[Vector<D>; D]> {
        match self {
            Domain::Periodic { edges, .. } => Some(*edges),
            Domain::Open => None,
        }
    }

    /// Whether an edge is not parallel to its axis.
    pub fn is_tilted(&self) -> bool {
        self.edges().is_some_and(|edges| is_tilted(&edges))
    }

    /// The image of a point (an unevaluated sum per axis) relative to another: every component of the difference is at
    /// most half of its length.
    ///
    /// The edges are subtracted from the last to the first. If a difference is shorter than half of every length, it
    /// is the only one with such components: two of them would differ by a sum of edges, and a component of that sum is
    /// at least a length. So the images of a pair in contact, and of disks within half of the shortest length around a
    /// disk, are the nearest ones, for every tilt.
    fn image(&self, mut point: [(f64, f64); D], other: Vector<D>) -> [(f64, f64); D] {
        let Domain::Periodic { edges, .. } = self else { return point };
        for d in (0..D).rev() {
            let (length, apart) = (edges[d][d], point[d].0 - other[d]);
            // Most pairs need no shift, which avoids the division.
            if apart.abs() > 0.5 * length {
                let boxes = (apart / length).round();
                for axis in (0..=d).filter(|&axis| edges[d][axis] != 0.0) {
                    point[axis] = extended_sum(point[axis], -boxes * edges[d][axis]);
                }
            }
        }
        point
    }

    /// From `b` to `a` along the nearest image, both given as unevaluated sums `high + low`.
    ///
    /// # Accuracy
    /// Half an ulp of the result for disks within the box or up to 2⁵² boxes away from it.
    pub fn separation(&self, a: (Vector<D>, Vector<D>), b: (Vector<D>, Vector<D>)) -> Vector<D> {
        let image = self.image(std::array::from_fn(|d| two_sum(a.0[d], -b.0[d])), [0.0; D]);
        std::array::from_fn(|d| {
            let low = extended_sum(image[d], a.1[d] - b.1[d]);
            low.0 + low.1
        })
    }

    /// Like [`Domain::separation`], with the result as an unevaluated sum.
    pub fn separation_extended(&self, a: (Vector<D>, Vector<D>), b: (Vector<D>, Vector<D>)) -> (Vector<D>, Vector<D>) {
        let image = self.image(std::array::from_fn(|d| two_sum(a.0[d], -b.0[d])), [0.0; D]);
        let mut result = ([0.0; D], [0.0; D]);
        for d in 0..D {
            let rest = a.1[d] - b.1[d];
            (result.0[d], result.1[d]) = if rest == 0.0 { image[d] } else { extended_sum(image[d], rest) };
        }
        result
    }

    /// The image of `centre` (position and correction) nearest to another point.
    pub(crate) fn nearest_image(&self, centre: (Vector<D>, Vector<D>), other: Vector<D>) -> (Vector<D>, Vector<D>) {
        let image = self.image(std::array::from_fn(|d| (centre.0[d], centre.1[d])), other);
        (image.map(|it| it.0), image.map(|it| it.1))
    }

    /// The image of a point within the brick at the corner; rounded, for looking up cells only.
    pub(crate) fn wrapped(&self, point: Vector<D>) -> Vector<D> {
        let mut image = point;
        if let Domain::Periodic { corner, edges } = self {
            for d in (0..D).rev() {
                let (from, length) = (image[d] - corner[d], edges[d][d]);
                let is_inside = from >= 0.0 && from < length;
                if !is_inside {
                    let boxes = (from / length).floor();
                    image[d] = corner[d] + (from - boxes * length).min(length);
                    for axis in 0..d {
                        image[axis] -= boxes * edges[d][axis];
                    }
                }
            }
        }
        image
    }

    pub(crate) fn check(&self) -> Result<(), PackingError> {
        if let Domain::Periodic { corner, edges } = self {
            for axis in 0..D {
                let (length, start) = (edges[axis][axis], corner[axis]);
                if !(length.is_finite() && length > 0.0 && start.is_finite()) {
                    return Err(PackingError::BoxNotPositive { axis, length, corner: start });
                }
                for (along, &value) in edges[axis].iter().enumerate().filter(|&(along, _)| along != axis) {
                    if !value.is_finite() || (along > axis && value != 0.0) {
                        return Err(PackingError::EdgeNotTriangular { edge: axis, axis: along, value });
                    }
                }
            }
        }
        Ok(())
    }
}

/// Whether an edge is not parallel to its axis.
pub(crate) fn is_tilted<const D: usize>(edges: &[Vector<D>; D]) -> bool {
    edges.iter().enumerate().any(|(d, edge)| edge[..d].iter().any(|&tilt| tilt != 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn separation_crosses_the_side_of_the_box() {
        let domain = Domain::<2>::cube(10.0);
        let zero = [0.0; 2];
        assert_eq!(domain.separation(([9.5, 0.0], zero), ([0.25, 0.0], zero)), [-0.75, 0.0]);
    }

    #[test]
    fn separation_keeps_the_low_parts() {
        let domain = Domain::<2>::cube(64.0);
        let low = (-60f64).exp2();
        assert_eq!(domain.separation(([40.0, 1.0], [low, 0.0]), ([40.0, 0.0], [0.0; 2])), [low, 1.0]);
    }
}
