//! Summary of the plastic part of a sample.

use crate::displacement::DisplacementField;
use crate::inflation::{Boundary, Inflated, Inflation, strip};
use crate::law::pair_law::PairLaw;
use crate::linear::LinearError;
use crate::linear::contact_changes::pressure_change;
use crate::observe::RadialProfile;
use crate::packing::ball_volume;
use crate::plastic::{PlasticPart, linear_response, load_factor};
use crate::run::PlasticSummary;

/// The summary and d − d_0 u of each disk, relative to the linear response of the state before, with the sites of the scene if it has any.
pub(super) fn of<const D: usize>(
    inflated: &Inflated<D>,
    inflation: &Inflation,
    law: &dyn PairLaw,
    ring_width: f64,
) -> Result<(PlasticSummary, DisplacementField<D>), LinearError> {
    let law = &*inflation.law_with_sites(law);
    let (before, centre) = (inflated.before.packing.get(), inflated.centre);
    let response = linear_response(inflated, law)?;
    let plastic = PlasticPart::of(inflated, &response);
    let changes = response.contact_changes(before, law)?;
    let increase = load_factor(inflated, &response);
    // Openings for an inflation; a deflation opens contacts for which the change has the other sign.
    let openings = changes.iter().filter_map(|change| change.opens_at().filter(|_| increase > 0.0));
    let per_increase = match inflation.boundary {
        Boundary::HeldRim { .. } => {
            // With a strain of the rim, dp = d(pV)/V − p dV/V.
            let compressed = inflated.before.pressure * (inflated.drive.strain::<D>().volume_ratio::<D>() - 1.0);
            pressure_change::<D>(&changes, ball_volume::<D>(inflated.outer_radius), |disk| disk > centre) - compressed
        }
        Boundary::Periodic => {
            pressure_change::<D>(&changes, before.domain().volume().unwrap_or(f64::INFINITY), |_| false)
        }
        Boundary::HeldWalls { .. } => {
            let area = strip::area(before.domain(), inflated.outer_radius);
            let is_row = |disk: usize| inflated.grown.binary_search(&disk).is_ok();
            pressure_change::<D>(&changes, area, |disk| before.held()[disk] && !is_row(disk))
        }
    };
    let summary = PlasticSummary {
        norm: plastic.norm,
        share: plastic.share,
        participation_ratio: plastic.participation_ratio,
        radial_profile: RadialProfile::of(&plastic.field, ring_width),
        first_opening: openings.reduce(f64::min),
        linear_pressure_change: increase * per_increase,
        negative_eigenvalue_count: response.negative_eigenvalue_count,
        backward_error: response.backward_error,
    };
    Ok((summary, plastic.field))
}
