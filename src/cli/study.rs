//! `jamscope study` and `jamscope merge`: an experiment over lists of parameters.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Mutex;
use std::time::Duration;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use jamscope::study::{self, FailureKind, Plan, Problem, Record, RecordOutcome, Shard, Study, StudyProgress, Task};

use crate::{Failure, print, set_threads};

/// What `study` is asked for.
#[derive(Args)]
pub struct StudyArguments {
    /// Study file (TOML).
    study: PathBuf,
    /// Folder of its samples; those that are there already are not run again.
    #[arg(long, value_name = "DIR", default_value = "jamscope-study")]
    out: PathBuf,
    /// Run only part I of N, I from 1 to N; without it, that of the Slurm array task this is, or all.
    #[arg(long, value_name = "I/N", value_parser = parse_shard)]
    shard: Option<Shard>,
    /// Print the plan with its cost, as far as samples in the folder tell, and run nothing.
    #[arg(long)]
    dry_run: bool,
    /// Let the study take the place of another one in the folder; samples of both are kept.
    #[arg(long)]
    replace: bool,
    /// Threads; without it one a core. Never changes a result.
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
}

/// What `merge` is asked for.
#[derive(Args)]
pub struct MergeArguments {
    /// Folder of a study.
    folder: PathBuf,
}

fn parse_shard(text: &str) -> Result<Shard, String> {
    let wrong = || format!("`{text}` is not I/N with I from 1 to N");
    let (index, count) = text.split_once('/').ok_or_else(wrong)?;
    let (index, count): (usize, usize) = (index.parse().map_err(|_| wrong())?, count.parse().map_err(|_| wrong())?);
    if index == 0 || index > count {
        return Err(wrong());
    }
    Ok(Shard { index: index - 1, count })
}

/// The part of a Slurm array task; all where there is none.
fn shard_of_environment() -> Result<Shard, Failure> {
    let number = |name: &str| -> Result<Option<usize>, Failure> {
        match std::env::var(name) {
            Err(_) => Ok(None),
            Ok(text) => Ok(Some(text.parse().map_err(|_| format!("{name} is `{text}`, not a number"))?)),
        }
    };
    let (task, count) = (number("SLURM_ARRAY_TASK_ID")?, number("SLURM_ARRAY_TASK_COUNT")?);
    let Some((task, count)) = task.zip(count) else { return Ok(Shard::default()) };
    let first = number("SLURM_ARRAY_TASK_MIN")?.unwrap_or(0);
    match task.checked_sub(first) {
        Some(index) if index < count => Ok(Shard { index, count }),
        _ => Err(format!("the array has {count} tasks from {first} on in steps of 1, {task} is none of them").into()),
    }
}

fn read_study(path: &Path) -> Result<Study, Failure> {
    let text = std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
    // A scene without samples is the default of a study, but not of a scene.
    let mut table: toml::Table = toml::from_str(&text).map_err(|error| format!("{}: {error}", path.display()))?;
    let scene = table.entry("scene").or_insert_with(|| toml::Value::Table(toml::Table::new()));
    if let Some(scene) = scene.as_table_mut() {
        scene.entry("sample").or_insert_with(|| toml::Value::Array(Vec::new()));
    }
    let study: Study = table.try_into().map_err(|error| format!("{}: {error}", path.display()))?;
    study.check().map_err(|error| format!("{}: {error}", path.display()))?;
    Ok(study)
}

/// Runs the study, or prints its plan.
pub fn run(arguments: &StudyArguments) -> Result<ExitCode, Failure> {
    let study = read_study(&arguments.study)?;
    let shard = match arguments.shard {
        Some(shard) => shard,
        None => shard_of_environment()?,
    };
    let plan = Plan::of(&study)?;
    if arguments.dry_run {
        return print(&cost::text(&plan, &arguments.out, shard));
    }
    set_threads(arguments.threads)?;
    let bar = Bar::new(plan.tasks.iter().filter(|task| shard.has(task.index)).count());
    let executed = study::execute(&study, &arguments.out, shard, arguments.replace, &bar);
    bar.bar.finish_and_clear();
    let done = executed.map_err(|error| error.to_string())?;
    let mut text = format!(
        "{} samples: {} run, {} there before, in {}\n",
        done.sample_count,
        done.run_count,
        done.found_count,
        arguments.out.display()
    );
    text += &failures(&done.failures);
    text += &problems("left alone, of no sample of this study", &done.foreign);
    print(&text)?;
    if done.damaged.is_empty() {
        return Ok(ExitCode::SUCCESS);
    }
    Err(problems("damaged, move them away to have their samples run again", &done.damaged).trim_end().into())
}

/// Merges the folder and prints what is in it.
pub fn merge(arguments: &MergeArguments) -> Result<ExitCode, Failure> {
    let merged = study::merge(&arguments.folder).map_err(|error| error.to_string())?;
    let mut text =
        format!("{} of {} samples in {}\n", merged.record_count, merged.sample_count, arguments.folder.display());
    for statistics in &merged.cells {
        let cell = &statistics.cell;
        let (target, value) = cell.target.name_and_value();
        text += &format!(
            "{} disks, {} {value}, d_0 {}, {}: {} samples",
            cell.disk_count,
            target.replace('_', " "),
            cell.increase,
            cell.relaxer.name(),
            statistics.done_count
        );
        for name in ["pressure_change", "anticorrelation", "correlation_angle_at_0.1", "spectrum_slope"] {
            if let Some(number) = statistics.numbers.get(name) {
                let error = number.standard_error.map_or(String::new(), |error| format!(" ± {error:.2e}"));
                text += &format!(", {} {:.4}{error}", name.replace('_', " "), number.mean);
            }
        }
        text.push('\n');
        text += &failures(&statistics.failures);
    }
    text += &problems("left out, damaged", &merged.damaged);
    text += &problems("left out, of no sample of this study", &merged.foreign);
    for file in &merged.files {
        text += &format!("{}\n", file.display());
    }
    print(&text)
}

fn failures(by_kind: &BTreeMap<FailureKind, usize>) -> String {
    by_kind.iter().map(|(kind, count)| format!("  {count} failed: {}\n", kind.name())).collect()
}

fn problems(what: &str, problems: &[Problem]) -> String {
    if problems.is_empty() {
        return String::new();
    }
    let each = problems.iter().map(|problem| format!("  {}: {}\n", problem.path.display(), problem.reason));
    format!("{} files {what}:\n{}", problems.len(), each.collect::<String>())
}

/// One bar: packings done, samples a minute, failures, time left.
struct Bar {
    bar: ProgressBar,
    counts: Mutex<Counts>,
}

#[derive(Default)]
struct Counts {
    run: usize,
    failures: BTreeMap<FailureKind, usize>,
}

impl Bar {
    fn new(task_count: usize) -> Self {
        let style = ProgressStyle::with_template("{bar:30} {pos}/{len} packings, {elapsed} gone, {eta} left{msg}")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
        let bar = ProgressBar::new(task_count as u64).with_style(style);
        bar.enable_steady_tick(Duration::from_millis(500));
        Bar { bar, counts: Mutex::new(Counts::default()) }
    }
}

impl StudyProgress for Bar {
    fn task(&self, _task: &Task, records: &[Record], seconds: Option<f64>) {
        let Ok(mut counts) = self.counts.lock() else { return };
        for record in records {
            counts.run += usize::from(seconds.is_some());
            if let RecordOutcome::Failed { kind, .. } = record.outcome {
                *counts.failures.entry(kind).or_default() += 1;
            }
        }
        if seconds.is_none() {
            // What was there before says nothing of how long the rest takes.
            self.bar.set_length(self.bar.length().unwrap_or(1).saturating_sub(1));
        } else {
            self.bar.inc(1);
        }
        let minutes = self.bar.elapsed().as_secs_f64() / 60.0;
        let failed: Vec<String> =
            counts.failures.iter().map(|(kind, count)| format!(", {count} failed ({})", kind.name())).collect();
        self.bar.set_message(format!(", {:.1} samples a minute{}", counts.run as f64 / minutes, failed.concat()));
    }
}

/// What a plan costs.
mod cost {
    use super::{Path, Plan, Shard};
    use jamscope::study::measured_seconds;

    /// The plan, cell by cell, with the seconds its finished packings took.
    pub fn text(plan: &Plan, folder: &Path, shard: Shard) -> String {
        let mut text = String::new();
        let (mut left, mut unknown) = (0.0, 0);
        let mut place = 0;
        while place < plan.tasks.len() {
            // Tasks that differ in the seed alone stand together.
            let first = &plan.tasks[place];
            let alike = |other: &&jamscope::study::Task| {
                (other.target, other.scenes[0].law, other.scenes[0].disk_count)
                    == (first.target, first.scenes[0].law, first.scenes[0].disk_count)
            };
            let tasks: Vec<_> = plan.tasks[place..].iter().take_while(alike).collect();
            place += tasks.len();
            let of_shard: Vec<_> = tasks.iter().filter(|task| shard.has(task.index)).collect();
            let seconds: Vec<f64> = of_shard.iter().filter_map(|task| measured_seconds(folder, task)).collect();
            let (target, value) = first.target.name_and_value();
            text += &format!(
                "{} disks, {} {value}: {} packings, {} inflations each",
                first.scenes[0].disk_count,
                target.replace('_', " "),
                of_shard.len(),
                first.scenes.len()
            );
            let missing = of_shard.len() - seconds.len();
            if seconds.is_empty() {
                unknown += missing;
                text += ", none done yet\n";
            } else {
                let mean = seconds.iter().sum::<f64>() / seconds.len() as f64;
                left += mean * missing as f64;
                text += &format!(
                    ", {} done, {mean:.1} s each, {:.0} s left on one thread\n",
                    seconds.len(),
                    mean * missing as f64
                );
            }
        }
        text += &format!(
            "{} packings, {} samples; {left:.0} s on one thread for what is left of cells with a sample",
            plan.tasks.len(),
            plan.sample_count()
        );
        if unknown > 0 {
            text += &format!(", {unknown} packings of other cells: run a few of each to know");
        }
        text + "\n"
    }
}
