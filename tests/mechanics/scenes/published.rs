//! Published jammed packings of harmonic disks and balls (`fixtures/goodrich`).

use std::path::Path;

use jamscope::law::PowerLaw;
use jamscope::packing::{Domain, Packing};
use jamscope::vector::{Vector, two_product};
use serde_json::Value;

/// The harmonic law (ε/2)(1 − r/σ)², ε = 1.
pub const HARMONIC: PowerLaw = PowerLaw { energy_scale: 1.0, exponent: 2.0 };

/// The files: 64 disks, 128 balls, at pressures of about 10⁻¹ and 10⁻⁴.
pub const DISKS: [&str; 2] = ["2d_polyuniform_N64_Lp-1.0", "2d_polyuniform_N64_Lp-4.0"];
/// As [`DISKS`].
pub const BALLS: [&str; 2] = ["3d_bi_N128_Lp-1.0", "3d_bi_N128_Lp-4.0"];

/// One packing with what was published of it.
pub struct Published<const D: usize> {
    /// File and number in it.
    pub name: String,
    /// The packing.
    pub packing: Packing<D>,
    /// Energy of the whole packing.
    pub energy: f64,
    /// Stress per volume, positive in compression (the file has the other sign).
    pub stress: [[f64; D]; D],
    /// Indices and value of every elastic constant.
    pub constants: Vec<([usize; 4], f64)>,
}

/// All packings of a file.
pub fn published<const D: usize>(file: &str) -> Vec<Published<D>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/goodrich").join(format!("{file}.json"));
    let whole: Value = serde_json::from_slice(&std::fs::read(path).expect("a fixture")).expect("JSON");
    let order: Vec<[usize; 4]> =
        list(&whole["elastic_constants_order"]).iter().map(|word| indices(word.as_str().expect("a word"))).collect();
    list(&whole["records"]).iter().enumerate().map(|(at, record)| one(format!("{file} {at}"), record, &order)).collect()
}

fn one<const D: usize>(name: String, record: &Value, order: &[[usize; 4]]) -> Published<D> {
    let lengths: Vector<D> = std::array::from_fn(|d| number(&record["box"][d][d]));
    // Fractions times sides without rounding: high and low part of each product.
    let centres: Vec<[(f64, f64); D]> = list(&record["positions_fractional"])
        .iter()
        .map(|point| std::array::from_fn(|d| two_product(number(&point[d]), lengths[d])))
        .collect();
    let radii = list(&record["radii"]).iter().map(number).collect();
    let domain = Domain::rectangular([0.0; D], lengths);
    let packing = Packing::new(domain, centres.iter().map(|centre| centre.map(|x| x.0)).collect(), radii)
        .and_then(|packing| packing.with_corrections(centres.iter().map(|centre| centre.map(|x| x.1)).collect()))
        .expect("a packing");
    let stress = std::array::from_fn(|a| std::array::from_fn(|b| -number(&record["stress"][a][b])));
    let constants = order.iter().copied().zip(list(&record["elastic_constants"]).iter().map(number)).collect();
    Published { name, packing, energy: number(&record["energy"]), stress, constants }
}

fn list(value: &Value) -> &[Value] {
    value.as_array().expect("a list")
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

/// `xyxy` as [0, 1, 0, 1].
fn indices(word: &str) -> [usize; 4] {
    let axes: Vec<usize> = word.bytes().map(|axis| usize::from(axis - b'x')).collect();
    axes.try_into().expect("four letters")
}
