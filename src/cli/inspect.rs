//! `jamscope inspect`: any packing file in numbers.

use std::path::Path;

use jamscope::contact::{ContactNetwork, LawChoice, PairLaw};
use jamscope::io::read_packing;
use jamscope::packing::{Domain, Packing};
use jamscope::relax::rounding_floor;
use jamscope::vector::norm;
use serde::Serialize;

/// What `inspect` says of a packing.
#[derive(Debug, Serialize)]
pub struct Inspection {
    /// Dimension of space.
    dimension: usize,
    /// Number of disks.
    disk_count: usize,
    /// Number of held disks.
    held_count: usize,
    /// Sides of the box; absent in the open plane.
    #[serde(skip_serializing_if = "Option::is_none")]
    box_sides: Option<Vec<f64>>,
    /// Packing fraction; absent in the open plane.
    #[serde(skip_serializing_if = "Option::is_none")]
    packing_fraction: Option<f64>,
    /// Elastic energy.
    energy: f64,
    /// Pressure; absent in the open plane, as all below that are per volume.
    #[serde(skip_serializing_if = "Option::is_none")]
    pressure: Option<f64>,
    /// Stress tensor, positive in compression.
    #[serde(skip_serializing_if = "Option::is_none")]
    stress: Option<Vec<Vec<f64>>>,
    /// Number of contacts.
    contact_count: usize,
    /// Number of contacts within the backbone.
    backbone_contact_count: usize,
    /// Number of rattlers.
    rattler_count: usize,
    /// Coordination of the backbone, Z.
    coordination: f64,
    /// Z of an isostatic packing, 2 D.
    isostatic_coordination: usize,
    /// Mean contact force of the backbone.
    mean_contact_force: f64,
    /// Largest contact force.
    largest_contact_force: f64,
    /// Largest net force on any mobile disk.
    largest_net_force: f64,
    /// Largest net force on a mobile disk of the backbone over the mean contact force of the backbone.
    relative_residual: f64,
    /// What rounding alone makes of it.
    rounding_floor: f64,
    /// Mean overlap of the contacts.
    mean_overlap: f64,
    /// Largest overlap.
    largest_overlap: f64,
}

/// Reads a packing of either dimension and looks at it under a law.
pub fn inspect(path: &Path, law: LawChoice, dimension: usize) -> Result<Inspection, Box<dyn std::error::Error>> {
    law.check()?;
    if dimension == 3 { with_law(&read_packing::<3>(path)?, law) } else { with_law(&read_packing::<2>(path)?, law) }
        .map_err(|error| format!("{}: {error}", path.display()).into())
}

fn with_law<const D: usize>(packing: &Packing<D>, law: LawChoice) -> Result<Inspection, Box<dyn std::error::Error>> {
    match law {
        LawChoice::Hertzian(law) => of(packing, &law),
        LawChoice::Hookean(law) => of(packing, &law),
        LawChoice::PowerLaw(law) => of(packing, &law),
    }
}

fn of<const D: usize, L: PairLaw>(packing: &Packing<D>, law: &L) -> Result<Inspection, Box<dyn std::error::Error>> {
    let network = ContactNetwork::new(packing, law)?;
    let assembly = jamscope::contact::Assembly::new(packing, *law)?;
    let volume = packing.domain().volume();
    let contacts = &network.contacts;
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, jamscope::vector::larger);
    let mean_contact_force = network.mean_contact_force();
    let on_backbone = largest(
        &mut (0..packing.len())
            .filter(|&disk| network.backbone[disk] && !packing.held()[disk])
            .map(|disk| norm(network.forces()[disk])),
    );
    Ok(Inspection {
        dimension: D,
        disk_count: packing.len(),
        held_count: packing.held().iter().filter(|&&held| held).count(),
        box_sides: match packing.domain() {
            Domain::Periodic { lengths, .. } => Some(lengths.to_vec()),
            Domain::Open => None,
        },
        packing_fraction: packing.packing_fraction(),
        energy: network.energy(),
        pressure: volume.map(|volume| network.pressure(volume)),
        stress: volume.map(|volume| network.stress(volume).iter().map(|row| row.to_vec()).collect()),
        contact_count: contacts.len(),
        backbone_contact_count: network.backbone_contacts().count(),
        rattler_count: network.rattlers().count(),
        coordination: network.coordination(),
        isostatic_coordination: 2 * D,
        mean_contact_force,
        largest_contact_force: largest(&mut contacts.iter().map(|contact| contact.force)),
        largest_net_force: network.largest_net_force(),
        relative_residual: if mean_contact_force > 0.0 { on_backbone / mean_contact_force } else { 0.0 },
        rounding_floor: rounding_floor(&assembly),
        mean_overlap: contacts.iter().map(|contact| contact.overlap).sum::<f64>() / contacts.len().max(1) as f64,
        largest_overlap: largest(&mut contacts.iter().map(|contact| contact.overlap)),
    })
}

impl std::fmt::Display for Inspection {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let disks = if self.dimension == 2 { "disks" } else { "balls" };
        writeln!(f, "{disks:<28} {}", self.disk_count)?;
        if self.held_count > 0 {
            writeln!(f, "{:<28} {}", "held", self.held_count)?;
        }
        match &self.box_sides {
            Some(sides) => {
                let sides: Vec<String> = sides.iter().map(f64::to_string).collect();
                writeln!(f, "{:<28} {} [length]", "periodic box", sides.join(" x "))?;
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
        writeln!(
            f,
            "{:<28} {:e} (rounding floor {:e}) [1]",
            "relative residual", self.relative_residual, self.rounding_floor
        )
    }
}
