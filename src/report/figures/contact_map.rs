//! [`contact_map`]: positions of contacts made and broken.

use crate::observe::ContactChanges;
use crate::observe::contact_changes::ChangedContact;
use crate::report::figures::Figure;
use crate::report::figures::layer::Group;
use crate::report::figures::map::{MapFrame, map_label};
use crate::report::figures::palette::{hexadecimal, red_over_blue};
use crate::report::number::count;

/// Width of a point \[tenths of a pixel\]: up to a thousand contacts are distinguishable.
const POINT: i64 = 50;

/// Width of a point for more contacts \[tenths of a pixel\].
const SMALL_POINT: i64 = 30;

/// Opacity of a point, so that points behind it are visible.
const OPACITY: f32 = 0.8;

/// Position of the colours of made and broken contacts on the scale of the bond map.
const STRENGTH: f64 = 0.8;

/// The contacts of the backbone that an inflation, or a deflation, made (red) and broke (blue), at their midpoints.
pub fn contact_map(name: &str, changes: &ContactChanges<2>, frame: &MapFrame) -> Figure {
    let width = if changes.made.len() + changes.broken.len() > 1000 { SMALL_POINT } else { POINT };
    let (red, blue) = (red_over_blue(-STRENGTH), red_over_blue(STRENGTH));
    let points = |contacts: &[ChangedContact<2>], colour: [u8; 3]| {
        let points = contacts.iter().map(|contact| [frame.place(contact.midpoint); 2]).collect();
        Group { opacity: OPACITY, ..Group::new(colour, width, points) }
    };
    let centre = Group::new([0; 3], POINT, vec![[[0; 2]; 2]]);
    let layer = frame.layer(vec![points(&changes.broken, blue), points(&changes.made, red), centre]);
    let text = |colour, text: String| format!("<tspan fill=\"{}\">● </tspan>{text}", hexadecimal(colour));
    let elements = [
        layer,
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
