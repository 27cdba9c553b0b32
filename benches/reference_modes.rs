//! Angular modes, sources at the centre and waves in a strip: setting one up, and one radius, elastic and screened.
//!
//! Times are per call. `cargo bench --features measurements --bench reference_modes`.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use jamscope::reference::Annulus;
use jamscope::reference::angular_modes::elastic::ElasticMode;
use jamscope::reference::angular_modes::force_dipole::ForceDipole;
use jamscope::reference::angular_modes::point_force::PointForce;
use jamscope::reference::angular_modes::screened::{ScreenedMode, Screening};
use jamscope::reference::angular_modes::screened_source::ScreenedSource;
use jamscope::reference::angular_modes::{AngularSolution, ModeAmplitudes};
use jamscope::reference::strip_modes::{StripAmplitudes, StripMode};

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

/// Sources at the centre, and waves along a strip.
fn sources_and_strips(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("angular_modes/sources");
    let (force, screening) = (0.1, (5.0f64 / 170.0).powi(2));
    let kelvin = PointForce::new(annulus(), POISSON_RATIO, force).expect("valid");
    group.bench_function("force", |bencher| bencher.iter(|| kelvin.at(black_box(40.0))));
    let dipole = ForceDipole::new(annulus(), POISSON_RATIO, force).expect("valid");
    group.bench_function("dipole", |bencher| bencher.iter(|| dipole.displacement(black_box(40.0), 0.3)));
    let set_up = || ScreenedSource::force(annulus(), POISSON_RATIO, screening, force).expect("no pole");
    group.bench_function("screened_force/set_up", |bencher| bencher.iter(set_up));
    let screened = set_up();
    group.bench_function("screened_force", |bencher| bencher.iter(|| screened.at(black_box(40.0))));
    let wave = StripAmplitudes { normal: 0.1, tangential: 0.0 };
    for (name, screening) in [("strip", 0.0), ("screened_strip", screening)] {
        let set_up = || StripMode::new(annulus(), POISSON_RATIO, screening, 0.1, wave).expect("no pole");
        group.bench_function(BenchmarkId::new(name, "set_up"), |bencher| bencher.iter(set_up));
        let mode = set_up();
        group.bench_function(BenchmarkId::new(name, "place"), |bencher| bencher.iter(|| mode.at(black_box(40.0))));
    }
    group.finish();
}

criterion_group!(benches, elastic, screened, sources_and_strips);
criterion_main!(benches);
