//! Coefficients of the Runge–Kutta–Chebyshev method: explicit, of second order, with as many stages as the stiffness
//! requires.
//!
//! ```text
//! Y_1 = y + h μ̃_1 f(y)
//! Y_j = (1 − μ_j − ν_j) y + μ_j Y_{j−1} + ν_j Y_{j−2} + h μ̃_j f(Y_{j−1}) + h γ̃_j f(y)        j = 2 … s,  y' = Y_s
//! y' = P(hλ) y        P(z) = a_s + b_s T_s(w_0 + w_1 z)        (for ẏ = λ y)
//! ```
//!
//! T_s is the Chebyshev polynomial of degree s; w_0 = 1 + ε/s², w_1 = T_s'(w_0)/T_s''(w_0), b_j =
//! T_j''(w_0)/T_j'(w_0)², a_j = 1 − b_j T_j(w_0). |P| ≤ 1 from 0 to −β with β = (w_0 + 1)/w_1, which grows as s². So s
//! evaluations of f replace of the order of s² evaluations of a plain explicit method. Unresolved decays are multiplied
//! by factors within 2/3 of 1/3. The range of these factors decreases with increasing ε.
//!
//! # Source
//! Sommeijer, Shampine, Verwer (1997), J. Comput. Appl. Math. 88, 315, eqs. (2.1) to (2.8), ε = 2/13 there.

/// ε, the damping of unresolved decays.
const DAMPING: f64 = 2.0 / 13.0;

/// Lower bound of β over s² − 1.
const EXTENT: f64 = 0.653;

/// R. An oscillation with the ratio ρ of stiffness to damping has λ on the circle of radius ρ through 0 with its centre
/// at −ρ. If hλ lies inside a circle of radius R (1 − 2.8/s²), then |P| ≤ 1 for every s.
const CIRCLE: f64 = 2.5;

/// The constant 2.8 in the radius of that circle.
const CIRCLE_LOSS: f64 = 2.8;

/// Longest step over R/ρ. For longer steps the circle would determine the number of stages.
const LONGEST: f64 = 0.9;

/// Coefficients of one stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct StageTerms {
    /// Of y, 1 − μ − ν.
    pub(crate) start: f64,
    /// Of the stage before, μ.
    pub(crate) last: f64,
    /// Of the one before that, ν.
    pub(crate) earlier: f64,
    /// Of h f at the stage before, μ̃.
    pub(crate) slope: f64,
    /// Of h f at the start, γ̃.
    pub(crate) start_slope: f64,
    /// Time of the stage over h.
    pub(crate) time: f64,
}

/// T_j, T_j' and T_j'' at one argument, from j = 0.
struct Polynomials {
    argument: f64,
    earlier: [f64; 3],
    now: [f64; 3],
}

impl Polynomials {
    fn at(argument: f64) -> Self {
        Polynomials { argument, earlier: [1.0, 0.0, 0.0], now: [argument, 1.0, 0.0] }
    }

    /// From T_j to T_{j+1}.
    fn rise(&mut self) {
        let ([t, first, second], [t_earlier, first_earlier, second_earlier]) = (self.now, self.earlier);
        self.earlier = self.now;
        self.now = [
            2.0 * self.argument * t - t_earlier,
            2.0 * (t + self.argument * first) - first_earlier,
            2.0 * (2.0 * first + self.argument * second) - second_earlier,
        ];
    }
}

/// The method of s stages.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Chebyshev {
    /// One entry per stage.
    pub(crate) stages: Vec<StageTerms>,
    /// β.
    pub(crate) extent: f64,
}

impl Chebyshev {
    /// The method with this number of stages, at least 2.
    pub(crate) fn new(stage_count: usize) -> Self {
        let count = stage_count.max(2);
        let w0 = 1.0 + DAMPING / (count as f64).powi(2);
        let mut last = Polynomials::at(w0);
        for _ in 1..count {
            last.rise();
        }
        let w1 = last.now[1] / last.now[2];
        let mut stages = Vec::with_capacity(count);
        let mut polynomials = Polynomials::at(w0);
        // b_0 = b_1 = b_2 = T_2''/T_2'² = 4/(4 w_0)².
        let first = 0.25 / (w0 * w0);
        let (mut b_earlier, mut b_last) = (first, first);
        let mut a_last = 1.0 - first * w0;
        // The stages of ẏ = 1 are their own times.
        let (mut time_earlier, mut time) = (0.0, first * w1);
        stages.push(StageTerms { start: 1.0, last: 0.0, earlier: 0.0, slope: first * w1, start_slope: 0.0, time });
        for _ in 2..=count {
            polynomials.rise();
            let [t, slope, curvature] = polynomials.now;
            let b = curvature / (slope * slope);
            let (mu, nu) = (2.0 * b * w0 / b_last, -b / b_earlier);
            let along = 2.0 * b * w1 / b_last;
            let start_slope = -a_last * along;
            (time_earlier, time) = (time, mu * time + nu * time_earlier + along + start_slope);
            stages.push(StageTerms { start: 1.0 - mu - nu, last: mu, earlier: nu, slope: along, start_slope, time });
            (b_earlier, b_last, a_last) = (b_last, b, 1.0 - b * t);
        }
        Chebyshev { stages, extent: (w0 + 1.0) / w1 }
    }
}

/// Stability requirement of a step: decay rates up to λ, and oscillations with ratios of stiffness to damping up to ρ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stiffness {
    /// λ \[1 / time\].
    pub(crate) decay: f64,
    /// ρ \[1 / time\].
    pub(crate) ratio: f64,
}

impl Stiffness {
    /// The longest step that is stable for any number of stages \[time\].
    pub(crate) fn longest_step(&self) -> f64 {
        LONGEST * CIRCLE / self.ratio
    }

    /// Number of stages for a step of this length, up to the largest number allowed.
    pub(crate) fn stage_count(&self, time_step: f64) -> usize {
        let decays = 1.0 + time_step * self.decay / EXTENT;
        let circle = CIRCLE_LOSS / (1.0 - (time_step * self.ratio / CIRCLE).min(LONGEST));
        let count = decays.max(circle).sqrt().ceil();
        // For NaN and very large counts the bound avoids an overflow.
        if count < MOST_STAGES as f64 { (count as usize).max(2) } else { MOST_STAGES }
    }
}

/// Largest number of stages.
const MOST_STAGES: usize = 1000;

#[cfg(test)]
mod tests {
    use super::*;
    use num_complex::Complex64;

    /// Numbers of stages in the tests.
    fn counts() -> impl Iterator<Item = usize> {
        (2..=30).chain([40, 60, 100, 200])
    }

    /// The result of the stages for y = 1, ẏ = λy, z = hλ.
    fn by_stages(method: &Chebyshev, z: Complex64) -> Complex64 {
        let (mut earlier, mut last) = (Complex64::ONE, Complex64::ONE);
        for terms in &method.stages {
            let next = terms.start
                + terms.last * last
                + terms.earlier * earlier
                + z * (terms.slope * last + terms.start_slope);
            (earlier, last) = (last, next);
        }
        last
    }

    /// a_s + b_s T_s(w_0 + w_1 z) in closed form: T_s(cosh θ) = cosh sθ, and its derivatives at w_0 = cosh θ.
    fn closed(count: usize, z: Complex64) -> Complex64 {
        let s = count as f64;
        let w0 = 1.0 + DAMPING / (s * s);
        let angle = w0.acosh();
        let (sinh, cosh) = (angle.sinh(), w0);
        let first = s * (s * angle).sinh() / sinh;
        let second = (s * s * (s * angle).cosh() - first * cosh) / (sinh * sinh);
        let w1 = first / second;
        let b = second / (first * first);
        let a = 1.0 - b * (s * angle).cosh();
        a + b * (s * (w0 + w1 * z).acosh()).cosh()
    }

    #[test]
    fn the_stages_multiply_by_their_polynomial() {
        for count in counts() {
            let method = Chebyshev::new(count);
            for k in 0..=40 {
                let z = Complex64::new(-method.extent * f64::from(k) / 40.0, 0.3 * f64::from(k % 5));
                let (stages, exact) = (by_stages(&method, z), closed(count, z));
                // Rounding grows as s² (Verwer, Hundsdorfer, Sommeijer 1990). The closed form contains second
                // differences of w_0 near 1, with a rounding error of 10⁻¹⁶ s⁴/ε.
                let bound = 1e-14 * (count as f64).powi(4) * exact.norm().max(1.0);
                assert!((stages - exact).norm() < bound, "{count} stages, z = {z}: {stages} for {exact}");
            }
        }
    }

    #[test]
    fn the_stages_are_where_their_polynomials_say() {
        // c_j = w_1 T_j''(w_0)/T_j'(w_0) is the first derivative at 0 of the polynomial of stage j; for c_1 it is that
        // of b_1 = b_2.
        for count in counts() {
            let method = Chebyshev::new(count);
            let w0 = 1.0 + DAMPING / (count as f64).powi(2);
            let w1 = (w0 + 1.0) / method.extent;
            let mut polynomials = Polynomials::at(w0);
            for (index, terms) in method.stages.iter().enumerate() {
                let [_, first, second] = polynomials.now;
                let exact = if index == 0 { 0.25 / (w0 * w0) * w1 } else { w1 * second / first };
                // Rounding as above.
                assert!((terms.time - exact).abs() < 1e-15 * (count as f64).powi(2), "stage {index} of {count}");
                polynomials.rise();
            }
            assert!((method.stages[count - 1].time - 1.0).abs() < 1e-15 * (count as f64).powi(2));
        }
    }

    #[test]
    fn a_step_agrees_with_the_exponential_to_second_order() {
        // Error C z³: halving z divides it by 8, up to relative order z.
        for count in counts() {
            let method = Chebyshev::new(count);
            let error = |z: f64| (by_stages(&method, Complex64::new(z, 0.0)).re - z.exp()).abs();
            let order = (error(-0.02) / error(-0.01)).log2();
            assert!((order - 3.0).abs() < 0.05, "{count} stages: {order}");
        }
    }

    #[test]
    fn decays_within_the_extent_are_damped() {
        for count in counts() {
            let method = Chebyshev::new(count);
            let squares = (count * count) as f64 - 1.0;
            assert!(method.extent >= EXTENT * squares, "{count} stages: {}", method.extent / squares);
            for k in 1..=2000 {
                let factor = by_stages(&method, Complex64::new(-method.extent * f64::from(k) / 2000.0, 0.0)).norm();
                // Rounding as above.
                assert!(factor <= 1.0 + 1e-15 * squares, "{count} stages: {factor}");
            }
            // Beyond it they grow.
            assert!(by_stages(&method, Complex64::new(-1.3 * method.extent, 0.0)).norm() > 1.0);
        }
    }

    #[test]
    fn a_damped_oscillator_never_grows() {
        // ẍ = −κx − gẋ with every g up to λ and κ up to ρg: both roots of x² + gx + κ, for a range of steps up to the
        // longest.
        let decay = 3600.0;
        for ratio in [1.0, 10.0, 30.0, 100.0, 400.0, 2000.0] {
            let stiffness = Stiffness { decay, ratio };
            for power in 0..24 {
                let step = stiffness.longest_step() * 0.7f64.powi(power);
                let method = Chebyshev::new(stiffness.stage_count(step));
                for (i, j) in (0..60).flat_map(|i| (0..=20).map(move |j| (i, j))) {
                    let g = decay * 0.8f64.powi(i);
                    let kappa = ratio * g * f64::from(j) / 20.0;
                    let root = Complex64::new(0.25 * g * g - kappa, 0.0).sqrt();
                    for value in [-0.5 * g + root, -0.5 * g - root] {
                        let factor = by_stages(&method, step * value).norm();
                        assert!(factor <= 1.0 + 1e-12, "h = {step}, ρ = {ratio}, λ = {value}: {factor}");
                    }
                }
            }
        }
    }

    #[test]
    fn oscillations_within_the_circle_never_grow() {
        for count in counts() {
            let method = Chebyshev::new(count);
            let radius = CIRCLE * (1.0 - CIRCLE_LOSS / (count * count) as f64);
            for (i, j) in (1..=20).flat_map(|i| (1..=400).map(move |j| (i, j))) {
                let (radius, angle) = (radius * f64::from(i) / 20.0, std::f64::consts::PI * f64::from(j) / 400.0);
                let z = Complex64::from_polar(radius, angle) - radius;
                let factor = by_stages(&method, z).norm();
                assert!(factor <= 1.0 + 1e-12, "{count} stages, z = {z}: {factor}");
            }
        }
    }
}
