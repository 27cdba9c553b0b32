//! [`Layer`]: the strokes of a map, as vectors or, if there are many, as one raster image.
//!
//! A browser draws ten thousand strokes immediately but takes seconds for a hundred thousand. The size of an image does
//! not depend on their number.

use std::fmt::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use tiny_skia::{Color, LineCap, Paint, PathBuilder, Pixmap, Stroke, Transform};

use crate::report::figures::palette::hexadecimal;

/// Largest number of strokes drawn as vectors.
pub(crate) const MOST_VECTORS: usize = 20_000;

/// Image pixels per pixel of the picture: sharp on high-resolution screens and in print at 6 cm.
const SHARPNESS: f32 = 3.0;

/// A segment between two points.
pub(crate) type Segment = [[i64; 2]; 2];

/// Strokes of one style. Points are strokes of zero length. Coordinates and width are tenths of a pixel, relative to
/// the origin of the layer.
pub(crate) struct Group {
    pub colour: String,
    pub width: i64,
    pub opacity: f32,
    pub strokes: Vec<Segment>,
}

/// Groups of strokes, each drawn over the ones before.
pub(crate) struct Layer {
    pub groups: Vec<Group>,
}

impl Group {
    /// Opaque strokes.
    pub(crate) fn new(colour: [u8; 3], width: i64, strokes: Vec<Segment>) -> Self {
        Group { colour: hexadecimal(colour), width, opacity: 1.0, strokes }
    }

    /// A path in which each stroke is relative to the end of the last one.
    fn vectors(&self) -> String {
        let mut path = String::new();
        let [mut last_x, mut last_y] = [0, 0];
        for &[[x, y], [end_x, end_y]] in &self.strokes {
            let _ = write!(path, "m{} {}", x - last_x, y - last_y);
            let _ = match (end_x - x, end_y - y) {
                (0, 0) => write!(path, "h0"),
                (dx, dy) => write!(path, "l{dx} {dy}"),
            };
            [last_x, last_y] = [end_x, end_y];
        }
        let opacity = if self.opacity < 1.0 { format!(" stroke-opacity=\"{}\"", self.opacity) } else { String::new() };
        format!("<path stroke=\"{}\"{opacity} stroke-width=\"{}\" d=\"{path}\"/>\n", self.colour, self.width)
    }
}

impl Layer {
    /// SVG elements around `origin` \[px\]; `half` is half the side of the square that contains them \[px\].
    pub(crate) fn markup(&self, origin: [f64; 2], half: f64) -> String {
        let [x, y] = origin;
        let count: usize = self.groups.iter().map(|group| group.strokes.len()).sum();
        let image = if count > MOST_VECTORS { self.image(half) } else { None };
        match image {
            Some(image) => format!(
                "<image x=\"{}\" y=\"{}\" width=\"{2}\" height=\"{2}\" href=\"data:image/png;base64,{image}\"/>\n",
                x - half,
                y - half,
                2.0 * half
            ),
            None => format!(
                "<g transform=\"translate({x} {y}) scale(.1)\" fill=\"none\" stroke-linecap=\"round\">\n{}</g>\n",
                self.groups.iter().map(Group::vectors).collect::<String>()
            ),
        }
    }

    /// The strokes as a base-64 PNG; none if there is not enough memory.
    fn image(&self, half: f64) -> Option<String> {
        let side = (2.0 * half as f32 * SHARPNESS).ceil() as u32;
        let mut pixels = Pixmap::new(side, side)?;
        // From tenths of a pixel relative to the middle to image pixels relative to the corner.
        let middle = half as f32 * SHARPNESS;
        let to_image = Transform::from_row(0.1 * SHARPNESS, 0.0, 0.0, 0.1 * SHARPNESS, middle, middle);
        for group in &self.groups {
            let mut paint = Paint::default();
            let mut colour = colour_of(&group.colour);
            colour.apply_opacity(group.opacity);
            paint.set_color(colour);
            paint.anti_alias = true;
            let radius = 0.5 * group.width as f32;
            let stroke = Stroke { width: group.width as f32, line_cap: LineCap::Round, ..Stroke::default() };
            for &[start, end] in &group.strokes {
                let [[x, y], [end_x, end_y]] = [start, end].map(|point| point.map(|value| value as f32));
                let mut path = PathBuilder::new();
                if start == end {
                    path.push_circle(x, y, radius);
                } else {
                    path.move_to(x, y);
                    path.line_to(end_x, end_y);
                }
                let Some(path) = path.finish() else { continue };
                if start == end {
                    pixels.fill_path(&path, &paint, tiny_skia::FillRule::Winding, to_image, None);
                } else {
                    pixels.stroke_path(&path, &paint, &stroke, to_image, None);
                }
            }
        }
        Some(STANDARD.encode(pixels.encode_png().ok()?))
    }
}

/// The colour of a text `#rrggbb`; black if the text is invalid.
fn colour_of(text: &str) -> Color {
    let channel = |place: usize| text.get(place..place + 2).and_then(|digits| u8::from_str_radix(digits, 16).ok());
    match (channel(1), channel(3), channel(5)) {
        (Some(red), Some(green), Some(blue)) => Color::from_rgba8(red, green, blue, 255),
        _ => Color::BLACK,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(count: i64) -> Layer {
        let strokes = (0..count).map(|i| [[i % 100, i / 100]; 2]).collect();
        Layer { groups: vec![Group::new([255, 0, 0], 10, strokes)] }
    }

    #[test]
    fn few_strokes_are_vectors_and_many_an_image() {
        let few = points(MOST_VECTORS as i64).markup([0.0, 0.0], 100.0);
        assert_eq!(few.matches("h0").count(), MOST_VECTORS);
        let many = points(MOST_VECTORS as i64 + 1).markup([0.0, 0.0], 100.0);
        assert!(
            many.starts_with("<image x=\"-100\" y=\"-100\" width=\"200\" height=\"200\" href=\"data:image/png;base64,")
        );
        assert!(many.len() < few.len());
    }

    #[test]
    fn an_image_has_a_point_where_it_stands() {
        // A red point of radius 2 px at (10, −20) px from the middle of a square of 100 px.
        let layer = Layer { groups: vec![Group::new([255, 0, 0], 40, vec![[[100, -200]; 2]])] };
        let encoded = layer.image(50.0).expect("memory for 300 × 300 pixels");
        let image = Pixmap::decode_png(&STANDARD.decode(encoded).expect("base 64")).expect("a picture");
        let alpha = |x: f32, y: f32| {
            let pixel = image.pixel((3.0 * (50.0 + x)) as u32, (3.0 * (50.0 + y)) as u32).expect("within");
            (pixel.alpha(), pixel.red(), pixel.blue())
        };
        assert_eq!(alpha(10.0, -20.0), (255, 255, 0));
        assert_eq!(alpha(11.5, -20.0), (255, 255, 0));
        assert_eq!(alpha(13.0, -20.0), (0, 0, 0));
        assert_eq!(alpha(-10.0, 20.0), (0, 0, 0));
    }
}
