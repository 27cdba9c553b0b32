//! No pole is left out, and none is counted twice.

use super::*;

fn poles_are_counted<const D: usize>() {
    for (inner, outer) in [(0.5, 42.0), (1.0, 1.001), (3.0, 4.0), (1e-9, 1.0), (1e-200, 1.0)] {
        let annulus = annulus(inner, outer);
        let mut last = 0.0;
        for index in (1..60).chain([1000, 123_456, 10_000_000]) {
            let pole = pole::<D>(annulus, index);
            assert!(pole > last, "pole {index} of {annulus:?}");
            last = pole;
            // 10⁻⁸ of index 10⁷ is a tenth of the spacing.
            assert_eq!(pole_count_below::<D>(annulus, pole * (1.0 - 1e-8)), index - 1, "{annulus:?}");
            assert_eq!(pole_count_below::<D>(annulus, pole * (1.0 + 1e-8)), index, "{annulus:?}");
            let at_pole = Screened::<D>::new(annulus, 1.0, pole);
            assert!(matches!(at_pole, Err(ReferenceError::AtPole { index: found, .. }) if found == index));
        }
        assert_eq!(pole::<D>(annulus, 0), 0.0);
    }
}

#[test]
fn every_pole_is_counted_once() {
    poles_are_counted::<2>();
    poles_are_counted::<3>();
}

#[test]
fn poles_are_all_the_sign_changes_of_the_cross_product() {
    // A scan by the definition, with steps of 1/50 of π/(R − a).
    for (inner, outer) in [(0.5, 42.0), (3.0, 4.0), (1.0, 1.3)] {
        let annulus = annulus(inner, outer);
        let cross = |k: f64| libm::j1(inner * k) * libm::y1(outer * k) - libm::y1(inner * k) * libm::j1(outer * k);
        let step = PI / (outer - inner) / 50.0;
        let mut found = 0;
        for i in 1..3000 {
            let (left, right) = (i as f64 * step, (i + 1) as f64 * step);
            if (cross(left) > 0.0) != (cross(right) > 0.0) {
                found += 1;
                let pole = pole::<2>(annulus, found);
                // The two may differ by rounding, where a pole falls on a point of the scan.
                assert!((left..=right).contains(&pole), "pole {found}: {pole} not in [{left}, {right}]");
            }
            assert_eq!(pole_count_below::<2>(annulus, right), found);
        }
        assert!(found > 50);
    }
}
