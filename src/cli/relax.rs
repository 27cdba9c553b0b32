//! `jamscope relax` and `jamscope compress`: one packing file brought to rest, or to a packing fraction or pressure.

use std::path::Path;
use std::process::ExitCode;

use clap::Args;
use jamscope::network::ContactNetwork;
use jamscope::packing::{Packing, PackingError};
use jamscope::preparation::{PreparationError, Target, compress};
use jamscope::relax::{Relaxer, Stop};
use jamscope::run::{Progress, Watch};

use crate::file_arguments::{FileArguments, InPortions, Start, Task, residual_limit};
use crate::progress::Bars;
use crate::{Failure, exit_code, print};

/// Arguments of `relax`.
#[derive(Args)]
pub struct RelaxArguments {
    #[command(flatten)]
    file: FileArguments,
}

/// Arguments of `compress`.
#[derive(Args)]
pub struct CompressArguments {
    #[command(flatten)]
    file: FileArguments,
    /// Pressure to reach.
    #[arg(
        long,
        value_name = "P",
        conflicts_with = "packing_fraction",
        required_unless_present = "packing_fraction",
        allow_negative_numbers = true
    )]
    pressure: Option<f64>,
    /// Packing fraction to reach.
    #[arg(long, value_name = "PHI", allow_negative_numbers = true)]
    packing_fraction: Option<f64>,
    /// Largest relative deviation of the pressure.
    #[arg(long, value_name = "X", default_value_t = 0.01)]
    tolerance: f64,
}

/// Whether a relaxation ended at rest: by the criteria of the relaxer, of force and energy, or at the rounding floor with
/// a residual that counts as rest.
fn is_at_rest(stop: Stop, residual: f64) -> bool {
    match stop {
        Stop::Converged(_) => true,
        Stop::RoundingFloor => residual <= residual_limit(),
        _ => false,
    }
}

/// What is done with a packing.
enum Action {
    Relax,
    Compress(Target, f64),
}

/// Relaxes a packing in the box, or within the held disks, that its file has.
pub fn relax(arguments: &RelaxArguments) -> Result<ExitCode, Failure> {
    run(&arguments.file, &arguments.file.task("relax", "relaxed")?, &Action::Relax)
}

/// Compresses or decompresses a packing to a packing fraction or a pressure.
pub fn compress_file(arguments: &CompressArguments) -> Result<ExitCode, Failure> {
    let tolerance = arguments.tolerance;
    let (target, what) = match (arguments.pressure, arguments.packing_fraction) {
        (_, Some(fraction)) => {
            (Target::PackingFraction(fraction), format!("compress to packing fraction {fraction:?}"))
        }
        (pressure, None) => {
            let pressure = pressure.unwrap_or(0.0);
            (Target::Pressure(pressure), format!("compress to pressure {pressure:?} within {tolerance:?}"))
        }
    };
    run(&arguments.file, &arguments.file.task(&what, "compressed")?, &Action::Compress(target, tolerance))
}

fn run(arguments: &FileArguments, task: &Task, action: &Action) -> Result<ExitCode, Failure> {
    task.named(match arguments.dimension {
        3 => run_in::<3>(task, action),
        _ => run_in::<2>(task, action),
    })
}

fn run_in<const D: usize>(task: &Task, action: &Action) -> Result<ExitCode, Failure> {
    let Start { given, unfinished, properties } = task.start::<D>()?;
    let (name, law) = (&task.name, &task.law);
    let bars = Bars::new(std::iter::once(name.as_str()));
    let mut trace = Watch { progress: &bars, sample: 0, stage: "relaxation", limit: task.relaxer.limit().value() };
    let labels = given.labels().to_vec();
    let network =
        ContactNetwork::new(&given, law).map_err(|error| format!("{name}: {}", error.with_labels(&labels)))?;
    let first = Numbers::of(&given, &network);
    let packing = unfinished.map_or(given, |(packing, _)| packing);
    let relaxer = InPortions::of(task);
    let (state, end) = match action {
        Action::Relax => {
            let outcome = relaxer
                .relax(packing, law, &mut trace)
                .map_err(|error| format!("{name}: {}", error.with_labels(&labels)))?;
            let cost = outcome.cost;
            let end = End { stop: outcome.stop, residual: outcome.residual.relative(), cost, relaxation_count: 1 };
            (outcome.state, end)
        }
        Action::Compress(target, tolerance) => {
            let prepared = compress(packing, (*target, *tolerance), law, &relaxer, &mut trace)
                .map_err(|error| format!("{name}: {}", too_few(&labels, error)))?;
            let end = End {
                stop: Stop::Converged(prepared.criterion),
                residual: prepared.residual.relative(),
                cost: prepared.cost,
                relaxation_count: prepared.relaxation_count,
            };
            (prepared.packing.into_inner(), end)
        }
    };
    bars.done(0, None);
    if end.stop == Stop::NonFinite {
        return Err(format!("{name}: a force became infinite or not a number; nothing is written").into());
    }
    let network = ContactNetwork::new(&state, law)?;
    task.finish(&state, &network, &properties)?;
    print(&table(&first, &Numbers::of(&state, &network), &end, &task.out))?;
    let moves = !is_at_rest(end.stop, end.residual);
    Ok(exit_code::of_relaxation(moves.then(|| format!("{name} ({:?})", end.stop))))
}

/// The error of a compression; a box that becomes too small has too few disks.
fn too_few(labels: &[u64], error: PreparationError) -> String {
    match error {
        PreparationError::Packing(PackingError::BoxTooSmall { length, range, .. }) => format!(
            "{} disks are too few: the target needs a box with a side of {length}, below twice the longest contact range {range}, and a \
             pair of disks would touch twice; use a larger packing",
            labels.len()
        ),
        PreparationError::Packing(error) => error.with_labels(labels).to_string(),
        other => other.to_string(),
    }
}

/// How the last relaxation ended, and what all of them cost.
struct End {
    stop: Stop,
    residual: f64,
    cost: jamscope::relax::Cost,
    relaxation_count: usize,
}

/// Numbers of a state.
struct Numbers {
    packing_fraction: Option<f64>,
    pressure: Option<f64>,
    energy: f64,
    contact_count: usize,
    rattler_count: usize,
    coordination: f64,
}

impl Numbers {
    fn of<const D: usize>(packing: &Packing<D>, network: &ContactNetwork<D>) -> Self {
        Numbers {
            packing_fraction: packing.packing_fraction(),
            pressure: packing.domain().volume().map(|volume| network.pressure(volume)),
            energy: network.energy(),
            contact_count: network.contacts.len(),
            rattler_count: network.rattlers().count(),
            coordination: network.coordination(),
        }
    }
}

/// The table on the terminal: before and after.
fn table(first: &Numbers, last: &Numbers, end: &End, out: &Path) -> String {
    let mut text = format!("{:<34} {:>24} {:>24}\n", "", "before", "after");
    let number = |value: f64| {
        let is_short = value == 0.0 || (1e-4..1e9).contains(&value.abs());
        if is_short { value.to_string() } else { format!("{value:e}") }
    };
    let mut row = |name: &str, of: &dyn Fn(&Numbers) -> Option<String>| {
        if let (Some(first), Some(last)) = (of(first), of(last)) {
            text.push_str(&format!("{name:<34} {first:>24} {last:>24}\n"));
        }
    };
    row("packing fraction [1]", &|it| it.packing_fraction.map(number));
    row("pressure [force / length^(D-1)]", &|it| it.pressure.map(number));
    row("energy [energy]", &|it| Some(number(it.energy)));
    row("contacts", &|it| Some(it.contact_count.to_string()));
    row("rattlers", &|it| Some(it.rattler_count.to_string()));
    row("coordination Z [1]", &|it| Some(number(it.coordination)));
    let End { stop, residual, cost, relaxation_count } = end;
    text.push_str(&format!(
        "\n{stop:?}: residual {residual:.1e} after {} relaxations, {} force evaluations, {} factorisations, {:.2} s\n{}\n",
        relaxation_count,
        cost.force_evaluation_count,
        cost.factorisation_count,
        cost.seconds,
        out.display()
    ));
    text
}

#[cfg(test)]
mod tests {
    use jamscope::relax::Criterion;

    use super::*;

    #[test]
    fn a_small_residual_alone_is_no_rest() {
        assert!(is_at_rest(Stop::Converged(Criterion::RelativeForce), 1e-9));
        assert!(is_at_rest(Stop::RoundingFloor, 1e-14) && !is_at_rest(Stop::RoundingFloor, 1e-2));
        // With more energy than at the start, without a minimum, or in an unstable motion nothing is at rest.
        for stop in [Stop::EnergyGained, Stop::NoMinimum, Stop::Unstable, Stop::StepLimit, Stop::Underflow] {
            assert!(!is_at_rest(stop, 0.0), "{stop:?}");
        }
    }
}
