use jamscope::inflation::Circle;
use jamscope::io::read_packing;
use jamscope::law::Hertzian;
use jamscope::network::ContactNetwork;
use jamscope::observe::bond_changes::{BondChanges, BondSet};
use jamscope::observe::fluctuations::{BondMeasure, Fluctuations};
use jamscope::observe::{RadialProfile, State};
use jamscope::packing::{Domain, Packing};
use jamscope::vector::{Vector, dot, norm};

use super::{field, generator, normal, random_places};

/// A stored packing cut to a circle in the open plane, so that any affine map is one of all its disks.
fn circle() -> Circle<2> {
    let packing = read_packing::<2>("fixtures/packings/hertz_N1000_p800.xyz").expect("a fixture");
    Circle::cut(&packing, 17, 15.0).expect("a circle")
}

/// The disks of a packing taken by x → F x.
fn mapped(packing: &Packing<2>, map: [[f64; 2]; 2]) -> Packing<2> {
    let positions: Vec<Vector<2>> = packing.positions().iter().map(|&x| map.map(|row| dot(row, x))).collect();
    Packing::new(Domain::Open, positions, packing.radii().to_vec())
        .and_then(|mapped| mapped.with_held(packing.held().to_vec()))
        .expect("sound disks")
}

#[test]
fn an_affine_map_stretches_every_bond_by_what_it_does_to_its_ends() {
    let (circle, law) = (circle(), Hertzian::default());
    // Positions without low parts, which the map would not carry along.
    let start = mapped(&circle.packing, [[1.0, 0.0], [0.0, 1.0]]);
    let before = State::new(&start, &law).expect("sound disks");
    let (strain, angle) = (1e-4, 3e-3f64);
    let (sine, cosine) = angle.sin_cos();
    let maps = [
        [[1.0 + strain, 0.0], [0.0, 1.0 - strain]],
        [[1.0, 2.0 * strain], [0.0, 1.0]],
        [[1.0 - strain, 0.0], [0.0, 1.0 - strain]],
        [[cosine, -sine], [sine, cosine]],
    ];
    for map in maps {
        let end = mapped(&start, map);
        let after = State::new(&end, &law).expect("sound disks");
        let changes = BondChanges::between(&before, &after, circle.centre, BondSet::Before);
        assert_eq!(changes.bonds.len(), before.network.backbone_contacts().count());
        for bond in &changes.bonds {
            let s = bond.separation;
            let stretched = map.map(|row| dot(row, s));
            let relative = [stretched[0] - s[0], stretched[1] - s[1]];
            // Four coordinates below 32 rounded to 3.6·10⁻¹⁵ by the map, and the expectation to 10⁻¹⁶.
            let tolerance = 2e-14;
            assert!((bond.parallel - dot(s, relative) / norm(s)).abs() < tolerance);
            assert!((bond.length_change - (norm(stretched) - norm(s))).abs() < tolerance);
        }
    }
    // A rotation changes no length, and d_∥ by its second order: (cos ω − 1) |s|.
    let end = mapped(&start, maps[3]);
    let after = State::new(&end, &law).expect("sound disks");
    let turned = BondChanges::between(&before, &after, circle.centre, BondSet::Kept);
    assert!(turned.bonds.iter().all(|bond| bond.length_change.abs() < 2e-14 && bond.parallel < -4e-6));
}

#[test]
fn bonds_are_kept_contacts_unless_all_are_asked_for() {
    let (circle, law) = (circle(), Hertzian::default());
    let start = mapped(&circle.packing, [[1.0, 0.0], [0.0, 1.0]]);
    // One per cent along x opens contacts in that direction.
    let end = mapped(&start, [[1.01, 0.0], [0.0, 1.0]]);
    let (before, after) =
        (State::new(&start, &law).expect("sound disks"), State::new(&end, &law).expect("sound disks"));
    let keys = |set| -> Vec<(u32, u32)> {
        let changes = BondChanges::between(&before, &after, circle.centre, set);
        changes.bonds.iter().map(|bond| (bond.first, bond.second)).collect()
    };
    let backbone = |disk: u32| before.network.backbone[disk as usize] && after.network.backbone[disk as usize];
    let pairs = |network: &ContactNetwork<2>| -> Vec<(u32, u32)> {
        let contacts = network.contacts.iter().map(|contact| (contact.first, contact.second));
        contacts.filter(|&(a, b)| backbone(a) && backbone(b)).collect()
    };
    let (old, new) = (pairs(&before.network), pairs(&after.network));
    let kept: Vec<(u32, u32)> = old.iter().copied().filter(|pair| new.contains(pair)).collect();
    assert!(kept.len() < old.len() && kept.len() > 1000);
    assert_eq!(keys(BondSet::Before), old);
    assert_eq!(keys(BondSet::Kept), kept);
}

#[cfg(feature = "linear")]
#[test]
fn bonds_of_a_linear_response_are_those_of_its_contact_changes() {
    use jamscope::linear::LinearResponse;
    use jamscope::linear::Prestress;
    let (circle, law) = (circle(), Hertzian::default());
    let state = State::new(&circle.packing, &law).expect("sound disks");
    let response = LinearResponse::of_inflation(&circle.packing, circle.centre, &law, Prestress::Included)
        .expect("a stable packing");
    let changes = BondChanges::of_linear_response(&state, &response, 0.1);
    let overlaps = response.contact_changes(&circle.packing, &law).expect("sound disks");
    let mut compared = 0;
    for bond in &changes.bonds {
        let same = |change: &&jamscope::linear::contact_changes::ContactChange| {
            (change.first, change.second) == (bond.first, bond.second)
        };
        let overlap = overlaps.iter().find(same).expect("a contact of the backbone");
        let grows = [bond.first, bond.second].contains(&(circle.centre as u32));
        let expected = 0.1 * (if grows { 1.0 } else { 0.0 } - overlap.overlap_change);
        // Both routes take a few roundings of displacements below 0.1.
        assert!((bond.parallel - expected).abs() < 1e-15, "{} is not {expected}", bond.parallel);
        compared += 1;
    }
    assert!(compared > 1000);
}

#[test]
fn the_fluctuation_of_a_pure_shear_on_a_triangular_lattice_is_known() {
    // γ cos 2φ at φ = 0, 60°, 120°: γ, −γ/2, −γ/2; mean 0, Σ² = 3γ²/2 for three.
    let (shear, triples) = (1e-3, 40);
    let pairs = (0..3 * triples).map(|bond| (5.3, if bond % 3 == 0 { shear } else { -0.5 * shear }));
    let rings = Fluctuations::of(pairs, 10.0, 1.0).rings;
    let count = 3.0 * triples as f64;
    let expected = shear * (0.5 * count / (count - 1.0)).sqrt();
    assert_eq!((rings.len(), rings[0].count), (1, 120));
    assert!((rings[0].radius - 5.3).abs() < 1e-14);
    assert!((rings[0].fluctuation / expected - 1.0).abs() < 1e-14 && rings[0].mean.abs() < 1e-18);
}

#[test]
fn bonds_in_an_elastic_medium_stretch_as_the_inverse_square_of_the_distance() {
    // d = (A/r) r̂ strains by ∓A/r² along and across: d_∥ = −(A s/r²) cos 2φ of a bond at φ to the radius, mean 0, h_∥ = A √⟨s²⟩/(√2 r²).
    let packing = read_packing::<2>("fixtures/packings/hertz_N5548_p100.xyz").expect("a fixture");
    let (circle, law) = (Circle::cut(&packing, 17, 40.0).expect("a circle"), Hertzian::default());
    let (amplitude, origin) = (1e-4, circle.packing.positions()[circle.centre]);
    let flowed = circle.packing.positions().iter().map(|&x| {
        let out = [x[0] - origin[0], x[1] - origin[1]];
        let along = amplitude / dot(out, out).max(1e-9);
        [x[0] + along * out[0], x[1] + along * out[1]]
    });
    let after = Packing::new(Domain::Open, flowed.collect(), circle.packing.radii().to_vec())
        .and_then(|packing| packing.with_held(circle.packing.held().to_vec()))
        .expect("sound disks");
    let before = State::new(&circle.packing, &law).expect("sound disks");
    let after = State::new(&after, &law).expect("sound disks");
    let changes = BondChanges::between(&before, &after, circle.centre, BondSet::Before);
    let squares = changes.bonds.iter().map(|bond| dot(bond.separation, bond.separation));
    let length = (squares.sum::<f64>() / changes.bonds.len() as f64).sqrt();
    let rings = Fluctuations::of_bonds(&changes, BondMeasure::Parallel, 40.0, 1.0).rings;
    // Bonds are short against r from here on: (s/2r)² is below a third of a per cent.
    let (mut weights, mut sum) = (0.0, 0.0);
    for ring in rings.iter().filter(|ring| ring.radius > 10.0) {
        let expected = amplitude * length / (2f64.sqrt() * ring.radius.powi(2));
        let error = ring.standard_error / ring.fluctuation;
        // Five standard errors, and r² over a ring of width 1 goes up and down by a tenth at r = 10, which moves its mean by 1/3 %.
        assert!((ring.fluctuation / expected - 1.0).abs() < 5.0 * error + 0.01, "r = {}", ring.radius);
        weights += error.powi(-2);
        sum += error.powi(-2) * (ring.fluctuation / expected);
    }
    // Of all rings: the same, with their common error.
    assert!(
        (sum / weights - 1.0).abs() < 4.0 / weights.sqrt() + 0.005,
        "{} ± {}",
        sum / weights,
        weights.sqrt().recip()
    );
}

#[test]
fn the_fluctuation_of_the_radial_displacement_is_the_spread_of_its_profile() {
    let mut generator = generator(5);
    let places = random_places(&[3.2, 7.7, 21.5], 60, &mut generator);
    let field = field(&places, |r, angle| [0.1 / r + 0.01 * (3.0 * angle).cos(), 0.0]);
    let rings = Fluctuations::of_radial(&field, 1.0).rings;
    // Rings of a profile begin at a = 0.5: the same disks, in another order.
    let profile = RadialProfile::of(&field, 1.0);
    assert_eq!(rings.len(), 3);
    for (ring, twin) in rings.iter().zip(&profile.rings) {
        assert_eq!(ring.count, twin.disk_count);
        // A sum of 60 terms in two orders.
        assert!((ring.fluctuation / twin.spread - 1.0).abs() < 1e-13 && (ring.mean - twin.mean).abs() < 1e-15);
    }
}

#[test]
fn errors_of_a_fluctuation_cover() {
    // 8000 rings of 150 independent numbers of known spread: (h − σ)/error lies within 1 in 68.3 % and within 2 in 95.4 %,
    // to four standard deviations of that count (√(0.683 · 0.317/8000) = 0.52 %, 0.23 %) and 1 % for the skewness of s at
    // 150.
    let (mut generator, mut within) = (generator(8), [0.0; 2]);
    for _ in 0..8000 {
        let values: Vec<(f64, f64)> = (0..150).map(|_| (1.5, 0.3 + 0.02 * normal(&mut generator))).collect();
        let ring = Fluctuations::of(values.into_iter(), 10.0, 1.0).rings[0];
        let pull = ((ring.fluctuation - 0.02) / ring.standard_error).abs();
        (0..2).for_each(|k| within[k] += if pull < (k + 1) as f64 { 1.0 / 8000.0 } else { 0.0 });
    }
    assert!((within[0] - 0.683f64).abs() < 0.031, "{within:?}");
    assert!((within[1] - 0.954f64).abs() < 0.02, "{within:?}");
}

#[test]
fn rings_with_one_member_have_no_fluctuation_and_one_of_equal_members_none_but_zero() {
    let pairs = [(0.5, 1.0), (1.5, 2.0), (1.6, 2.0), (12.0, 1.0), (12.5, 3.0)];
    let rings = Fluctuations::of(pairs.into_iter(), 10.0, 1.0).rings;
    assert_eq!(rings.len(), 1, "one member, and beyond the outer radius");
    assert_eq!((rings[0].fluctuation, rings[0].standard_error), (0.0, 0.0));
}
