//! Packings that relaxers start from.

use jamscope::inflation::Circle;
use jamscope::io::read_packing;
use jamscope::law::Hertzian;
use jamscope::network::ContactNetwork;
use jamscope::packing::{Domain, Mixture, Packing};
use jamscope::preparation::random_points;
use jamscope::vector::{Vector, sum};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Random points at a packing fraction.
pub fn points<const D: usize>(count: usize, packing_fraction: f64, seed: u64) -> Packing<D> {
    random_points::<D>(count, &Mixture::default(), packing_fraction, seed).expect("a possible packing fraction")
}

/// A stored packing cut to a circle with a held rim around its `index`-th small disk, grown by 0.1.
pub fn inflated(name: &str, index: usize) -> Packing<2> {
    let packing = read_packing::<2>(format!("{}/fixtures/packings/{name}.xyz", env!("CARGO_MANIFEST_DIR")));
    let packing = packing.expect("a fixture");
    let side = packing.domain().lengths().expect("periodic")[0];
    let backbone = ContactNetwork::new(&packing, &Hertzian::default()).expect("no coincidence").backbone;
    let small: Vec<usize> = (0..packing.len()).filter(|&disk| packing.radii()[disk] == 0.5 && backbone[disk]).collect();
    let circle = Circle::cut(&packing, small[(37 * index) % small.len()], 0.48 * side).expect("a circle in its box");
    circle.packing.with_radius(circle.centre, 0.6).expect("a positive radius")
}

/// Every disk that is not held moved by up to `length` along each axis.
pub fn shaken<const D: usize>(packing: &Packing<D>, length: f64, seed: u64) -> Packing<D> {
    let mut generator = Pcg64::seed_from_u64(seed);
    let corrections = (0..packing.len())
        .map(|disk| {
            let moved: Vector<D> = std::array::from_fn(|_| length * (2.0 * generator.random::<f64>() - 1.0));
            if packing.held()[disk] { packing.corrections()[disk] } else { sum(packing.corrections()[disk], moved) }
        })
        .collect();
    packing.clone().with_corrections(corrections).expect("finite")
}

/// A disk between four held ones at the corners of a cross, at rest in the middle.
pub fn cross(from: Vector<2>) -> Packing<2> {
    let positions = vec![from, [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
    Packing::new(Domain::Open, positions, vec![0.55, 0.5, 0.5, 0.5, 0.5])
        .and_then(|packing| packing.with_held(vec![false, true, true, true, true]))
        .expect("valid")
}
