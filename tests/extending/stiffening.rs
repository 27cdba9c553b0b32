use jamscope::law::PairLaw;
use jamscope::law::damping::{ContactDamping, MassDamping};

/// A spring that stiffens, of stiffness k \[force / length\] and length s \[length\]; not a power of δ:
/// F = k δ (1 + x), u = k δ² (1/2 + x/3), F' = k (1 + 2x) with x = δ/s.
#[derive(Debug, Clone, Copy)]
pub struct Stiffening(pub f64, pub f64);
impl PairLaw for Stiffening {
    fn viscoelastic(&self, rate: f64) -> ContactDamping {
        ContactDamping::Mass(MassDamping { rate })
    }
    fn coefficient(&self, _: f64, _: f64) -> f64 {
        self.0
    }
    fn coefficient_growth(&self, _: f64, _: f64) -> f64 {
        0.0
    }
    fn force(&self, k: f64, overlap: f64) -> f64 {
        k * overlap * (1.0 + overlap / self.1)
    }
    fn exponent(&self) -> f64 {
        2.0
    }
    fn energy(&self, force: f64, overlap: f64) -> f64 {
        force * overlap * (0.5 * self.1 + overlap / 3.0) / (self.1 + overlap)
    }
    fn stiffness(&self, force: f64, overlap: f64) -> f64 {
        if overlap > 0.0 { force / overlap * (self.1 + 2.0 * overlap) / (self.1 + overlap) } else { 0.0 }
    }
}
