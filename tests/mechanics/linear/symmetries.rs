//! What any Hessian of any packing has: symmetry, no work in a motion as a whole, no softness without prestress, and no
//! regard for how a packing is turned or what its disks are called.
//!
//! Random cases come from proptest, with the seeds of `scenes::seeds`.

use crate::scenes::seeds::config;
use jamscope::law::{Hertzian, Hookean, OnSite, PairLaw, PowerLaw};
use jamscope::linear::{Hessian, Members, Prestress};
use jamscope::packing::{Domain, Packing};
use jamscope::sparse::SymmetricMatrix;
use jamscope::vector::{Vector, larger};
use proptest::prelude::*;

use super::dense;
use crate::scenes::random_disks::{disks, periodic};

/// A vector of unknowns that looks random.
fn field(dimension: usize, seed: u64) -> Vec<f64> {
    (0..dimension).map(|row| (1.0 + seed as f64 + 1.7 * row as f64 * (1.0 + 0.01 * row as f64)).sin()).collect()
}

fn product(matrix: &SymmetricMatrix, vector: &[f64]) -> Vec<f64> {
    let mut result = vec![f64::NAN; vector.len()];
    matrix.multiply(vector, &mut result);
    result
}

/// Rounding of a row of K times a vector with entries up to 1: the sum of sizes in the row, less than ‖K‖, by as many terms
/// as there are. Random disks overlap much and have up to 40 contacts.
fn rounding(matrix: &SymmetricMatrix) -> f64 {
    128.0 * f64::EPSILON * matrix.norm()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// The packing turned by a quarter about the last axis (D = 3) or in the plane and its disks renamed in reverse; positions are
/// multiples of 2⁻²⁰, so nothing is rounded.
fn turned_and_renamed<const D: usize>(packing: &Packing<D>) -> Packing<D> {
    let turn = |mut v: Vector<D>| {
        (v[0], v[1]) = (-v[1], v[0]);
        v
    };
    let domain = match *packing.domain() {
        Domain::Periodic { corner, .. } => {
            let lengths = packing.domain().lengths().expect("periodic");
            let (mut sides, mut low) = (lengths, corner);
            (sides[0], sides[1]) = (lengths[1], lengths[0]);
            (low[0], low[1]) = (-corner[1] - lengths[1], corner[0]);
            Domain::rectangular(low, sides)
        }
        Domain::Open => Domain::Open,
    };
    let back = |column: &[bool]| column.iter().rev().copied().collect::<Vec<_>>();
    let positions = packing.positions().iter().rev().map(|&position| turn(position)).collect();
    Packing::new(domain, positions, packing.radii().iter().rev().copied().collect())
        .and_then(|other| other.with_held(back(packing.held())))
        .expect("valid")
}

fn check<const D: usize>(law: &dyn PairLaw, packing: &Packing<D>, members: Members, seed: u64) {
    let of = |packing: &Packing<D>, prestress| Hessian::new(packing, law, members, prestress).expect("apart");
    for prestress in [Prestress::Included, Prestress::LeftOut] {
        let hessian = of(packing, prestress);
        let matrix = hessian.matrix();
        let dimension = matrix.dimension();
        if dimension == 0 {
            continue;
        }
        let (x, y) = (field(dimension, seed), field(dimension, seed + 1));
        let (kx, ky) = (product(matrix, &x), product(matrix, &y));
        let allowed = rounding(matrix);

        // Symmetric in what a product does, and diagonal blocks in what they hold: one triangle is stored of each.
        close(dot(&y, &kx), dot(&x, &ky), allowed * dimension as f64, "symmetry");

        // Sum of rows: a motion of all disks alike is resisted by sites, −Γ each, and by held disks, as by their motion back.
        let held = packing.held().contains(&true);
        for axis in 0..D {
            let mut unit = [0.0; D];
            unit[axis] = 1.0;
            let together: Vec<f64> = hessian.disks().iter().flat_map(|_| unit).collect();
            let back = hessian.forces_of_held(&vec![unit; packing.len()]);
            assert!(held || back.iter().all(|&force| force == 0.0));
            for (row, (force, from_held)) in product(matrix, &together).iter().zip(&back).enumerate() {
                let sites = -law.on_site_coupling() * together[row];
                close(*force, sites + from_held, allowed, "sum of a row");
            }
        }

        // Springs at rest cost energy or nothing.
        if prestress == Prestress::LeftOut && law.on_site_coupling() <= 0.0 {
            for (vector, image) in [(&x, &kx), (&y, &ky)] {
                assert!(dot(vector, image) >= -allowed * dimension as f64);
            }
            // L D Lᵀ of the dense matrix, moved up by rounding, has no negative pivot.
            let mut dense = dense(matrix);
            for pivot in 0..dimension {
                dense[pivot][pivot] += allowed * dimension as f64;
            }
            assert!(smallest_pivot(dense) > 0.0, "a negative eigenvalue without prestress");
        }

        // The turned packing answers the turned field with the turned forces.
        let other = of(&turned_and_renamed(packing), prestress);
        let spread = hessian.scatter(&x);
        let moved: Vec<Vector<D>> = spread
            .iter()
            .rev()
            .map(|&v| {
                let mut v = v;
                (v[0], v[1]) = (-v[1], v[0]);
                v
            })
            .collect();
        let (ours, theirs) = (hessian.scatter(&kx), other.scatter(&product(other.matrix(), &other.gather(&moved))));
        assert_eq!(other.matrix().dimension(), dimension);
        for (one, two) in ours.iter().rev().zip(&theirs) {
            close(-one[1], two[0], allowed, "turned, x");
            close(one[0], two[1], allowed, "turned, y");
            (2..D).for_each(|axis| close(one[axis], two[axis], allowed, "turned, z"));
        }
    }
}

fn close(found: f64, expected: f64, allowed: f64, what: &str) {
    assert!((found - expected).abs() <= allowed, "{what}: {found:e} and {expected:e}, {allowed:e} allowed");
}

/// Least pivot of an elimination without pivoting: negative if an eigenvalue is (Sylvester).
fn smallest_pivot(mut a: Vec<Vec<f64>>) -> f64 {
    let n = a.len();
    let mut least = f64::INFINITY;
    for k in 0..n {
        let pivot = a[k][k];
        least = -larger(-least, -pivot);
        for i in k + 1..n {
            let factor = a[i][k] / pivot;
            for j in k..n {
                let above = a[k][j];
                a[i][j] -= factor * above;
            }
        }
    }
    least
}

fn every_law<const D: usize>(packing: &Packing<D>, members: Members, seed: u64) {
    check(&Hertzian { stiffness: 3.0 }, packing, members, seed);
    check(&Hookean { stiffness: 3.0 }, packing, members, seed);
    check(&PowerLaw { energy_scale: 2.0, exponent: 2.7 }, packing, members, seed);
    check(&OnSite { law: Hookean { stiffness: 3.0 }, coupling: 0.4 }, packing, members, seed);
    check(&OnSite { law: Hertzian { stiffness: 3.0 }, coupling: -0.4 }, packing, members, seed);
}

proptest! {
    #![proptest_config(config(24, 31))]

    #[test]
    fn a_hessian_is_symmetric_its_rows_add_up_and_turning_or_renaming_the_packing_changes_nothing(
        seed in 0..10_000u64,
        held_share in prop_oneof![Just(0.0), Just(0.3)],
        backbone in any::<bool>(),
        space in any::<bool>(),
        boxed in any::<bool>(),
    ) {
        let members = if backbone { Members::Backbone } else { Members::InContact };
        match (space, boxed) {
            (false, true) => every_law(&disks(seed, 40, periodic([2.0, 3.0]), held_share), members, seed),
            (false, false) => every_law(&disks::<2>(seed, 40, Domain::Open, held_share), members, seed),
            (true, true) => every_law(&disks(seed, 40, periodic([1.5, 2.0, 2.5]), held_share), members, seed),
            (true, false) => every_law(&disks::<3>(seed, 40, Domain::Open, held_share), members, seed),
        }
    }
}
