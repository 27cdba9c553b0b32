//! Linear algebra of packings at rest: sparse factorisations of the [`Hessian`], the answer
//! to an infinitesimal inflation or strain, and vibrational modes.
//!
//! Start from [`LinearResponse`], [`ElasticModuli`] or [`VibrationalModes`], or from [`Analysis`] for a matrix of one's own.
//! A definite matrix is factorised by Cholesky, an indefinite one as L D Lᵀ with the number of its negative eigenvalues; every solution is refined and comes
//! with its backward error.
//!
//! ```
//! use jamscope::law::Hertzian;
//! use jamscope::linear::{Hessian, Members, Prestress};
//! use jamscope::lattice::Lattice;
//! use jamscope::linear::Analysis;
//!
//! let circle = Lattice::triangular(0.5, 0.05)?.circle(8.0)?;
//! let hessian = Hessian::new(&circle.packing, &Hertzian::default(), Members::Backbone, Prestress::Included)?;
//! // One analysis serves all matrices with entries in the same places.
//! let mut analysis = Analysis::of(&hessian)?;
//! let mut factors = analysis.factorise(hessian.matrix())?;
//! assert!(factors.is_cholesky() && factors.negative_eigenvalue_count() == 0);
//! // Every disk pushed along x.
//! let push = hessian.gather(&vec![[1.0, 0.0]; circle.packing.len()]);
//! let mut moved = vec![0.0; push.len()];
//! let told = factors.solve(&push, &mut moved)?;
//! assert!(told.backward_error < 1e-15);
//! assert!(hessian.scatter(&moved)[circle.centre] == [0.0, 0.0], "the centre is held");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod contact_changes;
mod dissection;
pub mod factorisation;
pub mod hessian;
pub mod iterative;
mod lanczos;
pub mod modes;
pub mod moduli;
pub mod ordering;
pub mod response;
pub mod solution;

pub use contact_changes::ContactChange;
pub use factorisation::Analysis;
pub use hessian::{Hessian, Members, Prestress};
pub use modes::VibrationalModes;
pub use moduli::ElasticModuli;
pub use response::LinearResponse;
pub use solution::{Factorisation, Solution};

use crate::memory::TooLarge;
use crate::network::ContactNetwork;
use crate::packing::{Packing, PackingError};

/// The packing with the first disk of its backbone held, where nothing holds it: no rigid motion is left, and since
/// internal forces add up to nothing, holding one disk costs none. None without a backbone.
///
/// K with the rows of one disk taken out has as many negative eigenvalues as K: every displacement is one that leaves the
/// disk where it is plus a translation, and a translation costs nothing.
pub(crate) fn pinned<const D: usize>(
    packing: &Packing<D>,
    network: &ContactNetwork<D>,
) -> Result<Option<Packing<D>>, PackingError> {
    let Some(first) = network.backbone.iter().position(|&member| member) else { return Ok(None) };
    packing.clone().with_held((0..packing.len()).map(|disk| disk == first).collect()).map(Some)
}

/// Why there is no solution.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LinearError {
    /// More modes than memory holds.
    #[error(transparent)]
    TooLarge(#[from] TooLarge),
    /// The disks themselves are at fault.
    #[error(transparent)]
    Packing(#[from] PackingError),
    /// Nothing to solve for: no disk is on the backbone.
    #[error("no mobile disk of {disk_count} is on the backbone: an unjammed packing has no linear response")]
    NoBackbone {
        /// Number of disks.
        disk_count: usize,
    },
    /// The disk to inflate touches no disk that could answer.
    #[error("disk {disk} has no contact with the backbone: inflating it by an infinitesimal amount moves nothing")]
    CentreTouchesNothing {
        /// The disk.
        disk: usize,
    },
    /// There is no such disk.
    #[error("disk {disk} of {disk_count}: there is none")]
    NoSuchDisk {
        /// The index asked for.
        disk: usize,
        /// Number of disks.
        disk_count: usize,
    },
    /// A load that is not a number.
    #[error("the load on disk {disk} is not a finite vector")]
    LoadNotFinite {
        /// The disk.
        disk: usize,
    },
    /// Loads and disks differ in number.
    #[error("{found} forces for {disk_count} disks")]
    LoadNotOneADisk {
        /// Number of forces.
        found: usize,
        /// Number of disks.
        disk_count: usize,
    },
    /// Only held disks can be moved at will.
    #[error("disk {disk} is not held: its displacement is part of the answer")]
    NotHeld {
        /// The disk.
        disk: usize,
    },
    /// An entry is NaN or infinite.
    #[error("the matrix has the entry {value} in row {row}, column {column}")]
    NotFinite {
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// Entries stand elsewhere than in the matrix analysed.
    #[error("the matrix of {dimension} rows does not have the pattern that was analysed")]
    PatternDiffers {
        /// Its number of rows.
        dimension: usize,
    },
    /// An order of elimination names a row twice, one that is not there, or not every row.
    #[error("the order of elimination has row {row} in place {place}, which is no order of {dimension} rows")]
    NotAnOrder {
        /// Number of rows of the matrix.
        dimension: usize,
        /// The place at fault, from 0.
        place: usize,
        /// The row found there.
        row: usize,
    },
    /// A Cholesky factor was asked for and there is none.
    #[error("the matrix of {dimension} rows is not positive definite")]
    NotPositiveDefinite {
        /// Its number of rows.
        dimension: usize,
    },
    /// Singular to rounding: some motion costs nothing.
    #[error("the matrix is singular to rounding: its pivots span {pivot_ratio:e}, smallest over largest")]
    Singular {
        /// Smallest over largest size of a pivot; for a definite matrix the inverse condition number lies below it.
        pivot_ratio: f64,
    },
    /// Refinement does not bring the backward error down to rounding.
    #[error("the backward error of the solution stays at {backward_error:e} after {refinement_count} refinements")]
    NotAccurate {
        /// ‖b − A x‖ / (‖A‖ ‖x‖ + ‖b‖) reached.
        backward_error: f64,
        /// Refinements made.
        refinement_count: usize,
    },
    /// Conjugate gradients did not come to an end.
    #[error("the backward error is {backward_error:e} after {iteration_count} iterations, all that were allowed")]
    IterationsUsedUp {
        /// Iterations made.
        iteration_count: usize,
        /// ‖b − A x‖ / (‖A‖ ‖x‖ + ‖b‖) reached.
        backward_error: f64,
    },
    /// Held disks do not follow the strain of a box.
    #[error("{held_count} disks are held: elastic moduli are those of a periodic packing that nothing holds")]
    HeldDisks {
        /// Number of held disks.
        held_count: usize,
    },
    /// There is no box to strain.
    #[error("the packing lies in the open plane: elastic moduli are those of a periodic packing")]
    NotPeriodic,
    /// Sites do not follow the strain of a box.
    #[error("sites hold or push the disks with Γ = {coupling}: the energy is not one of the strain alone")]
    OnSites {
        /// Γ of the law.
        coupling: f64,
    },
    /// Not all modes asked for were found.
    #[error(
        "{found} of {asked} modes were found to {tolerance:e} of the norm after {factorisation_count} factorisations"
    )]
    ModesNotFound {
        /// Number found.
        found: usize,
        /// Number asked for.
        asked: usize,
        /// Residual over norm they should have.
        tolerance: f64,
        /// Factorisations made.
        factorisation_count: usize,
    },
    /// No memory for the factors.
    #[error("the factors of a matrix of {dimension} rows do not fit in memory")]
    OutOfMemory {
        /// Its number of rows.
        dimension: usize,
    },
}
