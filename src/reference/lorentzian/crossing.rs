//! Where a correlation function first falls to a threshold.

/// Where a correlation function first falls to a threshold, or the result that it never does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Crossing {
    /// At this angle \[rad\] (f†θ \[1\] in the limit f† → ∞). 0 if it is below the smallest positive number.
    At(f64),
    /// Nowhere: the threshold is below the lowest value.
    Never {
        /// The lowest value (in the limit f† → ∞ with s ≤ 2 it is 0, at infinity).
        lowest: f64,
    },
}

impl Crossing {
    /// The angle \[rad\], or f†θ \[1\] in the continuum limit, if there is one.
    pub fn angle(self) -> Option<f64> {
        match self {
            Crossing::At(angle) => Some(angle),
            Crossing::Never { .. } => None,
        }
    }
}

/// The crossing of `threshold` < 1 for a curve that starts at 1 and never rises, bracketed on an ascending grid.
pub(super) fn only_crossing(
    curve: &impl Fn(f64) -> (f64, f64),
    threshold: f64,
    grid: impl Iterator<Item = f64>,
) -> Crossing {
    let (mut before, mut lowest) = (0.0, 1.0);
    for point in grid {
        lowest = curve(point).0;
        if lowest <= threshold {
            return Crossing::At(root(curve, threshold, before, point));
        }
        before = point;
    }
    Crossing::Never { lowest }
}

/// The first crossing of `threshold` < 1 for a curve that starts at 1, bracketed on a grid.
///
/// The curve returns value and slope. Between two points of `grid`, ascending and positive, it must have at most one
/// minimum.
pub(super) fn first_crossing(
    curve: &impl Fn(f64) -> (f64, f64),
    threshold: f64,
    grid: impl Iterator<Item = f64>,
) -> Crossing {
    let mut lowest = 1.0_f64;
    let (mut before, mut falling) = (0.0, true);
    for point in grid {
        let (value, slope) = curve(point);
        let mut end = (point, value);
        if value > threshold && falling && slope > 0.0 {
            let bottom = minimum(curve, before, point);
            end = (bottom, curve(bottom).0);
        }
        if end.1 <= threshold {
            return Crossing::At(root(curve, threshold, before, end.0));
        }
        // NaN must be kept.
        if end.1 < lowest || end.1.is_nan() {
            lowest = end.1;
        }
        (before, falling) = (point, slope < 0.0);
    }
    Crossing::Never { lowest }
}

/// Where the slope changes from negative to positive.
fn minimum(curve: &impl Fn(f64) -> (f64, f64), mut low: f64, mut high: f64) -> f64 {
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return middle;
        }
        if curve(middle).1 < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
}

/// Where the curve is `threshold`, above it at `low` ≥ 0 and not above it at `high` > 0. Newton's method inside the
/// bracket, replaced by the geometric mean of the bracket if a Newton step leaves it or is slow.
fn root(curve: &impl Fn(f64) -> (f64, f64), threshold: f64, low: f64, high: f64) -> f64 {
    let (mut low, mut high) = (low, high);
    if low == 0.0 {
        // The curve may rise as any power of the angle: the bracket is found among powers of two.
        let mut halvings = 1.0;
        loop {
            low = high * libm::exp2(-halvings);
            if low == 0.0 {
                return 0.0;
            }
            if curve(low).0 > threshold {
                break;
            }
            high = low;
            halvings *= 2.0;
        }
    }
    let mut angle = low.sqrt() * high.sqrt();
    let mut last_step = f64::INFINITY;
    // Every second step at least halves the logarithm of the bracket: 10 steps for the logarithm, 53 for the digits.
    for _ in 0..200 {
        let (value, slope) = curve(angle);
        if value > threshold {
            low = angle;
        } else {
            high = angle;
        }
        let newton = angle - (value - threshold) / slope;
        let step = (newton - angle).abs();
        let next = if newton > low && newton < high && step <= 0.5 * last_step {
            last_step = step;
            newton
        } else {
            last_step = f64::INFINITY;
            low.sqrt() * high.sqrt()
        };
        if step <= f64::EPSILON * angle || next <= low || next >= high {
            return if newton >= low && newton <= high { newton } else { angle };
        }
        angle = next;
    }
    angle
}

/// Step of the search for crossings of an oscillating G, in units of 1/max(1, f†): the shortest period is 2π.
pub(super) const SCAN_STEP: f64 = 0.2;

/// Where oscillations are below e^(−45), in the same units: the first pole gives e^(−f†θ sin(π/s)).
pub(super) fn scan_end(exponent: f64) -> f64 {
    45.0 / libm::sin(std::f64::consts::PI / exponent)
}
