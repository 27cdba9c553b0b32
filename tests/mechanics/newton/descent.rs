//! The way down: the energy only falls, the residual is squared, saddles are left, units do not matter.
//!
//! Random cases come from proptest, with the seeds of `scenes::seeds`.

use jamscope::law::PairLaw;
use jamscope::network::ContactNetwork;
use jamscope::packing::Packing;
use jamscope::relax::{Check, Newton, Relaxer, RelaxerChoice, Stop};
use jamscope::vector::{Vector, difference, dot, larger, norm, scaled, sum};
use proptest::prelude::*;

use super::{fire, newton, staged};
use crate::claims::only_falls::only_falls;
use crate::claims::other_units::same_bits_in_other_units;
use crate::scenes::laws::{hertzian, hookean};
use crate::scenes::rest::{at_rest, moved, relax};
use crate::scenes::seeds::config;
use crate::scenes::square_lattice::square_lattice;
use crate::scenes::starts::{inflated, points, shaken};

/// What the second derivatives of the contact forces make of a step s: |D²f[s, s]| ≤ F'' s_n² + 2 (F'/r + F/r²) s² a contact, half of it
/// for each disk. F = F' δ/(α − 1) gives F'' = F' (α − 2)/δ.
fn remainders(network: &ContactNetwork<2>, law: &dyn PairLaw, step: &[Vector<2>]) -> Vec<f64> {
    let mut rows = vec![0.0; step.len()];
    for contact in &network.contacts {
        let (first, second) = (contact.first as usize, contact.second as usize);
        let (s, r) = (difference(step[first], step[second]), norm(contact.separation));
        let along = dot(s, contact.separation) / r;
        let stiffness = law.stiffness(contact.force, contact.overlap);
        let curvature = stiffness * (law.exponent() - 2.0) / contact.overlap;
        let half = 0.5 * (curvature * along * along + 2.0 * (stiffness + contact.force / r) / r * dot(s, s));
        rows[first] += half;
        rows[second] += half;
    }
    rows
}

/// A whole Newton step, K s = f, leaves of the forces what Taylor leaves: f(x + s) = ½ D²f[s, s] somewhere on the way, the square of
/// what was to be gone. States after 0, 1, 2, … steps are held against that, disk by disk.
#[test]
fn the_residual_is_squared_at_each_step_near_a_minimum() {
    let law = hertzian();
    let minimum = at_rest(relax(&staged(1e-13), inflated("hertz_N1000_p800", 1), &law));
    let network = ContactNetwork::new(&minimum, &law).expect("no coincidence");
    let least = network.backbone_contacts().map(|contact| contact.overlap).fold(f64::INFINITY, f64::min);
    // Moved by so much less than the smallest overlap that no contact of the backbone opens. F'' falls with the overlap, which goes
    // evenly from one end of a step to the other (to s²/r): the larger of the remainders at its ends is not exceeded between.
    let start = shaken(&minimum, 0.1 * least, 2);
    let states: Vec<Packing<2>> =
        (0..=5).map(|step_limit| relax(&Newton { step_limit, ..newton(1e-13) }, start.clone(), &law).state).collect();
    let mut residuals = Vec::new();
    for pair in states.windows(2) {
        let (before, after) = (&pair[0], &pair[1]);
        let [old, new] = [before, after].map(|state| ContactNetwork::new(state, &law).expect("no coincidence"));
        assert_eq!(old.backbone, network.backbone);
        let step: Vec<Vector<2>> = (0..after.len()).map(|disk| moved(after, before, disk)).collect();
        let [one, two] = [&old, &new].map(|network| remainders(network, &law, &step));
        let allowed: Vec<f64> = one.iter().zip(&two).map(|(one, two)| larger(*one, *two)).collect();
        // Disks that touch one off the backbone are left out: there the stiffness is the secant one.
        let mut counts: Vec<bool> =
            (0..after.len()).map(|disk| network.backbone[disk] && !after.held()[disk]).collect();
        for contact in old.contacts.iter().chain(&new.contacts) {
            for (disk, other) in [(contact.first, contact.second), (contact.second, contact.first)] {
                counts[disk as usize] &= network.backbone[other as usize];
            }
        }
        // Beside that 10⁻¹⁰ of the row times the step (the ground every disk stands on), and rounding.
        let mean = new.mean_contact_force();
        let stiffest =
            old.contacts.iter().map(|contact| law.stiffness(contact.force, contact.overlap)).fold(0.0, larger);
        let longest = step.iter().map(|&s| norm(s)).fold(0.0, larger);
        let beside = 1e-10 * 12.0 * stiffest * longest + 1e-13 * mean;
        let largest = |network: &ContactNetwork<2>| -> f64 {
            let forces = (0..after.len()).filter(|&disk| counts[disk]).map(|disk| norm(network.forces()[disk]));
            forces.fold(0.0, larger) / mean
        };
        assert!(counts.iter().filter(|&&counted| counted).count() > 500);
        for disk in (0..after.len()).filter(|&disk| counts[disk]) {
            let force = norm(new.forces()[disk]);
            let most = 1.01 * allowed[disk] + beside;
            assert!(force <= most, "disk {disk}: {force:e} left, {most:e} allowed, {residuals:?}");
        }
        residuals.push(largest(&old));
        println!("{:e} to {:e}", largest(&old), largest(&new));
    }
    assert!(residuals[0] > 1e-5 && residuals[1] > 1e-12 && residuals[4] <= 1e-13, "{residuals:?}");
}

/// Near jamming contacts close on the way of a whole step and make it climb (the energy would rise by 30 times what the forces
/// promise of a fall): not a look may show that.
#[test]
fn the_energy_falls_where_contacts_that_close_make_the_whole_step_climb() {
    fn check(law: &dyn PairLaw, name: &str) {
        let near = at_rest(relax(&fire(1e-4), inflated(name, 0), law));
        let mut checks = Vec::new();
        let settings = Newton { step_limit: 40, ..newton(1e-12) };
        let _ = settings.relax(near, law, &mut |check: &Check| checks.push(*check)).expect("no coincidence");
        only_falls(&checks, 1.0, &format!("{law:?}"));
    }
    check(&hookean(), "hooke_N1000_p100");
    check(&hookean(), "hooke_N1000_p10");
    check(&hertzian(), "hertz_N1000_p1");
}

proptest! {
    #![proptest_config(config(12, 20))]

    #[test]
    fn the_energy_of_newton_never_increases(seed in 0..1000u64, fraction in 0.8..1.3f64, law in 0..3usize) {
        fn check<const D: usize>(packing: Packing<D>, law: &dyn PairLaw) {
            let settings = Newton { step_limit: 60, ..newton(1e-10) };
            let mut checks = Vec::new();
            let _ = settings.relax(packing, law, &mut |check: &Check| checks.push(*check)).expect("no coincidence");
            only_falls(&checks, 1.0, &format!("{law:?}"));
        }
        match law {
            0 => check(points::<2>(100, fraction, seed), &hertzian()),
            1 => check(points::<2>(100, fraction, seed), &hookean()),
            _ => check(points::<3>(60, fraction, seed), &hertzian()),
        }
    }
}

#[test]
fn a_saddle_is_left_downhill() {
    fn check(law: &dyn PairLaw) {
        let energy = |packing: &Packing<2>| ContactNetwork::new(packing, law).expect("no coincidence").energy();
        let lattice_energy = energy(&square_lattice(6, f64::exp2(-6.0), 0.0));
        // The columns move out until the rows no longer touch: the half of the energy that the rows had is gone at least.
        for height in [1e-3, 1e-6] {
            for choice in [RelaxerChoice::Newton(newton(1e-10)), RelaxerChoice::Staged(staged(1e-10))] {
                let outcome = relax(&choice, square_lattice(6, f64::exp2(-6.0), height), law);
                let share = energy(&outcome.state) / lattice_energy;
                println!("{law:?} {height:e} {}: {:?}, {:?}, {share}", choice.name(), outcome.stop, outcome.cost);
                assert!(matches!(outcome.stop, Stop::Converged(_)), "{}: {:?}", choice.name(), outcome.stop);
                assert!(share < 0.5 * (1.0 + 1e-8), "{}: {share}", choice.name());
            }
        }
    }
    check(&hookean());
    check(&hertzian());
}

#[test]
fn a_relaxation_in_other_units_takes_the_same_steps_to_the_same_bits() {
    for choice in [RelaxerChoice::Newton(newton(1e-12)), RelaxerChoice::Staged(staged(1e-12))] {
        for cost in same_bits_in_other_units(&choice) {
            assert!(cost.factorisation_count > 1, "{}: {cost:?}", choice.name());
        }
    }
}

/// Nothing holds a periodic packing: forces add up to nothing, and so must steps.
#[test]
fn the_centre_of_mass_of_a_periodic_packing_stays() {
    let (law, start) = (hertzian(), points::<2>(200, 0.95, 4));
    let near = at_rest(relax(&fire(1e-3), start, &law));
    let end = at_rest(relax(&newton(1e-12), near.clone(), &law));
    let (mut mean, mut way) = ([0.0; 2], 0.0);
    for disk in 0..near.len() {
        let moved = moved(&end, &near, disk);
        mean = sum(mean, scaled(1.0 / near.len() as f64, moved));
        way += norm(moved) / near.len() as f64;
    }
    // Each step rounds each displacement once; fewer than 100 steps.
    assert!(way > 1e-6 && norm(mean) <= 100.0 * f64::EPSILON * way.max(1e-3), "{mean:?} of {way:e}");
}
