//! [`write_lammps_data`]: a periodic packing as a LAMMPS data file of `atom_style sphere`.

use std::collections::HashSet;
use std::io::{self, Write};
use std::path::Path;

use crate::io::atomic::{WriteError, write_atomically};
use crate::packing::{Domain, Packing};
use crate::vector::Vector;

/// Volume of a ball of radius 1 \[1\]: `atom_style sphere` uses the density of balls, also in two dimensions.
const UNIT_BALL: f64 = 4.0 / 3.0 * std::f64::consts::PI;

/// Writes a periodic packing as LAMMPS data, `atom_style sphere`, which `read_data` of LAMMPS and
/// [`read_packing`](crate::io::read_packing) read.
///
/// One atom type per radius, in ascending order; densities for which every mass is 1, as in the model. Numbers are the
/// shortest decimals that reproduce the `f64`. Ids are the labels if these are positive and unique, otherwise 1, 2, 3,
/// … in the order of the packing; readers sort by id. For D = 2 a coordinate z = 0 and a height from −0.5 to 0.5 are
/// added.
///
/// The file does not contain corrections, so overlaps change by the rounding of coordinates. It contains the ends of
/// the box, so sides are exact if the corner is the origin, and otherwise exact to the rounding of the larger end.
///
/// # Errors
/// [`WriteError`] with the file and the problem; nothing is written then. A packing in the open plane, with held disks
/// or with sites is refused, because the format cannot contain these.
///
/// # Example
/// ```
/// use jamscope::io::{read_packing, write_lammps_data};
///
/// let packing = read_packing::<2>("fixtures/packings/hertz_N1000_p100.xyz")?;
/// let folder = tempfile::tempdir()?;
/// let file = folder.path().join("packing.data");
/// write_lammps_data(&file, &packing)?;
/// let read = read_packing::<2>(&file)?;
/// assert_eq!((read.domain(), read.positions()[0]), (packing.domain(), packing.positions()[0]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_lammps_data<const D: usize>(path: impl AsRef<Path>, packing: &Packing<D>) -> Result<(), WriteError> {
    const { assert!(D == 2 || D == 3, "packings have two or three dimensions") };
    let path = path.as_ref();
    let refused = |what: &'static str| Err(WriteError::NoPlaceFor { path: path.into(), what });
    let Domain::Periodic { corner, edges } = packing.domain() else { return refused("the open plane") };
    if packing.held().contains(&true) {
        return refused("held disks");
    }
    if packing.sites().is_some() {
        return refused("sites");
    }
    if packing.loads().is_some() {
        return refused("loads");
    }
    let ends = |axis: usize| if axis < D { (corner[axis], corner[axis] + edges[axis][axis]) } else { (-0.5, 0.5) };
    if (0..D).any(|axis| !ends(axis).1.is_finite() || ends(axis).1 <= ends(axis).0) {
        return refused("a box whose end is not a number, or its corner");
    }
    // Outside this range LAMMPS has no valid type or mass.
    if packing.radii().iter().any(|&radius| !density(radius).is_normal()) {
        return refused("a radius whose cube is no number");
    }
    write_atomically(path, |writer| write(writer, packing, [ends(0), ends(1), ends(2)], tilts(edges)))
}

/// Density of a ball of mass 1.
fn density(radius: f64) -> f64 {
    1.0 / (UNIT_BALL * radius * radius * radius)
}

/// The tilts xy, xz, yz of the same lattice that are at most half of a side: LAMMPS refuses or is slow with larger ones.
/// None for a rectangular box.
fn tilts<const D: usize>(edges: &[Vector<D>; D]) -> Option<[f64; 3]> {
    let mut edges = *edges;
    for d in 1..D {
        for axis in (0..d).rev() {
            let boxes = (edges[d][axis] / edges[axis][axis]).round();
            (0..=axis).for_each(|along| edges[d][along] -= boxes * edges[axis][along]);
        }
    }
    let tilt = |d: usize, axis: usize| if d < D { edges[d][axis] } else { 0.0 };
    let tilts = [tilt(1, 0), tilt(2, 0), tilt(2, 1)];
    tilts.iter().any(|&tilt| tilt != 0.0).then_some(tilts)
}

fn write<const D: usize>(
    writer: &mut impl Write,
    packing: &Packing<D>,
    ends: [(f64, f64); 3],
    tilts: Option<[f64; 3]>,
) -> io::Result<()> {
    let mut sizes = packing.radii().to_vec();
    sizes.sort_by(f64::total_cmp);
    sizes.dedup();
    let mut seen = HashSet::new();
    let usable = packing.labels().iter().all(|&label| label > 0 && seen.insert(label));
    writeln!(writer, "packing of jamscope {}, mass of every disk 1", env!("CARGO_PKG_VERSION"))?;
    writeln!(writer, "\n{} atoms\n{} atom types\n", packing.len(), sizes.len())?;
    for ((low, high), axis) in ends.into_iter().zip(["x", "y", "z"]) {
        writeln!(writer, "{low:?} {high:?} {axis}lo {axis}hi")?;
    }
    if let Some([xy, xz, yz]) = tilts {
        writeln!(writer, "{xy:?} {xz:?} {yz:?} xy xz yz")?;
    }
    writeln!(writer, "\nAtoms # sphere\n")?;
    for (disk, (position, &radius)) in packing.positions().iter().zip(packing.radii()).enumerate() {
        let id = if usable { packing.labels()[disk] } else { disk as u64 + 1 };
        let kind = 1 + sizes.partition_point(|&size| size < radius);
        write!(writer, "{id} {kind} {:?} {:?}", 2.0 * radius, density(radius))?;
        for axis in 0..3 {
            write!(writer, " {:?}", position.get(axis).copied().unwrap_or(0.0))?;
        }
        writeln!(writer)?;
    }
    Ok(())
}
