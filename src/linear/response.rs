//! [`LinearResponse`]: how a packing answers an infinitesimal load: one disk growing, forces, or held disks moved.
//!
//! ```text
//! growth          K u = Σ_(contacts of the centre) [F' + F ∂ln c/∂R_0] n        u: displacement per d_0
//! forces          K u = f
//! displacements   K u = −K_(held) u_held
//! ```
//!
//! Growing the centre disk by d_0 adds d_0 to the overlap of each of its contacts, and changes the coefficient c of the law
//! where that depends on the radii (Hertzian: R_ij grows). n points away from the centre. This is the limit of
//! [`inflate`](crate::inflation::inflate) for d_0 → 0 as long as no contact opens or closes; u may be one at a saddle as
//! well, which no relaxer reaches.

use crate::forces::assembly::Assembly;
use crate::forces::elastic::geometry;
use crate::law::pair_law::PairLaw;
use crate::linear::error::LinearError;
use crate::linear::factorisation::Analysis;
use crate::linear::hessian::{Hessian, Members, Prestress};
use crate::network::ContactNetwork;
use crate::packing::Packing;
use crate::vector::{Vector, difference, scaled, sum};

/// Displacements of all disks of a packing per unit of what was done to it.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearResponse<const D: usize> {
    /// Index of the disk that grows; none where the load is another.
    pub growing: Option<usize>,
    /// Displacement of each disk, 0 for those off the backbone: per d_0 \[1\] of a disk that grows, else \[length\].
    pub displacements: Vec<Vector<D>>,
    /// Whether each disk has been solved for.
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
    /// The disk is held if the packing says so, as in a circle. Where nothing is held and no site holds the packing, the
    /// centre of mass of the backbone stays where it is, as in the periodic box of [`inflate`](crate::inflation::inflate).
    ///
    /// # Errors
    /// [`LinearError`] says why there is none.
    ///
    /// # Cost
    /// One analysis, one factorisation, and two solutions or more: 24 ms for 5 586 disks in two dimensions, 0.8 s for 89 232
    /// (`cargo bench --bench linear`, one of two shared cores).
    pub fn of_inflation<L: PairLaw>(
        packing: &Packing<D>,
        centre: usize,
        law: &L,
        prestress: Prestress,
    ) -> Result<Self, LinearError> {
        exists(packing, centre)?;
        with_solver(packing, Some(centre), (law, prestress), |assembly, hessian, solve| {
            Ok(LinearResponse { growing: Some(centre), ..solve(&push_of(assembly, hessian, centre)?)? })
        })
    }

    /// The responses of a packing at rest to the growth of one disk after another, each given to `visit`: one factorisation for
    /// all of them. Each is that of [`LinearResponse::of_inflation`], but for rounding where nothing holds the packing.
    ///
    /// # Errors
    /// As [`LinearResponse::of_inflation`]; no disk after the one at fault is visited.
    ///
    /// # Cost
    /// A solution a disk, a tenth of the time that one alone takes (the table of the chapter).
    pub fn of_inflations<L: PairLaw>(
        packing: &Packing<D>,
        centres: &[usize],
        law: &L,
        prestress: Prestress,
        mut visit: impl FnMut(Self),
    ) -> Result<(), LinearError> {
        centres.iter().try_for_each(|&centre| exists(packing, centre))?;
        with_solver(packing, None, (law, prestress), |assembly, hessian, solve| {
            centres.iter().try_for_each(|&centre| {
                visit(LinearResponse { growing: Some(centre), ..solve(&push_of(assembly, hessian, centre)?)? });
                Ok(())
            })
        })
    }

    /// The response to a force on each disk \[force\]. Forces on held disks and on those off the backbone do nothing.
    ///
    /// Where nothing is held and no site holds the packing, a force on the packing as a whole has no answer: its mean over the
    /// disks of the backbone is taken away, and their centre of mass stays where it is.
    ///
    /// # Shape
    /// One force a disk.
    ///
    /// # Errors
    /// A force that is not finite, or not one a disk; else as [`LinearResponse::of_inflation`].
    pub fn of_forces<L: PairLaw>(
        packing: &Packing<D>,
        forces: &[Vector<D>],
        law: &L,
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
                // The disk pinned in place of the packing answers for its own force through the sum of all.
                let backbone = Hessian::new(packing, assembly.law(), Members::Backbone, prestress)?;
                let total = backbone.disks().iter().fold([0.0; D], |total, &disk| sum(total, forces[disk as usize]));
                let mean = scaled(1.0 / backbone.disks().len() as f64, total);
                forces.iter_mut().for_each(|force| *force = difference(*force, mean));
            }
            solve(&hessian.gather(&forces))
        })
    }

    /// The response to held disks moved by these \[length\]; held disks not named stay.
    ///
    /// # Errors
    /// A disk that is not there or not held, a displacement that is not finite; else as [`LinearResponse::of_inflation`].
    pub fn of_displacements<L: PairLaw>(
        packing: &Packing<D>,
        moved: &[(usize, Vector<D>)],
        law: &L,
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

/// Whether nothing holds the packing as a whole.
fn floats<const D: usize, L: PairLaw>(packing: &Packing<D>, law: &L) -> bool {
    !packing.held().contains(&true) && law.on_site_coupling() == 0.0
}

/// Calls a function with what solves for a load on the unknowns. Where the packing floats a disk is pinned, `pin` or one of the
/// backbone, and the mean taken out.
fn with_solver<const D: usize, L: PairLaw, T>(
    packing: &Packing<D>,
    pin: Option<usize>,
    (law, prestress): (&L, Prestress),
    call: impl FnOnce(
        &Assembly<D, L>,
        &Hessian<D>,
        &mut dyn FnMut(&[f64]) -> Result<LinearResponse<D>, LinearError>,
    ) -> Result<T, LinearError>,
) -> Result<T, LinearError> {
    let disk_count = packing.len();
    let floating = floats(packing, law);
    // Nothing holds the packing as a whole: a disk does, and the shift is taken out again below. The forces of the load add
    // up to nothing, so holding it costs none.
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
    let assembly = Assembly::new(packing, *law)?;
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
            // Of the backbone: those solved for, and the one that is pinned. Rattlers stay.
            let total = displacements.iter().fold([0.0; D], |total, &u| sum(total, u));
            let mean = scaled(1.0 / (hessian.disks().len() + 1) as f64, total);
            for (disk, u) in displacements.iter_mut().enumerate() {
                if solved[disk] || packing.held()[disk] {
                    *u = difference(*u, mean);
                }
            }
        }
        Ok(LinearResponse {
            growing: None,
            displacements,
            solved: solved.clone(),
            unknown_count: push.len(),
            negative_eigenvalue_count: factorisation.negative_eigenvalue_count(),
            backward_error: solution.backward_error,
            pivot_ratio: factorisation.pivot_ratio(),
        })
    })
}

/// Forces per d_0 on the unknowns when the disk `centre` grows.
///
/// # Errors
/// A disk that touches nothing that could answer.
fn push_of<const D: usize, L: PairLaw>(
    assembly: &Assembly<D, L>,
    hessian: &Hessian<D>,
    centre: usize,
) -> Result<Vec<f64>, LinearError> {
    let (pairs, law, radii) = (assembly.pairs(), assembly.law(), assembly.radii());
    let mut push = vec![0.0; hessian.matrix().dimension()];
    let grows = |disk: u32| assembly.order()[disk as usize] as usize == centre;
    for pair in pairs.numbers() {
        let (first, second) = (pairs.first[pair], pairs.second[pair]);
        if !(grows(first) || grows(second)) {
            continue;
        }
        let (apart, distance, overlap) = geometry(pairs, pair, &assembly.displacements);
        // A neighbour off the backbone takes its contact with it; held ones keep theirs.
        let absent = |disk: u32| (disk as usize) < assembly.mobile_count() && hessian.row_of(disk).is_none();
        if overlap <= 0.0 || absent(first) || absent(second) {
            continue;
        }
        let (growing, other) = if grows(first) { (first, second) } else { (second, first) };
        let force = law.force(pairs.coefficient(pair), overlap);
        let growth = law.coefficient_growth(radii[growing as usize], radii[other as usize]);
        let push_on_first = scaled((law.stiffness(force, overlap) + force * growth) / distance, apart);
        for (disk, sign) in [(first, 1.0), (second, -1.0)] {
            if let Some(row) = hessian.row_of(disk) {
                for d in 0..D {
                    push[row + d] += sign * push_on_first[d];
                }
            }
        }
    }
    let touched = push.iter().any(|&value| value != 0.0);
    if touched { Ok(push) } else { Err(LinearError::CentreTouchesNothing { disk: centre }) }
}
