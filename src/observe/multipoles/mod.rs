//! [`Multipoles`]: the angular modes of a displacement field, ring by ring.
//!
//! ```text
//! d_r(θ) = c_0 + Σ_(n=1)^(n_max) (c_n cos nθ + s_n sin nθ) + rest = Σ_n A_n cos(nθ − ψ_n) + rest        the same for d_θ
//! ```
//!
//! The disks of a ring are at irregular angles, so c and s are found by least squares. In the complex form of
//! [`angular_modes`](crate::reference::angular_modes) the amplitude of mode n is U_n = c_n − i s_n. For the errors the
//! residuals, σ² = Σ rest²/(N − 2 n_max − 1), are treated as independent between disks.
//!
//! The mean square of a component over the circle is c_0² + Σ A_n²/2 + Σ rest²/N; the share of each mode is given.

mod least_squares;

use std::f64::consts::FRAC_PI_2;

use serde::{Deserialize, Serialize};

use crate::displacement::{DisplacementField, Moved};
use crate::observe::multipoles::least_squares::LeastSquares;

/// Rings and modes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MultipoleSettings {
    /// n_max, at least 2.
    pub highest_mode: usize,
    /// Width of a ring \[length\].
    pub ring_width: f64,
    /// Number of disks that a ring must have for each of its 2 n_max + 1 coefficients \[1\], at least 1. Errors need at
    /// least one disk more than coefficients.
    pub disks_per_coefficient: f64,
}

impl Default for MultipoleSettings {
    /// Modes up to 4 in rings of width 2: the ring at r = 3 has about 27 disks for 9 coefficients.
    fn default() -> Self {
        MultipoleSettings { highest_mode: 4, ring_width: 2.0, disks_per_coefficient: 3.0 }
    }
}

/// Invalid settings.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MultipoleError {
    /// The highest mode must be at least 2.
    #[error("highest_mode is {highest_mode}: must be from 2 to {HIGHEST_MODE}")]
    HighestModeOutOfRange {
        /// The value given.
        highest_mode: usize,
    },
    /// The width of a ring must be positive.
    #[error("ring_width is {ring_width}, not a positive number")]
    RingWidthNotPositive {
        /// The value given \[length\].
        ring_width: f64,
    },
    /// A fit needs at least as many disks as coefficients.
    #[error("disks_per_coefficient is {disks_per_coefficient}: must be a finite number of at least 1")]
    TooFewDisksPerCoefficient {
        /// The value given.
        disks_per_coefficient: f64,
    },
}

/// Largest n_max: a ring has at most some hundreds of disks.
pub const HIGHEST_MODE: usize = 64;

/// Angular modes against r.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Multipoles {
    /// Rings from the inside out; those without a disk are left out.
    pub rings: Vec<MultipoleRing>,
}

/// One ring.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MultipoleRing {
    /// Mean distance of its disks from the centre \[length\].
    pub radius: f64,
    /// Number of disks.
    pub disk_count: usize,
    /// The modes, or why there are none.
    pub fit: MultipoleFit,
}

/// The modes of a ring.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MultipoleFit {
    /// Fitted.
    Fitted {
        /// Of d_r.
        radial: ComponentModes,
        /// Of d_θ.
        transverse: ComponentModes,
    },
    /// The ring has fewer disks than the settings require.
    TooFewDisks {
        /// Number of disks required.
        needed: usize,
    },
    /// The angles cannot separate the modes.
    AnglesTooFew,
    /// A displacement in the ring is not finite.
    NotFinite,
}

/// The modes of one component of the displacement in one ring.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ComponentModes {
    /// Modes 0 to n_max.
    pub modes: Vec<ModeFit>,
    /// σ, the residual per disk \[length\].
    pub rest: f64,
    /// c_0² + Σ A_n²/2 + Σ rest²/N, the mean square over the circle \[length²\].
    pub mean_square: f64,
    /// Shares of modes 0, 1, 2 and of the rest in it, adding up to 1; absent if nothing moves \[1\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shares: Option<[f64; 4]>,
}

/// One mode.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ModeFit {
    /// n.
    pub mode: usize,
    /// c_n \[length\].
    pub cosine: f64,
    /// s_n, 0 for n = 0 \[length\].
    pub sine: f64,
    /// Standard errors of c_n and s_n, the second 0 for n = 0 \[length\].
    pub standard_errors: [f64; 2],
    /// A_n = √(c_n² + s_n²) ≥ 0; for n = 0 c_0 with its sign \[length\].
    pub amplitude: f64,
    /// Standard error of A_n, along (c_n, s_n) \[length\].
    pub amplitude_error: f64,
    /// ψ_n in (−π, π] \[rad\], 0 for n = 0: the mode is largest at θ = ψ_n/n.
    pub phase: f64,
    /// Standard error of ψ_n, perpendicular to (c_n, s_n), at most π/2 \[rad\]; 0 for n = 0.
    pub phase_error: f64,
}

impl Multipoles {
    /// The modes of a field, from the disks that count.
    ///
    /// The result does not depend on the order of the disks.
    ///
    /// # Errors
    /// Invalid settings.
    ///
    /// # Cost
    /// (2 n_max + 1)² operations per disk.
    pub fn of(field: &DisplacementField<2>, settings: &MultipoleSettings) -> Result<Self, MultipoleError> {
        settings.check()?;
        let width = settings.ring_width;
        let ring_of = |disk: &Moved<2>| (disk.distance / width).floor();
        let mut disks: Vec<(f64, Member)> = field
            .counted()
            .filter(|disk| disk.distance < field.outer_radius)
            .map(|disk| (ring_of(disk), Member::of(disk)))
            .collect();
        disks.sort_by(|a, b| {
            let keys = |x: &(f64, Member)| [x.0, x.1.angle, x.1.distance, x.1.radial, x.1.transverse];
            let (a, b) = (keys(a), keys(b));
            a.iter()
                .zip(&b)
                .map(|(x, y)| x.total_cmp(y))
                .find(|order| order.is_ne())
                .unwrap_or(std::cmp::Ordering::Equal)
        });
        let rings = disks.chunk_by(|a, b| a.0 == b.0);
        let rings = rings.map(|ring| settings.ring(&ring.iter().map(|(_, member)| *member).collect::<Vec<_>>()));
        Ok(Multipoles { rings: rings.collect() })
    }
}

/// One disk.
#[derive(Debug, Clone, Copy)]
struct Member {
    angle: f64,
    distance: f64,
    radial: f64,
    transverse: f64,
}

impl Member {
    fn of(disk: &Moved<2>) -> Self {
        Member { angle: disk.angle(), distance: disk.distance, radial: disk.radial, transverse: disk.transverse() }
    }
}

impl MultipoleSettings {
    /// Checks the settings.
    pub(crate) fn check(&self) -> Result<(), MultipoleError> {
        let Self { highest_mode, ring_width, disks_per_coefficient } = *self;
        if !(2..=HIGHEST_MODE).contains(&highest_mode) {
            return Err(MultipoleError::HighestModeOutOfRange { highest_mode });
        }
        if !(ring_width > 0.0 && ring_width.is_finite()) {
            return Err(MultipoleError::RingWidthNotPositive { ring_width });
        }
        if !(disks_per_coefficient >= 1.0 && disks_per_coefficient.is_finite()) {
            return Err(MultipoleError::TooFewDisksPerCoefficient { disks_per_coefficient });
        }
        Ok(())
    }

    fn ring(&self, disks: &[Member]) -> MultipoleRing {
        let radius = disks.iter().map(|disk| disk.distance).sum::<f64>() / disks.len() as f64;
        MultipoleRing { radius, disk_count: disks.len(), fit: self.fit(disks) }
    }

    fn fit(&self, disks: &[Member]) -> MultipoleFit {
        let coefficient_count = 2 * self.highest_mode + 1;
        // At least one disk more than coefficients, as errors need.
        let needed = (self.disks_per_coefficient * coefficient_count as f64).ceil() as usize;
        let needed = needed.max(coefficient_count + 1);
        if disks.len() < needed {
            return MultipoleFit::TooFewDisks { needed };
        }
        if !disks.iter().all(|disk| disk.radial.is_finite() && disk.transverse.is_finite()) {
            return MultipoleFit::NotFinite;
        }
        let mut columns = vec![vec![1.0; disks.len()]];
        for mode in 1..=self.highest_mode {
            let waves = disks.iter().map(|disk| libm::sincos(mode as f64 * disk.angle));
            let (sines, cosines) = waves.unzip();
            columns.extend([cosines, sines]);
        }
        let radial = disks.iter().map(|disk| disk.radial).collect();
        let transverse = disks.iter().map(|disk| disk.transverse).collect();
        let Some(squares) = LeastSquares::new(columns, vec![radial, transverse]) else {
            return MultipoleFit::AnglesTooFew;
        };
        let covariance = squares.covariance();
        let component = |which| ComponentModes::of(&squares, which, &covariance, disks.len());
        MultipoleFit::Fitted { radial: component(0), transverse: component(1) }
    }
}

impl ComponentModes {
    fn of(squares: &LeastSquares, which: usize, covariance: &[Vec<f64>], disk_count: usize) -> Self {
        let solution = squares.solution(which);
        let coefficients = &solution.coefficients;
        let variance = solution.rest_square / (disk_count - coefficients.len()) as f64;
        let mut modes = vec![ModeFit::isotropic(coefficients[0], (variance * covariance[0][0]).sqrt())];
        for mode in 1..=coefficients.len() / 2 {
            let at = 2 * mode - 1;
            let block = [covariance[at][at], covariance[at][at + 1], covariance[at + 1][at + 1]];
            modes.push(ModeFit::new(
                mode,
                [coefficients[at], coefficients[at + 1]],
                block.map(|entry| variance * entry),
            ));
        }
        let square = |mode: &ModeFit| mode.amplitude * mode.amplitude * if mode.mode == 0 { 1.0 } else { 0.5 };
        let mean_square = modes.iter().map(square).sum::<f64>() + solution.rest_square / disk_count as f64;
        let shares = (mean_square > 0.0).then(|| {
            let low: [f64; 3] = std::array::from_fn(|mode| square(&modes[mode]) / mean_square);
            [low[0], low[1], low[2], (1.0 - low.iter().sum::<f64>()).max(0.0)]
        });
        ComponentModes { modes, rest: variance.sqrt(), mean_square, shares }
    }
}

impl ModeFit {
    fn isotropic(mean: f64, error: f64) -> Self {
        ModeFit {
            mode: 0,
            cosine: mean,
            sine: 0.0,
            standard_errors: [error, 0.0],
            amplitude: mean,
            amplitude_error: error,
            phase: 0.0,
            phase_error: 0.0,
        }
    }

    /// A mode from c and s with their variances and covariance, [cc, cs, ss].
    fn new(mode: usize, [cosine, sine]: [f64; 2], [cc, cs, ss]: [f64; 3]) -> Self {
        let amplitude = libm::hypot(cosine, sine);
        let phase = libm::atan2(sine, cosine);
        let (unit_sine, unit_cosine) = libm::sincos(phase);
        let along = unit_cosine * unit_cosine * cc + 2.0 * unit_cosine * unit_sine * cs + unit_sine * unit_sine * ss;
        let across = unit_sine * unit_sine * cc - 2.0 * unit_cosine * unit_sine * cs + unit_cosine * unit_cosine * ss;
        ModeFit {
            mode,
            cosine,
            sine,
            standard_errors: [cc.sqrt(), ss.sqrt()],
            amplitude,
            amplitude_error: along.max(0.0).sqrt(),
            phase,
            phase_error: (across.max(0.0).sqrt() / amplitude).min(FRAC_PI_2),
        }
    }
}
