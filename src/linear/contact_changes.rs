//! Changes of contacts and of the pressure in a linear response.
//!
//! ```text
//! dr_ij = n·(u_i − u_j)        dδ_ij = −dr_ij + [i or j grows]        dF_ij = F' dδ_ij + F ∂ln c/∂R_0 [i or j grows]
//! d(p D V) = Σ (dF_ij r_ij + F_ij dr_ij)
//! ```
//!
//! Contacts with rattlers are excluded: their forces vanish under any load.

use crate::law::pair_law::PairLaw;
use crate::linear::response::LinearResponse;
use crate::network::ContactNetwork;
use crate::packing::{Packing, PackingError};
use crate::vector::{Vector, difference, dot, norm, scaled, sum};

/// One contact in a linear response, per unit of the load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactChange {
    /// First disk.
    pub first: u32,
    /// Second disk.
    pub second: u32,
    /// Overlap δ before \[length\].
    pub overlap: f64,
    /// Change of the overlap, dδ, per d_0 \[1\] if a disk grows, otherwise \[length\].
    pub overlap_change: f64,
    /// Change of the contact force, dF, per d_0 \[force / length\] if a disk grows, otherwise \[force\].
    pub force_change: f64,
    /// Change of F r, the contribution to the virial, per d_0 \[force\] if a disk grows, otherwise \[energy\].
    pub virial_change: f64,
}

impl ContactChange {
    /// The load at which the overlap vanishes by linear extrapolation: d_0 \[length\] if a disk grows, otherwise a
    /// multiple of the load \[1\]. None if the overlap does not shrink.
    pub fn opens_at(&self) -> Option<f64> {
        (self.overlap_change < 0.0).then(|| -self.overlap / self.overlap_change)
    }
}

impl<const D: usize> LinearResponse<D> {
    fn grows(&self, disk: usize) -> bool {
        self.growing.binary_search(&disk).is_ok()
    }

    /// The changes of all contacts, in ascending order of (first, second).
    ///
    /// `packing` and `law` are those of the response.
    ///
    /// # Errors
    /// See [`ContactNetwork::new`].
    ///
    /// # Panics
    /// If the packing has another number of disks.
    pub fn contact_changes(&self, packing: &Packing<D>, law: &dyn PairLaw) -> Result<Vec<ContactChange>, PackingError> {
        assert_eq!(packing.len(), self.displacements.len(), "a response belongs to the packing it was made from");
        let network = ContactNetwork::new(packing, law)?;
        let (radii, held) = (packing.radii(), packing.held());
        // A disk pinned for the solution has no row of its own; the growing disk is always included.
        let there = |disk: usize| self.solved[disk] || held[disk] || self.grows(disk) || network.backbone[disk];
        let changes = network.contacts.iter().filter_map(|contact| {
            let (i, j) = (contact.first as usize, contact.second as usize);
            if !(there(i) && there(j)) {
                return None;
            }
            let distance = norm(contact.separation);
            let moved = difference(self.displacements[i], self.displacements[j]);
            let distance_change = dot(moved, contact.separation) / distance;
            let (mut growth, mut coefficient_growth) = (0.0, 0.0);
            for (disk, other) in [(i, j), (j, i)].into_iter().filter(|&(disk, _)| self.grows(disk)) {
                growth += 1.0;
                coefficient_growth += law.coefficient_growth(radii[disk], radii[other]);
            }
            let overlap_change = growth - distance_change;
            let force_change =
                law.stiffness(contact.force, contact.overlap) * overlap_change + contact.force * coefficient_growth;
            Some(ContactChange {
                first: contact.first,
                second: contact.second,
                overlap: contact.overlap,
                overlap_change,
                force_change,
                virial_change: force_change * distance + contact.force * distance_change,
            })
        });
        Ok(changes.collect())
    }

    /// Change of the total contact force on each disk, per load \[force / length\] if a disk grows, otherwise
    /// \[force\]. On a mobile disk it balances the applied force; on a held disk it is the change of the constraint
    /// force.
    ///
    /// ```text
    /// Σ_(contacts) [dF n + F (1 − n nᵀ)(u_i − u_j)/r_ij]        n from the other disk j to the disk i
    /// ```
    ///
    /// `packing` and `law` are those of the response, with its prestress.
    ///
    /// # Errors
    /// See [`ContactNetwork::new`].
    ///
    /// # Panics
    /// If the packing has another number of disks.
    pub fn force_change(
        &self,
        packing: &Packing<D>,
        law: &dyn PairLaw,
        disk: usize,
    ) -> Result<Vector<D>, PackingError> {
        let network = ContactNetwork::new(packing, law)?;
        let changes = self.contact_changes(packing, law)?;
        let mut contacts = network.contacts.iter().peekable();
        let mut total = [0.0; D];
        for change in changes {
            let pair = (change.first, change.second);
            while contacts.next_if(|contact| (contact.first, contact.second) < pair).is_some() {}
            let ends = (change.first as usize, change.second as usize);
            let Some(contact) = contacts.next() else { break };
            let sign = match disk {
                _ if disk == ends.0 => 1.0,
                _ if disk == ends.1 => -1.0,
                _ => continue,
            };
            let distance = norm(contact.separation);
            let along = scaled(1.0 / distance, contact.separation);
            let moved = difference(self.displacements[ends.0], self.displacements[ends.1]);
            let across = difference(moved, scaled(dot(moved, along), along));
            let force = sum(scaled(change.force_change, along), scaled(contact.force / distance, across));
            total = sum(total, scaled(sign, force));
        }
        Ok(total)
    }
}

/// Change of the pressure in a volume. Contacts with one end for which `rim` is true count half, as in
/// [`ContactNetwork::cluster_pressure`]. Per d_0 \[force / length^D\] if a disk grows, otherwise \[force /
/// length^(D−1)\].
pub fn pressure_change<const D: usize>(changes: &[ContactChange], volume: f64, rim: impl Fn(usize) -> bool) -> f64 {
    let half = |change: &ContactChange| rim(change.first as usize) || rim(change.second as usize);
    let virial: f64 = changes.iter().map(|change| if half(change) { 0.5 } else { 1.0 } * change.virial_change).sum();
    virial / (D as f64 * volume)
}
