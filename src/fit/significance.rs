//! How many independent rings there are, and what a better fit is worth.

use statrs::function::beta::checked_beta_reg;

/// Effective number of independent rings, from the residuals in units of their errors.
///
/// ```text
/// n_eff = n / (1 + 2 Σ_k (1 − k/n) ρ_k)        ρ_k = Σ e_i e_(i+k) / Σ e_i²
/// ```
///
/// summed up to the first ρ_k that n independent residuals would show by chance, ρ_k ≤ 1/√n (Bartlett's error). Never
/// more than n. Source: Bayley & Hammersley (1946), Suppl. J. R. Stat. Soc. 8, 184.
pub(crate) fn effective_count(residuals: &[f64]) -> f64 {
    let n = residuals.len() as f64;
    let square: f64 = residuals.iter().map(|e| e * e).sum();
    if square == 0.0 {
        return n;
    }
    let mut sum = 0.0;
    for lag in 1..residuals.len() {
        let product: f64 = residuals.iter().zip(&residuals[lag..]).map(|(a, b)| a * b).sum();
        let correlation = product / square;
        if correlation <= 1.0 / n.sqrt() {
            break;
        }
        sum += (1.0 - lag as f64 / n) * correlation;
    }
    n / (1.0 + 2.0 * sum)
}

/// Degrees of freedom that `parameter_count` parameters leave, never less than one.
pub(crate) fn freedom(effective_count: f64, parameter_count: usize) -> f64 {
    (effective_count - parameter_count as f64).max(1.0)
}

/// Probability that `more` extra parameters lower χ² from `simple` to `full` or below by chance: the F test.
///
/// With F = ((simple − full)/more) / (full/freedom) the tail is the incomplete beta function
/// `I_x(freedom/2, more/2)` at x = full/simple, which needs no infinite F for an exact fit.
pub(crate) fn chance(simple: f64, full: f64, more: usize, freedom: f64) -> f64 {
    if !(simple > 0.0 && full < simple) {
        return 1.0;
    }
    // The arguments are in range: freedom ≥ 1, more ≥ 1, 0 ≤ x < 1; NaN, if it ever came, must not look significant.
    checked_beta_reg(0.5 * freedom, 0.5 * more as f64, full / simple).unwrap_or(1.0)
}

/// The same probability when the best of `trial_count` independent tries was taken (Šidák).
pub(crate) fn corrected(chance: f64, trial_count: f64) -> f64 {
    // 1 − (1 − p)^T without losing a small p.
    -(trial_count * (-chance).ln_1p()).exp_m1()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chance_is_the_tail_of_the_f_distribution() {
        // F(1, 10) = 4.9646 and F(2, 20) = 5.8489 are the 5 % and 1 % points (tables, 5 digits).
        let tail = |f: f64, more: usize, freedom: f64| chance(1.0 + f * more as f64 / freedom, 1.0, more, freedom);
        assert!((tail(4.9646, 1, 10.0) - 0.05).abs() < 1e-6);
        assert!((tail(5.8489, 2, 20.0) - 0.01).abs() < 1e-6);
        assert_eq!(chance(1.0, 0.0, 1, 10.0), 0.0);
        assert_eq!(chance(0.0, 0.0, 1, 10.0), 1.0);
        assert_eq!(chance(f64::NAN, 1.0, 1, 10.0), 1.0);
    }

    #[test]
    fn independent_residuals_count_in_full_and_pairs_half() {
        let alternating: Vec<f64> = (0..40).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
        assert_eq!(effective_count(&alternating), 40.0);
        // Each value twice: ρ_1 = 19.5/40 or so, hence about n/2.
        let pairs: Vec<f64> = (0..40).map(|i| [1.0, -1.0, -1.0, 1.0, -1.0][(i / 2) % 5]).collect();
        let count = effective_count(&pairs);
        assert!((18.0..32.0).contains(&count), "{count}");
    }

    #[test]
    fn many_tries_cost() {
        assert!((corrected(0.01, 10.0) - (1.0 - 0.99_f64.powi(10))).abs() < 1e-15);
        assert!((corrected(1e-30, 10.0) - 1e-29).abs() < 1e-43);
        assert_eq!(corrected(1.0, 3.0), 1.0);
    }
}
