//! Fast disks in a large packing: incremental updates of its list for them miss no contact.

use super::*;
use crate::scenes::tiled::tiled;
use jamscope::forces::advance::Advanced;
use jamscope::forces::single_precision::Single;
use jamscope::io::read_packing;

/// A packing in which a few neighbouring disks are fast: each moves straight on in its own direction, through the others.
struct Crossing<const D: usize> {
    assembly: Assembly<D>,
    fast: Vec<usize>,
    /// Displacements in a step of the fast disks and of the others \[length\].
    lengths: (f64, f64),
    /// Whether steps are made tile by tile.
    by_tiles: bool,
    steps: usize,
    /// Number of steps after which the list had expired.
    expired_count: usize,
}

impl<const D: usize> Crossing<D> {
    /// The `count` disks nearest to `middle`, seen from the corner of the box, are fast.
    fn new(packing: &Packing<D>, (count, middle): (usize, Vector<D>), lengths: (f64, f64)) -> Self {
        let mut assembly = Assembly::new(packing, &Hertzian::default()).expect("no coincidence");
        assembly.set_pruning(true);
        let away = |&disk: &usize| norm(difference(assembly.place(disk), middle));
        let mut fast: Vec<usize> = (0..packing.len()).collect();
        fast.sort_by(|one, two| away(one).total_cmp(&away(two)));
        fast.truncate(count);
        Crossing { assembly, fast, lengths, by_tiles: false, steps: 0, expired_count: 0 }
    }

    fn step(&mut self) {
        // Components of 1 and less: √D times the displacement at most.
        let direction =
            |disk: usize| -> Vector<D> { std::array::from_fn(|d| (1.7 * disk as f64 + 2.0 * d as f64).cos()) };
        // The other disks move to and fro.
        let length = if (self.steps / 50).is_multiple_of(2) { self.lengths.1 } else { -self.lengths.1 };
        let mobile = 0..self.assembly.mobile_count();
        let mut steps: Vec<Vector<D>> = mobile.map(|disk| direction(disk).map(|along| length * along)).collect();
        for &disk in &self.fast {
            steps[disk] = sum(steps[disk], direction(disk).map(|along| self.lengths.0 * along));
        }
        self.steps += 1;
        let bound = (D as f64).sqrt() * (self.lengths.0 + self.lengths.1);
        if self.by_tiles {
            let kick = |_: &[_], steps: &mut [_], displacements: &mut [_]| {
                moved(steps, displacements);
                bound
            };
            match self.assembly.advance(&mut steps, kick, |_, _| ()) {
                Advanced::Not => panic!("a long list is advanced whatever comes"),
                Advanced::Moved => self.expired_count += 1,
                Advanced::Evaluated(_) => {}
            }
            self.assembly.update_list_after_advance().expect("no coincidence");
        } else {
            moved(&steps, &mut self.assembly.displacements);
            self.assembly.update_list(bound).expect("no coincidence");
        }
    }

    /// 140 steps, every seventh checked.
    fn run(&mut self) {
        for step in 1..=140 {
            self.step();
            if step % 7 == 0 {
                self.check();
            }
        }
    }

    /// 1500 steps, most of them with the inner list, every 75th checked; the outer list is not rebuilt.
    fn run_slowly(&mut self) {
        let (all, mut inner_count) = (self.assembly.pairs().len(), 0);
        for step in 1..=1500 {
            self.step();
            inner_count += usize::from(self.assembly.pairs().len() < all * 9 / 10);
            if step % 75 == 0 {
                self.check();
            }
        }
        assert_eq!(self.assembly.build_count(), 1);
        assert!(inner_count > 1000, "an inner list in {inner_count} of 1500 steps");
    }

    /// Contacts and forces of the present list are those of a rebuilt one.
    fn check(&self) {
        let [mut updated, mut rebuilt] = [self.assembly.clone(), self.assembly.clone()];
        rebuilt.reanchor().expect("no coincidence");
        let (found, expected) = (updated.evaluate_totals(), rebuilt.evaluate_totals());
        assert_eq!(found.contact_count, expected.contact_count, "step {}", self.steps);
        // Sums of some 50 000 terms in another order, those of the fast disks known to ulps of displacements of several radii.
        assert!((found.energy - expected.energy).abs() < 1e-12 * expected.energy, "step {}", self.steps);
        assert_same_forces(&updated.forces, &rebuilt.forces, ROUNDING, self.steps);
    }
}

/// Overlaps known to 4·2⁻⁵³ of displacements up to 10 radii, over overlaps of a tenth and less where forces are large, relative to the largest force \[1\].
const ROUNDING: f64 = 1e-13;

fn assert_same_forces<const D: usize>(found: &[Vector<D>], expected: &[Vector<D>], tolerance: f64, step: usize) {
    // A NaN is not near anything.
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
    let domain = Domain::rectangular([0.0; 3], [17.0 * 0.98; 3]);
    Packing::new(domain, (0..4913).map(place).collect(), vec![0.5; 4913]).expect("a packing")
}

#[test]
fn a_list_with_incremental_updates_for_fast_disks_misses_no_contact() {
    let (packing, middle) = three_tiles();
    let mut crossing = Crossing::new(&packing, (60, middle), (0.03, 0.0));
    crossing.run();
    // Without updates a list would be built for each of some eight displacements of half a skin.
    assert!(crossing.assembly.build_count() <= 4, "{} lists", crossing.assembly.build_count());
}

#[test]
fn a_list_of_balls_with_incremental_updates_misses_no_contact() {
    // Through the corner of the box, where images meet.
    let mut crossing = Crossing::new(&balls(0.0), (16, [0.0; 3]), (0.03, 0.0));
    crossing.run();
    assert!(crossing.assembly.build_count() <= 4, "{} lists", crossing.assembly.build_count());
}

#[test]
fn a_list_updated_before_it_expires_misses_no_contact() {
    let (packing, middle) = three_tiles();
    let mut crossing = Crossing::new(&packing, (60, middle), (0.01, 1e-5));
    crossing.by_tiles = true;
    crossing.run();
    assert_eq!((crossing.assembly.build_count(), crossing.expired_count), (1, 0));
}

#[test]
fn an_inner_list_with_incremental_updates_misses_no_contact() {
    let (packing, middle) = three_tiles();
    Crossing::new(&packing, (40, middle), (1e-4, 1e-6)).run_slowly();
}

#[test]
fn an_inner_list_updated_before_it_expires_misses_no_contact() {
    let (packing, middle) = three_tiles();
    let mut crossing = Crossing::new(&packing, (40, middle), (1e-3, 1e-6));
    crossing.by_tiles = true;
    crossing.run_slowly();
    assert!(crossing.expired_count <= 3, "expired {} times", crossing.expired_count);
}

#[test]
fn an_inner_list_of_balls_misses_no_contact() {
    // Shaken, so that some of the listed pairs are not in the inner list.
    Crossing::new(&balls(0.1), (8, [0.0; 3]), (1e-4, 1e-6)).run_slowly();
}

fn moved<const D: usize>(steps: &[Vector<D>], displacements: &mut [Vector<D>]) {
    for (displacement, &step) in displacements.iter_mut().zip(steps) {
        *displacement = sum(*displacement, step);
    }
}

/// Displacement of the first disk in a step \[length\]; other fast disks move three times as far.
const LENGTH: f64 = 1e-3;

/// A step with a displacement bound of ten times its length.
fn run<const D: usize>(steps: &[Vector<D>], displacements: &mut [Vector<D>]) -> f64 {
    moved(steps, displacements);
    10.0 * LENGTH
}

/// Number of such steps made at once now and then, so that a list expires although no earlier step would have expired it.
const LEAP: f64 = 40.0;

fn leaps(step: usize) -> bool {
    step.is_multiple_of(50)
}

#[test]
fn computed_displacements_replace_displacement_bounds() {
    let (packing, middle) = three_tiles();
    let mut assembly = Crossing::new(&packing, (1, middle), (0.0, 0.0)).assembly;
    // No speed checks: the outer list is in use, with a skin of half a radius, and is complete for displacements of an eighth of a diameter.
    assembly.set_pruning(false);
    let mut velocities = vec![[0.0; 2]; assembly.mobile_count()];
    velocities[0] = [LENGTH, 0.0];
    for step in 1..=125 {
        let advanced = assembly.advance(&mut velocities, |_, v, u| run(v, u), |_, _| ());
        let holds = f64::from(step) * LENGTH < 0.12497;
        assert_eq!(matches!(advanced, Advanced::Evaluated(_)), holds, "step {step}");
        assert_eq!(matches!(advanced, Advanced::Moved), !holds, "step {step}");
        // The first disk is moved in both cases.
        assert!((assembly.displacements[0][0] - f64::from(step) * LENGTH).abs() < 1e-12, "step {step}");
        assert_eq!(assembly.update_list_after_advance(), Ok(!holds), "step {step}");
    }
    // NaN is no bound: the displacements are computed.
    let advanced = assembly.advance(&mut velocities, |_, _, _| f64::NAN, |_, _| ());
    assert!(matches!(advanced, Advanced::Evaluated(_)));
    assert_eq!(assembly.update_list_after_advance(), Ok(false));
    // Nor is it a place; that is left to the relaxer.
    velocities[0] = [f64::NAN, 0.0];
    let advanced = assembly.advance(&mut velocities, |_, v, u| f64::NAN * run(v, u), |_, _| ());
    assert_eq!(advanced, Advanced::Moved);
    assert_eq!(assembly.update_list_after_advance(), Ok(false));
}

/// The same forces, whatever the order of the disks.
fn sorted(mut forces: Vec<Vector<2>>) -> Vec<Vector<2>> {
    forces.sort_unstable_by(|one, two| one[0].total_cmp(&two[0]).then(one[1].total_cmp(&two[1])));
    forces
}

#[test]
fn steps_tile_by_tile_miss_no_contact_of_fast_disks() {
    let (packing, middle) = three_tiles();
    let mut crossing = Crossing::new(&packing, (60, middle), (0.0, 0.0));
    let mut velocities = vec![[0.0; 2]; crossing.assembly.mobile_count()];
    for &disk in &crossing.fast {
        velocities[disk] = [3.0 * LENGTH * (1.7 * disk as f64).cos(), 3.0 * LENGTH * (1.7 * disk as f64 + 2.0).cos()];
    }
    let (mut advanced, mut updated, mut expired_count) = (0, 0, 0);
    for step in 1..=280 {
        let kick = |_: &[_], velocities: &mut [Vector<2>], displacements: &mut [Vector<2>]| {
            let times = if leaps(step) { LEAP } else { 1.0 };
            moved(&velocities.iter().map(|v| v.map(|v| times * v)).collect::<Vec<_>>(), displacements);
            10.0 * times * LENGTH
        };
        match crossing.assembly.advance(&mut velocities, kick, |forces, _| forces.to_vec()) {
            Advanced::Evaluated(observed) => {
                advanced += 1;
                assert_eq!(
                    sorted(observed.concat()),
                    sorted(crossing.assembly.forces.clone()),
                    "step {step}: seen too early"
                );
                let mut rebuilt = crossing.assembly.clone();
                if step % 7 == 0 {
                    rebuilt.reanchor().expect("no coincidence");
                }
                rebuilt.evaluate();
                assert_same_forces(&crossing.assembly.forces, &rebuilt.forces, ROUNDING, step);
                updated += usize::from(crossing.assembly.update_list_after_advance().expect("no coincidence"));
            }
            Advanced::Moved => {
                expired_count += 1;
                assert_eq!(crossing.assembly.update_list_after_advance(), Ok(true), "step {step}");
            }
            Advanced::Not => panic!("a long list is advanced whatever comes"),
        }
    }
    assert!(advanced > 200 && updated > 3, "{advanced} steps, updated {updated} times");
    // By the leaps alone.
    assert_eq!(expired_count, 5);
    assert!(crossing.assembly.build_count() <= 4, "{} lists", crossing.assembly.build_count());
}

#[test]
fn inserted_pairs_have_their_forces_in_single_precision() {
    let (packing, middle) = three_tiles();
    let mut crossing = Crossing::new(&packing, (60, middle), (0.0, 0.0));
    let assembly = &mut crossing.assembly;
    let mut disks = Single::new(assembly).expect("numbers of ordinary size");
    let mut velocities = vec![[0.0f32; 2]; assembly.mobile_count()];
    for &disk in &crossing.fast {
        velocities[disk] = [1.7 * disk as f64, 1.7 * disk as f64 + 2.0].map(|angle| angle.cos() as f32);
    }
    // A radius is of the unit of lengths and below two of them.
    let step = (3.0 * LENGTH / disks.units().length) as f32;
    let (mut updated, mut expired_count) = (0, 0);
    for at in 1..=280 {
        let times = if leaps(at) { LEAP } else { 1.0 };
        let kick = |_: &[_], velocities: &mut [[f32; 2]], lengths: &mut [[f32; 2]]| {
            for (length, velocity) in lengths.iter_mut().zip(velocities) {
                *length = std::array::from_fn(|d| length[d] + times as f32 * step * velocity[d]);
            }
            5.0 * times * LENGTH
        };
        let holds = match disks.advance(assembly, &mut velocities, kick, |_, _| ()) {
            Advanced::Evaluated(_) => true,
            Advanced::Moved => false,
            Advanced::Not => panic!("a long list is advanced whatever comes"),
        };
        let made = assembly.build_count();
        let changed = assembly.update_list_after_advance().expect("no coincidence");
        updated += usize::from(changed && holds);
        expired_count += usize::from(!holds);
        assert_eq!(assembly.build_count(), made, "step {at}: updated, not rebuilt");
        if !changed && at % 7 != 0 {
            continue;
        }
        disks.evaluate(assembly);
        let mut exact = assembly.clone();
        disks.write_displacements(&mut exact);
        exact.reanchor().expect("no coincidence");
        exact.evaluate();
        let unit = disks.units().force;
        let found: Vec<Vector<2>> =
            disks.forces.iter().map(|force| force.map(|along| unit * f64::from(along))).collect();
        // Overlaps known to 4 · 2⁻²⁴ of displacements up to a diameter, in some eight contacts of a disk, over one of a tenth of that at least, Hertzian.
        assert_same_forces(&found, &exact.forces, 3e-5, at);
    }
    assert!(updated > 3 && expired_count == 5, "updated {updated} times, expired {expired_count} times");
}

#[test]
fn an_inner_list_of_a_nearly_expired_list_misses_no_contact() {
    // Farther apart than is listed, by nearly nothing.
    let packing =
        Packing::new(Domain::Open, vec![[0.0, 0.0], [1.0 + 0.25 + 1e-9, 0.0]], vec![0.5; 2]).expect("two disks");
    let mut assembly = Assembly::new(&packing, &Hertzian::default()).expect("apart");
    assembly.set_pruning(true);
    assert_eq!(assembly.pairs().len(), 0);
    // Towards each other, fast, until the list has nearly expired, then slowly: at a speed check an inner list would seem to suffice.
    for step in 1..=1200 {
        let length = if step <= 32 { 0.124 / 32.0 } else { 2e-6 };
        let right = if assembly.place(0)[0] < assembly.place(1)[0] { 0 } else { 1 };
        assembly.displacements[right][0] += length;
        assembly.displacements[1 - right][0] -= length;
        assembly.update_list(length).expect("apart");
        assembly.evaluate();
        let overlap = 1.0 - (assembly.place(1 - right)[0] - assembly.place(right)[0]);
        let pressed = assembly.forces[right][0] < 0.0;
        assert_eq!(pressed, overlap > 0.0, "step {step}: {overlap}");
    }
}

#[test]
fn a_list_that_all_disks_expire_is_rebuilt_with_a_wider_skin() {
    let (packing, _) = three_tiles();
    let smallest = packing.radii().iter().copied().fold(f64::INFINITY, f64::min);
    // Displacement of all disks in a step over the smallest radius, and the best skin: √(2 · 25 evaluations of a build / 0.75 · displacement).
    for (length, expected) in [(2e-4f64, 0.2), (2e-3, (50.0 / 0.75 * 2e-3f64).sqrt()), (1e-2, 0.5)] {
        let mut assembly = Assembly::with_incremental_updates(&packing, &Hertzian::default()).expect("no coincidence");
        assembly.set_pruning(true);
        assert_eq!(assembly.skin(), 0.2 * smallest);
        while assembly.build_count() == 1 {
            for (disk, displacement) in assembly.displacements.iter_mut().enumerate() {
                let angle = 1.7 * disk as f64;
                *displacement = sum(*displacement, [angle.cos(), angle.sin()].map(|along| length * smallest * along));
            }
            assembly.update_list(length * smallest).expect("no coincidence");
        }
        assert!((assembly.skin() - expected * smallest).abs() < 1e-9, "{length}: {}", assembly.skin());
    }
    // A short list has the wider one from the start.
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/packings/hertz_N5548_p100.xyz");
    let packing = read_packing::<2>(file).expect("a stored packing");
    let assembly = Assembly::with_incremental_updates(&packing, &Hertzian::default()).expect("no coincidence");
    assert_eq!(assembly.skin(), 0.5 * smallest);
}

#[test]
fn fast_disks_in_an_inner_list_find_each_other() {
    // Two disks beside very many at rest come together, several cells from where either was when the list was built.
    let beside = [[-20.0, 0.0], [-20.0, 4.5]];
    let places = (0..4900).map(|disk| [3.0 * f64::from(disk % 70), 3.0 * f64::from(disk / 70)]).chain(beside).collect();
    let packing = Packing::new(Domain::Open, places, vec![0.5; 4902]).expect("disks apart");
    let mut assembly = Assembly::new(&packing, &Hertzian::default()).expect("no coincidence");
    assembly.set_pruning(true);
    let [lower, upper] =
        [4900, 4901].map(|disk| assembly.order().iter().position(|&other| other == disk).expect("every disk"));
    let length = 1e-4;
    for step in 1..=17_600 {
        assembly.displacements[lower][1] += length;
        assembly.displacements[upper][1] -= length;
        assembly.update_list(length).expect("apart");
        if step > 17_400 {
            assembly.evaluate();
            let overlap = 1.0 - (assembly.place(upper)[1] - assembly.place(lower)[1]);
            assert!(overlap.abs() < 0.1, "they meet at the end");
            // Rounding decides at the touch itself.
            let pressed = assembly.forces[lower][1] < 0.0;
            assert!(overlap.abs() < 1e-9 || pressed == (overlap > 0.0), "step {step}: {overlap}");
        }
    }
    assert_eq!(assembly.build_count(), 1);
    assert!(assembly.skin() < 0.1, "by the inner list: {}", assembly.skin());
}
