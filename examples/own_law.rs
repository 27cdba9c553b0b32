//! A contact law of one's own, a spring that stiffens with the overlap: `cargo run --release --example own_law`

use jamscope::inflation::inflate_with;
use jamscope::law::damping::{ContactDamping, MassDamping};
use jamscope::preparation::{Target, prepare_with};
use jamscope::{Fire, Inflation, PairLaw, Preparation};

/// F = k δ (1 + δ/s) and u = k δ² (1/2 + δ/(3 s)), k `stiffness` [force / length] and s `scale` [length].
#[derive(Debug, Clone, Copy)]
struct Stiffening {
    stiffness: f64,
    scale: f64,
}

impl PairLaw for Stiffening {
    fn coefficient(&self, _: f64, _: f64) -> f64 {
        self.stiffness
    }
    fn coefficient_growth(&self, _: f64, _: f64) -> f64 {
        0.0 // ∂ ln k/∂R: k is the same for all radii
    }
    fn exponent(&self) -> f64 {
        2.0 // of the energy at small overlaps
    }
    fn force(&self, k: f64, overlap: f64) -> f64 {
        k * overlap * (1.0 + overlap / self.scale)
    }
    fn energy(&self, force: f64, overlap: f64) -> f64 {
        force * overlap * (0.5 * self.scale + overlap / 3.0) / (self.scale + overlap)
    }
    fn stiffness(&self, force: f64, overlap: f64) -> f64 {
        if overlap > 0.0 { force / overlap * (self.scale + 2.0 * overlap) / (self.scale + overlap) } else { 0.0 }
    }
    fn viscoelastic(&self, rate: f64) -> ContactDamping {
        ContactDamping::Mass(MassDamping { rate }) // for relaxers with damping; FIRE has none
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (law, fire) = (Stiffening { stiffness: 2e5, scale: 0.2 }, Fire::default());
    let preparation = Preparation { disk_count: 500, target: Target::Pressure(2000.0), ..Preparation::default() };
    let prepared = prepare_with::<2>(&preparation, &law, &fire, &mut ())?;
    println!("p = {:.1} at φ = {:.4}", prepared.pressure, prepared.packing_fraction);
    let (inflation, seed) = (Inflation::default(), 1); // seed of the inflated disk; `&mut ()`: no observer
    let inflated = inflate_with(&inflation, prepared.packing.get(), &law, &fire, seed, &mut ())?;
    println!("Δp = {:.4}", inflated.after.pressure - inflated.before.pressure);
    Ok(())
}
