//! [`Outcome`]: what a relaxer gives back, and [`Relaxed`], which only a converged outcome can make.

use serde::{Deserialize, Serialize};

use crate::relax::energy_account::EnergyAccount;

/// Which limit a converged state met.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Criterion {
    /// The relative residual.
    RelativeForce,
    /// The absolute residual.
    AbsoluteForce,
    /// Every contact force and every net force vanished, see [`UNJAMMED_FORCE`]; and is below the limit, if that is
    /// absolute.
    Unjammed,
}

/// Why a relaxer stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stop {
    /// At rest by this criterion.
    Converged(Criterion),
    /// The number of steps allowed is used up.
    StepLimit,
    /// The residual fluctuates at the rounding floor, above the limit asked for.
    RoundingFloor,
    /// A force became NaN or infinite.
    NonFinite,
    /// Disks overlap, but their forces are so small that the squares of net forces are no longer numbers with all digits: the
    /// stiffness constant, or the radii, are too small, and no residual can be told.
    Underflow,
    /// A damped motion gained energy, or its energies do not add up, however short its steps: they are too long.
    Unstable,
    /// At rest, but higher in energy than at the start: not where a relaxation can lead.
    EnergyGained,
    /// Pushed from their sites (Γ > 0), disks ran away: one is [`RUNAWAY`] from where it began. Near the sites the stiffness
    /// matrix is indefinite or became so on the way, and there is no minimum. The state is the one they ran to; its residual
    /// says nothing. (Forces alone do not tell a saddle from a minimum: disks that nothing pushes off a saddle stay there and
    /// count as at rest. The number of negative eigenvalues tells, see `linear`.)
    NoMinimum,
    /// An implicit motion does not come to rest: for thousands of steps its residual has not fallen by a tenth, and damping has
    /// taken less than half of its kinetic energy.
    #[cfg(feature = "linear")]
    Restless,
    /// The factors of Newton's matrix do not fit in memory.
    #[cfg(feature = "linear")]
    OutOfMemory,
    /// No step, however short, lowers the energy, and the residual is above what rounding makes.
    NoDescent,
    /// Whoever watched asked it to end: [`Trace::interrupted`].
    Interrupted,
}

/// How far from equilibrium a state is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Residual {
    /// Largest net force on a mobile disk of the backbone \[force\].
    pub largest_net_force: f64,
    /// Mean contact force of the backbone \[force\].
    pub mean_contact_force: f64,
}

impl Residual {
    /// The first over the second; 0 where there is no force at all \[1\].
    pub fn relative(&self) -> f64 {
        if self.largest_net_force == 0.0 { 0.0 } else { self.largest_net_force / self.mean_contact_force }
    }
}

/// What a relaxer gives back, converged or not.
#[must_use]
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome<T> {
    /// Where it stopped.
    pub state: T,
    /// Why it stopped.
    pub stop: Stop,
    /// The residual reached.
    pub residual: Residual,
    /// What rounding alone makes of the relative residual, by the estimate of [`rounding_floor`] \[1\].
    pub rounding_floor: f64,
    /// What it cost.
    pub cost: Cost,
}

/// What a relaxation cost.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Cost {
    /// Steps taken.
    pub step_count: usize,
    /// Steps whose error was too large, so that they were repeated, those within stretches included; not written where there are
    /// none.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub rejected_count: usize,
    /// Evaluations in the stretches of explicit and stabilised steps of implicit dynamics, one an explicit step, s a stabilised
    /// one of s stages; a stretch is one of its steps. Not written where there are none.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub explicit_count: usize,
    /// Evaluations of all forces.
    pub force_evaluation_count: usize,
    /// Neighbour lists made.
    pub rebuild_count: usize,
    /// Sparse factorisations tried, by the relaxers that make them; not written where there are none.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub factorisation_count: usize,
    /// Iterations of conjugate gradients on linear systems; not written where there are none.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub iteration_count: usize,
    /// Energies at the start and at the end, and of the motion between them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub energies: Option<EnergyAccount>,
    /// Time that has passed in the motion, by the relaxers that follow one; not written where there is none \[time\].
    #[serde(default, skip_serializing_if = "is_no_time")]
    pub simulated_time: f64,
    /// Wall time \[s\]; never written where two runs must agree to the byte.
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
    /// Both together, the other after this one.
    pub fn plus(self, other: Cost) -> Cost {
        Cost {
            step_count: self.step_count + other.step_count,
            rejected_count: self.rejected_count + other.rejected_count,
            explicit_count: self.explicit_count + other.explicit_count,
            force_evaluation_count: self.force_evaluation_count + other.force_evaluation_count,
            rebuild_count: self.rebuild_count + other.rebuild_count,
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
    /// The state if it is at rest, otherwise the whole outcome back.
    ///
    /// # Errors
    /// The outcome itself, with why it stopped and the residual.
    #[allow(clippy::result_large_err, reason = "the error is the outcome: the state is wanted in both cases")]
    pub fn converged(self) -> Result<Relaxed<T>, Self> {
        if matches!(self.stop, Stop::Converged(_)) { Ok(Relaxed(self.state)) } else { Err(self) }
    }
}
