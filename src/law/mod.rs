//! What happens at one contact: force and energy of an overlap ([`PairLaw`]), [`damping`], and forces from sites ([`OnSite`]).

pub mod damping;
pub(crate) mod kernel;
pub mod on_site;
pub mod pair_law;

pub use on_site::OnSite;
pub use pair_law::{Hertzian, Hookean, LawChoice, LawError, LawVisitor, PairLaw, PowerLaw};
