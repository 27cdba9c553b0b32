//! The radii at which a solution between an inflated disk and a rim is evaluated.

use clap::Args;
use jamscope::reference::Annulus;

use super::annulus::refused;
use super::grid::places;
use crate::Failure;

#[derive(Args)]
pub struct RadiiArguments {
    /// Radii, separated by commas [length].
    #[arg(long, value_name = "LENGTHS", value_delimiter = ',', allow_hyphen_values = true, conflicts_with = "count")]
    radii: Option<Vec<f64>>,
    /// Number of evenly spaced radii from the disk to the rim.
    #[arg(long, value_name = "N", default_value_t = 100)]
    count: u64,
}

impl RadiiArguments {
    /// Checks that all radii are inside the annulus, including its edges.
    pub fn within(&self, annulus: Annulus) -> Result<Box<dyn Iterator<Item = f64> + '_>, Failure> {
        let (inner, outer) = (annulus.inner_radius(), annulus.outer_radius());
        if let Some(radius) = self.radii.iter().flatten().find(|&&radius| !annulus.contains(radius)) {
            return Err(refused("radii", radius, format!("must be between the disk and the rim, {inner} to {outer}")));
        }
        places(self.radii.as_deref(), self.count, inner, outer)
    }
}
