//! `jamscope strain`: quasistatic simple shear of one packing file, with the stress of every step.

use std::fs::OpenOptions;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use clap::Args;
use jamscope::io::write_atomically;
use jamscope::network::ContactNetwork;
use jamscope::report::csv::{shear_header, shear_row};
use jamscope::run::{Progress, Watch};
use jamscope::strain::{QuasistaticShear, ShearSettings};

use crate::file_arguments::{FileArguments, Start, Task};
use crate::progress::Bars;
use crate::{Failure, print};

/// Arguments of `strain`.
#[derive(Args)]
pub struct StrainArguments {
    #[command(flatten)]
    file: FileArguments,
    /// Shear γ at the end: box and centres follow x → x + γ y. Of either sign.
    #[arg(long, value_name = "GAMMA", allow_negative_numbers = true)]
    shear: f64,
    /// Number of steps to it; after each the packing is relaxed to rest.
    #[arg(long, value_name = "N")]
    steps: usize,
}

/// Shears a packing step by step. The table of steps is beside the result, with the ending `csv`.
pub fn run(arguments: &StrainArguments) -> Result<ExitCode, Failure> {
    let settings = ShearSettings { strain: arguments.shear, step_count: arguments.steps };
    let action = format!("shear by {:?} in {} steps", arguments.shear, arguments.steps);
    let task = arguments.file.task(&action, "sheared")?;
    if !task.is_resumable() {
        return Err(format!(
            "{}: a shear writes a state after every step; give a file of extended XYZ with --out",
            task.out.display()
        )
        .into());
    }
    task.named(match arguments.file.dimension {
        3 => run_in::<3>(&task, settings),
        _ => run_in::<2>(&task, settings),
    })
}

fn run_in<const D: usize>(task: &Task, settings: ShearSettings) -> Result<ExitCode, Failure> {
    let Start { given, unfinished, properties } = task.start::<D>()?;
    let name = &task.name;
    let table = task.out.with_extension("csv");
    let failed = |error: jamscope::strain::StrainError| format!("{name}: {error}");
    let mut shear = match unfinished {
        Some((packing, step)) => {
            keep_rows(&table, step)?;
            QuasistaticShear::resumed(packing, step, settings, &task.law).map_err(failed)?
        }
        None => {
            let shear = QuasistaticShear::new(given, settings, &task.law).map_err(failed)?;
            write_atomically(&table, |writer| writer.write_all(shear_header().as_bytes()))?;
            shear
        }
    };
    let bars = Bars::new(std::iter::once(name.as_str()));
    let mut trace = Watch { progress: &bars, sample: 0, stage: "shear step", limit: task.relaxer.limit().value() };
    let mut last = None;
    while let Some(state) = shear.advance(&task.relaxer, &mut trace).map_err(failed)? {
        // The row first: rows beyond the last state are removed when the shear continues.
        let mut file = OpenOptions::new().append(true).open(&table)?;
        file.write_all(shear_row(&state).as_bytes())?;
        task.save(shear.packing(), state.step)?;
        last = Some(state);
    }
    bars.done(0, None);
    let network = ContactNetwork::new(shear.packing(), &task.law)?;
    task.finish(shear.packing(), &network, &properties)?;
    let rows = rows(&table)?;
    let column = |place: usize| rows.iter().filter_map(move |row| row.split(',').nth(place)?.parse::<f64>().ok());
    let event_count = column(11).filter(|&event| event == 1.0).count();
    let largest = column(2).fold(f64::NEG_INFINITY, f64::max);
    if let Some(state) = last {
        print(&format!(
            "shear {}: shear stress {:.6e}, largest {largest:.6e}, pressure {:.6e}, {event_count} events in {} steps\n",
            state.strain, state.shear_stress, state.pressure, settings.step_count
        ))?;
    }
    print(&format!("{}\n{}\n", task.out.display(), table.display()))
}

/// The rows of a table of steps.
fn rows(table: &Path) -> Result<Vec<String>, Failure> {
    let text = std::fs::read_to_string(table).map_err(|error| format!("{}: {error}", table.display()))?;
    Ok(text.lines().skip(2).map(str::to_owned).collect())
}

/// Keeps the rows up to a step, those of the states that were written.
fn keep_rows(table: &Path, step: usize) -> Result<(), Failure> {
    let rows = rows(table)?;
    if rows.len() <= step {
        return Err(format!(
            "{}: has {} steps, but the state beside it is that after step {step}; remove both to begin anew",
            table.display(),
            rows.len()
        )
        .into());
    }
    let kept: String = rows[..=step].iter().map(|row| format!("{row}\n")).collect();
    Ok(write_atomically(table, |writer| writer.write_all(format!("{}{kept}", shear_header()).as_bytes()))?)
}
