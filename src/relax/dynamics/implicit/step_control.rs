//! Step control: the length of the next step, from the ratio of the error of this one to the allowed error.
//!
//! The error of a step grows as the third power of h, for either method.

/// Largest ratio of a step to the previous one. After a rejected step it is 1, because the contact that caused the
/// rejection is usually still close.
pub(crate) const LARGEST_RATIO: f64 = 2.0;

/// Smallest ratio of a step to the previous one.
pub(crate) const SMALLEST_RATIO: f64 = 0.1;

/// Target error of the next step over the allowed one. Contacts open and close, so errors vary strongly from step to
/// step. A repeated step costs as much as a short one.
const SAFETY: f64 = 0.5;

/// Ratio of the next step to a step whose error is this fraction of the allowed error.
pub(crate) fn step_ratio(share: f64, largest: f64) -> f64 {
    let ratio = libm::cbrt(SAFETY / share).clamp(SMALLEST_RATIO, largest);
    if ratio.is_nan() { SMALLEST_RATIO } else { ratio }
}
