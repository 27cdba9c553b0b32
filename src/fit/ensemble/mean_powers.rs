//! −2 ln L of the mean powers of an ensemble.
//!
//! ```text
//! P̄_f ~ gamma of mean E_f and shape n        −2 ln L = 2 n Σ_f (ln E_f + P̄_f/E_f)        E_f = A e_f
//! A = (1/F) Σ_f P̄_f/e_f        the best A
//! ```
//!
//! A power with leakage removed may be negative, and so may a mean of few powers. If such means have a large weight, no
//! E describes them, and ln A is unbounded below. A shape is therefore refused if they contribute more than a tenth of
//! Σ |P̄/e|.

use crate::fit::ensemble::error::EnsembleFitError;

/// Minimum number of powers in a window.
const LEAST_POWER_COUNT: usize = 3;

/// Largest negative share of Σ |P̄/e|.
const NEGATIVE_SHARE: f64 = 0.1;

/// Mean powers in a window.
pub(super) struct MeanPowers {
    pub sample_count: usize,
    /// Its lowest f.
    lowest: usize,
    pub powers: Vec<f64>,
    /// ln f.
    pub logarithms: Vec<f64>,
}

/// The best amplitude for a shape.
pub(super) struct Best {
    pub amplitude: f64,
    /// −2 ln L.
    pub deviance: f64,
}

impl MeanPowers {
    /// The mean powers of samples whose powers are at f = 1, 2, …
    pub fn of(samples: &[&[f64]], window: [usize; 2]) -> Result<Self, EnsembleFitError> {
        let expected = samples.first().ok_or(EnsembleFitError::NoSample)?.len();
        let [lowest, highest] = window;
        if lowest == 0 || highest > expected || highest < lowest.saturating_add(LEAST_POWER_COUNT - 1) {
            return Err(EnsembleFitError::WindowOutOfRange { lowest, highest, power_count: expected });
        }
        let mut powers = vec![0.0; highest - lowest + 1];
        for (sample, all) in samples.iter().enumerate() {
            if all.len() != expected {
                return Err(EnsembleFitError::SamplesDiffer { sample, power_count: all.len(), expected });
            }
            for (i, (sum, power)) in powers.iter_mut().zip(&all[lowest - 1..]).enumerate() {
                if !power.is_finite() {
                    return Err(EnsembleFitError::PowerNotFinite { sample, frequency: lowest + i });
                }
                *sum += power;
            }
        }
        powers.iter_mut().for_each(|power| *power /= samples.len() as f64);
        Ok(MeanPowers { sample_count: samples.len(), lowest, powers, logarithms: logarithms(window).collect() })
    }

    /// The first f whose mean is not positive.
    pub fn non_positive(&self) -> Option<usize> {
        self.powers.iter().position(|power| power.is_nan() || *power <= 0.0).map(|i| self.lowest + i)
    }

    /// A and −2 ln L for a shape, given as the logarithm of e_f at ln f. None if negative means have too much weight,
    /// or all powers vanish.
    pub fn best(&self, shape: impl Fn(f64) -> f64) -> Option<Best> {
        self.best_of(self.logarithms.iter().map(|&at| Factor::of(shape(at))))
    }

    /// [`best`](Self::best) for a shape of which a table is [made](tabulated).
    pub fn best_of(&self, factors: impl Iterator<Item = Factor>) -> Option<Best> {
        let (mut positive, mut negative, mut logarithm) = (0.0, 0.0, 0.0);
        for (power, factor) in self.powers.iter().zip(factors) {
            let ratio = power * factor.inverse;
            if ratio > 0.0 {
                positive += ratio
            } else {
                negative -= ratio
            }
            logarithm += factor.logarithm;
        }
        let sum = positive - negative;
        if !(sum > 0.0 && sum.is_finite()) || negative > NEGATIVE_SHARE * (positive + negative) {
            return None;
        }
        let count = self.powers.len() as f64;
        let amplitude = sum / count;
        let deviance = 2.0 * self.sample_count as f64 * (logarithm + count * (libm::log(amplitude) + 1.0));
        Some(Best { amplitude, deviance })
    }
}

/// A shape at one f.
#[derive(Debug, Clone, Copy)]
pub(super) struct Factor {
    /// 1/e_f.
    inverse: f64,
    /// ln e_f.
    logarithm: f64,
}

impl Factor {
    fn of(logarithm: f64) -> Self {
        Factor { inverse: libm::exp(-logarithm), logarithm }
    }
}

/// A shape, given as the logarithm of e_f at ln f, in a window: for all resamplings the same.
pub(super) fn tabulated(window: [usize; 2], shape: impl Fn(f64) -> f64) -> Vec<Factor> {
    logarithms(window).map(|at| Factor::of(shape(at))).collect()
}

/// ln f.
fn logarithms([lowest, highest]: [usize; 2]) -> impl Iterator<Item = f64> {
    (lowest..=highest).map(|f| libm::log(f as f64))
}
