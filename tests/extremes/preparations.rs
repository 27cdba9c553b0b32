//! Pressures over eight decades, radii a thousand times apart, three disks, nothing but rattlers.

use jamscope::law::{Hertzian, Hookean, PairLaw};
use jamscope::network::ContactNetwork;
use jamscope::packing::{Component, Mixture, PackingError};
use jamscope::preparation::{Preparation, PreparationError, Prepared, Target, prepare_with};
use jamscope::relax::Criterion;

use crate::{all_finite, fire};

fn made(law: &dyn PairLaw, count: usize, mixture: Mixture, target: Target) -> Result<Prepared<2>, PreparationError> {
    let preparation =
        Preparation { disk_count: count, mixture, target, tolerance: 0.01, seed: 3, ..Preparation::default() };
    prepare_with::<2>(&preparation, law, &fire(1e-8), &mut ())
}

#[test]
fn pressures_over_eight_decades_are_met() {
    // From 10⁻⁴, where contact forces are 10⁻⁹ of the stiffness, to 10⁴, where φ is about 1.2.
    fn check(law: &dyn PairLaw, pressures: &[f64]) {
        for &pressure in pressures {
            let prepared = made(law, 64, Mixture::default(), Target::Pressure(pressure)).expect("in reach");
            assert!(
                (prepared.pressure / pressure - 1.0).abs() <= 0.01,
                "{law:?}: {} for {pressure}",
                prepared.pressure
            );
            let network = ContactNetwork::new(prepared.packing.get(), law).expect("no coincidence");
            // Maxwell: N_b disks of a periodic packing are rigid from 2 N_b − 1 contacts on, one more to have a pressure.
            let (disks, contacts) = (network.backbone_count(), network.backbone_contacts().count());
            assert!(contacts + 2 > 2 * disks, "{law:?} at {pressure}: {contacts} contacts of {disks} disks");
        }
    }
    check(&Hertzian::default(), &[1e-4, 1e-2, 1.0, 1e2, 1e4]);
    check(&Hookean::default(), &[1e-4, 1e-2, 1.0, 1e2, 1e4]);
}

#[test]
fn radii_a_thousand_times_apart_come_to_rest() {
    let mixture =
        Mixture { components: vec![Component { radius: 500.0, share: 0.5 }, Component { radius: 0.5, share: 0.5 }] };
    let prepared = made(&Hertzian::default(), 32, mixture, Target::PackingFraction(0.95)).expect("at rest");
    assert!(all_finite(prepared.packing.get()) && prepared.pressure > 0.0);
    // 16 large disks hold each other: none of the small ones, of a millionth of their area, is needed for it.
    let network = ContactNetwork::new(prepared.packing.get(), &Hertzian::default()).expect("no coincidence");
    assert!(network.backbone_count() >= 12, "{} on the backbone", network.backbone_count());
}

#[test]
fn two_disks_are_too_few_for_their_box_and_three_too() {
    // Three disks at φ = 0.9 fill a box of side 1.7, less than two contact ranges: a pair would touch twice.
    for count in [1, 2, 3] {
        let error = made(&Hertzian::default(), count, Mixture::default(), Target::PackingFraction(0.9));
        let error = error.expect_err("the box is too small");
        assert!(matches!(error, PreparationError::Packing(PackingError::BoxTooSmall { .. })), "{error}");
    }
}

#[test]
fn three_disks_in_a_box_that_holds_them_come_to_rest_apart() {
    // φ = 0.3: a box of side 3.0, above 4 · 0.7. Three disks there never jam.
    let prepared = made(&Hertzian::default(), 3, Mixture::default(), Target::PackingFraction(0.3)).expect("at rest");
    assert_eq!((prepared.criterion, prepared.pressure), (Criterion::Unjammed, 0.0));
}

#[test]
fn nothing_but_rattlers_is_unjammed() {
    for fraction in [1e-300, 1e-12, 0.1, 0.5] {
        let prepared = made(&Hertzian::default(), 50, Mixture::default(), Target::PackingFraction(fraction));
        let prepared = prepared.expect("at rest");
        assert_eq!((prepared.criterion, prepared.pressure), (Criterion::Unjammed, 0.0), "{fraction:e}");
        let network = ContactNetwork::new(prepared.packing.get(), &Hertzian::default()).expect("no coincidence");
        assert_eq!((network.backbone_count(), network.rattlers().count()), (0, 50), "{fraction:e}");
        // Zero, not the −0 of a sum over nothing, which a reader sees as "-0".
        let sums = [network.energy(), network.pressure(1.0), network.cluster_pressure(1.0, |_| false)];
        assert_eq!(sums.map(f64::to_bits), [0; 3], "{fraction:e}");
    }
}
