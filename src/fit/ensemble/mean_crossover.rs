//! [`crossover_of_mean`]: the crossover frequency f† of a mean power spectrum.

use serde::{Deserialize, Serialize};

use crate::fit::angular::{Crossover, CrossoverMinimum, CrossoverOutcome, CrossoverSettings, Shape, octaves};
use crate::fit::ensemble::bootstrap;
use crate::fit::ensemble::bootstrap::BootstrapInterval;
use crate::fit::ensemble::error::EnsembleFitError;
use crate::fit::ensemble::mean_powers::{Best, Factor, MeanPowers, tabulated};
use crate::fit::search::GridMinimum;

/// Rise of −2 ln L at two standard errors of one parameter.
const RISE: f64 = 4.0;

/// Settings of the fit of a mean crossover.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MeanCrossoverSettings {
    /// s \[1\].
    pub exponent: f64,
    /// k of θ† = k/f† \[rad\].
    pub angle_factor: f64,
}

impl Default for MeanCrossoverSettings {
    /// s = 1.5, and k of [`CrossoverSettings`].
    fn default() -> Self {
        MeanCrossoverSettings { exponent: 1.5, angle_factor: CrossoverSettings::default().angle_factor }
    }
}

impl MeanCrossoverSettings {
    fn check(&self) -> Result<(), EnsembleFitError> {
        for (setting, value) in [("exponent", self.exponent), ("angle_factor", self.angle_factor)] {
            if !(value > 0.0 && value <= 100.0) {
                return Err(EnsembleFitError::SettingOutOfRange { setting, value });
            }
        }
        Ok(())
    }
}

/// A Lorentzian fitted to a mean spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MeanCrossover {
    /// The fit succeeded.
    Fitted {
        /// The result for the spectrum, as for single rings; at the ends of intervals −2 ln L has risen by 4.
        outcome: CrossoverOutcome,
        /// The best f† for any outcome: 0 for a power law, infinite for a flat spectrum \[1\].
        crossover: f64,
        /// A \[power\].
        amplitude: f64,
        /// Rise of −2 ln L of f^(−s), f† = 0, above the best.
        scale_free_rise: f64,
        /// Rise of −2 ln L of a flat spectrum above the best.
        white_rise: f64,
    },
    /// In one of the limits, negative means contribute more than a tenth of Σ |P̄/E|.
    NegativePowers,
}

impl MeanCrossover {
    /// The best f†, if a crossover was found.
    pub fn found(&self) -> Option<f64> {
        match self {
            MeanCrossover::Fitted { outcome: CrossoverOutcome::Found { crossover, .. }, .. } => Some(crossover.best),
            _ => None,
        }
    }
}

/// Fits P̄_f = A/(1 + (f/f†)^s) in the window f_1 ≤ f ≤ f_2 to the mean of the samples, whose powers are at f = 1, 2, …
///
/// ```text
/// −2 ln L = 2 n Σ_f (ln E_f + P̄_f/E_f)        E_f = A/(1 + (f/f†)^s),  A in closed form        θ† = k/f†
/// ```
///
/// The amplitude of a power law, f† = 0, is that of f^(−s). The range of f† is 1/16 to 16 times the highest f. For
/// intervals and for powers over variances see [`slope_of_mean`](crate::fit::ensemble::slope_of_mean).
///
/// # Errors
/// See [`slope_of_mean`](crate::fit::ensemble::slope_of_mean); s or k not in (0, 100].
///
/// # Cost
/// Samples × powers, then powers × evaluations of a one-dimensional search.
///
/// # Example
/// ```
/// use jamscope::fit::ensemble::{MeanCrossoverSettings, crossover_of_mean};
/// let powers: Vec<f64> = (1..=30).map(|f| 0.2 / (1.0 + (f64::from(f) / 5.0).powf(1.5))).collect();
/// let samples = vec![powers.as_slice(); 50];
/// let fit = crossover_of_mean(&samples, [1, 30], &MeanCrossoverSettings::default())?;
/// assert!((fit.found().expect("a crossover") - 5.0).abs() < 1e-5);
/// # Ok::<(), jamscope::fit::ensemble::EnsembleFitError>(())
/// ```
pub fn crossover_of_mean(
    samples: &[&[f64]],
    window: [usize; 2],
    settings: &MeanCrossoverSettings,
) -> Result<MeanCrossover, EnsembleFitError> {
    settings.check()?;
    let powers = MeanPowers::of(samples, window)?;
    let fitted = Lorentzians::of(window, settings.exponent).fit(&powers, |found, best| {
        let crossover = found.best();
        let amplitude = best(crossover).map_or(f64::NAN, |best| best.amplitude);
        let (scale_free_rise, white_rise) = (found.scale_free_rise, found.white_rise);
        let (outcome, crossover) = (found.outcome(settings.angle_factor), frequency(crossover));
        MeanCrossover::Fitted { outcome, crossover, amplitude, scale_free_rise, white_rise }
    });
    Ok(fitted.unwrap_or(MeanCrossover::NegativePowers))
}

fn frequency(crossover: Crossover) -> f64 {
    match crossover {
        Crossover::Zero => 0.0,
        Crossover::Octave(octave) => libm::exp2(octave),
        Crossover::Infinite => f64::INFINITY,
    }
}

/// Lorentzians of one exponent in a window.
struct Lorentzians {
    exponent: f64,
    octaves: Vec<f64>,
    factors: Vec<Vec<Factor>>,
    /// f† = 0 and infinity.
    limits: [Vec<Factor>; 2],
}

impl Lorentzians {
    fn of(window: [usize; 2], exponent: f64) -> Self {
        let table = |crossover: Crossover| tabulated(window, |logarithm| log_shape(crossover, exponent, logarithm));
        let octaves = octaves(window[1]);
        let factors = octaves.iter().map(|&octave| table(Crossover::Octave(octave))).collect();
        let limits = [Crossover::Zero, Crossover::Infinite].map(table);
        Lorentzians { exponent, octaves, factors, limits }
    }

    /// Passes the minimum of −2 ln L, and the best amplitude for any f†, to `use_minimum`. None if negative powers have
    /// too much weight in one of the limits.
    fn fit<T>(
        &self,
        powers: &MeanPowers,
        use_minimum: impl FnOnce(CrossoverMinimum<'_>, &dyn Fn(Crossover) -> Option<Best>) -> T,
    ) -> Option<T> {
        // 1/E is a sum of those of the limits, so if negative powers are acceptable in both limits, they are between.
        let [scale_free, white] = self.limits.each_ref().map(|factors| powers.best_of(factors.iter().copied()));
        let limits = [scale_free?.deviance, white?.deviance];
        let deviance = |best: Option<Best>| best.map_or(f64::INFINITY, |best| best.deviance);
        let values: Vec<f64> =
            self.factors.iter().map(|factors| deviance(powers.best_of(factors.iter().copied()))).collect();
        let best = |crossover: Crossover| powers.best(|logarithm| log_shape(crossover, self.exponent, logarithm));
        let between = |octave: f64| deviance(best(Crossover::Octave(octave)));
        let inside = GridMinimum::of(&self.octaves, &values, &between);
        Some(use_minimum(CrossoverMinimum::of(inside, limits, RISE), &best))
    }
}

fn log_shape(crossover: Crossover, exponent: f64, logarithm: f64) -> f64 {
    libm::log(Shape { crossover, exponent }.at(logarithm))
}

/// f† over resamplings of the samples. None if the best f† of the original samples is infinite or does not exist.
///
/// A resampling counts with its best f†, 0 for a power law, and as failed if it is flat. So the interval of a spectrum
/// close to a power law extends to 0. For θ† divide k by it and exchange the ends.
///
/// # Errors
/// See [`crossover_of_mean`].
///
/// # Cost
/// Per resampling samples × powers, then powers × evaluations of a one-dimensional search.
pub fn crossover_interval(
    samples: &[&[f64]],
    window: [usize; 2],
    settings: &MeanCrossoverSettings,
    resamplings: usize,
) -> Result<Option<BootstrapInterval>, EnsembleFitError> {
    settings.check()?;
    MeanPowers::of(samples, window)?;
    let lorentzians = Lorentzians::of(window, settings.exponent);
    Ok(bootstrap(&[samples.len()], resamplings, |groups| {
        let chosen: Vec<&[f64]> = groups[0].iter().map(|&i| samples[i]).collect();
        let powers = MeanPowers::of(&chosen, window).ok()?;
        lorentzians.fit(&powers, |found, _| frequency(found.best()))
    }))
}
