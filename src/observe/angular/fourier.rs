//! Σ a_k e^(−ifθ_k) at irregular angles: term by term, or by a fast Fourier transform after spreading on a grid.
//!
//! **Direct.** e^(−ifθ) by one rotation per frequency, evaluated exactly every 64 frequencies.
//!
//! **Fast.** The strengths are spread as Gaussians on an even grid, transformed, and divided by the transform of the
//! Gaussian (Dutt, Rokhlin (1993), SIAM J. Sci. Comput. 14, 1368; parameters of Greengard, Lee (2004), SIAM Rev. 46,
//! 443).

use std::f64::consts::PI;

use num_complex::Complex64;
use rustfft::{FftPlanner, num_traits::Zero};

/// Frequencies between two exact evaluations of the rotation.
const RESTART: usize = 64;

/// Number of disks rotated in parallel lanes.
const LANES: usize = 8;

/// Grid points on either side of a disk over which it is spread. Truncation: e^(−3π·15/4) = 5·10⁻¹⁶, times e^(15π/12) =
/// 50.
const SPREAD: usize = 15;

/// Number of frequencies and of disks from which the fast method is faster: it takes 36 rotations per disk, independent
/// of the number of frequencies (`cargo bench --features measurements --bench angular`).
const FAST_FROM_FREQUENCY: usize = 40;
const FAST_FROM_DISKS: usize = 100;

/// A method to compute the sums.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Route {
    /// Term by term: n·f_max rotations.
    Direct,
    /// Spread on a grid of at least 4 f_max points and transformed.
    Fast,
}

impl Route {
    /// The faster method, by size alone.
    pub fn shorter(disk_count: usize, frequency_limit: usize) -> Self {
        if frequency_limit >= FAST_FROM_FREQUENCY && disk_count >= FAST_FROM_DISKS {
            Route::Fast
        } else {
            Route::Direct
        }
    }
}

/// Σ_k a_k e^(−ifθ_k) for f = 0, …, `frequency_limit`, by the faster method.
///
/// # Panics
/// If the numbers of strengths and angles differ.
pub fn fourier_sums(angles: &[f64], strengths: &[f64], frequency_limit: usize) -> Vec<Complex64> {
    fourier_sums_by(Route::shorter(angles.len(), frequency_limit), angles, strengths, frequency_limit)
}

/// Like [`fourier_sums`], by a given method.
///
/// # Accuracy
/// In units of Σ|a|: (2πf + 128)·2⁻⁵²; the fast method adds 5·10⁻¹⁴ (`fourier::both_routes_give_the_sums`). The
/// rounding of the angles has the same size.
///
/// # Panics
/// If the numbers of strengths and angles differ.
pub fn fourier_sums_by(route: Route, angles: &[f64], strengths: &[f64], frequency_limit: usize) -> Vec<Complex64> {
    assert_eq!(angles.len(), strengths.len(), "a strength for every angle");
    match route {
        Route::Direct => direct(angles, strengths, frequency_limit),
        Route::Fast => fast(angles, strengths, frequency_limit),
    }
}

fn direct(angles: &[f64], strengths: &[f64], frequency_limit: usize) -> Vec<Complex64> {
    let mut sums = vec![Complex64::zero(); frequency_limit + 1];
    for (angles, strengths) in angles.chunks(LANES).zip(strengths.chunks(LANES)) {
        let mut lanes = [[0.0; LANES]; 3];
        let [angle, cosine, sine] = &mut lanes;
        angle[..angles.len()].copy_from_slice(angles);
        for lane in 0..LANES {
            (sine[lane], cosine[lane]) = libm::sincos(angle[lane]);
        }
        for (block, sums) in sums.chunks_mut(RESTART).enumerate() {
            // a e^(−ifθ): real part, minus the imaginary part.
            let (mut re, mut im) = ([0.0; LANES], [0.0; LANES]);
            for (lane, strength) in strengths.iter().enumerate() {
                let (s, c) = libm::sincos((block * RESTART) as f64 * angle[lane]);
                (re[lane], im[lane]) = (strength * c, strength * s);
            }
            for sum in sums {
                *sum += Complex64::new(re.iter().sum(), -im.iter().sum::<f64>());
                for lane in 0..LANES {
                    let (a, b) = (re[lane], im[lane]);
                    re[lane] = a * cosine[lane] - b * sine[lane];
                    im[lane] = b * cosine[lane] + a * sine[lane];
                }
            }
        }
    }
    sums
}

fn fast(angles: &[f64], strengths: &[f64], frequency_limit: usize) -> Vec<Complex64> {
    let mode_count = (2 * frequency_limit + 1) as f64;
    let size = (4 * frequency_limit + 2).max(4 * SPREAD).next_power_of_two();
    let excess = size as f64 / mode_count;
    let width = PI * SPREAD as f64 / (mode_count * mode_count * excess * (excess - 0.5));
    let step = 2.0 * PI / size as f64;
    let fixed: Vec<f64> = (0..=SPREAD).map(|l| libm::exp(-(l as f64 * step).powi(2) / (4.0 * width))).collect();
    let mut grid = vec![0.0; size];
    for (angle, strength) in angles.iter().zip(strengths) {
        let nearest = (angle / step).floor();
        let rest = angle - nearest * step;
        let middle = strength * libm::exp(-rest * rest / (4.0 * width));
        let ratio = libm::exp(rest * step / (2.0 * width));
        let place = (nearest as i64).rem_euclid(size as i64) as usize;
        let (mut up, mut down) = (middle, middle);
        grid[place] += middle;
        for l in 1..=SPREAD {
            up *= ratio;
            down /= ratio;
            grid[(place + l) & (size - 1)] += up * fixed[l];
            if l < SPREAD {
                grid[(place + size - l) & (size - 1)] += down * fixed[l];
            }
        }
    }
    let mut transformed = transform(&grid);
    transformed.truncate(frequency_limit + 1);
    let scale = (PI / width).sqrt() / size as f64;
    for (f, sum) in transformed.iter_mut().enumerate() {
        *sum *= scale * libm::exp((f * f) as f64 * width);
    }
    transformed
}

/// Σ_j u_j e^(−2πifj/M) for f = 0, …, M − 1.
pub(super) fn transform(values: &[f64]) -> Vec<Complex64> {
    let mut buffer: Vec<Complex64> = values.iter().map(|&value| Complex64::new(value, 0.0)).collect();
    transform_in_place(&mut buffer);
    buffer
}

/// Like [`transform`], for complex numbers.
pub(super) fn transform_in_place(buffer: &mut [Complex64]) {
    // Without rustfft's features all processors run the same code, so the bits are the same.
    FftPlanner::new().plan_fft_forward(buffer.len()).process(buffer);
}
