//! The correlation function from all pairs of disks, by the difference of their angles.
//!
//! ```text
//! G_b = Σ_(i<j, pair in bin b) x_i x_j / (n_b ⟨x²⟩)        bin b: πb/B ≤ |θ_i − θ_j| < π(b+1)/B
//! ```

use std::f64::consts::PI;

use crate::observe::angular::ring::RingSample;

/// Sums over pairs in every bin.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PairSums {
    /// Σ x_i x_j.
    pub products: Vec<f64>,
    /// Number of pairs.
    pub counts: Vec<f64>,
}

impl PairSums {
    /// Sums without any pair.
    pub(super) fn none(bin_count: usize) -> Self {
        PairSums { products: vec![0.0; bin_count], counts: vec![0.0; bin_count] }
    }

    /// Adds one pair.
    fn add(&mut self, difference: f64, product: f64) {
        let folded = if difference > PI { 2.0 * PI - difference } else { difference };
        let count = self.counts.len();
        // A difference of π belongs to the last bin.
        let bin = ((folded * (count as f64 / PI)) as usize).min(count - 1);
        self.products[bin] += product;
        self.counts[bin] += 1.0;
    }

    /// All pairs of a ring. `centred` contains its values minus their mean.
    pub(super) fn of(ring: &RingSample, centred: &[f64], bin_count: usize) -> Self {
        let mut sums = Self::none(bin_count);
        let angles = ring.angles();
        for i in 0..angles.len() {
            for j in i + 1..angles.len() {
                sums.add(angles[j] - angles[i], centred[i] * centred[j]);
            }
        }
        sums
    }

    /// Pairs with at least one disk in a block, for every block; `block[k]` is the block of disk k.
    pub(super) fn of_blocks(
        ring: &RingSample,
        centred: &[f64],
        bin_count: usize,
        block: &[usize],
        blocks: usize,
    ) -> Vec<Self> {
        let mut sums = vec![Self::none(bin_count); blocks];
        let angles = ring.angles();
        for i in 0..angles.len() {
            for j in i + 1..angles.len() {
                let (difference, product) = (angles[j] - angles[i], centred[i] * centred[j]);
                sums[block[i]].add(difference, product);
                if block[j] != block[i] {
                    sums[block[j]].add(difference, product);
                }
            }
        }
        sums
    }

    /// Products over counts and variance; a bin without pairs takes the value of the bin before it.
    pub(super) fn correlation(&self, variance: f64) -> Vec<f64> {
        let first = if variance > 0.0 { 1.0 } else { f64::NAN };
        correlation_of_bins((&self.products, &self.counts), variance, first)
    }
}

/// Products over counts and variance; a bin without pairs takes the value of the bin before it, the first bin `first`.
pub(crate) fn correlation_of_bins((products, counts): (&[f64], &[f64]), variance: f64, first: f64) -> Vec<f64> {
    let mut last = first;
    let value = |(product, &count): (&f64, &f64)| {
        if count > 0.0 {
            last = product / count / variance;
        }
        last
    };
    products.iter().zip(counts).map(value).collect()
}
