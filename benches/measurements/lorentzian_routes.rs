//! Error against run time of ways to the correlation function of a Lorentzian, G(θ) = Σ S(f) cos fθ / Σ S(f), s = 1.5.
//!
//! ```text
//! cargo run --release --features measurements --example lorentzian_routes
//! ```
//!
//! The error is the largest over 104 values of 25 digits, f† from 0.01 to 1000 and θ from 0.001 to π
//! (`fixtures/reference/lorentzian.json`, the source of Σ S for all routes but the last two). The time is that of one G at
//! f† = 5 and at f† = 1000, θ evenly spaced in (0, π], the median of five runs; the last route sets up a curve of so many
//! angles first. Routes:
//!
//! - **direct**: the first so many terms;
//! - **by parts**: the first 2000 + 2 f† terms and summation by parts, three terms, beyond;
//! - **Abel–Plana tail**: the first max(8, 2 f†) terms, beyond them an integral along the imaginary axis with so many nodes
//!   t = exp(x − e^(−x)), evenly spaced in x;
//! - **Lorentzian**: [`jamscope::reference::lorentzian`].

use std::error::Error;
use std::f64::consts::PI;
use std::time::Instant;

use jamscope::reference::lorentzian::{Lorentzian, USUAL_EXPONENT};
use serde_json::Value;

/// Angles of a timed curve.
const CURVE: usize = 1000;

fn main() -> Result<(), Box<dyn Error>> {
    let path = format!("{}/fixtures/reference/lorentzian.json", env!("CARGO_MANIFEST_DIR"));
    let rows = Rows::read(&std::fs::read_to_string(path)?)?;
    println!("{:<34} {:>12} {:>14} {:>14}", "route", "error of G", "ns, f† = 5", "ns, f† = 1000");
    for exponent in 3..=6 {
        let last = 10_u32.pow(exponent);
        rows.report(&format!("direct, 10^{exponent} terms"), &|crossover, angle| direct(crossover, angle, last))?;
    }
    rows.report("by parts", &by_parts)?;
    for nodes in [40, 60, 80] {
        rows.report(&format!("Abel–Plana tail, {nodes} nodes"), &|crossover, angle| {
            abel_plana_tail(crossover, angle, nodes)
        })?;
    }
    let error =
        rows.largest_error(&|crossover, angle, _| Ok(Lorentzian::new(crossover, USUAL_EXPONENT)?.correlation(angle)))?;
    let time = |crossover: f64, count: usize| -> Result<f64, Box<dyn Error>> {
        Ok(median(&|| {
            let medium = Lorentzian::new(crossover, USUAL_EXPONENT)?;
            Ok(angles(count).map(|angle| medium.correlation(angle)).sum())
        })? / count as f64)
    };
    for count in [1, 100, CURVE, 100_000] {
        let name = format!("Lorentzian, a curve of {count}");
        println!("{name:<34} {error:>12.1e} {:>14.0} {:>14.0}", time(5.0, count)?, time(1000.0, count)?);
    }
    Ok(())
}

/// Values of the fixture: f†, Σ 1/(1 + (f/f†)^s), θ, G.
struct Rows(Vec<[f64; 4]>);

/// A route: Σ cos fθ/(1 + (f/f†)^s) at f† and θ.
type Route<'a> = &'a dyn Fn(f64, f64) -> f64;

impl Rows {
    fn read(text: &str) -> Result<Self, Box<dyn Error>> {
        let fixture: Value = serde_json::from_str(text)?;
        let number = |value: &Value| -> Result<f64, Box<dyn Error>> {
            let text = value.as_str().ok_or("numbers are strings")?;
            Ok(if text == "pi" { PI } else { text.parse()? })
        };
        let totals = fixture["theta_star"].as_array().ok_or("totals")?;
        let mut rows = Vec::new();
        for row in fixture["rows"].as_array().ok_or("rows")? {
            let total = totals.iter().find(|total| total["fd"] == row[0]).ok_or("a total for every row")?;
            rows.push([number(&row[0])?, number(&total["norm_sum"])?, number(&row[1])?, number(&row[2])?]);
        }
        Ok(Rows(rows))
    }

    fn largest_error(&self, g: &dyn Fn(f64, f64, f64) -> Result<f64, Box<dyn Error>>) -> Result<f64, Box<dyn Error>> {
        let mut largest = 0.0;
        for &[crossover, total, angle, expected] in &self.0 {
            largest = jamscope::vector::larger(largest, (g(crossover, angle, total)? - expected).abs());
        }
        Ok(largest)
    }

    fn report(&self, name: &str, route: Route) -> Result<(), Box<dyn Error>> {
        let error = self.largest_error(&|crossover, angle, total| Ok(route(crossover, angle) / total))?;
        let time = |crossover: f64| -> Result<f64, Box<dyn Error>> {
            // A curve, or as many angles of it as take some 10 ms.
            let start = Instant::now();
            route(crossover, 1.0);
            let count = (1e-2 / start.elapsed().as_secs_f64()).clamp(1.0, CURVE as f64) as usize;
            Ok(median(&|| Ok(angles(count).map(|angle| route(crossover, angle)).sum()))? / count as f64)
        };
        println!("{name:<34} {error:>12.1e} {:>14.0} {:>14.0}", time(5.0)?, time(1000.0)?);
        Ok(())
    }
}

fn angles(count: usize) -> impl Iterator<Item = f64> {
    (1..=count).map(move |n| PI * n as f64 / count as f64)
}

/// Nanoseconds of a run, the median of five.
fn median(run: &dyn Fn() -> Result<f64, Box<dyn Error>>) -> Result<f64, Box<dyn Error>> {
    let mut times = Vec::new();
    for _ in 0..5 {
        let start = Instant::now();
        std::hint::black_box(run()?);
        times.push(start.elapsed().as_secs_f64() * 1e9);
    }
    times.sort_by(f64::total_cmp);
    Ok(times[2])
}

fn spectrum(crossover: f64, frequency: f64) -> f64 {
    let ratio = frequency / crossover;
    1.0 / (1.0 + ratio * ratio.sqrt())
}

fn direct(crossover: f64, angle: f64, last: u32) -> f64 {
    // Terms by turning (cos, sin) once a term, from the first: the rounding grows as their number.
    let (sine, cosine) = angle.sin_cos();
    let (mut c, mut s, mut sum) = (1.0, 0.0, 0.0);
    for f in 1..=last {
        (c, s) = (c * cosine - s * sine, s * cosine + c * sine);
        sum += spectrum(crossover, f64::from(f)) * c;
    }
    sum
}

/// Σ_(f ≥ F) S z^f = z^F/(1−z) Σ_j (z/(1−z))^j Δ^j S(F), with z = e^(iθ).
fn by_parts(crossover: f64, angle: f64) -> f64 {
    let last = (2000.0 + 2.0 * crossover).ceil();
    let values = [0.0, 1.0, 2.0].map(|step| spectrum(crossover, last + step));
    let differences = [values[0], values[1] - values[0], values[2] - 2.0 * values[1] + values[0]];
    let cotangent = 1.0 / (0.5 * angle).tan();
    let (mut re, mut im) = (0.0, 0.0);
    let (mut x, mut y) = (0.5, 0.5 * cotangent);
    for difference in differences {
        (re, im) = (re + x * difference, im + y * difference);
        (x, y) = (-0.5 * x - 0.5 * cotangent * y, 0.5 * cotangent * x - 0.5 * y);
    }
    let (sine, cosine) = (last * angle).sin_cos();
    direct(crossover, angle, last as u32 - 1) + re * cosine - im * sine
}

/// Σ_(f ≥ F) S z^f = z^F {S(F)/2 + i ∫_0^∞ [S(F+it) e^(−θt) − S(F−it) e^((θ−2π)t)]/(1 − e^(−2πt)) dt}.
fn abel_plana_tail(crossover: f64, angle: f64, node_count: usize) -> f64 {
    let from = 8.0_f64.max((2.0 * crossover).ceil());
    // S is below 10⁻¹⁷ of its part before the left end; e^(−θt) is at the right one.
    let (left, right) = (-3.7, (38.0 / angle).ln());
    let step = (right - left) / (node_count - 1) as f64;
    let (mut re, mut im) = (0.5 * spectrum(crossover, from), 0.0);
    for node in 0..node_count {
        let x = left + step * node as f64;
        let t = (x - (-x).exp()).exp();
        let weight = step * t * (1.0 + (-x).exp()) / -(-2.0 * PI * t).exp_m1();
        // S(F + it): the power 1.5 in polar form.
        let power = (from.hypot(t) / crossover).powf(USUAL_EXPONENT);
        let (sine, cosine) = (USUAL_EXPONENT * t.atan2(from)).sin_cos();
        let (a, b) = (1.0 + power * cosine, power * sine);
        let (u, v) = (a / (a * a + b * b), -b / (a * a + b * b));
        let (near, far) = ((-angle * t).exp(), ((angle - 2.0 * PI) * t).exp());
        // i [(u + iv) near − (u − iv) far].
        re -= weight * v * (near + far);
        im += weight * u * (near - far);
    }
    let (sine, cosine) = (from * angle).sin_cos();
    direct(crossover, angle, from as u32 - 1) + re * cosine - im * sine
}
