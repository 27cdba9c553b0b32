//! [`DriveSummary`]: a point force, a force dipole or a displaced disk, beside the exact solution of its continuum.
//!
//! The medium has the bulk and shear modulus of the prepared packing, B and μ: ν = (B − μ)/(B + μ). With sites it is
//! screened. Nothing is fitted. The solution is that of a source at a point, so it holds from some diameters on.

use std::any::Any;

use serde::Serialize;

use crate::displacement::DisplacementField;
use crate::inflation::{Applied, Drive, Inflated};
use crate::law::pair_law::PairLaw;
use crate::linear::hessian::Prestress;
use crate::linear::{ElasticModuli, LinearError};
use crate::network::ContactNetwork;
use crate::observe::Multipoles;
use crate::observe::multipoles::{ModeFit, MultipoleError, MultipoleFit, MultipoleSettings};
use crate::packing::{Packing, PackingError};
use crate::reference::angular_modes::force_dipole::ForceDipole;
use crate::reference::angular_modes::point_force::PointForce;
use crate::reference::angular_modes::screened_source::ScreenedSource;
use crate::reference::angular_modes::{AngularModeError, AngularSolution, ModeAmplitudes};
use crate::reference::{Annulus, ReferenceError};
use crate::response::Measurement;
use crate::scene::Scene;
use crate::vector::{Vector, difference, norm};

/// Why a drive has no exact solution here.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DriveError {
    /// The packing has no elastic moduli.
    #[error("no elastic moduli: {0}")]
    Moduli(#[from] LinearError),
    /// The disks themselves are invalid.
    #[error(transparent)]
    Packing(#[from] PackingError),
    /// The disk is larger than the circle.
    #[error(transparent)]
    Annulus(#[from] ReferenceError),
    /// The medium has no such solution.
    #[error(transparent)]
    Mode(#[from] AngularModeError),
    /// The modes cannot be measured.
    #[error(transparent)]
    Multipoles(#[from] MultipoleError),
    /// The rim of the exact solutions is a circle.
    #[error("the exact solution is that of a circle with a held rim")]
    NoRim,
}

/// A drive beside the exact solution of its continuum.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DriveSummary {
    /// F, the force on the disk at the centre; for a displaced disk what it needs more than before \[force\].
    pub force: f64,
    /// F s, the moment of a dipole, positive outwards \[force · length\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub moment: Option<f64>,
    /// Displacement of a displaced disk \[length\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance: Option<f64>,
    /// θ_0, the direction of the force or of the arm of the dipole \[rad\].
    pub angle: f64,
    /// μ of the packing \[force / length\].
    pub shear_modulus: f64,
    /// ν of the packing in two dimensions \[1\].
    pub poisson_ratio: f64,
    /// Measured and exact amplitudes, ring by ring, of the modes that the drive excites.
    pub modes: Vec<DriveMode>,
}

/// One mode in one ring: d_r = U cos n(θ − θ_0), d_θ = w sin n(θ − θ_0).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DriveMode {
    /// n.
    pub mode: usize,
    /// Mean distance of the disks of the ring from the centre \[length\].
    pub radius: f64,
    /// Number of disks.
    pub disk_count: usize,
    /// U and its standard error \[length\].
    pub radial: [f64; 2],
    /// w and its standard error; 0 for n = 0 \[length\].
    pub transverse: [f64; 2],
    /// U and w of the continuum \[length\].
    pub exact: [f64; 2],
}

impl DriveSummary {
    /// The summary of a drive in the plane. `prepared` is the periodic packing that was driven, `coupling` the Γ of the
    /// inflation. None for an inflation, and for strains of the rim, whose exact non-affine displacement is zero.
    ///
    /// # Errors
    /// [`DriveError`].
    pub fn of(
        inflated: &Inflated<2>,
        prepared: &Packing<2>,
        law: &dyn PairLaw,
        coupling: Option<f64>,
        settings: &MultipoleSettings,
    ) -> Result<Option<Self>, DriveError> {
        if matches!(inflated.drive, Drive::Inflation | Drive::Shear { .. } | Drive::Compression { .. }) {
            return Ok(None);
        }
        if inflated.before.packing.get().domain().edges().is_some() {
            return Err(DriveError::NoRim);
        }
        let elastic = ElasticModuli::of(prepared, law, Prestress::Included)?.relaxed;
        let (bulk, shear) = (elastic.bulk(), elastic.shear().mean);
        let poisson_ratio = (bulk - shear) / (bulk + shear);
        let applied = Applied::of(inflated.before.packing.get(), &inflated.start, inflated.centre);
        let moved = norm(applied.displacement) > 0.0;
        let force = if moved { reaction(inflated, law)? } else { applied.force };
        let along = applied.arm.unwrap_or(force);
        let moment = applied.arm.map(|arm| -(force[0] * arm[0] + force[1] * arm[1]));
        let annulus = Annulus::new(inflated.inner_radius, inflated.outer_radius)?;
        // Γ/(A μ), A the area per disk, so that the force Γ u on a disk is that on its area.
        let screening = coupling.map(|coupling| {
            coupling * prepared.len() as f64 / (prepared.domain().volume().unwrap_or(f64::INFINITY) * shear)
        });
        let solutions: Vec<Box<dyn AngularSolution>> = match (moment, screening) {
            (None, None) => vec![Box::new(PointForce::new(annulus, poisson_ratio, norm(force) / shear)?)],
            (None, Some(screening)) => {
                vec![Box::new(ScreenedSource::force(annulus, poisson_ratio, screening, norm(force) / shear)?)]
            }
            (Some(moment), None) => boxed(*ForceDipole::new(annulus, poisson_ratio, moment / shear)?.modes()),
            (Some(moment), Some(screening)) => {
                boxed(ScreenedSource::dipole(annulus, poisson_ratio, screening, moment / shear)?)
            }
        };
        let angle = libm::atan2(along[1], along[0]);
        let measured = Multipoles::of(&DisplacementField::of_inflation(inflated), settings)?;
        let modes = solutions.iter().flat_map(|solution| modes(&measured, solution.as_ref(), angle, annulus)).collect();
        Ok(Some(DriveSummary {
            force: norm(force),
            moment,
            distance: moved.then(|| applied.displacement[0]),
            angle,
            shear_modulus: shear,
            poisson_ratio,
            modes,
        }))
    }

    /// U of the continuum at a distance between the rings, by linear interpolation; none outside \[length\].
    pub fn exact_radial(&self, mode: usize, radius: f64) -> Option<f64> {
        let rings: Vec<&DriveMode> = self.modes.iter().filter(|ring| ring.mode == mode).collect();
        let [first, second] = *rings.windows(2).find(|pair| pair[0].radius <= radius && radius <= pair[1].radius)?
        else {
            return None;
        };
        let share = (radius - first.radius) / (second.radius - first.radius);
        Some(first.exact[0] + share * (second.exact[0] - first.exact[0]))
    }

    /// The mean square deviation of the measured from the exact modes, over the mean square of the exact ones, from this
    /// distance on: √(Σ r² |measured − exact|² / Σ r² |exact|²). None without a ring there.
    pub fn deviation(&self, from: f64) -> Option<f64> {
        let rings = self.modes.iter().filter(|mode| mode.radius >= from);
        let (apart, exact) = rings.fold((0.0, 0.0), |(apart, exact), mode| {
            let square = |[first, second]: [f64; 2]| mode.radius.powi(2) * (first * first + second * second);
            let by = difference([mode.radial[0], mode.transverse[0]], mode.exact);
            (apart + square(by), exact + square(mode.exact))
        });
        (exact > 0.0).then(|| (apart / exact).sqrt())
    }
}

/// Another drive than an inflation beside its exact solution, in the plane.
pub(super) fn of<const D: usize>(
    scene: &Scene,
    inflated: &Inflated<D>,
    prepared: &Packing<D>,
    law: &dyn PairLaw,
) -> Option<Measurement<DriveSummary>> {
    let inflated = (inflated as &dyn Any).downcast_ref::<Inflated<2>>()?;
    let prepared = (prepared as &dyn Any).downcast_ref::<Packing<2>>()?;
    let (coupling, modes) = (scene.inflation.on_site_coupling, scene.observables.multipoles?);
    DriveSummary::of(inflated, prepared, law, coupling, &modes).transpose().map(Measurement::from)
}

fn boxed(solutions: [impl AngularSolution + 'static; 2]) -> Vec<Box<dyn AngularSolution>> {
    solutions.into_iter().map(|solution| Box::new(solution) as Box<dyn AngularSolution>).collect()
}

/// What holds a displaced disk, more than before: minus the change of the contact forces on it \[force\].
fn reaction(inflated: &Inflated<2>, law: &dyn PairLaw) -> Result<Vector<2>, PackingError> {
    let on_centre = |packing: &Packing<2>| ContactNetwork::new(packing, law).map(|it| it.forces()[inflated.centre]);
    Ok(difference(on_centre(inflated.before.packing.get())?, on_centre(inflated.after.packing.get())?))
}

/// The rings of one mode, from the first that lies outside the disk.
fn modes<'a>(
    measured: &'a Multipoles,
    solution: &'a dyn AngularSolution,
    angle: f64,
    annulus: Annulus,
) -> impl Iterator<Item = DriveMode> + 'a {
    let mode = solution.mode() as usize;
    let (sine, cosine) = libm::sincos(mode as f64 * angle);
    measured.rings.iter().filter_map(move |ring| {
        let MultipoleFit::Fitted { radial, transverse } = &ring.fit else { return None };
        let (radial, transverse) = (radial.modes.get(mode)?, transverse.modes.get(mode)?);
        if !(annulus.inner_radius()..=annulus.outer_radius()).contains(&ring.radius) {
            return None;
        }
        // The parts along cos n(θ − θ_0) and sin n(θ − θ_0).
        let part = |fit: &ModeFit, [of_cosine, of_sine]: [f64; 2]| {
            let [first, second] = fit.standard_errors;
            [of_cosine * fit.cosine + of_sine * fit.sine, libm::hypot(of_cosine * first, of_sine * second)]
        };
        let ModeAmplitudes { radial: exact, transverse: exact_transverse } = solution.at(ring.radius).value;
        Some(DriveMode {
            mode,
            radius: ring.radius,
            disk_count: ring.disk_count,
            radial: part(radial, [cosine, sine]),
            transverse: if mode == 0 { [0.0, 0.0] } else { part(transverse, [-sine, cosine]) },
            // In phase: u_θ = V sin nθ is Re[−i V e^(inθ)].
            exact: [exact.re, -exact_transverse.im],
        })
    })
}
