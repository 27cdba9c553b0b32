//! [`collapse`]: the exponents with which curves of several sizes lie on one.

use crate::fit::ensemble::error::EnsembleFitError;
use crate::fit::ensemble::quality::{CollapseQuality, Curve, Curves};
use crate::fit::search::minimum;

/// The search ends at this share of a range.
const STEP_LIMIT: f64 = 1e-7;

/// The rise of S of the rough interval.
const RISE: f64 = 1.0;

/// Points of the grid on which the ends of that interval are looked for.
const INTERVAL_POINTS: u32 = 100;

/// How exponents are searched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CollapseSettings<const K: usize> {
    /// Lowest and highest value of every exponent \[1\].
    pub ranges: [[f64; 2]; K],
    /// Points of the grid along every range, at least 3. Changes results only where S has several minima.
    pub grid_points: usize,
    /// Exponents at which fewer than this share of all points have others to be held against, or curves fall into groups that do
    /// not touch, are left out: where curves are torn apart, S is small for want of points \[1\].
    pub least_share: f64,
}

impl<const K: usize> Default for CollapseSettings<K> {
    /// From −3 to 3; 31 points; half of the points.
    fn default() -> Self {
        CollapseSettings { ranges: [[-3.0, 3.0]; K], grid_points: 31, least_share: 0.5 }
    }
}

/// The best collapse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Collapse<const K: usize> {
    /// The exponents \[1\].
    pub exponents: [f64; K],
    /// S there, and of how many points.
    pub quality: CollapseQuality,
    /// Where S has risen by 1 along every exponent, the others as they are: the usual rough bound, no confidence interval, and too
    /// narrow where exponents may make up for each other \[1\].
    pub rough: [[Option<f64>; 2]; K],
}

/// What curves say of the exponents.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CollapseOutcome<const K: usize> {
    /// S has its least value inside the ranges.
    Found(Collapse<K>),
    /// Nowhere in the ranges do enough points have others to be held against.
    NoOverlap {
        /// The largest share that have, on the grid.
        largest_share: f64,
    },
    /// S is least at the end of a range.
    AtEdge {
        /// Index of that exponent.
        exponent: usize,
        /// The exponents \[1\].
        exponents: [f64; K],
        /// S there.
        quality: CollapseQuality,
    },
}

impl<const K: usize> CollapseOutcome<K> {
    /// The exponents, if they are found.
    pub fn exponents(&self) -> Option<[f64; K]> {
        match self {
            CollapseOutcome::Found(found) => Some(found.exponents),
            _ => None,
        }
    }
}

/// The exponents of the least S, [`collapse_quality`](crate::fit::ensemble::collapse_quality).
///
/// S on a grid, then a pattern search from its lowest point: to the best of the 3^K − 1 neighbours, or half the step. S jumps where
/// a point gains or loses its neighbours; a search by values bears that.
///
/// Errors of the exponents: [`bootstrap_all`](crate::fit::ensemble::bootstrap_all) over samples, with an estimate that makes the
/// curves anew and calls this.
///
/// # Errors
/// As [`collapse_quality`](crate::fit::ensemble::collapse_quality); a range that is empty or not finite, fewer than 3 points of the
/// grid or more than 10⁶ in all, a share not in (0, 1], K = 0.
///
/// # Cost
/// So many S: the grid, 3^K − 1 a round of the search, and a one-dimensional search a rough bound.
///
/// # Source
/// The pattern search: Hooke, Jeeves (1961), J. ACM 8, 212, without its moves along a pattern.
///
/// # Example
/// ```
/// use jamscope::fit::ensemble::{CollapseSettings, Curve, MeasuredPoint, collapse};
/// let curves = [256.0, 1024.0, 4096.0].map(|size: f64| {
///     let point = |i: i32| {
///         let u = 0.1 * f64::from(i);
///         MeasuredPoint { x: u.exp() * size.powf(-0.5), y: u.tanh(), error: 0.01 }
///     };
///     Curve { scales: [size.ln()], points: (-30..=30).map(point).collect() }
/// });
/// let found = collapse(&curves, &CollapseSettings::default())?;
/// assert!((found.exponents().expect("a collapse")[0] - 0.5).abs() < 1e-3);
/// # Ok::<(), jamscope::fit::ensemble::EnsembleFitError>(())
/// ```
pub fn collapse<const K: usize>(
    curves: &[Curve<K>],
    settings: &CollapseSettings<K>,
) -> Result<CollapseOutcome<K>, EnsembleFitError> {
    settings.check()?;
    let curves = Curves::of(curves)?;
    let mut largest_share = 0.0f64;
    let enough = |exponents: [f64; K]| {
        curves.quality(exponents).filter(|found| found.connected && found.share() >= settings.least_share)
    };
    let value = |exponents: [f64; K]| enough(exponents).map_or(f64::INFINITY, |found| found.quality);
    let mut best: Option<([f64; K], f64)> = None;
    for index in 0..settings.grid_points.pow(K as u32) {
        let exponents = settings.grid_point(index);
        let Some(found) = curves.quality(exponents) else { continue };
        largest_share = largest_share.max(found.share());
        if found.connected
            && found.share() >= settings.least_share
            && best.is_none_or(|(_, lowest)| found.quality < lowest)
        {
            best = Some((exponents, found.quality));
        }
    }
    let Some((mut exponents, mut lowest)) = best else { return Ok(CollapseOutcome::NoOverlap { largest_share }) };
    let mut share = 0.5 / (settings.grid_points - 1) as f64;
    while share > STEP_LIMIT {
        let neighbours = (0..3usize.pow(K as u32)).map(|index| settings.neighbour(exponents, share, index));
        let next =
            neighbours.map(|near| (near, value(near))).fold((exponents, lowest), |a, b| if b.1 < a.1 { b } else { a });
        if next.1 < lowest {
            (exponents, lowest) = next;
        } else {
            share *= 0.5;
        }
    }
    let Some(quality) = enough(exponents) else { return Ok(CollapseOutcome::NoOverlap { largest_share }) };
    for (exponent, (at, [low, high])) in exponents.iter().zip(settings.ranges).enumerate() {
        let margin = 2.0 * STEP_LIMIT * (high - low);
        if at - low <= margin || high - at <= margin {
            return Ok(CollapseOutcome::AtEdge { exponent, exponents, quality });
        }
    }
    let rough = std::array::from_fn(|k| {
        let along = |at: f64| {
            let mut moved = exponents;
            moved[k] = at;
            // Beyond all S, but a number: where too few points are left the interval ends.
            value(moved).min(1e300)
        };
        let [low, high] = settings.ranges[k];
        let half = INTERVAL_POINTS / 2;
        let below = (0..half).map(|i| low + (exponents[k] - low) * f64::from(i) / f64::from(half));
        let above = (1..=half).map(|i| exponents[k] + (high - exponents[k]) * f64::from(i) / f64::from(half));
        let grid: Vec<f64> = below.chain(std::iter::once(exponents[k])).chain(above).collect();
        let found = minimum(&grid, RISE, along);
        [found.lower, found.upper]
    });
    Ok(CollapseOutcome::Found(Collapse { exponents, quality, rough }))
}

impl<const K: usize> CollapseSettings<K> {
    fn check(&self) -> Result<(), EnsembleFitError> {
        let refuse = |setting, value| Err(EnsembleFitError::SettingOutOfRange { setting, value });
        for [low, high] in self.ranges {
            if !(low.is_finite() && high.is_finite() && (high - low) > 0.0 && (high - low).is_finite()) {
                return refuse("ranges", high - low);
            }
        }
        if !(self.least_share > 0.0 && self.least_share <= 1.0) {
            return refuse("least_share", self.least_share);
        }
        let all = (self.grid_points as f64).powi(K as i32);
        if K == 0 || self.grid_points < 3 || all > 1e6 {
            return refuse("grid_points", self.grid_points as f64);
        }
        Ok(())
    }

    /// The exponents at an index of the grid.
    fn grid_point(&self, mut index: usize) -> [f64; K] {
        self.ranges.map(|[low, high]| {
            let step = index % self.grid_points;
            index /= self.grid_points;
            low + (high - low) * step as f64 / (self.grid_points - 1) as f64
        })
    }

    /// One of the 3^K points about another at a share of the ranges, held within them.
    fn neighbour(&self, exponents: [f64; K], share: f64, mut index: usize) -> [f64; K] {
        std::array::from_fn(|k| {
            let step = (index % 3) as f64 - 1.0;
            index /= 3;
            let [low, high] = self.ranges[k];
            (exponents[k] + step * share * (high - low)).clamp(low, high)
        })
    }
}
