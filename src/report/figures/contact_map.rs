//! [`contact_map`]: where contacts are made and broken.

use std::fmt::Write as _;

use crate::observe::ContactChanges;
use crate::observe::contact_changes::ChangedContact;
use crate::report::figures::Figure;
use crate::report::figures::map::{MapFrame, map_label};
use crate::report::figures::palette::{hexadecimal, red_over_blue};
use crate::report::number::count;

/// Width of a point \[tenths of a pixel\]: up to a thousand contacts stand apart.
const POINT: i64 = 50;

/// The same where there are more.
const SMALL_POINT: i64 = 30;

/// Where the colours of made and broken contacts are on the scale of the bond map.
const STRENGTH: f64 = 0.8;

/// The contacts of the backbone that an inflation, or a deflation, made (red) and broke (blue), at their midpoints.
pub fn contact_map(name: &str, changes: &ContactChanges<2>, frame: &MapFrame) -> Figure {
    let width = if changes.made.len() + changes.broken.len() > 1000 { SMALL_POINT } else { POINT };
    let (red, blue) = (red_over_blue(-STRENGTH), red_over_blue(STRENGTH));
    let points = |contacts: &[ChangedContact<2>], colour: [u8; 3]| {
        let mut path = String::new();
        for contact in contacts {
            let [x, y] = frame.place(contact.midpoint);
            let _ = write!(path, "M{x} {y}h0");
        }
        format!(
            "<path stroke=\"{}\" stroke-opacity=\"0.8\" stroke-width=\"{width}\" d=\"{path}\"/>\n",
            hexadecimal(colour)
        )
    };
    let centre = format!("<path stroke=\"#000000\" stroke-width=\"{POINT}\" d=\"M0 0h0\"/>\n");
    let strokes = [points(&changes.broken, blue), points(&changes.made, red), centre].concat();
    let text = |colour, text: String| format!("<tspan fill=\"{}\">● </tspan>{text}", hexadecimal(colour));
    let elements = [
        frame.group(&strokes),
        frame.boundary(),
        frame.scale_bar(),
        map_label(&format!(
            "{}   {}   of {}",
            text(red, format!("{} made", count(changes.made.len()))),
            text(blue, format!("{} broken", count(changes.broken.len()))),
            count(changes.kept_count + changes.broken.len())
        )),
    ];
    Figure {
        title: format!("{name}: contact changes"),
        description: format!(
            "{} contacts made (red) and {} broken (blue), {} kept, at the midpoints of their disks",
            changes.made.len(),
            changes.broken.len(),
            changes.kept_count
        ),
        elements: elements.concat(),
    }
}
