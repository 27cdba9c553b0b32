//! The Newton step of a packing: the Hessian with a shift that makes it positive definite, its factors and the
//! solution.
//!
//! ```text
//! (K' + S) s = F        S_ii = θ p_i + ε k_i on the backbone,  θ p_i + (η + θ) k_i off it
//! p_i = Σ_j 2 F/r (+ Γ if positive)        k_i = Σ_j 2 F'        a contact with a held disk counts once
//! ```
//!
//! K' is the Hessian, except for contacts of disks off the backbone. At rest these carry no force. Their forces grow as
//! δ^(α−1), so Newton's own step would leave (1 − 1/(α−1)) of such an overlap, a third for Hertzian contacts. With the
//! secant stiffness F/δ for F', and without prestress, one step removes it.
//!
//! The only negative parts of K' are the prestress −F/r across contacts and −Γ of sites. The p_i are their Gershgorin
//! row sums. With θ = 1 the matrix is positive definite for every packing (up to the change of r since the anchors). So
//! θ ≥ 0 alone makes the method converge from any start, and it has no unit. ε k_i fixes motions without stiffness,
//! such as the translations of a periodic box. (η + θ) k_i holds a rattler along directions without contact stiffness,
//! so that it does not run into its neighbours. No entry of S is below 10⁻¹² of the largest k_i.
//!
//! Large packings of spheres are solved by conjugate gradients with an incomplete factor ([`is_faster`]), to the
//! accuracy that a factor must reach. A direction of negative curvature then takes the place of a negative pivot. If
//! the iterations do not suffice, a factor is made.

use crate::forces::assembly::Assembly;
use crate::forces::stiffness_bound::stiffness_rows;
use crate::linear::hessian::{Hessian, Members, Prestress, StiffContact};
use crate::linear::iterative::{IncompleteFactor, IterationLimits, conjugate_gradients, is_faster};
use crate::linear::solution::ACCURACY;
use crate::linear::{Analysis, LinearError};
use crate::sparse::SymmetricMatrix;
use crate::vector::{Vector, larger, norm, scaled};

/// ε: far below the ratio of the softest to the stiffest mode (10⁻⁷ near jamming), far above the rounding of a pivot
/// (10⁻¹⁴).
const SMALLEST_SHIFT: f64 = 1e-10;

/// Largest η: about what remains of the overlap of a rattler after a step. η is the net force of the rattler over the
/// mean contact force, but at most this. An almost free rattler needs only a short displacement, even in a steep wedge.
const OFF_BACKBONE: f64 = 1e-4;

/// Smallest diagonal added, over the largest k_i. Without it, the pivots of a rattler with little stiffness may count
/// as those of a singular matrix (10⁻¹⁴). This is a hundred times above that limit.
const SMALLEST_DIAGONAL: f64 = 1e-12;

/// Iterations before a factor is made instead: ten times what 64000 spheres take at p = 10.
const ITERATION_LIMIT: usize = 5000;

/// The result of a factorisation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Solved {
    /// There is a step.
    Step,
    /// The matrix is not positive definite to rounding.
    Indefinite,
    /// Its factors do not fit in memory.
    OutOfMemory,
}

/// The shifted Hessian. Its buffers are reused; its symbolic analysis is reused while the pattern of entries stays the
/// same.
pub struct ShiftedHessian<const D: usize> {
    hessian: Hessian<D>,
    matrix: SymmetricMatrix,
    analysis: Option<Analysis>,
    prestress: Vec<f64>,
    stiffness: Vec<f64>,
    right_side: Vec<f64>,
    unknowns: Vec<f64>,
    /// Factorisations tried, complete or incomplete.
    pub factorisation_count: usize,
    /// The step of each mobile disk.
    pub step: Vec<Vector<D>>,
}

impl<const D: usize> ShiftedHessian<D> {
    /// Buffers for an assembly; [`ShiftedHessian::update`] fills them.
    pub fn new(assembly: &Assembly<D>) -> Self {
        ShiftedHessian {
            hessian: Hessian::of(assembly, Members::InContact, Prestress::Included),
            matrix: SymmetricMatrix::default(),
            analysis: None,
            prestress: vec![0.0; assembly.len()],
            stiffness: vec![0.0; assembly.len()],
            right_side: Vec::new(),
            unknowns: Vec::new(),
            factorisation_count: 0,
            step: vec![[0.0; D]; assembly.mobile_count()],
        }
    }

    /// Updates the Hessian at the present displacements.
    pub fn update(&mut self, assembly: &Assembly<D>, backbone: &[bool]) {
        let power = assembly.law().exponent() - 1.0;
        let weights = |contact: &StiffContact| {
            if backbone[contact.ends.0 as usize] && backbone[contact.ends.1 as usize] {
                (contact.stiffness, contact.across)
            } else {
                (contact.stiffness / power, 0.0)
            }
        };
        if !self.hessian.update_with(assembly, weights) {
            self.analysis = None;
        }
        self.set_rows(assembly);
    }

    fn set_rows(&mut self, assembly: &Assembly<D>) {
        let (law, pairs, mobile) = (assembly.law(), assembly.pairs(), assembly.mobile_count());
        let power = law.exponent() - 1.0;
        let displacements = &assembly.displacements;
        // F = F' δ / (α − 1).
        let across = |pair: usize, overlap: f64, stiffness: f64| stiffness * overlap / (power * pairs.distance(pair));
        stiffness_rows(law, pairs, displacements, mobile, Some(&across), &mut self.prestress);
        stiffness_rows(law, pairs, displacements, mobile, None, &mut self.stiffness);
        if law.on_site_coupling() > 0.0 {
            self.prestress.iter_mut().for_each(|row| *row += law.on_site_coupling());
        }
    }

    /// Solves for the step under the forces of the last evaluation.
    pub fn solve(&mut self, assembly: &Assembly<D>, backbone: &[bool], mean: f64, shift: f64) -> Solved {
        let coupling = assembly.law().on_site_coupling().abs();
        for (step, &force) in self.step.iter_mut().zip(&assembly.forces) {
            // Disks without rows feel at most their site.
            *step = if coupling > 0.0 { scaled(1.0 / coupling, force) } else { [0.0; D] };
        }
        if self.hessian.matrix().dimension() == 0 {
            return Solved::Step;
        }
        self.matrix.clone_from(self.hessian.matrix());
        self.right_side.clear();
        self.right_side.resize(self.matrix.dimension(), 0.0);
        let least =
            SMALLEST_DIAGONAL * self.stiffness[..assembly.mobile_count()].iter().fold(0.0, |most, &k| larger(k, most));
        for disk in 0..assembly.mobile_count() {
            let Some(row) = self.hessian.row_of(disk as u32) else { continue };
            let base = if backbone[disk] {
                SMALLEST_SHIFT
            } else {
                let force = norm(assembly.forces[disk]) / mean;
                shift + if force < OFF_BACKBONE { force.max(SMALLEST_SHIFT) } else { OFF_BACKBONE }
            };
            let value = larger(shift * self.prestress[disk] + base * self.stiffness[disk], least);
            for d in 0..D {
                // The first entry of a column is the one on the diagonal.
                self.matrix.values[self.matrix.starts[row + d]] += value;
                self.right_side[row + d] = assembly.forces[disk][d];
            }
        }
        match self.factorise_and_solve() {
            Ok(()) => {}
            Err(LinearError::OutOfMemory { .. }) => return Solved::OutOfMemory,
            Err(_) => return Solved::Indefinite,
        }
        for (disk, step) in self.step.iter_mut().enumerate() {
            if let Some(row) = self.hessian.row_of(disk as u32) {
                *step = std::array::from_fn(|d| self.unknowns[row + d]);
            }
        }
        Solved::Step
    }

    fn factorise_and_solve(&mut self) -> Result<(), LinearError> {
        if is_faster::<D>(self.hessian.disks().len()) {
            match self.iterate() {
                Err(LinearError::IterationsUsedUp { .. }) => {}
                solved => return solved,
            }
        }
        let analysis = match &mut self.analysis {
            Some(analysis) => analysis,
            empty => empty.insert(Analysis::of(&self.hessian)?),
        };
        self.factorisation_count += 1;
        self.unknowns.resize(self.right_side.len(), 0.0);
        analysis.cholesky(&self.matrix)?.solve(&self.right_side, &mut self.unknowns).map(|_| ())
    }

    /// Solves by conjugate gradients.
    fn iterate(&mut self) -> Result<(), LinearError> {
        self.factorisation_count += 1;
        self.unknowns.clear();
        self.unknowns.resize(self.right_side.len(), 0.0);
        let factor = IncompleteFactor::new(&self.matrix)?;
        let limits = IterationLimits { backward_error: ACCURACY, iteration_count: ITERATION_LIMIT };
        conjugate_gradients(&self.matrix, &factor, &self.right_side, &mut self.unknowns, &limits).map(|_| ())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Hertzian;
    use crate::packing::{Domain, Packing};

    /// Spheres of a body-centred cubic lattice, a few hundredths off their sites.
    fn displaced_lattice() -> Packing<3> {
        let (cells, edge) = (4usize, 0.93);
        let sites = (0..2 * cells.pow(3)).map(|site| {
            let (cell, half) = (site / 2, 0.5 * (site % 2) as f64);
            let off = |d: usize| 0.02 * libm::sin((7 * site + 11 * d) as f64);
            std::array::from_fn(|d| edge * ((cell / cells.pow(d as u32) % cells) as f64 + half) + off(d))
        });
        let positions: Vec<Vector<3>> = sites.collect();
        let radii = vec![0.5; positions.len()];
        let domain = Domain::rectangular([0.0; 3], [edge * cells as f64; 3]);
        Packing::new(domain, positions, radii).expect("separate spheres")
    }

    #[test]
    fn iterations_give_the_step_of_a_factor_and_refuse_what_it_refuses() {
        let packing = displaced_lattice();
        let mut assembly = Assembly::new(&packing, &Hertzian::default()).expect("separate spheres");
        let _ = assembly.evaluate_totals();
        let backbone = vec![true; packing.len()];
        let mut shifted = ShiftedHessian::new(&assembly);
        shifted.update(&assembly, &backbone);
        assert_eq!(shifted.solve(&assembly, &backbone, 1.0, 0.1), Solved::Step);
        let mut exact = shifted.unknowns.clone();
        shifted.iterate().expect("positive definite");
        let norm = |column: &[f64]| column.iter().map(|x| x * x).sum::<f64>().sqrt();
        let size = norm(&exact);
        exact.iter_mut().zip(&shifted.unknowns).for_each(|(exact, found)| *exact -= found);
        // Backward errors of 10⁻¹³ in maximum norms, √384 = 20 in others, times a condition below 10⁵: translations have
        // the stiffness θ p_i, a thousandth of k_i.
        assert!(norm(&exact) < 2e-7 * size, "{:e} of {size:e}", norm(&exact));
        assert_eq!(shifted.factorisation_count, 2);
        let dimension = shifted.matrix.dimension();
        for column in 0..dimension {
            shifted.matrix.values[shifted.matrix.starts[column]] *= 0.3;
        }
        let refused = Err(LinearError::NotPositiveDefinite { dimension });
        assert_eq!(shifted.iterate(), refused);
        assert_eq!(shifted.factorise_and_solve(), refused);
    }
}
