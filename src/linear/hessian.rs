//! [`Hessian`]: second derivatives of the energy of a packing, assembled straight into compressed columns.
//!
//! ```text
//! K_ii = Σ_j B_ij − Γ        K_ij = −B_ij        B = F' n nᵀ − (F/r) (1 − n nᵀ)        n = r_ij/r
//! ```
//!
//! F' n nᵀ is the stiffness of a contact along its line of centres. F/r across it is the *prestress*: pressed disks slip
//! sideways, so it weakens. −Γ is the term of sites ([`OnSite`](crate::law::on_site::OnSite)). K is the negative derivative of
//! the forces; its unknowns are the D coordinates of each disk that can move and is held by something: held disks and disks
//! without contacts are left out by construction, since their rows would be zero.

use crate::forces::assembly::Assembly;
use crate::law::pair_law::PairLaw;
use crate::neighbours::for_each_pair::{Walked, walk};
use crate::network::backbone;
use crate::packing::{Packing, PackingError};
use crate::sparse::{BlockPattern, Graph, SymmetricMatrix};
use crate::vector::{Vector, dot, scaled};

/// Whether contact forces weaken the packing across the contacts, as they do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Prestress {
    /// Yes: the second derivatives of the energy.
    #[default]
    Included,
    /// No: springs at rest of the stiffness of each contact, the "unstressed" network.
    LeftOut,
}

/// Which mobile disks have rows in the matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Members {
    /// Those on the backbone; rattlers are taken away with their contacts.
    #[default]
    Backbone,
    /// Those with a contact.
    InContact,
    /// All: rows of disks without a contact are 0, for matrices to whose diagonal something is added.
    Mobile,
}

/// Second derivatives of the energy of a packing with respect to its unknowns.
///
/// # Shape
/// D rows for each disk of [`Hessian::disks`], coordinate by coordinate.
///
/// # Accuracy
/// An entry is a sum over the contacts of a disk, each known to a few units in the last place (forces follow from overlaps
/// that are).
///
/// # Cost
/// Linear in pairs of the list: nine to fifteen evaluations of the forces with totals, from 1 000 to 89 000 disks
/// (`benches/measurements/scaling`).
#[derive(Debug, Clone)]
pub struct Hessian<const D: usize> {
    prestress: Prestress,
    members: Members,
    disks: Vec<u32>,
    /// Block row of each disk in working order; `NONE` for those left out.
    blocks: Vec<u32>,
    /// Where the disks with rows are, from an origin of the assembly's own.
    places: Vec<Vector<D>>,
    disk_count: usize,
    mobile_count: usize,
    /// Held disks in working order, in the packing's own numbering.
    held: Vec<u32>,
    links: Vec<Link<D>>,
    /// Ends of the pairs that have a place in the pattern when it is made.
    near: Vec<(u32, u32)>,
    pattern: BlockPattern,
    matrix: SymmetricMatrix,
}

/// No block row.
const NONE: u32 = u32::MAX;

/// A contact about to enter the matrix.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StiffContact {
    /// Its place in the neighbour list.
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
    apart: Vector<D>,
    distance: f64,
) -> [Vector<D>; D] {
    let normal = scaled(1.0 / distance, apart);
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
    pub fn new<L: PairLaw>(
        packing: &Packing<D>,
        law: &L,
        members: Members,
        prestress: Prestress,
    ) -> Result<Self, PackingError> {
        Ok(Self::of(&Assembly::new(packing, *law)?, members, prestress))
    }

    /// The second derivatives at the present displacements of an assembly.
    pub fn of<L: PairLaw>(assembly: &Assembly<D, L>, members: Members, prestress: Prestress) -> Self {
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

    /// Takes the second derivatives anew after disks have moved; true if entries stand where they stood, so that an
    /// analysis of the matrix stays valid. The assembly must be the one given first, or one of the same packing.
    pub fn update<L: PairLaw>(&mut self, assembly: &Assembly<D, L>) -> bool {
        self.update_with(assembly, |contact| (contact.stiffness, contact.across))
    }

    /// As [`Hessian::update`], with another stiffness along and across each contact.
    pub(crate) fn update_with<L: PairLaw>(
        &mut self,
        assembly: &Assembly<D, L>,
        weights: impl Fn(&StiffContact) -> (f64, f64),
    ) -> bool {
        self.update_within(assembly, |_| 0.0, 0.0, weights)
    }

    /// As [`Hessian::update_with`], with pairs of the list whose gap is below `reach` among the contacts. Pairs whose gap is
    /// no more than `spare` wider have entries, of value 0, so that those of later updates still stand where they stood.
    pub(crate) fn update_within<L: PairLaw>(
        &mut self,
        assembly: &Assembly<D, L>,
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

    fn set_links<L: PairLaw>(
        &mut self,
        assembly: &Assembly<D, L>,
        reach: impl Fn(usize) -> f64,
        spare: f64,
        weights: impl Fn(&StiffContact) -> (f64, f64),
    ) {
        let (pairs, law, prestress) = (assembly.pairs(), assembly.law(), self.prestress);
        self.links.clear();
        self.near.clear();
        walk(pairs, &assembly.displacements, &mut |&Walked { pair, ends, apart, distance, overlap, coefficient }| {
            let reach = reach(pair);
            // Written so that NaN becomes an entry, and is refused there.
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
            let block = contact_block(stiffness, across, apart, distance);
            self.links.push(Link { ends, block });
        });
    }

    fn set_members<L: PairLaw>(&mut self, assembly: &Assembly<D, L>) {
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

    /// The disks with rows as vertices in the order of [`Hessian::disks`], their contacts as edges.
    pub fn graph(&self) -> Graph {
        self.pattern.graph()
    }

    /// The disk of each block of D rows, in the packing's own numbering.
    pub fn disks(&self) -> &[u32] {
        &self.disks
    }

    /// Where each disk of [`Hessian::disks`] was when the derivatives were taken, from an origin of the assembly's own
    /// \[length\].
    pub fn places(&self) -> &[Vector<D>] {
        &self.places
    }

    /// The first row of a disk given in working order; none if the disk has no rows.
    pub(crate) fn row_of(&self, working: u32) -> Option<usize> {
        let block = self.blocks[working as usize];
        (block != NONE).then(|| D * block as usize)
    }

    /// Forces on the unknowns when held disks are moved by `imposed`: B u_held for each contact with one \[force\].
    ///
    /// # Shape
    /// One displacement a disk, in the packing's own numbering; those of disks that are not held are not looked at.
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
    /// One entry a disk, in the packing's own numbering.
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
