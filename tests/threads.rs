//! One large packing on several threads: the bits of one thread, and the forces of the plainest loop.
//!
//! Seven tiles of 8192 disks and less, three threads, whatever the machine has.

#[path = "../examples/scenes/tiled.rs"]
mod tiled;

use std::sync::Once;

use jamscope::contact::{Assembly, Hertzian, PairLaw};
use jamscope::io::read_packing;
use jamscope::packing::Packing;
use jamscope::relax::{Fire, ForceLimit, Relaxer};
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
    let mut assembly = Assembly::new(&large(), Hertzian::default()).expect("disks apart");
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
    let mut assembly = Assembly::new(&large(), Hertzian::default()).expect("disks apart");
    // Apart from the anchors too: up to a tenth of the skin.
    for (index, displacement) in assembly.displacements.iter_mut().enumerate() {
        *displacement = sum(*displacement, [6e-3 * (index as f64).sin(), 6e-3 * (3.0 * index as f64).cos()]);
    }
    assembly.evaluate();
    let (law, pairs) = (*assembly.law(), assembly.pairs());
    let mut plain = vec![[0.0; 2]; assembly.len()];
    let mut largest: f64 = 0.0;
    for pair in 0..pairs.len() {
        let (i, j) = (pairs.first[pair] as usize, pairs.second[pair] as usize);
        let moved = difference(assembly.displacements[i], assembly.displacements[j]);
        let apart = sum(pairs.separation[pair], moved);
        let overlap = (pairs.distance[pair] + pairs.overlap[pair] - norm(apart)).max(0.0);
        let force = scaled(law.force(pairs.coefficient[pair], overlap) / norm(apart), apart);
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
fn a_relaxation_has_the_bits_of_one_thread() {
    let fire = Fire { limit: ForceLimit::Relative(0.0), step_limit: 150, ..Fire::default() };
    let start = large();
    let law = Hertzian::default();
    let here = fire.relax(start.clone(), &law, &mut ()).expect("disks apart");
    let alone = on_one_thread(|| fire.relax(start, &law, &mut ())).expect("disks apart");
    assert!(here.cost.rebuild_count > 1, "no list was made anew");
    assert_eq!(here.cost.force_evaluation_count, alone.cost.force_evaluation_count);
    assert_eq!(here.state.positions(), alone.state.positions());
    assert_eq!(here.state.corrections(), alone.state.corrections());
    assert_eq!(here.residual, alone.residual);
}
