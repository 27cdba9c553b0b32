//! The protocols, and the relaxation of one of them from the start to rest.

use crate::inflation::Rest;
use crate::inflation::grown::with_centre_of_mass_of;
use crate::law::damping::{ConstantDamping, DampingChoice, ViscoelasticDamping};
use crate::law::pair_law::PairLaw;
use crate::network::ContactNetwork;
use crate::packing::displacement;
use crate::packing::{Packing, PackingError};
use crate::protocol::ending::Ending;
use crate::protocol::settings::ProtocolSettings;
use crate::relax::{
    Criterion, Fire, ForceLimit, GradientFlow, ImplicitDynamics, Newton, NonlinearConjugateGradients, Outcome,
    QuasiNewton, Relaxer, RelaxerChoice, Staged, Stop, Trace,
};
use crate::vector::{larger, norm};

/// A relaxer and its name in a comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct Protocol {
    /// The name.
    pub name: String,
    /// The relaxer.
    pub relaxer: RelaxerChoice,
}

impl Protocol {
    /// A relaxer under its own name.
    pub fn new(relaxer: RelaxerChoice) -> Self {
        Protocol { name: relaxer.name().into(), relaxer }
    }

    /// The given relaxer and all others that differ from it: FIRE, FIRE followed by Newton's method, implicit dynamics
    /// with constant and with viscoelastic damping, gradient flow, conjugate gradients, L-BFGS.
    ///
    /// Both damping laws have the rate of the given relaxer if it has one, otherwise 500, the rate of the model.
    pub fn all(own: &RelaxerChoice) -> Vec<Protocol> {
        let rate = match own {
            RelaxerChoice::Damped(damped) => damped.damping.rate(),
            RelaxerChoice::Implicit(dynamics) => dynamics.damping.rate(),
            _ => DampingChoice::default().rate(),
        };
        let implicit = |law: &str, damping| Protocol {
            name: format!("implicit, {law}"),
            relaxer: RelaxerChoice::Implicit(ImplicitDynamics { damping, ..ImplicitDynamics::default() }),
        };
        let others = [
            Protocol::new(RelaxerChoice::Fire(Fire::default())),
            Protocol::new(RelaxerChoice::Staged(Staged::default())),
            implicit("constant", DampingChoice::Constant(ConstantDamping { rate })),
            implicit("viscoelastic", DampingChoice::Viscoelastic(ViscoelasticDamping { rate })),
            Protocol::new(RelaxerChoice::GradientFlow(GradientFlow::default())),
            Protocol::new(RelaxerChoice::ConjugateGradients(NonlinearConjugateGradients::default())),
            Protocol::new(RelaxerChoice::QuasiNewton(QuasiNewton::default())),
        ];
        let mut protocols = vec![Protocol::new(*own)];
        for other in others {
            // The relaxer of the scene keeps its place, with the more specific name.
            if other.relaxer == *own { protocols[0].name = other.name } else { protocols.push(other) }
        }
        protocols
    }
}

/// An ending before the comparison, with its packing if it is at rest.
pub(super) struct EndState<const D: usize> {
    pub ending: Ending,
    pub rest: Option<(Rest<D>, ContactNetwork<D>)>,
}

/// Relaxes by the protocol, then by Newton's method.
pub(super) fn descend<const D: usize>(
    start: &Packing<D>,
    law: &dyn PairLaw,
    protocol: &Protocol,
    settings: &ProtocolSettings,
    pressure: &impl Fn(&ContactNetwork<D>) -> f64,
    trace: &mut dyn Trace,
) -> Result<EndState<D>, PackingError> {
    let first = protocol.relaxer.relax(start.clone(), law, trace)?;
    let (stop, cost) = (first.stop, first.cost);
    let pressed =
        matches!(stop, Stop::RoundingFloor | Stop::Converged(Criterion::RelativeForce | Criterion::AbsoluteForce));
    let (mut outcome, finish, finish_way) = if pressed {
        let residual = settings.residual.max(4.0 * first.rounding_floor);
        let newton = Newton { limit: ForceLimit::Relative(residual), ..Newton::default() };
        let before = first.state.clone();
        let outcome = newton.relax(first.state, law, &mut ())?;
        let backbone = ContactNetwork::new(&outcome.state, law)?.backbone;
        let longest = (0..before.len())
            .filter(|&disk| backbone[disk] && !before.held()[disk])
            .fold(0.0, |most, disk| larger(norm(displacement(&before, &outcome.state, disk)), most));
        let finish = outcome.stop;
        (outcome, Some(finish), longest)
    } else {
        (first, None, 0.0)
    };
    if !law.has_sites() && !start.held().contains(&true) {
        outcome.state = with_centre_of_mass_of(start, outcome.state);
    }
    let network = ContactNetwork::new(&outcome.state, law)?;
    let unjammed = outcome.stop == Stop::Converged(Criterion::Unjammed);
    let ending = Ending {
        relaxer: protocol.name.clone(),
        stop,
        finish,
        cost,
        finish_way,
        relative_residual: outcome.residual.relative(),
        minimum: None,
        distance: None,
        differing: Vec::new(),
        contact_difference_count: None,
        contact_count: network.contacts.len(),
        energy: network.energy() + network.on_site_energy(),
        pressure: if unjammed { 0.0 } else { pressure(&network) },
        pressure_change: None,
        response: None,
        #[cfg(feature = "fit")]
        fit: None,
    };
    let rest = rest(outcome, &ending, &network).map(|rest| (rest, network));
    Ok(EndState { ending, rest })
}

fn rest<const D: usize>(outcome: Outcome<Packing<D>>, ending: &Ending, network: &ContactNetwork<D>) -> Option<Rest<D>> {
    let Outcome { stop, residual, rounding_floor, .. } = outcome;
    let (Stop::Converged(criterion), Ok(packing)) = (stop, outcome.converged()) else { return None };
    Some(Rest {
        pressure: ending.pressure,
        energy: ending.energy,
        contact_count: ending.contact_count,
        rattler_count: network.rattlers().count(),
        packing,
        backbone: network.backbone.clone(),
        residual,
        rounding_floor,
        criterion,
        cost: ending.cost,
    })
}
