//! Disks that go far in a large packing: its list is amended for them, and misses no contact.

use super::*;
use crate::scenes::tiled::tiled;
use jamscope::io::read_packing;

/// A packing a few disks of which, side by side, go through each other and the rest, straight on, each in a direction of its own.
struct Crossing<const D: usize> {
    assembly: Assembly<D, Hertzian>,
    roaming: Vec<usize>,
    /// Ways of those and of the others a step.
    ways: (f64, f64),
    steps: usize,
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
        Crossing { assembly, roaming, ways, steps: 0 }
    }

    fn step(&mut self) {
        let mobile = self.assembly.mobile_count();
        // Components of 1 and less: √D times the way at most.
        let direction =
            |disk: usize| -> Vector<D> { std::array::from_fn(|d| (1.7 * disk as f64 + 2.0 * d as f64).cos()) };
        for disk in 0..mobile {
            // There and back again for the others.
            let way = if (self.steps / 50).is_multiple_of(2) { self.ways.1 } else { -self.ways.1 };
            let displacement = &mut self.assembly.displacements[disk];
            *displacement = sum(*displacement, direction(disk).map(|along| way * along));
        }
        for &disk in &self.roaming {
            let displacement = &mut self.assembly.displacements[disk];
            *displacement = sum(*displacement, direction(disk).map(|along| self.ways.0 * along));
        }
        self.steps += 1;
        self.assembly.keep_listed((D as f64).sqrt() * (self.ways.0 + self.ways.1)).expect("no coincidence");
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
        let largest = amended.forces.iter().map(|&force| norm(force)).fold(0.0, f64::max);
        for (one, two) in amended.forces.iter().zip(&anew.forces) {
            // Overlaps known to 4 u of ways up to 10 radii, over overlaps of a tenth and less where forces are large.
            assert!(norm(difference(*one, *two)) < 1e-13 * largest, "step {}: {one:?} {two:?}", self.steps);
        }
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
fn near_pairs_amended_for_disks_that_go_far_miss_no_contact() {
    let (packing, middle) = three_tiles();
    Crossing::new(&packing, (40, middle), (1e-4, 1e-6)).go_slowly();
}

#[test]
fn so_do_those_of_balls() {
    // Shaken, so that some of the pairs listed are not near.
    Crossing::new(&balls(0.1), (8, [0.0; 3]), (1e-4, 1e-6)).go_slowly();
}

/// A bound of ten times the way is told at every step: added up, it ends the list after a tenth of what that holds for.
#[test]
fn a_way_that_is_taken_stands_for_the_bounds_of_a_long_list() {
    let (packing, middle) = three_tiles();
    let mut crossing = Crossing::new(&packing, (1, middle), (0.0, 0.0));
    let assembly = &mut crossing.assembly;
    // No looks: without near pairs the list in use is that of all, with a skin of half a radius, and holds for ways of an eighth of a diameter.
    assembly.prune_lists(false);
    let (way, bound) = (1e-3, 1e-2);
    let mut taken = 0;
    for step in 0..120 {
        if assembly.may_hold_beyond(bound) {
            assembly.take_way();
            taken += 1;
            let holds = assembly.advance(&mut vec![[0.0; 2]; assembly.mobile_count()], bound, |_, _, _| (), |_, _| ());
            // Whatever it shows, it is not worth being taken again.
            assert!(!assembly.may_hold_beyond(bound), "step {step}");
            assert_eq!(holds.is_some(), f64::from(step) * way + bound < 0.12497, "step {step}");
        }
        assembly.displacements[0][0] += way;
        assert_eq!(assembly.keep_listed(bound), Ok(false), "step {step}");
    }
    assert!((10..60).contains(&taken), "taken {taken} times");
}

#[test]
fn a_short_list_is_gone_through_array_by_array_at_once() {
    let mut crossing = Crossing::new(&balls(0.0), (1, [0.0; 3]), (0.0, 0.0));
    assert!(!crossing.assembly.may_hold_beyond(f64::INFINITY));
    crossing.step();
}
