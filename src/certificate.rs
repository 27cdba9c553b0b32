//! [`Certificate`]: what is known of a state at rest, with independent methods.
//!
//! ```text
//! residual      max |f_i| / ⟨F⟩                    and the part of it that rounding alone causes
//! contacts      N_c − N_iso                        N_iso = D (N − 1) + 1  in a box under pressure
//! stability     negative eigenvalues of K          the negative pivots of a factorisation (feature `linear`)
//! virial        Σ F r  =  −dE/d ln L               forces against energies of the packing in a slightly scaled box
//! ```
//!
//! *Isostatic number.* N mobile disks of the backbone have D N degrees of freedom. In a box, D of them are
//! translations, so rigidity takes D (N − 1) contacts. A packing under pressure needs one contact more: force balance
//! has a non-zero solution only if contacts outnumber its independent equations. With held disks there are no
//! translations, so the number is D N. (A stressed state needs one more here as well, but contacts across the rim
//! exceed it by far. The number for rigidity is used.)
//!
//! *Bucklers* are disks of the backbone with exactly D + 1 contacts: they can buckle.
//!
//! # Source
//! Goodrich, Liu, Nagel (2012), Phys. Rev. Lett. 109, 095704 (isostatic number of finite packings). Charbonneau,
//! Corwin, Parisi, Zamponi (2015), Phys. Rev. Lett. 114, 125504 (bucklers).

use serde::Serialize;

use crate::forces::assembly::Assembly;
use crate::law::pair_law::PairLaw;
#[cfg(feature = "linear")]
use crate::linear::hessian::{Hessian, Members, Prestress};
#[cfg(feature = "linear")]
use crate::linear::pinned::pinned;
#[cfg(feature = "linear")]
use crate::linear::{Analysis, LinearError};
use crate::network::ContactNetwork;
use crate::packing::{Packing, PackingError};
use crate::relax::{Criterion, rounding_floor};
use crate::vector::{extended_sum, larger, norm};

/// Scaling of the packing for the virial identity, over the strain that removes the mean overlap \[1\]: 2⁻¹⁷. A contact
/// that opens or closes causes an error of order of its square. The rounding of the energy, 10⁻¹⁶, is divided by it.
const SCALING: f64 = 7.62939453125e-6;

/// Properties of a state at rest.
///
/// # Cost
/// Three neighbour lists and evaluations, and with the feature `linear` one factorisation.
///
/// # Example
/// ```
/// use jamscope::certificate::{Certificate, Support};
/// use jamscope::law::Hertzian;
/// use jamscope::io::read_packing;
///
/// let packing = read_packing::<2>("fixtures/packings/hertz_N1000_p1.xyz")?;
/// let certificate = Certificate::of(&packing, &Hertzian::default(), None)?;
/// let contacts = certificate.contacts.expect("it is jammed");
/// assert_eq!(contacts.support, Support::BoxUnderPressure);
/// assert_eq!(contacts.isostatic_count, 2 * (contacts.disk_count - 1) + 1);
/// assert!(contacts.excess > 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Certificate {
    /// Limit that a relaxer met; absent for a state that was not relaxed here.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub criterion: Option<Criterion>,
    /// Largest net force on a mobile disk of the backbone; on any mobile disk without a backbone \[force\].
    pub largest_net_force: f64,
    /// Mean contact force of the same disks \[force\].
    pub mean_contact_force: f64,
    /// Ratio of the two, 0 without forces \[1\].
    pub relative_residual: f64,
    /// Part of it that rounding alone causes, by [`rounding_floor`] \[1\].
    pub rounding_floor: f64,
    /// Contacts of the backbone against the isostatic number; absent without a backbone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contacts: Option<ContactCount>,
    /// Mobile disks off the backbone.
    pub rattler_count: usize,
    /// Mobile disks of the backbone with exactly D + 1 contacts to the backbone.
    pub buckler_count: usize,
    /// Whether it is a minimum.
    #[cfg(feature = "linear")]
    pub stability: Stability,
    /// Forces against energies. Absent without contacts, and in a box that is as small as allowed. Also absent if
    /// overlaps are below 10⁻¹⁰ of the distances: sides cannot resolve them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub virial: Option<VirialIdentity>,
}

/// The support of the backbone, which sets its isostatic number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Support {
    /// A periodic box with contacts under pressure: D (N − 1) + 1.
    BoxUnderPressure,
    /// A periodic box at rest as [`Criterion::Unjammed`], whose contact forces count as zero: D (N − 1).
    Box,
    /// Held disks: D N.
    HeldDisks,
    /// No support, in the open plane or space. Rotations are free as well: D N − D (D + 1)/2.
    Nothing,
}

/// Contacts of the backbone against the isostatic number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct ContactCount {
    /// Mobile disks of the backbone, N.
    pub disk_count: usize,
    /// Contacts of the backbone, including those with held disks, N_c.
    pub contact_count: usize,
    /// The support.
    pub support: Support,
    /// N_iso, by [`Support`].
    pub isostatic_count: usize,
    /// N_c − N_iso.
    pub excess: i64,
}

/// Two independent values of Σ F r \[energy\].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct VirialIdentity {
    /// Σ F r over the contacts: D V times the pressure \[energy\].
    pub from_forces: f64,
    /// −dE/d ln L at fixed radii, by central differences of the energy \[energy\].
    pub from_energies: f64,
    /// Their difference over the first value \[1\].
    pub relative_difference: f64,
}

/// Whether a state is a minimum, by the inertia of its Hessian. Without held disks, translations are excluded.
#[cfg(feature = "linear")]
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stability {
    /// The number of negative eigenvalues; 0 at a minimum.
    Counted {
        /// Number of negative eigenvalues.
        negative_eigenvalue_count: usize,
        /// Smallest over largest pivot \[1\].
        pivot_ratio: f64,
    },
    /// Singular to rounding: a motion has no stiffness.
    Singular {
        /// Smallest over largest pivot \[1\].
        pivot_ratio: f64,
    },
    /// There is no backbone.
    NoBackbone,
    /// The factorisation failed, with its error message.
    Unknown(String),
}

impl Certificate {
    /// Analyses a state. `criterion` is that of the relaxation, if there was one.
    ///
    /// # Errors
    /// Two disks with the same centre; a box that is too small.
    pub fn of<const D: usize>(
        packing: &Packing<D>,
        law: &dyn PairLaw,
        criterion: Option<Criterion>,
    ) -> Result<Self, PackingError> {
        let assembly = Assembly::new(packing, law)?;
        let network = ContactNetwork::new(packing, law)?;
        let (largest_net_force, mean_contact_force) = residual(packing, &network);
        let relative_residual = if largest_net_force == 0.0 { 0.0 } else { largest_net_force / mean_contact_force };
        Ok(Certificate {
            criterion,
            largest_net_force,
            mean_contact_force,
            relative_residual,
            rounding_floor: rounding_floor(&assembly),
            contacts: ContactCount::of(packing, &network, criterion != Some(Criterion::Unjammed)),
            rattler_count: network.rattlers().count(),
            buckler_count: buckler_count(packing, &network),
            #[cfg(feature = "linear")]
            stability: Stability::of(packing, law, &network)?,
            virial: VirialIdentity::of(packing, law, &network),
        })
    }
}

/// Largest net force and mean contact force of the backbone; of all disks without a backbone.
fn residual<const D: usize>(packing: &Packing<D>, network: &ContactNetwork<D>) -> (f64, f64) {
    let rigid = network.backbone_count() > 0;
    let net = network.forces().iter().enumerate();
    let net = net.filter(|&(disk, _)| !packing.held()[disk] && (network.backbone[disk] || !rigid));
    let largest = net.fold(0.0, |most, (_, force)| larger(norm(*force), most));
    let mean = if rigid {
        network.mean_contact_force()
    } else {
        let total = network.contacts.iter().fold(0.0, |total, contact| total + contact.force);
        total / network.contacts.len().max(1) as f64
    };
    (largest, mean)
}

fn buckler_count<const D: usize>(packing: &Packing<D>, network: &ContactNetwork<D>) -> usize {
    let mut touched = vec![0usize; packing.len()];
    for contact in network.backbone_contacts() {
        touched[contact.first as usize] += 1;
        touched[contact.second as usize] += 1;
    }
    let members = (0..packing.len()).filter(|&disk| network.backbone[disk] && !packing.held()[disk]);
    members.filter(|&disk| touched[disk] == D + 1).count()
}

impl ContactCount {
    /// None without a backbone.
    fn of<const D: usize>(packing: &Packing<D>, network: &ContactNetwork<D>, pressed: bool) -> Option<Self> {
        let (disk_count, contact_count) = (network.backbone_count(), network.backbone_contacts().count());
        let (support, isostatic_count) = match (packing.held().contains(&true), packing.domain().lengths()) {
            _ if disk_count == 0 => return None,
            (true, _) => (Support::HeldDisks, D * disk_count),
            (false, Some(_)) if pressed => (Support::BoxUnderPressure, D * (disk_count - 1) + 1),
            (false, Some(_)) => (Support::Box, D * (disk_count - 1)),
            (false, None) => (Support::Nothing, (D * disk_count).saturating_sub(D * (D + 1) / 2)),
        };
        let excess = contact_count as i64 - isostatic_count as i64;
        Some(ContactCount { disk_count, contact_count, support, isostatic_count, excess })
    }
}

impl VirialIdentity {
    /// None without contacts, or if the scaled packing is invalid.
    fn of<const D: usize>(packing: &Packing<D>, law: &dyn PairLaw, network: &ContactNetwork<D>) -> Option<Self> {
        let contacts = &network.contacts;
        let overlap: f64 = contacts.iter().map(|contact| contact.overlap).sum();
        let distance: f64 = contacts.iter().map(|contact| norm(contact.separation)).sum();
        let virial = network.stress(1.0);
        let from_forces: f64 = (0..D).map(|axis| virial[axis][axis]).sum();
        let strain = SCALING * overlap / distance;
        // Energies and sides must resolve the difference. NaN is passed on.
        let energy = network.energy();
        if contacts.is_empty() || energy < f64::MIN_POSITIVE / f64::EPSILON || strain < 4.0 * f64::EPSILON {
            return None;
        }
        let uniform = |strain| std::array::from_fn(|a| std::array::from_fn(|b| if a == b { strain } else { 0.0 }));
        let (wide, more_strain) = packing.deformed(&uniform(strain));
        let (narrow, less_strain) = packing.deformed(&uniform(-strain));
        let more = compensated_energy(&ContactNetwork::new(&wide, law).ok()?);
        let less = compensated_energy(&ContactNetwork::new(&narrow, law).ok()?);
        // Edges are rounded numbers: each component has its own strain, and the forces are compared at these strains.
        let work = |a: usize, b: usize| virial[a][b] * (more_strain[a][b] - less_strain[a][b]);
        let expected: f64 = (0..D).flat_map(|a| (0..D).map(move |b| (a, b))).map(|(a, b)| work(a, b)).sum();
        let relative_difference = (extended_sum(less, -more.0).0 - more.1 - expected) / expected;
        Some(VirialIdentity {
            from_forces,
            from_energies: from_forces * (1.0 + relative_difference),
            relative_difference,
        })
    }
}

/// The energy of the contacts by compensated summation.
fn compensated_energy<const D: usize>(network: &ContactNetwork<D>) -> (f64, f64) {
    network.contacts.iter().fold((0.0, 0.0), |sum, contact| extended_sum(sum, contact.energy))
}

#[cfg(feature = "linear")]
impl Stability {
    fn of<const D: usize>(
        packing: &Packing<D>,
        law: &dyn PairLaw,
        network: &ContactNetwork<D>,
    ) -> Result<Self, PackingError> {
        if network.backbone_count() == 0 {
            return Ok(Stability::NoBackbone);
        }
        let floating = !packing.held().contains(&true) && law.on_site_coupling() == 0.0;
        let fixed = if floating { pinned(packing, network)? } else { None };
        let hessian = Hessian::new(fixed.as_ref().unwrap_or(packing), law, Members::Backbone, Prestress::Included)?;
        let matrix = hessian.matrix();
        let counted = Analysis::of(&hessian).and_then(|mut analysis| {
            let factorisation = analysis.factorise(matrix)?;
            Ok((factorisation.negative_eigenvalue_count(), factorisation.pivot_ratio()))
        });
        Ok(match counted {
            Ok((negative_eigenvalue_count, pivot_ratio)) => {
                Stability::Counted { negative_eigenvalue_count, pivot_ratio }
            }
            Err(LinearError::Singular { pivot_ratio }) => Stability::Singular { pivot_ratio },
            Err(error) => Stability::Unknown(error.to_string()),
        })
    }

    /// Number of negative eigenvalues, if it is known.
    pub fn negative_eigenvalue_count(&self) -> Option<usize> {
        match self {
            Stability::Counted { negative_eigenvalue_count, .. } => Some(*negative_eigenvalue_count),
            _ => None,
        }
    }
}
