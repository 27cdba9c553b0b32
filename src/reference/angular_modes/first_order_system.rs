//! `System`: the screened equation as four first-order equations, and their solution by power series between two radii.
//!
//! With v = iV, ε = μ/(λ+2μ), the dilation and the rotation in the forms P = (r/ε) ∇·u and W = r ∇×u, and D = r d/dr,
//! the equation of mode n is
//!
//! ```text
//! D U = ε P − U − n v            D P = P + n W − r² (Γ_e U + iΓ_o v)
//! D v =   W − v − n U            D W = W + n P − r² (Γ_e v + iΓ_o U)
//! ```
//!
//! and d = U − v is also integrated, `D d = (n−1) d + ε P − W`. Where the displacement falls as r^(−n−1), U and v are
//! equal up to a much smaller d, which dominates farther out.
//!
//! The system is regular for every ε, Γ and n, and entire in Γ. The elastic limit is therefore not special, unlike for
//! the Bessel functions of the two potentials, which become equal there and must be subtracted.

use std::ops::Range;

use crate::reference::angular_modes::{Complex, times_i};

/// `[U, v, d, P, W]`, all \[length\].
pub(in crate::reference) type State = [Complex<f64>; 5];

/// Largest |z| for a series; its singularity, r = 0, is at 1.
const LARGEST_SHARE: f64 = 0.25;

/// The series ends at two successive terms below this share of the sum.
const NEGLIGIBLE: f64 = 0.25 * f64::EPSILON;

/// Limit of the number of terms. Terms of 0.25^k are below 2⁻⁵⁴ of the first at k = 27; a sum that nearly vanishes
/// needs more, up to 2⁻¹⁰⁸.
const TERM_LIMIT: u32 = 100;

/// Four linear first-order equations for U, v, P and W along one coordinate, the radius or a distance.
pub(in crate::reference) trait Equations {
    /// The rate of change of a solution at `place`, by which P and W are divided in its norm.
    fn rate(&self, place: f64) -> f64;

    /// The state at `place` (1 − z) from that at `place`, |z| within the reach of one series.
    fn advance(&self, place: f64, z: f64, start: State) -> State;

    /// The derivatives of U and v along the coordinate, in terms of the state.
    fn displacement_slope(&self, state: State) -> [Complex<f64>; 2];
}

/// The coefficients of the equation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::reference) struct System {
    /// n.
    pub(in crate::reference) mode: f64,
    /// ε.
    pub(in crate::reference) compliance_ratio: f64,
    /// Γ_e \[1/length²\].
    pub(in crate::reference) even: f64,
    /// Γ_o \[1/length²\].
    pub(in crate::reference) odd: f64,
}

impl System {
    /// √|Γ|, an upper bound of the wavenumbers of the medium \[1/length\].
    pub(in crate::reference) fn wavenumber(&self) -> f64 {
        libm::sqrt(libm::hypot(self.even, self.odd))
    }

    /// The share of `radius` within which a series is used; no term then exceeds the first by more than a factor e.
    pub(in crate::reference) fn reach(&self, radius: f64) -> f64 {
        LARGEST_SHARE.min(1.0 / self.rate(radius))
    }
}

impl Equations for System {
    /// max(1, n, √|Γ| r): the rate of change of the solution relative to r.
    fn rate(&self, radius: f64) -> f64 {
        self.mode.max(self.wavenumber() * radius).max(1.0)
    }

    /// The state at `radius` (1 − z) from that at `radius`, |z| within the reach.
    ///
    /// With y = Σ y_k z^k and r = ρ(1 − z), `(k+1) y_(k+1) = k y_k − A y_k + ρ² B (y_k − 2 y_(k−1) + y_(k−2))`, A and B
    /// the constant and the screening part of the equation.
    fn advance(&self, radius: f64, z: f64, start: State) -> State {
        let (n, epsilon) = (self.mode, self.compliance_ratio);
        // One radius factor at a time: Γ ρ² is moderate even if ρ² overflows.
        let (even, odd) = (self.even * radius * radius, self.odd * radius * radius);
        let mut sum = start;
        let mut term = start;
        // The last three coefficients of U and v, each with its power of z.
        let zero = Complex::new(0.0, 0.0);
        let mut before = [[zero; 2]; 2];
        let mut small_before = false;
        for index in 0..TERM_LIMIT {
            let k = f64::from(index);
            let [u, v, d, p, w] = term;
            let [x, y] = [0, 1].map(|i| term[i] - before[0][i] * (2.0 * z) + before[1][i] * (z * z));
            let factor = z / (k + 1.0);
            let next = [
                (u * (k + 1.0) + v * n - p * epsilon) * factor,
                (v * (k + 1.0) + u * n - w) * factor,
                (d * (k + 1.0 - n) - p * epsilon + w) * factor,
                (p * (k - 1.0) - w * n + x * even + times_i(y) * odd) * factor,
                (w * (k - 1.0) - p * n + y * even + times_i(x) * odd) * factor,
            ];
            before = [[u, v], before[0]];
            for i in 0..next.len() {
                sum[i] += next[i];
            }
            // Displacement and strain separately: near the rim one is much smaller than the other.
            let total = |state: &State, range: Range<usize>| state[range].iter().map(|&z| size(z)).sum::<f64>();
            let small = [0..2, 2..3, 3..5]
                .into_iter()
                .all(|range| total(&next, range.clone()) <= NEGLIGIBLE * total(&sum, range));
            if small && small_before && index >= 3 {
                break;
            }
            small_before = small;
            term = next;
        }
        sum
    }

    /// `[D U, D v]`, in terms of U and v.
    fn displacement_slope(&self, [u, v, _, p, w]: State) -> [Complex<f64>; 2] {
        [p * self.compliance_ratio - u - v * self.mode, w - v - u * self.mode]
    }
}

/// |Re z| + |Im z|.
pub(in crate::reference) fn size(z: Complex<f64>) -> f64 {
    z.re.abs() + z.im.abs()
}
