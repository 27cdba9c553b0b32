//! Implicit damped dynamics and gradient flow: closed forms and orders, energy balance, contacts on the way, the minimum that
//! explicit dynamics finds, named ends, and the work of fixed scenes.

use jamscope::inflation::Circle;
use jamscope::io::read_packing;
use jamscope::law::damping::{ConstantDamping, ContactDamping, DampingChoice, ViscoelasticDamping};
use jamscope::law::{Hookean, PairLaw};
use jamscope::network::ContactNetwork;
use jamscope::packing::{Domain, Packing};
use jamscope::relax::implicit::{Finish, ImplicitMotion, Inertia, Stepped};
use jamscope::relax::{
    Check, DampedDynamics, Fire, ForceLimit, GradientFlow, ImplicitDynamics, Newton, Outcome, Relaxer, Staged, Stop,
};
use jamscope::vector::{Vector, difference, larger, norm, sum};

use crate::scenes::laws::hertzian;

/// A small disk of a stored packing, of its backbone if there is one, grown by 0.1 in a circle with a held rim.
fn inflated(name: &str, index: usize) -> Packing<2> {
    let packing = read_packing::<2>(format!("{}/fixtures/packings/{name}.xyz", env!("CARGO_MANIFEST_DIR")));
    let packing = packing.expect("a fixture");
    let side = packing.domain().lengths().expect("periodic")[0];
    let backbone = ContactNetwork::new(&packing, &hertzian()).expect("no coincidence").backbone;
    let jammed = backbone.contains(&true);
    let chosen = |&disk: &usize| packing.radii()[disk] == 0.5 && (backbone[disk] || !jammed);
    let small: Vec<usize> = (0..packing.len()).filter(chosen).collect();
    let circle = Circle::cut(&packing, small[(37 * index) % small.len()], 0.48 * side).expect("a circle in its box");
    circle.packing.with_radius(circle.centre, 0.6).expect("a positive radius")
}

/// Two disks pressed together by `overlap`.
fn pair(overlap: f64) -> Packing<2> {
    Packing::new(Domain::<2>::Open, vec![[0.0, 0.0], [1.2 - overlap, 0.0]], vec![0.5, 0.7]).expect("valid")
}

fn overlap_of(packing: &Packing<2>) -> f64 {
    1.2 - norm(packing.separation(0, 1))
}

/// Steps of one length; the packing, the motion's work of damping and its kinetic energy afterwards.
fn moved(
    packing: &Packing<2>,
    law: &dyn PairLaw,
    rate: f64,
    inertia: Inertia,
    (time, step_count): (f64, usize),
) -> (Packing<2>, f64, f64) {
    let mut motion = ImplicitMotion::new(packing, law, &ContactDamping::Constant(ConstantDamping { rate }), inertia)
        .expect("disks apart");
    for _ in 0..step_count {
        let stepped = motion.step(time / step_count as f64).expect("no coincidence");
        assert!(matches!(stepped, Stepped::Moved(_)), "{stepped:?}");
    }
    assert!((motion.time - time).abs() < 1e-12 * time);
    (motion.assembly.placed(packing.clone()), motion.dissipated, motion.kinetic_energy())
}

#[test]
fn a_hookean_pair_is_a_damped_oscillator_to_third_order() {
    // δ'' = −2 k δ − 2 γ δ': δ = δ₀ e^(−γt) (cos ωt + (γ/ω) sin ωt), ω² = 2k − γ². The next term of the error is hω = 0.08 of
    // it at 8 steps and halves with them: orders within 0.1 of 3.
    let (stiffness, rate, first, time) = (2e5f64, 100.0f64, 0.01, 1e-3f64);
    let omega = (2.0 * stiffness - rate * rate).sqrt();
    let exact = first * (-rate * time).exp() * ((omega * time).cos() + rate / omega * (omega * time).sin());
    let error = |step_count: usize| {
        let (end, _, _) = moved(&pair(first), &Hookean { stiffness }, rate, Inertia::Massive, (time, step_count));
        (overlap_of(&end) - exact).abs()
    };
    let errors = [error(8), error(16), error(32)];
    for two in errors.windows(2) {
        let order = (two[0] / two[1]).log2();
        assert!((order - 3.0).abs() < 0.1, "order {order}, errors {errors:?}");
    }
}

/// As [`moved`] by stabilised steps.
fn stabilised(
    packing: &Packing<2>,
    law: &dyn PairLaw,
    rate: f64,
    (time, step_count): (f64, usize),
    stage_count: usize,
) -> (Packing<2>, f64, f64) {
    let damping = ContactDamping::Constant(ConstantDamping { rate });
    let mut motion = ImplicitMotion::new(packing, law, &damping, Inertia::Massive).expect("disks apart");
    for _ in 0..step_count {
        assert!(motion.stabilised_step(time / step_count as f64, stage_count).expect("no coincidence"));
    }
    // One evaluation a stage, after the first.
    assert_eq!(motion.work.evaluation_count, 1 + stage_count * step_count);
    assert!((motion.time - time).abs() < 1e-12 * time);
    (motion.assembly.placed(packing.clone()), motion.dissipated, motion.kinetic_energy())
}

#[test]
fn stabilised_steps_follow_a_damped_oscillator_to_second_order() {
    // The motion of the test above; the next term of the error is of relative order hω = 0.04 at 16 steps.
    let (stiffness, rate, first, time) = (2e5f64, 100.0f64, 0.01, 1e-3f64);
    let omega = (2.0 * stiffness - rate * rate).sqrt();
    let exact = first * (-rate * time).exp() * ((omega * time).cos() + rate / omega * (omega * time).sin());
    for stage_count in [2, 3, 7] {
        let error = |step_count: usize| {
            let law = Hookean { stiffness };
            let (end, _, _) = stabilised(&pair(first), &law, rate, (time, step_count), stage_count);
            (overlap_of(&end) - exact).abs()
        };
        let errors = [error(16), error(32), error(64)];
        for two in errors.windows(2) {
            let order = (two[0] / two[1]).log2();
            assert!((order - 2.0).abs() < 0.1, "{stage_count} stages: order {order}, errors {errors:?}");
        }
    }
}

#[test]
fn gradient_flow_of_a_hookean_pair_decays_exponentially_to_third_order() {
    // ζ δ' = −2 k δ.
    let (stiffness, friction, first, time) = (2e5, 10.0, 0.01, 2e-5f64);
    let exact = first * (-2.0 * stiffness / friction * time).exp();
    let error = |step_count: usize| {
        let inertia = Inertia::Friction(friction);
        let (end, _, _) = moved(&pair(first), &Hookean { stiffness }, 0.0, inertia, (time, step_count));
        (overlap_of(&end) - exact).abs()
    };
    let errors = [error(8), error(16), error(32)];
    for two in errors.windows(2) {
        let order = (two[0] / two[1]).log2();
        // hλ = 0.05 at 8 steps, and halves.
        assert!((order - 3.0).abs() < 0.1, "order {order}, errors {errors:?}");
    }
}

/// 100 disks at rest at high pressure, all shaken by much less than an overlap: no contact opens or closes.
fn smooth_scene() -> Packing<2> {
    use jamscope::packing::Mixture;
    use jamscope::preparation::{Preparation, Target, prepare_with};
    let preparation = Preparation {
        disk_count: 100,
        mixture: Mixture::default(),
        target: Target::Pressure(1000.0),
        tolerance: 0.3,
        seed: 4,
        ..Preparation::default()
    };
    let limit = ForceLimit::Relative(1e-12);
    let relaxer = Staged { limit, ..Staged::default() };
    let prepared = prepare_with::<2>(&preparation, &hertzian(), &relaxer, &mut ()).expect("a packing");
    let packing = prepared.packing.into_inner();
    let contacts = |packing: &Packing<2>| {
        let network = ContactNetwork::new(packing, &hertzian()).expect("no coincidence");
        network.contacts.iter().map(|contact| (contact.first, contact.second)).collect::<Vec<_>>()
    };
    let grown = packing.radii()[0] + 1e-3;
    let start = packing.clone().with_radius(0, grown).expect("a positive radius");
    let end = Staged::default().relax(start.clone(), &hertzian(), &mut ()).expect("no coincidence").state;
    assert_eq!(contacts(&start), contacts(&end), "the scene was chosen to keep its contacts");
    start
}

/// How far a disk of one packing is from where it is in the other, corrections included.
fn way(a: &Packing<2>, b: &Packing<2>, disk: usize) -> f64 {
    let positions = difference(a.positions()[disk], b.positions()[disk]);
    norm(sum(positions, difference(a.corrections()[disk], b.corrections()[disk])))
}

fn distance(a: &Packing<2>, b: &Packing<2>) -> f64 {
    (0..a.len()).map(|disk| way(a, b, disk)).fold(0.0, larger)
}

#[test]
fn a_hundred_disks_move_to_third_order_and_keep_account_of_their_energy() {
    let (start, law, rate, time) = (smooth_scene(), hertzian(), 500.0, 0.02);
    let energy = |packing: &Packing<2>| ContactNetwork::new(packing, &law).expect("no coincidence").energy();
    let run = |step_count: usize| moved(&start, &law, rate, Inertia::Massive, (time, step_count));
    let runs = [run(20), run(40), run(80), run(640)];
    let (finest, _, _) = &runs[3];
    let errors: Vec<f64> = runs[..3].iter().map(|(end, _, _)| distance(end, finest)).collect();
    let balances: Vec<f64> = runs[..3]
        .iter()
        .map(|(end, dissipated, kinetic)| (energy(&start) - energy(end) - kinetic - dissipated).abs())
        .collect();
    println!("errors {errors:?}, balances {balances:?}");
    for (name, values) in [("motion", &errors), ("energy", &balances)] {
        for two in values.windows(2) {
            // Contacts relax at rates to 2γλ = 5800, 1/6 of a coarsest step: the error falls by 8 each time once steps resolve
            // them, by a little less or more before.
            let order = (two[0] / two[1]).log2();
            assert!(order > 2.5, "{name}: order {order}, {values:?}");
        }
    }
}

#[test]
fn stabilised_steps_move_a_hundred_disks_to_second_order_and_keep_account_of_their_energy() {
    let (start, law, rate, time) = (smooth_scene(), hertzian(), 500.0, 0.02);
    let energy = |packing: &Packing<2>| ContactNetwork::new(packing, &law).expect("no coincidence").energy();
    // hλ is 3.6 at 20 steps, λ = 3600: three stages are stable from there on.
    let run = |step_count: usize| stabilised(&start, &law, rate, (time, step_count), 3);
    let runs = [run(40), run(80), run(160)];
    let (finest, _, _) = moved(&start, &law, rate, Inertia::Massive, (time, 640));
    let errors: Vec<f64> = runs.iter().map(|(end, _, _)| distance(end, &finest)).collect();
    let balances: Vec<f64> = runs
        .iter()
        .map(|(end, dissipated, kinetic)| (energy(&start) - energy(end) - kinetic - dissipated).abs())
        .collect();
    println!("errors {errors:?}, balances {balances:?}");
    for (name, values) in [("motion", &errors), ("energy", &balances)] {
        for two in values.windows(2) {
            let order = (two[0] / two[1]).log2();
            assert!(order > 1.7, "{name}: order {order}, {values:?}");
        }
    }
}

#[test]
fn a_stabilised_step_of_many_stages_is_stable_where_an_explicit_one_of_its_length_is_not() {
    // 0.01 units of time are 60 explicit steps; λ = 3600 asks for 8 stages: 0.653 (8² − 1) = 41 ≥ 36.
    let (start, law) = (smooth_scene(), hertzian());
    let first = ContactNetwork::new(&start, &law).expect("no coincidence").energy();
    let (end, _, kinetic) = stabilised(&start, &law, 500.0, (2.0, 200), 8);
    let last = ContactNetwork::new(&end, &law).expect("no coincidence").energy();
    assert!(last + kinetic < first, "{last} + {kinetic} of {first}");
    let damping = ContactDamping::Constant(ConstantDamping { rate: 500.0 });
    let mut motion = ImplicitMotion::new(&start, &law, &damping, Inertia::Massive).expect("disks apart");
    // Four stages are stable up to hλ = 9.8: what is left of the disks flies apart.
    let flown = (0..200).any(|_| !motion.stabilised_step(0.01, 4).expect("no coincidence"));
    let kinetic = motion.kinetic_energy();
    assert!(flown || kinetic.is_nan() || kinetic >= first, "{kinetic}");
}

#[test]
fn an_error_is_estimated_where_a_contact_opens_within_a_step() {
    // Two pressed disks without damping fly apart. As long as they touch the estimate is that of a smooth motion; in the step
    // in which they part, F kinks and the estimate must tell: it stands out against those before and after.
    let (stiffness, first) = (2e5f64, 0.01);
    let (law, packing) = (Hookean { stiffness }, pair(first));
    let omega = (2.0 * stiffness).sqrt();
    let step = 0.1 / omega;
    let mut motion =
        ImplicitMotion::new(&packing, &law, &ContactDamping::Constant(ConstantDamping { rate: 0.0 }), Inertia::Massive)
            .expect("disks apart");
    let mut estimates = Vec::new();
    for _ in 0..30 {
        let _ = motion.step(step).expect("no coincidence");
        estimates.push(motion.error(step, 0));
    }
    // They part at ωt = π/2, in step 16. Free flight is exact.
    let (parting, after) = (estimates[15], estimates[20]);
    assert!(after < 1e-12 * first, "{after}");
    assert!(parting > 20.0 * estimates[13].min(estimates[14]) || parting > 1e-5 * first, "{estimates:?}");
    // The energy is that of the start, to a share of the overlap the step misjudges: h³ωω² ~ 10⁻³.
    let energy = 0.5 * stiffness * first * first;
    assert!((motion.kinetic_energy() - energy).abs() < 3e-3 * energy);
}

#[test]
fn a_step_taken_back_leaves_no_trace() {
    let packing = inflated("hertz_N1000_p100", 0);
    let (law, damping) = (hertzian(), ContactDamping::Constant(ConstantDamping { rate: 500.0 }));
    let start = || ImplicitMotion::new(&packing, &law, &damping, Inertia::Massive).expect("no coincidence");
    let (mut once, mut twice) = (start(), start());
    for motion in [&mut once, &mut twice] {
        let _ = motion.step(1e-3).expect("no coincidence");
    }
    let _ = twice.step(10.0).expect("no coincidence");
    twice.take_back().expect("no coincidence");
    // A list made anew on the way moves anchors, so positions agree to rounding, not to the bit.
    assert!(distance(&once.assembly.placed(packing.clone()), &twice.assembly.placed(packing.clone())) < 1e-15);
    assert_eq!(once.velocities, twice.velocities);
    assert_eq!((once.time, once.dissipated), (twice.time, twice.dissipated));
    let _ = twice.stabilised_step(3e-3, 5).expect("no coincidence");
    twice.take_back().expect("no coincidence");
    assert!(distance(&once.assembly.placed(packing.clone()), &twice.assembly.placed(packing.clone())) < 1e-15);
    assert_eq!((&once.velocities, once.net_forces()), (&twice.velocities, twice.net_forces()));
    assert_eq!((once.time, once.dissipated), (twice.time, twice.dissipated));
}

/// The largest distance on the backbone, after Newton has taken both to rounding.
fn apart(a: Packing<2>, b: Packing<2>) -> f64 {
    let law = hertzian();
    let newton = Newton { limit: ForceLimit::Relative(1e-12), ..Newton::default() };
    let [a, b] = [a, b].map(|state| newton.relax(state, &law, &mut ()).expect("no coincidence").state);
    let backbone = ContactNetwork::new(&a, &law).expect("no coincidence").backbone;
    (0..a.len()).filter(|&disk| backbone[disk]).map(|disk| way(&a, &b, disk)).fold(0.0, larger)
}

fn relaxed(relaxer: &impl Relaxer, start: &Packing<2>) -> Outcome<Packing<2>> {
    relaxer.relax(start.clone(), &hertzian(), &mut ()).expect("no coincidence")
}

#[test]
fn explicit_and_implicit_dynamics_end_in_one_minimum_far_above_jamming() {
    // p = 800. The default explicit step is half of the longest stable one. Newton takes both to 10⁻¹² of the mean force, so
    // 10⁻⁸ is two minima or one. Nine of ten: near a snap-through either may fall to the other side.
    let mut same = 0;
    for index in 0..10 {
        let start = inflated("hertz_N1000_p800", index);
        let explicit =
            relaxed(&DampedDynamics { limit: ForceLimit::Relative(1e-4), ..DampedDynamics::default() }, &start);
        let implicit = relaxed(&ImplicitDynamics::default(), &start);
        assert!(matches!(implicit.stop, Stop::Converged(_)), "{:?}", implicit.stop);
        // Stabilised steps, and Newton at the end. The explicit ones take 10⁴ evaluations.
        assert!(implicit.cost.factorisation_count <= 20, "{:?}", implicit.cost);
        assert!(implicit.cost.force_evaluation_count <= 4000, "{:?}", implicit.cost);
        assert!(implicit.cost.simulated_time > 0.0);
        same += usize::from(apart(explicit.state, implicit.state) <= 1e-8);
    }
    assert!(same >= 9, "{same} of 10");
}

#[test]
fn the_end_does_not_depend_on_who_finishes() {
    let start = inflated("hertz_N1000_p800", 3);
    let limit = ForceLimit::Relative(1e-10);
    let by_motion = relaxed(&ImplicitDynamics { limit, finish: Finish::Motion, ..Default::default() }, &start);
    let by_newton = relaxed(&ImplicitDynamics { limit, ..Default::default() }, &start);
    for outcome in [&by_motion, &by_newton] {
        assert!(matches!(outcome.stop, Stop::Converged(_)) && outcome.residual.relative() <= 1e-10, "{outcome:?}");
    }
    assert!(apart(by_motion.state, by_newton.state) <= 1e-9);
}

#[test]
fn gradient_flow_goes_downhill_at_every_step() {
    let start = inflated("hertz_N1000_p100", 1);
    let mut last = f64::INFINITY;
    let mut check = |check: &Check| {
        // A step that is accepted has an error of two hundredths of an overlap at most: energy may rise by that of one disk.
        assert!(check.energy <= last * (1.0 + 1e-6), "{} after {last}", check.energy);
        last = check.energy;
    };
    let flow = GradientFlow::default();
    let outcome = flow.relax(start, &hertzian(), &mut check).expect("no coincidence");
    assert!(matches!(outcome.stop, Stop::Converged(_)), "{:?}", outcome.stop);
    // 201 where this was written.
    assert!(outcome.cost.factorisation_count <= 300, "{:?}", outcome.cost);
}

#[test]
fn relabelling_and_shifting_a_packing_changes_nothing_but_rounding() {
    let start = inflated("hertz_N1000_p800", 5);
    let shift: Vector<2> = [3.7, -11.9];
    let moved = Packing::new(
        Domain::Open,
        start.positions().iter().rev().map(|&at| difference(at, shift)).collect(),
        start.radii().iter().rev().copied().collect(),
    )
    .expect("valid")
    .with_held(start.held().iter().rev().copied().collect())
    .expect("one flag a disk");
    let (a, b) = (relaxed(&ImplicitDynamics::default(), &start), relaxed(&ImplicitDynamics::default(), &moved));
    let count = start.len();
    let largest = (0..count)
        .map(|disk| {
            norm(difference(
                a.state.positions()[disk],
                difference(b.state.positions()[count - 1 - disk], difference([0.0; 2], shift)),
            ))
        })
        .fold(0.0, larger);
    // Both end at 10⁻⁸ of the mean force or better, rattlers at 10⁻⁴: an overlap of 10⁻² times that.
    assert!(largest < 1e-5, "{largest}");
}

#[test]
fn what_never_comes_to_rest_ends_with_a_name() {
    // Unjammed, with a damping that vanishes at first touch: disks fly and bounce for ever.
    let packing = inflated("hertz_N1000_phi082", 0);
    let damping = DampingChoice::Viscoelastic(ViscoelasticDamping { rate: 500.0 });
    let outcome = relaxed(&ImplicitDynamics { damping, ..ImplicitDynamics::default() }, &packing);
    assert!(matches!(outcome.stop, Stop::Stagnation | Stop::Converged(_)), "{:?}", outcome.stop);
    assert!(outcome.cost.simulated_time > 0.0 && outcome.cost.step_count < 30_000);
    // Without Newton at the end, and where the limit on steps is first.
    let alone = ImplicitDynamics { damping, finish: Finish::Motion, ..ImplicitDynamics::default() };
    let outcome = relaxed(&alone, &packing);
    assert!(matches!(outcome.stop, Stop::Stagnation | Stop::Converged(_)), "{:?}", outcome.stop);
    assert!(outcome.cost.step_count < 30_000, "{:?}", outcome.cost);
    let short = relaxed(&ImplicitDynamics { step_limit: 2, ..alone }, &packing);
    assert_eq!((short.stop, short.cost.step_count), (Stop::StepLimit, 2));
}

#[test]
fn nothing_to_do_takes_no_step() {
    let law = hertzian();
    let apart = Packing::new(Domain::<2>::Open, vec![[0.0, 0.0], [2.0, 0.0]], vec![0.5, 0.7]).expect("valid");
    for outcome in [
        ImplicitDynamics::default().relax(apart.clone(), &law, &mut ()).expect("disks apart"),
        GradientFlow::default().relax(apart, &law, &mut ()).expect("disks apart"),
    ] {
        assert!(matches!(outcome.stop, Stop::Converged(_)), "{:?}", outcome.stop);
        assert_eq!((outcome.cost.step_count, outcome.cost.factorisation_count), (0, 0));
    }
}

#[test]
fn work_of_a_fixed_scene() {
    // Counts, not seconds. Explicit dynamics takes 4·10⁴ evaluations to 10⁻⁵ here, FIRE 900 to 10⁻¹⁰.
    let outcome = relaxed(&ImplicitDynamics::default(), &inflated("hertz_N1000_p100", 2));
    println!("{:?}", outcome.cost);
    // While disks collide everywhere stabilised steps are the cheapest: here to where Newton takes over. 20 steps (stretches of some
    // 80 stages), 27 repeated stabilised steps, 1414 evaluations, 3 factorisations where this was written; 27, 62, 1973 and 3 with steps
    // of one length for all disks.
    assert!(outcome.cost.step_count <= 40 && outcome.cost.rejected_count <= 60, "{:?}", outcome.cost);
    assert!(outcome.cost.force_evaluation_count <= 1900, "{:?}", outcome.cost);
    assert!(outcome.cost.factorisation_count <= 10, "{:?}", outcome.cost);
    assert!((700..1900).contains(&outcome.cost.explicit_count), "{:?}", outcome.cost);
    let flow = relaxed(&GradientFlow::default(), &inflated("hertz_N1000_p100", 2));
    assert_eq!(flow.cost.explicit_count, 0);
    let fire = relaxed(&Fire::default(), &inflated("hertz_N1000_p100", 2));
    assert_eq!((fire.cost.factorisation_count, fire.cost.simulated_time), (0, 0.0));
}
