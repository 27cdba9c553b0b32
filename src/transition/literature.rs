//! [`Comparison`]: what was found beside what is published.
//!
//! Source: design §6; the study. A published value agrees where the interval of 95 % holds it.

use serde::Serialize;

use crate::fit::Estimate;
use crate::fit::ensemble::{BootstrapInterval, DivergenceOutcome};
use crate::transition::lengths::JammingSeries;
use crate::transition::pressure::{
    Method, SCALE_FREE_ANGLE, SCALE_FREE_ANTICORRELATION, SCALE_FREE_SLOPE, TransitionPressure,
};
use crate::transition::scaling::{ExponentOutcome, PressureLaw, Scaling, beta};
use crate::transition::series::Series;

/// One number beside its published value.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// What it is, in words.
    pub quantity: String,
    /// Of which series or law.
    pub of: String,
    /// What was found \[unit of the quantity\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// Its interval, 95 % \[the same\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interval: Option<[f64; 2]>,
    /// What is published \[the same\].
    pub published: f64,
    /// Whether they agree.
    pub verdict: Verdict,
}

/// Whether a found and a published number agree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The interval holds the published value.
    Agrees,
    /// It does not.
    Differs,
    /// The series bounds it, and the published value is beyond the bound: no contradiction, and no confirmation.
    Beyond,
    /// The series bounds it on the other side.
    Excluded,
    /// There is no interval.
    Unknown,
}

impl Verdict {
    /// In one word.
    pub fn name(self) -> &'static str {
        match self {
            Verdict::Agrees => "agrees",
            Verdict::Differs => "differs",
            Verdict::Beyond => "beyond",
            Verdict::Excluded => "excluded",
            Verdict::Unknown => "unknown",
        }
    }
}

impl Comparison {
    fn interval(quantity: &str, of: &str, value: f64, interval: Option<[f64; 2]>, published: f64) -> Self {
        let verdict = match interval {
            Some([low, high]) if low <= published && published <= high => Verdict::Agrees,
            Some(_) => Verdict::Differs,
            None => Verdict::Unknown,
        };
        Comparison { quantity: quantity.into(), of: of.into(), value: Some(value), interval, published, verdict }
    }

    fn bootstrap(quantity: &str, of: &str, found: &BootstrapInterval, published: f64) -> Self {
        Self::interval(quantity, of, found.best, found.interval, published)
    }

    fn estimate(quantity: &str, of: &str, found: Estimate, published: f64) -> Self {
        let ends = [-2.0, 2.0].map(|errors| found.value + errors * found.standard_error);
        Self::interval(quantity, of, found.value, Some(ends), published)
    }

    fn pressure(quantity: &str, of: &str, found: TransitionPressure, published: f64) -> Self {
        let bound = |verdict| Comparison {
            quantity: quantity.into(),
            of: of.into(),
            value: None,
            interval: None,
            published,
            verdict,
        };
        match found {
            TransitionPressure::Found(found) => Self::bootstrap(quantity, of, &found, published),
            TransitionPressure::Between(ends) => {
                // Pressures of packings are met within a hundredth.
                let wide = [0.98 * ends[0], 1.02 * ends[1]];
                Self::interval(quantity, of, (ends[0] * ends[1]).sqrt(), Some(wide), published)
            }
            TransitionPressure::Above(highest) => {
                bound(if published >= highest { Verdict::Beyond } else { Verdict::Excluded })
            }
            TransitionPressure::Below(lowest) => {
                bound(if published <= lowest { Verdict::Beyond } else { Verdict::Excluded })
            }
            TransitionPressure::Unordered => bound(Verdict::Unknown),
        }
    }
}

/// All that can be compared.
pub(super) fn comparisons(
    series: &[Series],
    scaling: &[Scaling],
    laws: &[PressureLaw],
    jamming: &[JammingSeries],
) -> Vec<Comparison> {
    let mut all = Vec::new();
    // p̂_c is published for Hertzian disks and d_0 = 0.1.
    for one in series.iter().filter(|one| beta(&one.cell.law) == 3.0 && one.cell.increase == 0.1) {
        let of = one.name();
        for estimate in &one.estimates {
            let published = match estimate.method {
                Method::Wavenumber => 3e8,
                Method::PressureChange => 3e8,
                _ => 1e8,
            };
            let quantity = format!("p̂_c by {}", estimate.method.name());
            all.push(Comparison::pressure(&quantity, &of, estimate.pressure, published));
        }
        if let Some(at) = &one.at_published {
            let numbers = [
                ("slope of S(f) at p̂ = 10⁸", at.slope, SCALE_FREE_SLOPE),
                ("G* at p̂ = 10⁸", at.anticorrelation, SCALE_FREE_ANTICORRELATION),
                ("θ* at p̂ = 10⁸", at.angle, SCALE_FREE_ANGLE),
            ];
            for (quantity, found, published) in numbers {
                all.extend(found.map(|found| Comparison::bootstrap(quantity, &of, &found, published)));
            }
        }
        if let Some(at) = &one.at_transition {
            let numbers = [
                ("G* at p̂_c by the slope", at.anticorrelation, SCALE_FREE_ANTICORRELATION),
                ("θ* at p̂_c by the slope", at.angle, SCALE_FREE_ANGLE),
            ];
            for (quantity, found, published) in numbers {
                all.extend(found.map(|found| Comparison::bootstrap(quantity, &of, &found, published)));
            }
        }
        for (point, change) in one.points.iter().zip(&one.pressure_changes).filter(|(it, _)| it.reduced_pressure < 5e7)
        {
            if let Some(change) = change {
                let quantity = format!("Δp/p^(1/3) at p̂ = {:.0e}", point.reduced_pressure);
                all.push(Comparison::interval(&quantity, &of, change.mean, change.mean_interval, -0.05));
            }
        }
        for lengths in &one.lengths {
            if let (Some(length), Some(excess)) = (lengths.isostatic, lengths.excess) {
                let quantity = format!("ℓ_iso ΔZ at p̂ = {:.0e}", lengths.point.reduced_pressure);
                all.push(Comparison::interval(&quantity, &of, length * excess, None, 6.0));
            }
        }
        if let Some(matching) = one.matching {
            let reduced = matching * libm::pow(one.mobile_count(), 1.5);
            all.push(Comparison::interval("p̂ where ℓ_iso is 1/κ₁", &of, reduced, None, 1e8));
        }
        if let Some(fit) = one.divergence.at_transition {
            all.push(Comparison::estimate("μ of θ† ∼ (p̂_c − p̂)^(−μ), p̂_c by the slope", &of, fit.exponent, 0.9));
        }
    }
    for one in scaling {
        let of = format!("{}, {} curves", one.law.name(), one.curve_count);
        let beta = beta(&one.law);
        let exponents = [("N^a", one.size_exponent, 0.5 * beta), ("d_0^(−b)", one.inflation_exponent, 0.25 * beta)];
        for (factor, outcome, published) in exponents {
            let quantity = format!("exponent of {factor}, collapse of {}", words(one.observable));
            if let Some(ExponentOutcome::Found(found)) = outcome {
                all.push(Comparison::bootstrap(&quantity, &of, &found, published));
            }
        }
    }
    for one in laws {
        if let Some(fit) = &one.fit {
            let of = format!("{}, {} p_c by {}", one.law.name(), one.points.len(), one.method.name());
            let quantity = "c of N^β p_c ∼ (N² d_0)^c";
            all.push(Comparison::estimate(quantity, &of, fit.exponent, 0.25 * beta(&one.law)));
        }
    }
    for one in jamming {
        let of = format!("{} disks, d_th = {}", one.cell.disk_count, one.threshold);
        if let Some(fit) = one.at_jamming {
            all.push(Comparison::estimate("ν of ξ ∼ (φ_J − φ)^(−ν), φ_J = 0.842", &of, fit.exponent, 0.8));
        }
        if let Some(DivergenceOutcome::Found(fit)) = one.free {
            let ends = fit.critical.lower.zip(fit.critical.upper).map(|(low, high)| [low, high]);
            all.push(Comparison::interval("φ_J, fitted with ν", &of, fit.critical.best, ends, 0.842));
        }
    }
    all
}

/// An observable in words.
pub(crate) fn words(observable: &str) -> String {
    match observable.strip_prefix("correlation_angle_at_") {
        Some(threshold) => format!("θ*, G = {threshold}"),
        None => "G*".into(),
    }
}
