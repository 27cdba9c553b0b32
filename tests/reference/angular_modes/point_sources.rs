//! A force and a force dipole at the centre of a held circle, elastic and screened: their digits and their limits.

use jamscope::reference::angular_modes::elastic::ElasticMode;
use jamscope::reference::angular_modes::force_dipole::ForceDipole;
use jamscope::reference::angular_modes::point_force::PointForce;
use jamscope::reference::angular_modes::screened_source::ScreenedSource;
use jamscope::reference::angular_modes::{AngularModeError, AngularSolution, ModeAmplitudes, ModeState};
use jamscope::reference::poles::pole;
use jamscope::reference::rim::RimSolution;
use jamscope::reference::screened::Screened;
use jamscope::reference::{Annulus, RadialSolution};
use serde_json::Value;

use super::{apart, radii, screening, size};
use crate::{Worst, annulus, fixture, number, rows};

/// Accuracy claimed for the closed forms: at most 30 roundings of half an ulp, 3.4·10⁻¹⁵, of terms up to three times as
/// large as |u| + r|u'|.
const CLAIMED_CLOSED: f64 = 1e-14;

fn claimed(medium: &ScreenedSource) -> f64 {
    f64::EPSILON * (8.0 + medium.node_count() as f64) * medium.condition()
}

/// Force, inflation and elongation.
fn sources(circle: Annulus, ratio: f64, screening: f64) -> Result<[ScreenedSource; 3], AngularModeError> {
    let [inflation, elongation] = ScreenedSource::dipole(circle, ratio, screening, 1.0)?;
    Ok([ScreenedSource::force(circle, ratio, screening, 1.0)?, inflation, elongation])
}

/// [U, w, U', w'] of the three modes in a row.
fn exact(row: &Value) -> [ModeState; 3] {
    let state = |columns: [Option<usize>; 4]| {
        let [u, w, u_slope, w_slope] = columns.map(|column| column.map_or(0.0, |column| number(&row[column])));
        ModeState { value: ModeAmplitudes::in_phase(u, w), derivative: ModeAmplitudes::in_phase(u_slope, w_slope) }
    };
    [state([4, 5, 6, 7].map(Some)), state([Some(8), None, Some(9), None]), state([10, 11, 12, 13].map(Some))]
}

/// Length over which the solution changes: r/n, one over the wavenumber, the way to the rim.
fn length(outer: f64, mode: u32, screening: f64, radius: f64) -> f64 {
    (radius / f64::from(mode.max(1))).min(1.0 / screening.abs().sqrt()).min(outer - radius)
}

#[test]
fn sources_have_their_digits() {
    let file = fixture("point_sources.json");
    let [mut closed, mut march, mut near_poles, mut far] = [(); 4].map(|()| Worst::default());
    let [mut largest_closed, mut largest_march, mut poles] = [0.0_f64, 0.0, 0.0];
    for row in rows(&file) {
        let [outer, ratio, screening, radius] = [0, 1, 2, 3].map(|column| number(&row[column]));
        let (circle, tag) = (annulus(1e-5 * outer, outer), row[14].as_str().expect("a tag"));
        if matches!(tag, "pole1" | "pole2") {
            let found = if tag == "pole1" {
                ScreenedSource::force(circle, ratio, screening, 1.0).map(|_| ())
            } else {
                ScreenedSource::dipole(circle, ratio, screening, 1.0).map(|_| ())
            };
            assert!(matches!(found, Err(AngularModeError::AtPole { .. })), "{row}: {found:?}");
            poles += 1.0;
            continue;
        }
        let media = sources(circle, ratio, screening).unwrap_or_else(|error| panic!("{row}: {error}"));
        // Defined outside r only: the series about the centre then ends elsewhere.
        let others = sources(annulus(radius, outer), ratio, screening).unwrap_or_else(|error| panic!("{row}: {error}"));
        for ((medium, other), exact) in media.iter().zip(&others).zip(exact(row)) {
            let mode = medium.mode();
            let length = length(outer, mode, screening, radius);
            for (medium, worst) in [(medium, &mut march), (other, &mut far)] {
                let found = medium.at(radius);
                let error = super::error(&exact, &found, length);
                let what = || {
                    format!(
                        "{error:.1e}, condition {:.1e}, n {mode}, {}: {row}",
                        medium.condition(),
                        medium.node_count()
                    )
                };
                if let Some(off) = tag.strip_prefix(&format!("pole{mode}")) {
                    near_poles.take(error / claimed(medium), what);
                    let off: f64 = off.parse().expect("a number");
                    let ratio = medium.condition() * off.abs();
                    assert!(ratio > 0.05 && ratio < 20.0, "condition {:.1e} at {off}, n {mode}", medium.condition());
                } else {
                    worst.take(error / claimed(medium), what);
                    largest_march = largest_march.max(error / medium.condition());
                }
            }
            if screening == 0.0 {
                let force = PointForce::new(circle, ratio, 1.0).expect("finite");
                let dipole = ForceDipole::new(circle, ratio, 1.0).expect("finite");
                let state = match mode {
                    1 => force.at(radius),
                    0 => dipole.modes()[0].at(radius),
                    _ => dipole.modes()[1].at(radius),
                };
                let error = super::error(&exact, &state, length);
                closed.take(error / CLAIMED_CLOSED, || format!("{error:.1e}, n {mode}: {row}"));
                largest_closed = largest_closed.max(error);
            }
        }
    }
    println!("largest errors: closed {largest_closed:.1e}, screened over the condition {largest_march:.1e}");
    assert_eq!(poles, 3.0);
    for (worst, name) in [(closed, "closed"), (march, "screened"), (far, "far from the centre"), (near_poles, "poles")]
    {
        let count = worst.count;
        assert!(count >= 30, "{name}: {count}");
        worst.finish(name, count);
    }
}

#[test]
fn a_dipole_is_the_mode_that_its_own_displacement_at_the_inner_circle_makes() {
    let mut worst = 0.0_f64;
    for ratio in [1.5, 20.0, 340.0, 1e6] {
        for poisson_ratio in [-0.9, -0.3, 0.0, 0.3, 0.7, 0.99] {
            let circle = annulus(1.0, ratio);
            let dipole = ForceDipole::new(circle, poisson_ratio, 2.5).expect("finite");
            for part in dipole.modes() {
                let mode = ElasticMode::new(circle, poisson_ratio, part.mode(), part.at(1.0).value).expect("finite");
                for radius in radii(circle, 12) {
                    let (ours, theirs) = (part.at(radius), mode.at(radius));
                    let scale = size(&theirs.value) + radius * size(&theirs.derivative);
                    worst = worst.max(apart(&ours.value, &theirs.value) / scale);
                    worst = worst.max(radius * apart(&ours.derivative, &theirs.derivative) / scale);
                }
            }
        }
    }
    println!("a dipole against the mode: {worst:e}");
    // Both claims: 10⁻¹⁴, and 7.5·10⁻¹⁵ of the mode.
    assert!(worst < CLAIMED_CLOSED + 7.5e-15, "{worst:e}");
}

#[test]
fn a_dipole_is_the_difference_of_two_forces_near_the_centre() {
    // −∂_x of the displacement of a force far from the rim, by a difference of order h² and h⁴: with r/R = 10⁻⁸ the rim adds
    // (r/R)².
    let (circle, ratio) = (annulus(1e-3, 1e8), 0.3);
    let force = PointForce::new(circle, ratio, 1.0).expect("finite");
    let dipole = ForceDipole::new(circle, ratio, 1.0).expect("finite");
    let cartesian = |[radial, across]: [f64; 2], angle: f64| {
        [radial * angle.cos() - across * angle.sin(), radial * angle.sin() + across * angle.cos()]
    };
    let h = 1e-3;
    for [x, y] in [[1.0, 0.3], [-0.2, 0.9], [0.7, -0.7]] {
        let at = |x: f64| {
            let (radius, angle) = (f64::hypot(x, y), y.atan2(x));
            cartesian(force.displacement(radius, angle), angle)
        };
        let (radius, angle) = (f64::hypot(x, y), y.atan2(x));
        let found = cartesian(dipole.displacement(radius, angle), angle);
        let [near, far] = [h, 2.0 * h].map(|step| {
            let (ahead, behind) = (at(x + step), at(x - step));
            [0, 1].map(|c| -(ahead[c] - behind[c]) / (2.0 * step))
        });
        for c in 0..2 {
            let expected = (4.0 * near[c] - far[c]) / 3.0;
            // Rounding: ln(R/r) = 18 of F/μ, 2⁻⁵² of it over h; the order left out, 4 h⁴ u/r⁵.
            assert!((found[c] - expected).abs() < 1e-11, "{found:?}, not {expected} at {x}, {y}");
        }
    }
}

#[test]
fn the_inflation_by_a_dipole_is_the_radial_profile() {
    for (outer, inner) in [(42.0, 0.5), (1.0, 0.2)] {
        let circle = annulus(inner, outer);
        for argument in [1e-6, 0.5, 3.0, 20.0, 300.0] {
            let (wavenumber, ratio) = (argument / outer, 0.3);
            let gamma = wavenumber * wavenumber / 0.35;
            let [inflation, _] = ScreenedSource::dipole(circle, ratio, gamma, 1.0).expect("no pole");
            let rim = RimSolution::<2>::new(circle, wavenumber).expect("valid");
            let edge = inflation.at(inner).value.radial.re / rim.value(inner);
            for radius in radii(circle, 8) {
                let state = inflation.at(radius);
                let (value, slope) = (edge * rim.value(radius), edge * rim.derivative(radius));
                let scale = value.abs() + length(outer, 0, gamma, radius) * slope.abs();
                // κ = √(εΓ) is rounded three times; the value at a may be near a node, 10 of its envelope.
                let allowed = 2.0 * claimed(&inflation) * 10.0 * (1.0 + argument);
                let error = (state.value.radial.re - value).abs() / scale;
                assert!(error < allowed, "{error:.1e} at {radius}, κR {argument}");
                assert_eq!(state.value.transverse.norm(), 0.0);
            }
        }
    }
    // Torsion has a pole at k_T R = 3.83…, the first zero of J_1: it does not disturb the inflation.
    let circle = annulus(0.5, 42.0);
    let first = pole::<2>(annulus(1e-9, 42.0), 1);
    let [inflation, _] = ScreenedSource::dipole(circle, 0.3, first * first, 1.0).expect("no pole of it");
    assert!(inflation.condition() < 100.0, "{}", inflation.condition());
    let profile = Screened::<2>::new(circle, 1.0, 0.35_f64.sqrt() * first).expect("no pole");
    let ratio = inflation.at(20.0).value.radial.re / inflation.at(0.5).value.radial.re;
    assert!((ratio / profile.value(20.0) - 1.0).abs() < 1e-12, "{ratio}");
}

#[test]
fn weak_screening_tends_to_the_elastic_sources() {
    let circle = annulus(0.5, 170.0);
    let force = PointForce::new(circle, 0.3, 1.0).expect("finite");
    let dipole = ForceDipole::new(circle, 0.3, 1.0).expect("finite");
    let [flat, elongated] = dipole.modes();
    let elastic: [&dyn AngularSolution; 3] = [&force, flat, elongated];
    let difference = |even: f64, radius: f64| {
        let media = sources(circle, 0.3, screening(circle, even, 0.0).even).expect("no pole");
        [0, 1, 2].map(|part| {
            let (state, rest) = (media[part].at(radius).value, elastic[part].at(radius).value);
            [(state.radial - rest.radial) / size(&rest), (state.transverse - rest.transverse) / size(&rest)]
        })
    };
    for radius in [1.0, 40.0, 165.0] {
        for sign in [1.0, -1.0] {
            let (one, two) = (difference(1e-4 * sign, radius), difference(2e-4 * sign, radius));
            for (one, two) in one.iter().flatten().zip(two.iter().flatten()) {
                // The next order is (Γ R²)² < 4·10⁻⁸ of u; rounding as claimed, some 30 nodes: 10⁻¹³.
                assert!((two - one * 2.0).norm() < 4e-8, "{one}, {two} at {radius}");
                assert!(one.norm() < 1e-4, "{one} at {radius}");
            }
        }
        // Γ R² = 10⁻³⁰ changes nothing, and loses nothing.
        let nothing = difference(1e-30, radius);
        assert!(nothing.iter().flatten().all(|z| z.norm() < 1e-13), "{nothing:?} at {radius}");
    }
}

#[test]
fn sources_are_zero_at_the_rim_and_refused_where_they_are_none() {
    let circle = annulus(0.5, 42.0);
    let dipole = ForceDipole::new(circle, 0.3, 1.0).expect("finite");
    assert_eq!(dipole.annulus(), circle);
    assert_eq!(dipole.displacement(42.0, 0.4), [0.0, 0.0]);
    assert!(dipole.displacement(0.4, 0.4)[0].is_nan());
    for medium in sources(circle, 0.3, -0.7).expect("no pole") {
        assert_eq!(medium.annulus(), circle);
        assert_eq!(size(&medium.at(42.0).value), 0.0);
        assert!(medium.at(0.4).value.radial.re.is_nan() && medium.at(f64::NAN).derivative.radial.re.is_nan());
    }
    let refused = [
        ForceDipole::new(circle, 0.3, f64::NAN).map(|_| ()),
        ScreenedSource::dipole(circle, 0.3, 0.1, f64::INFINITY).map(|_| ()),
    ];
    assert!(refused.iter().all(|found| matches!(found, Err(AngularModeError::DipoleNotFinite { .. }))), "{refused:?}");
    let force =
        |ratio, screening, strength| ScreenedSource::force(circle, ratio, screening, strength).expect_err("refused");
    assert!(matches!(force(0.3, 0.1, f64::NAN), AngularModeError::ForceNotFinite { .. }));
    assert!(matches!(force(-1.0, 0.1, 1.0), AngularModeError::PoissonRatioOutside { .. }));
    assert!(matches!(force(0.3, f64::INFINITY, 1.0), AngularModeError::ScreeningNotFinite { .. }));
    assert!(matches!(force(0.3, 1e12, 1.0), AngularModeError::TooManyNodes { .. }));
    assert!(matches!(ForceDipole::new(circle, 1.0, 1.0), Err(AngularModeError::PoissonRatioOutside { .. })));
}
