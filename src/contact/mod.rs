//! What happens where two disks touch: [`law`], [`damping`], the neighbour list, the hot loop and the contact network.
//!
//! Start from [`ContactNetwork`] to look at a packing, from [`Assembly`] to move one.

pub mod advance;
mod amended;
pub mod assembly;
mod cells;
mod columns;
pub mod damped_forces;
pub mod damping;
mod far;
pub mod forces;
#[cfg(feature = "linear")]
pub mod hessian;
mod joined;
mod kinds;
mod lacking;
pub mod law;
mod law_kernel;
mod listed;
mod measured;
pub mod neighbours;
pub mod network;
pub mod on_site;
pub mod pair_list;
mod passes;
mod pruned;
mod rounded;
mod rows;
#[cfg(feature = "linear")]
mod selected;
pub mod single;
pub mod stiffness;
mod tiles;
pub mod totals;
mod turns;
pub mod walk;
mod ways;

pub use assembly::Assembly;
#[cfg(feature = "linear")]
pub use hessian::{Hessian, Members, Prestress};
pub use law::{Hertzian, Hookean, LawChoice, PairLaw, PowerLaw};
pub use network::{Contact, ContactNetwork};
pub use on_site::OnSite;
