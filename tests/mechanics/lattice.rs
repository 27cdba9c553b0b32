//! Lattices: their exact moduli against strain energies and waves, and the whole chain (linear algebra, relaxers, profile,
//! fit) against the continuum they tend to.

#[cfg(feature = "fit")]
mod body_centred;
#[cfg(feature = "fit")]
mod fits;

use std::f64::consts::PI;

use jamscope::displacement::DisplacementField;
use jamscope::forces::Assembly;
use jamscope::inflation::Circle;
use jamscope::lattice::{Lattice, LatticeError};
use jamscope::law::{Hookean, OnSite, PairLaw, PowerLaw};
use jamscope::linear::LinearResponse;
use jamscope::linear::{Hessian, Members, Prestress};
use jamscope::network::ContactNetwork;
use jamscope::observe::RadialProfile;
use jamscope::packing::Packing;
use jamscope::reference::angular_modes::AngularSolution;
use jamscope::reference::angular_modes::point_force::PointForce;
use jamscope::reference::antiscreened::Antiscreened;
use jamscope::reference::{Annulus, RadialSolution};
use jamscope::relax::{Fire, ForceLimit, Relaxer, Stop};
use jamscope::vector::{difference, dot, larger, norm, scaled, sum};

use crate::scenes::laws::{hertzian, hookean};

fn triangular(overlap: f64) -> Lattice {
    Lattice::triangular(0.5, overlap).expect("neighbours touch, second ones do not")
}

fn response(circle: &Circle<2>, law: &dyn PairLaw) -> LinearResponse<2> {
    LinearResponse::of_inflation(&circle.packing, circle.centre, law, Prestress::Included).expect("a response")
}

fn field(circle: &Circle<2>, response: &LinearResponse<2>, increase: f64, outer_radius: f64) -> DisplacementField<2> {
    DisplacementField::of_linear_response(response, &circle.packing, increase, outer_radius)
}

/// Energy and virial pressure of a periodic lattice, per disk and per area.
fn energy_and_pressure(lattice: &Lattice, law: &dyn PairLaw) -> (f64, f64) {
    let packing = lattice.periodic([8, 5]).expect("a lattice");
    let network = ContactNetwork::new(&packing, law).expect("apart");
    let volume = packing.domain().volume().expect("a box");
    // Six halves a disk, no forces but those of the rounding of coordinates below 8: 2e-15 of a stiffness in each of six.
    assert_eq!(network.contacts.len(), 3 * packing.len());
    let (stiffness, force) = (law.stiffness(network.contacts[0].force, lattice.overlap()), network.contacts[0].force);
    assert!(network.largest_net_force() <= 1e-14 * (stiffness + force), "{:e}", network.largest_net_force());
    assert!((volume / packing.len() as f64 / lattice.cell_area() - 1.0).abs() < 1e-14);
    (network.energy() / packing.len() as f64, network.pressure(volume))
}

#[test]
fn pressure_and_bulk_modulus_are_derivatives_of_the_energy_under_uniform_strain() {
    fn check(law: &dyn PairLaw) {
        for overlap in [0.02, 0.1] {
            let (lattice, h) = (triangular(overlap), 1e-5 * overlap);
            let moduli = lattice.moduli(law).expect("isotropic");
            let (more, less) = (triangular(overlap + h), triangular(overlap - h));
            let ((energy_more, pressure_more), (energy_less, pressure_less)) =
                (energy_and_pressure(&more, law), energy_and_pressure(&less, law));
            let (_, pressure) = energy_and_pressure(&lattice, law);
            let area = more.cell_area() - less.cell_area();
            assert!((pressure / moduli.pressure - 1.0).abs() < 1e-12, "{law:?}");
            // Central differences: truncation (h/δ)² = 1e-10, rounding of δ (1e-16/δ over h/δ = 1e-5: 1e-9 at δ = 0.02).
            assert!((-(energy_more - energy_less) / area / pressure - 1.0).abs() < 3e-9, "{law:?}, energy");
            let bulk = -lattice.cell_area() * (pressure_more - pressure_less) / area;
            assert!((bulk / moduli.bulk - 1.0).abs() < 3e-9, "{law:?}, bulk {bulk} and {}", moduli.bulk);
            assert!(((moduli.longitudinal - moduli.shear) / moduli.bulk - 1.0).abs() < 1e-14, "λ+2μ − μ = λ+μ");
        }
    }
    check(&Hookean { stiffness: 3.0 });
    check(&hertzian());
    check(&PowerLaw { energy_scale: 1.0, exponent: 3.0 });
}

/// ω² of a standing wave along x in a periodic lattice, polarised along an axis, over k² A: Kᵤ/u of the Hessian itself.
fn stiffness_of_a_wave(lattice: &Lattice, law: &dyn PairLaw, columns: usize, along_x: bool, axis: usize) -> f64 {
    let cells = if along_x { [columns, 3] } else { [4, columns] };
    let packing = lattice.periodic(cells).expect("a lattice");
    let lengths = packing.domain().lengths().expect("a box");
    let (direction, length) = if along_x { (0, lengths[0]) } else { (1, lengths[1]) };
    let wavenumber = 2.0 * PI / length;
    let hessian = Hessian::new(&packing, law, Members::InContact, Prestress::Included).expect("apart");
    let wave: Vec<[f64; 2]> = packing
        .positions()
        .iter()
        .map(|position| {
            let mut u = [0.0; 2];
            u[axis] = (wavenumber * position[direction]).cos();
            u
        })
        .collect();
    let u = hessian.gather(&wave);
    let mut force = vec![f64::NAN; u.len()];
    hessian.matrix().multiply(&u, &mut force);
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    product(&u, &force) / product(&u, &u) / (wavenumber * wavenumber * lattice.cell_area())
}

#[test]
fn long_waves_have_the_moduli_with_an_error_of_second_order_in_the_wavenumber() {
    fn check(law: &dyn PairLaw, overlap: f64) {
        let lattice = triangular(overlap);
        let moduli = lattice.moduli(law).expect("isotropic");
        for (along_x, axis) in [(true, 0), (true, 1), (false, 0), (false, 1)] {
            let exact = if along_x == (axis == 0) { moduli.longitudinal } else { moduli.shear };
            let off = |columns: usize| stiffness_of_a_wave(&lattice, law, columns, along_x, axis) / exact - 1.0;
            let (coarse, fine) = (off(64), off(128));
            let order = (coarse / fine).log2();
            // 1 − c (kb)² + O((kb)⁴): (kb)² = 0.01, of which the ratio of the next term to this one is about a tenth.
            assert!((order - 2.0).abs() < 0.01, "{law:?} {along_x} {axis}: {coarse:e}, {fine:e}");
            let (kb, best) = (2.0 * PI / 128.0, (4.0 * fine - coarse) / 3.0);
            assert!(fine.abs() < kb * kb && best.abs() < kb.powi(4), "{best:e}");
        }
    }
    check(&Hookean { stiffness: 1.0 }, 1e-3);
    check(&Hookean { stiffness: 1.0 }, 0.1);
    check(&hertzian(), 0.05);
    check(&PowerLaw { energy_scale: 2.0, exponent: 2.3 }, 0.05);
}

#[test]
fn the_circle_has_every_site_once_and_each_mobile_disk_its_six_neighbours() {
    for (lattice, neighbours) in [(triangular(0.05), 6), (Lattice::square(0.5, 0.05).expect("valid"), 4)] {
        let circle = lattice.circle(9.3).expect("a circle");
        let packing = &circle.packing;
        let network = ContactNetwork::new(packing, &hookean()).expect("apart");
        let mut degree = vec![0; packing.len()];
        for contact in &network.contacts {
            degree[contact.first as usize] += 1;
            degree[contact.second as usize] += 1;
            assert!((contact.overlap / 0.05 - 1.0).abs() < 1e-13);
        }
        for disk in 0..packing.len() {
            let distance = norm(sum(packing.centre(disk).0, packing.centre(disk).1));
            assert_eq!(packing.held()[disk], disk >= circle.centre);
            assert_eq!(disk > circle.centre, distance >= 9.3);
            assert!(disk > circle.centre || degree[disk] == neighbours, "disk {disk} at {distance}");
        }
        assert_eq!(packing.centre(circle.centre), ([0.0; 2], [0.0; 2]));
        // Sites inside by counting: i a + j b with integers.
        let inside = (-40i32..=40)
            .flat_map(|i| (-40i32..=40).map(move |j| (f64::from(i), f64::from(j))))
            .filter(|(i, j)| {
                let square = if neighbours == 6 { i * i + i * j + j * j } else { i * i + j * j };
                square.sqrt() * lattice.spacing() < 9.3
            })
            .count();
        assert_eq!(circle.mobile_count() + 1, inside);
        // Positions are sums of two numbers, good to 1e-32, and forces of one contact cancel another's.
        let force = network.contacts[0].force;
        let stiffness = Hookean::default().stiffness;
        assert!(network.largest_net_force() <= 16.0 * f64::EPSILON * (force + stiffness * 0.05));
    }
}

#[test]
fn what_is_no_lattice_is_refused() {
    let largest = 1.0 - 1.0 / 3f64.sqrt();
    assert_eq!(Lattice::triangular(-1.0, 0.1), Err(LatticeError::RadiusNotPositive { radius: -1.0 }));
    for overlap in [0.0, -0.1, 0.43, f64::NAN] {
        let error = Lattice::triangular(0.5, overlap).expect_err("no lattice");
        let LatticeError::OverlapOutOfRange { largest: most, .. } = error else { panic!("{error}") };
        assert!((most - largest).abs() < 1e-15);
    }
    let error = triangular(0.1).circle(0.5).expect_err("no mobile site");
    assert_eq!(error, LatticeError::OuterRadiusTooSmall { outer_radius: 0.5, spacing: 0.9 });
    assert!(triangular(0.1).periodic([0, 3]).is_err());
    let square = Lattice::square(0.5, 0.1).expect("valid");
    assert!(square.moduli(&hookean()).is_none() && square.growth_amplitude(&hookean()).is_none());
    assert!(square.effective_radius(&square.circle(5.0).expect("a circle")).is_none());
}

/// Slope of ln y against ln x by least squares.
fn slope(points: &[(f64, f64)]) -> f64 {
    let count = points.len() as f64;
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let (mx, my) = (logs.iter().map(|p| p.0).sum::<f64>() / count, logs.iter().map(|p| p.1).sum::<f64>() / count);
    let (xy, xx) = logs.iter().fold((0.0, 0.0), |(xy, xx), p| (xy + (p.0 - mx) * (p.1 - my), xx + (p.0 - mx).powi(2)));
    xy / xx
}

/// Largest deviation of the ring means from B (1/r − r/R²) for 0.3 R < r < 0.8 R, over B/R.
fn deviation(profile: &RadialProfile, amplitude: f64, outer_radius: f64) -> f64 {
    let inside = profile.rings.iter().filter(|ring| (0.3..0.8).contains(&(ring.radius / outer_radius)));
    let off = |radius: f64, mean: f64| mean - amplitude * (1.0 / radius - radius / outer_radius.powi(2));
    inside.map(|ring| off(ring.radius, ring.mean).abs()).fold(0.0, larger) * outer_radius / amplitude
}

#[test]
fn the_elastic_profile_is_met_to_first_order_with_the_nominal_rim_and_to_second_with_the_effective_one() {
    fn check(law: &dyn PairLaw, overlap: f64) {
        let lattice = triangular(overlap);
        let amplitude = lattice.growth_amplitude(law).expect("isotropic");
        let (mut nominal, mut effective) = (Vec::new(), Vec::new());
        for ratio in [20.0, 28.7, 40.0, 57.1, 80.0, 113.0, 160.0] {
            let circle = lattice.circle(0.5 * ratio).expect("a circle");
            let response = response(&circle, law);
            assert_eq!(response.negative_eigenvalue_count, 0);
            let profile = RadialProfile::of(&field(&circle, &response, 1.0, 0.5 * ratio), 1.0);
            nominal.push((ratio, deviation(&profile, amplitude, 0.5 * ratio)));
            effective
                .push((ratio, deviation(&profile, amplitude, lattice.effective_radius(&circle).expect("triangular"))));
        }
        let (first, second) = (-slope(&nominal), -slope(&effective));
        println!("{law:?} δ = {overlap}: orders {first:.3}, {second:.3}; {nominal:?} {effective:?}");
        assert!((first - 1.0).abs() < 0.25, "order {first} with the nominal rim: {nominal:?}");
        assert!(second > 1.6, "order {second} with the effective rim: {effective:?}");
        let last = (nominal[nominal.len() - 1].1, effective[effective.len() - 1].1);
        // What is left at R = 80: the curvature of 1/r over a ring, (w/r)²/12 of it at r = 0.3 R, 5e-4 of B/R.
        assert!(last.1 < 1e-3 && last.0 > 10.0 * last.1, "{last:?}");
    }
    check(&Hookean { stiffness: 1.0 }, 1e-6);
    check(&Hookean { stiffness: 1.0 }, 0.05);
    check(&hertzian(), 0.05);
}

/// The amplitude has no parameter at all: far from the disk u = B d_0 (1/r − r/R²) with B from the law and the spacing.
#[test]
fn the_amplitude_of_the_response_is_that_of_the_force_dipole() {
    fn check(law: &dyn PairLaw, overlap: f64) {
        let lattice = triangular(overlap);
        let exact = lattice.growth_amplitude(law).expect("isotropic");
        for outer_radius in [40.0, 80.0] {
            let circle = lattice.circle(outer_radius).expect("a circle");
            let field = field(&circle, &response(&circle, law), 1.0, outer_radius);
            // Least squares in u = B/r − C r, with no knowledge of R.
            let mut sums = [0.0; 5];
            for moved in field.disks.iter().filter(|m| (0.3..0.8).contains(&(m.distance / outer_radius))) {
                let (x, y, u) = (1.0 / moved.distance, -moved.distance, moved.radial);
                [x * x, x * y, y * y, x * u, y * u].iter().zip(&mut sums).for_each(|(term, sum)| *sum += term);
            }
            let [xx, xy, yy, xu, yu] = sums;
            let determinant = xx * yy - xy * xy;
            let (amplitude, slope) = ((xu * yy - yu * xy) / determinant, (xx * yu - xy * xu) / determinant);
            let off = amplitude / exact - 1.0;
            // Corrections of the lattice to 1/r fall as (b/r)², at r = 0.3 R: 0.007 and 0.0017, with small coefficients and
            // mostly of the angular order six, which the sum over angles takes out.
            println!("{law:?} δ = {overlap}, R = {outer_radius}: B off by {off:e}");
            assert!(off.abs() < 0.1 * (lattice.spacing() / (0.3 * outer_radius)).powi(2), "B off by {off:e}");
            // And where it vanishes is what the effective radius says, as far as it claims to.
            let vanishes = (amplitude / slope).sqrt() - lattice.effective_radius(&circle).expect("triangular");
            println!("    vanishes {:.4} b beyond the effective radius", vanishes / lattice.spacing());
            assert!(vanishes.abs() < 0.006 * lattice.spacing(), "{vanishes}");
        }
    }
    for overlap in [1e-6, 0.02, 0.05] {
        check(&Hookean { stiffness: 1.0 }, overlap);
        check(&hertzian(), overlap);
    }
    check(&PowerLaw { energy_scale: 1.0, exponent: 3.0 }, 0.05);
}

#[test]
fn a_pushed_disk_moves_a_lattice_and_stretches_its_bonds_as_a_point_force_does() {
    let (lattice, law, outer_radius) = (triangular(0.05), hertzian(), 60.0);
    let circle = lattice.circle(outer_radius).expect("a circle");
    let rim = (0..circle.packing.len()).map(|disk| disk > circle.centre).collect();
    let packing = circle.packing.clone().with_held(rim).expect("one a disk");
    let moduli = lattice.moduli(&law).expect("isotropic");
    let angle = 0.4_f64;
    let mut forces = vec![[0.0; 2]; packing.len()];
    forces[circle.centre] = [0.01 * moduli.shear * angle.cos(), 0.01 * moduli.shear * angle.sin()];
    let response = LinearResponse::of_forces(&packing, &forces, &law, Prestress::Included).expect("a response");
    // λ+2μ and μ of the equation of motion are per area: ν from their ratio ε = (1−ν)/2.
    let poisson_ratio = 1.0 - 2.0 * moduli.shear / moduli.longitudinal;
    let annulus = Annulus::new(0.5, lattice.effective_radius(&circle).expect("triangular")).expect("in order");
    let medium = PointForce::new(annulus, poisson_ratio, 0.01).expect("finite");
    let mut worst = 0.0f64;
    for disk in 0..circle.centre {
        let [x, y] = packing.positions()[disk];
        let (radius, around) = (x.hypot(y), y.atan2(x));
        if !(15.0..50.0).contains(&radius) {
            continue;
        }
        let [along, across] = medium.displacement(radius, around - angle);
        let (sine, cosine) = around.sin_cos();
        let expected = [along * cosine - across * sine, along * sine + across * cosine];
        worst = larger(worst, norm(difference(response.displacements[disk], expected)));
    }
    let scale = medium.at(15.0).value.radial.norm();
    // Corrections of the lattice of (b/r)², r ≥ 15, of c k; where the rim is to some thousandths of b.
    println!("a push: off by {:e}", worst / scale);
    assert!(worst < (lattice.spacing() / 15.0).powi(2) * scale, "{worst:e} of {scale:e}");

    // Three bonds a site average (n·ε·n)² over directions exactly: a tensor of fourth rank with sixfold symmetry is isotropic.
    let network = ContactNetwork::new(&packing, &law).expect("apart");
    let (mut count, mut square) = (0.0, 0.0);
    for contact in &network.contacts {
        let (i, j) = (contact.first as usize, contact.second as usize);
        let distance = norm(difference(packing.positions()[i], scaled(0.5, contact.separation)));
        if !(15.0..50.0).contains(&distance) {
            continue;
        }
        let apart = difference(response.displacements[i], response.displacements[j]);
        let stretched = dot(apart, contact.separation) / norm(contact.separation);
        count += 1.0;
        square += (stretched / (lattice.spacing() * medium.stretch_fluctuation(distance))).powi(2);
    }
    let off = (square / count).sqrt() - 1.0;
    println!("its bonds, {count}: h_∥ off by {off:e}");
    // Corrections of the lattice as before, and those of where its edge is cut: a row of 94 around an area of 7150.
    assert!(count > 20_000.0 && off.abs() < (lattice.spacing() / 15.0).powi(2), "{off}");
}

#[test]
fn tied_disks_answer_as_the_antiscreened_medium() {
    let (lattice, law, outer_radius) = (triangular(0.05), hertzian(), 60.0);
    let circle = lattice.circle(outer_radius).expect("a circle");
    let effective = lattice.effective_radius(&circle).expect("triangular");
    let amplitude = lattice.growth_amplitude(&law).expect("isotropic");
    for reduced in [1.0, 3.0, 8.0] {
        let wavenumber: f64 = reduced / effective;
        let coupling = lattice.coupling(&law, -wavenumber * wavenumber).expect("isotropic");
        assert!(coupling < 0.0);
        let response = response(&circle, &OnSite { law, coupling });
        assert_eq!(response.negative_eigenvalue_count, 0);
        let profile = RadialProfile::of(&field(&circle, &response, 1.0, effective), 0.25);
        // Near the centre the response is B d_0 κ K_1(κr) and what the rim adds: B d_0/a at a ≪ R, 1/κ, to (κa)² ln κa.
        let inner_radius = 1e-9;
        let annulus = Annulus::new(inner_radius, effective).expect("radii in order");
        let medium = Antiscreened::<2>::new(annulus, amplitude / inner_radius, wavenumber).expect("valid");
        let mut worst = 0.0f64;
        for ring in profile.rings.iter().filter(|ring| (20.0..50.0).contains(&ring.radius)) {
            worst = larger(worst, (ring.mean - medium.value(ring.radius)).abs() / (amplitude / ring.radius));
        }
        println!("κR = {reduced}i: {worst:e}");
        // Corrections of the lattice of (b/r)², r ≥ 20, of which rings of a dozen sites do not average all out.
        assert!(worst < (lattice.spacing() / 20.0).powi(2), "κR = {reduced}i: {worst:e}");
    }
}

#[test]
fn relaxers_find_the_screened_state_where_it_is_a_minimum_and_say_where_it_is_none() {
    let (lattice, law, outer_radius) = (triangular(0.05), hertzian(), 20.0);
    let circle = lattice.circle(outer_radius).expect("a circle");
    let rim = lattice.effective_radius(&circle).expect("triangular");
    let increase = (-20f64).exp2();
    let fire = Fire { limit: ForceLimit::Relative(1e-12), step_limit: 100_000, ..Fire::default() };
    let grown = || -> Packing<2> {
        circle.packing.clone().with_sites_here().with_radius(circle.centre, 0.5 + increase).expect("positive")
    };
    // The same with its disks off their sites by up to 1e-6, in no order: of long waves that is a fortieth.
    let shaken = || {
        let mobile = |disk: usize| if disk < circle.centre { 1e-6 } else { 0.0 };
        let off = |disk: usize| [(3.1 * disk as f64).sin(), (1.7 * disk as f64).cos()].map(|x| mobile(disk) * x);
        let sum = |disk: usize| {
            let low = circle.packing.corrections()[disk];
            [off(disk)[0] + low[0], off(disk)[1] + low[1]]
        };
        grown().with_corrections((0..circle.packing.len()).map(sum).collect()).expect("finite")
    };
    // Waves across their direction are softer (μ < λ+2μ): three modes, a shift along two axes and a turn, are unstable
    // well below the first pole, and the radial field itself between the first two.
    for (reduced, negative) in [(1.5, 0), (2.5, 3), (5.0, 19)] {
        let coupling = lattice.coupling(&law, (reduced / rim).powi(2)).expect("isotropic");
        let law = OnSite { law, coupling };
        let response = response(&circle, &law);
        assert_eq!(response.negative_eigenvalue_count, negative, "κR = {reduced}");
        let stop = |packing: Packing<2>| fire.relax(packing, &law, &mut ()).expect("apart").stop;
        if negative > 0 {
            assert_eq!(stop(shaken()), Stop::NoMinimum, "κR = {reduced}");
        }
        if negative > 3 {
            assert_eq!(stop(grown()), Stop::NoMinimum, "κR = {reduced}");
            continue;
        }
        // A growing disk pushes nothing into the three modes: where they alone are unstable it leads to the saddle.
        let outcome = fire.relax(grown(), &law, &mut ()).expect("apart");
        let relaxed = outcome.converged().expect("at rest").into_inner();
        let largest = worst(&circle.packing, &relaxed, |_| [0.0; 2]);
        let off = worst(&circle.packing, &relaxed, |disk| response.displacements[disk].map(|u| increase * u));
        println!("κR = {reduced}: moved {largest:e}, off by {off:e}");
        // Nonlinear by about d_0/δ = 2e-5; the limit on the force, 1e-12 of F, over F' and a softness of (R/b)²/10: 1e-12.
        assert!(off < 1e-4 * largest, "{off:e} of {largest:e}");
    }
}

fn worst(before: &Packing<2>, after: &Packing<2>, expected: impl Fn(usize) -> [f64; 2]) -> f64 {
    (0..before.len())
        .map(|disk| {
            let ((a, a_low), (b, b_low)) = (after.centre(disk), before.centre(disk));
            let u = expected(disk);
            norm::<2>(std::array::from_fn(|d| (a[d] - b[d]) + (a_low[d] - b_low[d]) - u[d]))
        })
        .fold(0.0, larger)
}

#[test]
fn a_square_lattice_is_unstable_and_a_triangular_one_is_not() {
    let law = Hookean { stiffness: 1.0 };
    let square = Lattice::square(0.5, 0.05).expect("valid").circle(8.0).expect("a circle");
    let count = response(&square, &law).negative_eigenvalue_count;
    assert!(count > 10, "{count}");
    // Without prestress it has only waves that cost nothing or something; the rim holds them.
    let unstressed = LinearResponse::of_inflation(&square.packing, square.centre, &law, Prestress::LeftOut);
    assert_eq!(unstressed.expect("a response").negative_eigenvalue_count, 0);
    assert_eq!(response(&triangular(0.05).circle(8.0).expect("a circle"), &law).negative_eigenvalue_count, 0);
    // Pushed a little, FIRE leaves it for another state.
    let fire = Fire { limit: ForceLimit::Relative(1e-8), step_limit: 100_000, ..Fire::default() };
    let shaken: Vec<[f64; 2]> = (0..square.packing.len())
        .map(|disk| if square.packing.held()[disk] { [0.0; 2] } else { [(disk as f64).sin(), (disk as f64).cos()] })
        .map(|u| u.map(|x| 1e-6 * x))
        .collect();
    let outcome =
        fire.relax(square.packing.clone().with_corrections(shaken).expect("valid"), &law, &mut ()).expect("apart");
    let before = Assembly::new(&square.packing, &law).expect("apart").evaluate_totals().energy;
    let after = Assembly::new(&outcome.state, &law).expect("apart").evaluate_totals().energy;
    assert!(after < 0.99 * before, "{after} of {before}");
}
