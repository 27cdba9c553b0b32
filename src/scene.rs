//! [`Scene`]: everything a run needs, as plain data, checked once.
//!
//! A scene has one law, one mixture, one inflation, and one or more samples: packings to which the same thing is done.
//! What an observable needs and the scene does not name is not computed.

use serde::{Deserialize, Serialize};

use crate::contact::law::{LawChoice, LawError};
use crate::inflation::{Boundary, Inflation};
use crate::packing::{Mixture, PackingError};
#[cfg(feature = "linear")]
use crate::relax::implicit::Finish;
use crate::relax::{DampedDynamics, Fire, ForceLimit, RelaxerChoice, TimeStep};

/// Everything a run needs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Scene {
    /// Number of disks in the box.
    pub disk_count: usize,
    /// The contact law.
    pub law: LawChoice,
    /// The distribution of radii.
    pub mixture: Mixture,
    /// How packings are made.
    pub preparation: PreparationSettings,
    /// The inflation.
    pub inflation: Inflation,
    /// What is measured.
    pub observables: Observables,
    /// The packings.
    pub sample: Vec<Sample>,
}

/// How packings are made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PreparationSettings {
    /// Largest relative deviation of a pressure from the one asked for \[1\].
    pub pressure_tolerance: f64,
    /// How they come to rest.
    pub relaxer: RelaxerChoice,
}

impl Default for PreparationSettings {
    fn default() -> Self {
        PreparationSettings { pressure_tolerance: 0.01, relaxer: RelaxerChoice::default() }
    }
}

/// One packing of a scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sample {
    /// Its name in reports and file names.
    pub name: String,
    /// Seed of the random points and of the choice of the inflated disk.
    #[serde(default = "first_seed")]
    pub seed: u64,
    /// Where the packing comes from.
    pub source: Source,
    /// How it comes to rest after the inflation.
    #[serde(default)]
    pub relaxer: RelaxerChoice,
}

fn first_seed() -> u64 {
    1
}

/// Where a packing comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// Random points quenched at this packing fraction \[1\].
    PackingFraction(f64),
    /// Random points quenched, then brought to this pressure \[force / length\].
    Pressure(f64),
    /// A packing from a file.
    File(std::path::PathBuf),
}

/// What is measured; what is absent is not computed.
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
    /// Radial displacement against angle in rings.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub angular_profiles: Option<AngularProfileSettings>,
    /// What of the response is not in the linear one.
    #[cfg(feature = "linear")]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plastic_part: Option<PlasticPartSettings>,
    /// Whether other relaxers end in the same minimum; absent by default.
    #[cfg(feature = "linear")]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub protocol: Option<ProtocolSettings>,
    /// The packing before and after the inflation, with its displacement field, as files; the map of r d_r.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub displacement_field: Option<DisplacementFieldSettings>,
}

impl Default for Observables {
    fn default() -> Self {
        Observables {
            radial_profile: Some(RadialProfileSettings::default()),
            #[cfg(feature = "fit")]
            profile_fit: Some(ProfileFitSettings::default()),
            angular_profiles: Some(AngularProfileSettings::default()),
            #[cfg(feature = "linear")]
            plastic_part: Some(PlasticPartSettings::default()),
            #[cfg(feature = "linear")]
            protocol: None,
            displacement_field: Some(DisplacementFieldSettings::default()),
        }
    }
}

/// The radial profile.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RadialProfileSettings {
    /// Width of a ring \[length\].
    pub ring_width: f64,
}

impl Default for RadialProfileSettings {
    /// One diameter of a small disk: at r = 10 a ring holds 50 disks.
    fn default() -> Self {
        RadialProfileSettings { ring_width: 1.0 }
    }
}

/// The fits of the radial profile.
#[cfg(feature = "fit")]
pub type ProfileFitSettings = crate::fit::profile::ProfileFitSettings;

/// The angular profiles.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AngularProfileSettings {
    /// Middles of the rings, r̂ = r/R \[1\].
    pub relative_radii: Vec<f64>,
}

impl Default for AngularProfileSettings {
    /// Source: the study, fig. 1.
    fn default() -> Self {
        AngularProfileSettings { relative_radii: vec![0.15, 0.5, 0.85] }
    }
}

/// The plastic part.
#[cfg(feature = "linear")]
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PlasticPartSettings {
    /// Width of a ring of its radial profile \[length\].
    pub ring_width: f64,
}

#[cfg(feature = "linear")]
impl Default for PlasticPartSettings {
    /// As the radial profile has it.
    fn default() -> Self {
        PlasticPartSettings { ring_width: RadialProfileSettings::default().ring_width }
    }
}

/// The comparison of protocols.
#[cfg(feature = "linear")]
pub type ProtocolSettings = crate::protocol::ProtocolSettings;

/// The displacement field has nothing to set.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DisplacementFieldSettings {}

impl Default for Scene {
    /// The three phases at the study's smallest size: unjammed, plastic and quasielastic.
    ///
    /// The transition lies at p_c = p̂_c N^(−3/2) with p̂_c from 8·10⁷ to 3·10⁸ and N = 4016 disks in the circle: 300 to
    /// 1200. As in the study, FIRE relaxes the unjammed packing and damped dynamics the quasielastic one; in the plastic
    /// one damped dynamics would take 10⁶ steps, so FIRE does it there too.
    ///
    /// Samples differ a lot at this size; the seeds are those of samples that show what their phase is known for. Relaxed by
    /// FIRE, 24 of 38 unjammed packings answer like this one (neither solution describes the profile; the others feel the
    /// rim), 11 of 54 at p = 10 (Δp < 0 in 7 of the 54), and 34 of 38 at p = 4000 (elastic).
    fn default() -> Self {
        Scene {
            disk_count: 5548,
            law: LawChoice::default(),
            mixture: Mixture::default(),
            preparation: PreparationSettings::default(),
            inflation: Inflation::default(),
            observables: Observables::default(),
            sample: vec![
                Sample {
                    name: "unjammed".into(),
                    seed: 9,
                    source: Source::PackingFraction(0.82),
                    relaxer: RelaxerChoice::Fire(Fire::default()),
                },
                Sample {
                    name: "plastic".into(),
                    seed: 48,
                    source: Source::Pressure(10.0),
                    relaxer: RelaxerChoice::Fire(Fire::default()),
                },
                Sample {
                    name: "quasielastic".into(),
                    seed: 11,
                    source: Source::Pressure(4000.0),
                    relaxer: RelaxerChoice::Damped(DampedDynamics::default()),
                },
            ],
        }
    }
}

/// A number of a scene that makes no sense.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// No sample at all.
    #[error("sample: a scene needs at least one")]
    NoSample,
    /// Two samples of one name would write the same files.
    #[error("sample: the name \"{name}\" is used twice")]
    NameTwice {
        /// The name.
        name: String,
    },
    /// A name becomes part of file names.
    #[error("sample.name = \"{name}\": use letters, digits, '-', '_' and '.', and start with a letter or digit")]
    NameNotAFileName {
        /// The name.
        name: String,
    },
    /// The law.
    #[error("law: {0}")]
    Law(#[from] LawError),
    /// The mixture or the number of disks.
    #[error("disk_count or mixture: {0}")]
    Mixture(PackingError),
    /// A number outside its range.
    #[error("{field} = {value}: must be {range}")]
    OutOfRange {
        /// The field, with its tables.
        field: String,
        /// The value found.
        value: f64,
        /// What it must be.
        range: &'static str,
    },
    /// One observable needs another.
    #[error("observables.{observable} needs observables.{needed}")]
    ObservableMissing {
        /// The one asked for.
        observable: &'static str,
        /// The one it needs.
        needed: &'static str,
    },
}

fn within(field: impl Into<String>, value: f64, range: &'static str, holds: bool) -> Result<(), SceneError> {
    if holds { Ok(()) } else { Err(SceneError::OutOfRange { field: field.into(), value, range }) }
}

fn positive(field: impl Into<String>, value: f64) -> Result<(), SceneError> {
    within(field, value, "a positive number", value.is_finite() && value > 0.0)
}

impl Scene {
    /// Whether every number makes sense.
    ///
    /// # Errors
    /// [`SceneError`] names the field and the value.
    pub fn check(&self) -> Result<(), SceneError> {
        self.law.check()?;
        self.mixture.radii(self.disk_count).map_err(SceneError::Mixture)?;
        let tolerance = self.preparation.pressure_tolerance;
        within("preparation.pressure_tolerance", tolerance, "between 0 and 1", tolerance > 0.0 && tolerance < 1.0)?;
        check_relaxer("preparation.relaxer", &self.preparation.relaxer)?;
        let increase = self.inflation.increase;
        within("inflation.increase", increase, "a finite number", increase.is_finite())?;
        if let Some(coupling) = self.inflation.on_site_coupling {
            within("inflation.on_site_coupling", coupling, "a finite number", coupling.is_finite())?;
        }
        if let Boundary::HeldRim { outer_radius_over_side: ratio } = self.inflation.boundary {
            let field = "inflation.boundary.held_rim.outer_radius_over_side";
            within(field, ratio, "above 0 and at most 0.5", ratio > 0.0 && ratio <= 0.5)?;
        }
        self.observables.check()?;
        if self.sample.is_empty() {
            return Err(SceneError::NoSample);
        }
        for (index, sample) in self.sample.iter().enumerate() {
            sample.check()?;
            if self.sample[..index].iter().any(|other| other.name == sample.name) {
                return Err(SceneError::NameTwice { name: sample.name.clone() });
            }
        }
        Ok(())
    }
}

impl Observables {
    fn check(&self) -> Result<(), SceneError> {
        if let Some(profile) = &self.radial_profile {
            positive("observables.radial_profile.ring_width", profile.ring_width)?;
        }
        #[cfg(feature = "fit")]
        if self.profile_fit.is_some() && self.radial_profile.is_none() {
            return Err(SceneError::ObservableMissing { observable: "profile_fit", needed: "radial_profile" });
        }
        #[cfg(feature = "linear")]
        if let Some(plastic) = &self.plastic_part {
            positive("observables.plastic_part.ring_width", plastic.ring_width)?;
        }
        #[cfg(feature = "linear")]
        if let Some(protocol) = &self.protocol {
            let (field, fraction) = ("observables.protocol.fraction", protocol.fraction);
            within(field, fraction, "above 0 and at most 1", fraction > 0.0 && fraction <= 1.0)?;
            let (field, same) = ("observables.protocol.same_minimum", protocol.same_minimum);
            within(field, same, "above 0 and below 1", same > 0.0 && same < 1.0)?;
            positive("observables.protocol.differing", protocol.differing)?;
            let (field, residual) = ("observables.protocol.residual", protocol.residual);
            within(field, residual, "a finite number, not negative", residual.is_finite() && residual >= 0.0)?;
        }
        if let Some(profiles) = &self.angular_profiles {
            for &radius in &profiles.relative_radii {
                let field = "observables.angular_profiles.relative_radii";
                within(field, radius, "above 0 and below 1", radius > 0.0 && radius < 1.0)?;
            }
        }
        Ok(())
    }
}

impl Sample {
    fn check(&self) -> Result<(), SceneError> {
        let letter = |c: char| c.is_ascii_alphanumeric();
        let fits = self.name.starts_with(letter) && self.name.chars().all(|c| letter(c) || "-_.".contains(c));
        if !fits {
            return Err(SceneError::NameNotAFileName { name: self.name.clone() });
        }
        let field = |last: &str| format!("sample \"{}\": {last}", self.name);
        match self.source {
            Source::PackingFraction(value) => {
                within(field("source.packing_fraction"), value, "above 0 and below 4", value > 0.0 && value < 4.0)?;
            }
            Source::Pressure(value) => positive(field("source.pressure"), value)?,
            Source::File(_) => {}
        }
        check_relaxer(&field("relaxer"), &self.relaxer)
    }
}

fn check_relaxer(field: &str, relaxer: &RelaxerChoice) -> Result<(), SceneError> {
    let value = relaxer.limit().value();
    let name = match relaxer.limit() {
        ForceLimit::Relative(_) => "limit.relative",
        ForceLimit::Absolute(_) => "limit.absolute",
    };
    within(format!("{field}.{name}"), value, "a finite number, not negative", value.is_finite() && value >= 0.0)?;
    match relaxer {
        RelaxerChoice::Fire(fire) => {
            let unit = |value: f64| value > 0.0 && value < 1.0;
            let name = |last: &str| format!("{field}.fire.{last}");
            let fraction = fire.time_step_fraction;
            within(name("time_step_fraction"), fraction, "above 0 and below 2", fraction > 0.0 && fraction < 2.0)?;
            within(name("step_growth"), fire.step_growth, "at least 1", fire.step_growth >= 1.0)?;
            within(name("step_cut"), fire.step_cut, "between 0 and 1", unit(fire.step_cut))?;
            within(name("mixing"), fire.mixing, "between 0 and 1", unit(fire.mixing))?;
            let decay = fire.mixing_decay;
            within(name("mixing_decay"), decay, "above 0 and at most 1", decay > 0.0 && decay <= 1.0)
        }
        RelaxerChoice::Damped(damped) => {
            let rate = damped.damping.rate();
            let rate_field = format!("{field}.damped.damping");
            within(rate_field, rate, "a finite number, not negative", rate.is_finite() && rate >= 0.0)?;
            match damped.time_step {
                TimeStep::Fixed(step) => positive(format!("{field}.damped.time_step.fixed"), step),
                TimeStep::OfStability(share) => positive(format!("{field}.damped.time_step.of_stability"), share),
            }
        }
        RelaxerChoice::ConjugateGradients(gradients) => {
            check_descent(&format!("{field}.conjugate_gradients"), gradients.largest_step, gradients.flatness)
        }
        RelaxerChoice::QuasiNewton(quasi_newton) => {
            let field = format!("{field}.quasi_newton");
            check_descent(&field, quasi_newton.largest_step, quasi_newton.flatness)?;
            let memory = quasi_newton.memory;
            within(format!("{field}.memory"), memory as f64, "at most 1000", memory <= 1000)
        }
        #[cfg(feature = "linear")]
        RelaxerChoice::Implicit(dynamics) => {
            let rate = dynamics.damping.rate();
            let rate_field = format!("{field}.implicit.damping");
            within(rate_field, rate, "a finite number, not negative", rate.is_finite() && rate >= 0.0)?;
            positive(format!("{field}.implicit.tolerance"), dynamics.tolerance)?;
            check_finish(&format!("{field}.implicit"), dynamics.finish)
        }
        #[cfg(feature = "linear")]
        RelaxerChoice::GradientFlow(flow) => {
            positive(format!("{field}.gradient_flow.tolerance"), flow.tolerance)?;
            check_finish(&format!("{field}.gradient_flow"), flow.finish)
        }
        #[cfg(feature = "linear")]
        RelaxerChoice::Newton(newton) => positive(format!("{field}.newton.largest_step"), newton.largest_step),
        #[cfg(feature = "linear")]
        RelaxerChoice::Staged(staged) => {
            positive(format!("{field}.staged.hand_over"), staged.hand_over)?;
            positive(format!("{field}.staged.largest_step"), staged.largest_step)
        }
    }
}

/// What nonlinear conjugate gradients and L-BFGS have in common.
fn check_descent(field: &str, largest_step: f64, flatness: f64) -> Result<(), SceneError> {
    positive(format!("{field}.largest_step"), largest_step)?;
    within(format!("{field}.flatness"), flatness, "between 0 and 1", flatness > 0.0 && flatness < 1.0)
}

#[cfg(feature = "linear")]
fn check_finish(field: &str, finish: Finish) -> Result<(), SceneError> {
    match finish {
        Finish::Motion => Ok(()),
        Finish::Newton(residual) => positive(format!("{field}.finish.newton"), residual),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_built_in_scene_makes_sense() {
        assert_eq!(Scene::default().check(), Ok(()));
    }

    #[test]
    fn nonsense_is_named_with_its_field() {
        let mut scene = Scene::default();
        scene.sample[0].source = Source::PackingFraction(4.5);
        let message = scene.check().expect_err("packing fraction above 4").to_string();
        assert_eq!(message, "sample \"unjammed\": source.packing_fraction = 4.5: must be above 0 and below 4");
        let mut scene = Scene::default();
        scene.mixture.components[1].radius = -0.7;
        assert!(scene.check().expect_err("negative radius").to_string().contains("radius is -0.7"));
        let scene = Scene { disk_count: 0, ..Scene::default() };
        assert!(scene.check().is_err());
    }
}
