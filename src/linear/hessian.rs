//! [`Hessian`]: second derivatives of the energy of a packing, assembled directly in compressed columns.
//!
//! ```text
//! K_ii = Σ_j B_ij − Γ        K_ij = −B_ij        B = F' n nᵀ − (F/r) (1 − n nᵀ)        n = r_ij/r
//! ```
//!
//! F' n nᵀ is the stiffness of a contact along its line of centres. F/r across it is the *prestress*: pressed disks
//! slip sideways, so it weakens the packing. −Γ is the term of sites ([`OnSite`](crate::law::on_site::OnSite)). K is
//! the negative derivative of the forces. Its unknowns are the D coordinates of each mobile disk with contacts. Held
//! disks and disks without contacts are excluded, since their rows would be zero.
//! without contacts are left out by construction, since their rows would be zero.

use crate::forces::assembly::Assembly;
use crate::law::pair_law::PairLaw;
use crate::neighbours::for_each_pair::{MovedPair, for_each_pair};
use crate::network::backbone;
use crate::packing::{Packing, PackingError};
use crate::sparse::{BlockPattern, Graph, SymmetricMatrix};
use crate::vector::{Vector, dot, scaled};

/// Whether the matrix contains the prestress, which weakens the packing across the contacts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Prestress {
    /// Included: the second derivatives of the energy.
    #[default]
    Included,
    /// Left out: unstretched springs with the stiffness of each contact, the "unstressed" network.
    LeftOut,
}

/// Which mobile disks have rows in the matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Members {
    /// Disks on the backbone; rattlers and their contacts are excluded.
    #[default]
    Backbone,
    /// Disks with a contact.
    InContact,
    /// All mobile disks. The rows of disks without a contact are 0, for matrices whose diagonal is modified later.
    Mobile,
}

/// Second derivatives of the energy of a packing with respect to its unknowns.
///
/// # Shape
/// D rows for each disk of [`Hessian::disks`], coordinate by coordinate.
///
/// # Accuracy
/// An entry is a sum over the contacts of a disk. Each term is exact to a few units in the last place, like overlaps
/// and forces.
///
/// # Cost
/// Linear in the pairs of the list: nine to fifteen evaluations of the forces with totals, from 1 000 to 89 000 disks
/// (`benches/measurements/scaling`).
#[derive(Debug, Clone)]
pub struct Hessian<const D: usize> {
    prestress: Prestress,
    members: Members,
    disks: Vec<u32>,
    /// Block row of each disk in working order; `NONE` for excluded disks.
    blocks: Vec<u32>,
    /// Positions of the disks with rows, relative to an origin of the assembly.
    places: Vec<Vector<D>>,
    disk_count: usize,
    mobile_count: usize,
    /// Held disks in working order; values are indices of the packing.
    held: Vec<u32>,
    links: Vec<Link<D>>,
    /// Ends of the pairs with entries in the pattern.
    near: Vec<(u32, u32)>,
    pattern: BlockPattern,
    matrix: SymmetricMatrix,
}

/// No block row.
const NONE: u32 = u32::MAX;

/// A contact to be added to the matrix.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StiffContact {
    /// Its index in the neighbour list.
    pub pair: usize,
    /// Its disks in working order.
    pub ends: (u32, u32),
    /// F', along the line of centres \[force / length\].
    pub stiffness: f64,
    /// −F/r, across it; 0 without prestress \[force / length\].
    pub across: f64,
}

/// A contact: its disks in working order, and its block B.
#[derive(Debug, Clone, Copy)]
struct Link<const D: usize> {
    ends: (u32, u32),
    block: [Vector<D>; D],
}

impl Prestress {
    /// Stiffness of a contact across its line of centres, −F/r or 0 \[force / length\].
    pub(crate) fn across(self, force: f64, distance: f64) -> f64 {
        match self {
            Prestress::Included => -force / distance,
            Prestress::LeftOut => 0.0,
        }
    }
}

/// B = k n nᵀ + t (1 − n nᵀ) of one contact with stiffness k along its line of centres and t across it.
pub(crate) fn contact_block<const D: usize>(
    stiffness: f64,
    across: f64,
    separation: Vector<D>,
    distance: f64,
) -> [Vector<D>; D] {
    let normal = scaled(1.0 / distance, separation);
    std::array::from_fn(|a| {
        std::array::from_fn(|b| {
            let both = normal[a] * normal[b];
            stiffness * both + across * (f64::from(u8::from(a == b)) - both)
        })
    })
}

impl<const D: usize> Hessian<D> {
    /// The second derivatives at a packing.
    ///
    /// # Errors
    /// As [`Assembly::new`].
    pub fn new(
        packing: &Packing<D>,
        law: &dyn PairLaw,
        members: Members,
        prestress: Prestress,
    ) -> Result<Self, PackingError> {
        Ok(Self::of(&Assembly::new(packing, law)?, members, prestress))
    }

    /// The second derivatives at the present displacements of an assembly.
    pub fn of(assembly: &Assembly<D>, members: Members, prestress: Prestress) -> Self {
        let mut hessian = Hessian {
            prestress,
            members,
            disks: Vec::new(),
            blocks: Vec::new(),
            places: Vec::new(),
            disk_count: assembly.len(),
            mobile_count: assembly.mobile_count(),
            held: assembly.order()[assembly.mobile_count()..].to_vec(),
            links: Vec::new(),
            near: Vec::new(),
            pattern: BlockPattern::default(),
            matrix: SymmetricMatrix::default(),
        };
        hessian.update(assembly);
        hessian
    }

    /// Recomputes the second derivatives after disks have moved. True if the pattern of entries is unchanged, so that
    /// an analysis of the matrix stays valid. The assembly must be the one given first, or one of the same packing.
    pub fn update(&mut self, assembly: &Assembly<D>) -> bool {
        self.update_with(assembly, |contact| (contact.stiffness, contact.across))
    }

    /// Like [`Hessian::update`], with another stiffness along and across each contact.
    pub(crate) fn update_with(
        &mut self,
        assembly: &Assembly<D>,
        weights: impl Fn(&StiffContact) -> (f64, f64),
    ) -> bool {
        self.update_within(assembly, |_| 0.0, 0.0, weights)
    }

    /// Like [`Hessian::update_with`], where pairs with a gap below `reach` also count as contacts. Pairs with a gap up
    /// to `spare` larger get entries of value 0, so that the pattern of later updates is the same.
    pub(crate) fn update_within(
        &mut self,
        assembly: &Assembly<D>,
        reach: impl Fn(usize) -> f64,
        spare: f64,
        weights: impl Fn(&StiffContact) -> (f64, f64),
    ) -> bool {
        self.set_links(assembly, reach, spare, weights);
        let first_time = self.disks.is_empty();
        self.set_members(assembly);
        let blocks = &self.blocks;
        let of_ends = |&(first, second): &(u32, u32)| {
            let (a, b) = (blocks[first as usize], blocks[second as usize]);
            (a != NONE && b != NONE).then(|| (a.max(b), a.min(b)))
        };
        let mut needed = self.links.iter().filter_map(|link| of_ends(&link.ends));
        if spare == 0.0 || first_time || !needed.all(|(row, column)| self.pattern.has(row, column)) {
            self.pattern.set(self.disks.len(), self.near.iter().filter_map(of_ends));
        }
        let same = self.pattern.clear_into::<D>(&mut self.matrix);
        let coupling = assembly.law().on_site_coupling();
        if assembly.law().has_sites() {
            let block: [Vector<D>; D] =
                std::array::from_fn(|a| std::array::from_fn(|b| if a == b { -coupling } else { 0.0 }));
            for row in 0..self.disks.len() as u32 {
                self.pattern.add_diagonal(&mut self.matrix, row, &block);
            }
        }
        let left_out = |disk: u32| disk < assembly.mobile_count() as u32 && self.blocks[disk as usize] == NONE;
        for link in &self.links {
            if left_out(link.ends.0) || left_out(link.ends.1) {
                continue;
            }
            let (a, b) = (self.blocks[link.ends.0 as usize], self.blocks[link.ends.1 as usize]);
            for row in [a, b].into_iter().filter(|&row| row != NONE) {
                self.pattern.add_diagonal(&mut self.matrix, row, &link.block);
            }
            if a != NONE && b != NONE {
                self.pattern.subtract_below(&mut self.matrix, (a.max(b), a.min(b)), &link.block);
            }
        }
        same
    }

    fn set_links(
        &mut self,
        assembly: &Assembly<D>,
        reach: impl Fn(usize) -> f64,
        spare: f64,
        weights: impl Fn(&StiffContact) -> (f64, f64),
    ) {
        let (pairs, law, prestress) = (assembly.pairs(), assembly.law(), self.prestress);
        self.links.clear();
        self.near.clear();
        for_each_pair(
            pairs,
            &assembly.displacements,
            &mut |&MovedPair { pair, ends, separation, distance, overlap, coefficient }| {
                let reach = reach(pair);
                // This form makes NaN an entry, which is refused there.
                if overlap <= -(reach + spare) {
                    return;
                }
                self.near.push(ends);
                if overlap <= -reach {
                    return;
                }
                let force = if overlap < 0.0 { 0.0 } else { law.force(coefficient, overlap) };
                let stiffness = if overlap.is_nan() { overlap } else { law.stiffness(force, overlap) };
                let across = prestress.across(force, distance);
                let (stiffness, across) = weights(&StiffContact { pair, ends, stiffness, across });
                let block = contact_block(stiffness, across, separation, distance);
                self.links.push(Link { ends, block });
            },
        );
    }

    fn set_members(&mut self, assembly: &Assembly<D>) {
        let mobile = assembly.mobile_count();
        let member = match self.members {
            Members::Backbone => {
                let held: Vec<bool> = (0..assembly.len()).map(|disk| disk >= mobile).collect();
                let links: Vec<(u32, u32)> = self.links.iter().map(|link| link.ends).collect();
                backbone::<D>(&held, &links)
            }
            Members::InContact => {
                let mut touched = vec![false; assembly.len()];
                for link in &self.links {
                    touched[link.ends.0 as usize] = true;
                    touched[link.ends.1 as usize] = true;
                }
                touched
            }
            Members::Mobile => vec![true; assembly.len()],
        };
        self.disks.clear();
        self.blocks.clear();
        self.blocks.resize(assembly.len(), NONE);
        self.places.clear();
        for disk in (0..mobile).filter(|&disk| member[disk]) {
            self.blocks[disk] = self.disks.len() as u32;
            self.disks.push(assembly.order()[disk]);
            self.places.push(assembly.place(disk));
        }
    }

    /// The matrix.
    pub fn matrix(&self) -> &SymmetricMatrix {
        &self.matrix
    }

    /// The graph of the contacts, with the disks of [`Hessian::disks`] as vertices.
    pub fn graph(&self) -> Graph {
        self.pattern.graph()
    }

    /// The disk of each block of D rows, as an index of the packing.
    pub fn disks(&self) -> &[u32] {
        &self.disks
    }

    /// Position of each disk of [`Hessian::disks`] at the last update, relative to an origin of the assembly
    /// \[length\].
    pub fn places(&self) -> &[Vector<D>] {
        &self.places
    }

    /// The first row of a disk given in working order; none for an excluded disk.
    pub(crate) fn row_of(&self, working: u32) -> Option<usize> {
        let block = self.blocks[working as usize];
        (block != NONE).then(|| D * block as usize)
    }

    /// Forces on the unknowns due to displacements `imposed` of held disks: B u_held for each contact with one
    /// \[force\].
    ///
    /// # Shape
    /// One displacement per disk, indexed as in the packing; those of mobile disks are ignored.
    ///
    /// # Panics
    /// If the field has fewer entries.
    pub fn forces_of_held(&self, imposed: &[Vector<D>]) -> Vec<f64> {
        let mut forces = vec![0.0; self.matrix.dimension()];
        for link in &self.links {
            for (disk, other) in [link.ends, (link.ends.1, link.ends.0)] {
                let (Some(row), true) = (self.row_of(disk), other as usize >= self.mobile_count) else { continue };
                let moved = imposed[self.held[other as usize - self.mobile_count] as usize];
                for (d, line) in link.block.iter().enumerate() {
                    forces[row + d] += dot(*line, moved);
                }
            }
        }
        forces
    }

    /// A field over the packing as a vector of unknowns.
    ///
    /// # Shape
    /// One entry per disk, indexed as in the packing.
    ///
    /// # Panics
    /// If the field has fewer entries.
    pub fn gather(&self, field: &[Vector<D>]) -> Vec<f64> {
        self.disks.iter().flat_map(|&disk| field[disk as usize]).collect()
    }

    /// A vector of unknowns as a field over the packing, 0 for disks without rows.
    ///
    /// # Panics
    /// If the vector is not as long as the matrix.
    pub fn scatter(&self, unknowns: &[f64]) -> Vec<Vector<D>> {
        assert_eq!(unknowns.len(), self.matrix.dimension(), "one number a row");
        let mut field = vec![[0.0; D]; self.disk_count];
        for (&disk, values) in self.disks.iter().zip(unknowns.as_chunks::<D>().0) {
            field[disk as usize] = *values;
        }
        field
    }
}
