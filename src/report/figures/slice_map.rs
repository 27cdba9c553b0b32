//! [`slice_map`]: spheres cut by a plane through the inflated one, coloured by r²·d_r.

use crate::displacement::{DisplacementField, Moved};
use crate::report::figures::heat_map::{LEVELS, Spot, spots};
use crate::report::figures::map::{MapFrame, Range, colour_bar, map_label};
use crate::report::figures::palette::diverging;
use crate::report::figures::{Figure, RESCALED_IN_SPACE, escaped};
use crate::report::number::significant;

/// The spheres that the plane z = 0 through the inflated sphere cuts, each as the disk of the cut.
///
/// r²·d_r is constant where the response is that of an incompressible medium, and falls as 1 − (r/R)³ in an elastic one.
/// Grey: not counted (rattlers). Black: the inflated sphere. `radii` are those of the packing of the field, in its order.
///
/// # Panics
/// If there are fewer radii than spheres.
pub fn slice_map(name: &str, field: &DisplacementField<3>, radii: &[f64], frame: &MapFrame) -> Figure {
    let value = |disk: &Moved<3>| disk.distance * disk.distance * disk.radial;
    let is_cut = |disk: &&Moved<3>| disk.position[2].abs() < radii[disk.disk];
    let range = Range::of(field.counted().filter(is_cut).map(value));
    let spot = |disk: &Moved<3>| {
        let [x, y, z] = disk.position;
        Spot {
            place: [x, y],
            diameter: 2.0 * (radii[disk.disk] * radii[disk.disk] - z * z).sqrt(),
            value: disk.counted.then(|| value(disk)),
        }
    };
    let cut = field.disks.iter().filter(is_cut).map(spot);
    let elements = [
        spots(frame, cut, range.shown, Some(field.inner_radius)),
        frame.boundary(),
        frame.scale_bar(),
        colour_bar(diverging, LEVELS),
        map_label(&format!(
            "{RESCALED_IN_SPACE} / ({} length³) in the plane z = 0",
            escaped(&significant(range.shown, 3)),
        )),
    ];
    Figure {
        title: format!("{name}: slice of r²·d_r"),
        description: format!(
            "Spheres cut by a plane through the inflated one, coloured by their radial displacement times r², orange outwards, purple inwards, full \
             at {} length³; grey ones are rattlers, the black one is inflated",
            significant(range.shown, 3)
        ),
        elements: elements.concat(),
    }
}
