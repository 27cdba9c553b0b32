//! Vector operations that [`pulp`] lacks, with the same bits for every vector width.

pub mod components;
pub mod lanes;
pub mod prefetch;
pub mod real;
pub mod roots;

use pulp::Simd;

/// 512-bit vectors, if `simd` stands for them; this is known at compile time.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn of_512_bits<S: Simd>(simd: S) -> Option<pulp::x86::V4> {
    (&simd as &dyn std::any::Any).downcast_ref::<pulp::x86::V4>().copied()
}
