//! What preparing a packing at a pressure costs, with every state of the search brought to rest and with states passed through.
//!
//! ```text
//! cargo run --release --features measurements --example preparation_cost -- [--disks N] [--seeds N] [PRESSURE] ...
//! ```
//!
//! Sums over the seeds, for FIRE and for the staged relaxer: relaxations, force evaluations, factorisations, seconds.

use std::error::Error;

use jamscope::law::{Hertzian, PairLaw};
use jamscope::packing::{Mixture, Packing, PackingError};
use jamscope::preparation::{Preparation, Target, prepare_with};
use jamscope::relax::{Cost, Fire, Outcome, Relaxer, Staged, Trace};

/// A relaxer that passes through states at a residual of its own, or through none.
struct PassingAt<R>(R, Option<f64>);

impl<R: Relaxer> Relaxer for PassingAt<R> {
    fn relax<const D: usize>(
        &self,
        packing: Packing<D>,
        law: &dyn PairLaw,
        trace: &mut dyn Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError> {
        self.0.relax(packing, law, trace)
    }

    fn for_intermediate_states(&self, _limit: f64) -> Option<Self> {
        self.0.for_intermediate_states(self.1?).map(|relaxer| PassingAt(relaxer, self.1))
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let (mut disks, mut seeds, mut pressures) = (1000usize, 3u64, Vec::new());
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--disks" => disks = arguments.next().ok_or("--disks needs a number")?.parse()?,
            "--seeds" => seeds = arguments.next().ok_or("--seeds needs a number")?.parse()?,
            pressure => pressures.push(pressure.parse()?),
        }
    }
    if pressures.is_empty() {
        pressures = vec![0.1, 1.0, 10.0, 100.0, 1000.0];
    }
    println!(
        "{:>9} {:<7} {:>8} {:>11} {:>12} {:>14} {:>8}",
        "pressure", "relaxer", "passing", "relaxations", "evaluations", "factorisations", "seconds"
    );
    for pressure in pressures {
        let row = |relaxer: &str, passing: &str, (count, cost): (usize, Cost)| {
            println!(
                "{pressure:>9} {relaxer:<7} {passing:>8} {count:>11} {:>12} {:>14} {:>8.2}",
                cost.force_evaluation_count, cost.factorisation_count, cost.seconds
            );
        };
        row("FIRE", "never", made(disks, pressure, seeds, &PassingAt(Fire::default(), None))?);
        row("staged", "never", made(disks, pressure, seeds, &PassingAt(Staged::default(), None))?);
        for limit in [1e-2, 1e-3, 1e-4, 1e-5] {
            row(
                "staged",
                &format!("{limit:.0e}"),
                made(disks, pressure, seeds, &PassingAt(Staged::default(), Some(limit)))?,
            );
        }
        row("FIRE", "default", made(disks, pressure, seeds, &Fire::default())?);
        row("staged", "default", made(disks, pressure, seeds, &Staged::default())?);
    }
    Ok(())
}

/// Relaxations and cost over the seeds.
fn made(disk_count: usize, pressure: f64, seeds: u64, relaxer: &impl Relaxer) -> Result<(usize, Cost), Box<dyn Error>> {
    let (mut count, mut cost) = (0, Cost::default());
    for seed in 1..=seeds {
        let target = Target::Pressure(pressure);
        let preparation = Preparation {
            disk_count,
            mixture: Mixture::default(),
            target,
            tolerance: 0.01,
            seed,
            ..Preparation::default()
        };
        let prepared = prepare_with::<2>(&preparation, &Hertzian::default(), relaxer, &mut ())?;
        count += prepared.relaxation_count;
        cost = cost.plus(prepared.cost);
    }
    Ok((count, cost))
}
