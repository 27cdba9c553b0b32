//! Pieces of one computation on several threads.
//!
//! Each piece has its own place for what it writes, and results come back in the order of the pieces, so no bit depends
//! on the number of threads. Inside a thread pool, where samples of an ensemble already run side by side, everything stays on
//! the thread it is on: a thread that waited for a piece would take up another sample meanwhile.

#[cfg(feature = "parallel")]
use std::sync::{Mutex, PoisonError};

/// Fewest pieces that are worth waking other threads for.
#[cfg(feature = "parallel")]
const LEAST_PIECES: usize = 4;

/// Disks of a piece of a long column that is not cut otherwise; fixed, so the bits do not depend on the number of threads.
pub const PIECE: usize = 1 << 14;

/// Whether so many pieces would be worked on by several threads.
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

/// Overwrites a column by `count` things that are made each on its own; none is copied, and memory is first touched by who writes it.
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

/// Applies `work` to every piece; the results in the order of the pieces.
///
/// # Panics
/// If `work` does.
pub fn each<T: Send, R: Send>(pieces: impl Iterator<Item = T>, work: impl Fn(T) -> R + Send + Sync) -> Vec<R> {
    #[cfg(not(feature = "parallel"))]
    return pieces.map(work).collect();
    #[cfg(feature = "parallel")]
    {
        let pieces: Vec<T> = pieces.collect();
        if !is_shared(pieces.len()) {
            return pieces.into_iter().map(work).collect();
        }
        let places: Vec<Mutex<Place<T, R>>> =
            pieces.into_iter().map(|piece| Mutex::new(Place::Waiting(piece))).collect();
        for_each_index(places.len(), &|index| {
            let mut place = places[index].lock().unwrap_or_else(PoisonError::into_inner);
            if let Place::Waiting(piece) = std::mem::replace(&mut *place, Place::Taken) {
                *place = Place::Done(work(piece));
            }
        });
        let result = |place: Mutex<Place<T, R>>| match place.into_inner().unwrap_or_else(PoisonError::into_inner) {
            Place::Done(result) => result,
            Place::Waiting(_) | Place::Taken => unreachable!("every index comes once"),
        };
        places.into_iter().map(result).collect()
    }
}

/// A piece of a computation that several threads share.
#[cfg(feature = "parallel")]
enum Place<T, R> {
    Waiting(T),
    Taken,
    Done(R),
}

/// Calls `work` once for every index below `count`, on several threads.
///
/// Not generic: what a thread pool needs is compiled once, not for every piece of work.
#[cfg(feature = "parallel")]
fn for_each_index(count: usize, work: &(dyn Fn(usize) + Sync)) {
    use rayon::prelude::*;
    (0..count).into_par_iter().with_max_len(1).for_each(work);
}
