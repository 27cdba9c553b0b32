//! Limits on memory and time.

use crate::memory::Limit;

/// Largest number of degrees of a spectrum and its sources together: the recursion of the harmonics overflows beyond
/// 1400.
pub const MOST_DEGREES: usize = 1000;

/// Largest number of bins of a correlation function: less than a tenth of a degree each.
pub const MOST_BINS: usize = 2000;

/// Largest number of spheres whose pairs are summed: 4·10⁹ pairs, some minutes.
pub const MOST_PAIRED: usize = 90_000;

/// An upper limit on a count.
pub(super) const fn at_most(largest: usize) -> Limit {
    Limit { largest: largest as u64, reason: "a limit on memory and time" }
}
