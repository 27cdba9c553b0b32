//! Angular modes fitted by the exact elastic ones: recovery, Poisson's ratio, what is not elastic, what cannot be fitted.

use jamscope::fit::FitError;
use jamscope::fit::modes::{ElasticModeSettings, ElasticModesFit, fit_elastic_modes};
use jamscope::observe::multipoles::{ComponentModes, ModeFit, MultipoleFit, MultipoleRing, Multipoles};
use jamscope::reference::Annulus;
use jamscope::reference::angular_modes::elastic::ElasticMode;
use jamscope::reference::angular_modes::screened::{ScreenedMode, Screening};
use jamscope::reference::angular_modes::{AngularSolution, Complex, ModeAmplitudes};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// r_1, R and the ratio of the elastic medium.
const FROM: f64 = 2.0;
const OUTER: f64 = 42.0;
const RATIO: f64 = 0.3;

/// Modes 0 to this.
const HIGHEST: usize = 3;

fn boundary(mode: usize) -> ModeAmplitudes {
    let size = 0.1 / (1.0 + mode as f64);
    if mode == 0 {
        return ModeAmplitudes { radial: Complex::new(size, 0.0), transverse: Complex::new(0.3 * size, 0.0) };
    }
    ModeAmplitudes { radial: Complex::new(size, 0.4 * size), transverse: Complex::new(-0.7 * size, 0.2 * size) }
}

/// A mode as it would be measured with these errors.
fn fit_of(mode: usize, amplitude: Complex<f64>, error: f64) -> ModeFit {
    ModeFit {
        mode,
        cosine: amplitude.re,
        sine: -amplitude.im,
        standard_errors: [error, if mode == 0 { 0.0 } else { error }],
        amplitude: amplitude.norm(),
        amplitude_error: error,
        phase: 0.0,
        phase_error: 0.0,
    }
}

/// Rings two lengths wide with these amplitudes of every mode.
fn multipoles(amplitudes: impl Fn(usize, f64) -> ModeAmplitudes, error: f64) -> Multipoles {
    let component = |modes: Vec<ModeFit>| ComponentModes { modes, rest: error, mean_square: 1.0, shares: None };
    let ring = |radius: f64| {
        let at: Vec<ModeAmplitudes> = (0..=HIGHEST).map(|mode| amplitudes(mode, radius)).collect();
        let of = |part: fn(&ModeAmplitudes) -> Complex<f64>| {
            component(at.iter().enumerate().map(|(mode, value)| fit_of(mode, part(value), error)).collect())
        };
        let fit = MultipoleFit::Fitted { radial: of(|value| value.radial), transverse: of(|value| value.transverse) };
        MultipoleRing { radius, disk_count: 100, fit }
    };
    Multipoles { rings: (1..21).map(|i| ring(2.0 * f64::from(i) + 1.0)).collect() }
}

fn elastic(mode: usize, radius: f64) -> ModeAmplitudes {
    let annulus = Annulus::new(FROM, OUTER).expect("an annulus");
    ElasticMode::new(annulus, RATIO, mode as u32, boundary(mode)).expect("finite").at(radius).value
}

fn fit(multipoles: &Multipoles) -> ElasticModesFit {
    fit_elastic_modes(multipoles, OUTER, &ElasticModeSettings::default()).expect("twenty rings")
}

#[test]
fn exact_modes_are_recovered_with_their_poisson_ratio() {
    let found = fit(&multipoles(elastic, 1e-3));
    // χ² is quadratic about ν with a minimum of rounding: flat to √(ε χ²_0) of it.
    assert!((found.poisson_ratio - RATIO).abs() < 1e-6, "{}", found.poisson_ratio);
    assert_eq!((found.ring_count, found.modes.len()), (20, HIGHEST + 1));
    for (mode, of_mode) in found.modes.iter().enumerate() {
        let exact = boundary(mode);
        let distance = |[re, im]: [f64; 2], value: Complex<f64>| (Complex::new(re, im) - value).norm();
        assert!(distance(of_mode.radial, exact.radial) < 1e-6, "U of mode {mode}: {:?}", of_mode.radial);
        assert!(distance(of_mode.transverse, exact.transverse) < 1e-6, "V of mode {mode}: {:?}", of_mode.transverse);
        assert!(of_mode.share_described.expect("it moves") > 1.0 - 1e-9);
        assert_eq!(of_mode.freedom, if mode == 0 { 38 } else { 76 });
    }
    let (ours, theirs) = (found.at(2, 17.0).expect("within"), elastic(2, 17.0));
    assert!((ours.radial - theirs.radial).norm() < 1e-7);
    assert!(found.at(2, 1.0).is_none() && found.at(9, 17.0).is_none());
}

#[test]
fn a_given_ratio_is_kept_and_the_amplitudes_are_exact() {
    let settings = ElasticModeSettings { poisson_ratio: Some(RATIO), ..ElasticModeSettings::default() };
    let found = fit_elastic_modes(&multipoles(elastic, 1e-3), OUTER, &settings).expect("twenty rings");
    assert_eq!((found.poisson_ratio, found.poisson_ratio_range), (RATIO, None));
    for (mode, of_mode) in found.modes.iter().enumerate() {
        // Normal equations square the condition of two columns, which at twenty rings is below 100: 10⁴ roundings of 0.1.
        let exact = boundary(mode).radial;
        let distance = (Complex::new(of_mode.radial[0], of_mode.radial[1]) - exact).norm();
        assert!(distance < 1e-12, "mode {mode}: {distance:e}");
    }
}

/// Elastic modes with normal noise of the error that is stated.
fn noisy(seed: u64, error: f64) -> Multipoles {
    let random = std::cell::RefCell::new(Pcg64Mcg::seed_from_u64(seed));
    let normal = || {
        let mut random = random.borrow_mut();
        let (a, b): (f64, f64) = (random.random(), random.random());
        (-2.0 * (1.0 - a).ln()).sqrt() * (std::f64::consts::TAU * b).cos()
    };
    let noise = |mode: usize| Complex::new(error * normal(), if mode == 0 { 0.0 } else { error * normal() });
    multipoles(
        |mode, radius| {
            let value = elastic(mode, radius);
            ModeAmplitudes { radial: value.radial + noise(mode), transverse: value.transverse + noise(mode) }
        },
        error,
    )
}

#[test]
fn with_noise_chi_squared_is_its_freedom_and_the_range_holds_the_ratio() {
    let (mut total, mut freedom, mut held) = (0.0, 0, 0);
    for seed in 0..200 {
        let found = fit(&noisy(seed, 5e-4));
        total += found.modes.iter().map(|mode| mode.chi_squared).sum::<f64>();
        freedom += found.modes.iter().map(|mode| mode.freedom).sum::<usize>();
        let [low, high] = found.poisson_ratio_range.expect("the noise is small");
        held += usize::from(low <= RATIO && RATIO <= high);
    }
    // One parameter for ν beside those counted; χ² of 200·266 degrees scatters by √(2/53200) = 0.6 %: three of them.
    let ratio = total / freedom as f64;
    assert!((ratio - 1.0 + 1.0 / 266.0).abs() < 0.019, "χ² over freedom {ratio}");
    // One standard error holds 68.3 %: σ = 3.3 % of 200, three of them.
    assert!((117..=156).contains(&held), "{held} of 200");
}

#[test]
fn screened_modes_are_described_worse() {
    let annulus = Annulus::new(FROM, OUTER).expect("an annulus");
    let screening = Screening { even: 0.02, odd: 0.0 };
    let screened = |mode: usize, radius: f64| {
        ScreenedMode::new(annulus, RATIO, screening, mode as u32, boundary(mode)).expect("no pole").at(radius).value
    };
    let found = fit(&multipoles(screened, 1e-3));
    // κR = √0.02·42 = 6, beyond the first pole: the sign of the response changes on the way. Mode n falls as r^(1−n) at least: the
    // third is gone before a wavelength, 44, and hardly sees the screening.
    for mode in &found.modes[..HIGHEST] {
        assert!(mode.share_described.expect("it moves") < 0.9, "{mode:?}");
    }
}

#[test]
fn what_cannot_be_fitted_says_why() {
    let all = multipoles(elastic, 1e-3);
    let few = Multipoles { rings: all.rings[..3].to_vec() };
    let settings = ElasticModeSettings::default();
    assert!(matches!(fit_elastic_modes(&few, OUTER, &settings), Err(FitError::TooFewRings { ring_count: 3, .. })));
    let settings = ElasticModeSettings { poisson_ratio: Some(1.0), ..ElasticModeSettings::default() };
    assert_eq!(fit_elastic_modes(&all, OUTER, &settings), Err(FitError::PoissonRatioOutside { ratio: 1.0 }));
    let settings = ElasticModeSettings { from: 50.0, ..ElasticModeSettings::default() };
    assert!(fit_elastic_modes(&all, OUTER, &settings).is_err());
    let still = multipoles(|_, _| ModeAmplitudes::in_phase(0.0, 0.0), 1e-3);
    assert!(fit(&still).modes.iter().all(|mode| mode.share_described.is_none()));
}
