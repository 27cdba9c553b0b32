//! [`heat_map`]: every disk where it was, coloured by r·d_r.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use crate::displacement::DisplacementField;
use crate::inflation::Boundary;
use crate::report::figures::palette::{diverging, hexadecimal};
use crate::report::figures::{Figure, HEIGHT, INK, RESCALED, escaped};
use crate::report::number::significant;
use crate::run::SampleResult;

/// Colours on either side of zero.
const LEVELS: i32 = 32;

/// Colour of disks that do not count.
const RATTLER: &str = "#c4c8cc";

/// Room for the packing \[px\].
const SIDE: f64 = 368.0;

/// Left and upper edge of that room \[px\].
const LEFT: f64 = 4.0;
const TOP: f64 = 22.0;

/// Share of the disks within the range of the colours; a few around a plastic event may move ten times as far.
const SHOWN_SHARE: f64 = 0.98;

/// The displacement field of a sample as a map of r·d_r, on a scale symmetric about zero that spans 98 % of the disks;
/// the others have the colour of its ends.
///
/// Disks stand at their positions before the inflation, with their radii. Grey: not counted (rattlers). Black: the
/// inflated disk. Each disk is a line of no length with round ends, as wide as the disk: ten letters instead of sixty.
pub fn heat_map(name: &str, result: &SampleResult, boundary: Boundary) -> Figure {
    let field = &result.field;
    let range = Range::of(field);
    let half_sides = match boundary {
        Boundary::HeldRim { .. } => [field.outer_radius; 2],
        Boundary::Periodic => result.packing.box_sides.map(|side| 0.5 * side),
    };
    let frame = Frame::new(half_sides, result);
    let mut elements = String::new();
    push(&mut elements, frame.disks(field, range.shown));
    push(&mut elements, frame.boundary(half_sides, boundary));
    push(&mut elements, frame.scale_bar());
    push(&mut elements, colour_bar(&range));
    Figure {
        title: format!("{name}: map of r·d_r"),
        description: format!(
            "Each disk coloured by its rescaled radial displacement, orange outwards, purple inwards, full at {} length² \
             (98 % of the disks are below it, the largest has {}); grey disks are rattlers, the black one is inflated",
            significant(range.shown, 3),
            significant(range.largest, 3)
        ),
        elements,
    }
}

/// Values of |r·d_r| \[length²\].
struct Range {
    /// Where the colours end.
    shown: f64,
    /// The largest one.
    largest: f64,
}

impl Range {
    fn of(field: &DisplacementField<2>) -> Self {
        let mut values: Vec<f64> = field.counted().map(|disk| (disk.distance * disk.radial).abs()).collect();
        values.sort_by(f64::total_cmp);
        let largest = values.last().copied().unwrap_or(0.0);
        let shown = values.get((SHOWN_SHARE * values.len() as f64) as usize).copied().unwrap_or(largest);
        // Where fewer than two in a hundred move at all, the largest sets the scale.
        Range { shown: if shown > 0.0 { shown } else { largest }, largest }
    }
}

fn push(elements: &mut String, more: String) {
    elements.push_str(&more);
}

/// From lengths to tenths of a pixel.
struct Frame<'a> {
    /// Tenths of a pixel to a length.
    zoom: f64,
    result: &'a SampleResult,
}

impl<'a> Frame<'a> {
    fn new(half_sides: [f64; 2], result: &'a SampleResult) -> Self {
        // Disks whose centre lies within the boundary reach beyond it by a radius.
        let widest = result.inflated.before.packing.get().radii().iter().copied().fold(0.0, f64::max);
        let half = half_sides[0].max(half_sides[1]) + widest;
        Frame { zoom: 5.0 * SIDE / half, result }
    }

    /// All mobile disks and the inflated one, in a group whose origin is the centre.
    fn disks(&self, field: &DisplacementField<2>, full: f64) -> String {
        let radii = self.result.inflated.before.packing.get().radii();
        let width = |radius: f64| (2.0 * self.zoom * radius).round() as i64;
        // Colour level, then width: few groups, in an order that does not depend on the disks.
        let mut groups: BTreeMap<(Option<i32>, i64), String> = BTreeMap::new();
        for disk in &field.disks {
            let level = disk.counted.then(|| level(disk.distance * disk.radial, full));
            let path = groups.entry((level, width(radii[disk.disk]))).or_default();
            let [x, y] = disk.position.map(|coordinate| (self.zoom * coordinate).round() as i64);
            // The y axis of SVG points down.
            let _ = write!(path, "M{x} {}h0", -y);
        }
        let mut markup = format!(
            "<g transform=\"translate({} {}) scale(.1)\" fill=\"none\" stroke-linecap=\"round\">\n",
            LEFT + 0.5 * SIDE,
            TOP + 0.5 * SIDE
        );
        for ((level, width), path) in groups {
            let colour =
                level.map_or(RATTLER.into(), |level| hexadecimal(diverging(f64::from(level) / f64::from(LEVELS))));
            let _ = writeln!(markup, "<path stroke=\"{colour}\" stroke-width=\"{width}\" d=\"{path}\"/>");
        }
        let inflated = width(self.result.inflation.inner_radius);
        let _ = writeln!(markup, "<path stroke=\"#000000\" stroke-width=\"{inflated}\" d=\"M0 0h0\"/>\n</g>");
        markup
    }

    fn boundary(&self, half_sides: [f64; 2], boundary: Boundary) -> String {
        let [x, y] = half_sides.map(|half| 0.1 * self.zoom * half);
        let (cx, cy) = (LEFT + 0.5 * SIDE, TOP + 0.5 * SIDE);
        match boundary {
            Boundary::HeldRim { .. } => {
                format!("<circle cx=\"{cx}\" cy=\"{cy}\" r=\"{x:.1}\" fill=\"none\" stroke=\"{INK}\"/>\n")
            }
            Boundary::Periodic => format!(
                "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"none\" stroke=\"{INK}\"/>\n",
                cx - x,
                cy - y,
                2.0 * x,
                2.0 * y
            ),
        }
    }

    /// A round length of about a quarter of the width.
    fn scale_bar(&self) -> String {
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

/// The colour of a value of r·d_r.
fn level(value: f64, full: f64) -> i32 {
    if full > 0.0 { ((value / full).clamp(-1.0, 1.0) * f64::from(LEVELS)).round() as i32 } else { 0 }
}

/// 1, 2 or 5 times a power of ten, at most `length`.
fn round_below(length: f64) -> f64 {
    let power = 10f64.powf(length.log10().floor());
    [5.0, 2.0, 1.0].into_iter().map(|digit| digit * power).find(|&round| round <= length).unwrap_or(power)
}

fn colour_bar(range: &Range) -> String {
    let (x, top, width, height) = (LEFT + SIDE + 14.0, TOP + 40.0, 14.0, SIDE - 80.0);
    let step = height / f64::from(2 * LEVELS + 1);
    let mut bar = String::new();
    for level in -LEVELS..=LEVELS {
        let y = top + step * f64::from(LEVELS - level);
        let colour = hexadecimal(diverging(f64::from(level) / f64::from(LEVELS)));
        // A little overlap, so that no seam shows.
        let _ = writeln!(
            bar,
            "<rect x=\"{x}\" y=\"{y:.2}\" width=\"{width}\" height=\"{:.2}\" fill=\"{colour}\"/>",
            if level == -LEVELS { step } else { step + 0.5 }
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
    let _ = writeln!(
        bar,
        "<text x=\"456\" y=\"14\" font-size=\"13\" text-anchor=\"end\">{RESCALED} / ({} length²),  largest |{RESCALED}| = {}</text>",
        escaped(&significant(range.shown, 3)),
        escaped(&significant(range.largest, 3))
    );
    bar
}
