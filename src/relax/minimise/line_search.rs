//! The line search: how far to go along a direction, from the work of the forces.
//!
//! ```text
//! φ(a) = E(u + a s)        −φ'(a) = F(u + a s)·s        sought: −φ'(a) ≈ 0
//! ```
//!
//! Secants in a bracket locate the zero of the slope. A point is accepted if the energy has fallen by a share of the
//! fall that the initial slope predicts. If that is below the rounding of energies, the energy must not rise by more
//! than rounding, and the final slope decides. So the search works down to the rounding of the forces, which lies far
//! below that of the energy.
//!
//! # Source
//! Hager, Zhang (2005), SIAM J. Optim. 16, 170, §4 (Wolfe's conditions by slopes alone where energies cannot decide).

use crate::forces::assembly::Assembly;
use crate::forces::totals::Totals;
use crate::packing::PackingError;
use crate::relax::column_operations::combine;
use crate::relax::rounding::ENERGY_ROUNDING;
use crate::simd::lanes::dot_product;
use crate::vector::{dot, larger};

/// Share of the predicted fall of the energy that a step must reach. Source: Nocedal, Wright (2006), §3.1.
const SUFFICIENT: f64 = 1e-4;

/// Points tried along one direction. They suffice for a first one that is 10⁷ times too far.
const TRIAL_LIMIT: usize = 10;

/// Largest factor of one extrapolation of the length \[1\].
const EXTRAPOLATION: f64 = 10.0;

/// A direction of descent.
#[derive(Debug, Clone, Copy)]
pub struct Line<'a> {
    /// s, all mobile disks.
    pub direction: &'a [f64],
    /// F·s at the start, positive.
    pub slope: f64,
    /// First trial length.
    pub first: f64,
    /// Slope over the initial slope below which a point counts as the lowest \[1\].
    pub flatness: f64,
    /// Longest displacement of a disk over its radius \[1\].
    pub largest_step: f64,
}

/// The point that a search found.
#[derive(Debug, Clone, Copy)]
pub struct Reached<const D: usize> {
    /// a.
    pub length: f64,
    /// F·s there.
    pub slope: f64,
    /// Energy and contacts there.
    pub totals: Totals<D>,
}

/// Length and slope of a point.
type End = (f64, f64);

/// Searches along the line from the present state, which becomes the checkpoint. None if no point tried is accepted;
/// the positions are then undefined. Every evaluation is counted.
pub fn search<const D: usize>(
    assembly: &mut Assembly<D>,
    line: &Line<'_>,
    before: &Totals<D>,
    evaluation_count: &mut usize,
) -> Result<Option<Reached<D>>, PackingError> {
    assembly.set_checkpoint();
    let (distance, longest) = reach(assembly, line);
    let mut go = |assembly: &mut Assembly<D>, length: f64, away: bool| -> Result<Reached<D>, PackingError> {
        if away {
            assembly.restore()?;
        }
        let mobile = assembly.mobile_count();
        combine(1.0, assembly.displacements[..mobile].as_flattened_mut(), length, line.direction);
        assembly.update_list(length * distance)?;
        *evaluation_count += 1;
        let totals = assembly.evaluate_totals();
        let slope = dot_product(assembly.forces[..mobile].as_flattened(), line.direction);
        Ok(Reached { length, slope, totals })
    };
    // The farthest accepted point before the lowest one, and the nearest one beyond.
    let (mut low, mut high): (End, Option<End>) = ((0.0, line.slope), None);
    let mut length = line.first.min(longest);
    for trial in 1..=TRIAL_LIMIT {
        let reached = go(assembly, length, trial > 1)?;
        let enough = low_enough(before, &reached, line.slope);
        let end = (length, reached.slope);
        if enough {
            let is_flat = reached.slope.abs() <= line.flatness * line.slope;
            let at_the_end = length >= longest && reached.slope > 0.0;
            if is_flat || at_the_end || trial == TRIAL_LIMIT {
                return Ok(Some(reached));
            }
        }
        length = if enough && reached.slope > 0.0 {
            let next = high.map_or_else(|| beyond(low, end), |high| between(end, high));
            low = end;
            next.min(longest)
        } else {
            high = Some(end);
            between(low, end)
        };
    }
    if low.0 == 0.0 {
        return Ok(None);
    }
    let reached = go(assembly, low.0, true)?;
    Ok(low_enough(before, &reached, line.slope).then_some(reached))
}

/// The zero of the slope between two points, kept away from both. The midpoint if the slopes do not bracket a zero.
fn between(low: End, high: End) -> f64 {
    let width = high.0 - low.0;
    let secant = low.0 + width * low.1 / (low.1 - high.1);
    if !high.1.is_finite() {
        low.0 + 0.1 * width
    } else if high.1 < 0.0 {
        secant.clamp(low.0 + 0.02 * width, high.0 - 0.02 * width)
    } else {
        low.0 + 0.5 * width
    }
}

/// The zero of the slope beyond the second point, within a factor [`EXTRAPOLATION`].
fn beyond(first: End, second: End) -> f64 {
    let fall = first.1 - second.1;
    let secant = if fall > 0.0 { second.0 + (second.0 - first.0) * second.1 / fall } else { f64::INFINITY };
    secant.clamp(1.1 * second.0, EXTRAPOLATION * second.0)
}

/// The longest displacement of a disk for length 1, and the length at which the largest step is reached.
fn reach<const D: usize>(assembly: &Assembly<D>, line: &Line<'_>) -> (f64, f64) {
    let (mut distance, mut share) = (0.0, 0.0);
    let disks = line.direction.as_chunks::<D>().0;
    for (&step, radius) in disks.iter().zip(assembly.radii()) {
        let squared = dot(step, step);
        distance = larger(squared, distance);
        share = larger(squared / (radius * radius), share);
    }
    (distance.sqrt(), line.largest_step / share.sqrt())
}

fn low_enough<const D: usize>(before: &Totals<D>, reached: &Reached<D>, slope: f64) -> bool {
    acceptance([before, &reached.totals], reached.length * slope, [slope, reached.slope], SUFFICIENT).is_some()
}

/// The fall of the energy over the predicted one, if a point is accepted. Where energies cannot resolve the fall, the
/// energy must not rise by more than rounding, the slopes at both ends decide, and the result is 1/2. NaN is not
/// accepted.
pub fn acceptance<const D: usize>(
    [before, after]: [&Totals<D>; 2],
    promised: f64,
    slopes: [f64; 2],
    share: f64,
) -> Option<f64> {
    let rounding = ENERGY_ROUNDING * (before.energy_scale() + after.energy_scale());
    let fall = before.energy - after.energy;
    if 0.5 * share * promised > rounding {
        (fall >= share * promised).then_some(fall / promised)
    } else {
        (fall >= -rounding && slopes[1] >= -0.9 * slopes[0]).then_some(0.5)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::power_laws::Hookean;
    use crate::packing::{Domain, Packing};

    /// One disk at −0.9 presses the disk to the right. Further disks lie at 1.5 and 3.3. At 2.4 the slope is also zero,
    /// but the energy is twice that of the start. The disk must come to rest where nothing touches it, between 0.1 and
    /// 0.5.
    #[test]
    fn a_flat_place_beyond_a_hump_is_refused() {
        let law = Hookean { stiffness: 1.0 };
        let positions = vec![[0.0, 0.0], [-0.9, 0.0], [1.5, 0.0], [3.3, 0.0]];
        let packing = Packing::new(Domain::<2>::Open, positions, vec![0.5; 4])
            .and_then(|packing| packing.with_held(vec![false, true, true, true]))
            .expect("valid");
        let mut assembly = Assembly::new(&packing, &law).expect("no coincidence");
        let before = assembly.evaluate_totals();
        let direction = [1.0, 0.0];
        // F·s = k δ = 0.1, to the rounding of 0.9.
        let slope = dot_product(assembly.forces[..1].as_flattened(), &direction);
        assert!((slope - 0.1).abs() < 1e-15);
        let line = Line { direction: &direction, slope, first: 2.4, flatness: 0.1, largest_step: 100.0 };
        let mut evaluation_count = 0;
        let found = search(&mut assembly, &line, &before, &mut evaluation_count).expect("no coincidence");
        let reached = found.expect("it goes down");
        assert!((0.09..=0.51).contains(&reached.length), "{reached:?}");
        assert!(reached.totals.energy < before.energy && evaluation_count > 1, "{reached:?}");
        let place = assembly.placed(packing).centre(0);
        assert_eq!(place.0[0] + place.1[0], reached.length);
    }
}
