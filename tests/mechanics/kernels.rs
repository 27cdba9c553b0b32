//! Our own kernels with every kind of vectors that this processor has: the same bits.
//!
//! Factorisations of faer keep the vectors of the processor meanwhile ([`Processor::run`]), so relaxers that make some must
//! agree as well.

use std::fmt::Debug;

use jamscope::forces::Assembly;
use jamscope::forces::damped::damped_forces;
use jamscope::law::damping::{ConstantDamping, ContactDamping};
use jamscope::law::{Hertzian, Hookean, OnSite, PairLaw, PowerLaw};
use jamscope::packing::Packing;
use jamscope::processor::{Processor, Vectors};
use jamscope::relax::{DampedDynamics, Fire, ForceLimit, NonlinearConjugateGradients, Precision, QuasiNewton, Relaxer};
#[cfg(feature = "linear")]
use jamscope::relax::{GradientFlow, ImplicitDynamics, Newton, Staged};
use jamscope::vector::Vector;

use crate::scenes::starts::{inflated, points, shaken};

/// What `work` gives with every kernel, which is to be one and the same.
fn one<T: PartialEq + Debug>(what: &str, work: impl Fn() -> T) -> T {
    let mut all: Vec<(Processor, T)> = Processor::all().into_iter().map(|it| (it, it.run(&work))).collect();
    assert!(all.iter().any(|(processor, _)| processor.vectors() == Vectors::None));
    let (own, expected) = all.pop().expect("its own");
    for (processor, found) in all {
        assert!(found == expected, "{what}: {processor:?} and {own:?} differ");
    }
    expected
}

fn bits<const D: usize>(vectors: &[Vector<D>]) -> Vec<u64> {
    vectors.as_flattened().iter().map(|value| value.to_bits()).collect()
}

/// Disks away from where they were listed, by up to a hundredth of a radius.
fn moved<const D: usize>(packing: &Packing<D>, law: &dyn PairLaw) -> Assembly<D> {
    let mut assembly = Assembly::new(packing, law).expect("disks apart");
    for (disk, displacement) in assembly.displacements.iter_mut().enumerate() {
        *displacement = std::array::from_fn(|d| 5e-3 * ((d + 1) as f64 * disk as f64).sin());
    }
    assembly
}

/// Forces, totals, rows of stiffness, and damped forces.
fn check_forces<const D: usize>(packing: &Packing<D>, law: &dyn PairLaw) {
    let (forces, largest) = one(&format!("forces, {law:?}, D = {D}"), || {
        let mut assembly = moved(packing, law);
        assembly.evaluate();
        let forces = bits(&assembly.forces);
        let totals = assembly.evaluate_totals();
        assert_eq!(forces, bits(&assembly.forces), "with and without totals");
        let numbers = [totals.energy, totals.force_sum, totals.virial_trace()].map(f64::to_bits);
        let mut rows = vec![0.0; assembly.len()];
        let bound = assembly.row_bound(&mut rows, None);
        let damping = ContactDamping::Constant(ConstantDamping { rate: 500.0 });
        let coefficients = vec![damping.coefficient(0.5, 0.5); assembly.pairs().place_count()];
        let at = &assembly.displacements;
        let mut damped = vec![[0.0; D]; assembly.len()];
        let power = damped_forces((law, &damping), assembly.pairs(), &coefficients, at, at, &mut damped);
        let rows: Vec<u64> = rows.into_iter().map(f64::to_bits).collect();
        ((forces, numbers, totals.contact_count, rows, bound.to_bits(), bits(&damped), power.to_bits()), bound)
    });
    assert!(forces.2 > packing.len() && largest > 0.0, "few contacts");
}

#[test]
fn forces_and_sums_have_the_same_bits_with_every_kernel() {
    let (disks, balls) = (points::<2>(400, 0.95, 3), points::<3>(200, 0.8, 3));
    check_forces(&disks, &Hertzian::default());
    check_forces(&disks, &Hookean::default());
    check_forces(&disks, &PowerLaw { energy_scale: 3.0, exponent: 2.3 });
    check_forces(&balls, &Hertzian::default());
    check_forces(&balls, &Hookean::default());
    check_forces(&balls, &PowerLaw { energy_scale: 3.0, exponent: 2.3 });
    // A mixture of many radii, which no table has room for.
    let radii: Vec<f64> = (0..disks.len()).map(|disk| 0.5 + 1e-3 * (disk % 150) as f64).collect();
    let many = Packing::new(*disks.domain(), disks.positions().to_vec(), radii).expect("valid");
    check_forces(&many, &Hertzian::default());
}

/// Where a relaxation ends, what it reached and what it took.
fn check_relaxer<const D: usize>(relaxer: &(impl Relaxer + Debug), start: &Packing<D>, law: &dyn PairLaw) {
    let (.., evaluations) = one(&format!("{relaxer:?}, {law:?}, D = {D}"), || {
        let outcome = relaxer.relax(start.clone(), law, &mut ()).expect("disks apart");
        let (state, cost) = (&outcome.state, outcome.cost);
        let counts = [cost.step_count, cost.build_count, cost.factorisation_count, cost.iteration_count];
        let reached = [outcome.residual.largest_net_force, outcome.residual.mean_contact_force];
        let numbers = [reached[0], reached[1], outcome.rounding_floor, cost.simulated_time];
        let ends = (bits(state.positions()), bits(state.corrections()));
        (ends, numbers.map(f64::to_bits), outcome.stop, counts, cost.force_evaluation_count)
    });
    assert!(evaluations > 5, "{evaluations} evaluations");
}

/// Steps of a relaxation, at most: a difference in any sum is there after the first, and grows.
const STEPS: usize = 300;

fn check_relaxers<const D: usize>(start: &Packing<D>, law: &dyn PairLaw) {
    let limit = ForceLimit::Relative(1e-8);
    for precision in [Precision::Double, Precision::Mixed] {
        check_relaxer(&Fire { limit, step_limit: STEPS, precision, ..Fire::default() }, start, law);
    }
    check_relaxer(&DampedDynamics { limit, step_limit: STEPS, ..DampedDynamics::default() }, start, law);
    let gradients = NonlinearConjugateGradients { limit, step_limit: STEPS, ..NonlinearConjugateGradients::default() };
    check_relaxer(&gradients, start, law);
    check_relaxer(&QuasiNewton { limit, step_limit: STEPS, ..QuasiNewton::default() }, start, law);
    #[cfg(feature = "linear")]
    {
        check_relaxer(&Newton { limit, ..Newton::default() }, start, law);
        check_relaxer(&Staged { limit, ..Staged::default() }, start, law);
    }
}

#[test]
fn relaxations_of_disks_end_in_the_same_bits_with_every_kernel() {
    let start = inflated("hertz_N1000_p10", 3);
    check_relaxers(&start, &Hertzian::default());
    check_relaxers(&inflated("hooke_N1000_p10", 3), &Hookean::default());
    let fire = Fire { step_limit: STEPS, ..Fire::default() };
    check_relaxer(&fire, &start, &PowerLaw { energy_scale: 2e5, exponent: 2.5 });
    check_relaxer(&fire, &start, &OnSite { law: Hertzian::default(), coupling: -50.0 });
    // From random points disks go far: lists are rebuilt, and pairs inserted.
    check_relaxer(&fire, &points::<2>(400, 0.9, 5), &Hertzian::default());
    check_relaxer(&Fire { precision: Precision::Mixed, ..fire }, &points::<2>(400, 0.9, 5), &Hertzian::default());
}

#[test]
fn relaxations_of_balls_end_in_the_same_bits_with_every_kernel() {
    let start = shaken(&points::<3>(150, 0.8, 2), 1e-2, 1);
    check_relaxers(&start, &Hertzian::default());
}

#[cfg(feature = "linear")]
#[test]
fn implicit_dynamics_ends_in_the_same_bits_with_every_kernel() {
    let start = inflated("hertz_N1000_p10", 3);
    // Explicit and stabilised steps in stretches: which, follows from bounds that our kernels sum. Steps of the flow are implicit.
    let dynamics = ImplicitDynamics { step_limit: 8, ..ImplicitDynamics::default() };
    check_relaxer(&dynamics, &start, &Hertzian::default());
    let flow = GradientFlow { step_limit: 8, ..GradientFlow::default() };
    check_relaxer(&flow, &start, &Hertzian::default());
    let motion = dynamics.relax(start.clone(), &Hertzian::default(), &mut ()).expect("disks apart");
    assert!(motion.cost.explicit_count > 0, "{:?}", motion.cost);
    let motion = flow.relax(start, &Hertzian::default(), &mut ()).expect("disks apart");
    assert!(motion.cost.factorisation_count > 0, "{:?}", motion.cost);
}
