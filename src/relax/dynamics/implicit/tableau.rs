//! Coefficients of a Rosenbrock method, in the form without products with the matrix.
//!
//! ```text
//! (1/(hγ) − J̃) U_i = f(y + Σ_{j<i} a_ij U_j) + Σ_{j<i} (c_ij/h) U_j        y' = y + Σ m_j U_j
//! ```
//!
//! [`ROS34PW2`] has four stages and order 3; it is L-stable and stiffly accurate. It keeps its order for every J̃ (a
//! *W-method*). So J̃ may omit unsymmetric parts, be outdated, or be made definite. Its embedded solution `y + Σ m̂_j
//! U_j` has order 2.
//!
//! # Source
//! Rang, Angermann (2005), BIT Numer. Math. 45, 761, ROS34PW2. The form: Hairer, Wanner (1996), Solving Ordinary
//! Differential Equations II, §IV.7.

/// Stages of the method.
pub const STAGE_COUNT: usize = 4;

/// Coefficients of a method in the form above; on and above the diagonal they are 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tableau {
    /// γ, on the diagonal of every stage; g in the equations of a step, where γ is the damping.
    pub diagonal: f64,
    /// a_ij.
    pub argument: [[f64; STAGE_COUNT]; STAGE_COUNT],
    /// c_ij.
    pub carried: [[f64; STAGE_COUNT]; STAGE_COUNT],
    /// m_j − m̂_j.
    pub error: [f64; STAGE_COUNT],
}

/// The method as published: α_ij, γ_ij below the diagonal, b̂_j. Stiffly accurate: b_j = α_4j + γ_4j.
const PUBLISHED_DIAGONAL: f64 = 4.358_665_215_084_59e-1;
const PUBLISHED_ARGUMENT: [[f64; STAGE_COUNT]; STAGE_COUNT] = [
    [0.0; STAGE_COUNT],
    [8.717_330_430_169_18e-1, 0.0, 0.0, 0.0],
    [8.445_706_001_536_942e-1, -1.129_906_423_648_418_5e-1, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0],
];
const PUBLISHED_IMPLICIT: [[f64; STAGE_COUNT]; STAGE_COUNT] = [
    [PUBLISHED_DIAGONAL, 0.0, 0.0, 0.0],
    [-8.717_330_430_169_18e-1, PUBLISHED_DIAGONAL, 0.0, 0.0],
    [-9.033_805_701_304_408e-1, 5.418_067_238_809_532_6e-2, PUBLISHED_DIAGONAL, 0.0],
    [2.421_238_070_609_534_6e-1, -1.223_250_583_904_514_7, 5.452_602_553_351_021e-1, PUBLISHED_DIAGONAL],
];
const PUBLISHED_EMBEDDED: [f64; STAGE_COUNT] =
    [3.781_090_314_581_937e-1, -9.604_229_221_242_318e-2, 0.5, 2.179_332_607_542_295e-1];

/// ROS34PW2.
pub const ROS34PW2: Tableau = transformed();

/// With U = Γ k, Γ the matrix of γ_ij: a = α Γ⁻¹, c = 1/γ − Γ⁻¹, m = b Γ⁻¹.
const fn transformed() -> Tableau {
    let inverse = inverse(PUBLISHED_IMPLICIT);
    let mut tableau = Tableau {
        diagonal: PUBLISHED_DIAGONAL,
        argument: [[0.0; STAGE_COUNT]; STAGE_COUNT],
        carried: [[0.0; STAGE_COUNT]; STAGE_COUNT],
        error: [0.0; STAGE_COUNT],
    };
    let mut i = 0;
    while i < STAGE_COUNT {
        let mut j = 0;
        while j < STAGE_COUNT {
            let mut k = j;
            while k < STAGE_COUNT {
                tableau.argument[i][j] += PUBLISHED_ARGUMENT[i][k] * inverse[k][j];
                k += 1;
            }
            if j < i {
                tableau.carried[i][j] = -inverse[i][j];
            } else {
                tableau.argument[i][j] = 0.0;
            }
            j += 1;
        }
        i += 1;
    }
    let mut j = 0;
    while j < STAGE_COUNT {
        // m: the last row of a, and 1 for the last stage.
        tableau.error[j] = if j + 1 == STAGE_COUNT { 1.0 } else { tableau.argument[STAGE_COUNT - 1][j] };
        let mut k = j;
        while k < STAGE_COUNT {
            tableau.error[j] -= PUBLISHED_EMBEDDED[k] * inverse[k][j];
            k += 1;
        }
        j += 1;
    }
    tableau
}

/// Inverse of a lower triangular matrix, by forward substitution.
const fn inverse(matrix: [[f64; STAGE_COUNT]; STAGE_COUNT]) -> [[f64; STAGE_COUNT]; STAGE_COUNT] {
    let mut inverse = [[0.0; STAGE_COUNT]; STAGE_COUNT];
    let mut column = 0;
    while column < STAGE_COUNT {
        let mut row = column;
        while row < STAGE_COUNT {
            let mut value = if row == column { 1.0 } else { 0.0 };
            let mut k = column;
            while k < row {
                value -= matrix[row][k] * inverse[k][column];
                k += 1;
            }
            inverse[row][column] = value / matrix[row][row];
            row += 1;
        }
        column += 1;
    }
    inverse
}

#[cfg(test)]
mod tests {
    use super::*;

    type Row = [f64; STAGE_COUNT];

    fn row_sums(matrix: &[Row; STAGE_COUNT]) -> Row {
        std::array::from_fn(|i| matrix[i].iter().sum())
    }

    fn times(matrix: &[Row; STAGE_COUNT], column: Row) -> Row {
        std::array::from_fn(|i| matrix[i].iter().zip(column).map(|(a, b)| a * b).sum())
    }

    fn product(a: Row, b: Row) -> f64 {
        a.iter().zip(b).map(|(a, b)| a * b).sum()
    }

    /// b_j of the method, which is stiffly accurate.
    fn weights() -> Row {
        std::array::from_fn(|j| PUBLISHED_ARGUMENT[3][j] + PUBLISHED_IMPLICIT[3][j])
    }

    #[test]
    fn the_order_conditions_of_a_w_method_hold_to_rounding() {
        // Hairer, Wanner (1996), §IV.7, eq. (7.11) with the conditions of W-methods: every tree of up to three
        // vertices, with either matrix on its edges. Sums of four products below 2: 4 roundings of 10⁻¹⁶.
        let (a, g) = (&PUBLISHED_ARGUMENT, &PUBLISHED_IMPLICIT);
        let (alpha, gamma) = (row_sums(a), row_sums(g));
        let squares = std::array::from_fn(|i| alpha[i] * alpha[i]);
        let b = weights();
        let close = |value: f64, exact: f64| assert!((value - exact).abs() < 1e-15, "{value} for {exact}");
        for b in [b, PUBLISHED_EMBEDDED] {
            close(b.iter().sum(), 1.0);
            close(product(b, alpha), 0.5);
            close(product(b, gamma), 0.0);
        }
        close(product(b, squares), 1.0 / 3.0);
        close(product(b, times(a, alpha)), 1.0 / 6.0);
        close(product(b, times(a, gamma)), 0.0);
        close(product(b, times(g, alpha)), 0.0);
        close(product(b, times(g, gamma)), 0.0);
        // The embedded solution is only of order 2; otherwise the difference would not estimate the error.
        assert!((product(PUBLISHED_EMBEDDED, squares) - 1.0 / 3.0).abs() > 0.01);
    }

    /// Amplification factor of a step for y' = λ y, with z = hλ real or imaginary, as (real, imaginary) part; and the
    /// same factor of the estimated error.
    fn factor(z: (f64, f64)) -> ((f64, f64), (f64, f64)) {
        let times = |a: (f64, f64), b: (f64, f64)| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
        let divided = |a: (f64, f64), b: (f64, f64)| {
            let squared = b.0 * b.0 + b.1 * b.1;
            ((a.0 * b.0 + a.1 * b.1) / squared, (a.1 * b.0 - a.0 * b.1) / squared)
        };
        let matrix = (1.0 / ROS34PW2.diagonal - z.0, -z.1);
        let mut stages = [(0.0, 0.0); STAGE_COUNT];
        let (mut end, mut error) = ((0.0, 0.0), (0.0, 0.0));
        for i in 0..STAGE_COUNT {
            let (mut y, mut carried) = ((1.0, 0.0), (0.0, 0.0));
            for j in 0..i {
                y = (y.0 + ROS34PW2.argument[i][j] * stages[j].0, y.1 + ROS34PW2.argument[i][j] * stages[j].1);
                carried = (
                    carried.0 + ROS34PW2.carried[i][j] * stages[j].0,
                    carried.1 + ROS34PW2.carried[i][j] * stages[j].1,
                );
            }
            let slope = times(z, y);
            stages[i] = divided((slope.0 + carried.0, slope.1 + carried.1), matrix);
            end = (y.0 + stages[i].0, y.1 + stages[i].1);
            error = (error.0 + ROS34PW2.error[i] * stages[i].0, error.1 + ROS34PW2.error[i] * stages[i].1);
        }
        (end, error)
    }

    #[test]
    fn a_step_is_stable_for_every_decay_and_every_oscillation_and_kills_the_stiffest() {
        for power in -40..=80 {
            let size = 10f64.powf(f64::from(power) / 10.0);
            for z in [(-size, 0.0), (0.0, size), (-size, size), (-0.1 * size, size)] {
                let (end, _) = factor(z);
                // 1 + 4 u on the imaginary axis near 0, where the exact factor is 1.
                assert!(end.0.hypot(end.1) <= 1.0 + 1e-15, "z = {z:?}: {end:?}");
            }
        }
        let (end, error) = factor((-1e8, 0.0));
        assert!(end.0.abs() < 1e-7 && error.0.abs() < 0.5, "{end:?} {error:?}");
    }

    #[test]
    fn a_step_agrees_with_the_exponential_to_third_order() {
        // Error C h⁴ per step: halving h divides it by 16, up to relative order h.
        let error = |h: f64| (factor((-h, 0.0)).0.0 - (-h).exp()).abs();
        let order = (error(0.02) / error(0.01)).log2();
        assert!((order - 4.0).abs() < 0.05, "{order}");
        let estimate = |h: f64| factor((-h, 0.0)).1.0.abs();
        let order = (estimate(0.02) / estimate(0.01)).log2();
        assert!((order - 3.0).abs() < 0.05, "{order}");
    }
}
