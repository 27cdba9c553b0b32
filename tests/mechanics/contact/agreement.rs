//! The list and the hot loop against the plainest loops over all pairs.

use super::*;

proptest! {
    #![proptest_config(cases(64))]

    #[test]
    fn list_and_hot_loop_are_those_of_all_pairs_in_the_plane(
        seed: u64, count in 1usize..60, domain in domains::<2>(), exponent in 2.0..4.0f64,
    ) {
        check_against_all_pairs(&Hertzian::default(), seed, count, domain);
        check_against_all_pairs(&Hookean::default(), seed, count, domain);
        check_against_all_pairs(&PowerLaw { energy_scale: 1.0, exponent }, seed, count, domain);
    }

    #[test]
    fn contacts_of_the_network_are_those_of_all_pairs(seed: u64, count in 1usize..60, domain in domains::<2>()) {
        let packing = disks(seed, count, domain, 0.2);
        let network = ContactNetwork::new(&packing, &Hertzian::default()).expect("no coincidence");
        let ours: Vec<(usize, usize)> =
            network.contacts.iter().map(|contact| (contact.first as usize, contact.second as usize)).collect();
        let sure = pairs_within(&packing, -blur(&packing));
        let possible = pairs_within(&packing, blur(&packing));
        prop_assert!(ours.is_sorted());
        let ours: BTreeSet<_> = ours.into_iter().collect();
        prop_assert_eq!(ours.len(), network.contacts.len());
        prop_assert!(sure.iter().all(|pair| ours.contains(&(pair.first, pair.second))));
        let possible_set: BTreeSet<_> = possible.iter().map(|pair| (pair.first, pair.second)).collect();
        prop_assert!(ours.is_subset(&possible_set));
        for contact in &network.contacts {
            let pair = possible.iter().find(|pair| (pair.first, pair.second) == (contact.first as usize, contact.second as usize));
            let pair = pair.expect("found above");
            prop_assert!(norm(difference(contact.separation, pair.separation)) <= blur(&packing));
            prop_assert!((contact.overlap - pair.overlap).abs() <= blur(&packing));
        }
    }
}

proptest! {
    // Three-dimensional images are many (7³ a pair): fewer cases.
    #![proptest_config(cases(32))]

    #[test]
    fn list_and_hot_loop_are_those_of_all_pairs_in_space(seed: u64, count in 1usize..40, domain in domains::<3>()) {
        check_against_all_pairs(&Hertzian::default(), seed, count, domain);
    }
}
