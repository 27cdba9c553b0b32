//! Relaxers to equal residuals, from the same inflated packing; force evaluations are printed beside the seconds.
//!
//! `cargo bench --features measurements --bench relax`.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use jamscope::inflation::Circle;
use jamscope::io::read_packing;
use jamscope::law::Hertzian;
use jamscope::packing::Packing;
use jamscope::relax::{
    DampedDynamics, Fire, ForceLimit, NonlinearConjugateGradients, QuasiNewton, Relaxer, RelaxerChoice, StepBack,
    Uphill,
};

/// The centre of a stored packing inflated by 0.1 in its circle, everything else still where it was.
fn inflated(name: &str) -> Packing<2> {
    let path = format!("{}/fixtures/packings/{name}.xyz", env!("CARGO_MANIFEST_DIR"));
    let packing = read_packing::<2>(path).expect("a fixture");
    let side = packing.domain().lengths().expect("periodic")[0];
    let circle = Circle::cut(&packing, 0, 0.48 * side).expect("a circle in its box");
    circle.packing.with_radius(circle.centre, 0.6).expect("a positive radius")
}

fn relaxers(criterion: &mut Criterion) {
    let law = Hertzian::default();
    let mut group = criterion.benchmark_group("relax");
    group.sample_size(10);
    for name in ["hertz_N1000_p10", "hertz_N1000_p100", "hertz_N1000_p800", "hertz_N5548_p100"] {
        let start = inflated(name);
        for limit in [1e-4, 1e-8] {
            let fire = Fire { limit: ForceLimit::Relative(limit), ..Fire::default() };
            let outcome = fire.relax(start.clone(), &law, &mut ()).expect("disks apart");
            println!(
                "FIRE {name} to {limit:e}: {} force evaluations, {:?}",
                outcome.cost.force_evaluation_count, outcome.stop
            );
            group.bench_function(BenchmarkId::new(format!("fire/{name}"), limit), |bencher| {
                bencher.iter(|| fire.relax(start.clone(), &law, &mut ()));
            });
        }
    }
    let start = inflated("hertz_N1000_p800");
    let damped = DampedDynamics { limit: ForceLimit::Relative(1e-4), ..DampedDynamics::default() };
    let outcome = damped.relax(start.clone(), &law, &mut ()).expect("disks apart");
    println!(
        "damped hertz_N1000_p800 to 1e-4: {} force evaluations, {:?}",
        outcome.cost.force_evaluation_count, outcome.stop
    );
    group.bench_function(BenchmarkId::new("damped/hertz_N1000_p800", 1e-4), |bencher| {
        bencher.iter(|| damped.relax(start.clone(), &law, &mut ()));
    });
    group.finish();
}

/// Conjugate gradients, L-BFGS and FIRE's step back, to a limit that FIRE reaches and to one near the rounding floor.
fn minimisers(criterion: &mut Criterion) {
    let law = Hertzian::default();
    let mut group = criterion.benchmark_group("relax");
    group.sample_size(10);
    for name in ["hertz_N1000_p10", "hertz_N1000_p100", "hertz_N1000_p800", "hertz_N5548_p100"] {
        let start = inflated(name);
        for limit in [1e-8, 1e-12] {
            let asked = ForceLimit::Relative(limit);
            let gradients = NonlinearConjugateGradients { limit: asked, ..Default::default() };
            let uphill = Uphill::StepBack(StepBack::default());
            for (what, relaxer) in [
                ("gradients", RelaxerChoice::ConjugateGradients(gradients)),
                ("l-bfgs", RelaxerChoice::QuasiNewton(QuasiNewton { limit: asked, ..Default::default() })),
                ("fire-step-back", RelaxerChoice::Fire(Fire { limit: asked, uphill, ..Default::default() })),
            ] {
                let outcome = relaxer.relax(start.clone(), &law, &mut ()).expect("disks apart");
                let made = outcome.cost.force_evaluation_count;
                println!("{what} {name} to {limit:e}: {made} force evaluations, {:?}", outcome.stop);
                group.bench_function(BenchmarkId::new(format!("{what}/{name}"), limit), |bencher| {
                    bencher.iter(|| relaxer.relax(start.clone(), &law, &mut ()));
                });
            }
        }
    }
    group.finish();
}

/// Implicit dynamics and gradient flow at their default tolerance, to a limit and to the rounding floor.
#[cfg(feature = "linear")]
fn implicit(criterion: &mut Criterion) {
    use jamscope::relax::{GradientFlow, ImplicitDynamics};
    let law = Hertzian::default();
    let mut group = criterion.benchmark_group("relax");
    group.sample_size(10);
    for name in ["hertz_N1000_p10", "hertz_N1000_p100", "hertz_N1000_p800", "hertz_N5548_p100"] {
        let start = inflated(name);
        let limit = ForceLimit::Relative(1e-12);
        for (what, relaxer) in [
            ("implicit", RelaxerChoice::Implicit(ImplicitDynamics { limit, ..Default::default() })),
            ("gradient-flow", RelaxerChoice::GradientFlow(GradientFlow { limit, ..Default::default() })),
        ] {
            let outcome = relaxer.relax(start.clone(), &law, &mut ()).expect("disks apart");
            let cost = outcome.cost;
            let (steps, rejected, factorisations) = (cost.step_count, cost.rejected_count, cost.factorisation_count);
            println!(
                "{what} {name}: {steps} steps, {rejected} rejected, {factorisations} factorisations, {:?}",
                outcome.stop
            );
            group.bench_function(BenchmarkId::new(format!("{what}/{name}"), 1e-12), |bencher| {
                bencher.iter(|| relaxer.relax(start.clone(), &law, &mut ()));
            });
        }
    }
    group.finish();
}

/// FIRE until Newton pays, then Newton, to limits that FIRE alone reaches and to one near the rounding floor.
#[cfg(feature = "linear")]
fn staged(criterion: &mut Criterion) {
    let law = Hertzian::default();
    let mut group = criterion.benchmark_group("relax");
    group.sample_size(10);
    for name in ["hertz_N1000_p10", "hertz_N1000_p100", "hertz_N1000_p800", "hertz_N5548_p100"] {
        let start = inflated(name);
        for limit in [1e-8, 1e-12] {
            let staged = jamscope::relax::Staged { limit: ForceLimit::Relative(limit), ..Default::default() };
            let outcome = staged.relax(start.clone(), &law, &mut ()).expect("disks apart");
            println!(
                "staged {name} to {limit:e}: {} force evaluations, {} factorisations, {:?}",
                outcome.cost.force_evaluation_count, outcome.cost.factorisation_count, outcome.stop
            );
            group.bench_function(BenchmarkId::new(format!("staged/{name}"), limit), |bencher| {
                bencher.iter(|| staged.relax(start.clone(), &law, &mut ()));
            });
        }
    }
    group.finish();
}

#[cfg(feature = "linear")]
criterion_group!(benches, relaxers, minimisers, implicit, staged);
#[cfg(not(feature = "linear"))]
criterion_group!(benches, relaxers, minimisers);
criterion_main!(benches);
