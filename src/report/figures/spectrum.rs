//! [`spectrum_figure`]: the power spectrum S(f), both axes logarithmic.

use std::fmt::Write as _;

use crate::report::figures::log_axes::{Axis, BOTTOM, FONT_SIZE, LEFT, LogAxis, RIGHT, TOP, axes};
use crate::report::figures::palette::{SEQUENCE, hexadecimal};
use crate::report::figures::{Around, Figure, INK};

/// One spectrum.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectrumPoints {
    /// Its label in the legend; may contain SVG markup.
    pub label: String,
    /// S at f = 1, 2, … \[1\]; values that are not positive are not drawn.
    pub values: Vec<f64>,
    /// Standard errors, drawn as bars; may be empty.
    pub standard_errors: Vec<f64>,
}

/// A curve S(f) next to the points.
pub struct SpectrumCurve<'a> {
    /// Its label in the legend; may contain SVG markup.
    pub label: String,
    /// S(f).
    pub of: Box<dyn Fn(f64) -> f64 + 'a>,
    /// Range of f for which it is drawn.
    pub window: [f64; 2],
}

/// Height of a line of the legend \[px\].
const LEGEND_LINE: f64 = 18.0;

/// Number of points of a curve.
const CURVE_POINTS: usize = 60;

/// Smallest power drawn, over the largest.
const DECADES: f64 = 1e-5;

/// Spectra as points, one colour each, and curves: the first solid, the others dashed. None if no power is positive.
pub fn spectrum_figure(
    name: &str,
    around: Around,
    spectra: &[SpectrumPoints],
    curves: &[SpectrumCurve<'_>],
) -> Option<Figure> {
    let (symbol, label, words) = match around {
        Around::Ring => ("f", "S(f) / S(1)", "a ring against the angular frequency f"),
        Around::Row => ("q L/2π", "S(q) / S(2π/L)", "a row against the wave number q along it"),
        Around::Shell => ("ℓ", "S(ℓ) / S(1)", "a shell against the degree ℓ"),
    };
    let highest = spectra.iter().map(|spectrum| spectrum.values.len()).max().filter(|&count| count > 1)?;
    let positive =
        || spectra.iter().flat_map(|it| &it.values).copied().filter(|&value| value > 0.0 && value.is_finite());
    let largest = positive().reduce(f64::max)?;
    let smallest = positive().fold(largest, f64::min).max(DECADES * largest);
    let x_axis = Axis::Log(LogAxis::between(0.9, 1.1 * highest as f64, [LEFT, RIGHT]));
    let y_axis = Axis::Log(LogAxis::between(0.5 * smallest, 2.0 * largest, [BOTTOM, TOP]));
    let mut svg = axes(&x_axis, &y_axis, symbol, label);
    let lines = spectra.len() + curves.len();
    // The last line of the legend is just above the axes.
    let row = |index: usize| TOP - 6.0 - (lines as f64 - 0.5 - index as f64) * LEGEND_LINE;
    for (index, curve) in curves.iter().enumerate() {
        let dashes = if index == 0 { "" } else { " stroke-dasharray=\"6 4\"" };
        let colour = hexadecimal(SEQUENCE[(spectra.len() + index) % SEQUENCE.len()]);
        let [from, to] = curve.window;
        let at = |i: usize| from * libm::pow(to / from, i as f64 / CURVE_POINTS as f64);
        let points: Vec<(f64, f64)> = (0..=CURVE_POINTS).map(|i| (at(i), (curve.of)(at(i)))).collect();
        for run in points.split(|&(f, value)| !(x_axis.holds(f) && y_axis.holds(value))).filter(|run| run.len() > 1) {
            let place = |&(f, value): &(f64, f64)| format!("{:.1},{:.1}", x_axis.place(f), y_axis.place(value));
            let _ = writeln!(
                svg,
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.8\"{dashes}/>",
                run.iter().map(place).collect::<Vec<_>>().join(" ")
            );
        }
        let sign = format!(
            "<path d=\"M{} {}h26\" stroke=\"{colour}\" stroke-width=\"2\"{dashes}/>",
            LEFT + 2.0,
            row(spectra.len() + index)
        );
        entry(&mut svg, &sign, row(spectra.len() + index), &curve.label);
    }
    for (index, spectrum) in spectra.iter().enumerate() {
        let colour = hexadecimal(SEQUENCE[index % SEQUENCE.len()]);
        for (place, &value) in spectrum.values.iter().enumerate().filter(|(_, value)| y_axis.holds(**value)) {
            let (x, y) = (x_axis.place((place + 1) as f64), y_axis.place(value));
            if let Some(error) = spectrum.standard_errors.get(place).filter(|error| error.is_finite()) {
                let ends = [value + error, (value - error).max(0.1 * smallest)].map(|end| y_axis.place(end));
                let _ = write!(svg, "<path d=\"M{x:.1} {:.1}V{:.1}\" stroke=\"{colour}\"/>", ends[0], ends[1]);
            }
            let _ = write!(svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.6\" fill=\"{colour}\"/>");
        }
        svg.push('\n');
        let sign = format!("<circle cx=\"{}\" cy=\"{}\" r=\"2.8\" fill=\"{colour}\"/>", LEFT + 15.0, row(index));
        entry(&mut svg, &sign, row(index), &spectrum.label);
    }
    Some(Figure {
        title: format!("{name}: angular power spectrum"),
        description: format!(
            "Power of the radial displacement in {words} from 1 to {highest}, both logarithmic, \
             with {} curves",
            curves.len()
        ),
        elements: svg,
    })
}

/// One line of the legend.
fn entry(svg: &mut String, sign: &str, y: f64, text: &str) {
    let _ = writeln!(
        svg,
        "{sign}<text x=\"{}\" y=\"{}\" font-size=\"{FONT_SIZE}\" fill=\"{INK}\">{text}</text>",
        LEFT + 34.0,
        y + 4.5
    );
}
