//! [`ProtocolSensitivity`]: the end states of several protocols from one start; [`Compared`] also contains the
//! packings.

use serde::Serialize;

use crate::inflation::Rest;
use crate::protocol::ending::Ending;
use crate::protocol::spread::Spreads;

/// The end states of several protocols from one start.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ProtocolSensitivity {
    /// One entry per protocol, in the order given.
    pub endings: Vec<Ending>,
    /// Index of the reference for distances: the first ending at rest with contacts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference: Option<usize>,
    /// Mean overlap of the contacts of the reference's backbone, ⟨δ⟩ \[length\].
    pub mean_overlap: f64,
    /// Number of minima found.
    pub minimum_count: usize,
    /// Largest distance from the reference \[length\].
    pub largest_distance: f64,
    /// Largest distance of an ending from the first one in its minimum, over ⟨δ⟩ \[1\].
    pub farthest_within: f64,
    /// Smallest distance between the first endings of two minima, over ⟨δ⟩ \[1\]; absent if there is only one minimum.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nearest_between: Option<f64>,
    /// Means and standard deviations over the endings at rest.
    pub spreads: Spreads,
}

/// A comparison with the packings compared.
#[derive(Debug, Clone)]
pub struct Compared<const D: usize> {
    /// The comparison.
    pub sensitivity: ProtocolSensitivity,
    /// The states in the order of the endings; none for a protocol that did not come to rest.
    pub states: Vec<Option<Rest<D>>>,
}
