//! Newton's method and the staged relaxer: closed forms, the way down, agreement with the other relaxers, the rounding floor and
//! the work it takes, and named ends.

#[path = "../scenes/square_lattice.rs"]
mod square_lattice;

mod agreement;
mod closed_forms;
mod depth;
mod descent;
mod outcomes;

use jamscope::contact::{ContactNetwork, Hertzian, Hessian, Members, PairLaw, Prestress};
use jamscope::inflation::Circle;
use jamscope::io::read_packing;
use jamscope::linear::Analysis;
use jamscope::packing::{Domain, Mixture, Packing};
use jamscope::preparation::random_points;
use jamscope::relax::{Fire, ForceLimit, Newton, Outcome, Relaxer, Staged};
use jamscope::vector::{Vector, larger, norm, sum};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

fn newton(limit: f64) -> Newton {
    Newton { limit: ForceLimit::Relative(limit), ..Newton::default() }
}

fn staged(limit: f64) -> Staged {
    Staged { limit: ForceLimit::Relative(limit), ..Staged::default() }
}

fn fire(limit: f64) -> Fire {
    Fire { limit: ForceLimit::Relative(limit), ..Fire::default() }
}

fn points<const D: usize>(count: usize, packing_fraction: f64, seed: u64) -> Packing<D> {
    random_points::<D>(count, &Mixture::default(), packing_fraction, seed).expect("a possible packing fraction")
}

fn relax<const D: usize, L: PairLaw>(relaxer: &impl Relaxer, packing: Packing<D>, law: &L) -> Outcome<Packing<D>> {
    relaxer.relax(packing, law, &mut ()).expect("no coincidence")
}

fn at_rest<const D: usize>(outcome: Outcome<Packing<D>>) -> Packing<D> {
    let (stop, residual) = (outcome.stop, outcome.residual.relative());
    outcome.converged().unwrap_or_else(|_| panic!("{stop:?} at {residual:e}")).into_inner()
}

fn stored(name: &str) -> Packing<2> {
    read_packing::<2>(format!("{}/fixtures/packings/{name}.xyz", env!("CARGO_MANIFEST_DIR"))).expect("a fixture")
}

/// A stored packing cut to a circle with a held rim around its `index`-th small disk, grown by 0.1.
fn inflated(name: &str, index: usize) -> Packing<2> {
    let packing = stored(name);
    let side = packing.domain().lengths().expect("periodic")[0];
    let backbone = ContactNetwork::new(&packing, &Hertzian::default()).expect("no coincidence").backbone;
    let small: Vec<usize> = (0..packing.len()).filter(|&disk| packing.radii()[disk] == 0.5 && backbone[disk]).collect();
    let circle = Circle::cut(&packing, small[(37 * index) % small.len()], 0.48 * side).expect("a circle in its box");
    circle.packing.with_radius(circle.centre, 0.6).expect("a positive radius")
}

/// Every disk that is not held moved by up to `length` along each axis.
fn shaken<const D: usize>(packing: &Packing<D>, length: f64, seed: u64) -> Packing<D> {
    let mut generator = Pcg64::seed_from_u64(seed);
    let corrections = (0..packing.len())
        .map(|disk| {
            let moved: Vector<D> = std::array::from_fn(|_| length * (2.0 * generator.random::<f64>() - 1.0));
            if packing.held()[disk] { packing.corrections()[disk] } else { sum(packing.corrections()[disk], moved) }
        })
        .collect();
    packing.clone().with_corrections(corrections).expect("finite")
}

/// How far a disk is from where it is in another packing.
fn moved<const D: usize>(one: &Packing<D>, two: &Packing<D>, disk: usize) -> Vector<D> {
    let ((a, a_low), (b, b_low)) = (one.centre(disk), two.centre(disk));
    one.domain().separation((a, a_low), (b, b_low))
}

/// Softest stiffness of the backbone of a packing with held disks, by inverse iteration: an upper bound that falls to it.
fn softest<const D: usize, L: PairLaw>(packing: &Packing<D>, law: &L) -> f64 {
    let hessian = Hessian::new(packing, law, Members::Backbone, Prestress::Included).expect("no coincidence");
    let matrix = hessian.matrix();
    let mut analysis = Analysis::of(&hessian).expect("small");
    let mut factorisation = analysis.cholesky(matrix).expect("a minimum");
    let mut generator = Pcg64::seed_from_u64(1);
    let mut mode: Vec<f64> = (0..matrix.dimension()).map(|_| generator.random::<f64>() - 0.5).collect();
    let mut next = vec![f64::NAN; mode.len()];
    let mut quotient = f64::INFINITY;
    for _ in 0..200 {
        let length = mode.iter().map(|x| x * x).sum::<f64>().sqrt();
        mode.iter_mut().for_each(|x| *x /= length);
        let _ = factorisation.solve(&mode, &mut next).expect("well conditioned enough");
        quotient = 1.0 / mode.iter().zip(&next).map(|(x, y)| x * y).sum::<f64>();
        std::mem::swap(&mut mode, &mut next);
    }
    quotient
}

/// Largest distance of a backbone disk between two states.
fn apart<const D: usize, L: PairLaw>(one: &Packing<D>, two: &Packing<D>, law: &L) -> f64 {
    let backbone = ContactNetwork::new(one, law).expect("no coincidence").backbone;
    (0..one.len()).filter(|&disk| backbone[disk]).map(|disk| norm(moved(one, two, disk))).fold(0.0, larger)
}

/// How far two states at rest to this relative limit may be apart: |u| ≤ |F|/λ_min each, |F| ≤ √N times the largest.
fn allowed<const D: usize, L: PairLaw>(packing: &Packing<D>, law: &L, limit: f64) -> f64 {
    let mean = ContactNetwork::new(packing, law).expect("no coincidence").mean_contact_force();
    2.0 * limit * mean * (packing.len() as f64).sqrt() / softest(packing, law)
}

/// A disk between four held ones at the corners of a cross, at rest in the middle.
fn cross(from: Vector<2>) -> Packing<2> {
    let positions = vec![from, [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
    Packing::new(Domain::Open, positions, vec![0.55, 0.5, 0.5, 0.5, 0.5])
        .and_then(|packing| packing.with_held(vec![false, true, true, true, true]))
        .expect("valid")
}
