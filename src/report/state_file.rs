//! [`write_state`]: a packing with the results of each disk, as extended XYZ.

use std::path::Path;

use crate::io::{Column, WriteError, write_packing};
use crate::law::choice::LawChoice;
use crate::network::ContactNetwork;
use crate::packing::Packing;
use crate::report::files::numbers_of;

/// Keys of the comment line that describe the state or the law. They are not copied from the input.
const OWN: [&str; 16] = [
    "law",
    "stiffness",
    "exponent",
    "pressure",
    "stress",
    "packing_fraction",
    "energy",
    "free_energy",
    "relative_residual",
    "rounding_floor",
    "rattlers",
    "bucklers",
    "excess_contacts",
    "negative_eigenvalues",
    "state",
    "jamscope_version",
];

/// Keys of the format itself.
const OF_FORMAT: [&str; 5] = ["Lattice", "Origin", "pbc", "Properties", "dimension"];

/// Whether a key-value pair of the input is written: not one of the format or of the state, and one that extended XYZ
/// can hold.
fn is_kept(key: &str, value: &str) -> bool {
    let is_name = !key.is_empty() && key.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"_-.".contains(&byte));
    let is_other = !OWN.iter().chain(&OF_FORMAT).any(|other| other.eq_ignore_ascii_case(key));
    is_name && is_other && !value.chars().any(char::is_control)
}

/// Writes a packing with the results of each disk: its contact network under a law. `properties` are kept, but for those of the format, of
/// the law and of the state, and those that are no names with values: free text, control characters.
///
/// | column | meaning |
/// |---|---|
/// | `contacts` | number of contacts \[1\] |
/// | `rattler` | 1 for a mobile disk off the backbone, else 0 |
/// | `net_force` | net force, D values \[force\] |
/// | `virial` | share in the virial tensor, D × D values, [`ContactNetwork::disk_virials`] \[force · length\] |
///
/// # Errors
/// [`WriteError`] with the file and the problem; nothing is written then.
pub fn write_state<const D: usize>(
    path: &Path,
    packing: &Packing<D>,
    (network, law): (&ContactNetwork<D>, &LawChoice),
    properties: &[(String, String)],
) -> Result<(), WriteError> {
    let contacts: Vec<f64> = network.contact_counts().into_iter().map(f64::from).collect();
    let mut rattler = vec![0.0; packing.len()];
    network.rattlers().for_each(|disk| rattler[disk] = 1.0);
    let virials = network.disk_virials();
    let columns = [
        Column { name: "contacts", width: 1, values: &contacts },
        Column { name: "rattler", width: 1, values: &rattler },
        Column { name: "net_force", width: D, values: network.forces().as_flattened() },
        Column { name: "virial", width: D * D, values: virials.as_flattened().as_flattened() },
    ];
    let name = match law {
        LawChoice::Hertzian(_) => "hertzian",
        LawChoice::Hookean(_) => "hookean",
        LawChoice::PowerLaw(_) => "power",
    };
    let mut own = vec![("jamscope_version", env!("CARGO_PKG_VERSION").into()), ("law", name.to_string())];
    own.extend(numbers_of(law));
    own.push(("energy", format!("{:?}", network.energy())));
    if let (Some(volume), Some(packing_fraction)) = (packing.domain().volume(), packing.packing_fraction()) {
        own.push(("pressure", format!("{:?}", network.pressure(volume))));
        own.push(("packing_fraction", format!("{packing_fraction:?}")));
    }
    own.push(("rattlers", network.rattlers().count().to_string()));
    let kept = properties.iter().filter(|(key, value)| is_kept(key, value));
    let kept = kept.map(|(key, value)| (key.as_str(), value.as_str()));
    let all: Vec<(&str, &str)> = own.iter().map(|(key, value)| (*key, value.as_str())).chain(kept).collect();
    write_packing(path, packing, &columns, &all)
}
