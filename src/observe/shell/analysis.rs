//! [`ShellAnalysis`]: spectrum and correlation function of one shell.

use serde::{Deserialize, Serialize};

use crate::displacement::DisplacementField;
use crate::observe::shell::correlation::{ShellCorrelation, ShellCorrelationSettings};
use crate::observe::shell::error::ShellError;
use crate::observe::shell::power_spectrum::{ShellSpectrum, ShellSpectrumSettings};
use crate::observe::shell::sample::ShellSample;

/// The middle of the usual shell, r̂. Source: the study.
pub const SHELL_RADIUS: f64 = 0.5;

/// Half its width, δr̂. Source: the study.
pub const SHELL_HALF_WIDTH: f64 = 0.03;

/// How a shell is analysed.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ShellSettings {
    /// S(ℓ).
    pub spectrum: ShellSpectrumSettings,
    /// G(γ).
    pub correlation: ShellCorrelationSettings,
}

/// Spectrum and correlation function of the radial displacement in one shell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ShellAnalysis {
    /// r̂ \[1\].
    pub relative_radius: f64,
    /// δr̂ \[1\].
    pub half_width: f64,
    /// Number of spheres.
    pub disk_count: usize,
    /// ⟨d_r⟩ \[length\].
    pub mean: f64,
    /// ⟨δd_r²⟩ \[length²\].
    pub variance: f64,
    /// S(ℓ).
    pub spectrum: ShellSpectrum,
    /// G(γ), from pairs.
    pub correlation: ShellCorrelation,
}

impl ShellAnalysis {
    /// The shell r̂ ± `half_width` of a field; the usual one has [`SHELL_RADIUS`] and [`SHELL_HALF_WIDTH`].
    ///
    /// # Errors
    /// Too few spheres, equal values, settings out of range: see [`ShellError`].
    ///
    /// # Example
    /// ```
    /// use jamscope::observe::shell::{ShellAnalysis, ShellSettings, SHELL_HALF_WIDTH, SHELL_RADIUS};
    /// use jamscope::displacement::{DisplacementField, MeasuredOn, Moved, Shape};
    ///
    /// // A spiral of 400 spheres at r = R/2, which move along z: d_r = 0.001 cos θ, a dipole.
    /// let disks = (0..400).map(|disk| {
    ///     let (z, angle) = (1.0 - (2 * disk + 1) as f64 / 400.0, 2.4 * disk as f64);
    ///     let across = (1.0 - z * z).sqrt();
    ///     let position = [10.0 * across * angle.cos(), 10.0 * across * angle.sin(), 10.0 * z];
    ///     let (displacement, radial) = ([0.0, 0.0, 1e-3], 1e-3 * z);
    ///     Moved { disk, position, distance: 10.0, displacement, radial, counted: true }
    /// });
    /// let measured_on = MeasuredOn::Backbone;
    /// let field = DisplacementField { disks: disks.collect(), inner_radius: 0.5, outer_radius: 20.0, shape: Shape::Round, measured_on };
    ///
    /// let shell = ShellAnalysis::of(&field, SHELL_RADIUS, SHELL_HALF_WIDTH, &ShellSettings::default())?;
    /// let relative = shell.spectrum.normalised().expect("power at ℓ = 1");
    /// assert!(relative[2..].iter().all(|power| power.abs() < 1e-3));
    /// // G = cos γ, so G* = 1.
    /// assert!((shell.correlation.anticorrelation.expect("pairs").value - 1.0).abs() < 0.01);
    /// # Ok::<(), jamscope::observe::shell::ShellError>(())
    /// ```
    pub fn of(
        field: &DisplacementField<3>,
        relative_radius: f64,
        half_width: f64,
        settings: &ShellSettings,
    ) -> Result<Self, ShellError> {
        let shell = ShellSample::of_field(field, relative_radius, half_width)?;
        Ok(ShellAnalysis {
            relative_radius,
            half_width,
            disk_count: shell.disk_count(),
            mean: shell.mean(),
            variance: shell.variance(),
            spectrum: ShellSpectrum::of(&shell, &settings.spectrum)?,
            correlation: ShellCorrelation::of(&shell, &settings.correlation)?,
        })
    }
}

impl ShellSettings {
    /// Checks the settings, independently of a shell.
    ///
    /// # Errors
    /// The first setting that is out of range.
    pub fn check(&self) -> Result<(), ShellError> {
        self.correlation.check()?;
        self.spectrum.check()
    }
}
