//! [`angular_figure`]: r·d_r against the angle, one colour per ring.

use std::f64::consts::PI;

use plotters::prelude::*;

use crate::observe::AngularProfile;
use crate::report::figures::chart::{Chart, Entry, LegendLine, SCALE, Sign};
use crate::report::figures::palette::SEQUENCE;
use crate::report::figures::radial::with_margin;
use crate::report::figures::{Around, DISPLACEMENT, Figure, FigureError, RESCALED};

/// Entries per line of the legend.
const ENTRIES_A_LINE: usize = 3;

/// The angular profiles of a sample: one point per disk of a ring, connected in the order of their angles.
///
/// # Errors
/// A profile without a finite number.
pub fn angular_figure(name: &str, around: Around, profiles: &[AngularProfile]) -> Result<Figure, FigureError> {
    let is_row = around == Around::Row;
    let colour = |index: usize| SEQUENCE[index % SEQUENCE.len()];
    let entries: Vec<(usize, &AngularProfile)> = profiles.iter().enumerate().collect();
    let legend = entries.chunks(ENTRIES_A_LINE).map(|line| {
        let entry = |&(index, profile): &(usize, &AngularProfile)| Entry {
            sign: Sign::PointOnLine(colour(index)),
            text: format!("r/R = {}", profile.relative_radius),
        };
        LegendLine(line.iter().map(entry).collect())
    });
    let values = profiles.iter().flat_map(|profile| points(profile, is_row).map(|(_, value)| value));
    let chart = Chart {
        title: format!("{name}: angular profiles"),
        description: format!(
            "{} of the disks in {} {}",
            if is_row { "Displacement d_r away from the line" } else { "Rescaled radial displacement r·d_r" },
            profiles.len(),
            if is_row { "rows against their place x along the strip" } else { "rings against their angle θ" }
        ),
        x_label: if is_row { "2x/L" } else { "θ/π" },
        x_range: [-1.0, 1.0],
        y_label: if is_row { DISPLACEMENT } else { RESCALED },
        y_unit: if is_row { "length" } else { "length²" },
        y_range: with_margin(values),
        legend: legend.collect(),
    };
    chart.draw(|axes, scaling| {
        for (index, profile) in profiles.iter().enumerate() {
            let [red, green, blue] = colour(index);
            let style = RGBColor(red, green, blue);
            let scaled: Vec<(f64, f64)> = points(profile, is_row).map(|(x, y)| (x, scaling.apply(y))).collect();
            axes.draw_series(LineSeries::new(scaled.iter().copied(), style.stroke_width(SCALE * 7 / 10)))?;
            let radius = f64::from(SCALE) * 1.6;
            axes.draw_series(scaled.iter().map(|&point| Circle::new(point, radius, style.filled())))?;
        }
        Ok(())
    })
}

/// (θ/π, r·d_r) of the disks of a ring, (2x/L, d_r) of a row; values that are not finite are left out.
fn points(profile: &AngularProfile, is_row: bool) -> impl Iterator<Item = (f64, f64)> {
    let weight = move |distance: f64| if is_row { 1.0 } else { distance };
    let values =
        profile.radial.iter().zip(&profile.distances).map(move |(radial, &distance)| radial * weight(distance));
    profile.angles.iter().map(|angle| angle / PI).zip(values).filter(|(_, value)| value.is_finite())
}
