//! Bringing a packing to rest: [`Relaxer`], its [`Outcome`], and [`Relaxed`], which only a converged outcome can make.
//!
//! The residual is the largest net force on a mobile disk of the backbone over the mean contact force of the backbone.
//! Where disks press each other but there is no backbone, as in a chain, all mobile disks count. Held disks never do.
//! Rattlers are held to the square root of the limit only: their contacts open algebraically slowly, without touching the
//! backbone.

pub mod conjugate_gradients;
pub mod damped;
mod descent;
mod energy_balance;
mod explicit_step;
pub mod fire;
mod flat;
#[cfg(feature = "linear")]
pub mod implicit;
mod line_search;
mod monitor;
#[cfg(feature = "linear")]
pub mod newton;
pub mod quasi_newton;
#[cfg(feature = "linear")]
mod shifted;
#[cfg(feature = "linear")]
pub mod staged;

use serde::{Deserialize, Serialize};

use crate::law::damping::DampingChoice;
use crate::law::pair_law::PairLaw;
use crate::packing::{Packing, PackingError};

pub use conjugate_gradients::NonlinearConjugateGradients;
pub use damped::{DampedDynamics, Motion, NetForce, TimeStep};
pub use energy_balance::EnergyAccount;
pub use fire::{Fire, Precision, StepBack, Uphill};
#[cfg(feature = "linear")]
pub use implicit::{GradientFlow, ImplicitDynamics};
pub use monitor::rounding_floor;
#[cfg(feature = "linear")]
pub use newton::Newton;
pub use quasi_newton::QuasiNewton;
#[cfg(feature = "linear")]
pub use staged::Staged;

/// When a packing counts as being at rest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ForceLimit {
    /// Largest net force on a mobile disk of the backbone over the mean contact force \[1\].
    Relative(f64),
    /// Largest net force on a mobile disk of the backbone, of any mobile disk where there is no backbone \[force\].
    Absolute(f64),
}

impl Default for ForceLimit {
    /// 10⁻⁸ of the mean contact force. Source: design §7 (an absolute limit means 2·10⁻⁶ at p = 0.04 and 10⁻¹⁰ at 860).
    fn default() -> Self {
        ForceLimit::Relative(1e-8)
    }
}

impl ForceLimit {
    /// The number, whatever it is relative to \[1, or force\].
    pub fn value(&self) -> f64 {
        match *self {
            ForceLimit::Relative(value) | ForceLimit::Absolute(value) => value,
        }
    }

    /// A relative limit in place of this one, unless this is a relative one that asks for no less.
    fn loosened(self, limit: f64) -> Option<ForceLimit> {
        (!matches!(self, ForceLimit::Relative(own) if own >= limit)).then_some(ForceLimit::Relative(limit))
    }
}

/// Contact forces below this share of the force at an overlap of one radius count as none: the packing is unjammed.
///
/// 10⁻¹² is 3.5·10⁻⁸ for the Hertzian disks of the model, where a packing at p = 0.05 has contact forces of 0.05.
pub const UNJAMMED_FORCE: f64 = 1e-12;

/// Way of a disk from its site over the largest radius from which on it counts as run away \[1\]: a diameter, so it has left
/// the cage of its neighbours. Up to there contacts could have held it; beyond, the push Γu only grows.
pub const RUNAWAY: f64 = 2.0;

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

/// What a relaxer tells while it works; `()` hears nothing and costs nothing.
pub trait Trace {
    /// Whether anything listens; lets the caller leave out what only a listener needs.
    const ACTIVE: bool = true;

    /// Called at every look at the residual.
    fn look(&mut self, look: &Look);

    /// Asked after every look: whether the relaxer is to end here, with [`Stop::Interrupted`].
    fn interrupted(&mut self) -> bool {
        false
    }
}

/// One look at a relaxation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// Steps taken so far.
    pub step_count: usize,
    /// Elastic energy, with that of the sites where the law has one: it may be negative then \[energy\].
    pub energy: f64,
    /// Kinetic energy \[energy\].
    pub kinetic_energy: f64,
    /// Relative residual, with the backbone of the last refresh \[1\].
    pub residual: f64,
    /// Time step \[time\].
    pub time_step: f64,
    /// The relaxer restarted from rest here; its energies at restarts never increase.
    pub restart: bool,
}

impl Trace for () {
    const ACTIVE: bool = false;
    fn look(&mut self, _look: &Look) {}
}

impl<F: FnMut(&Look)> Trace for F {
    fn look(&mut self, look: &Look) {
        self(look);
    }
}

/// A way to bring a packing to rest.
pub trait Relaxer {
    /// Moves the mobile disks until they are at rest or a limit is met.
    ///
    /// # Errors
    /// Only what makes forces undefined: a box too small, two disks with the same centre.
    fn relax<const D: usize, L: PairLaw>(
        &self,
        packing: Packing<D>,
        law: &L,
        trace: &mut impl Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError>;

    /// The same relaxer for states that are only passed through: at rest at a relative residual of `limit` \[1\]. None where it
    /// asks for no less itself, or has no such limit.
    fn passing(&self, limit: f64) -> Option<Self>
    where
        Self: Sized,
    {
        let _ = limit;
        None
    }
}

/// A relaxer chosen at run time, as a scene names it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RelaxerChoice {
    /// [`Fire`].
    Fire(Fire),
    /// [`DampedDynamics`].
    Damped(DampedDynamics),
    /// [`NonlinearConjugateGradients`].
    ConjugateGradients(NonlinearConjugateGradients),
    /// [`QuasiNewton`].
    QuasiNewton(QuasiNewton),
    /// [`ImplicitDynamics`].
    #[cfg(feature = "linear")]
    Implicit(ImplicitDynamics),
    /// [`GradientFlow`].
    #[cfg(feature = "linear")]
    GradientFlow(GradientFlow),
    /// [`Newton`].
    #[cfg(feature = "linear")]
    Newton(Newton),
    /// [`Staged`].
    #[cfg(feature = "linear")]
    Staged(Staged),
}

impl Default for RelaxerChoice {
    fn default() -> Self {
        RelaxerChoice::Fire(Fire::default())
    }
}

impl RelaxerChoice {
    /// Its force limit.
    pub fn limit(&self) -> ForceLimit {
        match self {
            RelaxerChoice::Fire(fire) => fire.limit,
            RelaxerChoice::Damped(damped) => damped.limit,
            RelaxerChoice::ConjugateGradients(conjugate_gradients) => conjugate_gradients.limit,
            RelaxerChoice::QuasiNewton(quasi_newton) => quasi_newton.limit,
            #[cfg(feature = "linear")]
            RelaxerChoice::Implicit(dynamics) => dynamics.limit,
            #[cfg(feature = "linear")]
            RelaxerChoice::GradientFlow(flow) => flow.limit,
            #[cfg(feature = "linear")]
            RelaxerChoice::Newton(newton) => newton.limit,
            #[cfg(feature = "linear")]
            RelaxerChoice::Staged(staged) => staged.limit,
        }
    }

    /// What it is, in the words of a report: dynamics by their damping law and rate, "viscoelastic 500".
    ///
    /// It has what a minimum depends on, but no limits and no tolerances.
    pub fn description(&self) -> String {
        let precise = |words: &str, precision: Precision| match precision {
            Precision::Double => words.to_string(),
            Precision::Mixed => format!("{words}, mixed precision"),
        };
        let damped = |damping: DampingChoice, net_force: NetForce| {
            let law = match damping {
                DampingChoice::Constant(_) => "constant damping",
                DampingChoice::Viscoelastic(_) => "viscoelastic",
            };
            let total = if net_force == NetForce::Total { ", total force" } else { "" };
            format!("{law} {}{total}", damping.rate())
        };
        match self {
            RelaxerChoice::Fire(fire) => precise("FIRE", fire.precision),
            RelaxerChoice::Damped(dynamics) => format!("{}, explicit", damped(dynamics.damping, dynamics.net_force)),
            RelaxerChoice::ConjugateGradients(_) | RelaxerChoice::QuasiNewton(_) => self.name().into(),
            #[cfg(feature = "linear")]
            RelaxerChoice::Implicit(dynamics) => damped(dynamics.damping, dynamics.net_force),
            #[cfg(feature = "linear")]
            RelaxerChoice::GradientFlow(_) | RelaxerChoice::Newton(_) => self.name().into(),
            #[cfg(feature = "linear")]
            RelaxerChoice::Staged(staged) => precise("FIRE and Newton", staged.precision),
        }
    }

    /// Its name in a table.
    pub fn name(&self) -> &'static str {
        match self {
            RelaxerChoice::Fire(fire) => match fire.precision {
                Precision::Double => "FIRE",
                Precision::Mixed => "FIRE, mixed",
            },
            RelaxerChoice::Damped(damped) => match damped.net_force {
                NetForce::Elastic => "damped dynamics",
                NetForce::Total => "damped, total force",
            },
            RelaxerChoice::ConjugateGradients(_) => "conjugate gradients",
            RelaxerChoice::QuasiNewton(_) => "L-BFGS",
            #[cfg(feature = "linear")]
            RelaxerChoice::Implicit(dynamics) => match dynamics.net_force {
                NetForce::Elastic => "implicit dynamics",
                NetForce::Total => "implicit, total force",
            },
            #[cfg(feature = "linear")]
            RelaxerChoice::GradientFlow(_) => "gradient flow",
            #[cfg(feature = "linear")]
            RelaxerChoice::Newton(_) => "Newton",
            #[cfg(feature = "linear")]
            RelaxerChoice::Staged(staged) => match staged.precision {
                Precision::Double => "FIRE, then Newton",
                Precision::Mixed => "mixed FIRE, Newton",
            },
        }
    }
}

impl Relaxer for RelaxerChoice {
    fn relax<const D: usize, L: PairLaw>(
        &self,
        packing: Packing<D>,
        law: &L,
        trace: &mut impl Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError> {
        match self {
            RelaxerChoice::Fire(fire) => fire.relax(packing, law, trace),
            RelaxerChoice::Damped(damped) => damped.relax(packing, law, trace),
            RelaxerChoice::ConjugateGradients(conjugate_gradients) => conjugate_gradients.relax(packing, law, trace),
            RelaxerChoice::QuasiNewton(quasi_newton) => quasi_newton.relax(packing, law, trace),
            #[cfg(feature = "linear")]
            RelaxerChoice::Implicit(dynamics) => dynamics.relax(packing, law, trace),
            #[cfg(feature = "linear")]
            RelaxerChoice::GradientFlow(flow) => flow.relax(packing, law, trace),
            #[cfg(feature = "linear")]
            RelaxerChoice::Newton(newton) => newton.relax(packing, law, trace),
            #[cfg(feature = "linear")]
            RelaxerChoice::Staged(staged) => staged.relax(packing, law, trace),
        }
    }

    fn passing(&self, limit: f64) -> Option<Self> {
        Some(match self {
            RelaxerChoice::Fire(fire) => RelaxerChoice::Fire(fire.passing(limit)?),
            RelaxerChoice::Damped(damped) => RelaxerChoice::Damped(damped.passing(limit)?),
            RelaxerChoice::ConjugateGradients(relaxer) => RelaxerChoice::ConjugateGradients(relaxer.passing(limit)?),
            RelaxerChoice::QuasiNewton(relaxer) => RelaxerChoice::QuasiNewton(relaxer.passing(limit)?),
            #[cfg(feature = "linear")]
            RelaxerChoice::Implicit(dynamics) => RelaxerChoice::Implicit(dynamics.passing(limit)?),
            #[cfg(feature = "linear")]
            RelaxerChoice::GradientFlow(flow) => RelaxerChoice::GradientFlow(flow.passing(limit)?),
            #[cfg(feature = "linear")]
            RelaxerChoice::Newton(newton) => RelaxerChoice::Newton(newton.passing(limit)?),
            #[cfg(feature = "linear")]
            RelaxerChoice::Staged(staged) => RelaxerChoice::Staged(staged.passing(limit)?),
        })
    }
}
