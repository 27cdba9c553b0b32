//! Likely causes if states are not at rest: the forces under other laws, and the positions of the unbalanced disks.

use crate::law::choice::LawChoice;
use crate::law::pair_law::PairLaw;
use crate::law::power_laws::{Hertzian, Hookean, PowerLaw};
use crate::observe::state::State;
use crate::packing::{Packing, ball_volume};
use crate::vector::{Vector, dot, larger, norm};
use crate::verdict::{Balance, Cause, Digits, OtherLaw, Place, RestVerdict};

/// A law explains the residual if it reduces it to this share. Coordinates with six digits may leave that much.
const LAW_SHARE: f64 = 0.01;

/// Share of the unbalanced disks that must be in one region.
const MOST: f64 = 0.9;

/// Up to this number, unbalanced disks count as few: twice a disk and its neighbours.
const FEW: usize = 14;

/// The largest residual of the states under every law except `choice`.
pub(super) fn other_laws<const D: usize>(
    states: &[(&'static str, &State<'_, D>)],
    choice: &LawChoice,
) -> Vec<OtherLaw> {
    let power = |exponent| LawChoice::PowerLaw(PowerLaw { energy_scale: 1.0, exponent });
    let all =
        [LawChoice::Hertzian(Hertzian::default()), LawChoice::Hookean(Hookean::default()), power(2.0), power(2.5)];
    let same = |law: &LawChoice| law.name() == choice.name() && law.exponent() == choice.exponent();
    let residual = |law: LawChoice| {
        let mut most = 0.0;
        for (_, state) in states {
            most = larger(residual_under(state.packing, &law)?, most);
        }
        Some(OtherLaw { law, relative_residual: most })
    };
    all.into_iter().filter(|law| !same(law)).filter_map(residual).collect()
}

fn residual_under<const D: usize>(packing: &Packing<D>, law: &LawChoice) -> Option<f64> {
    let state = State::new(packing, law).ok()?;
    let balance = Balance::of(packing, &state.network, law);
    Some(larger(balance.relative_residual(), balance.relative_residual_off_backbone().powi(2)))
}

/// Causes that fit, the most likely first; at least one.
pub(super) fn causes<const D: usize>(
    states: &[(&'static str, &State<'_, D>)],
    law: &dyn PairLaw,
    place: Option<Place>,
    verdict: &RestVerdict,
) -> Vec<Cause> {
    let limit = verdict.residual_limit();
    let size = |index: usize| {
        let state = &verdict.states()[index];
        larger(state.relative_residual, state.relative_residual_off_backbone.powi(2))
    };
    // The state farthest from rest. NaN counts as the largest residual.
    let worst = (0..states.len()).max_by(|&a, &b| size(a).total_cmp(&size(b)));
    let Some(worst) = worst.filter(|&index| !verdict.states()[index].at_rest) else { return vec![Cause::Unfinished] };
    let (state, found) = (states[worst].1, &verdict.states()[worst]);
    let unbalanced = unbalanced(state, limit);
    let mut causes = Vec::new();
    let best = verdict.other_laws().iter().min_by(|a, b| a.relative_residual.total_cmp(&b.relative_residual));
    if let Some(&OtherLaw { law, relative_residual }) = best
        && relative_residual <= larger(limit, LAW_SHARE * size(worst))
    {
        causes.push(Cause::Law { law, relative_residual });
    }
    if let Some(place) = place {
        causes.extend(boundary(state, place, &unbalanced));
        causes.extend(other_radii(states, place));
        causes.extend(centre(state, place, &unbalanced));
    }
    if let Some(digits) = Digits::of(state.packing)
        && let Some(residual_bound) = digits.residual_bound(state.packing, &state.network, law)
        && larger(found.relative_residual, found.relative_residual_off_backbone) <= residual_bound
    {
        causes.push(Cause::FewDigits { digits, residual_bound });
    }
    if state.packing.sites().is_some() && state.packing.loads().is_none() && !law.has_sites() {
        causes.push(Cause::Sites);
    }
    if causes.is_empty() {
        let few = unbalanced.len() <= larger(FEW as f64, 0.02 * state.packing.len() as f64) as usize;
        let largest = unbalanced.iter().max_by(|a, b| norm(a.force).total_cmp(&norm(b.force)));
        causes.push(match largest {
            Some(largest) if few => {
                Cause::FewDisks { unbalanced_count: unbalanced.len(), label: state.packing.labels()[largest.disk] }
            }
            _ => Cause::Unfinished,
        });
    }
    causes
}

/// A mobile disk whose net force is above the limit of a state at rest.
struct Unbalanced<const D: usize> {
    disk: usize,
    force: Vector<D>,
}

fn unbalanced<const D: usize>(state: &State<'_, D>, limit: f64) -> Vec<Unbalanced<D>> {
    let network = &state.network;
    let (rigid, mean) = (network.backbone_count() > 0, network.mean_contact_force());
    let above = |disk: usize, force: &Vector<D>| {
        let share = if rigid && !network.backbone[disk] { limit.sqrt() } else { limit };
        norm(*force) > share * mean
    };
    let disks = network.forces().iter().enumerate();
    disks
        .filter(|&(disk, force)| !state.packing.held()[disk] && above(disk, force))
        .map(|(disk, force)| Unbalanced { disk, force: *force })
        .collect()
}

/// Whether most of the unbalanced disks satisfy `such`.
fn most<const D: usize>(unbalanced: &[Unbalanced<D>], such: impl Fn(&Unbalanced<D>) -> bool) -> bool {
    let count = unbalanced.iter().filter(|it| such(it)).count();
    count > 0 && count as f64 >= MOST * unbalanced.len() as f64
}

/// No held disk beyond R, or unbalanced disks within a contact range of R.
fn boundary<const D: usize>(state: &State<'_, D>, place: Place, unbalanced: &[Unbalanced<D>]) -> Option<Cause> {
    let (packing, outer_radius) = (state.packing, place.outer_radius?);
    let distance = |disk: usize| norm(packing.separation(disk, place.centre));
    let others = || (0..packing.len()).filter(|&disk| disk != place.centre);
    if !others().any(|disk| packing.held()[disk]) {
        let farthest = others().map(distance).fold(0.0, larger);
        return Some(Cause::NothingHeld { outer_radius, farthest });
    }
    let reach = 2.0 * packing.radii().iter().copied().fold(0.0, larger);
    if !most(unbalanced, |it| distance(it.disk) >= outer_radius - reach) {
        return None;
    }
    let outward = |it: &&Unbalanced<D>| dot(it.force, packing.separation(it.disk, place.centre)) > 0.0;
    let mobile_count = others().filter(|&disk| !packing.held()[disk]).count();
    let inside = ball_volume::<D>(outer_radius);
    let shell = ball_volume::<D>(outer_radius + reach) - inside;
    Some(Cause::Boundary {
        outer_radius,
        unbalanced_count: unbalanced.len(),
        outward_count: unbalanced.iter().filter(outward).count(),
        held_count: others().filter(|&disk| packing.held()[disk] && distance(disk) <= outer_radius + reach).count(),
        expected_count: (mobile_count as f64 * shell / inside).round() as usize,
    })
}

/// Disks, other than the inflated one, whose radius differs between states.
fn other_radii<const D: usize>(states: &[(&'static str, &State<'_, D>)], place: Place) -> Option<Cause> {
    let (_, first) = states.first()?;
    let changed = |disk: &usize| {
        let radius = first.packing.radii()[*disk];
        states.iter().any(|(_, state)| state.packing.radii()[*disk] != radius)
    };
    let mut all = (0..first.packing.len()).filter(|&disk| disk != place.centre).filter(changed);
    let label = first.packing.labels()[all.next()?];
    Some(Cause::OtherRadii { count: 1 + all.count(), label })
}

/// Unbalanced disks that touch, or nearly touch, the inflated one.
fn centre<const D: usize>(state: &State<'_, D>, place: Place, unbalanced: &[Unbalanced<D>]) -> Option<Cause> {
    let packing = state.packing;
    let touches = |it: &Unbalanced<D>| {
        let range = packing.radii()[it.disk] + packing.radii()[place.centre];
        it.disk == place.centre || norm(packing.separation(it.disk, place.centre)) <= 1.1 * range
    };
    let label = packing.labels()[place.centre];
    most(unbalanced, touches).then_some(Cause::Centre { label, unbalanced_count: unbalanced.len() })
}
