//! The work of fixed scenes.

use jamscope::relax::{Criterion, RelaxerChoice, Stop};

use super::all;
use crate::scenes::laws::hertzian;
use crate::scenes::rest::relax;
use crate::scenes::starts::inflated;

/// Steps and evaluations of fixed scenes. They may move with the method, not by accident: within a quarter of what was counted
/// when this was written.
#[test]
fn the_work_of_fixed_scenes_stays_what_it_was() {
    let counted = |name: &str, choice: RelaxerChoice, steps: usize, evaluations: usize| {
        let outcome = relax(&choice, inflated(name, 0), &hertzian());
        println!("{name}, {}: {:?}, {:?}", choice.name(), outcome.stop, outcome.cost);
        assert_eq!(outcome.stop, Stop::Converged(Criterion::RelativeForce));
        let near = |ours: usize, then: usize| 4 * ours.abs_diff(then) <= then;
        let (ours, then) = (outcome.cost, (steps, evaluations));
        assert!(near(ours.step_count, then.0), "{name}, {}: {} steps, {} then", choice.name(), ours.step_count, then.0);
        let made = ours.force_evaluation_count;
        assert!(near(made, then.1), "{name}, {}: {made} evaluations, {} then", choice.name(), then.1);
    };
    for (name, work) in [
        ("hertz_N1000_p10", [(1850, 3198), (1890, 1954), (2780, 2798), (2780, 2798)]),
        ("hertz_N1000_p800", [(440, 770), (470, 492), (640, 652), (640, 652)]),
    ] {
        for (choice, (steps, evaluations)) in all(1e-8).into_iter().zip(work) {
            counted(name, choice, steps, evaluations);
        }
    }
}
