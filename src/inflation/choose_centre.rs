//! The disk to inflate: [`choose_centre`].

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::inflation::error::InflationError;
use crate::inflation::settings::Centre;
use crate::law::pair_law::PairLaw;
use crate::network::ContactNetwork;
use crate::packing::Packing;

/// Picks the disk to inflate.
///
/// # Errors
/// No disk has the label; two disks have the same centre.
pub fn choose_centre<const D: usize>(
    packing: &Packing<D>,
    law: &dyn PairLaw,
    centre: Centre,
    seed: u64,
) -> Result<usize, InflationError> {
    if let Centre::Label(label) = centre {
        let found = packing.labels().iter().position(|&other| other == label);
        return found.ok_or(InflationError::NoSuchLabel { label });
    }
    let smallest = packing.radii().iter().copied().fold(f64::INFINITY, f64::min);
    let small: Vec<usize> = (0..packing.len()).filter(|&disk| packing.radii()[disk] == smallest).collect();
    let backbone = ContactNetwork::new(packing, law)?.backbone;
    let rigid: Vec<usize> = small.iter().copied().filter(|&disk| backbone[disk]).collect();
    let candidates = if centre == Centre::Backbone && !rigid.is_empty() { rigid } else { small };
    let mut generator = Pcg64::seed_from_u64(seed);
    Ok(candidates[generator.random_range(0..candidates.len())])
}
