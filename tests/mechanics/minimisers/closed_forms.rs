//! Few disks, and rows of springs, whose rest is known in closed form.

use jamscope::forces::Assembly;
use jamscope::law::{Hookean, OnSite};
use jamscope::packing::{Domain, Packing};
use jamscope::relax::{ForceLimit, NonlinearConjugateGradients, QuasiNewton, RelaxerChoice, Stop};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::{all, gradients, minimisers, quasi_newton};
use crate::claims::closed_forms::{rests_in_the_middle, rests_under_one_force};
use crate::scenes::rest::{at_rest, relax};
use crate::scenes::starts::cross;

#[test]
fn a_disk_between_four_held_ones_comes_to_rest_in_their_middle() {
    for choice in all(1e-12) {
        rests_in_the_middle(&choice);
    }
}

#[test]
fn a_chain_without_a_backbone_comes_to_rest_under_one_force() {
    for choice in all(1e-12) {
        rests_under_one_force(&choice);
    }
}

/// A row of Hookean disks of radius 1/2 on a line between two held ones, every one of them in contact whatever happens: springs,
/// E = (k/2) Σ (δ₀ + u_j − u_(j+1))². At rest disk j stands at j (1 − δ₀), wherever it began.
fn springs(count: usize, seed: u64) -> Packing<2> {
    let (overlap, last) = (0.125, count + 1);
    let mut generator = Pcg64::seed_from_u64(seed);
    let positions = (0..=last).map(|disk| [disk as f64 * (1.0 - overlap), 0.0]).collect();
    let off =
        |disk: usize| if disk == 0 || disk == last { 0.0 } else { 0.05 * (2.0 * generator.random::<f64>() - 1.0) };
    let corrections = (0..=last).map(off).map(|x| [x, 0.0]).collect();
    Packing::new(Domain::Open, positions, vec![0.5; count + 2])
        .and_then(|packing| packing.with_corrections(corrections))
        .and_then(|packing| packing.with_held((0..=last).map(|disk| disk == 0 || disk == last).collect()))
        .expect("valid")
}

/// On a quadratic energy and with exact searches conjugate gradients end after as many steps as there are coordinates, and so do
/// quasi-Newton methods (Nocedal, Wright (2006), theorems 5.3 and 6.4). A memory that forgets, and searches as loose as those
/// of the defaults, take more, to the same place.
#[test]
fn both_end_in_a_row_of_springs_after_as_many_steps_as_it_has_disks() {
    let (law, flatness) = (Hookean::default(), 1e-12);
    let limit = ForceLimit::Relative(1e-10);
    for count in [1, 2, 5, 10, 20, 40] {
        let exact = NonlinearConjugateGradients { limit, flatness, ..NonlinearConjugateGradients::default() };
        let remembers_all = QuasiNewton { limit, flatness, memory: count, ..QuasiNewton::default() };
        for (choice, most) in [
            (RelaxerChoice::ConjugateGradients(exact), count + 1),
            (RelaxerChoice::QuasiNewton(remembers_all), count + 1),
            (gradients(limit), 10 * count),
            (quasi_newton(limit), 10 * count),
        ] {
            let outcome = relax(&choice, springs(count, 3), &law);
            let cost = outcome.cost;
            println!("{count} springs, {}: {} steps, at most {most}", choice.name(), cost.step_count);
            assert!(cost.step_count <= most, "{count}, {}: {cost:?}", choice.name());
            let end = at_rest(outcome);
            // |u| ≤ |F|/λ_min with λ_min = 2k (1 − cos(π/(n + 1))), |F| ≤ √n of the limit on a disk, which is of k δ₀.
            let softest = 2.0 * law.stiffness * (1.0 - (std::f64::consts::PI / (count as f64 + 1.0)).cos());
            let allowed = 1e-10 * law.stiffness * 0.125 * (count as f64).sqrt() / softest;
            for disk in 1..=count {
                let off = end.positions()[disk][0] + end.corrections()[disk][0] - 0.875 * disk as f64;
                // And an ulp of the position.
                let allowed = allowed + f64::EPSILON * disk as f64;
                assert!(off.abs() <= allowed, "{count}, {}: disk {disk} is off by {off:e}", choice.name());
                assert_eq!(end.centre(disk).0[1] + end.centre(disk).1[1], 0.0);
            }
        }
    }
}

/// One Hookean disk pressed between two held ones of other radii: F = k δ is shared half and half, in one step.
#[test]
fn one_disk_between_two_walls_rests_where_both_press_alike() {
    let law = Hookean::default();
    let packing = Packing::new(Domain::<2>::Open, vec![[-1.2, 0.0], [0.0, 0.0], [1.0, 0.0]], vec![0.75, 0.5, 0.75])
        .and_then(|packing| packing.with_held(vec![true, false, true]))
        .expect("valid");
    for choice in minimisers(1e-12) {
        let outcome = relax(&choice, packing.clone(), &law);
        assert!(outcome.cost.step_count <= 3, "{}: {:?}", choice.name(), outcome.cost);
        let (position, rest) = at_rest(outcome).centre(1);
        // Overlaps of 0.05 and 0.25 become 0.15 each: the middle between the walls, to the limit and an ulp.
        assert!((position[0] + rest[0] + 0.1).abs() <= 0.15e-12 + f64::EPSILON, "{}", choice.name());
    }
}

#[test]
fn disks_that_nothing_holds_run_away_from_their_sites_and_end_without_a_minimum() {
    let stiffness = 2.0 * 2e5;
    for share in [1.5, 10.0, 1e6] {
        let law = OnSite { law: Hookean { stiffness: 2e5 }, coupling: share * stiffness };
        let grown = cross([0.0; 2]).with_radius(2, 0.501).expect("positive");
        for choice in all(1e-12) {
            let outcome = relax(&choice, grown.clone(), &law);
            assert_eq!(outcome.stop, Stop::NoMinimum, "Γ = {share} K, {}: {:?}", choice.name(), outcome.cost);
        }
    }
}

#[test]
fn a_state_at_rest_is_left_as_it_was_found() {
    let packing = cross([0.0; 2]);
    let mut assembly = Assembly::new(&packing, &Hookean::default()).expect("no coincidence");
    assert_eq!(assembly.evaluate_totals().contact_count, 4);
    for choice in all(1e-8) {
        let outcome = relax(&choice, packing.clone(), &Hookean::default());
        assert_eq!((outcome.state, outcome.cost.step_count), (packing.clone(), 0), "{}", choice.name());
    }
}
