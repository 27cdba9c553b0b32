//! [`Layout`]: where each disk of a packing stands in working order, and what its displacement is relative to.
//!
//! Mobile disks come first, then held ones, each part in spatial order. So neighbours in space are neighbours in
//! memory. The caller's numbering is kept outside. A centre is an anchor plus a displacement, and a relaxer moves only
//! the displacement. Anchors are relative to a corner near the disks, so the distance of a packing from the origin does
//! not matter. When the neighbour list is rebuilt, the anchors absorb the displacements without rounding: the remainder
//! stays in the displacement.

use std::iter::repeat_with;

use crate::neighbours::verlet_list::{Disks, spatial_order};
use crate::packing::{Domain, Packing, PackingError};
use crate::parallel::{self, PIECE};
use crate::vector::{Vector, extended_sum, sum, two_sum};

/// The disks of a packing in working order, without their displacements.
#[derive(Debug, Clone)]
pub(crate) struct Layout<const D: usize> {
    /// The domain, shifted by −`origin`.
    domain: Domain<D>,
    /// Origin of the anchors.
    origin: Vector<D>,
    /// The caller's index of each disk in working order.
    pub order: Vec<u32>,
    pub mobile_count: usize,
    anchors: Vec<Vector<D>>,
    /// Anchor minus site of each mobile disk, as unevaluated sums; empty for a law without sites and disks without loads.
    from_sites: Vec<[(f64, f64); D]>,
    /// Constant force on each mobile disk; empty if there are none.
    loads: Vec<Vector<D>>,
    pub radii: Vec<f64>,
}

impl<const D: usize> Layout<D> {
    /// Lays out a packing. Returns the displacements from the anchors too.
    pub fn of(packing: &Packing<D>, has_sites: bool) -> (Self, Vec<Vector<D>>) {
        let order = spatial_order(packing.domain(), packing.positions(), packing.radii(), packing.held());
        let pick = |column: &[Vector<D>]| order.iter().map(|&disk| column[disk as usize]).collect::<Vec<_>>();
        let radii: Vec<f64> = order.iter().map(|&disk| packing.radii()[disk as usize]).collect();
        let mobile_count = packing.held().iter().filter(|&&held| !held).count();
        let (origin, domain) = origin_and_domain(packing);
        let (mut anchors, mut displacements) = (pick(packing.positions()), pick(packing.corrections()));
        for (anchor, displacement) in anchors.iter_mut().zip(&mut displacements) {
            for d in 0..D {
                let (high, low) = two_sum(anchor[d], -origin[d]);
                (anchor[d], displacement[d]) = (high, low + displacement[d]);
            }
        }
        // An anchor is the rounded difference of position and origin; the displacement has the remainder.
        let from_site = |&disk: &u32| {
            let position = packing.positions()[disk as usize];
            let offset = packing.vector_from_site(disk as usize, position);
            std::array::from_fn(|d| extended_sum(offset[d], -two_sum(position[d], -origin[d]).1))
        };
        let loads = packing.loads().map(|loads| pick(loads)[..mobile_count].to_vec()).unwrap_or_default();
        let with_sites = if has_sites || !loads.is_empty() { &order[..mobile_count] } else { &[] };
        let from_sites = with_sites.iter().map(from_site).collect();
        (Layout { domain, origin, mobile_count, anchors, from_sites, loads, radii, order }, displacements)
    }

    /// The disks as seen by the list builder.
    pub fn disks<'a>(&'a self, displacements: &'a [Vector<D>]) -> Disks<'a, D> {
        let Layout { domain, anchors, radii, mobile_count, .. } = self;
        Disks { domain, anchors, displacements, radii, mobile_count: *mobile_count }
    }

    /// Rounded position of a disk, relative to the origin of the anchors \[length\].
    pub fn place(&self, index: usize, displacements: &[Vector<D>]) -> Vector<D> {
        sum(self.anchors[index], displacements[index])
    }

    /// The packing it was made from, with its disks at the present positions.
    pub fn placed(&self, mut packing: Packing<D>, displacements: &[Vector<D>]) -> Packing<D> {
        for (index, &disk) in self.order.iter().enumerate().take(self.mobile_count) {
            let (anchor, displacement) = (self.anchors[index], displacements[index]);
            let sums: Vector<D> = std::array::from_fn(|d| anchor[d] + self.origin[d]);
            let rest = std::array::from_fn(|d| two_sum(anchor[d], self.origin[d]).1 + displacement[d]);
            packing.place(disk as usize, sums, rest);
        }
        packing
    }

    /// Constant force on a mobile disk; 0 if there are none \[force\].
    pub fn load(&self, index: usize) -> Vector<D> {
        self.loads.get(index).copied().unwrap_or([0.0; D])
    }

    /// Number of mobile disks that have a site.
    pub fn site_count(&self) -> usize {
        self.from_sites.len()
    }

    /// Displacement of a mobile disk from its site, rounded relative to itself; 0 without sites \[length\].
    pub fn displacement_from_site(&self, index: usize, displacements: &[Vector<D>]) -> Vector<D> {
        let from = |from: &[(f64, f64); D]| std::array::from_fn(|d| (from[d].0 + displacements[index][d]) + from[d].1);
        self.from_sites.get(index).map_or([0.0; D], from)
    }

    /// Moves the anchors to the present positions; the disks do not move. `saved` are other displacements from the same
    /// anchors, or none.
    pub fn absorb(&mut self, displacements: &mut [Vector<D>], saved: &mut [Vector<D>]) {
        let anchors = self.anchors[..self.mobile_count].chunks_mut(PIECE);
        let displacements = displacements[..self.mobile_count].chunks_mut(PIECE);
        // Arrays are empty where they are not needed.
        let saved = saved.chunks_mut(PIECE).chain(repeat_with(Default::default));
        let from_sites = self.from_sites.chunks_mut(PIECE).chain(repeat_with(Default::default));
        let pieces = anchors.zip(displacements).zip(saved.zip(from_sites));
        parallel::each(pieces, |((anchors, displacements), (saved, from_sites))| {
            for (index, (anchor, displacement)) in anchors.iter_mut().zip(displacements).enumerate() {
                let mut nowhere = [0.0; D];
                let saved = saved.get_mut(index).unwrap_or(&mut nowhere);
                for d in 0..D {
                    let (high, low) = two_sum(anchor[d], displacement[d]);
                    saved[d] += anchor[d] - high;
                    if let Some(from) = from_sites.get_mut(index) {
                        // The part that the anchor absorbs, without rounding.
                        from[d] = extended_sum(extended_sum(from[d], displacement[d]), -low);
                    }
                    (anchor[d], displacement[d]) = (high, low);
                }
            }
        });
    }

    /// The error with the caller's indices of the disks.
    pub fn in_callers_order(&self, error: PackingError) -> PackingError {
        match error {
            PackingError::CoincidentCentres { first, second } => {
                let (a, b) = (self.order[first] as usize, self.order[second] as usize);
                PackingError::CoincidentCentres { first: a.min(b), second: a.max(b) }
            }
            other => other,
        }
    }
}

/// Origin of the anchors, and the domain relative to it. In a periodic box it is the corner. In the open plane it is
/// the origin of the plane. If all disks lie far on one side of that origin, it is a corner of the disks, so that
/// distances keep their accuracy.
fn origin_and_domain<const D: usize>(packing: &Packing<D>) -> (Vector<D>, Domain<D>) {
    match packing.domain() {
        Domain::Periodic { corner, edges } => (*corner, Domain::Periodic { corner: [0.0; D], edges: *edges }),
        Domain::Open => {
            let origin = std::array::from_fn(|d| {
                let column = || packing.positions().iter().map(|position| position[d]);
                let (low, high) = (column().fold(f64::INFINITY, f64::min), column().fold(f64::NEG_INFINITY, f64::max));
                if high - low < low.abs() { low } else { 0.0 }
            });
            (origin, Domain::Open)
        }
    }
}
