//! How long the next step is, by the error of this one over the error allowed.
//!
//! Errors are those of second order, of either method, and in a step grow as the third power of h.

/// Largest ratio of a step to the one before; 1 after a rejected one, since the contact that made it fail is mostly still near.
pub(crate) const LARGEST_GROWTH: f64 = 2.0;

/// Smallest one.
pub(crate) const SMALLEST_GROWTH: f64 = 0.1;

/// Aim of the next step's error over what is allowed. Contacts come and go, so errors vary from step to step by much, and a
/// repeated step costs as much as a short one.
const SAFETY: f64 = 0.5;

/// Length of the next step over that of one with this share of the error allowed.
pub(crate) fn growth(share: f64, largest: f64) -> f64 {
    let growth = libm::cbrt(SAFETY / share).clamp(SMALLEST_GROWTH, largest);
    if growth.is_nan() { SMALLEST_GROWTH } else { growth }
}
