//! Nodes and weights of Gauss–Legendre quadrature for any number of nodes.

use std::f64::consts::PI;

/// Nodes in (−1, 1), ascending, and weights: `∫ f dx = Σ weight f(node)`, exact for polynomials up to degree 2·count −
/// 1.
///
/// Newton's method on the Legendre polynomial from the estimate `cos(π (k − 1/4)/(count + 1/2))`; the weight is
/// `2 / ((1 − x²) P'(x)²)`.
///
/// # Source
/// Abramowitz & Stegun (1964), 25.4.29 and 22.16.6.
pub(super) fn gauss_legendre(count: usize) -> (Vec<f64>, Vec<f64>) {
    let (mut nodes, mut weights) = (vec![0.0; count], vec![0.0; count]);
    for index in 0..count.div_ceil(2) {
        let mut x = libm::cos(PI * (index as f64 + 0.75) / (count as f64 + 0.5));
        // The estimate has an error of O(count⁻²) of the spacing, and every step squares it: four steps suffice from 4
        // to 1000 nodes; the fifth fixes the last bit.
        for _ in 0..5 {
            let (value, slope) = legendre(count, x);
            x -= value / slope;
        }
        let (_, slope) = legendre(count, x);
        let weight = 2.0 / ((1.0 - x) * (1.0 + x) * slope * slope);
        // The middle one of an odd number is 0.
        let x = if 2 * index + 1 == count { 0.0 } else { x };
        (nodes[index], weights[index]) = (-x, weight);
        (nodes[count - 1 - index], weights[count - 1 - index]) = (x, weight);
    }
    (nodes, weights)
}

/// The Legendre polynomial of a degree and its derivative, |x| < 1.
fn legendre(degree: usize, x: f64) -> (f64, f64) {
    let (mut previous, mut value) = (1.0, x);
    for n in 1..degree {
        let n = n as f64;
        (previous, value) = (value, ((2.0 * n + 1.0) * x * value - n * previous) / (n + 1.0));
    }
    (value, degree as f64 * (previous - x * value) / ((1.0 - x) * (1.0 + x)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_up_to_twice_the_count_are_exact() {
        for count in [4, 12, 16, 20, 28, 120, 540] {
            let (nodes, weights) = gauss_legendre(count);
            for degree in [0, 2, 3, count, 2 * count - 2, 2 * count - 1] {
                let found: f64 = nodes.iter().zip(&weights).map(|(x, w)| w * x.powi(degree as i32)).sum();
                let expected = if degree % 2 == 1 { 0.0 } else { 2.0 / (degree as f64 + 1.0) };
                // Roundings of the nodes, times the degree; of the weights, through the recurrence; of the sum.
                let tolerance = (degree + count + 10) as f64 * f64::EPSILON;
                assert!((found - expected).abs() < tolerance, "{count} nodes, x^{degree}: {found}, not {expected}");
            }
        }
    }
}
