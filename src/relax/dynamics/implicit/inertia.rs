//! [`Inertia`]: what resists a motion; [`Stepped`] and [`Work`]: what its steps come to and cost.

use crate::forces::totals::Totals;

/// What resists motion beside the contacts.
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

/// What a step came to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stepped<const D: usize> {
    /// The disks are where the step ends.
    Moved(Totals<D>),
    /// The factors of its matrix do not fit in memory; nothing has moved.
    OutOfMemory,
    /// The matrix is not positive definite: the step is so long that it would pass over a motion that grows, away from a
    /// saddle; nothing has moved.
    Indefinite,
    /// A disk would go farther than the smallest radius: to be taken back.
    TooFar,
}

/// Work of a motion so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Work {
    /// Evaluations of forces and damping.
    pub evaluation_count: usize,
    /// Sparse factorisations tried.
    pub factorisation_count: usize,
    /// Iterations of conjugate gradients.
    pub iteration_count: usize,
    /// Steps over whose start the set of contacts had changed since the start of the step before.
    pub contact_change_count: usize,
}
