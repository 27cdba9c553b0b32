//! [`fit_slope`]: the slope of log S against log f.

use serde::{Deserialize, Serialize};

use crate::fit::angular::error::SpectrumFitError;
use crate::fit::angular::interval::Interval;
use crate::fit::angular::likelihood::Powers;
use crate::fit::angular::window::SpectrumWindowSettings;
use crate::fit::search::minimum;
use crate::observe::angular::RingSample;

/// Search range of the exponent: −2 to 6 in steps of 1/4.
const FIRST: f64 = -2.0;
const STEP: f64 = 0.25;
const STEPS: u32 = 32;

/// A power law fitted to the spectra of rings.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SlopeFit {
    /// The result for the spectrum.
    pub outcome: SlopeOutcome,
    /// s of S ∝ f^(−s) \[1\].
    pub exponent: Interval,
    /// Lowest and highest f fitted.
    pub window: [usize; 2],
    /// Number of powers fitted.
    pub power_count: usize,
    /// A of the first ring over its variance \[1\].
    pub amplitude: f64,
    /// ρ of the first ring over its variance \[1\]; 0 if it was not fitted.
    pub noise: f64,
    /// Σ (P/E − 1)² per degree of freedom: 1 if the spectrum is a power law, otherwise larger \[1\].
    pub dispersion: f64,
}

/// The result for a slope.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SlopeOutcome {
    /// The interval is closed and does not contain zero.
    Sloped,
    /// The interval contains zero: the spectrum may be white.
    Flat,
    /// The interval is open: the powers determine no slope between −2 and 6.
    Undetermined,
}

/// Fits S = A f^(−s) to the rings with a common s.
///
/// # Errors
/// No ring, a window with fewer than three powers or beyond n/2, values without variance.
///
/// # Example
/// ```
/// use jamscope::fit::angular::{SpectrumWindowSettings, fit_slope};
/// use jamscope::observe::angular::synthetic::{SyntheticSettings, gaussian_rings};
/// let ring = gaussian_rings(&SyntheticSettings::default(), 1, |f| f.powf(-1.5))?.remove(0).ring;
/// let fit = fit_slope(&[ring], &SpectrumWindowSettings::default())?;
/// let exponent = fit.exponent.estimate().expect("62 powers tell a slope");
/// assert!((exponent.value - 1.5).abs() < 2.0 * exponent.standard_error && exponent.standard_error < 0.15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fit_slope(rings: &[RingSample], settings: &SpectrumWindowSettings) -> Result<SlopeFit, SpectrumFitError> {
    Ok(slope_of(&Powers::of(rings, settings)?))
}

/// The slope of the powers of rings or shells.
pub(super) fn slope_of(powers: &Powers) -> SlopeFit {
    let at = |exponent: f64| powers.best(|logarithm| libm::exp(-exponent * logarithm));
    let grid: Vec<f64> = (0..=STEPS).map(|step| FIRST + STEP * f64::from(step)).collect();
    let found = minimum(&grid, powers.rise(), &|exponent| at(exponent).deviance);
    let exponent = Interval { best: found.at, lower: found.lower, upper: found.upper };
    let outcome = match (found.lower, found.upper) {
        _ if exponent.holds(0.0) => SlopeOutcome::Flat,
        (Some(_), Some(_)) => SlopeOutcome::Sloped,
        _ => SlopeOutcome::Undetermined,
    };
    let best = at(found.at);
    SlopeFit {
        outcome,
        exponent,
        window: powers.window(),
        power_count: powers.count(),
        amplitude: best.amplitude,
        noise: best.noise,
        dispersion: powers.dispersion(best, 1),
    }
}
