//! The number of independent rings, and the significance of a better fit.

use crate::fit::incomplete_beta::incomplete_beta;

/// Effective number of independent rings, from the residuals of a fit in units of their errors.
///
/// ```text
/// n_eff = n / (1 + 2 Σ_k (1 − k/n) ρ_k)        ρ_k = Σ e_i e_(i+k) / Σ e_i² + p/n
/// ```
///
/// summed up to the first ρ_k that is not positive; at most n. A fit of p parameters changes the correlations of
/// independent residuals by −p/n on average, which is added back. Source: Bayley & Hammersley (1946), Suppl. J. R.
/// Stat. Soc. 8, 184; truncation of the sum as in Geyer (1992), Stat. Sci. 7, 473.
pub(crate) fn effective_count(residuals: &[f64], parameter_count: usize) -> f64 {
    let n = residuals.len() as f64;
    let square: f64 = residuals.iter().map(|e| e * e).sum();
    if square == 0.0 {
        return n;
    }
    let mut sum = 0.0;
    for lag in 1..residuals.len() {
        let product: f64 = residuals.iter().zip(&residuals[lag..]).map(|(a, b)| a * b).sum();
        let correlation = product / square + parameter_count as f64 / n;
        if correlation <= 0.0 {
            break;
        }
        sum += (1.0 - lag as f64 / n) * correlation;
    }
    n / (1.0 + 2.0 * sum)
}

/// Degrees of freedom left by `parameter_count` parameters, at least one.
pub(crate) fn freedom(effective_count: f64, parameter_count: usize) -> f64 {
    (effective_count - parameter_count as f64).max(1.0)
}

/// Probability that `more` extra parameters lower χ² from `simple` to `full` or less by chance: the F test.
///
/// With F = ((simple − full)/more) / (full/freedom) the tail is the incomplete beta function
/// `I_x(freedom/2, more/2)` at x = full/simple, which needs no infinite F for an exact fit.
pub(crate) fn chance(simple: f64, full: f64, more: usize, freedom: f64) -> f64 {
    if !(simple > 0.0 && full < simple) {
        return 1.0;
    }
    // The arguments are in range: freedom ≥ 1, more ≥ 1, 0 ≤ x < 1; NaN must not count as significant.
    incomplete_beta(0.5 * freedom, 0.5 * more as f64, full / simple).unwrap_or(1.0)
}

/// The same probability for the best of `trial_count` independent trials (Šidák).
pub(crate) fn corrected(chance: f64, trial_count: f64) -> f64 {
    // 1 − (1 − p)^T without losing a small p.
    -libm::expm1(trial_count * libm::log1p(-chance))
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
    fn long_runs_of_one_sign_leave_few_independent_rings() {
        let alternating: Vec<f64> = (0..40).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
        assert_eq!(effective_count(&alternating, 0), 40.0);
        // Each value twice: Σ e_i e_(i+1) = 20 − 19 + … with signs alternating in pairs, so ρ_1 = (20 − 19)/40 and
        // ρ_2 < 0: n/(1 + 2·(39/40)/40).
        let pairs: Vec<f64> = (0..40).map(|i| if i / 2 % 2 == 0 { 1.0 } else { -1.0 }).collect();
        assert!((effective_count(&pairs, 0) - 40.0 / (1.0 + 2.0 * 39.0 / 1600.0)).abs() < 1e-12);
        // Two blocks of one sign: ρ_k = (40 − 3k)/40 up to k = 13.
        let blocks: Vec<f64> = (0..40).map(|i| if i < 20 { 1.0 } else { -1.0 }).collect();
        let sum: f64 = (1..=13).map(|k| (1.0 - f64::from(k) / 40.0) * f64::from(40 - 3 * k) / 40.0).sum();
        assert!((effective_count(&blocks, 0) - 40.0 / (1.0 + 2.0 * sum)).abs() < 1e-12);
        // The effect of two parameters is added back: 2/40 to each.
        assert!(effective_count(&blocks, 2) < effective_count(&blocks, 0));
    }

    #[test]
    fn many_tries_cost() {
        assert!((corrected(0.01, 10.0) - (1.0 - 0.99_f64.powi(10))).abs() < 1e-15);
        assert!((corrected(1e-30, 10.0) - 1e-29).abs() < 1e-43);
        assert_eq!(corrected(1.0, 3.0), 1.0);
    }
}
