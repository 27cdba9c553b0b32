//! The exact solutions against values of 25 digits, their limits, and the equation they solve.

mod angular_modes;
mod lorentzian;
#[path = "../twins/precise_bessel.rs"]
mod precise_bessel;
#[path = "../twins/precise_profile.rs"]
mod precise_profile;

mod amplitude;
mod antiscreened;
mod bessel_functions;
mod pole_count;
mod precise_poles;
mod random_annuli;
#[path = "../scenes/seeds.rs"]
mod seeds;
mod strip_modes;
mod wavenumber_derivative;

use std::f64::consts::PI;

use jamscope::reference::elastic::Elastic;
use jamscope::reference::poles::{pole, pole_count_below};
use jamscope::reference::rim::RimSolution;
use jamscope::reference::screened::Screened;
use jamscope::reference::{Annulus, RadialSolution, ReferenceError};
use serde_json::Value;

/// Relative accuracy claimed for the screened solution: libm has 4·10⁻¹⁶ of the modulus in J and in Y, the cross product
/// takes two of each, and numerator and denominator both are such products: 8·4·10⁻¹⁶. The series near the rim and modulus and
/// phase, which stand for most of it, have less.
const CLAIMED: f64 = 3.2e-15;

/// Relative accuracy claimed for the poles: F to 1.2·10⁻¹⁵ (two phases of 6·10⁻¹⁶) over κF' > 3, and two
/// roundings, of nπ and of κ.
const CLAIMED_POLE: f64 = 8e-16;

fn fixture(name: &str) -> Value {
    let path = format!("{}/fixtures/reference/{name}", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&std::fs::read_to_string(path).expect("fixture exists")).expect("fixture is JSON")
}

fn rows(fixture: &Value) -> &[Value] {
    fixture["rows"].as_array().expect("fixture has rows")
}

/// A decimal string of up to 25 digits, rounded to the nearest `f64` (relative error 2⁻⁵³).
fn number(value: &Value) -> f64 {
    value.as_str().expect("numbers are strings").parse().expect("a decimal number")
}

fn annulus(inner_radius: f64, outer_radius: f64) -> Annulus {
    Annulus::new(inner_radius, outer_radius).expect("radii are in order")
}

/// The worst row of a comparison, printed with `cargo test -- --nocapture`.
#[derive(Default)]
struct Worst {
    share: f64,
    what: String,
    count: usize,
}

impl Worst {
    /// Takes an error in units of what is allowed for it.
    fn take(&mut self, share: f64, what: impl FnOnce() -> String) {
        self.count += 1;
        // NaN counts as the worst, and stays.
        if share > self.share || share.is_nan() {
            self.share = share;
            self.what = what();
        }
    }

    fn finish(self, name: &str, row_count: usize) {
        println!("{name}: {} rows, worst {:.2e} of what is allowed: {}", self.count, self.share, self.what);
        assert_eq!(self.count, row_count, "{name}: rows compared");
        assert!(self.share <= 1.0, "{name}: {} times what is allowed: {}", self.share, self.what);
    }
}

fn elastic_agrees<const D: usize>(name: &str, tolerance: f64) {
    let fixture = fixture(name);
    let mut worst = Worst::default();
    for row in rows(&fixture) {
        let (outer, radius, expected) = (number(&row[0]), number(&row[1]), number(&row[2]));
        let medium = Elastic::<D>::new(annulus(0.5, outer), 1.0).expect("valid");
        let error = (medium.value(radius) - expected).abs();
        let share = if expected == 0.0 { error * 1e300 } else { error / expected / tolerance };
        worst.take(share, || row.to_string());
    }
    worst.finish(name, rows(&fixture).len());
}

#[test]
fn elastic_solution_has_its_digits_up_to_the_rim() {
    // Roundings of half an ulp: r/R, its sum, R − r, their product, the same at a, quotient, a/r and its power, two
    // products; 12 at most in two dimensions, 16 in three, and one more in reading the fixture.
    elastic_agrees::<2>("annulus_elastic.json", 13.0 * 0.5 * f64::EPSILON);
    elastic_agrees::<3>("annulus_elastic_3d.json", 17.0 * 0.5 * f64::EPSILON);
}

fn poles_agree<const D: usize>(name: &str) {
    let fixture = fixture(name);
    let mut worst = Worst::default();
    for row in rows(&fixture) {
        let index = row["n"].as_u64().expect("an index") as usize;
        let (high, low) = (number(&row["k_f64"]), number(&row["k_lo"]));
        let found = pole::<D>(annulus(0.5, number(&row["R"])), index);
        worst.take(((found - high) - low).abs() / high / CLAIMED_POLE, || row.to_string());
    }
    worst.finish(name, rows(&fixture).len());
}

#[test]
fn poles_are_the_zeros_of_the_cross_product() {
    poles_agree::<2>("bessel_cross_zeros.json");
    poles_agree::<3>("spherical_cross_zeros.json");
}

/// 1 + κ_n/|κ − κ_n|, the condition of the profile in κ; pole n to twice the digits if the fixture has it.
fn condition<const D: usize>(annulus: Annulus, wavenumber: f64, tag: &str, zeros: &Value) -> f64 {
    let below = pole_count_below::<D>(annulus, wavenumber);
    let grid = [below, below + 1]
        .into_iter()
        .filter(|&index| index > 0)
        .map(|index| pole::<D>(annulus, index))
        .map(|pole| pole / (wavenumber - pole).abs())
        .fold(1.0, |sum, term| sum + term);
    if tag == "grid" {
        return grid;
    }
    let index: u64 = tag["pole_n".len()..].split('_').next().expect("an index").parse().expect("a number");
    let zero = rows(zeros)
        .iter()
        .find(|row| row["n"] == index && number(&row["R"]) == annulus.outer_radius())
        .expect("the zero is in the fixture");
    let (high, low) = (number(&zero["k_f64"]), number(&zero["k_lo"]));
    1.0 + high / ((wavenumber - high) - low).abs()
}

fn profiles_agree<const D: usize>(name: &str, zeros: &str) {
    let (fixture, zeros) = (fixture(name), fixture(zeros));
    let (mut worst, mut off_nodes) = (Worst::default(), Worst::default());
    let mut pole_rows = 0;
    let mut last: Option<(f64, f64, Result<Screened<D>, ReferenceError>)> = None;
    for row in rows(&fixture) {
        let (outer, wavenumber, radius, expected) =
            (number(&row[0]), number(&row[1]), number(&row[2]), number(&row[3]));
        let tag = row[4].as_str().expect("a tag");
        let annulus = annulus(0.5, outer);
        if last.as_ref().is_none_or(|(o, k, _)| (*o, *k) != (outer, wavenumber)) {
            last = Some((outer, wavenumber, Screened::<D>::new(annulus, 1.0, wavenumber)));
        }
        let (_, _, medium) = last.as_ref().expect("just set");
        // The two numbers nearest to a pole are the pole to rounding; every other row must have a value.
        if tag.ends_with("nearest_f64") || tag.ends_with("prev_f64") {
            let wanted: usize = tag["pole_n".len()..].split('_').next().expect("an index").parse().expect("a number");
            let named = matches!(medium, Err(ReferenceError::AtPole { index, .. }) if *index == wanted);
            assert!(named, "{row}: {medium:?}");
            pole_rows += 1;
            continue;
        }
        let medium = medium.as_ref().unwrap_or_else(|error| panic!("{row}: {error}"));
        let allowed = CLAIMED * condition::<D>(annulus, wavenumber, tag, &zeros);
        let error = (medium.value(radius) - expected).abs();
        // Amplitude of the oscillation the value is a point of: its quarter wave is 1/κ, or r where r is smaller.
        let envelope = expected.hypot(medium.derivative(radius) * radius.min(1.0 / wavenumber));
        let near_node = expected.abs() < 0.1 * envelope && radius < 0.9 * outer;
        let share = |scale: f64| if expected == 0.0 { error * 1e300 } else { error / scale / allowed };
        let scale = if near_node { envelope } else { expected.abs() };
        worst.take(share(scale), || format!("{row}, condition {:.1e}", allowed / CLAIMED));
        if !near_node && tag == "grid" {
            off_nodes.take(share(expected.abs()), || row.to_string());
        }
    }
    let count = off_nodes.count;
    off_nodes.finish(&format!("{name}, plain relative error away from nodes"), count);
    worst.finish(name, rows(&fixture).len() - pole_rows);
    // 5 radii of the rim, 4 poles, 2 numbers each, 17 distances.
    assert_eq!(pole_rows, 5 * 4 * 2 * 17);
}

#[test]
fn screened_profile_in_two_dimensions_has_the_digits_its_condition_allows() {
    profiles_agree::<2>("bessel_profile.json", "bessel_cross_zeros.json");
}

#[test]
fn screened_profile_in_three_dimensions_has_the_digits_its_condition_allows() {
    profiles_agree::<3>("spherical_profile.json", "spherical_cross_zeros.json");
}

/// Rims, wavenumbers and inner radii that visit all routes of the rim solution: thin and wide gaps, κR from 10⁻³ to 10³.
fn cases() -> impl Iterator<Item = (Annulus, f64)> {
    let gaps = [(0.5, 42.0), (0.5, 171.22479204766086), (1.0, 1.01), (3.0, 4.0), (1e-6, 1.0), (30.0, 900.0)];
    let arguments = [1e-3, 0.1, 1.0, 2.9, 5.3, 12.0, 24.0, 27.0, 90.0, 260.0, 1e3];
    gaps.into_iter().flat_map(move |(inner, outer)| {
        arguments.into_iter().map(move |argument| (annulus(inner, outer), argument / outer))
    })
}

/// `count` radii across the annulus, dense near both ends.
fn radii(annulus: Annulus, count: usize) -> impl Iterator<Item = f64> {
    let (inner, outer) = (annulus.inner_radius(), annulus.outer_radius());
    (1..count).map(move |step| inner + (outer - inner) * 0.5 * (1.0 - (PI * step as f64 / count as f64).cos()))
}

#[test]
fn boundary_values_are_exact() {
    for (annulus, wavenumber) in cases() {
        let two = Screened::<2>::new(annulus, 0.1, wavenumber).expect("no pole");
        let three = Screened::<3>::new(annulus, 0.1, wavenumber).expect("no pole");
        for medium in [&two as &dyn RadialSolution, &three] {
            assert_eq!(medium.value(annulus.inner_radius()), 0.1);
            assert_eq!(medium.value(annulus.outer_radius()), 0.0);
            assert!(medium.value(annulus.inner_radius() * 0.999).is_nan());
            assert!(medium.derivative(annulus.outer_radius() * 1.001).is_nan());
        }
    }
}

#[test]
fn zero_wavenumber_is_the_elastic_solution_bit_for_bit() {
    let annulus = annulus(0.5, 42.0);
    for wavenumber in [0.0, 1e-12] {
        let screened = Screened::<2>::new(annulus, 0.1, wavenumber).expect("no pole");
        let elastic = Elastic::<2>::new(annulus, 0.1).expect("valid");
        for radius in radii(annulus, 50) {
            assert_eq!(screened.value(radius), elastic.value(radius));
            assert_eq!(screened.derivative(radius), elastic.derivative(radius));
        }
    }
}

fn elastic_derivative_is_the_limit<const D: usize>() {
    for (inner, outer) in [(0.5, 42.0), (3.0, 4.0)] {
        let annulus = annulus(inner, outer);
        let elastic = Elastic::<D>::new(annulus, 0.1).expect("valid");
        // κR just above where the elastic formula takes over: both routes, (κR)²/8 = 5·10⁻¹⁷ apart.
        let screened = Screened::<D>::new(annulus, 0.1, 2e-8 / outer).expect("no pole");
        for radius in radii(annulus, 50) {
            let (limit, found) = (screened.derivative(radius), elastic.derivative(radius));
            assert!((found / limit - 1.0).abs() < CLAIMED, "{found}, not {limit} at {radius}");
        }
    }
}

#[test]
fn elastic_derivative_is_the_limit_of_the_screened_one() {
    elastic_derivative_is_the_limit::<2>();
    elastic_derivative_is_the_limit::<3>();
}

fn elastic_limit_has_second_order<const D: usize>(coefficient: f64) {
    let annulus = annulus(0.5, 42.0);
    let elastic = Elastic::<D>::new(annulus, 1.0).expect("valid");
    // Next to the rim the relative difference is (κR)² times a known coefficient (1/8, 1/10) times 1 + O(a/R).
    let radius = 41.999;
    let difference = |argument: f64| {
        let screened = Screened::<D>::new(annulus, 1.0, argument / 42.0).expect("no pole");
        screened.value(radius) / elastic.value(radius) - 1.0
    };
    for argument in [1e-3, 1e-2, 1e-1] {
        let (one, two) = (difference(argument), difference(2.0 * argument));
        // Next order: (κR)⁴ with a coefficient below 1/64, at 2κR; rounding: 10⁻¹⁵ of a difference of 10⁻⁷.
        let slope = (two / one).log2();
        assert!((slope - 2.0).abs() < argument * argument + 1e-7, "slope {slope} at {argument}");
        assert!((one / (argument * argument) - coefficient).abs() < 0.03 * coefficient, "{one} at {argument}");
    }
}

#[test]
fn screened_tends_to_elastic_with_the_square_of_the_wavenumber() {
    elastic_limit_has_second_order::<2>(1.0 / 8.0);
    elastic_limit_has_second_order::<3>(1.0 / 10.0);
}

fn equation_and_derivative_hold<const D: usize>() {
    let mut worst = Worst::default();
    let mut count = 0;
    for (annulus, wavenumber) in cases() {
        let medium = RimSolution::<D>::new(annulus, wavenumber).expect("valid");
        for radius in radii(annulus, 60) {
            // Length over which the solution changes.
            let length = radius.min(1.0 / wavenumber);
            let envelope = medium.value(radius).hypot(length * medium.derivative(radius));
            let step = (1e-4 * length).min(annulus.outer_radius() - radius).min(radius - annulus.inner_radius());
            // What the step is after rounding.
            let (left, right) = (radius - step, radius + step);
            let central = |f: &dyn Fn(f64) -> f64| (f(right) - f(left)) / (right - left);
            // Difference quotients err by step² f'''/6, f''' up to 24 envelopes/length³ where r^(1−D) rules, and by the
            // roundings of f and of the equation's terms over the step, 5·10⁻¹⁵ envelopes.
            let relative_step = step / length;
            let allowed = envelope / length * (4.0 * relative_step * relative_step + 5e-15 / relative_step);
            let slope = medium.derivative(radius);
            let error = (central(&|r| medium.value(r)) - slope).abs();
            worst.take(error / allowed, || format!("derivative at {radius}, {wavenumber}, {annulus:?}"));
            let curvature = central(&|r| medium.derivative(r));
            let (n, value) = ((D - 1) as f64, medium.value(radius));
            let residual =
                curvature + n * slope / radius - n * value / (radius * radius) + wavenumber * wavenumber * value;
            // The same, one order up: the fourth derivative is up to 120 envelopes/length⁴.
            let allowed = envelope / (length * length) * (20.0 * relative_step * relative_step + 2e-14 / relative_step);
            worst.take(residual.abs() / allowed, || format!("equation at {radius}, {wavenumber}, {annulus:?}"));
            count += 2;
        }
    }
    worst.finish("equation and derivative", count);
}

#[test]
fn rim_solution_solves_its_equation_and_knows_its_derivative() {
    equation_and_derivative_hold::<2>();
    equation_and_derivative_hold::<3>();
}

#[test]
fn rim_solution_leaves_the_rim_with_unit_slope() {
    for (annulus, wavenumber) in cases().chain([(annulus(0.5, 42.0), 0.0)]) {
        // Nothing but a few roundings stands between the formula and −1.
        let slopes = [
            RimSolution::<2>::new(annulus, wavenumber).expect("valid").derivative(annulus.outer_radius()),
            RimSolution::<3>::new(annulus, wavenumber).expect("valid").derivative(annulus.outer_radius()),
        ];
        assert!(slopes.iter().all(|slope| (slope + 1.0).abs() < 4.0 * f64::EPSILON), "{slopes:?}");
    }
}

#[test]
fn routes_of_the_rim_solution_meet() {
    // The series ends at r = R/e or R − r = 1.2/κ, modulus and phase begin at r = 2/κ, their expansion at 25/κ.
    // In the last two κR is rounded by 10⁻¹³ and 10⁻¹¹: the bracket has to put that back to meet the others.
    let media = [(42.0, 0.02), (42.0, 0.09), (42.0, 0.7), (42.0, 3.0), (41.7, 39.9), (9876.543, 29.3)];
    for (outer, wavenumber) in media {
        let annulus = annulus(0.5, outer);
        let medium = RimSolution::<2>::new(annulus, wavenumber).expect("valid");
        let ends =
            [f64::max(outer / std::f64::consts::E, outer - 1.2 / wavenumber), 2.0 / wavenumber, 25.0 / wavenumber];
        for seam in ends {
            if !annulus.contains(seam) {
                continue;
            }
            let (left, right) = (seam * (1.0 - 1e-13), seam * (1.0 + 1e-13));
            // The step explains (right − left) times the slope; its square is far below rounding.
            let length = seam.min(1.0 / wavenumber);
            let envelope = medium.value(seam).hypot(medium.derivative(seam) * length);
            let jump = medium.value(right) - medium.value(left) - (right - left) * medium.derivative(seam);
            assert!(jump.abs() < CLAIMED * envelope, "{jump} of {envelope} at {seam}, {wavenumber}");
            // The slope changes by the curvature, at most 3 envelopes/length², times the step.
            let turn = (medium.derivative(right) - medium.derivative(left)) * length;
            let step = 3.0 * (right - left) / length;
            assert!(turn.abs() < (2.0 * CLAIMED + step) * envelope, "{turn} of {envelope} at {seam}, {wavenumber}");
        }
    }
}

#[test]
fn values_of_the_literature_hold() {
    // κ_n R for a ≪ R: the zeros of J_1, and of tan y = y; they differ by O((a/R)²) and O((a/R)³).
    let wide = annulus(1e-7, 1.0);
    for (index, zero) in [(1, 3.831705970207512), (2, 7.015586669815619), (3, 10.173468135062722)] {
        assert!((pole::<2>(wide, index) - zero).abs() < 1e-12);
    }
    for (index, zero) in [(1, 4.493409457909064), (2, 7.725251836937707)] {
        assert!((pole::<3>(wide, index) - zero).abs() < 1e-14 * zero);
    }
    // 67352 disks: κ_1 ≈ 0.022, κ_2 ≈ 0.041.
    let circle = annulus(0.5, 171.22479204766086);
    assert!((pole::<2>(circle, 1) - 0.0223788).abs() < 5e-8);
    assert!((pole::<2>(circle, 2) - 0.0409749).abs() < 5e-8);
}

#[test]
fn lengths_scale() {
    // A power of two scales every number without rounding.
    let (one, other) = (annulus(0.5, 42.0), annulus(4.0, 336.0));
    for wavenumber in [0.01, 0.1, 1.0, 10.0] {
        let medium = Screened::<2>::new(one, 0.1, wavenumber).expect("no pole");
        let scaled = Screened::<2>::new(other, 0.8, wavenumber / 8.0).expect("no pole");
        for radius in radii(one, 40) {
            assert_eq!(8.0 * medium.value(radius), scaled.value(8.0 * radius));
            assert_eq!(medium.derivative(radius), scaled.derivative(8.0 * radius));
        }
    }
}

#[test]
fn bad_arguments_are_named() {
    for inner_radius in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = Annulus::new(inner_radius, 42.0).expect_err("bad inner radius");
        assert!(matches!(error, ReferenceError::InnerRadiusNotPositive { .. }), "{error}");
    }
    for outer_radius in [0.5, 0.1, f64::NAN, f64::INFINITY] {
        let error = Annulus::new(0.5, outer_radius).expect_err("bad outer radius");
        assert!(matches!(error, ReferenceError::OuterRadiusNotLarger { .. }), "{error}");
    }
    let annulus = annulus(0.5, 42.0);
    for wavenumber in [-0.1, f64::NAN, f64::INFINITY, f64::MAX] {
        let error = Screened::<2>::new(annulus, 0.1, wavenumber).expect_err("bad wavenumber");
        assert!(matches!(error, ReferenceError::WavenumberNegative { .. }), "{error}");
    }
    for amplitude in [f64::NAN, f64::NEG_INFINITY] {
        let error = Screened::<3>::new(annulus, amplitude, 0.1).expect_err("bad amplitude");
        assert!(matches!(error, ReferenceError::AmplitudeNotFinite { .. }), "{error}");
        assert!(Elastic::<2>::new(annulus, amplitude).is_err());
    }
    // All the numbers are in the message.
    let pole = pole::<2>(annulus, 3);
    let message = Screened::<2>::new(annulus, 0.1, pole).expect_err("a pole").to_string();
    assert!(message.contains(&pole.to_string()) && message.contains('3'), "{message}");
}
