//! [`ContactSummary`]: numbers and positions of contacts made and broken.

use serde::Serialize;

use crate::observe::contact_changes::{ContactChanges, ContactCycle, RattlerContacts};
use crate::observe::state::State;

/// Contacts of an inflation, and of the deflation after it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ContactSummary {
    /// From before the inflation to after it.
    pub inflation: ContactChangeCounts,
    /// The deflation, if there was one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub deflation: Option<CycleCounts>,
}

/// Numbers of contacts from one state to another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct ContactChangeCounts {
    /// In both states.
    pub kept_count: usize,
    /// In the second only.
    pub made_count: usize,
    /// In the first only.
    pub broken_count: usize,
    /// Contacts with rattlers.
    pub rattlers: RattlerContacts,
}

/// Effect of the deflation on contacts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CycleCounts {
    /// From the inflated state to the deflated one.
    pub changes: ContactChangeCounts,
    /// From before the inflation to after the deflation.
    pub left: ContactChangeCounts,
    /// Number of contacts that the inflation broke and the deflation restored.
    pub broken_returned_count: usize,
    /// Number of contacts that the inflation made and the deflation broke again.
    pub made_returned_count: usize,
    /// Share of the contacts changed by the inflation that the deflation restores; absent if none changed \[1\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub returned_share: Option<f64>,
}

impl ContactChangeCounts {
    fn of<const D: usize>(changes: &ContactChanges<D>) -> Self {
        ContactChangeCounts {
            kept_count: changes.kept_count,
            made_count: changes.made.len(),
            broken_count: changes.broken.len(),
            rattlers: changes.rattlers,
        }
    }
}

impl ContactSummary {
    /// The numbers, and the changed contacts of the inflation.
    pub(super) fn of<const D: usize>(
        before: &State<'_, D>,
        after: &State<'_, D>,
        deflated: Option<&State<'_, D>>,
        centre: usize,
    ) -> (Self, ContactChanges<D>) {
        let Some(deflated) = deflated else {
            let changes = ContactChanges::between(before, after, centre);
            return (ContactSummary { inflation: ContactChangeCounts::of(&changes), deflation: None }, changes);
        };
        let cycle = ContactCycle::through([before, after, deflated], centre);
        let deflation = CycleCounts {
            changes: ContactChangeCounts::of(&cycle.deflation),
            left: ContactChangeCounts::of(&cycle.left),
            broken_returned_count: cycle.broken_returned_count,
            made_returned_count: cycle.made_returned_count,
            returned_share: cycle.returned_share(),
        };
        let summary =
            ContactSummary { inflation: ContactChangeCounts::of(&cycle.inflation), deflation: Some(deflation) };
        (summary, cycle.inflation)
    }
}
