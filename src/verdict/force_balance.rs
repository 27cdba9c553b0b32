//! [`Balance`]: the net forces of a state against its contact forces.

use serde::Serialize;

use crate::law::pair_law::PairLaw;
use crate::network::ContactNetwork;
use crate::packing::Packing;
use crate::relax::UNJAMMED_FORCE;
use crate::vector::{larger, norm};

/// Overlap over the smallest radius up to which the contacts of a packing without a backbone count as zero \[1\]. Other
/// relaxers leave 10⁻⁸ at a force limit of 10⁻⁷; no observable resolves 10⁻⁶ of a diameter.
const LOOSE_OVERLAP: f64 = 1e-6;

/// Net forces of the mobile disks of a state. Only [`Balance::of`] makes one, from the forces themselves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Balance {
    on_backbone: f64,
    off_backbone: f64,
    mean_contact_force: f64,
    rigid: bool,
    /// A force that counts as zero.
    no_force: f64,
}

impl Balance {
    /// The balance of a packing with the contacts of `network` under `law`. Without a backbone, every disk counts as
    /// part of it.
    pub fn of<const D: usize>(packing: &Packing<D>, network: &ContactNetwork<D>, law: &dyn PairLaw) -> Self {
        let rigid = network.backbone_count() > 0;
        let mut largest = [0.0; 2];
        for (disk, force) in network.forces().iter().enumerate().filter(|&(disk, _)| !packing.held()[disk]) {
            let slot = usize::from(rigid && !network.backbone[disk]);
            largest[slot] = larger(norm(*force), largest[slot]);
        }
        let mean_contact_force = if rigid {
            network.mean_contact_force()
        } else {
            let total = network.contacts.iter().fold(0.0, |total, contact| total + contact.force);
            total / network.contacts.len().max(1) as f64
        };
        let radius = packing.radii().iter().copied().fold(f64::INFINITY, f64::min);
        let no_force = if rigid {
            UNJAMMED_FORCE * law.force_scale(radius)
        } else {
            law.force(law.coefficient(radius, radius), LOOSE_OVERLAP * radius)
        };
        Balance { on_backbone: largest[0], off_backbone: largest[1], mean_contact_force, rigid, no_force }
    }

    /// Largest net force on a mobile disk of the backbone over the mean contact force \[1\]. It is 0 if both count as
    /// zero in the sense of [`UNJAMMED_FORCE`]. Without a backbone nothing balances a force. A force then counts as
    /// zero up to an overlap of 10⁻⁶ of a radius.
    pub fn relative_residual(&self) -> f64 {
        self.over_mean(self.on_backbone)
    }

    /// The same ratio for the mobile disks off the backbone \[1\].
    pub fn relative_residual_off_backbone(&self) -> f64 {
        self.over_mean(self.off_backbone)
    }

    /// Whether the first ratio is at most `limit` and the second at most its square root. False for a NaN.
    pub fn is_at_rest(&self, limit: f64) -> bool {
        self.relative_residual() <= limit && self.relative_residual_off_backbone() <= limit.sqrt()
    }

    fn over_mean(&self, force: f64) -> f64 {
        let none = force <= self.no_force && (!self.rigid || self.mean_contact_force <= self.no_force);
        if none || force == 0.0 { 0.0 } else { force / self.mean_contact_force }
    }
}

/// The residuals of a state.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StateBalance {
    /// Name of the state.
    pub state: &'static str,
    /// [`Balance::relative_residual`] \[1\].
    pub relative_residual: f64,
    /// [`Balance::relative_residual_off_backbone`] \[1\].
    pub relative_residual_off_backbone: f64,
    /// Whether both are within the limit.
    pub at_rest: bool,
}

impl StateBalance {
    pub(super) fn new(state: &'static str, balance: Balance, limit: f64) -> Self {
        StateBalance {
            state,
            relative_residual: balance.relative_residual(),
            relative_residual_off_backbone: balance.relative_residual_off_backbone(),
            at_rest: balance.is_at_rest(limit),
        }
    }

    /// A sentence on the residual above its limit.
    pub(super) fn sentence(&self, limit: f64) -> String {
        // Not `>`: NaN counts as above every limit.
        if !self.at_rest && self.relative_residual <= limit {
            let (value, root) = (self.relative_residual_off_backbone, limit.sqrt());
            return format!("{value:.2e} {} on a disk off the backbone, whose limit is {root:.1e}", self.state);
        }
        format!("{:.2e} {}", self.relative_residual, self.state)
    }
}
