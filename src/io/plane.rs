//! [`Plane`]: whether all disks of a file in three coordinates lie in one plane.

use crate::io::read_error::ReadError;
use crate::io::source::Source;

/// Largest difference of z over the largest radius at which disks lie in one plane \[1\]. It changes a distance of
/// two disks by less than its square, 10⁻¹⁸ of a radius, which is below the rounding of the coordinates.
pub(super) const FLATNESS: f64 = 1e-9;

/// The third coordinates of the disks of a plane, which must be equal.
pub(super) struct Plane {
    /// z and line of the first disk.
    first: Option<f64>,
    /// Largest distance from it, with its line and text.
    farthest: (f64, usize, String),
}

impl Plane {
    pub fn new() -> Self {
        Plane { first: None, farthest: (0.0, 0, String::new()) }
    }

    /// Takes z of a disk, with its line and text.
    pub fn take(&mut self, z: f64, line: usize, text: &str) {
        let distance = (z - *self.first.get_or_insert(z)).abs();
        if distance > self.farthest.0 {
            self.farthest = (distance, line, text.into());
        }
    }

    /// Refuses disks that do not lie in one plane. `spacing` is that of the numbers of the file, if it is known.
    pub fn check(
        &self,
        source: &Source,
        field: &'static str,
        largest_radius: f64,
        spacing: f64,
    ) -> Result<(), ReadError> {
        let (distance, line, text) = &self.farthest;
        if *distance <= FLATNESS * largest_radius + spacing {
            return Ok(());
        }
        Err(source.dimension(*line, field, text, 2))
    }
}
