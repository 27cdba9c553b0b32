//! Memory that is asked for before it is needed, where the machine can be asked: it comes while other work is done.

use crate::processor::{Processor, Roots};

/// Numbers a line of a cache has room for are asked for at once \[bytes\].
pub const LINE: usize = 64;

/// Where memory that is asked for is brought to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cache {
    /// The second cache, since the first one waits for few lines at a time, and what is read from memory meanwhile stands behind them.
    Second,
    /// The first one alone: what a list has of pairs is used once a step, and in the second cache would take the place of the disks.
    First,
}

impl Cache {
    /// That of this machine: the first one is large and quick enough on AMD's fifth generation, on the fourth it is as slow as not to ask.
    #[inline(always)]
    pub fn here() -> Cache {
        match Processor::here().roots() {
            Roots::Instructions => Cache::First,
            Roots::Products | Roots::Quotients => Cache::Second,
        }
    }

    /// Asks for the line that has this place of a column. The place may lie beyond the column; nothing is read for good.
    #[inline(always)]
    pub fn ask<T>(self, column: &[T], place: usize) {
        #[cfg(target_arch = "x86_64")]
        {
            use std::arch::x86_64::{_MM_HINT_NTA, _MM_HINT_T1};
            // Every processor of this kind has these instructions, so nothing is looked up.
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

    /// Asks for so many places of a column, line by line.
    #[inline(always)]
    pub fn ask_for<T>(self, column: &[T], first: usize, count: usize) {
        for place in (0..count).step_by(LINE / size_of::<T>()) {
            self.ask(column, first + place);
        }
    }
}
