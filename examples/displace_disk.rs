//! Displaces one disk step by step farther and prints the force that it needs, until contacts change.
//!
//! ```text
//! cargo run --release --example displace_disk
//! ```

use jamscope::inflation::{Drive, inflate_with};
use jamscope::observe::multipoles::MultipoleSettings;
use jamscope::plastic::{PlasticPart, linear_response};
use jamscope::preparation::Target;
use jamscope::relax::Fire;
use jamscope::run::DriveSummary;
use jamscope::{Hertzian, Inflation, Preparation, prepare};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let preparation = Preparation { disk_count: 1000, target: Target::Pressure(100.0), ..Preparation::default() };
    let packing = prepare(&preparation)?.packing.into_inner();
    let (law, relaxer) = (Hertzian::default(), Fire::default());
    println!("{:>9} {:>12} {:>14}", "distance", "force/dist.", "plastic share");
    for distance in [1e-4, 1e-3, 1e-2, 3e-2, 0.1] {
        let inflation = Inflation { drive: Drive::Displacement { distance }, ..Inflation::default() };
        let moved = inflate_with(&inflation, &packing, &law, &relaxer, 1, &mut ())?;
        let summary =
            DriveSummary::of(&moved, &packing, &law, None, &MultipoleSettings::default())?.ok_or("a drive")?;
        let plastic = PlasticPart::of(&moved, &linear_response(&moved, &law)?);
        println!("{distance:9.4} {:12.2} {:14.4}", summary.force / distance, plastic.share);
    }
    Ok(())
}
