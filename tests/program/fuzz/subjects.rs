//! What the command line does with a packing, a scene and a study, without starting it.

use std::path::Path;

use jamscope::certificate::Certificate;
use jamscope::io::{Frame, read_packing, write_packing};
use jamscope::law::{LawChoice, PairLaw};
use jamscope::network::ContactNetwork;
use jamscope::observe::ForceDistribution;
use jamscope::packing::Packing;
use jamscope::relax::{Fire, Outcome, Relaxer, RelaxerChoice, Stop};
use jamscope::scene::Scene;
use jamscope::study::{Plan, Study};

use super::{Fault, contact_law, scene_file};

/// What refusals of packings name where it is not a line.
pub const PACKING_FIELDS: [&str; 9] =
    ["the file is empty", "no known format", "law", "stiffness", "exponent", "disk ", "disks ", "box axis", "frame"];

/// A refusal that does not name the file, or neither a field nor a line of it.
pub fn nameless(message: &str, path: &Path, fields: &[&str]) -> Fault {
    let file = path.file_name().map_or(String::new(), |name| name.to_string_lossy().into_owned());
    let Some((_, said)) = message.split_once(&file) else {
        return Some(format!("no file in: {message}"));
    };
    let line = said.split_once("line ").is_some_and(|(_, rest)| rest.starts_with(|c: char| c.is_ascii_digit()));
    let named = line || fields.iter().any(|field| said.contains(field));
    (!named).then(|| format!("neither field nor line in: {message}"))
}

/// Reads a packing of either dimension and does what `inspect` does.
pub fn packing(path: &Path) -> Fault {
    for asked in [None, contact_law::parse("power:2.5").ok()] {
        match contact_law::law_of(path, Frame::Last, asked, None) {
            Ok(law) if asked.is_none() => {
                if let Some(fault) = inspected::<2>(path, law).or_else(|| inspected::<3>(path, law)) {
                    return Some(fault);
                }
            }
            Ok(_) => {}
            Err(error) => {
                if let Some(fault) = nameless(&error.to_string(), path, &PACKING_FIELDS) {
                    return Some(fault);
                }
            }
        }
    }
    None
}

fn inspected<const D: usize>(path: &Path, law: LawChoice) -> Fault {
    let packing = match read_packing::<D>(path) {
        Ok(packing) => packing,
        Err(error) => return nameless(&error.to_string(), path, &PACKING_FIELDS),
    };
    let measured = match law {
        LawChoice::Hertzian(law) => measured(&packing, &law),
        LawChoice::Hookean(law) => measured(&packing, &law),
        LawChoice::PowerLaw(law) => measured(&packing, &law),
    };
    measured.or_else(|| written(&packing, &path.with_extension("copy.xyz")))
}

fn measured<const D: usize>(packing: &Packing<D>, law: &dyn PairLaw) -> Fault {
    let named = |error: &dyn std::fmt::Display| {
        let message = error.to_string();
        let said = PACKING_FIELDS.iter().any(|field| message.contains(field));
        (!said).then(|| format!("neither disk nor axis in: {message}"))
    };
    let network = match ContactNetwork::new(packing, law) {
        Ok(network) => network,
        Err(error) => return named(&error),
    };
    let numbers = [network.energy(), network.coordination(), network.mean_contact_force(), network.largest_net_force()];
    let _ = (network.rattlers().count(), ForceDistribution::of(&network), numbers);
    if let Err(error) = Certificate::of(packing, law, None) {
        return named(&error);
    }
    relaxers().iter().find_map(|relaxer| match relaxer.relax(packing.clone(), law, &mut ()) {
        Err(error) => named(&error),
        Ok(outcome) => at_rest_or_named(&outcome).map(|fault| format!("{}: {fault}", relaxer.name())),
    })
}

/// What `run --packing` relaxes with, for a few steps.
fn relaxers() -> Vec<RelaxerChoice> {
    vec![
        RelaxerChoice::Fire(Fire { step_limit: 60, ..Fire::default() }),
        #[cfg(feature = "linear")]
        RelaxerChoice::Implicit(jamscope::relax::ImplicitDynamics { step_limit: 10, ..Default::default() }),
    ]
}

/// A state that counts as at rest has numbers for all coordinates and for its residual.
fn at_rest_or_named<const D: usize>(outcome: &Outcome<Packing<D>>) -> Fault {
    let Stop::Converged(criterion) = outcome.stop else { return None };
    let finite = outcome.state.positions().iter().flatten().all(|x| x.is_finite());
    let known = finite && outcome.residual.relative().is_finite();
    (!known).then(|| format!("at rest by {criterion:?} with {:?}", outcome.residual))
}

/// What was read can be written, and is read again.
fn written<const D: usize>(packing: &Packing<D>, copy: &Path) -> Fault {
    if let Err(error) = write_packing(copy, packing, &[], &[]) {
        return Some(format!("a packing that was read is not written: {error}"));
    }
    match read_packing::<D>(copy) {
        Ok(again) if again == *packing => None,
        Ok(_) => Some("a packing that was read and written is another one".into()),
        Err(error) => Some(format!("a packing that was read and written is refused: {error}")),
    }
}

/// Fields of scenes and studies, by every word before `=` and in `[ ]` of the corpus.
fn scene_fields() -> Vec<String> {
    let texts = [super::corpus::scenes(), super::corpus::studies()].concat().concat();
    let text = String::from_utf8_lossy(&texts).into_owned();
    let words = text.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).filter(|word| word.len() > 3);
    words.map(Into::into).collect()
}

/// As [`nameless`], with the fields of scenes and studies.
pub fn nameless_scene(message: &str, path: &Path) -> Fault {
    let fields = scene_fields();
    nameless(
        message,
        path,
        &fields.iter().map(String::as_str).chain(["the file is empty", "UTF-8"]).collect::<Vec<_>>(),
    )
}

/// Reads a scene; one that makes sense can be written and read again.
pub fn scene(path: &Path) -> Fault {
    let scene = match scene_file::read_scene(path) {
        Ok(scene) => scene,
        Err(error) => return nameless_scene(&error.to_string(), path),
    };
    let text = match scene.to_toml() {
        Ok(text) => text,
        Err(error) => return Some(format!("a scene that makes sense is not written: {error}")),
    };
    match Scene::from_toml(&text) {
        Ok(again) if again == scene => None,
        Ok(_) => Some(format!("a scene that makes sense comes back as another one:\n{text}")),
        Err(error) => Some(format!("a scene that makes sense is not read again: {error}")),
    }
}

/// Reads a study and makes its plan; one that makes sense can be written and read again.
pub fn study(path: &Path) -> Fault {
    let study = match read_study(path) {
        Ok(study) => study,
        Err(message) => return nameless_scene(&format!("{}: {message}", path.display()), path),
    };
    if let Err(error) = Plan::of(&study) {
        return nameless_scene(&format!("{}: {error}", path.display()), path);
    }
    let text = match serde_json::to_string(&study) {
        Ok(text) => text,
        Err(error) => return Some(format!("a study that makes sense is not written: {error}")),
    };
    match serde_json::from_str::<Study>(&text) {
        Ok(again) if again == study => None,
        Ok(_) => Some(format!("a study that makes sense comes back as another one:\n{text}")),
        Err(error) => Some(format!("a study that makes sense is not read again: {error}")),
    }
}

/// As `jamscope study` reads it; [`super::commands::plan`] goes through the program itself.
fn read_study(path: &Path) -> Result<Study, String> {
    let text = std::fs::read_to_string(path).map_err(|error| error.to_string())?;
    let study = Study::from_toml(&text).map_err(|error| error.to_string())?;
    study.check().map_err(|error| error.to_string())?;
    scene_file::refuse_cut(&text)?;
    Ok(study)
}
