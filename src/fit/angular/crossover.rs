//! [`fit_crossover`]: f† of the generalised Lorentzian, or the result that there is none.

use serde::{Deserialize, Serialize};

use crate::fit::angular::error::SpectrumFitError;
use crate::fit::angular::interval::Interval;
use crate::fit::angular::likelihood::Powers;
use crate::fit::angular::window::SpectrumWindowSettings;
use crate::fit::search::{GridMinimum, golden};
use crate::observe::angular::RingSample;

/// Range of f†: from 1/16 to 16 times the highest f, in steps of 2^(1/4).
const OCTAVES_BEYOND: f64 = 4.0;
const STEPS_PER_OCTAVE: f64 = 4.0;

/// Search range of a free exponent.
const EXPONENTS: [f64; 2] = [0.5, 6.0];

/// Settings of the fit of a crossover.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CrossoverSettings {
    /// The powers used.
    pub window: SpectrumWindowSettings,
    /// s.
    pub exponent: ExponentChoice,
    /// k of θ† = k/f† \[rad\].
    pub angle_factor: f64,
}

impl Default for CrossoverSettings {
    /// s = 1.5; k = 1.681334, for which θ† is the angle of G = 0.1 at large f† (the study has 0.45, the value for
    /// another threshold).
    fn default() -> Self {
        CrossoverSettings {
            window: SpectrumWindowSettings::default(),
            exponent: ExponentChoice::Fixed(1.5),
            angle_factor: 1.681_333_697_987_038,
        }
    }
}

impl CrossoverSettings {
    /// Checks the settings, independently of the rings.
    pub(crate) fn check(&self) -> Result<(), SpectrumFitError> {
        self.window.check()?;
        self.exponent.check(self.angle_factor)
    }
}

/// The exponent of the Lorentzian.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ExponentChoice {
    /// This exponent \[1\].
    Fixed(f64),
    /// The best exponent from 0.5 to 6.
    Free,
}

impl ExponentChoice {
    /// Checks the exponent, and the factor of the angle.
    pub(super) fn check(self, angle_factor: f64) -> Result<(), SpectrumFitError> {
        if !(angle_factor > 0.0 && angle_factor.is_finite()) {
            return Err(SpectrumFitError::SettingOutOfRange { setting: "angle_factor", value: angle_factor });
        }
        match self {
            ExponentChoice::Fixed(value) if !(value > 0.0 && value <= 100.0) => {
                Err(SpectrumFitError::SettingOutOfRange { setting: "exponent", value })
            }
            _ => Ok(()),
        }
    }
}

/// A Lorentzian fitted to the spectra of rings.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CrossoverFit {
    /// The result for the spectrum.
    pub outcome: CrossoverOutcome,
    /// s, fixed or fitted \[1\].
    pub exponent: f64,
    /// Lowest and highest f fitted.
    pub window: [usize; 2],
    /// Number of powers fitted.
    pub power_count: usize,
    /// Rise of −2 ln L of f^(−s), f† = 0, above the best. Above [`rise`](Self::rise) this limit is rejected.
    pub scale_free_rise: f64,
    /// Rise of −2 ln L of a flat spectrum above the best.
    pub white_rise: f64,
    /// The rise of −2 ln L that defines the interval.
    pub rise: f64,
    /// ρ of the first ring over its variance \[1\]; 0 if it was not fitted.
    pub noise: f64,
    /// Σ (P/E − 1)² per degree of freedom: 1 if the model is correct, otherwise larger \[1\].
    pub dispersion: f64,
}

/// The result for f†.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CrossoverOutcome {
    /// There is a crossover.
    Found {
        /// f† \[1\].
        crossover: Interval,
        /// θ† = k/f† \[rad\].
        angle: Interval,
    },
    /// A power law fits as well: f† may be 0, and θ† is unbounded.
    ScaleFree {
        /// Upper end of the interval of f† \[1\].
        largest: f64,
        /// k over that end \[rad\].
        smallest_angle: f64,
    },
    /// A flat spectrum fits as well: f† is unbounded.
    White {
        /// Lower end of the interval of f† \[1\].
        smallest: f64,
        /// k over that end \[rad\].
        largest_angle: f64,
    },
    /// Both a power law and a flat spectrum fit as well.
    Undetermined,
}

impl CrossoverOutcome {
    /// Whether a crossover is consistent with the result; 0 means scale-free, infinity white.
    pub fn holds(&self, crossover: f64) -> bool {
        match self {
            CrossoverOutcome::Found { crossover: found, .. } => found.holds(crossover),
            CrossoverOutcome::ScaleFree { largest, .. } => crossover <= *largest,
            CrossoverOutcome::White { smallest, .. } => crossover >= *smallest,
            CrossoverOutcome::Undetermined => true,
        }
    }
}

/// Fits S = A/(1 + (f/f†)^s) to the rings with a common f†, and a common s if it is free.
///
/// # Errors
/// See [`fit_slope`](crate::fit::angular::fit_slope); a fixed exponent or k that is not positive and finite.
///
/// # Example
/// ```
/// use jamscope::fit::angular::{CrossoverOutcome, CrossoverSettings, fit_crossover};
/// use jamscope::observe::angular::synthetic::{SyntheticSettings, gaussian_rings};
/// let settings = SyntheticSettings { disk_count: 4000, ..SyntheticSettings::default() };
/// let ring = gaussian_rings(&settings, 1, |f| 1.0 / (1.0 + (f / 20.0).powf(1.5)))?.remove(0).ring;
/// let fit = fit_crossover(&[ring], &CrossoverSettings::default())?;
/// let CrossoverOutcome::Found { crossover, angle } = fit.outcome else { panic!("{fit:?}") };
/// assert!(crossover.holds(20.0) && angle.holds(1.681333697987038 / 20.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fit_crossover(rings: &[RingSample], settings: &CrossoverSettings) -> Result<CrossoverFit, SpectrumFitError> {
    settings.check()?;
    let powers = Powers::of(rings, &settings.window)?;
    Ok(crossover_of(&powers, settings.exponent, settings.angle_factor))
}

/// The crossover of the powers of rings or shells; θ† = `angle_factor`/f†.
pub(super) fn crossover_of(powers: &Powers, exponent: ExponentChoice, angle_factor: f64) -> CrossoverFit {
    let [_, highest] = powers.window();
    let deviance = |shape: Shape| powers.best(|logarithm| shape.at(logarithm)).deviance;
    // The best exponent at a given crossover, and −2 ln L there.
    let profile = |crossover: Crossover| match exponent {
        ExponentChoice::Fixed(exponent) => (exponent, deviance(Shape { crossover, exponent })),
        ExponentChoice::Free => {
            let at = |exponent: f64| deviance(Shape { crossover, exponent });
            let best = golden(EXPONENTS[0], EXPONENTS[1], 1e-5, &at);
            (best, at(best))
        }
    };
    let at = |crossover: Crossover| profile(crossover).1;
    let grid = octaves(highest);
    let values: Vec<f64> = grid.iter().map(|&octave| at(Crossover::Octave(octave))).collect();
    let between = |octave: f64| at(Crossover::Octave(octave));
    let inside = GridMinimum::of(&grid, &values, &between);
    let found = CrossoverMinimum::of(inside, [at(Crossover::Zero), at(Crossover::Infinite)], powers.rise());
    let crossover = found.best();
    let (fitted, _) = profile(crossover);
    let best = powers.best(|logarithm| Shape { crossover, exponent: fitted }.at(logarithm));
    let parameter_count = if exponent == ExponentChoice::Free { 2 } else { 1 };
    CrossoverFit {
        outcome: found.outcome(angle_factor),
        exponent: fitted,
        window: powers.window(),
        power_count: powers.count(),
        scale_free_rise: found.scale_free_rise,
        white_rise: found.white_rise,
        rise: powers.rise(),
        noise: best.noise,
        dispersion: powers.dispersion(best, parameter_count),
    }
}

/// The logarithms of f† to base 2 at which −2 ln L is computed first, ascending.
pub(in crate::fit) fn octaves(highest: usize) -> Vec<f64> {
    let octaves = libm::log2(highest as f64) + 2.0 * OCTAVES_BEYOND;
    let steps = (octaves * STEPS_PER_OCTAVE).ceil() as usize;
    (0..=steps).map(|i| i as f64 / STEPS_PER_OCTAVE - OCTAVES_BEYOND).collect()
}

/// The minimum of −2 ln L for f† from 0 to infinity.
pub(in crate::fit) struct CrossoverMinimum<'a> {
    /// The best f† between.
    inside: GridMinimum<'a>,
    /// Rise of −2 ln L that defines the interval, above the best f† of all and above the best between.
    rise: f64,
    rise_inside: f64,
    pub scale_free_rise: f64,
    pub white_rise: f64,
}

impl<'a> CrossoverMinimum<'a> {
    /// From the minimum between and −2 ln L of both limits, f† = 0 and infinity.
    pub fn of(inside: GridMinimum<'a>, [scale_free, white]: [f64; 2], rise: f64) -> Self {
        let lowest = inside.value.min(scale_free).min(white);
        // The interval is about the limit that fits better than any crossover between.
        let rise_inside = if lowest < inside.value { rise + lowest - inside.value } else { rise };
        let (scale_free_rise, white_rise) = (scale_free - lowest, white - lowest);
        CrossoverMinimum { inside, rise, rise_inside, scale_free_rise, white_rise }
    }

    /// The result for the spectrum; θ† = `factor`/f†.
    pub fn outcome(&self, factor: f64) -> CrossoverOutcome {
        let ends = self.inside.ends(self.rise_inside).map(|end| end.map(libm::exp2));
        // A sixteenth of f = 1 is equivalent to 0, sixteen times the highest f to infinity.
        let down_to_zero = self.scale_free_rise <= self.rise || ends[0].is_none();
        let up_to_infinity = self.white_rise <= self.rise || ends[1].is_none();
        match (down_to_zero, up_to_infinity, ends) {
            (true, false, [_, Some(largest)]) => {
                CrossoverOutcome::ScaleFree { largest, smallest_angle: factor / largest }
            }
            (false, true, [Some(smallest), _]) => {
                CrossoverOutcome::White { smallest, largest_angle: factor / smallest }
            }
            (false, false, [Some(lower), Some(upper)]) => {
                let best = libm::exp2(self.inside.at);
                CrossoverOutcome::Found {
                    crossover: Interval { best, lower: Some(lower), upper: Some(upper) },
                    angle: Interval { best: factor / best, lower: Some(factor / upper), upper: Some(factor / lower) },
                }
            }
            _ => CrossoverOutcome::Undetermined,
        }
    }

    /// The best f†: a limit if it fits best and the spectrum is like it, otherwise that between.
    pub fn best(&self) -> Crossover {
        // The outcome costs as much as the minimum: it is computed only where it decides.
        if self.scale_free_rise == 0.0 || self.white_rise == 0.0 {
            match self.outcome(1.0) {
                CrossoverOutcome::ScaleFree { .. } if self.scale_free_rise == 0.0 => return Crossover::Zero,
                CrossoverOutcome::White { .. } if self.white_rise == 0.0 => return Crossover::Infinite,
                _ => {}
            }
        }
        Crossover::Octave(self.inside.at)
    }
}

/// f†, including its limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::fit) enum Crossover {
    Zero,
    /// Its logarithm to base 2.
    Octave(f64),
    Infinite,
}

/// A spectrum up to its amplitude.
#[derive(Debug, Clone, Copy)]
pub(in crate::fit) struct Shape {
    pub crossover: Crossover,
    pub exponent: f64,
}

impl Shape {
    /// S at a frequency, given by its logarithm.
    pub fn at(self, logarithm: f64) -> f64 {
        match self.crossover {
            Crossover::Zero => libm::exp(-self.exponent * logarithm),
            Crossover::Octave(octave) => {
                1.0 / (1.0 + libm::exp(self.exponent * (logarithm - octave * std::f64::consts::LN_2)))
            }
            Crossover::Infinite => 1.0,
        }
    }
}
