//! [`Plot`]: series of points with errors and lines, with linear or logarithmic axes and a legend above.

use std::fmt::Write as _;

use crate::report::figures::log_axes::{Axis, BOTTOM, FONT_SIZE, LEFT, LinearAxis, LogAxis, RIGHT, TOP, axes};
use crate::report::figures::palette::{SEQUENCE, hexadecimal, ordered};
use crate::report::figures::{Figure, INK};

/// Height of a line of the legend \[px\].
const LEGEND_LINE: f64 = 17.0;

/// Number of legend lines that fit above the axes.
const LEGEND_LINES: usize = 5;

/// Width of the sign of a series before its label \[px\].
const SIGN_WIDTH: f64 = 30.0;

/// Mean width of a letter over the font size \[1\].
const LETTER_WIDTH: f64 = 0.5;

/// Margin beyond the outermost points: a share of a linear axis, or a power of ten on a logarithmic one.
const MARGIN: f64 = 0.05;

/// Smallest value on a logarithmic axis over the largest.
const MOST_DECADES: f64 = 1e-9;

/// An axis of a plot.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PlotAxis {
    /// SVG text including the unit.
    pub label: String,
    /// Whether it is logarithmic.
    pub logarithmic: bool,
    /// Its ends; if absent, chosen from the points.
    pub range: Option<[f64; 2]>,
}

impl PlotAxis {
    /// A logarithmic axis for the range of the points.
    pub(crate) fn logarithmic(label: impl Into<String>) -> Self {
        PlotAxis { label: label.into(), logarithmic: true, range: None }
    }

    /// A linear axis for the range of the points.
    pub(crate) fn linear(label: impl Into<String>) -> Self {
        PlotAxis { label: label.into(), logarithmic: false, range: None }
    }

    /// Sets the ends of the axis.
    pub(crate) fn within(self, low: f64, high: f64) -> Self {
        PlotAxis { range: Some([low, high]), ..self }
    }

    fn axis(&self, values: impl Iterator<Item = f64>, ends: [f64; 2]) -> Option<Axis> {
        let usable = |value: &f64| value.is_finite() && (!self.logarithmic || *value > 0.0);
        let [low, high] = match self.range {
            Some(range) => range,
            None => {
                let first = [f64::INFINITY, f64::NEG_INFINITY];
                let found = values.filter(usable).fold(first, |[low, high], it| [low.min(it), high.max(it)]);
                if !(found[0].is_finite() && found[1].is_finite()) {
                    return None;
                }
                if self.logarithmic {
                    let low = found[0].max(MOST_DECADES * found[1]);
                    let margin = libm::pow(found[1] / low, MARGIN).max(1.1);
                    [low / margin, found[1] * margin]
                } else {
                    // A single value also has an axis.
                    let margin = match found[1] - found[0] {
                        span if span > 1e-9 * found[1].abs().max(found[0].abs()) => MARGIN * span,
                        _ if found[1] == 0.0 => 1.0,
                        _ => 0.1 * found[1].abs(),
                    };
                    [found[0] - margin, found[1] + margin]
                }
            }
        };
        Some(match self.logarithmic {
            true => Axis::Log(LogAxis::between(low, high, ends)),
            false => Axis::Linear(LinearAxis::between(low, high, ends)),
        })
    }
}

/// A point, with the ends of its interval if it has one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PlotPoint {
    pub x: f64,
    pub y: f64,
    pub interval: Option<[f64; 2]>,
}

/// Style of a series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Style {
    /// Points only.
    Points,
    /// Hollow points.
    Hollow,
    /// Connected points.
    Joined,
    /// A line.
    Line,
    /// A dashed line.
    Dashed,
}

/// A series of points, or a curve.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Series {
    /// Its label in the legend, as SVG text; if empty, it has no entry.
    pub label: String,
    pub points: Vec<PlotPoint>,
    pub style: Style,
    pub colour: [u8; 3],
}

/// The colour of one of `count` series.
pub(crate) fn colour(index: usize, count: usize) -> [u8; 3] {
    if count <= 4 { SEQUENCE[index % SEQUENCE.len()] } else { ordered(index, count) }
}

/// Points without intervals.
pub(crate) fn bare(points: impl Iterator<Item = (f64, f64)>) -> Vec<PlotPoint> {
    points.map(|(x, y)| PlotPoint { x, y, interval: None }).collect()
}

/// A straight line across the axes, with a short label.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Guide {
    /// At x.
    Vertical(f64, String),
    /// At y.
    Horizontal(f64, String),
}

/// A picture to be drawn.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Plot {
    pub title: String,
    pub description: String,
    pub x: PlotAxis,
    pub y: PlotAxis,
    pub series: Vec<Series>,
    pub guides: Vec<Guide>,
}

impl Plot {
    /// The picture; none if no point can be shown.
    pub(crate) fn draw(self) -> Option<Figure> {
        let points = || self.series.iter().flat_map(|series| &series.points);
        let x_axis = self.x.axis(points().map(|point| point.x), [LEFT, RIGHT])?;
        let heights = points().flat_map(|point| point.interval.into_iter().flatten().chain([point.y]));
        let y_axis = self.y.axis(heights, [BOTTOM, TOP])?;
        let shown = |point: &&PlotPoint| x_axis.holds(point.x) && y_axis.holds(point.y);
        if !points().any(|point| shown(&point)) {
            return None;
        }
        let mut svg = axes(&x_axis, &y_axis, &self.x.label, &self.y.label);
        self.guides.iter().for_each(|guide| guide.markup(&mut svg, &x_axis, &y_axis));
        for series in &self.series {
            series.markup(&mut svg, &x_axis, &y_axis);
        }
        self.legend(&mut svg);
        Some(Figure { title: self.title, description: self.description, elements: svg })
    }

    /// The legend, in as many columns as needed, and in smaller letters where the longest label would not fit.
    fn legend(&self, svg: &mut String) {
        let named: Vec<&Series> = self.series.iter().filter(|series| !series.label.is_empty()).collect();
        let columns = named.len().div_ceil(LEGEND_LINES).max(1);
        let lines = named.len().div_ceil(columns);
        let longest = named.iter().map(|series| series.label.chars().count()).max().unwrap_or(0);
        let room = (RIGHT - LEFT) / columns as f64 - SIGN_WIDTH;
        let size = f64::from(FONT_SIZE).min((room / (LETTER_WIDTH * longest as f64)).floor());
        for (index, series) in named.iter().enumerate() {
            let (column, line) = (index / lines, index % lines);
            let x = LEFT + 2.0 + column as f64 * (RIGHT - LEFT) / columns as f64;
            let y = TOP - 8.0 - (lines as f64 - 0.5 - line as f64) * LEGEND_LINE;
            series.sign(svg, x, y);
            let _ = writeln!(
                svg,
                "<text x=\"{}\" y=\"{}\" font-size=\"{size}\" fill=\"{INK}\">{}</text>",
                x + SIGN_WIDTH,
                y + 4.5,
                series.label
            );
        }
    }
}

impl Series {
    fn markup(&self, svg: &mut String, x_axis: &Axis, y_axis: &Axis) {
        let colour = hexadecimal(self.colour);
        let shown = |point: &&PlotPoint| x_axis.holds(point.x) && y_axis.holds(point.y);
        if matches!(self.style, Style::Joined | Style::Line | Style::Dashed) {
            let (width, dashes) = match self.style {
                Style::Joined => (1.0, ""),
                Style::Dashed => (1.8, " stroke-dasharray=\"6 4\""),
                _ => (1.8, ""),
            };
            let all: Vec<&PlotPoint> = self.points.iter().collect();
            for run in all.split(|point| !shown(point)).filter(|run| run.len() > 1) {
                let place = |point: &&PlotPoint| format!("{:.1},{:.1}", x_axis.place(point.x), y_axis.place(point.y));
                let _ = writeln!(
                    svg,
                    "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"{dashes}/>",
                    run.iter().map(place).collect::<Vec<_>>().join(" ")
                );
            }
        }
        if matches!(self.style, Style::Line | Style::Dashed) {
            return;
        }
        let fill = if self.style == Style::Hollow { "#ffffff" } else { &colour };
        for point in self.points.iter().filter(shown) {
            let (x, y) = (x_axis.place(point.x), y_axis.place(point.y));
            if let Some(interval) = point.interval {
                let [low, high] = interval.map(|end| if end.is_finite() { y_axis.place(end) } else { y });
                let _ = write!(svg, "<path d=\"M{x:.1} {low:.1}V{high:.1}\" stroke=\"{colour}\"/>");
            }
            let _ = write!(svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.6\" fill=\"{fill}\" stroke=\"{colour}\"/>");
        }
        svg.push('\n');
    }

    /// The symbol of the series in the legend.
    fn sign(&self, svg: &mut String, x: f64, y: f64) {
        let colour = hexadecimal(self.colour);
        let fill = if self.style == Style::Hollow { "#ffffff" } else { &colour };
        let line = match self.style {
            Style::Points | Style::Hollow => None,
            Style::Joined => Some(("1", "")),
            Style::Line => Some(("2", "")),
            Style::Dashed => Some(("2", " stroke-dasharray=\"6 4\"")),
        };
        if let Some((width, dashes)) = line {
            let _ = write!(svg, "<path d=\"M{x} {y}h24\" stroke=\"{colour}\" stroke-width=\"{width}\"{dashes}/>");
        }
        if !matches!(self.style, Style::Line | Style::Dashed) {
            let middle = x + 12.0;
            let _ = write!(svg, "<circle cx=\"{middle}\" cy=\"{y}\" r=\"2.8\" fill=\"{fill}\" stroke=\"{colour}\"/>");
        }
    }
}

impl Guide {
    fn markup(&self, svg: &mut String, x_axis: &Axis, y_axis: &Axis) {
        let style = "stroke=\"#777777\" stroke-dasharray=\"2 3\"";
        match self {
            Guide::Vertical(at, text) if x_axis.holds(*at) => {
                let x = x_axis.place(*at);
                let _ = writeln!(
                    svg,
                    "<path d=\"M{x:.1} {TOP}V{BOTTOM}\" {style}/><text x=\"{:.1}\" y=\"{}\" font-size=\"12\" \
                     fill=\"#555555\">{text}</text>",
                    x + 4.0,
                    BOTTOM - 8.0
                );
            }
            Guide::Horizontal(at, text) if y_axis.holds(*at) => {
                let y = y_axis.place(*at);
                let _ = writeln!(
                    svg,
                    "<path d=\"M{LEFT} {y:.1}H{RIGHT}\" {style}/><text x=\"{}\" y=\"{:.1}\" font-size=\"12\" \
                     text-anchor=\"end\" fill=\"#555555\">{text}</text>",
                    RIGHT - 4.0,
                    y - 4.0
                );
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(points: Vec<PlotPoint>, y: PlotAxis) -> Option<Figure> {
        let series = Series { label: "a".into(), points, style: Style::Joined, colour: colour(0, 1) };
        let (title, description) = ("t".to_string(), "d".to_string());
        Plot { title, description, x: PlotAxis::logarithmic("x"), y, series: vec![series], guides: Vec::new() }.draw()
    }

    #[test]
    fn points_off_the_axes_are_left_out_and_break_the_line() {
        let points = bare([(1.0, 1.0), (2.0, 2.0), (3.0, -1.0), (4.0, 4.0), (5.0, 5.0)].into_iter());
        let figure = plot(points, PlotAxis::logarithmic("y")).expect("four points");
        assert_eq!(figure.elements.matches("<polyline").count(), 2);
        // Four points and the symbol of the legend.
        assert_eq!(figure.elements.matches("<circle").count(), 5);
    }

    #[test]
    fn nothing_to_show_is_no_picture() {
        assert!(plot(Vec::new(), PlotAxis::linear("y")).is_none());
        assert!(plot(bare([(1.0, f64::NAN)].into_iter()), PlotAxis::linear("y")).is_none());
        assert!(plot(bare([(1.0, -2.0)].into_iter()), PlotAxis::logarithmic("y")).is_none());
        let one = plot(bare([(1.0, 0.0)].into_iter()), PlotAxis::linear("y"));
        assert!(one.is_some_and(|figure| !figure.elements.contains("NaN")));
    }
}
