//! Inflations from 10⁻¹⁴ to half a length, of packings far from and below jamming.

use jamscope::displacement::DisplacementField;
use jamscope::inflation::{Inflated, Inflation, InflationError, inflate_with};
use jamscope::law::Hertzian;
use jamscope::packing::{Mixture, Packing};
use jamscope::preparation::{Preparation, Target, prepare_with};
use jamscope::relax::Criterion;
use jamscope::vector::larger;

use crate::{all_finite, fire};

fn packing(target: Target) -> Packing<2> {
    let preparation = Preparation {
        disk_count: 400,
        mixture: Mixture::default(),
        target,
        tolerance: 0.01,
        seed: 2,
        ..Preparation::default()
    };
    prepare_with::<2>(&preparation, &Hertzian::default(), &fire(1e-13), &mut ()).expect("in reach").packing.into_inner()
}

fn inflated(packing: &Packing<2>, increase: f64) -> Result<Inflated<2>, InflationError> {
    let inflation = Inflation { increase, ..Inflation::default() };
    inflate_with(&inflation, packing, &Hertzian::default(), &fire(1e-13), 1, &mut ())
}

#[test]
fn inflations_from_a_hundred_trillionth_to_half_a_length() {
    let dense = packing(Target::Pressure(3000.0));
    let response = |increase: f64| -> Vec<f64> {
        let inflated = inflated(&dense, increase).expect("at rest");
        assert!(all_finite(inflated.after.packing.get()));
        let field = DisplacementField::of_inflation(&inflated);
        field.disks.iter().map(|disk| disk.radial / increase).collect()
    };
    let linear = response(1e-6);
    let scale = linear.iter().copied().fold(0.0, |most, value| larger(most, value.abs()));
    for increase in [1e-14, 1e-12, 1e-10, 1e-8, -1e-8] {
        let found = response(increase);
        // Force limit 10⁻¹³ of ⟨F⟩ over a softest stiffness of some per mille of F'(δ) ~ ⟨F⟩/0.1, hence 10⁻¹¹ of a length;
        // curvature of the response: d_0 over the overlaps, 10⁻⁶/0.1.
        let tolerance = 1e-11 / increase.abs() + 1e-4 * scale;
        let worst = found.iter().zip(&linear).fold(0.0, |most, (a, b)| larger(most, (a - b).abs()));
        assert!(worst <= tolerance, "{increase:e}: {worst:e} of {scale}");
    }
    // Half a length doubles the radius of the disk; its neighbours stand at 0.9 and further.
    for increase in [0.1, 0.3] {
        assert!(response(increase).iter().copied().all(f64::is_finite));
    }
    match inflated(&dense, 0.5) {
        Ok(inflated) => assert!(all_finite(inflated.after.packing.get())),
        Err(error) => assert!(matches!(error, InflationError::IncreaseTooLarge { .. }), "{error}"),
    }
}

#[test]
fn a_disk_among_rattlers_grows_and_nothing_is_jammed() {
    let loose = packing(Target::PackingFraction(0.4));
    for increase in [1e-14, 0.1, 0.3] {
        let inflated = inflated(&loose, increase).expect("at rest");
        assert_eq!(inflated.after.criterion, Criterion::Unjammed, "{increase:e}");
        assert_eq!(inflated.after.pressure, 0.0);
        let field = DisplacementField::of_inflation(&inflated);
        assert!(field.disks.iter().all(|disk| disk.radial.is_finite() && disk.transverse().is_finite()));
    }
}
