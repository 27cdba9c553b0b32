//! [`State`]: the end of a run with the compared numbers; [`Errors`]: the differences of two states.

use serde::Serialize;

use crate::displacement::DisplacementField;
#[cfg(feature = "fit")]
use crate::fit::profile::{Decision, ProfileFit, ProfileFitSettings, fit_radial_profile};
use crate::inflation::Grown;
use crate::law::pair_law::PairLaw;
use crate::network::ContactNetwork;
#[cfg(feature = "fit")]
use crate::observe::RadialProfile;
use crate::packing::displacement;
use crate::packing::{Packing, PackingError};
#[cfg(feature = "fit")]
use crate::reference::Annulus;
use crate::relax::Criterion;
use crate::scene::Observables;
use crate::vector::{larger, norm};

/// The numbers of a state.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Measured {
    /// Elastic energy, including that of sites if there are any \[energy\].
    pub energy: f64,
    /// Pressure of the circle or the box; 0 for an unjammed packing \[force / length\].
    pub pressure: f64,
    /// Contacts of the backbone.
    pub contact_count: usize,
    /// The results of the fit; absent without a fit.
    pub fitted: Option<Fitted>,
}

/// The compared results of a fit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Fitted {
    /// Whether the screened solution was selected.
    pub screened: bool,
    /// κ of the screened solution for any decision; 0 if no κ > 0 fits better \[1/length\].
    pub wavenumber: f64,
    /// d_0^eff of the elastic solution \[length\].
    pub elastic_amplitude: f64,
    /// d_0^eff of the screened solution; that of the elastic one if κ = 0 \[length\].
    pub screened_amplitude: f64,
}

impl Fitted {
    /// d_0^eff of the selected solution \[length\].
    pub fn amplitude(&self) -> f64 {
        if self.screened { self.screened_amplitude } else { self.elastic_amplitude }
    }
}

#[cfg(feature = "fit")]
impl From<&ProfileFit> for Fitted {
    fn from(fit: &ProfileFit) -> Self {
        let elastic_amplitude = fit.elastic.amplitude.value;
        Fitted {
            screened: fit.decision == Decision::Screened,
            wavenumber: fit.screened.map_or(0.0, |fit| fit.wavenumber.value),
            elastic_amplitude,
            screened_amplitude: fit.screened.map_or(elastic_amplitude, |fit| fit.amplitude.value),
        }
    }
}

/// Errors of one state relative to another.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Errors {
    /// Largest distance between the two positions of a disk, over the backbone of the other state (over all mobile
    /// disks if that is unjammed) \[length\].
    pub displacement: f64,
    /// Error of the energy over that of the other state; absent if that is unjammed \[1\].
    pub energy: Option<f64>,
    /// Error of the pressure over that of the other state; absent if that is unjammed \[1\].
    pub pressure: Option<f64>,
    /// Error of κ \[1/length\].
    pub wavenumber: Option<f64>,
    /// Error of d_0^eff, for the solution selected in the other state \[length\].
    pub amplitude: Option<f64>,
    /// Number of contacts of the backbone that only one of the two has.
    pub contacts: usize,
}

/// A state of the inflated packing.
#[derive(Debug, Clone)]
pub struct State<const D: usize> {
    pub(super) packing: Packing<D>,
    backbone: Vec<bool>,
    contacts: Vec<(u32, u32)>,
    unjammed: bool,
    /// Its numbers.
    pub measured: Measured,
}

impl<const D: usize> State<D> {
    /// Measures a state, at rest or not; `criterion` is the limit that it met.
    ///
    /// # Errors
    /// Only conditions that make forces undefined.
    pub fn new(
        packing: Packing<D>,
        criterion: Option<Criterion>,
        grown: &Grown<D>,
        law: &dyn PairLaw,
        observables: &Observables,
    ) -> Result<Self, PackingError> {
        let network = ContactNetwork::new(&packing, law)?;
        let unjammed = [criterion, Some(grown.before.criterion)].contains(&Some(Criterion::Unjammed));
        let contacts: Vec<(u32, u32)> =
            network.backbone_contacts().map(|contact| (contact.first, contact.second)).collect();
        let mut state = State {
            measured: Measured {
                energy: network.energy() + network.on_site_energy(),
                pressure: if unjammed { 0.0 } else { grown.pressure_of(&network) },
                contact_count: contacts.len(),
                fitted: None,
            },
            backbone: network.backbone,
            contacts,
            unjammed,
            packing,
        };
        state.measured.fitted = state.fitted(grown, observables);
        Ok(state)
    }

    /// Whether no disk is pressed, so that there is no unique minimum.
    pub fn is_unjammed(&self) -> bool {
        self.unjammed
    }

    /// The displacement field from before the inflation to this state.
    pub(super) fn field(&self, grown: &Grown<D>) -> DisplacementField<D> {
        let before = (grown.before.packing.get(), grown.before.backbone.as_slice());
        let states = [before, (&self.packing, self.backbone.as_slice())];
        DisplacementField::of_states(states, self.unjammed, grown.region())
    }

    #[cfg(feature = "fit")]
    fn fitted(&self, grown: &Grown<D>, observables: &Observables) -> Option<Fitted> {
        let (profile, settings) = (observables.radial_profile?, observables.profile_fit?);
        fit(&self.field(grown), profile.ring_width, &settings)
    }

    #[cfg(not(feature = "fit"))]
    fn fitted(&self, _grown: &Grown<D>, _observables: &Observables) -> Option<Fitted> {
        None
    }

    /// Largest distance between the two positions of a disk, over the backbone of `other` \[length\].
    pub fn distance(&self, other: &State<D>) -> f64 {
        let counts = |disk: &usize| !self.packing.held()[*disk] && (other.unjammed || other.backbone[*disk]);
        let distance = |disk: usize| norm(displacement(&other.packing, &self.packing, disk));
        (0..self.packing.len()).filter(counts).map(distance).fold(0.0, larger)
    }

    /// The errors of this state relative to another.
    pub fn errors(&self, other: &State<D>) -> Errors {
        let relative = |ours: f64, theirs: f64| (!other.unjammed).then(|| (ours - theirs).abs() / theirs.abs());
        let fits = self.measured.fitted.zip(other.measured.fitted);
        Errors {
            displacement: self.distance(other),
            energy: relative(self.measured.energy, other.measured.energy),
            pressure: relative(self.measured.pressure, other.measured.pressure),
            wavenumber: fits.map(|(ours, theirs)| (ours.wavenumber - theirs.wavenumber).abs()),
            amplitude: fits.map(|(ours, theirs)| {
                (Fitted { screened: theirs.screened, ..ours }.amplitude() - theirs.amplitude()).abs()
            }),
            contacts: differing(&self.contacts, &other.contacts),
        }
    }
}

/// Fits a field in rings of a given width; none if the fit is refused.
#[cfg(feature = "fit")]
pub(super) fn fit<const D: usize>(
    field: &DisplacementField<D>,
    ring_width: f64,
    settings: &ProfileFitSettings,
) -> Option<Fitted> {
    let annulus = Annulus::new(field.inner_radius, field.outer_radius).ok()?;
    let profile = RadialProfile::of(field, ring_width);
    let fit = match field.spreading_dimension() {
        1 => fit_radial_profile::<1>(&profile, annulus, settings),
        _ => fit_radial_profile::<D>(&profile, annulus, settings),
    };
    fit.ok().as_ref().map(Fitted::from)
}

/// Number of entries in only one of two ascending lists.
fn differing(one: &[(u32, u32)], two: &[(u32, u32)]) -> usize {
    let shared = one.iter().filter(|pair| two.binary_search(pair).is_ok()).count();
    one.len() + two.len() - 2 * shared
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contacts_of_one_list_only_are_counted() {
        assert_eq!(differing(&[(0, 1), (0, 2), (3, 4)], &[(0, 2), (1, 2)]), 3);
        assert_eq!(differing(&[], &[]), 0);
    }
}
