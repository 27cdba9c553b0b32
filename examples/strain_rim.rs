//! Shears and compresses the rim of a circle and prints how far the disks inside are from following it.
//!
//! ```text
//! cargo run --release --example strain_rim
//! ```

use jamscope::inflation::{Drive, inflate_with};
use jamscope::plastic::{PlasticPart, linear_response};
use jamscope::preparation::Target;
use jamscope::relax::Fire;
use jamscope::{DisplacementField, Hertzian, Inflation, Preparation, prepare};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (law, relaxer) = (Hertzian::default(), Fire::default());
    println!("{:>6} {:>12} {:>16} {:>14}", "p", "strain", "non-affine, rms", "plastic share");
    for pressure in [10.0, 100.0, 1000.0] {
        let preparation =
            Preparation { disk_count: 1000, target: Target::Pressure(pressure), ..Preparation::default() };
        let packing = prepare(&preparation)?.packing.into_inner();
        for (name, drive) in
            [("shear", Drive::Shear { strain: 0.001 }), ("compression", Drive::Compression { strain: 0.001 })]
        {
            let inflation = Inflation { drive, ..Inflation::default() };
            let strained = inflate_with(&inflation, &packing, &law, &relaxer, 1, &mut ())?;
            // The field is the displacement without its affine part.
            let field = DisplacementField::of_inflation(&strained);
            let (count, squares) = field.counted().fold((0.0, 0.0), |(count, squares), disk| {
                let [x, y] = disk.displacement;
                (count + 1.0, squares + x * x + y * y)
            });
            let plastic = PlasticPart::of(&strained, &linear_response(&strained, &law)?);
            println!("{pressure:6} {name:>12} {:16.2e} {:14.3}", f64::sqrt(squares / count), plastic.share);
        }
    }
    Ok(())
}
