//! The observables of LAMMPS's own states before and after an inflation are those of ours, where both ended in one minimum.
//!
//! Places of the backbone differ by up to e_b before and e_a after, both measured. What that may change:
//!
//! * d of a disk by e_a + e_b, d_r by |d| e_b/r more, since the direction turns: ε = e_a + e_b (1 + |d|/r);
//! * means over disks by no more than ε, their spread neither (a standard deviation is a norm);
//! * functions O of a ring by Σ_k |∂O/∂x_k| ε + |∂O/∂θ_k| e_b/r, from differences, a hundredth more for the second order;
//! * a coefficient of least squares by ε √n times its error over σ (Cauchy, Schwarz: the error is σ times the norm of the row);
//! * d_∥ of a bond by 2 ε; a contact by being there or not where its overlap is below 2 e.

use std::collections::BTreeSet;

use jamscope::displacement::{DisplacementField, Shape};
use jamscope::inflation::{Drive, Inflated, Rest};
use jamscope::law::{Hertzian, Hookean, PairLaw};
use jamscope::network::ContactNetwork;
use jamscope::observe::angular::{
    AngularCorrelation, CorrelationSettings, PowerSpectrum, RingSample, RingSettings, SpectrumSettings,
};
use jamscope::observe::bond_changes::{BondChanges, BondSet};
use jamscope::observe::fluctuations::{BondMeasure, Fluctuations};
use jamscope::observe::multipoles::{MultipoleFit, MultipoleSettings, Multipoles};
use jamscope::observe::{AngularProfile, ContactChanges, ExcessCoordination, PressureChange, RadialProfile};
use jamscope::packing::Packing;
use jamscope::relax::{Fire, ForceLimit, Outcome, Relaxer, Stop};
use jamscope::vector::{difference, larger, norm};
use rand::RngExt;

use super::generator;
use crate::lammps_inflated::{INFLATED_RADIUS, Inflated as Stored};

/// A state at rest, its pressure that of the circle of LAMMPS.
fn rest(stored: &Stored, packing: Packing<2>, law: &dyn PairLaw, limit: ForceLimit) -> Rest<2> {
    let fire = Fire { limit, ..Fire::default() };
    let outcome = fire.relax(packing, law, &mut ()).expect("no coincidence");
    let Outcome { residual, rounding_floor, cost, stop: Stop::Converged(criterion), .. } = outcome else {
        panic!("{:?}", outcome.stop)
    };
    let packing = outcome.converged().expect("it says so");
    let network = ContactNetwork::new(packing.get(), law).expect("no coincidence");
    Rest {
        pressure: stored.pressure(&network),
        energy: network.energy(),
        contact_count: network.contacts.len(),
        rattler_count: network.rattlers().count(),
        packing,
        backbone: network.backbone,
        residual,
        rounding_floor,
        criterion,
        cost,
    }
}

fn inflated(stored: &Stored, before: Rest<2>, after: Rest<2>) -> Inflated<2> {
    let start = before.packing.get().clone().with_radius(stored.mobile_count, INFLATED_RADIUS).expect("positive");
    Inflated {
        drive: Drive::Inflation,
        start,
        centre: stored.mobile_count,
        grown: vec![stored.mobile_count],
        shape: Shape::Round,
        inner_radius: 0.5,
        outer_radius: stored.outer_radius,
        mobile_count: stored.mobile_count,
        before,
        after,
        deflated: None,
    }
}

/// LAMMPS's states as they are: so lenient a limit that nothing moves.
fn theirs(stored: &Stored, law: &dyn PairLaw) -> Inflated<2> {
    let [before, after] = [stored.before(0.5), stored.packing(stored.after.clone(), INFLATED_RADIUS)].map(|packing| {
        let positions = packing.positions().to_vec();
        let rest = rest(stored, packing, law, ForceLimit::Absolute(0.1));
        assert_eq!((rest.cost.step_count, rest.packing.get().positions()), (0, positions.as_slice()));
        rest
    });
    inflated(stored, before, after)
}

/// Largest distance of a disk that counts in both.
fn apart(one: &Rest<2>, two: &Rest<2>) -> f64 {
    assert_eq!(one.backbone, two.backbone, "one minimum has one backbone");
    let [a, b] = [one, two].map(|rest| rest.packing.get());
    let way = |disk: usize| {
        let ((x, x_rest), (y, y_rest)) = (a.centre(disk), b.centre(disk));
        norm([0, 1].map(|axis| (x[axis] - y[axis]) + (x_rest[axis] - y_rest[axis])))
    };
    (0..a.len()).filter(|&disk| one.backbone[disk]).map(way).fold(0.0, larger)
}

fn within(what: &str, ours: f64, theirs: f64, allowed: f64) {
    assert!((ours - theirs).abs() <= allowed, "{what}: {ours} against {theirs}, {allowed:e} allowed");
}

/// What may change by so much in every value and every angle of a ring.
fn allowed(ring: &RingSample, value: f64, angle: f64, of: impl Fn(&RingSample) -> Vec<f64>) -> Vec<f64> {
    let plain = of(ring);
    let mut sum = vec![0.0; plain.len()];
    let mut add = |angles: &[f64], values: &[f64], share: f64| {
        let changed = of(&RingSample::new(angles, values).expect("as before"));
        for (sum, (a, b)) in sum.iter_mut().zip(changed.iter().zip(&plain)) {
            *sum += share * (a - b).abs();
        }
    };
    let spread = ring.values().iter().map(|x| x.abs()).fold(0.0, larger);
    for disk in 0..ring.disk_count() {
        // Steps of 10⁻⁵: what is neglected is as small, and rounding 10⁻¹¹ of what is found.
        let (mut values, mut angles) = (ring.values().to_vec(), ring.angles().to_vec());
        values[disk] += 1e-5 * spread;
        add(ring.angles(), &values, value / (1e-5 * spread));
        // No disk is passed: angles are tenths apart, or thousandths.
        angles[disk] += 1e-5;
        add(&angles, ring.values(), angle / 1e-5);
    }
    sum.iter().map(|sum| 1.01 * sum + 1e-12).collect()
}

/// S to n/8, then G at every half degree with its crossings; what is not there is NaN.
fn spectrum_and_correlation(ring: &RingSample) -> Vec<f64> {
    let spectrum = PowerSpectrum::of(ring, &SpectrumSettings::default()).expect("enough disks");
    let correlation = AngularCorrelation::of(ring, &CorrelationSettings::default()).expect("enough disks");
    let crossings = correlation.crossings.iter().map(|crossing| crossing.outcome.angle().unwrap_or(f64::NAN));
    // Over the variance: with leakage removed a single power may be negative, that at f = 1 too.
    let relative = spectrum.power[1..].iter().map(|power| power / spectrum.variance);
    relative.chain(correlation.values.iter().copied()).chain(crossings).collect()
}

/// Pairs of disks and the overlaps of the nearer.
fn pairs(rest: &Rest<2>, law: &dyn PairLaw) -> BTreeSet<(u32, u32)> {
    let network = ContactNetwork::new(rest.packing.get(), law).expect("no coincidence");
    network.contacts.iter().map(|contact| (contact.first, contact.second)).collect()
}

fn observables_agree(stored: &Stored, ours: &Inflated<2>, law: &dyn PairLaw) {
    let (name, theirs) = (stored.name.as_str(), &theirs(stored, law));
    let network = ContactNetwork::new(ours.after.packing.get(), law).expect("no coincidence");
    let distance = stored.distance(ours.after.packing.get(), &network);
    assert!(distance < 1e-7, "{name}: another minimum, {distance:e} away");
    let (before, after) = (apart(&ours.before, &theirs.before), apart(&ours.after, &theirs.after));
    println!("{name}: apart by {before:.1e} before, {after:.1e} after");
    // Force limit 10⁻⁷ over the softest stiffness, as `tests/lammps.rs` has it; before: the rounding of coordinates, a force of 3·10⁻⁸.
    assert!(before < 1e-7 && after < 1e-7, "{name}: {before:e}, {after:e}");
    let [field, their_field] = [ours, theirs].map(DisplacementField::of_inflation);

    // Disk by disk.
    let mut epsilon: f64 = 0.0;
    for (a, b) in field.disks.iter().zip(&their_field.disks) {
        assert_eq!((a.disk, a.counted), (b.disk, b.counted), "{name}");
        if a.counted {
            let own = after + before * (1.0 + norm(a.displacement) / a.distance) + 1e-14;
            epsilon = larger(epsilon, own);
            assert!(norm(difference(a.displacement, b.displacement)) <= own, "{name}: disk {}", a.disk);
            within(&format!("{name}: d_r of disk {}", a.disk), a.radial, b.radial, own);
        }
    }

    // The radial profile.
    let [profile, their_profile] = [&field, &their_field].map(|field| RadialProfile::of(field, 1.0));
    assert_eq!(profile.rings.len(), their_profile.rings.len());
    for (a, b) in profile.rings.iter().zip(&their_profile.rings) {
        assert_eq!(a.disk_count, b.disk_count, "{name}: no disk stands that near to the edge of a ring");
        within("ring", a.mean, b.mean, epsilon);
        within("spread", a.spread, b.spread, epsilon * (a.disk_count as f64 / (a.disk_count - 1).max(1) as f64).sqrt());
    }

    // The ring r̂ = 0.5 ± 0.03.
    let settings = RingSettings::default();
    let [ring, their_ring] = [&field, &their_field].map(|field| RingSample::of_field(field, &settings).expect("disks"));
    let distance =
        AngularProfile::of(&field, 0.5).distances.iter().copied().fold(f64::INFINITY, |a, b| -larger(-a, -b));
    let limits = allowed(&ring, epsilon, before / distance, spectrum_and_correlation);
    let (values, their_values) = (spectrum_and_correlation(&ring), spectrum_and_correlation(&their_ring));
    let mut largest: f64 = 0.0;
    for (index, (value, limit)) in values.iter().zip(&limits).enumerate() {
        let theirs = their_values[index];
        assert_eq!(value.is_nan(), theirs.is_nan(), "{name}: a crossing in one");
        if !value.is_nan() {
            largest = larger(largest, *limit);
            within(&format!("{name}: number {index} of S, G and θ*"), *value, theirs, *limit);
        }
    }
    println!("{name}: {} disks in the ring, S, G and θ* to {largest:.1e} and less", ring.disk_count());
    // The tolerance tells: G is of order 1.
    assert!(largest < 1e-2, "{name}: {largest:e}");

    // Angular modes.
    let [modes, their_modes] =
        [&field, &their_field].map(|field| Multipoles::of(field, &MultipoleSettings::default()).expect("settings"));
    let mut fitted = 0;
    for (a, b) in modes.rings.iter().zip(&their_modes.rings) {
        let (MultipoleFit::Fitted { radial, transverse }, MultipoleFit::Fitted { radial: theirs, transverse: other }) =
            (&a.fit, &b.fit)
        else {
            assert_eq!(std::mem::discriminant(&a.fit), std::mem::discriminant(&b.fit), "{name}");
            continue;
        };
        fitted += 1;
        for (ours, theirs) in [(radial, theirs), (transverse, other)] {
            for (mode, their_mode) in ours.modes.iter().zip(&theirs.modes) {
                // Angles turn by e_b/r, which moves a mode n of size A by n A e_b/r: 4 modes of less than 0.1 over r > 3.
                let row = |error: f64| (a.disk_count as f64).sqrt() * error / ours.rest;
                let limit = |error: f64| row(error) * (epsilon + 4.0 * 0.1 * before) + 1e-14;
                within("cosine", mode.cosine, their_mode.cosine, limit(mode.standard_errors[0]));
                within("sine", mode.sine, their_mode.sine, limit(mode.standard_errors[1]));
            }
        }
    }
    assert!(fitted >= 5, "{name}: {fitted} rings have modes");

    // ΔZ, Δp, contacts, bonds.
    let excess = |inflated: &Inflated<2>| {
        let network = ContactNetwork::new(inflated.before.packing.get(), law).expect("no coincidence");
        ExcessCoordination::of(&network).expect("jammed")
    };
    assert_eq!(excess(ours), excess(theirs), "{name}");
    let network = ContactNetwork::new(ours.before.packing.get(), law).expect("no coincidence");
    let mean = network.contacts.iter().map(|contact| contact.overlap).sum::<f64>() / network.contacts.len() as f64;
    let [change, their_change] = [ours, theirs].map(|inflated| PressureChange::of_inflation(inflated, law));
    // A contact force changes by (α − 1)/δ of itself times the change of its length, up to 2 e.
    let sensitivity = (law.exponent() - 1.0) / mean * 2.0 * (before + after);
    within(&format!("{name}: Δp"), change.change, their_change.change, (sensitivity + 1e-12) * change.after);

    let near = |rest: &Rest<2>, e: f64| {
        let network = ContactNetwork::new(rest.packing.get(), law).expect("no coincidence");
        network.backbone_contacts().filter(|contact| contact.overlap <= 2.0 * e).count()
    };
    let doubtful = near(&ours.before, before)
        + near(&ours.after, after)
        + near(&theirs.before, before)
        + near(&theirs.after, after);
    let [contacts, their_contacts] =
        [ours, theirs].map(|inflated| ContactChanges::of_inflation(inflated, law).expect("no coincidence"));
    let keys = |contacts: &[jamscope::observe::contact_changes::ChangedContact<2>]| -> BTreeSet<(u32, u32)> {
        contacts.iter().map(|contact| (contact.first, contact.second)).collect()
    };
    let differing = keys(&contacts.made).symmetric_difference(&keys(&their_contacts.made)).count()
        + keys(&contacts.broken).symmetric_difference(&keys(&their_contacts.broken)).count();
    let (made, broken) = (contacts.made.len(), contacts.broken.len());
    println!("{name}: {made} made, {broken} broken, {differing} differ, {doubtful} within rounding");
    assert!(made + broken > 0 && differing <= 2 * doubtful, "{name}: {differing} differ, {doubtful} may");

    let [bonds, their_bonds] =
        [ours, theirs].map(|inflated| BondChanges::of_inflation(inflated, law, BondSet::Kept).expect("no coincidence"));
    if pairs(&ours.before, law) == pairs(&theirs.before, law) && differing == 0 {
        assert_eq!(bonds.bonds.len(), their_bonds.bonds.len());
        for (a, b) in bonds.bonds.iter().zip(&their_bonds.bonds) {
            assert_eq!((a.first, a.second), (b.first, b.second), "{name}");
            // n turns by 2 e_b over a length of 1: |d_i − d_j| of less than 1 times that.
            within("d_∥", a.parallel, b.parallel, 2.0 * epsilon + 2.0 * before);
        }
        let [fluctuations, theirs] = [&bonds, &their_bonds]
            .map(|bonds| Fluctuations::of_bonds(bonds, BondMeasure::Parallel, field.outer_radius, 1.0));
        for (a, b) in fluctuations.rings.iter().zip(&theirs.rings) {
            assert_eq!(a.count, b.count, "{name}");
            within("h_∥", a.fluctuation, b.fluctuation, 2.0 * (2.0 * epsilon + 2.0 * before));
        }
    } else {
        assert!(doubtful > 0, "{name}: contacts differ without one that may");
    }
}

/// From the inflated start, by FIRE.
fn ours(stored: &Stored, law: &dyn PairLaw) -> Inflated<2> {
    let exact = ForceLimit::Relative(1e-12);
    let before = rest(stored, stored.before(0.5), law, exact);
    inflated(stored, before, rest(stored, stored.before(INFLATED_RADIUS), law, exact))
}

#[test]
fn observables_of_lammps_are_ours_hertzian() {
    let law = Hertzian::default();
    for name in [
        "hertz_N1000_p800_fire",
        "hertz_N1000_p800_md",
        "hertz_N1000_p800_mdnet",
        "hertz_N1000_p100_fire",
        "hertz_N1000_p10_fire",
    ] {
        let stored = Stored::read(name);
        observables_agree(&stored, &ours(&stored, &law), &law);
    }
}

#[test]
fn observables_of_lammps_are_ours_hookean() {
    let law = Hookean::default();
    for name in ["hooke_N1000_p5000_fire", "hooke_N1000_p5000_md", "hooke_N1000_p5000_mdnet", "hooke_N1000_p800_fire"] {
        let stored = Stored::read(name);
        observables_agree(&stored, &ours(&stored, &law), &law);
    }
}

/// From the inflated start the two end in different minima here (`tests/lammps.rs`): ours comes back from a push of 10⁻⁵.
#[test]
fn observables_of_lammps_are_ours_among_four_thousand_disks() {
    let (law, exact) = (Hookean::default(), ForceLimit::Relative(1e-12));
    let stored = Stored::read("hooke_N5548_p800_fire");
    let mut generator = generator(1);
    let mut pushed = stored.after.clone();
    for position in &mut pushed[..stored.mobile_count] {
        *position = position.map(|x| x + 1e-5 * (2.0 * generator.random::<f64>() - 1.0));
    }
    let after = rest(&stored, stored.packing(pushed, INFLATED_RADIUS), &law, exact);
    let ours = inflated(&stored, rest(&stored, stored.before(0.5), &law, exact), after);
    observables_agree(&stored, &ours, &law);
}
