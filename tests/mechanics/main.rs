//! Contacts, relaxers, linear response, preparation and inflation: everything that moves disks.
//!
//! One crate, because its parts compile the same relaxers for the same laws: one by one they take four times as long.

mod claims;
mod scenes;
mod twins;

#[cfg(feature = "linear")]
mod applied;
mod certificate;
mod contact;
#[cfg(feature = "linear")]
mod drives;
#[cfg(feature = "linear")]
mod energy;
#[cfg(feature = "linear")]
mod implicit;
mod inflation;
mod kernels;
mod lammps;
#[cfg(feature = "linear")]
mod lattice;
#[cfg(feature = "linear")]
mod linear;
mod minimisers;
#[cfg(feature = "linear")]
mod modes;
#[cfg(feature = "linear")]
mod moduli;
#[cfg(feature = "linear")]
mod newton;
mod on_site;
#[cfg(feature = "linear")]
mod plastic;
mod preparation;
#[cfg(feature = "linear")]
mod protocol;
mod relax;
mod spheres;
#[cfg(feature = "linear")]
mod stability;
#[cfg(feature = "linear")]
mod strain;
#[cfg(feature = "linear")]
mod tilted;
