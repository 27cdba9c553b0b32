//! [`collapse`]: the exponents for which curves of several sizes collapse.

use crate::fit::ensemble::collapse_quality::{CollapseQuality, Curve, Curves};
use crate::fit::ensemble::error::EnsembleFitError;
use crate::fit::search::minimum;

/// Final step of the search, as a share of a range.
const STEP_LIMIT: f64 = 1e-7;

/// The rise of S that defines the rough interval.
const RISE: f64 = 1.0;

/// Number of points of the grid in which the ends of that interval are located.
const INTERVAL_POINTS: u32 = 100;

/// Settings of the search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CollapseSettings<const K: usize> {
    /// Lowest and highest value of every exponent \[1\].
    pub ranges: [[f64; 2]; K],
    /// Number of points of the grid along every range, at least 3. Changes results only if S has several minima.
    pub grid_points: usize,
    /// Minimum share of points that can be compared with other curves \[1\]. Exponents with a smaller share, or with
    /// disconnected groups of curves, are excluded: there S is small because few points contribute.
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
    /// S at these exponents, and the number of points.
    pub quality: CollapseQuality,
    /// Where S has risen by 1 along each exponent, with the others fixed \[1\]. This is a common rough bound, not a
    /// confidence interval; it is too narrow if exponents are correlated.
    pub rough: [[Option<f64>; 2]; K],
}

/// The result for the exponents.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CollapseOutcome<const K: usize> {
    /// The minimum of S is inside the ranges.
    Found(Collapse<K>),
    /// At no exponents in the ranges can enough points be compared with other curves.
    NoOverlap {
        /// The largest such share on the grid.
        largest_share: f64,
    },
    /// The minimum of S is at the end of a range.
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

/// The exponents at the minimum of S, [`collapse_quality`](crate::fit::ensemble::collapse_quality).
///
/// S is computed on a grid. A pattern search then starts from its lowest point: it moves to the best of the 3^K − 1
/// neighbours, or halves the step. S is discontinuous where a point gains or loses its neighbours; a search by values
/// tolerates this.
///
/// For errors of the exponents use [`bootstrap_all`](crate::fit::ensemble::bootstrap_all) over samples, with an
/// estimate that recomputes the curves and calls this function.
///
/// # Errors
/// See [`collapse_quality`](crate::fit::ensemble::collapse_quality); a range that is empty or not finite, fewer than 3
/// points of the grid or more than 10⁶ in total, a share not in (0, 1], K = 0.
///
/// # Cost
/// Evaluations of S: the grid, 3^K − 1 per step of the search, and a one-dimensional search per rough bound.
///
/// # Source
/// Pattern search: Hooke, Jeeves (1961), J. ACM 8, 212, without the pattern moves.
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
            // Larger than any S, but finite: the interval ends where too few points are left.
            value(moved).min(1e300)
        };
        let [low, high] = settings.ranges[k];
        let half = INTERVAL_POINTS / 2;
        let below = (0..half).map(|i| low + (exponents[k] - low) * f64::from(i) / f64::from(half));
        let above = (1..=half).map(|i| exponents[k] + (high - exponents[k]) * f64::from(i) / f64::from(half));
        let grid: Vec<f64> = below.chain(std::iter::once(exponents[k])).chain(above).collect();
        let found = minimum(&grid, RISE, &along);
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

    /// One of the 3^K neighbours of a point at a distance of `share` of the ranges, kept within them.
    fn neighbour(&self, exponents: [f64; K], share: f64, mut index: usize) -> [f64; K] {
        std::array::from_fn(|k| {
            let step = (index % 3) as f64 - 1.0;
            index /= 3;
            let [low, high] = self.ranges[k];
            (exponents[k] + step * share * (high - low)).clamp(low, high)
        })
    }
}
