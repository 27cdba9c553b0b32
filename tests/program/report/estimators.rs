//! How each observable was estimated, on the terminal and on the page.

use jamscope::observe::angular::{CorrelationEstimator, Leakage, SpectrumEstimator, Weights};
use jamscope::report::table::terminal_table;
use jamscope::run::{Report, run};

use super::{report, result, scene, written};

/// A spectrum whose leakage is removed may have negative powers, and the reader is told how many.
#[test]
fn the_table_and_the_page_name_the_estimators_and_negative_powers() {
    let shown = |report: &Report| {
        // Words of both, whatever the lines of the table.
        let plain = terminal_table(report).split_whitespace().collect::<Vec<_>>().join(" ");
        let page = written(report).get("report.html").map(|page| String::from_utf8(page.clone()).expect("text"));
        [Some(plain), page].into_iter().flatten().collect::<Vec<_>>()
    };
    let negative = |name: &str| {
        let response = &result(name).response;
        let ring = response.angular_correlation.as_ref().and_then(|it| it.measured()).expect("a ring");
        let powers = &ring.spectrum.power[1..];
        (powers.iter().filter(|power| **power < 0.0).count(), powers.len())
    };
    let (below, all) = [negative("loose"), negative("dense")].into_iter().max().expect("two");
    assert!(below > 0, "the seed has a negative power");
    for text in shown(report()) {
        assert_eq!(text.contains("s, f†: maximum of Whittle's likelihood"), cfg!(feature = "fit"), "{text}");
        for part in [
            "S(f): Fourier sums at the angles of the disks, the gaps between neighbours as weights, leakage between frequencies removed.",
            "Single powers of this estimator may be negative.",
            "G(θ): cosine sum of the powers of this spectrum",
            "θ*: first angle at which G falls to the threshold, by bisection",
            "h_∥² = Σ (d_∥ − ⟨d_∥⟩)²/(n − 1)",
            "negative S(f), number of f",
            &format!("{below} of {all}"),
        ] {
            assert!(text.contains(part), "no {part:?} in {text}");
        }
    }
    let mut other = scene();
    other.sample.retain(|sample| sample.name == "dense");
    let settings = other.observables.angular_correlation.as_mut().expect("by default");
    settings.spectrum.estimator = SpectrumEstimator::Direct { weights: Weights::Equal, leakage: Leakage::Kept };
    settings.correlation.estimator = CorrelationEstimator::Pairs { bin_count: 12 };
    // It has estimators of its own.
    other.observables.radial_dependence = None;
    for text in shown(&run(&other, &()).expect("the scene makes sense")) {
        for part in ["equal weights, leakage between frequencies kept", "G(θ): all pairs of disks in 12 bins"] {
            assert!(text.contains(part), "no {part:?} in {text}");
        }
        assert!(!text.contains("may be negative") && !text.contains("negative S(f)"), "{text}");
    }
}
