//! The on-site term: closed forms of one disk, sites across new anchors, energies of either sign, and disks that run away.

use jamscope::displacement::DisplacementField;
use jamscope::forces::Assembly;
use jamscope::inflation::{Boundary, Inflation, InflationError, Stage, inflate_with};
use jamscope::law::damping::{ConstantDamping, DampingChoice};
use jamscope::law::{Hookean, OnSite, PairLaw};
use jamscope::network::ContactNetwork;
use jamscope::packing::{Domain, Mixture, Packing};
use jamscope::preparation::{Preparation, Target, prepare_with, random_points};
use jamscope::relax::{Check, Criterion, DampedDynamics, Fire, ForceLimit, Outcome, Relaxer, Stop};
use jamscope::scene::{Scene, SceneError};
use jamscope::vector::{Vector, difference, dot, larger, norm, scaled, sum};

use crate::scenes::laws::{hertzian, hookean};

const STIFFNESS: f64 = 2e5;

fn fire(limit: f64) -> Fire {
    Fire { limit: ForceLimit::Relative(limit), step_limit: 100_000, ..Fire::default() }
}

fn damped(limit: f64) -> DampedDynamics {
    DampedDynamics { limit: ForceLimit::Relative(limit), step_limit: 1_000_000, ..DampedDynamics::default() }
}

/// A Hookean disk between four held ones at distance 1 along the axes, overlapping each by 0.05; the one on the left grown
/// by `growth`.
fn cross(growth: f64) -> Packing<2> {
    let positions = vec![[0.0, 0.0], [-1.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
    Packing::new(Domain::Open, positions, vec![0.55, 0.5 + growth, 0.5, 0.5, 0.5])
        .and_then(|packing| packing.with_held(vec![false, true, true, true, true]))
        .expect("valid")
}

/// Force along x on that disk at (x, 0), by hand.
fn push(x: f64, growth: f64, coupling: f64) -> f64 {
    let force = |overlap: f64| STIFFNESS * overlap.max(0.0);
    let (beside, above) = (force(0.05 + growth - x) - force(0.05 + x), (1.0 + x * x).sqrt());
    beside + 2.0 * force(1.05 - above) * x / above + coupling * x
}

/// Where that force vanishes, by halving: the lowest x > 0 at which it turns from out to back.
fn rest(growth: f64, coupling: f64) -> f64 {
    let (mut low, mut high) = (0.0, 0.04);
    assert!(push(low, growth, coupling) > 0.0 && push(high, growth, coupling) < 0.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if push(middle, growth, coupling) > 0.0 { low = middle } else { high = middle }
    }
    low
}

/// Stiffness of the disk in the middle: two contacts along, two across.
fn stiffness() -> f64 {
    2.0 * STIFFNESS - 2.0 * STIFFNESS * 0.05
}

#[test]
fn a_disk_pushed_from_its_site_rests_where_contacts_hold_it() {
    let growth = 0.01;
    // A thousand times what the contacts hold and as much again, inwards; half of it and almost all of it, outwards.
    for share in [-1e3, -1.0, 0.5, 0.7] {
        let coupling = share * stiffness();
        let law = OnSite { law: Hookean { stiffness: STIFFNESS }, coupling };
        let limit = 1e-12;
        let expected = rest(growth, coupling);
        for outcome in [
            fire(limit).relax(cross(growth), &law, &mut ()).expect("apart"),
            damped(limit).relax(cross(growth), &law, &mut ()).expect("apart"),
        ] {
            assert_eq!(outcome.stop, Stop::Converged(Criterion::RelativeForce), "Γ = {share} K");
            let mean = outcome.residual.mean_contact_force;
            let (position, low) = outcome.state.centre(0);
            let off = norm([position[0] + low[0] - expected, position[1] + low[1]]);
            // Limit over what is left of the stiffness (its change along the way: a tenth), twice; and 4 ulp of the root.
            let allowed = 2.0 * limit * mean / ((1.0 - share) * 0.9 * stiffness()) + 4.0 * f64::EPSILON * expected;
            assert!(off <= allowed, "Γ = {share} K: {off:e} from {expected}, allowed {allowed:e}");
            // The same landscape again: the site went along with the packing, and so the state is at rest at once.
            let network = ContactNetwork::new(&outcome.state, &law).expect("apart");
            assert!(network.largest_net_force() <= 2.0 * limit * mean, "{:e}", network.largest_net_force());
            let energy = -0.5 * coupling * expected * expected;
            assert!((network.on_site_energy() / energy - 1.0).abs() < 1e-9);
            let again = fire(limit).relax(outcome.state.clone(), &law, &mut ()).expect("apart");
            assert_eq!(again.cost.step_count, 0);
            assert_eq!(outcome.state.sites().expect("kept")[0], ([0.0; 2], [0.0; 2]));
        }
    }
}

#[test]
fn where_contacts_do_not_hold_the_disks_the_relaxers_say_that_there_is_no_minimum() {
    // 1.5 of the stiffness to 10⁶ times as much.
    for share in [1.5, 10.0, 1e6] {
        let law = OnSite { law: Hookean { stiffness: STIFFNESS }, coupling: share * stiffness() };
        for outcome in [
            fire(1e-10).relax(cross(1e-3), &law, &mut ()).expect("apart"),
            damped(1e-10).relax(cross(1e-3), &law, &mut ()).expect("apart"),
        ] {
            assert_eq!(outcome.stop, Stop::NoMinimum, "Γ = {share} K");
            assert!(outcome.cost.step_count < 2000, "{} steps", outcome.cost.step_count);
            let from = norm(outcome.state.centre(0).0);
            assert!(from >= 2.0 * 0.55 && from.is_finite(), "{from}");
            assert!(outcome.converged().is_err());
        }
    }
}

#[test]
fn a_packing_without_enough_stiffness_runs_away_and_a_tied_one_does_not() {
    let law = hertzian();
    let packing =
        fire(1e-8).relax(random_points::<2>(100, &Mixture::default(), 1.0, 3).expect("possible"), &law, &mut ());
    let packing = packing.expect("apart").converged().expect("at rest").into_inner();
    let grown = || packing.clone().with_radius(0, packing.radii()[0] + 0.01).expect("positive");
    // About the stiffness of a contact, k' √(δ R), ten times as much, and far too much.
    for coupling in [5e4, 5e5, 1e9] {
        let law = OnSite { law, coupling };
        assert_eq!(fire(1e-8).relax(grown(), &law, &mut ()).expect("apart").stop, Stop::NoMinimum);
        assert_eq!(damped(1e-8).relax(grown(), &law, &mut ()).expect("apart").stop, Stop::NoMinimum);
        // Without damping steps are longest, and disks go farthest between two checks.
        let damping = DampingChoice::Constant(ConstantDamping { rate: 0.0 });
        let free = DampedDynamics { damping, ..damped(1e-8) };
        assert_eq!(free.relax(grown(), &law, &mut ()).expect("apart").stop, Stop::NoMinimum);
    }
    // Nothing is held: moving all disks together costs nothing, so every Γ > 0 makes a saddle. But the growth of a disk does
    // not push all disks together, and what nothing pushes stays on its saddle.
    let saddle = fire(1e-8).relax(grown(), &OnSite { law, coupling: 10.0 }, &mut ()).expect("apart");
    assert_eq!(saddle.stop, Stop::Converged(Criterion::RelativeForce));
    let law = OnSite { law, coupling: -1e3 };
    let ends = [fire(1e-10).relax(grown(), &law, &mut ()), damped(1e-10).relax(grown(), &law, &mut ())];
    let [one, two] =
        ends.map(|end: Result<Outcome<_>, _>| end.expect("apart").converged().expect("at rest").into_inner());
    let mean = ContactNetwork::new(&one, &law).expect("apart").mean_contact_force();
    for disk in 0..one.len() {
        let apart = norm(one.domain().separation(one.centre(disk), two.centre(disk)));
        // Each within √N limit F / |Γ| of the minimum: no mode is softer than the sites.
        assert!(apart <= 2.0 * 10.0 * 1e-10 * mean / 1e3, "disk {disk}: {apart:e}");
    }
}

#[test]
fn the_displacement_from_a_site_survives_new_anchors_without_rounding() {
    let packing = random_points::<2>(40, &Mixture::default(), 0.9, 5).expect("possible");
    let coupling = 3.0;
    let mut assembly = Assembly::new(&packing, &OnSite { law: Hookean { stiffness: 0.0 }, coupling }).expect("apart");
    let steps: [Vector<2>; 4] = [[0.3, -0.2], [1e-9, 3e-8], [-0.7, 0.1], [2e-17, -5e-17]];
    for step in steps {
        for displacement in &mut assembly.displacements {
            *displacement = sum(*displacement, step);
        }
        assembly.reanchor().expect("apart");
    }
    assembly.evaluate();
    // Each displacement is a fresh small remainder plus the step, so only the parts below an ulp of the box (10⁻¹⁵) that the
    // displacement held before rounds: 10⁻¹⁶ of it. The sum in the test: (0.3 − 0.7) + 1e-9 + 2e-17.
    let way: Vector<2> = std::array::from_fn(|d| (steps[0][d] + steps[2][d]) + (steps[1][d] + steps[3][d]));
    for index in 0..assembly.len() {
        let off = norm(difference(assembly.displacement_from_site(index), way));
        assert!(off <= 2.0 * f64::EPSILON * norm(way), "{off:e}");
        assert_eq!(assembly.forces[index], scaled(coupling, assembly.displacement_from_site(index)));
    }
    assert!((assembly.longest_displacement_from_site() / norm(way) - 1.0).abs() <= 4.0 * f64::EPSILON);
}

#[test]
fn force_is_minus_the_gradient_of_the_energy_with_sites() {
    for coupling in [-0.8, 0.6] {
        let packing = random_points::<2>(24, &Mixture::default(), 1.1, 7).expect("possible").with_sites_here();
        let mut assembly =
            Assembly::new(&packing, &OnSite { law: Hookean { stiffness: 1.0 }, coupling }).expect("apart");
        for (index, displacement) in assembly.displacements.iter_mut().enumerate() {
            *displacement = [0.02 * (index as f64).sin(), 0.02 * (index as f64).cos()];
        }
        let totals = assembly.evaluate_totals();
        let squares: f64 = assembly.displacements.iter().map(|&u| dot(u, u)).sum();
        assert!((totals.on_site_energy + 0.5 * coupling * squares).abs() <= 1e-14 * squares);
        let plain = forces_without(&packing, &assembly);
        // The virial and the scale of forces are those of contacts alone.
        assert_eq!((totals.virial, totals.force_sum), (plain.0, plain.1));
        let (forces, h) = (assembly.forces.clone(), 1e-5);
        for index in 0..assembly.len() {
            for d in 0..2 {
                let mut energy_at = |step: f64| {
                    let before = assembly.displacements[index];
                    assembly.displacements[index][d] += step;
                    let energy = assembly.evaluate_totals().energy;
                    assembly.displacements[index] = before;
                    energy
                };
                let slope = (energy_at(h) - energy_at(-h)) / (2.0 * h);
                // Truncation h² times third derivatives below 10 (F/r² of a few contacts), a contact that opens within h
                // leaves k h/4; rounding ε E/h with E below 1: 1e-11.
                assert!((forces[index][d] + slope).abs() < 5e-6, "disk {index}: {} and {slope}", forces[index][d]);
            }
        }
    }
}

fn forces_without(packing: &Packing<2>, like: &Assembly<2>) -> ([[f64; 2]; 2], f64) {
    let mut plain = Assembly::new(packing, &Hookean { stiffness: 1.0 }).expect("apart");
    plain.displacements.clone_from(&like.displacements);
    let totals = plain.evaluate_totals();
    (totals.virial, totals.force_sum)
}

/// A disk far from its site: −Γu²/2 outweighs the contacts, so all energies on the way are negative.
#[test]
fn energies_at_the_restarts_of_fire_never_increase_below_zero_either() {
    let law = OnSite { law: Hookean { stiffness: STIFFNESS }, coupling: 0.3 * STIFFNESS };
    let moved = vec![[0.25, 0.02], [0.0; 2], [0.0; 2], [0.0; 2], [0.0; 2]];
    let site = |packing: Packing<2>| {
        let back: Vec<Vector<2>> = moved.iter().map(|&u| scaled(-1.0, u)).collect();
        let first = packing.clone().with_corrections(back).expect("valid").with_sites_here();
        // Centres are position plus correction: corrections of 0 do not move the disks back, the opposite ones do.
        first.with_corrections(moved.clone()).expect("valid")
    };
    let packing = site(cross(0.0));
    let mut checks: Vec<Check> = Vec::new();
    let outcome = fire(1e-12).relax(packing, &law, &mut |check: &Check| checks.push(*check)).expect("apart");
    assert!(matches!(outcome.stop, Stop::Converged(_)), "{:?}", outcome.stop);
    let restarts: Vec<f64> = checks.iter().filter(|check| check.restart).map(|check| check.energy).collect();
    assert!(restarts.len() > 3 && checks.iter().all(|check| check.energy < 0.0), "{restarts:?}");
    // Rounding of contact and site energy added up, each below 5·10³.
    assert!(restarts.is_sorted_by(|&before, &after| after <= before + 2e-13 * 1e4), "{restarts:?}");
    let damped = damped(1e-12).relax(site(cross(0.0)), &law, &mut ()).expect("apart");
    assert!(matches!(damped.stop, Stop::Converged(_)), "{:?}", damped.stop);
    let apart = norm(difference(damped.state.centre(0).0, outcome.state.centre(0).0));
    assert!(apart < 1e-11, "{apart:e}");
}

fn dense() -> Packing<2> {
    let target = Target::Pressure(2000.0);
    let preparation = Preparation {
        disk_count: 300,
        mixture: Mixture::default(),
        target,
        tolerance: 0.01,
        seed: 1,
        ..Preparation::default()
    };
    let prepared = prepare_with::<2>(&preparation, &hertzian(), &fire(1e-12), &mut ()).expect("a packing");
    prepared.packing.into_inner()
}

#[test]
fn an_inflation_with_sites_has_them_throughout_and_its_pressure_is_that_of_contacts() {
    let (packing, law) = (dense(), hertzian());
    for boundary in [Boundary::HeldRim { outer_radius_over_side: 0.45 }, Boundary::Periodic] {
        let inflation = Inflation { increase: 1e-3, boundary, deflate: true, ..Inflation::default() };
        let plain = inflate_with(&inflation, &packing, &law, &fire(1e-12), 1, &mut ()).expect("an inflation");
        let tied = Inflation { on_site_coupling: Some(-1e4), ..inflation };
        let run = inflate_with(&tied, &packing, &law, &fire(1e-12), 1, &mut ()).expect("an inflation");
        let sizes = [&plain, &run].map(|run| {
            DisplacementField::of_inflation(run).disks.iter().map(|m| dot(m.displacement, m.displacement)).sum::<f64>()
        });
        assert!(sizes[1] < 0.9 * sizes[0], "{sizes:?}: tied disks move less");
        // Deflated in the same landscape: back where it began, to the limit over the stiffness of the sites and softer modes.
        let left = DisplacementField::of_cycle(&run).expect("deflated");
        let largest = left.disks.iter().map(|moved| norm(moved.displacement)).fold(0.0, larger);
        assert!(largest < 2e-11, "{largest:e} left");
        let after = run.after.packing.get();
        let network = ContactNetwork::new(after, &law).expect("apart");
        let with_sites = ContactNetwork::new(after, &OnSite { law, coupling: -1e4 }).expect("apart");
        assert_eq!(with_sites.energy(), network.energy());
        assert!((run.after.energy - network.energy() - with_sites.on_site_energy()).abs() <= 1e-15 * run.after.energy);
        assert!(with_sites.on_site_energy() > 0.0);
        // At rest with the sites, not without.
        assert!(with_sites.largest_net_force() <= 2e-12 * network.mean_contact_force());
        assert!(network.largest_net_force() > 1e-6 * network.mean_contact_force());
        if boundary == Boundary::Periodic {
            let volume = packing.domain().volume().expect("periodic");
            assert_eq!(run.after.pressure, network.pressure(volume));
        }
        let pushed = Inflation { on_site_coupling: Some(1e5), deflate: false, ..inflation };
        let error = inflate_with(&pushed, &packing, &law, &fire(1e-12), 1, &mut ()).expect_err("no minimum");
        let InflationError::NotAtRest { stop, stage: Stage::Inflated, .. } = error else { panic!("{error}") };
        assert_eq!(stop, Stop::NoMinimum);
    }
    let nan = Inflation { on_site_coupling: Some(f64::NAN), ..Inflation::default() };
    let error = inflate_with(&nan, &packing, &law, &fire(1e-12), 1, &mut ()).expect_err("not a number");
    assert!(matches!(error, InflationError::CouplingNotFinite { .. }), "{error}");
}

#[test]
fn the_residual_reaches_its_rounding_floor_with_sites_too() {
    let law = OnSite { law: hertzian(), coupling: -1e3 };
    let packing = random_points::<2>(100, &Mixture::default(), 1.0, 8).expect("possible");
    let outcome = fire(0.0).relax(packing, &law, &mut ()).expect("apart");
    assert_eq!(outcome.stop, Stop::RoundingFloor);
    let (residual, floor) = (outcome.residual.relative(), outcome.rounding_floor);
    assert!(residual <= 16.0 * floor && floor < 1e-13, "{residual:e}, floor {floor:e}");
}

#[test]
fn a_scene_names_the_coupling_and_refuses_what_is_not_a_number() {
    let mut scene = Scene::default();
    assert_eq!(scene.inflation.on_site_coupling, None);
    scene.inflation.on_site_coupling = Some(-3.5);
    assert_eq!(scene.check(), Ok(()));
    scene.inflation.on_site_coupling = Some(f64::INFINITY);
    let Err(SceneError::OutOfRange { field, .. }) = scene.check() else { panic!("not refused") };
    assert_eq!(field, "inflation.on_site_coupling");
}

#[test]
fn a_run_reports_the_coupling_where_there_is_one() {
    use jamscope::report::table::terminal_table;
    use jamscope::run::{SampleOutcome, run};
    use jamscope::scene::{Sample, Source};

    let sample =
        Sample { name: "dense".into(), seed: 1, source: Source::Pressure(2000.0), relaxer: Default::default() };
    let mut scene = Scene { disk_count: 200, sample: vec![sample], ..Scene::default() };
    let energies = [None, Some(-1e4)].map(|coupling| {
        scene.inflation.on_site_coupling = coupling;
        let report = run(&scene, &()).expect("a report");
        assert_eq!(terminal_table(&report).contains("on-site coupling, Γ"), coupling.is_some());
        let json = serde_json::to_string(&report).expect("plain data");
        assert_eq!(json.contains("on_site_coupling"), coupling.is_some());
        let SampleOutcome::Done(result) = &report.samples[0].result else { panic!("failed") };
        // Prepared without sites, whatever the inflation has.
        (result.packing.energy, result.inflation.after.energy)
    });
    assert_eq!(energies[0].0, energies[1].0);
    assert!(energies[0].1 < energies[1].1, "tied disks give way less: {energies:?}");
}

#[test]
fn laws_without_sites_know_nothing_of_them() {
    fn check(law: &dyn PairLaw) {
        assert!(!law.has_sites());
        assert_eq!(law.on_site_coupling(), 0.0);
        let packing = random_points::<2>(20, &Mixture::default(), 0.9, 1).expect("possible");
        let outcome = fire(1e-6).relax(packing, law, &mut ()).expect("apart");
        assert!(outcome.state.sites().is_none());
    }
    check(&hertzian());
    check(&hookean());
    assert_eq!(OnSite { law: OnSite { law: hookean(), coupling: 1.0 }, coupling: 2.0 }.on_site_coupling(), 3.0);
}
