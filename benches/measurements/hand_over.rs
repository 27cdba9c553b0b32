//! When FIRE should hand a packing over to Newton: work and time of the staged relaxer over those of FIRE alone.
//!
//! ```text
//! cargo run --release --features measurements --example hand_over -- [NAME] ...          (stored Hertzian packings, four centres each)
//! cargo run --release --features measurements --example hand_over -- [--keep FOLDER] DISKS PRESSURE ...  (packings prepared first, one centre each)
//! ```
//!
//! The centre of each packing is inflated by 0.1 in a circle with a held rim and the rest relaxed to 10⁻¹² of the mean contact
//! force: stored packings by FIRE alone and by the staged relaxer with hand-overs from 10⁻¹ to 10⁻⁶, prepared ones by the
//! staged relaxer as it is. Evaluations and factorisations are sums over the centres (the most factorisations of one centre
//! beside them). Times of stored packings are over that of FIRE to 10⁻¹², those of prepared ones in seconds. With `--keep` a
//! prepared packing is written to a file of the folder, and read from there by the next run.

#[path = "scenes/inflated.rs"]
mod inflated;
#[path = "scenes/stored.rs"]
mod stored;

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use jamscope::io::{read_packing, write_packing};
use jamscope::law::Hertzian;
use jamscope::network::ContactNetwork;
use jamscope::packing::{Mixture, Packing};
use jamscope::preparation::{Preparation, Target, prepare_with};
use jamscope::relax::{Cost, Fire, ForceLimit, Outcome, Relaxer, Staged, Stop};
use jamscope::vector::larger;

use inflated::inflated;
use stored::{named, starts};

const LIMIT: ForceLimit = ForceLimit::Relative(1e-12);

fn main() -> Result<(), Box<dyn Error>> {
    let law = Hertzian::default();
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    println!(
        "{:<18} {:>9} {:>12} {:>7} {:>5} {:>6} {:>9} {:>9}  stop",
        "packing", "hand-over", "evaluations", "factor.", "most", "time", "residual", "floor"
    );
    let (folder, arguments) = match arguments.as_slice() {
        [option, folder, rest @ ..] if option == "--keep" => (Some(Path::new(folder)), rest),
        all => (None, all),
    };
    if let Some(Ok(disk_count)) = arguments.first().map(|first| first.parse::<usize>()) {
        for text in &arguments[1..] {
            let file = folder.map(|folder| folder.join(format!("hertz_N{disk_count}_p{text}.xyz")));
            let packing = prepared(disk_count, text.parse()?, &law, file.as_deref())?;
            let start = inflated(&packing, 1)?;
            row(
                &format!("{disk_count} at {text}"),
                "default",
                &[start],
                &Staged { limit: LIMIT, ..Staged::default() },
                &law,
                Some(1.0),
            )?;
        }
    } else {
        for name in named(arguments) {
            table(name, &starts(name)?, &[1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6], &law)?;
        }
    }
    Ok(())
}

/// A packing at a pressure, to 20 %: from the file if there is one, else prepared, and written to the file if one is named.
fn prepared(
    disk_count: usize,
    pressure: f64,
    law: &Hertzian,
    file: Option<&Path>,
) -> Result<Packing<2>, Box<dyn Error>> {
    if let Some(file) = file.filter(|file| file.exists()) {
        return Ok(read_packing(file)?);
    }
    let (mixture, target) = (Mixture::default(), Target::Pressure(pressure));
    let preparation = Preparation { disk_count, mixture, target, tolerance: 0.2, seed: 1, ..Preparation::default() };
    let coarse = Staged { limit: ForceLimit::Relative(1e-6), ..Staged::default() };
    let clock = Instant::now();
    let prepared = prepare_with::<2>(&preparation, law, &coarse, &mut ())?;
    let (pressure, seconds) = (prepared.pressure, clock.elapsed().as_secs_f64());
    println!("prepared {disk_count} at p = {pressure:.4}: {} relaxations, {seconds:.0} s", prepared.relaxation_count);
    if let Some(file) = file {
        write_packing(file, prepared.packing.get(), &[], &[])?;
    }
    Ok(prepared.packing.get().clone())
}

fn table(name: &str, starts: &[Packing<2>], hand_overs: &[f64], law: &Hertzian) -> Result<(), Box<dyn Error>> {
    let fire = Fire { limit: LIMIT, ..Fire::default() };
    let alone = row(name, "FIRE", starts, &fire, law, None)?;
    for &hand_over in hand_overs {
        let staged = Staged { limit: LIMIT, hand_over, ..Staged::default() };
        row(name, &format!("{hand_over:.0e}"), starts, &staged, law, Some(alone))?;
    }
    Ok(())
}

/// Relaxes all starts and prints what that took; the seconds.
fn row(
    name: &str,
    what: &str,
    starts: &[Packing<2>],
    relaxer: &impl Relaxer,
    law: &Hertzian,
    alone: Option<f64>,
) -> Result<f64, Box<dyn Error>> {
    let (mut cost, mut most, mut residual, mut floor, mut stops) = (Cost::default(), 0, 0.0f64, 0.0f64, Vec::new());
    for start in starts {
        let outcome: Outcome<Packing<2>> = relaxer.relax(start.clone(), law, &mut ())?;
        let network = ContactNetwork::new(&outcome.state, law)?;
        assert!(network.backbone_count() > 0, "{name}: the packing is unjammed");
        cost = cost.plus(outcome.cost);
        most = most.max(outcome.cost.factorisation_count);
        residual = larger(residual, outcome.residual.relative());
        floor = larger(floor, outcome.rounding_floor);
        if !matches!(outcome.stop, Stop::Converged(_)) {
            stops.push(format!("{:?}", outcome.stop));
        }
    }
    let stops = if stops.is_empty() { "all converged".to_string() } else { stops.join(", ") };
    println!(
        "{name:<18} {what:>9} {:>12} {:>7} {most:>5} {:>6.2} {residual:>9.1e} {floor:>9.1e}  {stops}",
        cost.force_evaluation_count,
        cost.factorisation_count,
        cost.seconds / alone.unwrap_or(cost.seconds),
    );
    Ok(cost.seconds)
}
