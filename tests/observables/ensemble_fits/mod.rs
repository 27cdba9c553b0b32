//! Fits over ensembles on data whose answer is known.

mod collapses;
mod crossings;
mod laws;
mod resampling;
mod rings;
mod spectra;

use rand::RngExt;
use rand_pcg::Pcg64;

/// A normal variate (Box and Muller; 1 − u is never 0).
fn normal(random: &mut Pcg64) -> f64 {
    let (u, v) = (random.random::<f64>(), random.random::<f64>());
    (-2.0 * (1.0 - u).ln()).sqrt() * (2.0 * std::f64::consts::PI * v).cos()
}

/// How often something of this probability may happen in so many trials: within three standard deviations.
fn expected(trials: usize, probability: [f64; 2]) -> std::ops::RangeInclusive<usize> {
    let spread = |p: f64| 3.0 * (trials as f64 * p * (1.0 - p)).sqrt();
    let [low, high] = probability;
    let end = |p: f64, sign: f64| trials as f64 * p + sign * spread(p);
    end(low, -1.0).max(0.0) as usize..=end(high, 1.0).min(trials as f64) as usize
}
