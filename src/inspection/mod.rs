//! [`Inspection`]: the properties of a packing file, from its energy to its lowest modes, as `jamscope inspect` prints them.

#[cfg(feature = "linear")]
mod elasticity;

use std::path::Path;

#[cfg(feature = "linear")]
pub use elasticity::{Constants, Elasticity, ModeSummary, Moduli, Vibrations};
use serde::Serialize;

use crate::certificate::Certificate;
#[cfg(feature = "linear")]
use crate::certificate::Stability;
use crate::io::{Frame, ReadError, ReadWarning, read_contents};
use crate::law::choice::{LawChoice, LawError};
use crate::memory::{Limit, TooLarge};
use crate::observe::ForceDistribution;
use crate::observe::force_distribution::PERCENTILES;
use crate::observe::state::State;
use crate::packing::{Packing, PackingError, particles};
use crate::vector::larger;
use crate::verdict::{RestVerdict, VerdictSettings};

/// The properties of a packing.
#[derive(Debug, Serialize)]
pub struct Inspection {
    /// What was read but should be known.
    #[serde(skip_serializing_if = "Vec::is_empty", serialize_with = "as_text")]
    pub warnings: Vec<ReadWarning>,
    /// Whether it is at rest; otherwise the likely causes.
    pub verdict: RestVerdict,
    /// The contact law used.
    pub law: LawChoice,
    /// Dimension of space.
    pub dimension: usize,
    /// Number of disks.
    pub disk_count: usize,
    /// Number of held disks.
    pub held_count: usize,
    /// Sides of the box, those of a tilted one along the axes; absent in the open plane \[length\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub box_sides: Option<Vec<f64>>,
    /// Edges of a tilted box, from its corner; absent for a rectangular one \[length\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub box_edges: Option<Vec<Vec<f64>>>,
    /// Packing fraction; absent in the open plane \[1\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub packing_fraction: Option<f64>,
    /// Elastic energy \[energy\].
    pub energy: f64,
    /// Pressure; absent in the open plane, like all quantities per volume \[force / length^(D−1)\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure: Option<f64>,
    /// Stress tensor, positive in compression \[force / length^(D−1)\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stress: Option<Vec<Vec<f64>>>,
    /// Number of contacts.
    pub contact_count: usize,
    /// Number of contacts within the backbone.
    pub backbone_contact_count: usize,
    /// Number of rattlers.
    pub rattler_count: usize,
    /// Coordination of the backbone, Z \[1\].
    pub coordination: f64,
    /// Z of an isostatic packing, 2 D.
    pub isostatic_coordination: usize,
    /// Mean contact force of the backbone \[force\].
    pub mean_contact_force: f64,
    /// Largest contact force \[force\].
    pub largest_contact_force: f64,
    /// Largest net force on any mobile disk \[force\].
    pub largest_net_force: f64,
    /// Mean overlap of the contacts \[length\].
    pub mean_overlap: f64,
    /// Largest overlap \[length\].
    pub largest_overlap: f64,
    /// Its certificate.
    pub certificate: Certificate,
    /// Contact forces of the backbone over the mean contact force; absent without a backbone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force_over_mean_contact_force: Option<ForceDistribution>,
    /// Elastic moduli, or why there are none.
    #[cfg(feature = "linear")]
    pub moduli: Elasticity,
    /// The lowest vibrational modes, or why there are none; absent if not requested.
    #[cfg(feature = "linear")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub modes: Option<Vibrations>,
}

/// Warnings as their text.
fn as_text<S: serde::Serializer>(warnings: &[ReadWarning], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(warnings.iter().map(ToString::to_string))
}

/// Why a packing file has no inspection.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum InspectionError {
    /// A parameter of the law is invalid.
    #[error(transparent)]
    Law(#[from] LawError),
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The packing has no contact network.
    #[error("{path}: {source}")]
    Packing {
        /// The file.
        path: String,
        /// The error.
        source: PackingError,
    },
    /// Not a dimension of packings.
    #[error("dimension = {value}: must be 2 or 3")]
    Dimension {
        /// The value given.
        value: usize,
    },
    /// More modes than coordinates.
    #[error("{path}: {source}")]
    Modes {
        /// The file.
        path: String,
        /// The error.
        source: TooLarge,
    },
}

/// Reads a frame of a packing file, of dimension 2 or 3, and measures it under a law.
///
/// `mode_count` is the number of vibrational modes, from the lowest; without the feature `linear` none are computed.
///
/// # Errors
/// See [`InspectionError`].
pub fn inspect(
    path: &Path,
    frame: Frame,
    law: LawChoice,
    dimension: usize,
    mode_count: usize,
    settings: &VerdictSettings,
) -> Result<Inspection, InspectionError> {
    law.check()?;
    let name = || path.display().to_string();
    let modes = |coordinate_count: usize| {
        let limit = Limit { largest: coordinate_count as u64, reason: "the number of coordinates of all disks" };
        let checked = limit.check("--modes", mode_count, 8.0 * coordinate_count as f64);
        checked.map_err(|source| InspectionError::Modes { path: name(), source })
    };
    let (measured, warnings) = match dimension {
        2 => {
            let contents = read_contents::<2>(path, frame)?;
            modes(2 * contents.packing.len())?;
            (Inspection::of(&contents.packing, law, mode_count, settings), contents.warnings)
        }
        3 => {
            let contents = read_contents::<3>(path, frame)?;
            modes(3 * contents.packing.len())?;
            (Inspection::of(&contents.packing, law, mode_count, settings), contents.warnings)
        }
        value => return Err(InspectionError::Dimension { value }),
    };
    let inspection = measured.map_err(|source| InspectionError::Packing { path: name(), source })?;
    Ok(Inspection { warnings, ..inspection })
}

impl Inspection {
    /// The properties of a packing, with this number of vibrational modes, at most the number of coordinates.
    ///
    /// # Errors
    /// See [`State::new`].
    #[cfg_attr(not(feature = "linear"), allow(unused_variables, reason = "modes are of the feature `linear`"))]
    pub fn of<const D: usize>(
        packing: &Packing<D>,
        choice: LawChoice,
        mode_count: usize,
        settings: &VerdictSettings,
    ) -> Result<Self, PackingError> {
        let law = &choice;
        let state = State::new(packing, law).map_err(|error| error.with_labels(packing.labels()))?;
        let verdict = RestVerdict::of(&[("in the file", &state)], law, &choice, None, settings);
        let network = state.network;
        let volume = packing.domain().volume();
        let contacts = &network.contacts;
        let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, larger);
        Ok(Inspection {
            warnings: Vec::new(),
            verdict,
            law: choice,
            dimension: D,
            disk_count: packing.len(),
            held_count: packing.held().iter().filter(|&&held| held).count(),
            box_sides: packing.domain().lengths().map(|lengths| lengths.to_vec()),
            box_edges: packing
                .domain()
                .edges()
                .filter(|_| packing.domain().is_tilted())
                .map(|edges| edges.iter().map(|edge| edge.to_vec()).collect()),
            packing_fraction: packing.packing_fraction(),
            energy: network.energy(),
            pressure: volume.map(|volume| network.pressure(volume)),
            stress: volume.map(|volume| network.stress(volume).iter().map(|row| row.to_vec()).collect()),
            contact_count: contacts.len(),
            backbone_contact_count: network.backbone_contacts().count(),
            rattler_count: network.rattlers().count(),
            coordination: network.coordination(),
            isostatic_coordination: 2 * D,
            mean_contact_force: network.mean_contact_force(),
            largest_contact_force: largest(&mut contacts.iter().map(|contact| contact.force)),
            largest_net_force: network.largest_net_force(),
            // From a positive zero: an empty sum of floats is a negative one.
            mean_overlap: contacts.iter().map(|contact| contact.overlap).fold(0.0, |sum, overlap| sum + overlap)
                / contacts.len().max(1) as f64,
            largest_overlap: largest(&mut contacts.iter().map(|contact| contact.overlap)),
            certificate: Certificate::of(packing, law, None)?,
            force_over_mean_contact_force: ForceDistribution::of(&network),
            #[cfg(feature = "linear")]
            moduli: Elasticity::of(packing, law),
            #[cfg(feature = "linear")]
            modes: (mode_count > 0).then(|| Vibrations::of(packing, law, mode_count)),
        })
    }

    /// The inspection as JSON, with every number in full precision.
    ///
    /// # Errors
    /// See [`serde_json::to_string_pretty`].
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        serde_json::to_string_pretty(self)
    }
}

/// The lines of a certificate.
fn write_certificate(f: &mut std::fmt::Formatter<'_>, certificate: &Certificate) -> std::fmt::Result {
    if certificate.contacts.is_none() {
        writeln!(f, "{:<28} none: there is no backbone", "relative residual")?;
    } else {
        writeln!(
            f,
            "{:<28} {:e} (rounding floor {:e}) [1]",
            "relative residual", certificate.relative_residual, certificate.rounding_floor
        )?;
    }
    if let Some(contacts) = certificate.contacts {
        writeln!(
            f,
            "{:<28} {:+} ({} on {} disks, isostatic {})",
            "contacts - isostatic",
            contacts.excess,
            contacts.contact_count,
            contacts.disk_count,
            contacts.isostatic_count
        )?;
        writeln!(f, "{:<28} {}", "bucklers", certificate.buckler_count)?;
    }
    #[cfg(feature = "linear")]
    match &certificate.stability {
        Stability::Counted { negative_eigenvalue_count, pivot_ratio } => {
            writeln!(f, "{:<28} {negative_eigenvalue_count} (pivots span {pivot_ratio:e})", "negative eigenvalues")?
        }
        Stability::Singular { pivot_ratio } => {
            writeln!(f, "{:<28} singular (pivots span {pivot_ratio:e})", "negative eigenvalues")?;
        }
        Stability::Unknown(reason) => writeln!(f, "{:<28} unknown: {reason}", "negative eigenvalues")?,
        Stability::NoBackbone => {}
    }
    if let Some(virial) = certificate.virial {
        writeln!(
            f,
            "{:<28} {} (relative difference from -dE/d ln L: {:e}) [energy]",
            "virial, sum F r", virial.from_forces, virial.relative_difference
        )?;
    }
    Ok(())
}

impl std::fmt::Display for Inspection {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for paragraph in self.verdict.paragraphs() {
            writeln!(f, "{paragraph}")?;
        }
        let disks = particles(self.dimension);
        writeln!(f, "{disks:<28} {}", self.disk_count)?;
        let law = match self.law {
            LawChoice::Hertzian(law) => format!("Hertzian, stiffness {}", law.stiffness),
            LawChoice::Hookean(law) => format!("Hookean, stiffness {}", law.stiffness),
            LawChoice::PowerLaw(law) => format!("power law, scale {}, exponent {}", law.energy_scale, law.exponent),
        };
        writeln!(f, "{:<28} {law}", "law")?;
        if self.held_count > 0 {
            writeln!(f, "{:<28} {}", "held", self.held_count)?;
        }
        match &self.box_sides {
            Some(sides) => {
                let sides: Vec<String> = sides.iter().map(f64::to_string).collect();
                writeln!(f, "{:<28} {} [length]", "periodic box", sides.join(" x "))?;
                for (edge, name) in self.box_edges.iter().flatten().zip(["edge a", "edge b", "edge c"]) {
                    let components: Vec<String> = edge.iter().map(f64::to_string).collect();
                    writeln!(f, "{name:<28} {} [length]", components.join("  "))?;
                }
            }
            None => writeln!(f, "{:<28} open", "domain")?,
        }
        if let Some(packing_fraction) = self.packing_fraction {
            writeln!(f, "{:<28} {packing_fraction} [1]", "packing fraction")?;
        }
        writeln!(f, "{:<28} {} [energy]", "energy", self.energy)?;
        let per_length = if self.dimension == 2 { "force / length" } else { "force / length^2" };
        if let Some(pressure) = self.pressure {
            writeln!(f, "{:<28} {pressure} [{per_length}]", "pressure")?;
        }
        for row in self.stress.iter().flatten() {
            let row: Vec<String> = row.iter().map(f64::to_string).collect();
            writeln!(f, "{:<28} {} [{per_length}]", "stress", row.join("  "))?;
        }
        writeln!(f, "{:<28} {} ({} on the backbone)", "contacts", self.contact_count, self.backbone_contact_count)?;
        writeln!(f, "{:<28} {}", "rattlers", self.rattler_count)?;
        writeln!(f, "{:<28} {} (isostatic {})", "coordination Z", self.coordination, self.isostatic_coordination)?;
        writeln!(
            f,
            "{:<28} mean {}, largest {} [force]",
            "contact force", self.mean_contact_force, self.largest_contact_force
        )?;
        writeln!(f, "{:<28} mean {}, largest {} [length]", "overlap", self.mean_overlap, self.largest_overlap)?;
        writeln!(f, "{:<28} {:e} [force]", "largest net force", self.largest_net_force)?;
        write_certificate(f, &self.certificate)?;
        if let Some(forces) = &self.force_over_mean_contact_force {
            let over = |value: f64| format!("{value:.4}");
            let range = [over(forces.smallest), over(forces.largest)];
            writeln!(f, "{:<28} range {} [1]", "force over mean contact force", range.join(" to "))?;
            let percentiles: Vec<String> = PERCENTILES
                .iter()
                .zip(forces.percentiles)
                .map(|(at, value)| format!("{at} %: {}", over(value)))
                .collect();
            writeln!(f, "{:<28} percentiles {} [1]", "force over mean contact force", percentiles.join("  "))?;
        }
        #[cfg(feature = "linear")]
        {
            self.moduli.write(f, per_length)?;
            if let Some(modes) = &self.modes {
                modes.write(f)?;
            }
        }
        Ok(())
    }
}
