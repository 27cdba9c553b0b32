//! The points at which a solution is evaluated: a list, or evenly spaced points.

use crate::Failure;

/// The list if there is one, otherwise `count` points from `from` to `to`, both included exactly.
pub fn places<'a>(
    list: Option<&'a [f64]>,
    count: u64,
    from: f64,
    to: f64,
) -> Result<Box<dyn Iterator<Item = f64> + 'a>, Failure> {
    if let Some(list) = list {
        return Ok(Box::new(list.iter().copied()));
    }
    if count < 2 {
        return Err(format!("--count {count}: must be at least two, for the first and the last point").into());
    }
    let last = count - 1;
    // The last point is exact, and rounding must not exceed it: there is no solution beyond.
    let place = move |n: u64| (from + (to - from) * (n as f64 / last as f64)).min(to);
    Ok(Box::new((0..count).map(move |n| if n == last { to } else { place(n) })))
}
