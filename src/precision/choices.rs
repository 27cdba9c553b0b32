//! [`ChoiceTable`]: what other numerical choices move, measured on one sample.
//!
//! Ring widths and the range and search of the fit are varied on the first reference; the time step on one explicit trajectory
//! from the inflated start, whose reference is the same trajectory at a quarter of the shortest step; the routes to the screened
//! profile on the annulus of the sample.

use std::time::Instant;

use serde::Serialize;

use crate::contact::PairLaw;
use crate::contact::damping::{DampingChoice, DampingLaw};
use crate::inflation::{Grown, displacement};
use crate::packing::{Packing, PackingError};
use crate::precision::state::State;
use crate::reference::screened::Screened;
use crate::reference::{Annulus, RadialSolution};
use crate::relax::Motion;
use crate::scene::Observables;
use crate::vector::{larger, norm};

/// One choice and what it moves.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChoiceTable {
    /// Its name in files.
    pub name: &'static str,
    /// What is varied, and on what, for readers.
    pub title: &'static str,
    /// What the first column is, then the names of the numbers, with units.
    pub columns: Vec<&'static str>,
    /// One row a setting.
    pub rows: Vec<ChoiceRow>,
}

/// One setting.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChoiceRow {
    /// The setting.
    pub setting: String,
    /// A number a column; seconds, the last one, differ from one measurement to the next.
    pub values: Vec<Option<f64>>,
}

/// All tables of a sample.
pub(super) fn choice_tables<L: PairLaw>(
    state: &State,
    grown: &Grown<2>,
    law: &L,
    damping: DampingChoice,
    observables: &Observables,
) -> Result<Vec<ChoiceTable>, PackingError> {
    #[cfg(feature = "fit")]
    let mut tables = fits::tables(state, grown, observables);
    #[cfg(not(feature = "fit"))]
    let (mut tables, _) = (Vec::new(), observables);
    tables.push(match damping {
        DampingChoice::Constant(damping) => time_steps(grown, law, &damping)?,
        DampingChoice::Viscoelastic(damping) => time_steps(grown, law, &law.viscoelastic(damping.rate))?,
    });
    let wavenumber = state.measured.fitted.map_or(0.0, |fitted| fitted.wavenumber);
    tables.extend(routes(grown, wavenumber));
    Ok(tables)
}

#[cfg(feature = "fit")]
mod fits {
    use std::time::Instant;

    use super::{ChoiceRow, ChoiceTable};
    use crate::fit::profile::ProfileFitSettings;
    use crate::inflation::Grown;
    use crate::precision::state::{State, fit};
    use crate::scene::Observables;

    /// Widths of a ring \[length\].
    const RING_WIDTHS: [f64; 8] = [0.25, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0];

    pub(super) fn tables(state: &State, grown: &Grown<2>, observables: &Observables) -> Vec<ChoiceTable> {
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
}

/// Steps of the trajectory at the longest step; the others have 2, 4, 8 times as many.
const FEWEST_STEPS: usize = 200;

/// Longest step over the bound on a stable one at the start \[1\].
const LONGEST_STEP: f64 = 0.5;

fn time_steps<L: PairLaw, C: DampingLaw>(grown: &Grown<2>, law: &L, damping: &C) -> Result<ChoiceTable, PackingError> {
    let longest = LONGEST_STEP * Motion::new(&grown.packing, law, damping)?.stable_step();
    let place = |division: usize| -> Result<(Packing<2>, f64), PackingError> {
        let start = Instant::now();
        let mut motion = Motion::new(&grown.packing, law, damping)?;
        for _ in 0..division * FEWEST_STEPS {
            motion.step(longest / division as f64)?;
        }
        Ok((motion.assembly.placed(grown.packing.clone()), start.elapsed().as_secs_f64()))
    };
    let reference = place(32)?.0;
    let counts = |disk: &usize| grown.before.backbone[*disk] && !grown.packing.held()[*disk];
    let mut rows: Vec<ChoiceRow> = Vec::new();
    let mut last: Option<f64> = None;
    for division in [1, 2, 4, 8] {
        let (state, seconds) = place(division)?;
        let ways = (0..state.len()).filter(counts).map(|disk| norm(displacement(&reference, &state, disk)));
        let error = ways.fold(0.0, larger);
        let order = last.map(|last| (last / error).log2()).filter(|order| order.is_finite());
        last = Some(error);
        let share = LONGEST_STEP / division as f64;
        let values = vec![Some(longest / division as f64), Some(error), order, Some(seconds)];
        rows.push(ChoiceRow { setting: share.to_string(), values });
    }
    Ok(ChoiceTable {
        name: "time_step",
        title: "Time step of explicit damped dynamics: the same time from the inflated start",
        columns: vec!["step over the stable one (1)", "time step", "largest error (length)", "order (1)", "seconds"],
        rows,
    })
}

/// Points of a profile.
const POINTS: usize = 400;

/// Evaluations of a profile that are timed.
const REPEATS: usize = 20;

/// The closed formula with J and Y of `libm` against [`Screened`], on the annulus of the sample: κ of the fit and shares of
/// it. None where the annulus has no screened solution.
fn routes(grown: &Grown<2>, wavenumber: f64) -> Option<ChoiceTable> {
    let annulus = Annulus::new(grown.inner_radius, grown.outer_radius).ok()?;
    let (inner, outer) = (grown.inner_radius, grown.outer_radius);
    let radii: Vec<f64> = (0..POINTS).map(|i| inner + (i as f64 + 0.5) / POINTS as f64 * (outer - inner)).collect();
    let mut rows = Vec::new();
    // Where nothing was fitted, the first wavelength that fits the annulus.
    let largest = if wavenumber > 0.0 { wavenumber } else { 2.0 / outer };
    for share in [1.0, 1e-2, 1e-4, 1e-6] {
        let wavenumber = share * largest;
        let Ok(medium) = Screened::<2>::new(annulus, 1.0, wavenumber) else { continue };
        let bracket = |radius: f64| {
            let (x, rim) = (wavenumber * radius, wavenumber * outer);
            libm::y1(x) * libm::j1(rim) - libm::j1(x) * libm::y1(rim)
        };
        let at_disk = bracket(inner);
        let timed = |profile: &dyn Fn(f64) -> f64| {
            let start = Instant::now();
            let mut sum = 0.0;
            for _ in 0..REPEATS {
                sum += radii.iter().map(|&radius| profile(std::hint::black_box(radius))).sum::<f64>();
            }
            std::hint::black_box(sum);
            start.elapsed().as_secs_f64() / (REPEATS * POINTS) as f64
        };
        let closed = |radius: f64| bracket(radius) / at_disk;
        let most = radii.iter().map(|&radius| medium.value(radius).abs()).fold(0.0, larger);
        let errors = radii.iter().map(|&radius| (closed(radius) - medium.value(radius)).abs() / most);
        let values =
            vec![Some(errors.fold(0.0, larger)), Some(timed(&closed)), Some(timed(&|radius| medium.value(radius)))];
        rows.push(ChoiceRow { setting: format!("{wavenumber:.3e}"), values });
    }
    (!rows.is_empty()).then(|| ChoiceTable {
        name: "bessel_route",
        title: "Screened profile: the closed formula with J and Y of libm against the route used",
        columns: vec![
            "κ (1/length)",
            "largest difference over largest value (1)",
            "closed formula (s a point)",
            "seconds",
        ],
        rows,
    })
}
