//! [`shell_map`]: the spheres of a shell on the map of Hammer, coloured by d_r.
//!
//! ```text
//! x = 2√2 cos φ sin(λ/2) / √(1 + cos φ cos(λ/2))        y = √2 sin φ / √(1 + cos φ cos(λ/2))
//! ```
//!
//! λ is the longitude, φ the latitude. The map keeps areas.
//!
//! # Source
//! Snyder (1987), Map Projections: A Working Manual, U.S. Geological Survey Professional Paper 1395, chapter 24.

use crate::displacement::{DisplacementField, Moved};
use crate::inflation::Boundary;
use crate::report::figures::heat_map::{LEVELS, Spot, spots};
use crate::report::figures::map::{MapFrame, Range, colour_bar, map_label};
use crate::report::figures::palette::diverging;
use crate::report::figures::{Figure, RESCALED, escaped};
use crate::report::number::significant;
use crate::vector::Vector;

/// Half-width of the shell over R \[1\]. Wider than that of the observables, so that the map has no gaps.
const HALF_WIDTH: f64 = 0.08;

/// Place of a direction on the map.
fn hammer([x, y, z]: Vector<3>) -> Vector<2> {
    let radius = libm::hypot(libm::hypot(x, y), z);
    let (longitude, sine) = (libm::atan2(y, x), z / radius);
    let cosine = libm::hypot(x, y) / radius;
    let scale = 2f64.sqrt() / (1.0 + cosine * libm::cos(0.5 * longitude)).sqrt();
    [2.0 * scale * cosine * libm::sin(0.5 * longitude), scale * sine]
}

/// The spheres near r̂ = r/R = `relative_radius`, by their directions. Grey: not counted (rattlers).
///
/// # Panics
/// If there are fewer radii than spheres.
pub fn shell_map(name: &str, field: &DisplacementField<3>, radii: &[f64], relative_radius: f64) -> Figure {
    let is_near = |disk: &&Moved<3>| (disk.distance / field.outer_radius - relative_radius).abs() <= HALF_WIDTH;
    let range = Range::of(field.counted().filter(is_near).map(|disk| disk.radial));
    let spot = |disk: &Moved<3>| Spot {
        place: hammer(disk.position),
        // The map keeps areas: a small circle of angle R_i/r has this radius at its middle.
        diameter: 2.0 * radii[disk.disk] / disk.distance,
        value: disk.counted.then_some(disk.radial),
    };
    let widest = 0.1;
    let frame = MapFrame::new(Boundary::Periodic, 1.0, [4.0 * 2f64.sqrt(), 2.0 * 2f64.sqrt()], widest);
    let elements = [
        spots(&frame, field.disks.iter().filter(is_near).map(spot), range.shown, None),
        frame.ellipse([2.0 * 2f64.sqrt(), 2f64.sqrt()]),
        colour_bar(diverging, LEVELS),
        map_label(&format!(
            "{} / ({} length) at r/R = {}",
            RESCALED.trim_start_matches("r·"),
            escaped(&significant(range.shown, 3)),
            escaped(&significant(relative_radius, 2)),
        )),
    ];
    Figure {
        title: format!("{name}: d_r on a shell"),
        description: format!(
            "All directions from the inflated sphere on a map that keeps areas; spheres near r/R = {} coloured by their radial displacement, orange \
             outwards, purple inwards, full at {} length; grey ones are rattlers",
            significant(relative_radius, 2),
            significant(range.shown, 3)
        ),
        elements: elements.concat(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_keeps_areas_and_its_corners_are_known() {
        let root = 2f64.sqrt();
        let close = |a: Vector<2>, b: Vector<2>| assert!((a[0] - b[0]).abs() + (a[1] - b[1]).abs() < 1e-12, "{a:?}");
        close(hammer([1.0, 0.0, 0.0]), [0.0, 0.0]);
        close(hammer([0.0, 0.0, 2.0]), [0.0, root]);
        close(hammer([-1.0, 1e-16, 0.0]), [2.0 * root, 0.0]);
        // The area of a small patch: central differences of step 10⁻⁴ are off by 10⁻⁸.
        let step = 1e-4;
        for (longitude, latitude) in [(0.3f64, 0.2f64), (-2.0, 0.9), (2.9, -1.2)] {
            let at = |l: f64, f: f64| hammer([f.cos() * l.cos(), f.cos() * l.sin(), f.sin()]);
            let along = |plus: Vector<2>, minus: Vector<2>| [0, 1].map(|d| (plus[d] - minus[d]) / (2.0 * step));
            let east = along(at(longitude + step, latitude), at(longitude - step, latitude));
            let north = along(at(longitude, latitude + step), at(longitude, latitude - step));
            let area = east[0] * north[1] - east[1] * north[0];
            assert!((area / latitude.cos() - 1.0).abs() < 1e-6, "{area}");
        }
    }
}
