//! Values of a ring on evenly spaced angles: interpolated, or averaged in bins.
//!
//! The grid begins at the disk after the widest gap and rotates with the ring.

use std::f64::consts::PI;

use crate::observe::angular::ring::{RingSample, gaps};

/// Angles and values in the order from the disk after the widest gap. The angles are relative to that disk.
fn from_widest_gap(ring: &RingSample) -> (Vec<f64>, Vec<f64>) {
    let (angles, values) = (ring.angles(), ring.values());
    let gaps = gaps(angles);
    let widest = (0..gaps.len()).fold(0, |best, k| if gaps[k] > gaps[best] { k } else { best });
    let start = (widest + 1) % gaps.len();
    let order = (start..angles.len()).chain(0..start);
    let turn = |k: usize| if k < start { 2.0 * PI } else { 0.0 };
    order.map(|k| (angles[k] - angles[start] + turn(k), values[k])).unzip()
}

/// The piecewise linear interpolant at 2πj/`count`.
pub(super) fn interpolated(ring: &RingSample, count: usize) -> Vec<f64> {
    let (mut angles, mut values) = from_widest_gap(ring);
    angles.push(2.0 * PI);
    values.push(values[0]);
    let mut next = 1;
    (0..count)
        .map(|j| {
            let at = 2.0 * PI * j as f64 / count as f64;
            while next < angles.len() - 1 && angles[next] <= at {
                next += 1;
            }
            let (low, high) = (angles[next - 1], angles[next]);
            // The interval is empty only if several disks share the last angle.
            let share = if high > low { ((at - low) / (high - low)).clamp(0.0, 1.0) } else { 0.0 };
            values[next - 1] + share * (values[next] - values[next - 1])
        })
        .collect()
}

/// Means in bins around 2πj/`count`; an empty bin is interpolated linearly between the nearest bins that are not empty.
pub(super) fn binned(ring: &RingSample, count: usize) -> Vec<f64> {
    let (angles, values) = from_widest_gap(ring);
    let mut sums = vec![(0.0, 0usize); count];
    for (angle, value) in angles.iter().zip(&values) {
        let bin = (angle * count as f64 / (2.0 * PI)).round() as usize % count;
        sums[bin].0 += value;
        sums[bin].1 += 1;
    }
    // Bin 0 contains the first disk.
    let mut means: Vec<f64> = sums.iter().map(|&(sum, disks)| sum / disks as f64).collect();
    let mut last = 0;
    for bin in 1..=count {
        let here = means[bin % count];
        if bin < count && sums[bin].1 == 0 {
            continue;
        }
        let width = (bin - last) as f64;
        for empty in last + 1..bin {
            let share = (empty - last) as f64 / width;
            means[empty] = (1.0 - share) * means[last] + share * here;
        }
        last = bin;
    }
    means
}
