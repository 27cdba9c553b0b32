use crate::seeds::config;
use jamscope::displacement::{DisplacementField, Moved};
use jamscope::inflation::{Inflation, inflate_with};
use jamscope::io::read_packing;
use jamscope::law::Hertzian;
use jamscope::observe::State;
use jamscope::observe::bond_changes::{BondChanges, BondSet};
use jamscope::observe::contact_changes::{ChangedContact, ContactChanges};
use jamscope::observe::fluctuations::{BondMeasure, Fluctuations};
use jamscope::observe::isostatic::{
    IsostaticLength, IsostaticOutcome, IsostaticRule, IsostaticSettings, Normalisation,
};
use jamscope::observe::multipoles::{ModeFit, MultipoleFit, MultipoleSettings, Multipoles};
use jamscope::observe::penetration_length::{Penetration, PenetrationLength, PenetrationSettings};
use jamscope::observe::{RadialProfile, Ring};
use jamscope::packing::Packing;
use jamscope::relax::Fire;
use proptest::prelude::*;
use rand::RngExt;
use std::sync::OnceLock;

use super::{field, generator, normal, random_places};

/// Three rings of disks with random displacements.
fn random_field(seed: u64) -> DisplacementField<2> {
    let mut generator = generator(seed);
    let places = random_places(&[5.0, 11.0, 29.0], 70, &mut generator);
    let values: std::cell::RefCell<Vec<[f64; 2]>> =
        (0..places.len()).map(|_| [normal(&mut generator), normal(&mut generator)]).collect::<Vec<_>>().into();
    field(&places, |_, _| values.borrow_mut().pop().expect("one a disk"))
}

/// Random order of so many things.
fn order(count: usize, seed: u64) -> Vec<usize> {
    let mut generator = generator(seed);
    let mut order: Vec<usize> = (0..count).collect();
    (1..count).rev().for_each(|k| order.swap(k, generator.random_range(0..=k)));
    order
}

fn modes(multipoles: &Multipoles) -> Vec<ModeFit> {
    let of = |fit: &MultipoleFit| match fit {
        MultipoleFit::Fitted { radial, transverse } => [radial.modes.clone(), transverse.modes.clone()].concat(),
        other => panic!("no modes: {other:?}"),
    };
    multipoles.rings.iter().flat_map(|ring| of(&ring.fit)).collect()
}

/// A packing before and after an inflation.
fn states() -> &'static (Packing<2>, Packing<2>, usize, f64) {
    static STATES: OnceLock<(Packing<2>, Packing<2>, usize, f64)> = OnceLock::new();
    STATES.get_or_init(|| {
        let packing = read_packing::<2>("fixtures/packings/hertz_N1000_p10.xyz").expect("a fixture");
        let inflated =
            inflate_with(&Inflation::default(), &packing, &Hertzian::default(), &Fire::default(), 1, &mut ());
        let inflated = inflated.expect("an inflation");
        let [before, after] = [inflated.before, inflated.after].map(|rest| rest.packing.into_inner());
        (before, after, inflated.centre, inflated.outer_radius)
    })
}

/// The same disks in another order.
fn relabelled(packing: &Packing<2>, order: &[usize]) -> Packing<2> {
    let take = |of: &[[f64; 2]]| order.iter().map(|&disk| of[disk]).collect::<Vec<_>>();
    let radii = order.iter().map(|&disk| packing.radii()[disk]).collect();
    Packing::new(*packing.domain(), take(packing.positions()), radii)
        .and_then(|it| it.with_corrections(take(packing.corrections())))
        .and_then(|it| it.with_held(order.iter().map(|&disk| packing.held()[disk]).collect()))
        .expect("sound disks")
}

proptest! {
    #![proptest_config(config(24, 20))]

    #[test]
    fn turning_a_field_turns_phases_and_nothing_else(seed in 0u64..1000, turn in -3.0f64..3.0) {
        let before = random_field(seed);
        let (sine, cosine) = turn.sin_cos();
        let turned = |v: [f64; 2]| [cosine * v[0] - sine * v[1], sine * v[0] + cosine * v[1]];
        let mut after = before.clone();
        for disk in &mut after.disks {
            let (position, displacement) = (turned(disk.position), turned(disk.displacement));
            *disk = Moved { position, displacement, ..*disk };
        }
        let of = |field| modes(&Multipoles::of(field, &MultipoleSettings::default()).expect("sound settings"));
        for (old, new) in of(&before).iter().zip(&of(&after)) {
            // Displacements of a few lengths, angles to 4·10⁻¹⁶, n to 4, condition of nine columns on 70 angles below 4.
            let tolerance = 1e-13;
            let phase = old.mode as f64 * turn;
            let (cosine, sine) = (
                old.cosine * phase.cos() - old.sine * phase.sin(),
                old.cosine * phase.sin() + old.sine * phase.cos(),
            );
            prop_assert!((new.cosine - cosine).abs() < tolerance && (new.sine - sine).abs() < tolerance);
            prop_assert!((new.amplitude - old.amplitude).abs() < tolerance);
            prop_assert!((new.amplitude_error - old.amplitude_error).abs() < tolerance);
        }
    }

    #[test]
    fn the_order_of_disks_changes_no_bit_of_modes_and_fluctuations(seed in 0u64..1000) {
        let before = random_field(seed);
        let mut after = before.clone();
        after.disks = order(before.disks.len(), seed + 1).into_iter().map(|disk| before.disks[disk]).collect();
        let settings = MultipoleSettings::default();
        prop_assert_eq!(Multipoles::of(&before, &settings), Multipoles::of(&after, &settings));
        prop_assert_eq!(Fluctuations::of_radial(&before, 1.0), Fluctuations::of_radial(&after, 1.0));
    }

    #[test]
    fn units_of_length_scale_all_lengths(seed in 0u64..1000, exponent in -30i32..30) {
        // A power of two, so that no bit may change but for the exponent.
        let factor = f64::from(exponent).exp2();
        let before = random_field(seed);
        let mut after = before.clone();
        after.outer_radius *= factor;
        for disk in &mut after.disks {
            let scaled = |v: [f64; 2]| v.map(|x| factor * x);
            *disk = Moved {
                position: scaled(disk.position),
                displacement: scaled(disk.displacement),
                distance: factor * disk.distance,
                radial: factor * disk.radial,
                ..*disk
            };
        }
        let of = |field, unit: f64| {
            let settings = MultipoleSettings { ring_width: 2.0 * unit, ..MultipoleSettings::default() };
            modes(&Multipoles::of(field, &settings).expect("sound settings"))
        };
        for (old, new) in of(&before, 1.0).iter().zip(&of(&after, factor)) {
            prop_assert_eq!((new.amplitude, new.phase), (factor * old.amplitude, old.phase));
            prop_assert_eq!((new.amplitude_error, new.phase_error), (factor * old.amplitude_error, old.phase_error));
        }
        let (old, new) = (Fluctuations::of_radial(&before, 1.0), Fluctuations::of_radial(&after, factor));
        let curve = |it: &Fluctuations, unit: f64| {
            let normalisation = Normalisation::NearCentre { radius: 5.0 * unit };
            let rule = IsostaticRule::Threshold(3.0);
            let settings = IsostaticSettings { normalisation, rule, ring_width: unit, from: unit, ..IsostaticSettings::default() };
            IsostaticLength::of(it, Some(0.5 / unit), 0.1 * unit, 40.0 * unit, &settings).expect("sound settings")
        };
        // ΔZ is a number and r ΔZ a length; dividing ΔZ by the unit here makes x one number in both.
        let (old, new) = (curve(&old, 1.0), curve(&new, factor));
        let scaled = |it: &IsostaticLength| it.curve.iter().map(|p| (p.scaled_radius, p.scaled_fluctuation)).collect::<Vec<_>>();
        prop_assert_eq!(scaled(&old), scaled(&new));
        if let (IsostaticOutcome::Reached { length: a, .. }, IsostaticOutcome::Reached { length: b, .. }) = (old.outcome, new.outcome) {
            prop_assert_eq!(b, factor * a);
        }
    }

    #[test]
    fn a_penetration_length_is_a_length(decay in 1.0f64..5.0, exponent in -30i32..30) {
        let factor = f64::from(exponent).exp2();
        let at = |unit: f64| {
            let ring = |k: u32| {
                let mean = unit * 0.1 * libm::exp(-f64::from(k) / decay);
                Ring { radius: unit * f64::from(k), disk_count: 3, mean, spread: 0.0, standard_error: 0.0 }
            };
            let profile = RadialProfile { rings: (1..60).map(ring).collect() };
            let settings = PenetrationSettings { thresholds: vec![1e-3 * unit] };
            PenetrationLength::of(&profile, &settings).expect("sound settings")[0].penetration
        };
        let (Penetration::FallsAt { radius: old, .. }, Penetration::FallsAt { radius: new, .. }) = (at(1.0), at(factor)) else {
            return Err(TestCaseError::fail("it falls"));
        };
        prop_assert_eq!(new, factor * old);
    }

    #[test]
    fn relabelling_a_packing_changes_no_bit_of_contacts_and_bonds(seed in 0u64..1000) {
        let (before, after, centre, outer_radius) = states();
        let law = Hertzian::default();
        let order = order(before.len(), seed);
        let (new_before, new_after) = (relabelled(before, &order), relabelled(after, &order));
        let new_centre = order.iter().position(|disk| disk == centre).expect("it is there");
        let state = |packing| State::new(packing, &law).expect("sound disks");
        let old = [state(before), state(after)];
        let new = [state(&new_before), state(&new_after)];

        let places = |changes: &[ChangedContact<2>]| {
            let mut places: Vec<[u64; 3]> =
                changes.iter().map(|it| [it.distance, it.midpoint[0], it.midpoint[1]].map(f64::to_bits)).collect();
            places.sort_unstable();
            places
        };
        let a = ContactChanges::between(&old[0], &old[1], *centre);
        let b = ContactChanges::between(&new[0], &new[1], new_centre);
        prop_assert_eq!((a.kept_count, a.rattlers), (b.kept_count, b.rattlers));
        prop_assert_eq!(places(&a.made), places(&b.made));
        prop_assert_eq!(places(&a.broken), places(&b.broken));
        prop_assert!(!a.made.is_empty() && !a.broken.is_empty());

        let bonds = |[before, after]: &[State<2>; 2], centre| BondChanges::between(before, after, centre, BondSet::Kept);
        let (a, b) = (bonds(&old, *centre), bonds(&new, new_centre));
        let h = |changes: &BondChanges<2>| Fluctuations::of_bonds(changes, BondMeasure::Parallel, *outer_radius, 1.0);
        prop_assert_eq!(h(&a), h(&b));
    }
}
