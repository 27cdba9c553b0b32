//! [`Totals`]: energy, virial and contact forces, summed block by block in the pass that computes the forces.

use pulp::{Simd, WithSimd};

use crate::forces::block_arithmetic::Columns;
use crate::law::pair_law::PairLaw;
use crate::neighbours::block::BLOCK;
use crate::processor;
use crate::simd::lanes;

/// The sums of the loop beside the forces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Totals<const D: usize> {
    /// Energy Σ u(δ), plus the energy of sites and loads \[energy\].
    pub energy: f64,
    /// Energy of sites and loads, −Σ (Γ u²/2 + f·u); 0 without them \[energy\].
    pub on_site_energy: f64,
    /// Virial tensor Σ F r_a r_b / |r| \[energy\]; its trace over D V is the pressure.
    pub virial: [[f64; D]; D],
    /// Number of pairs with δ > 0.
    pub contact_count: usize,
    /// Sum of the contact forces ΣF \[force\].
    pub force_sum: f64,
}

impl<const D: usize> Totals<D> {
    pub(crate) const ZERO: Self =
        Totals { energy: 0.0, on_site_energy: 0.0, virial: [[0.0; D]; D], contact_count: 0, force_sum: 0.0 };

    pub(crate) fn add(&mut self, part: &Self) {
        self.energy += part.energy;
        self.on_site_energy += part.on_site_energy;
        self.force_sum += part.force_sum;
        self.contact_count += part.contact_count;
        for (row, of_part) in self.virial.iter_mut().zip(&part.virial) {
            for (total, more) in row.iter_mut().zip(of_part) {
                *total += more;
            }
        }
    }

    /// Adds energy, contact forces, contact count and virial of the first `count` pairs of a block.
    pub(crate) fn add_block(&mut self, law: &dyn PairLaw, columns: &Columns<D>, count: usize) {
        let mut energy = [0.0; BLOCK];
        let energy = &mut energy[..count];
        law.energies(&columns.force[..count], &columns.overlap[..count], energy);
        processor::dispatch(BlockSums { columns, energy, totals: self });
    }

    /// Mean contact force; 0 without contacts \[force\].
    pub fn mean_contact_force(&self) -> f64 {
        if self.contact_count == 0 { 0.0 } else { self.force_sum / self.contact_count as f64 }
    }

    /// Contact energy plus the absolute energy of sites and loads \[energy\]. The rounding of the energy is relative to it.
    pub fn energy_scale(&self) -> f64 {
        (self.energy - self.on_site_energy).abs() + self.on_site_energy.abs()
    }

    /// Trace of the virial tensor Σ F r \[energy\].
    pub fn virial_trace(&self) -> f64 {
        (0..D).map(|d| self.virial[d][d]).sum()
    }
}

/// Sums over the pairs of a block.
struct BlockSums<'a, const D: usize> {
    columns: &'a Columns<D>,
    energy: &'a [f64],
    totals: &'a mut Totals<D>,
}

impl<const D: usize> WithSimd for BlockSums<'_, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let BlockSums { columns: Columns { separation, overlap, force, inverse, .. }, energy, totals } = self;
        let count = energy.len();
        totals.energy += lanes::sum(simd, energy);
        totals.force_sum += lanes::sum(simd, &force[..count]);
        totals.contact_count += overlap[..count].iter().filter(|&&overlap| overlap > 0.0).count();
        // First all terms of a column are computed, then those of its pairs are summed.
        let mut terms = [0.0; BLOCK];
        for a in 0..D {
            for b in 0..=a {
                for k in 0..BLOCK {
                    terms[k] = force[k] * inverse[k] * (separation[a][k] * separation[b][k]);
                }
                totals.virial[a][b] += lanes::sum(simd, &terms[..count]);
                totals.virial[b][a] = totals.virial[a][b];
            }
        }
    }
}
