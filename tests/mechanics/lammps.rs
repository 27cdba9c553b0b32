//! Against LAMMPS 22 Jul 2025 Update 4: forces of overlapping disks, relaxed packings, inflated packings.
//!
//! The numbers are in `fixtures/lammps` and `fixtures/packings`; LAMMPS keeps one number a coordinate, so its overlaps
//! carry the rounding of positions of order the box side L, about ulp(L).

use std::collections::{BTreeMap, BTreeSet};

use jamscope::forces::Assembly;
use jamscope::forces::damped::add_damping;
use jamscope::inflation::Circle;
use jamscope::io::read_packing;
use jamscope::law::PairLaw;
use jamscope::law::damping::{ConstantDamping, ContactDamping, DampingChoice};
use jamscope::network::ContactNetwork;
use jamscope::packing::{Domain, Packing};
use jamscope::relax::{DampedDynamics, Fire, ForceLimit, NetForce, Relaxer};
use jamscope::vector::{Vector, difference, larger, norm};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde_json::Value;

use crate::scenes::lammps_inflated::{INFLATED_RADIUS, Inflated, Table, fixture, text};
use crate::scenes::laws::{hertzian, hookean};

/// γ of the damped forces and runs \[force / velocity\].
const RATE: f64 = 500.0;

fn close(what: &str, ours: f64, theirs: f64, relative: f64) {
    println!("{what}: {ours} against {theirs}, relative difference {:.1e}", (ours / theirs - 1.0).abs());
    assert!((ours - theirs).abs() <= relative * theirs.abs(), "{what}: {ours} against {theirs}");
}

/// Largest difference of two columns of vectors over the largest vector of the second.
fn largest_difference(ours: &[Vector<2>], theirs: &[Vector<2>]) -> f64 {
    assert_eq!(ours.len(), theirs.len());
    let largest = theirs.iter().map(|&force| norm(force)).fold(0.0, larger);
    ours.iter().zip(theirs).map(|(&a, &b)| norm(difference(a, b))).fold(0.0, larger) / largest
}

fn forces_agree(name: &str, law: &dyn PairLaw) {
    // Coordinates below 16 are rounded to 1.8e-15; a separation in LAMMPS is wrong by up to twice that and a force by
    // F' ≈ 2e5 times that, 7e-10 of the largest force 1.5e4: 5e-14 a contact, and there are up to 8 of them.
    let tolerance = 1e-12;
    let table = Table::read(&format!("lammps/{name}.txt"));
    let side = table.number("L");
    let radii = table.rows.iter().map(|row| row[2]).collect();
    let packing = Packing::new(Domain::<2>::cube(side), table.columns(3), radii).expect("valid");
    let network = ContactNetwork::new(&packing, law).expect("no coincidence");

    assert_eq!(network.contacts.len() as f64, table.number("contacts"));
    close("energy", network.energy(), table.number("energy"), tolerance);
    let volume = side * side;
    close("pressure", network.pressure(volume), table.number("p"), tolerance);
    let stress = network.stress(volume);
    close("pxx", stress[0][0], table.number("pxx"), tolerance);
    close("pyy", stress[1][1], table.number("pyy"), tolerance);
    // The off-diagonal part is small by cancellation, so its rounding is relative to the pressure.
    let shear = (stress[0][1] - table.number("pxy")).abs() / table.number("p");
    assert!(shear <= tolerance, "pxy differs by {shear:e} of the pressure");
    assert_eq!(stress[0][1], stress[1][0]);
    let worst = largest_difference(network.forces(), &table.columns(5));
    println!("{name}: elastic forces differ by {worst:.1e} of the largest");
    assert!(worst <= tolerance, "elastic forces differ by {worst:e}");

    let mut assembly = Assembly::new(&packing, law).expect("no coincidence");
    assembly.forces.fill([f64::NAN; 2]);
    let totals = assembly.evaluate_totals();
    close("energy of the hot loop", totals.energy, table.number("energy"), tolerance);
    assert_eq!(totals.contact_count as f64, table.number("contacts"));
    let damping = ContactDamping::Constant(ConstantDamping { rate: RATE });
    let coefficients = vec![damping.coefficient(0.5, 0.5); assembly.pairs().place_count()];
    let velocities: Vec<Vector<2>> = table.columns(7);
    let working: Vec<Vector<2>> = assembly.order().iter().map(|&disk| velocities[disk as usize]).collect();
    let mut damped = assembly.forces.clone();
    let displacements = &assembly.displacements;
    let power = add_damping(&damping, assembly.pairs(), &coefficients, displacements, &working, &mut damped);
    let mut ours = vec![[f64::NAN; 2]; packing.len()];
    for (&disk, &force) in assembly.order().iter().zip(&damped) {
        ours[disk as usize] = force;
    }
    let worst = largest_difference(&ours, &table.columns(9));
    println!("{name}: damped forces differ by {worst:.1e} of the largest");
    assert!(worst <= tolerance, "damped forces differ by {worst:e}");
    // What the damping takes from the motion is minus its power: Σ c v_n² = −Σ f_damping·v.
    let taken: f64 = table.rows.iter().map(|row| -((row[9] - row[5]) * row[7] + (row[10] - row[6]) * row[8])).sum();
    close("dissipation", power, taken, tolerance);
}

#[test]
fn hertzian_forces_stress_and_damping_are_those_of_lammps() {
    forces_agree("forces_hertz", &hertzian());
}

#[test]
fn hookean_forces_stress_and_damping_are_those_of_lammps() {
    forces_agree("forces_hooke", &hookean());
}

fn packing_agrees(name: &str, law: &dyn PairLaw, expected: &Value) {
    let number = |key: &str| expected[key].as_f64().unwrap_or_else(|| panic!("{name} has no {key}"));
    let count = |key: &str| expected[key].as_u64().unwrap_or_else(|| panic!("{name} has no {key}")) as usize;
    let packing = read_packing::<2>(fixture(&format!("packings/{name}.xyz"))).expect("fixture is a packing");
    let network = ContactNetwork::new(&packing, law).expect("no coincidence");
    let volume = packing.domain().volume().expect("periodic");
    assert_eq!(packing.len(), count("N"), "{name}");
    // A plain sum of N areas: N roundings.
    let rounding = packing.len() as f64 * f64::EPSILON;
    close(&format!("{name} packing fraction"), packing.packing_fraction().expect("periodic"), number("phi"), rounding);
    assert_eq!(network.rattlers().count(), count("rattlers"), "{name}: rattlers");
    assert_eq!(network.backbone_contacts().count(), count("contacts_backbone"), "{name}: backbone contacts");
    if count("rattlers") == count("N") {
        // Unjammed: overlaps are of the order of the rounding of positions, 2e-12 and less, and whether a pair at 1e-15
        // touches is a matter of rounding. Forces below 1e-12 of that at an overlap of one radius count as none (k' R for
        // either law, 1e5), so the pressure is below 1e-7.
        assert!(network.pressure(volume) < 1e-7, "{name}: pressure {}", network.pressure(volume));
        assert!(
            (network.pressure(volume) - number("p")).abs() < 1e-13,
            "{name}: pressure {}",
            network.pressure(volume)
        );
        assert!((network.energy() - number("energy")).abs() < 1e-20, "{name}: energy {}", network.energy());
        assert_eq!(network.coordination(), 0.0);
        let difference = network.contacts.len().abs_diff(count("contacts"));
        println!("{name}: {} contacts against {}", network.contacts.len(), count("contacts"));
        assert!(difference <= count("contacts") / 50, "{name}: {} contacts", network.contacts.len());
        return;
    }
    // ulp(L) = 7e-15 in overlaps of 6e-6 on average (hooke p = 1) is 1e-9 a contact, of either sign; over 1900 contacts
    // the sum is good to 3e-11. All others have larger overlaps.
    close(&format!("{name} energy"), network.energy(), number("energy"), 1e-10);
    close(&format!("{name} pressure"), network.pressure(volume), number("p"), 1e-10);
    assert_eq!(network.contacts.len(), count("contacts"), "{name}: contacts");
    close(&format!("{name} Z"), network.coordination(), number("Z"), 1e-10);
    let mean = network.contacts.iter().map(|contact| contact.overlap).sum::<f64>() / network.contacts.len() as f64;
    close(&format!("{name} mean overlap"), mean, number("delta_mean"), 1e-10);
    // At rest to the rounding of coordinates: 10 k' ulp(L) = 1.4e-8 (L = 37), 2.8e-8 (L = 87).
    assert!(network.largest_net_force() < 3e-8, "{name}: net force {:e}", network.largest_net_force());
}

#[test]
fn every_packing_of_lammps_has_its_energy_pressure_contacts_and_rattlers() {
    let expected: BTreeMap<String, Value> =
        serde_json::from_str(&text("packings/expected.json")).expect("fixture is JSON");
    for (name, expected) in &expected {
        match expected["model"].as_str() {
            Some("hertz") => packing_agrees(name, &hertzian(), expected),
            Some("hooke") => packing_agrees(name, &hookean(), expected),
            other => panic!("{name}: model {other:?}"),
        }
    }
    assert_eq!(expected.len(), 16);
}

/// Disks that LAMMPS has as rattlers after the inflation.
fn rattlers_of(inflated: &Inflated) -> BTreeSet<usize> {
    (0..inflated.mobile_count).filter(|&disk| inflated.rattler[disk]).collect()
}

/// The states LAMMPS gives, evaluated as they are.
fn states_agree(name: &str, law: &dyn PairLaw) {
    let inflated = Inflated::read(name);
    let header = |keys: &[&str]| keys.iter().find_map(|key| inflated.table.find(key)).expect("one of the keys");
    let before = ContactNetwork::new(&inflated.before(0.5), law).expect("no coincidence");
    if inflated.table.find("energy_before").is_some() {
        // Coordinates of order 20 are rounded to 3.6e-15, the mean overlap is 2e-3 and more: 1e-12 a contact.
        close(&format!("{name} energy before"), before.energy(), inflated.table.number("energy_before"), 1e-11);
        close(&format!("{name} pressure before"), inflated.pressure(&before), header(&["p_circle_before"]), 1e-11);
        assert_eq!(before.contacts.len() as f64, inflated.table.number("contacts_before"), "{name}: contacts before");
    }
    let after_packing = inflated.packing(inflated.after.clone(), INFLATED_RADIUS);
    let after = ContactNetwork::new(&after_packing, law).expect("no coincidence");
    close(&format!("{name} energy after"), after.energy(), header(&["energy", "energy_md"]), 1e-11);
    close(&format!("{name} pressure after"), inflated.pressure(&after), header(&["p_circle", "p_md"]), 1e-11);
    let rattlers: BTreeSet<usize> = after.rattlers().collect();
    assert_eq!(rattlers, rattlers_of(&inflated), "{name}: rattlers after");
    if inflated.table.find("contacts").is_some() {
        assert_eq!(after.contacts.len() as f64, inflated.table.number("contacts"), "{name}: contacts after");
    }
}

#[test]
fn the_inflated_states_of_lammps_have_its_energies_circle_pressures_and_rattlers() {
    for method in ["fire", "md", "mdnet"] {
        states_agree(&format!("hertz_N1000_p800_{method}"), &hertzian());
        states_agree(&format!("hooke_N1000_p5000_{method}"), &hookean());
        states_agree(&format!("hooke_N1000_p800_{method}"), &hookean());
    }
    states_agree("hertz_N1000_p100_fire", &hertzian());
    states_agree("hertz_N1000_p10_fire", &hertzian());
    states_agree("hooke_N5548_p800_fire", &hookean());
}

/// The centre grown at once and the rest relaxed by ours; held against where LAMMPS ended.
fn relaxed_agrees(inflated: &Inflated, what: &str, packing: &Packing<2>, law: &dyn PairLaw) {
    let network = ContactNetwork::new(packing, law).expect("no coincidence");
    // LAMMPS stops at a largest force of 1e-7 (FIRE: elastic, all disks; damped dynamics: damping included), and a force f
    // displaces the softest mode by f/k. LAMMPS's own two methods are 3e-9 apart at p = 800 (header `dmax`), so k ≈ 30
    // there; at p = 10 it is p^(1/3) ≈ 4 times softer. 1e-7 means k = 1.
    let distance = inflated.distance(packing, &network);
    println!("{what}: backbone within {distance:.1e} of LAMMPS");
    assert!(distance < 1e-7, "{what}: backbone {distance:e} from LAMMPS");
    assert_eq!(network.rattlers().collect::<BTreeSet<_>>(), rattlers_of(inflated), "{what}: rattlers");
    // The energy is stationary: off by force × distance = 1e-7 · 1e-7 · 663 disks, far below its rounding.
    let energy = ["energy", "energy_md"].iter().find_map(|key| inflated.table.find(key)).expect("an energy");
    close(&format!("{what} energy"), network.energy(), energy, 1e-12);
    // The pressure is not: a contact force changes by (α − 1)/δ of itself times the change of its length, up to 2·distance.
    let mean = network.contacts.iter().map(|contact| contact.overlap).sum::<f64>() / network.contacts.len() as f64;
    let sensitivity = (law.exponent() - 1.0) / mean * 2.0 * distance;
    let pressure = ["p_circle", "p_md"].iter().find_map(|key| inflated.table.find(key)).expect("a pressure");
    close(&format!("{what} pressure"), inflated.pressure(&network), pressure, sensitivity + 1e-12);
}

fn fire(name: &str, law: &dyn PairLaw) -> Packing<2> {
    let fire = Fire { limit: ForceLimit::Relative(1e-12), ..Fire::default() };
    let start = Inflated::read(name).before(INFLATED_RADIUS);
    fire.relax(start, law, &mut ()).expect("no coincidence").converged().expect("at rest").into_inner()
}

/// Damped dynamics as LAMMPS ran it: constant γ = 500, until the largest total force on the backbone is 1e-7.
fn damped(name: &str, law: &dyn PairLaw) -> Packing<2> {
    let damped = DampedDynamics {
        damping: DampingChoice::Constant(ConstantDamping { rate: RATE }),
        limit: ForceLimit::Absolute(1e-7),
        net_force: NetForce::Total,
        step_limit: 200_000,
        ..DampedDynamics::default()
    };
    let start = Inflated::read(name).before(INFLATED_RADIUS);
    damped.relax(start, law, &mut ()).expect("no coincidence").converged().expect("at rest").into_inner()
}

/// FIRE and damped dynamics of ours against FIRE and both damped runs of LAMMPS: one minimum.
fn all_end_together(name: &str, law: &dyn PairLaw) {
    let ends = [fire(&format!("{name}_fire"), law), damped(&format!("{name}_md"), law)];
    for method in ["fire", "md", "mdnet"] {
        let inflated = Inflated::read(&format!("{name}_{method}"));
        relaxed_agrees(&inflated, &format!("FIRE, {name}_{method}"), &ends[0], law);
        relaxed_agrees(&inflated, &format!("damped, {name}_{method}"), &ends[1], law);
    }
}

#[test]
fn fire_and_damped_dynamics_end_where_those_of_lammps_do_hertzian() {
    all_end_together("hertz_N1000_p800", &hertzian());
}

#[test]
fn fire_and_damped_dynamics_end_where_those_of_lammps_do_hookean() {
    all_end_together("hooke_N1000_p5000", &hookean());
}

/// Here FIRE and damped dynamics end in two minima, in LAMMPS (header `same false`) and with ours: each method meets its
/// counterpart, and is 0.217 away from the other, as LAMMPS says (`dmax`).
#[test]
fn near_jamming_each_method_ends_in_the_minimum_it_ends_in_with_lammps() {
    let (name, law) = ("hooke_N1000_p800", hookean());
    let by_fire = fire(&format!("{name}_fire"), &law);
    let by_dynamics = damped(&format!("{name}_md"), &law);
    relaxed_agrees(&Inflated::read(&format!("{name}_fire")), "FIRE", &by_fire, &law);
    relaxed_agrees(&Inflated::read(&format!("{name}_md")), "damped", &by_dynamics, &law);
    let net = Inflated::read(&format!("{name}_mdnet"));
    relaxed_agrees(&net, "damped, mdnet", &by_dynamics, &law);
    let network = ContactNetwork::new(&by_fire, &law).expect("no coincidence");
    let apart = net.distance(&by_fire, &network);
    // Two positions known to 1e-7 each.
    assert!((apart - net.table.number("dmax")).abs() < 2e-7, "FIRE and damped dynamics are {apart} apart");
}

/// At these pressures another variant of FIRE often ends elsewhere; from these two centres ours meets LAMMPS's.
#[test]
fn fire_ends_where_that_of_lammps_does_at_lower_pressures() {
    for name in ["hertz_N1000_p100_fire", "hertz_N1000_p10_fire"] {
        let law = hertzian();
        relaxed_agrees(&Inflated::read(name), name, &fire(name, &law), &law);
    }
}

/// 4033 mobile Hookean disks at p = 811, where the inflation sets off plastic events: from the inflated start ours and
/// LAMMPS's FIRE end in two minima (0.13 apart when this was written), as two variants of FIRE do in LAMMPS itself. So what is
/// held here is that the state LAMMPS found is a minimum for us too, and which one: pushed off by up to 10⁻⁵ a coordinate,
/// far less than the mean overlap of 4·10⁻³, the disks come back to it.
#[test]
fn the_minimum_lammps_found_among_four_thousand_hookean_disks_is_one_for_ours() {
    let (name, law) = ("hooke_N5548_p800_fire", hookean());
    let inflated = Inflated::read(name);
    let mut generator = Pcg64::seed_from_u64(1);
    let mut pushed = inflated.after.clone();
    for position in &mut pushed[..inflated.mobile_count] {
        *position = position.map(|x| x + 1e-5 * (2.0 * generator.random::<f64>() - 1.0));
    }
    let fire = Fire { limit: ForceLimit::Relative(1e-12), ..Fire::default() };
    let start = inflated.packing(pushed, INFLATED_RADIUS);
    let end = fire.relax(start, &law, &mut ()).expect("no coincidence").converged().expect("at rest").into_inner();
    relaxed_agrees(&inflated, &inflated.name, &end, &law);
}

#[test]
fn the_circle_cut_from_a_packing_is_that_of_lammps() {
    let cases = ["hertz_N1000_p10", "hertz_N1000_p100", "hertz_N1000_p800", "hooke_N1000_p800", "hooke_N1000_p5000"];
    for name in cases {
        let inflated = Inflated::read(&format!("{name}_fire"));
        let packing = read_packing::<2>(fixture(&format!("packings/{name}.xyz"))).expect("fixture is a packing");
        let label = inflated.labels[inflated.mobile_count];
        let centre = packing.labels().iter().position(|&other| other == label).expect("the centre is in the packing");
        let circle = Circle::cut(&packing, centre, inflated.outer_radius).expect("a circle");
        let theirs = inflated.before(0.5);
        assert_eq!(circle.mobile_count(), inflated.mobile_count, "{name}");
        // Mobile disks and centre come in the order of the source in both.
        assert_eq!(circle.packing.labels()[..=circle.centre], theirs.labels()[..=circle.centre], "{name}");
        // Both subtract coordinates below 37: 7e-15 each, once in LAMMPS's and not in ours.
        let near = |a: Vector<2>, b: Vector<2>| norm(difference(a, b)) < 2e-14;
        for disk in 0..=circle.centre {
            assert!(near(circle.packing.positions()[disk], theirs.positions()[disk]), "{name}: disk {disk}");
            assert_eq!(circle.packing.radii()[disk], theirs.radii()[disk], "{name}: disk {disk}");
        }
        // LAMMPS's rim reaches to r_out + 3, ours to r_out + 4·0.7; up to there they are the same images.
        let rim = |packing: &Packing<2>| -> Vec<usize> {
            let (held, reach) = (packing.held(), inflated.outer_radius + 2.8 - 1e-9);
            (0..packing.len())
                .filter(|&disk| held[disk] && disk != circle.centre && norm(packing.positions()[disk]) < reach)
                .collect()
        };
        let (our_rim, their_rim) = (rim(&circle.packing), rim(&theirs));
        assert_eq!(our_rim.len(), their_rim.len(), "{name}: rim");
        for &disk in &their_rim {
            let found = our_rim.iter().filter(|&&other| {
                circle.packing.labels()[other] == theirs.labels()[disk]
                    && near(circle.packing.positions()[other], theirs.positions()[disk])
            });
            assert_eq!(found.count(), 1, "{name}: rim disk {disk}");
        }
    }
}
