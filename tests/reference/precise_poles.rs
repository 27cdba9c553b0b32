//! Poles held between two multi-precision numbers at which the cross product has opposite signs.

use jamscope::reference::poles::{pole, pole_count_below};
use jamscope::reference::screened::Screened;
use jamscope::reference::{Annulus, ReferenceError};
use proptest::prelude::*;

use crate::precise_bessel::{Real, real, rounded};
use crate::precise_profile::{PreciseProfile, Sign};
use crate::random_annuli::{annuli, holds};
use crate::{CLAIMED_POLE, annulus};

/// v(a) at κ (1 + shift).
fn inner_value<const D: usize>(annulus: Annulus, wavenumber: f64, shift: f64) -> Real {
    let shifted = real(wavenumber, 640) * (real(1.0, 640) + real(shift, 640));
    let (inner, outer) = (annulus.inner_radius(), annulus.outer_radius());
    PreciseProfile::<D>::with(Sign::Screened, inner, outer, shifted).rim_at_inner()[0].clone()
}

fn poles_are_bracketed<const D: usize>(count: u32) {
    let index = prop_oneof![1..20usize, 1..=1000usize];
    holds(&format!("poles, D = {D}"), count, (annuli(), index), |&(annulus, index)| {
        let found = pole::<D>(annulus, index);
        let values = [-CLAIMED_POLE, CLAIMED_POLE].map(|shift| inner_value::<D>(annulus, found, shift));
        let [below, above] = values.each_ref().map(rounded);
        // v(a) has the sign (−1)^(n−1) below pole n and the other above, so the root between is this one.
        let sign = if index % 2 == 1 { 1.0 } else { -1.0 };
        assert!(sign * below > 0.0 && sign * above < 0.0, "{below} and {above} around {found}, {annulus:?}");
        // Where the line through both vanishes, in units of what is allowed: v(a) is straight over 10⁻¹⁵ of κ.
        vec![((below + above) / (below - above)).abs()]
    });
}

#[test]
fn poles_lie_between_numbers_of_opposite_sign() {
    poles_are_bracketed::<2>(200);
    poles_are_bracketed::<3>(200);
}

fn counting_is_complete<const D: usize>() {
    for ratio in [1.001, 1.03, 1.7, 12.0, 340.0, 1e4, 1e7] {
        let annulus = annulus(0.5, 0.5 * ratio);
        // v(a) changes sign from one branch to the next: none of these poles is two, and none is missing between.
        let poles: Vec<f64> = (0..=12).map(|index| pole::<D>(annulus, index)).collect();
        for (index, pair) in poles.windows(2).enumerate() {
            let middle = 0.5 * (pair[0] + pair[1]);
            let value = rounded(&inner_value::<D>(annulus, middle, 0.0));
            assert!(
                if index % 2 == 0 { value > 0.0 } else { value < 0.0 },
                "{value} after pole {index}, R/a = {ratio}"
            );
            assert_eq!(pole_count_below::<D>(annulus, middle), index);
        }
        let width = annulus.outer_radius() - annulus.inner_radius();
        let mut last = 0.0;
        for index in 1..=1000 {
            let pole = pole::<D>(annulus, index);
            // φ lets the spacing exceed π/(R − a) by no more than its whole range, π/2; and poles attract no other.
            let spacing = (pole - last) * width / std::f64::consts::PI;
            assert!(spacing > 0.5 && spacing < 1.5, "spacing {spacing} before pole {index}, R/a = {ratio}");
            last = pole;
            assert_eq!(pole_count_below::<D>(annulus, pole * (1.0 - 4e-15)), index - 1, "R/a = {ratio}");
            assert_eq!(pole_count_below::<D>(annulus, pole * (1.0 + 4e-15)), index, "R/a = {ratio}");
            for neighbour in [pole.next_down(), pole, pole.next_up()] {
                let found = Screened::<D>::new(annulus, 1.0, neighbour);
                assert!(
                    matches!(found, Err(ReferenceError::AtPole { index: named, .. }) if named == index),
                    "{found:?} at pole {index}, R/a = {ratio}"
                );
            }
        }
    }
}

#[test]
fn a_thousand_poles_are_counted_and_refused_in_every_annulus() {
    counting_is_complete::<2>();
    counting_is_complete::<3>();
}
