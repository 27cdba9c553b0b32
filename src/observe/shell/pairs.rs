//! The correlation function from all pairs of spheres, by the angle between them.
//!
//! ```text
//! G_b = Σ_(i<j, pair in bin b) δ_i δ_j/(n_b V)        bin b: πb/B ≤ γ_ij < π(b+1)/B
//! cap: G = a + c (1 + cos γ) by least squares over the pairs with γ ≥ π − w, a = G(π)
//! ```

use std::f64::consts::PI;

use crate::observe::angular::correlation_of_bins;
use crate::observe::shell::sample::ShellSample;
use crate::vector::{Vector, dot};

/// Blocks of the jackknife: the neighbourhoods of the twelve vertices of an icosahedron, of equal area and shape.
pub(super) const BLOCK_COUNT: usize = 12;

/// Sums over pairs in every bin and in the cap around γ = π.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PairSums {
    /// Σ δ_i δ_j.
    pub products: Vec<f64>,
    /// Number of pairs.
    pub counts: Vec<f64>,
    /// Σ 1, Σ u, Σ u², Σ δδ, Σ u δδ in the cap, u = 1 + cos γ.
    pub cap: [f64; 5],
}

/// Sums over all pairs, and for every block over the pairs with at least one sphere in it.
pub(super) struct AllPairs {
    pub all: PairSums,
    pub blocks: Vec<PairSums>,
    /// Σ δ² and number of the spheres of every block.
    pub squares: Vec<[f64; 2]>,
}

impl PairSums {
    fn none(bin_count: usize) -> Self {
        PairSums { products: vec![0.0; bin_count], counts: vec![0.0; bin_count], cap: [0.0; 5] }
    }

    fn add(&mut self, bin: usize, product: f64, height: Option<f64>) {
        self.products[bin] += product;
        self.counts[bin] += 1.0;
        if let Some(u) = height {
            let terms = [1.0, u, u * u, product, u * product];
            self.cap.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
        }
    }

    /// These pairs without others.
    pub(super) fn without(&self, other: &Self) -> Self {
        let minus = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect();
        let cap = std::array::from_fn(|k| self.cap[k] - other.cap[k]);
        PairSums { products: minus(&self.products, &other.products), counts: minus(&self.counts, &other.counts), cap }
    }

    /// Products over counts and variance; a bin without pairs takes the value of the bin before it, the first that of
    /// γ = 0.
    pub(super) fn correlation(&self, variance: f64) -> Vec<f64> {
        correlation_of_bins((&self.products, &self.counts), variance, 1.0)
    }

    /// G(π) by the straight line in the cap; none with fewer than two angles in it.
    pub(super) fn opposite(&self, variance: f64) -> Option<f64> {
        let [count, u, uu, p, up] = self.cap;
        let determinant = count * uu - u * u;
        (count >= 2.0 && determinant > 1e-9 * count * uu).then(|| (uu * p - u * up) / determinant / variance)
    }
}

impl AllPairs {
    /// All pairs of a shell.
    pub(super) fn of(shell: &ShellSample, bin_count: usize, cap: f64) -> Self {
        let (directions, values) = (shell.directions(), shell.fluctuations());
        let block: Vec<usize> = directions.iter().map(|&direction| block_of(direction)).collect();
        let mut all = PairSums::none(bin_count);
        let mut blocks = vec![all.clone(); BLOCK_COUNT];
        let mut squares = vec![[0.0; 2]; BLOCK_COUNT];
        let (per_angle, highest) = (bin_count as f64 / PI, 1.0 - libm::cos(cap));
        for i in 0..directions.len() {
            let square = &mut squares[block[i]];
            *square = [square[0] + values[i] * values[i], square[1] + 1.0];
            for j in i + 1..directions.len() {
                let cosine = dot(directions[i], directions[j]).clamp(-1.0, 1.0);
                let product = values[i] * values[j];
                // γ = π belongs to the last bin.
                let bin = ((libm::acos(cosine) * per_angle) as usize).min(bin_count - 1);
                let height = (1.0 + cosine <= highest).then_some(1.0 + cosine);
                all.add(bin, product, height);
                blocks[block[i]].add(bin, product, height);
                if block[j] != block[i] {
                    blocks[block[j]].add(bin, product, height);
                }
            }
        }
        AllPairs { all, blocks, squares }
    }
}

/// The nearest vertex of an icosahedron.
fn block_of(direction: Vector<3>) -> usize {
    // The golden ratio: the vertices are (0, ±1, ±g) and their cyclic permutations.
    let golden = 0.5 * (1.0 + 5f64.sqrt());
    let mut nearest = (0, f64::NEG_INFINITY);
    for axis in 0..3 {
        for signs in 0..4 {
            let sign = |bit: usize| if signs & bit == 0 { 1.0 } else { -1.0 };
            let height = sign(1) * direction[(axis + 1) % 3] + sign(2) * golden * direction[(axis + 2) % 3];
            if height > nearest.1 {
                nearest = (4 * axis + signs, height);
            }
        }
    }
    nearest.0
}

/// The middle of every bin, weighted by the solid angle: ∫ γ sin γ dγ/∫ sin γ dγ.
pub(super) fn middles(bin_count: usize) -> Vec<f64> {
    let edge = |bin: usize| PI * bin as f64 / bin_count as f64;
    // About the middle m, with h half of the width: ∫ sin = 2 sin m sin h and ∫ (γ − m) sin γ = 2 cos m (sin h − h cos h).
    let half = 0.5 * edge(1);
    let shift = |middle: f64| {
        let (sine, cosine) = libm::sincos(half);
        let (s, c) = libm::sincos(middle);
        (sine - half * cosine) / sine * c / s
    };
    (0..bin_count).map(|bin| 0.5 * (edge(bin) + edge(bin + 1))).map(|middle| middle + shift(middle)).collect()
}
