//! A force in the middle of a held circle, and how modes stretch bonds.

use std::f64::consts::{PI, TAU};

use jamscope::reference::angular_modes::elastic::ElasticMode;
use jamscope::reference::angular_modes::point_force::PointForce;
use jamscope::reference::angular_modes::screened::Screening;
use jamscope::reference::angular_modes::{AngularModeError, AngularSolution, ModeState};

use super::equation::cartesian;
use super::{apart, boundaries, elastic, radii, screened, size};
use crate::annulus;

#[test]
fn a_force_is_the_mode_that_its_own_displacement_at_the_inner_circle_makes() {
    // Claimed: k ln(R/r), the gap and their factors, each rounded two or three times, of which a difference is taken
    // that |U| + |V| does not lose; the same of the other route (7.5e-15) at the worst, and of its boundary values.
    let mut worst = 0.0_f64;
    for ratio in [1.5, 20.0, 340.0, 1e6] {
        for poisson_ratio in [-0.9, -0.3, 0.0, 0.3, 0.7, 0.99] {
            let circle = annulus(1.0, ratio);
            let force = PointForce::new(circle, poisson_ratio, 2.5).expect("finite");
            let mode = ElasticMode::new(circle, poisson_ratio, 1, force.at(1.0).value).expect("finite");
            for radius in radii(circle, 12) {
                let (ours, theirs) = (force.at(radius), mode.at(radius));
                if size(&theirs.value) == 0.0 {
                    assert_eq!(size(&ours.value), 0.0);
                    continue;
                }
                let scale = size(&theirs.value) + radius * size(&theirs.derivative);
                worst = worst.max(apart(&ours.value, &theirs.value) / scale);
                worst = worst.max(radius * apart(&ours.derivative, &theirs.derivative) / scale);
            }
        }
    }
    println!("a force against the mode: {worst:e}");
    assert!(worst < 1e-14, "{worst:e}");
}

#[test]
fn the_traction_on_every_circle_carries_the_force() {
    let (circle, poisson_ratio, strength) = (annulus(0.5, 40.0), 0.4, 0.7);
    let force = PointForce::new(circle, poisson_ratio, strength).expect("finite");
    // Over μ: λ/μ = 2ν/(1−ν).
    let lambda = 2.0 * poisson_ratio / (1.0 - poisson_ratio);
    for radius in [0.5, 1.0, 7.0, 39.0, 40.0] {
        let ModeState { value, derivative } = force.at(radius);
        // u_r = U cos θ, u_θ = W sin θ, V = −iW.
        let (u, w) = (value.radial.re, -value.transverse.im);
        let (u_slope, w_slope) = (derivative.radial.re, -derivative.transverse.im);
        let around = (u + w) / radius;
        let normal = lambda * (u_slope + around) + 2.0 * u_slope;
        let shear = w_slope - (u + w) / radius;
        // What is outside pulls on what is inside by −F: ∮ (σ_rr cos θ − σ_rθ sin θ) r dθ.
        let pull = PI * radius * (normal - shear);
        // Strains of size F/μr, a few roundings each.
        assert!((pull / strength + 1.0).abs() < 1e-13, "{pull} at {radius}");
    }
}

/// Strains of a displacement in Cartesian coordinates, by differences of fourth order.
fn strain(medium: &dyn AngularSolution, [x, y]: [f64; 2]) -> [f64; 3] {
    let h = 1e-3;
    let slope = |along: usize| {
        let at = |steps: f64| {
            let mut place = [x, y];
            place[along] += steps * h;
            cartesian(medium, place)
        };
        let [one, back, two, far_back] = [at(1.0), at(-1.0), at(2.0), at(-2.0)];
        [0, 1].map(|c| (8.0 * (one[c] - back[c]) - (two[c] - far_back[c])) / (12.0 * h))
    };
    let [along_x, along_y] = [slope(0), slope(1)];
    [along_x[0], along_y[1], 0.5 * (along_x[1] + along_y[0])]
}

#[test]
fn stretching_varies_as_bonds_of_all_directions_around_the_circle_say() {
    let (circle, poisson_ratio) = (annulus(1.0, 3.0), 0.4);
    let point_force = PointForce::new(circle, poisson_ratio, 1.3).expect("finite");
    let mut media: Vec<Box<dyn AngularSolution>> = vec![Box::new(point_force)];
    for mode in [0, 1, 2, 5] {
        media.push(Box::new(elastic(circle, poisson_ratio, mode, boundaries()[3])));
        let screening = Screening { even: 2.0, odd: -1.0 };
        media.push(Box::new(screened(circle, poisson_ratio, screening, mode, boundaries()[3])));
    }
    for medium in &media {
        for radius in [1.3, 2.0, 2.7] {
            // Sums over equal angles are exact: at most cos 14θ around the circle (squares of n ± 2), cos 4φ of bonds.
            let (mut mean, mut square) = (0.0, 0.0);
            let (places, directions) = (40, 12);
            for place in 0..places {
                let angle = TAU * f64::from(place) / f64::from(places) + 0.1;
                let [xx, yy, xy] = strain(medium.as_ref(), [radius * angle.cos(), radius * angle.sin()]);
                for direction in 0..directions {
                    let (sine, cosine) = (PI * f64::from(direction) / f64::from(directions)).sin_cos();
                    let stretched = xx * cosine * cosine + yy * sine * sine + 2.0 * xy * sine * cosine;
                    mean += stretched / f64::from(places * directions);
                    square += stretched * stretched / f64::from(places * directions);
                }
            }
            let expected = (square - mean * mean).sqrt();
            let found = medium.stretch_fluctuation(radius);
            // h⁴ n⁵ u/30 of the differences, and their rounding ε u/h.
            assert!((found / expected - 1.0).abs() < 1e-8, "mode {}, r = {radius}: {found} {expected}", medium.mode());
        }
    }
}

#[test]
fn a_force_that_is_none_is_refused() {
    let circle = annulus(1.0, 3.0);
    for strength in [f64::NAN, f64::INFINITY] {
        let error = PointForce::new(circle, 0.3, strength).expect_err("not a number");
        assert!(matches!(error, AngularModeError::ForceNotFinite { .. }), "{error}");
    }
    assert!(matches!(PointForce::new(circle, 1.0, 1.0), Err(AngularModeError::PoissonRatioOutside { .. })));
    let force = PointForce::new(circle, 0.3, 1.0).expect("finite");
    assert_eq!(force.annulus(), circle);
    assert_eq!(size(&force.at(3.0).value), 0.0);
    assert!(force.at(0.9).value.radial.re.is_nan() && force.stretch_fluctuation(3.1).is_nan());
}
