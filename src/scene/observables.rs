//! [`Observables`]: the observables and their settings.

use serde::{Deserialize, Serialize};

#[cfg(feature = "fit")]
use crate::fit::angular::{CrossoverSettings, SpectrumWindowSettings};
#[cfg(feature = "fit")]
use crate::fit::modes::ElasticModeSettings;
use crate::observe::angular::{CorrelationSettings, RadialDependenceSettings, RingSettings, SpectrumSettings};
use crate::observe::bond_changes::BondSet;
use crate::observe::isostatic::IsostaticSettings;
use crate::observe::multipoles::MultipoleSettings;
use crate::observe::penetration_length::PenetrationSettings;
use crate::observe::shell::{SHELL_HALF_WIDTH, SHELL_RADIUS, ShellSettings};

/// The observables; absent ones are not computed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Observables {
    /// Mean radial displacement in rings.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radial_profile: Option<RadialProfileSettings>,
    /// Fits of the radial profile to the elastic and the screened solution.
    #[cfg(feature = "fit")]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub profile_fit: Option<ProfileFitSettings>,
    /// The largest distance from the inflated disk with a displacement; needs the radial profile.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub penetration_length: Option<PenetrationSettings>,
    /// Radial displacement against angle in rings.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub angular_profiles: Option<AngularProfileSettings>,
    /// Angular correlation and power spectrum of the radial displacement in one ring.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub angular_correlation: Option<AngularCorrelationSettings>,
    /// Slope and crossover of that spectrum.
    #[cfg(feature = "fit")]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spectrum_fit: Option<SpectrumFitSettings>,
    /// Angular correlation and power spectrum of the radial displacement in one shell of spheres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shell_correlation: Option<ShellCorrelationSettings>,
    /// Slope and crossover of that spectrum.
    #[cfg(feature = "fit")]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shell_fit: Option<ShellFitSettings>,
    /// Correlation and spectrum in rings from the inflated disk to the rim.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radial_dependence: Option<RadialDependenceSettings>,
    /// Angular modes of the displacement, ring by ring.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub multipoles: Option<MultipoleSettings>,
    /// Elastic modes fitted to the angular modes; needs the multipoles.
    #[cfg(feature = "fit")]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub elastic_modes: Option<ElasticModeSettings>,
    /// Contacts made, broken and restored.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact_changes: Option<ContactChangeSettings>,
    /// The stretch of every bond.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bond_changes: Option<BondChangeSettings>,
    /// The distance beyond which the stretch of bonds varies as in a continuum.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub isostatic_length: Option<IsostaticSettings>,
    /// The plastic part of the response.
    #[cfg(feature = "linear")]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plastic_part: Option<PlasticPartSettings>,
    /// Whether other relaxers end in the same minimum; absent by default.
    #[cfg(feature = "linear")]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub protocol: Option<ProtocolSettings>,
    /// Files of the packing before and after the inflation, with its displacement field; the map of r d_r.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub displacement_field: Option<DisplacementFieldSettings>,
}

impl Default for Observables {
    fn default() -> Self {
        Observables {
            radial_profile: Some(RadialProfileSettings::default()),
            #[cfg(feature = "fit")]
            profile_fit: Some(ProfileFitSettings::default()),
            penetration_length: Some(PenetrationSettings::default()),
            angular_profiles: Some(AngularProfileSettings::default()),
            angular_correlation: Some(AngularCorrelationSettings::default()),
            #[cfg(feature = "fit")]
            spectrum_fit: Some(SpectrumFitSettings::default()),
            shell_correlation: None,
            #[cfg(feature = "fit")]
            shell_fit: None,
            radial_dependence: Some(RadialDependenceSettings::default()),
            multipoles: Some(MultipoleSettings::default()),
            #[cfg(feature = "fit")]
            elastic_modes: Some(ElasticModeSettings::default()),
            contact_changes: Some(ContactChangeSettings::default()),
            bond_changes: Some(BondChangeSettings::default()),
            isostatic_length: Some(IsostaticSettings::default()),
            #[cfg(feature = "linear")]
            plastic_part: Some(PlasticPartSettings::default()),
            #[cfg(feature = "linear")]
            protocol: None,
            displacement_field: Some(DisplacementFieldSettings::default()),
        }
    }
}

impl Observables {
    /// The same observables with all lengths multiplied by `unit`: widths and smallest radii of rings, thresholds of
    /// displacements. The defaults are for packings whose small disks have diameter 1.
    pub fn in_units(mut self, unit: f64) -> Self {
        if let Some(profile) = &mut self.radial_profile {
            profile.ring_width *= unit;
        }
        if let Some(penetration) = &mut self.penetration_length {
            penetration.thresholds.iter_mut().for_each(|threshold| *threshold *= unit);
        }
        if let Some(multipoles) = &mut self.multipoles {
            multipoles.ring_width *= unit;
        }
        #[cfg(feature = "fit")]
        if let Some(modes) = &mut self.elastic_modes {
            modes.from *= unit;
        }
        if let Some(isostatic) = &mut self.isostatic_length {
            isostatic.ring_width *= unit;
            isostatic.from *= unit;
        }
        #[cfg(feature = "linear")]
        if let Some(plastic) = &mut self.plastic_part {
            plastic.ring_width *= unit;
        }
        self
    }

    /// The observables of disks (2) or spheres (3): those with angles in the plane are of disks only.
    pub fn of_dimension(dimension: usize) -> Self {
        if dimension != 3 {
            return Observables::default();
        }
        Observables {
            // A shell of half a diameter at r = 5 contains 100 spheres.
            radial_profile: Some(RadialProfileSettings { ring_width: 0.5 }),
            angular_profiles: None,
            angular_correlation: None,
            #[cfg(feature = "fit")]
            spectrum_fit: None,
            shell_correlation: Some(ShellCorrelationSettings::default()),
            #[cfg(feature = "fit")]
            shell_fit: Some(ShellFitSettings::default()),
            radial_dependence: None,
            multipoles: None,
            #[cfg(feature = "fit")]
            elastic_modes: None,
            isostatic_length: Some(IsostaticSettings::of_held::<3>()),
            ..Observables::default()
        }
    }

    /// The first of the observables that are of disks only.
    pub(crate) fn of_the_plane(&self) -> Option<&'static str> {
        let all = [
            ("angular_profiles", self.angular_profiles.is_some()),
            ("angular_correlation", self.angular_correlation.is_some()),
            ("radial_dependence", self.radial_dependence.is_some()),
            ("multipoles", self.multipoles.is_some()),
            #[cfg(feature = "fit")]
            ("spectrum_fit", self.spectrum_fit.is_some()),
            #[cfg(feature = "fit")]
            ("elastic_modes", self.elastic_modes.is_some()),
        ];
        all.into_iter().find(|(_, has)| *has).map(|(name, _)| name)
    }

    /// The observables of a strip between held walls: without those of the disks around one.
    pub fn of_strip() -> Self {
        Observables {
            multipoles: None,
            #[cfg(feature = "fit")]
            elastic_modes: None,
            bond_changes: None,
            isostatic_length: None,
            ..Observables::default()
        }
    }

    /// The first of the observables that need a disk in the middle.
    pub(crate) fn of_a_circle(&self) -> Option<&'static str> {
        let all = [
            ("multipoles", self.multipoles.is_some()),
            ("bond_changes", self.bond_changes.is_some()),
            ("isostatic_length", self.isostatic_length.is_some()),
        ];
        all.into_iter().find(|(_, has)| *has).map(|(name, _)| name)
    }

    /// The first of the observables that are of spheres only.
    pub(crate) fn of_space(&self) -> Option<&'static str> {
        #[cfg(feature = "fit")]
        if self.shell_fit.is_some() {
            return Some("shell_fit");
        }
        self.shell_correlation.as_ref().map(|_| "shell_correlation")
    }

    /// No observables.
    pub fn none() -> Self {
        Observables {
            radial_profile: None,
            #[cfg(feature = "fit")]
            profile_fit: None,
            penetration_length: None,
            angular_profiles: None,
            angular_correlation: None,
            #[cfg(feature = "fit")]
            spectrum_fit: None,
            shell_correlation: None,
            #[cfg(feature = "fit")]
            shell_fit: None,
            radial_dependence: None,
            multipoles: None,
            #[cfg(feature = "fit")]
            elastic_modes: None,
            contact_changes: None,
            bond_changes: None,
            isostatic_length: None,
            #[cfg(feature = "linear")]
            plastic_part: None,
            #[cfg(feature = "linear")]
            protocol: None,
            displacement_field: None,
        }
    }
}

/// Settings of the radial profile.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RadialProfileSettings {
    /// Width of a ring \[length\].
    pub ring_width: f64,
}

impl Default for RadialProfileSettings {
    /// One diameter of a small disk: at r = 10 a ring contains 50 disks.
    fn default() -> Self {
        RadialProfileSettings { ring_width: 1.0 }
    }
}

/// Settings of the fits to the radial profile.
#[cfg(feature = "fit")]
pub type ProfileFitSettings = crate::fit::profile::ProfileFitSettings;

/// Settings of the angular profiles.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AngularProfileSettings {
    /// Midpoints of the rings, r̂ = r/R \[1\].
    pub relative_radii: Vec<f64>,
}

impl Default for AngularProfileSettings {
    /// Source: the study, fig. 1.
    fn default() -> Self {
        AngularProfileSettings { relative_radii: vec![0.15, 0.5, 0.85] }
    }
}

/// Settings of correlation and spectrum in one ring.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AngularCorrelationSettings {
    /// The ring.
    pub ring: RingSettings,
    /// S(f).
    pub spectrum: SpectrumSettings,
    /// G(θ).
    pub correlation: CorrelationSettings,
}

/// Settings of correlation and spectrum in one shell of spheres.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ShellCorrelationSettings {
    /// Middle of the shell, r̂ = r/R \[1\].
    pub relative_radius: f64,
    /// Half its width over R \[1\].
    pub half_width: f64,
    /// S(ℓ) and G(γ).
    pub shell: ShellSettings,
}

impl Default for ShellCorrelationSettings {
    /// The ring of the study as a shell.
    fn default() -> Self {
        ShellCorrelationSettings {
            relative_radius: SHELL_RADIUS,
            half_width: SHELL_HALF_WIDTH,
            shell: ShellSettings::default(),
        }
    }
}

/// Settings of the fits to the spectrum of a shell.
#[cfg(feature = "fit")]
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ShellFitSettings {
    /// The powers used for the slope.
    pub slope: crate::fit::angular::ShellFitSettings,
    /// The fit of ℓ†.
    pub crossover: crate::fit::angular::ShellCrossoverSettings,
}

/// Settings of the fits to a spectrum.
#[cfg(feature = "fit")]
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SpectrumFitSettings {
    /// The powers used for the slope.
    pub slope: SpectrumWindowSettings,
    /// The fit of f†.
    pub crossover: CrossoverSettings,
}

/// Contact changes have no settings.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactChangeSettings {}

/// Settings of the stretch of bonds.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct BondChangeSettings {
    /// The contacts included.
    pub bonds: BondSet,
}

/// Settings of the plastic part.
#[cfg(feature = "linear")]
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PlasticPartSettings {
    /// Width of a ring of its radial profile \[length\].
    pub ring_width: f64,
}

#[cfg(feature = "linear")]
impl Default for PlasticPartSettings {
    /// The same width as for the radial profile.
    fn default() -> Self {
        PlasticPartSettings { ring_width: RadialProfileSettings::default().ring_width }
    }
}

/// Settings of the comparison of protocols.
#[cfg(feature = "linear")]
pub type ProtocolSettings = crate::protocol::ProtocolSettings;

/// The displacement field has no settings.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DisplacementFieldSettings {}
