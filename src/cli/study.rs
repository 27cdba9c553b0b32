//! `jamscope study` and `jamscope merge`: an experiment over lists of parameters.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use jamscope::relax::RelaxerChoice;
use jamscope::scene::{ProtocolChoice, relaxer_by_name};
use jamscope::study::{self, FailureKind, Merged, Plan, Problem, Recipe, Scale, Shard, Study};

use crate::scene_file::refuse_cut;
use crate::study_progress::Bar;
use crate::threads::set_threads;
use crate::{Failure, print};

/// Arguments of `study`.
#[derive(Args)]
pub struct StudyArguments {
    /// Study file (TOML).
    #[arg(conflicts_with = "recipe")]
    study: Option<PathBuf>,
    /// Run the study of a published figure, instead of a study file.
    #[arg(long, value_name = "NAME", value_parser = recipes())]
    recipe: Option<Recipe>,
    /// Size of a recipe: minutes on two cores, a night on two cores, or the published sizes and 400 samples.
    #[arg(long, value_parser = scales(), default_value = "small", requires = "recipe")]
    scale: Scale,
    /// How the packings of a recipe are relaxed after the inflation; several names with commas use the same packings.
    #[arg(long, value_name = "NAME", value_parser = protocols(), value_delimiter = ',', default_value = ProtocolChoice::default().name(), requires = "recipe")]
    protocol: Vec<ProtocolChoice>,
    /// Relaxer of a recipe with its default settings, instead of a protocol.
    #[arg(long, value_name = "NAME", value_parser = relaxer, requires = "recipe", conflicts_with = "protocol")]
    relaxer: Option<RelaxerChoice>,
    /// Number of packings for each size and pressure of a recipe, instead of that of its scale.
    #[arg(long, value_name = "N", requires = "recipe")]
    seeds: Option<usize>,
    /// Print the study as a study file (TOML) and run nothing.
    #[arg(long)]
    print: bool,
    /// Folder of the samples; existing samples are not run again.
    #[arg(long, value_name = "DIR", default_value = "jamscope-study")]
    out: PathBuf,
    /// Run only part I of N, with I from 1 to N; by default the part of the Slurm array task, or all.
    #[arg(long, value_name = "I/N", value_parser = parse_shard)]
    shard: Option<Shard>,
    /// Print the plan with its cost, estimated from existing samples if there are any, and run nothing.
    #[arg(long)]
    dry_run: bool,
    /// Replace another study in the folder; the samples of both are kept.
    #[arg(long)]
    replace: bool,
    /// Number of threads; by default one per core. Changes no result.
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
}

/// Arguments of `merge`.
#[derive(Args)]
pub struct MergeArguments {
    /// Folder of a study.
    folder: PathBuf,
}

/// The recipes by their names.
fn recipes() -> impl TypedValueParser<Value = Recipe> {
    let names = PossibleValuesParser::new(Recipe::ALL.map(|it| PossibleValue::new(it.name()).help(it.title())));
    names.try_map(|name| Recipe::ALL.into_iter().find(|it| it.name() == name).ok_or("no recipe of this name"))
}

/// The protocols by their names.
fn protocols() -> impl TypedValueParser<Value = ProtocolChoice> {
    let names = ProtocolChoice::ALL.map(|it| PossibleValue::new(it.name()).help(it.title()));
    PossibleValuesParser::new(names)
        .try_map(|name| ProtocolChoice::ALL.into_iter().find(|it| it.name() == name).ok_or("no protocol of this name"))
}

/// A relaxer by the name it has in a scene.
fn relaxer(name: &str) -> Result<RelaxerChoice, String> {
    relaxer_by_name(name).map_err(|error| error.message)
}

/// The scales by their names.
fn scales() -> impl TypedValueParser<Value = Scale> {
    let names = PossibleValuesParser::new(Scale::ALL.map(Scale::name));
    names.try_map(|name| Scale::ALL.into_iter().find(|it| it.name() == name).ok_or("no scale of this name"))
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

/// The part of a Slurm array task; the whole study otherwise.
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
        _ => {
            Err(format!("SLURM_ARRAY_TASK_ID is {task}, but the array has {count} tasks from {first} on in steps of 1")
                .into())
        }
    }
}

fn read_study(path: &Path) -> Result<Study, Failure> {
    let text = std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
    if text.trim().is_empty() {
        let how = "`jamscope study --recipe NAME --print` prints a study";
        return Err(format!("{}: the file is empty; {how}", path.display()).into());
    }
    let study = Study::from_toml(&text).map_err(|error| format!("{}: {error}", path.display()))?;
    study.check().map_err(|error| format!("{}: {error}", path.display()))?;
    refuse_cut(&text).map_err(|message| format!("{}: {message}", path.display()))?;
    Ok(study)
}

/// Runs the study, or prints its plan.
///
/// If all samples exist at the end, as after a run of all parts, the study is also merged.
pub fn run(arguments: &StudyArguments) -> Result<ExitCode, Failure> {
    let study = match (&arguments.study, arguments.recipe) {
        (Some(path), _) => read_study(path)?,
        (None, Some(recipe)) => {
            let by_protocol = || arguments.protocol.iter().map(|protocol| protocol.relaxer()).collect();
            let relaxers = arguments.relaxer.map_or_else(by_protocol, |relaxer| vec![relaxer]);
            let mut study = recipe.study_by(arguments.scale, relaxers);
            if let Some(count) = arguments.seeds {
                study.set_seed_count(count);
            }
            study.check()?;
            study
        }
        (None, None) => {
            let names = Recipe::ALL.map(Recipe::name).join(", ");
            return Err(format!("a study file is needed, or --recipe with one of {names}").into());
        }
    };
    if arguments.print {
        return print(&study.to_toml()?);
    }
    let shard = match arguments.shard {
        Some(shard) => shard,
        None => shard_of_environment()?,
    };
    let plan = Plan::of(&study)?;
    if arguments.dry_run {
        return print(&cost::text(&plan, &arguments.out, shard));
    }
    set_threads(arguments.threads)?;
    if let Some(recipe) = arguments.recipe {
        let by_protocol = || arguments.protocol.iter().map(|protocol| protocol.title()).collect::<Vec<_>>().join("; ");
        let by = arguments.relaxer.map_or_else(by_protocol, |relaxer| relaxer.name().to_string());
        let cost = cost::summary(&plan, &arguments.out, shard);
        print(&format!("{}: {}\nrelaxed by {by}\n{cost}", recipe.name(), recipe.title()))?;
    }
    let bar = Bar::new(plan.tasks.iter().filter(|task| shard.has(task.index)).count());
    let executed = match shard == Shard::default() {
        true => study::execute_and_merge(&study, &arguments.out, arguments.replace, &bar)
            .map(|whole| (whole.execution, whole.merged, Some(whole.lock)))
            .map_err(|error| error.to_string()),
        false => study::execute(&study, &arguments.out, shard, arguments.replace, &bar)
            .map(|execution| (execution, None, None))
            .map_err(|error| error.to_string()),
    };
    bar.clear();
    // The lock is held until the report is written, so that the report is of this study.
    let (done, merged, _lock) = executed?;
    let mut text = format!(
        "{} samples: {} run, {} already present, in {}\n",
        done.sample_count,
        done.run_count,
        done.found_count,
        arguments.out.display()
    );
    text += &failures(&done.failures);
    text += &problems("were not changed, because they belong to no sample of this study", &done.foreign);
    print(&text)?;
    if !done.damaged.is_empty() {
        return Err(problems("are damaged; move them away to run their samples again", &done.damaged)
            .trim_end()
            .into());
    }
    match merged {
        Some(merged) => print(&results(&merged, &arguments.out)?),
        None => Ok(ExitCode::SUCCESS),
    }
}

/// Merges the folder and prints the results.
pub fn merge(arguments: &MergeArguments) -> Result<ExitCode, Failure> {
    let merged = study::merge(&arguments.folder).map_err(|error| error.to_string())?;
    print(&results(&merged, &arguments.folder)?)
}

/// Writes the report of a merged study; returns a text on the results and the files.
fn results(merged: &Merged, folder: &Path) -> Result<String, Failure> {
    let mut text = format!("{} of {} samples in {}\n", merged.record_count, merged.sample_count, folder.display());
    if let Some(mixed) = merged.mixed_vectors() {
        text += &format!("{mixed}\n");
    }
    for statistics in &merged.cells {
        let cell = &statistics.cell;
        let (target, value) = cell.target.name_and_value();
        text += &format!(
            "{} {}, {} {value}, d_0 {}, {}: {} samples",
            cell.disk_count,
            cell.particles(),
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
    text += &problems("were left out, because they are damaged", &merged.damaged);
    text += &problems("were left out, because they belong to no sample of this study", &merged.foreign);
    let mut files = merged.files.clone();
    #[cfg(feature = "fit")]
    {
        let transition = jamscope::transition::Transition::of(merged);
        text += &transition::text(&transition);
        files.extend(jamscope::report::write_study(merged, &transition, folder).map_err(|error| error.to_string())?);
    }
    #[cfg(not(feature = "fit"))]
    let _ = &mut files;
    for file in &files {
        text += &format!("{}\n", file.display());
    }
    Ok(text)
}

/// The results of a study on the transition.
#[cfg(feature = "fit")]
mod transition {
    use jamscope::transition::{Comparison, Transition, TransitionPressure};

    /// p̂_c of every series, and every number with the published one.
    pub fn text(transition: &Transition) -> String {
        let mut text = String::new();
        for series in &transition.series {
            for estimate in &series.estimates {
                text +=
                    &format!("{}: p̂_c by {} {}\n", series.name(), estimate.method.name(), pressure(estimate.pressure));
            }
        }
        transition.comparisons.iter().for_each(|one| text += &line(one));
        text
    }

    fn pressure(found: TransitionPressure) -> String {
        match found {
            TransitionPressure::Above(highest) => format!("above {highest:.2e}"),
            TransitionPressure::Below(lowest) => format!("below {lowest:.2e}"),
            TransitionPressure::Unordered => "no single transition".into(),
            TransitionPressure::Uninformative { reason } => format!("cannot tell: {}", reason.words()),
            found => {
                let ends = found.interval().map_or(String::new(), |[low, high]| format!(" ({low:.2e} to {high:.2e})"));
                found.best().map_or("none".into(), |best| format!("{best:.2e}{ends}"))
            }
        }
    }

    fn line(one: &Comparison) -> String {
        let value = one.value.map_or("only a bound".into(), number);
        let ends = one.interval.map_or(String::new(), |[low, high]| format!(" ({} to {})", number(low), number(high)));
        let published = number(one.published);
        let reason = one.reason.map_or(String::new(), |reason| format!(", {}", reason.words()));
        format!("{}, {}: {value}{ends}, published {published}: {}{reason}\n", one.quantity, one.of, one.verdict.name())
    }

    /// Four digits.
    fn number(value: f64) -> String {
        if (1e-3..1e5).contains(&value.abs()) { format!("{value:.4}") } else { format!("{value:.3e}") }
    }
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

/// The cost of a plan.
mod cost {
    use jamscope::packing::particles;
    use jamscope::study::Task;

    use super::{Path, Plan, Shard};
    use jamscope::study::measured_seconds;

    /// The plan, cell by cell, with the times of finished packings or else the expected times.
    pub fn text(plan: &Plan, folder: &Path, shard: Shard) -> String {
        let mut text = String::new();
        for cell in cells(plan, folder, shard) {
            let first = cell.first;
            let (target, value) = first.target.name_and_value();
            text += &format!(
                "{} {} {}, {} {value}: {} packings, {} inflations each, {} done, {} each {}, {} left on one core\n",
                first.law.name(),
                first.disk_count,
                particles(first.dimension()),
                target.replace('_', " "),
                cell.count,
                first.scene_count(),
                cell.done,
                words(cell.each),
                if cell.done > 0 { "measured" } else { "expected" },
                words(cell.left()),
            );
        }
        text + &summary(plan, folder, shard)
    }

    /// The remaining work, in a line.
    pub fn summary(plan: &Plan, folder: &Path, shard: Shard) -> String {
        let cells = cells(plan, folder, shard);
        let left: f64 = cells.iter().map(Cell::left).sum();
        let done: usize = cells.iter().map(|cell| cell.done).sum();
        let count: usize = cells.iter().map(|cell| cell.count).sum();
        format!(
            "{} packings, {} samples in the plan; {done} of {count} packings done; about {} left on one core\n",
            plan.tasks.len(),
            plan.sample_count(),
            words(left)
        )
    }

    /// Packings that differ only in the seed.
    struct Cell<'a> {
        first: &'a Task,
        /// Number of packings in the requested part.
        count: usize,
        done: usize,
        /// Time of one packing \[s\].
        each: f64,
    }

    impl Cell<'_> {
        fn left(&self) -> f64 {
            self.each * (self.count - self.done) as f64
        }
    }

    fn cells<'a>(plan: &'a Plan, folder: &Path, shard: Shard) -> Vec<Cell<'a>> {
        let alike = |a: &Task, b: &Task| {
            let of = |task: &Task| (task.law, task.disk_count, task.boundary());
            a.target == b.target && of(a) == of(b)
        };
        // A file name is a hash of a scene: without any samples none is computed.
        let samples = folder.join("samples").is_dir();
        let measured = |task: &&Task| if samples { measured_seconds(folder, task) } else { None };
        let cell = |tasks: &'a [Task]| {
            let own: Vec<&Task> = tasks.iter().filter(|task| shard.has(task.index)).collect();
            let seconds: Vec<f64> = own.iter().filter_map(measured).collect();
            let each = match seconds.len() {
                0 => tasks[0].expected_seconds(),
                done => seconds.iter().sum::<f64>() / done as f64,
            };
            Cell { first: &tasks[0], count: own.len(), done: seconds.len(), each }
        };
        plan.tasks.chunk_by(alike).map(cell).collect()
    }

    /// A time in a suitable unit.
    fn words(seconds: f64) -> String {
        match seconds {
            s if s > 0.0 && s < 1.0 => format!("{s:.2} s"),
            s if s < 120.0 => format!("{s:.0} s"),
            s if s < 7200.0 => format!("{:.0} min", s / 60.0),
            s => format!("{:.1} h", s / 3600.0),
        }
    }
}
