//! Bessel functions to as many digits as asked for: power series with guard bits, and the expansion of Hankel where its smallest
//! term, about e^(−2x), is out of sight.
//!
//! ```text
//! J_n(x) = (x/2)^n Σ q^k/(k! (k+n)!)                                  q = −x²/4          A&S 9.1.10
//! π Y_0/2 = (ln(x/2) + γ) J_0 − Σ H_k q^k/k!²                                            A&S 9.1.13
//! π Y_1/2 = (ln(x/2) + γ) J_1 − 1/x − (x/4) Σ (H_k + H_(k+1)) q^k/(k! (k+1)!)            A&S 9.1.11
//! I, K                                                 q → x²/4, A&S 9.6.10, 9.6.11, 9.6.13
//! ```

use std::cell::RefCell;
use std::collections::HashMap;

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;

/// A binary number of any precision.
pub type Real = FBig<HalfEven, 2>;

/// An `f64` to `bits` bits; it must be finite.
pub fn real(x: f64, bits: usize) -> Real {
    Real::try_from(x).expect("a finite number").with_precision(bits).value()
}

/// The nearest `f64`.
pub fn rounded(x: &Real) -> f64 {
    x.to_f64().value()
}

/// Orders zero and one of the two kinds: J, Y; or I, K; or j, y; or i, k.
#[derive(Clone)]
pub struct Functions {
    pub first: [Real; 2],
    pub second: [Real; 2],
}

fn integer(n: usize) -> Real {
    Real::from(n as u64)
}

/// log2 of |x|, roughly.
fn magnitude(x: &Real) -> f64 {
    x.repr().exponent() as f64 + x.repr().digits() as f64
}

/// Euler's constant, to `bits` or somewhat more, by Brent & McMillan (1980), Math. Comp. 34, 305: the error is about π e^(−4n).
fn euler(bits: usize) -> Real {
    thread_local! {
        static KNOWN: RefCell<HashMap<usize, Real>> = RefCell::default();
    }
    // Few precisions, so that few are computed.
    let bits = bits.next_multiple_of(512);
    KNOWN.with_borrow_mut(|known| {
        known
            .entry(bits)
            .or_insert_with(|| {
                let work = bits + 64;
                let n = work / 5;
                let square = integer(n * n).with_precision(work).value();
                let (mut term, mut harmonic) = (real(1.0, work), real(0.0, work));
                let (mut upper, mut lower) = (real(0.0, work), real(1.0, work));
                for k in 1..4 * n {
                    term = term * &square / integer(k * k);
                    harmonic += real(1.0, work) / integer(k);
                    upper += &term * &harmonic;
                    lower += &term;
                }
                (upper / lower - integer(n).with_precision(work).value().ln()).with_precision(bits).value()
            })
            .clone()
    })
}

pub fn pi(bits: usize) -> Real {
    thread_local! {
        static KNOWN: RefCell<HashMap<usize, Real>> = RefCell::default();
    }
    KNOWN.with_borrow_mut(|known| known.entry(bits).or_insert_with(|| Real::pi(bits)).clone())
}

/// J_0, J_1, Y_0, Y_1 at x > 0, with an absolute error of 2^(−`bits`) of the modulus.
pub fn cylinder(x: &Real, bits: usize) -> Functions {
    if magnitude(x) < 40.0 && rounded(x) < 0.36 * bits as f64 {
        // Terms reach e^x.
        let work = bits + (1.5 * rounded(x)) as usize + 40;
        return power_series(x, work, true, bits);
    }
    // The phase is reduced: as many bits more as the argument has before its point.
    let work = bits + magnitude(x).max(0.0) as usize + 40;
    let x = x.clone().with_precision(work).value();
    let quarter_turn = pi(work) / integer(4);
    let scale = (integer(2) / (pi(work) * &x)).sqrt();
    let value = |order: usize| {
        let [p, q] = hankel(&x, order, bits, true);
        let (sine, cosine) = (&x - &quarter_turn * integer(2 * order + 1)).sin_cos();
        (&scale * (&p * &cosine - &q * &sine), &scale * (&p * &sine + &q * &cosine))
    };
    let ((j_zero, y_zero), (j_one, y_one)) = (value(0), value(1));
    Functions { first: [j_zero, j_one], second: [y_zero, y_one] }
}

/// I_0, I_1, K_0, K_1 at x > 0, with a relative error of 2^(−`bits`).
pub fn modified(x: &Real, bits: usize) -> Functions {
    if magnitude(x) < 40.0 && rounded(x) < 0.36 * bits as f64 {
        // K is e^(−x) from terms of e^x.
        let work = bits + (3.0 * rounded(x)) as usize + 40;
        return power_series(x, work, false, bits);
    }
    let work = bits + magnitude(x).max(0.0) as usize + 40;
    let x = x.clone().with_precision(work).value();
    let (grown, decayed) = (x.exp(), (-&x).exp());
    let scale = (pi(work) * integer(2) * &x).sqrt();
    let value = |order: usize| {
        // Both signs from one sum: the even terms and the odd.
        let [p, q] = hankel(&x, order, bits, false);
        (&grown * (&p - &q) / &scale, pi(work) * &decayed * (&p + &q) / &scale)
    };
    let ((i_zero, k_zero), (i_one, k_one)) = (value(0), value(1));
    Functions { first: [i_zero, i_one], second: [k_zero, k_one] }
}

/// Even and odd part of `Σ a_k x^(−k)`, `a_k/a_(k−1) = (4n² − (2k−1)²)/(8k)`; with alternating signs, A&S 9.2.9, 9.2.10.
fn hankel(x: &Real, order: usize, bits: usize, alternating: bool) -> [Real; 2] {
    let work = bits + 40;
    let inverse = (real(1.0, work) / (x * integer(8))).with_precision(work).value();
    let mut parts = [real(0.0, work), real(0.0, work)];
    let mut term = real(1.0, work);
    let mut k = 0;
    while magnitude(&term) > -(bits as f64) - 10.0 {
        let negative = alternating && k % 4 >= 2;
        if negative {
            parts[k % 2] -= &term
        } else {
            parts[k % 2] += &term
        }
        k += 1;
        let odd = 2 * k as i64 - 1;
        let factor = 4 * (order * order) as i64 - odd * odd;
        term = term * &inverse * Real::from(factor) / integer(k);
        assert!(k < 40 * bits, "the expansion does not reach {bits} bits at {x}");
    }
    parts
}

fn power_series(x: &Real, work: usize, alternating: bool, bits: usize) -> Functions {
    let one = real(1.0, work);
    let x = x.clone().with_precision(work).value();
    let square = &x * &x / integer(4);
    let q = if alternating { -square } else { square };
    let (mut term, mut harmonic) = (one.clone(), real(0.0, work));
    let [mut zero, mut first, mut zero_sum, mut one_sum] = [(); 4].map(|()| real(0.0, work));
    for k in 0.. {
        let next = &harmonic + &one / integer(k + 1);
        let shared = &term / integer(k + 1);
        zero += &term;
        first += &shared;
        zero_sum += &term * &harmonic;
        one_sum += &shared * (&harmonic + &next);
        harmonic = next;
        term = shared * &q / integer(k + 1);
        if magnitude(&term) < -(work as f64) {
            break;
        }
    }
    let half = &x / integer(2);
    let first = &half * &first;
    let logarithm = half.ln() + euler(work);
    let correction = &half * &one_sum / integer(2);
    let mut functions = if alternating {
        let factor = integer(2) / pi(work);
        let second_one = &logarithm * &first - &one / &x - correction;
        Functions { second: [&factor * (&logarithm * &zero - zero_sum), factor * second_one], first: [zero, first] }
    } else {
        let second_one = &logarithm * &first + &one / &x - correction;
        Functions { second: [zero_sum - &logarithm * &zero, second_one], first: [zero, first] }
    };
    for value in functions.first.iter_mut().chain(&mut functions.second) {
        *value = value.clone().with_precision(bits).value();
    }
    functions
}

/// j_0, j_1, y_0, y_1 at x > 0, with a relative error of 2^(−`bits`) of the modulus, small x included.
pub fn spherical(x: &Real, bits: usize) -> Functions {
    let work = bits + 3 * magnitude(x).abs() as usize + 40;
    let x = x.clone().with_precision(work).value();
    let (sine, cosine) = x.sin_cos();
    let (first, second) = (&sine / &x, -(&cosine / &x));
    Functions { first: [first.clone(), (&first - &cosine) / &x], second: [second.clone(), (&second - &sine) / &x] }
}

/// i_0, i_1, k_0, k_1 at x > 0, with a relative error of 2^(−`bits`).
pub fn modified_spherical(x: &Real, bits: usize) -> Functions {
    let work = bits + 3 * magnitude(x).abs() as usize + 40;
    let x = x.clone().with_precision(work).value();
    let (grown, decayed) = (x.exp(), (-&x).exp());
    let (sine, cosine) = ((&grown - &decayed) / integer(2), (&grown + &decayed) / integer(2));
    let first = &sine / &x;
    let second = pi(work) * &decayed / (&x * integer(2));
    Functions {
        first: [first.clone(), (cosine - &first) / &x],
        second: [second.clone(), &second * (real(1.0, work) + real(1.0, work) / &x)],
    }
}
