//! Packings that tests begin from, and what they look at where one came to rest.

#[path = "../../scenes/lammps_inflated.rs"]
pub mod lammps_inflated;
pub mod laws;
#[cfg_attr(not(feature = "linear"), allow(dead_code, reason = "most of it is for elastic constants and modes"))]
pub mod published;
pub mod random_disks;
pub mod rest;
#[path = "../../scenes/seeds.rs"]
pub mod seeds;
#[cfg(feature = "linear")]
#[path = "../../scenes/square_lattice.rs"]
pub mod square_lattice;
pub mod starts;
#[path = "../../../benches/measurements/scenes/tiled.rs"]
pub mod tiled;
