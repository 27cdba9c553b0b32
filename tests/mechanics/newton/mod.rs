//! Newton's method and the staged relaxer: closed forms, the way down, agreement with the other relaxers, the rounding floor and
//! the work it takes, spheres without a factor, and named ends.

mod agreement;
mod closed_forms;
mod depth;
mod descent;
mod outcomes;
mod spheres;

use jamscope::law::PairLaw;
use jamscope::linear::Analysis;
use jamscope::linear::{Hessian, Members, Prestress};
use jamscope::network::ContactNetwork;
use jamscope::packing::Packing;
use jamscope::relax::{Fire, ForceLimit, Newton, Staged};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

fn newton(limit: f64) -> Newton {
    Newton { limit: ForceLimit::Relative(limit), ..Newton::default() }
}

fn staged(limit: f64) -> Staged {
    Staged { limit: ForceLimit::Relative(limit), ..Staged::default() }
}

fn fire(limit: f64) -> Fire {
    Fire { limit: ForceLimit::Relative(limit), ..Fire::default() }
}

/// Softest stiffness of the backbone of a packing with held disks, by inverse iteration: an upper bound that falls to it.
fn softest<const D: usize>(packing: &Packing<D>, law: &dyn PairLaw) -> f64 {
    let hessian = Hessian::new(packing, law, Members::Backbone, Prestress::Included).expect("no coincidence");
    let matrix = hessian.matrix();
    let mut analysis = Analysis::of(&hessian).expect("small");
    let mut factorisation = analysis.cholesky(matrix).expect("a minimum");
    let mut generator = Pcg64::seed_from_u64(1);
    let mut mode: Vec<f64> = (0..matrix.dimension()).map(|_| generator.random::<f64>() - 0.5).collect();
    let mut next = vec![f64::NAN; mode.len()];
    let mut quotient = f64::INFINITY;
    for _ in 0..200 {
        let length = mode.iter().map(|x| x * x).sum::<f64>().sqrt();
        mode.iter_mut().for_each(|x| *x /= length);
        let _ = factorisation.solve(&mode, &mut next).expect("well conditioned enough");
        quotient = 1.0 / mode.iter().zip(&next).map(|(x, y)| x * y).sum::<f64>();
        std::mem::swap(&mut mode, &mut next);
    }
    quotient
}

/// How far two states at rest to this relative limit may be apart: |u| ≤ |F|/λ_min each, |F| ≤ √N times the largest.
fn allowed<const D: usize>(packing: &Packing<D>, law: &dyn PairLaw, limit: f64) -> f64 {
    let mean = ContactNetwork::new(packing, law).expect("no coincidence").mean_contact_force();
    2.0 * limit * mean * (packing.len() as f64).sqrt() / softest(packing, law)
}
