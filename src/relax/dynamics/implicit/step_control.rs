//! Step control: the length of the next step, from the ratio of the error of this one to the allowed error.
//!
//! The error of a step grows as the third power of h, for either method.

/// Largest ratio of a step to the one before. After a rejected step it is 1, since the contact that caused it is mostly still near.
pub(crate) const LARGEST_RATIO: f64 = 2.0;

/// Smallest ratio of a step to the one before.
pub(crate) const SMALLEST_RATIO: f64 = 0.1;

/// Aimed error of the next step over the allowed one. Contacts open and close, so errors vary strongly from step to step, and a
/// repeated step costs as much as a short one.
const SAFETY: f64 = 0.5;

/// Ratio of the next step to one whose error is this share of the allowed error.
pub(crate) fn step_ratio(share: f64, largest: f64) -> f64 {
    let ratio = libm::cbrt(SAFETY / share).clamp(SMALLEST_RATIO, largest);
    if ratio.is_nan() { SMALLEST_RATIO } else { ratio }
}
