//! The hot loop: energy, forces and virial of all contacts in one pass.
//!
//! ```text
//! r_ij = D_ij + w     w = u_i − u_j     δ = δ⁰_ij − w·(2 D_ij + w) / (|r_ij| + |D_ij|)
//! f_i += F(δ) r_ij/|r_ij|,  f_j −= the same
//! ```
//!
//! D_ij is the separation of the anchors, u a displacement from them, δ⁰_ij the overlap at the anchors, known to full
//! relative accuracy. The overlap follows from its change, so it carries the rounding of the displacements (10⁻¹⁶ w) and of
//! itself, not that of the distance (10⁻¹⁶), nor that of positions in a box (10⁻¹⁴ and more). Pairs are taken in blocks of [`BLOCK`]: first the
//! separations are gathered, then all arithmetic is done column by column (which the compiler turns into vector
//! instructions), then the forces are scattered. The order of every sum is fixed, so the bits do not depend on the
//! machine's vector width.

use crate::contact::damping::DampingLaw;
use crate::contact::law::PairLaw;
use crate::contact::neighbours::PairList;
use crate::vector::{Vector, difference, scaled, sum};

/// Pairs handled together; the columns of a block stay in the nearest cache.
pub const BLOCK: usize = 128;

/// What the loop sums beside the forces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Totals<const D: usize> {
    /// Energy Σ u(δ), with that of the sites where the law has one \[energy\].
    pub energy: f64,
    /// The part of it that sites have, −(Γ/2) Σ u²; 0 without them \[energy\].
    pub on_site_energy: f64,
    /// Virial tensor Σ F r_a r_b / |r| \[energy\]; its trace over D V is the pressure.
    pub virial: [[f64; D]; D],
    /// Number of pairs with δ > 0.
    pub contact_count: usize,
    /// Sum of the contact forces ΣF \[force\].
    pub force_sum: f64,
}

impl<const D: usize> Totals<D> {
    const ZERO: Self =
        Totals { energy: 0.0, on_site_energy: 0.0, virial: [[0.0; D]; D], contact_count: 0, force_sum: 0.0 };

    /// Mean contact force, 0 where there is no contact \[force\].
    pub fn mean_contact_force(&self) -> f64 {
        if self.contact_count == 0 { 0.0 } else { self.force_sum / self.contact_count as f64 }
    }

    /// Contact energy plus the size of that of the sites: what the rounding of the energy is relative to \[energy\].
    pub fn energy_scale(&self) -> f64 {
        (self.energy - self.on_site_energy).abs() + self.on_site_energy.abs()
    }

    /// Trace of the virial tensor Σ F r \[energy\].
    pub fn virial_trace(&self) -> f64 {
        (0..D).map(|d| self.virial[d][d]).sum()
    }
}

/// One block of pairs, column by column.
struct Block<const D: usize> {
    moved: [Vector<D>; BLOCK],
    apart: [Vector<D>; BLOCK],
    overlap: [f64; BLOCK],
    force: [f64; BLOCK],
    /// Force over distance.
    factor: [f64; BLOCK],
}

impl<const D: usize> Block<D> {
    #[inline(always)]
    fn new() -> Self {
        Block {
            moved: [[0.0; D]; BLOCK],
            apart: [[0.0; D]; BLOCK],
            overlap: [0.0; BLOCK],
            force: [0.0; BLOCK],
            factor: [0.0; BLOCK],
        }
    }
}

/// Forces on all disks; `forces` is overwritten, whatever it held.
///
/// # Shape
/// `displacements` and `forces` have one entry a disk.
///
/// # Accuracy
/// An overlap is known to a few units in the last place of itself and of the relative displacement w.
pub fn forces<const D: usize, L: PairLaw>(
    law: &L,
    pairs: &PairList<D>,
    displacements: &[Vector<D>],
    forces: &mut [Vector<D>],
) {
    let mut totals = Totals::ZERO;
    pulp::Arch::new().dispatch(Sweep::<D, L, false> { law, pairs, displacements, forces, totals: &mut totals });
}

/// Forces as by [`forces`], with energy, virial, contact count and mean force in the same pass.
pub fn forces_and_totals<const D: usize, L: PairLaw>(
    law: &L,
    pairs: &PairList<D>,
    displacements: &[Vector<D>],
    forces: &mut [Vector<D>],
) -> Totals<D> {
    let mut totals = Totals::ZERO;
    pulp::Arch::new().dispatch(Sweep::<D, L, true> { law, pairs, displacements, forces, totals: &mut totals });
    totals
}

/// The loop as a job that is compiled for each vector width the machine may have, and started for the widest it has.
struct Sweep<'a, const D: usize, L, const TOTALS: bool> {
    law: &'a L,
    pairs: &'a PairList<D>,
    displacements: &'a [Vector<D>],
    forces: &'a mut [Vector<D>],
    totals: &'a mut Totals<D>,
}

impl<const D: usize, L: PairLaw, const TOTALS: bool> pulp::WithSimd for Sweep<'_, D, L, TOTALS> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _simd: S) {
        sweep::<D, L, TOTALS>(self.law, self.pairs, self.displacements, self.forces, self.totals);
    }
}

#[inline(always)]
fn sweep<const D: usize, L: PairLaw, const TOTALS: bool>(
    law: &L,
    pairs: &PairList<D>,
    displacements: &[Vector<D>],
    forces: &mut [Vector<D>],
    totals: &mut Totals<D>,
) {
    forces.fill([0.0; D]);
    let mut block = Block::<D>::new();
    let mut start = 0;
    while start < pairs.len() {
        let count = BLOCK.min(pairs.len() - start);
        let range = start..start + count;
        let (first, second) = (&pairs.first[range.clone()], &pairs.second[range.clone()]);
        gather(&mut block, first, second, &pairs.separation[range.clone()], displacements);
        let (distance, overlap) = (&pairs.distance[range.clone()], &pairs.overlap[range.clone()]);
        evaluate(law, &mut block, distance, overlap, &pairs.coefficient[range]);
        if TOTALS {
            tally(law, &block, count, totals);
        }
        scatter(&block, first, second, forces);
        start += count;
    }
}

#[inline(always)]
fn gather<const D: usize>(
    block: &mut Block<D>,
    first: &[u32],
    second: &[u32],
    separation: &[Vector<D>],
    displacements: &[Vector<D>],
) {
    for (k, ((&i, &j), &anchor)) in first.iter().zip(second).zip(separation).enumerate() {
        let (a, b) = (displacements[i as usize], displacements[j as usize]);
        let moved = difference(a, b);
        block.moved[k] = moved;
        block.apart[k] = sum(anchor, moved);
    }
}

#[inline(always)]
fn evaluate<const D: usize, L: PairLaw>(
    law: &L,
    block: &mut Block<D>,
    anchor_distance: &[f64],
    anchor_overlap: &[f64],
    coefficient: &[f64],
) {
    let columns = anchor_distance.iter().zip(anchor_overlap).zip(coefficient);
    for (k, ((&anchor_distance, &anchor_overlap), &coefficient)) in columns.enumerate() {
        let mut squared = 0.0;
        let mut change = 0.0;
        for d in 0..D {
            let (apart, moved) = (block.apart[k][d], block.moved[k][d]);
            squared += apart * apart;
            // 2 D + w = (D + w) + D = 2 apart − moved.
            change += moved * (2.0 * apart - moved);
        }
        let distance = squared.sqrt();
        let both = distance + anchor_distance;
        // One division for change / both and 1 / distance: divisions and roots are what the loop waits for.
        let inverse = 1.0 / (distance * both);
        let gap = anchor_overlap - change * (distance * inverse);
        // Written so that NaN stays NaN.
        let overlap = if gap < 0.0 { 0.0 } else { gap };
        let force = law.force(coefficient, overlap);
        block.overlap[k] = overlap;
        block.force[k] = force;
        block.factor[k] = force * (both * inverse);
    }
}

/// Separation, distance and overlap of one listed pair, by the same formula as the loop; a negative overlap is a gap.
#[inline(always)]
pub fn geometry<const D: usize>(
    pairs: &PairList<D>,
    pair: usize,
    displacements: &[Vector<D>],
) -> (Vector<D>, f64, f64) {
    let (a, b) = (displacements[pairs.first[pair] as usize], displacements[pairs.second[pair] as usize]);
    let mut apart = [0.0; D];
    let mut squared = 0.0;
    let mut change = 0.0;
    for d in 0..D {
        let moved = a[d] - b[d];
        apart[d] = pairs.separation[pair][d] + moved;
        squared += apart[d] * apart[d];
        change += moved * (2.0 * apart[d] - moved);
    }
    let distance = squared.sqrt();
    let inverse = 1.0 / (distance * (distance + pairs.distance[pair]));
    (apart, distance, pairs.overlap[pair] - change * (distance * inverse))
}

#[inline(always)]
fn tally<const D: usize, L: PairLaw>(law: &L, block: &Block<D>, count: usize, totals: &mut Totals<D>) {
    let mut part = Totals::<D>::ZERO;
    for k in 0..count {
        part.energy += law.energy(block.force[k], block.overlap[k]);
        part.force_sum += block.force[k];
        part.contact_count += usize::from(block.overlap[k] > 0.0);
        for a in 0..D {
            for b in 0..=a {
                part.virial[a][b] += block.factor[k] * (block.apart[k][a] * block.apart[k][b]);
            }
        }
    }
    totals.energy += part.energy;
    totals.force_sum += part.force_sum;
    totals.contact_count += part.contact_count;
    for a in 0..D {
        for b in 0..=a {
            totals.virial[a][b] += part.virial[a][b];
            totals.virial[b][a] = totals.virial[a][b];
        }
    }
}

#[inline(always)]
fn scatter<const D: usize>(block: &Block<D>, first: &[u32], second: &[u32], forces: &mut [Vector<D>]) {
    for (k, (&i, &j)) in first.iter().zip(second).enumerate() {
        let force = scaled(block.factor[k], block.apart[k]);
        forces[i as usize] = sum(forces[i as usize], force);
        forces[j as usize] = difference(forces[j as usize], force);
    }
}

/// Adds the damping forces −c_ij v_n of all contacts to `forces`; the power they take, Σ c_ij v_n², is returned.
///
/// # Shape
/// `damping_coefficient` has one entry a pair, `velocities` one a disk.
pub fn add_damping<const D: usize, C: DampingLaw>(
    law: &C,
    pairs: &PairList<D>,
    damping_coefficient: &[f64],
    displacements: &[Vector<D>],
    velocities: &[Vector<D>],
    forces: &mut [Vector<D>],
) -> f64 {
    let mut dissipation = 0.0;
    for k in 0..pairs.len() {
        let (i, j) = (pairs.first[k] as usize, pairs.second[k] as usize);
        let (apart, distance, overlap) = geometry(pairs, k, displacements);
        if overlap > 0.0 {
            let damping = law.damping(damping_coefficient[k], overlap);
            let mut along = 0.0;
            for d in 0..D {
                along += (velocities[i][d] - velocities[j][d]) * apart[d];
            }
            let normal_velocity = along / distance;
            dissipation += damping * normal_velocity * normal_velocity;
            let factor = damping * normal_velocity / distance;
            for d in 0..D {
                forces[i][d] -= factor * apart[d];
                forces[j][d] += factor * apart[d];
            }
        }
    }
    dissipation
}

/// Sums over the contacts of each disk: of the stiffness, and of a second quantity of the contact.
///
/// The largest row sum bounds the largest eigenvalue of the stiffness matrix from above (Gershgorin): with masses 1,
/// `λ ≤ max_i Σ_j 2 F'(δ_ij)`, the prestress part being negative. A contact with a held disk counts once.
///
/// # Shape
/// `row` has one entry a disk and is overwritten.
pub fn stiffness_rows<const D: usize, L: PairLaw>(
    law: &L,
    pairs: &PairList<D>,
    displacements: &[Vector<D>],
    mobile_count: usize,
    weight: impl Fn(usize, f64, f64) -> f64,
    row: &mut [f64],
) {
    row.fill(0.0);
    for k in 0..pairs.len() {
        let (i, j) = (pairs.first[k] as usize, pairs.second[k] as usize);
        let (_, _, overlap) = geometry(pairs, k, displacements);
        if overlap > 0.0 {
            let stiffness = law.stiffness(law.force(pairs.coefficient[k], overlap), overlap);
            let value = weight(k, overlap, stiffness);
            if j < mobile_count {
                row[i] += 2.0 * value;
                row[j] += 2.0 * value;
            } else {
                row[i] += value;
            }
        }
    }
}
