//! Phases of stabilised steps; the work of a phase is about that of an implicit step.

use crate::forces::totals::Totals;
use crate::packing::PackingError;
use crate::relax::dynamics::energy_balance::{Energies, EnergyBalance};
use crate::relax::dynamics::implicit::allowed_error::AllowedError;
use crate::relax::dynamics::implicit::method_selection::{Method, MethodSelection};
use crate::relax::dynamics::implicit::motion::ImplicitMotion;
use crate::relax::dynamics::implicit::multirate::patch::PatchDisks;
use crate::relax::dynamics::implicit::step_control::{LARGEST_RATIO, SMALLEST_RATIO, step_ratio};
use crate::relax::outcome::Cost;

/// Error allowed in a stabilised step over that in an implicit step. Smaller values make more motions end in the
/// minimum of explicit dynamics, see the book.
const TOLERANCE_SHARE: f64 = 0.1;

/// Fraction of the mobile disks whose errors do not limit the step length. If their errors are too large, the step is
/// repeated around them. The speed depends weakly on this value.
const EXCLUDED_SHARE: f64 = 0.01;

/// Ratio of step lengths if the multirate correction fails.
const UNCORRECTED_RATIO: f64 = 0.5;

/// Ratio of step lengths after a phase that violated the energy balance.
const UNBALANCED_RATIO: f64 = 0.25;

/// Largest ratio after the longest stable step. Only an implicit step can follow, and it is cheaper only if it is much
/// longer.
const RATIO_FROM_LONGEST: f64 = 20.0;

/// Takes stabilised steps while they are cheapest, and repeats rejected ones with shorter lengths. `time_step` becomes
/// the next one.
pub(crate) fn rkc_phase<const D: usize>(
    motion: &mut ImplicitMotion<D>,
    selection: &mut MethodSelection,
    time_step: &mut f64,
    (cost, balance): (&mut Cost, &mut EnergyBalance),
    allowed: &AllowedError<'_>,
) -> Result<Option<Totals<D>>, PackingError> {
    let snapshot = motion.snapshot();
    let first_step = *time_step;
    motion.margin = allowed.overlap;
    selection.stiffness = motion.stiffness();
    let before = motion.work.evaluation_count;
    let mut rejected = false;
    let mut errors = Errors::default();
    while motion.work.evaluation_count - before < selection.implicit_cost() {
        let Method::Rkc { step, stage_count, stiffness } = selection.method(*time_step) else { break };
        let largest_ratio = if selection.is_longest(step) { RATIO_FROM_LONGEST } else { LARGEST_RATIO };
        let ratio = if motion.stabilised_step(step, stage_count)? {
            let share = |disk: usize, error: f64| allowed.weight(disk) / TOLERANCE_SHARE * error;
            let most =
                errors.set(motion.assembly.mobile_count(), |disk| share(disk, motion.stabilised_error(step, disk)));
            let ratio = step_ratio(most, largest_ratio);
            let fast = PatchDisks { time_step: step, stiffness, disks: &errors.too_large, share };
            if most <= 1.0 && (errors.too_large.is_empty() || motion.correct_fast_disks(&fast)?) {
                *time_step = step * if rejected { ratio.min(1.0) } else { ratio };
                rejected = false;
                continue;
            }
            if most <= 1.0 { UNCORRECTED_RATIO } else { ratio }
        } else {
            SMALLEST_RATIO
        };
        cost.rejected_count += 1;
        rejected = true;
        motion.take_back()?;
        *time_step = step * ratio;
    }
    cost.explicit_count += motion.work.evaluation_count - before;
    let totals = motion.evaluate();
    if balance.accept(Energies::new(&totals, motion.kinetic_energy(), motion.dissipated)) {
        return Ok(Some(totals));
    }
    cost.rejected_count += 1;
    motion.return_to(snapshot)?;
    *time_step = UNBALANCED_RATIO * first_step;
    Ok(None)
}

/// Errors of a step, over the allowed ones.
#[derive(Default)]
struct Errors {
    of_disks: Vec<f64>,
    sorted: Vec<f64>,
    /// Disks whose errors are above 1.
    too_large: Vec<u32>,
}

impl Errors {
    /// The largest error, except for a fraction [`EXCLUDED_SHARE`] of the disks. NaN counts as the largest.
    fn set(&mut self, disk_count: usize, error: impl Fn(usize) -> f64) -> f64 {
        self.of_disks.clear();
        self.of_disks.extend((0..disk_count).map(error));
        self.too_large.clear();
        self.too_large.extend((0..disk_count as u32).filter(|&disk| self.of_disks[disk as usize] > 1.0));
        self.sorted.clone_from(&self.of_disks);
        let excluded_count = (EXCLUDED_SHARE * disk_count as f64) as usize;
        let (_, &mut most, _) = self.sorted.select_nth_unstable_by(excluded_count, |a, b| b.total_cmp(a));
        if self.of_disks.iter().any(|error| error.is_nan()) { f64::NAN } else { most }
    }
}
