//! [`Relaxer`]: a method that brings a packing to rest.

use crate::law::pair_law::PairLaw;
use crate::packing::{Packing, PackingError};
use crate::relax::outcome::Outcome;
use crate::relax::trace::Trace;

/// A method that brings a packing to rest.
pub trait Relaxer {
    /// Moves the mobile disks until they are at rest or a limit is met.
    ///
    /// # Errors
    /// Only conditions that make forces undefined: a box too small, two disks with the same centre.
    fn relax<const D: usize>(
        &self,
        packing: Packing<D>,
        law: &dyn PairLaw,
        trace: &mut dyn Trace,
    ) -> Result<Outcome<Packing<D>>, PackingError>;

    /// The same relaxer for intermediate states, which count as at rest at a relative residual of `limit` \[1\]. None
    /// if its own limit is absolute or not below that.
    fn for_intermediate_states(&self, limit: f64) -> Option<Self>
    where
        Self: Sized,
    {
        let _ = limit;
        None
    }
}
