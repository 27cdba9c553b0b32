//! Common parts of all maps: the transformation from lengths to pixels, the boundary, the scale bar and the colour bar.

use std::fmt::Write as _;

use crate::inflation::Boundary;
use crate::report::figures::layer::{Group, Layer};
use crate::report::figures::palette::hexadecimal;
use crate::report::figures::{HEIGHT, INK};
use crate::vector::Vector;

/// Side of the area for the packing \[px\].
const SIDE: f64 = 368.0;

/// Left and upper edge of that area \[px\].
const LEFT: f64 = 4.0;
const TOP: f64 = 22.0;

/// Share of the values within the range of the colours; some near a plastic event may be ten times larger.
const SHOWN_SHARE: f64 = 0.98;

/// The transformation from lengths to tenths of a pixel, relative to the inflated disk.
#[derive(Debug, Clone, Copy)]
pub struct MapFrame {
    /// Tenths of a pixel per unit of length.
    zoom: f64,
    half_sides: [f64; 2],
    boundary: Boundary,
}

impl MapFrame {
    /// The circle of radius `outer_radius`, or the box, with a margin for disks up to `widest` in radius \[length\].
    pub fn new(boundary: Boundary, outer_radius: f64, box_sides: [f64; 2], widest: f64) -> Self {
        let half_sides = match boundary {
            Boundary::HeldRim { .. } => [outer_radius; 2],
            Boundary::Periodic => box_sides.map(|side| 0.5 * side),
            Boundary::HeldWalls { .. } => [0.5 * box_sides[0], outer_radius],
        };
        let half = half_sides[0].max(half_sides[1]) + widest;
        MapFrame { zoom: 5.0 * SIDE / half, half_sides, boundary }
    }

    /// A length, rounded to tenths of a pixel.
    pub(crate) fn tenths(&self, length: f64) -> i64 {
        (self.zoom * length).round() as i64
    }

    /// A point, rounded to tenths of a pixel; the y axis of SVG points down.
    pub(crate) fn place(&self, point: Vector<2>) -> [i64; 2] {
        let [x, y] = point.map(|coordinate| self.tenths(coordinate));
        [x, -y]
    }

    /// Strokes in tenths of a pixel, with the origin at the inflated disk.
    pub(crate) fn layer(&self, groups: Vec<Group>) -> String {
        Layer { groups }.markup([LEFT + 0.5 * SIDE, TOP + 0.5 * SIDE], 0.5 * SIDE)
    }

    /// A circle around the inflated disk.
    pub(crate) fn circle(&self, radius: f64, style: &str) -> String {
        let (cx, cy) = (LEFT + 0.5 * SIDE, TOP + 0.5 * SIDE);
        format!(
            "<circle cx=\"{cx}\" cy=\"{cy}\" r=\"{:.1}\" fill=\"none\" stroke=\"{INK}\"{style}/>\n",
            0.1 * self.zoom * radius
        )
    }

    /// An ellipse around the centre with these half axes.
    pub(crate) fn ellipse(&self, half_axes: [f64; 2]) -> String {
        let [x, y] = half_axes.map(|half| 0.1 * self.zoom * half);
        let (cx, cy) = (LEFT + 0.5 * SIDE, TOP + 0.5 * SIDE);
        format!("<ellipse cx=\"{cx}\" cy=\"{cy}\" rx=\"{x:.1}\" ry=\"{y:.1}\" fill=\"none\" stroke=\"{INK}\"/>\n")
    }

    pub(crate) fn boundary(&self) -> String {
        let [x, y] = self.half_sides.map(|half| 0.1 * self.zoom * half);
        match self.boundary {
            Boundary::HeldRim { .. } => self.circle(self.half_sides[0], ""),
            Boundary::Periodic | Boundary::HeldWalls { .. } => format!(
                "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"none\" stroke=\"{INK}\"/>\n",
                LEFT + 0.5 * SIDE - x,
                TOP + 0.5 * SIDE - y,
                2.0 * x,
                2.0 * y
            ),
        }
    }

    /// A round length of about a quarter of the width.
    pub(crate) fn scale_bar(&self) -> String {
        let length = round_below(2.5 * SIDE / self.zoom);
        let (x, y) = (LEFT + 4.0, HEIGHT as f64 - 28.0);
        let end = x + 0.1 * self.zoom * length;
        format!(
            "<path d=\"M{x:.1} {0:.1}v8m0 -4H{end:.1}m0 -4v8\" fill=\"none\" stroke=\"{INK}\" stroke-width=\"1.5\"/>\n\
             <text x=\"{1:.1}\" y=\"{2:.1}\" font-size=\"13\">{length} diameters of a small disk</text>\n",
            y - 4.0,
            end + 8.0,
            y + 4.5
        )
    }
}

/// Range of the absolute values of a map.
pub(crate) struct Range {
    /// Largest value on the colour scale.
    pub shown: f64,
    /// Largest value.
    pub largest: f64,
}

impl Range {
    pub(crate) fn of(values: impl Iterator<Item = f64>) -> Self {
        let mut values: Vec<f64> = values.map(f64::abs).collect();
        values.sort_by(f64::total_cmp);
        let largest = values.last().copied().unwrap_or(0.0);
        let shown = values.get((SHOWN_SHARE * values.len() as f64) as usize).copied().unwrap_or(largest);
        // If fewer than 2 % move at all, the largest value sets the scale.
        Range { shown: if shown > 0.0 { shown } else { largest }, largest }
    }
}

/// The colour level of a value, with `levels` levels on either side of zero.
pub(crate) fn level(value: f64, full: f64, levels: i32) -> i32 {
    if full > 0.0 { ((value / full).clamp(-1.0, 1.0) * f64::from(levels)).round() as i32 } else { 0 }
}

/// 1, 2 or 5 times a power of ten, at most `length`.
fn round_below(length: f64) -> f64 {
    let power = libm::pow(10.0, libm::log10(length).floor());
    [5.0, 2.0, 1.0].into_iter().map(|digit| digit * power).find(|&round| round <= length).unwrap_or(power)
}

/// The colours from −1 to 1.
pub(crate) fn colour_bar(colour: fn(f64) -> [u8; 3], levels: i32) -> String {
    let (x, top, width, height) = (LEFT + SIDE + 14.0, TOP + 40.0, 14.0, SIDE - 80.0);
    let step = height / f64::from(2 * levels + 1);
    let mut bar = String::new();
    for level in -levels..=levels {
        let y = top + step * f64::from(levels - level);
        let colour = hexadecimal(colour(f64::from(level) / f64::from(levels)));
        // The overlap avoids visible seams.
        let _ = writeln!(
            bar,
            "<rect x=\"{x}\" y=\"{y:.2}\" width=\"{width}\" height=\"{:.2}\" fill=\"{colour}\"/>",
            if level == -levels { step } else { step + 0.5 }
        );
    }
    let _ = writeln!(
        bar,
        "<rect x=\"{x}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" fill=\"none\" stroke=\"{INK}\"/>"
    );
    for (share, text) in [(0.0, "1"), (0.25, "0.5"), (0.5, "0"), (0.75, "−0.5"), (1.0, "−1")] {
        let y = top + share * height;
        let _ = writeln!(
            bar,
            "<path d=\"M{0} {y:.1}h4\" stroke=\"{INK}\"/><text x=\"{1}\" y=\"{2:.1}\" font-size=\"13\">{text}</text>",
            x + width,
            x + width + 7.0,
            y + 4.5
        );
    }
    bar
}

/// The quantity of a map, above it on the right; SVG text.
pub(crate) fn map_label(text: &str) -> String {
    format!("<text x=\"456\" y=\"14\" font-size=\"13\" text-anchor=\"end\">{text}</text>\n")
}
