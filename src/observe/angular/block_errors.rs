//! [`block_errors`]: standard errors of G from blocks of one ring.
//!
//! ```text
//! σ²(θ) = (B − 1)/B Σ_b (G_(−b)(θ) − Ḡ(θ))²        G_(−b): all pairs but those with a disk in block b
//! ```
//!
//! The jackknife over B blocks of neighbouring disks. It measures the scatter of G between parts of the ring. This is
//! the error if correlations are much shorter than a block, 2π/B. It does not include the scatter of the amplitudes of
//! f = 1, 2, …, of which one ring has a single value each, and so not that of G near π and of G*. These errors come
//! from samples ([`correlation_statistics`](crate::observe::angular::correlation_statistics)).
//! Source: Künsch (1989), Ann. Stat. 17, 1217 (the jackknife of blocks).

use serde::Serialize;

use crate::observe::angular::error::AngularError;
use crate::observe::angular::pairs::PairSums;
use crate::observe::angular::ring::{RingSample, Weights};

/// Minimum number of blocks for an estimate of their scatter.
const LEAST_BLOCK_COUNT: usize = 4;

/// G from pairs, with standard errors from the scatter between blocks.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BlockErrors {
    /// Number of blocks.
    pub block_count: usize,
    /// Middles of the bins \[rad\].
    pub angles: Vec<f64>,
    /// G of all pairs \[1\].
    pub values: Vec<f64>,
    /// Its standard errors by the jackknife \[1\].
    pub standard_errors: Vec<f64>,
}

/// G of pairs in `bin_count` bins of \[0, π\], and its scatter between `block_count` blocks with equal numbers of
/// disks.
///
/// # Errors
/// Fewer than 4 blocks, or more than a fourth of the number of disks; no bins.
pub fn block_errors(ring: &RingSample, bin_count: usize, block_count: usize) -> Result<BlockErrors, AngularError> {
    let disk_count = ring.disk_count();
    if block_count < LEAST_BLOCK_COUNT || block_count > disk_count / 4 {
        return Err(AngularError::BlockCountOutOfRange { block_count, disk_count });
    }
    if bin_count == 0 {
        return Err(AngularError::NotPositive { setting: "bins", value: 0.0 });
    }
    let centred = ring.centred(&ring.weights(Weights::Equal));
    let block: Vec<usize> = (0..disk_count).map(|disk| disk * block_count / disk_count).collect();
    let all = PairSums::of(ring, &centred.values, bin_count);
    let parts = PairSums::of_blocks(ring, &centred.values, bin_count, &block, block_count);
    let without: Vec<Vec<f64>> = parts
        .iter()
        .enumerate()
        .map(|(left_out, part)| {
            let rest = PairSums {
                products: all.products.iter().zip(&part.products).map(|(a, b)| a - b).collect(),
                counts: all.counts.iter().zip(&part.counts).map(|(a, b)| a - b).collect(),
            };
            let kept = || (0..disk_count).filter(|&disk| block[disk] != left_out);
            let variance = kept().map(|disk| centred.values[disk].powi(2)).sum::<f64>() / kept().count() as f64;
            rest.correlation(variance)
        })
        .collect();
    let blocks = block_count as f64;
    let standard_errors = (0..bin_count).map(|bin| {
        let mean = without.iter().map(|values| values[bin]).sum::<f64>() / blocks;
        let square: f64 = without.iter().map(|values| (values[bin] - mean).powi(2)).sum();
        ((blocks - 1.0) / blocks * square).sqrt()
    });
    Ok(BlockErrors {
        block_count,
        angles: (0..bin_count).map(|bin| std::f64::consts::PI * (bin as f64 + 0.5) / bin_count as f64).collect(),
        values: all.correlation(centred.variance),
        standard_errors: standard_errors.collect(),
    })
}
