//! The Hessian against closed forms, differences of forces, and one made anew.

use jamscope::forces::Assembly;
use jamscope::law::{Hertzian, Hookean, OnSite, PairLaw, PowerLaw};
use jamscope::linear::{Hessian, Members, Prestress};
use jamscope::network::ContactNetwork;
use jamscope::packing::{Domain, Packing};
use jamscope::preparation::random_points;
use jamscope::vector::{Vector, difference, larger};

use super::dense;
use crate::scenes::laws::hertzian;
use crate::scenes::random_disks::{disks, periodic, tilted};

/// A mobile disk, held ones around it where `held` says, overlapping it by 0.1 at a distance of 1.1.
fn around<const D: usize>(held: &[Vector<D>]) -> Packing<D> {
    let positions: Vec<Vector<D>> = std::iter::once([0.0; D]).chain(held.iter().map(|n| n.map(|x| 1.1 * x))).collect();
    let count = positions.len();
    let radii = std::iter::once(0.7).chain(std::iter::repeat_n(0.5, count - 1)).collect();
    Packing::new(Domain::Open, positions, radii)
        .and_then(|packing| packing.with_held((0..count).map(|disk| disk > 0).collect()))
        .expect("valid")
}

#[test]
fn one_contact_has_its_stiffness_along_and_its_force_over_its_length_across() {
    fn check<const D: usize>(law: &dyn PairLaw, normal: Vector<D>) {
        let coupling = 0.3;
        let law = &OnSite { law: law.shared(), coupling };
        let force = law.force(law.coefficient(0.7, 0.5), 0.1);
        let (along, across) = (law.stiffness(force, 0.1), -force / 1.1);
        for (prestress, across) in [(Prestress::Included, across), (Prestress::LeftOut, 0.0)] {
            let hessian = Hessian::new(&around(&[normal]), law, Members::InContact, prestress).expect("apart");
            assert_eq!(hessian.disks(), [0]);
            let matrix = dense(hessian.matrix());
            for a in 0..D {
                for b in 0..D {
                    let one = f64::from(u8::from(a == b));
                    let exact = along * normal[a] * normal[b] + across * (one - normal[a] * normal[b]) - coupling * one;
                    // The overlap is 1.2 − 1.1·|n|: rounded to 2e-16/0.1, and a few roundings of the products.
                    assert!((matrix[a][b] - exact).abs() < 2e-14 * along, "{law:?} {a}{b}: {} {exact}", matrix[a][b]);
                }
            }
        }
        // A disk with one contact is no part of a backbone.
        let none = Hessian::new(&around(&[normal]), law, Members::Backbone, Prestress::Included).expect("apart");
        assert_eq!(none.matrix().dimension(), 0);
    }
    check(&Hertzian { stiffness: 3.0 }, [0.6, 0.8]);
    check(&Hookean { stiffness: 3.0 }, [0.28, 0.96]);
    check(&PowerLaw { energy_scale: 2.0, exponent: 3.2 }, [0.8, -0.6]);
    check(&Hertzian { stiffness: 3.0 }, [0.48, 0.6, 0.64]);
    check(&Hookean { stiffness: 3.0 }, [0.0, 0.0, 1.0]);
}

/// Every column of the Hessian against central differences of the forces; disks with sites away from where they are.
fn check_against_forces<const D: usize>(law: &dyn PairLaw, packing: &Packing<D>) {
    let mut assembly = Assembly::new(packing, law).expect("apart");
    let hessian = Hessian::of(&assembly, Members::InContact, Prestress::Included);
    let matrix = dense(hessian.matrix());
    let place: Vec<usize> = (0..packing.len())
        .map(|disk| assembly.order().iter().position(|&other| other as usize == disk).expect("every disk"))
        .collect();
    let h = 1e-7;
    // Truncation (h/δ)² F'/δ^0 of each contact: overlaps below 20 h are left to the check that there are none. Hertzian:
    // F''' h²/6 = F' h²/(8 δ²) ≤ 3e-4 F'(δ) for δ = 20 h, and F'(20 h) is 1e-3 of the others. Rounding: ε F/h = 2e-9 F.
    let network = ContactNetwork::new(packing, law).expect("apart");
    let stiffest = network.contacts.iter().map(|c| law.stiffness(c.force, c.overlap)).fold(0.0, larger);
    assert!(network.contacts.iter().all(|contact| contact.overlap > 20.0 * h), "choose another seed");
    assert!(!hessian.disks().is_empty());
    for (block, &disk) in hessian.disks().iter().enumerate() {
        for axis in 0..D {
            let mut forces_at = |step: f64| {
                let before = assembly.displacements[place[disk as usize]];
                assembly.displacements[place[disk as usize]][axis] += step;
                assembly.evaluate();
                assembly.displacements[place[disk as usize]] = before;
                assembly.forces.clone()
            };
            let (ahead, behind) = (forces_at(h), forces_at(-h));
            for (other_block, &other) in hessian.disks().iter().enumerate() {
                let at = place[other as usize];
                let slopes = difference(behind[at], ahead[at]).map(|x| x / (2.0 * h));
                for d in 0..D {
                    let value = matrix[D * other_block + d][D * block + axis];
                    assert!(
                        (value - slopes[d]).abs() < 1e-6 * stiffest,
                        "{law:?}: disks {other}, {disk}: {value} and {}",
                        slopes[d]
                    );
                }
            }
        }
    }
}

#[test]
fn the_hessian_is_minus_the_derivative_of_the_forces() {
    fn check(law: &dyn PairLaw) {
        for seed in [1, 2, 5] {
            check_against_forces(law, &disks(seed, 30, periodic([3.0, 4.0]), 0.2));
            check_against_forces(law, &disks(seed, 30, tilted([3.0, 4.0], [0.7, 0.0, 0.0]), 0.2));
            check_against_forces(law, &disks(seed, 30, Domain::<2>::Open, 0.2));
            check_against_forces(law, &disks(seed, 30, periodic([2.0, 3.0, 2.5]), 0.2));
            check_against_forces(law, &disks(seed, 30, tilted([2.0, 3.0, 2.5], [-0.4, 0.6, 1.2]), 0.2));
            check_against_forces(
                &OnSite { law: law.shared(), coupling: 0.7 },
                &disks(seed, 30, periodic([3.0, 4.0]), 0.2),
            );
        }
    }
    check(&Hertzian { stiffness: 1.0 });
    check(&Hookean { stiffness: 1.0 });
    check(&PowerLaw { energy_scale: 1.0, exponent: 2.8 });
}

#[test]
fn a_moved_packing_keeps_the_pattern_until_a_contact_changes() {
    let law = hertzian();
    let mut assembly =
        Assembly::new(&random_points::<2>(60, &Default::default(), 1.0, 3).expect("possible"), &law).expect("apart");
    let mut hessian = Hessian::of(&assembly, Members::Backbone, Prestress::Included);
    let first = hessian.matrix().clone();
    assert!(hessian.update(&assembly));
    assert_eq!(*hessian.matrix(), first);
    let mut kept = 0;
    for step in 1..=20 {
        let length = 1e-9 * 4f64.powi(step);
        for (index, displacement) in assembly.displacements.iter_mut().enumerate() {
            *displacement = [length * (index as f64).sin(), length * (2.0 * index as f64).cos()];
        }
        assembly.update_list(f64::INFINITY).expect("apart");
        let same = hessian.update(&assembly);
        let fresh = Hessian::of(&assembly, Members::Backbone, Prestress::Included);
        assert_eq!(hessian.matrix(), fresh.matrix(), "length {length}");
        assert_eq!(hessian.disks(), fresh.disks());
        kept += usize::from(same && fresh.matrix().has_pattern_of(&first));
        if length > 0.2 {
            assert!(!fresh.matrix().has_pattern_of(&first));
        }
    }
    assert!(kept >= 5, "{kept}");
}
