//! What an inflation does to angles, contacts and bonds, on fields and packings whose answer is known.

mod bonds;
mod contacts;
mod excess;
#[cfg(feature = "plot")]
mod figures;
mod invariance;
mod isostatic;
mod lammps;
mod multipoles;
mod penetration;
mod spheres;

use jamscope::displacement::{DisplacementField, MeasuredOn, Moved, Shape};
use jamscope::packing::{Domain, Packing};
use jamscope::vector::Vector;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// A field of disks at these places, (r, θ), with d_r and d_θ by a function of the place.
fn field(places: &[[f64; 2]], displacement: impl Fn(f64, f64) -> [f64; 2]) -> DisplacementField<2> {
    let disks = places.iter().enumerate().map(|(disk, &[distance, angle])| {
        let (sine, cosine) = angle.sin_cos();
        let [radial, transverse] = displacement(distance, angle);
        Moved {
            disk,
            position: [distance * cosine, distance * sine],
            distance,
            displacement: [radial * cosine - transverse * sine, radial * sine + transverse * cosine],
            radial,
            counted: true,
        }
    });
    DisplacementField {
        disks: disks.collect(),
        inner_radius: 0.5,
        outer_radius: 40.0,
        shape: Shape::Round,
        measured_on: MeasuredOn::Backbone,
    }
}

/// Random angles at each of these distances.
fn random_places(distances: &[f64], count: usize, generator: &mut Pcg64) -> Vec<[f64; 2]> {
    let mut place = |distance: f64| [distance, std::f64::consts::TAU * (generator.random::<f64>() - 0.5)];
    distances.iter().flat_map(|&distance| vec![distance; count]).map(&mut place).collect()
}

fn generator(seed: u64) -> Pcg64 {
    Pcg64::seed_from_u64(seed)
}

/// A number of mean 0 and variance 1: the sum of twelve uniform ones, fourth moment 2.9.
fn normal(generator: &mut Pcg64) -> f64 {
    (0..12).map(|_| generator.random::<f64>()).sum::<f64>() - 6.0
}

/// Distance of neighbours in the lattice below; disks of diameter 1 overlap by 0.01.
const SPACING: f64 = 0.99;

/// Columns and rows of the lattice below.
const COLUMNS: usize = 6;
const ROWS: usize = 8;

/// A triangular lattice of 48 disks in a periodic box, row by row; six contacts each.
fn lattice_positions() -> Vec<Vector<2>> {
    let place = |row: usize, column: usize| {
        let shift = if row.is_multiple_of(2) { 0.25 } else { 0.75 };
        [SPACING * (column as f64 + shift), SPACING * 0.75f64.sqrt() * (row as f64 + 0.5)]
    };
    (0..ROWS).flat_map(|row| (0..COLUMNS).map(move |column| place(row, column))).collect()
}

/// The disks of that lattice and others in its box, radius 1/2 for the first 48 and 0.05 for the rest.
fn lattice(positions: Vec<Vector<2>>) -> Packing<2> {
    let lengths = [SPACING * COLUMNS as f64, SPACING * 0.75f64.sqrt() * ROWS as f64];
    let radii = (0..positions.len()).map(|disk| if disk < COLUMNS * ROWS { 0.5 } else { 0.05 }).collect();
    Packing::new(Domain::rectangular([0.0; 2], lengths), positions, radii).expect("sound disks")
}
