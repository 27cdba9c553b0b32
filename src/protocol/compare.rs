//! Distances between end states, and the grouping of end states into minima.

use std::collections::BTreeSet;

use crate::inflation::Rest;
use crate::network::ContactNetwork;
use crate::packing::displacement;
use crate::protocol::ending::Ending;
use crate::protocol::run_protocol::EndState;
use crate::protocol::sensitivity::{Compared, ProtocolSensitivity};
use crate::protocol::settings::ProtocolSettings;
use crate::protocol::spread::Spreads;
use crate::relax::Criterion;
use crate::vector::{Vector, difference, larger, norm, scaled, sum};

/// Groups end states into minima and computes the distance of each from the first.
pub(super) fn compare<const D: usize>(
    end_states: Vec<EndState<D>>,
    settings: &ProtocolSettings,
    pressure_before: f64,
    floating: bool,
) -> Compared<D> {
    let (mut endings, rests): (Vec<Ending>, Vec<_>) =
        end_states.into_iter().map(|state| (state.ending, state.rest)).unzip();
    for (ending, rest) in endings.iter_mut().zip(&rests) {
        ending.pressure_change = rest.as_ref().map(|_| ending.pressure - pressure_before);
    }
    let pressed = |index: usize| rests[index].as_ref().filter(|(rest, _)| rest.criterion != Criterion::Unjammed);
    let reference = (0..rests.len()).find(|&index| pressed(index).is_some());
    let mean_overlap = reference.and_then(pressed).map_or(0.0, |(_, network)| mean_overlap(network));
    // The first ending of each minimum.
    let mut minima: Vec<usize> = Vec::new();
    let mut farthest_within = 0.0;
    for index in 0..rests.len() {
        let Some((rest, network)) = pressed(index) else { continue };
        if let Some((first, first_network)) = reference.and_then(pressed) {
            let mut distances = distances(first, rest, floating);
            let ending = &mut endings[index];
            ending.distance = Some(distances.iter().fold(0.0, |most, &(_, distance)| larger(distance, most)));
            distances.retain(|&(_, distance)| distance > settings.differing * mean_overlap);
            distances.sort_by(|one, two| two.1.total_cmp(&one.1));
            ending.differing = distances.iter().map(|&(disk, _)| rest.packing.get().labels()[disk]).collect();
            ending.contact_difference_count = Some(links(first_network).symmetric_difference(&links(network)).count());
        }
        let apart = |first: usize| pressed(first).map(|(other, _)| apart(other, rest, floating));
        let found = minima.iter().enumerate().find_map(|(place, &first)| {
            apart(first).filter(|&apart| apart <= settings.same_minimum * mean_overlap).map(|apart| (place, apart))
        });
        let place = match found {
            Some((place, apart)) => {
                farthest_within = larger(apart, farthest_within);
                place
            }
            None => {
                minima.push(index);
                minima.len() - 1
            }
        };
        endings[index].minimum = Some(place + 1);
    }
    let mut nearest_between: Option<f64> = None;
    for (place, &one) in minima.iter().enumerate() {
        for (one, two) in minima[place + 1..].iter().filter_map(|&two| pressed(one).zip(pressed(two))) {
            let apart = apart(&one.0, &two.0, floating);
            nearest_between = Some(nearest_between.map_or(apart, |nearest| nearest.min(apart)));
        }
    }
    let over = |distance: f64| if mean_overlap > 0.0 { distance / mean_overlap } else { 0.0 };
    let sensitivity = ProtocolSensitivity {
        reference,
        mean_overlap,
        minimum_count: minima.len(),
        largest_distance: endings.iter().filter_map(|ending| ending.distance).fold(0.0, larger),
        farthest_within: over(farthest_within),
        nearest_between: nearest_between.map(over),
        spreads: Spreads::of(&endings),
        endings,
    };
    Compared { sensitivity, states: rests.into_iter().map(|rest| rest.map(|(rest, _)| rest)).collect() }
}

/// Mean overlap of the contacts of the backbone; of all contacts without a backbone \[length\].
fn mean_overlap<const D: usize>(network: &ContactNetwork<D>) -> f64 {
    let mean = |overlaps: Vec<f64>| overlaps.iter().sum::<f64>() / overlaps.len().max(1) as f64;
    if network.backbone_count() > 0 {
        mean(network.backbone_contacts().map(|contact| contact.overlap).collect())
    } else {
        mean(network.contacts.iter().map(|contact| contact.overlap).collect())
    }
}

/// The contacts between disks of the backbone.
fn links<const D: usize>(network: &ContactNetwork<D>) -> BTreeSet<(u32, u32)> {
    network.backbone_contacts().map(|contact| (contact.first, contact.second)).collect()
}

/// Distances between the positions of each mobile disk of both backbones. Without one of the backbones, all mobile
/// disks count.
fn distances<const D: usize>(one: &Rest<D>, two: &Rest<D>, floating: bool) -> Vec<(usize, f64)> {
    let (first, second) = (one.packing.get(), two.packing.get());
    let mobile = |disk: &usize| !first.held()[*disk];
    let none = [one, two].iter().any(|rest| !(0..first.len()).any(|disk| mobile(&disk) && rest.backbone[disk]));
    let counts = |disk: &usize| none || (one.backbone[*disk] && two.backbone[*disk]);
    let disks: Vec<usize> = (0..first.len()).filter(mobile).filter(counts).collect();
    let moved: Vec<Vector<D>> = disks.iter().map(|&disk| displacement(first, second, disk)).collect();
    let shift = if floating && !moved.is_empty() {
        scaled(1.0 / moved.len() as f64, moved.iter().fold([0.0; D], |total, &u| sum(total, u)))
    } else {
        [0.0; D]
    };
    disks.into_iter().zip(moved).map(|(disk, u)| (disk, norm(difference(u, shift)))).collect()
}

/// The largest of these distances \[length\].
fn apart<const D: usize>(one: &Rest<D>, two: &Rest<D>, floating: bool) -> f64 {
    distances(one, two, floating).iter().fold(0.0, |most, &(_, distance)| larger(distance, most))
}
