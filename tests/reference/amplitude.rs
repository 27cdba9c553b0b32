//! Amplitude over that of the elastic profile: against multi-precision, and as the sum over its poles.

use jamscope::reference::amplitude::Amplitude;
use jamscope::reference::poles::pole;
use jamscope::reference::{Annulus, ReferenceError};
use proptest::prelude::*;

use crate::precise_bessel::{Real, real, rounded};
use crate::precise_profile::{PreciseProfile, Sign, error};
use crate::random_annuli::{annuli, cases, condition, holds};
use crate::{CLAIMED, annulus};

const BITS: usize = 576;

/// v(a; 0) = (R^D − a^D)/(D a^(D−1)).
fn elastic<const D: usize>(annulus: Annulus) -> Real {
    let [inner, outer] = [annulus.inner_radius(), annulus.outer_radius()].map(|radius| real(radius, BITS));
    let power = |x: &Real, n: usize| (0..n).fold(real(1.0, BITS), |product, _| product * x);
    (power(&outer, D) - power(&inner, D)) / (power(&inner, D - 1) * real(D as f64, BITS))
}

fn amplitudes_have_their_digits<const D: usize>(count: u32) {
    holds(&format!("amplitude, D = {D}"), count, cases(0), |case| {
        let (inner, outer) = (case.annulus.inner_radius(), case.annulus.outer_radius());
        let precise = PreciseProfile::<D>::new(Sign::Screened, inner, outer, case.wavenumber);
        let exact = elastic::<D>(case.annulus) / &precise.rim_at_inner()[0];
        let found = Amplitude::<D>::new(case.annulus).at(case.wavenumber).expect("no pole");
        vec![error(found, &exact) / rounded(&exact).abs() / (CLAIMED * condition::<D>(case))]
    });
    let index = prop_oneof![1..20usize, 1..=1000usize];
    holds(&format!("residues, D = {D}"), count, (annuli(), index), |&(annulus, index)| {
        let (inner, outer) = (annulus.inner_radius(), annulus.outer_radius());
        // The pole to twice its digits: one step of Newton's in multi-precision.
        let start = real(pole::<D>(annulus, index), BITS);
        let [value, slope] = PreciseProfile::<D>::with(Sign::Screened, inner, outer, start.clone()).rim_at_inner();
        let exact_pole = start - value / slope;
        let [_, slope] = PreciseProfile::<D>::with(Sign::Screened, inner, outer, exact_pole).rim_at_inner();
        let exact = elastic::<D>(annulus) / slope;
        let found = Amplitude::<D>::new(annulus).residue(index);
        // v(a; 0), c, two moduli, Φ°, κ_n: each to 6·10⁻¹⁶ at most.
        vec![error(found, &exact) / rounded(&exact).abs() / 4e-15]
    });
}

#[test]
fn amplitudes_and_residues_have_their_digits() {
    amplitudes_have_their_digits::<2>(150);
    amplitudes_have_their_digits::<3>(150);
}

fn amplitude_is_the_sum_over_its_poles<const D: usize>() {
    for (inner, outer) in [(0.5, 42.0), (3.0, 4.0), (0.5, 5.0)] {
        let annulus = annulus(inner, outer);
        let amplitude = Amplitude::<D>::new(annulus);
        assert_eq!(amplitude.at(0.0), Ok(1.0));
        assert_eq!(amplitude.residue(0), 0.0);
        let terms: Vec<(f64, f64)> =
            (1..=4000).map(|index| (pole::<D>(annulus, index), amplitude.residue(index))).collect();
        let first = terms[0].0;
        for share in [0.1, 0.5, 0.9, 1.3, 2.6, 7.7] {
            let square = (share * first).powi(2);
            let term = |&(pole, residue): &(f64, f64)| 2.0 * square * residue / (pole * (square - pole * pole));
            let mut partial = [0.0; 3];
            for pair in &terms {
                partial = [partial[1], partial[2], partial[2] + term(pair)];
            }
            // Term n is (−1)^n times a smooth function that falls at least as 1/n² (κ_n grows as n, r_n no faster). Averaged twice
            // the sum errs by a quarter of the second difference of the last term, about 6/n² of it: 10⁻⁹ at n = 4000 if the
            // term is below 2·10⁻³.
            assert!((partial[2] - partial[1]).abs() < 2e-3 * partial[2].abs(), "{partial:?}");
            let sum = 1.0 + 0.25 * (partial[0] + 2.0 * partial[1] + partial[2]);
            let exact = amplitude.at(share * first).expect("no pole");
            assert!((sum / exact - 1.0).abs() < 1e-9, "{sum}, not {exact} at {share} κ_1, {annulus:?}, D = {D}");
        }
    }
}

#[test]
fn poles_and_residues_sum_to_the_amplitude() {
    amplitude_is_the_sum_over_its_poles::<2>();
    amplitude_is_the_sum_over_its_poles::<3>();
}

/// ln|A| = −Σ ln|1 − κ²/κ_n²|. The factors beyond the thousandth have κ_n w between nπ and nπ + π/2, w = R − a, so with
/// q = (κw/π)² they add between Σ q/(n + 1/2)² > q/(N + 3/2) and Σ q/n²/(1 − q/N²) < (q/N)/(1 − q/N²): a bracket of width
/// 1.5 q/N² or so. Rounding: a thousand terms, below 1 but for the first few, 1000·2⁻⁵³, and a few 2⁻⁵³ over the distance to a pole, of
/// 1/10 or more: 10⁻¹² is more than both.
fn amplitude_is_the_product_over_its_poles<const D: usize>() {
    const COUNT: usize = 1000;
    for annulus in [annulus(0.5, 0.55), annulus(0.5, 42.0), annulus(0.5, 1e5)] {
        let amplitude = Amplitude::<D>::new(annulus);
        let width = annulus.outer_radius() - annulus.inner_radius();
        let poles: Vec<f64> = (1..=COUNT).map(|n| pole::<D>(annulus, n)).collect();
        for (wavenumber, count) in [
            (0.1 * poles[0], 0),
            (0.8 * poles[0], 0),
            (0.5 * (poles[0] + poles[1]), 1),
            (0.5 * (poles[1] + poles[2]), 2),
        ] {
            let exact = amplitude.at(wavenumber).expect("no pole");
            assert_eq!(exact > 0.0, count % 2 == 0);
            let factors: f64 = poles.iter().map(|pole| (1.0 - (wavenumber / pole).powi(2)).abs().ln()).sum();
            let (scale, terms) = ((wavenumber * width / std::f64::consts::PI).powi(2), COUNT as f64);
            let (low, high) = (scale / (terms + 1.5), scale / terms / (1.0 - scale / terms.powi(2)));
            let rest = exact.abs().ln() + factors;
            assert!(low - 1e-12 <= rest && rest <= high + 1e-12, "{rest}, not {low} to {high}, {annulus:?}, D = {D}");
        }
    }
}

#[test]
fn amplitude_is_the_product_of_a_factor_a_pole() {
    amplitude_is_the_product_over_its_poles::<2>();
    amplitude_is_the_product_over_its_poles::<3>();
}

#[test]
fn amplitude_at_a_pole_is_refused_by_number() {
    let annulus = annulus(0.5, 42.0);
    let amplitude = Amplitude::<2>::new(annulus);
    for index in [1, 2, 30] {
        let found = amplitude.at(pole::<2>(annulus, index));
        assert!(matches!(found, Err(ReferenceError::AtPole { index: named, .. }) if named == index), "{found:?}");
    }
    for wavenumber in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(amplitude.at(wavenumber), Err(ReferenceError::WavenumberNegative { .. })));
    }
}
