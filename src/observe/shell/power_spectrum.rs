//! [`ShellSpectrum`]: S(ℓ) of the radial displacement in a shell.
//!
//! ```text
//! P_ℓ = n⁻² Σ_ij δ_i δ_j P_ℓ(n_i·n_j) = n⁻² Σ_m (Σ_i δ_i R_ℓm(n_i))²        δ = d_r − ⟨d_r⟩
//! S(ℓ) = P_ℓ/P_1        Σ_ℓ (2ℓ+1) P_ℓ + ρ = V
//! ```
//!
//! P_ℓ is the mean power of the 2ℓ+1 harmonics √(2ℓ+1) R_ℓm, of mean square 1, of degree ℓ: 4π P_ℓ is the C_ℓ of the literature, and S(ℓ) = C_ℓ/C_1.
//! In a ring P_f is the power of both modes of frequency f, and S(f) its ratio, so that the variance is Σ P_f. The
//! variance per degree, (2ℓ+1) P_ℓ, is therefore what compares with S(f): if S(ℓ) ∼ ℓ^(−s), it falls as ℓ^(1−s). The
//! values of an isotropic field along one great circle have S(f) ∼ f^(1−s) too.
//!
//! Irregular directions mix the degrees, and the pairs i = j add V/n to each. [`Leakage::Removed`] solves the equations
//! of [`ShellWindow`] for P and ρ. ρ is the variance above ℓ_max and of single spheres, so the pairs i = j are then
//! taken out. The result is unbiased if ρ is white, and single powers may be negative: they are kept.

use serde::{Deserialize, Serialize};

use crate::observe::angular::{Leakage, solve};
use crate::observe::shell::error::{LEAST_DISK_COUNT, ShellError};
use crate::observe::shell::harmonics::{HarmonicSums, legendre};
use crate::observe::shell::limits::{MOST_DEGREES, at_most};
use crate::observe::shell::sample::ShellSample;
use crate::observe::shell::window::ShellWindow;

/// The highest degree of a spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DegreeLimit {
    /// This share of √n, rounded down, at least 1.
    PerRoot(f64),
    /// This one, at most √n − 1.
    Fixed(usize),
}

impl DegreeLimit {
    /// The highest ℓ for n spheres: (ℓ + 1)² harmonics must not be more than n.
    pub(crate) fn of(self, disk_count: usize) -> Result<usize, ShellError> {
        let highest = disk_count.isqrt() - 1;
        let degree_limit = match self {
            DegreeLimit::Fixed(limit) => limit,
            DegreeLimit::PerRoot(share) => {
                if !(share > 0.0 && share <= 1.0) {
                    return Err(ShellError::NotPositive {
                        setting: "degrees per root of the disk count",
                        value: share,
                    });
                }
                ((share * (disk_count as f64).sqrt()) as usize).clamp(1, highest)
            }
        };
        if !(1..=highest).contains(&degree_limit) {
            return Err(ShellError::DegreeLimitOutOfRange { degree_limit, disk_count, highest });
        }
        at_most(MOST_DEGREES / 2).check("degree_limit", degree_limit, 16.0 * degree_limit as f64)?;
        Ok(degree_limit)
    }
}

/// How a spectrum is computed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ShellSpectrumSettings {
    /// Whether leakage is removed. Changes results.
    pub leakage: Leakage,
    /// ℓ_max.
    pub degree_limit: DegreeLimit,
}

impl ShellSpectrumSettings {
    /// Checks the settings, independently of a shell.
    pub(crate) fn check(&self) -> Result<(), ShellError> {
        match self.degree_limit {
            DegreeLimit::PerRoot(_) => self.degree_limit.of(LEAST_DISK_COUNT).map(drop),
            DegreeLimit::Fixed(0) => Err(ShellError::NotPositive { setting: "degree_limit", value: 0.0 }),
            DegreeLimit::Fixed(_) => Ok(()),
        }
    }
}

impl Default for ShellSpectrumSettings {
    /// Leakage removed up to √n/2: four spheres for each harmonic, as in a ring.
    fn default() -> Self {
        ShellSpectrumSettings { leakage: Leakage::Removed, degree_limit: DegreeLimit::PerRoot(0.5) }
    }
}

/// The power of a shell at ℓ = 0, …, ℓ_max.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ShellSpectrum {
    /// Whether leakage was removed.
    pub leakage: Leakage,
    /// Number of spheres, n.
    pub disk_count: usize,
    /// V \[value²\].
    pub variance: f64,
    /// P_ℓ at its index ℓ \[value²\]; P_0 is the squared mean.
    pub power: Vec<f64>,
    /// Standard error of P_ℓ of a Gaussian field \[value²\]; 0 at ℓ = 0.
    pub standard_errors: Vec<f64>,
    /// ρ, the variance of higher degrees and of single spheres, if leakage is removed; otherwise 0 \[value²\].
    pub unresolved: f64,
    /// Number of negative powers.
    pub negative_count: usize,
}

/// A negative ρ up to this share of Σ (2ℓ+1) P_ℓ counts as 0 in a correlation function, as in a ring \[1\].
const NOISE: f64 = 0.05;

/// A power that answers to a change of another by more than this has lost half of its digits: the directions do not
/// separate the degrees.
const LARGEST_RESPONSE: f64 = 1e8;

impl ShellSpectrum {
    /// The spectrum of a shell.
    ///
    /// # Errors
    /// ℓ_max out of range; directions that do not separate the degrees.
    ///
    /// # Cost
    /// 5 n ℓ_max² steps of a recursion and ℓ_max⁴/3 multiplications: 0.03 s at 5000 spheres.
    ///
    /// # Accuracy
    /// The errors are √(2/(2ℓ+1)) of the power with leakage, for Gaussian amplitudes, times the response of P_ℓ to that
    /// power. The scatter that other degrees leak is taken back by the removal, and is not counted.
    pub fn of(shell: &ShellSample, settings: &ShellSpectrumSettings) -> Result<Self, ShellError> {
        let disk_count = shell.disk_count();
        let degree_limit = settings.degree_limit.of(disk_count)?;
        let strengths: Vec<f64> = shell.fluctuations().iter().map(|x| x / disk_count as f64).collect();
        let mut power = HarmonicSums::of(shell.directions(), &strengths, degree_limit).power();
        power[0] = shell.mean() * shell.mean();
        let error = |(degree, power): (usize, &f64)| if degree == 0 { 0.0 } else { relative_error(degree) * power };
        let mut spectrum = ShellSpectrum {
            leakage: settings.leakage,
            disk_count,
            variance: shell.variance(),
            standard_errors: power.iter().enumerate().map(error).collect(),
            power,
            unresolved: 0.0,
            negative_count: 0,
        };
        if settings.leakage == Leakage::Removed {
            spectrum.remove_leakage(&ShellWindow::new(shell, degree_limit, degree_limit)?)?;
        }
        Ok(spectrum)
    }

    fn remove_leakage(&mut self, window: &ShellWindow) -> Result<(), ShellError> {
        let (degree_limit, disk_count) = (self.degree_limit(), self.disk_count);
        let solved = |right: &dyn Fn(usize) -> f64, last: f64| {
            let mut rows: Vec<Vec<f64>> = (1..=degree_limit)
                .map(|degree| [window.row(degree), &[window.white(degree), right(degree)]].concat())
                .collect();
            let share = |degree| (2 * degree + 1) as f64 * window.variance_share(degree);
            let closing = (1..=degree_limit).map(share);
            rows.push(closing.chain([1.0 - 1.0 / disk_count as f64, last]).collect());
            solve(rows).ok_or(ShellError::NotSeparable { disk_count, degree_limit })
        };
        let found = solved(&|degree| self.power[degree], self.variance)?;
        let mut errors = Vec::with_capacity(degree_limit);
        for measured in 1..=degree_limit {
            let error = self.standard_errors[measured];
            let response = solved(&|degree| if degree == measured { 1.0 } else { 0.0 }, 0.0)?;
            if !response.iter().all(|change| change.abs() <= LARGEST_RESPONSE) {
                return Err(ShellError::NotSeparable { disk_count, degree_limit });
            }
            errors.push(error * response[measured - 1].abs());
        }
        self.power[1..].copy_from_slice(&found[..degree_limit]);
        self.unresolved = found[degree_limit];
        self.standard_errors[1..].copy_from_slice(&errors);
        self.negative_count = self.power.iter().filter(|&&power| power < 0.0).count();
        Ok(())
    }

    /// S(ℓ) = P_ℓ/P_1 \[1\] at its index ℓ; none if P_1 is not positive.
    pub fn normalised(&self) -> Option<Vec<f64>> {
        let first = self.power[1];
        (first > 0.0).then(|| self.power.iter().map(|power| power / first).collect())
    }

    /// G(γ) = Σ (2ℓ+1) P_ℓ P_ℓ(cos γ)/(Σ (2ℓ+1) P_ℓ + ρ) \[1\] for γ > 0, the Wiener–Khinchin theorem on a sphere; none
    /// if the divisor is not positive.
    ///
    /// ρ is a peak at γ = 0. A slightly negative ρ, down to −0.05 Σ (2ℓ+1) P_ℓ, counts as 0.
    pub fn correlation(&self, angle: f64) -> Option<f64> {
        let weighted =
            || (1..).zip(&self.power[1..]).map(|(degree, power): (usize, _)| (2 * degree + 1) as f64 * power);
        let resolved: f64 = weighted().sum();
        let noise = self.unresolved < 0.0 && -self.unresolved <= NOISE * resolved;
        let total = if noise { resolved } else { resolved + self.unresolved };
        let polynomials = legendre(libm::cos(angle), self.degree_limit());
        let sum: f64 = weighted().zip(&polynomials[1..]).map(|(power, value)| power * value).sum();
        (total > 0.0).then(|| sum / total)
    }

    /// Highest ℓ.
    pub fn degree_limit(&self) -> usize {
        self.power.len() - 1
    }
}

/// √(2/(2ℓ+1)): the relative scatter of a mean of 2ℓ+1 squares of normal amplitudes.
fn relative_error(degree: usize) -> f64 {
    (2.0 / (2 * degree + 1) as f64).sqrt()
}
