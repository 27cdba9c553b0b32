//! [`dependence`]: correlations between the powers of one ring.
//!
//! ```text
//! D = (1/m) Σ_(f,f' ≤ m) cov(P_f, P_f')/(⟨P_f⟩⟨P_f'⟩)        m/D: number of independent powers with the same scatter
//! ```
//!
//! The sums F_f = Σ_k v_fk x_k, v_fk = w_k (e^(−ifθ_k) − W̄(f)), of a Gaussian field are Gaussian, and P_f = 2|F_f|²,
//! so
//!
//! ```text
//! cov(P_f, P_f') = 4 (|Γ|² + |C|²)      Γ = ⟨F_f F̄_f'⟩ = ½ Σ_g S_g (A_fg Ā_f'g + B_fg B̄_f'g)      C = ⟨F_f F_f'⟩, the same without bars
//! A_fg = W(g−f) − W̄(f) W(g)             B_fg = W̄(g+f) − W̄(f) W̄(g)                                  C = ½ Σ_g S_g (A_fg B_f'g + B_fg A_f'g)
//! ```
//!
//! W as in [`SpectralWindow`](crate::observe::angular::SpectralWindow). For evenly spaced angles D = 1. For irregular
//! angles the leakage of low frequencies is common to all powers: D = 2.2 for the 15 powers of 60 disks and S ∝
//! f^(−1.5).
//! Source: Isserlis (1918), Biometrika 12, 134 (fourth moments).

use num_complex::Complex64;

use crate::observe::angular::fourier::fourier_sums;
use crate::observe::angular::ring::{RingSample, Weights};

/// D of the powers f = 1, …, `frequency_limit` of a ring, for a spectrum up to `highest`; NaN if it has no power.
///
/// Frequencies above 2n, n the number of disks, count as independent values of single disks.
///
/// # Cost
/// `frequency_limit`² · n complex products.
pub fn dependence(
    ring: &RingSample,
    weights: Weights,
    frequency_limit: usize,
    spectrum: impl Fn(f64) -> f64,
    highest: usize,
) -> f64 {
    let counts = ring.weights(weights);
    let source_limit = highest.min(2 * ring.disk_count()).max(1);
    let sums = fourier_sums(ring.angles(), &counts, frequency_limit + source_limit);
    let squares: Vec<f64> = counts.iter().map(|w| w * w).collect();
    let square_sums = fourier_sums(ring.angles(), &squares, 2 * frequency_limit);
    // fourier_sums has e^(−ihθ); W has e^(ihθ).
    let of = |sums: &[Complex64], h: i64| if h < 0 { sums[h.unsigned_abs() as usize] } else { sums[h as usize].conj() };
    let (w, w2) = (|h: i64| of(&sums, h), |h: i64| of(&square_sums, h));
    let single: f64 = (source_limit + 1..=highest).map(|g| spectrum(g as f64)).sum();
    let strengths: Vec<f64> = (1..=source_limit).map(|g| (0.5 * spectrum(g as f64)).sqrt()).collect();
    let sources = || (1..).zip(&strengths);
    // √(S/2) A and √(S/2) B of every f, one after the other.
    let rows: Vec<Vec<Complex64>> = (1..=frequency_limit as i64)
        .map(|f| {
            let direct = |(g, strength): (i64, &f64)| strength * (w(g - f) - w(-f) * w(g));
            let mirrored = |(g, strength): (i64, &f64)| strength * (w(-g - f) - w(-f) * w(-g));
            sources().map(direct).chain(sources().map(mirrored)).collect()
        })
        .collect();
    let pair = |f: usize, other: usize| {
        let (a, b) = (&rows[f - 1], &rows[other - 1]);
        let plain: Complex64 = a.iter().zip(b).map(|(x, y)| x * y.conj()).sum();
        // A of one frequency with B of the other.
        let turned = b[source_limit..].iter().chain(&b[..source_limit]);
        let crossed: Complex64 = a.iter().zip(turned).map(|(x, y)| x * y).sum();
        let (f, other) = (f as i64, other as i64);
        let of_disks = |g: i64| w2(g - f) - w(g) * w2(-f) - w(-f) * w2(g) + w(-f) * w(g) * w2(0);
        (plain + single * of_disks(other), crossed + single * of_disks(-other))
    };
    let means: Vec<f64> = (1..=frequency_limit).map(|f| pair(f, f).0.re).collect();
    let mut sum = 0.0;
    for f in 1..=frequency_limit {
        for other in f..=frequency_limit {
            let (plain, crossed) = pair(f, other);
            let share = (plain.norm_sqr() + crossed.norm_sqr()) / (means[f - 1] * means[other - 1]);
            sum += if other == f { share } else { 2.0 * share };
        }
    }
    sum / frequency_limit as f64
}
