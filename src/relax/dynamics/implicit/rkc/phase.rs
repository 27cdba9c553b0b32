//! Stretches of explicit steps, each of about the work of an implicit one.

use crate::forces::totals::Totals;
use crate::law::damping::DampingLaw;
use crate::law::pair_law::PairLaw;
use crate::packing::PackingError;
use crate::relax::dynamics::energy_balance::{Energies, EnergyBalance};
use crate::relax::dynamics::implicit::allowed_error::Allowed;
use crate::relax::dynamics::implicit::method_selection::{Kind, Pace};
use crate::relax::dynamics::implicit::motion::ImplicitMotion;
use crate::relax::dynamics::implicit::multirate::patch::Refine;
use crate::relax::dynamics::implicit::step_control::{LARGEST_GROWTH, SMALLEST_GROWTH, growth};
use crate::relax::outcome::Cost;

/// Error allowed in a stabilised step over that allowed in an implicit one. Of twelve motions of 1000 disks at p = 10 (constant
/// damping) seven end where explicit dynamics do at 1/2, ten at 1/4, eleven at 1/10 where steps have
/// one length for all disks, all twelve at 1/10 with shorter ones around events; of twenty at p = 100 and at p = 800 all, at each.
const TOLERANCE_SHARE: f64 = 0.1;

/// Disks whose errors do not count for the length of a step, over all that can move: where their errors are too large, the step is
/// made again around them. From 1/300 to 1/30 a motion of 16 508 disks at p = 10 takes the same time, at 1/10 a tenth more.
const SET_APART: f64 = 0.01;

/// Growth where that does not work.
const GROWTH_UNREFINED: f64 = 0.5;

/// Growth after a stretch that broke the balance of energies.
const UNBALANCED_GROWTH: f64 = 0.25;

/// Largest growth from the longest stable step: no step follows it but an implicit one, which pays only if it is much longer.
const GROWTH_FROM_LONGEST: f64 = 20.0;

/// Stabilised steps while they are what pays, rejected ones repeated shorter; `time_step` is that of the next afterwards.
pub(crate) fn stabilised<const D: usize, L: PairLaw, C: DampingLaw>(
    motion: &mut ImplicitMotion<D, L, C>,
    pace: &mut Pace,
    time_step: &mut f64,
    (cost, balance): (&mut Cost, &mut EnergyBalance),
    allowed: &Allowed<'_>,
) -> Result<Option<Totals<D>>, PackingError> {
    let snapshot = motion.snapshot();
    let first_step = *time_step;
    motion.margin = allowed.overlap;
    pace.stiffness = motion.stiffness();
    let before = motion.work.evaluation_count;
    let mut rejected = false;
    let mut errors = Errors::default();
    while motion.work.evaluation_count - before < pace.worth() {
        let Kind::Stabilised { step, stage_count, stiffness } = pace.kind(*time_step) else { break };
        let largest_growth = if pace.is_longest(step) { GROWTH_FROM_LONGEST } else { LARGEST_GROWTH };
        let growth = if motion.stabilised_step(step, stage_count)? {
            let share = |disk: usize, error: f64| allowed.weight(disk) / TOLERANCE_SHARE * error;
            let most =
                errors.set(motion.assembly.mobile_count(), |disk| share(disk, motion.stabilised_error(step, disk)));
            let growth = growth(most, largest_growth);
            let refine = Refine { time_step: step, stiffness, disks: &errors.too_large, share };
            if most <= 1.0 && (errors.too_large.is_empty() || motion.refine(&refine)?) {
                *time_step = step * if rejected { growth.min(1.0) } else { growth };
                rejected = false;
                continue;
            }
            if most <= 1.0 { GROWTH_UNREFINED } else { growth }
        } else {
            SMALLEST_GROWTH
        };
        cost.rejected_count += 1;
        rejected = true;
        motion.take_back()?;
        *time_step = step * growth;
    }
    cost.explicit_count += motion.work.evaluation_count - before;
    let totals = motion.evaluate();
    if balance.accept(Energies::new(&totals, motion.kinetic_energy(), motion.dissipated)) {
        return Ok(Some(totals));
    }
    cost.rejected_count += 1;
    motion.return_to(snapshot)?;
    *time_step = UNBALANCED_GROWTH * first_step;
    Ok(None)
}

/// Errors of a step, over those allowed.
#[derive(Default)]
struct Errors {
    of_disks: Vec<f64>,
    sorted: Vec<f64>,
    /// Disks whose errors are above 1.
    too_large: Vec<u32>,
}

impl Errors {
    /// The largest error but for those of a share [`SET_APART`] of the disks; NaN comes first.
    fn set(&mut self, disk_count: usize, error: impl Fn(usize) -> f64) -> f64 {
        self.of_disks.clear();
        self.of_disks.extend((0..disk_count).map(error));
        self.too_large.clear();
        self.too_large.extend((0..disk_count as u32).filter(|&disk| self.of_disks[disk as usize] > 1.0));
        self.sorted.clone_from(&self.of_disks);
        let apart = (SET_APART * disk_count as f64) as usize;
        let (_, &mut most, _) = self.sorted.select_nth_unstable_by(apart, |a, b| b.total_cmp(a));
        if self.of_disks.iter().any(|error| error.is_nan()) { f64::NAN } else { most }
    }
}
