//! [`PreparationError`]: why a packing could not be prepared.

use crate::packing::PackingError;
use crate::relax::Stop;

/// Why a packing could not be prepared.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PreparationError {
    /// The disks themselves are invalid.
    #[error(transparent)]
    Packing(#[from] PackingError),
    /// φ must be above 0 and below 4: at 4 every disk overlaps all of a dozen neighbours.
    #[error("packing_fraction is {packing_fraction}, not a number between 0 and 4")]
    PackingFractionOutOfRange {
        /// The packing fraction given.
        packing_fraction: f64,
    },
    /// p must be positive: p = 0 leaves the packing fraction open.
    #[error(
        "pressure is {pressure}, not a positive number (for an unjammed packing give a packing_fraction below jamming)"
    )]
    PressureNotPositive {
        /// The pressure given.
        pressure: f64,
    },
    /// p must be below the pressure of disks at φ = 4.
    #[error(
        "pressure is {pressure}: must be at most {largest}, about the pressure at packing fraction 4, where every disk overlaps a dozen neighbours"
    )]
    PressureOutOfReach {
        /// The pressure given.
        pressure: f64,
        /// Estimate of the pressure at φ = 4.
        largest: f64,
    },
    /// The sides of a box must be positive.
    #[error("side_ratio is {side_ratio}, not a positive number")]
    SideRatioNotPositive {
        /// The ratio given.
        side_ratio: f64,
    },
    /// The tolerance on the pressure must lie between 0 and 1.
    #[error("pressure tolerance is {tolerance}, not a number between 0 and 1")]
    ToleranceOutOfRange {
        /// The tolerance given.
        tolerance: f64,
    },
    /// A packing in the open plane has no packing fraction and no pressure.
    #[error("the packing lies in the open plane: only a periodic box can be compressed")]
    NotPeriodic,
    /// A relaxation did not end at rest.
    #[error(
        "at packing fraction {packing_fraction} the relaxation stopped with {stop:?} after {step_count} steps, residual {residual:e}"
    )]
    NotAtRest {
        /// Packing fraction of that relaxation.
        packing_fraction: f64,
        /// Why it stopped.
        stop: Stop,
        /// Steps taken.
        step_count: usize,
        /// Relative residual reached.
        residual: f64,
    },
    /// The search did not meet the pressure.
    #[error(
        "pressure {target} not reached within a relative tolerance of {tolerance} after {relaxation_count} relaxations: the nearest pressure is {nearest}, at packing fraction {packing_fraction}"
    )]
    PressureNotReached {
        /// Target pressure.
        target: f64,
        /// Relative tolerance.
        tolerance: f64,
        /// Number of relaxations.
        relaxation_count: usize,
        /// Nearest pressure reached.
        nearest: f64,
        /// Packing fraction there.
        packing_fraction: f64,
    },
}
