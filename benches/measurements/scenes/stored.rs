//! Stored Hertzian packings, four inflated centres each.

use std::error::Error;

use jamscope::io::read_packing;
use jamscope::packing::Packing;

use crate::inflated::inflated;

/// Stored packings if none is named.
const STORED: [&str; 7] = [
    "hertz_N1000_p1",
    "hertz_N1000_p10",
    "hertz_N1000_p100",
    "hertz_N1000_p800",
    "hertz_N5548_p1",
    "hertz_N5548_p10",
    "hertz_N5548_p100",
];

/// The packings named, all if none is.
pub fn named(arguments: &[String]) -> Vec<&str> {
    if arguments.is_empty() { STORED.to_vec() } else { arguments.iter().map(String::as_str).collect() }
}

/// The starts of a stored packing.
pub fn starts(name: &str) -> Result<Vec<Packing<2>>, Box<dyn Error>> {
    let packing = read_packing::<2>(format!("{}/fixtures/packings/{name}.xyz", env!("CARGO_MANIFEST_DIR")))?;
    (1..=4).map(|seed| inflated(&packing, seed)).collect()
}
