//! [`EnergyBalance`]: the energy balance along a motion, which accepts or rejects its steps.
//!
//! ```text
//! E + K + W = E_0        E elastic, K kinetic energy, W work of damping, E_0 the elastic energy at the start
//! G ← max(0, G + Δ(E + K + W) − ε ΔW)        L ← max(0, L − Δ(E + K + W) − ε ΔW)
//! M ← max(max K, M − ΔW/2)        G, L ≤ ε M + η E        after every step; ε = 0.05, η = 10⁻⁷
//! ```
//!
//! G and L are the energies gained or lost by errors, beyond a fraction ε of the work of damping. They are cumulative
//! sums, so they detect a small gain in every step as well as a large gain in one step. Both are compared with the
//! energy in motion M. This energy is exchanged between K and E, and only damping removes it. Half of ΔW is subtracted,
//! so a motion with errors below half of the tolerance stays within the limit. E_0 would be too coarse a scale: the
//! initial energy of an inflation is 10⁴ times that of a packing near jamming. A small relative error could then
//! destroy the packing. The floor η E lies below the energy at which Newton's method may finish, because a long step
//! may remove the remaining energy.
//!
//! # Source
//! Page (1954), Biometrika 41, 100: cumulative sums that detect a drift below the size of fluctuations.

use crate::forces::totals::Totals;
use crate::relax::energy_account::EnergyAccount;
use crate::vector::larger;

/// ε. It exceeds the imbalance of explicit steps of 0.9 of their bound, relative to the energy in motion: 0.02 to 0.04
/// at the start of an inflation, and less later.
const TOLERANCE: f64 = 0.05;

/// η.
const FLOOR: f64 = 1e-7;

/// Relative rounding of summed energies \[1\].
const ROUNDING: f64 = 1e-13;

/// Energies of a motion at one moment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Energies {
    /// E \[energy\].
    pub(crate) elastic: f64,
    /// The scale of the rounding of E \[energy\].
    pub(crate) scale: f64,
    /// K \[energy\].
    pub(crate) kinetic: f64,
    /// The largest K since the last check, where it is known \[energy\].
    pub(crate) peak: f64,
    /// W \[energy\].
    pub(crate) damped: f64,
}

impl Energies {
    pub(crate) fn new<const D: usize>(totals: &Totals<D>, kinetic: f64, damped: f64) -> Self {
        Energies { elastic: totals.energy, scale: totals.energy_scale(), kinetic, peak: kinetic, damped }
    }

    /// The same, with the largest kinetic energy since the last check \[energy\].
    pub(crate) fn with_peak(self, peak: f64) -> Self {
        Energies { peak: larger(peak, self.peak), ..self }
    }

    fn mechanical(&self) -> f64 {
        self.elastic + self.kinetic
    }
}

/// The energy balance since the start.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EnergyBalance {
    start: Energies,
    now: Energies,
    /// G, L and M \[energy\].
    gain: f64,
    loss: f64,
    moving: f64,
    imbalance: f64,
}

impl EnergyBalance {
    pub(crate) fn new(start: Energies) -> Self {
        EnergyBalance { start, now: start, gain: 0.0, loss: 0.0, moving: start.kinetic, imbalance: 0.0 }
    }

    /// Adds steps that led to these energies. If they violate the balance, returns false and changes nothing.
    pub(crate) fn accept(&mut self, next: Energies) -> bool {
        let damped = next.damped - self.now.damped;
        let defect = next.mechanical() - self.now.mechanical() + damped;
        let moving = larger(next.peak, self.moving - 0.5 * damped.abs());
        let limit = TOLERANCE * moving
            + FLOOR * larger(self.now.scale, next.scale)
            + ROUNDING * (self.start.scale + next.damped.abs());
        let after = |sum: f64, defect: f64| (sum + defect - TOLERANCE * damped.abs()).max(0.0);
        let (gain, loss) = (after(self.gain, defect), after(self.loss, -defect));
        // NaN is rejected.
        let accepted = defect.is_finite() && larger(gain, loss) <= limit;
        if accepted {
            (self.now, self.gain, self.loss, self.moving) = (next, gain, loss, moving);
            self.imbalance += defect.abs();
        }
        accepted
    }

    /// Like [`EnergyBalance::accept`], for a motion without masses. Its energy must decrease. The work of friction in a
    /// long step is known only approximately.
    #[cfg(feature = "linear")]
    pub(crate) fn accept_descent(&mut self, next: Energies) -> bool {
        // NaN is rejected.
        let accepted = next.elastic - self.now.elastic <= 10.0 * ROUNDING * larger(self.now.scale, next.scale);
        if accepted {
            self.imbalance += (next.mechanical() - self.now.mechanical() + next.damped - self.now.damped).abs();
            self.now = next;
        }
        accepted
    }

    /// The account of a motion that ends with the elastic energy `after` \[energy\].
    pub(crate) fn account(&self, after: f64) -> EnergyAccount {
        EnergyAccount {
            before: self.start.elastic,
            after,
            damped: self.now.damped,
            left: self.now.mechanical() - after,
            imbalance: self.imbalance,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn energies(elastic: f64, kinetic: f64, damped: f64) -> Energies {
        Energies { elastic, scale: elastic, kinetic, peak: kinetic, damped }
    }

    #[test]
    fn a_balance_broken_by_more_than_the_tolerance_is_refused_and_changes_nothing() {
        let mut balance = EnergyBalance::new(energies(10.0, 0.0, 0.0));
        assert!(balance.accept(energies(5.0, 4.0, 1.0)));
        // The largest gain allowed is 5 % of the kinetic energy and of the work of damping: 0.2 + 0.01.
        assert!(!balance.accept(energies(5.0, 4.0, 1.0 + 0.22)));
        assert!(!balance.accept(energies(5.0, f64::NAN, 1.0)));
        assert!(!balance.accept(energies(4.7, 4.0, 1.0)));
        assert!(balance.accept(energies(5.0, 3.8, 1.1)));
        let account = balance.account(4.0);
        assert_eq!((account.before, account.after, account.damped), (10.0, 4.0, 1.1));
        assert!((account.left - 4.8).abs() < 1e-12 && (account.imbalance - 0.1).abs() < 1e-12, "{account:?}");
    }

    #[test]
    fn a_small_gain_in_every_step_is_found() {
        // A gain of 2 % of the kinetic energy per step, of which damping takes a quarter. The excess of 0.0195 exceeds
        // the limit in the third step.
        let mut balance = EnergyBalance::new(energies(1.0, 1.0, 0.0));
        let accepted = (1..=10).take_while(|&step| {
            let step = f64::from(step);
            balance.accept(energies(1.0, 1.0 + 0.015 * step, 0.005 * step))
        });
        assert_eq!(accepted.count(), 2);
        // Fluctuations of the same size are accepted.
        let mut balance = EnergyBalance::new(energies(1.0, 1.0, 0.0));
        for step in 1..=1000 {
            let sign = if step % 2 == 0 { 1.0 } else { -1.0 };
            let damped = 1e-4 * f64::from(step);
            assert!(balance.accept(energies(1.0, 1.0 - damped + 0.015 * sign, damped)), "{step}");
        }
    }
}
