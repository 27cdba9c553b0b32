//! [`Certificate`]: what is known of a state at rest, each number by a route of its own.
//!
//! ```text
//! residual      max |f_i| / ⟨F⟩                    beside what rounding alone makes of it
//! contacts      N_c − N_iso                        N_iso = D (N − 1) + 1  in a box under pressure
//! stability     negative eigenvalues of K          the negative pivots of a factorisation (feature `linear`)
//! virial        Σ F r  =  −dE/d ln L               forces against energies of the packing, box and all, a little larger and smaller
//! ```
//!
//! *Isostatic number.* N disks of the backbone that can move have D N degrees of freedom. In a box D of them are translations,
//! so rigidity takes D (N − 1) contacts; a state whose contacts press needs one more, for the balance of forces has a solution
//! other than none only if contacts outnumber its independent equations. Held disks leave no translation: D N. (A state of
//! stress needs one more there too, but contacts across a rim exceed that by far, so the number for rigidity is the one given.)
//!
//! *Bucklers* are disks of the backbone with exactly D + 1 contacts: they can snap through.
//!
//! # Source
//! Goodrich, Liu, Nagel (2012), Phys. Rev. Lett. 109, 095704 (isostatic number of finite packings). Charbonneau, Corwin, Parisi,
//! Zamponi (2015), Phys. Rev. Lett. 114, 125504 (bucklers).

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

/// How far the packing is scaled for the virial identity, over the strain that undoes the mean overlap \[1\]: 2⁻¹⁷. A contact
/// that opens or closes on the way falsifies by its square; the rounding of the energy, 10⁻¹⁶, is divided by it.
const SCALING: f64 = 7.62939453125e-6;

/// What is known of a state.
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
    /// Which limit a relaxer met; absent for a state nobody relaxed here.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub criterion: Option<Criterion>,
    /// Largest net force on a mobile disk of the backbone; of all mobile disks where there is no backbone \[force\].
    pub largest_net_force: f64,
    /// Mean contact force of the same disks \[force\].
    pub mean_contact_force: f64,
    /// The first over the second, 0 without forces \[1\].
    pub relative_residual: f64,
    /// What rounding alone makes of it, by [`rounding_floor`] \[1\].
    pub rounding_floor: f64,
    /// Contacts of the backbone against the isostatic number; absent without a backbone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contacts: Option<ContactCount>,
    /// Mobile disks off the backbone.
    pub rattler_count: usize,
    /// Mobile disks of the backbone with exactly D + 1 contacts on it.
    pub buckler_count: usize,
    /// Whether it is a minimum.
    #[cfg(feature = "linear")]
    pub stability: Stability,
    /// Forces against energies; absent without contacts, where overlaps are below 10⁻¹⁰ of the distances (sides have no digits
    /// for them), and in a box that must not be smaller.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub virial: Option<VirialIdentity>,
}

/// What the backbone rests on, hence how many contacts it needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Support {
    /// A periodic box, contacts that press: D (N − 1) + 1.
    BoxUnderPressure,
    /// A periodic box at rest as [`Criterion::Unjammed`], whose contact forces count as none: D (N − 1).
    Box,
    /// Held disks: D N.
    HeldDisks,
    /// Nothing, in the open plane or space: rotations are free as well, D N − D (D + 1)/2.
    Nothing,
}

/// Contacts of the backbone against the isostatic number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct ContactCount {
    /// Mobile disks of the backbone, N.
    pub disk_count: usize,
    /// Contacts of the backbone, those with held disks included, N_c.
    pub contact_count: usize,
    /// What it rests on.
    pub support: Support,
    /// N_iso, by [`Support`].
    pub isostatic_count: usize,
    /// N_c − N_iso.
    pub excess: i64,
}

/// Two routes to Σ F r \[energy\].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct VirialIdentity {
    /// Σ F r over the contacts: D V times the pressure \[energy\].
    pub from_forces: f64,
    /// −dE/d ln L at fixed radii, by a central difference of energies \[energy\].
    pub from_energies: f64,
    /// Their difference over the first \[1\].
    pub relative_difference: f64,
}

/// Whether a state is a minimum, by the inertia of its Hessian; where nothing holds the packing, translations are left out.
#[cfg(feature = "linear")]
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stability {
    /// The eigenvalues below 0 are counted: none at a minimum.
    Counted {
        /// How many.
        negative_eigenvalue_count: usize,
        /// Smallest over largest pivot \[1\].
        pivot_ratio: f64,
    },
    /// Singular to rounding: some motion costs nothing.
    Singular {
        /// Smallest over largest pivot \[1\].
        pivot_ratio: f64,
    },
    /// There is nothing to be stable.
    NoBackbone,
    /// The factorisation failed, in its own words.
    Unknown(String),
}

impl Certificate {
    /// Looks at a state. `criterion` is that of the relaxation, if there was one.
    ///
    /// # Errors
    /// Two disks with the same centre, a box too small.
    pub fn of<const D: usize, L: PairLaw>(
        packing: &Packing<D>,
        law: &L,
        criterion: Option<Criterion>,
    ) -> Result<Self, PackingError> {
        let assembly = Assembly::new(packing, *law)?;
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

/// Largest net force and mean contact force of the backbone, of all disks where there is none.
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
    /// None without contacts, or where the scaled packing is none.
    fn of<const D: usize, L: PairLaw>(packing: &Packing<D>, law: &L, network: &ContactNetwork<D>) -> Option<Self> {
        let contacts = &network.contacts;
        let overlap: f64 = contacts.iter().map(|contact| contact.overlap).sum();
        let distance: f64 = contacts.iter().map(|contact| norm(contact.separation)).sum();
        let virial = network.stress(1.0);
        let from_forces: f64 = (0..D).map(|axis| virial[axis][axis]).sum();
        let strain = SCALING * overlap / distance;
        // Energies and sides must have digits for the difference. NaN goes on.
        let energy = network.energy();
        if contacts.is_empty() || energy < f64::MIN_POSITIVE / f64::EPSILON || strain < 4.0 * f64::EPSILON {
            return None;
        }
        let (wide, longer) = packing.stretched(strain);
        let (narrow, shorter) = packing.stretched(-strain);
        let more = compensated_energy(&ContactNetwork::new(&wide, law).ok()?);
        let less = compensated_energy(&ContactNetwork::new(&narrow, law).ok()?);
        // Sides are rounded numbers: each axis has its own strain, and the forces are asked for those.
        let expected: f64 = (0..D).map(|axis| virial[axis][axis] * (longer[axis] - shorter[axis])).sum();
        let relative_difference = (extended_sum(less, -more.0).0 - more.1 - expected) / expected;
        Some(VirialIdentity {
            from_forces,
            from_energies: from_forces * (1.0 + relative_difference),
            relative_difference,
        })
    }
}

/// The energy of the contacts, summed without rounding.
fn compensated_energy<const D: usize>(network: &ContactNetwork<D>) -> (f64, f64) {
    network.contacts.iter().fold((0.0, 0.0), |sum, contact| extended_sum(sum, contact.energy))
}

#[cfg(feature = "linear")]
impl Stability {
    fn of<const D: usize, L: PairLaw>(
        packing: &Packing<D>,
        law: &L,
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

    /// Number of negative eigenvalues, where they could be counted.
    pub fn negative_eigenvalue_count(&self) -> Option<usize> {
        match self {
            Stability::Counted { negative_eigenvalue_count, .. } => Some(*negative_eigenvalue_count),
            _ => None,
        }
    }
}
