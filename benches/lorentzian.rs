//! The generalised Lorentzian: setting up, one G(θ), one G'(θ), one θ*.
//!
//! `cargo bench --features measurements --bench lorentzian`; `cargo run --release --features measurements --example lorentzian_routes` has other routes beside it.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use jamscope::reference::lorentzian::{ContinuumLorentzian, Lorentzian};

fn lorentzian(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("lorentzian");
    group.sample_size(20);
    for exponent in [1.5, 4.0, 30.0] {
        for crossover in [1e-6, 5.0, 1e6] {
            let name = format!("s={exponent}/f={crossover}");
            group.bench_function(BenchmarkId::new("set_up", &name), |bencher| {
                bencher.iter(|| Lorentzian::new(crossover, exponent));
            });
            let medium = Lorentzian::new(crossover, exponent).expect("valid");
            // Angles from 10⁻⁶ to π, each costs about the same.
            let mut angle = 1e-6;
            let mut next = move || {
                angle = if angle > 3.0 { 1e-6 } else { 1.1 * angle };
                angle
            };
            group.bench_function(BenchmarkId::new("correlation", &name), |bencher| {
                bencher.iter(|| medium.correlation(next()));
            });
            group.bench_function(BenchmarkId::new("derivative", &name), |bencher| {
                bencher.iter(|| medium.derivative(next()));
            });
            group.bench_function(BenchmarkId::new("crossing", &name), |bencher| {
                bencher.iter(|| medium.crossing(0.1));
            });
        }
    }
    let limit = ContinuumLorentzian::new(1.5).expect("valid");
    group.bench_function("continuum/correlation", |bencher| bencher.iter(|| limit.correlation(1.681)));
    group.finish();
}

criterion_group!(benches, lorentzian);
criterion_main!(benches);
