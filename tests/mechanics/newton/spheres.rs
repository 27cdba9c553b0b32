//! Packings of spheres so large that Newton's method solves its systems by conjugate gradients.

use jamscope::linear::iterative::is_faster;
use jamscope::packing::{Domain, Packing};
use jamscope::vector::{Vector, difference, larger, norm, scaled, sum};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::newton;
use crate::scenes::laws::hertzian;
use crate::scenes::rest::relax;

/// Edge of a cube of the lattice: first neighbours overlap by 0.19, second ones by 0.07.
const EDGE: f64 = 0.93;

/// Sites of a periodic body-centred cubic lattice.
fn sites(cells: usize) -> Vec<Vector<3>> {
    let place = |site: usize, d: usize| (site / 2 / cells.pow(d as u32) % cells) as f64 + 0.5 * (site % 2) as f64;
    (0..2 * cells.pow(3)).map(|site| std::array::from_fn(|d| EDGE * place(site, d))).collect()
}

#[test]
fn newton_brings_thousands_of_spheres_back_to_their_lattice() {
    let cells = 15;
    let sites = sites(cells);
    assert!(is_faster::<3>(sites.len()), "conjugate gradients");
    let mut generator = Pcg64::seed_from_u64(4);
    let off = |site: &Vector<3>| site.map(|x| x + 0.01 * (generator.random::<f64>() - 0.5));
    let positions: Vec<Vector<3>> = sites.iter().map(off).collect();
    let domain = Domain::rectangular([0.0; 3], [EDGE * cells as f64; 3]);
    let start = Packing::new(domain, positions, vec![0.5; sites.len()]).expect("separate spheres");
    let outcome = relax(&newton(1e-12), start.clone(), &hertzian());
    // Quadratic convergence: from a hundredth of an overlap 10⁻², 10⁻⁴, 10⁻⁸, 10⁻¹⁶.
    assert!((2..=6).contains(&outcome.cost.factorisation_count), "{}", outcome.cost.factorisation_count);
    let end = outcome.converged().expect("at rest").into_inner();
    // The centre of mass stays where it was at the start.
    let total = |packing: &Packing<3>| {
        let moved = packing.positions().iter().zip(&sites).map(|(&x, &site)| difference(x, site));
        scaled(1.0 / sites.len() as f64, moved.fold([0.0; 3], sum))
    };
    let shift = total(&start);
    let worst = (0..sites.len()).fold(0.0, |worst, sphere| {
        let (centre, correction) = end.centre(sphere);
        let at = difference(sum(centre, correction), sum(sites[sphere], shift));
        larger(norm(at), worst)
    });
    // Forces of 10⁻¹² of a contact force, F' δ, over the softest stiffness: that of a wave of the length of the box,
    // about (2π/15)² F'/3. Overlaps are below 0.2: 10⁻¹² · 0.2 · 17 √N.
    assert!(worst < 3e-10, "{worst:e}");
}
