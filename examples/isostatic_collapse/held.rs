//! What holding the disk that grows does to the bonds around it, beside what a point force does.

use std::error::Error;

use jamscope::contact::{Hertzian, Prestress};
use jamscope::inflation::Circle;
use jamscope::linear::LinearResponse;
use jamscope::observe::State;
use jamscope::observe::bond_changes::BondChanges;
use jamscope::packing::Packing;
use jamscope::reference::Annulus;
use jamscope::reference::angular_modes::AngularSolution;
use jamscope::reference::angular_modes::point_force::PointForce;
use jamscope::vector::dot;
use rayon::prelude::*;

use crate::moduli;
use crate::sample::{centres, in_rings, radius_of};

/// R over the side of the box: that of the study for 22184 disks.
const OUTER_RADIUS_OVER_SIDE: f64 = 0.486;

/// Rings between two that are printed.
const EVERY: usize = 4;

/// One circle, its centre held and free.
struct Around {
    /// The force that holds it \[force / length\].
    force: f64,
    /// R, ⟨s²⟩ of its bonds.
    outer_radius: f64,
    square_length: f64,
    /// h_∥ r² over d_0 in rings.
    held: Vec<Option<f64>>,
    free: Vec<Option<f64>>,
}

fn around(packing: &Packing<2>, centre: usize) -> Result<Around, Box<dyn Error>> {
    let law = Hertzian::default();
    let outer_radius = OUTER_RADIUS_OVER_SIDE * packing.domain().lengths().ok_or("no box")?[0];
    let circle = Circle::cut(packing, centre, outer_radius)?;
    let (held, centre) = (circle.packing, circle.centre);
    let rim = (0..held.len()).map(|disk| disk > centre).collect();
    let free = held.clone().with_held(rim)?;
    let respond = |packing: &Packing<2>| LinearResponse::of_inflation(packing, centre, &law, Prestress::Included);
    let (of_held, of_free) = (respond(&held)?, respond(&free)?);
    let push = of_held.force_change(&held, &law, centre)?;
    let rings = |packing: &Packing<2>,
                 response: &LinearResponse<2>|
     -> Result<(Vec<Option<f64>>, f64), Box<dyn Error>> {
        let bonds = BondChanges::of_linear_response(&State::new(packing, &law)?, response, 1.0).bonds;
        let square = bonds.iter().map(|bond| dot(bond.separation, bond.separation)).sum::<f64>() / bonds.len() as f64;
        let values = bonds.iter().map(|bond| (bond.distance, bond.parallel * bond.distance.powi(2)));
        Ok((in_rings(values, outer_radius), square))
    };
    let (held, square_length) = rings(&held, &of_held)?;
    Ok(Around { force: dot(push, push).sqrt(), outer_radius, square_length, held, free: rings(&free, &of_free)?.0 })
}

/// h_∥ r over d_0 with the centre held and free, and the root of the difference of the squares beside that of a point force.
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
    let force = mean(&|one| one.force.powi(2)).sqrt();
    let (outer_radius, length) = (mean(&|one| one.outer_radius), mean(&|one| one.square_length).sqrt());
    // In two dimensions ν = (K − G)/(K + G).
    let poisson_ratio = (bulk - shear) / (bulk + shear);
    let medium = PointForce::new(Annulus::new(0.5, outer_radius)?, poisson_ratio, force / shear)?;
    println!(
        "p = {pressure}: R = {outer_radius:.1}, K = {bulk:.0}, G = {shear:.0}, F = {force:.0} = {:.2} G, {} centres; h_∥ r/d_0",
        force / shear,
        all.len()
    );
    println!("{:>8} {:>8} {:>8} {:>8} {:>8}", "r", "held", "free", "force", "exact");
    for ring in (0..all[0].held.len()).step_by(EVERY) {
        let radius = radius_of(ring);
        let root = |of: &dyn Fn(&Around) -> Option<f64>| {
            let squares: Vec<f64> = all.iter().filter_map(|one| Some(of(one)?.powi(2))).collect();
            (squares.iter().sum::<f64>() / squares.len() as f64).sqrt() / radius
        };
        let held = root(&|one| *one.held.get(ring)?);
        let free = root(&|one| *one.free.get(ring)?);
        let exact = length * radius * medium.stretch_fluctuation(radius);
        println!("{radius:8.1} {held:8.4} {free:8.4} {:8.4} {exact:8.4}", (held * held - free * free).max(0.0).sqrt());
    }
    Ok(())
}
