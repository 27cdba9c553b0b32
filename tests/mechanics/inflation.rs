//! Inflation: the circle and its rim, forces in the cut, the size of the response, deflation, and the displacement field.

use std::sync::OnceLock;

use jamscope::displacement::{DisplacementField, MeasuredOn};
use jamscope::inflation::{
    Boundary, Centre, Circle, Inflated, Inflation, InflationError, Stage, choose_centre, inflate_with,
};
use jamscope::law::PairLaw;
use jamscope::network::ContactNetwork;
use jamscope::packing::{Domain, Mixture, Packing, PackingError};
use jamscope::preparation::{Preparation, Target, prepare_with};
use jamscope::relax::{Criterion, Fire, ForceLimit, Outcome, Relaxer, Stop, Trace};
use jamscope::vector::{Vector, difference, dot, larger, norm, sum};

use crate::scenes::laws::hertzian;

const LIMIT: f64 = 1e-12;

fn fire() -> Fire {
    Fire { limit: ForceLimit::Relative(LIMIT), ..Fire::default() }
}

/// A packing of 300 disks at p = 2000, far from jamming, and one at φ = 0.80.
fn dense() -> &'static Packing<2> {
    static PACKING: OnceLock<Packing<2>> = OnceLock::new();
    PACKING.get_or_init(|| made(Target::Pressure(2000.0)))
}

fn loose() -> &'static Packing<2> {
    static PACKING: OnceLock<Packing<2>> = OnceLock::new();
    PACKING.get_or_init(|| made(Target::PackingFraction(0.80)))
}

fn made(target: Target) -> Packing<2> {
    let preparation = Preparation {
        disk_count: 300,
        mixture: Mixture::default(),
        target,
        tolerance: 0.01,
        seed: 1,
        ..Preparation::default()
    };
    let prepared = prepare_with::<2>(&preparation, &hertzian(), &fire(), &mut ()).expect("a packing");
    prepared.packing.into_inner()
}

fn inflated(inflation: &Inflation, packing: &Packing<2>) -> Inflated<2> {
    inflate_with(inflation, packing, &hertzian(), &fire(), 1, &mut ()).expect("an inflation")
}

fn periodic(increase: f64) -> Inflation {
    Inflation { increase, boundary: Boundary::Periodic, ..Inflation::default() }
}

/// Every disk and every image of it, by brute force over five boxes each way.
fn images_within(packing: &Packing<2>, centre: usize, reach: f64) -> Vec<(usize, Vector<2>)> {
    let [[width, _], [tilt, height]] = packing.domain().edges().expect("periodic");
    let mut images = Vec::new();
    for disk in 0..packing.len() {
        for x in -2..=2 {
            for y in -2..=2 {
                let apart = difference(packing.positions()[disk], packing.positions()[centre]);
                let image = sum(apart, [f64::from(x) * width + f64::from(y) * tilt, f64::from(y) * height]);
                if norm(image) < reach {
                    images.push((disk, image));
                }
            }
        }
    }
    images
}

#[test]
fn the_circle_has_every_disk_inside_once_and_a_rim_without_holes() {
    check_circles(dense());
    // The same centres in a tilted box.
    let Domain::Periodic { corner, edges: [a, b] } = *dense().domain() else { panic!("periodic") };
    let domain = Domain::Periodic { corner, edges: [a, [0.7 * a[0], b[1]]] };
    check_circles(&Packing::new(domain, dense().positions().to_vec(), dense().radii().to_vec()).expect("valid"));
}

fn check_circles(packing: &Packing<2>) {
    let side = packing.domain().lengths().expect("periodic")[0];
    for (centre, share) in [(0, 0.5), (7, 0.48), (160, 0.491), (299, 0.3)] {
        let outer_radius = share * side;
        let circle = Circle::cut(packing, centre, outer_radius).expect("a circle");
        let cut = &circle.packing;
        let find = |label: u64, image: Vector<2>, disks: &mut dyn Iterator<Item = usize>| {
            // Coordinates below 20 are rounded to 4e-15, once in each difference.
            disks
                .filter(|&disk| cut.labels()[disk] == label && norm(difference(cut.positions()[disk], image)) < 1e-13)
                .count()
        };
        // A mobile disk touches others up to 2 R_max away from r_out, and may be pushed out by as much.
        let complete = images_within(packing, centre, outer_radius + 4.0 * 0.7 - 1e-9);
        for &(disk, image) in &complete {
            let label = packing.labels()[disk];
            if norm(image) == 0.0 {
                assert_eq!((cut.labels()[circle.centre], cut.positions()[circle.centre]), (label, [0.0; 2]));
            } else if norm(image) < outer_radius {
                assert_eq!(find(label, image, &mut (0..circle.centre)), 1, "disk {disk} inside");
            } else {
                assert_eq!(
                    find(label, image, &mut (circle.centre + 1..cut.len())),
                    1,
                    "image {image:?} of disk {disk}"
                );
            }
        }
        let inside = complete.iter().filter(|(_, image)| norm(*image) < outer_radius).count() - 1;
        assert_eq!(circle.mobile_count(), inside);
        // Nothing besides: the rim ends where it must not be looked for.
        assert!(cut.len().abs_diff(complete.len()) <= 1, "{} and {}", cut.len(), complete.len());
        assert!((0..cut.len()).all(|disk| cut.held()[disk] == (disk >= circle.centre)));
        let mut labels = cut.labels()[..=circle.centre].to_vec();
        labels.sort_unstable();
        labels.dedup();
        assert_eq!(labels.len(), circle.centre + 1, "a mobile disk is there twice");
    }
}

#[test]
fn forces_in_the_cut_are_those_in_the_periodic_packing() {
    let packing = dense();
    let side = packing.domain().lengths().expect("periodic")[0];
    // Not at rest, so that there are forces to compare: every other disk a little larger.
    let mut swollen = packing.clone();
    for disk in (0..packing.len()).step_by(2) {
        swollen = swollen.with_radius(disk, packing.radii()[disk] * 1.02).expect("positive");
    }
    let law = hertzian();
    let whole = ContactNetwork::new(&swollen, &law).expect("no coincidence");
    let circle = Circle::cut(&swollen, 3, 0.48 * side).expect("a circle");
    let cut = ContactNetwork::new(&circle.packing, &law).expect("no coincidence");
    let largest = whole.largest_net_force();
    for disk in 0..circle.centre {
        let label = circle.packing.labels()[disk] as usize;
        let off = norm(difference(cut.forces()[disk], whole.forces()[label]));
        // Positions carry corrections in both, so separations are the same to their rounding 2e-16: with overlaps of 0.05
        // 1e-14 of a contact force in each of six, summed in another order.
        assert!(off <= 1e-13 * largest.max(cut.mean_contact_force()), "disk {label}: {off:e} of {largest}");
    }
}

#[test]
fn a_small_inflation_moves_the_disks_in_proportion() {
    let displacements = |increase: f64| -> Vec<Vector<2>> {
        let field = DisplacementField::of_inflation(&inflated(&periodic(increase), dense()));
        field.disks.iter().map(|moved| moved.displacement).collect()
    };
    let size = |column: &[Vector<2>]| column.iter().map(|&d| dot(d, d)).sum::<f64>().sqrt();
    let departure = |increase: f64| {
        let (one, two) = (displacements(increase), displacements(2.0 * increase));
        let off: Vec<Vector<2>> = one.iter().zip(&two).map(|(&a, &b)| difference(b, sum(a, a))).collect();
        size(&off) / size(&two)
    };
    // Overlaps are about 0.07: nonlinear by d_0 over that, and contacts that open or close by d_0^(3/2); linear in the
    // limit, so ten times smaller steps depart at least five times less.
    let (coarse, fine) = (departure(1e-4), departure(1e-5));
    println!("departure from proportion {coarse:e}, {fine:e}");
    assert!(coarse < 10.0 * 1e-4 / 0.07, "{coarse}");
    assert!(fine < coarse / 5.0, "{coarse} and {fine}");
}

#[test]
fn a_small_inflation_is_undone_by_the_deflation() {
    for boundary in [Boundary::HeldRim { outer_radius_over_side: 0.45 }, Boundary::Periodic] {
        let inflation = Inflation { increase: 1e-3, boundary, deflate: true, ..Inflation::default() };
        let run = inflated(&inflation, dense());
        let (there, back) =
            (DisplacementField::of_inflation(&run), DisplacementField::of_cycle(&run).expect("deflated"));
        let largest = |field: &DisplacementField<2>| field.counted().map(|d| norm(d.displacement)).fold(0.0, larger);
        println!("{boundary:?}: there {:e}, back {:e}", largest(&there), largest(&back));
        assert!(largest(&there) > 1e-4);
        // Both ends are at rest to 1e-12 of a contact force of 10³, 1e-9; the softest modes of such a packing have a
        // stiffness of some 10³ (tests/relax.rs), √N = 17: 2e-11.
        assert!(largest(&back) < 2e-11, "{boundary:?}: {:e} left", largest(&back));
        let (before, deflated) = (&run.before, run.deflated.as_ref().expect("deflated"));
        assert!((deflated.energy / before.energy - 1.0).abs() < 1e-12);
        assert!((deflated.pressure / before.pressure - 1.0).abs() < 1e-10);
        assert!(run.after.energy > before.energy);
        assert_eq!((before.contact_count, before.rattler_count), (deflated.contact_count, deflated.rattler_count));
    }
}

/// FIRE that leaves the packing moved as a whole, as a method that does not keep momentum would.
struct Drifting(Fire);

impl Relaxer for Drifting {
    fn relax<const D: usize>(
        &self,
        packing: Packing<D>,
        law: &dyn PairLaw,
        trace: &mut dyn Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError> {
        let moved = packing.positions().iter().map(|position| position.map(|x| x + 0.25)).collect();
        let moved = Packing::new(*packing.domain(), moved, packing.radii().to_vec())?
            .with_corrections(packing.corrections().to_vec())?;
        self.0.relax(moved, law, trace)
    }
}

#[test]
fn nothing_held_keeps_the_centre_of_mass_whatever_the_relaxer() {
    let law = hertzian();
    let drifting = inflate_with(&periodic(0.1), dense(), &law, &Drifting(fire()), 1, &mut ()).expect("an inflation");
    for (run, drift) in [(inflated(&periodic(0.1), dense()), 0.0), (drifting, 0.25 * 2f64.sqrt())] {
        let (before, after) = (run.before.packing.get(), run.after.packing.get());
        let total = (0..before.len()).fold([0.0; 2], |total, disk| {
            let ((a, a_low), (b, b_low)) = (after.centre(disk), before.centre(disk));
            sum(total, sum(difference(a, b), difference(a_low, b_low)))
        });
        // 300 displacements up to 0.3, and the drift in each, summed and rounded once each, before and after.
        let count = before.len() as f64;
        assert!(norm(total) / count < count * (0.3 + drift) * f64::EPSILON, "{total:?}");
        assert!((0..before.len()).all(|disk| !after.held()[disk]));
        assert_eq!(after.radii()[run.centre], 0.6);
    }
}

#[test]
fn radial_and_transverse_parts_make_up_the_displacement() {
    for inflation in [Inflation::default(), periodic(0.1)] {
        let run = inflated(&inflation, dense());
        let field = DisplacementField::of_inflation(&run);
        assert_eq!(field.measured_on, MeasuredOn::Backbone);
        assert_eq!(field.disks.len(), if inflation.boundary == Boundary::Periodic { 299 } else { run.mobile_count });
        for moved in &field.disks {
            let whole = dot(moved.displacement, moved.displacement);
            let parts = moved.radial * moved.radial + moved.transverse() * moved.transverse();
            // Each part rounds a few times, relative to the whole.
            assert!((parts - whole).abs() <= 16.0 * f64::EPSILON * whole, "{moved:?}");
            let (sine, cosine) = moved.angle().sin_cos();
            let along = moved.displacement[0] * cosine + moved.displacement[1] * sine;
            assert!((along - moved.radial).abs() <= 16.0 * f64::EPSILON * whole.sqrt(), "{moved:?}");
            assert!((moved.distance - norm(moved.position)).abs() <= 4.0 * f64::EPSILON * moved.distance);
        }
        // Neighbours of a growing disk that is held are pushed away on the whole (in the periodic box it may move itself,
        // and one neighbour alone may give way sideways).
        let neighbours = field.disks.iter().filter(|moved| moved.distance < 1.3);
        assert!(inflation.boundary == Boundary::Periodic || neighbours.map(|moved| moved.radial).sum::<f64>() > 0.0);
    }
}

#[test]
fn a_packing_turned_by_a_quarter_answers_with_the_field_turned() {
    let packing = dense();
    let lengths = packing.domain().lengths().expect("prepared in a box");
    let turn = |column: &[Vector<2>]| -> Vec<Vector<2>> { column.iter().map(|&[x, y]| [-y, x]).collect() };
    let domain = Domain::rectangular([-lengths[1], 0.0], lengths);
    let turned = Packing::new(domain, turn(packing.positions()), packing.radii().to_vec())
        .and_then(|turned| turned.with_corrections(turn(packing.corrections())))
        .expect("valid");
    let label = choose_centre(packing, &hertzian(), Centre::Backbone, 1).expect("a backbone") as u64;
    let inflation = Inflation { centre: Centre::Label(label), ..periodic(0.01) };
    let fields = [packing, &turned].map(|packing| DisplacementField::of_inflation(&inflated(&inflation, packing)));
    for (one, two) in fields[0].disks.iter().zip(&fields[1].disks).filter(|(one, two)| one.counted && two.counted) {
        assert_eq!(one.disk, two.disk);
        let [x, y] = one.displacement;
        let off = norm(difference(two.displacement, [-y, x]));
        // The two take other ways to one minimum: force limit over softest stiffness, 2e-11, as in the deflation.
        assert!(off < 2e-11, "disk {}: {off:e}", one.disk);
        assert!((one.radial - two.radial).abs() < 2e-11 && (one.transverse() - two.transverse()).abs() < 2e-11);
    }
    let counted = fields.map(|field| field.counted().count());
    assert!(counted[0] == counted[1] && counted[0] > 250, "{counted:?}");
}

#[test]
fn an_unjammed_packing_is_measured_on_all_disks() {
    let run = inflated(&Inflation::default(), loose());
    assert_eq!((run.before.pressure, run.before.criterion), (0.0, Criterion::Unjammed));
    let field = DisplacementField::of_inflation(&run);
    assert_eq!(field.measured_on, MeasuredOn::AllDisks);
    assert_eq!(field.counted().count(), run.mobile_count);
}

#[test]
fn the_centre_chosen_is_a_small_disk_on_the_backbone_and_its_label_leads_back() {
    let (packing, law) = (dense(), hertzian());
    let network = ContactNetwork::new(packing, &law).expect("no coincidence");
    let mut chosen: Vec<usize> =
        (0..50).map(|seed| choose_centre(packing, &law, Centre::Backbone, seed).expect("a backbone")).collect();
    assert!(chosen.iter().all(|&disk| packing.radii()[disk] == 0.5 && network.backbone[disk]));
    chosen.sort_unstable();
    chosen.dedup();
    // 50 draws from 150: 42 different ones on average.
    assert!(chosen.len() > 30, "{} different centres of 50", chosen.len());
    assert_eq!(choose_centre(packing, &law, Centre::Label(17), 1), Ok(17));
    assert_eq!(choose_centre(packing, &law, Centre::Label(1700), 1), Err(InflationError::NoSuchLabel { label: 1700 }));
}

#[test]
fn what_cannot_be_inflated_is_refused_with_its_numbers() {
    let refused = |inflation: Inflation, packing: &Packing<2>| {
        inflate_with(&inflation, packing, &hertzian(), &fire(), 1, &mut ()).expect_err("not possible")
    };
    let error = refused(Inflation { increase: 5.0, ..Inflation::default() }, dense());
    let InflationError::IncreaseTooLarge { increase, radius, nearest } = error else { panic!("{error}") };
    assert_eq!((increase, radius), (5.0, 0.5));
    assert!(nearest > 0.8 && nearest < 1.2, "{nearest}");
    assert!(error.to_string().contains("increase is 5"), "{error}");
    let error = refused(Inflation { increase: -0.5, ..Inflation::default() }, dense());
    assert_eq!(error, InflationError::IncreaseNotPossible { increase: -0.5, radius: 0.5 });
    let error = refused(Inflation { increase: f64::NAN, ..Inflation::default() }, dense());
    assert!(matches!(error, InflationError::IncreaseNotPossible { .. }), "{error}");
    for share in [0.51, 0.0, -0.2] {
        let boundary = Boundary::HeldRim { outer_radius_over_side: share };
        let error = refused(Inflation { boundary, ..Inflation::default() }, dense());
        assert!(matches!(error, InflationError::OuterRadiusOutOfRange { .. }), "{error}");
    }
    let boundary = Boundary::HeldRim { outer_radius_over_side: 1e-3 };
    let error = refused(Inflation { boundary, ..Inflation::default() }, dense());
    assert!(matches!(error, InflationError::NoMobileDisk { .. }), "{error}");
    let open = Packing::new(Domain::Open, vec![[0.0; 2], [1.1, 0.0]], vec![0.5; 2]).expect("valid");
    assert_eq!(refused(Inflation::default(), &open), InflationError::NotPeriodic);
}

#[test]
fn too_few_steps_are_an_error_that_names_the_stage() {
    let fire = Fire { step_limit: 3, ..fire() };
    let error = inflate_with(&Inflation::default(), dense(), &hertzian(), &fire, 1, &mut ()).expect_err("too few");
    let InflationError::NotAtRest { stage, stop, step_count, .. } = &error else { panic!("{error}") };
    assert_eq!((*stage, *stop, *step_count), (Stage::Inflated, Stop::StepLimit, 3));
    assert!(error.to_string().starts_with("after the inflation: "), "{error}");
}
