//! [`ShellSample`]: the spheres of one shell, their directions and their values.

use serde::Serialize;

use crate::displacement::DisplacementField;
use crate::observe::shell::error::{LEAST_DISK_COUNT, ShellError};
use crate::vector::{Vector, norm, scaled};

/// The squares of larger values overflow.
const LARGEST_VALUE: f64 = 1e150;

/// A standard deviation below this share of the mean is rounding: the values have no fluctuation.
const LEAST_SPREAD: f64 = 8.0 * f64::EPSILON;

/// Directions and values of the spheres of a shell, in ascending order of directions; at equal directions, of values.
///
/// The result does not depend on the order of the spheres given. There are at least [`LEAST_DISK_COUNT`], and their
/// values are not all equal.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShellSample {
    directions: Vec<Vector<3>>,
    fluctuations: Vec<f64>,
    mean: f64,
    variance: f64,
}

impl ShellSample {
    /// A shell from directions, vectors of any length, and values.
    ///
    /// # Errors
    /// Different lengths, too few spheres, a direction of length zero, numbers that are not finite or above 10¹⁵⁰,
    /// equal values.
    pub fn new(directions: &[Vector<3>], values: &[f64]) -> Result<Self, ShellError> {
        let disk_count = directions.len();
        if disk_count != values.len() {
            return Err(ShellError::LengthsDiffer { direction_count: disk_count, value_count: values.len() });
        }
        if disk_count < LEAST_DISK_COUNT {
            return Err(ShellError::TooFewDisks { disk_count });
        }
        let mut disks = Vec::with_capacity(disk_count);
        for (disk, (&direction, &value)) in directions.iter().zip(values).enumerate() {
            let length = norm(direction);
            if !(length > 0.0 && length <= LARGEST_VALUE && value.abs() <= LARGEST_VALUE) {
                return Err(ShellError::NotFinite { disk, direction, value });
            }
            // Zeros get one sign, so that total_cmp treats them as equal.
            disks.push((scaled(1.0 / length, direction).map(|x| x + 0.0), value + 0.0));
        }
        disks.sort_unstable_by(|a: &(Vector<3>, f64), b| {
            let components = a.0.iter().zip(&b.0).map(|(x, y)| x.total_cmp(y));
            components.fold(std::cmp::Ordering::Equal, |order, next| order.then(next)).then(a.1.total_cmp(&b.1))
        });
        let count = disk_count as f64;
        let mean = disks.iter().map(|disk| disk.1).sum::<f64>() / count;
        let fluctuations: Vec<f64> = disks.iter().map(|disk| disk.1 - mean).collect();
        let variance = fluctuations.iter().map(|x| x * x).sum::<f64>() / count;
        if variance.sqrt() <= LEAST_SPREAD * mean.abs() || variance == 0.0 {
            return Err(ShellError::NoFluctuation { disk_count, mean });
        }
        let directions = disks.iter().map(|disk| disk.0).collect();
        Ok(ShellSample { directions, fluctuations, mean, variance })
    }

    /// d_r of the spheres of a field that count and have |r/R − `relative_radius`| ≤ `half_width`.
    ///
    /// # Errors
    /// A radius or width out of range; see [`new`](Self::new).
    pub fn of_field(field: &DisplacementField<3>, relative_radius: f64, half_width: f64) -> Result<Self, ShellError> {
        let usable = |number: f64| number > 0.0 && number.is_finite();
        if !(usable(relative_radius) && usable(half_width)) {
            return Err(ShellError::ShellOutOfRange { relative_radius, half_width });
        }
        let within = |distance: f64| (distance / field.outer_radius - relative_radius).abs() <= half_width;
        let (directions, values): (Vec<_>, Vec<_>) =
            field.counted().filter(|disk| within(disk.distance)).map(|disk| (disk.position, disk.radial)).unzip();
        Self::new(&directions, &values)
    }

    /// Number of spheres, n.
    pub fn disk_count(&self) -> usize {
        self.directions.len()
    }

    /// Unit vectors n_i, in ascending order of x, y and z.
    pub fn directions(&self) -> &[Vector<3>] {
        &self.directions
    }

    /// δd_r = d_r − ⟨d_r⟩, in the order of the directions \[length, of a displacement\].
    pub fn fluctuations(&self) -> &[f64] {
        &self.fluctuations
    }

    /// ⟨d_r⟩ \[length, of a displacement\].
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// V = ⟨δd_r²⟩ \[length², of a displacement\].
    pub fn variance(&self) -> f64 {
        self.variance
    }
}
