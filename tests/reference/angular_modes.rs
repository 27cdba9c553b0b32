//! Angular modes: their digits, against the slow twin in 160 bits. What else is known of them is in the files below.

#[path = "../twins/annulus_mode.rs"]
mod annulus_mode;
mod bessel;
mod equation;
mod outcomes;
mod point_force;
mod point_sources;
mod spherical;

use annulus_mode::Twin;
use jamscope::reference::Annulus;
use jamscope::reference::angular_modes::elastic::ElasticMode;
use jamscope::reference::angular_modes::screened::{ScreenedMode, Screening};
use jamscope::reference::angular_modes::{AngularSolution, Complex, ModeAmplitudes, ModeState};

use super::{Worst, annulus};

/// Accuracy claimed for the elastic modes: each bracket sums products of four rounded factors (an exponential 2, a power
/// or a quotient 1 each: 10·2⁻⁵³), keeps at least a third of its larger term, and is divided by another; the power a/r adds
/// 4, the combination of the two 4: (2·30 + 8)·2⁻⁵³ = 7.5·10⁻¹⁵, at the worst.
const CLAIMED_ELASTIC: f64 = 68.0 * 0.5 * f64::EPSILON;

/// Radial alone; equal ones, which have no r^(−n+1) at the inner circle; opposite ones (n = 1: a translation); any phases.
fn boundaries() -> [ModeAmplitudes; 4] {
    [
        ModeAmplitudes::in_phase(1.0, 0.0),
        ModeAmplitudes::in_phase(0.25, 0.25),
        ModeAmplitudes::in_phase(0.25, -0.25),
        ModeAmplitudes { radial: Complex::new(0.3, 0.2), transverse: Complex::new(-0.7, 0.1) },
    ]
}

fn screened(
    annulus: Annulus,
    poisson_ratio: f64,
    screening: Screening,
    mode: u32,
    boundary: ModeAmplitudes,
) -> ScreenedMode {
    ScreenedMode::new(annulus, poisson_ratio, screening, mode, boundary).expect("no pole")
}

fn elastic(annulus: Annulus, poisson_ratio: f64, mode: u32, boundary: ModeAmplitudes) -> ElasticMode {
    ElasticMode::new(annulus, poisson_ratio, mode, boundary).expect("valid")
}

/// Γ_e R² and Γ_o R².
fn screening(annulus: Annulus, even: f64, odd: f64) -> Screening {
    let square = annulus.outer_radius() * annulus.outer_radius();
    Screening { even: even / square, odd: odd / square }
}

fn size(amplitudes: &ModeAmplitudes) -> f64 {
    amplitudes.radial.norm() + amplitudes.transverse.norm()
}

fn apart(a: &ModeAmplitudes, b: &ModeAmplitudes) -> f64 {
    (a.radial - b.radial).norm() + (a.transverse - b.transverse).norm()
}

/// Falling radii across the annulus, even in r and in ln r, and next to both circles.
fn radii(annulus: Annulus, count: usize) -> Vec<f64> {
    let (inner, outer) = (annulus.inner_radius(), annulus.outer_radius());
    let gap = outer - inner;
    let mut radii: Vec<f64> = (1..count)
        .map(|step| step as f64 / count as f64)
        .flat_map(|share| [inner + gap * share, inner * (outer / inner).powf(share)])
        .chain([inner + 1e-7 * gap, outer - 1e-7 * gap])
        .filter(|radius| annulus.contains(*radius))
        .collect();
    radii.sort_by(|a, b| b.total_cmp(a));
    radii
}

/// Length over which a mode changes at a radius: r/n, one over the wavenumber, the way to the rim, the gap.
fn length(annulus: Annulus, mode: u32, screening: Screening, radius: f64) -> f64 {
    let wavenumber = screening.even.hypot(screening.odd).sqrt();
    let rate = f64::from(mode).max(1.0).max(wavenumber * radius);
    (radius / rate).min(annulus.outer_radius() - radius).min(annulus.outer_radius() - annulus.inner_radius())
}

/// The larger relative error of value and derivative: relative to |u| + length |u'|, the amplitude of the oscillation or
/// the decay the value is a point of.
fn error(exact: &ModeState, found: &ModeState, length: f64) -> f64 {
    let scale = size(&exact.value) + length * size(&exact.derivative);
    let (value, slope) = (apart(&exact.value, &found.value), length * apart(&exact.derivative, &found.derivative));
    if value >= slope || value.is_nan() { value / scale } else { slope / scale }
}

#[test]
fn elastic_modes_have_their_digits() {
    let mut worst = Worst::default();
    // R/a, n, ν.
    let cases = [
        (340.0, 0, 0.3),
        (340.0, 1, 0.3),
        (340.0, 7, 0.9),
        (1.0000001, 1, 0.5),
        (1.0000001, 3, 0.999),
        (1.001, 2, 0.3),
        (1.001, 2, 0.999_999_999_9),
        (1.001, 50, 0.999_999_999_9),
        (1.001, 1000, 0.5),
        (1.1, 1000, 0.3),
        (1.3, 2, 0.3),
        (1.5, 2, 0.999_999_999_9),
        (2.2, 1, 0.6),
        (4.0, 40, 0.3),
        (1e7, 1, 0.999_999_99),
        (1e7, 2, -0.99999),
    ];
    for (outer, mode, poisson_ratio) in cases {
        let (annulus, screening) = (annulus(1.0, outer), Screening::default());
        let radii = radii(annulus, 6);
        let twin = Twin { annulus, poisson_ratio, screening, mode };
        for (boundary, exact) in boundaries().into_iter().zip(twin.at(&radii, &boundaries())) {
            let medium = elastic(annulus, poisson_ratio, mode, boundary);
            for (state, &radius) in exact.iter().zip(&radii) {
                let error = error(state, &medium.at(radius), length(annulus, mode, screening, radius));
                worst.take(error / CLAIMED_ELASTIC, || {
                    format!("{error:.1e} at {radius}, R/a {outer}, n {mode}, ν {poisson_ratio}, {boundary:?}")
                });
            }
        }
    }
    // 5 radii in each of two ways, 2 more; 4 boundaries.
    worst.finish("elastic modes", cases.len() * 4 * 12);
}

#[test]
fn a_transverse_displacement_of_a_thin_nearly_incompressible_annulus_loses_digits() {
    // s_a = −d_a, and their factors are some R/((R−a) n) = 500 times as large as the displacement that they leave: a film
    // that can hardly be squeezed.
    let (annulus, mode, poisson_ratio) = (annulus(1.0, 1.001), 2, 0.999_999_999_9);
    let (radii, boundary) = (radii(annulus, 6), ModeAmplitudes::in_phase(0.0, 1.0));
    let twin = Twin { annulus, poisson_ratio, screening: Screening::default(), mode };
    let medium = elastic(annulus, poisson_ratio, mode, boundary);
    let exact = twin.at(&radii, &[boundary]);
    let errors = exact[0]
        .iter()
        .zip(&radii)
        .map(|(state, &radius)| error(state, &medium.at(radius), length(annulus, mode, Screening::default(), radius)));
    let worst = errors.fold(0.0, jamscope::vector::larger);
    println!("largest error {worst:.1e}");
    assert!(worst > CLAIMED_ELASTIC && worst < 500.0 * CLAIMED_ELASTIC, "{worst:.1e}");
}

/// Accuracy claimed for the screened modes: every node rounds a state by a few 2⁻⁵³ (a sum of terms, a projection, a
/// combination), the series to the radius once more; errors of nodes add, and the condition of the boundary values
/// multiplies.
fn claimed_screened(medium: &ScreenedMode) -> f64 {
    f64::EPSILON * (8.0 + medium.node_count() as f64) * medium.condition()
}

fn screened_modes_agree(name: &str, cases: &[(f64, u32, f64)], screenings: &[(f64, f64)]) {
    let (mut worst, mut largest) = (Worst::default(), Worst::default());
    for &(outer, mode, poisson_ratio) in cases {
        for &(even, odd) in screenings {
            let annulus = annulus(1.0, outer);
            let screening = screening(annulus, even, odd);
            let radii = radii(annulus, 4);
            let twin = Twin { annulus, poisson_ratio, screening, mode };
            for (boundary, exact) in boundaries().into_iter().zip(twin.at(&radii, &boundaries())) {
                let medium = screened(annulus, poisson_ratio, screening, mode, boundary);
                for (state, &radius) in exact.iter().zip(&radii) {
                    let error = error(state, &medium.at(radius), length(annulus, mode, screening, radius));
                    let what = || {
                        format!("at {radius}, R/a {outer}, n {mode}, ν {poisson_ratio}, Γ {even}, {odd}, {boundary:?}")
                    };
                    worst.take(error / claimed_screened(&medium), what);
                    largest.take(error, what);
                }
            }
        }
    }
    let count = cases.len() * screenings.len() * 4 * 8;
    largest.finish(&format!("{name}, plain error"), count);
    worst.finish(name, count);
}

#[test]
fn screened_modes_have_the_digits_their_condition_allows() {
    let cases = [(340.0, 0, 0.3), (340.0, 1, 0.3), (340.0, 2, -0.9), (60.0, 7, 0.6), (1e7, 2, 0.3)];
    // Even of either sign, far beyond the first poles, and next to none: no cancellation as Γ → 0.
    screened_modes_agree("even", &cases, &[(16.0, 0.0), (-16.0, 0.0), (1e-13, 0.0), (900.0, 0.0)]);
    let wide = [(340.0, 0, 0.3), (340.0, 3, 0.6), (1e4, 1, -0.9)];
    screened_modes_agree("odd", &wide, &[(1e-10, 50.0), (900.0, -100.0), (-30.0, 5.0)]);
    // Far beyond the first poles.
    screened_modes_agree("waves", &[(40.0, 0, 0.3), (40.0, 2, 0.6)], &[(6400.0, 0.0), (-6400.0, 0.0)]);
    let thin = [(1.0000001, 3, 0.5), (1.001, 0, 0.3), (1.001, 2, 0.999_999_999_9), (1.001, 1000, 0.5), (1.5, 2, 0.3)];
    screened_modes_agree("thin", &thin, &[(16.0, 0.0), (900.0, -100.0), (-9.0, 3.0)]);
    screened_modes_agree("fine", &[(4.0, 40, 0.3), (1.1, 1000, 0.3)], &[(0.0, 0.0), (900.0, 40.0)]);
}

#[test]
fn nearly_incompressible_modes_without_slow_decay_lose_as_said() {
    // ν → 1 and equal amplitudes: u falls as r^(−n−1) and its rotation W vanishes but for rounding of Γ r² u, which then
    // decays more slowly than u: up to |Γ| R² roundings a node.
    let (annulus, mode, poisson_ratio) = (annulus(1.0, 1e7), 1, 0.999_999_99);
    for even in [16.0, 2500.0] {
        let screening = screening(annulus, even, 0.0);
        let boundary = boundaries()[1];
        let radii = radii(annulus, 6);
        let medium = screened(annulus, poisson_ratio, screening, mode, boundary);
        let twin = Twin { annulus, poisson_ratio, screening, mode };
        let claimed = claimed_screened(&medium) * even;
        for (state, &radius) in twin.at(&radii, &[boundary])[0].iter().zip(&radii) {
            let error = error(state, &medium.at(radius), length(annulus, mode, screening, radius));
            assert!(error <= claimed, "{error:.1e} at {radius}, Γ R² {even}");
        }
    }
}

#[test]
fn both_routes_to_the_elastic_modes_meet_where_the_twin_is_too_slow() {
    for (outer, mode) in [(1e7, 100), (30.0, 1000), (3.0, 5000)] {
        let annulus = annulus(1.0, outer);
        for boundary in boundaries() {
            let (closed, series) =
                (elastic(annulus, 0.3, mode, boundary), screened(annulus, 0.3, Screening::default(), mode, boundary));
            // As far out as the displacement is an ordinary number: beyond, both fall to zero.
            let reach = f64::exp(600.0 / f64::from(mode)).min(outer);
            for step in 1..20 {
                let radius = reach.powf(f64::from(step) / 20.0);
                let (one, other) = (closed.at(radius), series.at(radius));
                // Nodes between a and r: (n + 4) ln r.
                let nodes = f64::from(mode + 4) * radius.ln() + 8.0;
                let allowed = CLAIMED_ELASTIC + f64::EPSILON * nodes * series.condition();
                let error = error(&one, &other, radius / f64::from(mode));
                assert!(error <= allowed, "{error:.1e} at {radius}, n {mode}, R/a {outer}");
            }
            let far = closed.at(0.99 * outer);
            assert!(size(&far.value) < 1e-190 && size(&series.at(0.99 * outer).value) < 1e-190, "{far:?}");
        }
    }
}
