//! The command line of jamscope: parses, calls the library, prints.

#[path = "cli/analyse.rs"]
mod analyse;
#[path = "cli/contact_law.rs"]
mod contact_law;
#[path = "cli/exact/mod.rs"]
mod exact;
#[path = "cli/exit_code.rs"]
mod exit_code;
#[path = "cli/file_arguments.rs"]
mod file_arguments;
#[path = "cli/input.rs"]
mod input;
#[cfg(feature = "linear")]
#[path = "cli/precision.rs"]
mod precision;
#[path = "cli/progress.rs"]
mod progress;
#[path = "cli/relax.rs"]
mod relax;
#[path = "cli/scene_file.rs"]
mod scene_file;
#[path = "cli/strain.rs"]
mod strain;
#[path = "cli/study.rs"]
mod study;
#[path = "cli/study_progress.rs"]
mod study_progress;
#[path = "cli/threads.rs"]
mod threads;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand};
#[cfg(feature = "linear")]
use jamscope::inspection::Vibrations;
use jamscope::inspection::{Inspection, inspect};
use jamscope::io::{Column, Frame, ReadWarning, properties_of_frame, read_contents};
use jamscope::law::LawChoice;
use jamscope::network::ContactNetwork;
use jamscope::packing::Packing;
use jamscope::read_packing;
use jamscope::relax::RelaxerChoice;
use jamscope::report;
use jamscope::run::{SampleOutcome, run};
use jamscope::scene::{ProtocolChoice, Sample, Scene, Source};
use jamscope::verdict::{AboveLimit, Decision, VerdictSettings};

use contact_law::LawName;

/// The mechanics of jammed packings: prepare, inflate, relax, and compare the response with exact solutions.
///
/// Without a command, jamscope runs the built-in scene, which shows the three phases.
#[derive(Parser)]
#[command(version, about, after_help = exit_code::HELP)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// Run a scene and write its report.
    Run(RunArguments),
    /// Print a scene with all defaults and a comment on every field.
    Scene,
    /// Print the properties of a packing file: certificate, energy, stress, contacts, forces, elastic moduli, modes.
    Inspect(InspectArguments),
    /// Bring a packing file to rest and write it with the results of each disk.
    Relax(relax::RelaxArguments),
    /// Compress or decompress a packing file to a pressure or a packing fraction.
    Compress(relax::CompressArguments),
    /// Shear a packing file in small steps, each relaxed to rest: stress against strain, and plastic events.
    Strain(strain::StrainArguments),
    /// Measure the observables of states that another program relaxed, before and after an inflation.
    Analyse(analyse::AnalyseArguments),
    /// Run an experiment over sizes, pressures, inflations, laws and seeds; an interrupted study continues.
    Study(study::StudyArguments),
    /// Merge the samples of a study and compute statistics.
    Merge(study::MergeArguments),
    /// Print an exact solution as a table with 17 significant digits.
    Exact(exact::ExactArguments),
    /// Measure error and cost of every relaxer, from the same inflated packing, at several settings.
    #[cfg(feature = "linear")]
    Precision(precision::PrecisionArguments),
}

#[derive(Args, Default)]
struct RunArguments {
    /// Scene file (TOML); by default the built-in scene.
    scene: Option<PathBuf>,
    /// Use this packing (extended XYZ, LAMMPS data or dump, NumPy archive; `-` is the standard input) instead of the samples of the scene.
    #[arg(long, value_name = "FILE")]
    packing: Option<PathBuf>,
    /// Dimension of the packing, if there is no scene file; 2 by default.
    #[arg(long, value_name = "D", value_parser = clap::value_parser!(u8).range(2..=3))]
    dimension: Option<u8>,
    /// Folder for the report.
    #[arg(long, value_name = "DIR", default_value = "jamscope-report")]
    out: PathBuf,
    /// Seed of every sample, instead of the seeds in the scene.
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Number of threads; by default one per core. Changes no result.
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Report a phase and fits, and exit with code 0, even if a state is not at rest.
    #[arg(long)]
    not_at_rest: bool,
}

#[derive(Args)]
struct InspectArguments {
    /// Packing file: extended XYZ, LAMMPS data or dump, possibly compressed by gzip or zstd, or a NumPy archive; `-` is the standard input.
    packing: PathBuf,
    /// Frame of a file with several: `last`, `all` or its number, from 0.
    #[arg(long, value_name = "FRAME", default_value = "last", value_parser = input::frames)]
    frame: input::Frames,
    /// Contact law if the file gives none: `hertzian`, `hookean` or `power:ALPHA`; by default Hertzian.
    #[arg(long, value_name = "LAW", value_parser = contact_law::parse)]
    law: Option<LawName>,
    /// Stiffness k' (Hertzian, Hookean) or energy scale (power law) if the file gives none; by default 2e5, and 1 for the
    /// power law.
    #[arg(long, value_name = "K")]
    stiffness: Option<f64>,
    /// Dimension of the packing.
    #[arg(long, value_name = "D", default_value_t = 2, value_parser = clap::value_parser!(u8).range(2..=3))]
    dimension: u8,
    /// Exit with code 0 even if the packing is not at rest.
    #[arg(long)]
    not_at_rest: bool,
    /// Print JSON, with every number in full precision.
    #[arg(long)]
    json: bool,
    /// Write the packing with the results of each disk to this file: extended XYZ, or a NumPy archive if its name ends in .npz.
    #[arg(long, value_name = "FILE")]
    write: Option<PathBuf>,
    /// Number of vibrational modes to compute, from the lowest; `--write` adds their vectors as columns.
    #[cfg(feature = "linear")]
    #[arg(long, value_name = "K", default_value_t = 0)]
    modes: usize,
}

type Failure = Box<dyn std::error::Error>;

fn main() -> ExitCode {
    let command = Cli::parse().command;
    let result = threads::check_environment().and_then(|()| run_command(command));
    result.unwrap_or_else(|error| {
        // The standard error stream may be closed: the exit code contains the same information.
        let _ = writeln!(std::io::stderr(), "jamscope: {error}");
        ExitCode::FAILURE
    })
}

fn run_command(command: Option<Command>) -> Result<ExitCode, Failure> {
    match command {
        None => run_scene(&RunArguments { out: "jamscope-report".into(), ..RunArguments::default() }),
        Some(Command::Run(arguments)) => run_scene(&arguments),
        Some(Command::Scene) => print(&scene_file::commented_scene()),
        Some(Command::Inspect(arguments)) => inspect_packing(&arguments),
        Some(Command::Relax(arguments)) => relax::relax(&arguments),
        Some(Command::Compress(arguments)) => relax::compress_file(&arguments),
        Some(Command::Strain(arguments)) => strain::run(&arguments),
        Some(Command::Analyse(arguments)) => analyse::run(&arguments),
        Some(Command::Study(arguments)) => study::run(&arguments),
        Some(Command::Merge(arguments)) => study::merge(&arguments),
        Some(Command::Exact(arguments)) => exact::print(&arguments).map(|()| ExitCode::SUCCESS),
        #[cfg(feature = "linear")]
        Some(Command::Precision(arguments)) => precision::run(&arguments),
    }
}

fn run_scene(arguments: &RunArguments) -> Result<ExitCode, Failure> {
    let mut inputs = input::Inputs::default();
    let result = run_with(arguments, &mut inputs);
    inputs.named(result)
}

fn run_with(arguments: &RunArguments, inputs: &mut input::Inputs) -> Result<ExitCode, Failure> {
    let mut scene = scene_of(arguments.scene.as_deref(), arguments.dimension)?;
    if let Some(path) = &arguments.packing {
        let path = inputs.file(path)?;
        scene.sample = vec![sample_of_file(&path, &scene)];
        scene.law = law_of_run(&path, arguments.scene.is_some().then_some(&scene.law))?;
        // A file that cannot be read is reported by the run.
        let unit = match scene.dimension {
            3 => read_packing::<3>(&path).ok().map(|packing| unit_of(&packing)),
            _ => read_packing::<2>(&path).ok().map(|packing| unit_of(&packing)),
        };
        if let Some(unit) = unit.filter(|_| arguments.scene.is_none()) {
            scene.observables = scene.observables.in_units(unit);
            scene.inflation.increase *= unit;
        }
    }
    if let Some(seed) = arguments.seed {
        scene.sample.iter_mut().for_each(|sample| sample.seed = seed);
    }
    override_limit(&mut scene.verdict, arguments.not_at_rest);
    threads::set_threads(arguments.threads)?;
    let output = report::OutputFolder::open(&arguments.out, report::Kind::Report)?;
    output.try_samples("sample.name", scene.sample.iter().map(|sample| sample.name.as_str()))?;
    let bars = progress::Bars::new(scene.sample.iter().map(|sample| sample.name.as_str()));
    let report = run(&scene, &bars)?;
    print(&inputs.with_given_names(report::table::terminal_table(&report)))?;
    let files = report::write_into(&report, output)?;
    let page = files.iter().find(|file| file.extension().is_some_and(|extension| extension == "html"));
    let shown = page.unwrap_or(&arguments.out);
    print(&format!("\n{} files in {}, start from {}\n", files.len(), arguments.out.display(), shown.display()))?;
    let failed = report.samples.iter().filter(|sample| matches!(sample.result, SampleOutcome::Failed(_))).count();
    if failed == 0 {
        let not_at_rest = report.samples.iter().filter(|sample| is_refused(&sample.result));
        return Ok(exit_code::of_states(&not_at_rest.map(|sample| sample.name.clone()).collect::<Vec<_>>()));
    }
    let scene_name = arguments.scene.as_ref().map_or("the built-in scene".into(), |path| path.display().to_string());
    Err(format!("{scene_name}: {failed} of {} samples failed, see above", report.samples.len()).into())
}

/// The scene of a file, or the built-in one of a dimension; the file must agree with a given dimension.
fn scene_of(path: Option<&Path>, dimension: Option<u8>) -> Result<Scene, Failure> {
    let scene = match path {
        Some(path) => scene_file::read_scene(path)?,
        None => Scene::in_dimension(usize::from(dimension.unwrap_or(2))),
    };
    match dimension.filter(|&it| usize::from(it) != scene.dimension) {
        Some(dimension) => {
            Err(format!("--dimension {dimension}: the scene has dimension = {}", scene.dimension).into())
        }
        None => Ok(scene),
    }
}

/// The law of `--packing`: that of the file, which must be that of the scene, if there is one and the file gives a law.
fn law_of_run(path: &Path, of_scene: Option<&LawChoice>) -> Result<LawChoice, Failure> {
    // A file that cannot be read is reported by the run.
    if properties_of_frame(path, Frame::Last).is_err() {
        return Ok(of_scene.copied().unwrap_or_default());
    }
    let parts = of_scene.map(|law| match law {
        LawChoice::Hertzian(law) => (LawName::Hertzian, law.stiffness),
        LawChoice::Hookean(law) => (LawName::Hookean, law.stiffness),
        LawChoice::PowerLaw(law) => (LawName::Power(law.exponent), law.energy_scale),
    });
    let (name, stiffness) = parts.unzip();
    contact_law::law_of(path, Frame::Last, name, stiffness)
}

/// The unit of lengths that are not given: the diameter of a small disk of the packing, 1 in the units of the defaults.
fn unit_of<const D: usize>(packing: &Packing<D>) -> f64 {
    2.0 * packing.radii().iter().copied().fold(f64::INFINITY, f64::min)
}

/// With the flag `--not-at-rest` a phase and fits are reported for any residual.
fn override_limit(settings: &mut VerdictSettings, given: bool) {
    if given {
        settings.above_limit = AboveLimit::Given;
    }
}

/// Whether a sample has no phase because a state of it is not at rest.
fn is_refused(result: &SampleOutcome) -> bool {
    match result {
        SampleOutcome::Done(result) => result.response.verdict.decision() == Decision::NotAtRest,
        SampleOutcome::Failed(_) => false,
    }
}

/// The sample of `--packing`: the file, relaxed after the inflation like the first sample of the scene on the same side of jamming.
fn sample_of_file(path: &Path, scene: &Scene) -> Sample {
    let stem: String = path
        .file_stem()
        .map(|stem| stem.to_string_lossy().into_owned())
        .unwrap_or_default()
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '_' })
        .collect();
    let name = if stem.starts_with(|c: char| c.is_ascii_alphanumeric()) { stem } else { format!("packing{stem}") };
    let seed = scene.sample.first().map_or(1, |first| first.seed);
    Sample { name, seed, source: Source::File(path.to_path_buf()), relaxer: relaxer_of_file(path, scene) }
}

/// What the scene relaxes packings with that are as dense as this one; the default protocol, if it has none of them.
fn relaxer_of_file(path: &Path, scene: &Scene) -> RelaxerChoice {
    // A file that cannot be read is reported by the run.
    let fraction = match scene.dimension {
        3 => read_packing::<3>(path).ok().and_then(|packing| packing.packing_fraction()),
        _ => read_packing::<2>(path).ok().and_then(|packing| packing.packing_fraction()),
    };
    let own = Source::PackingFraction(fraction.unwrap_or(1.0));
    let alike = scene
        .sample
        .iter()
        .find(|sample| sample.source.is_below_jamming(scene.dimension) == own.is_below_jamming(scene.dimension));
    alike.map_or_else(|| ProtocolChoice::default().relaxer_in(scene.dimension, &own), |sample| sample.relaxer)
}

fn inspect_packing(arguments: &InspectArguments) -> Result<ExitCode, Failure> {
    let mut inputs = input::Inputs::default();
    let path = inputs.file(&arguments.packing)?;
    inputs.named(inspect_file(arguments, &path))
}

fn inspect_file(arguments: &InspectArguments, path: &Path) -> Result<ExitCode, Failure> {
    #[cfg(feature = "linear")]
    let mode_count = arguments.modes;
    #[cfg(not(feature = "linear"))]
    let mode_count = 0;
    let mut settings = VerdictSettings::default();
    override_limit(&mut settings, arguments.not_at_rest);
    let dimension = usize::from(arguments.dimension);
    let frames = arguments.frame.of(path)?;
    if let Some(out) = &arguments.write {
        if frames.len() > 1 {
            return Err("--write FILE takes one frame".into());
        }
        input::check_output(out, path)?;
    }
    let (mut documents, mut refused) = (Vec::new(), Vec::new());
    let mut last = None;
    for &frame in &frames {
        let law = contact_law::law_of(path, frame, arguments.law, arguments.stiffness)?;
        let inspection = inspect(path, frame, law, dimension, mode_count, &settings)?;
        warn(&arguments.packing, &inspection.warnings);
        let name = match frame {
            Frame::Index(frame) => format!("{}, frame {frame}", arguments.packing.display()),
            Frame::Last => arguments.packing.display().to_string(),
        };
        if arguments.json {
            documents.push(inspection.to_json()?);
        } else if frames.len() > 1 {
            print(&format!("{name}\n{inspection}\n"))?;
        } else {
            print(&inspection.to_string())?;
        }
        if inspection.verdict.decision() == Decision::NotAtRest {
            refused.push(name);
        }
        last = Some((frame, inspection));
    }
    if let (Some(out), Some((frame, inspection))) = (&arguments.write, &last) {
        match dimension {
            3 => write_inspected::<3>(path, *frame, inspection, out)?,
            _ => write_inspected::<2>(path, *frame, inspection, out)?,
        }
    }
    match (arguments.json, arguments.frame) {
        (true, input::Frames::All) => print(&format!("[{}]\n", documents.join(",\n")))?,
        (true, input::Frames::One(_)) => print(&format!("{}\n", documents.join("")))?,
        (false, _) => ExitCode::SUCCESS,
    };
    Ok(exit_code::of_states(&refused))
}

/// Writes a packing with the results of each disk.
fn write_inspected<const D: usize>(
    path: &Path,
    frame: Frame,
    inspection: &Inspection,
    out: &Path,
) -> Result<(), Failure> {
    let contents = read_contents::<D>(path, frame)?;
    let network = ContactNetwork::new(&contents.packing, &inspection.law)?;
    #[cfg(feature = "linear")]
    let modes = inspection.modes.as_ref().map(Vibrations::columns).unwrap_or_default();
    #[cfg(not(feature = "linear"))]
    let modes: Vec<(String, &[f64])> = Vec::new();
    let modes: Vec<Column> = modes.iter().map(|(name, values)| Column { name, width: D, values }).collect();
    Ok(report::write_state(out, &contents.packing, (&network, &inspection.law), &modes, &contents.properties)?)
}

/// Prints warnings about a file to the standard error stream.
fn warn(path: &Path, warnings: &[ReadWarning]) {
    for warning in warnings {
        // The standard error stream may be closed.
        let _ = writeln!(std::io::stderr(), "jamscope: warning: {}, {warning}", path.display());
    }
}

/// Prints to the standard output; a closed pipe (`| head`) is not an error.
fn print(text: &str) -> Result<ExitCode, Failure> {
    match std::io::stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(ExitCode::SUCCESS),
    }
}
