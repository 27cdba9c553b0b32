//! [`StepMatrix`]: the matrix of an implicit step, and how its systems are solved.
//!
//! ```text
//! (m/(hγ)² + (ζ + C)/(hγ) + K) U = r
//! ```
//!
//! In it are the contacts there are and those that may close on the way: each disk is taken to come nearer by up to ten
//! times its way in the last step that was not taken back. Where the mass term dominates, the diagonal and an incomplete factor are
//! enough, and conjugate gradients need a few products; elsewhere a Cholesky factor serves all stages.

use crate::forces::assembly::Assembly;
use crate::law::damping::DampingLaw;
use crate::law::pair_law::PairLaw;
use crate::linear::hessian::{Hessian, Members, Prestress};
use crate::linear::iterative::{IncompleteFactor, IterationLimits, conjugate_gradients};
use crate::linear::{Analysis, Factorisation, LinearError};
use crate::neighbours::for_each_pair::{Walked, walk};
use crate::relax::dynamics::implicit::inertia::{Inertia, Work};
use crate::sparse::SymmetricMatrix;
use crate::vector::{Vector, larger, norm, scaled};

/// Condition of the matrix, by its rows, up to which conjugate gradients are used: there they need some ten products a stage,
/// and take less time than a factorisation of any size (5548 disks).
const ITERATE_BELOW: f64 = 6.0;

/// Backward error of their solutions \[1\]: a stage is known to this share of its way, far below any tolerance of a step.
const ITERATE_TO: f64 = 1e-8;

/// Share of a disk's last way by which it may come nearer in the next step.
const OUTLOOK: f64 = 10.0;

/// A pair in the matrix of a step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Link<const D: usize> {
    pub(crate) ends: (u32, u32),
    pub(crate) normal: Vector<D>,
    /// c of its damping in the matrix.
    pub(crate) damping: f64,
}

/// What a step has to say about its matrix.
pub(crate) struct StepTerms<'a, C> {
    /// hγ.
    pub(crate) scale: f64,
    pub(crate) inertia: Inertia,
    pub(crate) damping: &'a C,
    /// One a pair.
    pub(crate) damping_coefficient: &'a [f64],
    /// See [`ImplicitMotion::margin`](super::ImplicitMotion::margin).
    pub(crate) margin: f64,
    /// See [`ImplicitMotion::prestressed`](super::ImplicitMotion::prestressed).
    pub(crate) prestressed: &'a [bool],
}

/// The matrix of a step; its buffers and analysis are kept from one step to the next.
#[derive(Debug)]
pub(crate) struct StepMatrix<const D: usize> {
    hessian: Hessian<D>,
    matrix: SymmetricMatrix,
    analysis: Option<Analysis>,
    /// How far each mobile disk went in the last step that was not taken back; infinite before the first.
    ways: Vec<f64>,
    margins: Vec<f64>,
    /// Stiffness of each pair in the matrix, with its damping over hγ.
    along: Vec<f64>,
    links: Vec<Link<D>>,
}

/// A matrix ready to be solved with.
pub(crate) struct Ready<'a, const D: usize> {
    pub(crate) hessian: &'a Hessian<D>,
    pub(crate) links: &'a [Link<D>],
    solver: Solver<'a>,
}

/// How the stages of one step are solved.
enum Solver<'a> {
    Factor(Factorisation<'a>),
    Iterate(IncompleteFactor, &'a SymmetricMatrix),
}

impl<const D: usize> StepMatrix<D> {
    pub(crate) fn of<L: PairLaw>(assembly: &Assembly<D, L>) -> Self {
        StepMatrix {
            hessian: Hessian::of(assembly, Members::Mobile, Prestress::Included),
            matrix: SymmetricMatrix::default(),
            analysis: None,
            ways: vec![f64::INFINITY; assembly.mobile_count()],
            margins: Vec::new(),
            along: Vec::new(),
            links: Vec::new(),
        }
    }

    /// The ways of the last step, from which follows how much nearer disks may come in the next.
    pub(crate) fn set_ways(&mut self, moved: &[Vector<D>]) {
        self.ways.iter_mut().zip(moved).for_each(|(way, &moved)| *way = norm(moved));
    }

    /// The matrix of a step that begins here, factorised or ready for conjugate gradients.
    pub(crate) fn set<L: PairLaw, C: DampingLaw>(
        &mut self,
        assembly: &Assembly<D, L>,
        terms: &StepTerms<'_, C>,
        work: &mut Work,
    ) -> Result<Ready<'_, D>, LinearError> {
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
            // The first entry of a column is the one on the diagonal.
            matrix.values[matrix.starts[column]] += diagonal;
        }
        let iterate = mass > 0.0 && matrix.norm() <= ITERATE_BELOW * diagonal;
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
        Ok(Ready { hessian: &self.hessian, links: &self.links, solver })
    }

    /// The pairs in the matrix: those that touch, and those that may come to on the way.
    fn set_links<L: PairLaw, C: DampingLaw>(&mut self, assembly: &Assembly<D, L>, terms: &StepTerms<'_, C>) {
        let (pairs, law) = (assembly.pairs(), assembly.law());
        let way = |disk: u32| self.ways.get(disk as usize).copied().unwrap_or(0.0);
        self.links.clear();
        for column in [&mut self.margins, &mut self.along] {
            column.clear();
            column.resize(pairs.place_count(), 0.0);
        }
        walk(pairs, &assembly.displacements, &mut |&Walked { pair, ends, apart, distance, overlap, coefficient }| {
            let margin = (OUTLOOK * larger(way(ends.0), way(ends.1))).min(terms.margin);
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
            self.links.push(Link { ends, normal: scaled(1.0 / distance, apart), damping });
        });
    }
}

impl<const D: usize> Ready<'_, D> {
    /// Solves for one stage; the iterations it took.
    pub(crate) fn solve(&mut self, right_side: &[f64], unknowns: &mut [f64]) -> usize {
        match &mut self.solver {
            Solver::Factor(factorisation) => {
                factorisation.solve_unrefined(right_side, unknowns);
                0
            }
            Solver::Iterate(factor, matrix) => {
                unknowns.fill(0.0);
                let limits = IterationLimits { backward_error: ITERATE_TO, iteration_count: 200 };
                match conjugate_gradients(matrix, factor, right_side, unknowns, &limits) {
                    Ok(solution) => solution.iteration_count,
                    // The best so far; the error of the step tells if it is not good enough.
                    Err(_) => limits.iteration_count,
                }
            }
        }
    }
}
