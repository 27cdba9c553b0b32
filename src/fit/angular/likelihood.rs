//! Whittle's likelihood of the powers of rings and shells, maximised over amplitudes and noise.
//!
//! ```text
//! −2 ln L = 2 Σ_f h_f (ln E_f + P_f/E_f)        h: half the number of modes of a power, 1 in a ring, ℓ + ½ in a shell
//! ```

use crate::fit::angular::error::{LEAST_POWER_COUNT, SpectrumFitError};
use crate::fit::angular::window::{HighestFrequency, SingleDiskNoise, SpectrumWindowSettings};
use crate::fit::search::golden;
use crate::observe::angular::{
    FrequencyLimit, Leakage, PowerSpectrum, RingSample, Source, SpectralWindow, SpectrumEstimator, SpectrumSettings,
    Weights, dependence,
};
use crate::reference::lorentzian::USUAL_EXPONENT;
use crate::vector::larger;

/// Number of source frequencies of the window per disk. Leakage from beyond is white within the scatter of a window.
const SOURCES_PER_DISK: usize = 2;

/// Rise of −2 ln L at two standard errors.
const RISE: f64 = 4.0;

/// Bartlett's correction times the number of independent powers. Source: Lawley (1956), Biometrika 43, 295, for
/// exponential variates whose logarithms lie on a line in ln f: 0.36 to 0.41 from 3 to 250 powers
/// (`likelihood::tests::the_correction_of_few_powers_is_that_of_lawley`).
const SMALL_COUNT: f64 = 0.4;

/// Above this number, the powers of a ring count as independent in the correction, which is then at most 1.3 % of the
/// rise.
const DEPENDENCE_UP_TO: usize = 32;

/// Range of ρ N_f over Σ K S, in decades above and below 1.
const NOISE_DECADES: f64 = 8.0;

/// Range of A below its best value without noise.
const AMPLITUDE_DECADES: f64 = 4.0;

/// The expected powers at irregular places, for a spectrum of unit amplitude and for independent values.
pub(super) trait ExpectedPower {
    /// Expected powers of a spectrum known at the sources.
    fn expected(&self, spectrum: &[f64]) -> Vec<f64>;

    /// Expected powers of independent values of variance 1.
    fn white(&self) -> &[f64];
}

/// The window of a ring, and the frequencies at which a spectrum must be known.
struct RingWindow {
    window: SpectralWindow,
    sources: Vec<Source>,
}

impl ExpectedPower for RingWindow {
    fn expected(&self, spectrum: &[f64]) -> Vec<f64> {
        self.window.expected_from(&self.sources, spectrum)
    }

    fn white(&self) -> &[f64] {
        self.window.white()
    }
}

/// The powers of several rings or shells.
pub(super) struct Powers {
    rings: Vec<Ring>,
    noise: SingleDiskNoise,
    highest: usize,
}

/// The powers of one ring or shell.
pub(super) struct Ring {
    /// Lowest f fitted.
    pub lowest: usize,
    /// P_f over the variance, from the lowest f on.
    pub power: Vec<f64>,
    /// Half the number of modes of every power: P_f/E_f has the variance 1/h.
    pub half_modes: Vec<f64>,
    /// m over the number of independent powers with the same scatter, for S ∝ f^(−1.5).
    pub dependence: f64,
    /// ρ over the variance, if it is measured and not a parameter.
    pub measured_noise: Option<f64>,
    /// Expected powers from f = 1 on.
    pub window: Box<dyn ExpectedPower>,
    /// ln g of every source.
    pub logarithms: Vec<f64>,
}

/// −2 ln L up to a constant, and the best parameters of the first ring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Best {
    pub deviance: f64,
    pub amplitude: f64,
    pub noise: f64,
    /// Σ h (P/E − 1)² over all rings.
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
        Ok(Self::of_measured(found?, settings.noise))
    }

    /// The powers of measured rings or shells, at least one.
    pub(super) fn of_measured(rings: Vec<Ring>, noise: SingleDiskNoise) -> Self {
        let highest = rings.iter().map(|ring| ring.lowest + ring.power.len() - 1).max().unwrap_or(1);
        Powers { rings, noise, highest }
    }

    /// Number of powers.
    pub(super) fn count(&self) -> usize {
        self.rings.iter().map(|ring| ring.power.len()).sum()
    }

    /// Lowest and highest f.
    pub(super) fn window(&self) -> [usize; 2] {
        [self.rings.iter().map(|ring| ring.lowest).min().unwrap_or(1), self.highest]
    }

    /// Rise of −2 ln L at the ends of an interval, with the correction for few powers.
    pub(super) fn rise(&self) -> f64 {
        let count: f64 = self.rings.iter().map(Ring::half_count).sum();
        let scatter: f64 = self.rings.iter().map(|ring| ring.half_count() * ring.dependence).sum();
        RISE * (1.0 + SMALL_COUNT * scatter / (count * count))
    }

    /// The best amplitudes (and noise) for a spectrum of given shape, a function of ln f.
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

    /// Σ h (P/E − 1)² per degree of freedom: 1 if the model is correct.
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
        // Powers at the level of rounding count as zero.
        let rounding = f64::EPSILON * f64::EPSILON * (spectrum.power[0] + spectrum.variance);
        let power: Vec<f64> = spectrum.power[lowest..].iter().map(|p| p / spectrum.variance).collect();
        if spectrum.variance <= rounding || power.iter().sum::<f64>() <= 0.0 || power.iter().any(|p| p.is_nan()) {
            return Err(SpectrumFitError::NoPower { ring: index });
        }
        let window = SpectralWindow::new(ring, Weights::Gaps, highest, SOURCES_PER_DISK * disk_count);
        let extent = (settings.frequencies_per_disk * disk_count as f64) as usize;
        let sources = window.sources(extent);
        let logarithms = sources.iter().map(|source| libm::log(source.frequency)).collect();
        let dependence = if power_count < DEPENDENCE_UP_TO {
            dependence(ring, Weights::Gaps, highest, |f| libm::pow(f, -USUAL_EXPONENT), extent)
        } else {
            1.0
        };
        let half_modes = vec![1.0; power.len()];
        let window = Box::new(RingWindow { window, sources });
        Ok(Ring { lowest, power, half_modes, dependence, measured_noise: None, window, logarithms })
    }

    /// Half the number of modes.
    fn half_count(&self) -> f64 {
        self.half_modes.iter().sum()
    }

    fn best(&self, shape: impl Fn(f64) -> f64, noise: SingleDiskNoise) -> Best {
        let shapes: Vec<f64> = self.logarithms.iter().map(|&logarithm| shape(logarithm)).collect();
        let expected = self.window.expected(&shapes);
        let (expected, white) = (&expected[self.lowest - 1..], &self.window.white()[self.lowest - 1..]);
        let at = |ratio: f64| self.at(expected, white, ratio);
        let without = at(0.0);
        if let Some(noise) = self.measured_noise {
            return self.with_noise(expected, white, without, noise.max(0.0));
        }
        if noise == SingleDiskNoise::None {
            return without;
        }
        // Noise as strong as the weakest expected power, and as the strongest.
        let ratios = || expected.iter().zip(white).map(|(e, w)| e / w);
        let low = libm::log(-ratios().map(|ratio| -ratio).fold(f64::NEG_INFINITY, larger)) - NOISE_DECADES;
        let high = libm::log(ratios().fold(0.0, larger)) + NOISE_DECADES;
        let found = at(libm::exp(golden(low, high, 1e-4, &|log| at(libm::exp(log)).deviance)));
        if found.deviance < without.deviance { found } else { without }
    }

    /// E = A e + ρ N with a given ρ and the best A; `without` is the best for ρ = 0.
    fn with_noise(&self, expected: &[f64], white: &[f64], without: Best, noise: f64) -> Best {
        let terms = |amplitude: f64| {
            let powers = self.power.iter().zip(&self.half_modes);
            expected.iter().zip(white).zip(powers).map(move |((e, w), (p, h))| (amplitude * e + noise * w, *p, *h))
        };
        let deviance = |amplitude: f64| 2.0 * terms(amplitude).map(|(e, p, h)| h * (libm::log(e) + p / e)).sum::<f64>();
        let highest = libm::log(without.amplitude);
        let low = highest - AMPLITUDE_DECADES * std::f64::consts::LN_10;
        let amplitude = libm::exp(golden(low, highest + 1.0, 1e-7, &|log| deviance(libm::exp(log))));
        let scatter = terms(amplitude).map(|(e, p, h)| h * (p / e - 1.0).powi(2)).sum();
        Best { deviance: deviance(amplitude), amplitude, noise, scatter }
    }

    /// E = A (e + ratio N), with the best A.
    fn at(&self, expected: &[f64], white: &[f64], ratio: f64) -> Best {
        let count = self.half_count();
        let powers = || self.power.iter().zip(&self.half_modes);
        let terms = || expected.iter().zip(white).zip(powers()).map(|((e, w), (p, h))| (e + ratio * w, *p, *h));
        let amplitude = terms().map(|(e, p, h)| h * (p / e)).sum::<f64>() / count;
        let logarithms: f64 = terms().map(|(e, _, h)| h * libm::log(e)).sum();
        let scatter = terms().map(|(e, p, h)| h * (p / (amplitude * e) - 1.0).powi(2)).sum();
        let deviance = 2.0 * (logarithms + count * libm::log(amplitude));
        Best { deviance, amplitude, noise: ratio * amplitude, scatter }
    }
}

#[cfg(test)]
mod tests {

    /// Lawley's ε of exponential variates whose logarithms are linear in the columns x, H their hat matrix:
    /// −¼ Σ H_ii² + ⅙ Σ H_ij³ + ¼ Σ H_ii H_ij H_jj.
    fn epsilon(hat: &[Vec<f64>]) -> f64 {
        let count = hat.len();
        let diagonal: f64 = (0..count).map(|i| hat[i][i].powi(2)).sum();
        let pairs = || (0..count).flat_map(|i| (0..count).map(move |j| (i, j)));
        let cubes: f64 = pairs().map(|(i, j)| hat[i][j].powi(3)).sum();
        let chains: f64 = pairs().map(|(i, j)| hat[i][i] * hat[i][j] * hat[j][j]).sum();
        -0.25 * diagonal + cubes / 6.0 + 0.25 * chains
    }

    #[test]
    fn the_correction_of_few_powers_is_that_of_lawley() {
        for count in [3, 5, 15, 62, 250] {
            let logarithms: Vec<f64> = (1..=count).map(|f| f64::from(f).ln()).collect();
            let mean = logarithms.iter().sum::<f64>() / f64::from(count);
            let width: f64 = logarithms.iter().map(|x| (x - mean).powi(2)).sum();
            // First the amplitude alone, then amplitude and slope.
            let constant = vec![vec![1.0 / f64::from(count); count as usize]; count as usize];
            let line = |x: &f64| {
                let entry = |y: &f64| 1.0 / f64::from(count) + (x - mean) * (y - mean) / width;
                logarithms.iter().map(entry).collect()
            };
            // ε of a constant is known in closed form, 1/6m, from ⟨ln P⟩ = ψ(m) − ln m.
            let alone = epsilon(&constant);
            assert!((alone - 1.0 / (6.0 * f64::from(count))).abs() < 1e-14);
            let correction = f64::from(count) * (epsilon(&logarithms.iter().map(line).collect::<Vec<_>>()) - alone);
            assert!((0.35..0.42).contains(&correction), "{count} powers: {correction}/m");
        }
    }
}
