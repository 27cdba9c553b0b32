//! The exact solutions: a profile at 1000 radii, its derivatives, what setting it up costs, poles, Bessel functions.
//!
//! `cargo bench --features measurements --bench reference`, or `-- GROUP` for one of `profile`, `derivative`, `antiscreened`, `setup`, `pole`,
//! `amplitude`, `bessel`. Of the errors beside these times there is a table: `cargo run --release --features measurements --example exact_routes`.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use jamscope::reference::amplitude::Amplitude;
use jamscope::reference::antiscreened::Antiscreened;
use jamscope::reference::bessel::modulus_phase::modulus_phase;
use jamscope::reference::bessel::{cylinder, modified, spherical};
use jamscope::reference::poles::pole;
use jamscope::reference::screened::Screened;
use jamscope::reference::{Annulus, RadialSolution};

/// κR: elastic but for its digits, below the first pole, among the first, far beyond.
const ARGUMENTS: [f64; 5] = [1e-4, 1.0, 5.3, 100.0, 1e5];

/// The circle of 67352 disks.
fn circle() -> Annulus {
    Annulus::new(0.5, 171.22479204766086).expect("radii in order")
}

/// 1000 radii, evenly spaced from edge to edge.
fn radii(annulus: Annulus) -> Vec<f64> {
    let (inner, outer) = (annulus.inner_radius(), annulus.outer_radius());
    (0..1000).map(|step| inner + (outer - inner) * (f64::from(step) + 0.5) / 1000.0).collect()
}

fn wavenumber(annulus: Annulus, argument: f64) -> f64 {
    argument / annulus.outer_radius()
}

fn profiles(criterion: &mut Criterion) {
    let (annulus, radii) = (circle(), radii(circle()));
    let sum = |f: &dyn Fn(f64) -> f64| radii.iter().map(|&radius| f(black_box(radius))).sum::<f64>();
    for argument in ARGUMENTS {
        let wavenumber = wavenumber(annulus, argument);
        let planar = Screened::<2>::new(annulus, 0.1, wavenumber).expect("no pole");
        let shell = Screened::<3>::new(annulus, 0.1, wavenumber).expect("no pole");
        let foundation = Antiscreened::<2>::new(annulus, 0.1, wavenumber).expect("valid");
        let solid_foundation = Antiscreened::<3>::new(annulus, 0.1, wavenumber).expect("valid");
        let mut group = criterion.benchmark_group("profile/1000");
        group.bench_function(BenchmarkId::new("2", argument), |b| b.iter(|| sum(&|r| planar.value(r))));
        group.bench_function(BenchmarkId::new("3", argument), |b| b.iter(|| sum(&|r| shell.value(r))));
        group.finish();
        let mut group = criterion.benchmark_group("derivative/1000");
        group.bench_function(BenchmarkId::new("radius/2", argument), |b| b.iter(|| sum(&|r| planar.derivative(r))));
        group.bench_function(BenchmarkId::new("radius/3", argument), |b| b.iter(|| sum(&|r| shell.derivative(r))));
        group.bench_function(BenchmarkId::new("wavenumber/2", argument), |b| {
            b.iter(|| sum(&|r| planar.wavenumber_derivative(r)));
        });
        group.bench_function(BenchmarkId::new("wavenumber/3", argument), |b| {
            b.iter(|| sum(&|r| shell.wavenumber_derivative(r)));
        });
        group.finish();
        let mut group = criterion.benchmark_group("antiscreened/1000");
        group.bench_function(BenchmarkId::new("2", argument), |b| b.iter(|| sum(&|r| foundation.value(r))));
        group.bench_function(BenchmarkId::new("3", argument), |b| b.iter(|| sum(&|r| solid_foundation.value(r))));
        group.bench_function(BenchmarkId::new("wavenumber/2", argument), |b| {
            b.iter(|| sum(&|r| foundation.wavenumber_derivative(r)));
        });
        group.finish();
    }
}

fn setups(criterion: &mut Criterion) {
    let annulus = circle();
    let mut group = criterion.benchmark_group("setup");
    for argument in ARGUMENTS {
        let wavenumber = wavenumber(annulus, argument);
        group.bench_function(BenchmarkId::new("value/2", argument), |b| {
            b.iter(|| Screened::<2>::new(annulus, 0.1, black_box(wavenumber)));
        });
        group.bench_function(BenchmarkId::new("value/3", argument), |b| {
            b.iter(|| Screened::<3>::new(annulus, 0.1, black_box(wavenumber)));
        });
        group.bench_function(BenchmarkId::new("with wavenumber derivative/2", argument), |b| {
            b.iter(|| {
                let medium = Screened::<2>::new(annulus, 0.1, black_box(wavenumber)).expect("no pole");
                medium.wavenumber_derivative(1.0)
            });
        });
    }
    group.finish();
}

fn poles(criterion: &mut Criterion) {
    let annulus = circle();
    let amplitude = Amplitude::<2>::new(annulus);
    for index in [1, 5, 1000] {
        criterion.bench_function(&format!("pole/2/{index}"), |b| b.iter(|| pole::<2>(annulus, black_box(index))));
        criterion.bench_function(&format!("pole/3/{index}"), |b| b.iter(|| pole::<3>(annulus, black_box(index))));
        criterion.bench_function(&format!("amplitude/residue/2/{index}"), |b| {
            b.iter(|| amplitude.residue(black_box(index)));
        });
    }
    criterion.bench_function("amplitude/2", |b| b.iter(|| amplitude.at(black_box(0.03))));
}

fn bessel(criterion: &mut Criterion) {
    type Function = fn(f64) -> f64;
    let functions: [(&str, Function); 15] = [
        ("J_0", cylinder::j0),
        ("J_1", cylinder::j1),
        ("Y_0", cylinder::y0),
        ("Y_1", cylinder::y1),
        ("I_0 scaled", modified::i0_scaled),
        ("I_1 scaled", modified::i1_scaled),
        ("K_0 scaled", modified::k0_scaled),
        ("K_1 scaled", modified::k1_scaled),
        ("I_1", modified::i1),
        ("K_1", modified::k1),
        ("j_1", spherical::j1),
        ("y_1", spherical::y1),
        ("i_1 scaled", spherical::i1_scaled),
        ("k_1 scaled", spherical::k1_scaled),
        ("modulus and phase", |x| modulus_phase(x).shift),
    ];
    let mut group = criterion.benchmark_group("bessel");
    for (name, function) in functions {
        for x in [0.3, 7.0, 1e3] {
            group.bench_function(BenchmarkId::new(name, x), |b| b.iter(|| function(black_box(x))));
        }
    }
    group.finish();
}

criterion_group! {
    name = benches;
    // Some eighty functions of nanoseconds to microseconds: half a second each is enough.
    config = Criterion::default()
        .warm_up_time(std::time::Duration::from_millis(100))
        .measurement_time(std::time::Duration::from_millis(400))
        .sample_size(20);
    targets = profiles, setups, poles, bessel
}
criterion_main!(benches);
