//! [`gaussian_shells`]: synthetic shells with a known spectrum.
//!
//! ```text
//! d_r(n) = Σ_(ℓ=1)^H √((2ℓ+1) S(ℓ)) Σ_m ξ_ℓm R_ℓm(n) + noise        ξ normal, of variance 1
//! ⟨d_r d_r'⟩ = Σ (2ℓ+1) S(ℓ) P_ℓ(n·n')        √(2ℓ+1) R_ℓm has the mean square 1
//! ```

use std::f64::consts::PI;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::observe::shell::error::ShellError;
use crate::observe::shell::harmonics::HarmonicSums;
use crate::observe::shell::limits::{MOST_DEGREES, at_most};
use crate::observe::shell::sample::ShellSample;
use crate::vector::Vector;

/// The directions of the spheres of a synthetic shell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DirectionLayout {
    /// A Fibonacci lattice: nearly even.
    Even,
    /// Independent and uniform.
    Random,
    /// This share uniform in the cap of 60° around the north pole, the others uniform everywhere \[1\].
    Clustered(f64),
}

/// Settings of a synthetic shell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SyntheticSettings {
    /// Number of spheres.
    pub disk_count: usize,
    /// The directions.
    pub layout: DirectionLayout,
    /// Highest degree H.
    pub highest_degree: usize,
    /// Standard deviation of the independent noise of every sphere \[value\].
    pub noise: f64,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl Default for SyntheticSettings {
    /// 1000 spheres in random directions, degrees up to 64, no noise.
    fn default() -> Self {
        SyntheticSettings { disk_count: 1000, layout: DirectionLayout::Random, highest_degree: 64, noise: 0.0, seed: 1 }
    }
}

/// A shell and the field from which it was made.
#[derive(Debug, Clone, PartialEq)]
pub struct SyntheticShell {
    /// Directions and values.
    pub shell: ShellSample,
    /// Power per harmonic of this realisation at ℓ = 0, 1, …, H, `S(ℓ) Σ_m ξ²/(2ℓ+1)` \[value²\], without the noise.
    pub power: Vec<f64>,
}

/// `count` shells of independent fields and directions. `spectrum(ℓ)` is the variance of one harmonic.
///
/// # Errors
/// Fewer spheres than a shell needs, too many degrees; values that are not finite, from a negative or infinite spectrum.
pub fn gaussian_shells(
    settings: &SyntheticSettings,
    count: usize,
    spectrum: impl Fn(f64) -> f64,
) -> Result<Vec<SyntheticShell>, ShellError> {
    let highest = settings.highest_degree;
    at_most(MOST_DEGREES).check("highest_degree", highest, 16.0 * highest as f64)?;
    let strength =
        |degree: usize| if degree == 0 { 0.0 } else { ((2 * degree + 1) as f64 * spectrum(degree as f64)).sqrt() };
    let strengths: Vec<f64> = (0..=highest).map(strength).collect();
    let mut random = Pcg64::seed_from_u64(settings.seed);
    let mut shells = Vec::with_capacity(count);
    for _ in 0..count {
        let directions = directions(settings, &mut random);
        let amplitudes = HarmonicSums::of_amplitudes(highest, |degree, m| {
            let [c, s] = normal_pair(&mut random);
            // There is no harmonic of order −0.
            [strengths[degree] * c, if m == 0 { 0.0 } else { strengths[degree] * s }]
        });
        let mut values = Vec::with_capacity(directions.len());
        amplitudes.for_each_block(&directions, |parts, _, inside| {
            for k in 0..inside {
                let field: f64 = parts.iter().map(|part| part[k]).sum();
                values.push(field + settings.noise * normal_pair(&mut random)[0]);
            }
        });
        let modes = |degree: usize| (2 * degree + 1) as f64;
        let power = amplitudes.power();
        let power = power.iter().enumerate().map(|(degree, p)| p / (modes(degree) * modes(degree))).collect();
        shells.push(SyntheticShell { shell: ShellSample::new(&directions, &values)?, power });
    }
    Ok(shells)
}

fn directions(settings: &SyntheticSettings, random: &mut Pcg64) -> Vec<Vector<3>> {
    let count = settings.disk_count;
    let place = |z: f64, angle: f64| {
        let (sine, cosine) = libm::sincos(angle);
        let across = (1.0 - z * z).max(0.0).sqrt();
        [across * cosine, across * sine, z]
    };
    let mut uniform = |lowest: f64| {
        let z = lowest + (1.0 - lowest) * random.random::<f64>();
        place(z, 2.0 * PI * random.random::<f64>())
    };
    match settings.layout {
        DirectionLayout::Random => (0..count).map(|_| uniform(-1.0)).collect(),
        DirectionLayout::Clustered(share) => {
            let inside = (share.clamp(0.0, 1.0) * count as f64) as usize;
            (0..count).map(|disk| uniform(if disk < inside { 0.5 } else { -1.0 })).collect()
        }
        DirectionLayout::Even => {
            // The golden angle, π (3 − √5).
            let turn = PI * (3.0 - 5f64.sqrt());
            let height = |disk: usize| 1.0 - (2 * disk + 1) as f64 / count as f64;
            (0..count).map(|disk| place(height(disk), turn * disk as f64)).collect()
        }
    }
}

/// Two normal variates (Box, Muller (1958), Ann. Math. Stat. 29, 610).
fn normal_pair(random: &mut Pcg64) -> [f64; 2] {
    // 1 − u is never 0.
    let radius = (-2.0 * libm::log(1.0 - random.random::<f64>())).sqrt();
    let (sine, cosine) = libm::sincos(2.0 * PI * random.random::<f64>());
    [radius * cosine, radius * sine]
}
