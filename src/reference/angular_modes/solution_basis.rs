//! `Frame`: the two solutions that vanish at the rim, integrated inward without becoming parallel.
//!
//! Towards the centre every solution grows like r^(−n−1) or r^(−n+1). Two solutions integrated independently would soon
//! differ only by rounding. They are therefore orthogonalised at every node, and the transformation is stored. On the
//! way back outward, where the solution decays, the transformation is undone without growth of errors.
//!
//! # Source
//! Conte (1966), SIAM Rev. 8, 309 (after Godunov).

use crate::reference::angular_modes::Complex;
use crate::reference::angular_modes::first_order_system::{Equations, State, size};
use crate::vector::larger;

/// Two solutions, orthonormal in U, v, P and W; the last two are divided by the rate.
#[derive(Debug, Clone, Copy)]
pub(in crate::reference) struct Frame {
    pub(in crate::reference) columns: [State; 2],
}

/// The upper triangular matrix from coefficients in the new frame to those in the old: `old = new · triangle`.
#[derive(Debug, Clone, Copy)]
pub(in crate::reference) struct Triangle {
    first: f64,
    across: Complex<f64>,
    second: f64,
}

impl Frame {
    /// On a held circle of this radius: no displacement; pure dilation and pure rotation.
    pub(in crate::reference) fn held<E: Equations>(system: &E, radius: f64) -> Self {
        let (zero, one) = (Complex::new(0.0, 0.0), Complex::new(system.rate(radius), 0.0));
        Frame { columns: [[zero, zero, zero, one, zero], [zero, zero, zero, zero, one]] }
    }

    /// The frame at `radius` (1 − z), orthonormal, and the triangle that relates it to the integrated one.
    pub(in crate::reference) fn advance<E: Equations>(&self, system: &E, radius: f64, z: f64) -> (Self, Triangle) {
        Frame::orthonormal(self.columns.map(|column| system.advance(radius, z, column)), system, radius * (1.0 - z))
    }

    /// The frame of two solutions at `radius`, and the triangle that relates it to them.
    pub(in crate::reference) fn orthonormal<E: Equations>(
        [mut first, mut second]: [State; 2],
        system: &E,
        radius: f64,
    ) -> (Self, Triangle) {
        let scale = 1.0 / system.rate(radius);
        let weight = scale * scale;
        let length = product(&first, &first, weight).re.sqrt();
        first = first.map(|x| x / length);
        let across = product(&first, &second, weight);
        for i in 0..second.len() {
            second[i] -= first[i] * across;
        }
        let rest = product(&second, &second, weight).re.sqrt();
        second = second.map(|x| x / rest);
        (Frame { columns: [first, second] }, Triangle { first: length, across, second: rest })
    }

    /// The sine of the smaller angle between the solutions of this frame and of another one at `radius`: 0 if they
    /// share a solution. The product of both sines is the volume that they span, which is accurate even if it is small.
    /// The square of the larger sine is an eigenvalue of the complement of the projection on the other frame.
    pub(in crate::reference) fn smallest_sine<E: Equations>(&self, frame: &Frame, system: &E, radius: f64) -> f64 {
        let scale = 1.0 / system.rate(radius);
        let minor = |frame: &Frame, i: usize, j: usize| {
            let row = |i: usize| frame.columns.map(|column| if i > 2 { column[i] * scale } else { column[i] });
            let (first, second) = (row(i), row(j));
            first[0] * second[1] - first[1] * second[0]
        };
        // Complementary pairs of U, v, P, W (0, 1, 3, 4), with the sign of their permutation.
        let pairs = [([0, 1], [3, 4], 1.0), ([0, 3], [1, 4], -1.0), ([0, 4], [1, 3], 1.0)];
        let volume: Complex<f64> = pairs
            .into_iter()
            .flat_map(|(one, other, sign)| [(one, other, sign), (other, one, sign)])
            .map(|(one, other, sign)| minor(self, one[0], one[1]) * minor(frame, other[0], other[1]) * sign)
            .sum();

        let weight = scale * scale;
        let rest = frame.columns.map(|column| {
            let [first, second] = self.columns.map(|mine| product(&mine, &column, weight));
            std::array::from_fn(|i| column[i] - self.columns[0][i] * first - self.columns[1][i] * second)
        });
        let [first, second] = [0, 1].map(|i| product(&rest[i], &rest[i], weight).re);
        let across = modulus(product(&rest[0], &rest[1], weight));
        let largest = 0.5 * (first + second) + libm::hypot(0.5 * (first - second), across);
        modulus(volume) / largest.sqrt()
    }

    /// The solution with these coefficients.
    pub(in crate::reference) fn combine(&self, coefficients: [Complex<f64>; 2]) -> State {
        std::array::from_fn(|i| self.columns[0][i] * coefficients[0] + self.columns[1][i] * coefficients[1])
    }

    /// The coefficients of the solution with given U and d, and the condition number of their equation. It is the sum
    /// of the products in the determinant, over the determinant; each factor is replaced by the amplitude of its
    /// oscillation, the larger of |U| and length |U'|.
    pub(in crate::reference) fn with_displacement<E: Equations>(
        &self,
        system: &E,
        [u, d]: [Complex<f64>; 2],
        relative_length: f64,
    ) -> ([Complex<f64>; 2], f64) {
        let [first, second] = self.columns.map(|column| [column[0], column[2]]);
        let determinant = first[0] * second[1] - second[0] * first[1];
        let coefficients = [(u * second[1] - d * second[0]) / determinant, (d * first[0] - u * first[1]) / determinant];
        let [first_envelope, second_envelope] = self.columns.map(|column| {
            let [u_slope, v_slope] = system.displacement_slope(column);
            let slopes = [u_slope, u_slope - v_slope];
            [(column[0], slopes[0]), (column[2], slopes[1])]
                .map(|(value, slope)| larger(size(value), relative_length * size(slope)))
        });
        let products = first_envelope[0] * second_envelope[1] + second_envelope[0] * first_envelope[1];
        (coefficients, products / size(determinant))
    }
}

impl Triangle {
    /// The coefficients in the previous frame from those in this one.
    pub(in crate::reference) fn undo(&self, [first, second]: [Complex<f64>; 2]) -> [Complex<f64>; 2] {
        let second = second / self.second;
        [(first - self.across * second) / self.first, second]
    }
}

/// |a|.
fn modulus(a: Complex<f64>) -> f64 {
    libm::hypot(a.re, a.im)
}

/// `Σ conj(a_i) b_i` over U, v, P, W, the last two with `weight`; d is not an independent component.
fn product(a: &State, b: &State, weight: f64) -> Complex<f64> {
    a[0].conj() * b[0] + a[1].conj() * b[1] + (a[3].conj() * b[3] + a[4].conj() * b[4]) * weight
}
