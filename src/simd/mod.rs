//! The machine's vectors: what [`pulp`] leaves to be done, with the same bits whatever width they have.

pub mod components;
pub mod lanes;
pub mod prefetch;
pub mod real;
pub mod roots;

use pulp::Simd;

/// Vectors of 512 bits, if that is what `simd` stands for: known when the code is made.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn of_512_bits<S: Simd>(simd: S) -> Option<pulp::x86::V4> {
    (&simd as &dyn std::any::Any).downcast_ref::<pulp::x86::V4>().copied()
}
