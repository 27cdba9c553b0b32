//! `Cusp`: the correlation function near θ = 0, where S falls too slowly for a power series.

use std::f64::consts::{FRAC_PI_2, PI};

/// The expansions are used below this angle, in units of 1/max(1, f†).
pub(super) const CUSP_BELOW: f64 = 1e-10;

/// The leading terms that are not even powers of the angle:
///
/// ```text
/// Σ S cos fθ − Σ S = Σ_m (−1)^(m+1) A f†^(ms) κ(ms) θ^(ms−1) + O(θ²)        κ(a) = Γ(1−a) sin(πa/2) = π/(2 Γ(a) cos(πa/2))
/// ```
///
/// # Source
/// S = Σ (−1)^(m+1) A (f†/f)^(ms), each term with Σ f^(−a) cos fθ = κ(a) θ^(a−1) + Σ (−1)^j ζ(a−2j) θ^(2j)/(2j)! (DLMF
/// 25.12.12). The sum over m of the first terms is an entire function of f†θ.
///
/// # Accuracy
/// In the value, terms of order (f†θ)^1.8 and higher are neglected: below 10⁻¹⁸ of Σ S.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cusp {
    exponent: f64,
    /// max(1, f†): the terms are powers of scale·θ.
    scale: f64,
    /// The factors of κ(ms) (scale θ)^(ms−1), m = 1 and 2.
    factors: [f64; 2],
}

impl Cusp {
    pub(super) fn new(exponent: f64, scale: f64, factors: [f64; 2]) -> Self {
        Cusp { exponent, scale, factors }
    }

    /// Whether the expansion is valid at this angle.
    pub(super) fn holds(&self, angle: f64) -> bool {
        angle * self.scale < CUSP_BELOW
    }

    /// The largest angle at which the expansion is valid.
    pub(super) fn reach(&self) -> f64 {
        CUSP_BELOW / self.scale
    }

    /// `Σ S cos fθ − Σ S`.
    pub(super) fn value(&self, angle: f64) -> f64 {
        let x = self.scale * angle;
        self.terms(2.8).map(|(factor, a)| factor * kappa(a) * libm::pow(x, a - 1.0)).sum()
    }

    /// The derivative, from its value at [`reach`](Self::reach): the regular part is proportional to θ.
    pub(super) fn slope(&self, angle: f64, slope_at_reach: f64) -> f64 {
        let (x, end) = (self.scale * angle, CUSP_BELOW);
        let share = x / end;
        let cusps: f64 = self
            .terms(4.5)
            .map(|(factor, a)| {
                // κ(a) [x^(a−2) − x end^(a−3)], finite at a = 3, where κ diverges.
                let difference = if (a - 3.0).abs() < 0.1 {
                    let rise = (a - 3.0) * libm::log(share);
                    // cos(πa/2) = sin(π(a−3)/2).
                    let ratio = if rise == 0.0 {
                        libm::log(share) / FRAC_PI_2
                    } else {
                        libm::expm1(rise) / libm::sin(FRAC_PI_2 * (a - 3.0))
                    };
                    FRAC_PI_2 / libm::tgamma(a) * ratio * x * libm::pow(end, a - 3.0)
                } else {
                    kappa(a) * (libm::pow(x, a - 2.0) - x * libm::pow(end, a - 3.0))
                };
                factor * self.scale * (a - 1.0) * difference
            })
            .sum();
        share * slope_at_reach + cusps
    }

    /// Factor and a = ms, for a below `limit`.
    fn terms(&self, limit: f64) -> impl Iterator<Item = (f64, f64)> {
        [(self.factors[0], self.exponent), (self.factors[1], 2.0 * self.exponent)]
            .into_iter()
            .filter(move |&(factor, a)| a < limit && factor != 0.0)
    }
}

/// `κ(a) = π/(2 Γ(a) cos(πa/2))`.
fn kappa(a: f64) -> f64 {
    // cos(πa/2) = −sin(π(a−1)/2), which is accurate near a = 1.
    -PI / (2.0 * libm::tgamma(a) * libm::sin(FRAC_PI_2 * (a - 1.0)))
}
