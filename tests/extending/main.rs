//! What is added from outside the crate: a contact law and an observable, each in a file of less than 30 lines of code.

mod stiffening;
mod swirl;

use jamscope::displacement::{DisplacementField, MeasuredOn, Moved, Shape};
use jamscope::inflation::{Inflation, inflate_with};
use jamscope::io::read_packing;
use jamscope::law::{Hertzian, PairLaw};
use jamscope::network::ContactNetwork;
use jamscope::packing::{Mixture, Packing};
use jamscope::preparation::{Preparation, Target, prepare_with, random_points};
use jamscope::reference::{Annulus, RadialSolution, elastic::Elastic};
use jamscope::relax::{Criterion, Fire, Precision, Relaxer, Stop};
use jamscope::vector::{larger, norm};
use stiffening::Stiffening;
use swirl::swirl;

/// Stiffer by half at an overlap of 0.1.
const LAW: Stiffening = Stiffening(2e5, 0.2);

#[test]
fn a_law_and_an_observable_take_less_than_thirty_lines_of_code() {
    for text in [include_str!("stiffening.rs"), include_str!("swirl.rs")] {
        let code = text.lines().filter(|line| !line.trim().is_empty() && !line.starts_with("///"));
        let count = code.count();
        assert!(count < 30, "{count} lines");
    }
}

#[test]
fn the_force_of_a_new_law_is_minus_the_slope_of_its_energy() {
    let coefficient = LAW.coefficient(0.5, 0.7);
    let energy = |overlap: f64| LAW.energy(LAW.force(coefficient, overlap), overlap);
    for overlap in [1e-6, 1e-3, 0.05, 0.3] {
        let h = 1e-5 * overlap;
        // δ = R_i + R_j − r: minus the slope in r is the slope in δ. Central differences: truncation below (h/δ)² = 1e-10,
        // rounding ε/(h/δ) = 2e-11; a few of each.
        let (force, slope) = (LAW.force(coefficient, overlap), (energy(overlap + h) - energy(overlap - h)) / (2.0 * h));
        assert!((slope / force - 1.0).abs() < 1e-9, "{overlap}: {slope} for {force}");
        let slope = (LAW.force(coefficient, overlap + h) - LAW.force(coefficient, overlap - h)) / (2.0 * h);
        assert!((slope / LAW.stiffness(force, overlap) - 1.0).abs() < 1e-9, "{overlap}: {slope}");
        // In closed form, to a few roundings.
        let closed = 2e5 * overlap * overlap * (0.5 + overlap / 0.6);
        assert!((energy(overlap) / closed - 1.0).abs() < 8.0 * f64::EPSILON, "{overlap}");
    }
}

/// The energy of a packing under the new law.
fn energy(packing: &Packing<2>) -> f64 {
    ContactNetwork::new(packing, &LAW).expect("no coincidence").energy()
}

#[test]
fn a_law_that_is_no_power_is_never_computed_in_single_precision() {
    let points = || random_points::<2>(200, &Mixture::default(), 0.92, 1).expect("valid");
    let positions = |precision: Precision| {
        let outcome = Fire { precision, ..Fire::default() }.relax(points(), &LAW, &mut ()).expect("no coincidence");
        outcome.converged().expect("at rest").into_inner().positions().to_vec()
    };
    // The same bits: mixed precision falls back to double.
    assert_eq!(positions(Precision::Mixed), positions(Precision::Double));
}

#[test]
fn fire_brings_a_packing_to_rest_under_a_new_law() {
    let points = random_points::<2>(200, &Mixture::default(), 0.92, 1).expect("valid");
    let outcome = Fire::default().relax(points, &LAW, &mut ()).expect("no coincidence");
    assert_eq!(outcome.stop, Stop::Converged(Criterion::RelativeForce));
    let packing = outcome.converged().expect("at rest").into_inner();
    let network = ContactNetwork::new(&packing, &LAW).expect("no coincidence");
    assert!(network.coordination() > 4.0, "rigid: {}", network.coordination());

    // A minimum: moving a disk by h either way costs energy, to second order the same.
    let (h, mean) = (1e-5, network.mean_contact_force());
    for disk in network.contacts.iter().map(|contact| contact.first as usize).take(20) {
        let moved = |step: f64| {
            let mut corrections = packing.corrections().to_vec();
            corrections[disk][0] += step;
            energy(&packing.clone().with_corrections(corrections).expect("finite"))
        };
        let (left, right) = (moved(-h), moved(h));
        // Net forces are below 10⁻⁸ ⟨F⟩ (the criterion); sums of some 500 terms round to 10⁻¹⁴ of the energy; contacts that
        // open or stiffen are of third order, h²/s of a force.
        let tolerance = 2e-8 * mean + 1e-14 * network.energy() / h + 2e5 * h * h / 0.2;
        assert!(
            ((right - left) / (2.0 * h)).abs() < tolerance,
            "disk {disk}: {} above {tolerance}",
            (right - left) / h
        );
    }
}

#[test]
fn a_packing_under_a_new_law_is_prepared_and_inflated() {
    let (target, fire) = (Target::Pressure(2000.0), Fire::default());
    let preparation = Preparation {
        disk_count: 200,
        mixture: Mixture::default(),
        target,
        tolerance: 0.01,
        seed: 1,
        ..Preparation::default()
    };
    let prepared = prepare_with::<2>(&preparation, &LAW, &fire, &mut ()).expect("a packing");
    assert!((prepared.pressure / 2000.0 - 1.0).abs() <= 0.01);
    let inflated =
        inflate_with(&Inflation::default(), prepared.packing.get(), &LAW, &fire, 1, &mut ()).expect("at rest");
    // Neighbours are pushed away from a disk that grows.
    let field = DisplacementField::of_inflation(&inflated);
    let nearest = field.counted().min_by(|a, b| a.distance.total_cmp(&b.distance)).expect("a disk");
    assert!(nearest.radial > 0.0, "{nearest:?}");
}

/// The field of disks at these places that are displaced by `displacement`.
fn field(displacement: impl Fn([f64; 2]) -> [f64; 2]) -> DisplacementField<2> {
    let disk = |index: usize| {
        // A sunflower: even in area, no two at one angle.
        let (distance, angle) = (2.0 + (index as f64).sqrt(), 2.399_963 * index as f64);
        let position = [distance * angle.cos(), distance * angle.sin()];
        let (distance, displacement) = (norm(position), displacement(position));
        let radial = (displacement[0] * position[0] + displacement[1] * position[1]) / distance;
        Moved { disk: index, position, distance, displacement, radial, counted: !index.is_multiple_of(7) }
    };
    let disks = (0..300).map(disk).collect();
    DisplacementField {
        disks,
        inner_radius: 0.5,
        outer_radius: 20.0,
        shape: Shape::Round,
        measured_on: MeasuredOn::Backbone,
    }
}

#[test]
fn the_swirl_of_a_rotation_is_its_angle_and_that_of_an_elastic_field_is_nothing() {
    // Turned by ω about the centre, on top of the elastic solution: d_θ = r sin ω + d_r(r) · 0.
    let medium = Elastic::<2>::new(Annulus::new(0.5, 20.0).expect("in order"), 0.1).expect("finite");
    for angle in [0.0f64, 1e-9, 0.01, -0.3] {
        let turned = field(|[x, y]| {
            let out = medium.value(f64::hypot(x, y)) / f64::hypot(x, y);
            let (sine, less) = (angle.sin(), angle.cos() - 1.0);
            [x * less - y * sine + out * x, x * sine + y * less + out * y]
        });
        for (from, to) in [(0.0, 20.0), (5.0, 8.0)] {
            let found = swirl(&turned, from, to).expect("disks");
            // A few roundings of d (up to 0.1 radial, 20·|ω| across) over distances of at least 2.
            let tolerance = 8.0 * f64::EPSILON * (0.1 + angle.abs());
            assert!((found - angle.sin()).abs() < tolerance, "{angle}, from {from}: {found}");
        }
    }
    assert_eq!(swirl(&field(|place| place), 20.0, 30.0), None);
}

#[test]
fn the_swirl_of_a_response_is_below_that_of_its_disks_and_changes_sign_in_a_mirror() {
    let packing = read_packing::<2>("fixtures/packings/hertz_N1000_p800.xyz").expect("readable");
    let law = Hertzian::default();
    let inflated = inflate_with(&Inflation::default(), &packing, &law, &Fire::default(), 1, &mut ()).expect("at rest");
    let field = DisplacementField::of_inflation(&inflated);
    let whole = swirl(&field, 0.0, field.outer_radius).expect("disks");
    // No disk turns by more than the largest of them, and a mean not by more than that.
    let most = field.counted().map(|disk| (disk.transverse() / disk.distance).abs()).fold(0.0, larger);
    assert!(whole.abs() < most && whole != 0.0, "{whole} of at most {most}");
    let mirror = |[x, y]: [f64; 2]| [x, -y];
    let mirrored = field.disks.iter().map(|disk| Moved {
        position: mirror(disk.position),
        displacement: mirror(disk.displacement),
        ..*disk
    });
    let mirrored = DisplacementField { disks: mirrored.collect(), ..field.clone() };
    // To the bit: every term changes its sign.
    assert_eq!(swirl(&mirrored, 0.0, field.outer_radius), Some(-whole));
}
