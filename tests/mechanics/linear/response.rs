//! The linear response as the limit of relaxations.

use jamscope::displacement::{DisplacementField, MeasuredOn};
use jamscope::inflation::{Boundary, Centre, Circle, Inflation, inflate_with};
use jamscope::lattice::Lattice;
use jamscope::law::{OnSite, PairLaw, PowerLaw};
use jamscope::linear::Prestress;
use jamscope::linear::{LinearError, LinearResponse};
use jamscope::network::ContactNetwork;
use jamscope::packing::Packing;
use jamscope::preparation::random_points;
use jamscope::relax::Relaxer;
use jamscope::vector::{difference, larger, norm, scaled, sum};

use super::{fire, fixture};

use crate::scenes::laws::{hertzian, hookean};

/// Largest difference of two fields of displacements, but for a translation where that is `free`, and the largest displacement.
fn compare<const D: usize>(nonlinear: &DisplacementField<D>, linear: &DisplacementField<D>, free: bool) -> (f64, f64) {
    assert_eq!(nonlinear.disks.len(), linear.disks.len());
    let both = || nonlinear.disks.iter().zip(&linear.disks).filter(|(a, _)| a.counted);
    let apart = both().map(|(a, b)| difference(a.displacement, b.displacement)).fold([0.0; D], sum);
    let shift = if free { scaled(1.0 / both().count() as f64, apart) } else { [0.0; D] };
    both().fold((0.0, 0.0), |(off, most), (a, b)| {
        assert!(a.disk == b.disk && b.counted);
        let apart = difference(difference(a.displacement, b.displacement), shift);
        (larger(off, norm(apart)), larger(most, norm(a.displacement)))
    })
}

/// Nonlinear minus linear for these d_0: (d_0, largest difference, largest displacement, contacts of the backbone as before).
fn departures<const D: usize>(
    packing: &Packing<D>,
    law: &dyn PairLaw,
    base: &Inflation,
    increases: impl Iterator<Item = f64>,
) -> Vec<(f64, f64, f64, bool)> {
    increases
        .map(|asked| {
            // What the radius really grows by.
            let label = base.centre;
            let inflation = Inflation { increase: asked, centre: label, ..*base };
            let run = inflate_with(&inflation, packing, law, &fire(2e-14), 1, &mut ()).expect("at rest");
            let (before, after) = (run.before.packing.get(), run.after.packing.get());
            let increase = after.radii()[run.centre] - run.inner_radius;
            let response =
                LinearResponse::of_inflation(before, run.centre, law, Prestress::Included).expect("a response");
            assert_eq!(response.negative_eigenvalue_count, 0);
            let linear = DisplacementField::of_linear_response(&response, before, increase, run.outer_radius);
            assert_eq!(linear.measured_on, MeasuredOn::Backbone);
            // A rattler that its cage pushes on takes momentum with it, and what is not held moves the other way.
            let pushed = matches!(base.boundary, Boundary::Periodic) && run.before.rattler_count > 0;
            let (off, most) = compare(&DisplacementField::of_inflation(&run), &linear, pushed);
            let links = |packing| -> Vec<(u32, u32)> {
                let network = ContactNetwork::new(packing, law).expect("apart");
                network.backbone_contacts().map(|contact| (contact.first, contact.second)).collect()
            };
            (increase, off, most, links(before) == links(after))
        })
        .collect()
}

/// Over so many decades the difference falls by the square of d_0: at their end it is 10⁻¹⁴ to 10⁻¹³, not far
/// above what the states at rest are known to.
fn falls_as_the_square(what: &str, departures: &[(f64, f64, f64, bool)], decades: f64) {
    for &(increase, off, most, same) in departures {
        println!(
            "{what}: d_0 = {increase:.3e}, moved {most:.3e}, nonlinear − linear {off:.3e}, {:.4e} d_0²",
            off / increase.powi(2)
        );
        assert!(same, "{what}: contacts changed at d_0 = {increase}");
    }
    for pair in departures.windows(2) {
        let order = (pair[1].1 / pair[0].1).log2() / (pair[1].0 / pair[0].0).log2();
        assert!((order - 2.0).abs() < 0.1, "{what}: order {order} between {} and {}", pair[0].0, pair[1].0);
    }
    let (first, last) = (departures[0].0, departures[departures.len() - 1].0);
    assert!((first / last).log10() >= decades, "{what}: {first} to {last}");
}

/// d_0 = 2^−from, 2^−(from + 3), …
fn powers(from: i32, count: i32) -> impl Iterator<Item = f64> {
    (0..count).map(move |k| (-f64::from(from + 3 * k)).exp2())
}

#[test]
fn on_a_lattice_nonlinear_minus_linear_falls_as_the_square_of_the_inflation() {
    let packing = Lattice::triangular(0.5, 0.0625).expect("valid").periodic([16, 9]).expect("a lattice");
    let rim = Inflation {
        boundary: Boundary::HeldRim { outer_radius_over_side: 0.45 },
        centre: Centre::Label(100),
        ..Default::default()
    };
    let held = departures(&packing, &hertzian(), &rim, powers(7, 6));
    falls_as_the_square("Hertzian, held rim", &held, 4.5);
    // A Hookean lattice is nonlinear by its geometry alone: 30 times less, so the floor is met earlier.
    falls_as_the_square("Hookean, held rim", &departures(&packing, &hookean(), &rim, powers(5, 6)), 4.5);
    let periodic = Inflation { boundary: Boundary::Periodic, ..rim };
    falls_as_the_square("Hertzian, periodic", &departures(&packing, &hertzian(), &periodic, powers(7, 6)), 4.5);
    // Tied to its sites the packing is held by them, and nothing has to be held for the solution.
    let law = OnSite { law: hertzian(), coupling: -5e3 };
    falls_as_the_square("tied, periodic", &departures(&packing, &law, &periodic, powers(7, 6)), 4.5);
    let law = PowerLaw { energy_scale: 1.0, exponent: 3.0 };
    falls_as_the_square("power law, held rim", &departures(&packing, &law, &rim, powers(7, 6)), 4.5);
}

#[test]
fn on_a_jammed_packing_nonlinear_minus_linear_falls_as_the_square_of_the_inflation() {
    let packing = fixture("hertz_N1000_p800");
    // Disks whose inflation by 2⁻⁸ opens and closes no contact anywhere in the circle; that of most does.
    let of = |label, outer_radius_over_side| {
        let boundary = Boundary::HeldRim { outer_radius_over_side };
        Inflation { boundary, centre: Centre::Label(label), ..Default::default() }
    };
    falls_as_the_square("p = 800", &departures(&packing, &hertzian(), &of(71, 0.45), powers(8, 6)), 4.5);
    let packing = fixture("hooke_N1000_p5000");
    falls_as_the_square("Hookean, p = 5000", &departures(&packing, &hookean(), &of(7, 0.3), powers(8, 6)), 4.5);
}

/// Random centres, d_0 from 2⁻¹⁹ up by eights until a contact changes, which happens within eight of the last that counts.
/// Where a contact would open at d_c its force, (d_c − d_0)^(α−1), has powers of d_0/d_c with factors of size one, and the
/// difference as well: b d_0² (1 + c d_0/d_c), |c| ≤ 1. Between d_0 = x d_c and an eighth of it the order is then off 2 by up to
/// |log₈((1 − x)/(1 − x/8))|. Both states are at rest to 2·10⁻¹⁴ ⟨F⟩, over F' = (α − 1) F/δ and δ ≈ 0.03 a way of 10⁻¹⁵, along
/// soft modes ten times that: 10⁻¹⁴ over the smaller difference is what is left of digits.
#[test]
fn on_random_packings_the_responses_agree_to_first_order_until_the_first_contact_changes() {
    fn check(law: &dyn PairLaw, name: &str, boundary: Boundary) {
        let packing = fixture(name);
        let network = ContactNetwork::new(&packing, law).expect("apart");
        let small = (0..packing.len()).filter(|&disk| packing.radii()[disk] == 0.5 && network.backbone[disk]);
        for label in small.skip(11).step_by(97).take(4) {
            let inflation = Inflation { boundary, centre: Centre::Label(label as u64), ..Default::default() };
            let mut found: Vec<(f64, f64, f64, bool)> = Vec::new();
            for power in [-19, -16, -13, -10, -7] {
                found.extend(departures(&packing, law, &inflation, std::iter::once(f64::from(power).exp2())));
                if !found[found.len() - 1].3 {
                    found.pop();
                    break;
                }
            }
            assert!(found.len() >= 3, "{name}, {label}: a contact changed within the first {} inflations", found.len());
            for (below, pair) in (0..found.len() - 1).rev().zip(found.windows(2)) {
                let order = (pair[1].1 / pair[0].1).ln() / (pair[1].0 / pair[0].0).ln();
                println!("{name}, {label}: d_0 = {:.2e}, {:.3e} off, order {order:.4}", pair[1].0, pair[1].1);
                let x = 0.9 * 0.125f64.powi(below as i32);
                let allowed = (((1.0 - x) / (1.0 - x / 8.0)).ln().abs() + 1e-14 / pair[0].1) / 8f64.ln();
                assert!((order - 2.0).abs() <= allowed, "{name}, {label}: order {order} at {}", pair[1].0);
            }
        }
    }
    let rim = Boundary::HeldRim { outer_radius_over_side: 0.45 };
    check(&hertzian(), "hertz_N1000_p800", rim);
    check(&hertzian(), "hertz_N1000_p100", rim);
    check(&hookean(), "hooke_N1000_p5000", rim);
    // With rattlers, which stay where they are.
    check(&hertzian(), "hertz_N1000_p100", Boundary::Periodic);
}

/// A circle out of a stored packing, its rim held, and its centre unless it is to be free.
fn circle_at(label: usize, held: bool) -> Circle<2> {
    let mut circle = Circle::cut(&fixture("hertz_N1000_p100"), label, 14.0).expect("a circle");
    if !held {
        let rim = (0..circle.packing.len()).map(|disk| disk > circle.centre).collect();
        circle.packing = circle.packing.with_held(rim).expect("one a disk");
    }
    circle
}

#[test]
fn disks_that_grow_one_after_another_answer_as_each_alone() {
    let law = hertzian();
    let each = |packing: &Packing<2>, centres: &[usize], bound: f64| {
        let mut found = 0;
        LinearResponse::of_inflations(packing, centres, &law, Prestress::Included, |response| {
            let alone = LinearResponse::of_inflation(packing, centres[found], &law, Prestress::Included);
            let alone = alone.expect("a response");
            let apart = response.displacements.iter().zip(&alone.displacements).map(|(&a, &b)| norm(difference(a, b)));
            let apart = apart.fold(0.0, larger);
            assert!(apart <= bound, "{apart:e}");
            assert_eq!((response.growing, response.solved.len()), (alone.growing, alone.solved.len()));
            found += 1;
        })
        .expect("all on the backbone");
        assert_eq!(found, centres.len());
    };
    let circle = circle_at(71, true);
    let network = ContactNetwork::new(&circle.packing, &law).expect("apart");
    let some =
        |backbone: &[bool]| -> Vec<usize> { (0..backbone.len()).filter(|&disk| backbone[disk]).step_by(111).collect() };
    // The same matrix: the same bits.
    each(&circle.packing, &some(&network.backbone[..circle.centre]), 0.0);
    // Another disk is pinned: displacements of size one, the solution's error of 10⁻¹⁶ times a condition of 10⁴ at most.
    let packing = fixture("hertz_N1000_p100");
    let network = ContactNetwork::new(&packing, &law).expect("apart");
    each(&packing, &some(&network.backbone), 1e-12);
    each(&packing, &[], 0.0);
    // A rattler stays, and so does the centre of mass of the backbone: sums of a thousand displacements of size one at most.
    let rattler = network.backbone.iter().position(|&member| !member).expect("there are rattlers");
    LinearResponse::of_inflations(&packing, &some(&network.backbone)[..1], &law, Prestress::Included, |response| {
        assert_eq!(response.displacements[rattler], [0.0; 2]);
        assert!(norm(response.displacements.iter().copied().fold([0.0; 2], sum)) < 1e-11);
    })
    .expect("on the backbone");
    // A rattler that is to grow ends it, with its name.
    let first = some(&network.backbone)[0];
    let mut visited = 0;
    let end = LinearResponse::of_inflations(&packing, &[first, rattler, first], &law, Prestress::Included, |_| {
        visited += 1;
    });
    assert_eq!((visited, end), (1, Err(LinearError::CentreTouchesNothing { disk: rattler })));
}

#[test]
fn what_is_held_takes_up_the_force_and_what_is_free_none() {
    let law = hertzian();
    let mut forces = [0.0; 2];
    for held in [true, false] {
        let circle = circle_at(71, held);
        let (packing, centre) = (&circle.packing, circle.centre);
        let response = LinearResponse::of_inflation(packing, centre, &law, Prestress::Included).expect("a response");
        let on = |disk: usize| response.force_change(packing, &law, disk).expect("apart");
        forces[usize::from(!held)] = norm(on(centre));
        // Action and reaction: what holds the rim takes up what the centre is pushed with. Terms of stiffness 10³ a disk,
        // two hundred disks of the rim.
        let total = (centre..packing.len()).map(on).fold([0.0; 2], sum);
        assert!(norm(total) < 1e-9, "{total:?}");
        // And every disk that can move is at rest again.
        let most = (0..centre).step_by(7).map(|disk| norm(on(disk))).fold(0.0, larger);
        assert!(most < 1e-9, "{most:e}");
        if held {
            // The same from the forces of the inflated circle at rest, to the first order in d_0.
            let increase = 2f64.powi(-22);
            let grown = packing.clone().with_radius(centre, packing.radii()[centre] + increase).expect("positive");
            let rest = fire(2e-14).relax(grown, &law, &mut ()).expect("apart").converged().expect("at rest");
            let pushed = |packing: &Packing<2>| ContactNetwork::new(packing, &law).expect("apart").forces()[centre];
            let change = scaled(1.0 / increase, difference(pushed(rest.get()), pushed(packing)));
            let off = norm(difference(change, on(centre)));
            // The next order is d_0 over overlaps of 10⁻²: 2·10⁻⁵ of 10³; forces of 10² at rest to 2·10⁻¹⁴, over d_0.
            assert!(off < 0.1, "{off}, of {:?}", on(centre));
        }
    }
    assert!(forces[0] > 100.0 && forces[1] < 1e-9, "{forces:?}");
}

#[test]
fn balls_answer_in_the_same_way() {
    let packing = random_points::<3>(200, &Default::default(), 1.0, 4).expect("possible");
    let packing = fire(1e-12).relax(packing, &hertzian(), &mut ()).expect("apart");
    let packing = packing.converged().expect("at rest").into_inner();
    let inflation = Inflation { boundary: Boundary::Periodic, ..Default::default() };
    falls_as_the_square("balls", &departures(&packing, &hertzian(), &inflation, powers(12, 5)), 3.6);
}

#[test]
fn a_hessian_without_prestress_answers_otherwise() {
    let circle: Circle<2> = Lattice::triangular(0.5, 0.0625).expect("valid").circle(8.0).expect("a circle");
    let law = hertzian();
    let [with, without] = [Prestress::Included, Prestress::LeftOut].map(|prestress| {
        LinearResponse::of_inflation(&circle.packing, circle.centre, &law, prestress).expect("a response")
    });
    let largest = with.displacements.iter().map(|&u| norm(u)).fold(0.0, larger);
    let off = with.displacements.iter().zip(&without.displacements).map(|(&a, &b)| norm(difference(a, b)));
    // F/(r F') = δ/(1.5 r) = 0.044 of the stiffness.
    let off = off.fold(0.0, larger) / largest;
    assert!(off > 0.005 && off < 0.2, "{off}");
}
