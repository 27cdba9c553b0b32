//! [`Assembly`]: a packing laid out for the hot loop, with its forces and its neighbour list.
//!
//! Three parts: where the disks stand (`Layout`), their displacements and forces, and the lists of pairs
//! (`ListKeeper`). A relaxer moves the displacements, records by how much, and evaluates the forces.

use std::ops::{Range, RangeInclusive};
use std::sync::Arc;

use crate::forces::advance::{Advanced, Movers, Reach, advance};
use crate::forces::elastic;
use crate::forces::elastic::{BorderForces, Plain};
use crate::forces::layout::Layout;
use crate::forces::stiffness_bound::{Weight, stiffness_rows};
use crate::forces::totals::Totals;
use crate::law::pair_law::PairLaw;
use crate::neighbours::displacement_bounds::DisplacementBounds;
use crate::neighbours::list_keeper::{Kept, ListKeeper, ListNumber};
use crate::neighbours::pair_list::PairList;
use crate::packing::{Packing, PackingError};
use crate::vector::{Vector, dot, longest_difference_squared};

/// Width of the skin over the smallest radius \[1\]. A different skin changes the speed and, through the order of the
/// sums, the last digits. With a wider skin, lists last longer but contain more pairs without contact.
pub const SKIN: f64 = 0.5;

/// Width of the narrowest skin of a long list with incremental updates. Such a list need not last for the few fast
/// disks.
const UPDATED_SKIN: f64 = 0.2;

/// A packing under a contact law, in working order.
#[derive(Debug, Clone)]
pub struct Assembly<const D: usize> {
    law: Arc<dyn PairLaw>,
    layout: Layout<D>,
    lists: ListKeeper<D>,
    /// Forces of pairs whose second disks are in other tiles.
    border_forces: BorderForces<f64, D>,
    /// Displacements that the relaxer can restore, if it has set a checkpoint.
    checkpoint: Vec<Vector<D>>,
    /// Centre minus anchor of each disk; a relaxer moves the first [`Assembly::mobile_count`] disks \[length\].
    pub displacements: Vec<Vector<D>>,
    /// Forces of the last evaluation, all disks \[force\].
    pub forces: Vec<Vector<D>>,
}

impl<const D: usize> Assembly<D> {
    /// Lays out a packing and builds its neighbour list.
    ///
    /// # Errors
    /// A box too small for the minimum-image convention, or two disks with the same centre (named by the caller's
    /// indices).
    pub fn new(packing: &Packing<D>, law: &dyn PairLaw) -> Result<Self, PackingError> {
        Self::with_skin(packing, law, SKIN)
    }

    /// Like [`Assembly::new`], with an inner list and incremental updates ([`Assembly::set_pruning`]). The lists of a
    /// large packing have a narrower skin, unless all disks move.
    ///
    /// # Errors
    /// As in [`Assembly::new`].
    pub fn with_incremental_updates(packing: &Packing<D>, law: &dyn PairLaw) -> Result<Self, PackingError> {
        let narrowest = if PairList::<D>::are_long(packing.len()) { UPDATED_SKIN } else { SKIN };
        Self::with_skins(packing, law, narrowest..=SKIN)
    }

    /// Like [`Assembly::new`], with another width of the skin, over the smallest radius \[1\].
    ///
    /// # Errors
    /// As in [`Assembly::new`].
    pub fn with_skin(packing: &Packing<D>, law: &dyn PairLaw, skin: f64) -> Result<Self, PackingError> {
        Self::with_skins(packing, law, skin..=skin)
    }

    fn with_skins(packing: &Packing<D>, law: &dyn PairLaw, skins: RangeInclusive<f64>) -> Result<Self, PackingError> {
        let (layout, displacements) = Layout::of(packing, law.has_sites());
        let smallest_radius = layout.radii.iter().copied().fold(f64::INFINITY, f64::min);
        let largest = layout.radii.iter().copied().fold(0.0, f64::max);
        // The list contains one image per pair, so its range stays below half of the shortest side.
        let shortest = packing.domain().lengths().map(|lengths| lengths.iter().copied().fold(f64::INFINITY, f64::min));
        let most = shortest.map_or(f64::INFINITY, |shortest| (0.5 * shortest - 2.0 * largest).max(0.0));
        let [narrowest, widest] = [skins.start(), skins.end()].map(|skin| most.min(skin * smallest_radius));
        let mut assembly = Assembly {
            law: law.shared(),
            layout,
            lists: ListKeeper::new(smallest_radius, narrowest..=widest),
            border_forces: BorderForces::default(),
            checkpoint: Vec::new(),
            displacements,
            forces: vec![[0.0; D]; packing.len()],
        };
        assembly.reanchor()?;
        Ok(assembly)
    }

    /// The given packing, with its disks at the present positions.
    ///
    /// # Panics
    /// If `packing` has another number of disks than the packing of the assembly.
    pub fn placed(&self, mut packing: Packing<D>) -> Packing<D> {
        assert_eq!(packing.len(), self.len(), "an assembly belongs to the packing it was made from");
        if self.has_on_site_forces() && packing.sites().is_none() {
            packing = packing.with_sites_here();
        }
        self.layout.placed(packing, &self.displacements)
    }

    /// Number of disks.
    pub fn len(&self) -> usize {
        self.layout.order.len()
    }

    /// Always false: a packing has at least one disk.
    pub fn is_empty(&self) -> bool {
        self.layout.order.is_empty()
    }

    /// Number of mobile disks; they come first.
    pub fn mobile_count(&self) -> usize {
        self.layout.mobile_count
    }

    /// The caller's index of each disk in working order.
    pub fn order(&self) -> &[u32] {
        &self.layout.order
    }

    /// Radii in working order \[length\].
    pub fn radii(&self) -> &[f64] {
        &self.layout.radii
    }

    /// Rounded position of a disk, relative to the assembly's own origin \[length\].
    pub fn place(&self, index: usize) -> Vector<D> {
        self.layout.place(index, &self.displacements)
    }

    /// The contact law.
    pub fn law(&self) -> &dyn PairLaw {
        self.law.as_ref()
    }

    /// The contact law, as a shared pointer.
    pub(crate) fn shared_law(&self) -> Arc<dyn PairLaw> {
        Arc::clone(&self.law)
    }

    /// The neighbour list in use: every pair that may touch before the list is changed.
    pub fn pairs(&self) -> &PairList<D> {
        self.lists.in_use()
    }

    /// Number of builds of the outer list, the first one included.
    pub fn build_count(&self) -> usize {
        self.lists.build_count()
    }

    /// Width of the skin of the list in use \[length\].
    pub fn skin(&self) -> f64 {
        self.lists.skin()
    }

    /// Displacement that every disk can still make, at least, before the list expires \[length\].
    pub fn remaining_displacement(&self) -> f64 {
        self.lists.remaining_displacement()
    }

    /// Evaluates the forces at the present displacements into [`Assembly::forces`].
    pub fn evaluate(&mut self) {
        elastic::forces(
            self.law.as_ref(),
            self.lists.in_use(),
            &self.displacements,
            &mut self.border_forces,
            &mut self.forces,
        );
        if self.has_on_site_forces() {
            let _ = self.add_on_site_forces();
        }
    }

    /// Moves the mobile disks, evaluates the forces at their new positions and observes them, tile by tile. The caller
    /// must then call [`Assembly::update_list_after_advance`]. If the list is no longer complete at the new positions, the disks are only
    /// moved.
    ///
    /// # Shape
    /// `velocities` has one entry per mobile disk. `kick` takes (forces, velocities, displacements) of some mobile
    /// disks and returns a bound on their displacements \[length\]. `observe` takes (forces, velocities). Each mobile disk
    /// occurs once.
    pub fn advance<P: Send>(
        &mut self,
        velocities: &mut [Vector<D>],
        kick: impl Fn(&[Vector<D>], &mut [Vector<D>], &mut [Vector<D>]) -> f64 + Sync,
        observe: impl Fn(&[Vector<D>], &[Vector<D>]) -> P + Send + Sync,
    ) -> Advanced<P> {
        if !self.may_advance() {
            return Advanced::Not;
        }
        let (pairs, reference, limit, bounds) = self.lists.listing();
        let movers = Movers { velocities, displacements: &mut self.displacements, forces: &mut self.forces };
        let longest = |first: usize, displacements: &[Vector<D>]| {
            longest_difference_squared(displacements, &reference[first..first + displacements.len()]).sqrt()
        };
        let reach = Reach { limit, bounds, longest };
        Advanced::of(advance(
            &Plain { law: self.law.as_ref(), pairs },
            pairs,
            (movers, &mut self.border_forces),
            reach,
            kick,
            observe,
        ))
    }

    /// Forces as in [`Assembly::evaluate`], with energy, virial and contact count.
    pub fn evaluate_totals(&mut self) -> Totals<D> {
        let pairs = self.lists.in_use();
        let mut totals = elastic::forces_and_totals(
            self.law.as_ref(),
            pairs,
            &self.displacements,
            &mut self.border_forces,
            &mut self.forces,
        );
        if self.has_on_site_forces() {
            totals.on_site_energy = self.add_on_site_forces();
            totals.energy += totals.on_site_energy;
        }
        totals
    }

    /// Whether mobile disks have forces besides those of contacts and damping: sites with Γ, or loads.
    pub fn has_on_site_forces(&self) -> bool {
        self.layout.site_count() > 0
    }

    /// Adds Γ u and the load f to the forces on mobile disks. Returns their energy −Σ (Γ u²/2 + f·u).
    fn add_on_site_forces(&mut self) -> f64 {
        let coupling = self.law.on_site_coupling();
        let (mut squares, mut work) = (0.0, 0.0);
        for index in 0..self.mobile_count() {
            let (away, load) = (self.displacement_from_site(index), self.layout.load(index));
            squares += dot(away, away);
            work += dot(load, away);
            for d in 0..D {
                self.forces[index][d] += coupling * away[d] + load[d];
            }
        }
        -0.5 * coupling * squares - work
    }

    /// Displacement of a mobile disk from its site, rounded relative to itself; 0 without sites \[length\].
    pub fn displacement_from_site(&self, index: usize) -> Vector<D> {
        self.layout.displacement_from_site(index, &self.displacements)
    }

    /// The largest displacement of a mobile disk from its site \[length\].
    pub fn longest_displacement_from_site(&self) -> f64 {
        let from_sites = (0..self.layout.site_count()).map(|index| self.displacement_from_site(index));
        let squared = from_sites.map(|away| dot(away, away));
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
        // No bound is known, so the displacements are computed, and the list is rebuilt only if it has expired.
        self.update_list(f64::INFINITY).map(|_| ())
    }

    /// Largest displacement of a disk from its anchor \[length\]. The rounding of overlaps is relative to it.
    pub fn longest_displacement(&self) -> f64 {
        let squared = self.displacements[..self.mobile_count()].iter().map(|&u| dot(u, u));
        squared.fold(0.0, |most, value| if value > most { value } else { most }).sqrt()
    }

    /// Moves the anchors to the present positions and rebuilds the list; the disks do not move.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub fn reanchor(&mut self) -> Result<(), PackingError> {
        self.layout.absorb(&mut self.displacements, &mut self.checkpoint);
        let law = &self.law;
        let built = self.lists.build(&self.layout.disks(&self.displacements), &|a, b| law.coefficient(a, b));
        built.map_err(|error| self.layout.in_callers_order(error))
    }

    /// Sets whether an inner list is used while disks move slowly. The caller must call [`Assembly::update_list`] once
    /// per evaluation. Data that the caller keeps for each pair must be rebuilt whenever that call returns true.
    pub fn set_pruning(&mut self, prunes: bool) {
        self.lists.set_pruning(&self.layout.disks(&self.displacements), prunes);
    }

    /// Records that no disk has moved by more than `bound` since the last call, and changes the list if necessary.
    /// Returns whether the list has changed.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub fn update_list(&mut self, bound: f64) -> Result<bool, PackingError> {
        self.lists.add_step(bound);
        self.keep()
    }

    /// Changes the list if necessary, after a step whose displacements [`Assembly::advance`] has recorded. It also
    /// updates a list that the next step may exceed. Returns whether the list has changed.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub fn update_list_after_advance(&mut self) -> Result<bool, PackingError> {
        if self.keep()? {
            return Ok(true);
        }
        let law = &self.law;
        Ok(self.lists.update_ahead(&self.layout.disks(&self.displacements), &|a, b| law.coefficient(a, b)))
    }

    fn keep(&mut self) -> Result<bool, PackingError> {
        let law = &self.law;
        let disks = self.layout.disks(&self.displacements);
        match self.lists.keep(&disks, &|a, b| law.coefficient(a, b)) {
            Kept::Unchanged => Ok(false),
            Kept::Changed => Ok(true),
            Kept::Expired { best_inner_skin } => {
                self.reanchor()?;
                self.lists.prune_to(&self.layout.disks(&self.displacements), best_inner_skin);
                Ok(true)
            }
        }
    }

    /// Whether [`Assembly::advance`] does anything. It does not before a speed check of a short list: if the list is
    /// pruned then, the order of the force sums changes.
    pub(crate) fn may_advance(&self) -> bool {
        !self.has_on_site_forces() && (self.pairs().is_long() || !self.lists.checks_next())
    }

    /// Whether the next call of [`Assembly::update_list`] checks the speed of the disks.
    pub(crate) fn checks_next(&self) -> bool {
        self.lists.checks_next()
    }

    /// Identifies the list in use.
    pub(crate) fn list_number(&self) -> ListNumber {
        self.lists.list_number()
    }

    /// The list in use, the reference displacements of its disks, its limit, and the displacement bounds.
    pub(crate) fn listing(&mut self) -> (&PairList<D>, &[Vector<D>], f64, &mut DisplacementBounds) {
        self.lists.listing()
    }

    /// The disks that [`Assembly::update_list_after_advance`] checks after a step for which the list was complete.
    pub(crate) fn disks_to_check(&self) -> Vec<Range<usize>> {
        self.lists.disks_to_check()
    }

    #[cfg(test)]
    pub(crate) fn lists(&self) -> &ListKeeper<D> {
        &self.lists
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
        stiffness_rows(self.law.as_ref(), self.pairs(), &self.displacements, self.mobile_count(), weight, row);
        row[..self.mobile_count()].iter().fold(0.0, |most, &value| if value > most { value } else { most })
    }
}
