//! [`SpectralWindow`]: the expected power of sums over irregular angles, for a given spectrum.
//!
//! Let d_r = Σ_g a_g cos(gθ + φ_g) with random phases, S_g = ⟨a_g²⟩/2, plus independent values of single disks with
//! variance ρ. The expected power P_f = 2|Σ w_k (x_k − m) e^(−ifθ_k)|², m = Σ w_k x_k, Σ w_k = 1, is
//!
//! ```text
//! ⟨P_f⟩ = Σ_g K_fg S_g + ρ N_f                         W(h) = Σ w_k e^(ihθ_k),  W₂(h) = Σ w_k² e^(ihθ_k)
//! K_fg = |W(f−g) − W(f) W̄(g)|² + |W(f+g) − W(f) W(g)|²
//! N_f  = 2 [Σ w² (1 + |W(f)|²) − 2 Re W(f) W̄₂(f)]
//! ```
//!
//! At evenly spaced angles K is the identity below n/2. K − 1 and N describe the leakage. The angles are arbitrary.
//! Source: for even spacing with gaps, Sykulski, Olhede, Guillaumin, Lilly, Early (2019), Biometrika 106, 251 (the
//! debiased Whittle likelihood); for the sphere, Hivon et al. (2002), Astrophys. J. 567, 2 (K is their coupling
//! matrix).

use num_complex::Complex64;

use crate::observe::angular::fourier::fourier_sums;
use crate::observe::angular::ring::{RingSample, Weights};
use crate::simd::lanes::dot_product;

/// Relative width of the bands of source frequencies above the highest f: S changes by 3 % within a band.
const BAND_WIDTH: f64 = 0.02;

/// The coupling of spectrum and power at the angles of a ring.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectralWindow {
    /// Highest f.
    frequency_limit: usize,
    /// Sources: single frequencies up to a little above the highest f, then bands.
    bands: Vec<Band>,
    /// K_fg summed over each band; row f − 1.
    coupling: Vec<f64>,
    /// N_f, f = 1, …
    white: Vec<f64>,
}

/// A frequency, or the representative of a band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Source {
    /// g, or the middle of a band \[1\].
    pub frequency: f64,
    /// Number of frequencies that it represents.
    pub count: f64,
}

/// A group of neighbouring frequencies.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Band {
    first: usize,
    last: usize,
}

impl Band {
    /// The representative frequency.
    fn middle(self) -> f64 {
        if self.first == self.last {
            self.first as f64
        } else {
            (self.first as f64 - 0.5).sqrt() * (self.last as f64 + 0.5).sqrt()
        }
    }

    fn count(self) -> f64 {
        (self.last - self.first + 1) as f64
    }

    /// Bands from `next` to `last`; single frequencies up to `single`.
    fn all(next: usize, single: usize, last: usize) -> Vec<Self> {
        let mut bands = Vec::new();
        let mut first = next;
        while first <= last {
            let width = if first <= single { 1 } else { ((first as f64 * BAND_WIDTH) as usize).max(1) };
            let end = (first + width - 1).min(last);
            bands.push(Band { first, last: end });
            first = end + 1;
        }
        bands
    }
}

impl SpectralWindow {
    /// The window of a ring for f = 1, …, `frequency_limit`, with sources g up to `source_limit` ≥ `frequency_limit`.
    ///
    /// # Cost
    /// `frequency_limit` × `source_limit` couplings; one Fourier sum.
    pub fn new(ring: &RingSample, weights: Weights, frequency_limit: usize, source_limit: usize) -> Self {
        let source_limit = source_limit.max(frequency_limit);
        let bands = Band::all(1, frequency_limit + frequency_limit / 4, source_limit);
        let counts = ring.weights(weights);
        let squares: Vec<f64> = counts.iter().map(|w| w * w).collect();
        let sums = fourier_sums(ring.angles(), &counts, frequency_limit + source_limit);
        let square_sums = fourier_sums(ring.angles(), &squares, frequency_limit);
        let total = square_sums[0].re;
        let mut coupling = Vec::with_capacity(frequency_limit * bands.len());
        let mut white = Vec::with_capacity(frequency_limit);
        for f in 1..=frequency_limit {
            let at = sums[f];
            let one = |g: usize| {
                let below: Complex64 = if f >= g { sums[f - g] } else { sums[g - f].conj() };
                (below - at * sums[g].conj()).norm_sqr() + (sums[f + g] - at * sums[g]).norm_sqr()
            };
            coupling.extend(bands.iter().map(|band| (band.first..=band.last).map(one).sum::<f64>()));
            white.push(2.0 * (total * (1.0 + at.norm_sqr()) - 2.0 * (at * square_sums[f].conj()).re));
        }
        SpectralWindow { frequency_limit, bands, coupling, white }
    }

    /// Highest f.
    pub fn frequency_limit(&self) -> usize {
        self.frequency_limit
    }

    /// N_f for f = 1, … \[1\]: the expected power of independent values of single disks, over their variance.
    pub fn white(&self) -> &[f64] {
        &self.white
    }

    /// Σ_g K_fg S_g for f = 1, …, of a spectrum up to `highest`.
    ///
    /// Sources beyond those of the window count as independent values of single disks, a good approximation at
    /// irregular angles.
    pub fn expected(&self, spectrum: impl Fn(f64) -> f64, highest: usize) -> Vec<f64> {
        let sources = self.sources(highest);
        self.expected_from(&sources, &sources.iter().map(|source| spectrum(source.frequency)).collect::<Vec<_>>())
    }

    /// The frequencies at which a spectrum up to `highest` must be known.
    pub fn sources(&self, highest: usize) -> Vec<Source> {
        let last = self.bands.last().map_or(0, |band| band.last);
        let beyond = Band::all(last + 1, 0, highest);
        let source = |band: &Band| Source { frequency: band.middle(), count: band.count() };
        self.bands.iter().chain(&beyond).map(source).collect()
    }

    /// Σ_g K_fg S_g of a spectrum known at [`sources`](Self::sources).
    ///
    /// # Panics
    /// If there are fewer sources than the window has.
    pub fn expected_from(&self, sources: &[Source], power: &[f64]) -> Vec<f64> {
        let own = self.bands.len();
        let beyond: f64 = sources[own..].iter().zip(&power[own..]).map(|(source, power)| source.count * power).sum();
        let rows = self.coupling.chunks_exact(own);
        rows.zip(&self.white).map(|(row, white)| dot_product(row, &power[..own]) + beyond * white).collect()
    }

    /// K_fg of single frequencies: f and g from 1 to the limit.
    pub(super) fn coupling(&self, f: usize, g: usize) -> f64 {
        self.coupling[(f - 1) * self.bands.len() + g - 1]
    }
}
