//! Colours that colour-blind readers can distinguish.

/// Colours of lines and points. Source: Okabe, Ito (2008), Color universal design.
pub(crate) const BLUE: [u8; 3] = [0x00, 0x72, 0xB2];
/// See [`BLUE`].
pub(crate) const VERMILLION: [u8; 3] = [0xD5, 0x5E, 0x00];
/// See [`BLUE`].
pub(crate) const GREEN: [u8; 3] = [0x00, 0x9E, 0x73];
/// See [`BLUE`].
pub(crate) const PURPLE: [u8; 3] = [0xCC, 0x79, 0xA7];
/// See [`BLUE`].
pub(crate) const ORANGE: [u8; 3] = [0xE6, 0x9F, 0x00];
/// See [`BLUE`].
pub(crate) const SKY: [u8; 3] = [0x56, 0xB4, 0xE9];

/// Colours of several curves, in this order, then repeated; the first three as in the study, fig. 1.
pub(crate) const SEQUENCE: [[u8; 3]; 6] = [PURPLE, GREEN, VERMILLION, BLUE, ORANGE, SKY];

/// Dark to light, for ordered series. Source: viridis (Smith, van der Walt 2015, CC0), five of its colours.
#[cfg(feature = "fit")]
const ORDERED: [[u8; 3]; 5] =
    [[0x44, 0x01, 0x54], [0x3B, 0x52, 0x8B], [0x21, 0x90, 0x8C], [0x5D, 0xC8, 0x63], [0xE3, 0xC5, 0x1E]];

/// The colour of one of `count` ordered series.
#[cfg(feature = "fit")]
pub(crate) fn ordered(index: usize, count: usize) -> [u8; 3] {
    let place = index as f64 / count.saturating_sub(1).max(1) as f64 * (ORDERED.len() - 1) as f64;
    let class = (place as usize).min(ORDERED.len() - 2);
    mixed(ORDERED[class], ORDERED[class + 1], place - class as f64)
}

/// Purple through white to orange. Source: ColorBrewer 2.0 (Brewer, Harrower), PuOr in 11 classes, "colorblind safe".
const DIVERGING: [[u8; 3]; 11] = [
    [0x2D, 0x00, 0x4B],
    [0x54, 0x27, 0x88],
    [0x80, 0x73, 0xAC],
    [0xB2, 0xAB, 0xD2],
    [0xD8, 0xDA, 0xEB],
    [0xF7, 0xF7, 0xF7],
    [0xFE, 0xE0, 0xB6],
    [0xFD, 0xB8, 0x63],
    [0xE0, 0x82, 0x14],
    [0xB3, 0x58, 0x06],
    [0x7F, 0x3B, 0x08],
];

/// Red through white to blue. Source: ColorBrewer 2.0 (Brewer, Harrower), RdBu in 11 classes, "colorblind safe"; the
/// middle is white, the colour of the page.
const RED_OVER_BLUE: [[u8; 3]; 11] = [
    [0x67, 0x00, 0x1F],
    [0xB2, 0x18, 0x2B],
    [0xD6, 0x60, 0x4D],
    [0xF4, 0xA5, 0x82],
    [0xFD, 0xDB, 0xC7],
    [0xFF, 0xFF, 0xFF],
    [0xD1, 0xE5, 0xF0],
    [0x92, 0xC5, 0xDE],
    [0x43, 0x93, 0xC3],
    [0x21, 0x66, 0xAC],
    [0x05, 0x30, 0x61],
];

/// The colour of a value in −1 … 1: purple below zero, orange above; values outside have the colour of the end.
pub(crate) fn diverging(value: f64) -> [u8; 3] {
    between(&DIVERGING, value)
}

/// Like [`diverging`]: red below zero, blue above.
pub(crate) fn red_over_blue(value: f64) -> [u8; 3] {
    between(&RED_OVER_BLUE, value)
}

fn between(scale: &[[u8; 3]; 11], value: f64) -> [u8; 3] {
    let place = (value.clamp(-1.0, 1.0) + 1.0) / 2.0 * (scale.len() - 1) as f64;
    let class = (place as usize).min(scale.len() - 2);
    mixed(scale[class], scale[class + 1], place - class as f64)
}

fn mixed(low: [u8; 3], high: [u8; 3], share: f64) -> [u8; 3] {
    std::array::from_fn(|i| (f64::from(low[i]) + share * (f64::from(high[i]) - f64::from(low[i]))).round() as u8)
}

/// The colour as `#rrggbb`.
pub(crate) fn hexadecimal([red, green, blue]: [u8; 3]) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_has_its_classes_at_equal_distances() {
        assert_eq!(diverging(-1.0), DIVERGING[0]);
        assert_eq!(diverging(0.0), DIVERGING[5]);
        assert_eq!(diverging(0.2), DIVERGING[6]);
        assert_eq!(diverging(7.0), DIVERGING[10]);
        assert_eq!((red_over_blue(-1.0), red_over_blue(0.0)), (RED_OVER_BLUE[0], [0xFF; 3]));
        assert_eq!(hexadecimal(BLUE), "#0072b2");
    }
}
