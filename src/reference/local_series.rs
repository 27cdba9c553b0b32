//! [`LocalSeries`]: a solution and its derivative with respect to κ near one radius, as power series in ln r.
//!
//! With r = r_0 e^t the equation of the profiles has entire coefficients,
//!
//! ```text
//! f_tt + (D−2) f_t − (D−1) f ± x_0² e^(2t) f = 0        x_0 = κ r_0;  + screened, − antiscreened
//! ```
//!
//! so the series of f in t converges everywhere, and a solution that vanishes at r_0 is accurate near it. The
//! derivative `h = (1/κ) ∂f/∂κ` at fixed f(r_0), f'(r_0) solves the same equation with the right-hand side `∓2 r_0²
//! e^(2t) f`. It begins with t², without cancellation as κ → 0 or r → r_0.

/// The sign of κ² in the equation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Sign {
    /// `+κ²`: oscillating solutions.
    Screened,
    /// `−κ²`: growing and decaying solutions.
    Antiscreened,
}

impl Sign {
    /// +1 or −1.
    pub(crate) fn factor(self) -> f64 {
        match self {
            Sign::Screened => 1.0,
            Sign::Antiscreened => -1.0,
        }
    }
}

/// The range of the series at the rim in ln(r/R): to r = R/e, and at most κ(R − r) = 1.2. Within it no term exceeds the
/// sum by more than a factor 3, and none of the solutions has a node.
pub(crate) fn rim_reach(rim_argument: f64) -> f64 {
    const DISTANCE: f64 = 1.2;
    // 1 − 1.2/y = 1/e at y = 1.9.
    if rim_argument < 1.9 { -1.0 } else { libm::log1p(-DISTANCE / rim_argument).max(-1.0) }
}

/// Limit of the number of coefficients; the longest series needs 62, at κR = 2 and t = −1.
const LENGTH_LIMIT: usize = 80;

/// Coefficients below this share of the largest are negligible.
const NEGLIGIBLE: f64 = 8.673_617_379_884_035e-19; // 2⁻⁶⁰

/// The solution with given value and slope at one radius.
#[derive(Debug, Clone)]
pub(crate) struct LocalSeries {
    origin: f64,
    /// t at the end of the range, of either sign.
    reach: f64,
    /// `f = Σ F_n (t/reach)^n`.
    value: Vec<f64>,
    /// `(1/κ) ∂f/∂κ / r_0² = Σ H_n (t/reach)^n`.
    response: Vec<f64>,
}

impl LocalSeries {
    /// The solution with value `value` and derivative `slope` at the radius `origin`, where κr = `argument`, for
    /// t between 0 and `reach`.
    pub(crate) fn new<const D: usize>(sign: Sign, argument: f64, origin: f64, reach: f64, start: (f64, f64)) -> Self {
        let mut series = LocalSeries { origin, reach, value: Vec::new(), response: Vec::new() };
        let recurrence = Recurrence::new::<D>(sign, argument, reach);
        series.value = recurrence.solve([start.0, start.1 * origin * reach], &[], 0.0);
        series
    }

    /// Like [`LocalSeries::new`], with the derivative with respect to κ.
    pub(crate) fn with_response<const D: usize>(
        sign: Sign,
        argument: f64,
        origin: f64,
        reach: f64,
        start: (f64, f64),
    ) -> Self {
        let mut series = LocalSeries::new::<D>(sign, argument, origin, reach, start);
        let recurrence = Recurrence::new::<D>(sign, argument, reach);
        series.response = recurrence.solve([0.0, 0.0], &series.value, 2.0 * sign.factor() * reach * reach);
        series
    }

    /// The radius at which the range ends.
    pub(crate) fn end(&self) -> f64 {
        self.origin * libm::exp(self.reach)
    }

    /// t/reach.
    fn position(&self, radius: f64) -> f64 {
        libm::log1p((radius - self.origin) / self.origin) / self.reach
    }

    /// f(r).
    pub(crate) fn value(&self, radius: f64) -> f64 {
        sum(&self.value, self.position(radius))
    }

    /// f'(r).
    pub(crate) fn derivative(&self, radius: f64) -> f64 {
        let position = self.position(radius);
        let slope = self.value.iter().enumerate().skip(1).rev().fold(0.0, |s, (n, &c)| s * position + n as f64 * c);
        slope / (self.reach * radius)
    }

    /// `(1/κ) ∂f/∂κ` over r_0².
    pub(crate) fn reduced_response(&self, radius: f64) -> f64 {
        sum(&self.response, self.position(radius))
    }

    /// ∂f/∂κ at the given wavenumber of the solution.
    pub(crate) fn response(&self, wavenumber: f64, radius: f64) -> f64 {
        wavenumber * self.origin * self.origin * self.reduced_response(radius)
    }
}

fn sum(coefficients: &[f64], position: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, &coefficient| sum * position + coefficient)
}

/// `(n+2)(n+1) F_(n+2) = −(D−2)(n+1) T F_(n+1) + (D−1) T² F_n ∓ (x_0 T)² Σ E_k F_(n−k) − source`.
struct Recurrence {
    first: f64,
    zeroth: f64,
    oscillation: f64,
    /// `E_k = (2T)^k/k!` of e^(2t), up to negligible terms.
    exponential: Vec<f64>,
}

impl Recurrence {
    fn new<const D: usize>(sign: Sign, argument: f64, reach: f64) -> Self {
        let mut exponential = vec![1.0];
        let mut term = 1.0_f64;
        for k in 1..LENGTH_LIMIT {
            term *= 2.0 * reach / k as f64;
            if term.abs() < NEGLIGIBLE {
                break;
            }
            exponential.push(term);
        }
        Recurrence {
            first: (D as f64 - 2.0) * reach,
            zeroth: (D as f64 - 1.0) * reach * reach,
            oscillation: sign.factor() * (argument * reach).powi(2),
            exponential,
        }
    }

    /// The coefficients, from the first two on; `source` times e^(2t) is the right-hand side of the equation.
    fn solve(&self, start: [f64; 2], source: &[f64], factor: f64) -> Vec<f64> {
        let convolution = |terms: &[f64], n: usize| -> f64 {
            let count = self.exponential.len().min(n + 1);
            (0..count).filter_map(|k| terms.get(n - k).map(|term| self.exponential[k] * term)).sum()
        };
        let mut terms = start.to_vec();
        let mut largest = start[0].abs().max(start[1].abs());
        let mut small_count = 0;
        for n in 0..LENGTH_LIMIT - 2 {
            let right = -self.first * (n + 1) as f64 * terms[n + 1] + self.zeroth * terms[n]
                - self.oscillation * convolution(&terms, n)
                - if source.is_empty() { 0.0 } else { factor * convolution(source, n) };
            let next = right / ((n + 2) * (n + 1)) as f64;
            terms.push(next);
            largest = largest.max(next.abs());
            // Several in a row: a single one may vanish accidentally.
            small_count = if next.abs() < NEGLIGIBLE * largest { small_count + 1 } else { 0 };
            if small_count >= 4 {
                break;
            }
        }
        terms
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_of_the_radius_are_found() {
        // κ = 0: r and r^(1−D).
        let (origin, reach) = (2.0, -1.0);
        for radius in [0.8, 1.3, 1.999, 2.0] {
            let line = LocalSeries::new::<3>(Sign::Screened, 0.0, origin, reach, (2.0, 1.0));
            let field = LocalSeries::new::<3>(Sign::Screened, 0.0, origin, reach, (0.25, -0.25));
            // Sums of terms up to e² times their result.
            assert!((line.value(radius) - radius).abs() < 8.0 * f64::EPSILON * 2.0);
            assert!((field.value(radius) * radius * radius - 1.0).abs() < 8.0 * f64::EPSILON);
            assert!((line.derivative(radius) - 1.0).abs() < 16.0 * f64::EPSILON * 2.0);
        }
    }
}
