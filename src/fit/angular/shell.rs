//! [`fit_shell_slope`], [`fit_shell_crossover`]: slope and crossover of the spectrum of shells of spheres.
//!
//! ```text
//! power law     S(ℓ) = A ℓ^(−s)             Lorentzian    S(ℓ) = A/(1 + (ℓ/ℓ†)^s)        γ† = k/ℓ†
//! −2 ln L = Σ_ℓ (2ℓ+1) (ln E_ℓ + P_ℓ/E_ℓ)       E_ℓ = Σ_g K_ℓg S(g) + ρ N_ℓ        leakage kept
//! ```
//!
//! P_ℓ is a mean of 2ℓ+1 squares of Gaussian amplitudes, in a ring of 2. K and N are those of
//! [`ShellWindow`](crate::observe::shell::ShellWindow). The rest is as in rings. S is the power of one harmonic, so that
//! its exponent is larger by 1 than that of the variance per degree, (2ℓ+1) S; with s ≤ 2 the variance is dominated by the
//! highest degrees. Degrees above the model therefore belong to ρ, which is fitted by default.

use serde::{Deserialize, Serialize};

use crate::fit::angular::crossover::{CrossoverFit, ExponentChoice, crossover_of};
use crate::fit::angular::error::{LEAST_POWER_COUNT, SpectrumFitError};
use crate::fit::angular::likelihood::{ExpectedPower, Powers, Ring};
use crate::fit::angular::slope::{SlopeFit, slope_of};
use crate::fit::angular::window::{HighestFrequency, SingleDiskNoise};
use crate::observe::angular::Leakage;
use crate::observe::shell::{DegreeLimit, ShellSample, ShellSpectrum, ShellSpectrumSettings, ShellWindow};

/// Relative width of the bands of degrees above those of the window.
const BAND_WIDTH: f64 = 0.02;

/// The powers used in a fit, and the model of their noise.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ShellFitSettings {
    /// Lowest ℓ \[1\].
    pub lowest: usize,
    /// Highest ℓ: `Resolved` is √(n/8), eight spheres for each harmonic, as in a ring, at least 3; `Fixed` at most √n − 1.
    pub highest: HighestFrequency,
    /// Noise of single spheres, and variance above the model.
    pub noise: SingleDiskNoise,
    /// Highest degree of the model over √n, from 1 to 100 \[1\].
    pub degrees_per_root: f64,
}

impl Default for ShellFitSettings {
    /// From ℓ = 1; a model up to 2√n, ρ fitted.
    fn default() -> Self {
        ShellFitSettings {
            lowest: 1,
            highest: HighestFrequency::Resolved,
            noise: SingleDiskNoise::Fitted,
            degrees_per_root: 2.0,
        }
    }
}

/// Settings of the fit of a crossover.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ShellCrossoverSettings {
    /// The powers used.
    pub window: ShellFitSettings,
    /// s.
    pub exponent: ExponentChoice,
    /// k of γ† = k/ℓ† \[rad\].
    pub angle_factor: f64,
}

impl Default for ShellCrossoverSettings {
    /// s = 1.5, as in a ring; k = 1. The k of a ring has no counterpart: for s ≤ 2 the variance is at the highest
    /// degrees, and G has no limit as ℓ† grows.
    fn default() -> Self {
        ShellCrossoverSettings {
            window: ShellFitSettings::default(),
            exponent: ExponentChoice::Fixed(1.5),
            angle_factor: 1.0,
        }
    }
}

/// Fits S = A ℓ^(−s) to the shells with a common s; ℓ takes the place of f in the result.
///
/// # Errors
/// No shell, a window with fewer than three powers or out of range.
///
/// # Example
/// ```
/// use jamscope::fit::angular::{ShellFitSettings, fit_shell_slope};
/// use jamscope::observe::shell::synthetic::{SyntheticSettings, gaussian_shells};
/// let shell = gaussian_shells(&SyntheticSettings::default(), 1, |l| l.powf(-2.5))?.remove(0).shell;
/// let fit = fit_shell_slope(&[shell], &ShellFitSettings::default())?;
/// assert!(fit.exponent.holds(2.5) && fit.power_count == 11);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fit_shell_slope(shells: &[ShellSample], settings: &ShellFitSettings) -> Result<SlopeFit, SpectrumFitError> {
    Ok(slope_of(&powers(shells, settings)?))
}

/// Fits S = A/(1 + (ℓ/ℓ†)^s) to the shells with a common ℓ†, and a common s if it is free; ℓ takes the place of f in the
/// result.
///
/// # Errors
/// See [`fit_shell_slope`]; a fixed exponent or k that is not positive and finite.
pub fn fit_shell_crossover(
    shells: &[ShellSample],
    settings: &ShellCrossoverSettings,
) -> Result<CrossoverFit, SpectrumFitError> {
    settings.exponent.check(settings.angle_factor)?;
    Ok(crossover_of(&powers(shells, &settings.window)?, settings.exponent, settings.angle_factor))
}

fn powers(shells: &[ShellSample], settings: &ShellFitSettings) -> Result<Powers, SpectrumFitError> {
    let value = settings.degrees_per_root;
    if !(1.0..=100.0).contains(&value) {
        return Err(SpectrumFitError::SettingOutOfRange { setting: "degrees_per_root", value });
    }
    if shells.is_empty() {
        return Err(SpectrumFitError::NoRing);
    }
    let measured: Result<Vec<Ring>, _> = shells.iter().map(|shell| measured(shell, settings)).collect();
    Ok(Powers::of_measured(measured?, settings.noise))
}

fn measured(shell: &ShellSample, settings: &ShellFitSettings) -> Result<Ring, SpectrumFitError> {
    let disk_count = shell.disk_count();
    let root = (disk_count as f64).sqrt();
    let lowest = settings.lowest;
    let highest = match settings.highest {
        HighestFrequency::Resolved => ((root / 8f64.sqrt()) as usize).max(LEAST_POWER_COUNT),
        HighestFrequency::Fixed(highest) => highest,
    };
    if lowest == 0 || highest > disk_count.isqrt() - 1 {
        return Err(SpectrumFitError::WindowOutOfRange { lowest, highest, disk_count });
    }
    let power_count = (highest + 1).saturating_sub(lowest);
    if power_count < LEAST_POWER_COUNT {
        return Err(SpectrumFitError::TooFewPowers { power_count, lowest, highest, disk_count });
    }
    let spectrum = ShellSpectrumSettings { leakage: Leakage::Kept, degree_limit: DegreeLimit::Fixed(highest) };
    let spectrum = ShellSpectrum::of(shell, &spectrum)?;
    let power = spectrum.power[lowest..].iter().map(|p| p / spectrum.variance).collect();
    let extent = (settings.degrees_per_root * root) as usize;
    let window = DegreeWindow::new(shell, highest, extent)?;
    let logarithms = window.logarithms();
    // Leakage depends on all harmonics of a degree, so that powers of different degrees hardly depend on each other.
    let dependence = 1.0;
    let half_modes = (lowest..=highest).map(|degree| degree as f64 + 0.5).collect();
    Ok(Ring { lowest, power, half_modes, dependence, window: Box::new(window), logarithms })
}

/// The window of a shell, and bands of degrees beyond it.
struct DegreeWindow {
    window: ShellWindow,
    white: Vec<f64>,
    /// First and last degree of every band.
    bands: Vec<[usize; 2]>,
}

impl DegreeWindow {
    fn new(shell: &ShellSample, highest: usize, extent: usize) -> Result<Self, SpectrumFitError> {
        // Leakage from beyond 2√n is white within the scatter of a window.
        let window = ShellWindow::new(shell, highest, extent.min(2 * shell.disk_count().isqrt()))?;
        let mut bands = Vec::new();
        let mut first = window.source_limit() + 1;
        while first <= extent {
            let last = (first + (first as f64 * BAND_WIDTH) as usize).min(extent);
            bands.push([first, last]);
            first = last + 1;
        }
        let white = (1..=highest).map(|degree| window.white(degree)).collect();
        Ok(DegreeWindow { window, white, bands })
    }

    /// ln g of every degree of the window and of the middle of every band.
    fn logarithms(&self) -> Vec<f64> {
        let own = (1..=self.window.source_limit()).map(|degree| libm::log(degree as f64));
        let middle = |band: &[usize; 2]| 0.5 * libm::log((band[0] as f64 - 0.5) * (band[1] as f64 + 0.5));
        own.chain(self.bands.iter().map(middle)).collect()
    }
}

impl ExpectedPower for DegreeWindow {
    fn expected(&self, spectrum: &[f64]) -> Vec<f64> {
        let (own, beyond) = spectrum.split_at(self.window.source_limit());
        // Σ (2g+1) over a band is (last + 1)² − first².
        let modes = |band: &[usize; 2]| ((band[1] + 1) * (band[1] + 1) - band[0] * band[0]) as f64;
        let variance = self.bands.iter().zip(beyond).map(|(band, power)| modes(band) * power).sum();
        self.window.expected(own, variance)
    }

    fn white(&self) -> &[f64] {
        &self.white
    }
}
