//! [`fit_shell_slope`], [`fit_shell_crossover`]: slope and crossover of the spectrum of shells of spheres.
//!
//! ```text
//! power law     S(ℓ) = A ℓ^(−s)             Lorentzian    S(ℓ) = A/(1 + (ℓ/ℓ†)^s)        γ† = k/ℓ†
//! −2 ln L = Σ_ℓ (2ℓ+1) (ln E_ℓ + P_ℓ/E_ℓ)       E_ℓ = Σ_(g ≤ ℓ_2) K_ℓg S(g) + ρ N_ℓ        leakage kept
//! ```
//!
//! P_ℓ is a mean of 2ℓ+1 squares of Gaussian amplitudes, in a ring of 2. K and N are those of
//! [`ShellWindow`](crate::observe::shell::ShellWindow). ρ is the variance above the highest ℓ fitted, ℓ_2, and of single
//! spheres. It is measured: the [`ShellSpectrum`] with leakage removed has it, from many harmonics, so that no model of
//! the degrees above is needed. Those degrees matter: with s ≤ 2 most of the variance Σ (2ℓ+1) S is there.

use serde::{Deserialize, Serialize};

use crate::fit::angular::crossover::{CrossoverFit, ExponentChoice, crossover_of};
use crate::fit::angular::error::{LEAST_POWER_COUNT, SpectrumFitError};
use crate::fit::angular::likelihood::{ExpectedPower, Powers, Ring};
use crate::fit::angular::slope::{SlopeFit, slope_of};
use crate::fit::angular::window::{HighestFrequency, SingleDiskNoise};
use crate::observe::angular::Leakage;
use crate::observe::shell::{DegreeLimit, ShellSample, ShellSpectrum, ShellSpectrumSettings, ShellWindow};

/// The powers used in a fit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ShellFitSettings {
    /// Lowest ℓ \[1\].
    pub lowest: usize,
    /// Highest ℓ: `Resolved` is √(n/8), eight spheres for each harmonic, as in a ring, at least 3; `Fixed` at most √n − 1.
    pub highest: HighestFrequency,
}

impl Default for ShellFitSettings {
    /// From ℓ = 1.
    fn default() -> Self {
        ShellFitSettings { lowest: 1, highest: HighestFrequency::Resolved }
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
    if shells.is_empty() {
        return Err(SpectrumFitError::NoRing);
    }
    let measured: Result<Vec<Ring>, _> = shells.iter().map(|shell| measured(shell, settings)).collect();
    Ok(Powers::of_measured(measured?, SingleDiskNoise::None))
}

fn measured(shell: &ShellSample, settings: &ShellFitSettings) -> Result<Ring, SpectrumFitError> {
    let disk_count = shell.disk_count();
    let lowest = settings.lowest;
    let highest = match settings.highest {
        HighestFrequency::Resolved => ((disk_count as f64 / 8.0).sqrt() as usize).max(LEAST_POWER_COUNT),
        HighestFrequency::Fixed(highest) => highest,
    };
    if lowest == 0 || highest > disk_count.isqrt() - 1 {
        return Err(SpectrumFitError::WindowOutOfRange { lowest, highest, disk_count });
    }
    let power_count = (highest + 1).saturating_sub(lowest);
    if power_count < LEAST_POWER_COUNT {
        return Err(SpectrumFitError::TooFewPowers { power_count, lowest, highest, disk_count });
    }
    let spectrum = |leakage| {
        ShellSpectrum::of(shell, &ShellSpectrumSettings { leakage, degree_limit: DegreeLimit::Fixed(highest) })
    };
    let variance = shell.variance();
    let power = spectrum(Leakage::Kept)?.power[lowest..].iter().map(|p| p / variance).collect();
    let window = ShellWindow::new(shell, highest, highest)?;
    Ok(Ring {
        lowest,
        power,
        half_modes: (lowest..=highest).map(|degree| degree as f64 + 0.5).collect(),
        // Leakage is shared by the 2ℓ+1 harmonics of a degree, so that powers hardly depend on each other.
        dependence: 1.0,
        measured_noise: Some(spectrum(Leakage::Removed)?.unresolved / variance),
        logarithms: (1..=highest).map(|degree| libm::log(degree as f64)).collect(),
        window: Box::new(DegreeWindow { white: (1..=highest).map(|degree| window.white(degree)).collect(), window }),
    })
}

/// The window of a shell.
struct DegreeWindow {
    window: ShellWindow,
    white: Vec<f64>,
}

impl ExpectedPower for DegreeWindow {
    fn expected(&self, spectrum: &[f64]) -> Vec<f64> {
        self.window.expected(spectrum, 0.0)
    }

    fn white(&self) -> &[f64] {
        &self.white
    }
}
