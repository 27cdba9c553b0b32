//! Disks that go far in a large packing: its list is amended for them, and misses no contact.

use super::*;
use crate::scenes::tiled::tiled;
use jamscope::forces::advance::Advanced;
use jamscope::forces::single_precision::Single;
use jamscope::io::read_packing;

/// A packing a few disks of which, side by side, go through each other and the rest, straight on, each in a direction of its own.
struct Crossing<const D: usize> {
    assembly: Assembly<D, Hertzian>,
    roaming: Vec<usize>,
    /// Ways of those and of the others a step.
    ways: (f64, f64),
    /// Whether steps are made tile by tile.
    advances: bool,
    steps: usize,
    /// Those of them that spent the list.
    spent: usize,
}

impl<const D: usize> Crossing<D> {
    /// The `count` disks nearest to `middle`, seen from the corner of the box, go far.
    fn new(packing: &Packing<D>, (count, middle): (usize, Vector<D>), ways: (f64, f64)) -> Self {
        let mut assembly = Assembly::new(packing, Hertzian::default()).expect("no coincidence");
        assembly.prune_lists(true);
        let away = |&disk: &usize| norm(difference(assembly.place(disk), middle));
        let mut roaming: Vec<usize> = (0..packing.len()).collect();
        roaming.sort_by(|one, two| away(one).total_cmp(&away(two)));
        roaming.truncate(count);
        Crossing { assembly, roaming, ways, advances: false, steps: 0, spent: 0 }
    }

    fn step(&mut self) {
        // Components of 1 and less: √D times the way at most.
        let direction =
            |disk: usize| -> Vector<D> { std::array::from_fn(|d| (1.7 * disk as f64 + 2.0 * d as f64).cos()) };
        // There and back again for the others.
        let way = if (self.steps / 50).is_multiple_of(2) { self.ways.1 } else { -self.ways.1 };
        let mobile = 0..self.assembly.mobile_count();
        let mut steps: Vec<Vector<D>> = mobile.map(|disk| direction(disk).map(|along| way * along)).collect();
        for &disk in &self.roaming {
            steps[disk] = sum(steps[disk], direction(disk).map(|along| self.ways.0 * along));
        }
        self.steps += 1;
        let bound = (D as f64).sqrt() * (self.ways.0 + self.ways.1);
        if self.advances {
            let kick = |_: &[_], steps: &mut [_], displacements: &mut [_]| {
                moved(steps, displacements);
                bound
            };
            match self.assembly.advance(&mut steps, kick, |_, _| ()) {
                Advanced::Not => panic!("a long list is advanced whatever comes"),
                Advanced::Moved => self.spent += 1,
                Advanced::Evaluated(_) => {}
            }
            self.assembly.update_list_after_advance().expect("no coincidence");
        } else {
            moved(&steps, &mut self.assembly.displacements);
            self.assembly.update_list(bound).expect("no coincidence");
        }
    }

    /// 140 steps, every seventh checked.
    fn go(&mut self) {
        for step in 1..=140 {
            self.step();
            if step % 7 == 0 {
                self.check();
            }
        }
    }

    /// 1500 steps, most of them by near pairs, every 75th checked; the list of all pairs is not made anew.
    fn go_slowly(&mut self) {
        let (all, mut near) = (self.assembly.pairs().len(), 0);
        for step in 1..=1500 {
            self.step();
            near += usize::from(self.assembly.pairs().len() < all * 9 / 10);
            if step % 75 == 0 {
                self.check();
            }
        }
        assert_eq!(self.assembly.rebuild_count(), 1);
        assert!(near > 1000, "near pairs in {near} of 1500 steps");
    }

    /// Contacts and forces of the list as it is are those of one made anew.
    fn check(&self) {
        let [mut amended, mut anew] = [self.assembly.clone(), self.assembly.clone()];
        anew.reanchor().expect("no coincidence");
        let (found, expected) = (amended.evaluate_totals(), anew.evaluate_totals());
        assert_eq!(found.contact_count, expected.contact_count, "step {}", self.steps);
        // Sums of some 50 000 terms in another order, those of the disks that went far known to ulps of ways of several radii.
        assert!((found.energy - expected.energy).abs() < 1e-12 * expected.energy, "step {}", self.steps);
        assert_same_forces(&amended.forces, &anew.forces, ROUNDING, self.steps);
    }
}

/// Overlaps known to 4 u of ways up to 10 radii, over overlaps of a tenth and less where forces are large, relative to the largest force \[1\].
const ROUNDING: f64 = 1e-13;

fn assert_same_forces<const D: usize>(found: &[Vector<D>], expected: &[Vector<D>], tolerance: f64, step: usize) {
    // A NaN is nowhere near.
    let largest = expected.iter().map(|&force| norm(force)).fold(0.0, f64::max);
    assert_eq!(found.len(), expected.len());
    for (one, two) in found.iter().zip(expected) {
        assert!(norm(difference(*one, *two)) < tolerance * largest, "step {step}: {one:?} {two:?}");
    }
}

/// 22192 disks in three tiles, and where two of these meet: tiles have 8192 disks, in rows from below.
fn three_tiles() -> (Packing<2>, Vector<2>) {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/packings/hertz_N5548_p100.xyz");
    let packing = tiled(&read_packing::<2>(file).expect("a stored packing"), 2).expect("a periodic packing");
    let sides = packing.domain().lengths().expect("a periodic packing");
    let middle = [0.5 * sides[0], sides[1] * 8192.0 / packing.len() as f64];
    (packing, middle)
}

/// 4913 balls on a cubic lattice, pressed by a fiftieth of a diameter, each shaken by so much along each axis.
fn balls(shake: f64) -> Packing<3> {
    let place = |ball: usize| -> Vector<3> {
        let along = [ball % 17, ball / 17 % 17, ball / 289];
        std::array::from_fn(|d| 0.98 * along[d] as f64 + shake * (ball as f64 * (d + 2) as f64).sin())
    };
    let domain = Domain::Periodic { corner: [0.0; 3], lengths: [17.0 * 0.98; 3] };
    Packing::new(domain, (0..4913).map(place).collect(), vec![0.5; 4913]).expect("a packing")
}

#[test]
fn a_list_amended_for_disks_that_go_far_misses_no_contact() {
    let (packing, middle) = three_tiles();
    let mut crossing = Crossing::new(&packing, (60, middle), (0.03, 0.0));
    crossing.go();
    // Some eight ways of half a skin, for each of which a list would be made.
    assert!(crossing.assembly.rebuild_count() <= 4, "{} lists", crossing.assembly.rebuild_count());
}

#[test]
fn so_does_one_of_balls() {
    // Through the corner of the box, where images meet.
    let mut crossing = Crossing::new(&balls(0.0), (16, [0.0; 3]), (0.03, 0.0));
    crossing.go();
    assert!(crossing.assembly.rebuild_count() <= 4, "{} lists", crossing.assembly.rebuild_count());
}

#[test]
fn a_list_amended_before_it_is_spent_misses_no_contact() {
    let (packing, middle) = three_tiles();
    let mut crossing = Crossing::new(&packing, (60, middle), (0.01, 1e-5));
    crossing.advances = true;
    crossing.go();
    assert_eq!((crossing.assembly.rebuild_count(), crossing.spent), (1, 0));
}

#[test]
fn near_pairs_amended_for_disks_that_go_far_miss_no_contact() {
    let (packing, middle) = three_tiles();
    Crossing::new(&packing, (40, middle), (1e-4, 1e-6)).go_slowly();
}

#[test]
fn near_pairs_amended_before_they_are_spent_miss_no_contact() {
    let (packing, middle) = three_tiles();
    let mut crossing = Crossing::new(&packing, (40, middle), (1e-3, 1e-6));
    crossing.advances = true;
    crossing.go_slowly();
    assert!(crossing.spent <= 3, "spent {} times", crossing.spent);
}

#[test]
fn so_do_those_of_balls() {
    // Shaken, so that some of the pairs listed are not near.
    Crossing::new(&balls(0.1), (8, [0.0; 3]), (1e-4, 1e-6)).go_slowly();
}

fn moved<const D: usize>(steps: &[Vector<D>], displacements: &mut [Vector<D>]) {
    for (displacement, &step) in displacements.iter_mut().zip(steps) {
        *displacement = sum(*displacement, step);
    }
}

/// How far the first of a few disks goes a step; others that go far go three times as far.
const WAY: f64 = 1e-3;

/// A step, of which a bound of ten times the way is told.
fn go<const D: usize>(steps: &[Vector<D>], displacements: &mut [Vector<D>]) -> f64 {
    moved(steps, displacements);
    10.0 * WAY
}

/// How many of these steps are made at once now and then, so that a list is spent that no step before it would have spent.
const LEAP: f64 = 40.0;

fn leaps(step: usize) -> bool {
    step.is_multiple_of(50)
}

#[test]
fn a_way_that_is_taken_stands_for_the_bounds_that_were_told() {
    let (packing, middle) = three_tiles();
    let mut assembly = Crossing::new(&packing, (1, middle), (0.0, 0.0)).assembly;
    // No checks: without near pairs the list in use is that of all, with a skin of half a radius, and holds for ways of an eighth of a diameter.
    assembly.prune_lists(false);
    let mut velocities = vec![[0.0; 2]; assembly.mobile_count()];
    velocities[0] = [WAY, 0.0];
    for step in 1..=125 {
        let advanced = assembly.advance(&mut velocities, |_, v, u| go(v, u), |_, _| ());
        let holds = f64::from(step) * WAY < 0.12497;
        assert_eq!(matches!(advanced, Advanced::Evaluated(_)), holds, "step {step}");
        assert_eq!(matches!(advanced, Advanced::Moved), !holds, "step {step}");
        // The first disk is moved either way.
        assert!((assembly.displacements[0][0] - f64::from(step) * WAY).abs() < 1e-12, "step {step}");
        assert_eq!(assembly.update_list_after_advance(), Ok(!holds), "step {step}");
    }
    // NaN is no bound: the ways themselves are taken.
    let advanced = assembly.advance(&mut velocities, |_, _, _| f64::NAN, |_, _| ());
    assert!(matches!(advanced, Advanced::Evaluated(_)));
    assert_eq!(assembly.update_list_after_advance(), Ok(false));
    // Nor is it a place; that is left to the relaxer.
    velocities[0] = [f64::NAN, 0.0];
    let advanced = assembly.advance(&mut velocities, |_, v, u| f64::NAN * go(v, u), |_, _| ());
    assert_eq!(advanced, Advanced::Moved);
    assert_eq!(assembly.update_list_after_advance(), Ok(false));
}

/// The same forces, whatever the order of the disks.
fn sorted(mut forces: Vec<Vector<2>>) -> Vec<Vector<2>> {
    forces.sort_unstable_by(|one, two| one[0].total_cmp(&two[0]).then(one[1].total_cmp(&two[1])));
    forces
}

#[test]
fn steps_tile_by_tile_miss_no_contact_of_disks_that_go_far() {
    let (packing, middle) = three_tiles();
    let mut crossing = Crossing::new(&packing, (60, middle), (0.0, 0.0));
    let mut velocities = vec![[0.0; 2]; crossing.assembly.mobile_count()];
    for &disk in &crossing.roaming {
        velocities[disk] = [3.0 * WAY * (1.7 * disk as f64).cos(), 3.0 * WAY * (1.7 * disk as f64 + 2.0).cos()];
    }
    let (mut advanced, mut amended, mut spent) = (0, 0, 0);
    for step in 1..=280 {
        let kick = |_: &[_], velocities: &mut [Vector<2>], displacements: &mut [Vector<2>]| {
            let times = if leaps(step) { LEAP } else { 1.0 };
            moved(&velocities.iter().map(|v| v.map(|v| times * v)).collect::<Vec<_>>(), displacements);
            10.0 * times * WAY
        };
        match crossing.assembly.advance(&mut velocities, kick, |forces, _| forces.to_vec()) {
            Advanced::Evaluated(looked) => {
                advanced += 1;
                assert_eq!(
                    sorted(looked.concat()),
                    sorted(crossing.assembly.forces.clone()),
                    "step {step}: seen too early"
                );
                let mut anew = crossing.assembly.clone();
                if step % 7 == 0 {
                    anew.reanchor().expect("no coincidence");
                }
                anew.evaluate();
                assert_same_forces(&crossing.assembly.forces, &anew.forces, ROUNDING, step);
                amended += usize::from(crossing.assembly.update_list_after_advance().expect("no coincidence"));
            }
            Advanced::Moved => {
                spent += 1;
                assert_eq!(crossing.assembly.update_list_after_advance(), Ok(true), "step {step}");
            }
            Advanced::Not => panic!("a long list is advanced whatever comes"),
        }
    }
    assert!(advanced > 200 && amended > 3, "{advanced} steps, amended {amended} times");
    // By the leaps alone.
    assert_eq!(spent, 5);
    assert!(crossing.assembly.rebuild_count() <= 4, "{} lists", crossing.assembly.rebuild_count());
}

#[test]
fn pairs_that_a_list_is_amended_by_have_their_forces_in_single_precision_too() {
    let (packing, middle) = three_tiles();
    let mut crossing = Crossing::new(&packing, (60, middle), (0.0, 0.0));
    let assembly = &mut crossing.assembly;
    let mut disks = Single::new(assembly).expect("numbers of ordinary size");
    let mut velocities = vec![[0.0f32; 2]; assembly.mobile_count()];
    for &disk in &crossing.roaming {
        velocities[disk] = [1.7 * disk as f64, 1.7 * disk as f64 + 2.0].map(|angle| angle.cos() as f32);
    }
    // A radius is of the unit of lengths and below two of them.
    let step = (3.0 * WAY / disks.units().length) as f32;
    let (mut amended, mut spent) = (0, 0);
    for at in 1..=280 {
        let times = if leaps(at) { LEAP } else { 1.0 };
        let kick = |_: &[_], velocities: &mut [[f32; 2]], ways: &mut [[f32; 2]]| {
            for (way, velocity) in ways.iter_mut().zip(velocities) {
                *way = std::array::from_fn(|d| way[d] + times as f32 * step * velocity[d]);
            }
            5.0 * times * WAY
        };
        let holds = match disks.advance(assembly, &mut velocities, kick, |_, _| ()) {
            Advanced::Evaluated(_) => true,
            Advanced::Moved => false,
            Advanced::Not => panic!("a long list is advanced whatever comes"),
        };
        let made = assembly.rebuild_count();
        let changed = assembly.update_list_after_advance().expect("no coincidence");
        amended += usize::from(changed && holds);
        spent += usize::from(!holds);
        assert_eq!(assembly.rebuild_count(), made, "step {at}: amended, not made anew");
        if !changed && at % 7 != 0 {
            continue;
        }
        disks.evaluate(assembly);
        let mut exact = assembly.clone();
        disks.settle(&mut exact);
        exact.reanchor().expect("no coincidence");
        exact.evaluate();
        let unit = disks.units().force;
        let found: Vec<Vector<2>> =
            disks.forces.iter().map(|force| force.map(|along| unit * f64::from(along))).collect();
        // Overlaps known to 4 · 2⁻²⁴ of ways up to a diameter, in some eight contacts of a disk, over one of a tenth of that at least, Hertzian.
        assert_same_forces(&found, &exact.forces, 3e-5, at);
    }
    assert!(amended > 3 && spent == 5, "amended {amended} times, spent {spent} times");
}

#[test]
fn near_pairs_of_a_list_that_disks_have_worn_miss_no_contact() {
    // Farther apart than is listed, by nearly nothing.
    let packing =
        Packing::new(Domain::Open, vec![[0.0, 0.0], [1.0 + 0.25 + 1e-9, 0.0]], vec![0.5; 2]).expect("two disks");
    let mut assembly = Assembly::new(&packing, Hertzian::default()).expect("apart");
    assembly.prune_lists(true);
    assert_eq!(assembly.pairs().len(), 0);
    // Towards each other, fast, until the list just holds, then slowly: looked at then, near pairs seem to do.
    for step in 1..=1200 {
        let way = if step <= 32 { 0.124 / 32.0 } else { 2e-6 };
        let right = if assembly.place(0)[0] < assembly.place(1)[0] { 0 } else { 1 };
        assembly.displacements[right][0] += way;
        assembly.displacements[1 - right][0] -= way;
        assembly.update_list(way).expect("apart");
        assembly.evaluate();
        let overlap = 1.0 - (assembly.place(1 - right)[0] - assembly.place(right)[0]);
        let pressed = assembly.forces[right][0] < 0.0;
        assert_eq!(pressed, overlap > 0.0, "step {step}: {overlap}");
    }
}

#[test]
fn a_list_that_all_disks_wear_out_is_made_anew_with_a_wider_skin() {
    let (packing, _) = three_tiles();
    let smallest = packing.radii().iter().copied().fold(f64::INFINITY, f64::min);
    // Ways of all disks a step, over the smallest radius, and the skin that lasts for them: √(2 · 25 steps of making / 0.75 · way).
    for (way, expected) in [(2e-4f64, 0.2), (2e-3, (50.0 / 0.75 * 2e-3f64).sqrt()), (1e-2, 0.5)] {
        let mut assembly = Assembly::with_incremental_updates(&packing, Hertzian::default()).expect("no coincidence");
        assembly.prune_lists(true);
        assert_eq!(assembly.skin(), 0.2 * smallest);
        while assembly.rebuild_count() == 1 {
            for (disk, displacement) in assembly.displacements.iter_mut().enumerate() {
                let angle = 1.7 * disk as f64;
                *displacement = sum(*displacement, [angle.cos(), angle.sin()].map(|along| way * smallest * along));
            }
            assembly.update_list(way * smallest).expect("no coincidence");
        }
        assert!((assembly.skin() - expected * smallest).abs() < 1e-9, "{way}: {}", assembly.skin());
    }
    // A short list has the wider one from the start.
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/packings/hertz_N5548_p100.xyz");
    let packing = read_packing::<2>(file).expect("a stored packing");
    let assembly = Assembly::with_incremental_updates(&packing, Hertzian::default()).expect("no coincidence");
    assert_eq!(assembly.skin(), 0.5 * smallest);
}

#[test]
fn disks_that_go_far_in_near_pairs_find_each_other() {
    // Two disks beside very many at rest come together, several cells from where either was when the list was made.
    let beside = [[-20.0, 0.0], [-20.0, 4.5]];
    let places = (0..4900).map(|disk| [3.0 * f64::from(disk % 70), 3.0 * f64::from(disk / 70)]).chain(beside).collect();
    let packing = Packing::new(Domain::Open, places, vec![0.5; 4902]).expect("disks apart");
    let mut assembly = Assembly::new(&packing, Hertzian::default()).expect("no coincidence");
    assembly.prune_lists(true);
    let [lower, upper] =
        [4900, 4901].map(|disk| assembly.order().iter().position(|&other| other == disk).expect("every disk"));
    let way = 1e-4;
    for step in 1..=17_600 {
        assembly.displacements[lower][1] += way;
        assembly.displacements[upper][1] -= way;
        assembly.update_list(way).expect("apart");
        if step > 17_400 {
            assembly.evaluate();
            let overlap = 1.0 - (assembly.place(upper)[1] - assembly.place(lower)[1]);
            assert!(overlap.abs() < 0.1, "they meet at the end");
            // Rounding decides at the touch itself.
            let pressed = assembly.forces[lower][1] < 0.0;
            assert!(overlap.abs() < 1e-9 || pressed == (overlap > 0.0), "step {step}: {overlap}");
        }
    }
    assert_eq!(assembly.rebuild_count(), 1);
    assert!(assembly.skin() < 0.1, "by near pairs: {}", assembly.skin());
}
