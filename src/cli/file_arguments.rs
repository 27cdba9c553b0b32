//! [`FileArguments`]: a packing file on the command line, how it is relaxed, and a result that an interruption left unfinished.

use std::cell::Cell;
use std::path::{Path, PathBuf};

use clap::Args;
use jamscope::io::{Contents, Frame, read_contents, read_properties};
use jamscope::law::LawChoice;
use jamscope::network::ContactNetwork;
use jamscope::packing::Packing;
use jamscope::relax::{Cost, Outcome, Relaxer, RelaxerChoice, Stop, Trace};
use jamscope::report::write_state;
use jamscope::scene::{relaxer_by_name, relaxer_with_limit};
use jamscope::verdict::VerdictSettings;

use crate::contact_law::{self, LawName};
use crate::input::Inputs;
use crate::{Failure, input, threads, warn};

/// A packing file and how it is relaxed.
#[derive(Args)]
pub struct FileArguments {
    /// Packing file: extended XYZ, LAMMPS data or dump, NumPy archive, possibly compressed by gzip or zstd; `-` is the standard
    /// input.
    pub packing: PathBuf,
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
    pub dimension: u8,
    /// Number of threads; by default one per core. Changes no result.
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// File for the result, extended XYZ, or a NumPy archive if it ends in `.npz`; by default NAME.relaxed.xyz,
    /// NAME.compressed.xyz or NAME.sheared.xyz in the current folder, if there is no such file.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Key of a result that is not finished: the command that makes it.
const UNFINISHED: &str = "unfinished";

/// Key of the last step of an unfinished shear.
const UNFINISHED_STEP: &str = "unfinished_step";

/// Key of the packing from which an unfinished result was made, see [`digest`].
const UNFINISHED_OF: &str = "unfinished_of";

/// Steps between two states written of one relaxation. A state is written each half minute for 88776 disks. The relaxer
/// restarts from each. The number is fixed, so a result does not depend on interruptions.
const PORTION: usize = 20_000;

/// What the arguments name, checked.
pub struct Task {
    /// What messages call the packing.
    pub name: String,
    pub out: PathBuf,
    pub law: LawChoice,
    pub relaxer: RelaxerChoice,
    /// The command, without its files.
    description: String,
    /// The file that is read, possibly a copy of the standard input.
    pub path: PathBuf,
    frame: Frame,
    /// Copies of the standard input and of pipes, which last as long as this.
    inputs: Inputs,
    digest: Cell<u64>,
}

/// A number that differs for different packings: FNV-1a of the bits of positions and radii.
///
/// Source: Fowler, Noll and Vo, RFC 9923.
fn digest<const D: usize>(packing: &Packing<D>) -> u64 {
    let numbers = packing.positions().iter().flatten().chain(packing.radii());
    let bytes = numbers.flat_map(|number| number.to_bits().to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

/// A packing that was read, and where to continue.
pub struct Start<const D: usize> {
    /// The packing of the input.
    pub given: Packing<D>,
    /// The packing of an unfinished result, and its last step.
    pub unfinished: Option<(Packing<D>, usize)>,
    /// Key-value pairs of the input.
    pub properties: Vec<(String, String)>,
}

impl FileArguments {
    /// Checks the arguments. `action` is the command with its own options; the default name of the result ends in `ending`.
    pub fn task(&self, action: &str, ending: &str) -> Result<Task, Failure> {
        threads::set_threads(self.threads)?;
        let relaxer = self.relaxer()?;
        let mut inputs = Inputs::default();
        let path = inputs.file(&self.packing)?;
        let law = inputs.named(contact_law::law_of(&path, self.frame, self.law, self.stiffness))?;
        law.check()?;
        let limit = relaxer.limit().value();
        let description = format!("{action}, {} to {limit:e}, {law:?}", relaxer.name());
        let out = self.out.clone().unwrap_or_else(|| named(&self.packing, ending));
        if out.exists() {
            let unfinished = unfinished_command(&out);
            if unfinished.is_none() && self.out.is_none() {
                return Err(format!("{}: exists; name the file for the result with --out", out.display()).into());
            }
            if let Some(other) = unfinished.filter(|other| *other != description) {
                return Err(format!(
                    "{}: holds the unfinished result of `{other}`, which is not `{description}`; remove it, or give another file with --out",
                    out.display()
                )
                .into());
            }
        }
        input::check_output(&out, &path)?;
        let name = self.packing.display().to_string();
        Ok(Task { name, out, law, relaxer, description, path, frame: self.frame, inputs, digest: Cell::new(0) })
    }

    fn relaxer(&self) -> Result<RelaxerChoice, Failure> {
        let name = &self.relaxer;
        if name.is_empty() || !name.chars().all(|c| c.is_ascii_lowercase() || c == '_') {
            return Err(format!("--relaxer is `{name}`, not the name of a relaxer in a scene, such as fire").into());
        }
        let relaxer = match self.limit {
            Some(limit) if limit > 0.0 && limit <= residual_limit() => relaxer_with_limit(name, limit),
            Some(limit) => {
                return Err(format!("--limit is {limit}: must be above 0 and at most {}", residual_limit()).into());
            }
            None => relaxer_by_name(name),
        };
        Ok(relaxer.map_err(|error| format!("--relaxer {name}: {}", error.message))?)
    }
}

/// Largest residual of a state at rest \[1\].
pub fn residual_limit() -> f64 {
    VerdictSettings::default().residual_limit
}

/// The command whose unfinished result a file is.
fn unfinished_command(out: &Path) -> Option<String> {
    // A device has no end.
    if !out.is_file() {
        return None;
    }
    value_of(&read_properties(out).ok()?, UNFINISHED)
}

fn value_of(properties: &[(String, String)], wanted: &str) -> Option<String> {
    properties.iter().find(|(key, _)| key == wanted).map(|(_, value)| value.clone())
}

/// The default name of a result, in the current folder.
fn named(path: &Path, ending: &str) -> PathBuf {
    let stem = path.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
    let stem = if stem.is_empty() || stem == "-" { "packing" } else { &stem };
    PathBuf::from(format!("{stem}.{ending}.xyz"))
}

impl Task {
    /// The result, with the names that the user gave in its error.
    pub fn named<T>(&self, result: Result<T, Failure>) -> Result<T, Failure> {
        self.inputs.named(result)
    }

    /// Reads the packing, and the unfinished result, if there is one.
    pub fn start<const D: usize>(&self) -> Result<Start<D>, Failure> {
        let name = &self.name;
        let Contents { packing: given, mut properties, warnings } = read_contents::<D>(&self.path, self.frame)?;
        warn(Path::new(name), &warnings);
        check(&given).map_err(|reason| format!("{name}: {reason}"))?;
        properties.retain(|(key, _)| ![UNFINISHED, UNFINISHED_STEP, UNFINISHED_OF].contains(&key.as_str()));
        self.digest.set(digest(&given));
        let unfinished = match unfinished_command(&self.out) {
            Some(_) => {
                let Contents { packing, properties, .. } = read_contents::<D>(&self.out, Frame::Last)?;
                let is_same = value_of(&properties, UNFINISHED_OF) == Some(format!("{:016x}", self.digest.get()));
                if !is_same {
                    return Err(format!("{}: holds the unfinished result of another packing; remove it, or give another file with --out", self.out.display()).into());
                }
                let step = value_of(&properties, UNFINISHED_STEP).and_then(|step| step.parse().ok());
                let step = step.ok_or_else(|| {
                    format!(
                        "{}: unfinished_step is not the number of a step; remove the file to start again",
                        self.out.display()
                    )
                })?;
                Some((packing, step))
            }
            None => None,
        };
        Ok(Start { given, unfinished, properties })
    }

    /// Writes the result.
    pub fn finish<const D: usize>(
        &self,
        packing: &Packing<D>,
        network: &ContactNetwork<D>,
        properties: &[(String, String)],
    ) -> Result<(), Failure> {
        Ok(write_state(&self.out, packing, (network, &self.law), &[], properties)?)
    }

    /// Writes a state from which the same command continues.
    pub fn save<const D: usize>(&self, packing: &Packing<D>, step: usize) -> Result<(), Failure> {
        let network = ContactNetwork::new(packing, &self.law)?;
        let properties = [
            (UNFINISHED, self.description.clone()),
            (UNFINISHED_STEP, step.to_string()),
            (UNFINISHED_OF, format!("{:016x}", self.digest.get())),
        ];
        let properties = properties.map(|(key, value)| (key.to_string(), value));
        self.finish(packing, &network, &properties)
    }

    /// Whether states can be written between: a NumPy archive is written at the end only.
    pub fn is_resumable(&self) -> bool {
        !self.out.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("npz"))
    }
}

/// Refuses packings that the commands would change in a way that their file does not mean.
fn check<const D: usize>(packing: &Packing<D>) -> Result<(), &'static str> {
    if packing.sites().is_some() && packing.loads().is_none() {
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

/// The relaxer of a task, which writes its state after every [`PORTION`] steps. Dynamics and Newton's method are not
/// interrupted: velocities would be lost, and few steps suffice.
pub struct InPortions<'a> {
    task: &'a Task,
    relaxer: RelaxerChoice,
    portion: usize,
}

impl<'a> InPortions<'a> {
    pub fn of(task: &'a Task) -> Self {
        InPortions { task, relaxer: task.relaxer, portion: PORTION }
    }
}

/// Ends a relaxation after a portion.
struct Portion<'a> {
    trace: &'a mut dyn Trace,
    step_count: usize,
    is_over: bool,
}

impl Trace for Portion<'_> {
    fn checked(&mut self, check: &jamscope::relax::Check) {
        self.trace.checked(check);
        self.is_over = check.step_count >= self.step_count;
    }

    fn interrupted(&mut self) -> bool {
        self.is_over
    }
}

impl Relaxer for InPortions<'_> {
    fn relax<const D: usize>(
        &self,
        packing: Packing<D>,
        law: &dyn jamscope::law::PairLaw,
        trace: &mut dyn Trace,
    ) -> Result<Outcome<Packing<D>>, jamscope::packing::PackingError> {
        let minimises = matches!(
            self.relaxer,
            RelaxerChoice::Fire(_) | RelaxerChoice::ConjugateGradients(_) | RelaxerChoice::QuasiNewton(_)
        );
        if !minimises || !self.task.is_resumable() {
            return self.relaxer.relax(packing, law, trace);
        }
        let (mut packing, mut cost) = (packing, Cost::default());
        loop {
            let mut portion = Portion { trace, step_count: self.portion, is_over: false };
            let outcome = self.relaxer.relax(packing, law, &mut portion)?;
            cost = cost.plus(outcome.cost);
            if outcome.stop != Stop::Interrupted {
                return Ok(Outcome { cost, ..outcome });
            }
            // A state that cannot be written is found at the end: the relaxation goes on.
            let _ = self.task.save(&outcome.state, 0);
            packing = outcome.state;
        }
    }

    fn for_intermediate_states(&self, limit: f64) -> Option<Self> {
        let relaxer = self.relaxer.for_intermediate_states(limit)?;
        Some(InPortions { relaxer, ..*self })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jamscope::io::read_packing;

    fn task(out: PathBuf) -> Task {
        let path = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/packings/hertz_N1000_p100.xyz"));
        let (law, relaxer) = (LawChoice::default(), RelaxerChoice::default());
        let (name, description, frame) = ("a packing".into(), "relax".into(), Frame::Last);
        Task { name, out, law, relaxer, description, path, frame, inputs: Inputs::default(), digest: Cell::new(0) }
    }

    /// A relaxation in portions that is interrupted between two of them and continued has the bits of the whole one.
    #[test]
    fn a_relaxation_continues_from_its_last_portion() {
        let folder = tempfile::tempdir().expect("a folder");
        let task = task(folder.path().join("out.xyz"));
        let start: Start<2> = task.start().expect("a packing");
        let first = start.given.radii()[0];
        let moved = start.given.with_radius(0, 1.1 * first).expect("a radius");
        let law = LawChoice::default();
        let relaxer = InPortions { portion: 40, ..InPortions::of(&task) };
        let whole = relaxer.relax(moved.clone(), &law, &mut ()).expect("apart");
        assert!(matches!(whole.stop, Stop::Converged(_)) && whole.cost.step_count > 120, "{:?}", whole.cost);
        // The file holds the last portion that was written. The relaxation goes on from there as it did.
        let saved: Packing<2> = read_packing(&task.out).expect("a state");
        assert_ne!(saved, moved);
        let rest = relaxer.relax(saved, &law, &mut ()).expect("apart");
        assert_eq!(rest.state, whole.state);
        assert!(rest.cost.step_count < whole.cost.step_count);
        // Of another packing it is refused.
        let text = std::fs::read_to_string(&task.out).expect("text");
        let at = text.find("unfinished_of=").expect("a key") + "unfinished_of=".len();
        std::fs::write(&task.out, format!("{}{:016x}{}", &text[..at], 1, &text[at + 16..])).expect("written");
        let error = task.start::<2>().err().expect("another packing").to_string();
        assert!(error.contains("unfinished result of another packing"), "{error}");
    }
}
