//! The observables of a response in three dimensions, on fields whose answer is known.

use std::f64::consts::PI;

use jamscope::displacement::{DisplacementField, MeasuredOn, Moved, Shape};
use jamscope::law::Hertzian;
use jamscope::observe::bond_changes::{BondChange, BondChanges, BondSet};
use jamscope::observe::fluctuations::{BondMeasure, Fluctuations};
use jamscope::observe::isostatic::{
    IsostaticLength, IsostaticOutcome, IsostaticRule, IsostaticSettings, Normalisation, Scale, Tail,
};
use jamscope::observe::penetration_length::{PenetrationLength, PenetrationSettings};
use jamscope::observe::{ContactChanges, ExcessCoordination, RadialProfile, State};
use jamscope::packing::{Domain, Packing};
use jamscope::vector::{Vector, difference, dot, norm, scaled, sum};
use rand::RngExt;
use rand_pcg::Pcg64;

use super::generator;

/// Distance of neighbours in the lattice; spheres of diameter 1 overlap by 0.01.
const SPACING: f64 = 0.99;

const CELLS: usize = 4;

/// A face-centred cubic lattice of 256 spheres in a periodic box, taken by z → `stretch` z.
fn lattice(stretch: f64) -> Packing<3> {
    let edge = SPACING * 2f64.sqrt();
    let corners = [[0.25, 0.25, 0.25], [0.75, 0.75, 0.25], [0.75, 0.25, 0.75], [0.25, 0.75, 0.75]];
    let mut positions = Vec::new();
    for cell in 0..CELLS * CELLS * CELLS {
        let at = [cell % CELLS, cell / CELLS % CELLS, cell / CELLS / CELLS];
        for corner in corners {
            let place = [0, 1, 2].map(|d| edge * (at[d] as f64 + corner[d]));
            positions.push([place[0], place[1], stretch * place[2]]);
        }
    }
    let side = edge * CELLS as f64;
    let radii = vec![0.5; positions.len()];
    Packing::new(Domain::rectangular([0.0; 3], [side, side, stretch * side]), positions, radii).expect("sound spheres")
}

fn direction(random: &mut Pcg64) -> Vector<3> {
    let (z, angle) = (2.0 * random.random::<f64>() - 1.0, 2.0 * PI * random.random::<f64>());
    let across = (1.0 - z * z).sqrt();
    [across * angle.cos(), across * angle.sin(), z]
}

/// Bonds of length 0.01 in random directions, `count` at every distance, that a displacement field stretches.
fn bonds(distances: &[f64], count: usize, seed: u64, field: impl Fn(Vector<3>) -> Vector<3>) -> BondChanges<3> {
    let mut random = generator(seed);
    let bond = |distance: f64| {
        let midpoint = scaled(distance, direction(&mut random));
        let separation = scaled(0.01, direction(&mut random));
        let half = scaled(0.5, separation);
        let relative = difference(field(sum(midpoint, half)), field(difference(midpoint, half)));
        let parallel = dot(separation, relative) / norm(separation);
        BondChange { first: 0, second: 1, midpoint, distance, separation, parallel, length_change: parallel }
    };
    let bonds = distances.iter().flat_map(|&distance| vec![distance; count]).map(bond).collect();
    BondChanges { set: BondSet::Kept, bonds }
}

/// A sphere that grows: u = 3 r̂/r².
fn growth(x: Vector<3>) -> Vector<3> {
    scaled(3.0 / norm(x).powi(3), x)
}

/// A force along z on a medium with Poisson's ratio 0.3, up to its strength: u = [(3 − 4ν) z + (z·r̂) r̂]/r (Kelvin).
fn push(x: Vector<3>) -> Vector<3> {
    let r = norm(x);
    let along = scaled(x[2] / r.powi(3), x);
    sum([0.0, 0.0, 1.8 / r], along)
}

#[test]
fn a_lattice_of_spheres_has_six_contacts_to_spare() {
    let packing = lattice(1.0);
    let state = State::new(&packing, &Hertzian::default()).expect("sound spheres");
    let excess = ExcessCoordination::of(&state.network).expect("rigid");
    assert_eq!(excess, ExcessCoordination { disk_count: 256, end_count: 3072, value: 6.0 });
}

#[test]
fn a_stretch_breaks_the_contacts_that_are_not_across_it() {
    let (near, far) = (lattice(1.0), lattice(1.03));
    let law = Hertzian::default();
    let (before, after) = (State::new(&near, &law).expect("sound"), State::new(&far, &law).expect("sound"));
    // 8 of 12 neighbours are at 45° to z: their distance grows to 0.99 √(½ + ½ 1.03²) = 1.005. The other four are D + 1.
    let changes = ContactChanges::between(&before, &after, 0);
    assert_eq!((changes.kept_count, changes.made.len(), changes.broken.len()), (512, 0, 1024));
    assert_eq!(changes.broken_share(), Some(2.0 / 3.0));
    let nearest = changes.broken.iter().map(|contact| contact.distance).fold(f64::INFINITY, f64::min);
    assert!((nearest - 0.5 * SPACING).abs() < 1e-14);
    let back = ContactChanges::between(&after, &before, 0);
    assert_eq!((back.kept_count, back.made.len(), back.broken.len()), (512, 1024, 0));
}

#[test]
fn an_affine_map_stretches_every_bond_of_spheres() {
    let map = [[1e-3, 2e-3, 0.0], [0.0, -1e-3, 5e-4], [1e-3, 0.0, 2e-3]];
    let mapped = |x: Vector<3>| sum(x, map.map(|row| dot(row, x)));
    let edges = lattice(1.0);
    let open = |positions: Vec<Vector<3>>| {
        Packing::new(Domain::Open, positions, vec![0.5; edges.len()]).expect("sound spheres")
    };
    let start = open(edges.positions().to_vec());
    let end = open(edges.positions().iter().map(|&x| mapped(x)).collect());
    let law = Hertzian::default();
    let (before, after) = (State::new(&start, &law).expect("sound"), State::new(&end, &law).expect("sound"));
    let changes = BondChanges::between(&before, &after, 0, BondSet::Before);
    assert!(changes.bonds.len() > 900, "{}", changes.bonds.len());
    for bond in &changes.bonds {
        let s = bond.separation;
        // Six coordinates below 6, rounded to 9·10⁻¹⁶.
        assert!((bond.parallel - dot(s, map.map(|row| dot(row, s))) / norm(s)).abs() < 6e-15);
        assert!((bond.length_change - (norm(mapped(s)) - norm(s))).abs() < 6e-15);
    }
}

#[test]
fn bonds_around_a_growing_sphere_stretch_as_the_inverse_cube() {
    // u = A r̂/r²: the strain is A (1 − 3 r̂r̂)/r³, so a bond at φ to the radius stretches by A s (1 − 3 cos² φ)/r³. Over all
    // directions the mean is 0 and the mean square 4/5: h = A s √(4/5)/r³.
    let distances: Vec<f64> = (0..10).map(|k| 1.5 + f64::from(k)).collect();
    let changes = bonds(&distances, 4000, 1, growth);
    let rings = Fluctuations::of_bonds(&changes, BondMeasure::Parallel, 20.0, 1.0).rings;
    assert_eq!(rings.len(), 10);
    for ring in rings {
        let exact = 3.0 * 0.01 * 0.8f64.sqrt() / ring.radius.powi(3);
        // Four standard errors, and a bond of finite length: (0.005/r)² times some 10.
        assert!((ring.fluctuation - exact).abs() < 4.0 * ring.standard_error + 2e-4 * exact, "{ring:?} {exact}");
        assert!(ring.standard_error < 0.015 * exact);
    }
}

#[test]
fn bonds_around_a_pushed_sphere_stretch_as_the_inverse_square() {
    let changes = bonds(&[2.5, 5.5, 11.5], 20_000, 2, push);
    let rings = Fluctuations::of_bonds(&changes, BondMeasure::Parallel, 20.0, 1.0).rings;
    let level: Vec<f64> = rings.iter().map(|ring| ring.fluctuation * ring.radius.powi(2)).collect();
    let error: Vec<f64> = rings.iter().map(|ring| ring.standard_error * ring.radius.powi(2)).collect();
    for k in 1..3 {
        assert!((level[k] - level[0]).abs() < 4.0 * error[k].hypot(error[0]), "{level:?} {error:?}");
        assert!(error[k] < 0.01 * level[k]);
    }
}

#[test]
fn the_isostatic_length_of_spheres_has_the_tails_of_three_dimensions() {
    assert_eq!((Tail::of_held::<2>().power(), Tail::of_free::<2>().power()), (1, 2));
    assert_eq!((Tail::of_held::<3>().power(), Tail::of_free::<3>().power()), (2, 3));
    assert_eq!(IsostaticSettings::of_held::<2>(), IsostaticSettings::default());
    assert_eq!(IsostaticSettings::of_held::<3>().rule, IsostaticRule::Plateau { from: 0.4, to: 0.7, share: 0.8 });

    // h = 1 up to ℓ = 6/ΔZ and the tail of a continuum beyond: y = (h/h_0) xⁿ is level at 6ⁿ, whatever ΔZ.
    for (tail, excess) in [(Tail::InverseSquare, 0.4), (Tail::InverseCube, 0.4), (Tail::InverseCube, 0.8)] {
        let end = 6.0 / excess;
        let members = (0..400).flat_map(|k| {
            let r = 0.1 * (f64::from(k) + 0.5);
            let h = if r < end { 1.0 } else { (end / r).powi(tail.power()) };
            [(r, h), (r, -h)]
        });
        // Two values ± h have the variance 2 h².
        let fluctuations = Fluctuations::of(members, 40.0, 0.1);
        let rule = IsostaticRule::Plateau { from: 0.4, to: 0.9, share: 0.8 };
        let settings = IsostaticSettings {
            tail,
            rule,
            scale: Scale::Excess,
            normalisation: Normalisation::Length,
            ..IsostaticSettings::of_held::<3>()
        };
        let found = IsostaticLength::of(&fluctuations, Some(excess), 0.1, 40.0, &settings).expect("sound settings");
        let IsostaticOutcome::Reached { product, .. } = found.outcome else { panic!("{found:?}") };
        // y = 0.8 of the plateau at x = 6 · 0.8^(1/n); rings are 0.1 apart, where a straight line is wrong by less than
        // (0.1 ΔZ)²/4 of x.
        let exact = 6.0 * 0.8f64.powf(1.0 / f64::from(tail.power()));
        assert!((product - exact).abs() < 0.0025 * excess * excess, "{tail:?} {excess}: {product} {exact}");
    }
    let written = serde_json::to_string(&IsostaticSettings { tail: Tail::InverseCube, ..Default::default() });
    assert!(written.expect("plain data").contains("inverse_cube"));
}

#[test]
fn the_penetration_length_of_a_growing_sphere_is_that_of_its_profile() {
    // d_r = 3/r² in shells of one length: 10⁻² is passed at r = √300 = 17.32.
    let mut random = generator(4);
    let disks = (0..4000).map(|disk| {
        let distance = 1.0 + f64::from(disk / 100);
        let position = scaled(distance, direction(&mut random));
        let displacement = growth(position);
        let radial = dot(displacement, position) / distance;
        Moved { disk: disk as usize, position, distance, displacement, radial, counted: true }
    });
    let measured_on = MeasuredOn::AllDisks;
    let field = DisplacementField {
        disks: disks.collect(),
        inner_radius: 0.5,
        outer_radius: 45.0,
        shape: Shape::Round,
        measured_on,
    };
    let profile = RadialProfile::of(&field, 1.0);
    assert_eq!(profile.rings.len(), 40);
    let settings = PenetrationSettings { thresholds: vec![1e-2] };
    let found = PenetrationLength::of(&profile, &settings).expect("sound")[0].penetration.radius().expect("it falls");
    // A straight line in ln d between rings: wrong by at most y''/(8 y') = 1/(8 r).
    assert!((found - 300f64.sqrt()).abs() < 1.0 / (8.0 * 17.0), "{found}");
}
