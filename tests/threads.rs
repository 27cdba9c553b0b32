//! One large packing on several threads: the bits of one thread, and the forces of the plainest loop.
//!
//! Seven tiles of 8192 disks and less, three threads, whatever the machine has.

#[path = "../benches/measurements/scenes/tiled.rs"]
mod tiled;

use std::sync::Once;

use jamscope::forces::Assembly;
use jamscope::forces::advance::Advanced;
use jamscope::forces::damped::{add_damping, damped_forces};
use jamscope::io::read_packing;
use jamscope::law::Hertzian;
use jamscope::law::damping::{ConstantDamping, ContactDamping};
use jamscope::packing::Packing;
use jamscope::processor::{Processor, Vectors};
use jamscope::relax::{Fire, ForceLimit, Precision, Relaxer};
use jamscope::vector::{difference, norm, scaled, sum};

static THREADS: Once = Once::new();

/// 49932 disks at p = 100, one of them grown and held.
fn large() -> Packing<2> {
    THREADS.call_once(|| {
        rayon::ThreadPoolBuilder::new().num_threads(3).build_global().expect("the first pool of this program");
    });
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/packings/hertz_N5548_p100.xyz");
    let packing = tiled::tiled(&read_packing::<2>(file).expect("a stored packing"), 3).expect("a periodic packing");
    let held = (0..packing.len()).map(|disk| disk == 20_000).collect();
    let radius = packing.radii()[20_000];
    packing.with_radius(20_000, radius + 0.1).and_then(|packing| packing.with_held(held)).expect("a valid disk")
}

/// A pool's own threads keep a relaxation to one of them.
fn on_one_thread<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool").install(work)
}

#[test]
fn forces_and_totals_have_the_bits_of_one_thread() {
    let mut assembly = Assembly::new(&large(), &Hertzian::default()).expect("disks apart");
    let totals = assembly.evaluate_totals();
    let forces = assembly.forces.clone();
    let mut alone = assembly.clone();
    let (totals_alone, forces_alone) = on_one_thread(move || (alone.evaluate_totals(), alone.forces));
    assert_eq!(totals, totals_alone);
    assert_eq!(forces, forces_alone);
    assembly.forces.fill([f64::NAN; 2]);
    assembly.evaluate();
    assert_eq!(forces, assembly.forces, "with and without totals");
}

#[test]
fn forces_across_tiles_are_those_of_the_plain_loop() {
    let mut assembly = Assembly::new(&large(), &Hertzian::default()).expect("disks apart");
    // Apart from the anchors too: up to a tenth of the skin.
    for (index, displacement) in assembly.displacements.iter_mut().enumerate() {
        *displacement = sum(*displacement, [6e-3 * (index as f64).sin(), 6e-3 * (3.0 * index as f64).cos()]);
    }
    assembly.evaluate();
    let (law, pairs) = (assembly.law(), assembly.pairs());
    let mut plain = vec![[0.0; 2]; assembly.len()];
    let mut largest: f64 = 0.0;
    for pair in pairs.numbers() {
        let (i, j) = (pairs.first[pair] as usize, pairs.second[pair] as usize);
        let moved = difference(assembly.displacements[i], assembly.displacements[j]);
        let apart = sum(pairs.separation(pair), moved);
        let overlap = (pairs.distance(pair) + pairs.overlap(pair) - norm(apart)).max(0.0);
        let force = scaled(law.force(pairs.coefficient(pair), overlap) / norm(apart), apart);
        plain[i] = sum(plain[i], force);
        plain[j] = difference(plain[j], force);
        largest = largest.max(norm(force));
    }
    // The overlap of the plain loop carries the rounding of distances, some 2·10⁻¹⁶; at overlaps from 10⁻³ on that is 10⁻¹²
    // of a force, and there are up to seven in a sum. A force left out would be of the order of the largest.
    for (index, (found, plain)) in assembly.forces.iter().zip(&plain).enumerate() {
        let error = norm(difference(*found, *plain));
        assert!(error < 1e-11 * largest, "disk {index}: {error:e} of {largest:e}");
    }
}

#[test]
fn sums_of_stiffness_across_tiles_are_those_of_the_plain_loop() {
    // One held disk, and a third of all, which fill tiles of their own.
    for every in [usize::MAX, 3] {
        let held = (0..large().len()).map(|disk| disk == 20_000 || disk % every == 1).collect();
        let packing = large().with_held(held).expect("mobile disks");
        let mut assembly = Assembly::new(&packing, &Hertzian::default()).expect("disks apart");
        for (index, displacement) in assembly.displacements.iter_mut().enumerate() {
            *displacement = sum(*displacement, [6e-3 * (index as f64).sin(), 6e-3 * (3.0 * index as f64).cos()]);
        }
        let mut rows = vec![f64::NAN; 3];
        let bound = assembly.row_bound(&mut rows, None);
        let (law, pairs, mobile) = (assembly.law(), assembly.pairs(), assembly.mobile_count());
        let mut plain = vec![0.0; assembly.len()];
        for pair in pairs.numbers() {
            let (i, j) = (pairs.first[pair] as usize, pairs.second[pair] as usize);
            let moved = difference(assembly.displacements[i], assembly.displacements[j]);
            let apart = norm(sum(pairs.separation(pair), moved));
            let overlap = (pairs.distance(pair) + pairs.overlap(pair) - apart).max(0.0);
            let stiffness = law.stiffness(law.force(pairs.coefficient(pair), overlap), overlap);
            plain[i] += if j < mobile { 2.0 * stiffness } else { stiffness };
            plain[j] += if j < mobile { 2.0 * stiffness } else { 0.0 };
        }
        let largest = plain[..mobile].iter().copied().fold(0.0, f64::max);
        // An overlap of the plain loop carries some 4·10⁻¹⁶, so a stiffness ∼ √δ up to 2·10⁻⁸ of that of an overlap of 1, and twice
        // that stands in a row up to seven times; the largest row has overlaps above 0.03. A pair left out would be a tenth of it.
        for (disk, (found, plain)) in rows.iter().zip(&plain).enumerate() {
            assert!((found - plain).abs() < 2e-6 * largest, "disk {disk}: {found} for {plain}");
        }
        assert!((bound - largest).abs() < 2e-6 * largest, "{bound} for {largest}");
        assert!(rows[mobile..].iter().all(|&row| row == 0.0), "a held disk");
        assert_eq!(rows.len(), assembly.len());
    }
}

#[test]
fn damped_forces_across_tiles_are_elastic_forces_and_damping() {
    let mut assembly = Assembly::new(&large(), &Hertzian::default()).expect("disks apart");
    assembly.evaluate();
    let (law, damping, pairs) =
        (assembly.law(), ContactDamping::Constant(ConstantDamping { rate: 500.0 }), assembly.pairs());
    let coefficients = vec![damping.coefficient(0.5, 0.5); pairs.place_count()];
    let wave = |disk: usize| [1e-2 * (disk as f64).sin(), 1e-2 * (2.0 * disk as f64).cos()];
    let (at, velocities) = (&assembly.displacements, (0..assembly.len()).map(wave).collect::<Vec<_>>());
    let mut apart = assembly.forces.clone();
    let power = add_damping(&damping, pairs, &coefficients, at, &velocities, &mut apart);
    let mut together = vec![[f64::NAN; 2]; assembly.len()];
    let found = damped_forces((law, &damping), pairs, &coefficients, at, &velocities, &mut together);
    // Sums of 10⁵ terms of one sign in another order, 10⁻¹⁶ each.
    assert!((found - power).abs() < 1e-11 * power && power > 0.0, "{found} for {power}");
    let largest = apart.iter().map(|&force| norm(force)).fold(0.0, f64::max);
    for (disk, (one, two)) in apart.iter().zip(&together).enumerate() {
        // As above: forces of contacts carry 10⁻¹², a pair left out would be of the order of the largest.
        assert!(norm(difference(*one, *two)) < 1e-11 * largest, "disk {disk}: {one:?} {two:?}");
    }
}

/// All disks away from where they were by a fifth of a radius: many go far, and lists are made anew.
fn shaken(packing: &Packing<2>) -> Packing<2> {
    let way = |disk: usize| [0.1 * (disk as f64).sin(), 0.1 * (3.0 * disk as f64).cos()];
    let positions = packing.positions().iter().enumerate().map(|(disk, &at)| sum(at, way(disk))).collect();
    let shaken = Packing::new(*packing.domain(), positions, packing.radii().to_vec());
    shaken.and_then(|shaken| shaken.with_held(packing.held().to_vec())).expect("disks of that packing")
}

#[test]
fn tiles_and_packed_lists_have_the_same_bits_with_every_kernel() {
    // Seven tiles: long lists, packed where vectors have 512 bits, and borders.
    let law = Hertzian::default();
    let found: Vec<_> = Processor::all()
        .into_iter()
        .map(|processor| {
            processor.run(|| {
                let mut assembly = Assembly::new(&large(), &law).expect("disks apart");
                let totals = assembly.evaluate_totals();
                let ends = [Precision::Double, Precision::Mixed].map(|precision| {
                    let limit = ForceLimit::Relative(0.0);
                    let fire = Fire { limit, step_limit: 60, precision, ..Fire::default() };
                    let end = fire.relax(shaken(&large()), &law, &mut ()).expect("disks apart");
                    (
                        end.state.positions().to_vec(),
                        end.state.corrections().to_vec(),
                        end.residual,
                        end.cost.build_count,
                    )
                });
                (processor, (assembly.forces, totals, ends))
            })
        })
        .collect();
    let (own, expected) = found.last().expect("its own");
    assert!(found.iter().any(|(processor, _)| processor.vectors() == Vectors::None));
    for (processor, one) in &found {
        // Numbers that are equal and not zero have the same bits.
        assert!(one == expected, "{processor:?} and {own:?} differ");
    }
}

#[test]
fn a_relaxation_has_the_bits_of_one_thread() {
    // From rest a few disks go far, and the list is amended for them.
    for (start, makes_lists) in [(large(), false), (shaken(&large()), true)] {
        for precision in [Precision::Double, Precision::Mixed] {
            let fire = Fire { limit: ForceLimit::Relative(0.0), step_limit: 150, precision, ..Fire::default() };
            let law = Hertzian::default();
            let here = fire.relax(start.clone(), &law, &mut ()).expect("disks apart");
            let alone = on_one_thread(|| fire.relax(start.clone(), &law, &mut ())).expect("disks apart");
            assert!(here.cost.build_count > 1 || !makes_lists, "no list was rebuilt");
            assert_eq!(here.cost.force_evaluation_count, alone.cost.force_evaluation_count);
            assert_eq!(here.state.positions(), alone.state.positions());
            assert_eq!(here.state.corrections(), alone.state.corrections());
            assert_eq!(here.residual, alone.residual);
        }
    }
}

/// Velocities of the mobile disks, as if they had been moving.
fn velocities(assembly: &Assembly<2>) -> Vec<[f64; 2]> {
    (0..assembly.mobile_count()).map(|disk| [1e-3 * (disk as f64).sin(), 1e-3 * (2.0 * disk as f64).cos()]).collect()
}

/// v ← v + 10⁻⁶ F, u ← u + 10⁻² v. A bound on how far any has moved: forces are below 10⁴, velocities below 10⁻² then.
fn kick(forces: &[[f64; 2]], velocities: &mut [[f64; 2]], displacements: &mut [[f64; 2]]) -> f64 {
    for ((force, velocity), displacement) in forces.iter().zip(velocities.iter_mut()).zip(displacements) {
        *velocity = sum(*velocity, scaled(1e-6, *force));
        *displacement = sum(*displacement, scaled(1e-2, *velocity));
    }
    1e-3
}

/// How many disks there are, and Σ F·v.
fn look(forces: &[[f64; 2]], velocities: &[[f64; 2]]) -> (usize, f64) {
    assert_eq!(forces.len(), velocities.len());
    (
        forces.len(),
        forces.iter().flatten().zip(velocities.iter().flatten()).map(|(force, velocity)| force * velocity).sum(),
    )
}

#[test]
fn a_step_tile_by_tile_has_the_bits_of_one_array_by_array() {
    let packing = large();
    assert_eq!(packing.held().iter().filter(|&&held| held).count(), 1);
    check_a_step(packing);
    // Three tiles of held disks and one of both sorts.
    let packing = large();
    let middle = packing.domain().lengths().expect("periodic")[1] / 2.0;
    let held = packing.positions().iter().map(|position| position[1] > middle).collect();
    let packing = packing.with_held(held).expect("some are mobile");
    assert!(packing.held().iter().filter(|&&held| held).count() > 20_000);
    check_a_step(packing);
}

fn check_a_step(packing: Packing<2>) {
    let mut assembly = Assembly::new(&packing, &Hertzian::default()).expect("disks apart");
    assembly.evaluate();
    let mobile = assembly.mobile_count();
    let mut apart = (assembly.clone(), velocities(&assembly));
    kick(&apart.0.forces[..mobile], &mut apart.1, &mut apart.0.displacements[..mobile]);
    apart.0.evaluate();
    let mut step = (assembly.clone(), velocities(&assembly));
    let mut alone = step.clone();
    let looked = evaluated(step.0.advance(&mut step.1, kick, look));
    assert_eq!(apart.1, step.1, "velocities");
    assert_eq!(apart.0.displacements, step.0.displacements);
    assert_eq!(apart.0.forces, step.0.forces);
    assert_eq!(looked.iter().map(|&(count, _)| count).sum::<usize>(), mobile, "every disk is looked at once");
    let expected = look(&apart.0.forces[..mobile], &apart.1).1;
    let found: f64 = looked.iter().map(|&(_, power)| power).sum();
    // Sums of 10⁵ terms in another order, of size at most Σ|F||v| ~ 5·10⁴ · 10² · 10⁻³.
    assert!((found - expected).abs() < 1e-9, "{found} for {expected}");
    let (of_one, looked_by_one) = on_one_thread(move || {
        let looked = evaluated(alone.0.advance(&mut alone.1, kick, look));
        (alone, looked)
    });
    assert_eq!(of_one.0.forces, step.0.forces, "one thread");
    assert_eq!(looked_by_one, looked, "one thread");
    // A radius and a half in one step is farther than the list allows, and moves the disks all the same.
    let before = assembly.displacements.clone();
    let mut far = vec![[0.0, 0.0]; mobile];
    far[mobile / 2] = [0.75, 0.0];
    let go = |_: &[_], velocities: &mut [_], displacements: &mut [[f64; 2]]| {
        kick(&vec![[0.0; 2]; velocities.len()], velocities, displacements) + 0.75
    };
    far.iter_mut().for_each(|velocity| velocity[0] *= 100.0);
    assert_eq!(assembly.advance(&mut far, go, look), Advanced::Moved);
    let moved = |disk: usize| assembly.displacements[disk][0] - before[disk][0];
    assert!((moved(mobile / 2) - 0.75).abs() < 1e-12);
    assert!((0..mobile).filter(|&disk| disk != mobile / 2).all(|disk| moved(disk) == 0.0));
}

fn evaluated<P: std::fmt::Debug>(advanced: Advanced<P>) -> Vec<P> {
    match advanced {
        Advanced::Evaluated(parts) => parts,
        other => panic!("the list holds: {other:?}"),
    }
}
