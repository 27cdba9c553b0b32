//! [`Transition`]: what a study says of the plastic-to-elastic transition, of jamming, and of how both scale.
//!
//! ```text
//! series = cells that differ in the pressure alone        p̂ = p N^(α−1)
//! p̂_c    by κ_fit, by the sign of Δp, by G* and θ* at their values of a scale-free spectrum, by the slope of S(f), by f† → 0
//! θ† ∼ (p̂_c − p̂)^(−μ)        G*, θ* = F(p N^a d_0^(−b))        N^β p_c ∼ (N² d_0)^(β/4)        ξ ∼ (φ_J − φ)^(−ν)
//! ```
//!
//! Everything has an interval: the samples of every cell are drawn anew, [`bootstrap_all`](crate::fit::ensemble::bootstrap_all). What
//! cannot be had says why, and what rests on too little says so: [`CannotTell`].
//!
//! Series that differ in how their packings come to rest are series of their own, and no law is fitted through several of them.
//!
//! # Source
//! The study; what is taken from where stands with each number.

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
pub(crate) use pressure::{FIRST_ZERO, SCALE_FREE_ANGLE, SCALE_FREE_ANTICORRELATION};
#[cfg(feature = "plot")]
pub(crate) use scaling::{beta, laws_and_relaxers};
#[cfg(feature = "plot")]
pub(crate) use series::PUBLISHED;
#[cfg(feature = "plot")]
pub(crate) use series_point::{ANGLE, ANTICORRELATION};

use crate::response::Calibration;
use crate::study::Merged;

/// What a study says.
#[derive(Debug, Clone, Serialize)]
pub struct Transition {
    /// Cells above jamming that differ in the pressure alone, in the order of the plan.
    pub series: Vec<Series>,
    /// How the series of a law and relaxer scale, one an observable.
    pub scaling: Vec<Scaling>,
    /// p_c of all series of a law and relaxer as one power law.
    pub pressure_laws: Vec<PressureLaw>,
    /// ξ below jamming, by size.
    pub jamming: Vec<JammingSeries>,
    /// What was found beside what is published.
    pub comparisons: Vec<Comparison>,
    /// How often samples are called plastic or quasielastic, by which evidence, at which pressure.
    pub calibration: Calibration,
}

impl Transition {
    /// Of a merged study.
    ///
    /// # Cost
    /// Some seconds for a study of ten cells of a hundred samples: 400 resamplings of everything.
    pub fn of(merged: &Merged) -> Self {
        let series = Series::all(merged);
        let scaling = Scaling::all(merged, &series);
        let pressure_laws = PressureLaw::all(&series);
        let jamming = JammingSeries::all(merged);
        let comparisons = literature::comparisons(&series, &scaling, &pressure_laws, &jamming);
        let calibration = calibration::calibration(merged, &series);
        Transition { series, scaling, pressure_laws, jamming, comparisons, calibration }
    }
}
