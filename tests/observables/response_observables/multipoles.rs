use std::f64::consts::{PI, TAU};

use jamscope::observe::multipoles::{
    ComponentModes, ModeFit, MultipoleError, MultipoleFit, MultipoleSettings, Multipoles,
};
use jamscope::reference::Annulus;
use jamscope::reference::angular_modes::{AngularSolution, Complex, ModeAmplitudes, elastic::ElasticMode};

use super::{field, generator, normal, random_places};

fn fitted(fit: &MultipoleFit) -> [&ComponentModes; 2] {
    match fit {
        MultipoleFit::Fitted { radial, transverse } => [radial, transverse],
        other => panic!("no modes: {other:?}"),
    }
}

/// U = c − i s.
fn complex(mode: &ModeFit) -> Complex<f64> {
    Complex::new(mode.cosine, -mode.sine)
}

/// The elastic modes 0 to 4 of an annulus, each with amplitudes of its own at the inner circle.
fn exact_modes() -> Vec<ElasticMode> {
    let annulus = Annulus::new(0.5, 40.0).expect("an annulus");
    let boundary = |mode: u32| {
        let n = f64::from(mode);
        // Mode 0 has no phase.
        let turn = |z: Complex<f64>| if mode == 0 { Complex::new(z.re, 0.0) } else { z };
        ModeAmplitudes {
            radial: turn(Complex::new(0.1 / (1.0 + n), 0.03 * n)),
            transverse: turn(Complex::new(-0.02, 0.05 - 0.01 * n)),
        }
    };
    (0..5).map(|mode| ElasticMode::new(annulus, 0.3, mode, boundary(mode)).expect("a mode")).collect()
}

#[test]
fn exact_elastic_modes_are_recovered_to_rounding() {
    let modes = exact_modes();
    let mut generator = generator(1);
    let distances = [3.1, 9.4, 18.9, 35.2];
    let places = random_places(&distances, 80, &mut generator);
    let field = field(&places, |r, angle| {
        modes.iter().map(|mode| mode.displacement(r, angle)).fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]])
    });
    let found = Multipoles::of(&field, &MultipoleSettings::default()).expect("sound settings");
    assert_eq!(found.rings.len(), distances.len());
    for (ring, distance) in found.rings.iter().zip(distances) {
        assert_eq!(ring.disk_count, 80);
        let components = fitted(&ring.fit);
        let exact: Vec<ModeAmplitudes> = modes.iter().map(|mode| mode.at(distance).value).collect();
        let size = exact.iter().map(|value| value.radial.norm() + value.transverse.norm()).sum::<f64>();
        // The sum of five values and the angle from rounded coordinates, n θ with n to 4: 10⁻¹⁵ of the size each; the
        // condition of nine columns on 80 random angles is below 3.
        let tolerance = 1e-14 * size;
        for (n, exact) in exact.iter().enumerate() {
            for (component, exact) in components.iter().zip([exact.radial, exact.transverse]) {
                let mode = &component.modes[n];
                assert!((complex(mode) - exact).norm() < tolerance, "mode {n} at {distance}: {mode:?}, not {exact}");
                assert!(mode.standard_errors.iter().all(|error| *error < tolerance));
                if n > 0 {
                    assert!((mode.amplitude - exact.norm()).abs() < tolerance);
                    // d = A cos(nθ − ψ) = Re[U e^(inθ)] with U = A e^(−iψ); an angle is off by what the amplitude is over
                    // it.
                    let phase = (mode.phase + exact.arg()).rem_euclid(TAU);
                    assert!(phase.min(TAU - phase) * exact.norm() < tolerance);
                }
            }
        }
        // Shares are those of the exact amplitudes: nothing beyond mode 4.
        for (component, which) in components.iter().zip([0, 1]) {
            let squares: Vec<f64> = exact
                .iter()
                .enumerate()
                .map(|(n, value)| [value.radial, value.transverse][which].norm_sqr() * if n == 0 { 1.0 } else { 0.5 })
                .collect();
            let total: f64 = squares.iter().sum();
            assert!((component.mean_square / total - 1.0).abs() < 1e-12);
            let shares = component.shares.expect("something moves");
            (0..3).for_each(|n| assert!((shares[n] - squares[n] / total).abs() < 1e-12));
            assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-15);
        }
    }
}

#[test]
fn evenly_spaced_angles_give_the_discrete_fourier_sums_and_parseval() {
    let mut generator = generator(2);
    let count = 50;
    let places: Vec<[f64; 2]> = (0..count).map(|k| [5.0, TAU * k as f64 / count as f64 - PI]).collect();
    let values: Vec<f64> = (0..count).map(|_| normal(&mut generator)).collect();
    let at = |angle: f64| values[((angle + PI) / TAU * count as f64).round() as usize % count];
    let field = field(&places, |_, angle| [at(angle), 0.0]);
    let found = Multipoles::of(&field, &MultipoleSettings::default()).expect("sound settings");
    let [radial, transverse] = fitted(&found.rings[0].fit);
    for mode in &radial.modes {
        let factor = if mode.mode == 0 { 1.0 } else { 2.0 } / count as f64;
        let sum = |wave: fn(f64) -> f64| -> f64 {
            places.iter().map(|place| wave(mode.mode as f64 * place[1]) * at(place[1])).sum::<f64>() * factor
        };
        // 50 terms of size 1.
        assert!((mode.cosine - sum(f64::cos)).abs() < 1e-14 && (mode.sine - sum(f64::sin)).abs() < 1e-14);
    }
    let mean_square = values.iter().map(|value| value * value).sum::<f64>() / count as f64;
    assert!((radial.mean_square / mean_square - 1.0).abs() < 1e-13);
    // The transverse part of a radial field is rounding: 10⁻¹⁶ of displacements of a few lengths.
    assert!(transverse.modes.iter().all(|mode| mode.amplitude.abs() < 1e-14));
}

#[test]
fn errors_of_the_modes_cover_what_noise_does() {
    // 1500 rings of 60 disks at random angles, modes 0 to 2 and noise of 0.02. A pull lies within 1 in 68.0 % and within 2
    // in 95.0 % of the cases (t with 60 − 9 degrees of freedom: 67.8 and 94.9), to four standard deviations: 1.2 % and 0.56
    // % of 1500.
    let truth = [0.05, 0.03, -0.04];
    let phases = [0.0, 0.7, -2.0];
    let mut generator = generator(3);
    let ring_count = 1500;
    let mut within = vec![[0.0; 2]; 5];
    let mut rest = 0.0;
    for _ in 0..ring_count {
        let places = random_places(&[5.0], 60, &mut generator);
        let noise: std::cell::RefCell<Vec<f64>> =
            (0..60).map(|_| 0.02 * normal(&mut generator)).collect::<Vec<_>>().into();
        let field = field(&places, |_, angle| {
            let waves = (0..3).map(|n| truth[n] * (n as f64 * angle - phases[n]).cos());
            [waves.sum::<f64>() + noise.borrow_mut().pop().expect("one a disk"), 0.0]
        });
        let found = Multipoles::of(&field, &MultipoleSettings::default()).expect("sound settings");
        let [radial, _] = fitted(&found.rings[0].fit);
        rest += radial.rest.powi(2) / f64::from(ring_count);
        let [zero, one, two] = [&radial.modes[0], &radial.modes[1], &radial.modes[2]];
        let pulls = [
            (zero.amplitude - truth[0]) / zero.amplitude_error,
            (one.cosine - truth[1] * phases[1].cos()) / one.standard_errors[0],
            (one.sine - truth[1] * phases[1].sin()) / one.standard_errors[1],
            (two.amplitude - truth[2].abs()) / two.amplitude_error,
            // −0.04 cos(2θ + 2) = 0.04 cos(2θ − (π − 2)).
            (two.phase - (PI - 2.0)) / two.phase_error,
        ];
        for (count, pull) in within.iter_mut().zip(pulls) {
            (0..2)
                .for_each(|k| count[k] += if pull.abs() < (k + 1) as f64 { 1.0 } else { 0.0 } / f64::from(ring_count));
        }
    }
    for count in within {
        assert!((count[0] - 0.68).abs() < 0.048 && (count[1] - 0.95).abs() < 0.023, "{count:?}");
    }
    // σ² over 1500 · 51 degrees of freedom: 4 √(2/76500) = 2 %.
    assert!((rest / 0.0004 - 1.0).abs() < 0.021, "{rest}");
}

#[test]
fn rings_without_modes_say_why() {
    let mut generator = generator(4);
    let settings = MultipoleSettings::default();
    let mut places = random_places(&[5.0], 26, &mut generator);
    // Forty disks at three angles cannot tell nine coefficients apart.
    places.extend((0..40).map(|k| [15.0, [0.0, 1.0, 2.0][k % 3]]));
    places.extend(random_places(&[25.0], 40, &mut generator));
    let mut field = field(&places, |_, _| [0.0, 0.0]);
    field.disks[70].radial = f64::NAN;
    let fits: Vec<MultipoleFit> =
        Multipoles::of(&field, &settings).expect("sound settings").rings.into_iter().map(|ring| ring.fit).collect();
    assert_eq!(fits, [MultipoleFit::TooFewDisks { needed: 27 }, MultipoleFit::AnglesTooFew, MultipoleFit::NotFinite]);
    field.disks[70].radial = 0.0;
    let still = Multipoles::of(&field, &settings).expect("sound settings");
    let [radial, _] = fitted(&still.rings[2].fit);
    assert_eq!((radial.mean_square, radial.shares), (0.0, None));

    let refused = |settings: MultipoleSettings| Multipoles::of(&field, &settings).expect_err("no sense");
    assert_eq!(
        refused(MultipoleSettings { highest_mode: 1, ..settings }),
        MultipoleError::HighestModeOutOfRange { highest_mode: 1 }
    );
    assert_eq!(
        refused(MultipoleSettings { ring_width: 0.0, ..settings }),
        MultipoleError::RingWidthNotPositive { ring_width: 0.0 }
    );
    assert_eq!(
        refused(MultipoleSettings { disks_per_coefficient: 0.5, ..settings }),
        MultipoleError::TooFewDisksPerCoefficient { disks_per_coefficient: 0.5 }
    );
    let read = serde_json::from_str::<MultipoleSettings>(r#"{"ring_width": 3.0}"#).expect("the rest by default");
    assert_eq!(read, MultipoleSettings { ring_width: 3.0, ..settings });
    assert!(serde_json::from_str::<MultipoleSettings>(r#"{"width": 3.0}"#).is_err());
}
