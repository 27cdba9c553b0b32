//! Common axes of the charts, drawn by plotters with the series, and a legend above, where it covers no data.

use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use crate::report::figures::{Figure, FigureError, HEIGHT, INK, WIDTH};
use crate::report::number::superscript;

/// Canvas pixels per pixel of the picture.
pub(crate) const SCALE: u32 = 10;

/// Height of a line of the legend \[px\].
const LEGEND_LINE: u32 = 18;

/// Plotters writes `font-size = size / 1.24`.
const FONT_FACTOR: f64 = 1.24;

/// Smallest number of legend lines for which a chart has space, so that the axes of charts in a row have equal heights.
const LEAST_LEGEND: usize = 3;

/// Distances of the axes from the lower and left edges \[px\].
const BOTTOM: u32 = 50;
const LEFT: u32 = 68;

/// Distance from the right edge, for half a tick label \[px\].
const RIGHT: u32 = 14;

/// Font size of tick labels, axis labels and legend \[px\].
const FONT_SIZE: u32 = 13;

/// The drawing area of a chart.
pub(crate) type Axes<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// The result of drawing.
pub(crate) type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

/// A chart to be drawn.
pub(crate) struct Chart {
    pub title: String,
    pub description: String,
    /// SVG text including the unit.
    pub x_label: &'static str,
    pub x_range: [f64; 2],
    /// SVG text without the unit.
    pub y_label: &'static str,
    pub y_unit: &'static str,
    pub y_range: [f64; 2],
    pub legend: Vec<LegendLine>,
}

/// One line of a legend.
pub(crate) struct LegendLine(pub Vec<Entry>);

/// A symbol and its meaning.
pub(crate) struct Entry {
    pub sign: Sign,
    /// SVG text.
    pub text: String,
}

/// The symbol of a series.
#[derive(Clone, Copy)]
pub(crate) enum Sign {
    /// Points, filled or not.
    Point { colour: [u8; 3], filled: bool },
    /// A point on a thin line.
    PointOnLine([u8; 3]),
    /// A line.
    Line { colour: [u8; 3], dashed: bool },
}

/// The power of ten by which the numbers of an axis are divided, so that tick labels are short.
#[derive(Clone, Copy)]
pub(crate) struct Scaling {
    exponent: i32,
}

impl Scaling {
    /// For numbers with absolute values up to `largest`: none from 0.01 to 1000, otherwise a multiple of three.
    fn of(largest: f64) -> Self {
        let plain = largest == 0.0 || (0.01..1e3).contains(&largest);
        Scaling { exponent: if plain { 0 } else { 3 * (libm::log10(largest) / 3.0).floor() as i32 } }
    }

    /// A number in the units of the axis.
    pub(crate) fn apply(self, value: f64) -> f64 {
        value / 10f64.powi(self.exponent)
    }
}

impl Chart {
    /// Draws the axes, the content by `draw`, then the legend.
    pub(crate) fn draw(self, draw: impl FnOnce(&mut Axes<'_, '_>, Scaling) -> Drawn) -> Result<Figure, FigureError> {
        for (axis, [low, high]) in [("x", self.x_range), ("y", self.y_range)] {
            if !(low.is_finite() && high.is_finite() && low < high) {
                return Err(FigureError::RangeNotFinite { title: self.title, axis });
            }
        }
        let scaling = Scaling::of(self.y_range[0].abs().max(self.y_range[1].abs()));
        let mut canvas = String::new();
        match self.on(&mut canvas, scaling, draw) {
            Ok(()) => {}
            Err(error) => return Err(FigureError::Drawing { title: self.title, reason: error.to_string() }),
        }
        // The canvas becomes a group of the picture; its own <svg> element is not needed.
        let inner =
            canvas.split_once('>').and_then(|(_, rest)| rest.rsplit_once("</svg>")).map_or("", |(inner, _)| inner);
        let elements = format!(
            "<g transform=\"scale({})\">{inner}</g>\n{}{}",
            1.0 / f64::from(SCALE),
            self.axis_labels(scaling),
            self.legend.iter().enumerate().map(|(index, line)| line.markup(self.row(index))).collect::<String>()
        );
        Ok(Figure { title: self.title, description: self.description, elements })
    }

    fn on(
        &self,
        canvas: &mut String,
        scaling: Scaling,
        draw: impl FnOnce(&mut Axes<'_, '_>, Scaling) -> Drawn,
    ) -> Drawn {
        let area = SVGBackend::with_string(canvas, (WIDTH * SCALE, HEIGHT * SCALE)).into_drawing_area();
        let [y_low, y_high] = self.y_range.map(|value| scaling.apply(value));
        let mut axes = ChartBuilder::on(&area)
            .margin_top(self.top() * SCALE)
            .margin_right(RIGHT * SCALE)
            .x_label_area_size(BOTTOM * SCALE)
            .y_label_area_size(LEFT * SCALE)
            .build_cartesian_2d(self.x_range[0]..self.x_range[1], y_low..y_high)?;
        let ink = RGBColor(0x22, 0x22, 0x22);
        let font = ("sans-serif", f64::from(FONT_SIZE * SCALE) * FONT_FACTOR).into_font().color(&ink);
        axes.configure_mesh()
            .disable_mesh()
            .axis_style(ink.stroke_width(SCALE))
            .set_all_tick_mark_size(5 * SCALE)
            .x_labels(6)
            .y_labels(7)
            .x_label_formatter(&|value| tick(*value, self.x_range[1] - self.x_range[0]))
            .y_label_formatter(&|value| tick(*value, y_high - y_low))
            .label_style(font)
            .draw()?;
        // A line at zero displacement.
        if y_low < 0.0 && 0.0 < y_high {
            let ends = self.x_range.map(|x| (x, 0.0));
            axes.draw_series([PathElement::new(ends.to_vec(), RGBColor(0xAA, 0xAA, 0xAA).stroke_width(SCALE))])?;
        }
        draw(&mut axes, scaling)?;
        area.present()
    }
}

impl Chart {
    /// Height of the area above the axes \[px\].
    fn top(&self) -> u32 {
        self.legend.len().max(LEAST_LEGEND) as u32 * LEGEND_LINE + 12
    }

    /// Vertical position of a line of the legend; the last line is just above the axes \[px\].
    fn row(&self, index: usize) -> f64 {
        let first = f64::from(self.top()) - 6.0 - (self.legend.len() as f64 - 0.5) * f64::from(LEGEND_LINE);
        first + index as f64 * f64::from(LEGEND_LINE)
    }

    /// Axis labels with units.
    fn axis_labels(&self, scaling: Scaling) -> String {
        let power = match scaling.exponent {
            0 => String::new(),
            exponent => format!("10{} ", superscript(exponent)),
        };
        format!(
            "<g font-size=\"{FONT_SIZE}\" text-anchor=\"middle\"><text x=\"{}\" y=\"{}\">{}</text>\n\
             <text transform=\"translate(14 {}) rotate(-90)\">{} ({power}{})</text></g>\n",
            (LEFT + WIDTH - RIGHT) / 2,
            HEIGHT - 10,
            self.x_label,
            (self.top() + HEIGHT - BOTTOM) / 2,
            self.y_label,
            self.y_unit,
        )
    }
}

/// A tick label with the number of decimals that its axis needs.
fn tick(value: f64, span: f64) -> String {
    // About seven ticks, at 1, 2 or 5 times a power of ten.
    let decimals = (-libm::log10(span / 8.0).floor()).clamp(0.0, 12.0) as usize;
    let text = format!("{value:.decimals$}");
    let zero = text.chars().all(|letter| !('1'..='9').contains(&letter));
    let text = if zero { text.replace('-', "") } else { text };
    text.replace('-', "−")
}

impl LegendLine {
    /// SVG of the line at height `y` \[px\].
    fn markup(&self, y: f64) -> String {
        let start = f64::from(LEFT) + 2.0;
        let share = (f64::from(WIDTH) - start) / self.0.len() as f64;
        let entry = |(place, entry): (usize, &Entry)| {
            let x = start + place as f64 * share;
            format!(
                "{}<text x=\"{}\" y=\"{}\" font-size=\"{FONT_SIZE}\" fill=\"{INK}\">{}</text>\n",
                entry.sign.markup(x, y),
                x + 32.0,
                y + 4.5,
                entry.text
            )
        };
        self.0.iter().enumerate().map(entry).collect()
    }
}

impl Sign {
    fn markup(self, x: f64, y: f64) -> String {
        use crate::report::figures::palette::hexadecimal;
        let middle = x + 13.0;
        match self {
            Sign::Point { colour, filled } => {
                let colour = hexadecimal(colour);
                let fill = if filled { colour.as_str() } else { "#ffffff" };
                format!("<circle cx=\"{middle}\" cy=\"{y}\" r=\"2.8\" fill=\"{fill}\" stroke=\"{colour}\"/>")
            }
            Sign::PointOnLine(colour) => {
                let colour = hexadecimal(colour);
                format!(
                    "<path d=\"M{x} {y}h26\" stroke=\"{colour}\"/><circle cx=\"{middle}\" cy=\"{y}\" r=\"2.4\" fill=\"{colour}\"/>"
                )
            }
            Sign::Line { colour, dashed } => {
                let dashes = if dashed { " stroke-dasharray=\"6 4\"" } else { "" };
                let colour = hexadecimal(colour);
                format!("<path d=\"M{x} {y}h26\" stroke=\"{colour}\" stroke-width=\"2\"{dashes}/>")
            }
        }
    }
}
