//! What is measured on a response, and what is fitted to it.

mod angular;
#[cfg(feature = "fit")]
mod elastic_modes;
#[cfg(feature = "fit")]
mod ensemble_fits;
#[cfg(feature = "fit")]
mod fit;
mod response_observables;
mod shell;

#[path = "../scenes/lammps_inflated.rs"]
mod lammps_inflated;
#[path = "../scenes/seeds.rs"]
mod seeds;
