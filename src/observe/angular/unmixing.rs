//! Removal of leakage from a power spectrum: ⟨P⟩ = K S + ρ N, solved for S and ρ.
//!
//! The variance V = Σ w (x − m)² closes the equations, ⟨V⟩ = Σ_g S_g (1 − |W(g)|²) + ρ (1 − Σ w²). ρ is the variance
//! above the highest frequency and that of independent values of single disks. S is unbiased if ρ is white; single
//! values may be negative.
//! Source: Hivon et al. (2002), Astrophys. J. 567, 2.

use crate::observe::angular::window::SpectralWindow;

/// S for f = 1, … and ρ; none if the equations are singular.
pub(super) fn unmix(window: &SpectralWindow, power: &[f64], variance: f64, shares: Shares) -> Option<(Vec<f64>, f64)> {
    let size = power.len();
    let mut rows: Vec<Vec<f64>> = (0..size)
        .map(|f| {
            let mut row: Vec<f64> = (0..size).map(|g| window.coupling(f + 1, g + 1)).collect();
            row.extend([window.white()[f], power[f]]);
            row
        })
        .collect();
    let mut last = shares.modes;
    last.extend([shares.white, variance]);
    rows.push(last);
    let mut solution = solve(rows)?;
    let unresolved = solution.pop()?;
    Some((solution, unresolved))
}

/// Contributions to V of modes and of independent values of single disks, for unit variance.
pub(super) struct Shares {
    /// 1 − |W(g)|², g = 1, …
    pub modes: Vec<f64>,
    /// 1 − Σ w².
    pub white: f64,
}

/// Gaussian elimination with partial pivoting; each row ends with its right-hand side.
pub(crate) fn solve(mut rows: Vec<Vec<f64>>) -> Option<Vec<f64>> {
    let size = rows.len();
    for column in 0..size {
        let largest = (column..size).max_by(|&a, &b| rows[a][column].abs().total_cmp(&rows[b][column].abs()))?;
        rows.swap(column, largest);
        let (above, below) = rows.split_at_mut(column + 1);
        let pivot = &above[column];
        if pivot[column].is_nan() || pivot[column].abs() < f64::EPSILON {
            return None;
        }
        for row in below {
            let factor = row[column] / pivot[column];
            row[column..].iter_mut().zip(&pivot[column..]).for_each(|(a, p)| *a -= factor * p);
        }
    }
    for column in (0..size).rev() {
        let value = rows[column][size] / rows[column][column];
        rows[column][size] = value;
        for row in &mut rows[..column] {
            row[size] -= row[column] * value;
        }
    }
    Some(rows.iter().map(|row| row[size]).collect())
}
