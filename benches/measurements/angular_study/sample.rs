//! One packing inflated and deflated: what is kept of it.

use std::error::Error;
use std::f64::consts::PI;
use std::time::Instant;

use jamscope::displacement::DisplacementField;
use jamscope::inflation::{Boundary, Inflated, Inflation, inflate_with};
use jamscope::law::Hertzian;
use jamscope::observe::angular::{RingSample, RingSettings};
use jamscope::observe::multipoles::{MultipoleFit, MultipoleSettings, Multipoles};
use jamscope::observe::{ContactCycle, PressureChange};
use jamscope::packing::Mixture;
use jamscope::preparation::{Preparation, Target, prepare_with};
use jamscope::relax::{ImplicitDynamics, Relaxer, Staged};
use serde::{Deserialize, Serialize};

/// What all samples of a file have in common.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Disks in the box.
    pub disk_count: usize,
    /// R/L.
    pub outer_radius_over_side: f64,
    /// d_0.
    pub increase: f64,
    /// The relaxer of everything,
    pub relaxer: Staged,
    /// unless all moves by damped dynamics.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dynamics: Option<ImplicitDynamics>,
    /// φ of packings that are quenched there and not brought to a pressure.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub packing_fraction: Option<f64>,
}

/// One sample.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// p̂ asked for.
    pub reduced_pressure: f64,
    /// Seed of the random points and of the disk inflated.
    pub seed: u64,
    /// Seconds it took.
    pub seconds: f64,
    /// What was measured, or why nothing was.
    pub outcome: Result<Measured, String>,
}

/// What is measured of a sample.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// p of the box before.
    pub pressure: f64,
    /// N, mobile disks inside the circle.
    pub mobile_count: usize,
    /// d_r of the ring r̂ = 0.5 ± 0.03.
    pub ring: RingSample,
    /// Shares of modes 0, 1, 2 and of everything else in the mean square of d_r of that ring.
    pub shares: [f64; 4],
    /// Δp/p^(1/3) of the circle.
    pub pressure_change: Option<f64>,
    /// Contacts kept, made, broken on inflation; of those made and broken, how many returned on deflation.
    pub contacts: [usize; 5],
}

impl Plan {
    /// The geometry of the study; `damped`: its dynamics as well; with a packing fraction its packings.
    pub fn of(disk_count: usize, damped: bool, packing_fraction: Option<f64>) -> Self {
        let outer_radius_over_side = match disk_count {
            ..10_000 => 0.480,
            10_000..50_000 => 0.486,
            _ => 0.491,
        };
        let dynamics = damped.then(ImplicitDynamics::default);
        Plan {
            disk_count,
            outer_radius_over_side,
            increase: 0.1,
            relaxer: Staged::default(),
            dynamics,
            packing_fraction,
        }
    }

    /// N, expected.
    pub fn mobile_count(&self) -> f64 {
        PI * self.outer_radius_over_side.powi(2) * self.disk_count as f64
    }

    /// The sample of a pressure and a seed.
    pub fn sample(&self, reduced_pressure: f64, seed: u64) -> Row {
        let start = Instant::now();
        let outcome = self.measured(reduced_pressure, seed).map_err(|error| error.to_string());
        Row { reduced_pressure, seed, seconds: start.elapsed().as_secs_f64(), outcome }
    }

    fn measured(&self, reduced_pressure: f64, seed: u64) -> Result<Measured, Box<dyn Error>> {
        match &self.dynamics {
            Some(dynamics) => self.relaxed(reduced_pressure, seed, dynamics),
            None => self.relaxed(reduced_pressure, seed, &self.relaxer),
        }
    }

    fn relaxed(&self, reduced_pressure: f64, seed: u64, relaxer: &impl Relaxer) -> Result<Measured, Box<dyn Error>> {
        let law = Hertzian::default();
        let pressure = reduced_pressure / self.mobile_count().powf(1.5);
        let target = self.packing_fraction.map_or(Target::Pressure(pressure), Target::PackingFraction);
        let preparation = Preparation {
            disk_count: self.disk_count,
            mixture: Mixture::default(),
            target,
            tolerance: 0.01,
            seed,
            ..Preparation::default()
        };
        let prepared = prepare_with::<2>(&preparation, &law, relaxer, &mut ())?;
        let boundary = Boundary::HeldRim { outer_radius_over_side: self.outer_radius_over_side };
        let inflation = Inflation { increase: self.increase, boundary, deflate: true, ..Inflation::default() };
        let inflated = inflate_with(&inflation, prepared.packing.get(), &law, relaxer, seed, &mut ())?;
        let (ring, shares) = ring(&inflated)?;
        let cycle = ContactCycle::of(&inflated, &law)?.ok_or("it was deflated")?;
        let changes = &cycle.inflation;
        Ok(Measured {
            pressure: prepared.pressure,
            mobile_count: inflated.mobile_count,
            ring,
            shares,
            pressure_change: PressureChange::of_inflation(&inflated, &law).scaled,
            contacts: [
                changes.kept_count,
                changes.made.len(),
                changes.broken.len(),
                cycle.made_returned_count,
                cycle.broken_returned_count,
            ],
        })
    }
}

/// The ring and the shares of its modes.
fn ring(inflated: &Inflated<2>) -> Result<(RingSample, [f64; 4]), Box<dyn Error>> {
    let mut field = DisplacementField::of_inflation(inflated);
    let settings = RingSettings::default();
    let ring = RingSample::of_field(&field, &settings)?;
    let place = |distance: f64| distance / field.outer_radius - settings.relative_radius;
    field.disks.retain(|disk| place(disk.distance).abs() <= settings.half_width);
    // Only disks of the ring are left: one ring as wide as the circle is that ring.
    let whole = MultipoleSettings { ring_width: field.outer_radius, ..MultipoleSettings::default() };
    let multipoles = Multipoles::of(&field, &whole)?;
    let [ring_modes] = multipoles.rings.as_slice() else { return Err("one ring".into()) };
    let MultipoleFit::Fitted { radial, .. } = &ring_modes.fit else {
        return Err(format!("no modes: {:?}", ring_modes.fit).into());
    };
    Ok((ring, radial.shares.ok_or("nothing moved")?))
}
