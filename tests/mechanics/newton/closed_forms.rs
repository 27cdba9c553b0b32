//! Few disks whose rest is known in closed form, with Newton's method and the staged relaxer.

use jamscope::forces::Assembly;
use jamscope::law::{Hookean, OnSite};
use jamscope::network::ContactNetwork;
use jamscope::packing::{Domain, Packing};
use jamscope::relax::{RelaxerChoice, Stop};
use jamscope::vector::norm;

use super::{newton, staged};
use crate::claims::closed_forms::{rests_in_the_middle, rests_under_one_force};
use crate::scenes::laws::{hertzian, hookean};
use crate::scenes::rest::{at_rest, relax};
use crate::scenes::starts::cross;

#[test]
fn a_disk_between_four_held_ones_comes_to_rest_in_their_middle() {
    for cost in rests_in_the_middle(&RelaxerChoice::Newton(newton(1e-12))) {
        assert!(cost.factorisation_count <= 8, "{cost:?}");
    }
}

#[test]
fn a_chain_without_a_backbone_comes_to_rest_under_one_force() {
    rests_under_one_force(&RelaxerChoice::Newton(newton(1e-12)));
    rests_under_one_force(&RelaxerChoice::Staged(staged(1e-12)));
}

/// A Hookean disk between four held ones, one of them grown, with a site: force along x at (x, 0), by hand.
fn push(x: f64, growth: f64, coupling: f64) -> f64 {
    let force = |overlap: f64| 2e5 * overlap.max(0.0);
    let above = (1.0 + x * x).sqrt();
    force(0.05 + growth - x) - force(0.05 + x) + 2.0 * force(1.05 - above) * x / above + coupling * x
}

fn grown_cross(growth: f64) -> Packing<2> {
    cross([0.0; 2]).with_radius(2, 0.5 + growth).expect("positive")
}

#[test]
fn a_disk_pushed_from_its_site_rests_where_contacts_hold_it_and_else_there_is_no_minimum() {
    let (growth, limit) = (0.01, 1e-12);
    // Two contacts along, two across.
    let stiffness = 2.0 * 2e5 - 2.0 * 2e5 * 0.05;
    for share in [-1.0, 0.5, 0.7] {
        let law = OnSite { law: Hookean { stiffness: 2e5 }, coupling: share * stiffness };
        let (mut low, mut high) = (0.0, 0.04);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if push(middle, growth, law.coupling) > 0.0 { low = middle } else { high = middle }
        }
        for choice in [RelaxerChoice::Newton(newton(limit)), RelaxerChoice::Staged(staged(limit))] {
            let outcome = relax(&choice, grown_cross(growth), &law);
            let mean = outcome.residual.mean_contact_force;
            let (position, rest) = at_rest(outcome).centre(0);
            let off = norm([position[0] + rest[0] - low, position[1] + rest[1]]);
            // Limit over what is left of the stiffness (its change along the way: a tenth), twice; and 4 ulp of the root.
            let allowed = 2.0 * limit * mean / ((1.0 - share) * 0.9 * stiffness) + 4.0 * f64::EPSILON * low;
            assert!(off <= allowed, "Γ = {share} K, {}: {off:e}, {allowed:e} allowed", choice.name());
        }
    }
    for share in [1.5, 10.0, 1e6] {
        let law = OnSite { law: Hookean { stiffness: 2e5 }, coupling: share * stiffness };
        for choice in [RelaxerChoice::Newton(newton(limit)), RelaxerChoice::Staged(staged(limit))] {
            let outcome = relax(&choice, grown_cross(1e-3), &law);
            assert_eq!(outcome.stop, Stop::NoMinimum, "Γ = {share} K, {}: {:?}", choice.name(), outcome.cost);
        }
    }
}

/// The stiffness of a rattler's contacts is the one that opens them in one step; Newton's own would leave a third of each
/// overlap, a residual of a fifth a step.
#[test]
fn a_rattler_is_pushed_off_in_a_step() {
    let law = hertzian();
    let mut packing = cross([0.0; 2]);
    // A fifth disk leans on the mobile one and on nothing else.
    let positions = [packing.positions(), &[[0.55f64, 0.55].map(|x| x * 0.99)]].concat();
    let radii = [packing.radii(), &[0.22786]].concat();
    let held = [packing.held(), &[false]].concat();
    packing = Packing::new(Domain::Open, positions, radii).and_then(|packing| packing.with_held(held)).expect("valid");
    let network = ContactNetwork::new(&packing, &law).expect("no coincidence");
    assert!(network.contacts.iter().any(|contact| contact.second == 5), "the disk leans on nothing");
    let outcome = relax(&newton(1e-12), packing, &law);
    println!("{:?}", outcome.cost);
    assert!(matches!(outcome.stop, Stop::Converged(_)), "{:?}", outcome.stop);
    assert!(outcome.cost.factorisation_count <= 8, "{:?}", outcome.cost);
}

/// A rattler that overlaps a held disk by 10⁻²⁰ has a 10⁹th of the stiffness of the others along its contact, and 10⁻¹⁰ of that
/// across: far below what counts as singular. It must not cost a factorisation of the disk that has to move.
#[test]
fn a_rattler_that_is_almost_free_costs_no_factorisation() {
    let law = hertzian();
    let alone = cross([0.02, -0.013]);
    let positions = [alone.positions(), &[[2.0, 0.0]]].concat();
    let radii = [alone.radii(), &[0.5]].concat();
    let held = [alone.held(), &[false]].concat();
    let leaning = Packing::new(Domain::Open, positions, radii)
        .and_then(|packing| packing.with_held(held))
        .and_then(|packing| packing.with_corrections([vec![[0.0; 2]; 5], vec![[-1e-20, 0.0]]].concat()))
        .expect("valid");
    let network = ContactNetwork::new(&leaning, &law).expect("no coincidence");
    assert!(network.contacts.iter().any(|contact| contact.second == 5 && contact.overlap > 0.0), "it leans on nothing");
    let [one, two] = [alone, leaning].map(|packing| relax(&newton(1e-12), packing, &law));
    assert!(matches!(two.stop, Stop::Converged(_)), "{:?}", two.stop);
    assert_eq!(one.cost.factorisation_count, two.cost.factorisation_count);
}

#[test]
fn assemblies_are_left_where_they_were_found_when_nothing_is_to_do() {
    let packing = cross([0.0; 2]);
    let mut assembly = Assembly::new(&packing, &hookean()).expect("no coincidence");
    assert_eq!(assembly.evaluate_totals().contact_count, 4);
    let outcome = relax(&newton(1e-8), packing.clone(), &hookean());
    assert_eq!((outcome.state, outcome.cost.factorisation_count, outcome.cost.step_count), (packing, 0, 0));
}
