//! Drives that inflate nothing: a point force, a force dipole, a displaced disk, shear and compression of the rim.

use std::f64::consts::FRAC_PI_6;

use jamscope::displacement::DisplacementField;
use jamscope::inflation::{
    Applied, Boundary, Centre, Circle, Drive, Inflated, Inflation, InflationError, inflate_with,
};
use jamscope::lattice::Lattice;
use jamscope::law::{Hookean, OnSite, PairLaw};
use jamscope::linear::{LinearResponse, Prestress};
use jamscope::network::ContactNetwork;
use jamscope::observe::multipoles::MultipoleSettings;
use jamscope::packing::{Domain, Packing, PackingError};
use jamscope::plastic::{PlasticPart, linear_response};
use jamscope::preparation::{Preparation, Target, prepare_with};
use jamscope::reference::Annulus;
use jamscope::reference::angular_modes::AngularSolution;
use jamscope::reference::angular_modes::force_dipole::ForceDipole;
use jamscope::reference::angular_modes::point_force::PointForce;
use jamscope::reference::angular_modes::screened_source::ScreenedSource;
use jamscope::relax::{DampedDynamics, Fire, ForceLimit, Newton, Relaxer, Stop};
use jamscope::run::DriveSummary;
use jamscope::vector::{difference, dot, larger, norm, scaled, sum};

use crate::scenes::laws::hertzian;

fn fire(limit: f64) -> Fire {
    Fire { limit: ForceLimit::Relative(limit), step_limit: 1_000_000, ..Fire::default() }
}

/// A packing of 400 disks at p = 1000.
fn packing() -> Packing<2> {
    let preparation = Preparation { disk_count: 400, target: Target::Pressure(1000.0), ..Preparation::default() };
    prepare_with::<2>(&preparation, &hertzian(), &fire(1e-12), &mut ()).expect("a packing").packing.into_inner()
}

const DRIVES: [Drive; 5] = [
    Drive::PointForce { force_over_mean: 0.1 },
    Drive::ForceDipole { force_over_mean: 0.1 },
    Drive::Displacement { distance: 0.01 },
    Drive::Shear { strain: 0.001 },
    Drive::Compression { strain: 0.001 },
];

/// The drive with its amplitude times a factor.
fn times(drive: Drive, factor: f64) -> Drive {
    match drive {
        Drive::PointForce { force_over_mean } => Drive::PointForce { force_over_mean: force_over_mean * factor },
        Drive::ForceDipole { force_over_mean } => Drive::ForceDipole { force_over_mean: force_over_mean * factor },
        Drive::Displacement { distance } => Drive::Displacement { distance: distance * factor },
        Drive::Shear { strain } => Drive::Shear { strain: strain * factor },
        Drive::Compression { strain } => Drive::Compression { strain: strain * factor },
        Drive::Inflation => Drive::Inflation,
    }
}

fn rim(drive: Drive) -> Inflation {
    Inflation { drive, boundary: Boundary::HeldRim { outer_radius_over_side: 0.48 }, ..Inflation::default() }
}

fn driven(drive: Drive, packing: &Packing<2>) -> Inflated<2> {
    inflate_with(&rim(drive), packing, &hertzian(), &fire(1e-12), 1, &mut ()).expect("at rest")
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

#[test]
fn each_drive_does_what_it_says_before_any_disk_moves() {
    let packing = packing();
    for drive in DRIVES {
        let run = driven(drive, &packing);
        let (before, start, centre) = (run.before.packing.get(), &run.start, run.centre);
        assert_eq!(before.held()[centre], matches!(drive, Drive::Displacement { .. }), "{drive:?}");
        assert!((centre + 1..before.len()).all(|disk| before.held()[disk]), "the rim is held");
        assert_eq!(before.radii(), start.radii());
        let network = ContactNetwork::new(before, &hertzian()).expect("apart");
        let forces: Vec<f64> = network.backbone_contacts().map(|contact| contact.force).collect();
        let mean = forces.iter().sum::<f64>() / forces.len() as f64;
        let applied = Applied::of(before, start, centre);
        let moved = |disk: usize| -> [f64; 2] { difference(start.positions()[disk], before.positions()[disk]) };
        match drive {
            Drive::PointForce { .. } => {
                assert!((applied.force[0] - 0.1 * mean).abs() < 1e-12 * mean && applied.force[1] == 0.0);
                assert_eq!((applied.arm, applied.displacement), (None, [0.0; 2]));
            }
            Drive::ForceDipole { .. } => {
                let loads = start.loads().expect("loads");
                let pushed: Vec<usize> = (0..loads.len()).filter(|&disk| loads[disk] != [0.0; 2]).collect();
                assert_eq!(pushed.len(), 2);
                let arm = applied.arm.expect("two disks");
                assert!((norm(applied.force) - 0.1 * mean).abs() < 1e-12 * mean);
                assert_eq!(loads.iter().fold([0.0; 2], |total, &load| sum(total, load)), [0.0; 2]);
                assert!(dot(applied.force, arm) < 0.0, "apart");
                assert!(cross(applied.force, arm).abs() < 1e-15 * mean, "no torque");
                // The neighbour in contact whose direction is nearest to x.
                let along = |other: usize| {
                    let apart = before.separation(other, centre);
                    apart[0] / norm(apart)
                };
                let touching = network.backbone_contacts().filter_map(|contact| match centre as u32 {
                    it if it == contact.first => Some(contact.second as usize),
                    it if it == contact.second => Some(contact.first as usize),
                    _ => None,
                });
                let best = touching.map(along).fold(f64::NEG_INFINITY, f64::max);
                assert!((arm[0] / norm(arm) - best).abs() < 1e-15);
            }
            Drive::Displacement { distance } => {
                assert_eq!(applied.displacement, [distance, 0.0]);
                assert!((0..before.len()).filter(|&disk| disk != centre).all(|disk| moved(disk) == [0.0; 2]));
            }
            Drive::Shear { .. } | Drive::Compression { .. } => {
                let strain = drive.strain::<2>();
                for disk in 0..before.len() {
                    let affine = strain.of(before.positions()[disk]);
                    assert!(norm(difference(moved(disk), affine)) < 1e-14, "{drive:?}");
                }
                let area = (1.0 + strain.first) * (1.0 + strain.others);
                assert_eq!(strain.volume_ratio::<2>(), area);
                // Pure shear keeps the area to first order.
                assert!(matches!(drive, Drive::Compression { .. }) || (area - 1.0).abs() < 1e-6);
            }
            Drive::Inflation => unreachable!("not among the drives"),
        }
    }
}

/// Newton's third law and the balance of torques: the rim and a held disk carry exactly the loads.
#[test]
fn forces_and_torques_of_every_drive_are_balanced() {
    let packing = packing();
    for drive in DRIVES {
        let run = driven(drive, &packing);
        let after = run.after.packing.get();
        let network = ContactNetwork::new(after, &hertzian()).expect("apart");
        let (mut force, mut torque, mut mean) = ([0.0; 2], 0.0, 0.0);
        for contact in &network.contacts {
            let push = scaled(contact.force / norm(contact.separation), contact.separation);
            mean += contact.force / network.contacts.len() as f64;
            for (disk, sign) in [(contact.first as usize, 1.0), (contact.second as usize, -1.0)] {
                if after.held()[disk] {
                    force = sum(force, scaled(sign, push));
                    torque += sign * cross(after.positions()[disk], push);
                }
            }
        }
        for (disk, &load) in run.start.loads().unwrap_or_default().iter().enumerate() {
            force = difference(force, load);
            torque -= cross(after.positions()[disk], load);
        }
        // 300 mobile disks with a residual of 10⁻¹² of the mean force each, at distances up to 10.
        assert!(norm(force) < 3e-10 * mean, "{drive:?}: {force:?} of {mean}");
        assert!(torque.abs() < 3e-9 * mean, "{drive:?}: {torque} of {mean}");
    }
}

/// As the amplitude falls the relaxed response tends to the linear one, with a deviation of second order while no contact
/// changes.
#[test]
fn small_drives_have_their_linear_response() {
    let (packing, law) = (packing(), hertzian());
    for drive in DRIVES {
        let share = |factor: f64| {
            let run = inflate_with(&rim(times(drive, factor)), &packing, &law, &fire(1e-13), 1, &mut ());
            let run = run.expect("at rest");
            let response = linear_response(&run, &law).expect("a response");
            let part = PlasticPart::of(&run, &response);
            assert!(part.norm > 0.0 && run.before.contact_count > 500);
            part.share
        };
        let [large, small] = [share(1e-2), share(1e-3)];
        println!("{drive:?}: {large:e}, {small:e}");
        // The share is of first order in the amplitude, up to the next order, 10⁻², and the residual of 10⁻¹³.
        assert!((large / small / 10.0 - 1.0).abs() < 0.05 && large < 0.02, "{drive:?}: {large:e}, {small:e}");
    }
}

/// Without a plastic event a drive that is taken back leaves the disks where they were.
#[test]
fn a_drive_that_is_taken_back_leaves_nothing() {
    let packing = packing();
    for drive in DRIVES {
        let inflation = Inflation { deflate: true, ..rim(times(drive, 1e-4)) };
        let run = inflate_with(&inflation, &packing, &hertzian(), &fire(1e-13), 1, &mut ()).expect("at rest");
        let (before, again) = (run.before.packing.get(), run.deflated.as_ref().expect("taken back").packing.get());
        assert!(again.loads().is_none() && again.sites().is_none() && before.radii() == again.radii());
        let most = |field: &DisplacementField<2>| field.counted().map(|disk| norm(disk.displacement)).fold(0.0, larger);
        let (out, left) =
            (most(&DisplacementField::of_inflation(&run)), most(&DisplacementField::of_cycle(&run).expect("both")));
        assert!(left < 1e-6 * out, "{drive:?}: {left:e} of {out:e}");
        let held = (0..before.len()).filter(|&disk| before.held()[disk]);
        held.for_each(|disk| assert_eq!(before.centre(disk), again.centre(disk), "{drive:?}: disk {disk} is held"));
    }
}

/// The relaxers agree on the state of a packing with loads. That loads are the gradient of their energy: `contact::loads`.
#[test]
fn all_relaxers_find_the_state_of_a_packing_with_loads() {
    let circle = Circle::cut(&packing(), 7, 8.0).expect("a circle").with_free_centre().expect("one a disk").packing;
    let loads: Vec<[f64; 2]> =
        (0..circle.len()).map(|disk| [3.0 * (disk as f64).sin(), 3.0 * (3.0 * disk as f64).cos()]).collect();
    let law = hertzian();
    let start = circle.with_loads(loads).expect("finite");
    let state = |relaxer: &dyn Fn(Packing<2>) -> Packing<2>| relaxer(start.clone());
    let by_fire =
        state(&|it| fire(1e-11).relax(it, &law, &mut ()).expect("apart").converged().expect("at rest").into_inner());
    let newton = Newton { limit: ForceLimit::Relative(1e-11), ..Newton::default() };
    let by_newton =
        state(&|it| newton.relax(it, &law, &mut ()).expect("apart").converged().expect("at rest").into_inner());
    let damped = DampedDynamics { limit: ForceLimit::Relative(1e-9), ..DampedDynamics::default() };
    let by_motion =
        state(&|it| damped.relax(it, &law, &mut ()).expect("apart").converged().expect("at rest").into_inner());
    let network = ContactNetwork::new(&by_fire, &law).expect("apart");
    for (name, other, limit) in [("Newton", &by_newton, 1e-9), ("damped dynamics", &by_motion, 1e-6)] {
        let counted = (0..by_fire.len()).filter(|&disk| network.backbone[disk] && !by_fire.held()[disk]);
        let apart =
            counted.map(|disk| norm(difference(by_fire.positions()[disk], other.positions()[disk]))).fold(0.0, larger);
        // Residuals over the softest stiffness, 10⁻³ of that of a contact.
        assert!(apart < limit, "{name}: {apart:e}");
    }
    let moved = norm(difference(by_fire.positions()[0], start.positions()[0]));
    assert!(moved > 1e-5, "the loads move the disks: {moved:e}");
}

#[test]
fn drives_without_a_meaning_are_refused() {
    let packing = packing();
    let run = |inflation: &Inflation| inflate_with(inflation, &packing, &hertzian(), &fire(1e-8), 1, &mut ());
    let strip = Boundary::HeldWalls { distance_over_side: 0.35, length_over_side: 1.0 };
    for drive in DRIVES {
        let refused = run(&Inflation { boundary: strip, ..rim(drive) });
        assert!(matches!(refused, Err(InflationError::DriveNeedsRim { .. })), "{drive:?}");
        let periodic = run(&Inflation { boundary: Boundary::Periodic, ..rim(drive) });
        match drive {
            Drive::ForceDipole { .. } => assert!(periodic.is_ok()),
            _ => assert!(matches!(periodic, Err(InflationError::DriveNeedsRim { .. })), "{drive:?}"),
        }
        let refused = run(&rim(times(drive, f64::NAN)));
        assert!(matches!(refused, Err(InflationError::DriveOutOfRange { .. })), "{drive:?}");
    }
    let apart = Packing::new(*packing.domain(), packing.positions().to_vec(), vec![0.1; packing.len()]).expect("valid");
    let no_scale = inflate_with(&rim(DRIVES[0]), &apart, &hertzian(), &fire(1e-8), 1, &mut ());
    assert!(matches!(no_scale, Err(InflationError::NoContactForce)), "{no_scale:?}");
    // A force that no packing holds pushes the disk through the rim and away.
    let away = run(&rim(Drive::PointForce { force_over_mean: 1e6 }));
    assert!(matches!(away, Err(InflationError::NotAtRest { stop: Stop::NoMinimum, .. })), "{away:?}");
    assert!(matches!(run(&rim(Drive::Shear { strain: 0.2 })), Err(InflationError::DriveOutOfRange { .. })));
    let far = run(&rim(Drive::Displacement { distance: 0.6 }));
    assert!(matches!(far, Err(InflationError::DisplacementTooLong { .. })));
    assert!(matches!(
        packing.clone().with_loads(vec![[f64::NAN, 0.0]; packing.len()]),
        Err(PackingError::LoadNotFinite { disk: 0, axis: 0, .. })
    ));
    assert!(packing.clone().with_loads(vec![[0.0; 2]]).is_err());
}

/// A rim that is expanded by 10 % moves out by more than a disk: the disks inside follow it and have not left the circle.
#[test]
fn disks_that_follow_an_expanded_rim_have_not_left_it() {
    let preparation = Preparation { disk_count: 1387, target: Target::Pressure(1000.0), ..Preparation::default() };
    let packing = prepare_with::<2>(&preparation, &hertzian(), &fire(1e-8), &mut ()).expect("a packing").packing;
    let inflation = rim(Drive::Compression { strain: -0.1 });
    let run = inflate_with(&inflation, packing.get(), &hertzian(), &fire(1e-8), 1, &mut ()).expect("at rest");
    assert!(0.1 * run.outer_radius > 2.0 * packing.get().largest_radius());
    assert_eq!((run.after.contact_count, run.after.pressure), (0, 0.0), "so far the disks no longer touch");
}

/// Every Bravais lattice deforms affinely, so a triangular circle has no non-affine displacement at all.
#[test]
fn a_lattice_follows_a_strain_of_its_rim_exactly() {
    let lattice = Lattice::triangular(0.5, 0.05).expect("valid");
    let circle = lattice.circle(20.0).expect("a circle").with_free_centre().expect("one a disk");
    for law in [&hertzian() as &dyn PairLaw, &Hookean { stiffness: 1.0 }] {
        for drive in &DRIVES[3..] {
            let strain = drive.strain::<2>();
            let affine = |disk: usize| strain.of(circle.packing.positions()[disk]);
            let moved: Vec<_> =
                (0..circle.packing.len()).filter(|&it| circle.packing.held()[it]).map(|it| (it, affine(it))).collect();
            let response = LinearResponse::of_displacements(&circle.packing, &moved, law, Prestress::Included);
            let response = response.expect("a response");
            let off = |disk: usize| norm(difference(response.displacements[disk], affine(disk)));
            let worst = (0..circle.packing.len()).map(off).fold(0.0, larger);
            // A backward error of 10⁻¹⁵ times a condition number of (R/b)², of displacements of 0.02.
            assert!(worst < 1e-14, "{worst:e}");
        }
    }
}

/// The response of triangular lattices, whose rim is where the displacement vanishes, tends to Kelvin's solution and to that
/// of the dipole as (b/r)²: at fixed r/R the deviation falls by four when R doubles. The displaced disk is a point force
/// of the reaction on it. With sites the medium is screened; κR is far from the first pole, near which errors grow.
#[test]
fn lattices_tend_to_the_exact_solutions_of_their_drives() {
    let (lattice, law) = (Lattice::triangular(0.5, 0.05).expect("valid"), hertzian());
    let moduli = lattice.moduli(&law).expect("isotropic");
    let (poisson_ratio, spacing) = (1.0 - 2.0 * moduli.shear / moduli.longitudinal, lattice.spacing());
    for (name, reduced) in [("force", 0.0), ("dipole", 0.0), ("displaced", 0.0), ("force", 1.0), ("dipole", 1.0)] {
        let deviation = |outer_radius: f64| {
            let circle = lattice.circle(outer_radius).expect("a circle");
            let circle = if name == "displaced" { circle } else { circle.with_free_centre().expect("one a disk") };
            let (packing, centre) = (&circle.packing, circle.centre);
            let effective = lattice.effective_radius(&circle).expect("triangular");
            let annulus = Annulus::new(0.5, effective).expect("in order");
            let wavenumber = reduced / effective;
            let coupling = lattice.coupling(&law, wavenumber * wavenumber).expect("isotropic");
            let screening = coupling / (lattice.cell_area() * moduli.shear);
            let law = OnSite { law, coupling };
            let law: &dyn PairLaw = if reduced > 0.0 { &law } else { &law.law };
            let prestress = Prestress::Included;
            let neighbour =
                (0..centre).find(|&disk| norm(difference(packing.positions()[disk], [spacing, 0.0])) < 1e-9);
            let mut forces = vec![[0.0; 2]; packing.len()];
            let response = match name {
                "force" => {
                    forces[centre] = [moduli.shear, 0.0];
                    LinearResponse::of_forces(packing, &forces, law, prestress)
                }
                "dipole" => {
                    // Between the centre and its two neighbours along x, so that the middle of the dipole is the origin.
                    let other = (0..centre).find(|&disk| norm(sum(packing.positions()[disk], [spacing, 0.0])) < 1e-9);
                    forces[neighbour.expect("a neighbour")] = [moduli.shear, 0.0];
                    forces[other.expect("a neighbour")] = [-moduli.shear, 0.0];
                    LinearResponse::of_forces(packing, &forces, law, prestress)
                }
                _ => LinearResponse::of_displacements(packing, &[(centre, [1.0, 0.0])], law, prestress),
            };
            let response = response.expect("a response");
            let strength = match name {
                "dipole" => 2.0 * spacing,
                "displaced" => -response.force_change(packing, law, centre).expect("apart")[0] / moduli.shear,
                _ => 1.0,
            };
            let solution = |radius: f64, angle: f64| -> [f64; 2] {
                match (name, reduced > 0.0) {
                    ("dipole", false) => {
                        ForceDipole::new(annulus, poisson_ratio, strength).expect("valid").displacement(radius, angle)
                    }
                    ("dipole", true) => {
                        let [flat, long] =
                            ScreenedSource::dipole(annulus, poisson_ratio, screening, strength).expect("no pole");
                        sum(flat.displacement(radius, angle), long.displacement(radius, angle))
                    }
                    (_, true) => ScreenedSource::force(annulus, poisson_ratio, screening, strength)
                        .expect("no pole")
                        .displacement(radius, angle),
                    _ => PointForce::new(annulus, poisson_ratio, strength).expect("valid").displacement(radius, angle),
                }
            };
            let (mut worst, mut scale) = (0.0f64, 0.0f64);
            for disk in 0..centre {
                let [x, y] = packing.positions()[disk];
                let radius = x.hypot(y) / effective;
                if !(0.3..0.7).contains(&radius) {
                    continue;
                }
                let angle = y.atan2(x);
                let [along, across] = solution(x.hypot(y), angle);
                let (sine, cosine) = angle.sin_cos();
                let expected = [along * cosine - across * sine, along * sine + across * cosine];
                worst = larger(worst, norm(difference(response.displacements[disk], expected)));
                scale = larger(scale, norm(expected));
            }
            worst / scale
        };
        let [small, middle, large] = [12.0, 24.0, 48.0].map(deviation);
        let order = (small / large).log2() / 2.0;
        println!("{name}, κR = {reduced}: {small:.1e} {middle:.1e} {large:.1e}, order {order:.2}");
        // Corrections of the lattice are (b/r)² with r ≥ 0.3 R, and so are those of the rim.
        assert!(order > 1.8 && large < (spacing / (0.3 * 48.0)).powi(2), "{name}: {small:e} {middle:e} {large:e}");
    }
}

/// The whole chain on a lattice, moduli included: modes of the relaxed response against those of the continuum. The rim is the
/// nominal one, off by up to a spacing b: b/R of ln(R/r), which is 0.7 at R/2. The dipole acts half a spacing from the origin.
#[test]
fn the_summary_of_a_drive_in_a_lattice_is_its_continuum() {
    let (lattice, law) = (Lattice::triangular(0.5, 0.05).expect("valid"), hertzian());
    let periodic = lattice.periodic([64, 74]).expect("a lattice");
    let outer_radius = 0.48 * periodic.domain().lengths().expect("a box").into_iter().fold(f64::INFINITY, f64::min);
    let (drives, share) = (&DRIVES[..3], lattice.spacing() / outer_radius);
    for (&drive, reduced) in drives.iter().flat_map(|drive| [(drive, 0.0), (drive, 1.0)]) {
        let coupling = lattice.coupling(&law, f64::powi(reduced / outer_radius, 2)).expect("isotropic");
        let coupling = (reduced > 0.0).then_some(coupling);
        let inflation =
            Inflation { centre: Centre::Label(2000), on_site_coupling: coupling, ..rim(times(drive, 1e-3)) };
        let run = inflate_with(&inflation, &periodic, &law, &fire(1e-12), 1, &mut ()).expect("at rest");
        let settings = MultipoleSettings::default();
        let summary = DriveSummary::of(&run, &periodic, &law, coupling, &settings).expect("moduli").expect("a source");
        let deviation = summary.deviation(0.25 * outer_radius).expect("rings");
        println!("{drive:?}, κR = {reduced}: {deviation:.3}");
        let limit = if matches!(drive, Drive::ForceDipole { .. }) { 4.0 * share } else { 1.5 * share };
        assert!(deviation < limit, "{drive:?}, κR = {reduced}: {deviation}");
        if let Drive::Displacement { .. } = drive {
            assert!(summary.angle.abs() < 1e-6 && summary.distance == Some(1e-5), "{}", summary.angle);
        }
    }
    // With x and y exchanged the contacts have angles of 30° and 90°, so that the modes are turned.
    let [width, height] = periodic.domain().lengths().expect("a box");
    let domain = Domain::Periodic { corner: [0.0; 2], edges: [[height, 0.0], [0.0, width]] };
    let turned = periodic.positions().iter().map(|&[x, y]| [y, x]).collect();
    let turned = Packing::new(domain, turned, periodic.radii().to_vec()).expect("valid");
    let inflation = Inflation { centre: Centre::Label(2000), ..rim(times(DRIVES[1], 1e-3)) };
    let run = inflate_with(&inflation, &turned, &law, &fire(1e-12), 1, &mut ()).expect("at rest");
    let summary =
        DriveSummary::of(&run, &turned, &law, None, &MultipoleSettings::default()).expect("moduli").expect("a source");
    let deviation = summary.deviation(0.25 * outer_radius).expect("rings");
    assert!((summary.angle.abs() - FRAC_PI_6).abs() < 1e-6 && deviation < 4.0 * share, "{} {deviation}", summary.angle);
    let strained = inflate_with(&rim(DRIVES[3]), &periodic, &law, &fire(1e-10), 1, &mut ()).expect("at rest");
    let none = DriveSummary::of(&strained, &periodic, &law, None, &MultipoleSettings::default());
    assert!(none.expect("no error").is_none());
}

/// A compressed lattice is a lattice of smaller spacing b' = (1 − ε) b: nothing moves but affinely, and its pressure follows the
/// law and the area, p'/p = (δ'/δ)^(3/2) (b'/b)/(1 − ε)².
#[test]
fn a_compressed_lattice_has_the_pressure_of_its_new_spacing() {
    let lattice = Lattice::triangular(0.5, 0.05).expect("valid");
    let periodic = lattice.periodic([32, 38]).expect("a lattice");
    for strain in [0.001, -0.002, 0.01] {
        let inflation = Inflation { centre: Centre::Label(600), ..rim(Drive::Compression { strain }) };
        let run = inflate_with(&inflation, &periodic, &hertzian(), &fire(1e-12), 1, &mut ()).expect("at rest");
        let most =
            DisplacementField::of_inflation(&run).disks.iter().map(|disk| norm(disk.displacement)).fold(0.0, larger);
        assert!(most < 1e-10, "affine to the residual: {most:e}");
        let overlaps = [1.0 - strain, 1.0].map(|factor| 1.0 - factor * lattice.spacing());
        let expected = (overlaps[0] / overlaps[1]).powf(1.5) / (1.0 - strain);
        let found = run.after.pressure / run.before.pressure;
        // Twelve digits of the forces, and an overlap of 0.05 with the rounding of positions near 20.
        assert!((found / expected - 1.0).abs() < 1e-10, "{strain}: {found} and {expected}");
    }
}
