//! What the equation of the angular modes implies, away from how they are computed: itself in Cartesian coordinates,
//! reciprocity, forces, symmetry.

use std::f64::consts::PI;

use jamscope::reference::angular_modes::screened::Screening;
use jamscope::reference::angular_modes::{AngularSolution, Complex, ModeAmplitudes};

use super::{CLAIMED_ELASTIC, boundaries, elastic, screened, screening, size};
use crate::annulus;

/// The displacement in Cartesian components at a point.
pub(super) fn cartesian(medium: &dyn AngularSolution, [x, y]: [f64; 2]) -> [f64; 2] {
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
