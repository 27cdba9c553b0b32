//! Bessel functions against their series in multi-precision, from subnormal arguments to 10³⁰⁰.

use jamscope::reference::bessel::modulus_phase::modulus_phase;
use jamscope::reference::bessel::{cylinder, modified, spherical};
use proptest::prelude::*;

use crate::precise_bessel::{Functions, Real, pi, real, rounded};
use crate::precise_profile::error;
use crate::random_annuli::holds;
use crate::{precise_bessel, precise_profile};

/// Bits of the multi-precision values: far more than 53, and the power series still cheap.
const BITS: usize = 160;

/// Largest relative error claimed for J, Y (of the modulus), I, K, j, y, i, k: libm's 5·10⁻¹⁶ of J and Y; a polynomial, a root, a
/// quotient, an exponential and a product of I and K, half an ulp to an ulp each; about as many roundings of the rest.
const CLAIMED: f64 = 1e-15;

/// 10⁻³⁰⁰ to 10³⁰⁰, mostly where something happens.
fn arguments() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => (-3.0..2.0f64).prop_map(|exponent| 10f64.powf(exponent)),
        2 => 0.5..40.0f64,
        1 => (-300.0..300.0f64).prop_map(|exponent| 10f64.powf(exponent)),
        1 => (2.0..6.0f64).prop_map(|exponent| 10f64.powf(exponent)),
    ]
}

fn argument(x: f64) -> Real {
    real(x, BITS + 64)
}

/// Errors of both orders of both kinds over the modulus of each order.
fn over_modulus(found: [[f64; 2]; 2], exact: &Functions) -> Vec<f64> {
    let mut shares = Vec::new();
    for order in 0..2 {
        let modulus = rounded(&exact.first[order]).hypot(rounded(&exact.second[order]));
        shares.push(error(found[0][order], &exact.first[order]) / modulus);
        shares.push(error(found[1][order], &exact.second[order]) / modulus);
    }
    shares
}

/// Relative errors.
fn relative(found: [[f64; 2]; 2], exact: &Functions) -> Vec<f64> {
    let pairs = found.iter().flatten().zip(exact.first.iter().chain(&exact.second));
    pairs.map(|(&found, exact)| error(found, exact) / rounded(exact).abs()).collect()
}

#[test]
fn cylinder_functions_have_their_digits_at_any_argument() {
    holds("J, Y", 1500, arguments(), |&x| {
        let exact = precise_bessel::cylinder(&argument(x), BITS);
        let found = [[cylinder::j0(x), cylinder::j1(x)], [cylinder::y0(x), cylinder::y1(x)]];
        let shares = over_modulus(found, &exact);
        shares.into_iter().map(|share| share / CLAIMED).collect()
    });
}

#[test]
fn modified_functions_have_their_digits_at_any_argument() {
    use modified::{i0, i0_scaled, i1, i1_scaled, k0, k0_scaled, k1, k1_scaled};
    holds("I, K", 1500, arguments().prop_filter("e^x in reach", |&x| x < 1e6), |&x| {
        let exact = precise_bessel::modified(&argument(x), BITS);
        let (grown, decayed) = (argument(x).exp(), (-argument(x)).exp());
        let scaled = Functions {
            first: exact.first.each_ref().map(|value| value * &decayed),
            second: exact.second.each_ref().map(|value| value * &grown),
        };
        let mut shares = relative([[i0_scaled(x), i1_scaled(x)], [k0_scaled(x), k1_scaled(x)]], &scaled);
        if x < 700.0 {
            shares.extend(relative([[i0(x), i1(x)], [k0(x), k1(x)]], &exact));
        }
        shares.into_iter().map(|share| share / CLAIMED).collect()
    });
}

#[test]
fn spherical_functions_have_their_digits_at_any_argument() {
    use spherical::{i0, i0_scaled, i1, i1_scaled, j0, j1, k0, k0_scaled, k1, k1_scaled, y0, y1};
    // 1/x² stays in range.
    holds("j, y, i, k", 1500, arguments().prop_filter("in range", |&x| x > 1e-150 && x < 1e6), |&x| {
        let exact = precise_bessel::spherical(&argument(x), BITS);
        let mut shares = over_modulus([[j0(x), j1(x)], [y0(x), y1(x)]], &exact);
        if x < 2.0 {
            shares.extend([error(j0(x), &exact.first[0]), error(j1(x), &exact.first[1])]);
            let count = shares.len();
            shares[count - 2] /= rounded(&exact.first[0]).abs();
            shares[count - 1] /= rounded(&exact.first[1]).abs();
        }
        let exact = precise_bessel::modified_spherical(&argument(x), BITS);
        let (grown, decayed) = (argument(x).exp(), (-argument(x)).exp());
        let scaled = Functions {
            first: exact.first.each_ref().map(|value| value * &decayed),
            second: exact.second.each_ref().map(|value| value * &grown),
        };
        shares.extend(relative([[i0_scaled(x), i1_scaled(x)], [k0_scaled(x), k1_scaled(x)]], &scaled));
        if x < 700.0 {
            shares.extend(relative([[i0(x), i1(x)], [k0(x), k1(x)]], &exact));
        }
        shares.into_iter().map(|share| share / CLAIMED).collect()
    });
}

#[test]
fn modulus_and_phase_have_their_digits() {
    holds("M, θ", 1000, arguments().prop_filter("in range", |&x| x > 1e-6 && x < 1e6), |&x| {
        let exact = precise_bessel::cylinder(&argument(x), BITS);
        let (j, y) = (&exact.first[1], &exact.second[1]);
        let reduced_square = argument(x) * pi(BITS) / real(2.0, BITS) * (j * j + y * y);
        let found = modulus_phase(x);
        // φ as the sine of its error: J_1 + i Y_1 turned back by x − 3π/4 + φ is real.
        let angle = argument(x) - pi(BITS + 64) * real(0.75, BITS) + real(found.shift, BITS);
        let (sine, cosine) = angle.sin_cos();
        let off = rounded(&(y * &cosine - j * &sine)) / rounded(j).hypot(rounded(y));
        let claimed = if x < 2.0 { [1e-15, 6e-16] } else { [3e-16, 2e-16] };
        vec![
            error(found.reduced_square, &reduced_square) / rounded(&reduced_square) / claimed[0],
            off.abs() / claimed[1],
        ]
    });
}

#[test]
fn extreme_arguments_have_defined_values() {
    let tiny = f64::from_bits(1);
    // First terms of the power series are exact to rounding.
    assert_eq!((cylinder::j0(tiny), cylinder::j1(4.0 * tiny)), (1.0, 2.0 * tiny));
    assert_eq!((modified::i0(tiny), modified::i1(4.0 * tiny)), (1.0, 2.0 * tiny));
    assert_eq!((spherical::j0(tiny), spherical::j1(3.0 * tiny), spherical::i1(3.0 * tiny)), (1.0, tiny, tiny));
    let exact = precise_bessel::cylinder(&argument(tiny), BITS);
    assert!(error(cylinder::y0(tiny), &exact.second[0]) < CLAIMED * 475.0);
    let exact = precise_bessel::modified(&argument(tiny), BITS);
    assert!(error(modified::k0(tiny), &exact.second[0]) < CLAIMED * 745.0);
    // Where −2/(πx) and 1/x leave the range.
    assert_eq!((cylinder::y1(3.5e-309), modified::k1(5.5e-309)), (f64::NEG_INFINITY, f64::INFINITY));
    assert!(cylinder::y1(3.6e-309).is_finite() && modified::k1(5.7e-309).is_finite());
    for f in [cylinder::y0, cylinder::y1, spherical::y0, spherical::y1] {
        assert_eq!(f(0.0), f64::NEG_INFINITY);
        assert!(f(-1.0).is_nan() && f(f64::NAN).is_nan());
    }
    for f in [modified::k0, modified::k1, modified::k0_scaled, modified::k1_scaled, spherical::k0, spherical::k1] {
        assert_eq!((f(0.0), f(f64::INFINITY)), (f64::INFINITY, 0.0));
        assert!(f(-1.0).is_nan() && f(f64::NAN).is_nan());
    }
    for f in [modified::i0_scaled, modified::i1_scaled, spherical::i0_scaled, spherical::i1_scaled] {
        assert_eq!(f(f64::INFINITY), 0.0);
        assert!(f(f64::NAN).is_nan());
    }
    // e^710 overflows, I_n(712) and i_n(715) do not.
    for (f, last) in
        [(modified::i0 as fn(f64) -> f64, 712.0), (modified::i1, 712.0), (spherical::i0, 715.0), (spherical::i1, 715.0)]
    {
        assert!(f(last).is_finite() && f(last) > 1e305, "{}", f(last));
        assert_eq!((f(1e3), f(1e4), f(f64::INFINITY)), (f64::INFINITY, f64::INFINITY, f64::INFINITY));
        assert!(f(f64::NAN).is_nan());
    }
    // Even or odd.
    assert_eq!((modified::i0(-30.0), modified::i1(-30.0)), (modified::i0(30.0), -modified::i1(30.0)));
    assert_eq!((spherical::i0(-30.0), spherical::i1(-30.0)), (spherical::i0(30.0), -spherical::i1(30.0)));
    assert_eq!((spherical::j0(-30.0), spherical::j1(-30.0)), (spherical::j0(30.0), -spherical::j1(30.0)));
    // 10³⁰⁰: the Wronskian; J_1 Y_0 − J_0 Y_1 = 2/(πx).
    let x = 1e300;
    let exact = precise_bessel::cylinder(&argument(x), BITS);
    let scale = (2.0 / (std::f64::consts::PI * x)).sqrt();
    assert!(precise_profile::error(cylinder::j1(x), &exact.first[1]) < CLAIMED * scale);
    assert!((modified::i1_scaled(x) * modified::k0_scaled(x) * 2.0 * x - 1.0).abs() < CLAIMED);
}
