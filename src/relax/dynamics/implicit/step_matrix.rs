//! [`StepMatrix`]: the matrix of an implicit step, and the solution of its systems.
//!
//! ```text
//! (m/(hg)² + (ζ + C)/(hg) + K) U = r
//! ```
//!
//! The matrix contains the present contacts and those that may close during the step. Each disk may approach others by
//! up to ten times its displacement in the last accepted step. If the mass term dominates, conjugate gradients with an
//! incomplete factor need only a few matrix products. Otherwise a Cholesky factor serves all stages.

use crate::forces::assembly::Assembly;
use crate::law::damping::ContactDamping;
use crate::linear::hessian::{Hessian, Members, Prestress};
use crate::linear::iterative::{IncompleteFactor, IterationLimits, conjugate_gradients};
use crate::linear::{Analysis, Factorisation, LinearError};
use crate::neighbours::for_each_pair::{MovedPair, for_each_pair};
use crate::relax::dynamics::implicit::inertia::{Inertia, Work};
use crate::sparse::SymmetricMatrix;
use crate::vector::{Vector, larger, norm, scaled};

/// Largest condition number of the matrix, by its rows, for which conjugate gradients are used. They then need some ten
/// products per stage, and less time than a factorisation.
const ITERATION_CONDITION: f64 = 6.0;

/// Backward error of their solutions \[1\]. The relative error of a stage is then far below any tolerance of a step.
const ITERATION_ERROR: f64 = 1e-8;

/// Factor on the last displacement of a disk; the disk may approach others by the product in the next step.
const APPROACH_FACTOR: f64 = 10.0;

/// A pair in the matrix of a step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Link<const D: usize> {
    pub(crate) ends: (u32, u32),
    pub(crate) normal: Vector<D>,
    /// c of its damping in the matrix.
    pub(crate) damping: f64,
}

/// The terms that a step adds to the matrix.
pub(crate) struct StepTerms<'a> {
    /// hg, step times diagonal coefficient of the tableau \[time\].
    pub(crate) scale: f64,
    pub(crate) inertia: Inertia,
    pub(crate) damping: &'a ContactDamping,
    /// One per pair.
    pub(crate) damping_coefficient: &'a [f64],
    /// See [`ImplicitMotion::margin`](super::ImplicitMotion::margin).
    pub(crate) margin: f64,
    /// See [`ImplicitMotion::prestressed`](super::ImplicitMotion::prestressed).
    pub(crate) prestressed: &'a [bool],
}

/// The matrix of a step. Its buffers and its analysis are kept from one step to the next.
#[derive(Debug)]
pub(crate) struct StepMatrix<const D: usize> {
    hessian: Hessian<D>,
    matrix: SymmetricMatrix,
    analysis: Option<Analysis>,
    /// Displacement of each mobile disk in the last accepted step; infinite before the first.
    last_distances: Vec<f64>,
    margins: Vec<f64>,
    /// Stiffness of each pair in the matrix, with its damping over hg.
    along: Vec<f64>,
    links: Vec<Link<D>>,
}

/// A matrix ready for solutions.
pub(crate) struct PreparedMatrix<'a, const D: usize> {
    pub(crate) hessian: &'a Hessian<D>,
    pub(crate) links: &'a [Link<D>],
    solver: Solver<'a>,
}

/// The solver of the stages of one step.
enum Solver<'a> {
    Factor(Factorisation<'a>),
    Iterate(IncompleteFactor, &'a SymmetricMatrix),
}

impl<const D: usize> StepMatrix<D> {
    pub(crate) fn of(assembly: &Assembly<D>) -> Self {
        StepMatrix {
            hessian: Hessian::of(assembly, Members::Mobile, Prestress::Included),
            matrix: SymmetricMatrix::default(),
            analysis: None,
            last_distances: vec![f64::INFINITY; assembly.mobile_count()],
            margins: Vec::new(),
            along: Vec::new(),
            links: Vec::new(),
        }
    }

    /// Sets the displacements of the last step. They bound the approach of disks in the next step.
    pub(crate) fn set_last_distances(&mut self, moved: &[Vector<D>]) {
        self.last_distances.iter_mut().zip(moved).for_each(|(distance, &moved)| *distance = norm(moved));
    }

    /// The matrix of a step from the present state, factorised or prepared for conjugate gradients.
    pub(crate) fn set(
        &mut self,
        assembly: &Assembly<D>,
        terms: &StepTerms<'_>,
        work: &mut Work,
    ) -> Result<PreparedMatrix<'_, D>, LinearError> {
        self.set_links(assembly, terms);
        let (mass, friction) = terms.inertia.resistance();
        let diagonal = mass / (terms.scale * terms.scale) + friction / terms.scale;
        let (margins, along, prestressed) = (&self.margins, &self.along, terms.prestressed);
        let same = self.hessian.update_within(
            assembly,
            |pair| margins[pair],
            terms.margin,
            |contact| {
                let both = prestressed[contact.ends.0 as usize] && prestressed[contact.ends.1 as usize];
                (along[contact.pair], if both { contact.across } else { 0.0 })
            },
        );
        if !same {
            self.analysis = None;
            work.contact_change_count += 1;
        }
        let matrix = &mut self.matrix;
        matrix.clone_from(self.hessian.matrix());
        for column in 0..matrix.dimension() {
            // The first entry of a column is the diagonal one.
            matrix.values[matrix.starts[column]] += diagonal;
        }
        let iterate = mass > 0.0 && matrix.norm() <= ITERATION_CONDITION * diagonal;
        let solver = if iterate {
            Solver::Iterate(IncompleteFactor::new(matrix)?, matrix)
        } else {
            let analysis = match self.analysis.take() {
                Some(analysis) => analysis,
                None => Analysis::of(&self.hessian)?,
            };
            work.factorisation_count += 1;
            Solver::Factor(self.analysis.insert(analysis).cholesky(matrix)?)
        };
        Ok(PreparedMatrix { hessian: &self.hessian, links: &self.links, solver })
    }

    /// The pairs in the matrix: those in contact, and those that may touch during the step.
    fn set_links(&mut self, assembly: &Assembly<D>, terms: &StepTerms<'_>) {
        let (pairs, law) = (assembly.pairs(), assembly.law());
        let last = |disk: u32| self.last_distances.get(disk as usize).copied().unwrap_or(0.0);
        self.links.clear();
        for column in [&mut self.margins, &mut self.along] {
            column.clear();
            column.resize(pairs.place_count(), 0.0);
        }
        for_each_pair(
            pairs,
            &assembly.displacements,
            &mut |&MovedPair { pair, ends, separation, distance, overlap, coefficient }| {
                let margin = (APPROACH_FACTOR * larger(last(ends.0), last(ends.1))).min(terms.margin);
                self.margins[pair] = margin;
                if overlap <= -margin {
                    return;
                }
                let wide = overlap + margin;
                let damping = match terms.inertia {
                    Inertia::Massive => terms.damping.damping(terms.damping_coefficient[pair], wide),
                    Inertia::Friction(_) => 0.0,
                };
                let along = law.stiffness(law.force(coefficient, wide), wide) + damping / terms.scale;
                self.along[pair] = along;
                self.links.push(Link { ends, normal: scaled(1.0 / distance, separation), damping });
            },
        );
    }
}

impl<const D: usize> PreparedMatrix<'_, D> {
    /// Solves for one stage. Returns the number of iterations.
    pub(crate) fn solve(&mut self, right_side: &[f64], unknowns: &mut [f64]) -> usize {
        match &mut self.solver {
            Solver::Factor(factorisation) => {
                factorisation.solve_unrefined(right_side, unknowns);
                0
            }
            Solver::Iterate(factor, matrix) => {
                unknowns.fill(0.0);
                let limits = IterationLimits { backward_error: ITERATION_ERROR, iteration_count: 200 };
                match conjugate_gradients(matrix, factor, right_side, unknowns, &limits) {
                    Ok(solution) => solution.iteration_count,
                    // The best solution so far. If it is too inaccurate, the error estimate of the step shows it.
                    Err(_) => limits.iteration_count,
                }
            }
        }
    }
}
