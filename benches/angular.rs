//! Angular spectra and correlation functions: Fourier sums by both routes, every estimator, the window, fits.
//!
//! `cargo bench --features measurements --bench angular`; `cargo run --release --features measurements --example angular_estimators` has errors beside the times.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use jamscope::observe::angular::synthetic::{SyntheticSettings, gaussian_rings};
use jamscope::observe::angular::{
    AngularCorrelation, CorrelationEstimator, CorrelationSettings, FrequencyLimit, Leakage, PowerSpectrum, RingSample,
    Route, SpectralWindow, SpectrumEstimator, SpectrumSettings, Weights, fourier_sums_by,
};

fn ring(disk_count: usize) -> RingSample {
    let settings = SyntheticSettings { disk_count, ..SyntheticSettings::default() };
    gaussian_rings(&settings, 1, |f| f.powf(-1.5)).expect("enough disks").remove(0).ring
}

fn sums(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("angular/fourier_sums");
    group.sample_size(20);
    for (disk_count, limit) in
        [(60, 15), (60, 120), (250, 60), (250, 160), (1000, 15), (1000, 40), (1000, 125), (4000, 10), (4000, 500)]
    {
        let ring = ring(disk_count);
        for route in [Route::Direct, Route::Fast] {
            let name = BenchmarkId::new(format!("{route:?}"), format!("{disk_count}x{limit}"));
            group.bench_function(name, |bencher| {
                bencher.iter(|| fourier_sums_by(route, ring.angles(), ring.values(), limit));
            });
        }
    }
    group.finish();
}

fn estimators(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("angular/estimators");
    group.sample_size(10);
    for disk_count in [60, 1000, 4000] {
        let ring = ring(disk_count);
        let frequency_limit = FrequencyLimit::PerDisk(0.125);
        for (name, estimator) in [
            ("direct", SpectrumEstimator::Direct { weights: Weights::Gaps, leakage: Leakage::Kept }),
            ("unmixed", SpectrumEstimator::default()),
            ("interpolated", SpectrumEstimator::Interpolated { points_per_disk: 4.0 }),
            ("binned", SpectrumEstimator::Binned { bins_per_disk: 0.5 }),
        ] {
            let settings = SpectrumSettings { estimator, frequency_limit };
            group.bench_function(BenchmarkId::new(name, disk_count), |bencher| {
                bencher.iter(|| PowerSpectrum::of(&ring, &settings));
            });
        }
        for (name, estimator) in
            [("correlation", CorrelationEstimator::default()), ("pairs", CorrelationEstimator::Pairs { bin_count: 90 })]
        {
            let settings = CorrelationSettings { estimator, ..CorrelationSettings::default() };
            group.bench_function(BenchmarkId::new(name, disk_count), |bencher| {
                bencher.iter(|| AngularCorrelation::of(&ring, &settings));
            });
        }
        group.bench_function(BenchmarkId::new("window", disk_count), |bencher| {
            bencher.iter(|| SpectralWindow::new(&ring, Weights::Gaps, (disk_count / 16).max(15), 2 * disk_count));
        });
    }
    group.finish();
}

#[cfg(feature = "fit")]
fn fits(criterion: &mut Criterion) {
    use jamscope::fit::angular::{CrossoverSettings, ExponentChoice, SpectrumWindowSettings, fit_crossover, fit_slope};
    let mut group = criterion.benchmark_group("angular/fits");
    group.sample_size(10);
    for disk_count in [60, 1000, 4000] {
        let ring = [ring(disk_count)];
        let free = CrossoverSettings { exponent: ExponentChoice::Free, ..CrossoverSettings::default() };
        group.bench_function(BenchmarkId::new("slope", disk_count), |bencher| {
            bencher.iter(|| fit_slope(&ring, &SpectrumWindowSettings::default()));
        });
        group.bench_function(BenchmarkId::new("crossover", disk_count), |bencher| {
            bencher.iter(|| fit_crossover(&ring, &CrossoverSettings::default()));
        });
        group.bench_function(BenchmarkId::new("crossover, free exponent", disk_count), |bencher| {
            bencher.iter(|| fit_crossover(&ring, &free));
        });
    }
    group.finish();
}

#[cfg(not(feature = "fit"))]
fn fits(_: &mut Criterion) {}

/// Shells of spheres: spectrum, correlation of all pairs, fit of a slope.
fn shells(criterion: &mut Criterion) {
    use jamscope::observe::shell::synthetic::{SyntheticSettings, gaussian_shells};
    use jamscope::observe::shell::{ShellCorrelation, ShellCorrelationSettings, ShellSpectrum, ShellSpectrumSettings};
    let mut group = criterion.benchmark_group("angular/shells");
    group.sample_size(10);
    for disk_count in [500, 5000] {
        let settings = SyntheticSettings { disk_count, ..SyntheticSettings::default() };
        let shell = gaussian_shells(&settings, 1, |l| l.powf(-2.5)).expect("enough spheres").remove(0).shell;
        group.bench_function(BenchmarkId::new("spectrum", disk_count), |bencher| {
            bencher.iter(|| ShellSpectrum::of(&shell, &ShellSpectrumSettings::default()));
        });
        group.bench_function(BenchmarkId::new("correlation", disk_count), |bencher| {
            bencher.iter(|| ShellCorrelation::of(&shell, &ShellCorrelationSettings::default()));
        });
        #[cfg(feature = "fit")]
        {
            use jamscope::fit::angular::{ShellFitSettings, fit_shell_slope};
            group.bench_function(BenchmarkId::new("slope", disk_count), |bencher| {
                bencher.iter(|| fit_shell_slope(std::slice::from_ref(&shell), &ShellFitSettings::default()));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, sums, estimators, fits, shells);
criterion_main!(benches);
