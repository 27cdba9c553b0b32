//! Elastic and damping forces of all contacts in one pass, for methods that need only their sum.
//!
//! ```text
//! f_i += (F(δ) − c v_n) n,  f_j −= the same        n = r_ij/|r_ij|,  v_n = n·(v_i − v_j),  c = 0 where δ ≤ 0
//! ```
//!
//! Blocks, columns and order of sums as in [`super::forces`].

use crate::contact::damping::DampingLaw;
use crate::contact::law::PairLaw;
use crate::contact::pair_list::{BLOCK, PairList};
use crate::vector::{Vector, difference, scaled, sum};

/// Lanes of the sum of powers; fixed, so the bits do not depend on the machine.
const LANES: usize = 8;

/// Net forces of elastic and damping contacts on all disks; the power damping takes, Σ c v_n², is returned. `forces` is
/// overwritten, whatever it held.
///
/// # Shape
/// `damping_coefficient` has one entry a pair; `displacements`, `velocities` and `forces` one a disk.
///
/// # Accuracy
/// That of [`forces`](super::forces::forces) with [`add_damping`](super::forces::add_damping), but for the order of sums.
pub fn damped_forces<const D: usize, L: PairLaw, C: DampingLaw>(
    (law, damping): (&L, &C),
    pairs: &PairList<D>,
    damping_coefficient: &[f64],
    displacements: &[Vector<D>],
    velocities: &[Vector<D>],
    forces: &mut [Vector<D>],
) -> f64 {
    let mut power = [0.0; LANES];
    pulp::Arch::new().dispatch(Sweep {
        law,
        damping,
        pairs,
        damping_coefficient,
        displacements,
        velocities,
        forces,
        power: &mut power,
    });
    power.iter().sum()
}

struct Sweep<'a, const D: usize, L, C> {
    law: &'a L,
    damping: &'a C,
    pairs: &'a PairList<D>,
    damping_coefficient: &'a [f64],
    displacements: &'a [Vector<D>],
    velocities: &'a [Vector<D>],
    forces: &'a mut [Vector<D>],
    power: &'a mut [f64; LANES],
}

impl<const D: usize, L: PairLaw, C: DampingLaw> pulp::WithSimd for Sweep<'_, D, L, C> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _simd: S) {
        sweep(self);
    }
}

/// One block of pairs, column by column.
struct Block<const D: usize> {
    moved: [Vector<D>; BLOCK],
    apart: [Vector<D>; BLOCK],
    /// Relative velocity.
    apace: [Vector<D>; BLOCK],
    /// Force over distance.
    factor: [f64; BLOCK],
    power: [f64; BLOCK],
}

#[inline(always)]
fn sweep<const D: usize, L: PairLaw, C: DampingLaw>(job: Sweep<'_, D, L, C>) {
    job.forces.fill([0.0; D]);
    let mut block = Block::<D> {
        moved: [[0.0; D]; BLOCK],
        apart: [[0.0; D]; BLOCK],
        apace: [[0.0; D]; BLOCK],
        factor: [0.0; BLOCK],
        power: [0.0; BLOCK],
    };
    let pairs = job.pairs;
    let mut start = 0;
    while start < pairs.len() {
        let range = start..pairs.len().min(start + BLOCK);
        let (first, second) = (&pairs.first[range.clone()], &pairs.second[range.clone()]);
        for (k, ((&i, &j), &anchor)) in first.iter().zip(second).zip(&pairs.separation[range.clone()]).enumerate() {
            let (i, j) = (i as usize, j as usize);
            let moved = difference(job.displacements[i], job.displacements[j]);
            block.moved[k] = moved;
            block.apart[k] = sum(anchor, moved);
            block.apace[k] = difference(job.velocities[i], job.velocities[j]);
        }
        let columns = Columns {
            distance: &pairs.distance[range.clone()],
            overlap: &pairs.overlap[range.clone()],
            coefficient: &pairs.coefficient[range.clone()],
            damping: &job.damping_coefficient[range.clone()],
        };
        evaluate((job.law, job.damping), &mut block, &columns);
        let count = range.len();
        block.power[count..].fill(0.0);
        for lanes in block.power.chunks_exact(LANES) {
            for (total, &power) in job.power.iter_mut().zip(lanes) {
                *total += power;
            }
        }
        for (k, (&i, &j)) in first.iter().zip(second).enumerate() {
            let force = scaled(block.factor[k], block.apart[k]);
            job.forces[i as usize] = sum(job.forces[i as usize], force);
            job.forces[j as usize] = difference(job.forces[j as usize], force);
        }
        start += count;
    }
}

/// What the list has of each pair of a block.
struct Columns<'a> {
    distance: &'a [f64],
    overlap: &'a [f64],
    coefficient: &'a [f64],
    damping: &'a [f64],
}

#[inline(always)]
fn evaluate<const D: usize, L: PairLaw, C: DampingLaw>(
    (law, damping): (&L, &C),
    block: &mut Block<D>,
    columns: &Columns<'_>,
) {
    let of_pairs = columns.distance.iter().zip(columns.overlap).zip(columns.coefficient).zip(columns.damping);
    for (k, (((&anchor_distance, &anchor_overlap), &coefficient), &damping_coefficient)) in of_pairs.enumerate() {
        let (mut squared, mut change, mut along) = (0.0, 0.0, 0.0);
        for d in 0..D {
            let (apart, moved) = (block.apart[k][d], block.moved[k][d]);
            squared += apart * apart;
            change += moved * (2.0 * apart - moved);
            along += block.apace[k][d] * apart;
        }
        let distance = squared.sqrt();
        let both = distance + anchor_distance;
        // One division, as in the loop without damping.
        let inverse = 1.0 / (distance * both);
        let gap = anchor_overlap - change * (distance * inverse);
        // Written so that NaN stays NaN.
        let overlap = if gap < 0.0 { 0.0 } else { gap };
        let over_distance = both * inverse;
        let normal_velocity = along * over_distance;
        let resistance = damping.damping(damping_coefficient, overlap);
        let resisted = if gap > 0.0 { resistance * normal_velocity } else { 0.0 };
        block.power[k] = resisted * normal_velocity;
        block.factor[k] = (law.force(coefficient, overlap) - resisted) * over_distance;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Hertzian;
    use crate::contact::assembly::Assembly;
    use crate::contact::damping::ConstantDamping;
    use crate::contact::forces;
    use crate::io::read_packing;
    use crate::vector::norm;

    /// Both passes give the same sums, of terms of up to 10⁴ and 10⁶, to their rounding.
    fn agree<C: DampingLaw>(damping: &C) {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/packings/hertz_N1000_p100.xyz");
        let packing = read_packing::<2>(file).expect("a stored packing");
        let law = Hertzian::default();
        let assembly = Assembly::new(&packing, law).expect("no coincidence");
        let (pairs, at, radii) = (assembly.pairs(), &assembly.displacements, assembly.radii());
        let of_pair = |(&i, &j): (&u32, &u32)| damping.coefficient(radii[i as usize], radii[j as usize]);
        let coefficients: Vec<f64> = pairs.first.iter().zip(&pairs.second).map(of_pair).collect();
        let wave = |i: usize| [(7.0 * i as f64).sin(), (11.0 * i as f64).cos()];
        let velocities: Vec<Vector<2>> = (0..assembly.len()).map(wave).collect();
        let mut apart = vec![[0.0; 2]; assembly.len()];
        forces::forces(&law, pairs, at, &mut forces::Across::default(), &mut apart);
        let power = forces::add_damping(damping, pairs, &coefficients, at, &velocities, &mut apart);
        let mut together = vec![[1.0; 2]; assembly.len()];
        let found = damped_forces((&law, damping), pairs, &coefficients, at, &velocities, &mut together);
        assert!((found - power).abs() < 1e-13 * power, "{found} for {power}");
        assert!(power > 0.0);
        for (one, two) in apart.iter().zip(&together) {
            assert!(norm(difference(*one, *two)) < 1e-10, "{one:?} {two:?}");
        }
    }

    #[test]
    fn one_pass_is_elastic_forces_and_damping() {
        agree(&ConstantDamping { rate: 500.0 });
        agree(&Hertzian::default().viscoelastic(500.0));
    }
}
