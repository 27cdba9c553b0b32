//! Numbers looked up in short tables, a lane at a time or all at once.

use std::slice::from_mut;

use pulp::Simd;
use pulp::bytemuck::cast_slice_mut;

use crate::processor::{Processor, Vectors};

/// Numbers of a table: as many as a vector of 512 bits has.
pub const LENGTH: usize = 8;

/// Whether this machine looks a vector of numbers up at once: with vectors of 256 bits a table costs more than it saves of memory in a far
/// cache.
pub fn is_quick() -> bool {
    Processor::here().vectors() == Vectors::Avx512
}

/// The entries of a table with these numbers, one a lane; only the last three bits of a number count.
#[inline(always)]
pub fn look_up<S: Simd>(simd: S, table: &[f64; LENGTH], numbers: &[u8]) -> S::f64s {
    #[cfg(target_arch = "x86_64")]
    if let (Some(simd), Some(numbers)) = (super::of_512_bits(simd), numbers.first_chunk()) {
        return pulp::bytemuck::cast(long::look_up(simd, table, *numbers));
    }
    let mut found = simd.splat_f64s(0.0);
    let lanes: &mut [f64] = cast_slice_mut(from_mut(&mut found));
    for lane in 0..S::F64_LANES {
        lanes[lane] = table[usize::from(numbers[lane]) % LENGTH];
    }
    found
}

/// [`look_up`] in single precision.
#[inline(always)]
pub fn look_up_in_single<S: Simd>(simd: S, table: &[f32; LENGTH], numbers: &[u8]) -> S::f32s {
    #[cfg(target_arch = "x86_64")]
    if let (Some(simd), Some(numbers)) = (super::of_512_bits(simd), numbers.first_chunk()) {
        return pulp::bytemuck::cast(long::look_up_in_single(simd, table, *numbers));
    }
    let mut found = simd.splat_f32s(0.0);
    let lanes: &mut [f32] = cast_slice_mut(from_mut(&mut found));
    for lane in 0..S::F32_LANES {
        lanes[lane] = table[usize::from(numbers[lane]) % LENGTH];
    }
    found
}

#[cfg(target_arch = "x86_64")]
mod long {
    use std::arch::x86_64::{__m512, __m512d};

    use pulp::bytemuck::cast;
    use pulp::x86::V4;

    #[inline(always)]
    pub fn look_up(simd: V4, table: &[f64; 8], numbers: [u8; 8]) -> __m512d {
        let numbers = simd.avx512f._mm512_cvtepu8_epi64(cast([u64::from_le_bytes(numbers), 0]));
        simd.avx512f._mm512_permutexvar_pd(numbers, cast(*table))
    }

    /// Both halves of the vector are the table, so a fourth bit does not count either.
    #[inline(always)]
    pub fn look_up_in_single(simd: V4, table: &[f32; 8], numbers: [u8; 16]) -> __m512 {
        let numbers = simd.avx512f._mm512_cvtepu8_epi32(cast(numbers));
        simd.avx512f._mm512_permutexvar_ps(numbers, cast([*table; 2]))
    }
}

#[cfg(test)]
mod tests {
    use pulp::bytemuck::cast_slice;

    use super::*;
    use crate::processor::dispatch;

    /// Every number once and more, looked up a vector at a time.
    struct LookUp;

    impl pulp::WithSimd for LookUp {
        type Output = ();

        fn with_simd<S: Simd>(self, simd: S) {
            let table: [f64; LENGTH] = std::array::from_fn(|k| 10.0 + k as f64);
            let numbers: [u8; 32] = std::array::from_fn(|k| (k * 5) as u8);
            for begin in [0, 8, 13] {
                let expected = |lane: usize| table[usize::from(numbers[begin + lane]) % LENGTH];
                let found = [look_up(simd, &table, &numbers[begin..])];
                let found: &[f64] = cast_slice(&found);
                assert!(found.iter().enumerate().all(|(lane, &found)| found == expected(lane)), "{found:?}");
                let found = [look_up_in_single(simd, &table.map(|number| number as f32), &numbers[begin..])];
                let found: &[f32] = cast_slice(&found);
                assert!(found.iter().enumerate().all(|(lane, &found)| f64::from(found) == expected(lane)), "{found:?}");
            }
        }
    }

    #[test]
    fn every_lane_finds_its_own_number() {
        Processor::all().into_iter().for_each(|processor| processor.run(|| dispatch(LookUp)));
    }
}
