//! [`ExcessCoordination`]: the number of contacts per disk of a backbone above the isostatic value, ΔZ.
//!
//! ```text
//! ΔZ = Z − 2D        Z = (ends of contacts of the backbone on its mobile disks) / (mobile disks of the backbone)
//! ```
//!
//! # Source
//! Wyart, Nagel, Witten (2005), Europhys. Lett. 72, 486.

use serde::{Deserialize, Serialize};

use crate::network::ContactNetwork;

/// ΔZ of a backbone.
///
/// # Example
/// ```
/// use jamscope::law::Hertzian;
/// use jamscope::network::ContactNetwork;
/// use jamscope::io::read_packing;
/// use jamscope::observe::ExcessCoordination;
///
/// let packing = read_packing::<2>("fixtures/packings/hertz_N1000_p100.xyz")?;
/// let network = ContactNetwork::new(&packing, &Hertzian::default())?;
/// let excess = ExcessCoordination::of(&network).expect("it is jammed");
/// // 2195 contacts between the 988 disks of its backbone.
/// assert_eq!((excess.disk_count, excess.end_count), (988, 2 * 2195));
/// assert_eq!(excess.value, network.coordination() - 4.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ExcessCoordination {
    /// Mobile disks of the backbone.
    pub disk_count: usize,
    /// Ends of contacts of the backbone on these disks: two for a contact between two of them, one for a contact with a
    /// held disk.
    pub end_count: usize,
    /// ΔZ = Z − 2D \[1\].
    pub value: f64,
}

impl ExcessCoordination {
    /// ΔZ of a network; none without a backbone.
    pub fn of<const D: usize>(network: &ContactNetwork<D>) -> Option<Self> {
        let disk_count = network.backbone_count();
        let end_count = network.backbone_end_count();
        (disk_count > 0).then(|| ExcessCoordination {
            disk_count,
            end_count,
            value: network.coordination() - 2.0 * D as f64,
        })
    }
}
