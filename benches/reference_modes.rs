//! Angular modes: setting one up, and one radius, elastic and screened.
//!
//! Times are per call. `cargo bench --features measurements --bench reference_modes`.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use jamscope::reference::Annulus;
use jamscope::reference::angular_modes::elastic::ElasticMode;
use jamscope::reference::angular_modes::screened::{ScreenedMode, Screening};
use jamscope::reference::angular_modes::{AngularSolution, ModeAmplitudes};

const POISSON_RATIO: f64 = 0.3;

/// The circle of 67352 disks.
fn annulus() -> Annulus {
    Annulus::new(0.5, 170.0).expect("radii are in order")
}

fn boundary() -> ModeAmplitudes {
    ModeAmplitudes::in_phase(0.1, 0.05)
}

fn elastic(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("angular_modes/elastic");
    for mode in [0, 1, 2, 100] {
        let medium = ElasticMode::new(annulus(), POISSON_RATIO, mode, boundary()).expect("valid");
        group.bench_function(BenchmarkId::new("radius", mode), |bencher| bencher.iter(|| medium.at(black_box(40.0))));
    }
    group.finish();
}

fn screened(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("angular_modes/screened");
    // n and κR of the radial part: a few and many nodes of either kind.
    for (mode, argument) in [(0, 5.0), (2, 5.0), (100, 5.0), (2, 500.0)] {
        let even = Screening::from_wavenumber(argument / 170.0, POISSON_RATIO);
        let screening = Screening { odd: 0.3 * even.even, ..even };
        let set_up = || ScreenedMode::new(annulus(), POISSON_RATIO, screening, mode, boundary()).expect("no pole");
        let name = format!("n_{mode}_kR_{argument}");
        group.bench_function(BenchmarkId::new("set_up", &name), |bencher| bencher.iter(set_up));
        let medium = set_up();
        group.bench_function(BenchmarkId::new("radius", &name), |bencher| {
            bencher.iter(|| medium.at(black_box(40.0)));
        });
        println!("{name}: {} nodes", medium.node_count());
    }
    group.finish();
}

criterion_group!(benches, elastic, screened);
criterion_main!(benches);
