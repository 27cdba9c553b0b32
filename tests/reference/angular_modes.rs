//! Angular modes against their slow twin in 160 bits, their limits, and what the equation implies.

#[path = "../twins/annulus_mode.rs"]
mod annulus_mode;

use std::f64::consts::PI;

use annulus_mode::Twin;
use jamscope::reference::angular_modes::elastic::ElasticMode;
use jamscope::reference::angular_modes::screened::{ScreenedMode, Screening};
use jamscope::reference::angular_modes::{AngularModeError, AngularSolution, Complex, ModeAmplitudes, ModeState};
use jamscope::reference::elastic::Elastic;
use jamscope::reference::poles::{pole, pole_count_below};
use jamscope::reference::screened::Screened;
use jamscope::reference::{Annulus, RadialSolution};

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
    let wide = [(340.0, 0, 0.3), (340.0, 3, 0.6), (1e7, 1, -0.9)];
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

#[test]
fn boundary_values_are_exact_and_nothing_is_defined_outside() {
    for (outer, mode) in [(340.0, 0), (340.0, 1), (1.001, 4), (1e7, 30)] {
        let annulus = annulus(1.0, outer);
        for boundary in boundaries() {
            let media: [&dyn AngularSolution; 3] = [
                &elastic(annulus, 0.3, mode, boundary),
                &screened(annulus, 0.3, screening(annulus, 30.0, 0.0), mode, boundary),
                &screened(annulus, 0.3, screening(annulus, -30.0, 11.0), mode, boundary),
            ];
            for medium in media {
                assert_eq!(medium.mode(), mode);
                assert_eq!(medium.at(1.0).value, boundary);
                assert_eq!(size(&medium.at(outer).value), 0.0);
                for radius in [0.999, outer * 1.001, f64::NAN] {
                    let state = medium.at(radius);
                    for amplitude in [
                        state.value.radial,
                        state.value.transverse,
                        state.derivative.radial,
                        state.derivative.transverse,
                    ] {
                        assert!(amplitude.re.is_nan() && amplitude.im.is_nan(), "{amplitude} at {radius}");
                    }
                }
            }
        }
    }
}

#[test]
fn inflation_and_torsion_are_the_radial_solution() {
    for (inner, outer) in [(0.5, 42.0), (1.0, 1.001), (1e-3, 1e4)] {
        let annulus = annulus(inner, outer);
        let boundary = ModeAmplitudes { radial: Complex::new(1.0, 0.0), transverse: Complex::new(-0.5, 0.25) };
        let (mode, radial) = (elastic(annulus, 0.3, 0, boundary), Elastic::<2>::new(annulus, 1.0).expect("valid"));
        for radius in radii(annulus, 20) {
            let state = mode.at(radius);
            // Powers of two: bit for bit.
            let (value, slope) = (radial.value(radius), radial.derivative(radius));
            assert_eq!(state.value.radial, Complex::new(value, 0.0));
            assert_eq!(state.value.transverse, Complex::new(-0.5 * value, 0.25 * value));
            assert_eq!(state.derivative.radial, Complex::new(slope, 0.0));
            assert_eq!(state.derivative.transverse, Complex::new(-0.5 * slope, 0.25 * slope));
        }
    }
}

#[test]
fn screened_inflation_is_the_bessel_profile() {
    for (inner, outer) in [(0.5, 170.0), (1.0, 1.3), (1e-3, 10.0)] {
        let annulus = annulus(inner, outer);
        for argument in [1e-6, 0.3, 2.0, 5.0, 12.0, 60.0, 400.0] {
            let wavenumber = argument / outer;
            let bessel = Screened::<2>::new(annulus, 0.1, wavenumber).expect("no pole");
            for poisson_ratio in [-0.5, 0.3, 0.8] {
                let screening = Screening::from_wavenumber(wavenumber, poisson_ratio);
                let mode = screened(annulus, poisson_ratio, screening, 0, ModeAmplitudes::in_phase(0.1, 0.0));
                let below = pole_count_below::<2>(annulus, wavenumber);
                let condition: f64 = [below, below + 1]
                    .into_iter()
                    .filter(|&index| index > 0)
                    .map(|index| pole::<2>(annulus, index))
                    .fold(1.0, |sum, pole| sum + pole / (wavenumber - pole).abs());
                for radius in radii(annulus, 8) {
                    let (value, slope) = (bessel.value(radius), bessel.derivative(radius));
                    let length = radius.min(1.0 / wavenumber).min(outer - radius);
                    let state = mode.at(radius);
                    // Γ_e is rounded three times, which moves κ by 2·2⁻⁵³.
                    let allowed = claimed_screened(&mode) + (3.2e-15 + f64::EPSILON) * condition;
                    let error = (state.value.radial.re - value).abs() / (value.abs() + length * slope.abs());
                    assert!(error < allowed, "{error:.1e}, {allowed:.1e} at {radius}, κ {wavenumber}, {annulus:?}");
                    assert_eq!((state.value.radial.im, size(&state.value)), (0.0, state.value.radial.re.abs()));
                }
            }
        }
    }
}

#[test]
fn screened_modes_tend_to_elastic_ones_in_proportion_to_the_screening() {
    for mode in [0, 1, 2, 9] {
        let annulus = annulus(0.5, 170.0);
        let boundary = boundaries()[3];
        let rest = elastic(annulus, 0.3, mode, boundary);
        let difference = |even: f64, odd: f64, radius: f64| {
            let state = screened(annulus, 0.3, screening(annulus, even, odd), mode, boundary).at(radius).value;
            let rest = rest.at(radius).value;
            [state.radial - rest.radial, state.transverse - rest.transverse].map(|z| z / size(&rest))
        };
        for radius in [1.0, 40.0, 165.0] {
            for (even, odd) in [(1e-4, 0.0), (0.0, 1e-4)] {
                let (one, two) = (difference(even, odd, radius), difference(2.0 * even, 2.0 * odd, radius));
                for (one, two) in one.into_iter().zip(two) {
                    // The next order is (Γ R²)² < 4·10⁻⁸ of u; rounding as claimed, some 30 nodes: 10⁻¹³.
                    assert!((two - one * 2.0).norm() < 4e-8, "{one}, {two} at {radius}, n {mode}");
                    assert!(one.norm() < 1e-4, "{one} at {radius}, n {mode}");
                }
            }
            // Γ R² = 10⁻³⁰ changes nothing, and loses nothing.
            let nothing = difference(1e-30, 1e-30, radius);
            assert!(nothing.iter().all(|z| z.norm() < 1e-13), "{nothing:?} at {radius}, n {mode}");
        }
    }
}

/// The displacement in Cartesian components at a point.
fn cartesian(medium: &dyn AngularSolution, [x, y]: [f64; 2]) -> [f64; 2] {
    let (radius, angle) = (x.hypot(y), y.atan2(x));
    let [radial, transverse] = medium.displacement(radius, angle);
    let (sine, cosine) = angle.sin_cos();
    [radial * cosine - transverse * sine, radial * sine + transverse * cosine]
}

#[test]
fn the_displacement_solves_the_equation_in_cartesian_coordinates() {
    // Independent of polar coordinates, of signs in them, and of what "cos and sin" mean: second differences of u(x, y).
    let (annulus, poisson_ratio) = (annulus(1.0, 3.0), 0.4);
    let ratio = 2.0 / (1.0 - poisson_ratio);
    for mode in [0, 1, 2, 5] {
        for (even, odd) in [(0.0, 0.0), (40.0, 0.0), (-40.0, 0.0), (20.0, 15.0), (0.0, -30.0)] {
            let screening = screening(annulus, even, odd);
            let boundary = boundaries()[3];
            let screened_mode = screened(annulus, poisson_ratio, screening, mode, boundary);
            let elastic_mode = elastic(annulus, poisson_ratio, mode, boundary);
            let mut media: Vec<&dyn AngularSolution> = vec![&screened_mode];
            if screening == Screening::default() {
                media.push(&elastic_mode);
            }
            for medium in media {
                for (radius, angle) in [(1.3_f64, 0.4_f64), (2.0, 2.1), (2.7, -1.2)] {
                    let (x, y) = (radius * angle.cos(), radius * angle.sin());
                    let h = 1e-3;
                    let u = |i: i32, j: i32| cartesian(medium, [x + f64::from(i) * h, y + f64::from(j) * h]);
                    // Second derivatives to fourth order: (−1, 16, −30, 16, −1)/12 h², mixed by Richardson's rule.
                    let straight = |c: usize, i: i32, j: i32| {
                        (16.0 * (u(i, j)[c] + u(-i, -j)[c])
                            - u(2 * i, 2 * j)[c]
                            - u(-2 * i, -2 * j)[c]
                            - 30.0 * u(0, 0)[c])
                            / (12.0 * h * h)
                    };
                    let mixed = |c: usize, m: i32| {
                        (u(m, m)[c] - u(m, -m)[c] - u(-m, m)[c] + u(-m, -m)[c]) / (4.0 * h * h * f64::from(m * m))
                    };
                    let cross = |c: usize| (4.0 * mixed(c, 1) - mixed(c, 2)) / 3.0;
                    let [[xx, yy], [xx_y, yy_y]] = [0, 1].map(|c| [straight(c, 1, 0), straight(c, 0, 1)]);
                    let here = u(0, 0);
                    let residual = [
                        xx + yy + (ratio - 1.0) * (xx + cross(1)) + screening.even * here[0] - screening.odd * here[1],
                        xx_y + yy_y
                            + (ratio - 1.0) * (yy_y + cross(0))
                            + screening.odd * here[0]
                            + screening.even * here[1],
                    ];
                    // Sixth derivatives are up to (n+6)!/n! and 40³ times u, times h⁴/90: 10⁻⁸; rounding 10⁻¹⁵·64/h².
                    let scale = ratio * (1.0 + f64::from(mode * mode)) * here[0].hypot(here[1]).max(0.01);
                    let worst = residual[0].hypot(residual[1]);
                    assert!(worst < 1e-6 * scale, "{worst:.1e} of {scale} at {radius}, n {mode}, Γ {even}, {odd}");
                }
            }
        }
    }
}

#[test]
fn dilation_and_rotation_are_bessel_functions_of_their_wavenumbers() {
    // ∇·u solves Helmholtz's equation with k_L² = Γ/(λ+2μ), ∇×u with k_T² = Γ/μ: two radii give the multiples of J_n and
    // Y_n, a third is predicted.
    let (annulus, poisson_ratio, mode) = (annulus(1.0, 3.0), 0.4, 2_u32);
    for even in [30.0, 120.0] {
        let screening = screening(annulus, even, 0.0);
        let medium = screened(annulus, poisson_ratio, screening, mode, boundaries()[3]);
        let parts = |radius: f64| {
            let state = medium.at(radius);
            let along = Complex::new(0.0, f64::from(mode) / radius);
            let dilation = state.derivative.radial + state.value.radial / radius + state.value.transverse * along;
            let rotation = state.derivative.transverse + state.value.transverse / radius - state.value.radial * along;
            [dilation, rotation]
        };
        let wavenumbers = [(0.5 * (1.0 - poisson_ratio) * screening.even).sqrt(), screening.even.sqrt()];
        for (part, wavenumber) in wavenumbers.into_iter().enumerate() {
            let basis =
                |radius: f64| [libm::jn(mode as i32, wavenumber * radius), libm::yn(mode as i32, wavenumber * radius)];
            let (one, two) = (1.2, 1.9);
            let (first, second) = (basis(one), basis(two));
            let determinant = first[0] * second[1] - first[1] * second[0];
            let (left, right) = (parts(one)[part], parts(two)[part]);
            let regular = (left * second[1] - right * first[1]) / determinant;
            let singular = (right * first[0] - left * second[0]) / determinant;
            for radius in [1.0, 1.5, 2.4, 3.0] {
                let [j, y] = basis(radius);
                let (predicted, found) = (regular * j + singular * y, parts(radius)[part]);
                // Condition of the two equations: |products|/determinant, below 10² for these radii; libm to 10⁻¹⁵.
                let scale = left.norm() + right.norm();
                assert!(
                    (predicted - found).norm() < 1e-12 * scale,
                    "{predicted}, not {found} at {radius}, part {part}"
                );
            }
        }
    }
}

/// The displacement at `radius` by the four Bessel functions J_n, Y_n of k_L r and k_T r as they stand: `φ cos nθ` gives
/// U = φ', V = −nφ/r, `ψ sin nθ` gives U = nψ/r, V = −ψ'; four boundary values, elimination with pivots.
fn by_potentials(
    annulus: Annulus,
    poisson_ratio: f64,
    even: f64,
    mode: i32,
    boundary: [f64; 2],
    radius: f64,
) -> [f64; 2] {
    let n = f64::from(mode);
    let wavenumbers = [(0.5 * (1.0 - poisson_ratio) * even).sqrt(), even.sqrt()];
    let columns = |radius: f64| -> [[f64; 2]; 4] {
        std::array::from_fn(|column| {
            let wavenumber = wavenumbers[column / 2];
            let bessel = |order: i32| {
                let x = wavenumber * radius;
                if column % 2 == 0 { libm::jn(order, x) } else { libm::yn(order, x) }
            };
            let (value, slope) = (bessel(mode) / radius, 0.5 * wavenumber * (bessel(mode - 1) - bessel(mode + 1)));
            if column < 2 { [slope, -n * value] } else { [n * value, -slope] }
        })
    };
    let (at_inner, at_outer) = (columns(annulus.inner_radius()), columns(annulus.outer_radius()));
    // Columns scaled by what they are where they are largest.
    let scale: [f64; 4] = std::array::from_fn(|c| {
        [at_inner[c], at_outer[c]].iter().flatten().fold(0.0, |largest: f64, x| largest.max(x.abs()))
    });
    let mut rows: [[f64; 5]; 4] = std::array::from_fn(|row| {
        let (columns, wanted) = if row < 2 { (&at_inner, boundary[row]) } else { (&at_outer, 0.0) };
        std::array::from_fn(|c| if c == 4 { wanted } else { columns[c][row % 2] / scale[c] })
    });
    for step in 0..4 {
        let pivot = (step..4).max_by(|&i, &j| rows[i][step].abs().total_cmp(&rows[j][step].abs())).expect("a row");
        rows.swap(step, pivot);
        let lead = rows[step];
        for (index, row) in rows.iter_mut().enumerate() {
            if index != step {
                let factor = row[step] / lead[step];
                for c in step..5 {
                    row[c] -= factor * lead[c];
                }
            }
        }
    }
    let here = columns(radius);
    [0, 1].map(|i| (0..4).map(|c| here[c][i] / scale[c] * rows[c][4] / rows[c][c]).sum())
}

#[test]
fn four_bessel_functions_as_they_stand_agree_and_lose_digits() {
    let worst = |outer: f64, argument: f64| {
        let (annulus, boundary) = (annulus(1.0, outer), [1.0, 0.3]);
        let even = (argument / outer).powi(2);
        let screening = Screening { even, odd: 0.0 };
        let medium = screened(annulus, 0.3, screening, 2, ModeAmplitudes::in_phase(boundary[0], boundary[1]));
        // Next to the rim they cancel besides.
        let inside = radii(annulus, 8).into_iter().filter(|&radius| radius < 0.95 * outer);
        inside.fold(0.0, |worst: f64, radius| {
            let [radial, transverse] = by_potentials(annulus, 0.3, even, 2, boundary, radius);
            let state = medium.at(radius);
            let scale = size(&state.value) + length(annulus, 2, screening, radius) * size(&state.derivative);
            // V sin nθ is the amplitude −iV.
            let error = (state.value.radial.re - radial).abs() + (state.value.transverse.im + transverse).abs();
            worst.max(error / scale)
        })
    };
    // κa of order one: condition of the four equations some 10², libm to 10⁻¹⁵.
    let close = worst(3.0, 9.0);
    assert!(close < 1e-13, "{close:.1e}");
    // The singular pair of κa ≪ 1 differs by (κa)² of itself: digits lost as (κa)⁻², 10⁴ and 10⁹ times 10⁻¹⁶ and more.
    let (fewer, few) = (worst(340.0, 4.0), worst(1e5, 4.0));
    println!("four Bessel functions: {close:.1e} at κa = 3, {fewer:.1e} at 4/340, {few:.1e} at 4·10⁻⁵");
    assert!(fewer > 1e-13 && fewer < 1e-10, "{fewer:.1e}");
    assert!(few > 1e-9 && few < 1e-5, "{few:.1e}");
}

/// Tractions σ_rr/μ and σ_rθ/μ on the circle through `radius`.
fn tractions(medium: &dyn AngularSolution, poisson_ratio: f64, radius: f64) -> [Complex<f64>; 2] {
    let state = medium.at(radius);
    let along = Complex::new(0.0, f64::from(medium.mode()) / radius);
    let ratio = 2.0 / (1.0 - poisson_ratio);
    let hoop = state.value.radial / radius + state.value.transverse * along;
    [
        (state.derivative.radial + hoop) * (ratio - 2.0) + state.derivative.radial * 2.0,
        state.derivative.transverse - state.value.transverse / radius + state.value.radial * along,
    ]
}

#[test]
fn work_is_reciprocal_between_media_of_opposite_odd_screening() {
    // Betti: t_1·u_2 = t_2·u_1 on the inner circle, medium 2 having the transposed Γ. With the same odd Γ it fails.
    let (annulus, poisson_ratio) = (annulus(1.0, 5.0), 0.2);
    for mode in [0, 1, 4] {
        for (even, odd) in [(0.0, 0.0), (60.0, 0.0), (20.0, 35.0)] {
            let work = |one: ModeAmplitudes, odd: f64, two: ModeAmplitudes| {
                let medium = screened(annulus, poisson_ratio, screening(annulus, even, odd), mode, one);
                let [radial, transverse] = tractions(&medium, poisson_ratio, 1.0);
                (radial * two.radial.conj() + transverse * two.transverse.conj()).re
            };
            let [one, _, _, two] = boundaries();
            let (there, back, same) = (work(one, odd, two), work(two, -odd, one), work(two, odd, one));
            // Derivatives to some 20 roundings each, condition below 10.
            assert!((there - back).abs() < 1e-13 * (there.abs() + 1.0), "{there}, {back}: n {mode}, Γ {even}, {odd}");
            let broken = (there - same).abs() > 1e-3;
            assert_eq!(broken, odd != 0.0, "{there}, {same}: n {mode}, Γ {even}, {odd}");
        }
    }
}

#[test]
fn a_moved_disk_needs_the_force_of_the_closed_form() {
    // n = 1, translation by u: the force is the same on every circle, and in plane strain with ν₃, a and R
    // F = 8π μ (1−ν₃) u / [(3−4ν₃) ln(R/a) − (R²−a²)/((3−4ν₃)(R²+a²))], by hand from the logarithm and the powers of n = 1.
    for material_ratio in [0.1, 0.3, 0.49] {
        for (inner, outer) in [(0.5, 170.0), (1.0, 1.5)] {
            let annulus = annulus(inner, outer);
            let poisson_ratio = material_ratio / (1.0 - material_ratio);
            let medium = elastic(annulus, poisson_ratio, 1, ModeAmplitudes::in_phase(1.0, -1.0));
            let kappa = 3.0 - 4.0 * material_ratio;
            let (a, b) = (inner * inner, outer * outer);
            let force =
                8.0 * PI * (1.0 - material_ratio) / (kappa * (outer / inner).ln() - (b - a) / (kappa * (b + a)));
            for radius in [inner, 0.5 * (inner + outer), outer] {
                let [radial, transverse] = tractions(&medium, poisson_ratio, radius);
                // ∮ (σ_rr cos θ − σ_rθ sin θ) r dθ, with σ_rr ∝ cos θ, σ_rθ = Re[−i s e^(iθ)] = s sin θ.
                let found = -PI * radius * (radial.re + transverse.im);
                // Stresses subtract derivatives up to (λ+2μ)/μ < 52 times as large.
                assert!((found / force - 1.0).abs() < 52.0 * CLAIMED_ELASTIC, "{found}, not {force} at {radius}");
            }
        }
    }
}

#[test]
fn a_phase_turns_the_pattern() {
    let annulus = annulus(0.5, 170.0);
    for mode in [0, 1, 3, 800] {
        let turn = 0.7;
        let boundary = boundaries()[3];
        for screening in [Screening::default(), screening(annulus, 20.0, -7.0)] {
            let medium = screened(annulus, 0.3, screening, mode, boundary);
            let turned = screened(annulus, 0.3, screening, mode, boundary.rotated(mode, turn));
            for radius in [0.5, 0.501, 0.7] {
                let ([radial, transverse], [there, across]) =
                    (medium.displacement(radius, 1.1 - turn), turned.displacement(radius, 1.1));
                // 1.1 − 0.7 is rounded by 2⁻⁵⁴, n times that in the phase.
                let scale = size(&medium.at(radius).value) * (40.0 + f64::from(mode)) * f64::EPSILON;
                assert!((radial - there).abs() + (transverse - across).abs() < 4.0 * scale, "n {mode} at {radius}");
            }
        }
    }
    // cos nθ and sin nθ, by name.
    let [radial, transverse] = ModeAmplitudes::in_phase(2.0, 3.0).at_angle(2, 0.3);
    assert!((radial - 2.0 * 0.6_f64.cos()).abs() < 1e-15 && (transverse - 3.0 * 0.6_f64.sin()).abs() < 1e-15);
}

#[test]
fn odd_screening_turns_inflation() {
    // Radial inflation alone: transverse displacement, of the sign of the odd screening, real amplitudes.
    let annulus = annulus(0.5, 170.0);
    let inflation = ModeAmplitudes::in_phase(0.1, 0.0);
    let across = |odd: f64| {
        let state = screened(annulus, 0.3, screening(annulus, 6.0, odd), 0, inflation).at(60.0).value;
        assert_eq!((state.radial.im, state.transverse.im), (0.0, 0.0));
        [state.radial.re, state.transverse.re]
    };
    let (none, left, right) = (across(0.0), across(3.0), across(-3.0));
    assert_eq!(none[1], 0.0);
    // A mirror image: the same radial part, the opposite transverse one.
    assert_eq!([left[0], -left[1]], right);
    assert!(left[1].abs() > 0.01 * left[0].abs(), "{left:?}");
}

#[test]
fn poles_are_outcomes() {
    // n = 0: the pole of the Bessel profile.
    let here = annulus(0.5, 170.0);
    let boundary = ModeAmplitudes::in_phase(0.1, 0.0);
    let at = |even: f64, mode: u32, boundary: ModeAmplitudes| {
        ScreenedMode::new(here, 0.3, Screening { even, odd: 0.0 }, mode, boundary)
    };
    let square = Screening::from_wavenumber(pole::<2>(here, 1), 0.3).even;
    for away in [1e-2, 1e-4, 1e-6, 1e-9] {
        let medium = at(square * (1.0 + away), 0, boundary).expect("not at the pole");
        let ratio = medium.condition() * away;
        assert!(ratio > 0.2 && ratio < 2.0, "{} at {away}", medium.condition());
        // What the condition leaves is there: κ = √(ε Γ), rounded by 2⁻⁵², its condition 2/away.
        let bessel = Screened::<2>::new(here, 0.1, (0.35 * square * (1.0 + away)).sqrt()).expect("not at the pole");
        let allowed = claimed_screened(&medium) + (3.2e-15 + f64::EPSILON) * 2.0 / away;
        for radius in [1.0, 30.0, 100.0, 160.0] {
            let (found, exact) = (medium.at(radius).value.radial.re, bessel.value(radius));
            assert!((found / exact - 1.0).abs() < allowed, "{found}, not {exact} at {radius}, {away}");
        }
    }
    let nearest = (-4..=4).map(|step| square * (1.0 + f64::from(step) * f64::EPSILON));
    let refused =
        nearest.filter(|&even| matches!(at(even, 0, boundary), Err(AngularModeError::AtPole { mode: 0, .. })));
    assert!(refused.count() > 0, "the first pole of inflation");

    // n = 2: bisection on the sign of the slope at the rim ends at a number that is refused by name.
    let slope = |even: f64| at(even, 2, boundary).map(|medium| medium.at(170.0).derivative.radial.re);
    let (mut low, mut high) = (1e-4, 2e-3);
    let sign = slope(low).expect("not at a pole") > 0.0;
    assert_ne!(sign, slope(high).expect("not at a pole") > 0.0, "a pole lies between");
    let refused = loop {
        let middle = 0.5 * (low + high);
        match slope(middle) {
            Err(error) => break Some(error),
            Ok(slope) if (slope > 0.0) == sign => low = middle,
            Ok(_) => high = middle,
        }
        if high - low <= f64::EPSILON * low {
            break None;
        }
    };
    assert!(
        matches!(refused, Some(AngularModeError::AtPole { mode: 2, condition }) if condition > 1e12),
        "{refused:?}"
    );
}

#[test]
fn bad_arguments_are_named() {
    let annulus = annulus(0.5, 170.0);
    let boundary = ModeAmplitudes::in_phase(0.1, 0.0);
    for ratio in [-1.0, 1.0, 2.0, f64::NAN, f64::INFINITY] {
        let error = ElasticMode::new(annulus, ratio, 2, boundary).expect_err("outside");
        assert!(matches!(error, AngularModeError::PoissonRatioOutside { .. }), "{error}");
        let error = ScreenedMode::new(annulus, ratio, Screening::default(), 2, boundary).expect_err("outside");
        assert!(matches!(error, AngularModeError::PoissonRatioOutside { .. }), "{error}");
    }
    for bad in [f64::NAN, f64::INFINITY] {
        for boundary in [ModeAmplitudes::in_phase(bad, 0.0), ModeAmplitudes::in_phase(0.0, bad)] {
            let error = ElasticMode::new(annulus, 0.3, 2, boundary).expect_err("not finite");
            assert!(matches!(error, AngularModeError::AmplitudeNotFinite { .. }), "{error}");
        }
        for screening in [Screening { even: bad, odd: 0.0 }, Screening { even: 0.0, odd: bad }] {
            let error = ScreenedMode::new(annulus, 0.3, screening, 2, boundary).expect_err("not finite");
            assert!(matches!(error, AngularModeError::ScreeningNotFinite { .. }), "{error}");
        }
    }
    for (even, mode) in [(1e7, 2), (1e300, 2), (0.0, 100_000)] {
        let screening = Screening { even, odd: 0.0 };
        let error = ScreenedMode::new(annulus, 0.3, screening, mode, boundary).expect_err("too fine");
        assert!(matches!(error, AngularModeError::TooManyNodes { .. }), "{error}");
    }
}
