//! `jamscope analyse`: the observables of states relaxed by another program.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use jamscope::analysis::{Analysis, Pair, PairSettings};
use jamscope::io::{Contents, Frame, properties_of_frame, read_contents};
use jamscope::packing::Packing;
use jamscope::report;
use jamscope::scene::{Observables, Scene};
use jamscope::verdict::{Decision, VerdictSettings};

use crate::contact_law::{self, LawName};
use crate::{Failure, exit_code, input, override_limit, print, scene_file, unit_of, warn};

/// Arguments of `analyse`.
#[derive(Args)]
pub struct AnalyseArguments {
    /// A folder with pairs NAME.before.* and NAME.after.* (or NAME.displacement.*, as written by `run`) and optional files
    /// NAME.deflated.*; or the file before, the file after and, optionally, the file after the deflation; or one file, with
    /// --frames.
    #[arg(required = true, num_args = 1..=3, value_name = "DIR | BEFORE AFTER [DEFLATED]")]
    states: Vec<PathBuf>,
    /// Frames of one file that are the states before, after and, optionally, after the deflation: numbers from 0, or `last`.
    #[arg(long, value_name = "A,B[,C]", value_delimiter = ',', num_args = 1, value_parser = input::frame)]
    frames: Option<Vec<Frame>>,
    /// Dimension of the packings, 2 or 3; by default that of the files, or 2 if they give none.
    #[arg(long, value_name = "D", value_parser = clap::value_parser!(u8).range(2..=3))]
    dimension: Option<u8>,
    /// Label of the inflated disk; by default the disk whose radius changed.
    #[arg(long, value_name = "LABEL")]
    centre: Option<u64>,
    /// Radius R beyond which disks are held, as a length or over the shortest side of the box (0.48L); by default that of the
    /// file, or the distance of the nearest held disk, or half the box.
    #[arg(long, value_name = "R", value_parser = outer_radius)]
    outer_radius: Option<OuterRadius>,
    /// Contact law if the files give none: `hertzian`, `hookean` or `power:ALPHA`; by default Hertzian.
    #[arg(long, value_name = "LAW", value_parser = contact_law::parse)]
    law: Option<LawName>,
    /// Stiffness k' (Hertzian, Hookean) or energy scale (power law) if the files give none.
    #[arg(long, value_name = "K")]
    stiffness: Option<f64>,
    /// Scene file (TOML) that selects the observables and the residual limit; by default all observables.
    #[arg(long, value_name = "SCENE")]
    scene: Option<PathBuf>,
    /// Report a phase and fits, and exit with code 0, even if a state is not at rest.
    #[arg(long)]
    not_at_rest: bool,
    /// Write the state after with the response of each disk (displacement, its radial, linear and plastic parts) to this file: extended
    /// XYZ, or a NumPy archive if its name ends in .npz.
    #[arg(long, value_name = "FILE")]
    write: Option<PathBuf>,
    /// Folder for the results.
    #[arg(long, value_name = "DIR", default_value = "jamscope-analysis")]
    out: PathBuf,
}

/// R on the command line.
#[derive(Debug, Clone, Copy)]
enum OuterRadius {
    /// A length.
    Length(f64),
    /// Over the shortest side of the box.
    OverSide(f64),
}

impl OuterRadius {
    fn in_box<const D: usize>(self, packing: &Packing<D>) -> Result<f64, Failure> {
        let shortest = packing.domain().lengths().and_then(|sides| sides.into_iter().reduce(f64::min));
        match (self, shortest) {
            (OuterRadius::Length(length), _) => Ok(length),
            (OuterRadius::OverSide(share), Some(side)) => Ok(share * side),
            (OuterRadius::OverSide(share), None) => {
                let open = if D == 3 { "space" } else { "plane" };
                Err(format!("--outer-radius {share}L: the packing is in the open {open}; give a length").into())
            }
        }
    }
}

/// A length, or a number and L.
fn outer_radius(text: &str) -> Result<OuterRadius, String> {
    let number = |text: &str| text.parse().map_err(|_| format!("`{text}` is not a number"));
    match text.strip_suffix('L') {
        Some(share) => number(share).map(OuterRadius::OverSide),
        None => number(text).map(OuterRadius::Length),
    }
}

/// A state: a file and its frame.
#[derive(Clone)]
struct StateFile {
    path: PathBuf,
    /// Its name in messages.
    shown: PathBuf,
    frame: Frame,
}

impl StateFile {
    /// The last frame of a file.
    fn last(path: PathBuf) -> Self {
        StateFile { shown: path.clone(), path, frame: Frame::Last }
    }

    /// The last frame of a file given on the command line.
    fn given(path: &Path, inputs: &mut input::Inputs) -> Result<Self, Failure> {
        Ok(StateFile { path: inputs.file(path)?, shown: path.to_path_buf(), frame: Frame::Last })
    }

    fn read<const D: usize>(&self) -> Result<Contents<D>, Failure> {
        let contents = read_contents(&self.path, self.frame)?;
        warn(&self.shown, &contents.warnings);
        Ok(contents)
    }

    /// The dimension that the file gives. A file that cannot be read is reported by [`StateFile::read`].
    fn dimension(&self) -> Option<usize> {
        let properties = properties_of_frame(&self.path, self.frame).ok()?;
        properties.iter().find(|(key, _)| key == "dimension").and_then(|(_, value)| value.parse().ok())
    }
}

/// The states of one packing.
struct Files {
    name: String,
    before: StateFile,
    after: StateFile,
    deflated: Option<StateFile>,
}

/// The states given on the command line.
fn states(arguments: &AnalyseArguments, inputs: &mut input::Inputs) -> Result<Vec<Files>, Failure> {
    let given = &arguments.states;
    if let Some(frames) = &arguments.frames {
        let ([path], [before, after, rest @ ..]) = (&given[..], &frames[..]) else {
            return Err("--frames A,B or A,B,C takes two or three states from one file".into());
        };
        if rest.len() > 1 {
            return Err(format!("--frames names {} frames: two or three are states", frames.len()).into());
        }
        let file = inputs.file(path)?;
        let of = |frame: &Frame| StateFile { path: file.clone(), shown: path.clone(), frame: *frame };
        return Ok(vec![Files {
            name: name_of(path),
            before: of(before),
            after: of(after),
            deflated: rest.first().map(of),
        }]);
    }
    match &given[..] {
        [file] if file.is_file() || file == Path::new("-") => Err(format!(
            "{}: one file; give the file after too, or with --frames A,B two frames of this one",
            file.display()
        )
        .into()),
        [folder] => pairs_in(folder),
        [before, after, deflated @ ..] => Ok(vec![Files {
            name: name_of(before),
            before: StateFile::given(before, inputs)?,
            after: StateFile::given(after, inputs)?,
            deflated: deflated.first().map(|path| StateFile::given(path, inputs)).transpose()?,
        }]),
        [] => Ok(Vec::new()),
    }
}

/// Analyses all pairs; if one fails, the others are analysed before the error is returned.
pub fn run(arguments: &AnalyseArguments) -> Result<ExitCode, Failure> {
    let mut inputs = input::Inputs::default();
    let result = run_with(arguments, &mut inputs);
    inputs.named(result)
}

fn run_with(arguments: &AnalyseArguments, inputs: &mut input::Inputs) -> Result<ExitCode, Failure> {
    let scene = arguments.scene.as_ref().map(|path| scene_file::read_scene(path)).transpose()?;
    let all = states(arguments, inputs)?;
    match dimension(arguments, scene.as_ref(), &all)? {
        3 => run_in::<3>(arguments, scene, &all),
        _ => run_in::<2>(arguments, scene, &all),
    }
}

/// The dimension given, or that of the first file that gives one, or of the scene, or 2.
fn dimension(arguments: &AnalyseArguments, scene: Option<&Scene>, all: &[Files]) -> Result<usize, Failure> {
    let of_scene = scene.map(|scene| scene.dimension);
    let given = arguments.dimension.map(usize::from).or_else(|| all.iter().find_map(|files| files.before.dimension()));
    match (given, of_scene) {
        (Some(dimension), Some(other)) if dimension != other => {
            Err(format!("--scene: the scene has dimension = {other}, but the packings have {dimension}").into())
        }
        _ => Ok(given.or(of_scene).unwrap_or(2)),
    }
}

fn run_in<const D: usize>(
    arguments: &AnalyseArguments,
    scene: Option<Scene>,
    all: &[Files],
) -> Result<ExitCode, Failure> {
    let (observables, mut verdict) = match scene {
        Some(scene) => (Some(scene.observables), scene.verdict),
        None => (None, VerdictSettings::default()),
    };
    override_limit(&mut verdict, arguments.not_at_rest);
    if let Some(out) = &arguments.write {
        let [files] = all else {
            return Err(format!("--write FILE takes one pair of states; here are {}", all.len()).into());
        };
        for state in [Some(&files.before), Some(&files.after), files.deflated.as_ref()].into_iter().flatten() {
            input::check_output(out, &state.path)?;
        }
    }
    let output = report::OutputFolder::open(&arguments.out, report::Kind::Analysis)?;
    output.try_samples("name of a pair", all.iter().map(|files| files.name.as_str()))?;
    let mut analyses = Vec::new();
    let mut failures = Vec::new();
    for files in all {
        match analyse::<D>(files, arguments, observables.as_ref(), &verdict) {
            Ok(analysis) => analyses.push(analysis),
            Err(error) => {
                failures.push(format!("{} and {}: {error}", files.before.path.display(), files.after.path.display()))
            }
        }
    }
    if !analyses.is_empty() {
        print(&report::table::analysis_table(&analyses))?;
        let written = report::write_analyses_into(&analyses, output)?;
        let page = written.iter().find(|file| file.extension().is_some_and(|extension| extension == "html"));
        let shown = page.unwrap_or(&arguments.out).display();
        print(&format!("\n{} files in {}, start from {shown}\n", written.len(), arguments.out.display()))?;
    }
    if let (Some(out), [analysis]) = (&arguments.write, &analyses[..]) {
        let response = report::DiskResponse::of(analysis);
        response.write(out)?;
        let missing = response.not_linear.as_ref();
        let missing =
            missing.map_or(String::new(), |reason| format!(", without the linear and the plastic part: {reason}"));
        print(&format!("the response of each disk in {}{missing}\n", out.display()))?;
    }
    if !failures.is_empty() {
        return Err(failures.join("\n").into());
    }
    let refused = analyses.iter().filter(|analysis| analysis.response.verdict.decision() == Decision::NotAtRest);
    Ok(exit_code::of_states(&refused.map(|analysis| analysis.name.clone()).collect::<Vec<_>>()))
}

fn analyse<const D: usize>(
    files: &Files,
    arguments: &AnalyseArguments,
    observables: Option<&Observables>,
    verdict: &VerdictSettings,
) -> Result<Analysis<D>, Failure> {
    if let (Some(first), Some(second)) = (files.before.dimension(), files.after.dimension())
        && first != second
    {
        return Err(format!("the files give different dimensions, {first} and {second}").into());
    }
    let (before, after) = (files.before.read::<D>()?, files.after.read()?);
    let deflated = files.deflated.as_ref().map(StateFile::read).transpose()?;
    let law = |state: &StateFile| contact_law::law_of(&state.path, state.frame, arguments.law, arguments.stiffness);
    let (first, second) = (law(&files.before)?, law(&files.after)?);
    // A file without a law has that of the other file.
    let law = match (says_law(&before), says_law(&after)) {
        (true, true) if first != second => {
            return Err(format!("the files give different laws, {first:?} and {second:?}").into());
        }
        (false, true) => second,
        _ => first,
    };
    let outer_radius = match arguments.outer_radius {
        Some(radius) => Some(radius.in_box(&before.packing)?),
        None => outer_radius_of(&before, &files.before.path)?,
    };
    // The lengths of a scene are in the units of the file; those of the defaults are for small disks of diameter 1.
    let observables =
        observables.cloned().unwrap_or_else(|| Observables::of_dimension(D).in_units(unit_of(&before.packing)));
    let settings = PairSettings { centre_label: arguments.centre, outer_radius };
    let deflated = deflated.as_ref().map(|contents| &contents.packing);
    let pair = Pair::new(before.packing, &after.packing, deflated, &settings)?;
    law.check()?;
    Ok(Analysis::of(&files.name, pair, &law, &observables, verdict)?)
}

fn says_law<const D: usize>(contents: &Contents<D>) -> bool {
    contents.properties.iter().any(|(key, _)| key.eq_ignore_ascii_case("law"))
}

/// R, if a file of a run contains it.
fn outer_radius_of<const D: usize>(contents: &Contents<D>, path: &Path) -> Result<Option<f64>, Failure> {
    let Some((_, text)) = contents.properties.iter().find(|(key, _)| key == "outer_radius") else { return Ok(None) };
    let wrong = || format!("{}: outer_radius is `{text}`, not a number", path.display());
    Ok(Some(text.parse().map_err(|_| wrong())?))
}

/// The name of a single pair: the file before without its endings.
fn name_of(path: &Path) -> String {
    let name = path.file_name().map_or(String::new(), |name| name.to_string_lossy().into_owned());
    let stem = name.split('.').next().unwrap_or_default();
    let plain: String =
        stem.chars().map(|c| if c.is_ascii_alphanumeric() || "-_".contains(c) { c } else { '_' }).collect();
    if plain.is_empty() { "pair".into() } else { plain }
}

/// The pairs of a folder, from the names of its files, in their order.
fn pairs_in(folder: &Path) -> Result<Vec<Files>, Failure> {
    let named = |error: std::io::Error| format!("{}: {error}", folder.display());
    // First completes the report of a run that was killed while it moved its files.
    report::output::complete(folder, report::Kind::Report)?;
    let mut names: Vec<String> = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(named)? {
        names.push(entry.map_err(named)?.file_name().to_string_lossy().into_owned());
    }
    names.sort();
    let is_state = |name: &str| ["before.", "after.", "displacement.", "deflated."].iter().any(|it| name.contains(it));
    let (left, earlier): (Vec<String>, Vec<String>) = names
        .into_iter()
        .filter(|name| is_state(name))
        .partition(|name| report::output::is_of_the_last_report(folder, name));
    names = left;
    if !earlier.is_empty() {
        print(&format!(
            "left out, because they are from an earlier run than the report in {}: {}\n",
            folder.display(),
            earlier.join(", ")
        ))?;
    }
    // NAME.STATE.ENDING, or STATE.ENDING alone.
    let state_of = |name: &str, state: &str| -> Option<String> {
        let at = name.find(&format!("{state}."))?;
        match &name[..at] {
            "" => Some(String::new()),
            prefix => prefix.strip_suffix('.').map(Into::into),
        }
    };
    let find = |sample: &str, states: &[&str]| -> Result<Option<PathBuf>, Failure> {
        let fits = |name: &&String| states.iter().any(|state| state_of(name, state).as_deref() == Some(sample));
        let found: Vec<&String> = names.iter().filter(fits).collect();
        match found[..] {
            [] => Ok(None),
            [name] => Ok(Some(folder.join(name))),
            [a, b, ..] => Err(format!(
                "{}: {a} and {b} are both files of the state {}; only one is allowed",
                folder.display(),
                states.join(" or ")
            )
            .into()),
        }
    };
    let mut pairs = Vec::new();
    let mut samples: Vec<String> = names.iter().filter_map(|name| state_of(name, "before")).collect();
    samples.dedup();
    for sample in samples {
        let before = find(&sample, &["before"])?.ok_or("a file disappeared during the analysis")?;
        let Some(after) = find(&sample, &["after", "displacement"])? else {
            return Err(format!(
                "{}: no {sample}.after.* or {sample}.displacement.* in the same folder",
                before.display()
            )
            .into());
        };
        let deflated = find(&sample, &["deflated"])?.map(StateFile::last);
        let name = if sample.is_empty() { "pair".into() } else { sample };
        pairs.push(Files { name, before: StateFile::last(before), after: StateFile::last(after), deflated });
    }
    if pairs.is_empty() {
        return Err(format!("{}: the folder contains no file NAME.before.*", folder.display()).into());
    }
    Ok(pairs)
}
