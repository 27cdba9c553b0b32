//! Choices on one explicit trajectory from the inflated start: its time step, and the skin of its neighbour list.

use std::time::Instant;

use crate::forces::assembly::{Assembly, SKIN};
use crate::inflation::Grown;
use crate::law::damping::ContactDamping;
use crate::law::pair_law::PairLaw;
use crate::packing::displacement;
use crate::packing::{Packing, PackingError};
use crate::precision::numerical_choices::{ChoiceRow, ChoiceTable};
use crate::relax::Motion;
use crate::vector::{larger, norm};

/// Number of steps of the trajectory at the longest step; the others have 2, 4, 8 times as many.
const FEWEST_STEPS: usize = 200;

/// Longest step over the stability limit at the start \[1\].
const LONGEST_STEP: f64 = 0.5;

pub(super) fn time_steps<const D: usize>(
    grown: &Grown<D>,
    law: &dyn PairLaw,
    damping: &ContactDamping,
) -> Result<ChoiceTable, PackingError> {
    let longest = LONGEST_STEP * Motion::new(&grown.packing, law, damping)?.stable_step();
    let place = |division: usize| -> Result<(Packing<D>, f64), PackingError> {
        let start = Instant::now();
        let mut motion = Motion::new(&grown.packing, law, damping)?;
        for _ in 0..division * FEWEST_STEPS {
            motion.step(longest / division as f64)?;
        }
        Ok((motion.assembly.placed(grown.packing.clone()), start.elapsed().as_secs_f64()))
    };
    let reference = place(32)?.0;
    let counts = |disk: &usize| grown.before.backbone[*disk] && !grown.packing.held()[*disk];
    let mut rows: Vec<ChoiceRow> = Vec::new();
    let mut last: Option<f64> = None;
    for division in [1, 2, 4, 8] {
        let (state, seconds) = place(division)?;
        let displacements = (0..state.len()).filter(counts).map(|disk| norm(displacement(&reference, &state, disk)));
        let error = displacements.fold(0.0, larger);
        let order = last.map(|last| libm::log2(last / error)).filter(|order| order.is_finite());
        last = Some(error);
        let share = LONGEST_STEP / division as f64;
        let values = vec![Some(longest / division as f64), Some(error), order, Some(seconds)];
        rows.push(ChoiceRow { setting: share.to_string(), values });
    }
    Ok(ChoiceTable {
        name: "time_step",
        title: "Time step of explicit damped dynamics: the same time from the inflated start",
        columns: vec!["step over the stable one (1)", "time step", "largest error (length)", "order (1)", "seconds"],
        rows,
    })
}

/// Skins over the smallest radius, in addition to the one in use \[1\].
const SKINS: [f64; 6] = [0.05, 0.1, 0.15, 0.35, 0.5, 1.0];

/// Number of steps of the trajectory, at the longest step.
const STEPS: usize = 2000;

/// The skin changes no contact, so the largest difference from the skin in use must be 0 or rounding.
pub(super) fn skins<const D: usize>(
    grown: &Grown<D>,
    law: &dyn PairLaw,
    damping: &ContactDamping,
) -> Result<ChoiceTable, PackingError> {
    let time_step = LONGEST_STEP * Motion::new(&grown.packing, law, damping)?.stable_step();
    let go = |skin: f64| -> Result<(Packing<D>, [f64; 3]), PackingError> {
        let start = Instant::now();
        let mut motion = Motion::of(Assembly::with_skin(&grown.packing, law, skin)?, damping);
        let pairs = motion.assembly.pairs().len() as f64 / motion.assembly.mobile_count() as f64;
        for _ in 0..STEPS {
            motion.step(time_step)?;
        }
        let seconds = start.elapsed().as_secs_f64();
        let lists = motion.assembly.build_count() as f64;
        Ok((motion.assembly.placed(grown.packing.clone()), [pairs, lists, seconds]))
    };
    let reference = go(SKIN)?.0;
    let mut skins = [&SKINS[..], &[SKIN]].concat();
    skins.sort_by(f64::total_cmp);
    let mut rows = Vec::new();
    for skin in skins {
        let (state, [pairs, lists, seconds]) = go(skin)?;
        let displacements = (0..state.len()).map(|disk| norm(displacement(&reference, &state, disk)));
        let values = vec![Some(pairs), Some(lists), Some(displacements.fold(0.0, larger)), Some(seconds)];
        rows.push(ChoiceRow { setting: skin.to_string(), values });
    }
    Ok(ChoiceTable {
        name: "skin",
        title: "Skin of the neighbour list: 2000 steps of explicit damped dynamics from the inflated start",
        columns: vec![
            "skin over the smallest radius (1)",
            "pairs a mobile disk (1)",
            "lists made (1)",
            "largest difference (length)",
            "seconds",
        ],
        rows,
    })
}
