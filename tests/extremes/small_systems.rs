//! Few disks, answers in closed form: chains, a ring, collisions, a square lattice at its instability, with overlaps from
//! 10⁻¹⁵ to half a radius.

use std::f64::consts::PI;

use crate::square_lattice::square_lattice;
use jamscope::forces::Assembly;
use jamscope::law::damping::{ConstantDamping, ContactDamping};
use jamscope::law::{Hertzian, Hookean, PairLaw, PowerLaw};
use jamscope::network::ContactNetwork;
use jamscope::packing::{Domain, Packing};
use jamscope::relax::{
    Criterion, Fire, ForceLimit, Motion, NonlinearConjugateGradients, Outcome, QuasiNewton, Relaxer, RelaxerChoice,
    StepBack, Stop, Uphill,
};
use jamscope::vector::{larger, norm};

/// Radii of the chains: multiples of 1/8, so that touching disks stand at exact positions.
const RADII: [f64; 7] = [0.5, 0.75, 0.5, 0.625, 1.0, 0.5, 0.75];

/// Total overlaps, from about 10⁻¹⁵ to half the smallest radius; powers of two, which round nowhere.
fn overlaps() -> impl Iterator<Item = f64> {
    [-50.0, -40.0, -26.0, -13.0, -7.0, -4.0, -2.0].into_iter().map(f64::exp2)
}

/// Overlap of every contact of disks in a row that share a total overlap: all forces are equal, F = c_j δ_j^(α−1).
fn shared(law: &dyn PairLaw, radii: &[(f64, f64)], total: f64) -> Vec<f64> {
    // δ_j ∝ c_j^(−1/(α−1)).
    let shares: Vec<f64> =
        radii.iter().map(|&(a, b)| law.coefficient(a, b).powf(-1.0 / (law.exponent() - 1.0))).collect();
    let sum: f64 = shares.iter().sum();
    shares.iter().map(|share| total * share / sum).collect()
}

/// Holds the contacts of a row at rest against the closed form.
fn check_row(law: &dyn PairLaw, outcome: Outcome<Packing<2>>, radii: &[(f64, f64)], total: f64, limit: f64) {
    assert!(
        matches!(outcome.stop, Stop::Converged(Criterion::AbsoluteForce)),
        "{law:?}, {total:e}: {:?}",
        outcome.stop
    );
    let packing = outcome.converged().expect("at rest").into_inner();
    let network = ContactNetwork::new(&packing, law).expect("no coincidence");
    let expected = shared(law, radii, total);
    assert_eq!(network.contacts.len(), radii.len());
    // Net forces below `limit` of F, so forces of the row differ by at most a limit a disk, overlaps by that over α − 1 ≥ 1;
    // the sum of all overlaps is exact to the rounding of a displacement (2⁻⁵³ of the total) a disk.
    let tolerance = (radii.len() as f64 + 1.0) * (limit + 4.0 * f64::EPSILON);
    for contact in &network.contacts {
        // Contact j joins disks j and j + 1; the last one of a ring joins the first and the last disk.
        let (first, second) = (contact.first as usize, contact.second as usize);
        let row = if second == first + 1 { first } else { second };
        let error = (contact.overlap / expected[row] - 1.0).abs();
        assert!(error <= tolerance, "{law:?}, {total:e}: overlap {row} is off by {error:e} of itself");
    }
}

/// Relaxers that know no time to this share of the force that the row will have.
fn relaxers(law: &dyn PairLaw, radii: &[(f64, f64)], total: f64, limit: f64) -> Vec<RelaxerChoice> {
    let force = law.force(law.coefficient(radii[0].0, radii[0].1), shared(law, radii, total)[0]);
    let limit = ForceLimit::Absolute(limit * force);
    let fire = Fire { limit, ..Fire::default() };
    let gradients = NonlinearConjugateGradients { limit, ..NonlinearConjugateGradients::default() };
    vec![
        RelaxerChoice::Fire(fire),
        RelaxerChoice::Fire(Fire { uphill: Uphill::StepBack(StepBack::default()), ..fire }),
        RelaxerChoice::ConjugateGradients(gradients),
        RelaxerChoice::QuasiNewton(QuasiNewton { limit, ..QuasiNewton::default() }),
        #[cfg(feature = "linear")]
        RelaxerChoice::GradientFlow(jamscope::relax::GradientFlow { limit, ..Default::default() }),
    ]
}

/// A chain on a line between two held disks, the last of them pushed in by the total overlap.
fn chain(count: usize, total: f64) -> (Packing<2>, Vec<(f64, f64)>) {
    let radii = &RADII[..count + 2];
    let mut positions = vec![[0.0, 0.0]];
    for pair in radii.windows(2) {
        let last = positions[positions.len() - 1][0];
        positions.push([last + pair[0] + pair[1], 0.0]);
    }
    let mut corrections = vec![[0.0; 2]; radii.len()];
    corrections[radii.len() - 1][0] = -total;
    let held = (0..radii.len()).map(|disk| disk == 0 || disk + 1 == radii.len()).collect();
    let packing = Packing::new(Domain::Open, positions, radii.to_vec())
        .and_then(|packing| packing.with_corrections(corrections))
        .and_then(|packing| packing.with_held(held))
        .expect("valid");
    (packing, radii.windows(2).map(|pair| (pair[0], pair[1])).collect())
}

#[test]
fn a_chain_between_held_disks_shares_the_overlap_as_its_stiffnesses_ask() {
    fn check(law: &dyn PairLaw) {
        // One disk between two held ones is the shortest chain.
        for count in [1, 2, 5] {
            for total in overlaps() {
                let (packing, radii) = chain(count, total);
                for relaxer in relaxers(law, &radii, total, 1e-12) {
                    let outcome = relaxer.relax(packing.clone(), law, &mut ()).expect("no coincidence");
                    check_row(law, outcome, &radii, total, 1e-12);
                }
            }
        }
    }
    check(&Hertzian::default());
    check(&Hookean::default());
    check(&PowerLaw { energy_scale: 1.0, exponent: 3.0 });
}

#[test]
fn three_disks_on_a_ring_press_each_other_with_one_force() {
    fn check(law: &dyn PairLaw) {
        let radii = [0.5, 0.625, 0.75];
        let pairs = [(0.5, 0.625), (0.625, 0.75), (0.75, 0.5)];
        for total in overlaps() {
            // The ring is a periodic line: 3.75 less the total overlap (two units in the last place for the smallest).
            let side = 3.75 - total;
            let domain = Domain::rectangular([0.0; 2], [side, 8.0]);
            let packing =
                Packing::new(domain, vec![[0.0, 1.0], [1.125, 1.0], [2.5, 1.0]], radii.to_vec()).expect("valid");
            for relaxer in relaxers(law, &pairs, total, 1e-12) {
                let outcome = relaxer.relax(packing.clone(), law, &mut ()).expect("no coincidence");
                check_row(law, outcome, &pairs, total, 1e-12);
            }
        }
    }
    check(&Hertzian::default());
    check(&Hookean::default());
    check(&PowerLaw { energy_scale: 1.0, exponent: 2.5 });
}

#[test]
fn a_chain_without_a_backbone_meets_a_relative_limit_too() {
    // Each disk has two contacts: none would be rigid in the plane, but the chain is at rest under forces.
    let (packing, radii) = chain(3, 0.125);
    let outcome = Fire::default().relax(packing, &Hertzian::default(), &mut ()).expect("no coincidence");
    assert_eq!(outcome.stop, Stop::Converged(Criterion::RelativeForce));
    let residual = outcome.residual;
    let force = {
        let law = Hertzian::default();
        law.force(law.coefficient(radii[0].0, radii[0].1), shared(&law, &radii, 0.125)[0])
    };
    // All contact forces are F to the limit of 10⁻⁸ a disk, and so is their mean.
    assert!((residual.mean_contact_force / force - 1.0).abs() < 5e-8, "{residual:?}");
    assert!(residual.relative() <= 1e-8 && residual.largest_net_force > 0.0, "{residual:?}");
}

#[test]
fn forces_too_small_to_count_leave_a_packing_unjammed_unless_they_are_asked_for() {
    let (packing, _) = chain(2, f64::exp2(-50.0));
    let law = Hertzian::default();
    let outcome = Fire::default().relax(packing, &law, &mut ()).expect("no coincidence");
    assert_eq!(outcome.stop, Stop::Converged(Criterion::Unjammed));
    assert_eq!(outcome.cost.step_count, 0);
}

/// Two disks of radius 1/2 that meet head on with `speed` each, and what `watch` sees after every step until they part.
fn collide(law: &dyn PairLaw, rate: f64, speed: f64, time_step: f64, mut watch: impl FnMut(f64)) -> (f64, usize) {
    // They touch at the start: the first step begins with zero overlap.
    let packing = Packing::new(Domain::<2>::Open, vec![[0.0; 2], [1.0, 0.0]], vec![0.5; 2]).expect("valid");
    let mut motion =
        Motion::new(&packing, law, &ContactDamping::Constant(ConstantDamping { rate })).expect("two disks apart");
    for (index, &disk) in motion.assembly.order().iter().enumerate() {
        motion.velocities[index] = [if disk == 0 { speed } else { -speed }, 0.0];
    }
    for step in 1.. {
        motion.step(time_step).expect("no coincidence");
        let placed = motion.assembly.placed(packing.clone());
        let overlap = 1.0 - norm(placed.separation(0, 1));
        watch(overlap);
        if overlap <= 0.0 {
            let relative = norm(motion.velocities[0]) + norm(motion.velocities[1]);
            return (relative, step);
        }
    }
    unreachable!("the loop ends when the disks part");
}

#[test]
fn a_damped_hookean_collision_has_its_coefficient_of_restitution() {
    // Relative coordinate: δ'' = −2 k δ − 2 γ δ', so δ = (v/ω) e^(−γt) sin ωt, and the disks part at ωt = π with
    // e^(−γπ/ω) of their velocity, ω² = 2k − γ².
    let (stiffness, rate, speed) = (2e5, 100.0, 1.0);
    let omega = f64::sqrt(2.0 * stiffness - rate * rate);
    let expected = (-rate * PI / omega).exp();
    let error = |steps: f64| {
        let (relative, _) = collide(&Hookean { stiffness }, rate, speed, PI / omega / steps, |_| ());
        (relative / (2.0 * speed) - expected).abs()
    };
    // The damping force begins and ends with a jump of 2 γ v, which a step of length h resolves to half of h at best: both
    // ends together leave 2 γ h e, and the second order of the smooth part is far below.
    for steps in [100.0, 1000.0, 10000.0] {
        let h = PI / omega / steps;
        assert!(error(steps) <= 2.0 * rate * h * expected, "{steps} steps: {:e}, not {:e}", error(steps), rate * h);
    }
}

#[test]
fn an_undamped_hertzian_collision_lasts_as_long_as_hertz_says() {
    // Energy: (1/4)(2v)² = (2/5) c δ^(5/2) at the turning point (reduced mass 1/2), duration 2 ∫ dδ/√… =
    // (4√π/5) Γ(2/5)/Γ(9/10) δ_max/(2v). Source: Landau & Lifshitz, Theory of Elasticity, §9, problem; Γ to 16 digits.
    let law = Hertzian::default();
    let speed = 1.0_f64;
    let deepest = (0.25 * (2.0 * speed).powi(2) * 2.5 / law.coefficient(0.5, 0.5)).powf(0.4);
    let (gamma_two_fifths, gamma_nine_tenths) = (2.218_159_543_757_688, 1.068_628_702_119_319_4);
    let duration = 0.8 * PI.sqrt() * gamma_two_fifths / gamma_nine_tenths * deepest / (2.0 * speed);
    let mut errors = Vec::new();
    for steps in [200.0, 400.0, 800.0] {
        let time_step = duration / steps;
        let mut most: f64 = 0.0;
        let (relative, count) = collide(&law, 0.0, speed, time_step, |overlap| most = larger(most, overlap));
        // The disks part within the step in which the duration ends, give or take the second order (1/steps)².
        assert!((count as f64 - steps).abs() <= 1.0, "{count} of {steps} steps");
        // The deepest overlap met lies within half a step of the turning point, where it is off by a h²/8.
        let acceleration = 2.0 * law.force(law.coefficient(0.5, 0.5), deepest);
        let allowed = acceleration * time_step * time_step / 8.0 + deepest * 20.0 / (steps * steps);
        assert!((most - deepest).abs() <= allowed, "{most}, not {deepest} ± {allowed}");
        errors.push((relative / (2.0 * speed) - 1.0).abs());
    }
    // Energy comes back to second order: forces depend on positions alone, and begin as δ^(3/2).
    for (steps, error) in [200.0f64, 400.0, 800.0].into_iter().zip(&errors) {
        assert!(*error < 10.0 / (steps * steps), "{error:e} of the velocity lost with {steps} steps");
    }
}

/// Force on a disk of the lattice above in closed form: two neighbours, each `2 height` across, 2 F(δ') 2h/r away from the row.
fn column_force(law: &dyn PairLaw, overlap: f64, height: f64) -> f64 {
    let spacing = 1.0 - overlap;
    let distance = f64::hypot(spacing, 2.0 * height);
    let closed = overlap - 4.0 * height * height / (distance + spacing);
    4.0 * law.force(law.coefficient(0.5, 0.5), closed.max(0.0)) * height / distance
}

#[test]
fn a_square_lattice_pushes_its_columns_out_as_soon_as_it_is_pressed() {
    fn check(law: &dyn PairLaw) {
        for exponent in [-46, -40, -30, -20, -10, -5, -2] {
            let overlap = f64::exp2(f64::from(exponent));
            // Small enough to keep most of the overlap, r − b = 2h²/b, and diagonal neighbours apart.
            for height in [1e-3 * overlap.sqrt(), 0.03 * overlap.sqrt()] {
                let packing = square_lattice(6, overlap, height);
                let mut assembly = Assembly::new(&packing, law).expect("no coincidence");
                assembly.evaluate();
                let expected = column_force(law, overlap, height);
                for (&disk, force) in assembly.order().iter().zip(&assembly.forces) {
                    let sign = if (disk / 6) % 2 == 0 { 1.0 } else { -1.0 };
                    // Multiples of 2⁻⁴⁶ up to 6 are exact, so overlaps are too, but for a few roundings of the forces; the
                    // two neighbours in the column push with F(δ) each, which cancels to a rounding of F(δ).
                    let column = law.force(law.coefficient(0.5, 0.5), overlap);
                    let tolerance = 16.0 * f64::EPSILON + 4.0 * f64::EPSILON * column / expected;
                    let error = (sign * force[1] / expected - 1.0).abs();
                    assert!(error <= tolerance, "{law:?}, 2^{exponent}, {height:e}: off by {error:e} of {expected:e}");
                }
            }
        }
    }
    check(&Hertzian::default());
    check(&Hookean::default());
}

#[test]
fn a_pressed_square_lattice_falls_apart_at_the_rate_of_its_softest_mode() {
    // Linear in the height: h'' = (4 F/b) h, a growing exponential; at rest at first, h₀ cosh σt.
    let (law, overlap) = (Hookean::default(), f64::exp2(-6.0));
    let (spacing, height) = (1.0 - overlap, 1e-9);
    let rate = (4.0 * law.force(law.coefficient(0.5, 0.5), overlap) / spacing).sqrt();
    let time = 3.0 / rate;
    let error = |steps: usize| {
        let packing = square_lattice(4, overlap, height);
        let mut motion = Motion::new(&packing, &law, &ContactDamping::Constant(ConstantDamping { rate: 0.0 }))
            .expect("no coincidence");
        for _ in 0..steps {
            motion.step(time / steps as f64).expect("no coincidence");
        }
        let placed = motion.assembly.placed(packing.clone());
        let moved = (placed.positions()[0][1] - packing.positions()[0][1])
            + (placed.corrections()[0][1] - packing.corrections()[0][1]);
        ((moved + height) / (height * 3.0f64.cosh()) - 1.0).abs()
    };
    let errors = [error(60), error(120), error(240)];
    for pair in errors.windows(2) {
        // Second order; next order (σh)² = 0.0025, rounding 2⁻⁵⁰ of a spacing over the height: 10⁻⁶ of the value.
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 2.0).abs() < 0.05, "order {order}, {errors:?}");
    }
}

#[test]
fn a_perfect_square_lattice_is_at_rest_and_a_disturbed_one_goes_far_down() {
    let (law, overlap) = (Hookean::default(), f64::exp2(-6.0));
    let energy = |packing: &Packing<2>| ContactNetwork::new(packing, &law).expect("no coincidence").energy();
    let perfect = square_lattice(6, overlap, 0.0);
    let lattice_energy = energy(&perfect);
    // 2 contacts a disk with k δ²/2 each; sites are exact, the sum of 72 terms rounds 72 times at most.
    let expected = 36.0 * 2.0 * 0.5 * law.stiffness * overlap * overlap;
    assert!((lattice_energy / expected - 1.0).abs() < 72.0 * f64::EPSILON, "{lattice_energy}, not {expected}");
    let outcome = Fire::default().relax(perfect, &law, &mut ()).expect("no coincidence");
    assert_eq!((outcome.stop, outcome.cost.step_count), (Stop::Converged(Criterion::RelativeForce), 0));
    // The columns move out until the rows no longer touch: the half of the energy that the rows had is gone at least.
    let disturbed = square_lattice(6, overlap, 1e-6);
    let outcome = Fire::default().relax(disturbed, &law, &mut ()).expect("no coincidence");
    assert!(matches!(outcome.stop, Stop::Converged(_)), "{:?}", outcome.stop);
    assert!(
        energy(&outcome.state) < 0.5 * lattice_energy * (1.0 + 1e-8),
        "{}",
        energy(&outcome.state) / lattice_energy
    );
}
