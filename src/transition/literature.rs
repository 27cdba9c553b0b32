//! [`Comparison`]: results next to published values.
//!
//! A published value agrees if the 95 % interval contains it, and differs otherwise. Three conditions come first;
//! otherwise the comparison is [uninformative](Verdict::Uninformative), with a reason:
//!
//! 1. There is an interval.
//! 2. Every cell behind the number has at least 8 samples.
//! 3. An interval that contains the published value is not too wide. For a pressure, its ends are at most a factor of
//!    10 apart. For any other number, it is no wider than the published value, or than 0.1 if that is larger.
//!
//! The interval of a p̂_c must also lie within the measured cells and within a factor of 10 of the best value.
//!
//! Source: the study.

use serde::Serialize;

use crate::fit::Estimate;
use crate::fit::ensemble::{BootstrapInterval, DivergenceOutcome};
use crate::transition::evidence::{CannotTell, LEAST_SAMPLES, Quantity, Sampled, unsound};
use crate::transition::lengths::JammingSeries;
use crate::transition::pressure::{
    Method, MethodEstimate, SCALE_FREE_ANGLE, SCALE_FREE_ANTICORRELATION, SCALE_FREE_SLOPE, TransitionPressure,
};
use crate::transition::scaling::{ExponentOutcome, PressureLaw, Scaling, beta};
use crate::transition::series::Series;

/// A result and the published value.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// The quantity, in words.
    pub quantity: String,
    /// The series or the law.
    pub of: String,
    /// The result \[unit of the quantity\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// Its 95 % interval \[unit of the quantity\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interval: Option<[f64; 2]>,
    /// The published value \[unit of the quantity\].
    pub published: f64,
    /// Smallest number of samples of a cell behind the result.
    pub sample_count: usize,
    /// Whether they agree.
    pub verdict: Verdict,
    /// Why the comparison is uninformative, if it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<CannotTell>,
}

/// Whether a result agrees with a published value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The interval contains the published value.
    Agrees,
    /// The interval does not contain it.
    Differs,
    /// The series gives a bound, and the published value is allowed by it: neither a contradiction nor a confirmation.
    Beyond,
    /// The series gives a bound that excludes the published value.
    Excluded,
    /// No conclusion: too few samples or cells, no interval, or one that is too wide.
    Uninformative,
}

impl Verdict {
    /// A description in words.
    pub fn name(self) -> &'static str {
        match self {
            Verdict::Agrees => "agrees",
            Verdict::Differs => "differs",
            Verdict::Beyond => "beyond",
            Verdict::Excluded => "excluded",
            Verdict::Uninformative => "cannot tell",
        }
    }
}

/// A quantity to compare, and its series or law.
struct Subject<'a> {
    quantity: &'a str,
    of: &'a str,
    kind: Quantity,
    published: f64,
}

impl Subject<'_> {
    fn comparison(&self, sample_count: usize, verdict: Result<Verdict, CannotTell>) -> Comparison {
        Comparison {
            quantity: self.quantity.into(),
            of: self.of.into(),
            value: None,
            interval: None,
            published: self.published,
            sample_count,
            verdict: verdict.unwrap_or(Verdict::Uninformative),
            reason: verdict.err(),
        }
    }

    fn verdict_by_interval(&self, interval: Option<[f64; 2]>, sample_count: usize) -> Result<Verdict, CannotTell> {
        let interval = interval.ok_or(CannotTell::NoInterval)?;
        if sample_count < LEAST_SAMPLES {
            return Err(CannotTell::FewSamples);
        }
        let holds = interval[0] <= self.published && self.published <= interval[1];
        match holds {
            true if self.kind.too_wide(interval, self.published) => Err(CannotTell::WideInterval),
            true => Ok(Verdict::Agrees),
            false => Ok(Verdict::Differs),
        }
    }

    fn interval(&self, value: f64, interval: Option<[f64; 2]>, sample_count: usize) -> Comparison {
        let verdict = self.verdict_by_interval(interval, sample_count);
        Comparison { value: Some(value), interval, ..self.comparison(sample_count, verdict) }
    }

    fn bootstrap(&self, found: &BootstrapInterval, sample_count: usize) -> Comparison {
        self.interval(found.best, found.interval, sample_count)
    }

    fn sampled(&self, found: &Sampled) -> Comparison {
        self.bootstrap(&found.found, found.sample_count)
    }

    fn estimate(&self, found: Estimate, sample_count: usize) -> Comparison {
        let ends = [-2.0, 2.0].map(|errors| found.value + errors * found.standard_error);
        self.interval(found.value, Some(ends), sample_count)
    }

    fn pressure(&self, estimate: &MethodEstimate) -> Comparison {
        let sample_count = estimate.sample_count;
        let bound = |verdict| self.comparison(sample_count, verdict);
        match estimate.pressure {
            TransitionPressure::Found(found) => {
                let verdict = match estimate.measured.and_then(|measured| unsound(&found, measured)) {
                    Some(reason) => Err(reason),
                    None => self.verdict_by_interval(found.interval, sample_count),
                };
                Comparison { value: Some(found.best), interval: found.interval, ..bound(verdict) }
            }
            TransitionPressure::Between(ends) => {
                // Pressures of packings are within one percent of their targets.
                let wide = [0.98 * ends[0], 1.02 * ends[1]];
                self.interval((ends[0] * ends[1]).sqrt(), Some(wide), sample_count)
            }
            TransitionPressure::Above(highest) => {
                bound(Ok(if self.published >= highest { Verdict::Beyond } else { Verdict::Excluded }))
            }
            TransitionPressure::Below(lowest) => {
                bound(Ok(if self.published <= lowest { Verdict::Beyond } else { Verdict::Excluded }))
            }
            TransitionPressure::Unordered => bound(Err(CannotTell::Unordered)),
            TransitionPressure::Uninformative { reason } => bound(Err(reason)),
        }
    }
}

/// All comparisons.
pub(super) fn comparisons(
    series: &[Series],
    scaling: &[Scaling],
    laws: &[PressureLaw],
    jamming: &[JammingSeries],
) -> Vec<Comparison> {
    // All published values are of disks.
    if series.iter().any(|one| !one.cell.is_published()) {
        return Vec::new();
    }
    // p̂_c is published for Hertzian disks and d_0 = 0.1.
    let published = series.iter().filter(|one| beta(&one.cell.law) == 3.0 && one.cell.increase == 0.1);
    let mut all: Vec<Comparison> = published.flat_map(of_series).collect();
    for one in scaling {
        let of = format!("{}, {}, {} curves", one.law.name(), one.relaxer.description(), one.curve_count);
        let beta = beta(&one.law);
        let exponents = [("N^a", one.size_exponent, 0.5 * beta), ("d_0^(−b)", one.inflation_exponent, 0.25 * beta)];
        for (factor, outcome, published) in exponents {
            let quantity = format!("exponent of {factor}, collapse of {}", words(one.observable, "θ"));
            if let Some(ExponentOutcome::Found(found)) = outcome {
                all.push(number(&quantity, &of, published).bootstrap(&found, one.sample_count));
            }
        }
    }
    for one in laws {
        if let Some(fit) = &one.fit {
            let (law, relaxer) = (one.law.name(), one.relaxer.description());
            let of = format!("{law}, {relaxer}, {} p_c by {}", one.points.len(), one.method.name());
            let subject = number("c of N^β p_c ∼ (N² d_0)^c", &of, 0.25 * beta(&one.law));
            all.push(subject.estimate(fit.exponent, one.sample_count));
        }
    }
    for one in jamming {
        let (cell, count) = (&one.cell, one.sample_count);
        let of = format!("{} disks, d_th = {}, {}", cell.disk_count, one.threshold, cell.relaxer.description());
        if let Some(fit) = one.at_jamming {
            all.push(number("ν of ξ ∼ (φ_J − φ)^(−ν), φ_J = 0.842", &of, 0.8).estimate(fit.exponent, count));
        }
        if let Some(DivergenceOutcome::Found(fit)) = one.free {
            let ends = fit.critical.lower.zip(fit.critical.upper).map(|(low, high)| [low, high]);
            all.push(number("φ_J, fitted with ν", &of, 0.842).interval(fit.critical.best, ends, count));
        }
    }
    all
}

/// A quantity that is not a pressure.
fn number<'a>(quantity: &'a str, of: &'a str, published: f64) -> Subject<'a> {
    Subject { quantity, of, kind: Quantity::Number, published }
}

/// A pressure.
fn pressure<'a>(quantity: &'a str, of: &'a str, published: f64) -> Subject<'a> {
    Subject { quantity, of, kind: Quantity::Pressure, published }
}

/// All comparisons of one series of Hertzian disks.
fn of_series(one: &Series) -> Vec<Comparison> {
    let mut all = Vec::new();
    let of = one.name();
    for estimate in &one.estimates {
        let published = match estimate.method {
            Method::Wavenumber | Method::PressureChange => 3e8,
            _ => 1e8,
        };
        let quantity = format!("p̂_c by {}", estimate.method.name());
        all.push(pressure(&quantity, &of, published).pressure(estimate));
    }
    let mut numbers = Vec::new();
    if let Some(at) = &one.at_published {
        numbers.extend([
            ("slope of S(f) at p̂ = 10⁸, least squares", at.slope, SCALE_FREE_SLOPE),
            ("slope of S(f) at p̂ = 10⁸, likelihood", at.likelihood_slope, SCALE_FREE_SLOPE),
            ("G* at p̂ = 10⁸", at.anticorrelation, SCALE_FREE_ANTICORRELATION),
            ("θ* at p̂ = 10⁸", at.angle, SCALE_FREE_ANGLE),
        ]);
    }
    if let Some(at) = &one.at_transition {
        numbers.extend([
            ("G* at p̂_c by the slope", at.anticorrelation, SCALE_FREE_ANTICORRELATION),
            ("θ* at p̂_c by the slope", at.angle, SCALE_FREE_ANGLE),
        ]);
    }
    for (quantity, found, published) in numbers {
        all.extend(found.map(|found| number(quantity, &of, published).sampled(&found)));
    }
    for (point, change) in one.points.iter().zip(&one.pressure_changes).filter(|(it, _)| it.reduced_pressure < 5e7) {
        if let Some(change) = change {
            let quantity = format!("Δp/p^(1/3) at p̂ = {:.0e}", point.reduced_pressure);
            all.push(number(&quantity, &of, -0.05).interval(change.mean, change.mean_interval, change.count));
        }
    }
    for lengths in &one.lengths {
        if let Some(product) = &lengths.scaled_isostatic {
            let quantity = format!("ℓ_iso ΔZ at p̂ = {:.0e}", lengths.point.reduced_pressure);
            all.push(number(&quantity, &of, 6.0).sampled(product));
        }
    }
    if let Some(matching) = &one.matching {
        let unit = libm::pow(one.mobile_count(), 1.5);
        let interval = matching.found.interval.map(|ends| ends.map(|end| end * unit));
        let subject = pressure("p̂ where ℓ_iso is 1/κ₁", &of, 1e8);
        all.push(subject.interval(matching.found.best * unit, interval, matching.sample_count));
    }
    if let Some(fit) = one.divergence.at_transition {
        let quantity = "μ of θ† ∼ (p̂_c − p̂)^(−μ), p̂_c by the slope";
        all.push(number(quantity, &of, 0.9).estimate(fit.exponent, one.divergence.sample_count));
    }
    all
}

/// The name of an observable in words; the angle is θ in a ring, γ in a shell.
pub(crate) fn words(observable: &str, angle: &str) -> String {
    match observable.strip_prefix("correlation_angle_at_") {
        Some(threshold) => format!("{angle}*, G = {threshold}"),
        None => "G*".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verdict(published: f64, interval: Option<[f64; 2]>, sample_count: usize) -> (Verdict, Option<CannotTell>) {
        let found = number("c", "a law", published).interval(0.5, interval, sample_count);
        assert_eq!((found.interval, found.sample_count), (interval, sample_count));
        (found.verdict, found.reason)
    }

    #[test]
    fn numbers_agree_or_differ_only_where_their_intervals_say_so() {
        assert_eq!(verdict(0.75, Some([0.6, 0.9]), 8), (Verdict::Agrees, None));
        assert_eq!(verdict(0.75, Some([0.4, 0.7]), 8), (Verdict::Differs, None));
        let cannot = |reason| (Verdict::Uninformative, Some(reason));
        assert_eq!(verdict(0.75, None, 400), cannot(CannotTell::NoInterval));
        // An interval from −0.78 to 1.13 must not agree with 3/4, and three samples per cell must not differ.
        assert_eq!(verdict(0.75, Some([-0.78, 1.13]), 400), cannot(CannotTell::WideInterval));
        assert_eq!(verdict(0.75, Some([0.5, 0.500_1]), 3), cannot(CannotTell::FewSamples));
        assert_eq!(verdict(0.75, Some([0.6, 0.9]), 7), cannot(CannotTell::FewSamples));
        // Wide, but without the published value.
        assert_eq!(verdict(0.75, Some([0.8, 4.0]), 8), (Verdict::Differs, None));
        assert_eq!(verdict(-0.05, Some([-0.1, -0.01]), 8), (Verdict::Agrees, None));
        assert_eq!(verdict(-0.05, Some([-0.1, 0.05]), 8), cannot(CannotTell::WideInterval));
    }

    fn of_pressure(found: TransitionPressure, sample_count: usize) -> (Verdict, Option<CannotTell>) {
        let measured = Some([1e6, 1e10]);
        let estimate = MethodEstimate { method: Method::Angle, pressure: found, measured, sample_count };
        let found = pressure("p̂_c", "a series", 1e8).pressure(&estimate);
        (found.verdict, found.reason)
    }

    #[test]
    fn pressures_are_compared_only_where_their_intervals_are_sound() {
        let found = |ends: [f64; 2]| {
            let interval = Some(ends);
            let best = (ends[0] * ends[1]).sqrt();
            let found =
                BootstrapInterval { best, standard_error: None, interval, resampling_count: 400, failed_count: 0 };
            of_pressure(TransitionPressure::Found(found), 20)
        };
        let cannot = |reason| (Verdict::Uninformative, Some(reason));
        assert_eq!(found([5e7, 4.9e8]), (Verdict::Agrees, None));
        assert_eq!(found([5e7, 5.1e8]), cannot(CannotTell::WideInterval));
        // Not too wide to differ, if each half is less than a decade.
        assert_eq!(found([2e6, 5e7]), (Verdict::Differs, None));
        assert_eq!(found([1.1e6, 2.0e8]), cannot(CannotTell::WideInterval));
        assert_eq!(found([2e8, 3e10]), cannot(CannotTell::BeyondCells));
        assert_eq!(of_pressure(TransitionPressure::Between([6e7, 5e8]), 20), (Verdict::Agrees, None));
        assert_eq!(of_pressure(TransitionPressure::Between([3e7, 4e8]), 20), cannot(CannotTell::WideInterval));
        assert_eq!(of_pressure(TransitionPressure::Above(5e7), 20), (Verdict::Beyond, None));
        assert_eq!(of_pressure(TransitionPressure::Above(5e8), 20), (Verdict::Excluded, None));
        assert_eq!(of_pressure(TransitionPressure::Unordered, 20), cannot(CannotTell::Unordered));
        let reason = CannotTell::OneSide;
        assert_eq!(of_pressure(TransitionPressure::Uninformative { reason }, 20), cannot(reason));
    }

    #[test]
    fn what_cannot_be_told_is_called_so() {
        assert_eq!(Verdict::Uninformative.name(), "cannot tell");
        assert_eq!(serde_json::to_string(&Verdict::Uninformative).expect("a word"), "\"uninformative\"");
    }
}
