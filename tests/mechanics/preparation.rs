//! Preparation: targets met, unjammed packings, and what is refused.

use std::cell::RefCell;

use jamscope::displacement::DisplacementField;
use jamscope::inflation::{Boundary, Inflation, inflate_with};
use jamscope::law::PairLaw;
use jamscope::network::ContactNetwork;
use jamscope::packing::{Component, Mixture, Packing, PackingError};
use jamscope::preparation::{Preparation, PreparationError, Prepared, Target, prepare_with, random_points};
use jamscope::relax::{Criterion, Fire, ForceLimit, Outcome, Relaxer, Stop, Trace};
use jamscope::vector::{larger, norm};

use crate::scenes::laws::{hertzian, hookean};

fn preparation(disk_count: usize, target: Target, seed: u64) -> Preparation {
    Preparation { disk_count, mixture: Mixture::default(), target, tolerance: 0.01, seed, ..Preparation::default() }
}

fn made(preparation: &Preparation, law: &dyn PairLaw) -> Result<Prepared<2>, PreparationError> {
    prepare_with::<2>(preparation, law, &Fire::default(), &mut ())
}

fn meets_pressures(law: &dyn PairLaw, seed: u64) {
    for pressure in [0.05, 1.0, 100.0, 2000.0] {
        let preparation = preparation(256, Target::Pressure(pressure), seed);
        let prepared = made(&preparation, law).expect("a packing at this pressure");
        let packing = prepared.packing.get();
        println!(
            "{law:?} p {pressure}: {} after {} relaxations, {:?}",
            prepared.pressure, prepared.relaxation_count, prepared.cost
        );
        assert!((prepared.pressure / pressure - 1.0).abs() <= preparation.tolerance);
        // The numbers handed out are those of the packing handed out: sums of a few hundred terms.
        let network = ContactNetwork::new(packing, law).expect("no coincidence");
        let volume = packing.domain().volume().expect("periodic");
        assert!((network.pressure(volume) / prepared.pressure - 1.0).abs() < 1e-12);
        assert_eq!(packing.packing_fraction(), Some(prepared.packing_fraction));
        assert_eq!(prepared.criterion, Criterion::RelativeForce);
        // At rest when looked at anew; positions carry their corrections, so rounding is far below the limit.
        let residual = (0..packing.len())
            .filter(|&disk| network.backbone[disk])
            .map(|disk| norm(network.forces()[disk]))
            .fold(0.0, larger);
        assert!(residual <= 1.01e-8 * network.mean_contact_force(), "{residual:e}");
        // Maxwell: N backbone disks need at least 2 N − 2 contacts (translations are free), and one more to bear a pressure.
        let (disks, contacts) = (network.backbone_count(), network.backbone_contacts().count());
        assert!(contacts > 2 * disks - 2, "{contacts} contacts of {disks} disks bear no pressure");
        assert_eq!(packing.radii().iter().filter(|&&radius| radius == 0.5).count(), 128);
    }
}

/// FIRE that writes down the limit of every relaxation.
struct Recorded<'a>(Fire, &'a RefCell<Vec<f64>>);

impl Relaxer for Recorded<'_> {
    fn relax<const D: usize>(
        &self,
        packing: Packing<D>,
        law: &dyn PairLaw,
        trace: &mut dyn Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError> {
        self.1.borrow_mut().push(self.0.limit.value());
        self.0.relax(packing, law, trace)
    }

    fn for_intermediate_states(&self, limit: f64) -> Option<Self> {
        self.0.for_intermediate_states(limit).map(|fire| Recorded(fire, self.1))
    }
}

#[test]
fn states_on_the_way_to_a_pressure_are_passed_through_and_the_last_is_at_rest() {
    // A tolerance that the quench misses, and one so narrow that it rules the limit: a tenth of it.
    for (tolerance, passing) in [(0.02, 1e-3), (1e-4, 1e-5)] {
        let limits = RefCell::new(Vec::new());
        let wanted = Preparation { tolerance, ..preparation(128, Target::Pressure(100.0), 7) };
        let fire = Recorded(Fire::default(), &limits);
        let prepared = prepare_with::<2>(&wanted, &hertzian(), &fire, &mut ()).expect("a packing");
        let limits = limits.into_inner();
        assert_eq!(limits.len(), prepared.relaxation_count);
        // Passed through first, at rest from the first that met the pressure on, and no way back.
        let passed = limits.iter().filter(|&&limit| limit == passing).count();
        assert!(passed >= 1 && limits[..passed].iter().all(|&limit| limit == passing), "{limits:?}");
        assert!(passed < limits.len() && limits[passed..].iter().all(|&limit| limit == 1e-8), "{limits:?}");
        assert!((prepared.pressure / 100.0 - 1.0).abs() <= tolerance && prepared.residual.relative() <= 1e-8);
    }
    // Who asks for no less has nothing to pass through.
    assert!(Fire { limit: ForceLimit::Relative(1e-3), ..Fire::default() }.for_intermediate_states(1e-3).is_none());
}

#[test]
fn hertzian_packings_meet_their_pressure_and_are_rigid() {
    meets_pressures(&hertzian(), 1);
}

#[test]
fn hookean_packings_meet_their_pressure_and_are_rigid() {
    meets_pressures(&hookean(), 2);
}

#[test]
fn a_packing_fraction_is_met_to_rounding() {
    let prepared = made(&preparation(300, Target::PackingFraction(0.9), 3), &hertzian()).expect("a packing");
    // A sum of 300 areas and a square root, squared.
    assert!((prepared.packing_fraction - 0.9).abs() < 300.0 * f64::EPSILON);
    assert_eq!((prepared.relaxation_count, prepared.quench_packing_fraction), (1, 0.9));
    // Design §4: 630 for 1000 disks and one seed; another quench of 300 gives another, of the same size.
    assert!(prepared.pressure > 400.0 && prepared.pressure < 900.0, "{}", prepared.pressure);
}

#[test]
fn below_jamming_the_pressure_is_zero() {
    for seed in [4, 5] {
        let preparation = preparation(200, Target::PackingFraction(0.80), seed);
        let hertzian = made(&preparation, &hertzian()).expect("a packing");
        let hookean = made(&preparation, &hookean()).expect("a packing");
        for prepared in [hertzian, hookean] {
            assert_eq!((prepared.pressure, prepared.criterion), (0.0, Criterion::Unjammed));
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_bits_and_another_seed_another_packing() {
    let packing = |seed| {
        let prepared = made(&preparation(100, Target::Pressure(100.0), seed), &hertzian());
        prepared.expect("a packing").packing.into_inner()
    };
    let first = packing(6);
    assert_eq!(first, packing(6));
    assert_ne!(first.positions(), packing(7).positions());
}

#[test]
fn balls_are_prepared_as_disks_are() {
    let preparation = preparation(200, Target::Pressure(100.0), 8);
    let prepared = prepare_with::<3>(&preparation, &hookean(), &Fire::default(), &mut ()).expect("a packing");
    assert!((prepared.pressure / 100.0 - 1.0).abs() <= 0.01);
    let network = ContactNetwork::new(prepared.packing.get(), &hookean()).expect("no coincidence");
    let (balls, contacts) = (network.backbone_count(), network.backbone_contacts().count());
    assert!(contacts > 3 * balls - 3, "{contacts} contacts of {balls} balls bear no pressure");
}

#[track_caller]
fn refused(preparation: &Preparation, expected: PreparationError, number: &str) {
    let error = made(preparation, &hertzian()).expect_err("nonsense");
    assert_eq!(error, expected);
    assert!(error.to_string().contains(number), "{error} does not say {number}");
}

#[test]
fn nonsense_is_refused_with_its_number() {
    for packing_fraction in [4.0, 17.5, -0.25, 0.0] {
        let expected = PreparationError::PackingFractionOutOfRange { packing_fraction };
        refused(
            &preparation(10, Target::PackingFraction(packing_fraction), 1),
            expected,
            &packing_fraction.to_string(),
        );
    }
    for pressure in [-3.5, 0.0, f64::INFINITY] {
        let expected = PreparationError::PressureNotPositive { pressure };
        refused(&preparation(10, Target::Pressure(pressure), 1), expected, &pressure.to_string());
    }
    let strict = Preparation { tolerance: 1.5, ..preparation(10, Target::Pressure(1.0), 1) };
    refused(&strict, PreparationError::ToleranceOutOfRange { tolerance: 1.5 }, "1.5");
    for target in [Target::PackingFraction(0.9), Target::Pressure(1.0)] {
        refused(&preparation(0, target, 1), PreparationError::Packing(PackingError::NoDisks), "at least one disk");
        let components = vec![Component { radius: 0.5, share: 1.0 }, Component { radius: -0.7, share: 1.0 }];
        let negative = Preparation { mixture: Mixture { components }, ..preparation(10, target, 1) };
        let expected = PackingError::MixtureRadiusOutOfRange { component: 1, radius: -0.7 };
        refused(&negative, PreparationError::Packing(expected), "-0.7");
    }
    let nan = made(&preparation(10, Target::PackingFraction(f64::NAN), 1), &hertzian());
    assert!(matches!(nan, Err(PreparationError::PackingFractionOutOfRange { .. })));
}

#[test]
fn a_pressure_beyond_reach_is_refused_with_its_number() {
    let error = made(&preparation(10, Target::Pressure(2.5e10), 1), &hertzian()).expect_err("out of reach");
    // φ = 4 compresses distances by √(0.842/4) = 0.46: overlaps of about one diameter, forces of k' δ = 2e5, pressures of
    // a few times that.
    let PreparationError::PressureOutOfReach { pressure, largest } = error else { panic!("{error}") };
    assert!(pressure == 2.5e10 && largest > 1e5 && largest < 1e7, "{error}");
    assert!(error.to_string().contains("25000000000"), "{error}");
}

#[test]
fn too_few_steps_are_an_error_with_their_number() {
    let preparation = preparation(100, Target::PackingFraction(0.9), 9);
    let fire = Fire { step_limit: 12, ..Fire::default() };
    let error = prepare_with::<2>(&preparation, &hertzian(), &fire, &mut ()).expect_err("too few steps");
    let PreparationError::NotAtRest { packing_fraction, stop, step_count, residual } = &error else {
        panic!("{error}")
    };
    assert_eq!((*stop, *step_count), (Stop::StepLimit, 12));
    assert!((packing_fraction - 0.9).abs() < 1e-12 && *residual > 1e-8);
    for part in ["0.9", "StepLimit", "12 steps"] {
        assert!(error.to_string().contains(part), "{error} does not say {part}");
    }
}

#[test]
fn random_points_fill_the_box_evenly() {
    let packing = random_points::<2>(4000, &Mixture::default(), 0.9, 10).expect("valid");
    let side = packing.domain().lengths().expect("periodic")[0];
    assert!(packing.positions().iter().flatten().all(|&x| (0.0..side).contains(&x)));
    // A quarter of the points in each quadrant: standard deviation √(4000·3/16) = 27, five of them.
    for quadrant in [[false, false], [false, true], [true, false], [true, true]] {
        let inside = |position: &&[f64; 2]| (0..2).all(|d| (position[d] > 0.5 * side) == quadrant[d]);
        let count = packing.positions().iter().filter(inside).count();
        assert!(count.abs_diff(1000) < 137, "{count} points in {quadrant:?}");
    }
}

/// The same code in space: balls are jammed at a pressure, with at least 2 D contacts each less the D that translation takes,
/// and one of them inflated in a sphere cut out of the box pushes its neighbours outwards.
#[test]
fn balls_are_prepared_and_inflated_by_the_same_code() {
    let preparation = Preparation {
        disk_count: 400,
        mixture: Mixture::default(),
        target: Target::Pressure(2000.0),
        tolerance: 0.01,
        seed: 3,
        ..Preparation::default()
    };
    let (law, fire) = (hertzian(), Fire::default());
    let prepared = prepare_with::<3>(&preparation, &law, &fire, &mut ()).expect("within reach");
    assert!((prepared.pressure / 2000.0 - 1.0).abs() <= 0.01);
    let network = ContactNetwork::new(prepared.packing.get(), &law).expect("valid");
    let count = network.backbone_count() as f64;
    let contacts = network.backbone_contacts().count() as f64;
    assert!(contacts >= 3.0 * count - 3.0, "{contacts} contacts cannot hold {count} balls");

    // Three diameters hold a ball's neighbours; the box has a side of about nine.
    let boundary = Boundary::HeldRim { outer_radius_over_side: 0.45 };
    let inflation = Inflation { boundary, ..Inflation::default() };
    let inflated = inflate_with(&inflation, prepared.packing.get(), &law, &fire, 3, &mut ()).expect("room to grow");
    let field = DisplacementField::of_inflation(&inflated);
    assert_eq!(field.disks.len(), inflated.mobile_count);
    let near: Vec<f64> = field.counted().filter(|ball| ball.distance < 1.3).map(|ball| ball.radial).collect();
    assert!(near.len() >= 4 && near.iter().sum::<f64>() > 0.0, "{near:?}");
    assert!(inflated.after.pressure > inflated.before.pressure);
}
