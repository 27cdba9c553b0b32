//! The hot loop, the neighbour list, and the contact network, at four sizes and for two laws.
//!
//! Times are per call; criterion's throughput is disks per second. `cargo bench --features measurements --bench contact`.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use jamscope::forces::Assembly;
use jamscope::law::{Hertzian, Hookean, PairLaw};
use jamscope::network::ContactNetwork;
use jamscope::packing::{Mixture, Packing};
use jamscope::preparation::random_points;
use jamscope::relax::{Fire, ForceLimit, Relaxer};

/// The sizes of the study and two below.
const SIZES: [usize; 4] = [1024, 5548, 22184, 88776];

/// Random points at φ = 0.86, relaxed far enough that only touching disks overlap; the loop does not care for the rest.
fn packing(disks: usize, law: &dyn PairLaw) -> Packing<2> {
    let points = random_points::<2>(disks, &Mixture::default(), 0.86, 1).expect("a valid mixture and packing fraction");
    let fire = Fire { limit: ForceLimit::Relative(1e-2), step_limit: 5000, ..Fire::default() };
    fire.relax(points, law, &mut ()).expect("random points never coincide").state
}

fn hot_loop(criterion: &mut Criterion, name: &str, law: &dyn PairLaw) {
    let mut group = criterion.benchmark_group(format!("forces/{name}"));
    for disks in SIZES {
        let mut assembly = Assembly::new(&packing(disks, law), law).expect("a valid packing");
        group.throughput(Throughput::Elements(disks as u64));
        group.bench_function(BenchmarkId::new("forces", disks), |bencher| bencher.iter(|| assembly.evaluate()));
        group.bench_function(BenchmarkId::new("forces_and_totals", disks), |bencher| {
            bencher.iter(|| assembly.evaluate_totals())
        });
    }
    group.finish();
}

fn loops(criterion: &mut Criterion) {
    hot_loop(criterion, "hertzian", &Hertzian::default());
    hot_loop(criterion, "hookean", &Hookean::default());
}

fn lists(criterion: &mut Criterion) {
    let law = Hertzian::default();
    let mut group = criterion.benchmark_group("list");
    group.sample_size(20);
    for disks in SIZES {
        let packing = packing(disks, &law);
        let mut assembly = Assembly::new(&packing, &law).expect("a valid packing");
        group.throughput(Throughput::Elements(disks as u64));
        group.bench_function(BenchmarkId::new("rebuild", disks), |bencher| {
            bencher.iter(|| assembly.reanchor().expect("disks apart"));
        });
        group.bench_function(BenchmarkId::new("from_scratch", disks), |bencher| {
            bencher.iter(|| Assembly::new(&packing, &law).expect("a valid packing"));
        });
        group.bench_function(BenchmarkId::new("contact_network", disks), |bencher| {
            bencher.iter(|| ContactNetwork::new(&packing, &law).expect("a valid packing"));
        });
    }
    group.finish();
}

criterion_group!(benches, loops, lists);
criterion_main!(benches);
