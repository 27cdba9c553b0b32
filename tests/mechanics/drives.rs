//! Other drives than a held disk: a row inflated in a strip, against its exact solutions, and a free disk in a circle; both
//! against the final states of LAMMPS (`fixtures/lammps/drives_*`).

use std::f64::consts::PI;

use jamscope::displacement::{DisplacementField, Moved, Shape};
use jamscope::inflation::{Boundary, Centre, Inflation, InflationError, Strip, inflate_with};
use jamscope::io::read_packing;
use jamscope::lattice::Lattice;
use jamscope::law::{Hookean, OnSite, PairLaw};
use jamscope::linear::{LinearError, LinearResponse, Prestress};
use jamscope::network::ContactNetwork;
use jamscope::observe::AngularProfile;
use jamscope::packing::{Mixture, Packing};
use jamscope::plastic::PlasticPart;
use jamscope::preparation::{Preparation, Target, prepare_with, random_points_in};
use jamscope::reference::Annulus;
use jamscope::reference::strip_modes::{StripAmplitudes, StripMode};
use jamscope::relax::{Fire, ForceLimit, Relaxer};
use jamscope::vector::{difference, larger, norm};

use crate::scenes::lammps_inflated::fixture;
use crate::scenes::laws::hertzian;

fn fire(limit: f64) -> Fire {
    Fire { limit: ForceLimit::Relative(limit), step_limit: 1_000_000, ..Fire::default() }
}

/// A packing of 400 disks at p = 1000 in a box twice as long as wide.
fn packing() -> Packing<2> {
    let preparation =
        Preparation { disk_count: 400, target: Target::Pressure(1000.0), side_ratio: 2.0, ..Preparation::default() };
    prepare_with::<2>(&preparation, &hertzian(), &fire(1e-12), &mut ()).expect("a packing").packing.into_inner()
}

fn strip_of(distance_over_side: f64) -> Inflation {
    Inflation {
        increase: 0.02,
        boundary: Boundary::HeldWalls { distance_over_side, length_over_side: 2.0 },
        ..Inflation::default()
    }
}

#[test]
fn a_strip_has_its_row_its_walls_and_the_rest() {
    let packing = packing();
    let lengths = packing.domain().lengths().expect("a box");
    assert!((lengths[0] / lengths[1] - 2.0).abs() < 1e-12, "the box is twice as long as wide");
    let wall_distance = 0.35 * lengths[1];
    for row_held in [true, false] {
        let strip = Strip::cut(&packing, 7, wall_distance, row_held).expect("a strip");
        // By brute force over the images across the box.
        let across = |disk: usize| {
            let apart = packing.positions()[disk][1] - packing.positions()[7][1];
            (-2..=2).map(|image| (apart + f64::from(image) * lengths[1]).abs()).fold(f64::INFINITY, f64::min)
        };
        for disk in 0..packing.len() {
            let (wall, row) = (across(disk) >= wall_distance, across(disk) < packing.radii()[disk]);
            assert_eq!((strip.is_wall(disk), strip.row.contains(&disk)), (wall, row), "disk {disk}");
            assert_eq!(strip.packing.held()[disk], wall || (row && row_held), "disk {disk}");
        }
        assert!(strip.row.contains(&7), "the line runs through the chosen disk");
        // A dense row: at most one diameter of a large disk between two centres.
        assert!(strip.row.len() as f64 > lengths[0] / 1.4, "{} disks on {}", strip.row.len(), lengths[0]);
        let walls = (0..packing.len()).filter(|&disk| strip.is_wall(disk)).count();
        assert_eq!(strip.mobile_count() + strip.row.len() + walls, packing.len());
        assert!((strip.area() - 2.0 * wall_distance * lengths[0]).abs() < 1e-9);
    }
}

#[test]
fn walls_that_are_too_thin_and_rows_that_cannot_grow_are_refused() {
    let packing = packing();
    let run = |inflation: &Inflation| inflate_with(inflation, &packing, &hertzian(), &fire(1e-8), 1, &mut ());
    assert!(matches!(run(&strip_of(0.499)), Err(InflationError::WallDistanceOutOfRange { .. })));
    assert!(matches!(run(&strip_of(0.0)), Err(InflationError::WallDistanceOutOfRange { .. })));
    assert!(matches!(run(&strip_of(0.03)), Err(InflationError::NoMobileDisk { .. })));
    let large = Inflation { increase: 1.0, ..strip_of(0.35) };
    assert!(matches!(run(&large), Err(InflationError::IncreaseTooLarge { .. })));
    let shrunk = Inflation { increase: -0.6, ..strip_of(0.35) };
    assert!(matches!(run(&shrunk), Err(InflationError::IncreaseNotPossible { .. })));
    assert!(random_points_in::<2>(0.0, 10, &Mixture::default(), 0.8, 1).is_err());
    let nothing = LinearResponse::of_growth(&packing, &[], &hertzian(), Prestress::Included);
    assert!(matches!(nothing, Err(LinearError::NothingGrows)));
}

/// The rows of a triangular lattice above the line, from the first mobile one to the last; the row of the centre is 0.
fn rows(lattice: &Lattice, packing: &Packing<2>, centre: usize) -> Vec<Option<usize>> {
    let height = 0.5 * 3f64.sqrt() * lattice.spacing();
    (0..packing.len())
        .map(|disk| {
            let place = packing.separation(disk, centre)[1] / height;
            (place > 0.5).then(|| place.round() as usize)
        })
        .collect()
}

/// A row of a triangular lattice that grows between held rows pushes each disk of the next ones by g (√3/2) twice. The rows
/// are a chain of springs of stiffness 2 B_yy, with B the block of the Hessian of one bond at 60°:
///
/// ```text
/// u_k = U_0 sin θ(m−k)/sin θm,  2 − 2 cos θ = Γ/(2 B_yy)      U_0 = g (√3/2)/B_yy = √3 g/2 / (¾ F' − F/(4b))
/// Γ = 0:  u_k = U_0 (m−k)/m
/// ```
///
/// m is the first held row. Without Γ this is the elastic strip with R at the held row; with it the screened one, as θ/h →
/// κ = √(Γ/(A (λ+2μ))) for h κ → 0.
#[test]
fn the_row_of_a_lattice_has_its_exact_response() {
    let lattice = Lattice::triangular(0.5, 0.05).expect("valid");
    for law in [&hertzian() as &dyn PairLaw, &Hookean { stiffness: 3.0 }] {
        for coupling in [0.0, 0.002, 0.01] {
            let periodic = lattice.periodic([12, 16]).expect("a lattice");
            let centre = 90;
            let height = 0.5 * 3f64.sqrt() * lattice.spacing();
            // Rows 0 to 9 move, row 10 is held.
            let strip = Strip::cut(&periodic, centre, 9.5 * height, true).expect("a strip");
            assert_eq!(strip.row.len(), 12);
            let (force, stiffness) = {
                let force = law.force(law.coefficient(0.5, 0.5), lattice.overlap());
                (force, law.stiffness(force, lattice.overlap()))
            };
            let push = stiffness + force * law.coefficient_growth(0.5, 0.5);
            let bond = 0.75 * stiffness - 0.25 * force / lattice.spacing();
            let amplitude = 0.5 * 3f64.sqrt() * push / bond;
            let coupling = coupling * bond;
            let law = OnSite { law: law.shared(), coupling };
            let response =
                LinearResponse::of_growth(&strip.packing, &strip.row, &law, Prestress::Included).expect("a response");
            let angle = (1.0 - coupling / (4.0 * bond)).acos();
            let mut counted = 0;
            for (disk, row) in rows(&lattice, &periodic, centre).into_iter().enumerate() {
                let Some(row) = row.filter(|&row| row < 10) else { continue };
                let share = |row: f64| if coupling == 0.0 { 10.0 - row } else { (angle * (10.0 - row)).sin() };
                let exact = amplitude * share(row as f64) / share(0.0);
                let [x, y] = response.displacements[disk];
                // Backward error 10⁻¹⁵ times a condition number of 100 for ten rows, and the rounding of the overlaps.
                assert!((y - exact).abs() < 1e-11 && x.abs() < 1e-11, "{coupling} row {row}: {y} and {exact}");
                counted += 1;
            }
            assert_eq!(counted, 9 * 12);
            // Long waves: κ² A (λ+2μ) = Γ, with h κ below 0.1 an error of (hκ)²/24 relative.
            let moduli = lattice.moduli(law.law.as_ref()).expect("isotropic");
            let kappa = (coupling / (moduli.longitudinal * lattice.cell_area())).sqrt();
            assert!((angle / height - kappa).abs() <= kappa * (kappa * height).powi(2) / 20.0, "{kappa}");
        }
    }
}

/// The whole chain: a row relaxed in a lattice with sites has the κ of its chain, by the profile and its fit.
#[test]
#[cfg(feature = "fit")]
fn a_known_kappa_of_a_strip_is_found() {
    use jamscope::fit::profile::{Decision, ProfileFitSettings, fit_radial_profile};
    use jamscope::observe::RadialProfile;
    use jamscope::reference::{Annulus, RadialSolution, screened::Screened};

    let (lattice, law) = (Lattice::triangular(0.5, 0.05).expect("valid"), Hookean { stiffness: 1.0 });
    let periodic = lattice.periodic([6, 30]).expect("a lattice");
    let height = 0.5 * 3f64.sqrt() * lattice.spacing();
    let side = periodic.domain().lengths().expect("a box")[1];
    let bond = 0.75 - 0.25 * 0.05 / lattice.spacing();
    // κ R = 2.5 in a strip of 24 rows; from the first pole, π, on the packing with its sites is unstable.
    let angle: f64 = 2.5 / 24.0;
    let inflation = Inflation {
        increase: 1e-5,
        boundary: Boundary::HeldWalls { distance_over_side: 23.5 * height / side, length_over_side: 1.0 },
        centre: Centre::Label(181),
        on_site_coupling: Some(2.0 * bond * (2.0 - 2.0 * angle.cos())),
        ..Inflation::default()
    };
    let inflated = inflate_with(&inflation, &periodic, &law, &fire(1e-13), 1, &mut ()).expect("at rest");
    assert_eq!((inflated.shape, inflated.grown.len()), (Shape::Strip { length: 6.0 * lattice.spacing() }, 6));
    let field = DisplacementField::of_inflation(&inflated);
    assert_eq!(field.spreading_dimension(), 1);
    let profile = RadialProfile::of(&field, height);
    // The displacement vanishes on the first held row, 24.
    let annulus = Annulus::new(0.5, 24.0 * height).expect("an interval");
    let fit = fit_radial_profile::<1>(&profile, annulus, &ProfileFitSettings::default()).expect("a fit");
    assert_eq!(fit.decision, Decision::Screened);
    let kappa = fit.screened.expect("decided").wavenumber.value;
    // The chain is a sine exactly; the response is linear to d_0 times the stretch, 10⁻⁴, near a condition number of 10.
    assert!((kappa * height / angle - 1.0).abs() < 1e-3, "{} and {angle}", kappa * height);
    let medium = Screened::<1>::new(annulus, 1.0, angle / height).expect("no pole");
    let ratio = |ring: usize| profile.rings[ring].mean / medium.value(profile.rings[ring].radius);
    assert!((ratio(3) / ratio(15) - 1.0).abs() < 1e-3, "{} and {}", ratio(3), ratio(15));
}

/// Newton's third law: what the row and the two walls receive adds up to zero, and every mobile disk is balanced.
#[test]
fn forces_of_a_strip_are_balanced() {
    let packing = packing();
    for centre_held in [true, false] {
        let inflation = Inflation { centre_held, ..strip_of(0.38) };
        let inflated = inflate_with(&inflation, &packing, &hertzian(), &fire(1e-12), 1, &mut ()).expect("at rest");
        let network = ContactNetwork::new(inflated.after.packing.get(), &hertzian()).expect("apart");
        let mut on_held = [0.0; 2];
        let mut mean = 0.0;
        for contact in &network.contacts {
            let distance = norm(contact.separation);
            mean += contact.force / network.contacts.len() as f64;
            for (disk, sign) in [(contact.first, 1.0), (contact.second, -1.0)] {
                if inflated.after.packing.get().held()[disk as usize] {
                    for d in 0..2 {
                        on_held[d] += sign * contact.force * contact.separation[d] / distance;
                    }
                }
            }
        }
        // The residual of every mobile disk is 10⁻¹² of the mean force; there are 300 of them.
        assert!(norm(on_held) < 3e-10 * mean, "{on_held:?} of {mean}");
        assert_eq!(inflated.mobile_count, DisplacementField::of_inflation(&inflated).disks.len());
        // A row that grows compresses the packing between fixed walls.
        assert!(inflated.after.pressure > inflated.before.pressure);
    }
}

/// Deflated again at p = 1000, after a small inflation, the disks are where they were.
#[test]
fn a_deflated_row_has_its_radii_again() {
    let inflation = Inflation { increase: 1e-6, deflate: true, ..strip_of(0.38) };
    let inflated = inflate_with(&inflation, &packing(), &hertzian(), &fire(1e-12), 1, &mut ()).expect("at rest");
    let (before, deflated) =
        (inflated.before.packing.get(), inflated.deflated.as_ref().expect("deflated").packing.get());
    assert_eq!(before.radii(), deflated.radii());
    let field = DisplacementField::of_cycle(&inflated).expect("deflated");
    let most = field.counted().map(|disk| norm(disk.displacement)).fold(0.0, larger);
    assert!(most < 1e-9, "{most:e}");
}

/// The angle of a disk in a strip is its place along it, and distances are from the line.
#[test]
fn a_field_of_a_strip_is_measured_from_the_line() {
    let inflated = inflate_with(&strip_of(0.38), &packing(), &hertzian(), &fire(1e-12), 1, &mut ()).expect("at rest");
    let (field, before) = (DisplacementField::of_inflation(&inflated), inflated.before.packing.get());
    let length = before.domain().lengths().expect("a box")[0];
    for disk in &field.disks {
        let [x, y] = before.separation(disk.disk, inflated.centre);
        assert_eq!(disk.distance, y.abs());
        assert!((disk.radial - disk.displacement[1] * y.signum()).abs() < 1e-15);
        assert!((field.angle(disk) - 2.0 * PI * x / length).abs() < 1e-15);
        assert!(!before.held()[disk.disk] && !inflated.grown.contains(&disk.disk));
    }
    assert!(field.disks.iter().map(|disk| disk.radial).sum::<f64>() > 0.0, "away from the row on the whole");
    // A ring is the row of disks at one distance above the line.
    let ring = AngularProfile::within(&field, 0.5, 0.2);
    let near = |disk: &&Moved<2>| (disk.distance / field.outer_radius - 0.5).abs() <= 0.2;
    let above: Vec<&Moved<2>> = field.counted().filter(near).filter(|disk| disk.position[1] > 0.0).collect();
    assert!(above.len() > 20 && field.counted().filter(near).count() > above.len(), "{} above", above.len());
    let mut places: Vec<(f64, f64)> = above.iter().map(|disk| (field.angle(disk), disk.radial)).collect();
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert_eq!(ring.angles.iter().copied().zip(ring.radial.iter().copied()).collect::<Vec<_>>(), places);
}

/// From the same start FIRE of both programs ends in the same minimum at p ≥ 100: in all of the packings tried, four of inflations
/// and ten of other drives.
#[test]
fn final_states_of_other_drives_are_those_of_lammps() {
    let law = hertzian();
    let drives = ["line", "free", "push", "pair", "moved", "shear", "squeeze"];
    for name in drives.into_iter().flat_map(|drive| ["p100", "p1000"].map(|pressure| format!("{drive}_{pressure}"))) {
        let before = read_packing::<2>(fixture(&format!("lammps/drives_{name}.before.xyz"))).expect("a packing");
        let text = std::fs::read_to_string(fixture(&format!("lammps/drives_{name}.after.txt"))).expect("text");
        let theirs: Vec<[f64; 3]> = text
            .lines()
            .filter(|line| !line.starts_with('#'))
            .map(|line| {
                let numbers: Vec<f64> = line.split(' ').map(|word| word.parse().expect("a number")).collect();
                [numbers[0], numbers[1], numbers[2]]
            })
            .collect();
        let mut grown = before.clone();
        let mut row = Vec::new();
        for (disk, &[_, _, radius]) in theirs.iter().enumerate() {
            if radius != before.radii()[disk] {
                grown = grown.with_radius(disk, radius).expect("a radius");
                row.push(disk);
            }
        }
        // The row of the file is that of the strip through one of its disks, perhaps of several; the file does not say which.
        let rows = row.iter().filter(|&&disk| {
            let wall_distance = before.domain().lengths().map(|lengths| 0.4 * lengths[1]);
            let strip = wall_distance.map(|distance| Strip::cut(&before, disk, distance, true).expect("a strip"));
            strip.is_some_and(|strip| strip.row == row && strip.packing.held() == before.held())
        });
        assert_eq!(rows.count() > 0, name.starts_with("line"), "{name}");
        let grow = if name.starts_with("free") { 1 } else { 0 };
        assert!(name.starts_with("line") || row.len() == grow, "{name}: {} disks grow", row.len());
        let loaded = grown.loads().map_or(0, |loads| loads.iter().filter(|&&load| load != [0.0; 2]).count());
        assert_eq!(
            loaded,
            if name.starts_with("push") { 1 } else { 2 * usize::from(name.starts_with("pair")) },
            "{name}"
        );
        let after = fire(1e-13).relax(grown, &law, &mut ()).expect("apart").converged().expect("at rest").into_inner();
        let network = ContactNetwork::new(&after, &law).expect("apart");
        let (mut most, mut moved) = (0.0, 0.0);
        for disk in (0..after.len()).filter(|&disk| !after.held()[disk]) {
            // LAMMPS puts disks back into the box.
            let apart = |to: [f64; 2]| {
                let by: [f64; 2] = std::array::from_fn(|d| after.positions()[disk][d] - to[d]);
                let lengths = before.domain().lengths().unwrap_or([f64::INFINITY; 2]);
                norm(std::array::from_fn::<_, 2, _>(|d| {
                    if lengths[d].is_finite() { by[d] - (by[d] / lengths[d]).round() * lengths[d] } else { by[d] }
                }))
            };
            moved = larger(apart(before.positions()[disk]), moved);
            if network.backbone[disk] {
                most = larger(apart([theirs[disk][0], theirs[disk][1]]), most);
            }
        }
        println!("{name}: {most:.1e} apart, largest displacement {moved:.2}");
        // The net force of LAMMPS is below 1e-9; the softest modes have 1e-3 of a stiffness of 10⁴: 1e-10 each.
        assert!(most < 1e-7 * 0.05, "{name}: {most:e}");
        assert!(moved > 1e-3, "{name}: something moved");
    }
}

/// As d_0 → 0 the relaxed response is the linear one, of a held row, of a free row (whose disks push each other too), and of a
/// free disk in a circle. Its deviation is of second order in d_0, as long as no contact changes: it falls by ten with d_0.
#[test]
fn small_inflations_of_rows_and_free_disks_are_the_linear_response() {
    let (packing, law) = (packing(), hertzian());
    let rim = Boundary::HeldRim { outer_radius_over_side: 0.48 };
    let rows = [true, false].map(|centre_held| Inflation { centre_held, ..strip_of(0.38) });
    for inflation in [rows[0], rows[1], Inflation { centre_held: false, boundary: rim, ..Inflation::default() }] {
        let deviation = |increase: f64| {
            let inflation = Inflation { increase, ..inflation };
            let inflated = inflate_with(&inflation, &packing, &law, &fire(1e-13), 1, &mut ()).expect("at rest");
            let (before, after) = (inflated.before.packing.get(), inflated.after.packing.get());
            let response =
                LinearResponse::of_growth(before, &inflated.grown, &law, Prestress::Included).expect("a response");
            assert_eq!(response.growing, inflated.grown);
            let (mut most, mut largest) = (0.0, 0.0);
            for disk in (0..before.len()).filter(|&disk| response.solved[disk]) {
                let ((a, a_low), (b, b_low)) = (after.centre(disk), before.centre(disk));
                let by: [f64; 2] = std::array::from_fn(|d| ((a[d] - b[d]) + (a_low[d] - b_low[d])) / increase);
                largest = larger(norm(response.displacements[disk]), largest);
                most = larger(norm(difference(by, response.displacements[disk])), most);
            }
            let changes = PlasticPart::of(&inflated, &response);
            // The same by the plastic part, over the disks that count.
            assert!(changes.share < 10.0 * most / largest + 1e-12, "{} and {most}", changes.share);
            // Δp/d_0, from the changes of all contacts.
            let virial: f64 =
                response.contact_changes(before, &law).expect("apart").iter().map(|change| change.virial_change).sum();
            assert!(virial > 0.0, "{virial}");
            most / largest
        };
        let [coarse, fine] = [1e-6, 1e-7].map(deviation);
        // d_0 over the softest overlaps, some 10⁻³, times the amplification of the softest modes.
        assert!(coarse < 1e-2 && fine < 0.2 * coarse, "{inflation:?}: {coarse:e}, {fine:e}");
    }
}

#[test]
fn a_strip_is_of_the_plane() {
    let target = Target::Pressure(1000.0);
    let preparation = Preparation { disk_count: 200, target, ..Preparation::default() };
    let spheres = prepare_with::<3>(&preparation, &hertzian(), &fire(1e-8), &mut ()).expect("a packing");
    let run = inflate_with(&strip_of(0.3), spheres.packing.get(), &hertzian(), &fire(1e-8), 1, &mut ());
    assert!(matches!(run, Err(InflationError::StripNotInPlane)));
}

/// A held row of a lattice displaced by cos qx across the strip: the rows above tend to the wave in a strip as (qb)². The last
/// row that moves ends one row before the wall, where the displacement vanishes.
#[test]
fn a_modulated_row_of_a_lattice_tends_to_the_wave_in_a_strip() {
    let (lattice, law) = (Lattice::triangular(0.5, 0.05).expect("valid"), hertzian());
    let (height, moduli) = (0.5 * 3f64.sqrt() * lattice.spacing(), lattice.moduli(&law).expect("isotropic"));
    let poisson_ratio = 1.0 - 2.0 * moduli.shear / moduli.longitudinal;
    for reduced in [0.0, 1.0] {
        // One wave along the strip, qH about 2.7; all lengths double from one lattice to the next.
        let deviation = |columns: usize| {
            let rows = columns / 2;
            let periodic = lattice.periodic([columns, 2 * rows + 10]).expect("a lattice");
            let centre = columns * (rows + 5) + columns / 2;
            let strip = Strip::cut(&periodic, centre, (rows as f64 - 0.5) * height, true).expect("a strip");
            let (length, wall) = (strip.length(), rows as f64 * height);
            let q = 2.0 * PI / length;
            let along = |disk: usize| periodic.separation(disk, centre);
            let moved: Vec<_> = strip.row.iter().map(|&disk| (disk, [0.0, (q * along(disk)[0]).cos()])).collect();
            let coupling = lattice.coupling(&law, (reduced / wall).powi(2)).expect("isotropic");
            let law = OnSite { law, coupling };
            let law: &dyn PairLaw = if reduced > 0.0 { &law } else { &law.law };
            let response = LinearResponse::of_displacements(&strip.packing, &moved, law, Prestress::Included);
            let response = response.expect("a response");
            let interval = Annulus::new(1e-12, wall).expect("in order");
            let screening = coupling / (lattice.cell_area() * moduli.shear);
            let wave = StripAmplitudes { normal: 1.0, tangential: 0.0 };
            let mode = StripMode::new(interval, poisson_ratio, screening, q, wave).expect("no pole");
            let above =
                (0..periodic.len()).filter(|&disk| !strip.packing.held()[disk] && along(disk)[1] > 0.5 * height);
            let off = above.map(|disk| {
                let [x, y] = along(disk);
                norm(difference(response.displacements[disk], mode.displacement(x, y)))
            });
            off.fold(0.0, larger)
        };
        let [coarse, middle, fine] = [16, 32, 64].map(deviation);
        let order = (coarse / fine).log2() / 2.0;
        println!("κH = {reduced}: {coarse:.1e} {middle:.1e} {fine:.1e}, order {order:.2}");
        // The dispersion of a triangular lattice deviates by (qb)²/24 or less, over a distance of H.
        assert!(order > 1.8 && fine < (2.0 * PI / 64.0).powi(2), "{coarse:e} {middle:e} {fine:e}");
    }
}
