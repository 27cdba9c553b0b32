//! Power series about the centre: the regular solutions of a mode, and those of a force and of a force dipole there.
//!
//! *Sources.* With g_s the solution of Δg + s g + δ(r) = 0, the displacement of a unit force along x, times μ, is
//!
//! ```text
//! u = g_T x̂ + (1−ε) ∇ ∂_x h        h = (g_L − g_T)/(s_L − s_T)        s_L = εΓ,  s_T = Γ
//! ```
//!
//! that is, k k/k² of its Fourier transform written as partial fractions. Its dilation is ε ∂_x g_L and its rotation
//! −∂_y g_T. The dipole is −∂_x of it. With L = ln(r/R) and H_k = 1 + 1/2 + … + 1/k
//!
//! ```text
//! g_s = −(1/2π) Σ_k (−s r²/4)^k (L − H_k)/(k!)²
//! h   = −(1/2π) Σ_(k≥1) (−r²/4)^k Γ^(k−1) (1 + ε + … + ε^(k−1)) (L − H_k)/(k!)²
//! ```
//!
//! A regular solution is left open, which the rim determines. The terms of h are those of a divided difference of
//! powers, all of one sign, so Γ → 0 loses no digits. Of r^(2k) (L − H_k), a polynomial F of D = r d/dr makes
//! r^(2k) [F(2k) (L − H_k) + F'(2k)].
//!
//! *Regular solutions.* With p = P ± W, s = U + v, d = U − v the equations of the first-order system are
//!
//! ```text
//! D s = −(1+n) s + (1+ε)/2 p₊ − (1−ε)/2 p₋        D p₊ = (1+n) p₊ − Γ r² s
//! D d = (n−1) d − (1−ε)/2 p₊ + (1+ε)/2 p₋         D p₋ = (1−n) p₋ − Γ r² d
//! ```
//!
//! and a series in r² starts from d alone ∝ r^(n−1), n ≥ 1, or from p₊ ∝ r^(n+1).

use std::f64::consts::TAU;

use crate::reference::angular_modes::Complex;
use crate::reference::angular_modes::first_order_system::State;

/// Largest |Γ| r² at which the series are used. Terms then fall by a factor of 16 k² at least.
pub(super) const LARGEST_SCREENING: f64 = 0.25;

/// Number of terms: the last is below (1/16)^k/(k!)², 10⁻²⁸ for k = 10.
const TERM_COUNT: u32 = 12;

/// The source at the centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Source {
    /// A force along θ = 0: n = 1.
    Force,
    /// Two forces outward along θ = 0: the part n = 0.
    DipoleInflation,
    /// The same: the part n = 2.
    DipoleElongation,
}

impl Source {
    /// n.
    pub(super) fn mode(self) -> u32 {
        match self {
            Source::DipoleInflation => 0,
            Source::Force => 1,
            Source::DipoleElongation => 2,
        }
    }

    /// The singular solution of a source of unit strength over μ at `radius`, with ε, x = Γ r² and L = `logarithm`.
    pub(super) fn state(self, radius: f64, epsilon: f64, x: f64, logarithm: f64) -> State {
        let g = |square: f64, operator: fn(f64) -> [f64; 2]| green(square, logarithm, operator);
        // h/r².
        let h = |operator: fn(f64) -> [f64; 2]| divided(x, epsilon, logarithm, operator);
        // F(D) and its derivative.
        let identity: fn(f64) -> [f64; 2] = |_| [1.0, 0.0];
        let first: fn(f64) -> [f64; 2] = |m| [m, 1.0];
        let shear: fn(f64) -> [f64; 2] = |m| [m * (m - 2.0), 2.0 * m - 2.0];
        let rest = 1.0 - epsilon;
        let [u, v, d, p, w] = match self {
            Source::Force => {
                let g_transverse = g(x, identity);
                let along = rest * h(|m| [m * (m - 1.0), 2.0 * m - 1.0]);
                let across = rest * h(first);
                let difference = 2.0 * g_transverse + rest * h(|m| [m * m, 2.0 * m]);
                [g_transverse + along, -g_transverse - across, difference, g(epsilon * x, first), -g(x, first)]
            }
            Source::DipoleInflation => {
                let u = -0.5 * epsilon * g(epsilon * x, first) / radius;
                [u, 0.0, u, 0.5 * epsilon * x * g(epsilon * x, identity) / radius, 0.0]
            }
            Source::DipoleElongation => {
                let slope = g(x, first);
                let along = rest * h(|m| [m * (m - 2.0).powi(2), 3.0 * m * m - 8.0 * m + 4.0]);
                let across = 2.0 * rest * h(shear);
                let half = 0.5 / radius;
                [
                    -half * (slope + along),
                    half * (slope + across),
                    -half * (2.0 * slope + along + across),
                    -half * g(epsilon * x, shear),
                    half * g(x, shear),
                ]
            }
        };
        [u, v, d, p, w].map(|x| Complex::new(x, 0.0))
    }
}

/// F(D) g_s at s r² = `square`.
fn green(square: f64, logarithm: f64, operator: impl Fn(f64) -> [f64; 2]) -> f64 {
    let (mut factor, mut harmonic, mut sum) = (1.0, 0.0, 0.0);
    for k in 0..TERM_COUNT {
        let k = f64::from(k);
        if k > 0.0 {
            factor *= -0.25 * square / (k * k);
            harmonic += 1.0 / k;
        }
        let [value, slope] = operator(2.0 * k);
        sum += factor * (value * (logarithm - harmonic) + slope);
    }
    -sum / TAU
}

/// F(D) h over r², at x = Γ r².
fn divided(x: f64, epsilon: f64, logarithm: f64, operator: impl Fn(f64) -> [f64; 2]) -> f64 {
    let (mut factor, mut harmonic, mut powers, mut sum) = (-0.25, 0.0, 0.0, 0.0);
    for k in 1..TERM_COUNT {
        let k = f64::from(k);
        if k > 1.0 {
            factor *= -0.25 * x;
        }
        factor /= k * k;
        harmonic += 1.0 / k;
        powers = powers * epsilon + 1.0;
        let [value, slope] = operator(2.0 * k);
        sum += factor * powers * (value * (logarithm - harmonic) + slope);
    }
    -sum / TAU
}

/// Two regular solutions of mode n at a radius, up to factors, with ε and x = Γ r².
pub(super) fn regular_solutions(mode: u32, epsilon: f64, x: f64) -> [State; 2] {
    let n = f64::from(mode);
    let (even, odd) = (0.5 * (1.0 + epsilon), 0.5 * (1.0 - epsilon));
    if mode == 0 {
        // U with P and v with W, each ∝ r at first: D U = εP − U, D P = P − Γ r² U, the same without ε.
        let pair = |share: f64| {
            let (mut pressure, mut sums) = (1.0, [0.0; 2]);
            for k in 0..TERM_COUNT {
                let exponent = 1.0 + 2.0 * f64::from(k);
                let displacement = share * pressure / (exponent + 1.0);
                sums = [sums[0] + displacement, sums[1] + pressure];
                pressure = -x * displacement / (exponent + 1.0);
            }
            sums
        };
        let ([u, p], [v, w]) = (pair(epsilon), pair(1.0));
        return [[u, 0.0, u, p, 0.0], [0.0, v, -v, 0.0, w]].map(|state| state.map(|x| Complex::new(x, 0.0)));
    }
    // [s, d, p₊, p₋] of the first term, and its exponent.
    let series = |start: [f64; 4], start_exponent: f64| {
        let (mut term, mut sum) = (start, start);
        for k in 1..TERM_COUNT {
            let exponent = start_exponent + 2.0 * f64::from(k);
            // From d alone the first s is 0, and p₊ stays 0 where its factor is singular.
            let plus = if term[0] == 0.0 { 0.0 } else { -x * term[0] / (exponent - 1.0 - n) };
            let minus = -x * term[1] / (exponent - 1.0 + n);
            term = [
                (even * plus - odd * minus) / (exponent + 1.0 + n),
                (even * minus - odd * plus) / (exponent + 1.0 - n),
                plus,
                minus,
            ];
            sum = std::array::from_fn(|i| sum[i] + term[i]);
        }
        let [s, d, plus, minus] = sum;
        [0.5 * (s + d), 0.5 * (s - d), d, 0.5 * (plus + minus), 0.5 * (plus - minus)].map(|x| Complex::new(x, 0.0))
    };
    [series([0.0, 1.0, 0.0, 0.0], n - 1.0), series([even / (2.0 * n + 2.0), -0.5 * odd, 1.0, 0.0], n + 1.0)]
}
