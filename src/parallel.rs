//! Parallel work on the pieces of one computation.
//!
//! Each piece writes to its own memory, and results are returned in the order of the pieces. So no bit depends on the
//! number of threads. Inside a thread pool, where samples of an ensemble already run in parallel, all work stays on the
//! current thread. A thread that waited for a piece would otherwise start another sample.

#[cfg(feature = "parallel")]
use std::sync::{Mutex, PoisonError};

/// Fewest pieces for which parallel work pays.
#[cfg(feature = "parallel")]
const LEAST_PIECES: usize = 4;

/// Number of disks in a piece of a long column; fixed, so the bits do not depend on the number of threads.
pub const PIECE: usize = 1 << 14;

/// Whether this number of pieces is distributed over several threads.
pub fn is_shared(piece_count: usize) -> bool {
    #[cfg(feature = "parallel")]
    {
        piece_count >= LEAST_PIECES && rayon::current_thread_index().is_none() && rayon::current_num_threads() > 1
    }
    #[cfg(not(feature = "parallel"))]
    {
        let _ = piece_count;
        false
    }
}

/// Overwrites a column by `count` values, each made separately. No value is copied, and the thread that writes a value
/// touches its memory first.
pub fn fill<T: Send>(column: &mut Vec<T>, count: usize, make: impl Fn(usize) -> T + Send + Sync) {
    #[cfg(feature = "parallel")]
    if is_shared(count) {
        use rayon::prelude::*;
        (0..count).into_par_iter().map(make).collect_into_vec(column);
        return;
    }
    column.clear();
    column.extend((0..count).map(make));
}

/// Applies `work` to every piece; returns the results in the order of the pieces.
///
/// # Panics
/// If `work` panics.
pub fn each<T: Send, R: Send>(pieces: impl Iterator<Item = T>, work: impl Fn(T) -> R + Send + Sync) -> Vec<R> {
    // Plain loops: this is compiled once for every call site, and each `collect` is some hundred lines of machine code.
    let mut results = Vec::new();
    #[cfg(feature = "parallel")]
    {
        let mut places = Vec::new();
        for piece in pieces {
            places.push(Mutex::new((Some(piece), None)));
        }
        let at = |index: usize| {
            let (piece, result) = &mut *places[index].lock().unwrap_or_else(PoisonError::into_inner);
            if let Some(piece) = piece.take() {
                *result = Some(work(piece));
            }
        };
        for_each_index(places.len(), &at);
        for place in places {
            let (_, result) = place.into_inner().unwrap_or_else(PoisonError::into_inner);
            results.push(result.expect("every index comes once"));
        }
    }
    #[cfg(not(feature = "parallel"))]
    for piece in pieces {
        results.push(work(piece));
    }
    results
}

/// Calls `work` once for every index below `count`, on several threads if there are enough indices.
///
/// It is not generic, so the code of the thread pool is compiled only once.
#[cfg(feature = "parallel")]
fn for_each_index(count: usize, work: &(dyn Fn(usize) + Sync)) {
    use rayon::prelude::*;
    if is_shared(count) {
        (0..count).into_par_iter().with_max_len(1).for_each(work);
    } else {
        (0..count).for_each(work);
    }
}
