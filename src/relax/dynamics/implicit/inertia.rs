//! [`Inertia`]: the resistance to motion; [`Stepped`] and [`Work`]: results and cost of steps.

use crate::forces::totals::Totals;

/// Resistance to motion, beside the contacts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Inertia {
    /// Masses 1, no friction: damped dynamics.
    Massive,
    /// No masses, friction ζ on every disk: gradient flow \[force / velocity\].
    Friction(f64),
}

impl Inertia {
    /// Mass and friction of a disk.
    pub(crate) fn resistance(self) -> (f64, f64) {
        match self {
            Inertia::Massive => (1.0, 0.0),
            Inertia::Friction(friction) => (0.0, friction),
        }
    }
}

/// The result of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stepped<const D: usize> {
    /// The disks are at the end of the step.
    Moved(Totals<D>),
    /// The factors of the matrix do not fit in memory. Nothing has moved.
    OutOfMemory,
    /// The matrix is not positive definite: such a long step would miss a growing motion away from a saddle. Nothing
    /// has moved.
    Indefinite,
    /// A disk would move farther than the smallest radius. The step must be taken back.
    TooFar,
}

/// Cost of a motion so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Work {
    /// Evaluations of forces and damping.
    pub evaluation_count: usize,
    /// Sparse factorisations tried.
    pub factorisation_count: usize,
    /// Iterations of conjugate gradients.
    pub iteration_count: usize,
    /// Steps at whose start the set of contacts differs from that at the start of the step before.
    pub contact_change_count: usize,
}
