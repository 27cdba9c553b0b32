//! Exact radial profiles of an elastic and of a screened medium, as a table.
//!
//! ```text
//! cargo run --release --example exact_profile [WAVENUMBER]
//! ```

use jamscope::Annulus;
use jamscope::reference::poles::pole;
use jamscope::reference::{RadialSolution, elastic::Elastic, screened::Screened};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // An inflated disk of radius 1/2 in a circle of radius 40, d_0 = 0.1.
    let annulus = Annulus::new(0.5, 40.0)?;
    let increase = 0.1;
    let [first, second] = [1, 2].map(|index| pole::<2>(annulus, index));
    let wavenumber = match std::env::args().nth(1) {
        Some(text) => text.parse()?,
        None => 0.5 * (first + second),
    };
    println!("poles κ₁ = {first:.6}, κ₂ = {second:.6}; κ = {wavenumber:.6}");

    let elastic = Elastic::<2>::new(annulus, increase)?;
    let screened = Screened::<2>::new(annulus, increase, wavenumber)?;
    println!("{:>6} {:>22} {:>22}", "r", "elastic", "screened");
    for radius in [0.5, 1.0, 2.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0] {
        println!("{radius:6} {:22.15e} {:22.15e}", elastic.value(radius), screened.value(radius));
    }
    Ok(())
}
