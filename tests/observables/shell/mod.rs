//! Spectra and correlation functions of shells of spheres against what is exactly known of them.

mod correlation;
mod exact;
mod fields;
#[cfg(feature = "fit")]
mod fits;

use std::f64::consts::PI;

use jamscope::displacement::{DisplacementField, MeasuredOn, Moved, Shape};
use jamscope::observe::angular::Leakage;
use jamscope::observe::shell::{DegreeLimit, ShellSample, ShellSpectrumSettings};
use jamscope::vector::{Vector, dot};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Independent uniform directions, by the seed.
fn random_directions(count: usize, seed: u64) -> Vec<Vector<3>> {
    let mut random = Pcg64::seed_from_u64(seed);
    let direction = |_| {
        let (z, angle) = (2.0 * random.random::<f64>() - 1.0, 2.0 * PI * random.random::<f64>());
        let across = (1.0 - z * z).sqrt();
        [across * angle.cos(), across * angle.sin(), z]
    };
    (0..count).map(direction).collect()
}

/// Half of the directions within 60° of the north pole.
fn clustered_directions(count: usize, seed: u64) -> Vec<Vector<3>> {
    let raise = |(k, n): (usize, Vector<3>)| {
        let z = if k % 2 == 0 { 0.75 + 0.25 * n[2] } else { n[2] };
        let factor = ((1.0 - z * z) / (1.0 - n[2] * n[2])).sqrt();
        [factor * n[0], factor * n[1], z]
    };
    random_directions(count, seed).into_iter().enumerate().map(raise).collect()
}

/// The values of a function of the direction.
fn shell(directions: &[Vector<3>], value: impl Fn(Vector<3>) -> f64) -> ShellSample {
    let values: Vec<f64> = directions.iter().map(|&direction| value(direction)).collect();
    ShellSample::new(directions, &values).expect("finite directions and values")
}

fn up_to(degree: usize, leakage: Leakage) -> ShellSpectrumSettings {
    ShellSpectrumSettings { leakage, degree_limit: DegreeLimit::Fixed(degree) }
}

/// P_0, …, P_limit at a cosine, by the plain recursion.
fn legendre(cosine: f64, limit: usize) -> Vec<f64> {
    let mut values = vec![1.0, cosine];
    for degree in 1..limit {
        let l = degree as f64;
        values.push(((2.0 * l + 1.0) * cosine * values[degree] - l * values[degree - 1]) / (l + 1.0));
    }
    values.truncate(limit + 1);
    values
}

/// The rotation by `angle` about the axis (1, 2, 2)/3.
fn rotated(angle: f64, n: Vector<3>) -> Vector<3> {
    let axis = [1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0];
    let (sine, cosine) = angle.sin_cos();
    let along = dot(axis, n) * (1.0 - cosine);
    let cross = [axis[1] * n[2] - axis[2] * n[1], axis[2] * n[0] - axis[0] * n[2], axis[0] * n[1] - axis[1] * n[0]];
    std::array::from_fn(|d| cosine * n[d] + sine * cross[d] + along * axis[d])
}

/// A field of spheres at these positions that count, with d_r by a function of the position.
fn field(positions: &[Vector<3>], outer_radius: f64, radial: impl Fn(Vector<3>) -> f64) -> DisplacementField<3> {
    let disks = positions.iter().enumerate().map(|(disk, &position)| {
        let (distance, radial) = (dot(position, position).sqrt(), radial(position));
        let displacement = position.map(|x| radial * x / distance);
        Moved { disk, position, distance, displacement, radial, counted: true }
    });
    let measured_on = MeasuredOn::Backbone;
    DisplacementField { disks: disks.collect(), inner_radius: 0.5, outer_radius, shape: Shape::Round, measured_on }
}
