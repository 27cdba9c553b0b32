//! [`Amplitude`]: the amplitude of the response of a screened medium, as a function of its wavenumber.

use crate::reference::elastic::power_gap;
use crate::reference::oscillating::{Wave, rim_factor};
use crate::reference::poles::{pole, pole_at};
use crate::reference::rim::RimSolution;
use crate::reference::{Annulus, RadialSolution, ReferenceError};

/// Amplitude of the screened profile over that of the elastic one, for equal d_0.
///
/// ```text
/// A(κ) = v(a; 0)/v(a; κ) = d'(R; κ)/d'(R; 0) = Π_n (1 − κ²/κ_n²)⁻¹
///
/// A(κ) → r_n/(κ − κ_n)  at a pole        A(κ) = 1 + Σ_n 2κ² r_n / (κ_n (κ² − κ_n²))
/// ```
///
/// v is the rim solution. At the rim the field is A times as steep as the elastic one. A is 1 at κ = 0, is even in κ,
/// and changes sign at every pole κ_n ([`pole`]), where it has the residue r_n with the sign (−1)^n.
///
/// *The product.* v(a; κ) is an entire function of κ that grows as e^(|Im κ| (R−a)), so it is a function of κ² of order
/// 1/2. Such a function is its value at 0 times Π (1 − κ²/κ_n²) over its zeros (Hadamard's theorem). Its zeros are the
/// poles.
///
/// *The sum.* Let φ_n be the field that vanishes at both edges for κ = κ_n, and d = d_el + Σ c_n φ_n, d_el the elastic
/// field. The equation gives c_n = −κ² ⟨φ_n, d_el⟩/((κ² − κ_n²) ⟨φ_n, φ_n⟩) with the weight r^(D−1). Green's identity
/// is ⟨φ_n, d_el⟩ = a^(D−1) φ_n'(a) d_0/κ_n². So c_n φ_n' falls as n^(−2), and the sum may be differentiated at R:
/// d'(R)/d_el'(R) = 1 + Σ κ² b_n/(κ² − κ_n²), where b_n does not depend on κ. At the pole this is κ_n b_n/(2(κ − κ_n)),
/// so b_n = 2 r_n/κ_n.
///
/// # Units
/// κ and r_n in 1/length, A without unit.
///
/// # Source
/// Lemaître et al. (2021), Phys. Rev. E 104, 024904, for the profile; product and sum as derived above. For a → 0 the
/// product is that of J_1, Abramowitz & Stegun (1964), 9.5.10.
///
/// # Accuracy
/// Relative error of A below 3.2·10⁻¹⁵ (1 + κ_n/|κ − κ_n|), like that of the profile; of r_n below 4·10⁻¹⁵. Largest
/// errors found for R/a from 1.001 to 10⁷, n ≤ 1000, κR ≤ 10⁶, against multi-precision (`reference::amplitude`):
/// 3.3·10⁻¹⁶ of that factor, and 8.2·10⁻¹⁶.
///
/// # Cost
/// See `cargo bench --features measurements --bench reference -- amplitude`.
///
/// # Example
/// ```
/// use jamscope::reference::{Annulus, amplitude::Amplitude, poles::pole};
/// let annulus = Annulus::new(0.5, 30.0)?;
/// let amplitude = Amplitude::<2>::new(annulus);
/// assert_eq!(amplitude.at(0.0)?, 1.0);
/// // Close to the first pole the residue determines the amplitude.
/// let (first, off) = (pole::<2>(annulus, 1), 1e-9);
/// let expected = amplitude.residue(1) / off;
/// assert!((amplitude.at(first + off)? / expected - 1.0).abs() < 1e-6);
/// # Ok::<(), jamscope::reference::ReferenceError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Amplitude<const D: usize> {
    annulus: Annulus,
    /// v(a; 0).
    elastic: f64,
}

impl<const D: usize> Amplitude<D> {
    /// The amplitude of profiles in `annulus`.
    pub fn new(annulus: Annulus) -> Self {
        const { assert!(D == 2 || D == 3, "an annulus has D = 2, a shell D = 3") };
        let (inner, outer) = (annulus.inner_radius(), annulus.outer_radius());
        let elastic = power_gap::<D>(outer, inner) * (outer / inner).powi(D as i32 - 1) / D as f64;
        Amplitude { annulus, elastic }
    }

    /// A at `wavenumber` κ ≥ 0 \[1/length\].
    ///
    /// # Errors
    /// A wavenumber that is negative, not finite, or a pole to rounding.
    pub fn at(&self, wavenumber: f64) -> Result<f64, ReferenceError> {
        let rim = RimSolution::<D>::new(self.annulus, wavenumber)?;
        if rim.is_elastic() {
            return Ok(1.0);
        }
        if let Some(index) = pole_at::<D>(self.annulus, wavenumber) {
            return Err(ReferenceError::AtPole { index, wavenumber, pole: pole::<D>(self.annulus, index) });
        }
        Ok(self.elastic / rim.value(self.annulus.inner_radius()))
    }

    /// Residue r_n \[1/length\] at pole number `index`, counted from 1; 0 for `index` 0, which is not a pole.
    ///
    /// At the pole v = c M M sin Φ with Φ = nπ, so `r_n = (−1)^n v(a; 0) κ_n/(c M(κ_n a) M(κ_n R) Φ°)`, Φ° = κ ∂Φ/∂κ,
    /// without cancellation.
    pub fn residue(&self, index: usize) -> f64 {
        if index == 0 {
            return 0.0;
        }
        let wavenumber = pole::<D>(self.annulus, index);
        let (inner, outer) = (self.annulus.inner_radius(), self.annulus.outer_radius());
        let [at_disk, at_rim] = [inner, outer].map(|radius| Wave::new::<D>(wavenumber, radius));
        let turn = at_disk.turn_to(wavenumber, &at_rim);
        let height = rim_factor::<D>(wavenumber, outer) * at_disk.modulus * at_rim.modulus;
        let size = self.elastic / height * (wavenumber / turn.rate);
        if index.is_multiple_of(2) { size } else { -size }
    }
}
