//! Contacts: the neighbour list and the hot loop against their slow twins, forces against energies, invariances,
//! rounding, and what is refused.
//!
//! Random cases come from proptest, with the seeds of `scenes::seeds`.

use std::collections::BTreeSet;
use std::f64::consts::SQRT_2;

use crate::scenes::random_disks::{disks, on_grid, periodic, tilted};
use crate::scenes::seeds::config;
use crate::twins::all_pairs::{mechanics, pairs_within};
use crate::twins::naive_backbone::contacts_within;
use crate::twins::{all_pairs, naive_backbone};
use jamscope::forces::Assembly;
use jamscope::forces::assembly::SKIN;
use jamscope::forces::totals::Totals;
use jamscope::law::{Hertzian, Hookean, PairLaw, PowerLaw};
use jamscope::network::ContactNetwork;
use jamscope::network::backbone;
use jamscope::packing::{Domain, Packing, PackingError};
use jamscope::vector::{Vector, difference, norm, sum};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Unit roundoff, twice.
const EPSILON: f64 = f64::EPSILON;

fn cases(count: u32) -> ProptestConfig {
    config(count, 20)
}

/// Boxes from the smallest allowed (one to three cells a side) to elongated ones, rectangular and tilted, and the open
/// plane.
fn domains<const D: usize>() -> impl Strategy<Value = Domain<D>> {
    let side = prop_oneof![Just(1.0), 1.0..1.6f64, 1.0..6.0f64];
    prop_oneof![
        4 => proptest::array::uniform::<_, D>(side.clone()).prop_map(|sides| periodic(sides.map(on_grid))),
        4 => (proptest::array::uniform::<_, D>(side), [-1.5..1.5f64, -1.5..1.5f64, -1.5..1.5f64])
            .prop_map(|(sides, tilts)| tilted(sides.map(on_grid), tilts)),
        1 => Just(Domain::Open),
    ]
}

/// Forces of the hot loop in the caller's order, from buffers full of NaN.
fn evaluated<const D: usize>(assembly: &mut Assembly<D>) -> (Vec<Vector<D>>, Totals<D>) {
    assembly.forces.fill([f64::NAN; D]);
    let totals = assembly.evaluate_totals();
    let with_totals = assembly.forces.clone();
    assembly.forces.fill([f64::NAN; D]);
    assembly.evaluate();
    assert_eq!(assembly.forces, with_totals, "the loop with totals gives other forces than the one without");
    let mut forces = vec![[f64::NAN; D]; assembly.len()];
    for (&disk, &force) in assembly.order().iter().zip(&with_totals) {
        forces[disk as usize] = force;
    }
    (forces, totals)
}

fn forces_of<const D: usize>(packing: &Packing<D>, law: &dyn PairLaw) -> (Vec<Vector<D>>, Totals<D>) {
    evaluated(&mut Assembly::new(packing, law).expect("no coincidence"))
}

/// How far forces and totals may be off when every separation is known to `blur` only, pair by pair: the force by
/// F(δ + blur) − F(δ) and by the turn of its direction, F blur / r; and by 16 roundings of itself.
struct Allowed {
    forces: Vec<f64>,
    energy: f64,
    virial: f64,
    force_sum: f64,
}

fn allowed<const D: usize>(packing: &Packing<D>, law: &dyn PairLaw, blur: f64) -> Allowed {
    let pairs = pairs_within(packing, blur);
    let mut allowed = Allowed { forces: vec![0.0; packing.len()], energy: 0.0, virial: 0.0, force_sum: 0.0 };
    // A sum over all contacts rounds once a contact.
    let sum_rounding = (16 + pairs.len()) as f64 * EPSILON;
    for pair in &pairs {
        let coefficient = law.coefficient(packing.radii()[pair.first], packing.radii()[pair.second]);
        let overlap = pair.overlap.max(0.0);
        let (force, most) = (law.force(coefficient, overlap), law.force(coefficient, overlap + blur));
        let off = (most - force) + most * (blur / pair.distance + 16.0 * EPSILON);
        // A disk has at most all pairs; its sum rounds once each.
        allowed.forces[pair.first] += off + sum_rounding * most;
        allowed.forces[pair.second] += off + sum_rounding * most;
        allowed.energy += most * blur + sum_rounding * most * (overlap + blur);
        allowed.virial += off * pair.distance + most * blur + sum_rounding * most * pair.distance;
        allowed.force_sum += off + sum_rounding * most;
    }
    allowed
}

/// Rounding of plain coordinate differences: a few roundings of the largest coordinate and the largest box.
fn blur<const D: usize>(packing: &Packing<D>) -> f64 {
    let largest = packing.positions().iter().flatten().fold(1.0f64, |most, value| most.max(value.abs()));
    let side = packing.domain().lengths().map_or(0.0, |lengths| lengths.iter().copied().fold(0.0, f64::max));
    8.0 * EPSILON * (largest + 3.0 * side)
}

fn assert_agree<const D: usize>(
    what: &str,
    ours: (&[Vector<D>], &Totals<D>),
    theirs: (&[Vector<D>], f64, &[[f64; D]; D], f64),
    allowed: &Allowed,
) {
    for (disk, (&a, &b)) in ours.0.iter().zip(theirs.0).enumerate() {
        let off = norm(difference(a, b));
        assert!(off <= allowed.forces[disk], "{what}: force on {disk} is {a:?}, not {b:?}");
    }
    let totals = ours.1;
    assert!((totals.energy - theirs.1).abs() <= allowed.energy, "{what}: energy {} and {}", totals.energy, theirs.1);
    for a in 0..D {
        for b in 0..D {
            let off = (totals.virial[a][b] - theirs.2[a][b]).abs();
            assert!(off <= allowed.virial, "{what}: virial {a}{b} {:?} and {:?}", totals.virial, theirs.2);
        }
    }
    assert!((totals.force_sum - theirs.3).abs() <= allowed.force_sum, "{what}: {} and {}", totals.force_sum, theirs.3);
}

/// The list has every pair in reach, once, along the right image, and nothing beyond the skin.
fn assert_list_is_complete<const D: usize>(assembly: &Assembly<D>, packing: &Packing<D>, fresh: bool) {
    let smallest = packing.radii().iter().copied().fold(f64::INFINITY, f64::min);
    let pairs = assembly.pairs();
    let order = assembly.order();
    let blur = blur(packing);
    let listed: BTreeSet<(usize, usize)> = pairs
        .numbers()
        .map(|pair| {
            let (i, j) = (pairs.first[pair] as usize, pairs.second[pair] as usize);
            assert!(i < j && i < assembly.mobile_count(), "pair {i} {j} is held–held or in the wrong order");
            let (a, b) = (order[i] as usize, order[j] as usize);
            if fresh {
                let reach = packing.radii()[a] + packing.radii()[b] + SKIN * smallest;
                assert!(pairs.distance(pair) < reach + blur, "pair {a} {b} is beyond the skin");
            }
            (a.min(b), a.max(b))
        })
        .collect();
    assert_eq!(listed.len(), pairs.len(), "a pair is listed twice");
    for pair in pairs_within(packing, -blur) {
        assert!(listed.contains(&(pair.first, pair.second)), "{} and {} touch, unlisted", pair.first, pair.second);
    }
}

fn check_against_all_pairs<const D: usize>(law: &dyn PairLaw, seed: u64, count: usize, domain: Domain<D>) {
    let packing = disks(seed, count, domain, 0.2);
    let mut assembly = Assembly::new(&packing, law).expect("no coincidence");
    let mut generator = Pcg64::seed_from_u64(seed ^ 1);
    // First as listed, then in flight, each disk straight on by up to half the skin a round: between two
    // rounds the list stays or is rebuilt, and at the end disks have come together from well beyond the skin.
    let mobile = assembly.mobile_count();
    let mut away = |_| std::array::from_fn(|_| 0.15 * SKIN * (2.0 * generator.random::<f64>() - 1.0));
    let flight: Vec<Vector<D>> = (0..mobile).map(&mut away).collect();
    let longest = flight.iter().map(|&step| norm(step)).fold(0.0, f64::max);
    for round in 0..8 {
        if round > 0 {
            for (u, &step) in assembly.displacements[..mobile].iter_mut().zip(&flight) {
                *u = sum(*u, step);
            }
            assembly.update_list(longest).expect("no coincidence");
        }
        let placed = assembly.placed(packing.clone());
        assert_list_is_complete(&assembly, &placed, round == 0);
        let (forces, totals) = evaluated(&mut assembly);
        let twin = mechanics(&placed, law);
        let allowed = allowed(&placed, law, blur(&placed));
        let theirs = (&twin.forces[..], twin.energy, &twin.virial, twin.force_sum);
        assert_agree("hot loop and twin", (&forces, &totals), theirs, &allowed);
        let near = pairs_within(&placed, blur(&placed)).len() - pairs_within(&placed, -blur(&placed)).len();
        assert!(totals.contact_count.abs_diff(twin.contact_count) <= near, "contacts");
    }
}

mod agreement;
mod derivatives;
mod incremental_update;
mod invariance;
mod loads;
mod network;
mod places;
mod rattlers;
mod refusals;
mod single;
