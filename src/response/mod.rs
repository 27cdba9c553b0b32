//! [`Response`]: all observables of the response of a packing to an inflation.
//!
//! A response is computed from two states, before and after. A run makes them; an [`analysis`](crate::analysis) reads
//! them from files. Only what [`Observables`] requests is computed. An observable that cannot be computed is
//! [`Measurement::Refused`] with a reason. A phase and fits require the permit of a [`RestVerdict`].

mod calibration;
mod contacts;
mod detail;
mod measurement;
mod phase;
mod shell;

use serde::Serialize;

pub use calibration::{
    CalibratedCell, CalibratedEnsemble, Calibration, Conditions, EvidenceCounts, PhaseFrequency, WordCounts,
};
pub use contacts::{ContactChangeCounts, ContactSummary, CycleCounts};
pub(crate) use detail::in_dimension;
pub use detail::{Detail, DetailOf};
pub use measurement::Measurement;
pub use phase::{Evidence, Phase, PhaseDecision, PhaseOutcome};
pub use shell::ShellResponse;

use crate::displacement::{DisplacementField, MeasuredOn};
#[cfg(feature = "fit")]
use crate::fit::angular::{CrossoverFit, CrossoverOutcome, SlopeFit, SlopeOutcome, fit_crossover, fit_slope};
#[cfg(feature = "fit")]
use crate::fit::modes::{ElasticModesFit, fit_elastic_modes};
#[cfg(feature = "fit")]
use crate::fit::profile::{Decision, ProfileFit, fit_radial_profile};
use crate::inflation::Drive;
use crate::observe::angular::{
    AngularCorrelation, AngularError, PowerSpectrum, RingAnalysis, RingSample, radial_dependence,
};
use crate::observe::bond_changes::BondChanges;
use crate::observe::isostatic::IsostaticLength;
use crate::observe::penetration_length::PenetrationLength;
use crate::observe::state::State;
use crate::observe::{AngularProfile, Multipoles, RadialProfile};
#[cfg(feature = "fit")]
use crate::reference::{Annulus, poles::pole};
use crate::response::phase::{by_contact_changes, by_pressure_change};
use crate::scene::{AngularCorrelationSettings, Observables};
use crate::verdict::RestVerdict;

/// The states of a response.
pub struct Subject<'a, const D: usize> {
    /// Whether they are at rest.
    pub verdict: RestVerdict,
    /// The displacement field from the first to the second.
    pub field: DisplacementField<D>,
    /// State before the inflation.
    pub before: State<'a, D>,
    /// State after it.
    pub after: State<'a, D>,
    /// State after the deflation, if there was one.
    pub deflated: Option<State<'a, D>>,
    /// Index of the inflated disk in all of them.
    pub centre: usize,
    /// What was done.
    pub drive: Drive,
    /// Δp \[force / length\].
    pub pressure_change: f64,
}

/// Smallest slope of a power law that counts as elastic: the published one at p_c.
#[cfg(feature = "fit")]
const SCALE_FREE_SLOPE: f64 = 1.5;

/// All observables of a response; those not requested are absent.
#[derive(Debug, Clone, Serialize)]
pub struct Response {
    /// Whether the states are at rest, so that a phase and fits may be reported.
    pub verdict: RestVerdict,
    /// Which disks the observables include.
    pub measured_on: MeasuredOn,
    /// The phase of the packing.
    pub phase: PhaseDecision,
    /// Mean radial displacement in rings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radial_profile: Option<RadialProfile>,
    /// The fits to the radial profile.
    #[cfg(feature = "fit")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub profile_fit: Option<Measurement<ProfileFit>>,
    /// ξ at every threshold.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub penetration_lengths: Option<Measurement<Vec<PenetrationLength>>>,
    /// Radial displacement against angle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angular_profiles: Option<Vec<AngularProfile>>,
    /// Spectrum and correlation of one ring.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angular_correlation: Option<Measurement<RingResponse>>,
    /// Spectrum and correlation in rings from the inflated disk to the rim.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radial_dependence: Option<Measurement<Vec<RingAnalysis>>>,
    /// Spectrum and correlation of one shell of spheres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shell_correlation: Option<Measurement<ShellResponse>>,
    /// Angular modes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub multipoles: Option<Measurement<Multipoles>>,
    /// The elastic modes fitted to them.
    #[cfg(feature = "fit")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub elastic_modes: Option<Measurement<ElasticModesFit>>,
    /// Contacts made, broken and returned.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact_changes: Option<ContactSummary>,
    /// ℓ_iso.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub isostatic_length: Option<Measurement<IsostaticLength>>,
    /// The displacement field, the stretch of every bond and the changed contacts.
    #[serde(skip)]
    pub detail: Detail,
    /// Labels of all disks, by their indices in the field, the bonds and the contacts.
    #[serde(skip)]
    pub labels: Vec<u64>,
}

/// Spectrum and correlation of one ring, and the fits to the spectrum.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RingResponse {
    /// Midpoint of the ring, r̂ \[1\].
    pub relative_radius: f64,
    /// S(f).
    pub spectrum: PowerSpectrum,
    /// G(θ), G*, θ*.
    pub correlation: AngularCorrelation,
    /// Slope of log S against log f.
    #[cfg(feature = "fit")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slope: Option<Measurement<SlopeFit>>,
    /// f† and θ†.
    #[cfg(feature = "fit")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crossover: Option<Measurement<CrossoverFit>>,
}

impl Response {
    /// Computes the requested observables; the settings must have been [checked](Observables::check).
    pub fn of<const D: usize>(subject: Subject<'_, D>, observables: &Observables) -> Self {
        let Subject { verdict, field, before, after, deflated, centre, drive, pressure_change } = subject;
        let increase = after.packing.radii()[centre] - before.packing.radii()[centre];
        let no_fit = no_fit(&verdict, increase, &drive);
        let radial_profile = observables.radial_profile.map(|settings| RadialProfile::of(&field, settings.ring_width));
        let plane = field.in_plane();
        let multipoles: Option<Measurement<Multipoles>> =
            observables.multipoles.zip(plane).map(|(settings, field)| Multipoles::of(field, &settings).into());
        let (contact_summary, contact_changes) =
            observables.contact_changes.map(|_| ContactSummary::of(&before, &after, deflated.as_ref(), centre)).unzip();
        let bond_changes =
            observables.bond_changes.map(|settings| BondChanges::between(&before, &after, centre, settings.bonds));
        let mut response = Response {
            verdict,
            measured_on: field.measured_on,
            phase: PhaseDecision::default(),
            #[cfg(feature = "fit")]
            profile_fit: observables.profile_fit.zip(radial_profile.as_ref()).map(|(settings, profile)| {
                if let Some(reason) = &no_fit {
                    return Measurement::Refused(reason.clone());
                }
                if !drive.is_inflation() {
                    return Measurement::Refused("the profiles fitted are those of an inflation".into());
                }
                match Annulus::new(field.inner_radius, field.outer_radius) {
                    Ok(annulus) => match field.spreading_dimension() {
                        1 => fit_radial_profile::<1>(profile, annulus, &settings).into(),
                        _ => fit_radial_profile::<D>(profile, annulus, &settings).into(),
                    },
                    Err(error) => Measurement::Refused(error.to_string()),
                }
            }),
            penetration_lengths: observables
                .penetration_length
                .as_ref()
                .zip(radial_profile.as_ref())
                .map(|(settings, profile)| PenetrationLength::of(profile, settings).into()),
            radial_profile,
            angular_profiles: observables.angular_profiles.as_ref().zip(plane).map(|(settings, field)| {
                settings.relative_radii.iter().map(|&radius| AngularProfile::of(field, radius)).collect()
            }),
            angular_correlation: observables
                .angular_correlation
                .as_ref()
                .zip(plane)
                .map(|(settings, field)| RingResponse::of(field, settings, observables, no_fit.as_deref()).into()),
            radial_dependence: observables
                .radial_dependence
                .as_ref()
                .zip(plane)
                .map(|(settings, field)| radial_dependence(field, settings).into()),
            shell_correlation: observables
                .shell_correlation
                .as_ref()
                .zip(field.in_space())
                .map(|(settings, field)| ShellResponse::of(field, settings, observables, no_fit.as_deref()).into()),
            #[cfg(feature = "fit")]
            elastic_modes: observables.elastic_modes.zip(multipoles.as_ref().and_then(Measurement::measured)).map(
                |(settings, modes)| match &no_fit {
                    Some(reason) => Measurement::Refused(reason.clone()),
                    None => fit_elastic_modes(modes, field.outer_radius, &settings).into(),
                },
            ),
            multipoles,
            contact_changes: contact_summary,
            isostatic_length: observables.isostatic_length.map(|settings| {
                IsostaticLength::between(&before, &after, centre, field.outer_radius, &settings).into()
            }),
            labels: before.packing.labels().to_vec(),
            detail: Detail::of(DetailOf { field, bond_changes, contact_changes }),
        };
        response.phase = response.phase(pressure_change, increase, &drive);
        response
    }

    /// κ_1, the first pole of the screened solution \[1/length\]; none if a is not below R.
    #[cfg(feature = "fit")]
    pub(crate) fn first_pole(&self) -> Option<f64> {
        let [inner, outer] = self.detail.radii();
        let annulus = Annulus::new(inner, outer).ok()?;
        Some(match self.detail.spreading_dimension() {
            1 => pole::<1>(annulus, 1),
            3 => pole::<3>(annulus, 1),
            _ => pole::<2>(annulus, 1),
        })
    }

    /// The labels of two disks.
    pub(crate) fn labels_of(&self, disks: [u32; 2]) -> [u64; 2] {
        disks.map(|disk| self.labels[disk as usize])
    }

    /// The phase by all evidence; `increase` is d_0.
    fn phase(&self, pressure_change: f64, increase: f64, drive: &Drive) -> PhaseDecision {
        let Some(permit) = self.verdict.permit() else { return PhaseDecision::not_at_rest() };
        if self.measured_on == MeasuredOn::AllDisks {
            return PhaseDecision { outcome: PhaseOutcome::Unjammed, ..PhaseDecision::default() };
        }
        // The evidence of a phase is known for inflations only.
        if !drive.is_inflation() {
            return PhaseDecision::from_evidence(permit, Evidence::default());
        }
        // A row between walls compresses the packing in either phase and changes many contacts.
        let around_a_disk = self.detail.spreading_dimension() != 1;
        let evidence = Evidence {
            profile: by_profile(self),
            pressure_change: by_pressure_change(pressure_change, increase).filter(|_| around_a_disk),
            spectrum: by_spectrum(self),
            contact_changes: self
                .contact_changes
                .as_ref()
                .filter(|_| around_a_disk)
                .and_then(|it| by_contact_changes(it.inflation)),
        };
        PhaseDecision::from_evidence(permit, evidence)
    }
}

/// Why fits are refused, if they are.
fn no_fit(verdict: &RestVerdict, increase: f64, drive: &Drive) -> Option<String> {
    if increase == 0.0 && drive.is_inflation() {
        return Some("the radius of the inflated disk did not change: there is no response".into());
    }
    verdict.refusal()
}

impl RingResponse {
    fn of(
        field: &DisplacementField<2>,
        settings: &AngularCorrelationSettings,
        observables: &Observables,
        no_fit: Option<&str>,
    ) -> Result<Self, AngularError> {
        #[cfg(not(feature = "fit"))]
        let _ = (observables, no_fit);
        let ring = RingSample::of_field(field, &settings.ring)?;
        Ok(RingResponse {
            relative_radius: settings.ring.relative_radius,
            spectrum: PowerSpectrum::of(&ring, &settings.spectrum)?,
            correlation: AngularCorrelation::of(&ring, &settings.correlation)?,
            #[cfg(feature = "fit")]
            slope: observables.spectrum_fit.map(|fit| match no_fit {
                Some(reason) => Measurement::Refused(reason.into()),
                None => fit_slope(std::slice::from_ref(&ring), &fit.slope).into(),
            }),
            #[cfg(feature = "fit")]
            crossover: observables.spectrum_fit.map(|fit| match no_fit {
                Some(reason) => Measurement::Refused(reason.into()),
                None => fit_crossover(std::slice::from_ref(&ring), &fit.crossover).into(),
            }),
        })
    }
}

#[cfg(feature = "fit")]
fn by_profile(response: &Response) -> Option<Phase> {
    let fit = response.profile_fit.as_ref()?.measured()?;
    match fit.decision {
        Decision::Screened => Some(Phase::Plastic),
        Decision::Elastic => {
            let bound = fit.elastic.wavenumber_bound?;
            (bound < response.first_pole()?).then_some(Phase::Quasielastic)
        }
        Decision::Neither => None,
    }
}

#[cfg(feature = "fit")]
fn by_spectrum(response: &Response) -> Option<Phase> {
    let ring = response.angular_correlation.as_ref()?.measured()?;
    match ring.crossover.as_ref()?.measured()?.outcome {
        CrossoverOutcome::Found { .. } | CrossoverOutcome::White { .. } => Some(Phase::Plastic),
        CrossoverOutcome::ScaleFree { .. } => {
            let slope = ring.slope.as_ref()?.measured().filter(|slope| slope.outcome != SlopeOutcome::Undetermined)?;
            (slope.exponent.best >= SCALE_FREE_SLOPE).then_some(Phase::Quasielastic)
        }
        CrossoverOutcome::Undetermined => None,
    }
}

/// No fits without the feature `fit`.
#[cfg(not(feature = "fit"))]
fn by_profile(_response: &Response) -> Option<Phase> {
    None
}

/// No fits without the feature `fit`.
#[cfg(not(feature = "fit"))]
fn by_spectrum(_response: &Response) -> Option<Phase> {
    None
}
