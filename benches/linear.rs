//! The Hessian, its analysis, factors and solutions, at four sizes: triangular lattices with a held rim.
//!
//! Times are per call; criterion's throughput is disks per second. `cargo bench --features measurements --bench linear`.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use jamscope::forces::Assembly;
use jamscope::inflation::Circle;
use jamscope::lattice::Lattice;
use jamscope::law::{Hertzian, OnSite};
use jamscope::linear::{Analysis, LinearResponse};
use jamscope::linear::{Hessian, Members, Prestress};

/// Radii of circles that hold about 1 000, 5 500, 22 000 and 89 000 disks.
const RADII: [f64; 4] = [16.0, 37.2, 74.4, 149.0];

fn circle(outer_radius: f64) -> Circle<2> {
    let lattice = Lattice::triangular(0.5, 0.05).expect("a positive overlap");
    lattice.circle(outer_radius).expect("mobile sites")
}

fn stages(criterion: &mut Criterion) {
    let law = Hertzian::default();
    let lattice = Lattice::triangular(0.5, 0.05).expect("a positive overlap");
    let mut group = criterion.benchmark_group("linear");
    group.sample_size(10);
    for outer_radius in RADII {
        let circle = circle(outer_radius);
        let disks = circle.mobile_count();
        group.throughput(Throughput::Elements(disks as u64));
        let mut assembly = Assembly::new(&circle.packing, &law).expect("disks apart");
        group.bench_function(BenchmarkId::new("forces_and_totals", disks), |bencher| {
            bencher.iter(|| assembly.evaluate_totals())
        });
        let mut hessian = Hessian::of(&assembly, Members::Backbone, Prestress::Included);
        group.bench_function(BenchmarkId::new("hessian", disks), |bencher| bencher.iter(|| hessian.update(&assembly)));
        let matrix = hessian.matrix();
        group.bench_function(BenchmarkId::new("analysis", disks), |bencher| {
            bencher.iter(|| Analysis::of(&hessian).expect("memory"))
        });
        let mut analysis = Analysis::of(&hessian).expect("memory");
        println!(
            "{disks} disks: {} values in a factor, {} in the matrix",
            analysis.factor_count(),
            matrix.stored_count()
        );
        group.bench_function(BenchmarkId::new("cholesky", disks), |bencher| {
            bencher.iter(|| analysis.cholesky(matrix).expect("definite").negative_eigenvalue_count())
        });
        // κR = 5, between the first two poles.
        let coupling = lattice.coupling(&law, (5.0 / outer_radius).powi(2)).expect("isotropic");
        let screened = Hessian::new(&circle.packing, &OnSite { law, coupling }, Members::Backbone, Prestress::Included);
        let screened = screened.expect("disks apart");
        group.bench_function(BenchmarkId::new("indefinite", disks), |bencher| {
            bencher.iter(|| analysis.indefinite(screened.matrix()).expect("no pole").negative_eigenvalue_count())
        });
        let (right, mut solution) = (vec![1.0; matrix.dimension()], vec![0.0; matrix.dimension()]);
        let mut factorisation = analysis.cholesky(matrix).expect("definite");
        group.bench_function(BenchmarkId::new("solve_and_refine", disks), |bencher| {
            bencher.iter(|| factorisation.solve(&right, &mut solution).expect("accurate"))
        });
        group.bench_function(BenchmarkId::new("response", disks), |bencher| {
            bencher.iter(|| LinearResponse::of_inflation(&circle.packing, circle.centre, &law, Prestress::Included))
        });
    }
    group.finish();
}

criterion_group!(benches, stages);
criterion_main!(benches);
