//! Ring widths, and the range and search of the profile fit.

use std::time::Instant;

use crate::fit::profile::ProfileFitSettings;
use crate::inflation::Grown;
use crate::precision::numerical_choices::{ChoiceRow, ChoiceTable};
use crate::precision::state::{State, fit};
use crate::scene::Observables;

/// Widths of a ring \[length\].
const RING_WIDTHS: [f64; 8] = [0.25, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0];

pub(super) fn tables<const D: usize>(
    state: &State<D>,
    grown: &Grown<D>,
    observables: &Observables,
) -> Vec<ChoiceTable> {
    let width = observables.radial_profile.unwrap_or_default().ring_width;
    let settings = observables.profile_fit.unwrap_or_default();
    let field = state.field(grown);
    let row = |setting: String, width: f64, settings: &ProfileFitSettings| {
        let start = Instant::now();
        let fitted = fit(&field, width, settings);
        let seconds = start.elapsed().as_secs_f64();
        let of = |number: fn(&crate::precision::state::Fitted) -> f64| fitted.as_ref().map(number);
        let values = vec![
            of(|fitted| f64::from(u8::from(fitted.screened))),
            of(|fitted| fitted.wavenumber),
            of(|fitted| fitted.screened_amplitude),
            of(|fitted| fitted.elastic_amplitude),
            Some(seconds),
        ];
        ChoiceRow { setting, values }
    };
    let columns = |first| {
        let numbers = ["screened decided (1)", "κ (1/length)", "d_0^eff, screened (length)"];
        [&[first], &numbers[..], &["d_0^eff, elastic (length)", "seconds"]].concat()
    };
    let mut ranges = Vec::new();
    for inner_margin in [1.0, 2.0, 4.0] {
        for rim_margin in [0.0, 1.0, 2.0] {
            let varied = ProfileFitSettings { inner_margin, rim_margin, ..settings };
            ranges.push(row(format!("{inner_margin} and {rim_margin}"), width, &varied));
        }
    }
    let searches = [4.0, 8.0, 16.0].map(|rings_per_wavelength| {
        let varied = ProfileFitSettings { rings_per_wavelength, ..settings };
        row(rings_per_wavelength.to_string(), width, &varied)
    });
    vec![
        ChoiceTable {
            name: "ring_width",
            title: "Width of the rings of the radial profile",
            columns: columns("ring width (length)"),
            rows: RING_WIDTHS.map(|width| row(width.to_string(), width, &settings)).into(),
        },
        ChoiceTable {
            name: "fit_range",
            title: "Margins of the fit at the disk and at the rim",
            columns: columns("margins (disk diameters)"),
            rows: ranges,
        },
        ChoiceTable {
            name: "fit_search",
            title: "Shortest wavelength searched by the fit",
            columns: columns("rings per wavelength (1)"),
            rows: searches.into(),
        },
    ]
}
