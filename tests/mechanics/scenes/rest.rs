//! States at rest, and how far they are from each other.

use jamscope::law::PairLaw;
use jamscope::network::ContactNetwork;
use jamscope::packing::Packing;
use jamscope::relax::{Outcome, Relaxer};
use jamscope::vector::{Vector, larger, norm};

/// Where a relaxer ends, converged or not.
pub fn relax<const D: usize>(relaxer: &impl Relaxer, packing: Packing<D>, law: &dyn PairLaw) -> Outcome<Packing<D>> {
    relaxer.relax(packing, law, &mut ()).expect("no coincidence")
}

/// The state of an outcome that must have converged.
pub fn at_rest<const D: usize>(outcome: Outcome<Packing<D>>) -> Packing<D> {
    let (stop, residual) = (outcome.stop, outcome.residual.relative());
    outcome.converged().unwrap_or_else(|_| panic!("{stop:?} at {residual:e}")).into_inner()
}

/// How far a disk is from where it is in another packing.
pub fn moved<const D: usize>(one: &Packing<D>, two: &Packing<D>, disk: usize) -> Vector<D> {
    let ((a, a_low), (b, b_low)) = (one.centre(disk), two.centre(disk));
    one.domain().separation((a, a_low), (b, b_low))
}

/// Largest distance of a backbone disk between two states.
pub fn apart<const D: usize>(one: &Packing<D>, two: &Packing<D>, law: &dyn PairLaw) -> f64 {
    let backbone = ContactNetwork::new(one, law).expect("no coincidence").backbone;
    (0..one.len()).filter(|&disk| backbone[disk]).map(|disk| norm(moved(one, two, disk))).fold(0.0, larger)
}
