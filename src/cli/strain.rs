//! `jamscope strain`: quasistatic simple shear of one packing file, with the stress of every step.

use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::path::Path;
use std::process::ExitCode;

use clap::Args;
use jamscope::network::ContactNetwork;
use jamscope::report::csv::{shear_header, shear_row};
use jamscope::run::{Progress, Watch};
use jamscope::strain::{QuasistaticShear, ShearSettings};
use jamscope::vector::larger;

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
    if table == task.out || table == task.path {
        return Err(format!(
            "{}: would be the table of steps, which ends in .csv; give another file with --out",
            table.display()
        )
        .into());
    }
    let step = unfinished.as_ref().map(|(_, step)| *step);
    let mut shear = match unfinished {
        Some((packing, step)) => QuasistaticShear::resumed(packing, step, settings, &task.law).map_err(failed)?,
        None => QuasistaticShear::new(given, settings, &task.law).map_err(failed)?,
    };
    let mut file = opened(&table, step)?;
    let bars = Bars::new(std::iter::once(name.as_str()));
    let mut trace = Watch { progress: &bars, sample: 0, stage: "shear step", limit: task.relaxer.limit().value() };
    let mut last = None;
    while let Some(state) = shear.advance(&task.relaxer, &mut trace).map_err(failed)? {
        // The row first: rows beyond the last state are removed when the shear continues.
        file.write_all(shear_row(&state).as_bytes())?;
        task.save(shear.packing(), state.step)?;
        last = Some(state);
    }
    bars.done(0, None);
    let network = ContactNetwork::new(shear.packing(), &task.law)?;
    task.finish(shear.packing(), &network, &properties)?;
    if let Some(state) = last {
        let (largest, event_count) = summary(&table)?;
        print(&format!(
            "shear {}: shear stress {:.6e}, largest size {largest:.6e}, pressure {:.6e}, {event_count} events in {} steps\n",
            state.strain, state.shear_stress, state.pressure, settings.step_count
        ))?;
    }
    print(&format!("{}\n{}\n", task.out.display(), table.display()))
}

/// The largest |σ_xy| of a table of steps, and the number of its events.
fn summary(table: &Path) -> Result<(f64, usize), Failure> {
    let text = std::fs::read_to_string(table).map_err(|error| format!("{}: {error}", table.display()))?;
    let names: Vec<&str> = text.lines().next().unwrap_or_default().split(',').collect();
    let column = |name: &str| -> Vec<f64> {
        let place = names.iter().position(|&other| other == name).unwrap_or_default();
        let cells = text.lines().skip(2).filter_map(|row| row.split(',').nth(place)?.parse().ok());
        cells.collect()
    };
    let largest = column("shear_stress").into_iter().fold(0.0, |most, stress| larger(stress.abs(), most));
    Ok((largest, column("event").into_iter().filter(|&event| event == 1.0).count()))
}

/// The table of steps, locked: new with its header, or with the rows up to `step`, those of the states that were written.
fn opened(table: &Path, step: Option<usize>) -> Result<File, Failure> {
    let named = |reason: &dyn std::fmt::Display| format!("{}: {reason}", table.display());
    let mut file =
        OpenOptions::new().read(true).append(true).create(true).open(table).map_err(|error| named(&error))?;
    file.try_lock().map_err(|_| named(&"another shear writes it"))?;
    let header = shear_header();
    let Some(step) = step else {
        if file.metadata()?.len() > 0 {
            return Err(named(&"exists; give another file with --out, or remove it").into());
        }
        file.write_all(header.as_bytes())?;
        return Ok(file);
    };
    let mut text = String::new();
    file.read_to_string(&mut text).map_err(|error| named(&error))?;
    let start_again = "remove it and the state beside it to start again";
    let rest = text.strip_prefix(&header).ok_or_else(|| named(&format!("is not a table of steps; {start_again}")))?;
    let columns = header.lines().next().map_or(0, |names| names.split(',').count());
    let mut length = header.len();
    let mut rows = rest.split_inclusive('\n');
    for index in 0..=step {
        let row = rows.next().unwrap_or_default();
        let is_whole = row.trim_end().split(',').filter(|cell| cell.parse::<f64>().is_ok()).count() == columns;
        if !(is_whole && row.split(',').next() == Some(index.to_string().as_str()) && row.ends_with('\n')) {
            return Err(named(&format!(
                "has no row of step {index}, but the state beside it is that after step {step}; {start_again}"
            ))
            .into());
        }
        length += row.len();
    }
    file.set_len(length as u64)?;
    Ok(file)
}
