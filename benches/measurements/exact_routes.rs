//! Error against run time of the ways to evaluate the screened profile, as tables in markdown.
//!
//! ```text
//! cargo run --release --features measurements --example exact_routes
//! ```
//!
//! d/d_0 in two dimensions at the points of `fixtures/reference/bessel_profile.json`, whose values have 25 digits. Errors are
//! relative, in two parts of the annulus, without the points next to a node or to a pole (where the condition of the problem
//! shows and no route); a rounding is 1.1·10⁻¹⁶. Times are a median of repeated passes over all points of a table row, the set-up of
//! each κ not counted. A second table has the Bessel functions against multi-precision.

#[path = "../../tests/twins/precise_bessel.rs"]
mod precise_bessel;

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

use jamscope::reference::bessel::modified;
use jamscope::reference::elastic::Elastic;
use jamscope::reference::poles::{pole, pole_count_below};
use jamscope::reference::screened::Screened;
use jamscope::reference::{Annulus, RadialSolution};
use precise_bessel::{Functions, Real, real, rounded};
use serde_json::Value;

const INNER_RADIUS: f64 = 0.5;

/// J_1 and Y_1 of κr, from κ and r.
type Pair = fn(f64, f64) -> (f64, f64);

/// d/d_0 as a function of r.
type Profile = Box<dyn Fn(f64) -> f64>;

fn of_libm(wavenumber: f64, radius: f64) -> (f64, f64) {
    let x = wavenumber * radius;
    (libm::j1(x), libm::y1(x))
}

fn of_puruspe(wavenumber: f64, radius: f64) -> (f64, f64) {
    let x = wavenumber * radius;
    (puruspe::bessel::Jn(1, x), puruspe::bessel::Yn(1, x))
}

/// With what rounding took from the product put back by a fused multiplication.
fn product_put_back(wavenumber: f64, radius: f64) -> (f64, f64) {
    let x = wavenumber * radius;
    let low = wavenumber.mul_add(radius, -x);
    let (j, y) = (libm::j1(x), libm::y1(x));
    (j + low * (libm::j0(x) - j / x), y + low * (libm::y0(x) - y / x))
}

/// One way to evaluate d/d_0: set up for one κ, then a function of r.
enum Route {
    Bracket(&'static str, Pair),
    Elastic,
    Ours,
}

impl Route {
    fn name(&self) -> &'static str {
        match self {
            Route::Bracket(name, _) => name,
            Route::Elastic => "elastic formula",
            Route::Ours => "`Screened`",
        }
    }

    fn prepared(&self, annulus: Annulus, wavenumber: f64) -> Result<Profile, Box<dyn Error>> {
        Ok(match self {
            Route::Bracket(_, pair) => {
                let pair = *pair;
                let rim = pair(wavenumber, annulus.outer_radius());
                let bracket = move |radius: f64| {
                    let (j, y) = pair(wavenumber, radius);
                    y * rim.0 - j * rim.1
                };
                let inner = bracket(annulus.inner_radius());
                Box::new(move |radius| bracket(radius) / inner)
            }
            Route::Elastic => {
                let medium = Elastic::<2>::new(annulus, 1.0)?;
                Box::new(move |radius| medium.value(radius))
            }
            Route::Ours => {
                let medium = Screened::<2>::new(annulus, 1.0, wavenumber)?;
                Box::new(move |radius| medium.value(radius))
            }
        })
    }
}

/// A point of the fixture.
struct Point {
    outer_radius: f64,
    wavenumber: f64,
    radius: f64,
    exact: f64,
}

fn points() -> Result<Vec<Point>, Box<dyn Error>> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/reference/bessel_profile.json");
    let fixture: Value = serde_json::from_str(&std::fs::read_to_string(path)?)?;
    let number = |value: &Value| -> Result<f64, Box<dyn Error>> { Ok(value.as_str().ok_or("a string")?.parse()?) };
    let mut points = Vec::new();
    for row in fixture["rows"].as_array().ok_or("rows")? {
        let radius = number(&row[2])?;
        let outer_radius = number(&row[0])?;
        if row[4] == "grid" && radius > INNER_RADIUS && radius < outer_radius {
            points.push(Point { outer_radius, wavenumber: number(&row[1])?, radius, exact: number(&row[3])? });
        }
    }
    Ok(points)
}

/// Whether the point is far from a node of the profile, and κ from a pole: where errors are those of the route.
fn is_well_conditioned(point: &Point) -> Result<bool, Box<dyn Error>> {
    let annulus = Annulus::new(INNER_RADIUS, point.outer_radius)?;
    let medium = Screened::<2>::new(annulus, 1.0, point.wavenumber)?;
    let length = point.radius.min(1.0 / point.wavenumber);
    let envelope = point.exact.hypot(length * medium.derivative(point.radius));
    let node = point.exact.abs() < 0.3 * envelope && point.radius < 0.9 * point.outer_radius;
    let below = pole_count_below::<2>(annulus, point.wavenumber);
    let spacing = std::f64::consts::PI / point.outer_radius;
    let near = |index: usize| index > 0 && (pole::<2>(annulus, index) - point.wavenumber).abs() < 0.1 * spacing;
    Ok(!node && !near(below) && !near(below + 1))
}

/// Largest error in the bulk and next to the rim, and ns a point.
fn measured(route: &Route, points: &[&Point]) -> Result<[f64; 3], Box<dyn Error>> {
    let mut prepared: Vec<(Profile, &Point)> = Vec::new();
    for point in points {
        let annulus = Annulus::new(INNER_RADIUS, point.outer_radius)?;
        prepared.push((route.prepared(annulus, point.wavenumber)?, point));
    }
    let mut errors = [0.0_f64; 2];
    for (evaluate, point) in &prepared {
        let error = (evaluate(point.radius) / point.exact - 1.0).abs();
        let rim = usize::from(point.outer_radius - point.radius < 0.02 * point.outer_radius);
        // A NaN is the worst error there is.
        errors[rim] = if error.is_nan() { f64::INFINITY } else { errors[rim].max(error) };
    }
    let mut times: Vec<f64> = (0..15)
        .map(|_| {
            let start = Instant::now();
            for _ in 0..20 {
                for (evaluate, point) in &prepared {
                    black_box(evaluate(black_box(point.radius)));
                }
            }
            start.elapsed().as_secs_f64() * 1e9 / (20 * prepared.len()) as f64
        })
        .collect();
    times.sort_by(f64::total_cmp);
    Ok([errors[0], errors[1], times[times.len() / 2]])
}

/// A function of one number, and its value in multi-precision with what the error is relative to.
type Compared = (&'static str, fn(f64) -> f64, fn(&Real) -> (Real, f64));

fn over_modulus(functions: Functions, order: usize, second: bool) -> (Real, f64) {
    let [first_kind, second_kind] = [&functions.first[order], &functions.second[order]];
    let modulus = rounded(first_kind).hypot(rounded(second_kind));
    (if second { second_kind } else { first_kind }.clone(), modulus)
}

fn relative(value: &Real) -> (Real, f64) {
    (value.clone(), rounded(value).abs())
}

/// Largest errors of Bessel functions: J, Y, j, y over the modulus, I, K, i relative.
fn bessel_functions() {
    const BITS: usize = 160;
    use puruspe::bessel::{In, Jn, Kn, Yn};
    let functions: [Compared; 14] = [
        ("J_1, libm", libm::j1, |x| over_modulus(precise_bessel::cylinder(x, BITS), 1, false)),
        ("J_1, puruspe", |x| Jn(1, x), |x| over_modulus(precise_bessel::cylinder(x, BITS), 1, false)),
        ("Y_1, libm", libm::y1, |x| over_modulus(precise_bessel::cylinder(x, BITS), 1, true)),
        ("Y_1, puruspe", |x| Yn(1, x), |x| over_modulus(precise_bessel::cylinder(x, BITS), 1, true)),
        ("I_0, puruspe", |x| In(0, x), |x| relative(&precise_bessel::modified(x, BITS).first[0])),
        ("I_0, `modified`", modified::i0, |x| relative(&precise_bessel::modified(x, BITS).first[0])),
        ("I_1, puruspe", |x| In(1, x), |x| relative(&precise_bessel::modified(x, BITS).first[1])),
        ("I_1, `modified`", modified::i1, |x| relative(&precise_bessel::modified(x, BITS).first[1])),
        ("K_0, puruspe", |x| Kn(0, x), |x| relative(&precise_bessel::modified(x, BITS).second[0])),
        ("K_0, `modified`", modified::k0, |x| relative(&precise_bessel::modified(x, BITS).second[0])),
        ("K_1, puruspe", |x| Kn(1, x), |x| relative(&precise_bessel::modified(x, BITS).second[1])),
        ("K_1, `modified`", modified::k1, |x| relative(&precise_bessel::modified(x, BITS).second[1])),
        (
            "j_1, (sin x/x − cos x)/x",
            |x| (x.sin() / x - x.cos()) / x,
            |x| relative(&precise_bessel::spherical(x, BITS).first[1]),
        ),
        (
            "i_1, (cosh x − sinh x/x)/x",
            |x| (x.cosh() - x.sinh() / x) / x,
            |x| relative(&precise_bessel::modified_spherical(x, BITS).first[1]),
        ),
    ];
    let ranges = [(-12.0, -3.0), (-3.0, 0.0), (0.0, 1.5), (1.5, 2.8), (2.86, 3.0), (3.0, 6.0)];
    let heads: Vec<String> = ranges.iter().map(|(low, high)| format!("10^{low} to 10^{high}")).collect();
    println!("\n| function | {} | ns at 7 |\n|---|{}---|", heads.join(" | "), "---|".repeat(ranges.len()));
    for (name, function, precise) in functions {
        let mut cells = Vec::new();
        for (low, high) in ranges {
            let mut worst = 0.0_f64;
            for step in 0..60 {
                let x = 10f64.powf(low + (high - low) * (f64::from(step) + 0.5) / 60.0);
                let (exact, scale) = precise(&real(x, BITS + 64));
                let found = function(x);
                let error =
                    if found.is_finite() { rounded(&(real(found, BITS) - exact)).abs() / scale } else { f64::NAN };
                // What leaves the range of an f64 is neither right nor wrong.
                if scale > 1e-305 && scale < 1e307 {
                    worst = if error.is_nan() { f64::INFINITY } else { worst.max(error) };
                }
            }
            cells.push(if worst > 0.0 { format!("{worst:.1e}") } else { "–".to_owned() });
        }
        let start = Instant::now();
        for _ in 0..200_000 {
            black_box(function(black_box(7.0)));
        }
        println!("| {name} | {} | {:.0} |", cells.join(" | "), start.elapsed().as_secs_f64() * 1e9 / 2e5);
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let points = points()?;
    let mut well_conditioned = Vec::new();
    for point in &points {
        if is_well_conditioned(point)? {
            well_conditioned.push(point);
        }
    }
    let routes = [
        Route::Bracket("bracket, libm", of_libm),
        Route::Bracket("bracket, puruspe", of_puruspe),
        Route::Bracket("bracket, libm, products put back", product_put_back),
        Route::Elastic,
        Route::Ours,
    ];
    println!("| κR | points | route | error, bulk | error, (R−r)/R < 0.02 | ns/point |");
    println!("|---|---|---|---|---|---|");
    for (low, high) in [(0.0, 1e-3), (1e-3, 1.0), (1.0, 30.0), (30.0, 1e3), (1e3, 1e6)] {
        let inside = |point: &&&Point| (low..high).contains(&(point.wavenumber * point.outer_radius));
        let chosen: Vec<&Point> = well_conditioned.iter().filter(inside).copied().collect();
        for route in &routes {
            let [bulk, rim, time] = measured(route, &chosen)?;
            println!(
                "| {low:e} to {high:e} | {} | {} | {bulk:.1e} | {rim:.1e} | {time:.0} |",
                chosen.len(),
                route.name()
            );
        }
    }
    bessel_functions();
    Ok(())
}
