//! [`Detail`]: the parts of a response that have vectors, in the plane or in space.

use std::any::Any;

use crate::displacement::DisplacementField;
use crate::observe::bond_changes::BondChanges;
use crate::observe::contact_changes::ContactChanges;

/// The parts of a response that have vectors.
#[derive(Debug, Clone)]
pub enum Detail {
    /// Disks in the plane.
    Plane(Box<DetailOf<2>>),
    /// Spheres in space.
    Space(Box<DetailOf<3>>),
}

/// The same in D dimensions.
#[derive(Debug, Clone)]
pub struct DetailOf<const D: usize> {
    /// The displacement field.
    pub field: DisplacementField<D>,
    /// The stretch of every bond, if requested.
    pub bond_changes: Option<BondChanges<D>>,
    /// The changed contacts of the inflation, if requested.
    pub contact_changes: Option<ContactChanges<D>>,
}

impl Detail {
    /// Wraps the parts of a response in two or three dimensions.
    pub(crate) fn of<const D: usize>(detail: DetailOf<D>) -> Self {
        const { assert!(D == 2 || D == 3, "a response has two or three dimensions") };
        in_dimension(detail, Detail::Plane, Detail::Space)
    }

    /// The parts in the plane.
    pub fn plane(&self) -> Option<&DetailOf<2>> {
        match self {
            Detail::Plane(detail) => Some(detail),
            Detail::Space(_) => None,
        }
    }

    /// The parts in space.
    pub fn space(&self) -> Option<&DetailOf<3>> {
        match self {
            Detail::Plane(_) => None,
            Detail::Space(detail) => Some(detail),
        }
    }

    /// The parts, if they have D dimensions.
    pub(crate) fn of_dimension<const D: usize>(&self) -> Option<&DetailOf<D>> {
        match self {
            Detail::Plane(detail) => (&**detail as &dyn Any).downcast_ref(),
            Detail::Space(detail) => (&**detail as &dyn Any).downcast_ref(),
        }
    }

    /// Number of dimensions.
    pub fn dimension(&self) -> usize {
        match self {
            Detail::Plane(_) => 2,
            Detail::Space(_) => 3,
        }
    }

    /// Number of dimensions in which the field spreads: 1 in a strip.
    pub fn spreading_dimension(&self) -> usize {
        match self {
            Detail::Plane(detail) => detail.field.spreading_dimension(),
            Detail::Space(detail) => detail.field.spreading_dimension(),
        }
    }

    /// a and R \[length\].
    pub fn radii(&self) -> [f64; 2] {
        match self {
            Detail::Plane(detail) => [detail.field.inner_radius, detail.field.outer_radius],
            Detail::Space(detail) => [detail.field.inner_radius, detail.field.outer_radius],
        }
    }
}

/// Wraps a value that is an `A` (of the plane) or a `B` (of space).
///
/// # Panics
/// If it is neither.
pub(crate) fn in_dimension<A: Any, B: Any, R>(
    value: impl Any,
    plane: impl FnOnce(Box<A>) -> R,
    space: impl FnOnce(Box<B>) -> R,
) -> R {
    let value: Box<dyn Any> = Box::new(value);
    match value.downcast() {
        Ok(value) => plane(value),
        Err(value) => space(value.downcast().expect("three dimensions if not two")),
    }
}
