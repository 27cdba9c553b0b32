//! [`QuasistaticShear`]: simple shear of a periodic packing in small steps, each relaxed to rest.
//!
//! ```text
//! r_x → r_x + Δγ r_y, box and centres, then relaxation          σ_xy = −(1/V) Σ f_ij r_x r_y / r_ij
//!
//! at fixed contacts and without an instability    ΔE = V σ_xy Δγ, so W = V (σ + σ') Δγ/2 − ΔE = O(Δγ³)
//! ```
//!
//! W is the energy dissipated in a step. In a plastic event the packing falls into another minimum: the stress drops
//! although the strain grows, and W is positive.
//!
//! # Source
//! Maloney and Lemaître (2006), Phys. Rev. E 74, 016118 (athermal quasistatic shear; events as drops of the stress).

use std::collections::BTreeSet;

use serde::Serialize;

use crate::law::pair_law::PairLaw;
use crate::network::ContactNetwork;
use crate::packing::{Packing, PackingError};
use crate::relax::{Cost, Outcome, Relaxer, Stop, Trace};
use crate::vector::{Vector, dot};

/// How a packing is sheared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShearSettings {
    /// Shear γ at the end, of either sign \[1\].
    pub strain: f64,
    /// Number of steps to it.
    pub step_count: usize,
}

/// Largest |γ| \[1\]. Coordinates grow to γ L_y; at 1000 sides they have lost three of their 16 digits, and every reader
/// still accepts them.
const LARGEST_STRAIN: f64 = 1e3;

/// Why a packing cannot be sheared.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StrainError {
    /// The disks themselves are invalid.
    #[error(transparent)]
    Packing(#[from] PackingError),
    /// Only a box has a strain.
    #[error("the packing lies in the open plane: only a periodic box can be sheared")]
    NotPeriodic,
    /// γ must be a number other than 0, and not so large that coordinates lose their digits.
    #[error("shear is {strain}: must be a number other than 0, at most {LARGEST_STRAIN} in size")]
    StrainNotPossible {
        /// The shear given.
        strain: f64,
    },
    /// There must be a step.
    #[error("steps is 0: must be at least 1")]
    NoStep,
    /// A relaxation did not end at rest.
    #[error("step {step}: the relaxation stopped with {stop:?}, residual {residual:e}")]
    NotAtRest {
        /// Number of the step; 0 is the relaxation before the first.
        step: usize,
        /// Why it stopped.
        stop: Stop,
        /// Relative residual reached.
        residual: f64,
    },
}

/// The packing after a step, and the changes since the step before.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ShearState {
    /// Number of the step; 0 is the packing at rest before the first.
    pub step: usize,
    /// Shear since the start, γ \[1\].
    pub strain: f64,
    /// Shear stress σ_xy, positive against a positive shear \[force / length^(D−1)\].
    pub shear_stress: f64,
    /// Pressure \[force / length^(D−1)\].
    pub pressure: f64,
    /// Energy of the packing \[energy\].
    pub energy: f64,
    /// Number of contacts.
    pub contact_count: usize,
    /// Coordination of the backbone, Z \[1\].
    pub coordination: f64,
    /// Contacts made in the step.
    pub made_count: usize,
    /// Contacts broken in the step.
    pub broken_count: usize,
    /// Root of the mean square displacement of the backbone in the step, beyond the affine part \[length\].
    pub non_affine: f64,
    /// Dissipated energy W of the step \[energy\].
    pub dissipated: f64,
    /// Whether the stress dropped although the strain grew: a plastic event.
    pub is_event: bool,
    /// Relative residual \[1\].
    pub residual: f64,
}

/// A quasistatic shear in progress.
///
/// # Example
/// ```
/// use jamscope::lattice::Lattice;
/// use jamscope::law::Hookean;
/// use jamscope::relax::Fire;
/// use jamscope::strain::{QuasistaticShear, ShearSettings};
///
/// let (lattice, law) = (Lattice::triangular(0.5, 0.05)?, Hookean { stiffness: 1.0 });
/// let settings = ShearSettings { strain: 1e-4, step_count: 2 };
/// let mut shear = QuasistaticShear::new(lattice.periodic([8, 5])?, settings, &law)?;
/// let (relaxer, mut states) = (Fire::default(), Vec::new());
/// while let Some(state) = shear.advance(&relaxer, &mut ())? {
///     states.push(state);
/// }
/// // At a pressure that is the same in all directions dσ/dγ is the shear modulus.
/// let slope = states[2].shear_stress / states[2].strain;
/// let exact = lattice.moduli(&law).expect("isotropic").shear;
/// assert!((slope / exact - 1.0).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct QuasistaticShear<'a, const D: usize> {
    packing: Packing<D>,
    volume: f64,
    settings: ShearSettings,
    law: &'a dyn PairLaw,
    /// The next step.
    next: usize,
    /// Contacts, shear stress and energy of the step before, if there was one.
    before: Option<Before>,
    cost: Cost,
}

/// What a step is compared with.
struct Before {
    contacts: BTreeSet<(u32, u32)>,
    shear_stress: f64,
    energy: f64,
}

impl Before {
    fn of<const D: usize>(network: &ContactNetwork<D>, volume: f64) -> Self {
        let contacts = network.contacts.iter().map(|contact| (contact.first, contact.second)).collect();
        // The stress of the network is positive in compression.
        Before { contacts, shear_stress: 0.0 - network.stress(volume)[0][1], energy: network.energy() }
    }
}

impl<'a, const D: usize> QuasistaticShear<'a, D> {
    /// A packing before its shear; step 0 relaxes it.
    ///
    /// # Errors
    /// [`StrainError`] with the value.
    pub fn new(packing: Packing<D>, settings: ShearSettings, law: &'a dyn PairLaw) -> Result<Self, StrainError> {
        let volume = packing.domain().volume().ok_or(StrainError::NotPeriodic)?;
        let ShearSettings { strain, step_count } = settings;
        // False for NaN.
        let is_possible = strain != 0.0 && strain.abs() <= LARGEST_STRAIN;
        if !is_possible {
            return Err(StrainError::StrainNotPossible { strain });
        }
        if step_count == 0 {
            return Err(StrainError::NoStep);
        }
        Ok(QuasistaticShear { packing, volume, settings, law, next: 0, before: None, cost: Cost::default() })
    }

    /// A shear that continues from the packing at rest after `step`. It gives the same bits as one without interruption.
    ///
    /// # Errors
    /// As [`QuasistaticShear::new`].
    pub fn resumed(
        packing: Packing<D>,
        step: usize,
        settings: ShearSettings,
        law: &'a dyn PairLaw,
    ) -> Result<Self, StrainError> {
        let mut shear = QuasistaticShear::new(packing, settings, law)?;
        shear.before = Some(Before::of(&ContactNetwork::new(&shear.packing, law)?, shear.volume));
        shear.next = step + 1;
        Ok(shear)
    }

    /// The packing after the last step.
    pub fn packing(&self) -> &Packing<D> {
        &self.packing
    }

    /// Cost of all steps so far.
    pub fn cost(&self) -> Cost {
        self.cost
    }

    /// Takes the next step: strains box and centres, and relaxes. None after the last step.
    ///
    /// # Errors
    /// A relaxation that does not end at rest. The packing is then that after the step before.
    pub fn advance(
        &mut self,
        relaxer: &impl Relaxer,
        trace: &mut dyn Trace,
    ) -> Result<Option<ShearState>, StrainError> {
        let ShearSettings { strain, step_count } = self.settings;
        let step = self.next;
        if step > step_count {
            return Ok(None);
        }
        let increment = if step == 0 { 0.0 } else { strain / step_count as f64 };
        let mut gradient = [[0.0; D]; D];
        gradient[0][1] = increment;
        let (strained, _) = self.packing.deformed(&gradient);
        let outcome = relaxer.relax(strained.clone(), self.law, trace)?;
        self.cost = self.cost.plus(outcome.cost);
        let Outcome { stop, residual, .. } = outcome;
        let residual = residual.relative();
        let Ok(rest) = outcome.converged() else { return Err(StrainError::NotAtRest { step, stop, residual }) };
        self.packing = rest.into_inner();
        let network = ContactNetwork::new(&self.packing, self.law)?;
        let now = Before::of(&network, self.volume);
        let change = self.before.as_ref().map(|before| Change::between(before, &now, increment * self.volume));
        let change = change.unwrap_or_default();
        let state = ShearState {
            step,
            strain: strain * (step as f64 / step_count as f64),
            shear_stress: now.shear_stress,
            pressure: network.pressure(self.volume),
            energy: now.energy,
            contact_count: network.contacts.len(),
            coordination: network.coordination(),
            made_count: change.made_count,
            broken_count: change.broken_count,
            non_affine: if step == 0 { 0.0 } else { mean_displacement(&strained, &self.packing, &network.backbone) },
            dissipated: change.dissipated,
            is_event: change.is_event,
            residual,
        };
        self.before = Some(now);
        self.next = step + 1;
        Ok(Some(state))
    }
}

/// What changed in a step.
#[derive(Default)]
struct Change {
    made_count: usize,
    broken_count: usize,
    dissipated: f64,
    is_event: bool,
}

impl Change {
    /// `volume_strain` is V Δγ.
    fn between(before: &Before, now: &Before, volume_strain: f64) -> Self {
        Change {
            made_count: now.contacts.difference(&before.contacts).count(),
            broken_count: before.contacts.difference(&now.contacts).count(),
            dissipated: 0.5 * (before.shear_stress + now.shear_stress) * volume_strain - (now.energy - before.energy),
            is_event: (now.shear_stress - before.shear_stress) * volume_strain < 0.0,
        }
    }
}

/// Root of the mean square displacement of some disks; 0 if there are none.
fn mean_displacement<const D: usize>(from: &Packing<D>, to: &Packing<D>, members: &[bool]) -> f64 {
    let moved = |disk: usize| -> Vector<D> {
        let ((high, low), (high_from, low_from)) = (to.centre(disk), from.centre(disk));
        std::array::from_fn(|d| (high[d] - high_from[d]) + (low[d] - low_from[d]))
    };
    let (mut total, mut count) = (0.0, 0usize);
    for disk in (0..from.len()).filter(|&disk| members[disk]) {
        total += dot(moved(disk), moved(disk));
        count += 1;
    }
    if count == 0 { 0.0 } else { (total / count as f64).sqrt() }
}
