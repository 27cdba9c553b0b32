//! Limits on memory and time.

use crate::memory::Limit;

/// Steps or bins of a correlation function: a million of them stand 3 10⁻⁶ rad apart, closer than any two disks can.
pub const MOST_STEPS: usize = 1_000_000;

/// Points of a grid on which a ring is interpolated or binned.
pub const MOST_GRID_POINTS: usize = 1 << 26;

/// Frequencies between which leakage is removed: f_max² numbers and f_max³/3 multiplications, 0.8 GB and some minutes at most.
pub const MOST_COUPLED_FREQUENCIES: usize = 10_000;

/// A limit on what a table may have.
pub(super) const fn at_most(largest: usize) -> Limit {
    Limit { largest: largest as u64, reason: "a limit on memory and time" }
}
