//! `jamscope precision`: error against cost, with one bar of progress.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use jamscope::precision::table::terminal_table;
use jamscope::precision::{PrecisionSettings, Progress, measure, write_into};
use jamscope::report::{Kind, OutputFolder};

use crate::{Failure, print, sample_of_file, scene_of, threads};

#[derive(Args)]
pub struct PrecisionArguments {
    /// Scene file (TOML); by default the built-in scene.
    scene: Option<PathBuf>,
    /// Run only the sample with this name.
    #[arg(long, value_name = "NAME", conflicts_with = "packing")]
    sample: Option<String>,
    /// Use this packing (extended XYZ, LAMMPS data or dump, NumPy archive) instead of the samples of the scene.
    #[arg(long, value_name = "FILE")]
    packing: Option<PathBuf>,
    /// Dimension of the packing, if there is no scene file; 2 by default.
    #[arg(long, value_name = "D", value_parser = clap::value_parser!(u8).range(2..=3))]
    dimension: Option<u8>,
    /// Folder for the tables, the plots and the page.
    #[arg(long, value_name = "DIR", default_value = "precision")]
    out: PathBuf,
    /// Step limit of relaxers with one or two force evaluations per step.
    #[arg(long, value_name = "N", default_value_t = PrecisionSettings::default().explicit_step_limit)]
    steps: usize,
}

/// Measures, prints the table and writes the files.
pub fn run(arguments: &PrecisionArguments) -> Result<ExitCode, Failure> {
    let mut scene = scene_of(arguments.scene.as_deref(), arguments.dimension)?;
    if let Some(path) = &arguments.packing {
        scene.sample = vec![sample_of_file(path, &scene)];
    }
    if let Some(name) = &arguments.sample {
        let known: Vec<String> = scene.sample.iter().map(|sample| format!("\"{}\"", sample.name)).collect();
        scene.sample.retain(|sample| sample.name == *name);
        if scene.sample.is_empty() {
            return Err(format!("--sample {name}: the scene has {}", known.join(", ")).into());
        }
    }
    if arguments.steps == 0 {
        return Err("--steps 0: at least one step is needed".into());
    }
    threads::set_threads(None)?;
    let settings = PrecisionSettings { explicit_step_limit: arguments.steps, ..PrecisionSettings::default() };
    let output = OutputFolder::open(&arguments.out, Kind::Precision)?;
    output.try_samples("sample.name", scene.sample.iter().map(|sample| sample.name.as_str()))?;
    let bar = Bar::new();
    let measured = measure(&scene, &settings, &bar);
    bar.0.finish_and_clear();
    let report = measured?;
    print(&terminal_table(&report))?;
    let files = write_into(&report, output)?;
    let page = files.iter().find(|file| file.extension().is_some_and(|extension| extension == "html"));
    let shown = page.unwrap_or(&arguments.out);
    print(&format!("{} files in {}, start from {}\n", files.len(), arguments.out.display(), shown.display()))
}

/// One bar for the runs of a sample, on the standard error stream; indicatif hides it if that is not a terminal.
struct Bar(ProgressBar);

impl Bar {
    fn new() -> Self {
        let style = ProgressStyle::with_template("{prefix:>14} {bar:30} {pos}/{len} {elapsed} {msg}")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
        let bar = ProgressBar::new(1).with_style(style).with_prefix("packings").with_message("preparation");
        // A run of dynamics may take a minute: the elapsed time shows that it works.
        bar.enable_steady_tick(Duration::from_millis(250));
        Bar(bar)
    }
}

impl Progress for Bar {
    fn sample(&self, name: &str, run_count: usize) {
        self.0.set_prefix(name.to_string());
        self.0.set_length(run_count as u64);
    }

    fn begins(&self, done: usize, what: &str) {
        self.0.set_position(done as u64);
        self.0.set_message(what.to_string());
    }
}
