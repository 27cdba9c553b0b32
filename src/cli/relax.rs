//! `jamscope relax` and `jamscope compress`: one packing file brought to rest, or to a packing fraction or pressure.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use jamscope::io::{Contents, Frame, read_contents};
use jamscope::law::LawChoice;
use jamscope::network::ContactNetwork;
use jamscope::packing::{Packing, PackingError};
use jamscope::preparation::{PreparationError, Target, compress};
use jamscope::relax::{Relaxer, RelaxerChoice, Stop};
use jamscope::report::write_state;
use jamscope::run::{Progress, Watch};
use jamscope::scene::{relaxer_by_name, relaxer_with_limit};
use jamscope::verdict::VerdictSettings;

use crate::contact_law::{self, LawName};
use crate::progress::Bars;
use crate::{Failure, exit_code, input, print, threads, warn};

/// A packing file and how it is relaxed.
#[derive(Args)]
struct FileArguments {
    /// Packing file: extended XYZ, LAMMPS data or dump, possibly compressed by gzip or zstd, or a NumPy archive; `-` is the standard input.
    packing: PathBuf,
    /// Frame of a file with several: `last` or its number, from 0.
    #[arg(long, value_name = "FRAME", default_value = "last", value_parser = input::frame)]
    frame: Frame,
    /// Relaxer, by its name in a scene: `fire`, `damped`, `conjugate_gradients`, `quasi_newton`, `implicit`,
    /// `gradient_flow`, `newton` or `staged`.
    #[arg(long, value_name = "NAME", default_value = "fire")]
    relaxer: String,
    /// Limit of the largest net force on the backbone over the mean contact force, at most 1e-3; by default that of the
    /// relaxer, 1e-8.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    limit: Option<f64>,
    /// Contact law if the file gives none: `hertzian`, `hookean` or `power:ALPHA`; by default Hertzian.
    #[arg(long, value_name = "LAW", value_parser = contact_law::parse)]
    law: Option<LawName>,
    /// Stiffness k' (Hertzian, Hookean) or energy scale (power law) if the file gives none.
    #[arg(long, value_name = "K")]
    stiffness: Option<f64>,
    /// Dimension of the packing.
    #[arg(long, value_name = "D", default_value_t = 2, value_parser = clap::value_parser!(u8).range(2..=3))]
    dimension: u8,
    /// Number of threads; by default one per core. Changes no result.
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// File for the result: extended XYZ, or a NumPy archive if its name ends in .npz; by default NAME.relaxed.xyz or NAME.compressed.xyz in the current folder, if there is
    /// no such file.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

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

/// Largest residual of a state at rest \[1\].
fn residual_limit() -> f64 {
    VerdictSettings::default().residual_limit
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
enum Task {
    Relax,
    Compress(Target, f64),
}

/// Relaxes a packing in the box, or within the held disks, that its file has.
pub fn relax(arguments: &RelaxArguments) -> Result<ExitCode, Failure> {
    run(&arguments.file, &Task::Relax)
}

/// Compresses or decompresses a packing to a packing fraction or a pressure.
pub fn compress_file(arguments: &CompressArguments) -> Result<ExitCode, Failure> {
    let target = match (arguments.pressure, arguments.packing_fraction) {
        (_, Some(fraction)) => Target::PackingFraction(fraction),
        (pressure, None) => Target::Pressure(pressure.unwrap_or(0.0)),
    };
    run(&arguments.file, &Task::Compress(target, arguments.tolerance))
}

fn run(arguments: &FileArguments, task: &Task) -> Result<ExitCode, Failure> {
    threads::set_threads(arguments.threads)?;
    let name = &arguments.relaxer;
    if name.is_empty() || !name.chars().all(|c| c.is_ascii_lowercase() || c == '_') {
        return Err(format!("--relaxer is `{name}`, not the name of a relaxer in a scene, such as fire").into());
    }
    let relaxer = match arguments.limit {
        Some(limit) if limit > 0.0 && limit <= residual_limit() => relaxer_with_limit(name, limit),
        Some(limit) => {
            return Err(format!("--limit is {limit}: must be above 0 and at most {}", residual_limit()).into());
        }
        None => relaxer_by_name(name),
    };
    let relaxer = relaxer.map_err(|error| format!("--relaxer {name}: {}", error.message))?;
    let mut inputs = input::Inputs::default();
    let path = inputs.file(&arguments.packing)?;
    inputs.named(run_file(&path, arguments, &relaxer, task))
}

fn run_file(path: &Path, arguments: &FileArguments, relaxer: &RelaxerChoice, task: &Task) -> Result<ExitCode, Failure> {
    let out = match (&arguments.out, named(&arguments.packing, task)) {
        (Some(out), _) => out.clone(),
        (None, default) if default.exists() => {
            return Err(format!("{}: exists; name the file for the result with --out", default.display()).into());
        }
        (None, default) => default,
    };
    input::check_output(&out, path)?;
    let law = contact_law::law_of(path, arguments.frame, arguments.law, arguments.stiffness)?;
    law.check()?;
    match arguments.dimension {
        3 => run_in::<3>((path, &out), arguments, (&law, relaxer), task),
        _ => run_in::<2>((path, &out), arguments, (&law, relaxer), task),
    }
}

/// Refuses packings that the commands would change in a way that their file does not mean.
fn check<const D: usize>(packing: &Packing<D>) -> Result<(), &'static str> {
    if packing.sites().is_some() {
        return Err(
            "the disks have sites, and their on-site forces are known only to a scene; leave out the columns site and site_correction to go on without them",
        );
    }
    if packing.domain().lengths().is_none() && !packing.held().contains(&true) {
        return Err(
            "the packing lies in the open plane and no disk is held, so it would fly apart; mark the disks of the rim in a column held:I:1",
        );
    }
    Ok(())
}

fn run_in<const D: usize>(
    (path, out): (&Path, &Path),
    arguments: &FileArguments,
    (law, relaxer): (&LawChoice, &RelaxerChoice),
    task: &Task,
) -> Result<ExitCode, Failure> {
    let Contents { packing, properties, warnings } = read_contents::<D>(path, arguments.frame)?;
    warn(&arguments.packing, &warnings);
    let name = arguments.packing.display();
    check(&packing).map_err(|reason| format!("{name}: {reason}"))?;
    let bars = Bars::new(std::iter::once(name.to_string().as_str()));
    let mut trace = Watch { progress: &bars, sample: 0, stage: "relaxation", limit: relaxer.limit().value() };
    let labels = packing.labels().to_vec();
    let network =
        ContactNetwork::new(&packing, law).map_err(|error| format!("{name}: {}", error.with_labels(&labels)))?;
    let first = Numbers::of(&packing, &network);
    let (state, end) = match task {
        Task::Relax => {
            let outcome = relaxer
                .relax(packing, law, &mut trace)
                .map_err(|error| format!("{name}: {}", error.with_labels(&labels)))?;
            let cost = outcome.cost;
            let end = End { stop: outcome.stop, residual: outcome.residual.relative(), cost, relaxation_count: 1 };
            (outcome.state, end)
        }
        Task::Compress(target, tolerance) => {
            let prepared = compress(packing, (*target, *tolerance), law, relaxer, &mut trace)
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
    write_state(out, &state, (&network, law), &[], &properties)?;
    print(&table(&first, &Numbers::of(&state, &network), &end, out))?;
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

/// The default name of the result, in the current folder.
fn named(path: &Path, task: &Task) -> PathBuf {
    let ending = match task {
        Task::Relax => "relaxed",
        Task::Compress(..) => "compressed",
    };
    let stem = path.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
    let stem = if stem.is_empty() || stem == "-" { "packing" } else { &stem };
    PathBuf::from(format!("{stem}.{ending}.xyz"))
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
