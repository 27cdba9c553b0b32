//! Figures of one sample as SVG: [`heat_map`](heat_map::heat_map), [`radial`](radial::radial_figure),
//! [`angular`](angular::angular_figure), [`bond_map`](bond_map::bond_map), [`contact_map`](contact_map::contact_map),
//! [`isostatic`](isostatic::isostatic_figure), [`multipoles`](multipoles::multipole_figure),
//! [`correlation`](correlation::correlation_figure), [`spectrum`](spectrum::spectrum_figure),
//! [`radial_dependence`](radial_dependence::radial_dependence_figure).
//!
//! All have the same height and style, so that they fit in a row. The charts are drawn by plotters on a canvas ten
//! times finer than the picture, because plotters rounds positions to whole pixels. Maps are written directly, one
//! stroke per disk, bond or contact.

pub mod angular;
pub mod bond_map;
mod chart;
pub mod contact_map;
pub mod correlation;
pub mod heat_map;
pub mod isostatic;
mod layer;
pub(crate) mod log_axes;
pub mod map;
pub mod multipoles;
pub(crate) mod palette;
#[cfg(feature = "fit")]
pub(crate) mod plot;
pub mod radial;
pub mod radial_dependence;
pub mod shell_map;
pub mod slice_map;
pub mod spectrum;

/// Height of every figure \[px\].
pub const HEIGHT: u32 = 440;

/// Width of every figure \[px\].
pub const WIDTH: u32 = 460;

/// Why a figure could not be drawn.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FigureError {
    /// A number on an axis is not finite, so there is no range to draw.
    #[error("figure \"{title}\": {axis} has no finite range")]
    RangeNotFinite {
        /// The figure.
        title: String,
        /// The axis.
        axis: &'static str,
    },
    /// The drawing itself failed.
    #[error("figure \"{title}\": {reason}")]
    Drawing {
        /// The figure.
        title: String,
        /// The error of plotters.
        reason: String,
    },
}

/// Where an angular figure is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Around {
    /// A ring of disks: angle θ, frequency f.
    Ring,
    /// A row of disks along a strip of length L: place x, with θ = 2πx/L, frequency f = qL/2π.
    Row,
    /// A shell of spheres: great-circle angle γ, degree ℓ.
    Shell,
}

/// A picture with its title and a description for readers who cannot see it.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// A short title; unique on a page.
    pub title: String,
    /// The content, in a sentence.
    pub description: String,
    /// SVG elements, on a canvas of WIDTH × HEIGHT.
    elements: String,
}

impl Figure {
    /// A picture of these SVG elements.
    #[cfg(feature = "linear")]
    pub(crate) fn new(title: String, description: String, elements: String) -> Self {
        Figure { title, description, elements }
    }

    /// The SVG as a separate file.
    pub fn to_svg(&self) -> String {
        self.markup(r#" xmlns="http://www.w3.org/2000/svg""#)
    }

    /// The SVG as an HTML element, without a declaration of the name space.
    pub fn to_inline_svg(&self) -> String {
        self.markup("")
    }

    fn markup(&self, name_space: &str) -> String {
        format!(
            "<svg{name_space} viewBox=\"0 0 {WIDTH} {HEIGHT}\" width=\"{WIDTH}\" height=\"{HEIGHT}\" role=\"img\" \
             aria-label=\"{title}. {description}\" font-family=\"{FONT}\" fill=\"{INK}\">\n\
             <title>{title}</title>\n<desc>{description}</desc>\n{elements}</svg>\n",
            title = escaped(&self.title),
            description = escaped(&self.description),
            elements = self.elements,
        )
    }
}

/// r·d_r as SVG text with a subscript.
pub(crate) const RESCALED: &str = "r·d<tspan dy=\"3\" font-size=\"10\">r</tspan><tspan dy=\"-3\">\u{200B}</tspan>";

/// d_r, in a strip.
pub(crate) const DISPLACEMENT: &str = "d<tspan dy=\"3\" font-size=\"10\">r</tspan><tspan dy=\"-3\">\u{200B}</tspan>";

/// r²·d_r, for spheres.
pub(crate) const RESCALED_IN_SPACE: &str =
    "r²·d<tspan dy=\"3\" font-size=\"10\">r</tspan><tspan dy=\"-3\">\u{200B}</tspan>";

/// d_0^eff as SVG text.
#[cfg(feature = "fit")]
pub(crate) const AMPLITUDE: &str = "d<tspan dy=\"3\" font-size=\"10\">0</tspan><tspan dy=\"-8\" font-size=\"10\">eff</tspan>\
                                    <tspan dy=\"5\">\u{200B}</tspan>";

/// Fonts in order of preference.
pub(crate) const FONT: &str = "Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif";

/// Colour of text and axes.
pub(crate) const INK: &str = "#222222";

/// Escapes text for XML and HTML, including within double quotes.
pub(crate) fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            // XML allows no control characters except white space.
            letter if letter.is_control() && !letter.is_whitespace() => escaped.push('\u{FFFD}'),
            letter => escaped.push(letter),
        }
    }
    escaped
}
