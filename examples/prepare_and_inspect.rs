//! Prepares a jammed packing and prints what is known of it.
//!
//! ```text
//! cargo run --release --example prepare_and_inspect
//! ```

use jamscope::certificate::Certificate;
use jamscope::preparation::Target;
use jamscope::{ContactNetwork, Hertzian, Preparation, prepare};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // 1000 disks at p = 100 [force / length], seed 1 of the random points.
    let prepared =
        prepare(&Preparation { disk_count: 1000, target: Target::Pressure(100.0), ..Preparation::default() })?;
    let (packing, law) = (prepared.packing.get(), Hertzian::default());
    println!("pressure          {:.3}", prepared.pressure);
    println!("packing fraction  {:.5}", prepared.packing_fraction);
    println!("force evaluations {}", prepared.cost.force_evaluation_count);

    let network = ContactNetwork::new(packing, &law)?;
    println!("contacts          {}", network.contacts.len());
    println!("rattlers          {}", network.rattlers().count());
    println!("coordination      {:.4} (isostatic: 4)", network.coordination());

    // How far from rest, and how near that is to the smallest residual that rounding allows.
    let certificate = Certificate::of(packing, &law, None)?;
    println!("residual          {:.1e} of the mean contact force", certificate.relative_residual);
    println!("rounding floor    {:.1e}", certificate.rounding_floor);
    println!("stability         {:?}", certificate.stability);
    Ok(())
}
