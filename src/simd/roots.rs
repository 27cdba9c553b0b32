//! Square roots and reciprocals of vectors with the bits of the machine's own instructions, but faster where those are
//! slow.
//!
//! Many processors with 512-bit vectors need 16 to 30 cycles for eight square roots or quotients, without pipelining.
//! They can start two fused multiply–adds in each cycle. There, an estimate of 14 bits is refined by multiplications.
//! Every second root is left to the hardware instruction, which runs in parallel ([`Roots`]):
//!
//! ```text
//! √a    g = a y, h = y/2, y ≈ 1/√a      twice: e = 1/2 − g h, g ← g + g e, h ← h + h e      finally: g + (a − g²) h
//! 1/a   y ≈ 1/a                         twice: e = 1 − a y, y ← y + y e      finally: y + y (e + e²)
//! ```
//!
//! The last e and a − g² are exact. The final correction has a relative error of 2⁻⁵², and is at most 2⁻⁵² of the
//! result. So the result before rounding has a relative error of 2⁻¹⁰⁴. Rounding then gives the correctly rounded
//! result, unless the exact one is too close to the midpoint of two numbers. The tests cover the closest cases.
//!
//! Without e² one reciprocal would be wrong: that of the largest number below a power of two. There 1/a lies above a
//! midpoint m, at a relative distance of 2⁻¹⁰⁶. The value y (1 + e) = (1 − e²)/a equals m, and would be rounded down.
//! Therefore e + e² is rounded up. The value before the last rounding then exceeds 1/a by less than one unit in the
//! last place of e + e². This is sufficient. The product a m is an integer number of units and no power of two, so the
//! relative distance of 1/a from any m is at least 2⁻¹⁰⁶. If 1/a is close to some m, y is a number next to m. Then |e|
//! < 2⁻⁵³, and the last place of e + e² is at most 2⁻¹⁰⁶. The only number with e = 2⁻⁵³ lies above its m.
//!
//! # Source
//! Markstein (2000), IA-64 and Elementary Functions, chapters 8 and 9.

use pulp::Simd;

use crate::processor::Roots;

/// √a of two vectors of numbers a ≥ 0. The bits are those of [`f64::sqrt`] for 0 and from 2⁻⁹⁶⁰ to 2¹⁰⁰⁰. Smaller
/// numbers have an error of at most one unit in the last place; larger ones may give NaN. The hardware instruction
/// computes one of the vectors in parallel, or both.
#[inline(always)]
pub fn square_roots<S: Simd>(simd: S, roots: Roots, [a, b]: [S::f64s; 2]) -> [S::f64s; 2] {
    #[cfg(target_arch = "x86_64")]
    if let (Some(long), Roots::Products | Roots::Quotients) = (super::of_512_bits(simd), roots) {
        return [pulp::bytemuck::cast(long::square_root(long, pulp::bytemuck::cast(a))), simd.sqrt_f64s(b)];
    }
    let _ = roots;
    [simd.sqrt_f64s(a), simd.sqrt_f64s(b)]
}

/// 1/a, with the bits of a division for |a| from 2⁻¹⁰⁰⁰ to 2¹⁰⁰⁰; beyond, it may be NaN.
#[inline(always)]
pub fn reciprocal<S: Simd>(simd: S, roots: Roots, a: S::f64s) -> S::f64s {
    #[cfg(target_arch = "x86_64")]
    if let (Some(simd), Roots::Products) = (super::of_512_bits(simd), roots) {
        return pulp::bytemuck::cast(long::reciprocal(simd, pulp::bytemuck::cast(a)));
    }
    let _ = roots;
    simd.div_f64s(simd.splat_f64s(1.0), a)
}

/// The positive part: a, but 0 where a is negative; NaN stays NaN.
#[inline(always)]
pub fn positive_part<S: Simd>(simd: S, a: S::f64s) -> S::f64s {
    let zero = simd.splat_f64s(0.0);
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = super::of_512_bits(simd) {
        // If one operand is NaN, this instruction returns the second one.
        let (zero, a) = (pulp::bytemuck::cast(zero), pulp::bytemuck::cast(a));
        return pulp::bytemuck::cast(simd.avx512f._mm512_max_pd(zero, a));
    }
    simd.select_f64s(simd.less_than_f64s(a, zero), zero, a)
}

/// [`positive_part`] in single precision.
#[inline(always)]
pub fn positive_part_in_single<S: Simd>(simd: S, a: S::f32s) -> S::f32s {
    let zero = simd.splat_f32s(0.0);
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = super::of_512_bits(simd) {
        let (zero, a) = (pulp::bytemuck::cast(zero), pulp::bytemuck::cast(a));
        return pulp::bytemuck::cast(simd.avx512f._mm512_max_ps(zero, a));
    }
    simd.select_f32s(simd.less_than_f32s(a, zero), zero, a)
}

#[cfg(target_arch = "x86_64")]
mod long {
    use std::arch::x86_64::{__m512d, _CMP_NEQ_UQ, _MM_FROUND_NO_EXC, _MM_FROUND_TO_POS_INF};

    use pulp::x86::V4;

    #[inline(always)]
    pub fn square_root(simd: V4, a: __m512d) -> __m512d {
        let simd = simd.avx512f;
        let half = simd._mm512_set1_pd(0.5);
        let guess = simd._mm512_rsqrt14_pd(a);
        let mut root = simd._mm512_mul_pd(a, guess);
        let mut inverse = simd._mm512_mul_pd(half, guess);
        for _ in 0..2 {
            let error = simd._mm512_fnmadd_pd(root, inverse, half);
            root = simd._mm512_fmadd_pd(root, error, root);
            inverse = simd._mm512_fmadd_pd(inverse, error, inverse);
        }
        let rest = simd._mm512_fnmadd_pd(root, root, a);
        // The estimate for 0 is infinite.
        let kept = simd._mm512_cmp_pd_mask::<_CMP_NEQ_UQ>(a, simd._mm512_setzero_pd());
        simd._mm512_maskz_fmadd_pd(kept, rest, inverse, root)
    }

    #[inline(always)]
    pub fn reciprocal(simd: V4, a: __m512d) -> __m512d {
        let simd = simd.avx512f;
        let one = simd._mm512_set1_pd(1.0);
        let mut inverse = simd._mm512_rcp14_pd(a);
        for _ in 0..2 {
            let error = simd._mm512_fnmadd_pd(a, inverse, one);
            inverse = simd._mm512_fmadd_pd(inverse, error, inverse);
        }
        let error = simd._mm512_fnmadd_pd(a, inverse, one);
        let error = simd._mm512_fmadd_round_pd::<{ _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC }>(error, error, error);
        simd._mm512_fmadd_pd(inverse, error, inverse)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::processor::{Processor, dispatch};

    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    /// Roots, reciprocals and positive parts of a column of whole vectors.
    struct Each<'a>(&'a [f64], Roots);

    impl pulp::WithSimd for Each<'_> {
        type Output = [Vec<f64>; 3];

        fn with_simd<S: Simd>(self, simd: S) -> [Vec<f64>; 3] {
            let (column, rest) = S::as_simd_f64s(self.0);
            assert!(rest.is_empty());
            let list = |of: &dyn Fn(S::f64s) -> S::f64s| {
                let vectors: Vec<S::f64s> = column.iter().map(|&a| of(a)).collect();
                pulp::bytemuck::cast_slice(&vectors).to_vec()
            };
            [
                list(&|a| square_roots(simd, self.1, [a, a])[0]),
                list(&|a| reciprocal(simd, self.1, a)),
                list(&|a| positive_part(simd, a)),
            ]
        }
    }

    fn of(column: &[f64], processor: Processor) -> [Vec<f64>; 3] {
        processor.run(|| dispatch(Each(column, processor.roots())))
    }

    /// Odd numbers M < 2⁵⁴ for which M² − c is a number of 53 bits times a power of two. M/2 is then a midpoint of two
    /// doubles very close to a root. The bits of M follow from M² ≡ c modulo increasing powers of two.
    fn nearest_to_a_middle(c: i64) -> Vec<f64> {
        let mut found = Vec::new();
        for start in [1u128, 3] {
            let wanted = |m: u128, bits: u32| (m * m).wrapping_sub(c as i128 as u128) & ((1 << bits) - 1) == 0;
            let mut m = start;
            if !wanted(m, 3) {
                continue;
            }
            for bits in 4..=55 {
                if !wanted(m, bits) {
                    m += 1 << (bits - 2);
                }
            }
            for m in [m & ((1 << 54) - 1), (1 << 54) - (m & ((1 << 54) - 1))] {
                // M² − c; its last 54 bits are zero.
                let near = ((m * m) as i128 - i128::from(c)) as u128;
                if m > 1 << 53 && near.leading_zeros() + near.trailing_zeros() >= 128 - 53 {
                    found.push(near as f64);
                }
            }
        }
        found
    }

    /// Numbers of 53 bits whose reciprocals are closest to a midpoint m: a m = 2¹⁰⁶ ± 1, from the factors of both.
    fn reciprocals_near_a_middle() -> Vec<f64> {
        let below = [3u128, 107, 6361, 69_431, 20_394_401, 28_059_810_762_433];
        let above = [5u128, 15_358_129, 586_477_649, 1_801_439_824_104_653];
        assert_eq!(below.iter().product::<u128>(), (1 << 106) - 1);
        assert_eq!(above.iter().product::<u128>(), (1 << 106) + 1);
        let mut found = Vec::new();
        for factors in [&below[..], &above[..]] {
            for chosen in 0u32..1 << factors.len() {
                let of = |(place, &factor): (usize, &u128)| if chosen >> place & 1 == 1 { factor } else { 1 };
                let a: u128 = factors.iter().enumerate().map(of).product();
                if (1 << 52..1 << 53).contains(&a) {
                    found.push(a as f64);
                }
            }
        }
        found
    }

    #[test]
    fn roots_and_reciprocals_have_the_bits_of_the_instructions() {
        let mut random = Pcg64::seed_from_u64(1);
        let mut column: Vec<f64> = (0..400_000)
            .map(|_| f64::from_bits(random.random_range((1023u64 - 960) << 52..(1023u64 + 1000) << 52)))
            .collect();
        // Neighbours of powers of two and of squares, where rounding is most critical.
        for exponent in -900..900 {
            let power = f64::from_bits(((1023 + exponent) as u64) << 52);
            for near in -4i64..=4 {
                column.push(f64::from_bits(power.to_bits().wrapping_add_signed(near)));
            }
        }
        for _ in 0..20_000 {
            let root = 1.0 + random.random::<f64>();
            for near in -2i64..=2 {
                column.push(f64::from_bits((root * root).to_bits().wrapping_add_signed(near)));
            }
        }
        let hard: Vec<f64> = (-64..64).flat_map(|k| nearest_to_a_middle(8 * k + 1)).collect();
        assert!(hard.len() > 100, "{} hard cases", hard.len());
        column.extend(hard);
        let hard = reciprocals_near_a_middle();
        assert!(hard.contains(&9_007_199_254_740_991.0) && hard.len() > 1, "{hard:?}");
        column.extend(hard);
        column.resize(column.len().next_multiple_of(8), 1.0);
        for processor in Processor::all() {
            let [roots, reciprocals, _] = of(&column, processor);
            for ((a, root), reciprocal) in column.iter().zip(roots).zip(reciprocals) {
                assert_eq!(root.to_bits(), a.sqrt().to_bits(), "root of {a:e}, {processor:?}");
                assert_eq!(reciprocal.to_bits(), (1.0 / a).to_bits(), "reciprocal of {a:e}, {processor:?}");
            }
        }
    }

    #[test]
    fn nothing_and_no_number_are_kept() {
        let column = [0.0, 1.0, f64::NAN, 4.0, 0.0, 0.25, f64::MIN_POSITIVE, 9.0];
        for processor in Processor::all() {
            let [roots, reciprocals, parts] = of(&column, processor);
            assert_eq!([roots[0], roots[1], roots[3], roots[4], roots[5], roots[7]], [0.0, 1.0, 2.0, 0.0, 0.5, 3.0]);
            assert!(roots[2].is_nan() && reciprocals[2].is_nan() && parts[2].is_nan());
            let smallest = f64::MIN_POSITIVE.sqrt();
            assert!((roots[6] - smallest).abs() <= f64::EPSILON * smallest);
        }
        let signs = [-1.0, -0.0, 0.0, 2.0, f64::NAN, f64::NEG_INFINITY, f64::INFINITY, -1e-300];
        for processor in Processor::all() {
            let [_, _, parts] = of(&signs, processor);
            assert_eq!([parts[0], parts[1], parts[2], parts[3]], [0.0, 0.0, 0.0, 2.0]);
            assert!(parts[4].is_nan());
            assert_eq!([parts[5], parts[6], parts[7]], [0.0, f64::INFINITY, 0.0]);
        }
    }

    /// Positive parts of sixteen numbers.
    struct InSingle([f32; 16]);

    impl pulp::WithSimd for InSingle {
        type Output = [f32; 16];

        fn with_simd<S: Simd>(mut self, simd: S) -> [f32; 16] {
            S::as_mut_simd_f32s(&mut self.0).0.iter_mut().for_each(|a| *a = positive_part_in_single(simd, *a));
            self.0
        }
    }

    #[test]
    fn positive_parts_in_single_precision_are_those_of_one_number_after_the_other() {
        let mut column = [1.5; 16];
        column[..8].copy_from_slice(&[-1.0, -0.0, 0.0, 2.0, f32::NAN, f32::NEG_INFINITY, f32::INFINITY, -1e-40]);
        let alone = pulp::WithSimd::with_simd(InSingle(column), pulp::Scalar::new());
        for processor in Processor::all() {
            let parts = processor.run(|| dispatch(InSingle(column)));
            assert_eq!([parts[0], parts[1], parts[2], parts[3]], [0.0, 0.0, 0.0, 2.0]);
            assert!(parts[4].is_nan());
            assert_eq!([parts[5], parts[6], parts[7], parts[8]], [0.0, f32::INFINITY, 0.0, 1.5]);
            assert_eq!(parts.map(f32::to_bits), alone.map(f32::to_bits), "{processor:?}");
        }
    }
}
