//! [`gaussian_rings`]: synthetic rings with a known spectrum.
//!
//! ```text
//! d_r(θ) = Σ_(f=1)^H √S(f) (ξ_f cos fθ + η_f sin fθ) + noise       ξ, η normal, of variance 1
//! ```
//!
//! The sum is one transform on a grid whose size is the next power of two above 2H points. Disks are at grid points.

use std::f64::consts::PI;

use num_complex::Complex64;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::observe::angular::error::AngularError;
use crate::observe::angular::fourier::transform_in_place;
use crate::observe::angular::ring::RingSample;

/// The angles of the disks of a synthetic ring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AngleLayout {
    /// Evenly spaced.
    Even,
    /// Evenly spaced plus a uniform random shift within ± half of this share of the even gap \[1\].
    Jittered(f64),
    /// Independent and uniform.
    Random,
}

/// Settings of a synthetic ring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SyntheticSettings {
    /// Number of disks.
    pub disk_count: usize,
    /// The angles.
    pub layout: AngleLayout,
    /// Highest frequency over the number of disks \[1\].
    pub frequencies_per_disk: usize,
    /// Standard deviation of the independent noise of every disk \[value\].
    pub noise: f64,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl Default for SyntheticSettings {
    /// 1000 disks at random angles, up to 16 frequencies per disk, no noise.
    fn default() -> Self {
        let layout = AngleLayout::Random;
        SyntheticSettings { disk_count: 1000, layout, frequencies_per_disk: 16, noise: 0.0, seed: 1 }
    }
}

/// A ring and the field from which it was made.
#[derive(Debug, Clone, PartialEq)]
pub struct SyntheticRing {
    /// Angles and values.
    pub ring: RingSample,
    /// Power of this realisation of the field at f = 0, 1, …, H, `S(f) (ξ² + η²)/2` \[value²\], without the noise.
    pub power: Vec<f64>,
}

/// `count` rings of independent fields and angles. `spectrum(f)` is the variance at f.
///
/// # Errors
/// Fewer disks than a ring needs; values that are not finite, from a negative or infinite spectrum.
pub fn gaussian_rings(
    settings: &SyntheticSettings,
    count: usize,
    spectrum: impl Fn(f64) -> f64,
) -> Result<Vec<SyntheticRing>, AngularError> {
    let highest = (settings.disk_count * settings.frequencies_per_disk).max(1);
    let amplitudes: Vec<f64> = (1..=highest).map(|f| (0.5 * spectrum(f as f64)).sqrt()).collect();
    let size = (2 * highest + 1).next_power_of_two();
    let mut random = Pcg64::seed_from_u64(settings.seed);
    let mut rings = Vec::with_capacity(count + 1);
    while rings.len() < count {
        // Two fields per transform: the real and the imaginary part.
        let mut buffer = vec![Complex64::ZERO; size];
        for (f, amplitude) in (1..).zip(&amplitudes) {
            buffer[f] = amplitude * normal_pair(&mut random);
            buffer[size - f] = amplitude * normal_pair(&mut random);
        }
        let sums = |f: usize| (buffer[f], buffer[size - f].conj());
        let real = (1..=highest).map(|f| 0.5 * (sums(f).0 + sums(f).1).norm_sqr());
        let imaginary = (1..=highest).map(|f| 0.5 * (sums(f).0 - sums(f).1).norm_sqr());
        let powers: [Vec<f64>; 2] =
            [std::iter::once(0.0).chain(real).collect(), std::iter::once(0.0).chain(imaginary).collect()];
        transform_in_place(&mut buffer);
        for (power, part) in powers.into_iter().zip([|z: Complex64| z.re, |z: Complex64| z.im]) {
            let places = places(settings, size, &mut random);
            let step = 2.0 * PI / size as f64;
            let angles: Vec<f64> = places.iter().map(|&place| place as f64 * step).collect();
            let values: Vec<f64> = places
                .iter()
                .map(|&place| part(buffer[place]) + settings.noise * normal_pair(&mut random).re)
                .collect();
            rings.push(SyntheticRing { ring: RingSample::new(&angles, &values)?, power });
        }
    }
    rings.truncate(count);
    Ok(rings)
}

/// Grid points with a disk.
fn places(settings: &SyntheticSettings, size: usize, random: &mut Pcg64) -> Vec<usize> {
    let gap = size as f64 / settings.disk_count as f64;
    (0..settings.disk_count)
        .map(|disk| {
            let at = match settings.layout {
                AngleLayout::Even => disk as f64 * gap,
                AngleLayout::Jittered(spread) => {
                    (disk as f64 + spread * (random.random::<f64>() - 0.5)) * gap + size as f64
                }
                AngleLayout::Random => random.random::<f64>() * size as f64,
            };
            at.round() as usize % size
        })
        .collect()
}

/// Two normal variates (Box, Muller (1958), Ann. Math. Stat. 29, 610).
fn normal_pair(random: &mut Pcg64) -> Complex64 {
    // 1 − u is never 0.
    let radius = (-2.0 * libm::log(1.0 - random.random::<f64>())).sqrt();
    let (sine, cosine) = libm::sincos(2.0 * PI * random.random::<f64>());
    Complex64::new(radius * cosine, radius * sine)
}
