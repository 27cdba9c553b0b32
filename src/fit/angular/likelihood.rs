//! Whittle's likelihood of the powers of rings, amplitudes and noise at their best.

use crate::fit::angular::{
    HighestFrequency, LEAST_POWER_COUNT, SingleDiskNoise, SpectrumFitError, SpectrumWindowSettings,
};
use crate::fit::search::golden;
use crate::observe::angular::{
    FrequencyLimit, Leakage, PowerSpectrum, RingSample, Source, SpectralWindow, SpectrumEstimator, SpectrumSettings,
    Weights,
};

/// Sources of the window over the number of disks; beyond it leakage is white within the scatter of a window.
const SOURCES_PER_DISK: usize = 2;

/// Rise of −2 ln L over two standard errors.
const RISE: f64 = 4.0;

/// Bartlett's correction times the number of powers: measured, 0.15 to 0.5 from 3 to 62 powers.
const SMALL_COUNT: f64 = 0.4;

/// Largest ρ N_f over Σ K S, in decades either way.
const NOISE_DECADES: f64 = 8.0;

/// The powers of several rings.
pub(super) struct Powers {
    rings: Vec<Ring>,
    noise: SingleDiskNoise,
    highest: usize,
}

struct Ring {
    lowest: usize,
    power: Vec<f64>,
    window: SpectralWindow,
    sources: Vec<Source>,
    /// ln g of every source.
    logarithms: Vec<f64>,
}

/// −2 ln L up to a constant, and the best parameters of the first ring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Best {
    pub deviance: f64,
    pub amplitude: f64,
    pub noise: f64,
    /// Σ (P/E − 1)² over all rings.
    pub scatter: f64,
}

impl Powers {
    pub(super) fn of(rings: &[RingSample], settings: &SpectrumWindowSettings) -> Result<Self, SpectrumFitError> {
        settings.check()?;
        if rings.is_empty() {
            return Err(SpectrumFitError::NoRing);
        }
        let found: Result<Vec<Ring>, _> =
            rings.iter().enumerate().map(|(index, ring)| Ring::of(index, ring, settings)).collect();
        let found = found?;
        let highest = found.iter().map(|ring| ring.lowest + ring.power.len() - 1).max().unwrap_or(1);
        Ok(Powers { rings: found, noise: settings.noise, highest })
    }

    /// Number of powers.
    pub(super) fn count(&self) -> usize {
        self.rings.iter().map(|ring| ring.power.len()).sum()
    }

    /// Lowest and highest f.
    pub(super) fn window(&self) -> [usize; 2] {
        [self.rings.iter().map(|ring| ring.lowest).min().unwrap_or(1), self.highest]
    }

    /// Rise of −2 ln L at the ends of an interval.
    pub(super) fn rise(&self) -> f64 {
        RISE * (1.0 + SMALL_COUNT / self.count() as f64)
    }

    /// The best amplitudes (and noise) for a shape of the spectrum, a function of ln f.
    pub(super) fn best(&self, shape: impl Fn(f64) -> f64) -> Best {
        let mut total = Best { deviance: 0.0, amplitude: f64::NAN, noise: f64::NAN, scatter: 0.0 };
        for (index, ring) in self.rings.iter().enumerate() {
            let best = ring.best(&shape, self.noise);
            total.deviance += best.deviance;
            total.scatter += best.scatter;
            if index == 0 {
                (total.amplitude, total.noise) = (best.amplitude, best.noise);
            }
        }
        total
    }

    /// Σ (P/E − 1)² per degree of freedom: 1 where the model holds.
    pub(super) fn dispersion(&self, best: Best, parameter_count: usize) -> f64 {
        let noises = if self.noise == SingleDiskNoise::Fitted { self.rings.len() } else { 0 };
        let freedom = self.count() as f64 - (self.rings.len() + parameter_count + noises) as f64;
        best.scatter / freedom.max(1.0)
    }
}

impl Ring {
    fn of(index: usize, ring: &RingSample, settings: &SpectrumWindowSettings) -> Result<Self, SpectrumFitError> {
        let disk_count = ring.disk_count();
        let lowest = settings.lowest;
        let highest = match settings.highest {
            HighestFrequency::Resolved => (disk_count / 16).max((disk_count / 4).min(15)),
            HighestFrequency::Fixed(highest) => highest,
        };
        if lowest == 0 || highest > disk_count / 2 {
            return Err(SpectrumFitError::WindowOutOfRange { lowest, highest, disk_count });
        }
        let power_count = (highest + 1).saturating_sub(lowest);
        if power_count < LEAST_POWER_COUNT {
            return Err(SpectrumFitError::TooFewPowers { power_count, lowest, highest, disk_count });
        }
        let estimator = SpectrumEstimator::Direct { weights: Weights::Gaps, leakage: Leakage::Kept };
        let spectrum = SpectrumSettings { estimator, frequency_limit: FrequencyLimit::Fixed(highest) };
        let spectrum = PowerSpectrum::of(ring, &spectrum)?;
        // Powers of rounding alone are none.
        let rounding = f64::EPSILON * f64::EPSILON * (spectrum.power[0] + spectrum.variance);
        let power: Vec<f64> = spectrum.power[lowest..].iter().map(|p| p / spectrum.variance).collect();
        if spectrum.variance <= rounding || power.iter().sum::<f64>() <= 0.0 || power.iter().any(|p| p.is_nan()) {
            return Err(SpectrumFitError::NoPower { ring: index });
        }
        let window = SpectralWindow::new(ring, Weights::Gaps, highest, SOURCES_PER_DISK * disk_count);
        let sources = window.sources((settings.frequencies_per_disk * disk_count as f64) as usize);
        let logarithms = sources.iter().map(|source| libm::log(source.frequency)).collect();
        Ok(Ring { lowest, power, window, sources, logarithms })
    }

    fn best(&self, shape: impl Fn(f64) -> f64, noise: SingleDiskNoise) -> Best {
        let shapes: Vec<f64> = self.logarithms.iter().map(|&logarithm| shape(logarithm)).collect();
        let expected = self.window.expected_from(&self.sources, &shapes);
        let (expected, white) = (&expected[self.lowest - 1..], &self.window.white()[self.lowest - 1..]);
        let at = |ratio: f64| self.at(expected, white, ratio);
        let without = at(0.0);
        if noise == SingleDiskNoise::None {
            return without;
        }
        // The scale at which the noise is as strong as the weakest power expected, and that of the strongest.
        let ratios = || expected.iter().zip(white).map(|(e, w)| e / w);
        let low = ratios().fold(f64::INFINITY, f64::min).ln() - NOISE_DECADES;
        let high = ratios().fold(0.0, f64::max).ln() + NOISE_DECADES;
        let found = at(golden(low, high, 1e-4, |log| at(log.exp()).deviance).exp());
        if found.deviance < without.deviance { found } else { without }
    }

    /// E = A (e + ratio N), A at its best.
    fn at(&self, expected: &[f64], white: &[f64], ratio: f64) -> Best {
        let count = self.power.len() as f64;
        let terms = || expected.iter().zip(white).zip(&self.power).map(|((e, w), p)| (e + ratio * w, *p));
        let amplitude = terms().map(|(e, p)| p / e).sum::<f64>() / count;
        let logarithms: f64 = terms().map(|(e, _)| libm::log(e)).sum();
        let scatter = terms().map(|(e, p)| (p / (amplitude * e) - 1.0).powi(2)).sum();
        let deviance = 2.0 * (logarithms + count * libm::log(amplitude));
        Best { deviance, amplitude, noise: ratio * amplitude, scatter }
    }
}
