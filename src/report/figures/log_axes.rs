//! [`LogAxis`], [`LinearAxis`]: logarithmic axes over whole decades or between two values, linear axes, and their
//! drawing.

use std::fmt::Write as _;

use crate::report::figures::{HEIGHT, INK, WIDTH};
use crate::report::number::{significant, superscript};

/// Positions of the ends of the axes \[px\].
pub(crate) const LEFT: f64 = 66.0;
pub(crate) const RIGHT: f64 = WIDTH as f64 - 14.0;
pub(crate) const TOP: f64 = 96.0;
pub(crate) const BOTTOM: f64 = HEIGHT as f64 - 50.0;

/// Font size of all text \[px\].
pub(crate) const FONT_SIZE: u32 = 13;

/// Largest number of decades below the largest value; smaller values, including zero, are drawn at the lower end.
#[cfg(feature = "linear")]
const MOST_DECADES: i32 = 16;

/// Largest number of labels of an axis.
const MOST_LABELS: i32 = 8;

/// Largest number of labels of a linear axis.
const LINEAR_LABELS: f64 = 7.0;

/// Largest number of decades for which ticks from 2 to 9 are drawn.
const FINE_DECADES: f64 = 4.5;

/// Largest number of decades for which 2 and 5 have labels.
const LABELLED_DECADES: f64 = 2.0;

/// A logarithmic axis.
pub(crate) struct LogAxis {
    /// log₁₀ of its ends.
    range: [f64; 2],
    /// Positions of its ends \[px\].
    ends: [f64; 2],
}

impl LogAxis {
    /// Over the whole decades of the positive values among these; none without positive values.
    #[cfg(feature = "linear")]
    pub(crate) fn over(values: impl Iterator<Item = f64>, ends: [f64; 2]) -> Option<Self> {
        let (low, high) = values
            .filter(|&value| value > 0.0)
            .fold((f64::INFINITY, 0.0f64), |(low, high), value| (low.min(value), high.max(value)));
        if high == 0.0 || !high.is_finite() {
            return None;
        }
        let last = libm::log10(high).ceil() as i32;
        let first = (libm::log10(low).floor() as i32).min(last - 1).max(last - MOST_DECADES);
        Some(LogAxis { range: [f64::from(first), f64::from(last)], ends })
    }

    /// From one value to another, both above zero.
    pub(crate) fn between(low: f64, high: f64, ends: [f64; 2]) -> Self {
        LogAxis { range: [libm::log10(low), libm::log10(high)], ends }
    }

    /// Position of a value \[px\].
    pub(crate) fn place(&self, value: f64) -> f64 {
        // Values that are not positive are at the lower end.
        let share = (libm::log10(value.max(0.0)) - self.range[0]) / (self.range[1] - self.range[0]);
        self.ends[0] + share.clamp(0.0, 1.0) * (self.ends[1] - self.ends[0])
    }

    /// Whether a value lies on the axis.
    pub(crate) fn holds(&self, value: f64) -> bool {
        value > 0.0 && (self.range[0]..=self.range[1]).contains(&libm::log10(value))
    }

    /// Labels and their positions.
    fn labels(&self) -> Vec<(String, f64)> {
        let decades = self.range[1] - self.range[0];
        let [first, last] = [self.range[0].ceil() as i32, self.range[1].floor() as i32];
        let stride = ((last - first + MOST_LABELS - 1) / MOST_LABELS).max(1);
        let steps: &[i32] = if decades <= LABELLED_DECADES { &[1, 2, 5] } else { &[1] };
        let mut labels = Vec::new();
        for power in (first - 1..=last).filter(|power| (last - power) % stride == 0) {
            for &step in steps {
                let value = f64::from(step) * 10f64.powi(power);
                // Rounding of the logarithm must not exclude the label of an end.
                let inside = (self.range[0] - 1e-9..=self.range[1] + 1e-9).contains(&libm::log10(value));
                let plain = steps.len() > 1 && (0..4).contains(&power);
                let text = match step {
                    _ if plain => format!("{value}"),
                    1 => format!("10{}", superscript(power)),
                    _ => format!("{step}·10{}", superscript(power)),
                };
                if inside {
                    labels.push((text, self.place(value)));
                }
            }
        }
        labels
    }

    /// Positions of the ticks between powers of ten; none on a long axis.
    fn fine_ticks(&self) -> Vec<f64> {
        if self.range[1] - self.range[0] > FINE_DECADES {
            return Vec::new();
        }
        let decades = self.range[0].floor() as i32..=self.range[1].floor() as i32;
        let ticks = decades.flat_map(|power| (2..10).map(move |step| f64::from(step) * 10f64.powi(power)));
        ticks.filter(|&value| self.holds(value)).map(|value| self.place(value)).collect()
    }
}

/// A linear axis.
#[cfg_attr(not(feature = "fit"), allow(dead_code, reason = "only the figures of studies have one"))]
pub(crate) struct LinearAxis {
    range: [f64; 2],
    /// Positions of its ends \[px\].
    ends: [f64; 2],
}

#[cfg_attr(not(feature = "fit"), allow(dead_code, reason = "only the figures of studies have one"))]
impl LinearAxis {
    /// From one value to a larger one.
    pub(crate) fn between(low: f64, high: f64, ends: [f64; 2]) -> Self {
        LinearAxis { range: [low, high], ends }
    }

    /// Position of a value \[px\].
    pub(crate) fn place(&self, value: f64) -> f64 {
        let share = (value - self.range[0]) / (self.range[1] - self.range[0]);
        self.ends[0] + share.clamp(0.0, 1.0) * (self.ends[1] - self.ends[0])
    }

    /// Whether a value lies on the axis.
    pub(crate) fn holds(&self, value: f64) -> bool {
        (self.range[0]..=self.range[1]).contains(&value)
    }

    /// Labels at multiples of 1, 2 or 5 times a power of ten, and their positions.
    fn labels(&self) -> Vec<(String, f64)> {
        let span = self.range[1] - self.range[0];
        let power = 10f64.powi(libm::log10(span / LINEAR_LABELS).floor() as i32);
        let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|it| it * power).find(|step| span / step <= LINEAR_LABELS);
        let step = step.unwrap_or(10.0 * power);
        let decimals = (-(libm::log10(step) + 1e-9).floor()).clamp(0.0, 12.0) as usize;
        let first = (self.range[0] / step - 1e-9).ceil() as i64;
        let last = (self.range[1] / step + 1e-9).floor() as i64;
        let label = |multiple: i64| {
            let value = multiple as f64 * step;
            let text = if value.abs() < 1e5 { format!("{value:.decimals$}") } else { significant(value, 2) };
            (text.replace('-', "−"), self.place(value))
        };
        (first..=last).map(label).collect()
    }
}

/// A logarithmic or linear axis.
#[cfg_attr(not(feature = "fit"), allow(dead_code, reason = "only the figures of studies have one"))]
pub(crate) enum Axis {
    Log(LogAxis),
    Linear(LinearAxis),
}

impl Axis {
    /// Position of a value \[px\].
    pub(crate) fn place(&self, value: f64) -> f64 {
        match self {
            Axis::Log(axis) => axis.place(value),
            Axis::Linear(axis) => axis.place(value),
        }
    }

    /// Whether a value lies on the axis.
    pub(crate) fn holds(&self, value: f64) -> bool {
        match self {
            Axis::Log(axis) => axis.holds(value),
            Axis::Linear(axis) => axis.holds(value),
        }
    }

    fn labels(&self) -> Vec<(String, f64)> {
        match self {
            Axis::Log(axis) => axis.labels(),
            Axis::Linear(axis) => axis.labels(),
        }
    }

    fn fine_ticks(&self) -> Vec<f64> {
        match self {
            Axis::Log(axis) => axis.fine_ticks(),
            Axis::Linear(_) => Vec::new(),
        }
    }
}

/// Both axes with ticks, labels and thin grid lines, as SVG elements.
pub(crate) fn axes(x_axis: &Axis, y_axis: &Axis, x_label: &str, y_label: &str) -> String {
    let mut svg = format!("<g font-size=\"{FONT_SIZE}\" stroke-width=\"1\">\n");
    for (text, x) in x_axis.labels() {
        let _ = writeln!(
            svg,
            "<path d=\"M{x:.1} {TOP}V{BOTTOM}\" stroke=\"#e2e2e2\"/><path d=\"M{x:.1} {BOTTOM}v5\" stroke=\"{INK}\"/>\
             <text x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\">{text}</text>",
            BOTTOM + 19.0,
        );
    }
    for (text, y) in y_axis.labels() {
        let _ = writeln!(
            svg,
            "<path d=\"M{LEFT} {y:.1}H{RIGHT}\" stroke=\"#e2e2e2\"/><path d=\"M{LEFT} {y:.1}h-5\" stroke=\"{INK}\"/>\
             <text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{text}</text>",
            LEFT - 8.0,
            y + 4.5,
        );
    }
    let fine: String = x_axis.fine_ticks().iter().map(|x| format!("M{x:.1} {BOTTOM}v3")).collect();
    let fine: String =
        y_axis.fine_ticks().iter().map(|y| format!("M{LEFT} {y:.1}h-3")).fold(fine, |all, one| all + &one);
    if !fine.is_empty() {
        let _ = writeln!(svg, "<path d=\"{fine}\" stroke=\"{INK}\"/>");
    }
    let _ = write!(
        svg,
        "<path d=\"M{LEFT} {TOP}V{BOTTOM}H{RIGHT}\" fill=\"none\" stroke=\"{INK}\"/>\n\
         <text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{x_label}</text>\n\
         <text transform=\"translate(15 {}) rotate(-90)\" text-anchor=\"middle\">{y_label}</text>\n</g>\n",
        0.5 * (LEFT + RIGHT),
        HEIGHT - 10,
        0.5 * (TOP + BOTTOM)
    );
    svg
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(feature = "linear")]
    #[test]
    fn decades_have_their_places_and_zero_stands_on_the_edge() {
        let axis = LogAxis::over([0.0, 3e-9, 2e-3].into_iter(), [100.0, 0.0]).expect("positive values");
        assert_eq!(axis.range, [-9.0, -2.0]);
        assert_eq!(axis.place(1e-9), 100.0);
        assert_eq!(axis.place(0.0), 100.0);
        assert_eq!(axis.place(1e-2), 0.0);
        assert!(LogAxis::over([0.0].into_iter(), [0.0, 1.0]).is_none());
        let labels: Vec<String> = axis.labels().into_iter().map(|(text, _)| text).collect();
        assert_eq!(labels.first().map(String::as_str), Some("10⁻⁹"));
        assert_eq!(labels.len(), 8);
    }

    #[test]
    fn equal_steps_are_round_numbers() {
        let labels = |low, high| {
            let axis = LinearAxis::between(low, high, [0.0, 1.0]);
            axis.labels().into_iter().map(|(text, _)| text).collect::<Vec<_>>()
        };
        assert_eq!(labels(-0.1, 0.3), ["−0.1", "0.0", "0.1", "0.2", "0.3"]);
        assert_eq!(labels(0.0, 41.0), ["0", "10", "20", "30", "40"]);
        assert_eq!(labels(0.0012, 0.0031), ["0.0015", "0.0020", "0.0025", "0.0030"]);
    }

    #[test]
    fn a_short_axis_has_labels_between_powers_of_ten() {
        let axis = LogAxis::between(0.9, 33.0, [0.0, 1.0]);
        let labels: Vec<String> = axis.labels().into_iter().map(|(text, _)| text).collect();
        assert_eq!(labels, ["1", "2", "5", "10", "20"]);
        // 0.9, 2 to 9, 20 and 30.
        assert_eq!(axis.fine_ticks().len(), 11);
    }
}
