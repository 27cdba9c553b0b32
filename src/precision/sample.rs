//! One sample: its inflated packing, its known minima, and a run for each rung of the ladders.

use crate::inflation::Grown;
use crate::law::damping::DampingChoice;
use crate::law::pair_law::PairLaw;
use crate::packing::{Packing, PackingError};
use crate::precision::Progress;
use crate::precision::ladder::{Rung, Varied, rungs};
use crate::precision::minima::{End, Minima};
use crate::precision::numerical_choices::choice_tables;
use crate::precision::results::{Run, SamplePrecision};
use crate::precision::settings::PrecisionSettings;
use crate::relax::{Criterion, RelaxerChoice, Stop};
use crate::run::RunError;
use crate::scene::{Sample, Scene};

/// Measures a sample; its disks have sites if its inflation does.
pub(super) fn of_sample<const D: usize>(
    scene: &Scene,
    sample: &Sample,
    packing: &Packing<D>,
    law: &dyn PairLaw,
    settings: &PrecisionSettings,
    progress: &dyn Progress,
) -> Result<SamplePrecision, RunError> {
    let law = &*scene.inflation.checked_law_with_sites(law)?;
    let damping = damping_of(&sample.relaxer);
    let grown = Grown::new(&scene.inflation, packing, law, &sample.relaxer, sample.seed, &mut ())?;
    let rungs = if grown.before.criterion == Criterion::Unjammed {
        rungs(&settings.for_unjammed(), damping)
    } else {
        rungs(settings, damping)
    };
    progress.sample(&sample.name, rungs.len());
    progress.begins(0, "references");
    let mut minima = Minima::new(&grown, law, &scene.observables, damping, settings.reference_limit)?;
    let mut runs: Vec<Run> = Vec::new();
    for (done, rung) in rungs.iter().enumerate() {
        let what = format!("{}, {} {:e}", rung.method.name(), rung.varied.name(), rung.value);
        progress.begins(done, &what);
        let run = match runs.last().filter(|last| can_be_skipped(last, rung)) {
            Some(last) => Run { value: rung.value, ..last.clone() },
            None => run_of(rung, &what, &grown, law, scene, &mut minima)?,
        };
        runs.push(run);
    }
    progress.begins(rungs.len(), "other choices");
    let choices = choice_tables(minima.first(), &grown, law, damping, &scene.observables)?;
    Ok(SamplePrecision {
        name: sample.name.clone(),
        mobile_count: grown.mobile_count,
        pressure: grown.before.pressure,
        unjammed: minima.first().is_unjammed(),
        references: minima.disagreement,
        minima: minima.known,
        runs,
        choices,
    })
}

/// The damping of the sample's own dynamics; the default if its relaxer has none.
fn damping_of(relaxer: &RelaxerChoice) -> DampingChoice {
    match relaxer {
        RelaxerChoice::Damped(dynamics) => dynamics.damping,
        RelaxerChoice::Implicit(dynamics) => dynamics.damping,
        _ => DampingChoice::default(),
    }
}

/// Whether a run can be skipped: after one that reached its step limit, a tighter limit on the same trajectory gives
/// the same end.
fn can_be_skipped(last: &Run, rung: &Rung) -> bool {
    last.stop == Stop::StepLimit
        && (last.method, last.varied) == (rung.method, rung.varied)
        && rung.varied == Varied::ForceLimit
        && rung.value < last.value
}

fn run_of<const D: usize>(
    rung: &Rung,
    what: &str,
    grown: &Grown<D>,
    law: &dyn PairLaw,
    scene: &Scene,
    minima: &mut Minima<'_, D>,
) -> Result<Run, PackingError> {
    let outcome = grown.relax(grown.packing.clone(), law, &rung.relaxer, &mut ())?;
    let cost = outcome.cost;
    let end = End::new(outcome, grown, law, &scene.observables)?;
    let minimum = minima.of(&end.state, what)?;
    Ok(Run {
        method: rung.method,
        varied: rung.varied,
        value: rung.value,
        stop: end.stop,
        residual: end.residual,
        minimum: minima.known[minimum].label.clone(),
        minimum_distance: minima.known[minimum].distance,
        errors: minima.errors(&end.state, minimum),
        seconds: cost.seconds,
        cost,
    })
}
