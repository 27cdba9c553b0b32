//! The loop under the roofs of the machine: pairs a second against pairs a byte, both axes logarithmic.

use std::path::Path;

use plotters::prelude::*;

use crate::{Failure, Row};

/// Ranges of the axes: pairs a byte, pairs a second.
const BYTES: (f64, f64) = (0.003, 0.06);
const PAIRS: (f64, f64) = (2e7, 2e9);

/// Bytes the loop moves: what the list has of a pair; displacement read, force cleared, read and written of a disk.
fn bytes(row: &Row) -> f64 {
    const DISK: f64 = 4.0 * 16.0;
    (row.pair_size * row.pairs) as f64 + DISK * row.disks as f64
}

/// Draws the loop at each size under the bandwidths and the roots.
pub fn draw(path: &Path, rows: &[Row], bandwidths: &[(&str, f64)], roots: f64) -> Result<(), Failure> {
    let partial = path.with_extension("svg.part");
    {
        let root = SVGBackend::new(&partial, (720, 440)).into_drawing_area();
        root.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(&root)
            .margin(12)
            .x_label_area_size(44)
            .y_label_area_size(96)
            .build_cartesian_2d((BYTES.0..BYTES.1).log_scale(), (PAIRS.0..PAIRS.1).log_scale())?;
        chart
            .configure_mesh()
            .x_desc("pairs per byte moved")
            .y_desc("pairs per second, one thread")
            .axis_desc_style(("sans-serif", 15))
            .label_style(("sans-serif", 13))
            .x_labels(5)
            .y_labels(5)
            .light_line_style(TRANSPARENT)
            .x_label_formatter(&|x| format!("{x}"))
            .y_label_formatter(&|y| format!("{:.0} million", y * 1e-6))
            .draw()?;
        let colours = [RGBColor(0, 114, 178), RGBColor(0, 158, 115), RGBColor(213, 94, 0)];
        for ((name, bandwidth), colour) in bandwidths.iter().zip(colours) {
            // From edge to edge of the chart: what leaves it is not cut but bent.
            let line = [BYTES.0.max(PAIRS.0 / bandwidth), BYTES.1.min(PAIRS.1 / bandwidth)].map(|x| (x, x * bandwidth));
            chart
                .draw_series(LineSeries::new(line, colour.stroke_width(2)))?
                .label(format!("{name}, {:.0} GB/s", bandwidth * 1e-9))
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2)));
        }
        let ceiling = [(BYTES.0, 1.0 / roots), (BYTES.1, 1.0 / roots)];
        chart
            .draw_series(LineSeries::new(ceiling, BLACK.stroke_width(2)))?
            .label("two roots and a division a pair")
            .legend(|(x, y)| PathElement::new([(x, y), (x + 18, y)], BLACK.stroke_width(2)));
        let point =
            |row: &Row| (row.pairs as f64 / bytes(row), row.pairs as f64 / (row.forces * 1e-9 * row.disks as f64));
        // The same bytes a pair at many sizes: side by side they can be told apart.
        let spread = |index: usize| 1.04f64.powf(index as f64 - 0.5 * rows.len() as f64);
        let points = rows.iter().enumerate().map(|(index, row)| {
            let (x, y) = point(row);
            Circle::new((x * spread(index), y), 4, RGBColor(204, 121, 167).filled())
        });
        chart
            .draw_series(points)?
            .label("the loop, 10³ disks (left) to 10⁶ (right)")
            .legend(|(x, y)| Circle::new((x + 9, y), 4, RGBColor(204, 121, 167).filled()));
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::LowerRight)
            .label_font(("sans-serif", 13))
            .background_style(WHITE.mix(0.85))
            .border_style(BLACK.mix(0.3))
            .draw()?;
        root.present()?;
    }
    std::fs::rename(partial, path)?;
    Ok(())
}
