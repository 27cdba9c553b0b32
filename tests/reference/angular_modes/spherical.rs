//! Angular modes of an elastic shell: their digits, the equation in Cartesian coordinates, and what is known in closed
//! form.

use std::f64::consts::PI;

use jamscope::reference::angular_modes::AngularModeError;
use jamscope::reference::angular_modes::spherical::{SphericalAmplitudes, SphericalMode};
use jamscope::reference::elastic::Elastic;
use jamscope::reference::{Annulus, RadialSolution};
use jamscope::vector::{difference, norm, scaled};
use serde_json::Value;

use crate::{Worst, annulus, fixture, number, rows};

/// The kernels are those of the plane, and so is the number of their roundings (`CLAIMED_ELASTIC`). The combination of U
/// and V adds a product each, covered by the four counted there.
const CLAIMED: f64 = 68.0 * 0.5 * f64::EPSILON;

fn mode(annulus: Annulus, poisson_ratio: f64, degree: u32, boundary: SphericalAmplitudes) -> SphericalMode {
    SphericalMode::new(annulus, poisson_ratio, degree, boundary).expect("valid")
}

fn spheroidal(radial: f64, gradient: f64) -> SphericalAmplitudes {
    SphericalAmplitudes { radial, gradient, toroidal: 0.0 }
}

const TORSION: SphericalAmplitudes = SphericalAmplitudes { radial: 0.0, gradient: 0.0, toroidal: 1.0 };

#[test]
fn modes_of_a_shell_have_their_digits() {
    let file = fixture("spherical_modes.json");
    let [mut spheroidal_worst, mut plain_worst, mut toroidal_worst] = [(); 3].map(|()| Worst::default());
    let mut largest = 0.0_f64;
    for row in rows(&file) {
        let degree = row[1].as_u64().expect("a degree") as u32;
        let [outer, ratio, radius] = [0, 2, 3].map(|column| number(&row[column]));
        let (annulus, l) = (annulus(0.5, outer), f64::from(degree));
        // Length over which a mode changes.
        let length = (radius / l).min(outer - radius).min(outer - 0.5);
        let root = (l * (l + 1.0)).sqrt();
        let error = |exact: [f64; 4], found: [f64; 4]| {
            let [value, slope] =
                [0, 2].map(|k| (exact[k] - found[k]).abs() + root * (exact[k + 1] - found[k + 1]).abs());
            let [size, change] = [0, 2].map(|k| exact[k].abs() + root * exact[k + 1].abs());
            // NaN stays.
            (value + length * slope) / (size + length * change)
        };
        for (boundary, first) in [(spheroidal(1.0, 0.0), 4), (spheroidal(0.0, 1.0), 8)] {
            let exact = [0, 1, 2, 3].map(|k| number(&row[first + k]));
            let medium = mode(annulus, ratio, degree, boundary);
            let (state, condition) = (medium.at(radius), medium.condition(radius));
            let (value, slope) = (state.value, state.derivative);
            let error = error(exact, [value.radial, value.gradient, slope.radial, slope.gradient]);
            spheroidal_worst
                .take(error / CLAIMED / condition, || format!("{error:.1e}, condition {condition:.1}: {row}"));
            if condition < 10.0 {
                plain_worst.take(error / CLAIMED, || format!("{error:.1e}, condition {condition:.1}: {row}"));
            }
            largest = largest.max(error);
            assert_eq!((value.toroidal, slope.toroidal), (0.0, 0.0));
        }
        let [exact, exact_slope] = [12, 13].map(|column| number(&row[column]));
        let state = mode(annulus, ratio, degree, TORSION).at(radius);
        let error = error([exact, 0.0, exact_slope, 0.0], [state.value.toroidal, 0.0, state.derivative.toroidal, 0.0]);
        toroidal_worst.take(error / CLAIMED, || format!("{error:.1e}: {row}, torsion"));
        assert_eq!((state.value.radial, state.value.gradient), (0.0, 0.0));
    }
    let count = file["rows"].as_array().map_or(0, Vec::<Value>::len);
    assert_eq!(count, 144);
    println!("largest error {largest:.1e}");
    spheroidal_worst.finish("spheroidal modes", 2 * count);
    let plain_count = plain_worst.count;
    plain_worst.finish("spheroidal modes of condition below 10", plain_count);
    assert!(plain_count > count, "{plain_count}");
    toroidal_worst.finish("toroidal modes", count);
}

/// A harmonic polynomial of this degree and its gradient.
fn solid_harmonic(degree: u32, [x, y, z]: [f64; 3]) -> (f64, [f64; 3]) {
    match degree {
        0 => (1.0, [0.0; 3]),
        1 => (0.6 * x - 0.3 * y + z, [0.6, -0.3, 1.0]),
        2 => (x * y + z * z - 0.5 * (x * x + y * y), [y - x, x - y, 2.0 * z]),
        3 => (x * y * z + z * (2.0 * z * z - 3.0 * x * x - 3.0 * y * y), {
            [y * z - 6.0 * x * z, x * z - 6.0 * y * z, x * y + 6.0 * z * z - 3.0 * x * x - 3.0 * y * y]
        }),
        _ => unreachable!("up to 3"),
    }
}

/// The displacement in Cartesian components at a point.
fn cartesian(medium: &SphericalMode, point: [f64; 3]) -> [f64; 3] {
    let radius = norm(point);
    let direction = scaled(1.0 / radius, point);
    let (harmonic, gradient) = solid_harmonic(medium.degree(), direction);
    // ∇ of r^ℓ Y at r = 1 is ℓ Y r̂ + ∇Y.
    let along: [f64; 3] = std::array::from_fn(|d| gradient[d] - f64::from(medium.degree()) * harmonic * direction[d]);
    medium.at(radius).value.along(direction, harmonic, along)
}

#[test]
fn the_displacement_of_a_shell_solves_the_equation_in_cartesian_coordinates() {
    let (annulus, h) = (annulus(1.0, 3.0), 2e-3);
    let (mut largest, mut smallest_broken) = (0.0_f64, f64::INFINITY);
    for degree in 0..=3 {
        for ratio in [-0.6, 0.1, 0.3, 0.49] {
            let medium =
                mode(annulus, ratio, degree, SphericalAmplitudes { radial: 0.4, gradient: -0.7, toroidal: 0.3 });
            for point in [[0.8, 0.7, 0.9], [-1.2, 0.4, 1.1], [0.5, -1.9, -1.6]] {
                let u =
                    |shift: [i32; 3]| cartesian(&medium, std::array::from_fn(|d| point[d] + f64::from(shift[d]) * h));
                let unit = |a: usize, k: i32| -> [i32; 3] { std::array::from_fn(|d| if d == a { k } else { 0 }) };
                let both = |a: usize, b: usize, i: i32, j: i32| -> [i32; 3] {
                    std::array::from_fn(|d| {
                        if d == a {
                            i
                        } else if d == b {
                            j
                        } else {
                            0
                        }
                    })
                };
                let here = u([0; 3]);
                // ∂_a ∂_b u_c to fourth order: (−1, 16, −30, 16, −1)/12 h², mixed by Richardson's rule.
                let second = |a: usize, b: usize, c: usize| {
                    if a == b {
                        let pair = |k: i32| u(unit(a, k))[c] + u(unit(a, -k))[c];
                        return (16.0 * pair(1) - pair(2) - 30.0 * here[c]) / (12.0 * h * h);
                    }
                    let mixed = |m: i32| {
                        let at = |i: i32, j: i32| u(both(a, b, i * m, j * m))[c];
                        (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / (4.0 * h * h * f64::from(m * m))
                    };
                    (4.0 * mixed(1) - mixed(2)) / 3.0
                };
                let residual = |ratio: f64| -> f64 {
                    let dilation = 1.0 / (1.0 - 2.0 * ratio);
                    let component = |c: usize| -> f64 {
                        let laplacian: f64 = (0..3).map(|a| second(a, a, c)).sum();
                        laplacian + dilation * (0..3).map(|a| second(a, c, a)).sum::<f64>()
                    };
                    norm([component(0), component(1), component(2)])
                };
                // Sixth derivatives are up to (ℓ+8)!/(ℓ+1)!/r⁶ < 10⁶ times u, times h⁴/90 < 2·10⁻¹³; rounding 10⁻¹⁵·64/h².
                let scale = norm(here).max(0.01) / (1.0 - 2.0 * ratio);
                let found = residual(ratio) / scale;
                assert!(found < 1e-6, "{found:.1e} at {point:?}, ℓ {degree}, ν {ratio}");
                largest = largest.max(found);
                if degree > 0 {
                    smallest_broken = smallest_broken.min(residual(ratio - 0.05) / scale);
                }
            }
        }
    }
    println!("largest residual {largest:.1e}, with a wrong ν at least {smallest_broken:.1e}");
    // The same differences see a ν that is off by a twentieth.
    assert!(smallest_broken > 1e-4, "{smallest_broken:.1e}");
}

#[test]
fn inflation_of_a_sphere_is_the_elastic_shell_for_any_poisson_ratio() {
    let annulus = annulus(0.5, 42.0);
    let shell = Elastic::<3>::new(annulus, 0.1).expect("valid");
    for ratio in [-0.9, 0.2, 0.4999] {
        // The other amplitudes have no meaning for ℓ = 0.
        let medium = mode(annulus, ratio, 0, SphericalAmplitudes { radial: 0.1, gradient: 3.0, toroidal: 5.0 });
        for radius in [0.5, 0.6, 7.0, 41.9, 42.0] {
            let state = medium.at(radius);
            assert_eq!(state.value, spheroidal(shell.value(radius), 0.0));
            assert_eq!(state.derivative, spheroidal(shell.derivative(radius), 0.0));
        }
    }
}

#[test]
fn a_moved_sphere_needs_the_force_of_the_closed_form() {
    // ℓ = 1, Y = cos θ, U_a = V_a = 1. In the infinite medium F = 24π μ (1−ν) a/(5−6ν); a rim adds a relative a/R.
    for ratio in [-0.5, 0.1, 0.3, 0.49] {
        for outer in [1.5, 50.0, 1e6] {
            let medium = mode(annulus(0.5, outer), ratio, 1, spheroidal(1.0, 1.0));
            let force = |radius: f64| {
                let state = medium.at(radius);
                let (value, slope) = (state.value, state.derivative);
                let dilation = slope.radial + 2.0 * (value.radial - value.gradient) / radius;
                let normal = 2.0 * ratio / (1.0 - 2.0 * ratio) * dilation + 2.0 * slope.radial;
                let shear = slope.gradient + (value.radial - value.gradient) / radius;
                // Means over the sphere: cos²θ 1/3, sin²θ 2/3.
                -4.0 * PI * radius * radius * (normal + 2.0 * shear) / 3.0
            };
            let at_disk = force(0.5);
            for radius in [0.7, 1.2, 1.5] {
                // Stresses subtract derivatives up to (λ+2μ)/μ = 51 times as large, in a sum of six.
                let off = (force(radius) / at_disk - 1.0).abs();
                assert!(off < 6.0 * 51.0 * CLAIMED, "{off:.1e} at {radius}, ν {ratio}, R {outer}");
            }
            let infinite = 24.0 * PI * (1.0 - ratio) * 0.5 / (5.0 - 6.0 * ratio);
            let beyond = at_disk / infinite - 1.0;
            // Confinement: a/R times at most 5/2 at R/a = 100 and more; always stiffer.
            assert!(beyond > 0.0 && (outer < 2.0 || beyond < 3.0 * 0.5 / outer), "{beyond:.2e}, ν {ratio}, R {outer}");
        }
    }
}

#[test]
fn boundaries_are_exact_and_high_degrees_finite() {
    for degree in [0, 1, 2, 3, 50, 4000] {
        for outer in [0.500_01, 5.0, 5e6] {
            let boundary = match degree {
                0 => spheroidal(0.3, 0.0),
                _ => SphericalAmplitudes { radial: 0.3, gradient: -0.2, toroidal: 0.7 },
            };
            let medium = mode(annulus(0.5, outer), 0.3, degree, boundary);
            assert_eq!(medium.at(0.5).value, boundary);
            assert_eq!(medium.at(outer).value, SphericalAmplitudes::default());
            let inside = medium.at(0.5 + 0.3 * (outer - 0.5));
            for part in [inside.value, inside.derivative] {
                assert!([part.radial, part.gradient, part.toroidal].iter().all(|it| it.is_finite()), "{part:?}");
            }
            assert!(medium.at(0.4).value.radial.is_nan() && medium.at(2.0 * outer).value.radial.is_nan());
        }
    }
}

#[test]
fn condition_is_the_loss_of_digits_by_cancellation() {
    // ℓ = 2: U_a = −3 V_a is the power r^(−4) alone, d_a = 0: far away, the slow power r^(−2) must cancel.
    let shell = annulus(0.5, 5e6);
    let cancelling = mode(shell, 0.3, 2, spheroidal(3.0, -1.0));
    let plain = mode(shell, 0.3, 2, spheroidal(1.0, 0.0));
    for (radius, at_least) in [(5.0, 10.0), (50.0, 1e3), (500.0, 1e5)] {
        let condition = cancelling.condition(radius);
        // U_a alone decays as (a/r)², the sum as (a/r)⁴.
        assert!(condition > at_least && condition < 30.0 * at_least, "{condition:.1e} at {radius}");
        assert!(plain.condition(radius) < 5.0, "{}", plain.condition(radius));
        // A relative change of U_a by 10⁻⁷ is magnified by at most the condition, and not by much less.
        let changed = mode(shell, 0.3, 2, spheroidal(3.0 * (1.0 + 1e-7), -1.0)).at(radius).value.radial;
        let change = (changed / cancelling.at(radius).value.radial - 1.0).abs() / 1e-7;
        assert!(change > 0.1 * condition && change < condition, "{change:.1e}, {condition:.1e} at {radius}");
    }
}

#[test]
fn at_the_inner_sphere_the_condition_is_that_of_the_two_combinations() {
    // K is the identity there: |T⁻¹| |T| |b| over |b|, T = (1, −ℓ; 1, ℓ+1), T⁻¹ = (ℓ+1, ℓ; −1, 1)/(2ℓ+1).
    for (degree, [u, v]) in [(1, [1.0, 1.0]), (2, [1.0, -1.0]), (2, [0.0, 1.0]), (7, [0.3, 0.2])] {
        let l = f64::from(degree);
        let [s, d] = [f64::abs(u) + l * f64::abs(v), f64::abs(u) + (l + 1.0) * f64::abs(v)];
        let terms = (((l + 1.0) * s + l * d) + (l * (l + 1.0)).sqrt() * (s + d)) / (2.0 * l + 1.0);
        let exact = terms / (f64::abs(u) + (l * (l + 1.0)).sqrt() * f64::abs(v));
        let found = mode(annulus(0.5, 42.0), 0.3, degree, spheroidal(u, v)).condition(0.5);
        // Factors of the type, each within the accuracy of a mode.
        assert!((found / exact - 1.0).abs() < 2.0 * CLAIMED, "{degree}: {found} {exact}");
    }
}

#[test]
fn torsion_turns_about_the_gradient_and_loses_no_digits() {
    // W = 1, Y = z: r̂×∇Y = r̂×ẑ, the velocity of a turn about −z, for every direction.
    for direction in [[1.0, 0.0, 0.0], [0.0, 0.6, -0.8], [2.0 / 3.0, -2.0 / 3.0, 1.0 / 3.0]] {
        let [x, y, z] = direction;
        let gradient: [f64; 3] = std::array::from_fn(|d| if d == 2 { 1.0 - z * z } else { -z * direction[d] });
        let found = TORSION.along(direction, z, gradient);
        let off = norm(difference(found, [y, -x, 0.0]));
        assert!(off < 1e-15, "{found:?}");
    }
    // One term, W_a times a positive factor; at the rim nothing moves.
    let medium = mode(annulus(0.5, 42.0), 0.3, 2, TORSION);
    for radius in [0.5, 0.7, 20.0, 41.0] {
        assert_eq!(medium.condition(radius), 1.0, "{radius}");
    }
    assert!(medium.condition(42.0).is_nan());
    let inflated = mode(annulus(0.5, 42.0), 0.3, 0, spheroidal(0.1, 0.0));
    assert_eq!(inflated.condition(7.0), 1.0);
    assert!(inflated.condition(42.0).is_nan() && inflated.condition(0.4).is_nan());
}

#[test]
fn shells_out_of_range_are_refused() {
    let shell = annulus(0.5, 5.0);
    for ratio in [-1.0, 0.5, 0.7, f64::NAN] {
        let found = SphericalMode::new(shell, ratio, 1, TORSION);
        assert!(matches!(found, Err(AngularModeError::MaterialRatioOutside { .. })), "{found:?}");
    }
    for boundary in [spheroidal(f64::NAN, 0.0), spheroidal(0.0, f64::INFINITY)] {
        let found = SphericalMode::new(shell, 0.3, 1, boundary);
        assert!(matches!(found, Err(AngularModeError::SphericalAmplitudeNotFinite { .. })), "{found:?}");
    }
}
