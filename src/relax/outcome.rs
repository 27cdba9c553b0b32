//! [`Outcome`]: the result of a relaxer, and [`Relaxed`], which only a converged outcome can make.

use serde::{Deserialize, Serialize};

use crate::relax::energy_account::EnergyAccount;

/// The limit that a converged state met.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Criterion {
    /// The relative residual.
    RelativeForce,
    /// The absolute residual.
    AbsoluteForce,
    /// All contact forces and net forces vanish, see [`UNJAMMED_FORCE`](crate::relax::UNJAMMED_FORCE). An absolute
    /// limit is met as well.
    Unjammed,
}

/// Why a relaxer stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stop {
    /// At rest by this criterion.
    Converged(Criterion),
    /// The steps allowed are used up.
    StepLimit,
    /// The residual fluctuates at the rounding floor, above the limit.
    RoundingFloor,
    /// A force became NaN or infinite.
    NonFinite,
    /// Disks overlap, but the squares of their forces underflow: the stiffness constant or the radii are too small, and
    /// the residual is unknown.
    Underflow,
    /// A damped motion gained energy, or its energies do not balance: its steps are too long, even the shortest.
    Unstable,
    /// At rest, but with more energy than at the start. A relaxation cannot lead there.
    EnergyGained,
    /// Disks that the law pushes from their sites (Γ > 0) ran away: one is [`RUNAWAY`](crate::relax::RUNAWAY) from
    /// where it began; or a disk with a load, and no site that ties it, has left the packing. The stiffness matrix is or became indefinite, and there is no minimum. The final state and its
    /// residual have no meaning. Forces alone do not distinguish a saddle from a minimum: disks at a saddle count as at
    /// rest. The number of negative eigenvalues distinguishes the two, see `linear`.
    NoMinimum,
    /// An implicit motion stagnates. For thousands of steps its residual has not fallen by 10 %, and damping has taken
    /// less than half of its kinetic energy.
    #[cfg(feature = "linear")]
    #[serde(alias = "restless")]
    Stagnation,
    /// The factors of the matrix of Newton's method or of an implicit step do not fit in memory.
    #[cfg(feature = "linear")]
    OutOfMemory,
    /// No step, however short, lowers the energy, and the residual is above the rounding floor.
    NoDescent,
    /// The trace interrupted it: [`Trace::interrupted`](crate::relax::Trace::interrupted).
    Interrupted,
}

/// How far a state is from equilibrium.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Residual {
    /// Largest net force on a mobile disk of the backbone \[force\].
    pub largest_net_force: f64,
    /// Mean contact force of the backbone \[force\].
    pub mean_contact_force: f64,
}

impl Residual {
    /// The ratio of the two; 0 without any force \[1\].
    pub fn relative(&self) -> f64 {
        if self.largest_net_force == 0.0 { 0.0 } else { self.largest_net_force / self.mean_contact_force }
    }
}

/// The result of a relaxer, converged or not.
#[must_use]
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome<T> {
    /// The final state.
    pub state: T,
    /// Why the relaxer stopped.
    pub stop: Stop,
    /// The residual reached.
    pub residual: Residual,
    /// The rounding floor of the relative residual, estimated by [`rounding_floor`](crate::relax::rounding_floor())
    /// \[1\].
    pub rounding_floor: f64,
    /// The cost.
    pub cost: Cost,
}

/// The cost of a relaxation.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Cost {
    /// Steps taken.
    pub step_count: usize,
    /// Steps rejected because of a large error, including those within explicit phases. Not written if 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub rejected_count: usize,
    /// Evaluations in the explicit and stabilised phases of implicit dynamics: one per explicit step, s per stabilised
    /// step of s stages. A phase counts as one step. Not written if 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub explicit_count: usize,
    /// Evaluations of all forces.
    pub force_evaluation_count: usize,
    /// Neighbour lists built. Files keep the earlier name `rebuild_count`.
    #[serde(rename = "rebuild_count")]
    pub build_count: usize,
    /// Sparse factorisations tried. Not written if 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub factorisation_count: usize,
    /// Iterations of conjugate gradients on linear systems. Not written if 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub iteration_count: usize,
    /// Energies at the start, at the end, and of the motion between.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub energies: Option<EnergyAccount>,
    /// Simulated time of relaxers that follow a motion. Not written if 0 \[time\].
    #[serde(default, skip_serializing_if = "is_no_time")]
    pub simulated_time: f64,
    /// Wall time \[s\]. Never written, since two runs must agree to the byte.
    #[serde(skip)]
    pub seconds: f64,
}

fn is_zero(count: &usize) -> bool {
    *count == 0
}

fn is_no_time(time: &f64) -> bool {
    *time == 0.0
}

impl Cost {
    /// The sum of this cost and of one that follows.
    pub fn plus(self, other: Cost) -> Cost {
        Cost {
            step_count: self.step_count + other.step_count,
            rejected_count: self.rejected_count + other.rejected_count,
            explicit_count: self.explicit_count + other.explicit_count,
            force_evaluation_count: self.force_evaluation_count + other.force_evaluation_count,
            build_count: self.build_count + other.build_count,
            factorisation_count: self.factorisation_count + other.factorisation_count,
            iteration_count: self.iteration_count + other.iteration_count,
            energies: match (self.energies, other.energies) {
                (Some(first), Some(second)) => Some(first.then(second)),
                (first, second) => first.or(second),
            },
            simulated_time: self.simulated_time + other.simulated_time,
            seconds: self.seconds + other.seconds,
        }
    }
}

/// A state at rest, proven by its type: only [`Outcome::converged`] makes one.
#[derive(Debug, Clone, PartialEq)]
pub struct Relaxed<T>(T);

impl<T> Relaxed<T> {
    /// The state.
    pub fn get(&self) -> &T {
        &self.0
    }

    /// The state, no longer known to be at rest.
    pub fn into_inner(self) -> T {
        self.0
    }
}

impl<T> Outcome<T> {
    /// The state if it is at rest, otherwise the whole outcome.
    ///
    /// # Errors
    /// The outcome itself, with its stop and its residual.
    #[allow(clippy::result_large_err, reason = "the error is the outcome: the state is wanted in both cases")]
    pub fn converged(self) -> Result<Relaxed<T>, Self> {
        if matches!(self.stop, Stop::Converged(_)) { Ok(Relaxed(self.state)) } else { Err(self) }
    }
}
