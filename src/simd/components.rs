//! Conversion between D-component vectors stored consecutively and columns of components.

use std::slice::{from_mut, from_ref};

use pulp::Simd;
#[cfg(target_arch = "x86_64")]
use pulp::bytemuck::cast;
use pulp::bytemuck::{cast_slice, cast_slice_mut};

/// Splits consecutive D-component vectors, stored in D machine vectors, into one machine vector per component.
#[inline(always)]
pub fn split<S: Simd, const D: usize>(simd: S, together: &[S::f64s]) -> [S::f64s; D] {
    let mut apart = [simd.splat_f64s(0.0); D];
    #[cfg(target_arch = "x86_64")]
    if let ([x, y], [low, high], Some(simd)) = (&mut apart[..], together, super::of_512_bits(simd)) {
        let [even, odd] = long::split(simd, [cast(*low), cast(*high)]);
        (*x, *y) = (cast(even), cast(odd));
        return apart;
    }
    let together: &[f64] = cast_slice(&together[..D]);
    for d in 0..D {
        let column: &mut [f64] = cast_slice_mut(from_mut(&mut apart[d]));
        for lane in 0..S::F64_LANES {
            column[lane] = together[lane * D + d];
        }
    }
    apart
}

/// Inverse of [`split`].
#[inline(always)]
pub fn join<S: Simd, const D: usize>(simd: S, apart: &[S::f64s; D], together: &mut [S::f64s]) {
    #[cfg(target_arch = "x86_64")]
    if let ([x, y], [low, high], Some(simd)) = (&apart[..], &mut *together, super::of_512_bits(simd)) {
        let [first, second] = long::join(simd, [cast(*x), cast(*y)]);
        (*low, *high) = (cast(first), cast(second));
        return;
    }
    let _ = simd;
    let together: &mut [f64] = cast_slice_mut(&mut together[..D]);
    for d in 0..D {
        let column: &[f64] = cast_slice(from_ref(&apart[d]));
        for lane in 0..S::F64_LANES {
            together[lane * D + d] = column[lane];
        }
    }
}

/// [`split`] in single precision.
#[inline(always)]
pub fn split_single<S: Simd, const D: usize>(simd: S, together: &[S::f32s]) -> [S::f32s; D] {
    let mut apart = [simd.splat_f32s(0.0); D];
    #[cfg(target_arch = "x86_64")]
    if let ([x, y], [low, high], Some(simd)) = (&mut apart[..], together, super::of_512_bits(simd)) {
        let [even, odd] = long::split_single(simd, [cast(*low), cast(*high)]);
        (*x, *y) = (cast(even), cast(odd));
        return apart;
    }
    let together: &[f32] = cast_slice(&together[..D]);
    for d in 0..D {
        let column: &mut [f32] = cast_slice_mut(from_mut(&mut apart[d]));
        for lane in 0..S::F32_LANES {
            column[lane] = together[lane * D + d];
        }
    }
    apart
}

/// [`join`] in single precision.
#[inline(always)]
pub fn join_single<S: Simd, const D: usize>(simd: S, apart: &[S::f32s; D], together: &mut [S::f32s]) {
    #[cfg(target_arch = "x86_64")]
    if let ([x, y], [low, high], Some(simd)) = (&apart[..], &mut *together, super::of_512_bits(simd)) {
        let [first, second] = long::join_single(simd, [cast(*x), cast(*y)]);
        (*low, *high) = (cast(first), cast(second));
        return;
    }
    let _ = simd;
    let together: &mut [f32] = cast_slice_mut(&mut together[..D]);
    for d in 0..D {
        let column: &[f32] = cast_slice(from_ref(&apart[d]));
        for lane in 0..S::F32_LANES {
            together[lane * D + d] = column[lane];
        }
    }
}

/// Two components in vectors of eight or sixteen lanes. For the plain loops the compiler would write to memory.
#[cfg(target_arch = "x86_64")]
mod long {
    use std::arch::x86_64::{__m512, __m512d};

    use pulp::x86::V4;

    #[inline(always)]
    pub fn split(simd: V4, [low, high]: [__m512d; 2]) -> [__m512d; 2] {
        let simd = simd.avx512f;
        let even = simd._mm512_setr_epi64(0, 2, 4, 6, 8, 10, 12, 14);
        let odd = simd._mm512_setr_epi64(1, 3, 5, 7, 9, 11, 13, 15);
        [simd._mm512_permutex2var_pd(low, even, high), simd._mm512_permutex2var_pd(low, odd, high)]
    }

    #[inline(always)]
    pub fn join(simd: V4, [x, y]: [__m512d; 2]) -> [__m512d; 2] {
        let simd = simd.avx512f;
        let low = simd._mm512_setr_epi64(0, 8, 1, 9, 2, 10, 3, 11);
        let high = simd._mm512_setr_epi64(4, 12, 5, 13, 6, 14, 7, 15);
        [simd._mm512_permutex2var_pd(x, low, y), simd._mm512_permutex2var_pd(x, high, y)]
    }

    #[inline(always)]
    pub fn split_single(simd: V4, [low, high]: [__m512; 2]) -> [__m512; 2] {
        let simd = simd.avx512f;
        let even = simd._mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
        let odd = simd._mm512_setr_epi32(1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31);
        [simd._mm512_permutex2var_ps(low, even, high), simd._mm512_permutex2var_ps(low, odd, high)]
    }

    #[inline(always)]
    pub fn join_single(simd: V4, [x, y]: [__m512; 2]) -> [__m512; 2] {
        let simd = simd.avx512f;
        let low = simd._mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
        let high = simd._mm512_setr_epi32(8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
        [simd._mm512_permutex2var_ps(x, low, y), simd._mm512_permutex2var_ps(x, high, y)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::processor::{Processor, dispatch};

    /// Splits and joins the numbers of a column.
    struct ThereAndBack<const D: usize>;

    impl<const D: usize> pulp::WithSimd for ThereAndBack<D> {
        type Output = ();

        fn with_simd<S: Simd>(self, simd: S) {
            let mut vectors = [simd.splat_f64s(0.0); D];
            let numbers: &mut [f64] = cast_slice_mut(&mut vectors);
            for (k, number) in numbers.iter_mut().enumerate() {
                *number = k as f64;
            }
            let apart = split::<S, D>(simd, &vectors);
            for (d, column) in apart.iter().enumerate() {
                let column: &[f64] = cast_slice(from_ref(column));
                let expected: Vec<f64> = (0..S::F64_LANES).map(|lane| (lane * D + d) as f64).collect();
                assert_eq!(column, expected, "component {d} of {D}");
            }
            let mut vectors_in_single = [simd.splat_f32s(0.0); D];
            let numbers: &mut [f32] = cast_slice_mut(&mut vectors_in_single);
            for (k, number) in numbers.iter_mut().enumerate() {
                *number = k as f32;
            }
            let in_single = split_single::<S, D>(simd, &vectors_in_single);
            for (d, column) in in_single.iter().enumerate() {
                let column: &[f32] = cast_slice(from_ref(column));
                let expected: Vec<f32> = (0..S::F32_LANES).map(|lane| (lane * D + d) as f32).collect();
                assert_eq!(column, expected, "component {d} of {D} in single precision");
            }
            let mut back = [simd.splat_f32s(-1.0); D];
            join_single(simd, &in_single, &mut back);
            assert_eq!(
                cast_slice::<_, f32>(&back),
                cast_slice::<_, f32>(&vectors_in_single),
                "{D} in single precision"
            );
            let mut back = [simd.splat_f64s(-1.0); D];
            join(simd, &apart, &mut back);
            assert_eq!(cast_slice::<_, f64>(&back), cast_slice::<_, f64>(&vectors), "{D} components");
        }
    }

    #[test]
    fn components_go_into_columns_and_back() {
        fn check<const D: usize>() {
            Processor::all().into_iter().for_each(|processor| processor.run(|| dispatch(ThereAndBack::<D>)));
        }
        check::<1>();
        check::<2>();
        check::<3>();
    }
}
