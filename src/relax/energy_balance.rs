//! [`EnergyBalance`]: the account of energy along a motion, which judges its steps.
//!
//! ```text
//! E + K + W = E_0        E elastic, K kinetic energy, W what damping took, E_0 the elastic energy of the start
//! |Δ(E + K + W)| ≤ ε (K + |ΔW|) + η E        for every step; ε = 0.05, η = 10⁻⁷
//! ```
//!
//! The change is compared with the energy in motion, not with E_0. The blow of an inflation has 10⁴ times the energy of a packing near
//! jamming; an error that is small beside it can still tear the packing apart. The floor η E lies below the energy from which on Newton's
//! method may finish: a long step may damp away what is left there.

use serde::{Deserialize, Serialize};

use crate::contact::totals::Totals;
use crate::vector::larger;

/// ε. Explicit steps of 0.9 of their bound leave 0.02 to 0.04 of the energy in motion unaccounted for while the front of a blow spreads, and less
/// afterwards.
const TOLERANCE: f64 = 0.05;

/// η.
const FLOOR: f64 = 1e-7;

/// Energies of a motion at one moment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Energies {
    /// E \[energy\].
    pub(super) elastic: f64,
    /// What the rounding of E is relative to \[energy\].
    pub(super) scale: f64,
    /// K \[energy\].
    pub(super) kinetic: f64,
    /// W \[energy\].
    pub(super) damped: f64,
}

impl Energies {
    pub(super) fn new<const D: usize>(totals: &Totals<D>, kinetic: f64, damped: f64) -> Self {
        Energies { elastic: totals.energy, scale: totals.energy_scale(), kinetic, damped }
    }

    fn mechanical(&self) -> f64 {
        self.elastic + self.kinetic
    }
}

/// The account since the start.
#[derive(Debug, Clone, Copy)]
pub(super) struct EnergyBalance {
    start: Energies,
    now: Energies,
    imbalance: f64,
}

impl EnergyBalance {
    pub(super) fn new(start: Energies) -> Self {
        EnergyBalance { start, now: start, imbalance: 0.0 }
    }

    /// Takes steps that led to these energies into the account; false, and nothing changes, if they break the balance.
    pub(super) fn accept(&mut self, next: Energies) -> bool {
        let moving = larger(self.now.kinetic, next.kinetic) + (next.damped - self.now.damped).abs();
        self.accept_if(next, |defect, floor| defect.abs() <= TOLERANCE * moving + floor)
    }

    /// As [`EnergyBalance::accept`], where the work of damping is known roughly: only a gain of E + K is refused.
    pub(super) fn accept_unless_gained(&mut self, next: Energies) -> bool {
        let (gain, kinetic) = (next.mechanical() - self.now.mechanical(), larger(self.now.kinetic, next.kinetic));
        self.accept_if(next, |_, floor| gain <= TOLERANCE * kinetic + floor)
    }

    /// `holds` is given Δ(E + K + W) and the floor; it is written so that NaN is refused.
    fn accept_if(&mut self, next: Energies, holds: impl Fn(f64, f64) -> bool) -> bool {
        let defect = next.mechanical() - self.now.mechanical() + (next.damped - self.now.damped);
        let accepted = holds(defect, FLOOR * larger(self.now.scale, next.scale));
        if accepted {
            self.now = next;
            self.imbalance += defect.abs();
        }
        accepted
    }

    /// The account for a motion at whose end the elastic energy is `after` \[energy\].
    pub(super) fn account(&self, after: f64) -> EnergyAccount {
        EnergyAccount {
            before: self.start.elastic,
            after,
            damped: self.now.damped,
            left: self.now.mechanical() - after,
            imbalance: self.imbalance,
        }
    }
}

/// Energies of a relaxation, from its start to its end.
///
/// ```text
/// before = after + damped + left ± imbalance
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct EnergyAccount {
    /// Elastic energy at the start \[energy\].
    pub before: f64,
    /// Elastic energy at the end \[energy\].
    pub after: f64,
    /// Work of damping and friction along a motion; not written where nothing moved \[energy\].
    #[serde(default, skip_serializing_if = "is_none")]
    pub damped: f64,
    /// Elastic and kinetic energy above the end when the motion was left to Newton's method, or where it stopped \[energy\].
    #[serde(default, skip_serializing_if = "is_none")]
    pub left: f64,
    /// What the steps of a motion left unaccounted for: the sum of |Δ(E + K + W)| \[energy\].
    #[serde(default, skip_serializing_if = "is_none")]
    pub imbalance: f64,
}

fn is_none(energy: &f64) -> bool {
    *energy == 0.0
}

impl EnergyAccount {
    /// Of this relaxation and one that begins where it ended.
    pub(super) fn then(self, next: EnergyAccount) -> EnergyAccount {
        EnergyAccount {
            before: self.before,
            after: next.after,
            damped: self.damped + next.damped,
            left: self.left + next.left,
            imbalance: self.imbalance + next.imbalance,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn energies(elastic: f64, kinetic: f64, damped: f64) -> Energies {
        Energies { elastic, scale: elastic, kinetic, damped }
    }

    #[test]
    fn a_balance_broken_by_more_than_the_tolerance_is_refused_and_changes_nothing() {
        let mut balance = EnergyBalance::new(energies(10.0, 0.0, 0.0));
        assert!(balance.accept(energies(5.0, 3.9, 1.0)));
        // Energy in motion is 3.9 + 0.1: a defect of 0.2 is the most.
        assert!(!balance.accept(energies(5.0, 3.9, 1.11 + 0.21)));
        assert!(!balance.accept(energies(5.0, f64::NAN, 1.0)));
        assert!(balance.accept(energies(5.0, 3.7, 1.1)));
        let account = balance.account(4.0);
        assert_eq!((account.before, account.after, account.damped), (10.0, 4.0, 1.1));
        assert!((account.left - 4.7).abs() < 1e-12 && (account.imbalance - 0.2).abs() < 1e-12, "{account:?}");
    }

    #[test]
    fn only_a_gain_is_refused_where_the_work_of_damping_is_rough() {
        let mut balance = EnergyBalance::new(energies(10.0, 1.0, 0.0));
        assert!(balance.accept_unless_gained(energies(4.0, 1.0, 0.0)));
        assert!(!balance.accept_unless_gained(energies(4.1, 1.0, 0.0)));
        assert!(!balance.accept_unless_gained(energies(f64::NAN, 1.0, 0.0)));
    }
}
