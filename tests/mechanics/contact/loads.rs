//! Contacts, sites and loads together: forces against the energy, forces and torques that add up to those from outside.

use super::derivatives::{STEP, energy_slope, slope_error};
use super::*;
use jamscope::law::OnSite;
use jamscope::vector::dot;

/// Random disks with a random load each, and sites up to 0.2 away along each axis.
fn loaded<const D: usize>(seed: u64, count: usize, domain: Domain<D>, held_share: f64) -> Packing<D> {
    let packing = disks(seed, count, domain, held_share);
    let mut generator = Pcg64::seed_from_u64(seed ^ 2);
    let mut vector = |length: f64| -> Vector<D> {
        std::array::from_fn(|_| on_grid(length * (2.0 * generator.random::<f64>() - 1.0)))
    };
    let loads = (0..count).map(|_| vector(0.3)).collect();
    let sites = packing.positions().iter().map(|&position| (sum(position, vector(0.2)), [0.0; D])).collect();
    packing.with_sites(sites).and_then(|packing| packing.with_loads(loads)).expect("finite")
}

/// Σ (|Γ| u²/2 + |f·u|) over the mobile disks, by hand: what the energy of sites and loads is rounded by.
fn on_site<const D: usize>(packing: &Packing<D>, coupling: f64) -> (f64, f64) {
    let (sites, loads) = (packing.sites().expect("given"), packing.loads().expect("given"));
    let (mut energy, mut scale) = (0.0, 0.0);
    for disk in (0..packing.len()).filter(|&disk| !packing.held()[disk]) {
        let away = difference(packing.positions()[disk], sites[disk].0);
        let (spring, work) = (-0.5 * coupling * dot(away, away), -dot(loads[disk], away));
        energy += spring + work;
        scale += spring.abs() + loads[disk].iter().zip(away).map(|(f, u)| (f * u).abs()).sum::<f64>();
    }
    (energy, scale)
}

fn check_gradient<const D: usize>(contacts: &dyn PairLaw, coupling: f64, packing: &Packing<D>) {
    let mut assembly = Assembly::new(packing, contacts).expect("no coincidence");
    let totals = assembly.evaluate_totals();
    let forces = assembly.forces.clone();
    let (energy, scale) = on_site(packing, coupling);
    // Sums of a few products a disk.
    let sum_rounding = (8 * D + packing.len()) as f64 * EPSILON;
    assert!(
        (totals.on_site_energy - energy).abs() <= sum_rounding * scale,
        "{contacts:?}: {} {energy}",
        totals.on_site_energy
    );
    for index in 0..assembly.mobile_count() {
        let disk = assembly.order()[index] as usize;
        let touches = |pair: &all_pairs::Pair<D>| if pair.first == disk || pair.second == disk { 1.0 } else { 0.0 };
        // The energy of sites and loads is of second degree: its central difference is exact up to rounding.
        let allowed = slope_error(packing, contacts, STEP, 4.0 * EPSILON, touches) + 2.0 * sum_rounding * scale / STEP;
        for d in 0..D {
            let slope = energy_slope(&mut assembly, index, d);
            let off = (forces[index][d] + slope).abs();
            assert!(off <= allowed, "{contacts:?}, Γ = {coupling}, disk {disk}: {} and {slope}", forces[index][d]);
        }
    }
}

/// What contacts alone do: the forces minus Γ u and the loads. They add up to nothing, and in the open plane so do their torques.
fn check_sums<const D: usize>(contacts: &dyn PairLaw, coupling: f64, packing: &Packing<D>) {
    let (forces, totals) = forces_of(packing, contacts);
    let (sites, loads) = (packing.sites().expect("given"), packing.loads().expect("given"));
    let (mut net, mut torque, mut outer) = ([0.0; D], [[0.0; D]; D], 0.0);
    for disk in 0..packing.len() {
        let position = packing.positions()[disk];
        let away = difference(position, sites[disk].0);
        let from_outside: Vector<D> = std::array::from_fn(|d| coupling * away[d] + loads[disk][d]);
        let inner = difference(forces[disk], from_outside);
        net = sum(net, inner);
        for (a, b) in (0..D).flat_map(|a| (0..D).map(move |b| (a, b))) {
            torque[a][b] += position[a] * inner[b] - position[b] * inner[a];
        }
        outer += norm(from_outside);
    }
    // Each contact adds and takes the same number; sums round once for each contact and disk, at what is summed up.
    let roundings = (2 * totals.contact_count + 4 * packing.len()) as f64;
    let allowed = roundings * EPSILON * (totals.force_sum + outer);
    assert!(norm(net) <= allowed, "{contacts:?}, Γ = {coupling}: {net:?} of {}", totals.force_sum);
    if *packing.domain() == Domain::Open {
        let farthest = packing.positions().iter().map(|&position| norm(position)).fold(1.0, f64::max);
        // A force is along the separation up to a few roundings of both.
        let allowed = (roundings + 16.0) * EPSILON * farthest * 4.0 * (totals.force_sum + outer);
        assert!(
            torque.as_flattened().iter().all(|torque| torque.abs() <= allowed),
            "{contacts:?}: {torque:?}, {allowed:e}"
        );
    }
}

proptest! {
    #![proptest_config(cases(16))]

    #[test]
    fn force_is_minus_the_energy_gradient_with_sites_and_loads(
        seed: u64, coupling in prop_oneof![Just(0.0), -2.0..2.0f64], exponent in 2.0..4.0f64, flat in domains::<2>(), deep in domains::<3>(),
    ) {
        let (flat, deep) = (loaded(seed, 20, flat, 0.2), loaded(seed, 20, deep, 0.2));
        check_gradient(&OnSite { law: Hertzian { stiffness: 1.0 }, coupling }, coupling, &flat);
        check_gradient(&OnSite { law: PowerLaw { energy_scale: 1.0, exponent }, coupling }, coupling, &flat);
        check_gradient(&OnSite { law: Hookean { stiffness: 1.0 }, coupling }, coupling, &deep);
    }
}

proptest! {
    #![proptest_config(cases(64))]

    #[test]
    fn forces_without_sites_and_loads_add_up_to_nothing_and_so_do_their_torques(
        seed: u64, count in 2usize..60, coupling in prop_oneof![Just(0.0), -2.0..2.0f64], flat in domains::<2>(), deep in domains::<3>(),
    ) {
        for domain in [flat, Domain::Open] {
            let packing = loaded(seed, count, domain, 0.0);
            check_sums(&OnSite { law: Hertzian { stiffness: 1.0 }, coupling }, coupling, &packing);
            check_sums(&OnSite { law: Hookean { stiffness: 1.0 }, coupling }, coupling, &packing);
        }
        for domain in [deep, Domain::Open] {
            check_sums(&OnSite { law: Hertzian { stiffness: 1.0 }, coupling }, coupling, &loaded(seed, count, domain, 0.0));
        }
    }

    /// One contact after the other: what a contact gives to one disk it takes from the other, with held disks, loads and sites.
    #[test]
    fn forces_are_the_sums_of_equal_and_opposite_contact_forces(
        seed: u64, count in 2usize..60, coupling in -2.0..2.0f64, held_share in 0.0..0.4f64, domain in domains::<2>(),
    ) {
        let packing = loaded(seed, count, domain, held_share);
        let law = OnSite { law: Hertzian { stiffness: 1.0 }, coupling };
        let network = ContactNetwork::new(&packing, &law).expect("no coincidence");
        let (sites, loads) = (packing.sites().expect("given"), packing.loads().expect("given"));
        let mut expected: Vec<Vector<2>> = (0..count)
            .map(|disk| {
                let away = difference(packing.positions()[disk], sites[disk].0);
                std::array::from_fn(|d| coupling * away[d] + loads[disk][d])
            })
            .collect();
        let mut sizes: Vec<f64> = expected.iter().map(|&force| norm(force)).collect();
        for contact in &network.contacts {
            let part = contact.separation.map(|x| contact.force * x / norm(contact.separation));
            let (a, b) = (contact.first as usize, contact.second as usize);
            (expected[a], expected[b]) = (sum(expected[a], part), difference(expected[b], part));
            (sizes[a], sizes[b]) = (sizes[a] + contact.force, sizes[b] + contact.force);
        }
        for disk in (0..count).filter(|&disk| !packing.held()[disk]) {
            // The same contacts in another order: a rounding of each sum, and a few of each force.
            let allowed = (network.contacts.len() + 16) as f64 * EPSILON * sizes[disk];
            prop_assert!(norm(difference(network.forces()[disk], expected[disk])) <= allowed, "disk {disk}");
        }
    }
}

#[test]
fn without_sites_no_disk_is_away_from_one() {
    let assembly = Assembly::new(&disks::<2>(1, 10, Domain::Open, 0.0), &Hertzian::default()).expect("no coincidence");
    assert!((0..10).all(|index| assembly.displacement_from_site(index) == [0.0; 2]));
}
