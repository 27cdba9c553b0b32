//! Tilted boxes: lattices sheared by known amounts, and boxes of other edges that hold the same packing.

use crate::scenes::laws::hertzian;
use jamscope::law::{Hertzian, Hookean, PairLaw};
use jamscope::linear::{ElasticModuli, Prestress};
use jamscope::network::ContactNetwork;
use jamscope::packing::{Domain, Mixture, Packing};
use jamscope::preparation::{Preparation, Target, prepare_with};
use jamscope::relax::{Fire, ForceLimit, Relaxer};
use jamscope::vector::{Vector, larger, norm};

/// A Bravais lattice of disks with radius 0.5: `counts` cells along the edges, a box spanned by multiples of them.
fn bravais<const D: usize>(cell: [Vector<D>; D], counts: [usize; D]) -> Packing<D> {
    let total: usize = counts.iter().product();
    let positions = (0..total)
        .map(|site| {
            let mut rest = site;
            let mut position = [0.0; D];
            for d in 0..D {
                let index = (rest % counts[d]) as f64;
                rest /= counts[d];
                (0..D).for_each(|axis| position[axis] += index * cell[d][axis]);
            }
            position
        })
        .collect();
    let edges = std::array::from_fn(|d| cell[d].map(|component| counts[d] as f64 * component));
    Packing::new(Domain::Periodic { corner: [0.0; D], edges }, positions, vec![0.5; total]).expect("a lattice")
}

/// Energy, stress and affine constants of a lattice with one site a cell and these bonds, per site and cell.
fn check_lattice<const D: usize>(
    name: &str,
    law: &dyn PairLaw,
    cell: [Vector<D>; D],
    counts: [usize; D],
    bonds: &[Vector<D>],
) {
    let packing = bravais(cell, counts);
    let count = packing.len() as f64;
    let volume = packing.domain().volume().expect("a box");
    let (mut energy, mut stress) = (0.0, [[0.0; D]; D]);
    let mut constants = vec![0.0; D * D * D * D];
    for bond in bonds {
        let (distance, coefficient) = (norm(*bond), law.coefficient(0.5, 0.5));
        let overlap = 1.0 - distance;
        assert!(overlap > 0.0, "{name}: a bond that is none");
        let force = law.force(coefficient, overlap);
        energy += count * law.energy(force, overlap);
        let (along, across) = (law.stiffness(force, overlap), -force / distance);
        let unit = bond.map(|component| component / distance);
        // d^(ab) · B d^(cd) with d^(ab) = (e_a r_b + e_b r_a)/2 and B = k n n + (−F/r) (1 − n n).
        let block = |p: usize, q: usize| {
            let one = f64::from(u8::from(p == q));
            along * unit[p] * unit[q] + across * (one - unit[p] * unit[q])
        };
        for (a, row) in stress.iter_mut().enumerate() {
            for (b, value) in row.iter_mut().enumerate() {
                *value += count / volume * force * distance * unit[a] * unit[b];
            }
        }
        for (index, value) in constants.iter_mut().enumerate() {
            let [a, b, c, d] = [index % D, index / D % D, index / (D * D) % D, index / (D * D * D)];
            let of = |p: usize, q: usize, r: usize, s: usize| block(p, r) * bond[q] * bond[s];
            let sum = of(a, b, c, d) + of(b, a, c, d) + of(a, b, d, c) + of(b, a, d, c);
            *value += count / volume * 0.25 * sum;
        }
    }
    let network = ContactNetwork::new(&packing, law).expect("apart");
    assert_eq!(network.contacts.len(), bonds.len() * packing.len(), "{name}");
    // Coordinates up to 20 are rounded to 4e-15 and their distances to twice that, over overlaps of 0.02 and more: 4e-13,
    // in forces and slopes times at most 3/2; errors of many bonds are of either sign.
    let close = |found: f64, expected: f64, scale: f64, what: &str| {
        assert!((found - expected).abs() <= 1e-12 * scale.abs(), "{name}, {what}: {found} and {expected}");
    };
    close(network.energy(), energy, energy, "energy");
    let (found, size) = (network.stress(volume), stress[0][0].abs());
    let moduli = ElasticModuli::of(&packing, law, Prestress::Included).expect("rigid");
    for a in 0..D {
        for b in 0..D {
            close(found[a][b], stress[a][b], size, "stress");
        }
    }
    let stiffest = constants.iter().fold(0.0, |most, value| larger(value.abs(), most));
    for (index, &expected) in constants.iter().enumerate() {
        let [a, b, c, d] = [index % D, index / D % D, index / (D * D) % D, index / (D * D * D)];
        close(moduli.affine.constants[a][b][c][d], expected, stiffest, "affine constants");
        // A lattice with one site a cell follows every strain as a whole.
        close(moduli.relaxed.constants[a][b][c][d], expected, stiffest, "relaxed constants");
    }
}

#[test]
fn a_sheared_triangular_lattice_has_its_exact_energy_stress_and_constants() {
    let (apart, height) = (0.94, 0.94 * 0.75f64.sqrt());
    for law in [&hertzian() as &dyn PairLaw, &Hookean { stiffness: 3.0 }] {
        for shear in [0.0, 1e-9, 0.003, -0.02, 0.03] {
            let sheared = |[x, y]: Vector<2>| [x + shear * y, y];
            let bonds = [[apart, 0.0], [0.5 * apart, height], [-0.5 * apart, height]].map(sheared);
            // The cell by two of its bonds, then by edges that lean over many cells to either side.
            for lean in [0.0, 1.0, -1.0, 5.0, -14.0] {
                let edge = sheared([0.5 * apart + lean * apart, height]);
                let name = format!("{law:?}, shear {shear}, lean {lean}");
                check_lattice(&name, law, [[apart, 0.0], edge], [9, 8], &bonds);
            }
        }
    }
}

#[test]
fn a_sheared_close_packed_lattice_has_its_exact_energy_stress_and_constants() {
    // Face-centred cubic: layers of triangles at √(2/3) of the spacing.
    let apart = 0.95;
    let (a, b) = ([apart, 0.0, 0.0], [0.5 * apart, 0.75f64.sqrt() * apart, 0.0]);
    let c = [0.5 * apart, apart / 12f64.sqrt(), (2.0 / 3.0f64).sqrt() * apart];
    for [xy, xz, yz] in [[0.0; 3], [0.01, 0.0, 0.0], [0.004, -0.01, 0.007]] {
        let sheared = |[x, y, z]: Vector<3>| [x + xy * y + xz * z, y + yz * z, z];
        let minus = |p: Vector<3>, q: Vector<3>| std::array::from_fn(|d| p[d] - q[d]);
        let bonds = [a, b, c, minus(b, a), minus(c, a), minus(c, b)].map(sheared);
        let cell = [a, b, c].map(sheared);
        check_lattice(&format!("{xy} {xz} {yz}"), &Hertzian { stiffness: 1.0 }, cell, [5, 4, 4], &bonds);
        // An edge more along each earlier one: the same lattice.
        let more = |p: Vector<3>, q: Vector<3>, n: f64| std::array::from_fn(|d| p[d] + n * q[d]);
        let leaning = [cell[0], more(cell[1], cell[0], -2.0), more(more(cell[2], cell[0], 3.0), cell[1], 1.0)];
        check_lattice("leaning", &Hertzian { stiffness: 1.0 }, leaning, [5, 4, 4], &bonds);
    }
}

/// A packing at rest in a box tilted by `tilt` sides.
fn at_rest(tilt: f64, law: &dyn PairLaw) -> Packing<2> {
    let fire = Fire { limit: ForceLimit::Relative(1e-12), ..Fire::default() };
    let target = Target::PackingFraction(0.88);
    let preparation = Preparation {
        disk_count: 120,
        mixture: Mixture::default(),
        target,
        tolerance: 0.01,
        seed: 3,
        ..Preparation::default()
    };
    let prepared = prepare_with::<2>(&preparation, law, &fire, &mut ()).expect("at rest");
    let packing = prepared.packing.get();
    let [width, height] = packing.domain().lengths().expect("a box");
    let sheared = packing.positions().iter().map(|&[x, y]| [x + tilt * width * y / height, y]).collect();
    let domain = Domain::Periodic { corner: [0.0; 2], edges: [[width, 0.0], [tilt * width, height]] };
    let start = Packing::new(domain, sheared, packing.radii().to_vec()).expect("a packing");
    fire.relax(start, law, &mut ()).expect("apart").converged().expect("at rest").into_inner()
}

/// Energy per area, stress and relaxed constants, the same to 10⁻¹².
fn check_same(one: &Packing<2>, other: &Packing<2>, law: &dyn PairLaw, what: &str) {
    let of = |packing: &Packing<2>| {
        let volume = packing.domain().volume().expect("a box");
        let network = ContactNetwork::new(packing, law).expect("apart");
        let moduli = ElasticModuli::of(packing, law, Prestress::Included).expect("rigid");
        let constants = moduli.relaxed.constants.as_flattened().as_flattened().as_flattened().to_vec();
        (network.energy() / volume, network.stress(volume).as_flattened().to_vec(), constants)
    };
    let ((energy, stress, constants), (energy_too, stress_too, constants_too)) = (of(one), of(other));
    assert!((energy / energy_too - 1.0).abs() < 1e-12, "{what}: {energy} and {energy_too}");
    for (values, values_too) in [(stress, stress_too), (constants, constants_too)] {
        let scale = values.iter().fold(0.0, |most, value| larger(value.abs(), most));
        for (value, value_too) in values.iter().zip(&values_too) {
            assert!((value - value_too).abs() < 1e-12 * scale, "{what}: {value} and {value_too}");
        }
    }
}

/// A box tilted by m/n of its side holds the same packing as a rectangular box of n copies, each shifted by the tilt: n
/// edges b, less m edges a, are an edge along y. Coordinates are rounded to 4·10⁻¹⁵ and overlaps are 0.03 on average.
#[test]
fn a_tilted_box_and_the_rectangular_box_of_its_copies_agree() {
    let law = hertzian();
    for (m, n) in [(1, 2), (-1, 2), (2, 3), (5, 3), (1, 4)] {
        let tilted = at_rest(f64::from(m) / f64::from(n), &law);
        let Domain::Periodic { edges: [[width, _], [tilt, height]], .. } = *tilted.domain() else { panic!("a box") };
        let copies = (0..n).flat_map(|copy| {
            let shift = [f64::from(copy) * tilt, f64::from(copy) * height];
            tilted.positions().iter().map(move |&[x, y]| [x + shift[0], y + shift[1]]).collect::<Vec<_>>()
        });
        let corrections = (0..n).flat_map(|_| tilted.corrections().to_vec()).collect();
        let radii = (0..n).flat_map(|_| tilted.radii().to_vec()).collect();
        let domain = Domain::rectangular([0.0; 2], [width, f64::from(n) * height]);
        let whole = Packing::new(domain, copies.collect(), radii)
            .and_then(|packing| packing.with_corrections(corrections))
            .expect("a packing");
        check_same(&tilted, &whole, &law, &format!("tilt {m}/{n}"));
    }
}

#[test]
fn edges_that_span_the_same_lattice_agree() {
    let law = hertzian();
    for tilt in [0.0, 0.21, -0.4] {
        let packing = at_rest(tilt, &law);
        let Domain::Periodic { corner, edges: [a, b] } = *packing.domain() else { panic!("a box") };
        for more in [-7.0, -1.0, 1.0, 3.0] {
            let domain =
                Domain::Periodic { corner: [corner[0] - 3.3, corner[1] + 1.1], edges: [a, [b[0] + more * a[0], b[1]]] };
            let other = Packing::new(domain, packing.positions().to_vec(), packing.radii().to_vec())
                .and_then(|other| other.with_corrections(packing.corrections().to_vec()))
                .expect("a packing");
            check_same(&packing, &other, &law, &format!("tilt {tilt}, {more} sides more"));
        }
    }
}

#[test]
fn edges_that_are_not_triangular_are_refused() {
    let of = |edges| Packing::new(Domain::Periodic { corner: [0.0; 2], edges }, vec![[0.0; 2]], vec![0.5]);
    let error = of([[9.0, 0.5], [0.0, 9.0]]).expect_err("an edge along y");
    assert!(error.to_string().contains("box edge 0: component 0.5 along axis 1"), "{error}");
    assert!(of([[9.0, 0.0], [f64::NAN, 9.0]]).is_err());
    assert!(of([[9.0, 0.0], [1.0, 0.0]]).is_err());
}
