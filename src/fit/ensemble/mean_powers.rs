//! −2 ln L of the mean powers of an ensemble.
//!
//! ```text
//! P̄_f ~ gamma of mean E_f and shape n        −2 ln L = 2 n Σ_f (ln E_f + P̄_f/E_f)        E_f = A e_f
//! A = (1/F) Σ_f P̄_f/e_f        at its best
//! ```
//!
//! A power with leakage removed may be negative, and so may a mean of few. Where such means weigh, no E describes them, and ln A
//! falls without bound: a shape is refused where they have more than a tenth of Σ |P̄/e|.

use crate::fit::ensemble::error::EnsembleFitError;

/// Powers a window needs.
const LEAST_POWER_COUNT: usize = 3;

/// The largest share of Σ |P̄/e| that is negative.
const NEGATIVE_SHARE: f64 = 0.1;

/// Mean powers in a window.
pub(super) struct MeanPowers {
    pub sample_count: usize,
    /// Of its lowest f.
    lowest: usize,
    pub powers: Vec<f64>,
    /// ln f.
    pub logarithms: Vec<f64>,
}

/// The amplitude that suits a shape best.
pub(super) struct Best {
    pub amplitude: f64,
    /// −2 ln L.
    pub deviance: f64,
}

impl MeanPowers {
    /// Of samples whose powers are those at f = 1, 2, …
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
        let logarithms = (lowest..=highest).map(|f| libm::log(f as f64)).collect();
        Ok(MeanPowers { sample_count: samples.len(), lowest, powers, logarithms })
    }

    /// The first f whose mean is not positive.
    pub fn non_positive(&self) -> Option<usize> {
        self.powers.iter().position(|power| power.is_nan() || *power <= 0.0).map(|i| self.lowest + i)
    }

    /// A and −2 ln L of a shape, the logarithm of e_f at ln f; none where negative means weigh too much, or there is no power.
    pub fn best(&self, shape: impl Fn(f64) -> f64) -> Option<Best> {
        let (mut positive, mut negative, mut logarithm) = (0.0, 0.0, 0.0);
        for (power, &at) in self.powers.iter().zip(&self.logarithms) {
            let of_shape = shape(at);
            let ratio = power * libm::exp(-of_shape);
            if ratio > 0.0 {
                positive += ratio
            } else {
                negative -= ratio
            }
            logarithm += of_shape;
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
