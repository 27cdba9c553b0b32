//! Angular modes and the Bessel functions they are made of: the profile of n = 0, the potentials, the limit without them.

use std::f64::consts::PI;

use jamscope::reference::angular_modes::screened::Screening;
use jamscope::reference::angular_modes::{AngularSolution, Complex, ModeAmplitudes};
use jamscope::reference::elastic::Elastic;
use jamscope::reference::poles::{pole, pole_count_below};
use jamscope::reference::screened::Screened;
use jamscope::reference::{Annulus, RadialSolution};
use jamscope::vector::larger;

use super::{boundaries, claimed_screened, elastic, length, radii, screened, screening, size};
use crate::annulus;

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
        for argument in [1e-6, 0.3, 2.0, 5.0, 12.0, 60.0, 400.0, 5000.0] {
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
        [at_inner[c], at_outer[c]].iter().flatten().fold(0.0, |largest, x| larger(largest, x.abs()))
    });
    let weights = eliminate(std::array::from_fn(|row| {
        let (columns, wanted) = if row < 2 { (&at_inner, boundary[row]) } else { (&at_outer, 0.0) };
        std::array::from_fn(|c| Complex::from(if c == 4 { wanted } else { columns[c][row % 2] / scale[c] }))
    }));
    let here = columns(radius);
    [0, 1].map(|i| (0..4).map(|c| here[c][i] / scale[c] * weights[c].re).sum())
}

/// Four equations, the last column being the right side, by elimination with row pivots.
fn eliminate(mut rows: [[Complex<f64>; 5]; 4]) -> [Complex<f64>; 4] {
    for step in 0..4 {
        let pivot = (step..4).max_by(|&i, &j| rows[i][step].norm().total_cmp(&rows[j][step].norm())).expect("a row");
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
    std::array::from_fn(|c| rows[c][4] / rows[c][c])
}

/// J_1 and Y_1 of a complex argument, by their power series (A&S 9.1.10 and 9.1.11).
fn first_order(z: Complex<f64>) -> [Complex<f64>; 2] {
    const EULER: f64 = 0.577_215_664_901_532_9;
    let quarter = -z * z / 4.0;
    let (mut term, mut regular, mut harmonic) = (z / 2.0, Complex::from(0.0), Complex::from(0.0));
    // ψ(k+1) + ψ(k+2).
    let mut psi = 1.0 - 2.0 * EULER;
    for k in 0..60 {
        let k = f64::from(k);
        regular += term;
        harmonic += term * psi;
        term *= quarter / ((k + 1.0) * (k + 2.0));
        psi += 1.0 / (k + 1.0) + 1.0 / (k + 2.0);
    }
    [regular, (regular * (z / 2.0).ln() * 2.0 - z.inv() * 2.0 - harmonic) / PI]
}

#[test]
fn odd_inflation_is_two_waves_of_complex_wavenumber() {
    // n = 0: (β k² − Γ_e)(k² − Γ_e) + Γ_o² = 0 gives two k²; J_1 and Y_1 of kr in U, and (Γ_e − β k²)/Γ_o times them in V.
    let (annulus, poisson_ratio) = (annulus(1.0, 3.0), 0.2);
    let beta = 2.0 / (1.0 - poisson_ratio);
    for (even, odd) in [(9.0, 20.0), (30.0, -12.0), (-9.0, 20.0), (9.0, 0.1)] {
        let screening = screening(annulus, even, odd);
        let boundary = boundaries()[3];
        let medium = screened(annulus, poisson_ratio, screening, 0, boundary);
        let (e, o) = (Complex::from(screening.even), Complex::from(screening.odd));
        let root = ((e * (1.0 + beta)).powi(2) - (e * e + o * o) * (4.0 * beta)).sqrt();
        let squares = [1.0, -1.0].map(|sign| (e * (1.0 + beta) + root * sign) / (2.0 * beta));
        let columns = |radius: f64| -> [[Complex<f64>; 2]; 4] {
            std::array::from_fn(|c| {
                let square = squares[c / 2];
                let value = first_order(square.sqrt() * radius)[c % 2];
                [value, value * (e - square * beta) / o]
            })
        };
        let (at_inner, at_outer) = (columns(1.0), columns(3.0));
        let wanted = [boundary.radial, boundary.transverse];
        let weights = eliminate(std::array::from_fn(|row| {
            let columns = if row < 2 { &at_inner } else { &at_outer };
            let right = if row < 2 { wanted[row] } else { Complex::from(0.0) };
            std::array::from_fn(|c| if c == 4 { right } else { columns[c][row % 2] })
        }));
        for radius in [1.2, 1.7, 2.3, 2.8] {
            let here = columns(radius);
            let [radial, transverse] = [0, 1].map(|i| (0..4).map(|c| here[c][i] * weights[c]).sum::<Complex<f64>>());
            let state = medium.at(radius);
            let error = (state.value.radial - radial).norm() + (state.value.transverse - transverse).norm();
            // Series at |kr| ≤ 5: their largest term, e⁵ roundings; the four equations: condition some 10².
            let scale = size(&state.value) + size(&state.derivative);
            assert!(error < 1e-12 * scale, "{error:.1e} of {scale} at {radius}, Γ {even}, {odd}");
        }
    }
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
