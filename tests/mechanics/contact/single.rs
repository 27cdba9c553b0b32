//! The loop in single precision against the one in double.

use jamscope::forces::Assembly;
use jamscope::forces::single_precision::Single;
use jamscope::law::{Hertzian, Hookean, PairLaw, PowerLaw};
use jamscope::packing::{Domain, Packing};
use jamscope::vector::{difference, norm};

use crate::scenes::starts::{inflated, points};

/// Unit roundoff of single precision.
const ROUNDING: f64 = f64::EPSILON * (1u64 << 28) as f64;

/// Disks of an assembly in single precision, each moved by up to `length` in a direction of its own.
fn moved<const D: usize>(assembly: &Assembly<D>, length: f64) -> Single<D> {
    let mut single = Single::new(assembly).expect("in range");
    let unit = single.units().length;
    let mut velocities = vec![[0.0; D]; assembly.mobile_count()];
    single.kick(assembly, &mut velocities, |_, _, ways| {
        for (disk, way) in ways.iter_mut().enumerate() {
            *way = std::array::from_fn(|d| (length / unit * ((d + 1) as f64 * disk as f64 + d as f64).sin()) as f32);
        }
    });
    single
}

/// Each contact is known to some roundings of its force and of what the way changes it by: r, its square and root, the reciprocal, δ, F and
/// the product with r, a dozen of half a unit each; F' is less than 2.5 F/δ, or the largest of all contacts.
fn compare<const D: usize>(packing: &Packing<D>, law: &dyn PairLaw, length: f64) {
    let mut assembly = Assembly::new(packing, law).expect("no coincidence");
    let mut single = moved(&assembly, length);
    single.evaluate(&assembly);
    single.write_displacements(&mut assembly);
    assert!(length == 0.0 || assembly.longest_displacement() > 0.5 * length, "settled");
    assembly.evaluate();
    let stiffest = assembly.stiffness_bound(&mut Vec::new());
    let contact = single.units().force;
    let mut worst = 0.0f64;
    for (disk, (ours, exact)) in single.forces.iter().zip(&assembly.forces).enumerate() {
        let ours = ours.map(|force| contact * f64::from(force));
        let pressed: f64 = pulls(&assembly, disk);
        // Gershgorin's bound is four times the stiffness around a disk and more.
        let error = ROUNDING * (12.0 * pressed + 4.0 * stiffest * length);
        worst = worst.max(norm(difference(ours, *exact)) / error);
    }
    assert!(worst <= 1.0, "{law:?}, {length:e}: {worst} of what rounding explains");
    assert!(worst > 1e-3, "{law:?}, {length:e}: single precision is what is tested, {worst}");
}

/// Sum of the contact forces on a disk.
fn pulls<const D: usize>(assembly: &Assembly<D>, disk: usize) -> f64 {
    let (law, pairs) = (assembly.law(), assembly.pairs());
    let with = pairs.numbers().filter(|&k| pairs.first[k] as usize == disk || pairs.second[k] as usize == disk);
    with.map(|k| {
        let (_, _, overlap) = jamscope::forces::elastic::geometry(pairs, k, &assembly.displacements);
        law.force(pairs.coefficient(k), overlap.max(0.0))
    })
    .sum()
}

#[test]
fn forces_are_those_in_double_precision_to_the_rounding_of_single() {
    for length in [0.0, 1e-5, 1e-2] {
        compare(&inflated("hertz_N1000_p100", 1), &Hertzian::default(), length);
        compare(&inflated("hooke_N1000_p5000", 1), &Hookean::default(), length);
        compare(&points::<2>(300, 1.0, 4), &PowerLaw { energy_scale: 3.0, exponent: 2.5 }, length);
        compare(&points::<2>(300, 1.0, 4), &PowerLaw { energy_scale: 1e-3, exponent: 3.3 }, length);
        compare(&points::<3>(300, 1.0, 5), &Hertzian::default(), length);
    }
}

/// An overlap of 2⁻⁵⁰ is below the rounding of the distance in single precision and nearly in double: it is known from the base.
#[test]
fn an_overlap_far_below_the_rounding_of_distances_has_its_force() {
    let overlap = (-50f64).exp2();
    let packing = Packing::new(Domain::Open, vec![[0.0; 2], [1.0 - overlap, 0.0]], vec![0.5; 2]).expect("valid");
    let assembly = Assembly::new(&packing, &Hookean { stiffness: 2.0 }).expect("no coincidence");
    let mut single = moved(&assembly, 0.0);
    single.evaluate(&assembly);
    let force = single.units().force * f64::from(single.forces[0][0].abs());
    assert!((force / (2.0 * overlap) - 1.0).abs() < 4.0 * ROUNDING, "{force:e}");
}

#[test]
fn what_leaves_the_range_of_single_precision_is_not_begun() {
    let packing = points::<2>(30, 0.9, 1);
    let single = |stiffness| Single::new(&Assembly::new(&packing, &Hookean { stiffness }).expect("no coincidence"));
    assert!(single(1e-100).is_some() && single(1e100).is_some());
    for stiffness in [f64::NAN, f64::INFINITY, 1e308, 1e-308] {
        assert!(single(stiffness).is_none(), "{stiffness}");
    }
}
