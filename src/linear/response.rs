//! [`LinearResponse`]: the response of a packing to an infinitesimal load: growth of a disk, forces, or displacements
//! of held disks.
//!
//! ```text
//! growth          K u = Σ_(contacts of the centre) [F' + F ∂ln c/∂R_0] n        u: displacement per d_0
//! forces          K u = f
//! displacements   K u = −K_(held) u_held
//! ```
//!
//! Growing the centre disk by d_0 adds d_0 to the overlap of each of its contacts. It also changes the coefficient c of
//! the law if that depends on the radii (Hertzian: R_ij grows). n points away from the centre. This is the limit of
//! [`inflate`](crate::inflation::inflate) for d_0 → 0 if no contact opens or closes. The response also exists at a
//! saddle, which no relaxer reaches.

use crate::forces::assembly::Assembly;
use crate::forces::elastic::geometry;
use crate::law::pair_law::PairLaw;
use crate::linear::error::LinearError;
use crate::linear::factorisation::Analysis;
use crate::linear::hessian::{Hessian, Members, Prestress};
use crate::network::ContactNetwork;
use crate::packing::Packing;
use crate::vector::{Vector, difference, scaled, sum};

/// Displacements of all disks of a packing per unit load.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearResponse<const D: usize> {
    /// Indices of the growing disks, ascending; empty for other loads.
    pub growing: Vec<usize>,
    /// Displacement of each disk, 0 for those off the backbone: per d_0 \[1\] if a disk grows, otherwise \[length\].
    pub displacements: Vec<Vector<D>>,
    /// Whether each disk is among the unknowns.
    pub solved: Vec<bool>,
    /// Number of unknowns.
    pub unknown_count: usize,
    /// Number of negative eigenvalues of the matrix: 0 at a minimum, more at a saddle.
    pub negative_eigenvalue_count: usize,
    /// Backward error of the solution \[1\].
    pub backward_error: f64,
    /// Smallest over largest pivot of the factorisation \[1\].
    pub pivot_ratio: f64,
}

impl<const D: usize> LinearResponse<D> {
    /// The response of a packing at rest to the growth of a disk.
    ///
    /// The disk is held if it is held in the packing, as in a circle. If neither held disks nor sites hold the packing,
    /// the centre of mass of the backbone is fixed, as in the periodic box of [`inflate`](crate::inflation::inflate).
    ///
    /// # Errors
    /// [`LinearError`].
    ///
    /// # Cost
    /// One analysis, one factorisation, and at least two solutions (`cargo bench --features measurements --bench linear`).
    pub fn of_inflation(
        packing: &Packing<D>,
        centre: usize,
        law: &dyn PairLaw,
        prestress: Prestress,
    ) -> Result<Self, LinearError> {
        Self::of_growth(packing, &[centre], law, prestress)
    }

    /// The response of a packing at rest to the growth of several disks at once, such as the row of a strip: each grows by
    /// d_0.
    ///
    /// # Errors
    /// See [`LinearResponse::of_inflation`]; no disk given, or one twice.
    pub fn of_growth(
        packing: &Packing<D>,
        growing: &[usize],
        law: &dyn PairLaw,
        prestress: Prestress,
    ) -> Result<Self, LinearError> {
        growing.iter().try_for_each(|&disk| exists(packing, disk))?;
        let mut growing = growing.to_vec();
        growing.sort_unstable();
        with_solver(packing, growing.first().copied(), (law, prestress), |assembly, hessian, solve| {
            let push = push_of(assembly, hessian, &growing)?;
            Ok(LinearResponse { growing: growing.clone(), ..solve(&push)? })
        })
    }

    /// The responses of a packing at rest to the growth of several disks, one at a time, with a single factorisation.
    /// Each is passed to `visit`. Results equal those of [`LinearResponse::of_inflation`], up to rounding if nothing
    /// holds the packing.
    ///
    /// # Errors
    /// See [`LinearResponse::of_inflation`]. After an error, no further disk is visited.
    ///
    /// # Cost
    /// One solution per disk, a tenth of the time of a single response (table in the book).
    pub fn of_inflations(
        packing: &Packing<D>,
        centres: &[usize],
        law: &dyn PairLaw,
        prestress: Prestress,
        mut visit: impl FnMut(Self),
    ) -> Result<(), LinearError> {
        centres.iter().try_for_each(|&centre| exists(packing, centre))?;
        with_solver(packing, None, (law, prestress), |assembly, hessian, solve| {
            centres.iter().try_for_each(|&centre| {
                visit(LinearResponse { growing: vec![centre], ..solve(&push_of(assembly, hessian, &[centre])?)? });
                Ok(())
            })
        })
    }

    /// The response to a force on each disk \[force\]. Forces on held disks and on those off the backbone have no
    /// effect.
    ///
    /// If neither held disks nor sites hold the packing, a net force has no response. The mean force on the backbone is
    /// then subtracted, and its centre of mass is fixed.
    ///
    /// # Shape
    /// One force per disk.
    ///
    /// # Errors
    /// A force that is not finite, or a wrong number of forces; otherwise see [`LinearResponse::of_inflation`].
    pub fn of_forces(
        packing: &Packing<D>,
        forces: &[Vector<D>],
        law: &dyn PairLaw,
        prestress: Prestress,
    ) -> Result<Self, LinearError> {
        if forces.len() != packing.len() {
            return Err(LinearError::LoadNotOneADisk { found: forces.len(), disk_count: packing.len() });
        }
        if let Some(disk) = forces.iter().position(|force| force.iter().any(|value| !value.is_finite())) {
            return Err(LinearError::LoadNotFinite { disk });
        }
        let floating = floats(packing, law);
        with_solver(packing, None, (law, prestress), |assembly, hessian, solve| {
            let mut forces = forces.to_vec();
            if floating {
                // The force on the pinned disk enters through the sum of all forces.
                let backbone = Hessian::new(packing, assembly.law(), Members::Backbone, prestress)?;
                let total = backbone.disks().iter().fold([0.0; D], |total, &disk| sum(total, forces[disk as usize]));
                let mean = scaled(1.0 / backbone.disks().len() as f64, total);
                forces.iter_mut().for_each(|force| *force = difference(*force, mean));
            }
            solve(&hessian.gather(&forces))
        })
    }

    /// The response to displacements of held disks \[length\]; held disks not listed do not move.
    ///
    /// # Errors
    /// An index without a disk, a disk that is not held, a displacement that is not finite; otherwise see
    /// [`LinearResponse::of_inflation`].
    pub fn of_displacements(
        packing: &Packing<D>,
        moved: &[(usize, Vector<D>)],
        law: &dyn PairLaw,
        prestress: Prestress,
    ) -> Result<Self, LinearError> {
        let mut imposed = vec![[0.0; D]; packing.len()];
        for &(disk, displacement) in moved {
            exists(packing, disk)?;
            if !packing.held()[disk] {
                return Err(LinearError::NotHeld { disk });
            }
            if displacement.iter().any(|value| !value.is_finite()) {
                return Err(LinearError::LoadNotFinite { disk });
            }
            imposed[disk] = displacement;
        }
        let mut response =
            with_solver(packing, None, (law, prestress), |_, hessian, solve| solve(&hessian.forces_of_held(&imposed)))?;
        for &(disk, displacement) in moved {
            response.displacements[disk] = displacement;
        }
        Ok(response)
    }
}

fn exists<const D: usize>(packing: &Packing<D>, disk: usize) -> Result<(), LinearError> {
    let disk_count = packing.len();
    if disk < disk_count { Ok(()) } else { Err(LinearError::NoSuchDisk { disk, disk_count }) }
}

/// Whether neither held disks nor sites hold the packing.
fn floats<const D: usize>(packing: &Packing<D>, law: &dyn PairLaw) -> bool {
    !packing.held().contains(&true) && law.on_site_coupling() == 0.0
}

/// Calls a function with a solver for loads on the unknowns. If the packing floats, a disk is pinned (`pin` or one of
/// the backbone), and the mean displacement is subtracted.
fn with_solver<const D: usize, T>(
    packing: &Packing<D>,
    pin: Option<usize>,
    (law, prestress): (&dyn PairLaw, Prestress),
    call: impl FnOnce(
        &Assembly<D>,
        &Hessian<D>,
        &mut dyn FnMut(&[f64]) -> Result<LinearResponse<D>, LinearError>,
    ) -> Result<T, LinearError>,
) -> Result<T, LinearError> {
    let disk_count = packing.len();
    let floating = floats(packing, law);
    // Nothing holds the packing, so one disk is pinned and the translation is subtracted below. The forces of the load
    // add up to zero, so the pinned disk carries no force.
    let pinned;
    let packing = if floating {
        let pin = match pin {
            Some(pin) => Some(pin),
            None => ContactNetwork::new(packing, law)?.backbone.iter().position(|&member| member),
        };
        let held = (0..disk_count).map(|disk| Some(disk) == pin).collect();
        pinned = packing.clone().with_held(held)?;
        &pinned
    } else {
        packing
    };
    let assembly = Assembly::new(packing, law)?;
    let hessian = Hessian::of(&assembly, Members::Backbone, prestress);
    let matrix = hessian.matrix();
    if matrix.dimension() == 0 {
        return Err(LinearError::NoBackbone { disk_count });
    }
    let mut analysis = Analysis::of(&hessian)?;
    let mut factorisation = analysis.factorise(matrix)?;
    let mut solved = vec![false; disk_count];
    hessian.disks().iter().for_each(|&disk| solved[disk as usize] = true);
    call(&assembly, &hessian, &mut |push| {
        let mut unknowns = vec![0.0; push.len()];
        let solution = factorisation.solve(push, &mut unknowns)?;
        let mut displacements = hessian.scatter(&unknowns);
        if floating {
            // Mean over the backbone: the disks solved for and the pinned one. Rattlers do not move.
            let total = displacements.iter().fold([0.0; D], |total, &u| sum(total, u));
            let mean = scaled(1.0 / (hessian.disks().len() + 1) as f64, total);
            for (disk, u) in displacements.iter_mut().enumerate() {
                if solved[disk] || packing.held()[disk] {
                    *u = difference(*u, mean);
                }
            }
        }
        Ok(LinearResponse {
            growing: Vec::new(),
            displacements,
            solved: solved.clone(),
            unknown_count: push.len(),
            negative_eigenvalue_count: factorisation.negative_eigenvalue_count(),
            backward_error: solution.backward_error,
            pivot_ratio: factorisation.pivot_ratio(),
        })
    })
}

/// Forces per d_0 on the unknowns when these disks grow.
///
/// # Errors
/// The disks have no contact with the backbone.
fn push_of<const D: usize>(
    assembly: &Assembly<D>,
    hessian: &Hessian<D>,
    growing: &[usize],
) -> Result<Vec<f64>, LinearError> {
    let (pairs, law, radii) = (assembly.pairs(), assembly.law(), assembly.radii());
    let mut push = vec![0.0; hessian.matrix().dimension()];
    let grows = |disk: u32| growing.binary_search(&(assembly.order()[disk as usize] as usize)).is_ok();
    for pair in pairs.numbers() {
        let (first, second) = (pairs.first[pair], pairs.second[pair]);
        if !(grows(first) || grows(second)) {
            continue;
        }
        let (apart, distance, overlap) = geometry(pairs, pair, &assembly.displacements);
        // A contact with a mobile neighbour off the backbone does not count; contacts with held disks do.
        let absent = |disk: u32| (disk as usize) < assembly.mobile_count() && hessian.row_of(disk).is_none();
        if overlap <= 0.0 || absent(first) || absent(second) {
            continue;
        }
        let force = law.force(pairs.coefficient(pair), overlap);
        // Two growing disks in contact add both their growths.
        let mut magnitude = 0.0;
        for (disk, other) in [(first, second), (second, first)].into_iter().filter(|&(disk, _)| grows(disk)) {
            let growth = law.coefficient_growth(radii[disk as usize], radii[other as usize]);
            magnitude += law.stiffness(force, overlap) + force * growth;
        }
        let push_on_first = scaled(magnitude / distance, apart);
        for (disk, sign) in [(first, 1.0), (second, -1.0)] {
            if let Some(row) = hessian.row_of(disk) {
                for d in 0..D {
                    push[row + d] += sign * push_on_first[d];
                }
            }
        }
    }
    let touched = push.iter().any(|&value| value != 0.0);
    match growing.first() {
        Some(_) if touched => Ok(push),
        Some(&disk) => Err(LinearError::CentreTouchesNothing { disk }),
        None => Err(LinearError::NothingGrows),
    }
}
