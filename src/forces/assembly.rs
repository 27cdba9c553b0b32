//! [`Assembly`]: a packing laid out for the hot loop.
//!
//! Mobile disks come first, then held ones, each part in spatial order. So neighbours in space are neighbours in
//! memory. The caller's numbering is kept outside. A centre is an anchor plus a displacement, and a relaxer moves only
//! the displacement. Anchors are relative to a corner near the disks, so the distance of a packing from the origin does
//! not matter. When the neighbour list is rebuilt, the anchors absorb the displacements without rounding: the remainder
//! stays in the displacement.

mod incremental_update;
mod list_keeping;

use std::iter::repeat_with;
use std::ops::RangeInclusive;

use crate::forces::advance::{Advanced, Movers, Reach, advance};
use crate::forces::elastic;
use crate::forces::elastic::{Across, Plain};
use crate::forces::stiffness_bound::{Weight, stiffness_rows};
use crate::forces::totals::Totals;
use crate::law::pair_law::PairLaw;
use crate::neighbours::displacement_bounds::{DisplacementBounds, SKIN_FRACTION};
use crate::neighbours::fast_disks::FastDisks;
use crate::neighbours::pair_list::PairList;
use crate::neighbours::verlet_list::{Disks, ListRoom, build_pairs, spatial_order};
use crate::packing::{Domain, Packing, PackingError};
use crate::parallel::{self, PIECE};
use crate::vector::{Vector, dot, extended_sum, longest_difference_squared, sum, two_sum};

/// Width of the skin over the smallest radius \[1\]. Changes speed only. With a wider skin, lists last longer but
/// contain more pairs without contact.
pub const SKIN: f64 = 0.5;

/// Width of the narrowest skin of a long list with incremental updates. Such a list need not last for the few fast
/// disks.
const AMENDED_SKIN: f64 = 0.2;

/// A packing under a contact law, in working order.
#[derive(Debug, Clone)]
pub struct Assembly<const D: usize, L> {
    law: L,
    /// The domain, shifted by −`origin`.
    domain: Domain<D>,
    /// Origin of the anchors.
    origin: Vector<D>,
    /// The caller's index of each disk in working order.
    order: Vec<u32>,
    mobile_count: usize,
    anchors: Vec<Vector<D>>,
    /// Anchor minus site of each mobile disk, as unevaluated sums; empty for a law without sites.
    from_sites: Vec<[(f64, f64); D]>,
    radii: Vec<f64>,
    pairs: PairList<D>,
    /// Inner list, used in place of `pairs` while `inner_skin` is set.
    inner_pairs: PairList<D>,
    inner_skin: Option<f64>,
    /// Whether an inner list may be used.
    prunes: bool,
    /// Number of calls of [`Assembly::keep_listed`] since the list in use was built, and the number at which the speed
    /// of the disks is checked.
    age: usize,
    next_check: usize,
    /// Displacements at the last speed check, and the value of `age` then.
    checked_displacements: Vec<Vector<D>>,
    checked_at: usize,
    across: Across<f64, D>,
    list_room: ListRoom<D>,
    smallest_radius: f64,
    /// Skin of the outer list.
    skin: f64,
    /// Narrowest and widest skin of the outer list.
    skins: RangeInclusive<f64>,
    /// Displacements at the build of the outer list, or at the last update of a disk in it; the same for the inner
    /// list.
    outer_at_build: Vec<Vector<D>>,
    inner_at_build: Vec<Vector<D>>,
    /// The fast disks of the present update.
    fast_disks: FastDisks,
    /// Displacements that the relaxer can restore, if it has set a checkpoint.
    checkpoint: Vec<Vector<D>>,
    /// Displacement bounds since the list in use was built.
    bounds: DisplacementBounds,
    /// Bound on the displacements in the outer list up to the build of the inner list, for each portion; empty if the
    /// inner list is not in use.
    bounds_before: Vec<f64>,
    /// Number of lists used so far, and number of incremental updates of the present one.
    listing_number: (usize, usize),
    rebuild_count: usize,
    /// Centre minus anchor of each disk; a relaxer moves the first [`Assembly::mobile_count`] disks \[length\].
    pub displacements: Vec<Vector<D>>,
    /// Forces of the last evaluation, all disks \[force\].
    pub forces: Vec<Vector<D>>,
}

impl<const D: usize, L: PairLaw> Assembly<D, L> {
    /// Lays out a packing and builds its neighbour list.
    ///
    /// # Errors
    /// A box too small for the minimum-image convention, or two disks with the same centre (named by the caller's
    /// indices).
    pub fn new(packing: &Packing<D>, law: L) -> Result<Self, PackingError> {
        Self::with_skin(packing, law, SKIN)
    }

    /// Like [`Assembly::new`], with an inner list and incremental updates ([`Assembly::prune_lists`]). The lists of a
    /// large packing have a narrower skin, unless all disks move.
    ///
    /// # Errors
    /// As in [`Assembly::new`].
    pub fn with_amended_lists(packing: &Packing<D>, law: L) -> Result<Self, PackingError> {
        let narrowest = if PairList::<D>::are_long(packing.len()) { AMENDED_SKIN } else { SKIN };
        Self::with_skins(packing, law, narrowest..=SKIN)
    }

    /// Like [`Assembly::new`], with another width of the skin, over the smallest radius \[1\].
    ///
    /// # Errors
    /// As in [`Assembly::new`].
    pub fn with_skin(packing: &Packing<D>, law: L, skin: f64) -> Result<Self, PackingError> {
        Self::with_skins(packing, law, skin..=skin)
    }

    fn with_skins(packing: &Packing<D>, law: L, skins: RangeInclusive<f64>) -> Result<Self, PackingError> {
        let order = spatial_order(packing.domain(), packing.positions(), packing.radii(), packing.held());
        let pick = |column: &[Vector<D>]| order.iter().map(|&disk| column[disk as usize]).collect::<Vec<_>>();
        let radii: Vec<f64> = order.iter().map(|&disk| packing.radii()[disk as usize]).collect();
        let smallest_radius = radii.iter().copied().fold(f64::INFINITY, f64::min);
        let largest = radii.iter().copied().fold(0.0, f64::max);
        // The list contains one image per pair, so its range stays below half of the shortest side.
        let shortest = packing.domain().lengths().map(|lengths| lengths.iter().copied().fold(f64::INFINITY, f64::min));
        let most = shortest.map_or(f64::INFINITY, |shortest| (0.5 * shortest - 2.0 * largest).max(0.0));
        let [narrowest, widest] = [skins.start(), skins.end()].map(|skin| most.min(skin * smallest_radius));
        let (origin, domain) = origin_and_domain(packing);
        let (mut anchors, mut displacements) = (pick(packing.positions()), pick(packing.corrections()));
        for (anchor, displacement) in anchors.iter_mut().zip(&mut displacements) {
            for d in 0..D {
                let (high, low) = two_sum(anchor[d], -origin[d]);
                (anchor[d], displacement[d]) = (high, low + displacement[d]);
            }
        }
        let mut assembly = Assembly {
            law,
            domain,
            origin,
            mobile_count: packing.held().iter().filter(|&&held| !held).count(),
            anchors,
            displacements,
            forces: vec![[0.0; D]; packing.len()],
            outer_at_build: Vec::new(),
            inner_at_build: Vec::new(),
            fast_disks: FastDisks::default(),
            checkpoint: Vec::new(),
            bounds: DisplacementBounds::default(),
            bounds_before: Vec::new(),
            listing_number: (0, 0),
            rebuild_count: 0,
            from_sites: Vec::new(),
            pairs: PairList::default(),
            inner_pairs: PairList::default(),
            inner_skin: None,
            prunes: false,
            age: 0,
            next_check: 0,
            checked_displacements: Vec::new(),
            checked_at: 0,
            across: Across::default(),
            list_room: ListRoom::default(),
            radii,
            smallest_radius,
            skin: narrowest,
            skins: narrowest..=widest,
            order,
        };
        if law.has_sites() {
            // An anchor is the rounded difference of position and origin; the displacement has the remainder.
            let from_site = |&disk: &u32| {
                let position = packing.positions()[disk as usize];
                let offset = packing.vector_from_site(disk as usize, position);
                std::array::from_fn(|d| extended_sum(offset[d], -two_sum(position[d], -origin[d]).1))
            };
            assembly.from_sites = assembly.order[..assembly.mobile_count].iter().map(from_site).collect();
        }
        assembly.rebuild()?;
        Ok(assembly)
    }

    /// The given packing, with its disks at the present positions.
    ///
    /// # Panics
    /// If `packing` has another number of disks than the packing of the assembly.
    pub fn placed(&self, mut packing: Packing<D>) -> Packing<D> {
        assert_eq!(packing.len(), self.order.len(), "an assembly belongs to the packing it was made from");
        if self.law.has_sites() && packing.sites().is_none() {
            packing = packing.with_sites_here();
        }
        for (index, &disk) in self.order.iter().enumerate().take(self.mobile_count) {
            let (anchor, displacement) = (self.anchors[index], self.displacements[index]);
            let sums: Vector<D> = std::array::from_fn(|d| anchor[d] + self.origin[d]);
            let rest = std::array::from_fn(|d| two_sum(anchor[d], self.origin[d]).1 + displacement[d]);
            packing.place(disk as usize, sums, rest);
        }
        packing
    }

    /// Number of disks.
    pub fn len(&self) -> usize {
        self.order.len()
    }

    /// Always false: a packing has at least one disk.
    pub fn is_empty(&self) -> bool {
        self.order.is_empty()
    }

    /// Number of mobile disks; they come first.
    pub fn mobile_count(&self) -> usize {
        self.mobile_count
    }

    /// The caller's index of each disk in working order.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Radii in working order \[length\].
    pub fn radii(&self) -> &[f64] {
        &self.radii
    }

    /// Rounded position of a disk, relative to the assembly's own origin \[length\].
    pub fn place(&self, index: usize) -> Vector<D> {
        sum(self.anchors[index], self.displacements[index])
    }

    /// The contact law.
    pub fn law(&self) -> &L {
        &self.law
    }

    /// The neighbour list in use: every pair that may touch before the list is changed.
    pub fn pairs(&self) -> &PairList<D> {
        in_use(self.inner_skin, &self.inner_pairs, &self.pairs)
    }

    /// Number of builds of the outer list, the first one included.
    pub fn rebuild_count(&self) -> usize {
        self.rebuild_count
    }

    /// Evaluates the forces at the present displacements into [`Assembly::forces`].
    pub fn evaluate(&mut self) {
        let pairs = in_use(self.inner_skin, &self.inner_pairs, &self.pairs);
        elastic::forces(&self.law, pairs, &self.displacements, &mut self.across, &mut self.forces);
        if self.law.has_sites() {
            let _ = self.add_on_site_forces();
        }
    }

    /// Moves the mobile disks, evaluates the forces at their new positions and observes them, tile by tile. The caller
    /// must then call [`Assembly::keep`]. If the list is no longer complete at the new positions, the disks are only
    /// moved.
    ///
    /// # Shape
    /// `velocities` has one entry per mobile disk. `kick` takes (forces, velocities, displacements) of some mobile
    /// disks and returns a bound on their displacements \[length\]. `look` takes (forces, velocities). Each mobile disk
    /// occurs once.
    pub fn advance<P: Send>(
        &mut self,
        velocities: &mut [Vector<D>],
        kick: impl Fn(&[Vector<D>], &mut [Vector<D>], &mut [Vector<D>]) -> f64 + Sync,
        look: impl Fn(&[Vector<D>], &[Vector<D>]) -> P + Send + Sync,
    ) -> Advanced<P> {
        if !self.may_advance() {
            return Advanced::Not;
        }
        let limit = SKIN_FRACTION * self.skin();
        let (pairs, listed) = match self.inner_skin {
            Some(_) => (&self.inner_pairs, &self.inner_at_build),
            None => (&self.pairs, &self.outer_at_build),
        };
        let movers = Movers { velocities, displacements: &mut self.displacements, forces: &mut self.forces };
        let longest = |first: usize, displacements: &[Vector<D>]| {
            longest_difference_squared(displacements, &listed[first..first + displacements.len()]).sqrt()
        };
        let reach = Reach { limit, bounds: &mut self.bounds, longest };
        Advanced::of(advance(&Plain { law: &self.law, pairs }, pairs, (movers, &mut self.across), reach, kick, look))
    }

    /// Forces as in [`Assembly::evaluate`], with energy, virial and contact count.
    pub fn evaluate_totals(&mut self) -> Totals<D> {
        let pairs = in_use(self.inner_skin, &self.inner_pairs, &self.pairs);
        let mut totals =
            elastic::forces_and_totals(&self.law, pairs, &self.displacements, &mut self.across, &mut self.forces);
        if self.law.has_sites() {
            totals.on_site_energy = self.add_on_site_forces();
            totals.energy += totals.on_site_energy;
        }
        totals
    }

    /// Adds Γ u to the forces on mobile disks. Returns their energy −(Γ/2) Σ u².
    fn add_on_site_forces(&mut self) -> f64 {
        let coupling = self.law.on_site_coupling();
        let mut squares = 0.0;
        for index in 0..self.mobile_count {
            let away = self.way_from_site(index);
            squares += dot(away, away);
            for d in 0..D {
                self.forces[index][d] += coupling * away[d];
            }
        }
        -0.5 * coupling * squares
    }

    /// Displacement of a mobile disk from its site, rounded relative to itself; 0 for a law without sites \[length\].
    pub fn way_from_site(&self, index: usize) -> Vector<D> {
        self.from_sites
            .get(index)
            .map_or([0.0; D], |from| std::array::from_fn(|d| (from[d].0 + self.displacements[index][d]) + from[d].1))
    }

    /// The largest displacement of a mobile disk from its site \[length\].
    pub fn longest_way_from_site(&self) -> f64 {
        let squared = (0..self.from_sites.len()).map(|index| dot(self.way_from_site(index), self.way_from_site(index)));
        squared.fold(0.0, |most, value| if value > most { value } else { most }).sqrt()
    }

    /// Stores the present positions, for [`Assembly::restore`].
    pub fn set_checkpoint(&mut self) {
        self.checkpoint.clone_from(&self.displacements);
    }

    /// Restores the positions of the last checkpoint; without one, nothing changes.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub fn restore(&mut self) -> Result<(), PackingError> {
        if self.checkpoint.is_empty() {
            return Ok(());
        }
        self.displacements.clone_from(&self.checkpoint);
        self.keep_listed(f64::INFINITY).map(|_| ())
    }

    /// Largest displacement of a disk from its anchor \[length\]. The rounding of overlaps is relative to it.
    pub fn longest_displacement(&self) -> f64 {
        let squared = self.displacements[..self.mobile_count].iter().map(|&u| dot(u, u));
        squared.fold(0.0, |most, value| if value > most { value } else { most }).sqrt()
    }

    /// Moves the anchors to the present positions and rebuilds the list; the disks do not move.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub fn reanchor(&mut self) -> Result<(), PackingError> {
        self.rebuild()
    }

    fn rebuild(&mut self) -> Result<(), PackingError> {
        let anchors = self.anchors[..self.mobile_count].chunks_mut(PIECE);
        let displacements = self.displacements[..self.mobile_count].chunks_mut(PIECE);
        // Arrays are empty where the assembly does not need them.
        let checkpoint = self.checkpoint.chunks_mut(PIECE).chain(repeat_with(Default::default));
        let from_sites = self.from_sites.chunks_mut(PIECE).chain(repeat_with(Default::default));
        let pieces = anchors.zip(displacements).zip(checkpoint.zip(from_sites));
        parallel::each(pieces, |((anchors, displacements), (checkpoint, from_sites))| {
            for (index, (anchor, displacement)) in anchors.iter_mut().zip(displacements).enumerate() {
                let mut nowhere = [0.0; D];
                let saved = checkpoint.get_mut(index).unwrap_or(&mut nowhere);
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
        let law = self.law;
        let (mut pairs, mut room) = (std::mem::take(&mut self.pairs), std::mem::take(&mut self.list_room));
        let built = build_pairs(&self.disks(), self.skin, |a, b| law.coefficient(a, b), &mut room, &mut pairs);
        (self.pairs, self.list_room) = (pairs, room);
        built.map_err(|error| match error {
            PackingError::CoincidentCentres { first, second } => {
                let (a, b) = (self.order[first] as usize, self.order[second] as usize);
                PackingError::CoincidentCentres { first: a.min(b), second: a.max(b) }
            }
            other => other,
        })?;
        self.begin_outer_list();
        self.rebuild_count += 1;
        Ok(())
    }

    /// The disks as seen by the list builder.
    fn disks(&self) -> Disks<'_, D> {
        Disks {
            domain: &self.domain,
            anchors: &self.anchors,
            displacements: &self.displacements,
            radii: &self.radii,
            mobile_count: self.mobile_count,
        }
    }

    /// Upper bound on the largest eigenvalue of the stiffness matrix (masses 1), by Gershgorin's theorem \[1 / time²\].
    ///
    /// Sites shift every eigenvalue by −Γ. The bound adds |Γ| for either sign, so that unstable disks also move in
    /// small steps.
    pub fn stiffness_bound(&self, row: &mut Vec<f64>) -> f64 {
        let bound = self.row_bound(row, None);
        bound + self.law.on_site_coupling().abs()
    }

    /// Upper bound on the largest eigenvalue of a contact matrix with this weight per contact, or with the stiffness of
    /// each contact.
    pub fn row_bound(&self, row: &mut Vec<f64>, weight: Option<&Weight<'_>>) -> f64 {
        row.resize(self.len(), 0.0);
        stiffness_rows(&self.law, self.pairs(), &self.displacements, self.mobile_count, weight, row);
        row[..self.mobile_count].iter().fold(0.0, |most, &value| if value > most { value } else { most })
    }
}

/// The inner list if its skin is set, otherwise the outer list.
fn in_use<'a, const D: usize>(inner_skin: Option<f64>, near: &'a PairList<D>, all: &'a PairList<D>) -> &'a PairList<D> {
    if inner_skin.is_some() { near } else { all }
}

/// Origin of the anchors, and the domain relative to it. In a periodic box it is the corner. In the open plane it is
/// the origin of the plane. If all disks lie far on one side of that origin, it is a corner of the disks, so that
/// distances keep their accuracy.
fn origin_and_domain<const D: usize>(packing: &Packing<D>) -> (Vector<D>, Domain<D>) {
    match packing.domain() {
        Domain::Periodic { corner, lengths } => (*corner, Domain::Periodic { corner: [0.0; D], lengths: *lengths }),
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
