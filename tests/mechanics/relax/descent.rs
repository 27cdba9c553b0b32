//! Energies from random starts: restarts of FIRE, and damped motions with both damping laws.

use jamscope::forces::Assembly;
use jamscope::law::damping::{ConstantDamping, DampingChoice, ViscoelasticDamping};
use jamscope::law::{Hertzian, Hookean, PairLaw};
use jamscope::network::ContactNetwork;
use jamscope::packing::Packing;
use jamscope::relax::{
    Check, DampedDynamics, Fire, ForceLimit, Motion, Precision, Relaxer, StepBack, Stop, TimeStep, Uphill,
};
use jamscope::vector::Vector;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::scenes::seeds::config;
use crate::scenes::starts::points;

/// Random points, the share of them held.
fn start<const D: usize>(seed: u64, count: usize, fraction: f64, held_share: f64) -> Packing<D> {
    let mut generator = Pcg64::seed_from_u64(seed);
    let held = (0..count).map(|_| generator.random::<f64>() < held_share).collect();
    points::<D>(count, fraction, seed).with_held(held).expect("a flag each")
}

fn laws() -> impl Strategy<Value = bool> {
    any::<bool>()
}

/// Energies relative to k: 1 or the default stiffness.
fn law(hookean: bool, stiffness: f64) -> Box<dyn PairLaw> {
    if hookean { Box::new(Hookean { stiffness }) } else { Box::new(Hertzian { stiffness }) }
}

/// Where 300 steps of the default lead: the energy has little left to fall.
fn nearly_at_rest<const D: usize>(packing: Packing<D>, law: &dyn PairLaw) -> Packing<D> {
    let fire = Fire { limit: ForceLimit::Relative(1e-4), step_limit: 300, ..Fire::default() };
    fire.relax(packing, law, &mut ()).expect("no coincidence").state
}

/// Energies at the restarts of FIRE, from the start to the end, do not rise by more than the rounding of a sum over contacts, 10⁻¹³.
fn restarts_do_not_rise<const D: usize>(fire: &Fire, packing: Packing<D>, law: &dyn PairLaw) {
    let energy = |packing: &Packing<D>| ContactNetwork::new(packing, law).expect("no coincidence").energy();
    let first = energy(&packing);
    let mut energies = vec![first];
    let mut last = first;
    let mut trace = |check: &Check| {
        if check.restart {
            energies.push(check.energy);
        }
        last = check.energy;
    };
    let outcome = fire.relax(packing, law, &mut trace).expect("no coincidence");
    let rounding = 1.0 + 1e-13;
    assert!(energies.is_sorted_by(|&before, &after| after <= before * rounding), "{fire:?}: {energies:?}");
    // 1500 steps are several restarts, or the end.
    assert!(energies.len() > 2 || matches!(outcome.stop, Stop::Converged(_)), "{:?}, {energies:?}", outcome.stop);
    if matches!(outcome.stop, Stop::Converged(_)) {
        // Downhill from the last restart on; summed by contacts here, by blocks there. An unjammed packing ends near 0.
        let end = energy(&outcome.state);
        assert!(end <= energies[energies.len() - 1] * rounding + 1e-13 * first, "{end} after {energies:?}");
    }
}

proptest! {
    #![proptest_config(config(24, 20))]

    #[test]
    fn energies_at_the_restarts_of_fire_never_increase_from_random_starts(
        seed in 0..1_000_000u64,
        count in 20usize..120,
        fraction in 0.8..1.3f64,
        held_share in prop_oneof![Just(0.0), Just(0.2)],
        // 1 is the limit of stability by Gershgorin's bound; far beyond it FIRE climbs, and must come back.
        time_step_fraction in prop_oneof![0.3..2.5f64, 2.5..40.0f64],
        near_rest in any::<bool>(),
        back in any::<bool>(),
        mixed in any::<bool>(),
        space in any::<bool>(),
        hookean in laws(),
    ) {
        let fire = Fire {
            limit: ForceLimit::Relative(1e-9),
            step_limit: 1500,
            time_step_fraction,
            uphill: if back { Uphill::StepBack(StepBack::default()) } else { Uphill::Restart },
            precision: if mixed { Precision::Mixed } else { Precision::Double },
            ..Fire::default()
        };
        let law = law(hookean, 2e5);
        if space {
            let packing = start::<3>(seed, count + 20, 0.75 * fraction, held_share);
            restarts_do_not_rise(&fire, if near_rest { nearly_at_rest(packing, &*law) } else { packing }, &*law);
        } else {
            let packing = start::<2>(seed, count, fraction, held_share);
            restarts_do_not_rise(&fire, if near_rest { nearly_at_rest(packing, &*law) } else { packing }, &*law);
        }
    }
}

/// By how much the energy E + K of a motion may exceed an earlier one, per sum of both.
///
/// Velocity Verlet follows H + h² (v·K·v/12 − F²/24) to higher order, of which damping only takes. So H itself is off by at most h² λ/6 of
/// what it is above the minimum, at either time. At a share s of the stable step h² λ < 4 s². The next order has another h² λ: with s ≤ 0.12
/// it is 6 % of this bound, and the Gershgorin bound exceeds λ by more than that. Energies of contacts are positive, so what H is above its
/// minimum is less than H.
fn rise(share: f64) -> f64 {
    4.0 * share * share / 6.0
}

/// E + K does not rise above its lowest value so far, at any of the times, beyond that bound.
fn only_lost(totals: &[f64], share: f64, what: &str) {
    let mut least = f64::INFINITY;
    for (time, &total) in totals.iter().enumerate() {
        let allowed = (rise(share) + 1e-13) * (total + least);
        assert!(time == 0 || total - least <= allowed, "{what}, {time}: {total} after {least}, {totals:?}");
        least = least.min(total);
    }
}

/// E + K after every step of a motion with random velocities of this size, in units of what stops within a radius at the first contacts.
fn energies_of_steps<const D: usize>(
    packing: &Packing<D>,
    law: &dyn PairLaw,
    damping: &DampingChoice,
    (share, speed, seed): (f64, f64, u64),
) -> (Vec<f64>, f64) {
    let mut generator = Pcg64::seed_from_u64(seed);
    let mut assembly = Assembly::new(packing, law).expect("no coincidence");
    let energy = assembly.evaluate_totals().energy;
    let mobile = assembly.mobile_count();
    let scale = speed * (energy / packing.len() as f64).sqrt();
    let mut velocity = |_| -> Vector<D> { std::array::from_fn(|_| scale * (2.0 * generator.random::<f64>() - 1.0)) };
    let velocities: Vec<Vector<D>> = (0..mobile).map(&mut velocity).collect();
    let mut motion = Motion::moving(assembly, &velocities, &law.contact_damping(damping));
    let mut totals = vec![energy + motion.kinetic_energy()];
    for _ in 0..400 {
        // Of the stable step of the present contacts: they stiffen little within a step this short.
        let time_step = share * motion.stable_step();
        motion.step(time_step).expect("no coincidence");
        totals.push(motion.assembly.evaluate_totals().energy + motion.kinetic_energy());
    }
    (totals, motion.dissipated)
}

fn dampings() -> impl Strategy<Value = DampingChoice> {
    // From hardly any to far above critical, at the frequencies of contacts with k = 2·10⁵ (10² to 10³).
    (0.0..3.5f64, any::<bool>()).prop_map(|(exponent, constant)| {
        let rate = 10f64.powf(exponent);
        if constant {
            DampingChoice::Constant(ConstantDamping { rate })
        } else {
            DampingChoice::Viscoelastic(ViscoelasticDamping { rate })
        }
    })
}

proptest! {
    #![proptest_config(config(48, 20))]

    #[test]
    fn no_step_of_a_damped_motion_gains_energy(
        seed in 0..1_000_000u64,
        count in 10usize..80,
        fraction in 0.8..1.3f64,
        held_share in prop_oneof![Just(0.0), Just(0.2)],
        damping in dampings(),
        share in 0.03..0.12f64,
        speed in prop_oneof![Just(0.0), 0.0..1.0f64],
        space in any::<bool>(),
        hookean in laws(),
    ) {
        let law = law(hookean, 2e5);
        let settings = (share, speed, seed);
        let (totals, dissipated) = if space {
            energies_of_steps(&start::<3>(seed, count + 20, 0.75 * fraction, held_share), &*law, &damping, settings)
        } else {
            energies_of_steps(&start::<2>(seed, count, fraction, held_share), &*law, &damping, settings)
        };
        only_lost(&totals, share, &format!("{law:?}, {damping:?}"));
        // What damping took is what is missing, up to the error of H at both ends and a share h λ_Γ ≤ s of the work itself: the power of a
        // mode that decays at the rate λ_Γ changes by that much within a step.
        let (first, last) = (totals[0], totals[totals.len() - 1]);
        let allowed = rise(share) * (first + last) + share * dissipated;
        prop_assert!((first - last - dissipated).abs() <= allowed, "{law:?}, {damping:?}: {first} to {last}, {dissipated}");
    }
}

proptest! {
    #![proptest_config(config(12, 20))]

    #[test]
    fn damped_dynamics_loses_energy_between_checks_with_both_damping_laws(
        seed in 0..1_000_000u64, count in 20usize..100, fraction in 0.86..1.2f64, exponent in 1.0..3.0f64, hookean in laws(),
    ) {
        let (rate, share) = (10f64.powf(exponent), 0.1);
        for damping in [DampingChoice::Constant(ConstantDamping { rate }), DampingChoice::Viscoelastic(ViscoelasticDamping { rate })] {
            let dynamics = DampedDynamics {
                damping, time_step: TimeStep::OfStability(share), step_limit: 1000, ..DampedDynamics::default()
            };
            let mut totals = Vec::new();
            let mut trace = |check: &Check| totals.push(check.energy + check.kinetic_energy);
            let outcome = dynamics.relax(start::<2>(seed, count, fraction, 0.0), &*law(hookean, 2e5), &mut trace).expect("apart");
            prop_assert!(matches!(outcome.stop, Stop::StepLimit | Stop::Converged(_)), "{:?}", outcome.stop);
            prop_assert!(totals.len() > 10);
            only_lost(&totals, share, &format!("{damping:?}"));
        }
    }
}
