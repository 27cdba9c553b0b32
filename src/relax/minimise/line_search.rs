//! How far to go along a direction, found by the work of the forces.
//!
//! ```text
//! φ(a) = E(u + a s)        −φ'(a) = F(u + a s)·s        sought: −φ'(a) ≈ 0
//! ```
//!
//! The zero of the slope is sought by secants in a bracket. A point counts as low enough if the energy has fallen by a share
//! of what the slope at the start promises; where that is less than energies can tell apart, it must not rise beyond their
//! rounding, and the slope at the end decides. So the search works down to the rounding of the forces, which lies far below
//! that of the energy.
//!
//! # Source
//! Hager, Zhang (2005), SIAM J. Optim. 16, 170, §4 (Wolfe's conditions by slopes alone where energies cannot tell).

use crate::forces::assembly::Assembly;
use crate::forces::totals::Totals;
use crate::law::pair_law::PairLaw;
use crate::packing::PackingError;
use crate::relax::column_operations::{combine, dot_product};
use crate::relax::rounding::ENERGY_ROUNDING;
use crate::vector::{dot, larger};

/// Share of the promised fall of the energy that a step must bring. Source: Nocedal, Wright (2006), §3.1.
const SUFFICIENT: f64 = 1e-4;

/// Points tried along one direction: a first one 10⁷ times too long is still brought back.
const TRIAL_LIMIT: usize = 10;

/// Most by which a length is extrapolated at once \[1\].
const GROWTH: f64 = 10.0;

/// A direction of descent.
#[derive(Debug, Clone, Copy)]
pub struct Line<'a> {
    /// s, all mobile disks.
    pub direction: &'a [f64],
    /// F·s at the start, positive.
    pub slope: f64,
    /// Length tried first.
    pub first: f64,
    /// Slope over that at the start below which a point counts as the lowest \[1\].
    pub flat: f64,
    /// Longest way of a disk over its radius \[1\].
    pub largest_step: f64,
}

/// A point found.
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

/// Goes along the line from the present state, which becomes the checkpoint. None if no point tried is low enough; the disks
/// are anywhere then. Every evaluation is counted.
pub fn search<const D: usize, L: PairLaw>(
    assembly: &mut Assembly<D, L>,
    line: &Line<'_>,
    before: &Totals<D>,
    evaluation_count: &mut usize,
) -> Result<Option<Reached<D>>, PackingError> {
    assembly.set_checkpoint();
    let (way, longest) = reach(assembly, line);
    let mut go = |assembly: &mut Assembly<D, L>, length: f64, away: bool| -> Result<Reached<D>, PackingError> {
        if away {
            assembly.restore()?;
        }
        let mobile = assembly.mobile_count();
        combine(1.0, assembly.displacements[..mobile].as_flattened_mut(), length, line.direction);
        assembly.keep_listed(length * way)?;
        *evaluation_count += 1;
        let totals = assembly.evaluate_totals();
        let slope = dot_product(assembly.forces[..mobile].as_flattened(), line.direction);
        Ok(Reached { length, slope, totals })
    };
    // The farthest point accepted before the lowest one, and the nearest one beyond.
    let (mut low, mut high): (End, Option<End>) = ((0.0, line.slope), None);
    let mut length = line.first.min(longest);
    for trial in 1..=TRIAL_LIMIT {
        let reached = go(assembly, length, trial > 1)?;
        let enough = low_enough(before, &reached, line.slope);
        let end = (length, reached.slope);
        if enough {
            let flat = reached.slope.abs() <= line.flat * line.slope;
            let at_the_end = length >= longest && reached.slope > 0.0;
            if flat || at_the_end || trial == TRIAL_LIMIT {
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

/// The zero of the slope between two points, kept off both of them; the middle where the slopes do not tell.
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

/// The zero of the slope beyond the second point, not too far.
fn beyond(first: End, second: End) -> f64 {
    let fall = first.1 - second.1;
    let secant = if fall > 0.0 { second.0 + (second.0 - first.0) * second.1 / fall } else { f64::INFINITY };
    secant.clamp(1.1 * second.0, GROWTH * second.0)
}

/// The longest way of a disk for length 1, and the length at which one has gone as far as a step may.
fn reach<const D: usize, L: PairLaw>(assembly: &Assembly<D, L>, line: &Line<'_>) -> (f64, f64) {
    let (mut way, mut share) = (0.0, 0.0);
    let disks = line.direction.as_chunks::<D>().0;
    for (&step, radius) in disks.iter().zip(assembly.radii()) {
        let squared = dot(step, step);
        way = larger(squared, way);
        share = larger(squared / (radius * radius), share);
    }
    (way.sqrt(), line.largest_step / share.sqrt())
}

fn low_enough<const D: usize>(before: &Totals<D>, reached: &Reached<D>, slope: f64) -> bool {
    acceptance([before, &reached.totals], reached.length * slope, [slope, reached.slope], SUFFICIENT).is_some()
}

/// Whether a point is low enough: its energy has fallen by a share of what was promised, or as far as energies tell not risen
/// while the slopes at both ends say that it fell. Then the fall over the promised one, 1/2 where energies cannot tell. NaN
/// fails.
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
    use crate::law::pair_law::Hookean;
    use crate::packing::{Domain, Packing};

    /// A disk pressed to the right by one at −0.9, one at 1.5 in its way and one at 3.3 beyond: at 2.4 the slope is zero too,
    /// but the energy twice that of the start. It must come to rest where nothing touches it, between 0.1 and 0.5.
    #[test]
    fn a_flat_place_beyond_a_hump_is_refused() {
        let law = Hookean { stiffness: 1.0 };
        let positions = vec![[0.0, 0.0], [-0.9, 0.0], [1.5, 0.0], [3.3, 0.0]];
        let packing = Packing::new(Domain::<2>::Open, positions, vec![0.5; 4])
            .and_then(|packing| packing.with_held(vec![false, true, true, true]))
            .expect("valid");
        let mut assembly = Assembly::new(&packing, law).expect("no coincidence");
        let before = assembly.evaluate_totals();
        let direction = [1.0, 0.0];
        // F·s = k δ = 0.1, to the rounding of 0.9.
        let slope = dot_product(assembly.forces[..1].as_flattened(), &direction);
        assert!((slope - 0.1).abs() < 1e-15);
        let line = Line { direction: &direction, slope, first: 2.4, flat: 0.1, largest_step: 100.0 };
        let mut evaluation_count = 0;
        let found = search(&mut assembly, &line, &before, &mut evaluation_count).expect("no coincidence");
        let reached = found.expect("it goes down");
        assert!((0.09..=0.51).contains(&reached.length), "{reached:?}");
        assert!(reached.totals.energy < before.energy && evaluation_count > 1, "{reached:?}");
        let place = assembly.placed(packing).centre(0);
        assert_eq!(place.0[0] + place.1[0], reached.length);
    }
}
