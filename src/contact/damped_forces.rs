//! Elastic and damping forces of all contacts in one pass, for methods that need only their sum.
//!
//! ```text
//! f_i += (F(δ) − c v_n) n,  f_j −= the same        n = r_ij/|r_ij|,  v_n = n·(v_i − v_j),  c = 0 where δ ≤ 0
//! ```
//!
//! Blocks, rows and columns as in [`super::forces`]; tiles play no part.

use crate::contact::damping::DampingLaw;
use crate::contact::forces::geometry;
use crate::contact::law::PairLaw;
use crate::contact::pair_list::{BLOCK, PairList};
use crate::contact::rows::{gather, rows_of, scatter};
use crate::lanes;
use crate::vector::Vector;

/// Net forces of elastic and damping contacts on all disks; the power damping takes, Σ c v_n², is returned. `forces` is
/// overwritten, whatever it held.
///
/// # Shape
/// `damping_coefficient` has one entry a pair; `displacements`, `velocities` and `forces` one a disk.
///
/// # Accuracy
/// That of [`forces`](super::forces::forces) with [`add_damping`], but for the order of sums.
pub fn damped_forces<const D: usize, L: PairLaw, C: DampingLaw>(
    (law, damping): (&L, &C),
    pairs: &PairList<D>,
    damping_coefficient: &[f64],
    displacements: &[Vector<D>],
    velocities: &[Vector<D>],
    forces: &mut [Vector<D>],
) -> f64 {
    forces.fill([0.0; D]);
    let mut power = 0.0;
    let mut columns = Columns::<D> { pull: [[0.0; BLOCK]; D], apace: [[0.0; BLOCK]; D], power: [0.0; BLOCK] };
    for block in &pairs.blocks {
        let range = block.pairs..block.pairs + block.pair_count;
        let (rows, second) = (rows_of(pairs, block), &pairs.second[range.clone()]);
        gather(&mut columns.pull, block, (rows, second, 0), displacements);
        gather(&mut columns.apace, block, (rows, second, 0), velocities);
        let listed = Listed {
            separation: pairs.separation.columns().map(|column| &column[range.clone()]),
            distance: &pairs.distance[range.clone()],
            overlap: &pairs.overlap[range.clone()],
            coefficient: &pairs.coefficient[range.clone()],
            damping: &damping_coefficient[range],
        };
        power += pulp::Arch::new().dispatch(Arithmetic { laws: (law, damping), columns: &mut columns, listed });
        scatter(&columns.pull, block, (rows, second, 0), forces);
    }
    power
}

/// One block of pairs, column by column.
#[repr(align(64))]
struct Columns<const D: usize> {
    /// Relative displacement of the pair, then the force on its first disk.
    pull: [[f64; BLOCK]; D],
    /// Relative velocity.
    apace: [[f64; BLOCK]; D],
    power: [f64; BLOCK],
}

/// What the list has of each pair of a block.
struct Listed<'a, const D: usize> {
    separation: [&'a [f64]; D],
    distance: &'a [f64],
    overlap: &'a [f64],
    coefficient: &'a [f64],
    damping: &'a [f64],
}

/// The arithmetic of a block, which returns the power.
struct Arithmetic<'a, const D: usize, L, C> {
    laws: (&'a L, &'a C),
    columns: &'a mut Columns<D>,
    listed: Listed<'a, D>,
}

impl<const D: usize, L: PairLaw, C: DampingLaw> pulp::WithSimd for Arithmetic<'_, D, L, C> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, simd: S) -> f64 {
        evaluate(self.laws, self.columns, &self.listed);
        lanes::sum(simd, &self.columns.power[..self.listed.distance.len()])
    }
}

#[inline(always)]
fn evaluate<const D: usize, L: PairLaw, C: DampingLaw>(
    (law, damping): (&L, &C),
    columns: &mut Columns<D>,
    listed: &Listed<'_, D>,
) {
    let count = listed.distance.len();
    let pulls = columns.pull.each_mut().map(|column| &mut column[..count]);
    let (apaces, powers) = (columns.apace.each_ref().map(|column| &column[..count]), &mut columns.power[..count]);
    let (separations, overlaps) = (listed.separation.map(|column| &column[..count]), &listed.overlap[..count]);
    let (coefficients, dampings) = (&listed.coefficient[..count], &listed.damping[..count]);
    for k in 0..count {
        let mut apart = [0.0; D];
        let (mut squared, mut change, mut along) = (0.0, 0.0, 0.0);
        for d in 0..D {
            let (anchored, moved) = (separations[d][k], pulls[d][k]);
            apart[d] = anchored + moved;
            squared += apart[d] * apart[d];
            change += moved * (anchored + apart[d]);
            along += apaces[d][k] * apart[d];
        }
        let distance = squared.sqrt();
        let both = distance + listed.distance[k];
        // One division, as in the loop without damping.
        let inverse = 1.0 / (distance * both);
        let gap = overlaps[k] - change * (distance * inverse);
        // Written so that NaN stays NaN.
        let overlap = if gap < 0.0 { 0.0 } else { gap };
        let over_distance = both * inverse;
        let normal_velocity = along * over_distance;
        let resistance = damping.damping(dampings[k], overlap);
        let resisted = if gap > 0.0 { resistance * normal_velocity } else { 0.0 };
        powers[k] = resisted * normal_velocity;
        let factor = (law.force(coefficients[k], overlap) - resisted) * over_distance;
        for d in 0..D {
            pulls[d][k] = factor * apart[d];
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Hertzian;
    use crate::contact::assembly::Assembly;
    use crate::contact::damping::ConstantDamping;
    use crate::contact::forces;
    use crate::io::read_packing;
    use crate::vector::{difference, norm};

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
        let power = add_damping(damping, pairs, &coefficients, at, &velocities, &mut apart);
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
