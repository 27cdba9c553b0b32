//! One minimum, however it is reached: other relaxers, other places, other names, other units.

use jamscope::law::PairLaw;
use jamscope::network::ContactNetwork;
use jamscope::relax::{Fire, ForceLimit};

use super::all;
use crate::claims::elsewhere::Elsewhere;
use crate::claims::other_units::same_bits_in_other_units;
use crate::scenes::laws::{hertzian, hookean};
use crate::scenes::rest::{apart, at_rest, relax};
use crate::scenes::starts::{inflated, points, shaken};

/// Far above jamming all end in one minimum.
#[test]
#[cfg(feature = "linear")]
fn all_end_in_the_minimum_of_newton_at_high_pressure() {
    use jamscope::relax::Staged;
    let (law, limit) = (hertzian(), 1e-12);
    let mut together = 0;
    for index in 0..10 {
        let start = || inflated("hertz_N1000_p800", index);
        let staged = Staged { limit: ForceLimit::Relative(limit), ..Staged::default() };
        let reference = at_rest(relax(&staged, start(), &law));
        let far = all(limit).map(|choice| apart(&reference, &at_rest(relax(&choice, start(), &law)), &law));
        println!("sample {index}: {far:?} from staged");
        together += usize::from(far.iter().all(|&far| far <= 1e-9));
    }
    assert!(together >= 9, "{together} of 10 end together");
}

/// From next to a minimum every relaxer goes back to it.
#[test]
fn all_meet_in_a_minimum_near_by() {
    fn check(law: &dyn PairLaw, name: &str) {
        let fire = |limit| Fire { limit: ForceLimit::Relative(limit), ..Fire::default() };
        let minimum = at_rest(relax(&fire(1e-12), inflated(name, 5), law));
        let start = shaken(&minimum, 1e-4, 7);
        for choice in all(1e-11) {
            let off = apart(&minimum, &at_rest(relax(&choice, start.clone(), law)), law);
            // 10⁻¹¹ of the mean force over the softest stiffness: Newton's tests derive 10⁻⁹ to 10⁻⁷ for these packings.
            assert!(off <= 1e-8, "{name}, {}: {off:e}", choice.name());
        }
    }
    check(&hertzian(), "hertz_N1000_p800");
    check(&hertzian(), "hertz_N1000_p100");
    check(&hookean(), "hooke_N1000_p5000");
}

/// Turned by a quarter, moved by a multiple of 2¹⁰ and relabelled in reverse, a shaken minimum is found at the same place.
#[test]
fn a_minimum_is_found_wherever_it_lies_and_whatever_its_disks_are_called() {
    let (law, limit) = (hertzian(), 1e-12);
    let minimum = at_rest(relax(&all(1e-12)[1], inflated("hertz_N1000_p800", 3), &law));
    let start = shaken(&minimum, 1e-5, 11);
    let elsewhere = Elsewhere { turned: true, offset: 3072.0 };
    let other = elsewhere.twin(&start);
    let backbone = ContactNetwork::new(&minimum, &law).expect("no coincidence").backbone;
    for choice in all(limit) {
        let [one, two] = [start.clone(), other.clone()].map(|start| at_rest(relax(&choice, start, &law)));
        let worst = elsewhere.apart(&one, &two, &backbone);
        // Both are at rest to 10⁻¹² of the mean force, which at this pressure the softest mode makes 10⁻¹⁰ of a length at most
        // (p of 800 over a stiffness of 10² for the softest mode of 700 disks, √N for the norm).
        assert!(worst <= 1e-10, "{}: {worst:e} apart", choice.name());
    }
}

#[test]
fn a_relaxation_in_other_units_takes_the_same_steps_to_the_same_bits() {
    for choice in all(1e-10) {
        same_bits_in_other_units(&choice);
    }
}

#[test]
fn the_same_input_gives_the_same_bits() {
    for choice in all(1e-8) {
        let [one, two] = [(); 2].map(|()| relax(&choice, points::<2>(100, 0.9, 14), &hertzian()));
        assert_eq!(one.state, two.state);
        assert_eq!((one.stop, one.residual, one.cost.step_count), (two.stop, two.residual, two.cost.step_count));
    }
}
