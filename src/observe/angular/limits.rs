//! Limits on memory and time.

use crate::memory::Limit;

/// Largest number of steps or bins of a correlation function: a million of them are 3·10⁻⁶ rad apart, closer than any
/// two disks.
pub const MOST_STEPS: usize = 1_000_000;

/// Largest number of points of a grid on which a ring is interpolated or binned.
pub const MOST_GRID_POINTS: usize = 1 << 26;

/// Largest number of frequencies with leakage removed: f_max² numbers and f_max³/3 multiplications, 0.8 GB and some
/// minutes.
pub const MOST_COUPLED_FREQUENCIES: usize = 10_000;

/// An upper limit on the size of a table.
pub(super) const fn at_most(largest: usize) -> Limit {
    Limit { largest: largest as u64, reason: "a limit on memory and time" }
}
