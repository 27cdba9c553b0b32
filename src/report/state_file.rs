//! [`write_state`]: a packing with the results of each disk, as extended XYZ or a NumPy archive.

use std::path::Path;

use crate::io::{Column, WriteError, npz, write_npz, write_packing};
use crate::law::choice::LawChoice;
use crate::network::ContactNetwork;
use crate::packing::Packing;

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

/// Writes a packing and columns, as a NumPy archive if the name of the file ends in `.npz`, otherwise as extended XYZ. `properties` are the
/// key-value pairs of the caller, which must be known to be valid; of `kept`, the pairs of the input, those are left out that describe the
/// format, the law or the state, that are no names with values (free text, control characters), or that an archive has an array for.
///
/// # Errors
/// [`WriteError`] with the file and the problem; nothing is written then.
pub(crate) fn write_by_ending<const D: usize>(
    path: &Path,
    packing: &Packing<D>,
    columns: &[Column],
    properties: &[(&str, String)],
    kept: &[(String, String)],
) -> Result<(), WriteError> {
    let is_archive = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("npz"));
    let is_array = |key: &str| npz::is_reserved(key) || columns.iter().any(|column| column.name == key);
    let kept = kept.iter().filter(|(key, value)| is_kept(key, value) && !(is_archive && is_array(key)));
    let kept = kept.map(|(key, value)| (key.as_str(), value.as_str()));
    let all: Vec<(&str, &str)> = properties.iter().map(|(key, value)| (*key, value.as_str())).chain(kept).collect();
    if is_archive { write_npz(path, packing, columns, &all) } else { write_packing(path, packing, columns, &all) }
}

/// Writes a packing with the results of each disk: its contact network under a law, then `more` columns. A name that ends in `.npz` is that
/// of a NumPy archive, any other of extended XYZ. `properties` are kept, but for those of the format, of the law and of the state, and those
/// that are no names with values: free text, control characters.
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
    more: &[Column],
    properties: &[(String, String)],
) -> Result<(), WriteError> {
    let contacts: Vec<f64> = network.contact_counts().into_iter().map(f64::from).collect();
    let mut rattler = vec![0.0; packing.len()];
    network.rattlers().for_each(|disk| rattler[disk] = 1.0);
    let virials = network.disk_virials();
    let mut columns = vec![
        Column { name: "contacts", width: 1, values: &contacts },
        Column { name: "rattler", width: 1, values: &rattler },
        Column { name: "net_force", width: D, values: network.forces().as_flattened() },
        Column { name: "virial", width: D * D, values: virials.as_flattened().as_flattened() },
    ];
    columns.extend_from_slice(more);
    let mut own = law_keys(law);
    own.push(("energy", format!("{:?}", network.energy())));
    if let (Some(volume), Some(packing_fraction)) = (packing.domain().volume(), packing.packing_fraction()) {
        own.push(("pressure", format!("{:?}", network.pressure(volume))));
        own.push(("packing_fraction", format!("{packing_fraction:?}")));
    }
    own.push(("rattlers", network.rattlers().count().to_string()));
    write_by_ending(path, packing, &columns, &own, properties)
}

/// The version of the program and the law, in the form that `jamscope inspect` reads.
pub(crate) fn law_keys(law: &LawChoice) -> Vec<(&'static str, String)> {
    let name = match law {
        LawChoice::Hertzian(_) => "hertzian",
        LawChoice::Hookean(_) => "hookean",
        LawChoice::PowerLaw(_) => "power",
    };
    let mut keys = vec![("jamscope_version", env!("CARGO_PKG_VERSION").into()), ("law", name.to_string())];
    keys.extend(numbers_of(law));
    keys
}

/// The parameters of a law, in the form that `jamscope inspect` reads.
pub(super) fn numbers_of(law: &LawChoice) -> Vec<(&'static str, String)> {
    match law {
        LawChoice::Hertzian(law) => vec![("stiffness", format!("{:?}", law.stiffness))],
        LawChoice::Hookean(law) => vec![("stiffness", format!("{:?}", law.stiffness))],
        LawChoice::PowerLaw(law) => {
            vec![("stiffness", format!("{:?}", law.energy_scale)), ("exponent", format!("{:?}", law.exponent))]
        }
    }
}
