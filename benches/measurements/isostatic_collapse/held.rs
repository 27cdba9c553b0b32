//! What holding the disk that grows does: its neighbours push it, and what holds it pushes the medium back, as a point force does.

use std::error::Error;

use jamscope::displacement::{DisplacementField, Moved};
use jamscope::inflation::Circle;
use jamscope::law::Hertzian;
use jamscope::linear::LinearResponse;
use jamscope::linear::Prestress;
use jamscope::observe::State;
use jamscope::observe::bond_changes::BondChanges;
use jamscope::observe::fluctuations::Fluctuations;
use jamscope::packing::Packing;
use jamscope::reference::Annulus;
use jamscope::reference::angular_modes::AngularSolution;
use jamscope::reference::angular_modes::point_force::PointForce;
use jamscope::vector::{Vector, norm};
use rayon::prelude::*;

use crate::moduli;
use crate::sample::centres;

/// R over the side of the box, as in the study, for packings of up to so many disks.
const OUTER_RADII_OVER_SIDE: [(usize, f64); 3] = [(10_000, 0.480), (40_000, 0.486), (usize::MAX, 0.491)];

/// Rings in a radius.
const RINGS: usize = 10;

/// Highest angular mode that is looked at.
const HIGHEST: usize = 30;

/// One ring of a response, per d_0.
#[derive(Clone, Copy)]
struct Ring {
    /// h_∥².
    stretching: f64,
    /// Twice the mean of d_r along the point force.
    along: f64,
    /// Shares of modes 1 and 2 of d_r in the variance, and −G(π): the share of odd modes less that of even ones.
    dipole: f64,
    quadrupole: f64,
    anticorrelation: f64,
}

/// One circle, its centre held and free.
struct Around {
    /// The point force \[force / length\].
    force: f64,
    outer_radius: f64,
    held: Vec<Ring>,
    free: Vec<Ring>,
}

/// Share of a mode of d_r in the variance, and twice the mean of d_r cos(θ − angle).
fn modes(disks: &[&Moved<2>], angle: f64) -> ([f64; HIGHEST + 1], f64) {
    let count = disks.len() as f64;
    let mean = disks.iter().map(|disk| disk.radial).sum::<f64>() / count;
    let around = |disk: &Moved<2>| disk.position[1].atan2(disk.position[0]);
    let power = |mode: usize| {
        let (mut cosine, mut sine) = (0.0, 0.0);
        for disk in disks {
            let (s, c) = (mode as f64 * around(disk)).sin_cos();
            cosine += (disk.radial - mean) * c / count;
            sine += (disk.radial - mean) * s / count;
        }
        2.0 * (cosine * cosine + sine * sine)
    };
    let variance = disks.iter().map(|disk| (disk.radial - mean).powi(2)).sum::<f64>() / count;
    let along = disks.iter().map(|disk| 2.0 * (disk.radial - mean) * (around(disk) - angle).cos()).sum::<f64>() / count;
    (std::array::from_fn(|mode| if mode == 0 { 0.0 } else { power(mode) / variance }), along)
}

fn rings(
    packing: &Packing<2>,
    response: &LinearResponse<2>,
    outer_radius: f64,
    force: Vector<2>,
) -> Result<Vec<Ring>, Box<dyn Error>> {
    let width = outer_radius / RINGS as f64;
    let bonds = BondChanges::of_linear_response(&State::new(packing, &Hertzian::default())?, response, 1.0).bonds;
    let bonds = bonds.iter().map(|bond| (bond.distance, bond.parallel));
    let field = DisplacementField::of_linear_response(response, packing, 1.0, outer_radius);
    let ring = |number: usize| {
        let inside = |disk: &&Moved<2>| (disk.distance / width) as usize == number;
        let disks: Vec<&Moved<2>> = field.counted().filter(inside).collect();
        let (shares, along) = modes(&disks, force[1].atan2(force[0]));
        let signed = |(mode, share): (usize, &f64)| if mode % 2 == 1 { *share } else { -share };
        let anticorrelation = shares.iter().enumerate().map(signed).sum::<f64>() / shares.iter().sum::<f64>();
        (along, shares[1], shares[2], anticorrelation)
    };
    let stretching = Fluctuations::of(bonds, outer_radius, width).rings;
    let rings = stretching.iter().map(|of_bonds| {
        let (along, dipole, quadrupole, anticorrelation) = ring((of_bonds.radius / width) as usize);
        Ring { stretching: of_bonds.fluctuation.powi(2), along, dipole, quadrupole, anticorrelation }
    });
    Ok(rings.collect())
}

fn around(packing: &Packing<2>, centre: usize) -> Result<Around, Box<dyn Error>> {
    let law = Hertzian::default();
    let share = OUTER_RADII_OVER_SIDE.iter().find(|(most, _)| packing.len() < *most).map_or(0.5, |&(_, share)| share);
    let outer_radius = share * packing.domain().lengths().ok_or("no box")?[0];
    let circle = Circle::cut(packing, centre, outer_radius)?;
    let (held, centre) = (circle.packing, circle.centre);
    let rim = (0..held.len()).map(|disk| disk > centre).collect();
    let free = held.clone().with_held(rim)?;
    let respond = |packing: &Packing<2>| LinearResponse::of_inflation(packing, centre, &law, Prestress::Included);
    let (of_held, of_free) = (respond(&held)?, respond(&free)?);
    // What holds the disk pushes it against its neighbours.
    let force = of_held.force_change(&held, &law, centre)?.map(|push| -push);
    Ok(Around {
        force: norm(force),
        outer_radius,
        held: rings(&held, &of_held, outer_radius, force)?,
        free: rings(&free, &of_free, outer_radius, force)?,
    })
}

/// Means over centres, ring by ring.
pub fn print_held(pressure: f64, packings: &[Packing<2>], count: usize) -> Result<(), Box<dyn Error>> {
    let law = Hertzian::default();
    let mut all = Vec::new();
    for packing in packings {
        let centres = centres(&State::new(packing, &law)?, count);
        let found = centres.par_iter().map(|&centre| around(packing, centre).map_err(|error| error.to_string()));
        all.extend(found.collect::<Result<Vec<_>, String>>()?);
    }
    let (bulk, shear) = moduli(packings)?;
    let mean = |of: &dyn Fn(&Around) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
    let (force, outer_radius) = (mean(&|one| one.force), mean(&|one| one.outer_radius));
    // In two dimensions ν = (K − G)/(K + G).
    let poisson_ratio = (bulk - shear) / (bulk + shear);
    let medium = PointForce::new(Annulus::new(0.5, outer_radius)?, poisson_ratio, force / shear)?;
    println!(
        "p = {pressure}: R = {outer_radius:.1}, K = {bulk:.0}, G = {shear:.0}, ⟨F⟩ = {force:.0} = {:.2} G, {} centres",
        force / shear,
        all.len()
    );
    println!("{:16}centre held{:43}centre free", "", "");
    let names = ["h_∥ r", "along F", "exact", "mode 1", "mode 2", "G*", "h_∥ r", "along F", "mode 1", "mode 2", "G*"];
    print!("{:>6}", "r");
    names.iter().for_each(|name| print!(" {name:>8}"));
    println!();
    for ring in 0..RINGS {
        let radius = outer_radius * (ring as f64 + 0.5) / RINGS as f64;
        let exact = medium.at(radius).value.radial.re;
        let of = |free: bool, value: fn(&Ring) -> f64| {
            mean(&|one| if free { &one.free } else { &one.held }.get(ring).map_or(f64::NAN, value))
        };
        let row = |free: bool| {
            let root = of(free, |ring| ring.stretching).sqrt() * radius;
            let shares = [of(free, |ring| ring.dipole), of(free, |ring| ring.quadrupole)];
            (root, of(free, |ring| ring.along), shares, of(free, |ring| ring.anticorrelation))
        };
        let ((held, held_along, [h1, h2], held_g), (free, free_along, [f1, f2], free_g)) = (row(false), row(true));
        print!("{radius:6.1}");
        [held, held_along, exact, h1, h2, held_g, free, free_along, f1, f2, free_g]
            .iter()
            .for_each(|value| print!(" {value:8.4}"));
        println!();
    }
    Ok(())
}
