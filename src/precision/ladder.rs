//! [`rungs`]: every relaxer at a sequence of settings.

use serde::Serialize;

use crate::law::damping::DampingChoice;
use crate::precision::settings::PrecisionSettings;
use crate::relax::implicit::Finish;
use crate::relax::{
    DampedDynamics, Fire, ForceLimit, GradientFlow, ImplicitDynamics, Newton, NonlinearConjugateGradients, QuasiNewton,
    RelaxerChoice, Staged, StepBack, TimeStep, Uphill,
};

/// A relaxer without its settings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// [`Fire`].
    Fire,
    /// [`Fire`] with the back step of FIRE 2.0.
    FireStepBack,
    /// [`NonlinearConjugateGradients`].
    ConjugateGradients,
    /// [`QuasiNewton`].
    QuasiNewton,
    /// [`DampedDynamics`].
    Damped,
    /// [`ImplicitDynamics`].
    Implicit,
    /// [`GradientFlow`].
    GradientFlow,
    /// [`Newton`].
    Newton,
    /// [`Staged`].
    Staged,
}

impl Method {
    /// All relaxers, in the order of tables and legends.
    pub const ALL: [Method; 9] = [
        Method::Fire,
        Method::FireStepBack,
        Method::ConjugateGradients,
        Method::QuasiNewton,
        Method::Damped,
        Method::Implicit,
        Method::GradientFlow,
        Method::Newton,
        Method::Staged,
    ];

    /// Its name in tables and legends.
    pub fn name(self) -> &'static str {
        match self {
            Method::Fire => "FIRE",
            Method::FireStepBack => "FIRE, step back",
            Method::ConjugateGradients => "conjugate gradients",
            Method::QuasiNewton => "L-BFGS",
            Method::Damped => "damped dynamics",
            Method::Implicit => "implicit dynamics",
            Method::GradientFlow => "gradient flow",
            Method::Newton => "Newton",
            Method::Staged => "FIRE, then Newton",
        }
    }
}

/// The setting that a ladder varies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Varied {
    /// Largest net force over the mean contact force \[1\].
    ForceLimit,
    /// Time step over the stability limit \[1\].
    TimeStep,
    /// Error limit of an implicit step over the median overlap \[1\].
    Tolerance,
}

impl Varied {
    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Varied::ForceLimit => "force limit",
            Varied::TimeStep => "time step",
            Varied::Tolerance => "tolerance",
        }
    }
}

/// One run: a relaxer with one setting of its ladder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rung {
    /// The relaxer.
    pub method: Method,
    /// The setting that its ladder varies.
    pub varied: Varied,
    /// Its value \[1\].
    pub value: f64,
    /// The relaxer with its settings.
    pub relaxer: RelaxerChoice,
}

/// All runs of a sample, ladder by ladder from loose to tight.
///
/// Force limits are varied for each relaxer; the implicit motion then ends by its own steps. Time steps of damped
/// dynamics and tolerances of implicit motions are varied at the tightest force limit, the latter followed by Newton's
/// method. They change the trajectory and so the final minimum.
pub fn rungs(settings: &PrecisionSettings, damping: DampingChoice) -> Vec<Rung> {
    let tightest = settings.force_limits.iter().copied().fold(f64::INFINITY, f64::min);
    let mut rungs = Vec::new();
    for method in Method::ALL {
        // Above its hand-over, FIRE followed by Newton's method is FIRE.
        let distinct = |limit: &&f64| method != Method::Staged || **limit < Staged::default().hand_over;
        for &limit in settings.force_limits.iter().filter(distinct) {
            if let Some(relaxer) = at_limit(method, limit, settings, damping) {
                rungs.push(Rung { method, varied: Varied::ForceLimit, value: limit, relaxer });
            }
        }
        if method == Method::Damped {
            rungs.extend(settings.time_steps.iter().map(|&share| {
                let time_step = TimeStep::OfStability(share);
                let damped = DampedDynamics { time_step, ..damped(tightest, settings, damping) };
                let relaxer = RelaxerChoice::Damped(damped);
                Rung { method, varied: Varied::TimeStep, value: share, relaxer }
            }));
        }
        rungs.extend(settings.tolerances.iter().filter_map(|&tolerance| {
            let (limit, step_limit) = (ForceLimit::Relative(tightest), settings.implicit_step_limit);
            let relaxer = match method {
                Method::Implicit => RelaxerChoice::Implicit(ImplicitDynamics {
                    limit,
                    tolerance,
                    damping,
                    step_limit,
                    ..Default::default()
                }),
                Method::GradientFlow => {
                    RelaxerChoice::GradientFlow(GradientFlow { limit, tolerance, step_limit, ..Default::default() })
                }
                _ => return None,
            };
            Some(Rung { method, varied: Varied::Tolerance, value: tolerance, relaxer })
        }));
    }
    rungs
}

fn damped(limit: f64, settings: &PrecisionSettings, damping: DampingChoice) -> DampedDynamics {
    let step_limit = settings.explicit_step_limit;
    DampedDynamics { limit: ForceLimit::Relative(limit), damping, step_limit, ..DampedDynamics::default() }
}

fn at_limit(method: Method, limit: f64, settings: &PrecisionSettings, damping: DampingChoice) -> Option<RelaxerChoice> {
    let force_limit = ForceLimit::Relative(limit);
    let step_limit = settings.explicit_step_limit;
    let fire = Fire { limit: force_limit, step_limit, ..Fire::default() };
    Some(match method {
        Method::Fire => RelaxerChoice::Fire(fire),
        Method::FireStepBack => RelaxerChoice::Fire(Fire { uphill: Uphill::StepBack(StepBack::default()), ..fire }),
        Method::ConjugateGradients => RelaxerChoice::ConjugateGradients(NonlinearConjugateGradients {
            limit: force_limit,
            step_limit,
            ..Default::default()
        }),
        Method::QuasiNewton => {
            RelaxerChoice::QuasiNewton(QuasiNewton { limit: force_limit, step_limit, ..Default::default() })
        }
        Method::Damped => RelaxerChoice::Damped(damped(limit, settings, damping)),
        Method::Implicit => RelaxerChoice::Implicit(ImplicitDynamics {
            limit: force_limit,
            damping,
            finish: Finish::Motion,
            step_limit: settings.implicit_step_limit,
            ..Default::default()
        }),
        // Its ladder varies the tolerance.
        Method::GradientFlow => return None,
        Method::Newton => RelaxerChoice::Newton(Newton { limit: force_limit, ..Newton::default() }),
        Method::Staged => RelaxerChoice::Staged(Staged { limit: force_limit, step_limit, ..Staged::default() }),
    })
}
