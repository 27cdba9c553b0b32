//! Linear responses to forces and moved disks, the changes of contacts and pressure that go with them, and the plastic part.

use jamscope::inflation::{Boundary, Centre, Circle, Inflated, Inflation, inflate_with};
use jamscope::io::read_packing;
use jamscope::lattice::Lattice;
use jamscope::law::PairLaw;
use jamscope::linear::contact_changes::pressure_change;
use jamscope::linear::{Hessian, Members, Prestress};
use jamscope::linear::{LinearError, LinearResponse};
use jamscope::network::ContactNetwork;
use jamscope::packing::{Packing, ball_volume};
use jamscope::plastic::{LinearRangeSearch, PlasticPart, linear_range};
use jamscope::relax::{Fire, ForceLimit, Relaxed, Relaxer};
use jamscope::vector::{Vector, difference, larger, norm};

use crate::scenes::laws::{hertzian, hookean};

fn fire() -> Fire {
    Fire { limit: ForceLimit::Relative(1e-13), step_limit: 500_000, ..Fire::default() }
}

fn at_rest(packing: Packing<2>, law: &dyn PairLaw) -> Relaxed<Packing<2>> {
    fire().relax(packing, law, &mut ()).expect("no coincidence").converged().expect("at rest")
}

fn dense() -> Packing<2> {
    read_packing("fixtures/packings/hertz_N1000_p800.xyz").expect("readable")
}

fn inflated(increase: f64, boundary: Boundary) -> Inflated<2> {
    let inflation = Inflation { increase, boundary, centre: Centre::Backbone, ..Inflation::default() };
    inflate_with(&inflation, &dense(), &hertzian(), &fire(), 1, &mut ()).expect("at rest")
}

fn response(inflated: &Inflated<2>) -> LinearResponse<2> {
    LinearResponse::of_inflation(inflated.before.packing.get(), inflated.centre, &hertzian(), Prestress::Included)
        .expect("a response")
}

#[test]
fn contact_forces_and_pressure_change_as_small_inflations_say() {
    let law = hertzian();
    for boundary in [Boundary::default(), Boundary::Periodic] {
        let increase = 1e-6;
        let inflated = inflated(increase, boundary);
        let (before, after) = (inflated.before.packing.get(), inflated.after.packing.get());
        let changes = response(&inflated).contact_changes(before, &law).expect("no coincidence");
        let networks = [before, after].map(|packing| ContactNetwork::new(packing, &law).expect("no coincidence"));
        let largest = changes.iter().map(|change| change.force_change.abs()).fold(0.0, larger);
        for change in &changes {
            let force_and_virial = |network: &ContactNetwork<2>| {
                let same = |pair: (u32, u32)| pair == (change.first, change.second);
                let contact = network.contacts.iter().find(|contact| same((contact.first, contact.second)));
                contact.map_or((0.0, 0.0), |contact| (contact.force, contact.force * norm(contact.separation)))
            };
            let ((force, virial), (force_before, virial_before)) =
                (force_and_virial(&networks[1]), force_and_virial(&networks[0]));
            let (found, found_virial) = ((force - force_before) / increase, (virial - virial_before) / increase);
            // The next order is d_0 over the smallest overlaps in play, 10⁻⁶/10⁻³, of the changes; forces at rest to 10⁻¹³ ⟨F⟩
            // over softest stiffness, 10⁻¹¹ of F' over d_0.
            assert!((found - change.force_change).abs() < 2e-3 * largest, "{change:?}: {found}");
            // F dr is a few hundredths of dF r here (the overlap over the distance).
            assert!((found_virial - change.virial_change).abs() < 2e-3 * largest, "{change:?}: {found_virial}");
        }
        let (volume, rim): (f64, &dyn Fn(usize) -> bool) = match boundary {
            Boundary::Periodic => (before.domain().volume().expect("periodic"), &|_| false),
            _ => (ball_volume::<2>(inflated.outer_radius), &|disk| disk > inflated.centre),
        };
        let expected = pressure_change::<2>(&changes, volume, rim);
        let found = (inflated.after.pressure - inflated.before.pressure) / increase;
        assert!((found / expected - 1.0).abs() < 2e-3, "{boundary:?}: {found}, not {expected}");
    }
}

/// The disks of a circle, and its centre.
fn circle() -> (Packing<2>, usize) {
    let packing = dense();
    let side = packing.domain().lengths().expect("periodic")[0];
    let circle = Circle::cut(&packing, 17, 0.48 * side).expect("a circle");
    (at_rest(circle.packing, &hertzian()).into_inner(), circle.centre)
}

#[test]
fn forces_are_answered_by_displacements_whose_hessian_gives_them_back() {
    let law = hertzian();
    let push: Vec<Vector<2>> = (0..1000).map(|disk| [f64::sin(disk as f64), f64::cos(3.0 * disk as f64)]).collect();
    let (circle, _) = circle();
    for packing in [at_rest(dense(), &law).into_inner(), circle] {
        let hessian = Hessian::new(&packing, &law, Members::Backbone, Prestress::Included).expect("no coincidence");
        let mut forces = push.clone();
        forces.resize(packing.len(), [1.0, -2.0]);
        let answer = LinearResponse::of_forces(&packing, &forces, &law, Prestress::Included).expect("a response");
        let mut given = vec![0.0; hessian.matrix().dimension()];
        hessian.matrix().multiply(&hessian.gather(&answer.displacements), &mut given);
        // In a periodic box the mean force has no answer; on the circle every force on a disk of the backbone is given back.
        let mut wanted = hessian.gather(&forces);
        if !packing.held().contains(&true) {
            for axis in 0..2 {
                let mean = wanted.iter().skip(axis).step_by(2).sum::<f64>() / hessian.disks().len() as f64;
                wanted.iter_mut().skip(axis).step_by(2).for_each(|force| *force -= mean);
            }
            let shift = answer.displacements.iter().fold([0.0; 2], |sum, u| [sum[0] + u[0], sum[1] + u[1]]);
            let size = answer.displacements.iter().fold(0.0, |most, u| larger(most, norm(*u)));
            assert!(norm(shift) < 1e-12 * size * packing.len() as f64, "{shift:?} of {size}");
        }
        // Backward error of 10⁻¹⁵ of ‖A‖ ‖x‖.
        let size = answer.displacements.as_flattened().iter().fold(0.0, |most, x| larger(most, x.abs()));
        let tolerance = 1e-14 * hessian.matrix().norm() * size;
        for (given, wanted) in given.iter().zip(&wanted) {
            assert!((given - wanted).abs() < tolerance, "{given}, not {wanted} ± {tolerance:e}");
        }
    }
}

#[test]
fn a_held_rim_moved_as_a_whole_takes_the_packing_with_it_and_stretched_it_is_followed_by_a_relaxation() {
    let law = hertzian();
    let (packing, _) = circle();
    let held: Vec<usize> = (0..packing.len()).filter(|&disk| packing.held()[disk]).collect();
    let moved: Vec<_> = held.iter().map(|&disk| (disk, [0.3, -0.7])).collect();
    let answer = LinearResponse::of_displacements(&packing, &moved, &law, Prestress::Included).expect("a response");
    for disk in (0..packing.len()).filter(|&disk| answer.solved[disk] || packing.held()[disk]) {
        // Rounding 10⁻¹⁶ times the condition, which is some 10⁴ to 10⁶ here.
        assert!(norm(difference(answer.displacements[disk], [0.3, -0.7])) < 1e-9, "disk {disk}");
    }
    // Every held disk moved in proportion to its place: a stretch by 10⁻⁷, followed by FIRE.
    let stretch = 1e-7;
    let moved: Vec<_> = held.iter().map(|&disk| (disk, packing.positions()[disk])).collect();
    let answer = LinearResponse::of_displacements(&packing, &moved, &law, Prestress::Included).expect("a response");
    let corrections = (0..packing.len())
        .map(|disk| {
            let share = if packing.held()[disk] { stretch } else { 0.0 };
            let (position, correction) = packing.centre(disk);
            [correction[0] + share * position[0], correction[1] + share * position[1]]
        })
        .collect();
    let stretched = packing.clone().with_corrections(corrections).expect("finite");
    let after = at_rest(stretched, &law);
    let size = answer.displacements.iter().fold(0.0, |most, u| larger(most, norm(*u)));
    for disk in (0..packing.len()).filter(|&disk| answer.solved[disk]) {
        let ((a, a_low), (b, b_low)) = (after.get().centre(disk), packing.centre(disk));
        let found: Vector<2> = std::array::from_fn(|d| ((a[d] - b[d]) + (a_low[d] - b_low[d])) / stretch);
        // The next order: strain over the smallest overlaps over a diameter, 10⁻⁷ · 20/10⁻³, of the displacements.
        assert!(norm(difference(found, answer.displacements[disk])) < 2e-3 * size, "disk {disk}: {found:?}");
    }
}

#[test]
fn loads_that_cannot_be_are_refused() {
    let (packing, centre) = circle();
    let law = hookean();
    let forces = |forces: &[Vector<2>]| LinearResponse::of_forces(&packing, forces, &law, Prestress::Included);
    let disk_count = packing.len();
    assert_eq!(forces(&[[0.0; 2]; 3]), Err(LinearError::LoadNotOneADisk { found: 3, disk_count }));
    let mut load = vec![[0.0; 2]; disk_count];
    load[5][1] = f64::NAN;
    assert_eq!(forces(&load), Err(LinearError::LoadNotFinite { disk: 5 }));
    let moved =
        |moved: &[(usize, Vector<2>)]| LinearResponse::of_displacements(&packing, moved, &law, Prestress::Included);
    assert_eq!(moved(&[(disk_count, [0.0; 2])]), Err(LinearError::NoSuchDisk { disk: disk_count, disk_count }));
    assert_eq!(moved(&[(3, [0.0; 2])]), Err(LinearError::NotHeld { disk: 3 }));
    assert_eq!(moved(&[(centre, [0.0, f64::INFINITY])]), Err(LinearError::LoadNotFinite { disk: centre }));
}

#[test]
fn the_plastic_part_vanishes_with_the_inflation_and_is_all_there_is_beyond() {
    // As long as contacts stay its share falls as d_0.
    let parts: Vec<PlasticPart<2>> = [1e-5, 1e-6]
        .map(|increase| {
            let inflated = inflated(increase, Boundary::default());
            PlasticPart::of(&inflated, &response(&inflated))
        })
        .into();
    let order = (parts[0].share / parts[1].share).log10();
    assert!((order - 1.0).abs() < 0.05, "order {order}: {}, {}", parts[0].share, parts[1].share);
    for part in &parts {
        let count = part.field.counted().count() as f64;
        assert!(
            part.participation_ratio >= 1.0 / count && part.participation_ratio <= 1.0,
            "{}",
            part.participation_ratio
        );
        let squares: f64 = part.field.counted().map(|disk| norm(disk.displacement).powi(2)).sum();
        assert!((part.norm / squares.sqrt() - 1.0).abs() < 1e-14);
    }
    // An inflation by a tenth of a diameter changes contacts: what is not linear is a good part of the response.
    let large = inflated(0.1, Boundary::default());
    assert!(PlasticPart::of(&large, &response(&large)).share > 0.05);
}

#[test]
fn one_disk_alone_has_a_participation_ratio_of_one_over_n() {
    let run = inflated(1e-6, Boundary::default());
    let mut answer = response(&run);
    // A response that differs from the relaxed one in a single disk, by far.
    let field = jamscope::displacement::DisplacementField::of_inflation(&run);
    for disk in &field.disks {
        answer.displacements[disk.disk] = disk.displacement.map(|x| x / 1e-6);
    }
    let odd = field.counted().next().expect("a disk").disk;
    answer.displacements[odd] = [1e3, 0.0];
    let part = PlasticPart::of(&run, &answer);
    let count = part.field.counted().count() as f64;
    // The others differ by the rounding of a quotient: 10⁻¹⁶ of 10⁻⁶, beside 10⁻³.
    assert!((part.participation_ratio * count - 1.0).abs() < 1e-12, "{}", part.participation_ratio * count);
}

#[test]
fn a_lattice_is_linear_until_its_deviation_is_a_hundredth_and_keeps_its_contacts_as_far_as_said() {
    let (lattice, law) = (Lattice::triangular(0.5, 0.0625).expect("touching"), hookean());
    let circle = lattice.circle(8.0).expect("a circle");
    let packing = at_rest(circle.packing.clone(), &law);
    let response =
        LinearResponse::of_inflation(packing.get(), circle.centre, &law, Prestress::Included).expect("a response");
    let search = LinearRangeSearch { largest: 0.4, smallest: 1e-4, halving_count: 12, ..LinearRangeSearch::default() };
    let range = linear_range(&packing, &response, &law, &fire(), &search).expect("at rest");
    // The smallest d_0 is linear and the largest is not; the ends are a (4000)^(1/4096) apart.
    let (good, bad) = (range.linear_up_to, range.not_linear_from.expect("0.4 is far"));
    assert!(good > 1e-4 && bad < 0.4 && bad / good < 1.003, "{range:?}");
    // Where it ends the deviation is the tolerance: the inflation there says so itself.
    let deviation = |increase: f64| {
        let grown = packing.get().clone().with_radius(circle.centre, 0.5 + increase).expect("possible");
        let after = at_rest(grown, &law);
        let (mut off, mut all) = (0.0, 0.0);
        for disk in (0..packing.get().len()).filter(|&disk| response.solved[disk]) {
            let ((a, a_low), (b, b_low)) = (after.get().centre(disk), packing.get().centre(disk));
            let u = response.displacements[disk];
            off += (0..2).map(|d| ((a[d] - b[d]) + (a_low[d] - b_low[d]) - increase * u[d]).powi(2)).sum::<f64>();
            all += increase * increase * (u[0] * u[0] + u[1] * u[1]);
        }
        (off / all).sqrt()
    };
    assert!(deviation(good) <= 0.01 && deviation(bad) > 0.01, "{} {}", deviation(good), deviation(bad));
    // Contacts open at the ring around the neighbours; the linear response foresees it within its own error.
    let (first, kept) = (range.first_opening.expect("some open"), range.contacts_kept_up_to);
    let changed = range.contact_change_from.expect("0.4 is far");
    assert!(kept < changed && changed / kept < 1.003, "{range:?}");
    assert!((first / changed - 1.0).abs() < 0.3, "foreseen {first}, found {changed}");
    assert!(range.cost.force_evaluation_count > 0);
}
