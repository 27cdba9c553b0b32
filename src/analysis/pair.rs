//! [`Pair`]: two states of the same disks, matched, with the inflated disk identified.

use std::collections::BTreeMap;

use crate::inflation::Boundary;
use crate::packing::{Packing, PackingError};
use crate::vector::norm;

/// Settings that the states do not contain.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PairSettings {
    /// Label of the inflated disk; if absent, it is the one whose radius changed.
    pub centre_label: Option<u64>,
    /// R: disks whose distance before from the inflated one is at least R are held; if absent, the held disks are those
    /// of the states \[length\].
    pub outer_radius: Option<f64>,
}

/// Why two states cannot be compared.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AnalysisError {
    /// The numbers of disks differ.
    #[error("{before_count} disks before, {after_count} {state}: both states must contain the same disks")]
    CountsDiffer {
        /// Which state is compared with the one before.
        state: &'static str,
        /// Number of disks before.
        before_count: usize,
        /// Number of disks in that state.
        after_count: usize,
    },
    /// A label of one state is missing in the other.
    #[error("disk {label} is in the state before, but not in the state {state}")]
    LabelMissing {
        /// Which state is compared with the one before.
        state: &'static str,
        /// Its label.
        label: u64,
    },
    /// Repeated labels do not match in order.
    #[error("label {label} occurs more than once, and the order of the disks {state} differs from that before")]
    LabelsAmbiguous {
        /// Which state is compared with the one before.
        state: &'static str,
        /// One such label.
        label: u64,
    },
    /// The boxes differ.
    #[error("the box before and the one {state} differ")]
    DomainsDiffer {
        /// Which state is compared with the one before.
        state: &'static str,
    },
    /// No radius changed.
    #[error("no disk changed its radius, so none was inflated")]
    NoCentre,
    /// Several radii changed.
    #[error(
        "{count} disks changed their radius, among them disks {first} and {second}: only one disk may be inflated; name it with --centre LABEL if the others changed for another reason"
    )]
    SeveralCentres {
        /// Number of these disks.
        count: usize,
        /// Label of the first.
        first: u64,
        /// Label of the second.
        second: u64,
    },
    /// No disk, or more than one mobile disk, has the given label.
    #[error("{count} disks have the label {label} of the inflated disk: exactly one disk must have it")]
    CentreNotOne {
        /// The label.
        label: u64,
        /// Number of disks with it.
        count: usize,
    },
    /// The given inflated disk has equal radii in both states.
    #[error("disk {label} is named as the inflated one, but its radius is {radius} before and after{}", grown_instead(*grown))]
    CentreUnchanged {
        /// Its label.
        label: u64,
        /// Its radius.
        radius: f64,
        /// Label of a disk whose radius changed.
        grown: Option<u64>,
    },
    /// R is invalid.
    #[error("the outer radius is {outer_radius}: must be larger than the radius of the inflated disk, {inner_radius}")]
    OuterRadiusOutOfRange {
        /// R given.
        outer_radius: f64,
        /// Radius of the inflated disk.
        inner_radius: f64,
    },
    /// The boundary of the packing is unknown.
    #[error("the packing has no box and no disk is held: give the outer radius beyond which disks are held")]
    NoBoundary,
    /// No disk could move.
    #[error("no disk lies within the outer radius {outer_radius}")]
    NoMobileDisk {
        /// R.
        outer_radius: f64,
    },
    /// The disks themselves are invalid.
    #[error(transparent)]
    Packing(#[from] PackingError),
}

/// A hint to the disk that was probably meant.
fn grown_instead(label: Option<u64>) -> String {
    label.map_or(String::new(), |label| format!("; that of disk {label} changed"))
}

/// States of the same disks in the same order.
#[derive(Debug, Clone)]
pub struct Pair<const D: usize = 2> {
    /// State before the inflation.
    pub before: Packing<D>,
    /// State after it.
    pub after: Packing<D>,
    /// State after the deflation, if it is known.
    pub deflated: Option<Packing<D>>,
    /// Index of the inflated disk in all of them.
    pub centre: usize,
    /// R \[length\].
    pub outer_radius: f64,
    /// The boundary.
    pub boundary: Boundary,
}

impl<const D: usize> Pair<D> {
    /// Matches the disks by their labels, identifies the inflated one and sets the held disks.
    ///
    /// Repeated labels, as of images of a disk in a rim, are matched in the order of the disks.
    ///
    /// # Errors
    /// [`AnalysisError`].
    pub fn new(
        before: Packing<D>,
        after: &Packing<D>,
        deflated: Option<&Packing<D>>,
        settings: &PairSettings,
    ) -> Result<Self, AnalysisError> {
        let after = matched(&before, after, "after")?;
        let deflated = deflated.map(|deflated| matched(&before, deflated, "after the deflation")).transpose()?;
        let centre = match settings.centre_label {
            Some(label) => changed(&before, &after, labelled(&before, label)?)?,
            None => grown(&before, &after)?,
        };
        let (outer_radius, boundary) = outer(&before, centre, settings.outer_radius)?;
        let held = held(&before, centre, outer_radius, boundary, settings.outer_radius.is_some());
        if held.iter().all(|&held| held) {
            return Err(AnalysisError::NoMobileDisk { outer_radius });
        }
        let hold = |packing: Packing<D>| packing.with_held(held.clone());
        Ok(Pair {
            before: hold(before)?,
            after: hold(after)?,
            deflated: deflated.map(hold).transpose()?,
            centre,
            outer_radius,
            boundary,
        })
    }
}

/// The disks of a state in the order of the first one.
fn matched<const D: usize>(
    first: &Packing<D>,
    second: &Packing<D>,
    state: &'static str,
) -> Result<Packing<D>, AnalysisError> {
    let (before_count, after_count) = (first.len(), second.len());
    if before_count != after_count {
        return Err(AnalysisError::CountsDiffer { state, before_count, after_count });
    }
    if first.domain() != second.domain() {
        return Err(AnalysisError::DomainsDiffer { state });
    }
    let order = order(first, second, state)?;
    let radii = order.iter().map(|&place| second.radii()[place]).collect();
    // In the image nearest to the position in the first state.
    let image = |disk: usize, place| second.domain().nearest_image(second.centre(place), first.positions()[disk]);
    let (positions, corrections): (Vec<_>, Vec<_>) =
        order.iter().enumerate().map(|(disk, &place)| image(disk, place)).unzip();
    let packing = Packing::new(*second.domain(), positions, radii)?;
    Ok(packing.with_corrections(corrections)?.with_labels(first.labels().to_vec())?)
}

/// The index in the second state of each disk of the first.
fn order<const D: usize>(
    first: &Packing<D>,
    second: &Packing<D>,
    state: &'static str,
) -> Result<Vec<usize>, AnalysisError> {
    if first.labels() == second.labels() {
        return Ok((0..first.len()).collect());
    }
    let mut places: BTreeMap<u64, usize> = BTreeMap::new();
    for (place, &label) in second.labels().iter().enumerate() {
        if places.insert(label, place).is_some() {
            return Err(AnalysisError::LabelsAmbiguous { state, label });
        }
    }
    // Each index is taken once: the labels of the second are unique, and their number is that of the first.
    let mut place = |label: &u64| places.remove(label).ok_or(AnalysisError::LabelMissing { state, label: *label });
    first.labels().iter().map(&mut place).collect()
}

/// The one disk with a label.
fn labelled<const D: usize>(packing: &Packing<D>, label: u64) -> Result<usize, AnalysisError> {
    let all: Vec<usize> = (0..packing.len()).filter(|&disk| packing.labels()[disk] == label).collect();
    match all[..] {
        [centre] => Ok(centre),
        _ => Err(AnalysisError::CentreNotOne { label, count: all.len() }),
    }
}

/// The given disk, if its radius changed.
fn changed<const D: usize>(before: &Packing<D>, after: &Packing<D>, centre: usize) -> Result<usize, AnalysisError> {
    let radius = before.radii()[centre];
    if radius != after.radii()[centre] {
        return Ok(centre);
    }
    let grown = all_grown(before, after).first().map(|&disk| before.labels()[disk]);
    Err(AnalysisError::CentreUnchanged { label: before.labels()[centre], radius, grown })
}

fn all_grown<const D: usize>(before: &Packing<D>, after: &Packing<D>) -> Vec<usize> {
    let radii = before.radii().iter().zip(after.radii()).enumerate();
    radii.filter(|(_, (a, b))| a != b).map(|(disk, _)| disk).collect()
}

/// The disk whose radius changed.
fn grown<const D: usize>(before: &Packing<D>, after: &Packing<D>) -> Result<usize, AnalysisError> {
    let changed = all_grown(before, after);
    match changed[..] {
        [] => Err(AnalysisError::NoCentre),
        [centre] => Ok(centre),
        [first, second, ..] => Err(AnalysisError::SeveralCentres {
            count: changed.len(),
            first: before.labels()[first],
            second: before.labels()[second],
        }),
    }
}

/// R and the boundary: given, or from the nearest held disk, or half of the box.
fn outer<const D: usize>(
    packing: &Packing<D>,
    centre: usize,
    given: Option<f64>,
) -> Result<(f64, Boundary), AnalysisError> {
    let lengths = packing.domain().lengths();
    let shortest = lengths.and_then(|sides| sides.into_iter().reduce(f64::min));
    // A map of the circle only needs to know that there is a rim.
    let rim = |radius: f64| {
        (radius, Boundary::HeldRim { outer_radius_over_side: shortest.map_or(0.5, |side| (radius / side).min(0.5)) })
    };
    let inner_radius = packing.radii()[centre];
    if let Some(outer_radius) = given {
        if !(outer_radius > inner_radius && outer_radius.is_finite()) {
            return Err(AnalysisError::OuterRadiusOutOfRange { outer_radius, inner_radius });
        }
        return Ok(rim(outer_radius));
    }
    let held = (0..packing.len()).filter(|&disk| packing.held()[disk] && disk != centre);
    let nearest = held.map(|disk| norm(packing.separation(disk, centre))).reduce(f64::min);
    match (nearest, shortest) {
        (Some(radius), _) => Ok(rim(radius)),
        (None, Some(side)) => Ok((0.5 * side, Boundary::Periodic)),
        (None, None) => Err(AnalysisError::NoBoundary),
    }
}

/// The held disks: those of the packing, or all beyond a given R, and the centre.
fn held<const D: usize>(
    packing: &Packing<D>,
    centre: usize,
    outer_radius: f64,
    boundary: Boundary,
    by_radius: bool,
) -> Vec<bool> {
    if boundary == Boundary::Periodic {
        return vec![false; packing.len()];
    }
    let marked = packing.held();
    // Held disks of a file are more reliable than a radius, which may be rounded.
    let has_held = marked.iter().enumerate().any(|(disk, &held)| held && disk != centre);
    let far = |disk: usize| norm(packing.separation(disk, centre)) >= outer_radius;
    (0..packing.len()).map(|disk| disk == centre || marked[disk] || (by_radius && !has_held && far(disk))).collect()
}
