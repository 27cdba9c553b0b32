//! Forces against differences of the energy, the virial against a stretched box, Newton's third law.

use super::*;

/// Bound on the error of a central difference over ±s of u(|r + s e|), e a unit vector.
///
/// Away from contact, s²/6 times the third derivative, |u'''| + 3|u''|/r + 3|u'|/r², taken at the ends of the interval.
/// Within s of contact u'' = F' is only Hölder continuous (for α < 3; it jumps for α = 2): F differs from its tangent by
/// at most its growth over the interval.
fn difference_error(law: &dyn PairLaw, coefficient: f64, overlap: f64, distance: f64, s: f64) -> f64 {
    if overlap < -s {
        return 0.0;
    }
    let alpha = law.exponent();
    let ends = [overlap - s, overlap + s].map(|overlap| overlap.max(0.0));
    let force = law.force(coefficient, ends[1]);
    let stiffness = law.stiffness(force, ends[1]);
    let near = distance - s;
    let geometry = s * s / 6.0 * (3.0 * stiffness / near + 3.0 * force / (near * near));
    if overlap > 2.0 * s {
        let third = |overlap: f64| (alpha - 2.0) * law.stiffness(law.force(coefficient, overlap), overlap) / overlap;
        geometry + s * s / 6.0 * third(ends[0]).max(third(ends[1]))
    } else {
        geometry + law.force(coefficient, overlap.max(0.0) + s) - law.force(coefficient, 0.0)
    }
}

/// What a central difference of the energy may be off by: truncation of each pair; over h, the rounding of the energy and
/// that of the separations, `blur`.
pub(super) fn slope_error<const D: usize>(
    packing: &Packing<D>,
    law: &dyn PairLaw,
    h: f64,
    blur: f64,
    speed: impl Fn(&all_pairs::Pair<D>) -> f64,
) -> f64 {
    let pairs = pairs_within(packing, 0.1);
    let mut error = 0.0;
    let mut energy = 0.0;
    for pair in &pairs {
        let coefficient = law.coefficient(packing.radii()[pair.first], packing.radii()[pair.second]);
        let speed = speed(pair);
        error += speed * difference_error(law, coefficient, pair.overlap, pair.distance, h * speed);
        let overlap = pair.overlap.max(0.0) + h * speed;
        let force = law.force(coefficient, overlap);
        energy += law.energy(force, overlap);
        error += force * blur / h;
    }
    error + (pairs.len() + 16) as f64 * EPSILON * energy / h
}

/// Step of the differences: rounding ε/h and truncation h^1.5 to h² are both near 1e-9 of what is differentiated.
pub(super) const STEP: f64 = 1.0 / 65536.0;

/// ∂E/∂r_d of a disk in working order, by a central difference over 2 [`STEP`].
pub(super) fn energy_slope<const D: usize>(assembly: &mut Assembly<D>, index: usize, d: usize) -> f64 {
    let mut energy_at = |h: f64| {
        let before = assembly.displacements[index];
        assembly.displacements[index][d] += h;
        let energy = assembly.evaluate_totals().energy;
        assembly.displacements[index] = before;
        energy
    };
    (energy_at(STEP) - energy_at(-STEP)) / (2.0 * STEP)
}

fn check_gradient<const D: usize>(law: &dyn PairLaw, seed: u64, count: usize, domain: Domain<D>) {
    let packing = disks(seed, count, domain, 0.2);
    let mut assembly = Assembly::new(&packing, law).expect("no coincidence");
    assembly.evaluate();
    let forces = assembly.forces.clone();
    for index in 0..assembly.mobile_count() {
        let disk = assembly.order()[index] as usize;
        let touches = |pair: &all_pairs::Pair<D>| if pair.first == disk || pair.second == disk { 1.0 } else { 0.0 };
        let allowed = slope_error(&packing, law, STEP, 4.0 * EPSILON, touches);
        for d in 0..D {
            let slope = energy_slope(&mut assembly, index, d);
            let off = (forces[index][d] + slope).abs();
            assert!(
                off <= allowed,
                "{law:?}, disk {disk}, axis {d}: force {} and slope {slope}, {off:e} > {allowed:e}",
                forces[index][d]
            );
        }
    }
}

/// Deforming the box with the positions, r_a → r_a + h r_b: dE/dh = −virial_ab, radii kept.
fn check_virial<const D: usize>(law: &dyn PairLaw, seed: u64, count: usize, domain: Domain<D>) {
    let packing = disks(seed, count, domain, 0.0);
    let (_, totals) = forces_of(&packing, law);
    // Edges remain triangular for a ≤ b.
    for (a, b) in (0..D).flat_map(|b| (0..=b).map(move |a| (a, b))) {
        let deformed = |h: f64| {
            let Domain::Periodic { mut corner, mut edges } = *packing.domain() else { panic!("made periodic") };
            let mut positions = packing.positions().to_vec();
            edges.iter_mut().chain([&mut corner]).chain(&mut positions).for_each(|vector| vector[a] += h * vector[b]);
            let packing = Packing::new(Domain::Periodic { corner, edges }, positions, packing.radii().to_vec());
            forces_of(&packing.expect("valid"), law).1.energy
        };
        let slope = (deformed(STEP) - deformed(-STEP)) / (2.0 * STEP);
        let off = (slope + totals.virial[a][b]).abs();
        // The deformed coordinates are rounded.
        let allowed = slope_error(&packing, law, STEP, blur(&packing), |pair| pair.separation[b].abs());
        assert!(
            off <= allowed,
            "{law:?}, axes {a} {b}: virial {} and slope {slope}, {off:e} > {allowed:e}",
            totals.virial[a][b]
        );
    }
    let volume = packing.domain().volume().expect("periodic");
    let network = ContactNetwork::new(&packing, law).expect("no coincidence");
    let expected = totals.virial_trace() / (D as f64 * volume);
    // Two sums of the same positive terms.
    assert!((network.pressure(volume) - expected).abs() <= (16 + network.contacts.len()) as f64 * EPSILON * expected);
}

proptest! {
    #![proptest_config(cases(32))]

    #[test]
    fn force_is_minus_the_energy_gradient(seed: u64, exponent in 2.0..4.0f64, flat in domains::<2>(), deep in domains::<3>()) {
        check_gradient(&Hertzian { stiffness: 1.0 }, seed, 24, flat);
        check_gradient(&Hookean { stiffness: 1.0 }, seed, 24, flat);
        check_gradient(&PowerLaw { energy_scale: 1.0, exponent }, seed, 24, flat);
        check_gradient(&Hertzian { stiffness: 1.0 }, seed, 24, deep);
        check_gradient(&Hookean { stiffness: 1.0 }, seed, 24, deep);
        check_gradient(&PowerLaw { energy_scale: 1.0, exponent }, seed, 24, deep);
    }

    #[test]
    fn virial_is_minus_the_energy_change_when_the_box_is_deformed(seed: u64, exponent in 2.0..4.0f64, x in 1.1..3.0f64, y in 1.1..3.0f64, z in 1.1..2.0f64, tilts in [-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64]) {
        let (flat, deep) = (tilted([x, y].map(on_grid), tilts), tilted([x, y, z].map(on_grid), tilts));
        check_virial(&Hertzian { stiffness: 1.0 }, seed, 24, periodic([x, y].map(on_grid)));
        check_virial(&Hertzian { stiffness: 1.0 }, seed, 24, flat);
        check_virial(&Hookean { stiffness: 1.0 }, seed, 24, flat);
        check_virial(&PowerLaw { energy_scale: 1.0, exponent }, seed, 24, flat);
        check_virial(&Hertzian { stiffness: 1.0 }, seed, 24, deep);
    }

    #[test]
    fn forces_of_a_packing_without_held_disks_add_up_to_nothing(seed: u64, count in 2usize..80, domain in domains::<2>()) {
        let packing = disks(seed, count, domain, 0.0);
        let (forces, totals) = forces_of(&packing, &Hertzian::default());
        let net = forces.iter().fold([0.0; 2], |total, &force| sum(total, force));
        // Each contact adds and takes the same number, exactly; what remains is the rounding of the sums: at most one
        // rounding of a partial sum below ΣF for every contact and disk.
        let roundings = (2 * totals.contact_count + count) as f64;
        prop_assert!(norm(net) <= roundings * EPSILON * totals.force_sum, "{net:?}, ΣF {}", totals.force_sum);
    }

    #[test]
    fn two_disks_push_each_other_with_opposite_forces_to_the_last_bit(x in 0.01..0.7f64, y in 0.01..0.7f64, z in 0.01..0.7f64) {
        let packing = Packing::new(Domain::<3>::cube(8.0), vec![[7.9, 0.1, 4.0], [(7.9 + x) % 8.0, 0.1 + y, 4.0 + z]], vec![0.7, 0.8]);
        let (forces, totals) = forces_of(&packing.expect("valid"), &Hertzian::default());
        prop_assert_eq!(totals.contact_count, 1);
        prop_assert_eq!(forces[0], forces[1].map(|component| -component));
        // Along the line of centres, pushing apart.
        prop_assert!(forces[1][0] > 0.0 && forces[1][1] > 0.0 && forces[1][2] > 0.0);
    }
}

/// ζ = c/(2 √(k m)) of the oscillator that a contact is, with stiffness and damping from the laws.
#[test]
fn the_damping_ratio_is_that_of_an_oscillator_with_the_stiffness_and_damping_of_the_contact() {
    use jamscope::law::damping::{ConstantDamping, DampingChoice, REDUCED_MASS, ViscoelasticDamping, effective_radius};
    let (law, radii, overlap) = (Hertzian { stiffness: 3e4 }, (0.5, 0.7), 4e-3);
    for damping in [
        DampingChoice::Constant(ConstantDamping { rate: 70.0 }),
        DampingChoice::Viscoelastic(ViscoelasticDamping { rate: 70.0 }),
    ] {
        let contact = law.contact_damping(&damping);
        let resistance = contact.damping(contact.coefficient(radii.0, radii.1), overlap);
        let stiffness = law.stiffness(law.force(law.coefficient(radii.0, radii.1), overlap), overlap);
        let expected = resistance / (2.0 * (stiffness * REDUCED_MASS).sqrt());
        let found = damping.hertzian_damping_ratio(3e4, effective_radius(radii.0, radii.1), overlap);
        // A dozen products and roots.
        assert!((found / expected - 1.0).abs() < 1e-14, "{found} {expected}");
    }
}
