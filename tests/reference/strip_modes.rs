//! Modes of a strip: their digits, their limits, their poles.

use jamscope::reference::screened::Screened;
use jamscope::reference::strip_modes::{StripAmplitudes, StripMode, StripModeError, StripState};
use jamscope::reference::{Annulus, RadialSolution};

use super::{Worst, annulus, fixture, number, rows};

/// The kernels are those of the annulus, and so is the number of their roundings: `CLAIMED_ELASTIC` of the angular modes,
/// (2·30 + 8)·2⁻⁵³.
const CLAIMED_ELASTIC: f64 = 68.0 * 0.5 * f64::EPSILON;

const NORMAL: StripAmplitudes = StripAmplitudes { normal: 1.0, tangential: 0.0 };
const TANGENTIAL: StripAmplitudes = StripAmplitudes { normal: 0.0, tangential: 1.0 };

fn mode(interval: Annulus, ratio: f64, screening: f64, wavenumber: f64, boundary: StripAmplitudes) -> StripMode {
    StripMode::new(interval, ratio, screening, wavenumber, boundary).expect("no pole")
}

/// What is claimed at the type. q = 0 is the profile with D = 1, whose error is 3.2·10⁻¹⁵ (`CLAIMED`), and its κ = √(εΓ)
/// is rounded three times.
fn claimed(medium: &StripMode) -> f64 {
    let roundings = match (medium.wavenumber() == 0.0, medium.node_count()) {
        (true, _) => 3.2e-15 + 1.5 * f64::EPSILON,
        (false, 0) => CLAIMED_ELASTIC,
        (false, count) => f64::EPSILON * (8.0 + count as f64),
    };
    roundings * medium.condition()
}

/// The larger error of value and derivative, relative to |u| + length |u'| + `rest`.
fn error(exact: [f64; 4], found: &StripState, length: f64, rest: f64) -> f64 {
    let [u, v, u_slope, v_slope] = exact;
    let scale = u.abs() + v.abs() + length * (u_slope.abs() + v_slope.abs()) + rest;
    let value = (found.value.normal - u).abs() + (found.value.tangential - v).abs();
    let slope = (found.derivative.normal - u_slope).abs() + (found.derivative.tangential - v_slope).abs();
    if value >= length * slope || value.is_nan() { value / scale } else { length * slope / scale }
}

/// The slowest decay from 1 at a: `sinh k(H−y)/sinh k(H−a)`, k² = q² − Γ or q² − εΓ, whichever is smaller. For Γ < 0 a
/// tangential displacement of small q decays faster; a rounding of A changes it by this much.
fn slowest(interval: Annulus, ratio: f64, screening: f64, wavenumber: f64, place: f64) -> f64 {
    let square = wavenumber * wavenumber - screening.max(0.5 * (1.0 - ratio) * screening);
    let rate = square.max(0.0).sqrt();
    let (inner, outer) = (interval.inner_radius(), interval.outer_radius());
    let reached = |from: f64| -f64::exp_m1(-2.0 * rate * (outer - from));
    if rate == 0.0 { 1.0 } else { f64::exp(-rate * (place - inner)) * reached(place) / reached(inner) }
}

/// Length over which a mode changes at a place: one over the larger wavenumber, the way to the wall.
fn length(outer: f64, screening: f64, wavenumber: f64, place: f64) -> f64 {
    (1.0 / wavenumber.max(screening.abs().sqrt())).min(outer - place)
}

#[test]
fn modes_of_a_strip_have_their_digits() {
    let file = fixture("strip_modes.json");
    let [mut elastic, mut even, mut screened, mut near_poles] = [(); 4].map(|()| Worst::default());
    let [mut largest_elastic, mut largest_screened, mut plain_normal, mut poles] = [0.0_f64; 4];
    let mut faster = 0;
    for row in rows(&file) {
        let [outer, ratio, screening, wavenumber, place] = [0, 1, 2, 3, 4].map(|column| number(&row[column]));
        let (interval, tag) = (annulus(0.5, outer), row[13].as_str().expect("a tag"));
        if tag == "pole" {
            let found = StripMode::new(interval, ratio, screening, wavenumber, NORMAL);
            // The nearest number is off by 2⁻⁵³ of itself at most: a condition of 4·10¹⁵ or more.
            assert!(matches!(found, Err(StripModeError::AtPole { .. })), "{row}: {found:?}");
            poles += 1.0;
            continue;
        }
        for (boundary, first) in [(NORMAL, 5), (TANGENTIAL, 9)] {
            let exact = [0, 1, 2, 3].map(|k| number(&row[first + k]));
            let medium = mode(interval, ratio, screening, wavenumber, boundary);
            if wavenumber == 0.0 && boundary == TANGENTIAL {
                assert_eq!(medium.at(place).value, StripAmplitudes::default());
                continue;
            }
            let (state, length) = (medium.at(place), length(outer, screening, wavenumber, place));
            let plain = error(exact, &state, length, 0.0);
            // Waves do not decay: only for Γ < 0.
            let rest = if screening < 0.0 { slowest(interval, ratio, screening, wavenumber, place) } else { 0.0 };
            let error = error(exact, &state, length, rest);
            if boundary == NORMAL && tag == "grid" && medium.node_count() > 0 {
                plain_normal = plain_normal.max(plain / claimed(&medium));
            }
            if plain > claimed(&medium) && tag == "grid" {
                faster += 1;
                assert!(boundary == TANGENTIAL && screening < 0.0, "{plain:.1e}: {row}");
            }
            let what = || format!("{error:.1e}, condition {:.1e}, {boundary:?}: {row}", medium.condition());
            let share = error / claimed(&medium);
            if let Some(off) = tag.strip_prefix("pole") {
                near_poles.take(share, what);
                // The condition is 1/|off| to a factor of order one.
                let off: f64 = off.parse().expect("a number");
                let ratio = medium.condition() * off.abs();
                assert!(ratio > 0.05 && ratio < 20.0, "condition {:.1e} at {off}", medium.condition());
            } else if wavenumber == 0.0 {
                even.take(share, what);
            } else if medium.node_count() == 0 {
                elastic.take(share, what);
                largest_elastic = largest_elastic.max(error);
            } else {
                screened.take(share, what);
                largest_screened = largest_screened.max(error / medium.condition());
            }
        }
    }
    println!("largest errors: elastic {largest_elastic:.1e}, screened over the condition {largest_screened:.1e}");
    println!("screened, A alone, of |u|: {plain_normal:.2} of what is allowed; {faster} beyond");
    assert_eq!(poles, 3.0);
    for (worst, name) in [(elastic, "elastic"), (even, "q = 0"), (screened, "screened"), (near_poles, "next to poles")]
    {
        let count = worst.count;
        assert!(count >= 50, "{name}: {count}");
        worst.finish(name, count);
    }
}

#[test]
fn a_deep_strip_is_a_half_space() {
    // The wall at h changes the half space by (qh)² e^(−2qh) of u at the line, 10⁻³¹ for qh = 40, and by e^(−2qz) (qh)² of
    // u at the distance z from it.
    for (depth, wavenumber) in [(40.0, 1.0), (1000.0, 0.5), (20.0, 35.0)] {
        for ratio in [-0.9, 0.3, 0.999_999_999] {
            let epsilon = 0.5 * (1.0 - ratio);
            for boundary in [NORMAL, TANGENTIAL, StripAmplitudes { normal: 0.7, tangential: 0.7 }] {
                let StripAmplitudes { normal, tangential } = boundary;
                let medium = mode(annulus(2.0, 2.0 + depth), ratio, 0.0, wavenumber, boundary);
                for reduced in [0.0, 0.01, 1.0, 8.0, 15.0] {
                    let place = 2.0 + reduced / wavenumber;
                    let eta = place - 2.0;
                    let faded = f64::exp(-wavenumber * eta);
                    let across = (1.0 - epsilon) / (1.0 + epsilon) * wavenumber * eta * (normal - tangential);
                    let slope = (1.0 - epsilon) / (1.0 + epsilon) * wavenumber * (normal - tangential);
                    let exact = [
                        faded * (normal + across),
                        faded * (tangential + across),
                        faded * (slope - wavenumber * (normal + across)),
                        faded * (slope - wavenumber * (tangential + across)),
                    ];
                    // e^(−qη) of this test: qη roundings, 15 at most.
                    let error = error(exact, &medium.at(place), 1.0 / wavenumber, 0.0);
                    let allowed = CLAIMED_ELASTIC + 16.0 * f64::EPSILON;
                    assert!(error < allowed, "{error:.1e} at qη = {reduced}, ν {ratio}, {boundary:?}");
                }
            }
        }
    }
}

#[test]
fn long_waves_tend_to_even_stretching() {
    let interval = annulus(0.5, 20.5);
    for screening in [0.0, 0.01, -0.01] {
        let even = mode(interval, 0.3, screening, 0.0, NORMAL);
        for place in [1.0, 7.0, 20.0] {
            let exact = even.at(place);
            let differences = [1e-3, 2e-3].map(|scaled| {
                let state = mode(interval, 0.3, screening, scaled / 20.0, NORMAL).at(place);
                [state.value.normal - exact.value.normal, state.value.tangential]
            });
            let [[u, v], [twice_u, twice_v]] = differences;
            // U changes as (qh)², V grows as qh; the next orders are smaller by (qh)² = 4·10⁻⁶ times the condition of
            // the screened strip, 5. Rounding of U, 10⁻¹⁴, over 10⁻⁷.
            assert!((twice_u / u - 4.0).abs() < 1e-4, "{u:e}, {twice_u:e} at {place}, Γ {screening}");
            assert!((twice_v / v - 2.0).abs() < 1e-4, "{v:e}, {twice_v:e} at {place}, Γ {screening}");
            // qh = 10⁻⁹ changes nothing and loses nothing.
            let medium = mode(interval, 0.3, screening, 1e-9 / 20.0, NORMAL);
            let off = (medium.at(place).value.normal - exact.value.normal).abs();
            assert!(off < claimed(&medium) + claimed(&even), "{off:e} at {place}, Γ {screening}");
        }
    }
}

#[test]
fn even_stretching_is_the_profile_of_the_strip_for_any_poisson_ratio() {
    let interval = annulus(0.5, 20.5);
    for ratio in [-0.9, 0.3, 0.999] {
        let epsilon = 0.5 * (1.0 - ratio);
        let elastic = mode(interval, ratio, 0.0, 0.0, StripAmplitudes { normal: 0.1, tangential: 3.0 });
        assert!((elastic.at(8.0).value.normal - 0.1 * 12.5 / 20.0).abs() < 1e-16);
        assert_eq!(elastic.displacement(0.3, 8.0), [0.0, elastic.at(8.0).value.normal]);
        for wavenumber in [1e-5, 0.1, 2.0] {
            let medium = mode(interval, ratio, wavenumber * wavenumber / epsilon, 0.0, NORMAL);
            let profile = Screened::<1>::new(interval, 1.0, wavenumber).expect("no pole");
            for place in [1.0, 8.0, 20.0] {
                let (state, value, slope) = (medium.at(place), profile.value(place), profile.derivative(place));
                let error =
                    error([value, 0.0, slope, 0.0], &state, length(20.5, wavenumber * wavenumber, 0.0, place), 0.0);
                assert!(error < 2.0 * claimed(&medium), "{error:.1e} at {place}, κ {wavenumber}");
            }
        }
    }
}

#[test]
fn weak_screening_tends_to_the_elastic_strip() {
    for (depth, ratio) in [(20.0, 0.3), (0.01, -0.8), (20.0, 0.999)] {
        let interval = annulus(0.5, 0.5 + depth);
        for scaled in [1e-4, 0.3, 3.0, 40.0, 700.0] {
            let wavenumber = scaled / depth;
            let elastic = mode(interval, ratio, 0.0, wavenumber, NORMAL);
            let difference = |screening: f64, place: f64| {
                let (state, rest) =
                    (mode(interval, ratio, screening, wavenumber, NORMAL).at(place).value, elastic.at(place).value);
                let size = rest.normal.abs() + rest.tangential.abs();
                [(state.normal - rest.normal) / size, (state.tangential - rest.tangential) / size]
            };
            for reduced in [0.1, 0.5, 0.9] {
                let place = 0.5 + reduced * depth / f64::max(1.0, scaled / 10.0);
                // The share of Γ: at most |Γ| over q² + (π/h)², times qη ≤ 10.
                let unit = 1e-4 * wavenumber.max(1.0 / depth).powi(2);
                let (one, two) = (difference(unit, place), difference(2.0 * unit, place));
                for (one, two) in one.into_iter().zip(two) {
                    assert!(one.abs() < 2e-3, "{one:e} at {place}, qh {scaled}");
                    // The next order: the square, (2·10⁻³)². Rounding: 10⁻¹².
                    assert!((two - 2.0 * one).abs() < 1e-5, "{one:e}, {two:e} at {place}, qh {scaled}");
                }
                let nodes = mode(interval, ratio, 1e-20 * unit, wavenumber, NORMAL);
                let allowed = claimed(&nodes) + CLAIMED_ELASTIC;
                let off = difference(1e-20 * unit, place);
                let slack = 10.0
                    * length(0.5 + depth, 0.0, wavenumber, place)
                    * (elastic.at(place).derivative.normal.abs() + elastic.at(place).derivative.tangential.abs())
                    / (elastic.at(place).value.normal.abs() + elastic.at(place).value.tangential.abs());
                assert!(
                    off.iter().all(|x| x.abs() < allowed * (1.0 + slack)),
                    "{off:?}, {allowed:.1e} at {place}, qh {scaled}, ν {ratio}"
                );
            }
        }
    }
}

#[test]
fn ends_are_exact_and_what_is_no_strip_is_refused() {
    let interval = annulus(0.5, 20.5);
    for screening in [0.0, 0.3, -0.3] {
        for wavenumber in [0.0, 1e-9, 0.7, 30.0] {
            let tangential = if wavenumber == 0.0 { 0.0 } else { -0.2 };
            let boundary = StripAmplitudes { normal: 0.3, tangential };
            let medium = mode(interval, 0.3, screening, wavenumber, boundary);
            assert_eq!(medium.at(0.5).value, boundary);
            let wall = medium.at(20.5).value;
            assert_eq!((wall.normal, wall.tangential), (0.0, 0.0), "Γ {screening}, q {wavenumber}");
            for place in [0.49, 20.6, f64::NAN] {
                let state = medium.at(place);
                assert!(state.value.normal.is_nan() && state.derivative.tangential.is_nan());
            }
            let state = medium.at(11.0);
            assert!(state.value.normal.is_finite() && state.derivative.tangential.is_finite());
        }
    }
    let new = |ratio, screening, wavenumber, normal| {
        StripMode::new(interval, ratio, screening, wavenumber, StripAmplitudes { normal, tangential: 0.0 })
            .expect_err("refused")
    };
    assert!(matches!(new(1.0, 0.0, 1.0, 1.0), StripModeError::PoissonRatioOutside { .. }));
    assert!(matches!(new(0.3, f64::NAN, 1.0, 1.0), StripModeError::ScreeningNotFinite { .. }));
    assert!(matches!(new(0.3, 0.0, -1.0, 1.0), StripModeError::WavenumberNegative { .. }));
    assert!(matches!(new(0.3, 0.0, f64::INFINITY, 1.0), StripModeError::WavenumberNegative { .. }));
    assert!(matches!(new(0.3, 0.0, 1.0, f64::NAN), StripModeError::AmplitudeNotFinite { .. }));
    assert!(matches!(new(0.3, 1e20, 1.0, 1.0), StripModeError::TooManyNodes { .. }));
    // q = 0: κ h = π.
    let pole = (std::f64::consts::PI / 20.0).powi(2) / 0.35;
    assert!(matches!(new(0.3, pole, 0.0, 1.0), StripModeError::AtPole { .. }));
}
