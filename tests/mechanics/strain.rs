//! Quasistatic shear: lattices in closed form, the first slope against the moduli, dissipation in events, resumption.

use crate::scenes::laws::hertzian;
use jamscope::law::{Hookean, PairLaw};
use jamscope::linear::{ElasticModuli, Prestress};
use jamscope::network::ContactNetwork;
use jamscope::packing::{Domain, Mixture, Packing};
use jamscope::preparation::{Preparation, Target, prepare_with};
use jamscope::relax::{Fire, ForceLimit};
use jamscope::strain::{QuasistaticShear, ShearSettings, ShearState, StrainError};
use jamscope::vector::{larger, norm};

fn fire(limit: f64) -> Fire {
    Fire { limit: ForceLimit::Relative(limit), ..Fire::default() }
}

fn sheared(
    packing: Packing<2>,
    settings: ShearSettings,
    law: &dyn PairLaw,
    limit: f64,
) -> (Vec<ShearState>, Packing<2>) {
    let mut shear = QuasistaticShear::new(packing, settings, law).expect("a box");
    let mut states = Vec::new();
    while let Some(state) = shear.advance(&fire(limit), &mut ()).expect("at rest") {
        states.push(state);
    }
    (states, shear.packing().clone())
}

fn dense(disk_count: usize, packing_fraction: f64, seed: u64) -> Packing<2> {
    let target = Target::PackingFraction(packing_fraction);
    let preparation = Preparation {
        disk_count,
        mixture: Mixture::default(),
        target,
        tolerance: 0.01,
        seed,
        ..Preparation::default()
    };
    prepare_with::<2>(&preparation, &hertzian(), &fire(1e-12), &mut ()).expect("at rest").packing.into_inner()
}

/// A lattice with one disk a cell follows the shear as a whole, so the energy is a sum over lattice vectors:
///
/// ```text
/// E/N = ½ Σ u(|m a + n b(γ)|)        σ_xy = dE/dγ / V = −½ (N/V) Σ F x y / r
/// ```
///
/// After γ = a / h each row has passed one site of the row below: the lattice is the first one again. Between, contacts
/// are made and broken. Hookean springs at rest lengths: forces are exact to the rounding of coordinates up to 20.
#[test]
fn a_lattice_follows_its_closed_form_through_a_whole_period() {
    let (apart, law) = (0.95, Hookean { stiffness: 1.0 });
    let height = 0.75f64.sqrt() * apart;
    let (columns, rows) = (8, 6);
    let positions = (0..columns * rows).map(|site| {
        let (row, column) = ((site / columns) as f64, (site % columns) as f64);
        [column * apart + 0.5 * row * apart, row * height]
    });
    let edges = [[columns as f64 * apart, 0.0], [0.5 * rows as f64 * apart, rows as f64 * height]];
    let domain = Domain::Periodic { corner: [0.0; 2], edges };
    let packing = Packing::new(domain, positions.collect(), vec![0.5; columns * rows]).expect("a lattice");
    let (volume, count) = (edges[0][0] * edges[1][1], (columns * rows) as f64);
    // A share of a period that is not a multiple of the symmetry, so no contact is at zero overlap.
    let settings = ShearSettings { strain: apart / height, step_count: 23 };
    let (states, last) = sheared(packing.clone(), settings, &law, 1e-8);
    assert_eq!(states.len(), 24);
    let mut changes = 0;
    for state in &states {
        let (mut energy, mut stress, mut contacts) = (0.0, 0.0, 0usize);
        for m in -3..=3 {
            for n in -2..=2 {
                let y = f64::from(n) * height;
                let vector = [f64::from(m) * apart + 0.5 * f64::from(n) * apart + state.strain * y, y];
                let distance = norm(vector);
                if (m, n) != (0, 0) && distance < 1.0 {
                    let force = law.force(law.coefficient(0.5, 0.5), 1.0 - distance);
                    energy += 0.5 * count * law.energy(force, 1.0 - distance);
                    stress -= 0.5 * count / volume * force * vector[0] * vector[1] / distance;
                    contacts += 1;
                }
            }
        }
        // Overlaps of 0.05 from coordinates rounded to 4e-15, many of them, and steps of a shear that add up their rounding.
        assert!((state.energy / energy - 1.0).abs() < 1e-12, "{}: {} and {energy}", state.strain, state.energy);
        assert!((state.shear_stress - stress).abs() < 1e-13, "{}: {} and {stress}", state.strain, state.shear_stress);
        assert_eq!(2 * state.contact_count, contacts * columns * rows, "{}", state.strain);
        assert!(state.non_affine < 1e-13);
        changes += state.made_count + state.broken_count;
    }
    assert!(changes > 0, "rows pass each other");
    // One side more of tilt for six rows: the box is another one of the same lattice.
    let first = ContactNetwork::new(&packing, &law).expect("apart");
    let after = ContactNetwork::new(&last, &law).expect("apart");
    assert!((after.energy() / first.energy() - 1.0).abs() < 1e-12);
}

/// The slope at small strain is that of the stress under r_x → r_x + γ r_y: B_xyxy and the turn of the stress at rest.
#[test]
fn the_first_slope_is_that_of_the_elastic_moduli() {
    let law = hertzian();
    for seed in [1, 2, 3] {
        let packing = dense(100, 0.92, seed);
        let moduli = ElasticModuli::of(&packing, &law, Prestress::Included).expect("rigid");
        let stress = moduli.relaxed.stress;
        let slope = moduli.relaxed.stress_slopes()[0][1][0][1] + 0.5 * (stress[0][0] - stress[1][1]);
        let strain = 1e-7;
        for signed in [strain, -strain] {
            let (states, _) = sheared(packing.clone(), ShearSettings { strain: signed, step_count: 1 }, &law, 1e-12);
            let found = (states[1].shear_stress - states[0].shear_stress) / signed;
            // Curvature: strain over the overlaps of 0.03 (1e-3 for the least) gives 1e-4; residual 1e-12 over strain 1e-5.
            assert!((found / slope - 1.0).abs() < 1e-3, "seed {seed}: {found} and {slope}");
            assert_eq!((states[1].made_count, states[1].broken_count), (0, 0), "seed {seed}");
        }
    }
}

/// Work is energy gained plus energy dissipated. Without an event the dissipated energy is the error of the trapezium, of
/// third order in the step; events dissipate.
#[test]
fn events_dissipate_and_elastic_steps_do_not() {
    let law = hertzian();
    let packing = dense(100, 0.87, 5);
    let (states, last) = sheared(packing.clone(), ShearSettings { strain: 0.15, step_count: 300 }, &law, 1e-10);
    let energies = states.iter().map(|state| state.energy).fold(0.0, larger);
    let mut event_count = 0;
    for state in &states[1..] {
        if state.is_event && state.dissipated > 1e-3 * energies {
            event_count += 1;
            assert!(state.non_affine > 0.0);
        }
        // The trapezium may err either way, a fall into another minimum only one.
        assert!(state.dissipated > -1e-4 * energies, "step {}: {}", state.step, state.dissipated);
    }
    assert!(event_count >= 3, "{event_count} events up to a strain of 0.15, far beyond yielding");
    let [[_, _], [tilt, height]] = last.domain().edges().expect("a box");
    assert!((tilt / height - 0.15).abs() < 1e-13);
    // A step back and forth within the elastic range ends where it began.
    let small = 1e-6;
    let there = sheared(packing.clone(), ShearSettings { strain: small, step_count: 2 }, &law, 1e-12);
    let back = sheared(there.1, ShearSettings { strain: -small, step_count: 2 }, &law, 1e-12);
    let (start, end) = (there.0[0], back.0[2]);
    assert!((end.energy / start.energy - 1.0).abs() < 1e-10, "{} and {}", end.energy, start.energy);
}

#[test]
fn a_resumed_shear_has_the_bits_of_the_whole_one() {
    let law = hertzian();
    let settings = ShearSettings { strain: -0.02, step_count: 10 };
    let mut whole = QuasistaticShear::new(dense(60, 0.88, 2), settings, &law).expect("a box");
    let mut halves = Vec::new();
    for step in 0..=10 {
        let state = whole.advance(&fire(1e-8), &mut ()).expect("at rest").expect("a step");
        assert_eq!(state.step, step);
        halves.push((state, whole.packing().clone()));
    }
    assert_eq!(whole.advance(&fire(1e-8), &mut ()), Ok(None));
    let mut resumed = QuasistaticShear::resumed(halves[4].1.clone(), 4, settings, &law).expect("a box");
    for (state, packing) in &halves[5..] {
        assert_eq!(resumed.advance(&fire(1e-8), &mut ()).expect("at rest").as_ref(), Some(state));
        assert_eq!(resumed.packing(), packing);
    }
}

#[test]
fn what_cannot_be_sheared_is_named() {
    let of = |packing: Packing<2>, strain, step_count| {
        QuasistaticShear::new(packing, ShearSettings { strain, step_count }, &hertzian()).err()
    };
    let open = Packing::new(Domain::Open, vec![[0.0, 0.0], [0.9, 0.0]], vec![0.5; 2]).expect("valid");
    let boxed = Packing::new(Domain::cube(9.0), vec![[0.0, 0.0], [0.9, 0.0]], vec![0.5; 2]).expect("valid");
    assert_eq!(of(open, 0.1, 1), Some(StrainError::NotPeriodic));
    assert_eq!(of(boxed.clone(), 0.0, 1), Some(StrainError::StrainNotPossible { strain: 0.0 }));
    assert!(matches!(of(boxed.clone(), f64::NAN, 1), Some(StrainError::StrainNotPossible { .. })));
    assert_eq!(of(boxed, 0.1, 0), Some(StrainError::NoStep));
}
