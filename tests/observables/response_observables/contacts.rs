use jamscope::inflation::{Inflation, inflate_with};
use jamscope::law::{Hertzian, Hookean};
use jamscope::network::ContactNetwork;
use jamscope::observe::contact_changes::{ContactChanges, ContactCycle, RattlerContacts};
use jamscope::observe::{PressureChange, State};
use jamscope::packing::{Mixture, Packing};
use jamscope::preparation::{Preparation, Target, prepare_with};
use jamscope::relax::Fire;
use jamscope::vector::{Vector, norm};

use super::{COLUMNS, SPACING, lattice, lattice_positions};

fn state(packing: &Packing<2>) -> State<'_, 2> {
    State::new(packing, &Hookean::default()).expect("sound disks")
}

/// Disk 2 of row 3 and disk 4 of row 5, whose left neighbours are the disks before them.
const MOVING: usize = 3 * COLUMNS + 2;
const RETURNING: usize = 5 * COLUMNS + 4;

/// By so much a disk moves to the right: its contact to the left opens (0.99 + 0.015 > 1), those at ±120° keep an overlap
/// of 0.01 − 0.0075 and a little less.
const STEP: f64 = 0.015;

fn moved(mut positions: Vec<Vector<2>>, disk: usize, by: Vector<2>) -> Vec<Vector<2>> {
    positions[disk] = [positions[disk][0] + by[0], positions[disk][1] + by[1]];
    positions
}

#[test]
fn a_disk_that_moves_aside_breaks_one_contact_and_one_that_returns_makes_one() {
    let before = lattice(moved(lattice_positions(), RETURNING, [STEP, 0.0]));
    let after = lattice(moved(lattice_positions(), MOVING, [STEP, 0.0]));
    let changes = ContactChanges::between(&state(&before), &state(&after), 0);
    // 48 disks with six contacts are 144; each state lacks one of its own.
    assert_eq!((changes.kept_count, changes.made.len(), changes.broken.len()), (142, 1, 1));
    assert_eq!(changes.rattlers, RattlerContacts::default());
    assert_eq!(changes.broken_share(), Some(1.0 / 143.0));
    let (made, broken) = (changes.made[0], changes.broken[0]);
    assert_eq!((made.first as usize, made.second as usize), (RETURNING - 1, RETURNING));
    assert_eq!((broken.first as usize, broken.second as usize), (MOVING - 1, MOVING));
    // Midpoints in the state that has the contact: undisturbed lattice, half a spacing left of the disk.
    for (change, disk) in [(made, RETURNING), (broken, MOVING)] {
        let (place, centre) = (lattice_positions()[disk], lattice_positions()[0]);
        let midpoint = [place[0] - 0.5 * SPACING - centre[0], place[1] - centre[1]];
        let image = |x: f64, side: f64| x - (x / side).round() * side;
        let sides = [SPACING * COLUMNS as f64, SPACING * 0.75f64.sqrt() * super::ROWS as f64];
        for axis in 0..2 {
            // Coordinates below 8, rounded to 9·10⁻¹⁶ a few times; an image may differ where it is as far the other way.
            let apart = image(change.midpoint[axis] - midpoint[axis], sides[axis]);
            assert!(apart.abs() < 1e-14, "{:?} is not {midpoint:?}", change.midpoint);
        }
        assert_eq!(change.distance, norm(change.midpoint));
    }
}

#[test]
fn what_a_cycle_undoes_and_what_it_leaves_is_counted() {
    let before = lattice(moved(lattice_positions(), RETURNING, [STEP, 0.0]));
    let inflated = lattice(moved(lattice_positions(), MOVING, [STEP, 0.0]));
    // The disk that broke its contact is back; the contact made elsewhere stays.
    let deflated = lattice(lattice_positions());
    let cycle = ContactCycle::through([&state(&before), &state(&inflated), &state(&deflated)], 0);
    assert_eq!((cycle.broken_returned_count, cycle.made_returned_count), (1, 0));
    assert_eq!(cycle.returned_share(), Some(0.5));
    assert_eq!((cycle.deflation.made.len(), cycle.deflation.broken.len()), (1, 0));
    assert_eq!((cycle.left.kept_count, cycle.left.made.len(), cycle.left.broken.len()), (143, 1, 0));
    let nothing = ContactCycle::through([&state(&deflated), &state(&deflated), &state(&deflated)], 0);
    assert_eq!((nothing.inflation.kept_count, nothing.returned_share()), (144, None));
}

#[test]
fn contacts_of_rattlers_are_counted_apart() {
    // A small disk in the hole between disks 0, 1 and the one above them (0.5716 from each, room for 0.0716): it touches the
    // one it is nearer to by 0.03.
    let corners = [0, 1, COLUMNS].map(|disk| lattice_positions()[disk]);
    let hole = [0, 1].map(|axis| corners.iter().map(|corner| corner[axis]).sum::<f64>() / 3.0);
    let at = |corner: usize| {
        let way = [corners[corner][0] - hole[0], corners[corner][1] - hole[1]];
        let mut positions = lattice_positions();
        positions.push([0, 1].map(|axis| hole[axis] + 0.03 * way[axis] / norm(way)));
        lattice(positions)
    };
    let (first, second) = (at(0), at(1));
    let changes = ContactChanges::between(&state(&first), &state(&second), 20);
    assert_eq!((changes.kept_count, changes.made.len(), changes.broken.len()), (144, 0, 0));
    assert_eq!(changes.rattlers, RattlerContacts { kept_count: 0, made_count: 1, broken_count: 1 });
    let same = ContactChanges::between(&state(&first), &state(&first), 20);
    assert_eq!(same.rattlers, RattlerContacts { kept_count: 1, made_count: 0, broken_count: 0 });
}

#[test]
fn a_real_inflation_adds_up_state_by_state() {
    let (law, fire) = (Hertzian::default(), Fire::default());
    let (mixture, target) = (Mixture::default(), Target::Pressure(100.0));
    let preparation =
        Preparation { disk_count: 400, mixture, target, tolerance: 0.01, seed: 3, ..Preparation::default() };
    let packing = prepare_with::<2>(&preparation, &law, &fire, &mut ()).expect("a packing").packing.into_inner();
    let inflation = Inflation { deflate: true, ..Inflation::default() };
    let inflated = inflate_with(&inflation, &packing, &law, &fire, 1, &mut ()).expect("an inflation");
    let cycle = ContactCycle::of(&inflated, &law).expect("sound disks").expect("deflated");
    assert_eq!(cycle.inflation, ContactChanges::of_inflation(&inflated, &law).expect("sound disks"));
    let deflated = inflated.deflated.as_ref().expect("deflated");
    let totals = [&inflated.before, &inflated.after, deflated].map(|rest| rest.contact_count);
    for (changes, [first, second]) in [(&cycle.inflation, [0, 1]), (&cycle.deflation, [1, 2]), (&cycle.left, [0, 2])] {
        let rattlers = changes.rattlers;
        let kept = changes.kept_count + rattlers.kept_count;
        assert_eq!(kept + changes.broken.len() + rattlers.broken_count, totals[first]);
        assert_eq!(kept + changes.made.len() + rattlers.made_count, totals[second]);
    }
    // Twin: sets of pairs.
    let pairs = |packing: &Packing<2>| -> std::collections::BTreeSet<(u32, u32)> {
        let network = ContactNetwork::new(packing, &law).expect("sound disks");
        network.contacts.iter().map(|contact| (contact.first, contact.second)).collect()
    };
    let [before, after, last] = [&inflated.before, &inflated.after, deflated].map(|rest| pairs(rest.packing.get()));
    let on_both = |&(a, b): &(u32, u32)| {
        [a, b].iter().all(|&disk| inflated.before.backbone[disk as usize] && inflated.after.backbone[disk as usize])
    };
    let broken: Vec<(u32, u32)> = before.difference(&after).copied().filter(on_both).collect();
    let made: Vec<(u32, u32)> = after.difference(&before).copied().filter(on_both).collect();
    let keys = |list: &[jamscope::observe::contact_changes::ChangedContact<2>]| -> Vec<(u32, u32)> {
        list.iter().map(|change| (change.first, change.second)).collect()
    };
    assert!(!broken.is_empty() && !made.is_empty(), "this seed changes contacts");
    assert_eq!(keys(&cycle.inflation.broken), broken);
    assert_eq!(keys(&cycle.inflation.made), made);
    assert_eq!(cycle.broken_returned_count, broken.iter().filter(|pair| last.contains(pair)).count());
    assert_eq!(cycle.made_returned_count, made.iter().filter(|pair| !last.contains(pair)).count());

    let change = PressureChange::of_inflation(&inflated, &law);
    assert_eq!(change.change, inflated.after.pressure - inflated.before.pressure);
    let left = PressureChange::of_cycle(&inflated, &law).expect("deflated");
    assert_eq!(left.change, deflated.pressure - inflated.before.pressure);
    // p^(1/3), here by another route.
    let scaled = change.change / inflated.before.pressure.cbrt();
    assert!((change.scaled.expect("jammed") / scaled - 1.0).abs() < 1e-15);
}

/// Of packings of 1000 disks at a pressure: how many contacts in a thousand are left changed after inflation and deflation.
#[cfg(feature = "linear")]
fn left_changed(pressure: f64, seeds: std::ops::Range<u64>) -> f64 {
    let (law, staged) = (Hertzian::default(), jamscope::relax::Staged::default());
    let inflation = Inflation { deflate: true, ..Inflation::default() };
    let (mut left, mut all) = (0, 0);
    for seed in seeds {
        let (mixture, target) = (Mixture::default(), Target::Pressure(pressure));
        let preparation =
            Preparation { disk_count: 1000, mixture, target, tolerance: 0.01, seed, ..Preparation::default() };
        let packing = prepare_with::<2>(&preparation, &law, &staged, &mut ()).expect("a packing").packing;
        let inflated = inflate_with(&inflation, packing.get(), &law, &staged, seed, &mut ()).expect("an inflation");
        let cycle = ContactCycle::of(&inflated, &law).expect("sound disks").expect("deflated");
        let changed = cycle.inflation.made.len() + cycle.inflation.broken.len();
        left += changed - cycle.made_returned_count - cycle.broken_returned_count;
        all += cycle.inflation.kept_count + cycle.inflation.broken.len();
    }
    1e3 * left as f64 / all as f64
}

/// The smallest form of what `benches/measurements/angular_study` measures in ensembles (chapter "Contact changes"): p̂ = 2·10⁵ and 3·10⁸, 16 packings
/// each. That at least twice as many contacts are left changed below was asked before these seeds were looked at; the share that
/// returns, of those that change, does not tell the two apart at this size.
#[cfg(feature = "linear")]
#[test]
#[ignore = "32 packings: the weekly tier runs it"]
fn fewer_contacts_are_left_changed_far_above_the_transition_than_below() {
    let (below, above) = (left_changed(10.27, 2001..2017), left_changed(15_405.0, 2001..2017));
    println!("left changed in a thousand: {below} below, {above} above");
    assert!(below > 2.0 * above, "{below} below, {above} above");
}

#[test]
fn balls_have_contacts_and_bonds_as_disks_do_and_both_can_be_written() {
    use jamscope::observe::bond_changes::{BondChanges, BondSet};
    use jamscope::packing::Domain;
    // One ball between six held ones along the axes, overlap 0.005; it moves by 0.01 along x and leaves one of them.
    let packing = |x: f64| {
        let mut positions = vec![[x, 0.0, 0.0]];
        for axis in 0..3 {
            positions.extend([-0.995, 0.995].map(|side| {
                let mut place = [0.0; 3];
                place[axis] = side;
                place
            }));
        }
        let held = (0..7).map(|ball| ball > 0).collect();
        Packing::<3>::new(Domain::Open, positions, vec![0.5; 7]).and_then(|it| it.with_held(held)).expect("sound balls")
    };
    let (start, end) = (packing(0.0), packing(0.01));
    let law = Hookean::default();
    let (before, after) = (State::new(&start, &law).expect("sound"), State::new(&end, &law).expect("sound"));
    let changes = ContactChanges::between(&before, &after, 0);
    assert_eq!((changes.kept_count, changes.made.len(), changes.broken.len()), (5, 0, 1));
    assert_eq!((changes.broken[0].midpoint, changes.broken[0].distance), ([-0.4975, 0.0, 0.0], 0.4975));
    let bonds = BondChanges::between(&before, &after, 0, BondSet::Before);
    let stretched: Vec<f64> = bonds.bonds.iter().map(|bond| bond.parallel).collect();
    assert_eq!(stretched, [0.01, -0.01, 0.0, 0.0, 0.0, 0.0]);
    let written = serde_json::to_value((&changes, &bonds)).expect("plain data");
    assert_eq!(written[0]["broken"][0]["midpoint"], serde_json::json!([-0.4975, 0.0, 0.0]));
    assert_eq!(written[1]["bonds"].as_array().map(Vec::len), Some(6));
}
