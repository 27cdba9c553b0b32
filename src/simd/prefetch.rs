//! Software prefetch: data is loaded into a cache while other work is done.

use crate::processor::{Processor, Roots};

/// Length of a cache line \[bytes\].
const LINE: usize = 64;

/// The cache into which data is prefetched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cache {
    /// The second-level cache. The first-level cache can wait for only a few lines at a time.
    Second,
    /// The first-level cache only. Pairs are used once per step and would displace the disks from the second-level
    /// cache.
    First,
}

impl Cache {
    /// The cache for the present processor, chosen by its type of root instructions.
    #[inline(always)]
    pub fn here() -> Cache {
        match Processor::here().roots() {
            Roots::Instructions => Cache::First,
            Roots::Products | Roots::Quotients => Cache::Second,
        }
    }

    /// Prefetches the cache line of this place of a column. The place may lie beyond the column.
    #[inline(always)]
    pub fn prefetch<T>(self, column: &[T], place: usize) {
        #[cfg(target_arch = "x86_64")]
        {
            use std::arch::x86_64::{_MM_HINT_NTA, _MM_HINT_T1};
            // Every x86-64 processor has these instructions.
            let Some(sse) = pulp::core_arch::x86::Sse::try_new() else { return };
            let at = column.as_ptr().wrapping_add(place).cast();
            match self {
                Cache::Second => sse._mm_prefetch::<_MM_HINT_T1>(at),
                Cache::First => sse._mm_prefetch::<_MM_HINT_NTA>(at),
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        let _ = (self, column, place);
    }

    /// Prefetches consecutive places of a column, line by line.
    #[inline(always)]
    pub fn prefetch_all<T>(self, column: &[T], first: usize, count: usize) {
        for place in (0..count).step_by(LINE / size_of::<T>()) {
            self.prefetch(column, first + place);
        }
    }
}
