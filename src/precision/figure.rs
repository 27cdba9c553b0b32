//! [`figures`]: work–precision plots, log error against log cost.
//!
//! Written directly, one element per point, like the heat map of a report, with decades, markers and a legend.

use std::fmt::Write as _;

use crate::precision::ladder::{Method, Varied};
use crate::precision::results::{Run, SamplePrecision};
use crate::relax::Stop;
use crate::report::figures::log_axes::{Axis, BOTTOM, FONT_SIZE, LEFT, LogAxis, RIGHT, TOP, axes};
use crate::report::figures::{Figure, INK};

/// The quantity on the vertical axis.
#[derive(Clone, Copy)]
struct Quantity {
    name: &'static str,
    label: &'static str,
    of: fn(&Run) -> Option<f64>,
}

/// The quantity on the horizontal axis.
#[derive(Clone, Copy)]
struct Price {
    name: &'static str,
    label: &'static str,
    of: fn(&Run) -> f64,
}

const QUANTITIES: [Quantity; 5] = [
    Quantity {
        name: "displacement",
        label: "largest error of a displacement (length)",
        of: |run| Some(run.errors.displacement),
    },
    Quantity { name: "energy", label: "error of the energy, relative (1)", of: |run| run.errors.energy },
    Quantity { name: "pressure", label: "error of p, relative (1)", of: |run| run.errors.pressure },
    Quantity { name: "wavenumber", label: "error of κ (1/length)", of: |run| run.errors.wavenumber },
    Quantity { name: "amplitude", label: "error of d₀ eff (length)", of: |run| run.errors.amplitude },
];

const SECONDS: Price = Price { name: "seconds", label: "wall time on one core (s)", of: |run| run.seconds };
const EVALUATIONS: Price =
    Price { name: "force_evaluations", label: "force evaluations", of: |run| run.cost.force_evaluation_count as f64 };
const FACTORISATIONS: Price = Price {
    name: "factorisations",
    label: "factorisations (runs without any left out)",
    of: |run| run.cost.factorisation_count as f64,
};

/// The plots of a sample, each with a name for its file: every error against seconds; that of the displacement also
/// against force evaluations and factorisations.
pub fn figures(sample: &SamplePrecision) -> Vec<(String, Figure)> {
    let plots = [(QUANTITIES[0], SECONDS), (QUANTITIES[0], EVALUATIONS), (QUANTITIES[0], FACTORISATIONS)];
    let plots = plots.into_iter().chain(QUANTITIES[1..].iter().map(|&quantity| (quantity, SECONDS)));
    plots
        .filter_map(|(quantity, price)| {
            Some((format!("{}_{}", quantity.name, price.name), figure(sample, quantity, price)?))
        })
        .collect()
}

/// One plot; none if no run has these numbers.
fn figure(sample: &SamplePrecision, quantity: Quantity, price: Price) -> Option<Figure> {
    let points: Vec<(&Run, f64, f64)> = sample
        .runs
        .iter()
        .filter_map(|run| Some((run, (price.of)(run), (quantity.of)(run)?)))
        .filter(|&(_, x, y)| x > 0.0 && x.is_finite() && y.is_finite())
        .collect();
    let x_axis = Axis::Log(LogAxis::over(points.iter().map(|point| point.1), [LEFT, RIGHT])?);
    let y_axis = Axis::Log(LogAxis::over(points.iter().map(|point| point.2), [BOTTOM, TOP])?);
    let mut svg = axes(&x_axis, &y_axis, price.label, quantity.label);
    for method in Method::ALL {
        for varied in [Varied::ForceLimit, Varied::TimeStep, Varied::Tolerance] {
            let ladder: Vec<Mark> = points
                .iter()
                .filter(|(run, ..)| (run.method, run.varied) == (method, varied))
                .map(|&(run, x, y)| Mark { x: x_axis.place(x), y: y_axis.place(y), run })
                .collect();
            svg.push_str(&ladder_markup(method, varied, &ladder));
        }
    }
    svg.push_str(&legend(sample.unjammed));
    Some(Figure::new(
        format!("{}: {} against {}", sample.name, quantity.name, price.label),
        format!(
            "{} of {} runs against {}, both logarithmic, with one colour and marker per relaxer",
            quantity.label,
            points.len(),
            price.label
        ),
        svg,
    ))
}

/// The position of a run.
struct Mark<'a> {
    x: f64,
    y: f64,
    run: &'a Run,
}

/// The runs of a ladder, connected from loose to tight: filled in a reference minimum, hollow in another, crossed out
/// if the step limit was reached.
fn ladder_markup(method: Method, varied: Varied, ladder: &[Mark<'_>]) -> String {
    let (colour, shape) = colour_and_marker(method);
    let mut svg = String::new();
    let points: Vec<String> = ladder.iter().map(|mark| format!("{:.1},{:.1}", mark.x, mark.y)).collect();
    if points.len() > 1 {
        let dashes = if varied == Varied::ForceLimit { "" } else { " stroke-dasharray=\"2 3\"" };
        let _ = writeln!(
            svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-opacity=\"0.55\"{dashes}/>",
            points.join(" ")
        );
    }
    for Mark { x, y, run } in ladder {
        let fill = if run.minimum_distance == 0.0 { colour } else { "#ffffff" };
        let _ = writeln!(svg, "{}", shape.markup(*x, *y, colour, fill));
        if run.stop == Stop::StepLimit {
            let _ = writeln!(
                svg,
                "<path d=\"M{:.1} {:.1}l12 12m0 -12l-12 12\" stroke=\"{INK}\" stroke-width=\"1.2\"/>",
                x - 6.0,
                y - 6.0
            );
        }
    }
    svg
}

/// A marker.
#[derive(Clone, Copy)]
enum Shape {
    Circle,
    Square,
    Triangle,
    Diamond,
}

impl Shape {
    fn markup(self, x: f64, y: f64, colour: &str, fill: &str) -> String {
        let style = format!("fill=\"{fill}\" stroke=\"{colour}\" stroke-width=\"1.3\"");
        let path = |path: &str| format!("<path transform=\"translate({x:.1} {y:.1})\" d=\"{path}\" {style}/>");
        match self {
            Shape::Circle => format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.4\" {style}/>"),
            Shape::Square => path("M-3.2 -3.2h6.4v6.4h-6.4z"),
            Shape::Triangle => path("M0 -4.2L4 3H-4z"),
            Shape::Diamond => path("M0 -4.6L4.6 0L0 4.6L-4.6 0z"),
        }
    }
}

/// Colour and marker of a relaxer. Colours from Okabe, Ito (2008); related relaxers share one and differ in the marker.
fn colour_and_marker(method: Method) -> (&'static str, Shape) {
    match method {
        Method::Fire => ("#0072b2", Shape::Circle),
        Method::FireStepBack => ("#56b4e9", Shape::Triangle),
        Method::ConjugateGradients => ("#009e73", Shape::Square),
        Method::QuasiNewton => ("#009e73", Shape::Diamond),
        Method::Damped => ("#d55e00", Shape::Circle),
        Method::Implicit => ("#d55e00", Shape::Square),
        Method::GradientFlow => ("#e69f00", Shape::Triangle),
        Method::Newton => ("#cc79a7", Shape::Diamond),
        Method::Staged => ("#222222", Shape::Circle),
    }
}

/// Symbols and their meanings, above the axes.
fn legend(unjammed: bool) -> String {
    const COLUMNS: usize = 3;
    const LINE: f64 = 18.0;
    let mut svg = format!("<g font-size=\"{}\">\n", FONT_SIZE - 1);
    let mut entry = |index: usize, sign: String, text: &str| {
        let (x, y) = cell(index);
        let _ = writeln!(svg, "{sign}<text x=\"{:.1}\" y=\"{:.1}\">{text}</text>", x + 9.0, y + 4.2);
    };
    fn cell(index: usize) -> (f64, f64) {
        (20.0 + (index % COLUMNS) as f64 * 146.0, 14.0 + (index / COLUMNS) as f64 * LINE)
    }
    for (index, method) in Method::ALL.into_iter().enumerate() {
        let (colour, shape) = colour_and_marker(method);
        let (x, y) = cell(index);
        entry(index, shape.markup(x, y, colour, colour), method.name());
    }
    let first = Method::ALL.len();
    let (x, y) = cell(first);
    if !unjammed {
        entry(first, Shape::Circle.markup(x, y, "#666666", "#ffffff"), "another minimum");
    }
    let (x, y) = cell(first + 1);
    let cross = format!("<path d=\"M{:.1} {:.1}l10 10m0 -10l-10 10\" stroke=\"{INK}\"/>", x - 5.0, y - 5.0);
    entry(first + 1, cross, "step limit");
    let (x, y) = cell(first + 2);
    let dotted = format!("<path d=\"M{:.1} {y:.1}h14\" stroke=\"{INK}\" stroke-dasharray=\"2 3\"/>", x - 8.0);
    entry(first + 2, dotted, "time step, tolerance");
    svg + "</g>\n"
}
