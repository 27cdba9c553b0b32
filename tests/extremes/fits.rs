//! Profiles that no packing has: a handful of rings, numbers from one end of the range to the other, no errors at all.

use crate::seeds::config;
use jamscope::fit::profile::{ProfileFit, ProfileFitSettings, fit_radial_profile};
use jamscope::observe::RadialProfile;
use jamscope::observe::radial_profile::Ring;
use jamscope::reference::Annulus;
use proptest::prelude::*;

/// Numbers of any size and sign, with a taste for zero and for the ends of the range.
fn any_size() -> impl Strategy<Value = f64> {
    let power = (-150.0..150.0f64).prop_map(|power| 10f64.powf(power));
    let signed = (power, any::<bool>()).prop_map(|(size, sign)| if sign { size } else { -size });
    prop_oneof![3 => signed, 3 => -1.0..1.0, 1 => Just(0.0), 1 => Just(f64::MAX), 1 => Just(f64::from_bits(1))]
}

fn numbers(fit: &ProfileFit) -> Vec<f64> {
    // What a report would hold: a number that is not finite becomes null there.
    let text = serde_json::to_string(fit).expect("a fit can be written");
    assert!(!text.contains("null,\"standard_error\""), "{text}");
    let elastic = [fit.elastic.amplitude.value, fit.elastic.amplitude.standard_error];
    let screened = fit.screened.iter().flat_map(|fit| [fit.amplitude.value, fit.wavenumber.value]);
    elastic.into_iter().chain(screened).collect()
}

proptest! {
    #![proptest_config(config(200, 1))]

    #[test]
    fn any_profile_is_fitted_or_refused(
        rows in prop::collection::vec((any_size(), any_size(), 1usize..100), 1..60),
        size in -100.0..100.0f64,
    ) {
        let unit = 10f64.powf(size);
        let annulus = Annulus::new(0.5 * unit, 42.0 * unit).expect("radii in order");
        let rings = rows.iter().enumerate().map(|(index, &(mean, error, disk_count))| Ring {
            radius: (1.0 + 40.0 * index as f64 / rows.len() as f64) * unit,
            disk_count,
            mean,
            spread: error.abs(),
            standard_error: error.abs() / (disk_count as f64).sqrt(),
        });
        let profile = RadialProfile { rings: rings.collect() };
        if let Ok(fit) = fit_radial_profile::<2>(&profile, annulus, &ProfileFitSettings::default()) {
            let numbers = numbers(&fit);
            prop_assert!(numbers.iter().all(|number| !number.is_nan()), "{fit:?}");
        }
    }
}
