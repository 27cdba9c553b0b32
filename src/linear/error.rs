//! [`LinearError`]: why there is no solution.

use crate::memory::TooLarge;
use crate::packing::PackingError;

/// Why there is no solution.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LinearError {
    /// The number of modes exceeds the memory.
    #[error(transparent)]
    TooLarge(#[from] TooLarge),
    /// The disks themselves are invalid.
    #[error(transparent)]
    Packing(#[from] PackingError),
    /// No disk is on the backbone.
    #[error("no mobile disk of {disk_count} is on the backbone: an unjammed packing has no linear response")]
    NoBackbone {
        /// Number of disks.
        disk_count: usize,
    },
    /// The disk to inflate has no contact with the backbone.
    #[error("disk {disk} has no contact with the backbone: inflating it by an infinitesimal amount moves nothing")]
    CentreTouchesNothing {
        /// The disk: its index, from 0, or its label if a report contains the error.
        disk: usize,
    },
    /// No disk is to grow.
    #[error("no disk is given to grow")]
    NothingGrows,
    /// No disk has this index.
    #[error("disk {disk} does not exist: there are {disk_count} disks, counted from 0")]
    NoSuchDisk {
        /// The index given.
        disk: usize,
        /// Number of disks.
        disk_count: usize,
    },
    /// A load is not finite.
    #[error("the load on disk {disk} is not a finite vector")]
    LoadNotFinite {
        /// The disk.
        disk: usize,
    },
    /// The numbers of loads and disks differ.
    #[error("{found} forces for {disk_count} disks: there must be one force per disk")]
    LoadNotOneADisk {
        /// Number of forces.
        found: usize,
        /// Number of disks.
        disk_count: usize,
    },
    /// A displacement is given for a disk that is not held.
    #[error("disk {disk} is not held: a displacement can be given only for held disks")]
    NotHeld {
        /// The disk.
        disk: usize,
    },
    /// An entry is NaN or infinite.
    #[error("the matrix has the entry {value} in row {row}, column {column}, which is not finite")]
    NotFinite {
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// The pattern of entries differs from that of the analysed matrix.
    #[error("the matrix of {dimension} rows has another sparsity pattern than the matrix that was analysed")]
    PatternDiffers {
        /// Its number of rows.
        dimension: usize,
    },
    /// An elimination order contains a row twice, an invalid row, or not all rows.
    #[error("the order of elimination has row {row} in place {place}: must be a permutation of the {dimension} rows")]
    NotAnOrder {
        /// Number of rows of the matrix.
        dimension: usize,
        /// The invalid place, from 0.
        place: usize,
        /// The row at that place.
        row: usize,
    },
    /// The matrix has no Cholesky factor.
    #[error("the matrix of {dimension} rows is not positive definite")]
    NotPositiveDefinite {
        /// Its number of rows.
        dimension: usize,
    },
    /// Singular to rounding: a motion has no stiffness.
    #[error(
        "the matrix is singular within rounding: the ratio of its smallest to its largest pivot is {pivot_ratio:e}"
    )]
    Singular {
        /// Smallest over largest absolute value of a pivot; for a definite matrix, an upper bound of the inverse
        /// condition number.
        pivot_ratio: f64,
    },
    /// Refinement does not reduce the backward error to rounding.
    #[error("the backward error of the solution stays at {backward_error:e} after {refinement_count} refinements")]
    NotAccurate {
        /// ‖b − A x‖ / (‖A‖ ‖x‖ + ‖b‖) reached.
        backward_error: f64,
        /// Refinements made.
        refinement_count: usize,
    },
    /// Conjugate gradients did not converge.
    #[error("the backward error is {backward_error:e} after {iteration_count} iterations, the iteration limit")]
    IterationsUsedUp {
        /// Iterations made.
        iteration_count: usize,
        /// ‖b − A x‖ / (‖A‖ ‖x‖ + ‖b‖) reached.
        backward_error: f64,
    },
    /// Held disks do not follow the strain of a box.
    #[error("{held_count} disks are held: elastic moduli need a periodic packing without held disks")]
    HeldDisks {
        /// Number of held disks.
        held_count: usize,
    },
    /// There is no box to strain.
    #[error("the packing lies in the open plane: elastic moduli need a periodic packing")]
    NotPeriodic,
    /// Sites do not follow the strain of a box.
    #[error("sites act on the disks with Γ = {coupling}: elastic moduli need an energy without sites")]
    OnSites {
        /// Γ of the law.
        coupling: f64,
    },
    /// Not all requested modes were found.
    #[error(
        "{found} of {asked} modes were found within {tolerance:e} of the matrix norm after {factorisation_count} factorisations"
    )]
    ModesNotFound {
        /// Number found.
        found: usize,
        /// Number requested.
        asked: usize,
        /// Limit of the residual over the norm.
        tolerance: f64,
        /// Factorisations made.
        factorisation_count: usize,
    },
    /// Not enough memory for the factors: they would take more than a third of that of the machine.
    #[error("the factors of a matrix of {dimension} rows do not fit in memory")]
    OutOfMemory {
        /// Its number of rows.
        dimension: usize,
    },
}

impl LinearError {
    /// The same error with disks named by their labels, as a file numbers them.
    #[must_use]
    pub fn with_labels(self, labels: &[u64]) -> Self {
        match self {
            LinearError::Packing(error) => LinearError::Packing(error.with_labels(labels)),
            LinearError::CentreTouchesNothing { disk } => {
                let label = labels.get(disk).and_then(|&label| usize::try_from(label).ok());
                LinearError::CentreTouchesNothing { disk: label.unwrap_or(disk) }
            }
            other => other,
        }
    }
}
