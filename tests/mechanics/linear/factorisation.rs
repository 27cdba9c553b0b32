//! Factorisations and conjugate gradients against dense algebra, in every order of elimination, and what they refuse.

use jamscope::lattice::Lattice;
use jamscope::law::{Hookean, OnSite};
use jamscope::linear::iterative::{IncompleteFactor, IterationLimits, conjugate_gradients};
use jamscope::linear::ordering::{minimum_degree, nested_dissection};
use jamscope::linear::{Analysis, LinearError, LinearResponse};
use jamscope::linear::{Hessian, Members, Prestress};
use jamscope::packing::{Mixture, Packing};
use jamscope::preparation::{Preparation, Target, prepare_with, random_points};
use jamscope::vector::larger;

use super::{dense, fire, fixture};

use crate::scenes::laws::hertzian;

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
            let largest = exact.iter().fold(0.0, |most, x| larger(most, x.abs()));
            let off = solved.iter().zip(&exact).fold(0.0, |most, (a, b)| larger(most, (a - b).abs()));
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
    let error =
        Analysis::of(&floating).expect("memory").factorise(floating.matrix()).map(|_| ()).expect_err("singular");
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

#[test]
fn every_order_of_elimination_gives_the_same_solution() {
    fn check<const D: usize>(packing: &Packing<D>, shares: [f64; 2]) {
        // The first disk is held: nothing else keeps a periodic packing in place.
        let held = (0..packing.len()).map(|disk| disk == 0).collect();
        let packing = packing.clone().with_held(held).expect("one flag a disk");
        let hessian = Hessian::new(&packing, &hertzian(), Members::Backbone, Prestress::LeftOut).expect("apart");
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
        let size = expected.iter().fold(0.0, |most, x| larger(most, x.abs()));
        for analysis in &mut orders {
            let mut found = vec![f64::NAN; right.len()];
            let _ = analysis.cholesky(matrix).expect("definite").solve(&right, &mut found).expect("accurate");
            let worst = expected.iter().zip(&found).fold(0.0, |most, (a, b)| larger(most, (a - b).abs()));
            // Backward errors of 10⁻¹⁵ over the inverse condition number, which lies below the ratio of pivots.
            assert!(worst <= 1e-15 / ratio * 1e3 * size, "D = {D}: {worst:e} of {size:e}, pivots {ratio:e}");
        }
    }
    check(&fixture("hertz_N1000_p100"), [1.1, 1.4]);
    let target = Target::PackingFraction(0.75);
    let preparation = Preparation {
        disk_count: 2000,
        mixture: Mixture::default(),
        target,
        tolerance: 0.01,
        seed: 1,
        ..Preparation::default()
    };
    let balls = prepare_with::<3>(&preparation, &hertzian(), &fire(1e-4), &mut ()).expect("at rest");
    check(balls.packing.get(), [1.1, 0.85]);
}

#[test]
fn what_is_no_order_is_refused() {
    let packing = fixture("hertz_N1000_p100");
    let hessian = Hessian::new(&packing, &hertzian(), Members::Backbone, Prestress::Included).expect("apart");
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
    let packing = fixture("hertz_N1000_p100");
    let held = (0..packing.len()).map(|disk| disk == 0).collect();
    let packing = packing.with_held(held).expect("one flag a disk");
    for prestress in [Prestress::LeftOut, Prestress::Included] {
        let hessian = Hessian::new(&packing, &hertzian(), Members::Backbone, prestress).expect("apart");
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
        let size = expected.iter().fold(0.0, |most, x| larger(most, x.abs()));
        let worst = expected.iter().zip(&found).fold(0.0, |most, (a, b)| larger(most, (a - b).abs()));
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
    let (lattice, law) = (Lattice::triangular(0.5, 0.05).expect("touching"), hertzian());
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
