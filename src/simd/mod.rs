//! The machine's vectors: what [`pulp`] leaves to be done, with the same bits whatever width they have.

pub mod components;
pub mod lanes;
pub mod real;
pub mod roots;

use pulp::Simd;

/// Asks for the part of a column that begins some places behind its own begin, where the machine can be asked: it is brought to the
/// second cache while other work is done. The place may lie beyond the column; nothing is read for good.
///
/// Not to the first cache: that one waits for few lines at a time, and what is read from memory meanwhile stands behind them.
#[inline(always)]
pub fn prefetch<S: Simd, T>(simd: S, column: &[T], ahead: usize) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::_MM_HINT_T1;
        let at = column.as_ptr().wrapping_add(ahead).cast();
        if let Some(simd) = of_512_bits(simd) {
            simd.sse._mm_prefetch::<_MM_HINT_T1>(at);
        } else if let Some(simd) = (&simd as &dyn std::any::Any).downcast_ref::<pulp::x86::V3>() {
            simd.sse._mm_prefetch::<_MM_HINT_T1>(at);
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (simd, column, ahead);
}

/// Vectors of 512 bits, if that is what `simd` stands for: known when the code is made.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn of_512_bits<S: Simd>(simd: S) -> Option<pulp::x86::V4> {
    (&simd as &dyn std::any::Any).downcast_ref::<pulp::x86::V4>().copied()
}
