//! [`Shape`]: the shape of the region in which disks respond to an inflation.

use crate::inflation::drive::DiagonalStrain;
use crate::vector::{Vector, dot, norm, scaled};

/// The axis across a strip.
pub(crate) const ACROSS: usize = 1;

/// The shape of the region of a displacement field.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Shape {
    /// A circle, a sphere or a box: distances and radial parts are from the inflated disk.
    #[default]
    Round,
    /// A strip along the first axis, of this length and periodic along it: distances and radial parts are from the line
    /// through the inflated disk, across the strip \[length\].
    Strip {
        /// Period along the strip \[length\].
        length: f64,
    },
}

impl Shape {
    /// The part of a vector at this position along the radius, or in a strip across it: d·r̂.
    pub fn radial_part<const D: usize>(self, position: Vector<D>, vector: Vector<D>) -> f64 {
        let from = self.offset(position);
        dot(vector, scaled(1.0 / norm(from), from))
    }

    /// The vector to a position from the centre, or in a strip from the line \[length\].
    pub(crate) fn offset<const D: usize>(self, position: Vector<D>) -> Vector<D> {
        match self {
            Shape::Round => position,
            Shape::Strip { .. } => std::array::from_fn(|d| if d == ACROSS { position[d] } else { 0.0 }),
        }
    }
}

/// The inflated disks and the region around them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Region<'a> {
    /// The disk, or that of the row through which the line runs.
    pub centre: usize,
    /// All inflated disks.
    pub grown: &'a [usize],
    pub inner_radius: f64,
    pub outer_radius: f64,
    pub shape: Shape,
    /// The affine part of displacements, which a field leaves out.
    pub strain: DiagonalStrain,
}
