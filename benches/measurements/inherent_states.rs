//! When a motion after an inflation decides its minimum: the states that FIRE and Newton's method reach from points along it.
//!
//! ```text
//! cargo run --release --features measurements --example inherent_states -- [--disks N] [--pressures A,B,...] [--seeds FIRST,COUNT]
//! ```
//!
//! Random points are quenched at a pressure, cut to a circle with a held rim and brought to rest; the centre grows by 0.1. From there damped
//! dynamics move the disks, by viscoelastic and by constant damping of rate 500. The motion is stopped where its elastic and kinetic energy above
//! that of its end has fallen to a share of the energy before the inflation; FIRE and Newton's method take the positions from there to a minimum, the
//! inherent state of that moment (Stillinger, Weber (1982), Phys. Rev. A 25, 978). A line each has the share, the kinetic part of the energy, and of the
//! inherent state Δp/p^(1/3) and the contacts made, as means over seeds with standard errors, and how many motions are in the minimum of their end
//! already.

use std::error::Error;

use jamscope::inflation::{Centre, Circle, choose_centre};
use jamscope::law::Hertzian;
use jamscope::law::damping::{ConstantDamping, DampingChoice, ViscoelasticDamping};
use jamscope::network::ContactNetwork;
use jamscope::packing::{Mixture, Packing};
use jamscope::preparation::{Preparation, Target, prepare_with};
use jamscope::relax::{Check, ImplicitDynamics, Relaxer, Staged, Trace};

/// Radius of the circle over the side of the box: the study's smallest size.
const OUTER_RADIUS_OVER_SIDE: f64 = 0.480;

/// Energies where a motion is stopped, over the elastic energy before the inflation.
const SHARES: [f64; 10] = [1e3, 1e2, 1e1, 1e0, 3e-1, 1e-1, 3e-2, 1e-2, 1e-3, 1e-4];

/// Energies of one minimum differ by less than this share: ends have residuals of 10⁻⁸ of a contact force.
const SAME_MINIMUM: f64 = 1e-9;

struct Start {
    packing: Packing<2>,
    centre: usize,
    outer_radius: f64,
}

/// Stops a motion at an energy and remembers its kinetic part.
struct StopAt {
    energy: f64,
    kinetic_share: f64,
    reached: bool,
}

impl Trace for StopAt {
    fn checked(&mut self, check: &Check) {
        if !self.reached && check.energy + check.kinetic_energy <= self.energy {
            self.reached = true;
            self.kinetic_share = check.kinetic_energy / (check.energy + check.kinetic_energy);
        }
    }

    fn interrupted(&mut self) -> bool {
        self.reached
    }
}

/// What a state is: E, Δp/p^(1/3), contacts made.
#[derive(Clone, Copy)]
struct End {
    energy: f64,
    pressure_change: f64,
    made: f64,
}

fn main() -> Result<(), Box<dyn Error>> {
    let (mut disk_count, mut pressures, mut seeds) = (5548, vec![4.0, 40.0, 4000.0], (1, 8));
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let value = arguments.next().ok_or_else(|| format!("{argument} needs a value"))?;
        match argument.as_str() {
            "--disks" => disk_count = value.parse()?,
            "--pressures" => pressures = value.split(',').map(str::parse).collect::<Result<_, _>>()?,
            "--seeds" => {
                let (first, count) = value.split_once(',').ok_or("--seeds FIRST,COUNT")?;
                seeds = (first.parse()?, count.parse()?);
            }
            _ => return Err(format!("unknown argument {argument}").into()),
        }
    }
    for pressure in pressures {
        let starts: Vec<Start> =
            (seeds.0..seeds.0 + seeds.1).map(|seed| at_rest(disk_count, pressure, seed)).collect::<Result<_, _>>()?;
        for damping in [
            DampingChoice::Viscoelastic(ViscoelasticDamping { rate: 500.0 }),
            DampingChoice::Constant(ConstantDamping { rate: 500.0 }),
        ] {
            along(pressure, damping, &starts)?;
        }
    }
    Ok(())
}

/// A circle at rest.
fn at_rest(disk_count: usize, pressure: f64, seed: u64) -> Result<Start, Box<dyn Error>> {
    let (law, relaxer) = (Hertzian::default(), Staged::default());
    let (mixture, target) = (Mixture::default(), Target::Pressure(pressure));
    let preparation = Preparation { disk_count, mixture, target, tolerance: 0.01, seed, ..Preparation::default() };
    let prepared = prepare_with::<2>(&preparation, &law, &relaxer, &mut ())?;
    let packing = prepared.packing.get();
    let chosen = choose_centre(packing, &law, Centre::Backbone, seed)?;
    let side = packing.domain().lengths().ok_or("the packing is not periodic")?[0];
    let circle = Circle::cut(packing, chosen, OUTER_RADIUS_OVER_SIDE * side)?;
    let outcome = relaxer.relax(circle.packing.clone(), &law, &mut ())?;
    let stop = outcome.stop;
    let packing = outcome.converged().map_err(|_| format!("the circle is not at rest: {stop:?}"))?.into_inner();
    Ok(Start { packing, centre: circle.centre, outer_radius: circle.outer_radius })
}

/// The inherent states along the motions of all starts.
fn along(pressure: f64, damping: DampingChoice, starts: &[Start]) -> Result<(), Box<dyn Error>> {
    let law = Hertzian::default();
    let dynamics = ImplicitDynamics { damping, ..ImplicitDynamics::default() };
    let mut columns: Vec<Vec<(f64, End, bool)>> = vec![Vec::new(); SHARES.len() + 1];
    for start in starts {
        let radius = start.packing.radii()[start.centre];
        let grown = start.packing.clone().with_radius(start.centre, radius + 0.1)?;
        let before = ContactNetwork::new(&start.packing, &law)?.energy();
        let last = end(start, &dynamics.relax(grown.clone(), &law, &mut ())?.state)?;
        for (column, share) in columns.iter_mut().zip(SHARES) {
            let mut stop = StopAt { energy: last.energy + share * before, kinetic_share: f64::NAN, reached: false };
            let stopped = dynamics.relax(grown.clone(), &law, &mut stop)?.state;
            let inherent = end(start, &Staged::default().relax(stopped, &law, &mut ())?.state)?;
            let same = (inherent.energy / last.energy - 1.0).abs() < SAME_MINIMUM;
            column.push((stop.kinetic_share, inherent, same));
        }
        columns[SHARES.len()].push((0.0, last, true));
    }
    for (share, column) in SHARES.into_iter().chain([0.0]).zip(&columns) {
        let count = column.len() as f64;
        let kinetic = column.iter().map(|row| row.0).sum::<f64>() / count;
        let (change, error) = mean(column.iter().map(|row| row.1.pressure_change));
        let (made, made_error) = mean(column.iter().map(|row| row.1.made));
        let same = column.iter().filter(|row| row.2).count();
        println!(
            "p {pressure} {} {}: energy above the end {share}, kinetic share {kinetic:.2}, inherent Δp/p^(1/3) {change:.3} ± {error:.3}, \
             made {made:.0} ± {made_error:.0}, in the minimum of the end {same} of {}",
            match damping {
                DampingChoice::Constant(_) => "constant",
                DampingChoice::Viscoelastic(_) => "viscoelastic",
            },
            damping.rate(),
            column.len()
        );
    }
    Ok(())
}

/// E, Δp/p^(1/3) and contacts made of a state, against the start.
fn end(start: &Start, state: &Packing<2>) -> Result<End, Box<dyn Error>> {
    let law = Hertzian::default();
    let networks = [ContactNetwork::new(&start.packing, &law)?, ContactNetwork::new(state, &law)?];
    let area = std::f64::consts::PI * start.outer_radius * start.outer_radius;
    let [before, after] =
        [&networks[0], &networks[1]].map(|network| network.cluster_pressure(area, |disk| disk > start.centre));
    let [old, new] = [&networks[0], &networks[1]].map(|network| {
        network.contacts.iter().map(|contact| (contact.first, contact.second)).collect::<std::collections::HashSet<_>>()
    });
    let made = new.difference(&old).count() as f64;
    Ok(End { energy: networks[1].energy(), pressure_change: (after - before) / before.cbrt(), made })
}

/// Mean and its standard error; the latter NaN for one value.
fn mean(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let count = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / count;
    let squares: f64 = values.map(|value| (value - mean) * (value - mean)).sum();
    (mean, (squares / (count * (count - 1.0))).sqrt())
}
