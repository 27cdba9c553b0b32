//! The Hessian against closed forms and differences of forces, factorisations against dense elimination, and the linear
//! response as the limit of relaxations.

#[path = "scenes/random_disks.rs"]
mod random_disks;

use std::path::Path;

use jamscope::contact::{
    Assembly, ContactNetwork, Hertzian, Hessian, Hookean, Members, OnSite, PairLaw, PowerLaw, Prestress,
};
use jamscope::displacement::{DisplacementField, MeasuredOn};
use jamscope::inflation::{Boundary, Centre, Circle, Inflation, inflate};
use jamscope::io::read_packing;
use jamscope::lattice::Lattice;
use jamscope::linear::iterative::{IncompleteFactor, IterationLimits, conjugate_gradients};
use jamscope::linear::ordering::{minimum_degree, nested_dissection};
use jamscope::linear::{Analysis, LinearError, LinearResponse};
use jamscope::packing::{Domain, Mixture, Packing};
use jamscope::preparation::{Preparation, Target, prepare, random_points};
use jamscope::relax::{Fire, ForceLimit, Relaxer};
use jamscope::sparse::SymmetricMatrix;
use jamscope::vector::{Vector, difference, norm};
use random_disks::{disks, periodic};

fn fire(limit: f64) -> Fire {
    Fire { limit: ForceLimit::Relative(limit), step_limit: 200_000, ..Fire::default() }
}

fn dense(matrix: &SymmetricMatrix) -> Vec<Vec<f64>> {
    let mut dense = vec![vec![0.0; matrix.dimension()]; matrix.dimension()];
    for (row, column, value) in matrix.entries() {
        dense[row][column] = value;
        dense[column][row] = value;
    }
    dense
}

/// A mobile disk, held ones around it where `held` says, overlapping it by 0.1 at a distance of 1.1.
fn around<const D: usize>(held: &[Vector<D>]) -> Packing<D> {
    let positions: Vec<Vector<D>> = std::iter::once([0.0; D]).chain(held.iter().map(|n| n.map(|x| 1.1 * x))).collect();
    let count = positions.len();
    let radii = std::iter::once(0.7).chain(std::iter::repeat_n(0.5, count - 1)).collect();
    Packing::new(Domain::Open, positions, radii)
        .and_then(|packing| packing.with_held((0..count).map(|disk| disk > 0).collect()))
        .expect("valid")
}

#[test]
fn one_contact_has_its_stiffness_along_and_its_force_over_its_length_across() {
    fn check<const D: usize, L: PairLaw>(law: L, normal: Vector<D>) {
        let coupling = 0.3;
        let law = OnSite { law, coupling };
        let force = law.force(law.coefficient(0.7, 0.5), 0.1);
        let (along, across) = (law.stiffness(force, 0.1), -force / 1.1);
        for (prestress, across) in [(Prestress::Included, across), (Prestress::LeftOut, 0.0)] {
            let hessian = Hessian::new(&around(&[normal]), &law, Members::InContact, prestress).expect("apart");
            assert_eq!(hessian.disks(), [0]);
            let matrix = dense(hessian.matrix());
            for a in 0..D {
                for b in 0..D {
                    let one = f64::from(u8::from(a == b));
                    let exact = along * normal[a] * normal[b] + across * (one - normal[a] * normal[b]) - coupling * one;
                    // The overlap is 1.2 − 1.1·|n|: rounded to 2e-16/0.1, and a few roundings of the products.
                    assert!((matrix[a][b] - exact).abs() < 2e-14 * along, "{law:?} {a}{b}: {} {exact}", matrix[a][b]);
                }
            }
        }
        // A disk with one contact is no part of a backbone.
        let none = Hessian::new(&around(&[normal]), &law, Members::Backbone, Prestress::Included).expect("apart");
        assert_eq!(none.matrix().dimension(), 0);
    }
    check(Hertzian { stiffness: 3.0 }, [0.6, 0.8]);
    check(Hookean { stiffness: 3.0 }, [0.28, 0.96]);
    check(PowerLaw { energy_scale: 2.0, exponent: 3.2 }, [0.8, -0.6]);
    check(Hertzian { stiffness: 3.0 }, [0.48, 0.6, 0.64]);
    check(Hookean { stiffness: 3.0 }, [0.0, 0.0, 1.0]);
}

/// Every column of the Hessian against central differences of the forces; disks with sites away from where they are.
fn check_against_forces<const D: usize, L: PairLaw>(law: L, packing: &Packing<D>) {
    let mut assembly = Assembly::new(packing, law).expect("apart");
    let hessian = Hessian::of(&assembly, Members::InContact, Prestress::Included);
    let matrix = dense(hessian.matrix());
    let place: Vec<usize> = (0..packing.len())
        .map(|disk| assembly.order().iter().position(|&other| other as usize == disk).expect("every disk"))
        .collect();
    let h = 1e-7;
    // Truncation (h/δ)² F'/δ^0 of each contact: overlaps below 20 h are left to the check that there are none. Hertzian:
    // F''' h²/6 = F' h²/(8 δ²) ≤ 3e-4 F'(δ) for δ = 20 h, and F'(20 h) is 1e-3 of the others. Rounding: ε F/h = 2e-9 F.
    let network = ContactNetwork::new(packing, &law).expect("apart");
    let stiffest = network.contacts.iter().map(|c| law.stiffness(c.force, c.overlap)).fold(0.0, f64::max);
    assert!(network.contacts.iter().all(|contact| contact.overlap > 20.0 * h), "choose another seed");
    assert!(!hessian.disks().is_empty());
    for (block, &disk) in hessian.disks().iter().enumerate() {
        for axis in 0..D {
            let mut forces_at = |step: f64| {
                let before = assembly.displacements[place[disk as usize]];
                assembly.displacements[place[disk as usize]][axis] += step;
                assembly.evaluate();
                assembly.displacements[place[disk as usize]] = before;
                assembly.forces.clone()
            };
            let (ahead, behind) = (forces_at(h), forces_at(-h));
            for (other_block, &other) in hessian.disks().iter().enumerate() {
                let at = place[other as usize];
                let slopes = difference(behind[at], ahead[at]).map(|x| x / (2.0 * h));
                for d in 0..D {
                    let value = matrix[D * other_block + d][D * block + axis];
                    assert!(
                        (value - slopes[d]).abs() < 1e-6 * stiffest,
                        "{law:?}: disks {other}, {disk}: {value} and {}",
                        slopes[d]
                    );
                }
            }
        }
    }
}

#[test]
fn the_hessian_is_minus_the_derivative_of_the_forces() {
    fn check<L: PairLaw>(law: L) {
        for seed in [1, 2, 5] {
            check_against_forces(law, &disks(seed, 30, periodic([3.0, 4.0]), 0.2));
            check_against_forces(law, &disks(seed, 30, Domain::<2>::Open, 0.2));
            check_against_forces(law, &disks(seed, 30, periodic([2.0, 3.0, 2.5]), 0.2));
            check_against_forces(OnSite { law, coupling: 0.7 }, &disks(seed, 30, periodic([3.0, 4.0]), 0.2));
        }
    }
    check(Hertzian { stiffness: 1.0 });
    check(Hookean { stiffness: 1.0 });
    check(PowerLaw { energy_scale: 1.0, exponent: 2.8 });
}

#[test]
fn a_moved_packing_keeps_the_pattern_until_a_contact_changes() {
    let law = Hertzian::default();
    let mut assembly =
        Assembly::new(&random_points::<2>(60, &Default::default(), 1.0, 3).expect("possible"), law).expect("apart");
    let mut hessian = Hessian::of(&assembly, Members::Backbone, Prestress::Included);
    let first = hessian.matrix().clone();
    assert!(hessian.update(&assembly));
    assert_eq!(*hessian.matrix(), first);
    let mut kept = 0;
    for step in 1..=20 {
        let length = 1e-9 * 4f64.powi(step);
        for (index, displacement) in assembly.displacements.iter_mut().enumerate() {
            *displacement = [length * (index as f64).sin(), length * (2.0 * index as f64).cos()];
        }
        assembly.keep_listed(f64::INFINITY).expect("apart");
        let same = hessian.update(&assembly);
        let fresh = Hessian::of(&assembly, Members::Backbone, Prestress::Included);
        assert_eq!(hessian.matrix(), fresh.matrix(), "length {length}");
        assert_eq!(hessian.disks(), fresh.disks());
        kept += usize::from(same && fresh.matrix().has_pattern_of(&first));
        if length > 0.2 {
            assert!(!fresh.matrix().has_pattern_of(&first));
        }
    }
    assert!(kept >= 5, "{kept}");
}

/// Gaussian elimination with partial pivoting.
fn eliminate(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs())).expect("rows left");
        a.swap(k, pivot);
        b.swap(k, pivot);
        for i in k + 1..n {
            let factor = a[i][k] / a[k][k];
            for j in k..n {
                a[i][j] -= factor * a[k][j];
            }
            b[i] -= factor * b[k];
        }
    }
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| a[k][j] * b[j]).sum();
        b[k] = (b[k] - known) / a[k][k];
    }
    b
}

/// Eigenvalues by cyclic Jacobi rotations, ascending. Source: Golub, Van Loan (2013), Matrix Computations, §8.5.
fn eigenvalues(mut a: Vec<Vec<f64>>) -> Vec<f64> {
    let n = a.len();
    for _ in 0..30 {
        for p in 0..n {
            for q in p + 1..n {
                if a[p][q] == 0.0 {
                    continue;
                }
                let tau = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
                let t = tau.signum() / (tau.abs() + (1.0 + tau * tau).sqrt());
                let (c, s) = (1.0 / (1.0 + t * t).sqrt(), t / (1.0 + t * t).sqrt());
                for k in 0..n {
                    (a[k][p], a[k][q]) = (c * a[k][p] - s * a[k][q], s * a[k][p] + c * a[k][q]);
                }
                for k in 0..n {
                    (a[p][k], a[q][k]) = (c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]);
                }
            }
        }
    }
    let mut values: Vec<f64> = (0..n).map(|k| a[k][k]).collect();
    values.sort_by(f64::total_cmp);
    values
}

#[test]
fn factors_solve_and_count_as_dense_algebra_does() {
    let circle = Lattice::triangular(0.5, 0.05).expect("valid").circle(4.4).expect("a circle");
    let plain = Hookean { stiffness: 1.0 };
    let mut analysis = None;
    for coupling in [-0.5, 0.0, 0.1, 0.3, 0.7, 1.5, 2.5, 7.0] {
        let law = OnSite { law: plain, coupling };
        let hessian = Hessian::new(&circle.packing, &law, Members::Backbone, Prestress::Included).expect("apart");
        let matrix = hessian.matrix();
        let dense = dense(matrix);
        let spectrum = eigenvalues(dense.clone());
        let negative = spectrum.iter().filter(|&&value| value < 0.0).count();
        let smallest = spectrum.iter().map(|value| value.abs()).fold(f64::INFINITY, f64::min);
        let right: Vec<f64> = (0..matrix.dimension()).map(|k| (1.0 + k as f64).sin()).collect();
        let exact = eliminate(dense, right.clone());
        let analysis = analysis.get_or_insert_with(|| Analysis::of(&hessian).expect("memory"));
        // One analysis for all: the pattern is the same.
        assert!(analysis.fits(matrix));
        let mut solved = vec![f64::NAN; right.len()];
        for indefinite in [false, true] {
            let made = if indefinite { analysis.indefinite(matrix) } else { analysis.factorise(matrix) };
            let mut factorisation = made.expect("not singular");
            assert_eq!(factorisation.negative_eigenvalue_count(), negative, "Γ = {coupling}");
            assert_eq!(factorisation.is_cholesky(), !indefinite && negative == 0);
            if factorisation.is_cholesky() {
                assert!(factorisation.pivot_ratio() >= smallest / spectrum[spectrum.len() - 1] * (1.0 - 1e-10));
            }
            let told = factorisation.solve(&right, &mut solved).expect("accurate");
            assert!(told.backward_error <= 4.0 * f64::EPSILON, "{:e}", told.backward_error);
            let largest = exact.iter().fold(0.0f64, |most, x| most.max(x.abs()));
            let off = solved.iter().zip(&exact).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
            // Condition times backward errors of both, 10 ε with norms that differ by √n = 15 at most.
            let condition = spectrum[spectrum.len() - 1].abs().max(spectrum[0].abs()) / smallest;
            assert!(off <= 150.0 * f64::EPSILON * condition * largest, "Γ = {coupling}: {off:e} of {largest:e}");
        }
        let cholesky = analysis.cholesky(matrix).map(|factorisation| factorisation.is_cholesky());
        if negative == 0 {
            assert_eq!(cholesky, Ok(true));
        } else {
            assert_eq!(cholesky, Err(LinearError::NotPositiveDefinite { dimension: matrix.dimension() }));
        }
    }
}

#[test]
fn what_has_no_solution_is_named() {
    let law = Hookean { stiffness: 1.0 };
    let lattice = Lattice::triangular(0.5, 0.05).expect("valid");
    let of =
        |packing: &Packing<2>, law| Hessian::new(packing, &law, Members::Backbone, Prestress::Included).expect("apart");
    // Nothing holds the box: two translations cost nothing.
    let floating = of(&lattice.periodic([8, 5]).expect("a lattice"), law);
    let error = Analysis::of(&floating)
        .expect("memory")
        .factorise(floating.matrix())
        .map(|_| ())
        .expect_err("singular");
    let LinearError::Singular { pivot_ratio } = error else { panic!("{error}") };
    assert!(pivot_ratio < 2e-14, "{pivot_ratio:e}");
    let circle = lattice.circle(5.0).expect("a circle");
    let held = of(&circle.packing, law);
    let mut analysis = Analysis::of(&held).expect("memory");
    let dimension = floating.matrix().dimension();
    assert_eq!(analysis.cholesky(floating.matrix()).map(|_| ()), Err(LinearError::PatternDiffers { dimension }));
    let nan = of(&circle.packing, Hookean { stiffness: f64::NAN });
    assert!(matches!(analysis.factorise(nan.matrix()).map(|_| ()), Err(LinearError::NotFinite { .. })));
    let response =
        |packing: &Packing<2>, centre| LinearResponse::of_inflation(packing, centre, &law, Prestress::Included);
    let loose = random_points::<2>(50, &Default::default(), 0.3, 1).expect("possible");
    assert_eq!(response(&loose, 0), Err(LinearError::NoBackbone { disk_count: 50 }));
    let disk_count = circle.packing.len();
    assert_eq!(response(&circle.packing, disk_count), Err(LinearError::NoSuchDisk { disk: disk_count, disk_count }));
    let shrunk = circle.packing.clone().with_radius(circle.centre, 0.3).expect("positive");
    assert_eq!(response(&shrunk, circle.centre), Err(LinearError::CentreTouchesNothing { disk: circle.centre }));
    // A rattler has no row and does not spoil the matrix.
    let rattling = circle.packing.clone().with_radius(7, 0.3).expect("positive");
    let answer = response(&rattling, circle.centre).expect("a response");
    assert!(!answer.solved[7] && answer.displacements[7] == [0.0; 2]);
    assert_eq!(answer.unknown_count, 2 * (circle.mobile_count() - 1));
}

/// Largest difference of two fields of displacements, and the largest displacement.
fn compare<const D: usize>(nonlinear: &DisplacementField<D>, linear: &DisplacementField<D>) -> (f64, f64) {
    assert_eq!(nonlinear.disks.len(), linear.disks.len());
    nonlinear.disks.iter().zip(&linear.disks).filter(|(a, _)| a.counted).fold((0.0, 0.0), |(off, most), (a, b)| {
        assert!(a.disk == b.disk && b.counted);
        (f64::max(off, norm(difference(a.displacement, b.displacement))), f64::max(most, norm(a.displacement)))
    })
}

/// Nonlinear minus linear for these d_0: (d_0, largest difference, largest displacement, contacts as before).
fn departures<const D: usize, L: PairLaw>(
    packing: &Packing<D>,
    law: &L,
    base: &Inflation,
    increases: impl Iterator<Item = f64>,
) -> Vec<(f64, f64, f64, bool)> {
    increases
        .map(|asked| {
            // What the radius really grows by.
            let label = base.centre;
            let inflation = Inflation { increase: asked, centre: label, ..*base };
            let run = inflate(&inflation, packing, law, &fire(2e-14), 1, &mut ()).expect("at rest");
            let (before, after) = (run.before.packing.get(), run.after.packing.get());
            let increase = after.radii()[run.centre] - run.inner_radius;
            let response =
                LinearResponse::of_inflation(before, run.centre, law, Prestress::Included).expect("a response");
            assert_eq!(response.negative_eigenvalue_count, 0);
            let linear = DisplacementField::of_linear_response(&response, before, increase, run.outer_radius);
            assert_eq!(linear.measured_on, MeasuredOn::Backbone);
            let (off, most) = compare(&DisplacementField::of_inflation(&run), &linear);
            let links = |packing| -> Vec<(u32, u32)> {
                let network = ContactNetwork::new(packing, law).expect("apart");
                network.contacts.iter().map(|contact| (contact.first, contact.second)).collect()
            };
            (increase, off, most, links(before) == links(after))
        })
        .collect()
}

/// Over so many decades the difference falls by the square of d_0: at their end it is 10⁻¹⁴ to 10⁻¹³, not far
/// above what the states at rest are known to.
fn falls_as_the_square(what: &str, departures: &[(f64, f64, f64, bool)], decades: f64) {
    for &(increase, off, most, same) in departures {
        println!(
            "{what}: d_0 = {increase:.3e}, moved {most:.3e}, nonlinear − linear {off:.3e}, {:.4e} d_0²",
            off / increase.powi(2)
        );
        assert!(same, "{what}: contacts changed at d_0 = {increase}");
    }
    for pair in departures.windows(2) {
        let order = (pair[1].1 / pair[0].1).log2() / (pair[1].0 / pair[0].0).log2();
        assert!((order - 2.0).abs() < 0.1, "{what}: order {order} between {} and {}", pair[0].0, pair[1].0);
    }
    let (first, last) = (departures[0].0, departures[departures.len() - 1].0);
    assert!((first / last).log10() >= decades, "{what}: {first} to {last}");
}

/// d_0 = 2^−from, 2^−(from + 3), …
fn powers(from: i32, count: i32) -> impl Iterator<Item = f64> {
    (0..count).map(move |k| (-f64::from(from + 3 * k)).exp2())
}

#[test]
fn on_a_lattice_nonlinear_minus_linear_falls_as_the_square_of_the_inflation() {
    let packing = Lattice::triangular(0.5, 0.0625).expect("valid").periodic([16, 9]).expect("a lattice");
    let rim = Inflation {
        boundary: Boundary::HeldRim { outer_radius_over_side: 0.45 },
        centre: Centre::Label(100),
        ..Default::default()
    };
    let hertzian = departures(&packing, &Hertzian::default(), &rim, powers(7, 6));
    falls_as_the_square("Hertzian, held rim", &hertzian, 4.5);
    // A Hookean lattice is nonlinear by its geometry alone: 30 times less, so the floor is met earlier.
    falls_as_the_square("Hookean, held rim", &departures(&packing, &Hookean::default(), &rim, powers(5, 6)), 4.5);
    let periodic = Inflation { boundary: Boundary::Periodic, ..rim };
    falls_as_the_square(
        "Hertzian, periodic",
        &departures(&packing, &Hertzian::default(), &periodic, powers(7, 6)),
        4.5,
    );
    // Tied to its sites the packing is held by them, and nothing has to be held for the solution.
    let law = OnSite { law: Hertzian::default(), coupling: -5e3 };
    falls_as_the_square("tied, periodic", &departures(&packing, &law, &periodic, powers(7, 6)), 4.5);
    let law = PowerLaw { energy_scale: 1.0, exponent: 3.0 };
    falls_as_the_square("power law, held rim", &departures(&packing, &law, &rim, powers(7, 6)), 4.5);
}

fn fixture(name: &str) -> Packing<2> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/packings").join(name);
    read_packing::<2>(&path).expect("a packing")
}

#[test]
fn on_a_jammed_packing_nonlinear_minus_linear_falls_as_the_square_of_the_inflation() {
    let packing = fixture("hertz_N1000_p800.xyz");
    // Disks whose inflation by 2⁻⁸ opens and closes no contact anywhere in the circle; that of most does.
    let of = |label, outer_radius_over_side| {
        let boundary = Boundary::HeldRim { outer_radius_over_side };
        Inflation { boundary, centre: Centre::Label(label), ..Default::default() }
    };
    falls_as_the_square("p = 800", &departures(&packing, &Hertzian::default(), &of(71, 0.45), powers(8, 6)), 4.5);
    let packing = fixture("hooke_N1000_p5000.xyz");
    falls_as_the_square(
        "Hookean, p = 5000",
        &departures(&packing, &Hookean::default(), &of(7, 0.3), powers(8, 6)),
        4.5,
    );
}

#[test]
fn balls_answer_in_the_same_way() {
    let packing = random_points::<3>(200, &Default::default(), 1.0, 4).expect("possible");
    let packing = fire(1e-12).relax(packing, &Hertzian::default(), &mut ()).expect("apart");
    let packing = packing.converged().expect("at rest").into_inner();
    let inflation = Inflation { boundary: Boundary::Periodic, ..Default::default() };
    falls_as_the_square("balls", &departures(&packing, &Hertzian::default(), &inflation, powers(12, 5)), 3.6);
}

#[test]
fn a_hessian_without_prestress_answers_otherwise() {
    let circle: Circle<2> = Lattice::triangular(0.5, 0.0625).expect("valid").circle(8.0).expect("a circle");
    let law = Hertzian::default();
    let [with, without] = [Prestress::Included, Prestress::LeftOut].map(|prestress| {
        LinearResponse::of_inflation(&circle.packing, circle.centre, &law, prestress).expect("a response")
    });
    let largest = with.displacements.iter().map(|&u| norm(u)).fold(0.0, f64::max);
    let off = with.displacements.iter().zip(&without.displacements).map(|(&a, &b)| norm(difference(a, b)));
    // F/(r F') = δ/(1.5 r) = 0.044 of the stiffness.
    let off = off.fold(0.0, f64::max) / largest;
    assert!(off > 0.005 && off < 0.2, "{off}");
}

#[test]
fn every_order_of_elimination_gives_the_same_solution() {
    fn check<const D: usize>(packing: &Packing<D>, shares: [f64; 2]) {
        // The first disk is held: nothing else keeps a periodic packing in place.
        let held = (0..packing.len()).map(|disk| disk == 0).collect();
        let packing = packing.clone().with_held(held).expect("one flag a disk");
        let hessian =
            Hessian::new(&packing, &Hertzian::default(), Members::Backbone, Prestress::LeftOut).expect("apart");
        let matrix = hessian.matrix();
        let right: Vec<f64> = (0..matrix.dimension()).map(|row| (row as f64).sin()).collect();
        let mut plain = Analysis::new(matrix).expect("memory");
        let degree = minimum_degree(&hessian).expect("memory");
        let dissection = nested_dissection(&hessian);
        let mut orders = [&degree, &dissection].map(|order| Analysis::in_order(matrix, order).expect("an order"));
        // Counts of work: minimum degree on disks is as good as on rows; dissection leaves more in the plane, most so in a
        // small periodic box (1.35 here), and less in space.
        let counts =
            [&orders[0], &orders[1]].map(|analysis| analysis.factor_count() as f64 / plain.factor_count() as f64);
        println!("D = {D}: {counts:?} of the values of minimum degree on rows");
        assert!(counts[0] < shares[0] && counts[1] < shares[1], "{counts:?}");
        // The order taken where none is asked for is the better one: disks in the plane, positions in space.
        let taken = Analysis::of(&hessian).expect("memory").factor_count();
        assert_eq!(taken, orders[if D == 2 { 0 } else { 1 }].factor_count());
        let mut expected = vec![f64::NAN; right.len()];
        let mut factorisation = plain.cholesky(matrix).expect("definite");
        let ratio = factorisation.pivot_ratio();
        let _ = factorisation.solve(&right, &mut expected).expect("accurate");
        let size = expected.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        for analysis in &mut orders {
            let mut found = vec![f64::NAN; right.len()];
            let _ = analysis.cholesky(matrix).expect("definite").solve(&right, &mut found).expect("accurate");
            let worst = expected.iter().zip(&found).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
            // Backward errors of 10⁻¹⁵ over the inverse condition number, which lies below the ratio of pivots.
            assert!(worst <= 1e-15 / ratio * 1e3 * size, "D = {D}: {worst:e} of {size:e}, pivots {ratio:e}");
        }
    }
    check(&read_packing::<2>("fixtures/packings/hertz_N1000_p100.xyz").expect("readable"), [1.1, 1.4]);
    let target = Target::PackingFraction(0.75);
    let preparation = Preparation { disk_count: 2000, mixture: Mixture::default(), target, tolerance: 0.01, seed: 1 };
    let balls = prepare::<3, _>(&preparation, &Hertzian::default(), &fire(1e-4), &mut ()).expect("at rest");
    check(balls.packing.get(), [1.1, 0.85]);
}

#[test]
fn what_is_no_order_is_refused() {
    let packing = read_packing::<2>("fixtures/packings/hertz_N1000_p100.xyz").expect("readable");
    let hessian = Hessian::new(&packing, &Hertzian::default(), Members::Backbone, Prestress::Included).expect("apart");
    let (matrix, mut order) = (hessian.matrix(), minimum_degree(&hessian).expect("memory"));
    let refused = |order: &[usize]| Analysis::in_order(matrix, order).expect_err("no order");
    let dimension = matrix.dimension();
    assert_eq!(refused(&order[1..]), LinearError::NotAnOrder { dimension, place: dimension - 1, row: dimension });
    let (first, twice) = (order[0], order[7]);
    order[7] = first;
    assert_eq!(refused(&order), LinearError::NotAnOrder { dimension, place: 7, row: first });
    order[7] = dimension;
    assert_eq!(refused(&order), LinearError::NotAnOrder { dimension, place: 7, row: dimension });
    order[7] = twice;
    assert!(Analysis::in_order(matrix, &order).is_ok());
}

#[test]
fn conjugate_gradients_come_to_the_solution_of_the_factor() {
    let packing = read_packing::<2>("fixtures/packings/hertz_N1000_p100.xyz").expect("readable");
    let held = (0..packing.len()).map(|disk| disk == 0).collect();
    let packing = packing.with_held(held).expect("one flag a disk");
    for prestress in [Prestress::LeftOut, Prestress::Included] {
        let hessian = Hessian::new(&packing, &Hertzian::default(), Members::Backbone, prestress).expect("apart");
        let matrix = hessian.matrix();
        let right: Vec<f64> = (0..matrix.dimension()).map(|row| (row as f64).sin()).collect();
        let mut analysis = Analysis::of(&hessian).expect("memory");
        let mut factorisation = analysis.cholesky(matrix).expect("definite");
        let ratio = factorisation.pivot_ratio();
        let mut expected = vec![f64::NAN; right.len()];
        let _ = factorisation.solve(&right, &mut expected).expect("accurate");
        let incomplete = IncompleteFactor::new(matrix).expect("a positive diagonal");
        let mut found = vec![0.0; right.len()];
        let solution = conjugate_gradients(matrix, &incomplete, &right, &mut found, &IterationLimits::default());
        let solution = solution.expect("definite");
        println!("{prestress:?}: {solution:?}, shift {:e}", incomplete.shift());
        // Far fewer than the unknowns, of which there are 1900.
        assert!(solution.backward_error <= 16.0 * f64::EPSILON && solution.iteration_count < 1000, "{solution:?}");
        let size = expected.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let worst = expected.iter().zip(&found).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        // Backward errors of 10⁻¹⁵ over the inverse condition number, which lies below the ratio of pivots.
        assert!(worst <= 1e-15 / ratio * 1e3 * size, "{worst:e} of {size:e}, pivots {ratio:e}");
        // Started at the solution nothing is left to do; one iteration is too few.
        let again = conjugate_gradients(matrix, &incomplete, &right, &mut found, &IterationLimits::default());
        assert!(again.expect("definite").iteration_count <= solution.iteration_count / 2);
        let one = IterationLimits { iteration_count: 1, ..IterationLimits::default() };
        let used_up = conjugate_gradients(matrix, &incomplete, &right, &mut vec![0.0; right.len()], &one);
        assert!(matches!(used_up, Err(LinearError::IterationsUsedUp { iteration_count: 1, .. })), "{used_up:?}");
    }
}

#[test]
fn conjugate_gradients_refuse_a_saddle() {
    let (lattice, law) = (Lattice::triangular(0.5, 0.05).expect("touching"), Hertzian::default());
    let circle = lattice.circle(12.0).expect("a circle");
    let coupling = lattice.coupling(&law, (5.0f64 / 12.0).powi(2)).expect("isotropic");
    let hessian = Hessian::new(&circle.packing, &OnSite { law, coupling }, Members::Backbone, Prestress::Included);
    let hessian = hessian.expect("apart");
    let matrix = hessian.matrix();
    let dimension = matrix.dimension();
    let refused = LinearError::NotPositiveDefinite { dimension };
    let right: Vec<f64> = (0..dimension).map(|row| (0.1 * row as f64).sin()).collect();
    match IncompleteFactor::new(matrix) {
        Ok(factor) => {
            let mut solution = vec![0.0; dimension];
            let outcome = conjugate_gradients(matrix, &factor, &right, &mut solution, &IterationLimits::default());
            assert_eq!(outcome, Err(refused));
        }
        Err(error) => assert_eq!(error, refused),
    }
}
