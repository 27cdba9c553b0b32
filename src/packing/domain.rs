//! The domain of a packing: a periodic box or the open plane, and the nearest image of a pair.

use crate::packing::error::PackingError;
use crate::vector::{Vector, extended_sum, two_sum};

/// The space a packing fills.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Domain<const D: usize> {
    /// A rectangular box repeated in every direction.
    Periodic {
        /// The corner with the smallest coordinates \[length\].
        corner: Vector<D>,
        /// The sides \[length\].
        lengths: Vector<D>,
    },
    /// The infinite plane (or space); held disks confine the packing.
    Open,
}

impl<const D: usize> Domain<D> {
    /// A periodic cube (a square for D = 2) of side `length` with its corner at the origin.
    pub fn cube(length: f64) -> Self {
        Domain::Periodic { corner: [0.0; D], lengths: [length; D] }
    }

    /// Area (D = 2) or volume (D = 3) of the box \[length^D\]; `None` in the open plane.
    pub fn volume(&self) -> Option<f64> {
        match self {
            Domain::Periodic { lengths, .. } => Some(lengths.iter().product()),
            Domain::Open => None,
        }
    }

    /// The sides of the box; `None` in the open plane.
    pub fn lengths(&self) -> Option<Vector<D>> {
        match self {
            Domain::Periodic { lengths, .. } => Some(*lengths),
            Domain::Open => None,
        }
    }

    /// The shift of a difference of coordinates to the nearest image: a multiple of the side.
    #[inline(always)]
    pub(crate) fn shift(&self, difference: f64, axis: usize) -> f64 {
        match self {
            // Most pairs need no shift, which avoids the division.
            Domain::Periodic { lengths, .. } if difference.abs() > 0.5 * lengths[axis] => {
                -(difference / lengths[axis]).round() * lengths[axis]
            }
            _ => 0.0,
        }
    }

    /// From `b` to `a` along the nearest image, both given as unevaluated sums `high + low`.
    ///
    /// # Accuracy
    /// Half an ulp of the result for disks within the box or up to 2⁵² boxes away from it.
    pub fn separation(&self, a: (Vector<D>, Vector<D>), b: (Vector<D>, Vector<D>)) -> Vector<D> {
        std::array::from_fn(|d| {
            let high = two_sum(a.0[d], -b.0[d]);
            let shifted = extended_sum(high, self.shift(high.0, d));
            let low = extended_sum(shifted, a.1[d] - b.1[d]);
            low.0 + low.1
        })
    }

    /// Like [`Domain::separation`], with the result as an unevaluated sum.
    pub fn separation_extended(&self, a: (Vector<D>, Vector<D>), b: (Vector<D>, Vector<D>)) -> (Vector<D>, Vector<D>) {
        let mut result = ([0.0; D], [0.0; D]);
        for d in 0..D {
            let high = two_sum(a.0[d], -b.0[d]);
            let (shift, rest) = (self.shift(high.0, d), a.1[d] - b.1[d]);
            // Without a shift, as for most pairs of a box, the sum is already known.
            (result.0[d], result.1[d]) =
                if shift == 0.0 && rest == 0.0 { high } else { extended_sum(extended_sum(high, shift), rest) };
        }
        result
    }

    /// The image of a point within the box; rounded, for looking up cells only.
    pub(crate) fn wrapped(&self, point: Vector<D>) -> Vector<D> {
        let mut image = point;
        if let Domain::Periodic { corner, lengths } = self {
            for d in 0..D {
                let from = point[d] - corner[d];
                let is_inside = from >= 0.0 && from < lengths[d];
                if !is_inside {
                    image[d] = corner[d] + (from - (from / lengths[d]).floor() * lengths[d]).min(lengths[d]);
                }
            }
        }
        image
    }

    pub(crate) fn check(&self) -> Result<(), PackingError> {
        if let Domain::Periodic { corner, lengths } = self {
            for axis in 0..D {
                let (length, start) = (lengths[axis], corner[axis]);
                if !(length.is_finite() && length > 0.0 && start.is_finite()) {
                    return Err(PackingError::BoxNotPositive { axis, length, corner: start });
                }
            }
        }
        Ok(())
    }
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
