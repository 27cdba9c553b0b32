//! [`heat_map`]: every disk at its position, coloured by r·d_r.

use std::collections::BTreeMap;

use crate::displacement::{DisplacementField, Moved, Shape};
use crate::report::figures::layer::{Group, Segment};
use crate::report::figures::map::{MapFrame, Range, colour_bar, level, map_label};
use crate::report::figures::palette::diverging;
use crate::report::figures::{DISPLACEMENT, Figure, RESCALED, escaped};
use crate::report::number::significant;
use crate::vector::Vector;

/// Colours on either side of zero.
pub(crate) const LEVELS: i32 = 32;

/// Colour of disks that do not count.
const RATTLER: [u8; 3] = [0xC4, 0xC8, 0xCC];

/// The displacement field of a sample as a map of r·d_r, or of d_r in a strip. The scale is symmetric about zero and covers 98 % of the
/// disks; the others have the colour of its ends.
///
/// Disks are drawn at their positions before the inflation, with their radii. Grey: not counted (rattlers). Black: the
/// inflated disk. Each disk is a line of zero length with round ends, which needs ten characters instead of sixty.
///
/// `radii` are those of the packing of the field, in its order.
///
/// # Panics
/// If there are fewer radii than disks.
pub fn heat_map(name: &str, field: &DisplacementField<2>, radii: &[f64], frame: &MapFrame) -> Figure {
    let (label, words, unit) = match field.shape {
        Shape::Round => (RESCALED, "r·d_r", "length²"),
        Shape::Strip { .. } => (DISPLACEMENT, "d_r", "length"),
    };
    let value = |disk: &Moved<2>| match field.shape {
        Shape::Round => disk.distance * disk.radial,
        Shape::Strip { .. } => disk.radial,
    };
    let range = Range::of(field.counted().map(value));
    let spot = |disk: &Moved<2>| Spot {
        place: disk.position,
        diameter: 2.0 * radii[disk.disk],
        value: disk.counted.then(|| value(disk)),
    };
    let elements = [
        spots(frame, field.disks.iter().map(spot), range.shown, Some(field.inner_radius)),
        frame.boundary(),
        frame.scale_bar(),
        colour_bar(diverging, LEVELS),
        map_label(&format!(
            "{label} / ({} {unit}),  largest |{label}| = {}",
            escaped(&significant(range.shown, 3)),
            escaped(&significant(range.largest, 3))
        )),
    ];
    let elements = elements.concat();
    Figure {
        title: format!("{name}: map of {words}"),
        description: format!(
            "Each disk coloured by its rescaled radial displacement, orange outwards, purple inwards, full at {} {unit} \
             (98 % of the disks are below it, the largest has {}); grey disks are rattlers, the black one is inflated",
            significant(range.shown, 3),
            significant(range.largest, 3)
        ),
        elements,
    }
}

/// A disk of a map.
pub(crate) struct Spot {
    /// Its place relative to the centre of the map \[length\].
    pub place: Vector<2>,
    /// Its diameter \[length\].
    pub diameter: f64,
    /// Its value; none for a disk that does not count.
    pub value: Option<f64>,
}

/// Disks coloured by their values, full at ±`full`, and last the inflated one, in a group with its origin at the centre.
pub(crate) fn spots(frame: &MapFrame, all: impl Iterator<Item = Spot>, full: f64, inflated: Option<f64>) -> String {
    // Colour level, then width: few groups, in a fixed order.
    let mut groups: BTreeMap<(Option<i32>, i64), Vec<Segment>> = BTreeMap::new();
    for spot in all {
        let level = spot.value.map(|value| level(value, full, LEVELS));
        let points = groups.entry((level, frame.tenths(spot.diameter))).or_default();
        points.push([frame.place(spot.place); 2]);
    }
    let group = |((level, width), points): ((Option<i32>, i64), Vec<_>)| {
        let colour = level.map_or(RATTLER, |level| diverging(f64::from(level) / f64::from(LEVELS)));
        Group::new(colour, width, points)
    };
    let mut groups: Vec<Group> = groups.into_iter().map(group).collect();
    groups.extend(inflated.map(|radius| Group::new([0; 3], frame.tenths(2.0 * radius), vec![[[0; 2]; 2]])));
    frame.layer(groups)
}
