//! The backbone on random graphs by enumeration of all subsets, and on packings by plain removal.

use super::*;
use crate::scenes::laws::hertzian;
use crate::scenes::rest::{at_rest, relax};
use crate::scenes::starts::points;
use jamscope::relax::{Fire, ForceLimit};

/// A graph: which disks are held, and which of all pairs touch.
fn graph(seed: u64, count: usize, share: f64, held_share: f64) -> (Vec<bool>, Vec<(u32, u32)>) {
    let mut generator = Pcg64::seed_from_u64(seed);
    let held: Vec<bool> = (0..count).map(|_| generator.random::<f64>() < held_share).collect();
    let pairs = (0..count as u32).flat_map(|b| (0..b).map(move |a| (a, b)));
    let touching = pairs.filter(|&(a, b)| !(held[a as usize] && held[b as usize]));
    // A contact may name either disk first.
    let turned = |(a, b), turn| if turn { (b, a) } else { (a, b) };
    let mut contacts = Vec::new();
    for pair in touching {
        if generator.random::<f64>() < share {
            contacts.push(turned(pair, generator.random()));
        }
    }
    (held, contacts)
}

/// The union of all sets of mobile disks in which each has `least` contacts with disks of the set or held ones. The union of two such sets
/// is such a set, so it is the largest one. All 2^count sets are tried; no disk is ever removed.
fn largest_set(held: &[bool], contacts: &[(u32, u32)], least: u32) -> Vec<bool> {
    let count = held.len();
    let mut touching = vec![0u32; count];
    for &(a, b) in contacts {
        touching[a as usize] |= 1 << b;
        touching[b as usize] |= 1 << a;
    }
    let fixed: u32 = (0..count).filter(|&disk| held[disk]).map(|disk| 1 << disk).sum();
    let sound = |set: u32| {
        (0..count).all(|disk| set >> disk & 1 == 0 || held[disk] || (touching[disk] & set).count_ones() >= least)
    };
    let union =
        (0..1u32 << count).map(|set| set | fixed).filter(|&set| sound(set)).fold(fixed, |union, set| union | set);
    (0..count).map(|disk| union >> disk & 1 == 1).collect()
}

/// Whether unit vectors lie in a half plane: some gap between neighbouring directions is π or more. Directions of π less `margin` count too.
fn in_a_half_plane(directions: &[Vector<2>], margin: f64) -> bool {
    let mut angles: Vec<f64> = directions.iter().map(|[x, y]| y.atan2(*x)).collect();
    angles.sort_by(f64::total_cmp);
    let Some(&first) = angles.first() else { return true };
    let next = angles.iter().skip(1).copied().chain([first + std::f64::consts::TAU]);
    angles.iter().zip(next).any(|(&angle, next)| next - angle >= std::f64::consts::PI - margin)
}

/// Disks that remain when a mobile disk is taken out for too few contacts, or for contacts that all push it to one side.
fn held_in_place(packing: &Packing<2>, network: &ContactNetwork<2>) -> Vec<bool> {
    let mut remains = vec![true; packing.len()];
    loop {
        let loose = |disk: usize| {
            let mut directions = Vec::new();
            for contact in &network.contacts {
                let (a, b) = (contact.first as usize, contact.second as usize);
                if (a == disk && remains[b]) || (b == disk && remains[a]) {
                    let sign = if a == disk { 1.0 } else { -1.0 };
                    directions.push(contact.separation.map(|x| sign * x / norm(contact.separation)));
                }
            }
            // Two disks of the backbone that rest on a third at exactly π do not occur in disordered packings: no margin.
            directions.len() < 3 || in_a_half_plane(&directions, 0.0)
        };
        let next: Vec<bool> =
            (0..packing.len()).map(|disk| packing.held()[disk] || (remains[disk] && !loose(disk))).collect();
        if next == remains {
            return remains;
        }
        remains = next;
    }
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn the_backbone_of_a_graph_is_the_union_of_all_sets_with_enough_contacts(
        seed: u64, count in 1usize..12, share in 0.1..0.9f64, held_share in prop_oneof![Just(0.0), 0.0..0.5f64],
    ) {
        let (held, contacts) = graph(seed, count, share, held_share);
        prop_assert_eq!(backbone::<2>(&held, &contacts), largest_set(&held, &contacts, 3));
        prop_assert_eq!(backbone::<3>(&held, &contacts), largest_set(&held, &contacts, 4));
    }
}

proptest! {
    #![proptest_config(cases(32))]

    /// Sparse graphs, in which each removal makes others: the work space serves one after the other.
    #[test]
    fn one_work_space_finds_the_backbones_of_many_large_graphs(seed: u64, held_share in 0.0..0.1f64) {
        let mut peeling = jamscope::network::Peeling::default();
        for (number, count) in [(0, 300usize), (1, 20), (2, 150)] {
            // 3 to 5 contacts a disk: on either side of the degree at which a backbone appears.
            let degree = 3.0 + 2.0 * (seed % 97) as f64 / 97.0;
            let (held, contacts) = graph(seed ^ number, count, degree / count as f64, held_share);
            let mut remains = vec![number == 1; count];
            peeling.peel::<2>(|disk| held[disk], &contacts, &mut remains);
            prop_assert_eq!(&remains, &naive_backbone::backbone(&held, &contacts, 3));
            peeling.peel::<3>(|disk| held[disk], &contacts, &mut remains);
            prop_assert_eq!(&remains, &naive_backbone::backbone(&held, &contacts, 4));
        }
    }

    #[test]
    fn the_backbone_of_balls_has_four_contacts_each(
        seed: u64, count in 1usize..80, side in 1.1..1.8f64, held_share in 0.0..0.3f64,
    ) {
        let packing = disks(seed, count, periodic([on_grid(side); 3]), held_share);
        let network = ContactNetwork::new(&packing, &Hertzian::default()).expect("no coincidence");
        let links: Vec<(u32, u32)> = network.contacts.iter().map(|contact| (contact.first, contact.second)).collect();
        prop_assert_eq!(&network.backbone, &naive_backbone::backbone(packing.held(), &links, 4));
        let mut counts = vec![0; count];
        links.iter().for_each(|&(a, b)| [a, b].iter().for_each(|&disk| counts[disk as usize] += 1));
        prop_assert_eq!(network.contact_counts(), counts);
    }
}

proptest! {
    #![proptest_config(cases(8))]

    /// At rest the forces on a disk cancel, so its contacts cannot lie in a half plane: the geometric criterion removes no disk of the
    /// backbone, and disks that it does remove were rattlers. The largest net force, 10⁻¹⁰ of the mean contact force, is far below the
    /// smallest force on the backbone.
    #[test]
    fn contacts_of_the_backbone_of_a_packing_at_rest_surround_each_disk(seed in 0..1_000_000u64, fraction in 0.88..1.1f64) {
        let fire = Fire { limit: ForceLimit::Relative(1e-10), ..Fire::default() };
        let packing = at_rest(relax(&fire, points::<2>(60, fraction, seed), &hertzian()));
        let network = ContactNetwork::new(&packing, &hertzian()).expect("no coincidence");
        prop_assert!(network.backbone_count() > 30, "{} disks", network.backbone_count());
        prop_assert_eq!(held_in_place(&packing, &network), network.backbone);
    }
}
