//! The screened strip, integrated from the held wall.
//!
//! With z = H − y, P = ∇·u/ε and W the amplitude of −∇×u,
//!
//! ```text
//! U' = qV − εP        V' = qU − W        P' = −qW + ΓU        W' = −qP + ΓV
//! ```
//!
//! As in the annulus, two solutions that vanish at the wall are integrated towards a, kept orthogonal, and combined to
//! the displacement at a. The unit of length is a power of two, so the nodes and the wavenumbers are not rounded.

use crate::reference::angular_modes::Complex;
use crate::reference::angular_modes::first_order_system::{Equations, State, size};
use crate::reference::angular_modes::solution_basis::Frame;
use crate::reference::strip_modes::state::{NODE_LIMIT, StripAmplitudes, StripModeError, StripState};
use crate::vector::{larger, two_sum};

/// The series ends at two successive terms below this share of the sum.
const NEGLIGIBLE: f64 = 0.25 * f64::EPSILON;

/// Limit of the number of terms: each is at most 2/k of the one before, so term 30 is below 10⁻²³ of the first.
const TERM_LIMIT: u32 = 60;

/// The equations with lengths in units of 1/`rate`; no coefficient exceeds 1.
///
/// P stands for wP, w = min(1, ε + q). Without shear, q → 0, a unit of displacement needs P = 1/ε, which in a nearly
/// incompressible medium would lose the digits of V.
#[derive(Debug, Clone, Copy)]
struct Equation {
    /// w.
    pressure_unit: f64,
    /// ε/w.
    compliance_ratio: f64,
    wavenumber: f64,
    screening: f64,
}

impl Equations for Equation {
    fn rate(&self, _place: f64) -> f64 {
        1.0
    }

    /// The state a distance `z` farther from the wall, |z| ≤ 1. No coefficient depends on the place.
    fn advance(&self, _place: f64, z: f64, start: State) -> State {
        let (q, epsilon, screening) = (self.wavenumber, self.compliance_ratio, self.screening);
        let (mut sum, mut term, mut small_before) = (start, start, false);
        for index in 1..TERM_LIMIT {
            let [u, v, d, p, w] = term;
            let factor = z / f64::from(index);
            term = [
                (v * q - p * epsilon) * factor,
                (u * q - w) * factor,
                (w - p * epsilon - d * q) * factor,
                (u * screening - w * q) * (self.pressure_unit * factor),
                (v * screening - p * (q / self.pressure_unit)) * factor,
            ];
            for i in 0..term.len() {
                sum[i] += term[i];
            }
            // Displacement and strain separately: near the wall one is much smaller than the other.
            let small = [0..2, 2..3, 3..5].into_iter().all(|range| {
                let total = |state: &State| state[range.clone()].iter().map(|&z| size(z)).sum::<f64>();
                total(&term) <= NEGLIGIBLE * total(&sum)
            });
            if small && small_before && index >= 4 {
                break;
            }
            small_before = small;
        }
        sum
    }

    fn displacement_slope(&self, [u, v, _, p, w]: State) -> [Complex<f64>; 2] {
        [v * self.wavenumber - p * self.compliance_ratio, u * self.wavenumber - w]
    }
}

/// The solution at its nodes.
#[derive(Debug, Clone)]
pub(super) struct ScreenedStrip {
    outer: f64,
    /// One over the distance of nodes, a power of two.
    rate: f64,
    equation: Equation,
    /// At the distances i/rate from the wall, and last at a.
    states: Vec<State>,
    /// H − a, an unevaluated sum.
    depth: (f64, f64),
    pub(super) condition: f64,
}

impl ScreenedStrip {
    pub(super) fn new(
        [inner, outer]: [f64; 2],
        epsilon: f64,
        screening: f64,
        wavenumber: f64,
        boundary: StripAmplitudes,
    ) -> Result<Self, StripModeError> {
        let depth = two_sum(outer, -inner);
        let largest = larger(larger(wavenumber, libm::sqrt(screening.abs())), 1.0 / depth.0);
        // The power of two above it.
        let rate = libm::ldexp(1.0, libm::frexp(largest).1);
        let node_estimate = rate * depth.0;
        if node_estimate.is_nan() || node_estimate > NODE_LIMIT as f64 {
            return Err(StripModeError::TooManyNodes { node_estimate, node_limit: NODE_LIMIT });
        }
        let pressure_unit = (epsilon + wavenumber / rate).min(1.0);
        let equation = Equation {
            pressure_unit,
            compliance_ratio: epsilon / pressure_unit,
            wavenumber: wavenumber / rate,
            screening: screening / rate / rate,
        };
        // Whole steps, and the rest.
        let whole_steps = (node_estimate.ceil() as usize).max(1) - 1;
        let rest = (node_estimate - whole_steps as f64) + depth.1 * rate;
        let steps: Vec<f64> = std::iter::repeat_n(1.0, whole_steps).chain([rest]).collect();

        let mut frames = vec![Frame::held(&equation, 0.0)];
        let mut triangles = Vec::with_capacity(steps.len());
        for &step in &steps {
            let (frame, triangle) = frames[frames.len() - 1].advance(&equation, 0.0, step);
            frames.push(frame);
            triangles.push(triangle);
        }

        let [u, v] = [boundary.normal, boundary.tangential].map(|x| Complex::new(x, 0.0));
        let difference = Complex::new(boundary.normal - boundary.tangential, 0.0);
        let (mut coefficients, edge_condition) =
            frames[frames.len() - 1].with_displacement(&equation, [u, difference], 1.0);
        let condition = edge_condition * closeness(&equation, &steps, &frames);
        // Every node adds a rounding of some 2⁻⁵². With less than this left, the determinant may be zero.
        if condition.is_nan() || condition * 4.0 * f64::EPSILON * frames.len() as f64 >= 1.0 {
            return Err(StripModeError::AtPole { wavenumber, screening, condition });
        }

        let mut states = Vec::with_capacity(frames.len());
        for index in (0..frames.len()).rev() {
            if index < steps.len() {
                coefficients = triangles[index].undo(coefficients);
            }
            states.push(frames[index].combine(coefficients));
        }
        states.reverse();
        if let Some(last) = states.last_mut() {
            last[..3].copy_from_slice(&[u, v, difference]);
        }
        Ok(ScreenedStrip { outer, rate, equation, states, depth, condition })
    }

    pub(super) fn node_count(&self) -> usize {
        self.states.len()
    }

    /// At a place in the strip.
    pub(super) fn at(&self, place: f64) -> StripState {
        let (distance, low) = two_sum(self.outer, -place);
        let last = self.states.len() - 1;
        let nearest = ((distance * self.rate).round() as usize).min(last);
        let z = if nearest < last {
            (distance * self.rate - nearest as f64) + low * self.rate
        } else {
            ((distance - self.depth.0) + (low - self.depth.1)) * self.rate
        };
        let state = self.equation.advance(0.0, z, self.states[nearest]);
        let [u_slope, v_slope] = self.equation.displacement_slope(state);
        // d/dy = −d/dz.
        let amplitudes = |u: Complex<f64>, v: Complex<f64>, factor: f64| StripAmplitudes {
            normal: factor * u.re,
            tangential: factor * v.re,
        };
        StripState { value: amplitudes(state[0], state[1], 1.0), derivative: amplitudes(u_slope, v_slope, -self.rate) }
    }
}

/// The sine of the angle between the solutions that vanish at the wall and those that vanish at a: its value at a over
/// its smallest value anywhere between. At a pole one solution vanishes at both.
fn closeness(equation: &Equation, steps: &[f64], frames: &[Frame]) -> f64 {
    let mut inner = Frame::held(equation, 0.0);
    let mut sines = Vec::with_capacity(frames.len());
    for index in (0..frames.len()).rev() {
        if let Some(&step) = steps.get(index) {
            inner = inner.advance(equation, 0.0, -step).0;
        }
        sines.push(frames[index].smallest_sine(&inner, equation, 0.0));
    }
    sines.iter().fold(1.0, |largest, sine| larger(largest, sines[0] / sine))
}
