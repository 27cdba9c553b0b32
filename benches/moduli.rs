//! Elastic moduli, lowest modes and certificate of packings at rest, and faer's partial eigensolver on the same operator.
//!
//! Times are per call, factorisations included. `cargo bench --features measurements --bench moduli`.

use criterion::{Criterion, criterion_group, criterion_main};
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::matrix_free::LinOp;
use faer::matrix_free::eigen::{PartialEigenParams, partial_self_adjoint_eigen, partial_self_adjoint_eigen_scratch};
use faer::{Col, Mat, MatMut, MatRef, Par};
use jamscope::certificate::Certificate;
use jamscope::io::read_packing;
use jamscope::law::Hertzian;
use jamscope::linear::{Analysis, ElasticModuli, Factorisation, VibrationalModes};
use jamscope::linear::{Hessian, Members, Prestress};
use jamscope::packing::{Mixture, Packing};
use jamscope::preparation::{Preparation, Target, prepare_with};
use jamscope::relax::{ForceLimit, Staged};
use jamscope::vector::larger;

/// Modes asked for.
const MODE_COUNTS: [usize; 3] = [1, 10, 40];

fn disks(name: &str) -> Packing<2> {
    read_packing(format!("{}/fixtures/packings/{name}.xyz", env!("CARGO_MANIFEST_DIR"))).expect("a fixture")
}

fn balls() -> Packing<3> {
    let target = Target::PackingFraction(0.75);
    let preparation = Preparation {
        disk_count: 1000,
        mixture: Mixture::default(),
        target,
        tolerance: 0.01,
        seed: 1,
        ..Preparation::default()
    };
    let staged = Staged { limit: ForceLimit::Relative(1e-10), ..Staged::default() };
    prepare_with::<3>(&preparation, &Hertzian::default(), &staged, &mut ()).expect("at rest").packing.get().clone()
}

fn of<const D: usize>(criterion: &mut Criterion, name: &str, packing: &Packing<D>) {
    let law = Hertzian::default();
    let mut group = criterion.benchmark_group(name);
    group.sample_size(10);
    group.bench_function("elastic_moduli", |bencher| {
        bencher.iter(|| ElasticModuli::of(packing, &law, Prestress::Included).expect("rigid"))
    });
    group.bench_function("certificate", |bencher| {
        bencher.iter(|| Certificate::of(packing, &law, None).expect("disks apart"))
    });
    for count in MODE_COUNTS {
        group.bench_function(format!("modes/{count}"), |bencher| {
            bencher.iter(|| VibrationalModes::lowest(packing, &law, Prestress::Included, count).expect("found"))
        });
        group.bench_function(format!("faer_modes/{count}"), |bencher| {
            bencher.iter(|| krylov_schur(packing, &law, count))
        });
    }
    for count in MODE_COUNTS {
        let modes = VibrationalModes::lowest(packing, &law, Prestress::Included, count).expect("found");
        let worst = modes.modes.iter().fold(0.0, |most, mode| larger(most, mode.residual));
        let (residual, solutions, found) = krylov_schur(packing, &law, count);
        println!(
            "{name}, {count} modes: {} solutions, residual {worst:.1e}; faer {solutions} solutions, residual \
             {residual:.1e}, {found} found",
            modes.solution_count
        );
    }
}

/// (K + s)⁻¹ without the translations, as faer's solvers take it: one solution, refined as ours are.
struct Inverse<'a, const D: usize>(std::sync::Mutex<(Factorisation<'a>, usize)>, usize);

/// Takes the mean over the disks out of each coordinate.
fn without_translations<const D: usize>(vector: &mut [f64]) {
    for axis in 0..D {
        let mean = vector.iter().skip(axis).step_by(D).sum::<f64>() / (vector.len() / D) as f64;
        vector.iter_mut().skip(axis).step_by(D).for_each(|value| *value -= mean);
    }
}

impl<const D: usize> std::fmt::Debug for Inverse<'_, D> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "Inverse of {} rows", self.1)
    }
}

impl<const D: usize> LinOp<f64> for Inverse<'_, D> {
    fn apply_scratch(&self, _: usize, _: Par) -> StackReq {
        StackReq::EMPTY
    }

    fn nrows(&self) -> usize {
        self.1
    }

    fn ncols(&self) -> usize {
        self.1
    }

    fn apply(&self, mut out: MatMut<'_, f64>, right: MatRef<'_, f64>, _: Par, _: &mut MemStack) {
        let mut held = self.0.lock().expect("one thread");
        let mut solution = vec![0.0; self.1];
        for column in 0..right.ncols() {
            let mut right: Vec<f64> = (0..self.1).map(|row| right[(row, column)]).collect();
            without_translations::<D>(&mut right);
            let _ = held.0.solve(&right, &mut solution).expect("accurate");
            held.1 += 1;
            without_translations::<D>(&mut solution);
            (0..self.1).for_each(|row| out[(row, column)] = solution[row]);
        }
    }

    fn conj_apply(&self, out: MatMut<'_, f64>, right: MatRef<'_, f64>, par: Par, stack: &mut MemStack) {
        self.apply(out, right, par, stack);
    }
}

/// The lowest modes by faer's restarted Krylov–Schur iteration on the inverse that ours takes: largest
/// residual over ‖K‖, solutions, modes found. Whether any is missing is not looked at.
fn krylov_schur<const D: usize>(packing: &Packing<D>, law: &Hertzian, count: usize) -> (f64, usize, usize) {
    let hessian = Hessian::new(packing, law, Members::Backbone, Prestress::Included).expect("disks apart");
    let matrix = hessian.matrix();
    let (dimension, norm) = (matrix.dimension(), matrix.norm());
    let shifted = matrix.shifted(1e-9 * norm);
    let mut analysis = Analysis::of(&hessian).expect("memory");
    let factorisation = analysis.cholesky(&shifted).expect("definite");
    let inverse = Inverse::<D>(std::sync::Mutex::new((factorisation, 0)), dimension);
    let parameters = PartialEigenParams { max_restarts: 40, ..Default::default() };
    let mut memory = MemBuffer::new(partial_self_adjoint_eigen_scratch(&inverse, count, Par::Seq, parameters));
    let (mut vectors, mut values) = (Mat::<f64>::zeros(dimension, count), vec![0.0; count]);
    let mut start: Vec<f64> =
        (0..dimension).map(|row| (1.0 + 1.7 * row as f64 * (1.0 + 0.01 * row as f64)).sin()).collect();
    without_translations::<D>(&mut start);
    let start = Col::<f64>::from_fn(dimension, |row| start[row]);
    let start = &start * (1.0 / start.norm_l2());
    let found = partial_self_adjoint_eigen(
        vectors.as_mut(),
        &mut values,
        &inverse,
        start.as_ref(),
        1e-14,
        Par::Seq,
        MemStack::new(&mut memory),
        parameters,
    );
    let mut worst = 0.0f64;
    for mode in 0..found.n_converged_eigen.min(count) {
        let vector: Vec<f64> = (0..dimension).map(|row| vectors[(row, mode)]).collect();
        let mut product = vec![0.0; dimension];
        matrix.multiply(&vector, &mut product);
        let value: f64 = vector.iter().zip(&product).map(|(x, y)| x * y).sum();
        let off: f64 = vector.iter().zip(&product).map(|(x, y)| (y - value * x).powi(2)).sum();
        worst = larger(worst, off.sqrt() / norm);
    }
    let solutions = inverse.0.lock().expect("one thread").1;
    (worst, solutions, found.n_converged_eigen)
}

fn all(criterion: &mut Criterion) {
    of(criterion, "1000_disks", &disks("hertz_N1000_p100"));
    of(criterion, "5548_disks", &disks("hertz_N5548_p100"));
    of(criterion, "1000_balls", &balls());
}

criterion_group!(benches, all);
criterion_main!(benches);
