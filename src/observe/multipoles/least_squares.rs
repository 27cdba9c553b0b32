//! Linear least squares of a few columns by Householder reflections, with the covariance for errors.
//!
//! ```text
//! X = Q R        R c = Qᵀ y        |y − X c|² = |rest of Qᵀ y|²        (XᵀX)⁻¹ = R⁻¹ R⁻ᵀ
//! ```
//!
//! # Source
//! Golub, Van Loan, Matrix Computations, §5.2 and §5.3.

use crate::vector::larger;

/// Smallest ratio of diagonal entries of R at which columns count as independent \[1\]. Below it, a coefficient loses
/// half of its digits.
const LEAST_DIAGONAL: f64 = 1e-8;

/// A factorised matrix of columns, and the right-hand sides with the same reflections.
pub(super) struct LeastSquares {
    /// Columns of R, then the reflected right-hand sides.
    columns: Vec<Vec<f64>>,
    column_count: usize,
}

/// The solution for one right-hand side.
pub(super) struct Solution {
    /// c.
    pub coefficients: Vec<f64>,
    /// |y − X c|².
    pub rest_square: f64,
}

impl LeastSquares {
    /// Factorises columns of equal length, at least as long as their number; `None` if they are not independent.
    pub(super) fn new(mut columns: Vec<Vec<f64>>, right_hand_sides: Vec<Vec<f64>>) -> Option<Self> {
        let column_count = columns.len();
        columns.extend(right_hand_sides);
        for k in 0..column_count {
            let length = columns[k][k..].iter().map(|x| x * x).sum::<f64>().sqrt();
            // The sign avoids cancellation.
            let diagonal = if columns[k][k] > 0.0 { -length } else { length };
            let mut mirror = columns[k][k..].to_vec();
            mirror[0] -= diagonal;
            let square: f64 = mirror.iter().map(|x| x * x).sum();
            if square.is_nan() || square <= 0.0 {
                return None;
            }
            for column in &mut columns[k..] {
                let along: f64 = mirror.iter().zip(&column[k..]).map(|(a, b)| a * b).sum();
                let factor = 2.0 * along / square;
                column[k..].iter_mut().zip(&mirror).for_each(|(x, m)| *x -= factor * m);
            }
        }
        let diagonal = || (0..column_count).map(|k| columns[k][k].abs());
        // A NaN on the diagonal makes both NaN, and the comparison fails.
        let (least, most) =
            (-diagonal().map(|entry| -entry).fold(f64::NEG_INFINITY, larger), diagonal().fold(0.0, larger));
        (least > LEAST_DIAGONAL * most).then_some(LeastSquares { columns, column_count })
    }

    /// The solution for right-hand side `which`.
    pub(super) fn solution(&self, which: usize) -> Solution {
        let reflected = &self.columns[self.column_count + which];
        let mut coefficients = reflected[..self.column_count].to_vec();
        for k in (0..self.column_count).rev() {
            for j in k + 1..self.column_count {
                coefficients[k] -= self.columns[j][k] * coefficients[j];
            }
            coefficients[k] /= self.columns[k][k];
        }
        Solution { coefficients, rest_square: reflected[self.column_count..].iter().map(|x| x * x).sum() }
    }

    /// (XᵀX)⁻¹, row by row.
    pub(super) fn covariance(&self) -> Vec<Vec<f64>> {
        let n = self.column_count;
        // Columns of R⁻¹: upper triangular.
        let mut inverse = vec![vec![0.0; n]; n];
        for column in 0..n {
            for k in (0..=column).rev() {
                let known: f64 = (k + 1..=column).map(|j| self.columns[j][k] * inverse[column][j]).sum();
                let unit = if k == column { 1.0 } else { 0.0 };
                inverse[column][k] = (unit - known) / self.columns[k][k];
            }
        }
        let entry = |a: usize, b: usize| (0..n).map(|column| inverse[column][a] * inverse[column][b]).sum();
        (0..n).map(|a| (0..n).map(|b| entry(a, b)).collect()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_through_three_points_has_its_textbook_answer() {
        // y = 1, 2, 4 at x = 0, 1, 2: slope 3/2, offset 5/6, rest² = 1/6; (XᵀX)⁻¹ = [[5, −3], [−3, 3]]/6.
        let columns = vec![vec![1.0; 3], vec![0.0, 1.0, 2.0]];
        let found = LeastSquares::new(columns, vec![vec![1.0, 2.0, 4.0]]).expect("independent");
        let solution = found.solution(0);
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-14, "{a} is not {b}");
        near(solution.coefficients[0], 5.0 / 6.0);
        near(solution.coefficients[1], 1.5);
        near(solution.rest_square, 1.0 / 6.0);
        for (row, expected) in found.covariance().iter().zip([[5.0, -3.0], [-3.0, 3.0]]) {
            row.iter().zip(expected).for_each(|(value, expected)| near(*value, expected / 6.0));
        }
        assert!(LeastSquares::new(vec![vec![1.0; 3], vec![2.0; 3]], Vec::new()).is_none());
    }
}
