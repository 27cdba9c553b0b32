//! [`bond_map`]: every bond at its position, coloured by r·d_∥.

use std::collections::BTreeMap;

use crate::observe::BondChanges;
use crate::report::figures::layer::{Group, Segment};
use crate::report::figures::map::{MapFrame, Range, colour_bar, level, map_label};
use crate::report::figures::palette::red_over_blue;
use crate::report::figures::{Figure, escaped};
use crate::report::number::significant;
use crate::vector::{difference, scaled, sum};

/// Colours on either side of zero.
const LEVELS: i32 = 16;

/// Width of a bond \[length\]: less than the distance between bonds, so that both are visible.
const WIDTH: f64 = 0.3;

/// Height of a strip \[tenths of a pixel\].
const STRIP: i64 = 60;

/// Smallest width of a bond \[tenths of a pixel\].
const LEAST_WIDTH: i64 = 4;

/// r·d_∥ as SVG text with a subscript.
const STRETCH: &str = "r·d<tspan dy=\"3\" font-size=\"10\">∥</tspan><tspan dy=\"-3\">\u{200B}</tspan>";

/// The bonds of a sample between the centres of their disks before the inflation: red compressed, blue stretched, white
/// unchanged (not drawn). The scale is symmetric about zero and covers 98 % of the bonds. `isostatic_length` is drawn
/// as a circle, if given \[length\].
///
/// Bonds of one colour are one path of relative strokes. The largest values come last, so that small ones do not hide
/// them.
pub fn bond_map(name: &str, changes: &BondChanges<2>, frame: &MapFrame, isostatic_length: Option<f64>) -> Figure {
    let rescaled = |bond: &crate::observe::bond_changes::BondChange<2>| bond.distance * bond.parallel;
    let range = Range::of(changes.bonds.iter().map(rescaled));
    // Absolute value, then sign: few groups, in a fixed order.
    let mut groups: BTreeMap<(i32, bool), Vec<Segment>> = BTreeMap::new();
    for bond in &changes.bonds {
        let level = level(rescaled(bond), range.shown, LEVELS);
        // White on a white background.
        if level == 0 {
            continue;
        }
        let half = scaled(0.5, bond.separation);
        let ends = [difference(bond.midpoint, half), sum(bond.midpoint, half)].map(|end| frame.place(end));
        groups.entry((level.abs(), level > 0)).or_default().push(ends);
    }
    let width = frame.tenths(WIDTH).max(LEAST_WIDTH);
    let group = |((size, stretched), bonds): ((i32, bool), Vec<_>)| {
        let value = f64::from(if stretched { size } else { -size }) / f64::from(LEVELS);
        Group::new(red_over_blue(value), width, in_strips(bonds))
    };
    let layer = frame.layer(groups.into_iter().map(group).collect());
    let circle = isostatic_length.map(|length| frame.circle(length, " stroke-width=\"1.6\" stroke-dasharray=\"6 4\""));
    let elements = [
        layer,
        frame.boundary(),
        circle.unwrap_or_default(),
        frame.scale_bar(),
        colour_bar(red_over_blue, LEVELS),
        map_label(&format!(
            "{STRETCH} / ({} length²),  largest |{STRETCH}| = {}",
            escaped(&significant(range.shown, 3)),
            escaped(&significant(range.largest, 3))
        )),
    ];
    Figure {
        title: format!("{name}: map of r·d_∥"),
        description: format!(
            "Each of {} bonds coloured by its rescaled stretching, blue stretched, red compressed, full at {} length² (98 % of the \
             bonds are below it, the largest has {}){}",
            changes.bonds.len(),
            significant(range.shown, 3),
            significant(range.largest, 3),
            isostatic_length.map_or(String::new(), |length| format!(
                "; the dashed circle has the isostatic length {}",
                significant(length, 3)
            ))
        ),
        elements: elements.concat(),
    }
}

/// Strokes sorted in strips across the map: each is near the one before, so that relative paths are short.
fn in_strips(mut bonds: Vec<Segment>) -> Vec<Segment> {
    bonds.sort_unstable_by_key(|&[[x, y], end]| (y.div_euclid(STRIP), x, y, end));
    bonds
}
