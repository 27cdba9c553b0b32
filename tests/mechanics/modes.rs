//! Vibrational modes against a dense eigensolver, waves of a lattice, and what has none.

use std::f64::consts::PI;

use crate::scenes::laws::hertzian;
use crate::scenes::published::{BALLS, DISKS, HARMONIC, published};
use crate::scenes::random_disks::{disks, periodic};
use faer::{Mat, Side};
use jamscope::io::read_packing;
use jamscope::lattice::Lattice;
use jamscope::law::{Hertzian, Hookean, OnSite, PairLaw};
use jamscope::linear::{Hessian, Members, Prestress};
use jamscope::linear::{LinearError, VibrationalModes};
use jamscope::packing::{Domain, Packing};

/// All eigenvalues of the backbone by dense algebra, ascending, and ‖K‖.
fn dense<const D: usize>(packing: &Packing<D>, law: &dyn PairLaw) -> (Vec<f64>, f64) {
    let hessian = Hessian::new(packing, law, Members::Backbone, Prestress::Included).expect("apart");
    let dimension = hessian.matrix().dimension();
    let mut matrix = Mat::zeros(dimension, dimension);
    for (row, column, value) in hessian.matrix().entries() {
        matrix[(row, column)] = value;
        matrix[(column, row)] = value;
    }
    (matrix.self_adjoint_eigenvalues(Side::Lower).expect("finite"), hessian.matrix().norm())
}

fn lowest<const D: usize>(packing: &Packing<D>, law: &dyn PairLaw, count: usize) -> VibrationalModes<D> {
    VibrationalModes::lowest(packing, law, Prestress::Included, count).expect("modes")
}

/// The lowest modes against dense ones, translations taken out of those; the largest difference over ‖K‖.
fn check<const D: usize>(packing: &Packing<D>, law: &dyn PairLaw, count: usize, name: &str) -> f64 {
    let (mut values, norm) = dense(packing, law);
    let found = lowest(packing, law, count);
    if found.translation_count > 0 {
        // Those nearest to nothing; at a saddle they stand in the middle.
        values.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
        values.drain(..D);
        values.sort_by(f64::total_cmp);
    }
    assert_eq!(found.modes.len(), count.min(values.len()), "{name}");
    // Dense algebra is off by its dimension times the unit roundoff at most, 400 · 1e-16; ours by the residual, which it states.
    let mut worst = 0.0f64;
    for (at, (mode, &value)) in found.modes.iter().zip(&values).enumerate() {
        let off = (mode.eigenvalue - value).abs() / norm;
        assert!(mode.residual < 1e-13, "{name} {at}: residual {:e}", mode.residual);
        assert!(off < 1e-13, "{name} {at}: {} and {value}", mode.eigenvalue);
        worst = worst.max(off);
        let size: f64 = mode.displacements.iter().flatten().map(|x| x * x).sum();
        assert!((size - 1.0).abs() < 1e-13);
        let ratio = mode.participation_ratio * (found.unknown_count / D) as f64;
        assert!(ratio > 1.0 - 1e-12 && mode.participation_ratio < 1.0 + 1e-12, "{name}");
    }
    worst
}

#[test]
fn lowest_modes_are_those_of_dense_algebra() {
    for file in DISKS {
        for (at, record) in published::<2>(file).iter().enumerate() {
            // All modes of some, the lowest of the others.
            let count = [1, 7, 20, 1000][at % 4];
            let worst = check(&record.packing, &HARMONIC, count, &record.name);
            println!("{}: {count} modes off by {worst:.1e} of the norm", record.name);
        }
    }
    for file in BALLS {
        for (at, record) in published::<3>(file).iter().enumerate().take(4) {
            let count = [5, 30, 1000, 1][at];
            let worst = check(&record.packing, &HARMONIC, count, &record.name);
            println!("{}: {count} modes off by {worst:.1e} of the norm", record.name);
        }
    }
}

#[test]
fn at_a_saddle_the_negative_modes_come_first() {
    for seed in [1, 2, 3] {
        // Random disks are far from any minimum; a share of them is held in one of the boxes.
        let law = Hookean { stiffness: 1.0 };
        let held = disks(seed, 80, periodic([2.0, 3.0]), 0.2);
        let floating = disks(seed, 80, periodic([2.0, 3.0]), 0.0);
        assert!(lowest(&floating, &law, 3).modes[0].eigenvalue < 0.0);
        assert_eq!((lowest(&held, &law, 3).translation_count, lowest(&floating, &law, 3).translation_count), (0, 2));
        check(&held, &law, 10, "held");
        check(&floating, &law, 25, "floating");
        check(&floating, &OnSite { law, coupling: 0.3 }, 25, "pushed from sites");
        check(&disks(seed, 150, periodic([1.2, 1.2, 1.2]), 0.0), &law, 20, "balls");
    }
}

/// ω² of all waves of a triangular lattice of disks in a box, translations left out, ascending.
fn waves(lattice: &Lattice, cells: [usize; 2], law: &dyn PairLaw) -> Vec<f64> {
    let force = law.force(law.coefficient(lattice.radius(), lattice.radius()), lattice.overlap());
    let (along, across) = (law.stiffness(force, lattice.overlap()), -force / lattice.spacing());
    let mut values = Vec::new();
    // A rectangular cell has two disks, so the waves of the other disk's phase are those of twice as many rows.
    for x in 0..cells[0] {
        for y in 0..2 * cells[1] {
            // Phases of the steps (1, 0) and (1/2, √3/2): a shift by two rows and one column back is a whole cell.
            let (step, row) = (2.0 * PI * x as f64 / cells[0] as f64, 2.0 * PI * y as f64 / (2 * cells[1]) as f64);
            let mut block = [[0.0; 2]; 2];
            for (angle, phase) in [(0.0, step), (PI / 3.0, 0.5 * step + row), (2.0 * PI / 3.0, row - 0.5 * step)] {
                let (n, weight) = ([f64::cos(angle), f64::sin(angle)], 2.0 * (1.0 - f64::cos(phase)));
                for a in 0..2 {
                    for b in 0..2 {
                        let one = f64::from(u8::from(a == b));
                        block[a][b] += weight * (along * n[a] * n[b] + across * (one - n[a] * n[b]));
                    }
                }
            }
            let (mean, half) = (0.5 * (block[0][0] + block[1][1]), 0.5 * (block[0][0] - block[1][1]));
            let away = half.hypot(block[0][1]);
            values.extend([mean - away, mean + away]);
        }
    }
    values.sort_by(f64::total_cmp);
    values.drain(..2);
    values
}

#[test]
fn waves_of_a_lattice_are_found_as_often_as_they_occur() {
    fn check(law: &dyn PairLaw) {
        let few = (1..13).flat_map(|count| [([8, 5], count), ([10, 6], count), ([7, 4], count)]);
        for (cells, count) in [([12, 7], 40), ([20, 11], 24)].into_iter().chain(few) {
            let lattice = Lattice::triangular(0.5, 0.03).expect("neighbours touch, second ones do not");
            let packing = lattice.periodic(cells).expect("a box");
            let (exact, found) = (waves(&lattice, cells, law), lowest(&packing, law, count));
            assert_eq!(found.modes.len(), count);
            // At the least two waves run each way: the lowest are alike to rounding.
            assert!((exact[1] - exact[0]).abs() < 1e-12 * found.norm);
            for (mode, value) in found.modes.iter().zip(&exact) {
                // Overlaps are off by an ulp of the side, 4e-15, where they cross it: over δ = 0.03, 1e-13 of a stiffness.
                assert!((mode.eigenvalue - value).abs() < 2e-13 * found.norm, "{cells:?}: {} {value}", mode.eigenvalue);
            }
            // Nor does a vector occur twice.
            for (at, mode) in found.modes.iter().enumerate() {
                for other in &found.modes[..at] {
                    let (a, b) = (mode.displacements.as_flattened(), other.displacements.as_flattened());
                    let along: f64 = a.iter().zip(b).map(|(x, y)| x * y).sum();
                    // Eigenvectors of unlike eigenvalues by their residuals over the gap, of like ones by the search.
                    assert!(along.abs() < 1e-6, "{cells:?} {at}: {along:e}");
                }
            }
        }
    }
    check(&Hertzian { stiffness: 1.0 });
    check(&Hookean { stiffness: 1.0 });
}

#[test]
fn eight_equal_cages_have_their_softest_mode_eight_times() {
    // A ball between six held ones, nearer along one axis than along the next: three levels, each exactly as often as there are
    // cages, of which one run of Lanczos sees one vector each.
    let (cages, apart) = (8, [1.0, 1.0625, 1.125]);
    let (mut positions, mut held) = (Vec::new(), Vec::new());
    for cage in 0..cages {
        let middle = [4.0 * cage as f64, 0.0, 0.0];
        positions.push(middle);
        held.push(false);
        for axis in 0..3 {
            for side in [-1.0, 1.0] {
                let mut place = middle;
                place[axis] += side * apart[axis];
                positions.push(place);
                held.push(true);
            }
        }
    }
    let radii = vec![0.625; positions.len()];
    let packing =
        Packing::new(Domain::Open, positions, radii).and_then(|packing| packing.with_held(held)).expect("a packing");
    // Along an axis 2 F', less 2 F/r of the other four: softest where those press hardest, along the longest.
    let softest = 2.0 - 2.0 * (0.25 / apart[0] + 0.1875 / apart[1]);
    let found = lowest(&packing, &Hookean { stiffness: 1.0 }, 5);
    for mode in &found.modes {
        assert!((mode.eigenvalue - softest).abs() < 1e-14, "{} and {softest}", mode.eigenvalue);
    }
}

#[test]
fn a_thousand_disks_take_few_factorisations() {
    for name in ["hertz_N1000_p1", "hertz_N1000_p100", "hertz_N1000_p800"] {
        let path = format!("{}/fixtures/packings/{name}.xyz", env!("CARGO_MANIFEST_DIR"));
        let packing = read_packing::<2>(path).expect("a fixture");
        let found = lowest(&packing, &hertzian(), 10);
        let (first, last) = (&found.modes[0], &found.modes[9]);
        println!(
            "{name}: {:e} to {:e}, residuals {:.0e}, {} factorisations, {} solutions",
            first.eigenvalue, last.eigenvalue, last.residual, found.factorisation_count, found.solution_count
        );
        assert!(first.eigenvalue > 0.0, "{name}: at rest, but no minimum");
        assert!(found.translation_residual < 1e-15, "{name}");
        assert!(found.factorisation_count <= 6 && found.solution_count <= 200, "{name}: {found:?}");
        assert!(found.modes.windows(2).all(|pair| pair[0].eigenvalue <= pair[1].eigenvalue));
        assert!(found.modes.iter().all(|mode| mode.residual < 1e-14), "{name}");
    }
}

#[test]
fn one_disk_between_held_ones_has_its_modes_and_loose_disks_none() {
    // Four held disks around one, Hookean: along an axis 2 F' − 2 F/r, the same along the other.
    let positions = vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
    let packing = Packing::new(Domain::Open, positions, vec![0.6; 5])
        .and_then(|packing| packing.with_held(vec![false, true, true, true, true]))
        .expect("a packing");
    let found = lowest(&packing, &Hookean { stiffness: 1.0 }, 5);
    assert_eq!((found.modes.len(), found.translation_count, found.unknown_count), (2, 0, 2));
    for mode in &found.modes {
        // 2 · 1 − 2 · 0.2: δ = 0.2 to 1e-16, a few roundings.
        assert!((mode.eigenvalue - 1.6).abs() < 1e-14 && (mode.participation_ratio - 1.0).abs() < 1e-14);
    }
    let alone = Packing::new(Domain::Open, vec![[0.0, 0.0], [1.0, 0.0]], vec![0.6, 0.6]).expect("a packing");
    let none = VibrationalModes::lowest(&alone, &Hookean { stiffness: 1.0 }, Prestress::Included, 1);
    assert_eq!(none, Err(LinearError::NoBackbone { disk_count: 2 }));
    assert!(lowest(&packing, &Hookean { stiffness: 1.0 }, 0).modes.is_empty());
}
