//! [`half_crossing`]: where the probability of an event is one half, by logistic regression.

use serde::{Deserialize, Serialize};

use crate::fit::Estimate;
use crate::fit::ensemble::bootstrap;
use crate::fit::ensemble::bootstrap::BootstrapInterval;
use crate::fit::ensemble::error::EnsembleFitError;

/// Limit of Newton steps. ln L is concave, and a few steps are enough.
const STEP_LIMIT: usize = 100;

/// Gain over |ln L| below which a Newton step is the last: ln L is quadratic there, and the next step would gain
/// nothing.
const GAIN_LIMIT: f64 = 1e-15;

/// Rise of −2 ln L at two standard errors of one parameter.
const RISE: f64 = 4.0;

/// Frequency of an event at one x.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HitCount {
    /// The parameter, for example ln p̂.
    pub x: f64,
    /// Number of samples with the event; expected numbers need not be integers.
    pub hits: f64,
    /// Number of samples.
    pub count: f64,
}

/// Whether the event becomes rarer or more frequent as x grows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Trend {
    /// P(hit) = 1/(1 + exp((x − x_c)/w)).
    Falling,
    /// P(hit) = 1/(1 + exp(−(x − x_c)/w)).
    Rising,
}

/// The result for x_c.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HalfCrossing {
    /// There is a crossing.
    Found {
        /// x_c, with its error from the Fisher information \[x\].
        crossing: Estimate,
        /// w, positive: P goes from 0.73 to 0.27 within 2w \[x\].
        width: f64,
        /// Rise of −2 ln L above the best for a P that does not depend on x.
        flat_rise: f64,
        /// Whether x_c lies outside all x.
        extrapolated: bool,
    },
    /// All hits are on one side, all others on the other side: any small w fits.
    Separated {
        /// The last x before and the first x after the crossing; equal if one x has both \[x\].
        between: [f64; 2],
        /// Their midpoint, an arbitrary choice \[x\].
        middle: f64,
    },
    /// Every sample is a hit.
    AllHit,
    /// No sample is a hit.
    NoneHit,
    /// A P that does not depend on x is within the error, a rise of −2 ln L of at most 4.
    Flat {
        /// That rise.
        flat_rise: f64,
    },
    /// The trend is the opposite one.
    WrongSign {
        /// Rise of −2 ln L above the best for a P that does not depend on x; infinite if the sides are separated.
        flat_rise: f64,
    },
    /// The Newton steps did not converge.
    NotConverged {
        /// Number of steps.
        step_count: usize,
    },
}

/// Maximum likelihood estimate of x_c and w.
///
/// ```text
/// ln L = Σ_g h_g ln P(x_g) + (n_g − h_g) ln(1 − P(x_g))
/// ```
///
/// ln L is concave. Newton steps, halved until they increase it, reach its only maximum, which exists unless the sides
/// are separated. Groups without samples have no effect.
///
/// # Errors
/// No sample; an x that is not finite, hits that are negative or more than the count.
///
/// # Source
/// Cox (1958), J. R. Stat. Soc. B 20, 215; existence: Albert, Anderson (1984), Biometrika 71, 1.
///
/// # Cost
/// Groups × Newton steps.
///
/// # Example
/// ```
/// use jamscope::fit::ensemble::{HalfCrossing, HitCount, Trend, half_crossing};
/// let groups = [(1.0, 18.0), (2.0, 10.0), (3.0, 2.0)].map(|(x, hits)| HitCount { x, hits, count: 20.0 });
/// let HalfCrossing::Found { crossing, width, .. } = half_crossing(&groups, Trend::Falling)? else { panic!() };
/// // 18 : 2 and 2 : 18 are ln 9 on either side.
/// assert!((crossing.value - 2.0).abs() < 1e-9 && (width * 9f64.ln() - 1.0).abs() < 1e-9);
/// # Ok::<(), jamscope::fit::ensemble::EnsembleFitError>(())
/// ```
pub fn half_crossing(groups: &[HitCount], trend: Trend) -> Result<HalfCrossing, EnsembleFitError> {
    for (group, &HitCount { x, hits, count }) in groups.iter().enumerate() {
        if !(x.is_finite() && count.is_finite() && (0.0..=count).contains(&hits)) {
            return Err(EnsembleFitError::GroupUnusable { group, x, hits, count });
        }
    }
    let seen: Vec<HitCount> = groups.iter().copied().filter(|group| group.count > 0.0).collect();
    if seen.is_empty() {
        return Err(EnsembleFitError::NoSample);
    }
    let span = |keep: fn(&HitCount) -> bool| {
        let kept = seen.iter().filter(|group| keep(group)).map(|group| group.x);
        kept.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
    };
    let (hits, misses, all) = (span(|g| g.hits > 0.0), span(|g| g.hits < g.count), span(|_| true));
    if misses[0] > misses[1] {
        return Ok(HalfCrossing::AllHit);
    }
    if hits[0] > hits[1] {
        return Ok(HalfCrossing::NoneHit);
    }
    if all[0] == all[1] {
        return Ok(HalfCrossing::Flat { flat_rise: 0.0 });
    }
    let (before, after) = match trend {
        Trend::Falling => (hits, misses),
        Trend::Rising => (misses, hits),
    };
    if before[1] <= after[0] {
        let between = [before[1], after[0]];
        return Ok(HalfCrossing::Separated { between, middle: between[0] + 0.5 * (between[1] - between[0]) });
    }
    if after[1] <= before[0] {
        return Ok(HalfCrossing::WrongSign { flat_rise: f64::INFINITY });
    }
    Ok(maximum(&seen, all, trend))
}

/// The maximum of ln L over α and β, with ln P/(1 − P) = α + β z, z = (x − middle)/(half the range).
fn maximum(groups: &[HitCount], [low, high]: [f64; 2], trend: Trend) -> HalfCrossing {
    let (middle, scale) = (low + 0.5 * (high - low), 0.5 * (high - low));
    let at = |group: &HitCount| (group.x - middle) / scale;
    let log_likelihood = |alpha: f64, beta: f64| -> f64 {
        let of = |g: &HitCount| {
            let logit = alpha + beta * at(g);
            // ln P = −ln(1 + e^(−logit)), ln(1 − P) = −ln(1 + e^logit), without overflow.
            let ln_1p_exp = |t: f64| t.max(0.0) + libm::log1p(libm::exp(-t.abs()));
            -g.hits * ln_1p_exp(-logit) - (g.count - g.hits) * ln_1p_exp(logit)
        };
        groups.iter().map(of).sum()
    };
    let (hits, count) = groups.iter().fold((0.0, 0.0), |(h, n), g| (h + g.hits, n + g.count));
    let (mut alpha, mut beta) = (libm::log(hits / (count - hits)), 0.0);
    let flat = log_likelihood(alpha, beta);
    let mut best = flat;
    for _ in 0..STEP_LIMIT {
        let (mut gradient, mut info) = ([0.0; 2], [0.0; 3]);
        for group in groups {
            let z = at(group);
            let probability = 1.0 / (1.0 + libm::exp(-alpha - beta * z));
            let (excess, weight) =
                (group.hits - group.count * probability, group.count * probability * (1.0 - probability));
            gradient = [gradient[0] + excess, gradient[1] + excess * z];
            info = [info[0] + weight, info[1] + weight * z, info[2] + weight * z * z];
        }
        let determinant = info[0] * info[2] - info[1] * info[1];
        let step = [
            (info[2] * gradient[0] - info[1] * gradient[1]) / determinant,
            (info[0] * gradient[1] - info[1] * gradient[0]) / determinant,
        ];
        // The gain of the step for a quadratic ln L.
        let gain = 0.5 * (step[0] * gradient[0] + step[1] * gradient[1]);
        if gain.is_nan() {
            break;
        }
        if gain <= GAIN_LIMIT * best.abs() {
            (alpha, beta) = (alpha + step[0], beta + step[1]);
            let flat_rise = 2.0 * (best - flat);
            let falls = beta < 0.0;
            return match trend {
                _ if flat_rise <= RISE => HalfCrossing::Flat { flat_rise },
                Trend::Falling if !falls => HalfCrossing::WrongSign { flat_rise },
                Trend::Rising if falls => HalfCrossing::WrongSign { flat_rise },
                _ => {
                    let z = -alpha / beta;
                    // Var z = (∂z/∂α, ∂z/∂β) I⁻¹ (…), ∂z/∂α = −1/β, ∂z/∂β = −z/β.
                    let variance = (info[2] - 2.0 * z * info[1] + z * z * info[0]) / (beta * beta * determinant);
                    let value = middle + scale * z;
                    HalfCrossing::Found {
                        crossing: Estimate { value, standard_error: scale * variance.sqrt() },
                        width: scale / beta.abs(),
                        flat_rise,
                        extrapolated: value < low || value > high,
                    }
                }
            };
        }
        let mut share = 1.0;
        let climbed = loop {
            let next = log_likelihood(alpha + share * step[0], beta + share * step[1]);
            // The rounding of ln L itself does not count as a decrease.
            if next >= best - GAIN_LIMIT * best.abs() {
                break Some(next);
            }
            share *= 0.5;
            if share < 1e-9 {
                break None;
            }
        };
        let Some(next) = climbed else { break };
        (alpha, beta, best) = (alpha + share * step[0], beta + share * step[1], next);
    }
    HalfCrossing::NotConverged { step_count: STEP_LIMIT }
}

/// x_c over resamplings of the samples within their groups. None if the original data have neither a crossing nor two
/// separated sides.
///
/// A separated resampling counts with its midpoint. One that is flat, has the wrong sign or has only one outcome counts
/// as failed.
///
/// # Errors
/// See [`half_crossing`].
///
/// # Cost
/// One [`half_crossing`] per resampling.
pub fn half_crossing_interval(
    groups: &[(f64, Vec<bool>)],
    trend: Trend,
    resamplings: usize,
) -> Result<Option<BootstrapInterval>, EnsembleFitError> {
    let sizes: Vec<usize> = groups.iter().map(|(_, hits)| hits.len()).collect();
    let counts = |chosen: &[Vec<usize>]| -> Vec<HitCount> {
        let of = |((x, hits), indices): (&(f64, Vec<bool>), &Vec<usize>)| HitCount {
            x: *x,
            hits: indices.iter().filter(|&&i| hits[i]).count() as f64,
            count: indices.len() as f64,
        };
        groups.iter().zip(chosen).map(of).collect()
    };
    let every: Vec<Vec<usize>> = sizes.iter().map(|&size| (0..size).collect()).collect();
    half_crossing(&counts(&every), trend)?;
    Ok(bootstrap(&sizes, resamplings, |chosen| match half_crossing(&counts(chosen), trend) {
        Ok(HalfCrossing::Found { crossing, .. }) => Some(crossing.value),
        Ok(HalfCrossing::Separated { middle, .. }) => Some(middle),
        _ => None,
    }))
}
