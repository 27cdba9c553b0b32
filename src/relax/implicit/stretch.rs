//! Stretches of explicit steps, each of about the work of an implicit one.

use crate::contact::PairLaw;
use crate::contact::damping::DampingLaw;
use crate::contact::totals::Totals;
use crate::packing::PackingError;
use crate::relax::Cost;
use crate::relax::implicit::integration::{Allowed, LARGEST_GROWTH, SMALLEST_GROWTH};
use crate::relax::implicit::motion::ImplicitMotion;
use crate::relax::implicit::pace::{Kind, Pace, SHARE};

/// Error allowed in a stabilised step over that allowed in an implicit one. Of twelve motions of 1000 disks at p = 10 (constant
/// damping) seven end where explicit dynamics do at 1/2, ten at 1/4, eleven at 1/10; of twenty at p = 100 and at p = 800 all, at each.
const TOLERANCE_SHARE: f64 = 0.1;

/// Largest growth from the longest stable step: no step follows it but an implicit one, which pays only if it is much longer.
const GROWTH_FROM_LONGEST: f64 = 20.0;

/// Verlet's steps, as many as [`Pace`] says; `time_step` is that of the implicit one to try after it.
pub(super) fn explicit<const D: usize, L: PairLaw, C: DampingLaw>(
    motion: &mut ImplicitMotion<D, L, C>,
    pace: &mut Pace,
    time_step: &mut f64,
    cost: &mut Cost,
) -> Result<Totals<D>, PackingError> {
    let count = pace.next_stretch();
    let (totals, explicit_step) = motion.go_explicitly(count, SHARE, pace.tried())?;
    cost.explicit_count += count;
    pace.set_explicit_step(explicit_step);
    *time_step = pace.tried();
    Ok(totals)
}

/// Stabilised steps while they are what pays, rejected ones repeated shorter; `time_step` is that of the next afterwards.
pub(super) fn stabilised<const D: usize, L: PairLaw, C: DampingLaw>(
    motion: &mut ImplicitMotion<D, L, C>,
    pace: &mut Pace,
    time_step: &mut f64,
    cost: &mut Cost,
    allowed: &Allowed<'_>,
) -> Result<Totals<D>, PackingError> {
    motion.margin = allowed.overlap;
    pace.stiffness = motion.stiffness();
    let before = motion.work.evaluation_count;
    let mut rejected = false;
    while motion.work.evaluation_count - before < pace.worth() {
        let Kind::Stabilised { step, stage_count } = pace.kind(*time_step) else { break };
        let growth = if motion.stabilised_step(step, stage_count)? {
            let error = allowed.share(motion, |motion, disk| motion.stabilised_error(step, disk)) / TOLERANCE_SHARE;
            let stable = pace.is_longest(step);
            let growth = allowed.growth(error, if stable { GROWTH_FROM_LONGEST } else { LARGEST_GROWTH });
            if error <= 1.0 {
                *time_step = step * if rejected { growth.min(1.0) } else { growth };
                rejected = false;
                continue;
            }
            growth
        } else {
            SMALLEST_GROWTH
        };
        cost.rejected_count += 1;
        rejected = true;
        motion.take_back()?;
        *time_step = step * growth;
    }
    cost.explicit_count += motion.work.evaluation_count - before;
    Ok(motion.evaluate())
}
