//! The mechanics of one contact: force and energy of an overlap ([`PairLaw`]), [`damping`], and forces from sites
//! ([`OnSite`]).

pub mod choice;
pub mod damping;
pub mod on_site;
pub mod pair_law;
pub mod power_laws;

pub use choice::{LawChoice, LawError};
pub use on_site::OnSite;
pub use pair_law::{PairLaw, ShareLaw};
pub use power_laws::{Hertzian, Hookean, PowerLaw};
