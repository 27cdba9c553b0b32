//! [`Relaxer`]: a method that brings a packing to rest.

use crate::law::pair_law::PairLaw;
use crate::packing::{Packing, PackingError};
use crate::relax::outcome::Outcome;
use crate::relax::trace::Trace;

/// A way to bring a packing to rest.
pub trait Relaxer {
    /// Moves the mobile disks until they are at rest or a limit is met.
    ///
    /// # Errors
    /// Only what makes forces undefined: a box too small, two disks with the same centre.
    fn relax<const D: usize, L: PairLaw>(
        &self,
        packing: Packing<D>,
        law: &L,
        trace: &mut impl Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError>;

    /// The same relaxer for states that are only passed through: at rest at a relative residual of `limit` \[1\]. None where it
    /// asks for no less itself, or has no such limit.
    fn passing(&self, limit: f64) -> Option<Self>
    where
        Self: Sized,
    {
        let _ = limit;
        None
    }
}
