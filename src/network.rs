//! [`ContactNetwork`]: contacts, rattlers, backbone, coordination and pressure.
//!
//! A rattler is a mobile disk with fewer than D + 1 contacts. Its removal may make other disks rattlers, so removal is
//! repeated until no rattler is left. The remaining disks are the backbone. It is the largest set in which every disk
//! has D + 1 contacts with disks of the set or held disks. The order of removal does not matter.
//!
//! # Source
//! Goodrich, Liu, Nagel (2012), Phys. Rev. Lett. 109, 095704.

use crate::forces::assembly::Assembly;
use crate::forces::block_arithmetic::Columns;
use crate::forces::elastic::fill;
use crate::law::pair_law::PairLaw;
use crate::packing::{Packing, PackingError};
use crate::vector::{Vector, norm};

/// A contact of two disks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact<const D: usize> {
    /// First disk.
    pub first: u32,
    /// Second disk.
    pub second: u32,
    /// Overlap δ > 0 \[length\].
    pub overlap: f64,
    /// Force F(δ) \[force\].
    pub force: f64,
    /// Energy u(δ) \[energy\].
    pub energy: f64,
    /// From the centre of the second to that of the first \[length\].
    pub separation: Vector<D>,
}

/// All contacts of a packing and the quantities derived from them.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactNetwork<const D: usize> {
    /// Contacts, except those of two held disks, in ascending order of (first, second).
    pub contacts: Vec<Contact<D>>,
    /// Whether each disk belongs to the backbone; held disks do.
    pub backbone: Vec<bool>,
    held: Vec<bool>,
    forces: Vec<Vector<D>>,
    on_site_energy: f64,
}

/// The backbone: the disks that remain after rattlers are removed, with all held disks.
///
/// # Shape
/// One entry per disk; `contacts` contains pairs of indices below `held.len()`.
///
/// # Cost
/// Linear in disks and contacts.
pub fn backbone<const D: usize>(held: &[bool], contacts: &[(u32, u32)]) -> Vec<bool> {
    let mut remains = vec![true; held.len()];
    Peeling::default().peel::<D>(|disk| held[disk], contacts, &mut remains);
    remains
}

/// Work space for finding a backbone, reused between calls.
#[derive(Debug, Clone, Default)]
pub struct Peeling {
    /// Start of the neighbours of each disk, and the end of the last.
    starts: Vec<u32>,
    next: Vec<u32>,
    neighbours: Vec<u32>,
    /// Number of contacts with disks that are not removed yet.
    degree: Vec<u32>,
    pending: Vec<u32>,
}

impl Peeling {
    /// Like [`backbone`]; overwrites `remains`, which has one entry per disk.
    pub fn peel<const D: usize>(
        &mut self,
        held: impl Fn(usize) -> bool,
        contacts: &[(u32, u32)],
        remains: &mut [bool],
    ) {
        let Peeling { starts, next, neighbours, degree, pending } = self;
        let count = remains.len();
        degree.clear();
        degree.resize(count, 0);
        for &(first, second) in contacts {
            degree[first as usize] += 1;
            degree[second as usize] += 1;
        }
        starts.resize(count + 1, 0);
        let mut total = 0;
        for (start, &degree) in starts.iter_mut().zip(&*degree) {
            *start = total;
            total += degree;
        }
        starts[count] = total;
        next.clone_from(starts);
        neighbours.resize(2 * contacts.len(), 0);
        for &(first, second) in contacts {
            for (a, b) in [(first, second), (second, first)] {
                neighbours[next[a as usize] as usize] = b;
                next[a as usize] += 1;
            }
        }
        let least = D as u32 + 1;
        pending.clear();
        for (disk, remains) in remains.iter_mut().enumerate() {
            *remains = held(disk) || degree[disk] >= least;
            if !*remains {
                pending.push(disk as u32);
            }
        }
        while let Some(disk) = pending.pop() {
            for &other in &neighbours[starts[disk as usize] as usize..starts[disk as usize + 1] as usize] {
                let disk = other as usize;
                degree[disk] -= 1;
                if remains[disk] && !held(disk) && degree[disk] < least {
                    remains[disk] = false;
                    pending.push(other);
                }
            }
        }
    }
}

impl<const D: usize> ContactNetwork<D> {
    /// The contacts of a packing under a law, in the caller's numbering.
    ///
    /// # Errors
    /// As in [`Assembly::new`].
    pub fn new(packing: &Packing<D>, law: &dyn PairLaw) -> Result<Self, PackingError> {
        let mut assembly = Assembly::new(packing, law)?;
        let on_site_energy = assembly.evaluate_totals().on_site_energy;
        let order = assembly.order();
        let mut contacts: Vec<Contact<D>> = working_contacts(&assembly)
            .into_iter()
            .map(|contact| {
                let (a, b) = (order[contact.first as usize], order[contact.second as usize]);
                if a < b {
                    Contact { first: a, second: b, ..contact }
                } else {
                    let separation = std::array::from_fn(|d| -contact.separation[d]);
                    Contact { first: b, second: a, separation, ..contact }
                }
            })
            .collect();
        contacts.sort_unstable_by_key(|contact| (contact.first, contact.second));
        let links: Vec<(u32, u32)> = contacts.iter().map(|contact| (contact.first, contact.second)).collect();
        let mut forces = vec![[0.0; D]; packing.len()];
        for (&disk, force) in order.iter().zip(&assembly.forces) {
            forces[disk as usize] = *force;
        }
        Ok(ContactNetwork {
            backbone: backbone::<D>(packing.held(), &links),
            contacts,
            held: packing.held().to_vec(),
            forces,
            on_site_energy,
        })
    }

    /// Net elastic force on each disk, plus the force of its site and its load \[force\].
    pub fn forces(&self) -> &[Vector<D>] {
        &self.forces
    }

    /// Largest net force on a mobile disk \[force\]; NaN if any force is NaN.
    pub fn largest_net_force(&self) -> f64 {
        let mobile = self.forces.iter().zip(&self.held).filter(|(_, held)| !**held);
        mobile.fold(0.0, |most, (force, _)| crate::vector::larger(norm(*force), most))
    }

    /// Elastic energy of the contacts \[energy\].
    pub fn energy(&self) -> f64 {
        total(self.contacts.iter().map(|contact| contact.energy))
    }

    /// Energy of sites and loads, −Σ (Γ u²/2 + f·u); 0 without them \[energy\].
    pub fn on_site_energy(&self) -> f64 {
        self.on_site_energy
    }

    /// Mobile disks that are not on the backbone.
    pub fn rattlers(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.held.len()).filter(|&disk| !self.backbone[disk])
    }

    /// Number of mobile disks on the backbone.
    pub fn backbone_count(&self) -> usize {
        self.backbone.iter().zip(&self.held).filter(|&(&member, &held)| member && !held).count()
    }

    /// Whether both disks of a contact belong to the backbone.
    pub fn on_backbone(&self, contact: &Contact<D>) -> bool {
        self.backbone[contact.first as usize] && self.backbone[contact.second as usize]
    }

    /// Contacts between disks of the backbone.
    pub fn backbone_contacts(&self) -> impl Iterator<Item = &Contact<D>> + '_ {
        self.contacts.iter().filter(|contact| self.on_backbone(contact))
    }

    /// Mean number of contacts of a mobile disk of the backbone, Z; 0 without a backbone \[1\].
    pub fn coordination(&self) -> f64 {
        let count = self.backbone_count();
        if count == 0 {
            return 0.0;
        }
        self.backbone_end_count() as f64 / count as f64
    }

    /// Number of contacts of the backbone, counted once for each mobile disk: two per contact, one if the other disk is
    /// held.
    pub fn backbone_end_count(&self) -> usize {
        let mobile = |disk: u32| usize::from(!self.held[disk as usize]);
        self.backbone_contacts().map(|contact| mobile(contact.first) + mobile(contact.second)).sum()
    }

    /// Mean force of the contacts of the backbone; 0 without a backbone \[force\].
    pub fn mean_contact_force(&self) -> f64 {
        let (count, total) =
            self.backbone_contacts().fold((0usize, 0.0), |(count, total), contact| (count + 1, total + contact.force));
        if count == 0 { 0.0 } else { total / count as f64 }
    }

    /// Virial tensor over a volume, positive in compression \[force / length^(D−1)\].
    ///
    /// ```text
    /// σ_ab = Σ F r_a r_b / (r V)        p = tr σ / D
    /// ```
    pub fn stress(&self, volume: f64) -> [[f64; D]; D] {
        let mut stress = [[0.0; D]; D];
        for contact in &self.contacts {
            let factor = contact.force / norm(contact.separation);
            for a in 0..D {
                for b in 0..D {
                    stress[a][b] += factor * (contact.separation[a] * contact.separation[b]);
                }
            }
        }
        stress.map(|row| row.map(|value| value / volume))
    }

    /// Share of each disk in the virial tensor, half of every contact \[force · length\]. The sum over all disks, divided
    /// by the volume, is [`stress`](ContactNetwork::stress) up to rounding.
    ///
    /// ```text
    /// s_ab = ½ Σ F r_a r_b / r        over the contacts of the disk
    /// ```
    ///
    /// # Shape
    /// One tensor a disk.
    pub fn disk_virials(&self) -> Vec<[[f64; D]; D]> {
        let mut virials = vec![[[0.0; D]; D]; self.held.len()];
        for contact in &self.contacts {
            let factor = 0.5 * contact.force / norm(contact.separation);
            for disk in [contact.first, contact.second] {
                for a in 0..D {
                    for b in 0..D {
                        virials[disk as usize][a][b] += factor * (contact.separation[a] * contact.separation[b]);
                    }
                }
            }
        }
        virials
    }

    /// Number of contacts of each disk.
    pub fn contact_counts(&self) -> Vec<u32> {
        let mut counts = vec![0; self.held.len()];
        for contact in &self.contacts {
            counts[contact.first as usize] += 1;
            counts[contact.second as usize] += 1;
        }
        counts
    }

    /// Pressure p = Σ F r / (D V) \[force / length^(D−1)\].
    pub fn pressure(&self, volume: f64) -> f64 {
        let virial = total(self.contacts.iter().map(|contact| contact.force * norm(contact.separation)));
        virial / (D as f64 * volume)
    }

    /// Pressure of a cluster of disks with a held rim \[force / length^(D−1)\]. Contacts with one end for which `rim`
    /// is true count half.
    pub fn cluster_pressure(&self, volume: f64, rim: impl Fn(usize) -> bool) -> f64 {
        let virial = total(self.contacts.iter().map(|contact| {
            let share = if rim(contact.first as usize) || rim(contact.second as usize) { 0.5 } else { 1.0 };
            share * contact.force * norm(contact.separation)
        }));
        virial / (D as f64 * volume)
    }
}

/// Sum of values in their order. The sum of no values is 0; [`Iterator::sum`] would give −0.
fn total(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |sum, value| sum + value)
}

/// The contacts of an assembly, in working numbering and list order.
pub fn working_contacts<const D: usize>(assembly: &Assembly<D>) -> Vec<Contact<D>> {
    let law = assembly.law();
    let mut contacts = Vec::with_capacity(assembly.pairs().len());
    each_contact(assembly, |(first, second), columns, place| {
        let (overlap, force) = (columns.overlap[place], columns.force[place]);
        let separation = columns.separation.each_ref().map(|column| column[place]);
        contacts.push(Contact { first, second, overlap, force, energy: law.energy(force, overlap), separation });
    });
    contacts
}

/// The contacts of an assembly, with the data that a backbone needs, in working numbering and list order. The buffers
/// are reused between checks.
#[derive(Debug, Clone, Default)]
pub struct Links {
    /// The disks of each contact.
    pub ends: Vec<(u32, u32)>,
    /// Its force \[force\].
    pub forces: Vec<f64>,
}

impl Links {
    /// Overwrites them by the present contacts of an assembly.
    pub fn take<const D: usize>(&mut self, assembly: &Assembly<D>) {
        let pairs = assembly.pairs();
        self.ends.resize(pairs.len(), (0, 0));
        self.forces.resize(pairs.len(), 0.0);
        let mut columns = Columns::new();
        let mut count = 0;
        for block in &pairs.blocks {
            fill(assembly.law(), pairs, (&assembly.displacements, 0), block, &mut columns);
            let listed = block.pairs..block.pairs + block.pair_count;
            let ends = pairs.first[listed.clone()].iter().zip(&pairs.second[listed]);
            let values = columns.overlap.iter().zip(&columns.force);
            for ((&first, &second), (&overlap, &force)) in ends.zip(values) {
                // The outcome is unpredictable, so contacts are selected without a branch.
                self.ends[count] = (first, second);
                self.forces[count] = force;
                count += usize::from(overlap > 0.0);
            }
        }
        self.ends.truncate(count);
        self.forces.truncate(count);
    }
}

/// Calls a function of (disks, columns of the block, place in the columns) for every contact, in list order.
fn each_contact<const D: usize>(assembly: &Assembly<D>, mut call: impl FnMut((u32, u32), &Columns<D>, usize)) {
    let pairs = assembly.pairs();
    let mut columns = Columns::new();
    for block in &pairs.blocks {
        fill(assembly.law(), pairs, (&assembly.displacements, 0), block, &mut columns);
        for place in 0..block.pair_count {
            if columns.overlap[place] > 0.0 {
                let pair = block.pairs + place;
                call((pairs.first[pair], pairs.second[pair]), &columns, place);
            }
        }
    }
}
