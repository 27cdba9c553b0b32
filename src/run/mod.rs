//! [`run`]: from a [`Scene`] to a [`Report`], one line per stage. The only file that uses all stages.

#[cfg(feature = "linear")]
mod drive_summary;
mod error;
#[cfg(feature = "linear")]
mod plastic_summary;
mod progress;
mod report_data;

use std::path::Path;

use crate::certificate::Certificate;
use crate::displacement::DisplacementField;
use crate::inflation::{Boundary, Inflated, Inflation, InflationError, Rest, inflate_with};
use crate::io::read_packing;
use crate::law::pair_law::PairLaw;
use crate::memory::Memory;
use crate::network::ContactNetwork;
use crate::observe::PressureChange;
use crate::observe::state::State;
use crate::packing::{Packing, PackingError};
use crate::preparation::{Preparation, Prepared, Target, compress, prepare_with};
use crate::processor::Processor;
#[cfg(feature = "linear")]
use crate::protocol::{Compared, Protocol, ProtocolSensitivity, ProtocolSettings, ProtocolSummary, chosen};
use crate::relax::{Criterion, Outcome, Relaxer, RelaxerChoice, Stop, Trace};
#[cfg(feature = "linear")]
use crate::response::Measurement;
use crate::response::{Calibration, Conditions, PhaseFrequency, Response, Subject};
use crate::scene::reduced_pressure::reduction;
use crate::scene::{Sample, Scene, SceneError, Source};
use crate::verdict::{Place, RestVerdict};

#[cfg(feature = "linear")]
pub use drive_summary::{DriveError, DriveMode, DriveSummary};
pub use error::RunError;
pub use progress::{Progress, Watch};
#[cfg(feature = "linear")]
pub use report_data::PlasticSummary;
pub use report_data::{
    InflationSummary, PackingSummary, Report, RestSummary, SampleOutcome, SampleReport, SampleResult, StateSummary,
    States, StatesOf,
};

/// Runs a scene. Samples are independent; with the feature `parallel` each has a thread, and results do not depend on
/// it.
///
/// # Errors
/// An invalid scene. The failure of a sample is recorded in its entry of the report.
pub fn run(scene: &Scene, progress: &dyn Progress) -> Result<Report, RunError> {
    scene.check()?;
    scene.check_memory(Memory::of_machine(), thread_count()).map_err(SceneError::from)?;
    let one = |(index, sample): (usize, &Sample)| {
        let result = match scene.dimension {
            3 => run_sample::<3>(scene, sample, index, progress),
            _ => run_sample::<2>(scene, sample, index, progress),
        };
        let result = match result {
            Ok(result) => SampleOutcome::Done(Box::new(result)),
            Err(error) => SampleOutcome::Failed(error.to_string()),
        };
        let failure = match &result {
            SampleOutcome::Failed(reason) => Some(reason.as_str()),
            SampleOutcome::Done(_) => None,
        };
        progress.done(index, failure);
        SampleReport { name: sample.name.clone(), seed: sample.seed, result }
    };
    #[cfg(feature = "parallel")]
    let samples: Vec<SampleReport> = {
        use rayon::prelude::*;
        if scene.sample.len() == 1 {
            // A single sample runs alone, so that its relaxations can use all threads.
            scene.sample.iter().enumerate().map(one).collect()
        } else {
            // One sample per work item, so that the results keep the order of the scene.
            scene.sample.par_iter().enumerate().with_max_len(1).map(one).collect()
        }
    };
    #[cfg(not(feature = "parallel"))]
    let samples: Vec<SampleReport> = scene.sample.iter().enumerate().map(one).collect();
    #[cfg(feature = "linear")]
    let protocol = protocol_summary(&samples);
    Ok(Report {
        jamscope_version: env!("CARGO_PKG_VERSION"),
        vectors: Processor::own().vectors(),
        scene: scene.clone(),
        samples,
        #[cfg(feature = "linear")]
        protocol,
    })
}

/// Largest number of samples that run in parallel.
pub(crate) fn thread_count() -> usize {
    #[cfg(feature = "parallel")]
    let count = rayon::current_num_threads();
    #[cfg(not(feature = "parallel"))]
    let count = 1;
    count
}

/// Summary of the protocols over samples, if any was compared.
#[cfg(feature = "linear")]
fn protocol_summary(samples: &[SampleReport]) -> Option<ProtocolSummary> {
    let compared = samples.iter().filter_map(|sample| match &sample.result {
        SampleOutcome::Done(result) => result.protocol.as_ref()?.measured().map(Box::as_ref),
        SampleOutcome::Failed(_) => None,
    });
    ProtocolSummary::of(samples.len(), &compared.collect::<Vec<_>>())
}

/// Runs one sample of a scene. The only place that matches on the law.
///
/// # Errors
/// [`RunError`] with the stage.
pub fn run_sample<const D: usize>(
    scene: &Scene,
    sample: &Sample,
    index: usize,
    progress: &dyn Progress,
) -> Result<SampleResult, RunError> {
    let (prepared, packing) = prepared::<D>(scene, sample, &scene.law, index, progress)?;
    measure(scene, sample, (prepared, packing), &scene.law, index, progress)
}

/// The packing of a sample with its summary.
pub(crate) fn prepared<const D: usize>(
    scene: &Scene,
    sample: &Sample,
    law: &dyn PairLaw,
    index: usize,
    progress: &dyn Progress,
) -> Result<(Packing<D>, PackingSummary), RunError> {
    let relaxer = &scene.preparation.relaxer;
    let trace = &mut Watch { progress, sample: index, stage: "preparation", limit: relaxer.limit().value() };
    packing_of(scene, sample, law, trace)
}

/// Inflates a packing and computes all observables.
pub(crate) fn measure<const D: usize>(
    scene: &Scene,
    sample: &Sample,
    (prepared, packing): (Packing<D>, PackingSummary),
    law: &dyn PairLaw,
    index: usize,
    progress: &dyn Progress,
) -> Result<SampleResult, RunError> {
    let watch =
        |stage, relaxer: &RelaxerChoice| Watch { progress, sample: index, stage, limit: relaxer.limit().value() };
    let trace = &mut watch("inflation", &sample.relaxer);
    let inflated = inflate_with(&scene.inflation, &prepared, law, &sample.relaxer, sample.seed, trace)?;
    let observables = &scene.observables;
    let verdict = verdict(scene, &inflated, law)?;
    let verdict = match &packing.as_read {
        Some(read) => verdict.after(read),
        None => verdict,
    };
    let response = Response::of(subject(&inflated, law, verdict)?, observables);
    #[cfg(feature = "linear")]
    let (plastic_part, plastic_field) = match observables.plastic_part {
        Some(settings) => match plastic_summary::of(&inflated, &scene.inflation, law, settings.ring_width) {
            Ok((summary, field)) => (Some(Measurement::Measured(summary)), Some(field)),
            Err(error) => {
                let reason = error.with_labels(inflated.before.packing.get().labels()).to_string();
                (Some(Measurement::Refused(reason)), None)
            }
        },
        None => (None, None),
    };
    #[cfg(feature = "linear")]
    let protocol = observables.protocol.filter(|settings| takes(scene, sample, settings)).map(|settings| {
        let trace = &mut watch("protocols", &sample.relaxer);
        let compared = protocol_of(scene, sample, (&inflated, &response.verdict), law, &settings, trace);
        compared.map(Box::new).into()
    });
    #[cfg(feature = "linear")]
    let drive = drive_summary::of(scene, &inflated, &prepared, law);
    let phase_frequency = phase_frequency(scene, sample, &packing, &response);
    Ok(SampleResult {
        packing,
        phase_frequency,
        inflation: summary(&inflated, law, &scene.inflation)?,
        response,
        #[cfg(feature = "linear")]
        plastic_part,
        #[cfg(feature = "linear")]
        protocol,
        #[cfg(feature = "linear")]
        drive,
        states: States::of(StatesOf {
            cycle_field: DisplacementField::of_cycle(&inflated),
            #[cfg(feature = "linear")]
            plastic_field,
            inflated,
            prepared,
        }),
    })
}

/// How often similar samples have the phase of this one.
fn phase_frequency(
    scene: &Scene,
    sample: &Sample,
    packing: &PackingSummary,
    response: &Response,
) -> Option<PhaseFrequency> {
    // The ensembles are of disks around a held one that is inflated.
    let Inflation { boundary, centre_held, drive, .. } = scene.inflation;
    if scene.dimension != 2 || boundary.is_strip() || !centre_held || !drive.is_inflation() {
        return None;
    }
    let relaxer = sample.relaxer.description();
    let conditions = Conditions {
        law: scene.law.name(),
        relaxer: &relaxer,
        disk_count: packing.disk_count,
        increase: scene.inflation.increase,
        reduced_pressure: packing.pressure * reduction(scene),
    };
    Calibration::built_in().frequency(&conditions, response.phase.outcome)
}

/// An inflation as the input of the observables.
fn subject<'a, const D: usize>(
    inflated: &'a Inflated<D>,
    law: &dyn PairLaw,
    verdict: RestVerdict,
) -> Result<Subject<'a, D>, PackingError> {
    let state = |rest: &'a Rest<D>| State::new(rest.packing.get(), law);
    Ok(Subject {
        verdict,
        field: DisplacementField::of_inflation(inflated),
        before: state(&inflated.before)?,
        after: state(&inflated.after)?,
        deflated: inflated.deflated.as_ref().map(state).transpose()?,
        centre: inflated.centre,
        drive: inflated.drive,
        pressure_change: inflated.after.pressure - inflated.before.pressure,
    })
}

/// Whether the states of an inflation are at rest, including the forces from sites if there are any.
fn verdict<const D: usize>(
    scene: &Scene,
    inflated: &Inflated<D>,
    law: &dyn PairLaw,
) -> Result<RestVerdict, PackingError> {
    fn state<'a, const D: usize>(rest: &'a Rest<D>, law: &dyn PairLaw) -> Result<State<'a, D>, PackingError> {
        State::new(rest.packing.get(), law)
    }
    let law = &*scene.inflation.law_with_sites(law);
    let (before, after) = (state(&inflated.before, law)?, state(&inflated.after, law)?);
    let deflated = inflated.deflated.as_ref().map(|rest| state(rest, law)).transpose()?;
    let mut named = vec![("before", &before), ("after", &after)];
    named.extend(deflated.as_ref().map(|state| ("after the deflation", state)));
    let held = matches!(scene.inflation.boundary, Boundary::HeldRim { .. });
    let place = Place { centre: inflated.centre, outer_radius: held.then_some(inflated.outer_radius) };
    Ok(RestVerdict::of(&named, law, &scene.law, Some(place), &scene.verdict))
}

/// Whether the sample belongs to the fraction whose protocols are compared.
#[cfg(feature = "linear")]
fn takes(scene: &Scene, sample: &Sample, settings: &ProtocolSettings) -> bool {
    let names: Vec<(&str, u64)> = scene.sample.iter().map(|other| (other.name.as_str(), other.seed)).collect();
    chosen(&names, settings.fraction).into_iter().zip(&names).any(|(taken, (name, _))| taken && *name == sample.name)
}

/// Compares the relaxer of the sample with the others, from the same start.
#[cfg(feature = "linear")]
fn protocol_of<const D: usize>(
    scene: &Scene,
    sample: &Sample,
    (inflated, verdict): (&Inflated<D>, &RestVerdict),
    law: &dyn PairLaw,
    settings: &ProtocolSettings,
    trace: &mut dyn Trace,
) -> Result<ProtocolSensitivity, PackingError> {
    let protocols = Protocol::all(&sample.relaxer);
    #[cfg(not(feature = "fit"))]
    let _ = verdict;
    let mut compared = Compared::of_inflation(inflated, &scene.inflation, law, &protocols, settings, trace)?;
    compared.measure_responses(inflated, law)?;
    #[cfg(feature = "fit")]
    if let (Some(profile), Some(fit), Some(_)) =
        (scene.observables.radial_profile, scene.observables.profile_fit, verdict.permit())
    {
        compared.fit(inflated, profile.ring_width, &fit);
    }
    Ok(compared.sensitivity)
}

/// The packing of a sample at rest, prepared or read.
pub(crate) fn packing_of<const D: usize>(
    scene: &Scene,
    sample: &Sample,
    law: &dyn PairLaw,
    trace: &mut dyn Trace,
) -> Result<(Packing<D>, PackingSummary), RunError> {
    let target = match &sample.source {
        Source::File(path) => return packing_from((path, None), scene, law, trace),
        Source::FileAtPressure { file, pressure } => return packing_from((file, Some(*pressure)), scene, law, trace),
        Source::PackingFraction(fraction) => Target::PackingFraction(*fraction),
        Source::Pressure(pressure) => Target::Pressure(*pressure),
    };
    let preparation = Preparation {
        disk_count: scene.disk_count,
        mixture: scene.mixture.clone(),
        target,
        tolerance: scene.preparation.pressure_tolerance,
        seed: sample.seed,
        side_ratio: scene.inflation.boundary.side_ratio(),
    };
    let prepared = prepare_with::<D>(&preparation, law, &scene.preparation.relaxer, trace)?;
    let quench_packing_fraction = Some(prepared.quench_packing_fraction);
    let (packing, summary) = prepared_summary(prepared, law)?;
    Ok((packing, PackingSummary { quench_packing_fraction, ..summary }))
}

/// The packing at rest and its summary.
fn prepared_summary<const D: usize>(
    prepared: Prepared<D>,
    law: &dyn PairLaw,
) -> Result<(Packing<D>, PackingSummary), RunError> {
    let rest = RestSummary {
        criterion: prepared.criterion,
        relative_residual: prepared.residual.relative(),
        largest_net_force: prepared.residual.largest_net_force,
        rounding_floor: prepared.rounding_floor,
        cost: prepared.cost,
    };
    let packing = prepared.packing.into_inner();
    let summary =
        PackingSummary { relaxation_count: prepared.relaxation_count, ..packing_summary(&packing, law, rest)? };
    Ok((packing, summary))
}

/// A packing from a file, relaxed if it is not at rest, or brought to a pressure. The verdict on the file is kept.
fn packing_from<const D: usize>(
    (path, pressure): (&Path, Option<f64>),
    scene: &Scene,
    law: &dyn PairLaw,
    trace: &mut dyn Trace,
) -> Result<(Packing<D>, PackingSummary), RunError> {
    let named = |source| RunError::PackingOfFile { path: path.into(), source };
    let read = read_packing(path)?;
    let as_read = {
        let state = State::new(&read, law).map_err(named)?;
        RestVerdict::of(&[("as read", &state)], law, &scene.law, None, &scene.verdict)
    };
    if let Some(pressure) = pressure {
        let target = (Target::Pressure(pressure), scene.preparation.pressure_tolerance);
        let prepared = compress(read, target, law, &scene.preparation.relaxer, trace)?;
        let (packing, summary) = prepared_summary(prepared, law)?;
        return Ok((packing, PackingSummary { as_read: Some(as_read), ..summary }));
    }
    let outcome = scene.preparation.relaxer.relax(read, law, trace).map_err(named)?;
    let Outcome { stop, residual, rounding_floor, cost, .. } = outcome;
    let (Stop::Converged(criterion), Ok(packing)) = (stop, outcome.converged()) else {
        let (step_count, residual) = (cost.step_count, residual.relative());
        return Err(RunError::NotAtRest { path: path.into(), stop, step_count, residual });
    };
    let rest = RestSummary {
        criterion,
        relative_residual: residual.relative(),
        largest_net_force: residual.largest_net_force,
        rounding_floor,
        cost,
    };
    let packing = packing.into_inner();
    let summary = PackingSummary { as_read: Some(as_read), ..packing_summary(&packing, law, rest)? };
    Ok((packing, summary))
}

fn packing_summary<const D: usize>(
    packing: &Packing<D>,
    law: &dyn PairLaw,
    rest: RestSummary,
) -> Result<PackingSummary, RunError> {
    let network = ContactNetwork::new(packing, law)?;
    let volume = packing.domain().volume().ok_or(InflationError::NotPeriodic)?;
    let jammed = rest.criterion != Criterion::Unjammed;
    Ok(PackingSummary {
        disk_count: packing.len(),
        box_sides: packing.domain().lengths().ok_or(InflationError::NotPeriodic)?.to_vec(),
        packing_fraction: packing.packing_fraction().ok_or(InflationError::NotPeriodic)?,
        quench_packing_fraction: None,
        as_read: None,
        pressure: if jammed { network.pressure(volume) } else { 0.0 },
        energy: network.energy(),
        contact_count: network.contacts.len(),
        rattler_count: network.rattlers().count(),
        coordination: network.coordination(),
        relaxation_count: 1,
        rest,
        certificate: Certificate::of(packing, law, Some(rest.criterion))?,
    })
}

fn summary<const D: usize>(
    inflated: &Inflated<D>,
    law: &dyn PairLaw,
    inflation: &Inflation,
) -> Result<InflationSummary, PackingError> {
    let certificate = |rest: &Rest<D>| {
        Certificate::of(rest.packing.get(), inflation.law_with_sites(law).as_ref(), Some(rest.criterion))
    };
    let state = |rest: &Rest<D>| -> Result<StateSummary, PackingError> {
        Ok(StateSummary {
            pressure: rest.pressure,
            energy: rest.energy,
            contact_count: rest.contact_count,
            rattler_count: rest.rattler_count,
            rest: RestSummary {
                criterion: rest.criterion,
                relative_residual: rest.residual.relative(),
                largest_net_force: rest.residual.largest_net_force,
                rounding_floor: rest.rounding_floor,
                cost: rest.cost,
            },
            certificate: certificate(rest)?,
        })
    };
    let pressure = PressureChange::of_inflation(inflated, law);
    Ok(InflationSummary {
        centre_label: inflated.before.packing.get().labels()[inflated.centre],
        inner_radius: inflated.inner_radius,
        outer_radius: inflated.outer_radius,
        mobile_count: inflated.mobile_count,
        before: state(&inflated.before)?,
        after: state(&inflated.after)?,
        deflated: inflated.deflated.as_ref().map(state).transpose()?,
        pressure_change: pressure.change,
        scaled_pressure_change: pressure.scaled,
    })
}
