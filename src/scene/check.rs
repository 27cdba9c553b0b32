//! [`SceneError`]: checks of all numbers of a scene.

use crate::inflation::{Boundary, InflationError};
use crate::law::choice::LawError;
use crate::memory::TooLarge;
use crate::packing::PackingError;
#[cfg(feature = "linear")]
use crate::relax::implicit::Finish;
use crate::relax::{ForceLimit, RelaxerChoice, TimeStep};
use crate::scene::definition::{Sample, Scene};
use crate::scene::finite_numbers::{self, NotWritable};
use crate::scene::observables::Observables;
use crate::scene::size::{BYTES_A_DISK, DISK_INDEX};
use crate::scene::source::Source;

/// An invalid number of a scene.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// There is no sample.
    #[error("sample: a scene needs at least one sample")]
    NoSample,
    /// Two samples have the same name and would write the same files.
    #[error("sample: the name \"{name}\" is used twice")]
    NameTwice {
        /// The name.
        name: String,
    },
    /// A name is not valid in file names.
    #[error("sample.name = \"{name}\": use letters, digits, '-', '_' and '.', and start with a letter or digit")]
    NameNotAFileName {
        /// The name.
        name: String,
    },
    /// The law is invalid.
    #[error("law: {0}")]
    Law(#[from] LawError),
    /// A number cannot be written to a file and read back.
    #[error(transparent)]
    NotWritable(#[from] NotWritable),
    /// A count exceeds memory or index types.
    #[error(transparent)]
    TooLarge(#[from] TooLarge),
    /// The mixture or the number of disks is invalid.
    #[error("disk_count or mixture: {0}")]
    Mixture(PackingError),
    /// A number is outside its range.
    #[error("{field} = {value}: must be {range}")]
    OutOfRange {
        /// The field, including its tables.
        field: String,
        /// Its value.
        value: f64,
        /// The valid range.
        range: &'static str,
    },
    /// A force limit accepts states far from rest.
    #[error(
        "{field} = {value}: must be at most {limit:.3e}, because a packing with a residual above {} of the mean contact force is not at rest",
        crate::verdict::LARGEST_RESIDUAL
    )]
    LimitTooLoose {
        /// The field, including its tables.
        field: String,
        /// Its value.
        value: f64,
        /// The largest valid value.
        limit: f64,
    },
    /// Radii differ so much that forces on small disks are lost in rounding.
    #[error("mixture: radii from {smallest:e} to {largest:e} have a ratio of {:.1e}: must be at most {limit:e}, because beyond it forces on small disks are below the rounding of those on large disks", largest / smallest)]
    RadiiTooFarApart {
        /// The smallest \[length\].
        smallest: f64,
        /// The largest \[length\].
        largest: f64,
        /// The largest ratio \[1\].
        limit: f64,
    },
    /// A pressure is below the resolution of rounding.
    #[error(
        "sample \"{name}\": source.pressure = {pressure:?}: disks of radius {radius:e} would overlap by about {overlap:.1e} of their radius: must be at least {limit:e}, because smaller overlaps are lost in rounding; check the units of pressure, stiffness and radii"
    )]
    PressureBelowRounding {
        /// The sample.
        name: String,
        /// The target pressure \[force / length\].
        pressure: f64,
        /// Estimate of the overlap over the radius \[1\].
        overlap: f64,
        /// The radius \[length\].
        radius: f64,
        /// The smallest valid overlap \[1\].
        limit: f64,
    },
    /// A setting of an observable is invalid, with its error message.
    #[error("observables.{observable}: {reason}")]
    Observable {
        /// The observable.
        observable: &'static str,
        /// The problem, with field and value.
        reason: String,
    },
    /// An observable of disks is requested for spheres.
    #[error("observables.{observable}: with dimension = 3 there is no angle in the plane; remove it")]
    OfThePlane {
        /// The observable.
        observable: &'static str,
    },
    /// A strip is of disks only.
    #[error("inflation.boundary.held_walls: a row of disks is inflated in two dimensions; set dimension = 2")]
    StripOfThePlane,
    /// An observable of a circle is requested in a strip.
    #[error("observables.{observable}: is of the disks around one that is inflated, not of a strip; remove it")]
    OfACircle {
        /// The observable.
        observable: &'static str,
    },
    /// An observable of spheres is requested for disks.
    #[error("observables.{observable}: is of spheres; set dimension = 3 or remove it")]
    OfSpace {
        /// The observable.
        observable: &'static str,
    },
    /// The drive is not possible.
    #[error("inflation.{0}")]
    Drive(#[from] InflationError),
    /// An observable needs another one.
    #[error("observables.{observable} needs observables.{needed}")]
    ObservableMissing {
        /// The requested observable.
        observable: &'static str,
        /// The observable that it needs.
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
    /// Checks every number.
    ///
    /// # Errors
    /// [`SceneError`] with the field and the value.
    pub fn check(&self) -> Result<(), SceneError> {
        within("dimension", self.dimension as f64, "2 or 3", matches!(self.dimension, 2 | 3))?;
        if self.dimension == 3 && self.inflation.boundary.is_strip() {
            return Err(SceneError::StripOfThePlane);
        }
        if let Some(observable) = self.observables.of_the_plane().filter(|_| self.dimension == 3) {
            return Err(SceneError::OfThePlane { observable });
        }
        if let Some(observable) = self.observables.of_space().filter(|_| self.dimension == 2) {
            return Err(SceneError::OfSpace { observable });
        }
        self.law.check()?;
        DISK_INDEX.check("disk_count", self.disk_count, BYTES_A_DISK)?;
        self.mixture.check(self.disk_count).map_err(SceneError::Mixture)?;
        let tolerance = self.preparation.pressure_tolerance;
        within("preparation.pressure_tolerance", tolerance, "between 0 and 1", tolerance > 0.0 && tolerance < 1.0)?;
        check_relaxer("preparation.relaxer", &self.preparation.relaxer)?;
        let increase = self.inflation.increase;
        within("inflation.increase", increase, "a finite number", increase.is_finite())?;
        self.inflation.check_drive()?;
        if let Some(coupling) = self.inflation.on_site_coupling {
            within("inflation.on_site_coupling", coupling, "a finite number", coupling.is_finite())?;
        }
        if let Boundary::HeldRim { outer_radius_over_side: ratio } = self.inflation.boundary {
            let field = "inflation.boundary.held_rim.outer_radius_over_side";
            within(field, ratio, "above 0 and at most 0.5", ratio > 0.0 && ratio <= 0.5)?;
        }
        if let Boundary::HeldWalls { distance_over_side, length_over_side } = self.inflation.boundary {
            let field = |last: &str| format!("inflation.boundary.held_walls.{last}");
            let ratio = distance_over_side;
            within(field("distance_over_side"), ratio, "above 0 and below 0.5", ratio > 0.0 && ratio < 0.5)?;
            let ratio = length_over_side;
            within(field("length_over_side"), ratio, "between 1e-3 and 1e3", (1e-3..=1e3).contains(&ratio))?;
            if let Some(observable) = self.observables.of_a_circle() {
                return Err(SceneError::OfACircle { observable });
            }
        }
        self.observables.check()?;
        if self.sample.is_empty() {
            return Err(SceneError::NoSample);
        }
        self.check_rest()?;
        for (index, sample) in self.sample.iter().enumerate() {
            sample.check()?;
            if self.sample[..index].iter().any(|other| other.name == sample.name) {
                return Err(SceneError::NameTwice { name: sample.name.clone() });
            }
        }
        self.check_scales()?;
        // Fields that no rule above checks, such as new ones.
        Ok(finite_numbers::check(self)?)
    }
}

impl Observables {
    /// Checks every setting.
    ///
    /// # Errors
    /// [`SceneError`] with the field and the value.
    pub fn check(&self) -> Result<(), SceneError> {
        if let Some(profile) = &self.radial_profile {
            positive("observables.radial_profile.ring_width", profile.ring_width)?;
        }
        #[cfg(feature = "fit")]
        if let Some(fit) = &self.profile_fit {
            if self.radial_profile.is_none() {
                return Err(SceneError::ObservableMissing { observable: "profile_fit", needed: "radial_profile" });
            }
            let wrong = |reason: String| SceneError::Observable { observable: "profile_fit", reason };
            fit.check().map_err(|error| wrong(error.to_string()))?;
        }
        self.check_response()?;
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
                relative_radius("observables.angular_profiles.relative_radii", radius)?;
            }
        }
        Ok(finite_numbers::check_at("observables", self)?)
    }

    /// Checks the settings of penetration, correlation, modes and isostatic length.
    fn check_response(&self) -> Result<(), SceneError> {
        let wrong = |observable, reason: String| SceneError::Observable { observable, reason };
        if let Some(penetration) = &self.penetration_length {
            if self.radial_profile.is_none() {
                let (observable, needed) = ("penetration_length", "radial_profile");
                return Err(SceneError::ObservableMissing { observable, needed });
            }
            for &threshold in &penetration.thresholds {
                positive("observables.penetration_length.thresholds", threshold)?;
            }
        }
        if let Some(angular) = &self.angular_correlation {
            relative_radius("observables.angular_correlation.ring.relative_radius", angular.ring.relative_radius)?;
            positive("observables.angular_correlation.ring.half_width", angular.ring.half_width)?;
            let checked = angular.spectrum.check().and_then(|()| angular.correlation.check());
            checked.map_err(|error| wrong("angular_correlation", error.to_string()))?;
        }
        if let Some(shell) = &self.shell_correlation {
            relative_radius("observables.shell_correlation.relative_radius", shell.relative_radius)?;
            positive("observables.shell_correlation.half_width", shell.half_width)?;
            shell.shell.check().map_err(|error| wrong("shell_correlation", error.to_string()))?;
        }
        #[cfg(feature = "fit")]
        if self.shell_fit.is_some() && self.shell_correlation.is_none() {
            let (observable, needed) = ("shell_fit", "shell_correlation");
            return Err(SceneError::ObservableMissing { observable, needed });
        }
        #[cfg(feature = "fit")]
        if let Some(fit) = &self.spectrum_fit {
            if self.angular_correlation.is_none() {
                let (observable, needed) = ("spectrum_fit", "angular_correlation");
                return Err(SceneError::ObservableMissing { observable, needed });
            }
            let checked = fit.slope.check().and_then(|()| fit.crossover.check());
            checked.map_err(|error| wrong("spectrum_fit", error.to_string()))?;
        }
        if let Some(rings) = &self.radial_dependence {
            for &radius in &rings.relative_radii {
                relative_radius("observables.radial_dependence.relative_radii", radius)?;
            }
            positive("observables.radial_dependence.half_width", rings.half_width)?;
            let checked = rings.spectrum.check().and_then(|()| rings.correlation.check());
            checked.map_err(|error| wrong("radial_dependence", error.to_string()))?;
        }
        if let Some(multipoles) = &self.multipoles {
            multipoles.check().map_err(|error| wrong("multipoles", error.to_string()))?;
        }
        #[cfg(feature = "fit")]
        if let Some(modes) = &self.elastic_modes {
            if self.multipoles.is_none() {
                return Err(SceneError::ObservableMissing { observable: "elastic_modes", needed: "multipoles" });
            }
            modes.check().map_err(|error| wrong("elastic_modes", error.to_string()))?;
        }
        if let Some(isostatic) = &self.isostatic_length {
            isostatic.check().map_err(|error| wrong("isostatic_length", error.to_string()))?;
        }
        Ok(())
    }
}

/// Checks the midpoint of a ring over R.
fn relative_radius(field: &str, radius: f64) -> Result<(), SceneError> {
    within(field, radius, "above 0 and below 1", radius > 0.0 && radius < 1.0)
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
            Source::Pressure(value) | Source::FileAtPressure { pressure: value, .. } => {
                positive(field("source.pressure"), value)?
            }
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

/// Checks the common settings of nonlinear conjugate gradients and L-BFGS.
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
