//! Error against run time of estimators of S(f) and G(θ) from values at irregular angles.
//!
//! ```text
//! cargo run --release --features measurements --example angular_estimators [FILE.svg]
//! ```
//!
//! Gaussian rings with S ∝ f^(−1.5) up to f = 16 n at n random angles, 60, 1000 and 4000 disks, without noise and with noise of
//! single disks of 30 % of the standard deviation. For every estimator:
//!
//! - bias and rms error of the power in three bands of f, relative to the power of the very field in the band;
//! - rms error of G(θ) at 90 angles from 2° to 180° against that of the very field (divided by the variance, noise included);
//! - rms error of θ* at G = 0.1, and how often one of both has none;
//! - time of one spectrum and of one G, the least over the rings.
//!
//! The plot has the error of G against its time.

use std::error::Error;
use std::f64::consts::PI;
use std::time::Instant;

use jamscope::observe::angular::synthetic::{SyntheticRing, SyntheticSettings, gaussian_rings};
use jamscope::observe::angular::{
    AngularCorrelation, CorrelationEstimator, CorrelationSettings, FrequencyLimit, Leakage, PowerSpectrum, RingSample,
    SpectrumEstimator, SpectrumSettings, Weights, fourier_sums,
};
use jamscope::vector::larger;
use plotters::prelude::*;

/// Disks and rings of a comparison.
const SIZES: [(usize, usize); 3] = [(60, 400), (1000, 60), (4000, 16)];

/// Steps of G, 2° each.
const STEPS: usize = 90;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "out/angular_estimators.svg".into());
    let mut marks = Vec::new();
    for noise in [0.0, 0.3] {
        for (disk_count, ring_count) in SIZES {
            compare(disk_count, ring_count, noise, &mut marks)?;
        }
    }
    if let Some(folder) = std::path::Path::new(&path).parent() {
        std::fs::create_dir_all(folder)?;
    }
    plot(&path, &marks)?;
    println!("\n{path}");
    Ok(())
}

/// Estimators of both, by name, with the highest frequency a disk.
fn estimators() -> Vec<(&'static str, Option<SpectrumEstimator>, f64)> {
    let direct = |weights, leakage| Some(SpectrumEstimator::Direct { weights, leakage });
    vec![
        ("direct, equal", direct(Weights::Equal, Leakage::Kept), 0.25),
        ("direct, equal, unmixed", direct(Weights::Equal, Leakage::Removed), 0.25),
        ("direct, gaps", direct(Weights::Gaps, Leakage::Kept), 0.25),
        ("direct, gaps, to n/2", direct(Weights::Gaps, Leakage::Kept), 0.5),
        ("direct, gaps, unmixed", direct(Weights::Gaps, Leakage::Removed), 0.25),
        ("direct, gaps, unmixed, to n/8", direct(Weights::Gaps, Leakage::Removed), 0.125),
        ("interpolated, 4 n", Some(SpectrumEstimator::Interpolated { points_per_disk: 4.0 }), 0.25),
        ("interpolated, 4 n, to 2 n", Some(SpectrumEstimator::Interpolated { points_per_disk: 4.0 }), 2.0),
        ("binned, n/2", Some(SpectrumEstimator::Binned { bins_per_disk: 0.5 }), 0.25),
        ("binned, n", Some(SpectrumEstimator::Binned { bins_per_disk: 1.0 }), 0.5),
        ("pairs, 2° bins", None, 0.0),
        ("least squares, gaps, to n/8", None, 0.125),
    ]
}

/// What a point of the plot stands for.
struct Mark {
    disk_count: usize,
    noise: bool,
    estimator: usize,
    seconds: f64,
    error: f64,
}

fn compare(
    disk_count: usize,
    ring_count: usize,
    noise_share: f64,
    marks: &mut Vec<Mark>,
) -> Result<(), Box<dyn Error>> {
    let spectrum = |f: f64| f.powf(-1.5);
    let highest = 16 * disk_count;
    let variance: f64 = (1..=highest).map(|f| spectrum(f as f64)).sum();
    let noise = noise_share * variance.sqrt();
    let settings = SyntheticSettings { disk_count, noise, seed: 7, ..SyntheticSettings::default() };
    let rings = gaussian_rings(&settings, ring_count, spectrum)?;
    let truths: Vec<Truth> = rings.iter().map(|ring| Truth::of(ring, noise)).collect();
    let n = disk_count;
    let bands = [(1, 4), (n / 32 + 1, n / 16 + 1), (n / 16 + 1, n / 8 + 1)];
    println!("\n{n} disks, noise {noise_share}, {ring_count} rings; bands {bands:?}: bias/rms of S; rms of G, θ*; µs");
    for (index, (name, estimator, share)) in estimators().into_iter().enumerate() {
        let mut line = format!("{name:<30}");
        let mut spectrum_time = f64::INFINITY;
        if share > 0.0 {
            let mut spectra = Vec::new();
            for ring in &rings {
                let start = Instant::now();
                spectra.push(spectrum_of(&ring.ring, estimator, share)?);
                spectrum_time = spectrum_time.min(start.elapsed().as_secs_f64());
            }
            for (from, to) in bands {
                let sum = |power: &[f64]| power[from..to].iter().sum::<f64>();
                let real = rings.iter().map(|ring| sum(&ring.power)).sum::<f64>() / ring_count as f64;
                let errors: Vec<f64> =
                    rings.iter().zip(&spectra).map(|(ring, s)| (sum(&s.power) - sum(&ring.power)) / real).collect();
                line += &format!(" {:>+6.3}/{:<6.3}", errors.iter().sum::<f64>() / ring_count as f64, rms(&errors));
            }
        } else {
            line += &" ".repeat(42);
        }
        let spectral = estimator;
        let estimator = CorrelationEstimator::Pairs { bin_count: STEPS };
        let settings = CorrelationSettings { estimator, step_count: STEPS, thresholds: vec![0.1] };
        let (mut errors, mut angle_errors, mut missed, mut seconds) = (Vec::new(), Vec::new(), 0, f64::INFINITY);
        for (ring, truth) in rings.iter().zip(&truths) {
            let start = Instant::now();
            let found = if share > 0.0 {
                AngularCorrelation::of_spectrum(&spectrum_of(&ring.ring, spectral, share)?, &settings)?
            } else {
                AngularCorrelation::of(&ring.ring, &settings)?
            };
            seconds = seconds.min(start.elapsed().as_secs_f64());
            for (angle, value) in found.angles.iter().zip(&found.values).skip(1) {
                errors.push(value - truth.correlation(*angle));
            }
            match (found.crossing(0.1), truth.crossing()) {
                (Some(a), Some(b)) => angle_errors.push(a - b),
                (None, None) => {}
                _ => missed += 1,
            }
        }
        let error = rms(&errors);
        line += &format!(" {error:>8.4} {:>8.4} ({missed})", rms(&angle_errors));
        let spectrum_time =
            if spectrum_time.is_finite() { format!("{:.0}", spectrum_time * 1e6) } else { "–".into() };
        println!("{line} {spectrum_time:>9} {:>9.0}", seconds * 1e6);
        marks.push(Mark { disk_count, noise: noise_share > 0.0, estimator: index, seconds, error });
    }
    Ok(())
}

/// A spectrum up to so many frequencies a disk; by least squares if no estimator is named.
fn spectrum_of(
    ring: &RingSample,
    estimator: Option<SpectrumEstimator>,
    share: f64,
) -> Result<PowerSpectrum, Box<dyn Error>> {
    let frequency_limit = FrequencyLimit::PerDisk(share);
    let settings = SpectrumSettings {
        estimator: estimator.unwrap_or(SpectrumEstimator::Direct { weights: Weights::Gaps, leakage: Leakage::Kept }),
        frequency_limit,
    };
    let mut spectrum = PowerSpectrum::of(ring, &settings)?;
    if estimator.is_none() {
        let power = least_squares(ring, spectrum.frequency_limit());
        spectrum.unresolved = spectrum.variance - power[1..].iter().sum::<f64>();
        spectrum.power = power;
    }
    Ok(spectrum)
}

/// Powers of the constant, cosines and sines that are nearest to the values, gaps as weights: the normal equations, whose
/// coefficients are Fourier sums of the weights.
fn least_squares(ring: &RingSample, limit: usize) -> Vec<f64> {
    let weights = ring.weights(Weights::Gaps);
    let sums = fourier_sums(ring.angles(), &weights, 2 * limit);
    let strengths: Vec<f64> = weights.iter().zip(ring.values()).map(|(w, x)| w * x).collect();
    let right = fourier_sums(ring.angles(), &strengths, limit);
    // Σ w cos hθ and Σ w sin hθ for h of either sign.
    let even = |h: i64| sums[h.unsigned_abs() as usize].re;
    let odd = |h: i64| -(h.signum() as f64) * sums[h.unsigned_abs() as usize].im;
    // Column 0 is the constant, then cosines, then sines.
    let size = 2 * limit + 1;
    let mode = |column: usize| if column > limit { (true, (column - limit) as i64) } else { (false, column as i64) };
    let mut rows: Vec<Vec<f64>> = (0..size)
        .map(|row| {
            let entry = |column: usize| {
                let ((sine_f, f), (sine_g, g)) = (mode(row), mode(column));
                0.5 * match (sine_f, sine_g) {
                    (false, false) => even(f - g) + even(f + g),
                    (true, true) => even(f - g) - even(f + g),
                    (false, true) => odd(f + g) + odd(g - f),
                    (true, false) => odd(f + g) + odd(f - g),
                }
            };
            let (sine, f) = mode(row);
            let sum = right[f as usize];
            (0..size).map(entry).chain([if sine { -sum.im } else { sum.re }]).collect()
        })
        .collect();
    // Symmetric and positive definite: elimination without exchanges.
    for pivot in 0..size {
        let (above, below) = rows.split_at_mut(pivot + 1);
        let first = &above[pivot];
        for row in below {
            let factor = row[pivot] / first[pivot];
            row[pivot..].iter_mut().zip(&first[pivot..]).for_each(|(a, p)| *a -= factor * p);
        }
    }
    for pivot in (0..size).rev() {
        let known: f64 = (pivot + 1..size).map(|column| rows[pivot][column] * rows[column][size]).sum();
        rows[pivot][size] = (rows[pivot][size] - known) / rows[pivot][pivot];
    }
    let amplitude = |column: usize| rows[column][size];
    let of_mode = |f: usize| 0.5 * (amplitude(f).powi(2) + amplitude(limit + f).powi(2));
    std::iter::once(amplitude(0).powi(2)).chain((1..=limit).map(of_mode)).collect()
}

/// G of the very field, on a fine grid.
struct Truth {
    values: Vec<f64>,
}

/// Points of \[0, π\] of the true G, half a bin of the pairs among them.
const FINE: usize = 4 * STEPS;

impl Truth {
    fn of(ring: &SyntheticRing, noise: f64) -> Self {
        // cos fθ at 2π-periodic multiples: f modulo 2·FINE is enough.
        let mut folded = vec![0.0; 2 * FINE];
        ring.power.iter().enumerate().for_each(|(f, power)| folded[f % (2 * FINE)] += power);
        let total = ring.power.iter().sum::<f64>() + noise * noise;
        let value = |j: usize| -> f64 {
            let cosine = |f: usize| (PI * ((f * j) % (2 * FINE)) as f64 / FINE as f64).cos();
            folded.iter().enumerate().map(|(f, power)| power * cosine(f)).sum::<f64>() / total
        };
        Truth { values: (0..=FINE).map(value).collect() }
    }

    fn correlation(&self, angle: f64) -> f64 {
        self.values[(angle / PI * FINE as f64).round() as usize]
    }

    fn crossing(&self) -> Option<f64> {
        let high = self.values.iter().position(|&value| value <= 0.1)?;
        let (a, b) = (self.values[high - 1], self.values[high]);
        Some(PI / FINE as f64 * (high as f64 - 1.0 + (a - 0.1) / (a - b)))
    }
}

fn rms(errors: &[f64]) -> f64 {
    (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt()
}

fn plot(path: &str, marks: &[Mark]) -> Result<(), Box<dyn Error>> {
    let area = SVGBackend::new(path, (900, 560)).into_drawing_area();
    area.fill(&WHITE)?;
    let range = |of: &dyn Fn(&Mark) -> f64| {
        let low = -marks.iter().map(|mark| -of(mark)).fold(f64::NEG_INFINITY, larger);
        let high = marks.iter().map(of).fold(0.0, larger);
        (0.7 * low..1.4 * high).log_scale()
    };
    let mut chart = ChartBuilder::on(&area)
        .caption("rms error of G against time: 60 (circle), 1000 (triangle), 4000 (cross) disks; pale: with noise", 15)
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(60)
        .build_cartesian_2d(range(&|mark| mark.seconds), range(&|mark| mark.error))?;
    let short = |value: &f64| format!("{value:.0e}");
    chart
        .configure_mesh()
        .x_desc("seconds")
        .y_desc("error of G")
        .x_label_formatter(&short)
        .y_label_formatter(&short)
        .draw()?;
    for (index, (name, ..)) in estimators().into_iter().enumerate() {
        let colour = Palette99::pick(index).to_rgba();
        let own = marks.iter().filter(|mark| mark.estimator == index);
        for mark in own {
            let style = colour.mix(if mark.noise { 0.4 } else { 1.0 }).stroke_width(2);
            let at = (mark.seconds, mark.error);
            match mark.disk_count {
                60 => chart.draw_series([Circle::new(at, 5, style)])?,
                1000 => chart.draw_series([TriangleMarker::new(at, 6, style)])?,
                _ => chart.draw_series([Cross::new(at, 5, style)])?,
            };
        }
        chart
            .draw_series(std::iter::empty::<Circle<(f64, f64), i32>>())?
            .label(name)
            .legend(move |(x, y)| Circle::new((x + 8, y), 4, colour.filled()));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerLeft)
        .background_style(WHITE.mix(0.8))
        .border_style(BLACK)
        .draw()?;
    area.present()?;
    Ok(())
}
