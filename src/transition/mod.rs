//! [`Transition`]: the results of a study on the plastic-to-elastic transition, on jamming, and on their scaling.
//!
//! ```text
//! series = cells that differ only in the pressure        p̂ = p N^(α−1)
//! p̂_c    by κ_fit, by the sign of Δp, by G* and θ* at their values of a scale-free spectrum, by the slope of S(f), by f† → 0
//! θ† ∼ (p̂_c − p̂)^(−μ)        G*, θ* = F(p N^a d_0^(−b))        N^β p_c ∼ (N² d_0)^(β/4)        ξ ∼ (φ_J − φ)^(−ν)
//! ```
//!
//! Every number has an interval, from resampling the samples of every cell
//! ([`bootstrap_all`](crate::fit::ensemble::bootstrap_all)). A number without a result or with too little evidence has
//! a reason: [`CannotTell`].
//!
//! Packings relaxed by different methods are in separate series, and no law is fitted through several of them.
//!
//! # Source
//! The study; details are given with each number.

mod calibration;
mod crossing;
mod estimates;
mod evidence;
mod lengths;
mod literature;
mod pressure;
mod scaling;
mod series;
mod series_point;
mod spectra;

use serde::Serialize;

pub use evidence::{CannotTell, Sampled};
pub use lengths::{JammingSeries, LengthPoint, Lengths, PenetrationPoint};
pub use literature::{Comparison, Verdict};
pub use pressure::{Method, MethodEstimate, TransitionPressure};
pub use scaling::{ExponentOutcome, PressureLaw, Scaling};
pub use series::{AtPressure, Series};
pub use series_point::SeriesPoint;
pub use spectra::{AngleDivergence, CellSpectrum, RingSlope};

#[cfg(feature = "plot")]
pub(crate) use evidence::{LEAST_CELLS, LEAST_SAMPLES};
#[cfg(feature = "plot")]
pub(crate) use lengths::{ISOSTATIC_THRESHOLD, JAMMING};
#[cfg(feature = "plot")]
pub(crate) use literature::words;
#[cfg(feature = "plot")]
pub(crate) use pressure::{SCALE_FREE_ANGLE, SCALE_FREE_ANTICORRELATION, poles};
#[cfg(feature = "plot")]
pub(crate) use scaling::{beta, laws_and_relaxers};
#[cfg(feature = "plot")]
pub(crate) use series::PUBLISHED;
#[cfg(feature = "plot")]
pub(crate) use series_point::{ANGLE, ANTICORRELATION};

use crate::response::Calibration;
use crate::study::Merged;

/// The results of a study.
#[derive(Debug, Clone, Serialize)]
pub struct Transition {
    /// Cells above jamming that differ only in the pressure, in the order of the plan.
    pub series: Vec<Series>,
    /// Scaling of the series of a law and relaxer, one entry per observable.
    pub scaling: Vec<Scaling>,
    /// p_c of all series of a law and relaxer as a power law.
    pub pressure_laws: Vec<PressureLaw>,
    /// ξ below jamming, by size.
    pub jamming: Vec<JammingSeries>,
    /// Results next to published values.
    pub comparisons: Vec<Comparison>,
    /// How often samples are classified as plastic or quasielastic, by type of evidence and pressure.
    pub calibration: Calibration,
}

impl Transition {
    /// The results of a merged study.
    ///
    /// # Cost
    /// Some seconds for a study of ten cells of a hundred samples: 400 resamplings of every number.
    pub fn of(merged: &Merged) -> Self {
        let series = Series::all(merged);
        // The scaling is that of p̂: a strip has none, and a free centre is another experiment.
        let scaled: Vec<Series> = series.iter().filter(|one| one.cell.scales()).cloned().collect();
        let scaling = Scaling::all(merged, &scaled);
        let pressure_laws = PressureLaw::all(&scaled);
        let jamming = JammingSeries::all(merged);
        let comparisons = literature::comparisons(&series, &scaling, &pressure_laws, &jamming);
        let calibration = calibration::calibration(merged, &series);
        Transition { series, scaling, pressure_laws, jamming, comparisons, calibration }
    }
}
