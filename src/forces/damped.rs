//! Elastic and damping forces of all contacts in one pass, for methods that need only their sum.
//!
//! ```text
//! f_i += (F(δ) − c v_n) n,  f_j −= the same        n = r_ij/|r_ij|,  v_n = n·(v_i − v_j),  c = 0 where δ ≤ 0
//! ```
//!
//! Blocks, rows and columns as in [`crate::forces::elastic`]; tiles are not used.

use pulp::{Simd, WithSimd};

use crate::forces::block_arithmetic::{Anchors, Columns};
use crate::law::damping::ContactDamping;
use crate::law::pair_law::PairLaw;
use crate::neighbours::block::BLOCK;
use crate::neighbours::for_each_pair::{MovedPair, for_each_pair};
use crate::neighbours::pair_list::PairList;
use crate::neighbours::rows::{gather, scatter};
use crate::processor;
use crate::simd::lanes;
use crate::vector::Vector;

/// Net forces of elastic and damping contacts on all disks; `forces` is overwritten. Returns the power of damping, Σ c
/// v_n².
///
/// # Shape
/// `damping_coefficient` has one entry per pair; `displacements`, `velocities` and `forces` have one per disk.
///
/// # Accuracy
/// Equal to [`forces`](crate::forces::elastic::forces) with [`add_damping`], except for the order of sums.
pub fn damped_forces<const D: usize>(
    (law, damping): (&dyn PairLaw, &ContactDamping),
    pairs: &PairList<D>,
    damping_coefficient: &[f64],
    displacements: &[Vector<D>],
    velocities: &[Vector<D>],
    forces: &mut [Vector<D>],
) -> f64 {
    forces.as_flattened_mut().fill(0.0);
    let mut power = 0.0;
    let (mut columns, mut relative_velocity) = (Columns::<D>::new(), [[0.0; D]; BLOCK]);
    for block in &pairs.blocks {
        let listed = block.pairs..block.pairs + block.pair_count;
        gather(&mut columns.pair_vectors, pairs, block, (displacements, 0));
        gather(&mut relative_velocity, pairs, block, (velocities, 0));
        let (relative_velocity, coefficient) = (&relative_velocity[..block.pair_count], &damping_coefficient[listed]);
        let anchors = Anchors::of(law, pairs, block);
        columns.compute_overlaps(&anchors);
        columns.compute_forces(law, &anchors);
        power += processor::dispatch(Damping { damping, coefficient, relative_velocity, columns: &mut columns });
        columns.resolve(&anchors);
        scatter(&columns.pair_vectors, pairs, block, (forces, 0));
    }
    power
}

/// Subtracts the damping from the forces of a block; returns its power. Overlaps and forces must be computed before.
struct Damping<'a, const D: usize> {
    damping: &'a ContactDamping,
    coefficient: &'a [f64],
    /// Relative velocities.
    relative_velocity: &'a [Vector<D>],
    columns: &'a mut Columns<D>,
}

impl<const D: usize> WithSimd for Damping<'_, D> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let count = self.relative_velocity.len().min(BLOCK);
        let (relative_velocity, coefficient) = (&self.relative_velocity[..count], &self.coefficient[..count]);
        let (overlap, force) = (&self.columns.overlap[..count], &mut self.columns.force[..count]);
        let inverse = &self.columns.inverse[..count];
        let mut power = [0.0; BLOCK];
        for k in 0..count {
            let mut along = 0.0;
            for d in 0..D {
                along += relative_velocity[k][d] * self.columns.separation[d][k];
            }
            let normal_velocity = along * inverse[k];
            let resistance = self.damping.damping(coefficient[k], overlap[k]);
            let resisted = if overlap[k] > 0.0 { resistance * normal_velocity } else { 0.0 };
            power[k] = resisted * normal_velocity;
            force[k] -= resisted;
        }
        lanes::sum(simd, &power[..count])
    }
}

/// Adds the damping forces −c_ij v_n of all contacts to `forces`. Returns their power, Σ c_ij v_n².
///
/// # Shape
/// `damping_coefficient` has one entry per pair, `velocities` one per disk.
pub fn add_damping<const D: usize>(
    damping: &ContactDamping,
    pairs: &PairList<D>,
    damping_coefficient: &[f64],
    displacements: &[Vector<D>],
    velocities: &[Vector<D>],
    forces: &mut [Vector<D>],
) -> f64 {
    let mut dissipation = 0.0;
    for_each_pair(pairs, displacements, &mut |&MovedPair { pair, ends, separation, distance, overlap, .. }| {
        if overlap > 0.0 {
            let (i, j) = (ends.0 as usize, ends.1 as usize);
            let resistance = damping.damping(damping_coefficient[pair], overlap);
            let mut along = 0.0;
            for d in 0..D {
                along += (velocities[i][d] - velocities[j][d]) * separation[d];
            }
            let normal_velocity = along / distance;
            dissipation += resistance * normal_velocity * normal_velocity;
            let factor = resistance * normal_velocity / distance;
            for d in 0..D {
                forces[i][d] -= factor * separation[d];
                forces[j][d] += factor * separation[d];
            }
        }
    });
    dissipation
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forces::assembly::Assembly;
    use crate::forces::elastic;
    use crate::io::read_packing;
    use crate::law::damping::{ConstantDamping, ContactDamping};
    use crate::law::power_laws::Hertzian;
    use crate::vector::{difference, norm};

    /// Both methods give the same sums, of terms of up to 10⁴ and 10⁶, up to rounding.
    fn agree(damping: &ContactDamping) {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/packings/hertz_N1000_p100.xyz");
        let packing = read_packing::<2>(file).expect("a stored packing");
        let law = Hertzian::default();
        let assembly = Assembly::new(&packing, &law).expect("no coincidence");
        let (pairs, at, radii) = (assembly.pairs(), &assembly.displacements, assembly.radii());
        let of_pair = |(&i, &j): (&u32, &u32)| damping.coefficient(radii[i as usize], radii[j as usize]);
        let coefficients: Vec<f64> = pairs.first.iter().zip(&pairs.second).map(of_pair).collect();
        let wave = |i: usize| [(7.0 * i as f64).sin(), (11.0 * i as f64).cos()];
        let velocities: Vec<Vector<2>> = (0..assembly.len()).map(wave).collect();
        let mut separate = vec![[0.0; 2]; assembly.len()];
        elastic::forces(&law, pairs, at, &mut elastic::BorderForces::default(), &mut separate);
        let power = add_damping(damping, pairs, &coefficients, at, &velocities, &mut separate);
        let mut together = vec![[1.0; 2]; assembly.len()];
        let found = damped_forces((&law, damping), pairs, &coefficients, at, &velocities, &mut together);
        assert!((found - power).abs() < 1e-13 * power, "{found} for {power}");
        assert!(power > 0.0);
        for (one, two) in separate.iter().zip(&together) {
            assert!(norm(difference(*one, *two)) < 1e-10, "{one:?} {two:?}");
        }
    }

    #[test]
    fn one_pass_is_elastic_forces_and_damping() {
        agree(&ContactDamping::Constant(ConstantDamping { rate: 500.0 }));
        agree(&Hertzian::default().viscoelastic(500.0));
    }
}
