//! Fits of profiles whose answer is known.

use jamscope::fit::FitError;
use jamscope::fit::profile::{Decision, ProfileFit, ProfileFitSettings, fit_radial_profile};
use jamscope::observe::radial_profile::{RadialProfile, Ring};
use jamscope::reference::poles::pole;
use jamscope::reference::rim::RimSolution;
use jamscope::reference::screened::Screened;
use jamscope::reference::{Annulus, RadialSolution};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// The circle of 4016 disks: a = 0.5, R = 42, rings one diameter wide.
const RIM: f64 = 42.0;

fn annulus() -> Annulus {
    Annulus::new(0.5, RIM).expect("radii are in order")
}

/// First pole.
fn first() -> f64 {
    pole::<2>(annulus(), 1)
}

fn normal(random: &mut Pcg64Mcg) -> f64 {
    // Box and Muller; 1 − u is never 0.
    let (u, v) = (random.random::<f64>(), random.random::<f64>());
    (-2.0 * (1.0 - u).ln()).sqrt() * (2.0 * std::f64::consts::PI * v).cos()
}

/// What is added to the displacement of a medium.
#[derive(Clone, Copy)]
struct Noise {
    /// Standard deviation of r·d_r of a disk, independent of the others.
    disk: f64,
    /// Standard deviation of r·d_r of a ring as a whole, which its disks do not show.
    ring: f64,
    /// Correlation of that between neighbouring rings.
    memory: f64,
}

const QUIET: Noise = Noise { disk: 0.0, ring: 0.0, memory: 0.0 };
/// r·d_r of an elastic sample is 0.025 at the disk: a disk scatters as much, a ring by a tenth of it.
const WHITE: Noise = Noise { disk: 0.025, ring: 0.0, memory: 0.0 };
const CORRELATED: Noise = Noise { disk: 0.025, ring: 0.003, memory: 0.5 };

/// The rings of a sample in which disk i is displaced by `rescaled(r)/r` and noise.
fn profile(rescaled: impl Fn(f64) -> f64, noise: Noise, random: &mut Pcg64Mcg) -> RadialProfile {
    let mut shared = noise.ring * normal(random);
    let rings = (1..41)
        .map(|index| {
            let radius = f64::from(index) + 0.5;
            // 0.73 disks in the unit of area.
            let disk_count = (0.73 * 2.0 * std::f64::consts::PI * radius).round() as usize;
            let expected = rescaled(radius) + shared;
            shared = noise.memory * shared + noise.ring * (1.0 - noise.memory * noise.memory).sqrt() * normal(random);
            let disks: Vec<f64> = (0..disk_count).map(|_| (expected + noise.disk * normal(random)) / radius).collect();
            let mean = disks.iter().sum::<f64>() / disk_count as f64;
            let square = disks.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / (disk_count as f64 - 1.0);
            let spread = if noise.disk > 0.0 { square.sqrt() } else { 0.0 };
            Ring { radius, disk_count, mean, spread, standard_error: spread / (disk_count as f64).sqrt() }
        })
        .collect();
    RadialProfile { rings }
}

fn screened(amplitude: f64, wavenumber: f64) -> impl Fn(f64) -> f64 {
    let medium = Screened::<2>::new(annulus(), amplitude, wavenumber).expect("no pole");
    move |radius| radius * medium.value(radius)
}

fn fit(profile: &RadialProfile) -> ProfileFit {
    fit_radial_profile(profile, annulus(), &ProfileFitSettings::default()).expect("a profile that can be fitted")
}

#[test]
fn explore() {
    for (name, noise) in
        [("white", WHITE), ("correlated", CORRELATED), ("loud", Noise { disk: 0.05, ring: 0.008, memory: 0.5 })]
    {
        for share in [0.0, 0.2, 0.5, 0.8, 0.95, 1.0001, 1.1, 1.3, 1.6, 1.8, 2.2, 3.0] {
            let k = share * first();
            let scale = {
                let v = RimSolution::<2>::new(annulus(), k).unwrap();
                let m = (1..41).map(|i| (i as f64 + 0.5) * v.value(i as f64 + 0.5)).map(f64::abs).fold(0.0, f64::max);
                0.025 / m * v.value(0.5)
            };
            let mut rng = Pcg64Mcg::seed_from_u64(3);
            let (mut e, mut s, mut cov, mut covd, mut bound, mut share_sum, mut neff, mut sse, mut far) =
                (0, 0, 0, 0, 0, 0.0, 0.0, 0.0, 0);
            let n = 400;
            for _ in 0..n {
                let f = fit(&profile(screened(scale, k), noise, &mut rng));
                match f.decision {
                    Decision::Elastic => e += 1,
                    Decision::Screened => s += 1,
                    _ => {}
                }
                if let Some(q) = &f.screened {
                    if (q.wavenumber.value - k).abs() < q.wavenumber.standard_error {
                        cov += 1
                    };
                    if (q.amplitude.value - scale).abs() < q.amplitude.standard_error {
                        covd += 1
                    };
                    share_sum += q.share_described;
                    neff += q.effective_ring_count;
                    sse += q.wavenumber.standard_error;
                    if (q.wavenumber.value - k).abs() > 0.5 * first() {
                        far += 1
                    }
                }
                if share == 0.0 && (f.elastic.amplitude.value - scale).abs() < f.elastic.amplitude.standard_error {
                    covd += 1
                }
                if f.elastic.wavenumber_bound.is_none_or(|b| b > k) {
                    bound += 1
                }
            }
            println!(
                "{name} {share}: elastic {} screened {} cov k {} d {} bound {} share {:.2} neff {:.1} se/k1 {:.3} far {far}",
                e,
                s,
                cov,
                covd,
                bound,
                share_sum / n as f64,
                neff / n as f64,
                sse / n as f64 / first()
            );
        }
    }
    for len in [3.0, 5.0, 8.0] {
        for noise in [QUIET, Noise { disk: 0.002, ring: 0.0, memory: 0.0 }] {
            let f = fit(&profile(
                |r| if r < 10.0 { 0.05 * (-r / len).exp() } else { 0.0 },
                noise,
                &mut Pcg64Mcg::seed_from_u64(3),
            ));
            println!(
                "blob {len} {:?} E {:.2} S {:?} {:?}",
                f.decision,
                f.elastic.share_described,
                f.screened.map(|s| (
                    s.share_described,
                    s.chance_of_elastic,
                    s.chance_of_nothing,
                    s.wavenumber.value / first(),
                    s.effective_ring_count
                )),
                f.elastic.effective_ring_count
            );
            let f = fit(&profile(
                |r| if r < 10.0 { 0.05 * (1.0 - r / 10.0) } else { 0.0 },
                noise,
                &mut Pcg64Mcg::seed_from_u64(3),
            ));
            println!(
                "triangle {len} {:?} E {:.2} S {:?} {:?}",
                f.decision,
                f.elastic.share_described,
                f.screened.map(|s| (
                    s.share_described,
                    s.chance_of_elastic,
                    s.chance_of_nothing,
                    s.wavenumber.value / first(),
                    s.effective_ring_count
                )),
                f.elastic.effective_ring_count
            );
            let f = fit(&profile(|r| if r < 10.0 { 0.05 } else { 0.0 }, noise, &mut Pcg64Mcg::seed_from_u64(3)));
            println!(
                "box {len} {:?} E {:.2} S {:?} {:?}",
                f.decision,
                f.elastic.share_described,
                f.screened.map(|s| (
                    s.share_described,
                    s.chance_of_elastic,
                    s.chance_of_nothing,
                    s.wavenumber.value / first(),
                    s.effective_ring_count
                )),
                f.elastic.effective_ring_count
            );
        }
    }
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    let mut c = [0; 3];
    for mem in [0.0, 0.5, 0.9] {
        c = [0; 3];
        for _ in 0..400 {
            let f = fit(&profile(|_| 0.0, Noise { disk: 0.025, ring: 0.02, memory: mem }, &mut rng));
            c[f.decision as usize] += 1;
        }
        println!("noise {mem} {c:?}");
    }
    let t = std::time::Instant::now();
    let p = profile(screened(0.05, 0.12), WHITE, &mut rng);
    for _ in 0..50 {
        std::hint::black_box(fit(&p));
    }
    println!("{:?}", t.elapsed() / 50);
}
