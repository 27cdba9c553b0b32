//! [`sentences`]: how each observable of a report was estimated.

use crate::observe::angular::{CorrelationEstimator, Leakage, RingOutcome, SpectrumEstimator, Weights};
use crate::response::{Response, RingResponse};

/// One sentence per observable and estimator, each once, for the observables that these responses have.
pub(crate) fn sentences<'a>(responses: impl Iterator<Item = &'a Response>) -> Vec<String> {
    let mut all: Vec<String> = Vec::new();
    for response in responses {
        for sentence in of(response) {
            if !all.contains(&sentence) {
                all.push(sentence);
            }
        }
    }
    all
}

fn of(response: &Response) -> Vec<String> {
    let mut all = Vec::new();
    if response.radial_profile.is_some() {
        all.push(
            "⟨d_r⟩(r): mean over the n disks of a ring; its standard error is s/√n with s² = Σ (d_r − ⟨d_r⟩)²/(n − 1)."
                .into(),
        );
    }
    if response.penetration_lengths.is_some() {
        all.push("ξ: outermost crossing of the threshold by |⟨d_r⟩|, interpolated exponentially between rings.".into());
    }
    #[cfg(feature = "fit")]
    all.extend(of_fits(response));
    let ring = response.angular_correlation.as_ref().and_then(|it| it.measured());
    all.extend(ring.into_iter().flat_map(|ring| of_ring(&ring.spectrum.estimator, &ring.correlation.estimator)));
    if response.shell_correlation.as_ref().is_some_and(|it| it.measured().is_some()) {
        all.extend([
            "S(ℓ): squares of harmonic sums over the spheres of a shell, mean over 2ℓ+1 orders, leakage between degrees and the noise of single \
             spheres removed. Single powers of this estimator may be negative."
                .into(),
            "G(γ): all pairs of spheres in bins of their great-circle angle; G* from the pairs near γ = π; γ* interpolated linearly between bins; \
             standard errors by the jackknife."
                .into(),
        ]);
    }
    let rings = response.radial_dependence.as_ref().and_then(|it| it.measured());
    all.extend(rings.into_iter().flatten().flat_map(|ring| match &ring.outcome {
        RingOutcome::Measured { spectrum, correlation } => {
            of_ring(&spectrum.estimator, &correlation.estimator).to_vec()
        }
        _ => Vec::new(),
    }));
    if response.multipoles.as_ref().is_some_and(|it| it.measured().is_some()) {
        all.push("Angular modes: least squares at the angles of the disks of a ring.".into());
    }
    if response.isostatic_length.as_ref().is_some_and(|it| it.measured().is_some()) {
        all.push(
            "ℓ_iso: first crossing of the threshold by h_∥, interpolated linearly between rings; h_∥² = Σ (d_∥ − ⟨d_∥⟩)²/(n − 1) over the n \
             bonds of a ring."
                .into(),
        );
    }
    all
}

#[cfg(feature = "fit")]
fn of_fits(response: &Response) -> Vec<String> {
    let mut all = Vec::new();
    if response.profile_fit.as_ref().is_some_and(|it| it.measured().is_some()) {
        all.push(
            "d_0^eff, κ: least squares of r⟨d_r⟩ over rings, weighted with errors that are moderated by the pooled variance; decision by an F \
             test."
                .into(),
        );
    }
    let ring = response.angular_correlation.as_ref().and_then(|it| it.measured());
    let has_fit = |ring: &RingResponse| {
        let (slope, crossover) = (ring.slope.as_ref(), ring.crossover.as_ref());
        slope.is_some_and(|it| it.measured().is_some()) || crossover.is_some_and(|it| it.measured().is_some())
    };
    if ring.is_some_and(has_fit) {
        all.push("s, f†: maximum of Whittle's likelihood of the powers with gaps as weights.".into());
    }
    all
}

fn of_ring(spectrum: &SpectrumEstimator, correlation: &CorrelationEstimator) -> [String; 3] {
    let (of_correlation, of_crossing) = match correlation {
        CorrelationEstimator::Spectral(settings) if settings.estimator == *spectrum => {
            ("cosine sum of the powers of this spectrum".into(), "by bisection of the cosine sum")
        }
        CorrelationEstimator::Spectral(settings) => {
            (format!("cosine sum of a spectrum by {}", by(&settings.estimator)), "by bisection of the cosine sum")
        }
        CorrelationEstimator::Pairs { bin_count } => {
            (format!("all pairs of disks in {bin_count} bins of their angle"), "interpolated linearly between bins")
        }
    };
    let may_be_negative = match spectrum {
        SpectrumEstimator::Direct { leakage: Leakage::Removed, .. } => {
            " Single powers of this estimator may be negative."
        }
        _ => "",
    };
    [
        format!("S(f): {}.{may_be_negative}", by(spectrum)),
        format!("G(θ): {of_correlation}; G* = −G(π)."),
        format!("θ*: first angle at which G falls to the threshold, {of_crossing}."),
    ]
}

fn by(estimator: &SpectrumEstimator) -> String {
    match estimator {
        SpectrumEstimator::Direct { weights, leakage } => {
            let weights = match weights {
                Weights::Equal => "equal weights",
                Weights::Gaps => "the gaps between neighbours as weights",
            };
            let leakage = match leakage {
                Leakage::Kept => "leakage between frequencies kept",
                Leakage::Removed => "leakage between frequencies removed",
            };
            format!("Fourier sums at the angles of the disks, {weights}, {leakage}")
        }
        SpectrumEstimator::Interpolated { points_per_disk } => {
            format!("linear interpolation at {points_per_disk} even points per disk, then a Fourier transform")
        }
        SpectrumEstimator::Binned { bins_per_disk } => {
            format!("means in {bins_per_disk} bins per disk, then a Fourier transform")
        }
    }
}

/// Number of powers below 0 and of all powers from f = 1, if some are below 0.
pub(crate) fn negative_powers(ring: &RingResponse) -> Option<[usize; 2]> {
    let powers = ring.spectrum.power.get(1..)?;
    let negative = powers.iter().filter(|&&power| power < 0.0).count();
    (negative > 0).then_some([negative, powers.len()])
}
