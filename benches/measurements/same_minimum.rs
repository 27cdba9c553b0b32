//! Whether implicit dynamics end in the minimum that explicit damped dynamics end in, and whether those do so themselves.
//!
//! ```text
//! cargo run --release --features measurements --example same_minimum -- [--centres N] [--tolerances A,B,...] [NAME] ...   (stored packings)
//! ```
//!
//! The centre of each packing is inflated by 0.1 in a circle with a held rim, and the rest moves with either damping law:
//! explicitly at 0.9 and at half of that, 0.45, of the bound on a stable step, to 10⁻⁵ of the mean contact force, from where
//! Newton goes on to 10⁻¹⁰; and implicitly at several tolerances, to the same limit. A line a centre has the largest distance
//! of a backbone disk between the two explicit ends, and between each implicit one and the explicit one at half the step; where
//! the first tolerance ends elsewhere though the explicit ends agree, the explicit step is halved once more. Then a line for
//! the packing: in how many of the centres the distances are at most 10⁻⁸, steps and factorisations a centre, seconds a centre.

#[path = "scenes/distance.rs"]
mod distance;
#[path = "scenes/inflated.rs"]
mod inflated;

use std::error::Error;

use jamscope::io::read_packing;
use jamscope::law::Hertzian;
use jamscope::law::damping::{ConstantDamping, DampingChoice, ViscoelasticDamping};
use jamscope::packing::Packing;
use jamscope::relax::{Cost, DampedDynamics, ForceLimit, ImplicitDynamics, Newton, Outcome, Relaxer, Stop, TimeStep};

use distance::distance;
use inflated::inflated;

/// Stored packings if none is named.
const STORED: [&str; 3] = ["hertz_N1000_p10", "hertz_N1000_p100", "hertz_N1000_p800"];

/// Largest distance at which two states are one.
const SAME: f64 = 1e-8;

/// Limit of all states compared: a residual of 10⁻¹⁰ leaves a disk about that share of an overlap away.
const LIMIT: ForceLimit = ForceLimit::Relative(1e-10);

/// Where the explicit motion is left to Newton.
const EXPLICIT_LIMIT: ForceLimit = ForceLimit::Relative(1e-5);

/// The explicit step over its bound.
const SHARE: f64 = 0.9;

fn main() -> Result<(), Box<dyn Error>> {
    let (mut centre_count, mut names) = (10u64, Vec::new());
    let mut tolerances = vec![ImplicitDynamics::default().tolerance, 0.01, 0.005];
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
        match argument.as_str() {
            "--centres" => centre_count = value()?.parse()?,
            "--tolerances" => tolerances = value()?.split(',').map(str::parse).collect::<Result<_, _>>()?,
            _ => names.push(argument),
        }
    }
    if names.is_empty() {
        names = STORED.map(String::from).to_vec();
    }
    for name in names {
        let packing = read_packing::<2>(format!("{}/fixtures/packings/{name}.xyz", env!("CARGO_MANIFEST_DIR")))?;
        let laws = [
            ("constant", DampingChoice::Constant(ConstantDamping { rate: 500.0 })),
            ("viscoelastic", DampingChoice::Viscoelastic(ViscoelasticDamping { rate: 500.0 })),
        ];
        for (law, damping) in laws {
            table(&name, law, damping, &packing, centre_count, &tolerances)?;
        }
    }
    Ok(())
}

/// The centres of one packing with one damping law.
fn table(
    name: &str,
    law: &str,
    damping: DampingChoice,
    packing: &Packing<2>,
    centre_count: u64,
    tolerances: &[f64],
) -> Result<(), Box<dyn Error>> {
    println!("{name}, {law} damping: away from explicit dynamics at {:.2} of the bound", 0.5 * SHARE);
    print!("{:>8} {:>13}", "centre", format!("explicit {SHARE}"));
    tolerances.iter().for_each(|tolerance| print!(" {:>14}", format!("implicit {tolerance}")));
    println!();
    let mut costs = vec![Cost::default(); 2 + tolerances.len()];
    let mut same_counts = vec![0; 1 + tolerances.len()];
    for seed in 1..=centre_count {
        let start = inflated(packing, seed)?;
        let whole = explicit(&start, damping, SHARE, &mut costs[0])?;
        let half = explicit(&start, damping, 0.5 * SHARE, &mut costs[1])?;
        let mut apart = vec![distance(&whole, &half)?];
        for (tolerance, cost) in tolerances.iter().zip(&mut costs[2..]) {
            let dynamics = ImplicitDynamics { damping, limit: LIMIT, tolerance: *tolerance, ..Default::default() };
            apart
                .push(distance(&at_rest(dynamics.relax(start.clone(), &Hertzian::default(), &mut ())?, cost)?, &half)?);
        }
        print!("{seed:>8} {:>13.1e}", apart[0]);
        apart[1..].iter().for_each(|apart| print!(" {apart:>14.1e}"));
        if apart[0] <= SAME && apart.get(1).is_some_and(|&apart| apart > SAME) {
            let quarter = explicit(&start, damping, 0.25 * SHARE, &mut Cost::default())?;
            print!("   explicit {:.3}: {:.1e}", 0.25 * SHARE, distance(&quarter, &half)?);
        }
        println!();
        same_counts.iter_mut().zip(&apart).for_each(|(count, &apart)| *count += usize::from(apart <= SAME));
    }
    print!("{:>8} {:>13}", "same", same_counts[0]);
    same_counts[1..].iter().for_each(|count| print!(" {count:>14}"));
    let per = |total: f64| total / centre_count as f64;
    let row = |what: &str, of: &dyn Fn(&Cost) -> f64| {
        print!("\n{what:>8} {:>13.2}", per(of(&costs[0])));
        costs[2..].iter().for_each(|cost| print!(" {:>14.2}", per(of(cost))));
        print!("   explicit {:.2}: {:.2}", 0.5 * SHARE, per(of(&costs[1])));
    };
    row("steps", &|cost| cost.step_count as f64);
    row("factor.", &|cost| cost.factorisation_count as f64);
    row("seconds", &|cost| cost.seconds);
    println!("\n");
    Ok(())
}

/// Explicit damped dynamics to a small residual, then Newton.
fn explicit(
    start: &Packing<2>,
    damping: DampingChoice,
    share: f64,
    cost: &mut Cost,
) -> Result<Packing<2>, Box<dyn Error>> {
    let time_step = TimeStep::OfStability(share);
    let dynamics = DampedDynamics { damping, limit: EXPLICIT_LIMIT, time_step, ..Default::default() };
    let law = Hertzian::default();
    let end = at_rest(dynamics.relax(start.clone(), &law, &mut ())?, cost)?;
    at_rest(Newton { limit: LIMIT, ..Newton::default() }.relax(end, &law, &mut ())?, cost)
}

fn at_rest(outcome: Outcome<Packing<2>>, cost: &mut Cost) -> Result<Packing<2>, Box<dyn Error>> {
    *cost = cost.plus(outcome.cost);
    match outcome.stop {
        Stop::Converged(_) | Stop::RoundingFloor => Ok(outcome.state),
        stop => Err(format!("stopped by {stop:?} at {:.1e}", outcome.residual.relative()).into()),
    }
}
