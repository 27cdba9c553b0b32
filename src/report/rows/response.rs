//! The rows of a response.

use std::f64::consts::PI;

use crate::displacement::MeasuredOn;
#[cfg(feature = "fit")]
use crate::fit::angular::{CrossoverOutcome, SlopeFit, SlopeOutcome};
use crate::observe::angular::CrossingOutcome;
use crate::observe::isostatic::{IsostaticLength, IsostaticOutcome, Scale};
use crate::observe::multipoles::{ComponentModes, MultipoleFit};
use crate::observe::penetration_length::Penetration;
#[cfg(feature = "fit")]
use crate::report::curve;
use crate::report::number::{count, significant, with_error};
use crate::report::rows::estimators::negative_powers;
use crate::report::rows::refused_of;
use crate::report::rows::section::{Rows, Section};
#[cfg(feature = "fit")]
use crate::response::Measurement;
use crate::response::{Phase, PhaseOutcome, Response, RingResponse, ShellResponse};

/// All sections of these responses; some may have no rows.
pub(crate) fn sections(responses: Vec<Option<&Response>>) -> Vec<Section> {
    vec![
        phase(responses.clone()),
        #[cfg(feature = "fit")]
        fit(responses.clone()),
        penetration(responses.clone()),
        angular(responses.clone()),
        shell(responses.clone()),
        multipoles(responses.clone()),
        contacts(responses.clone()),
        isostatic(responses),
    ]
}

/// The refused quantities of a response, with reasons.
pub(crate) fn refusals(response: &Response) -> Vec<(&'static str, &str)> {
    let found = [
        #[cfg(feature = "fit")]
        ("no fit", refused_of(&response.profile_fit)),
        ("no penetration length", refused_of(&response.penetration_lengths)),
        ("no angular correlation", refused_of(&response.angular_correlation)),
        #[cfg(feature = "fit")]
        ("no slope of the spectrum", ring(response).and_then(|ring| refused_of(&ring.slope))),
        #[cfg(feature = "fit")]
        ("no crossover of the spectrum", ring(response).and_then(|ring| refused_of(&ring.crossover))),
        ("no correlation on a shell", refused_of(&response.shell_correlation)),
        #[cfg(feature = "fit")]
        ("no slope of the spectrum", shell_of(response).and_then(|shell| refused_of(&shell.slope))),
        #[cfg(feature = "fit")]
        ("no crossover of the spectrum", shell_of(response).and_then(|shell| refused_of(&shell.crossover))),
        ("no radial dependence", refused_of(&response.radial_dependence)),
        ("no angular modes", refused_of(&response.multipoles)),
        #[cfg(feature = "fit")]
        ("no elastic modes", refused_of(&response.elastic_modes)),
        ("no isostatic length", refused_of(&response.isostatic_length)),
    ];
    found.into_iter().filter_map(|(what, reason)| Some((what, reason?))).collect()
}

/// A phase in a word.
pub(crate) fn outcome_name(outcome: PhaseOutcome) -> &'static str {
    match outcome {
        PhaseOutcome::Unjammed => "unjammed",
        PhaseOutcome::Plastic => "plastic",
        PhaseOutcome::Quasielastic => "quasielastic",
        PhaseOutcome::Undecided => "undecided",
        PhaseOutcome::NotAtRest => "not at rest",
    }
}

fn phase(responses: Vec<Option<&Response>>) -> Section {
    let name = |phase: Option<Phase>| {
        phase.map(|phase| match phase {
            Phase::Plastic => "plastic".into(),
            Phase::Quasielastic => "quasielastic".into(),
        })
    };
    let mut rows = Rows::new(responses);
    rows.add("phase", |it| Some(outcome_name(it.phase.outcome).into()))
        .add("by the radial profile", |it| name(it.phase.by_profile))
        .add("by the sign of Δp", |it| name(it.phase.by_pressure_change))
        .add("by the angular spectrum", |it| name(it.phase.by_spectrum))
        .add("by the contacts changed", |it| name(it.phase.by_contact_changes));
    rows.section("Phase")
}

fn penetration(responses: Vec<Option<&Response>>) -> Section {
    let lengths = |it: &Response| it.penetration_lengths.as_ref()?.measured().cloned();
    let mut thresholds: Vec<f64> = Vec::new();
    for length in responses.iter().flatten().filter_map(|it| lengths(it)).flatten() {
        if !thresholds.contains(&length.threshold) {
            thresholds.push(length.threshold);
        }
    }
    let mut rows = Rows::new(responses);
    for threshold in thresholds {
        rows.add(format!("ξ, |⟨d_r⟩| = {} [length]", significant(threshold, 1)), |it| {
            // In a jammed packing displacements extend to the rim.
            if it.measured_on == MeasuredOn::Backbone {
                return None;
            }
            Some(match lengths(it)?.into_iter().find(|length| length.threshold == threshold)?.penetration {
                Penetration::FallsAt { radius, .. } => significant(radius, 4),
                Penetration::NeverAbove { .. } => "nowhere".into(),
                Penetration::ReachesRim { .. } => "to the rim".into(),
            })
        });
    }
    rows.section("Penetration length")
}

fn ring(response: &Response) -> Option<&RingResponse> {
    response.angular_correlation.as_ref()?.measured()
}

fn angular(responses: Vec<Option<&Response>>) -> Section {
    let mut thresholds: Vec<f64> = Vec::new();
    for crossing in responses.iter().flatten().filter_map(|it| ring(it)).flat_map(|ring| &ring.correlation.crossings) {
        if !thresholds.contains(&crossing.threshold) {
            thresholds.push(crossing.threshold);
        }
    }
    let mut rows = Rows::new(responses);
    rows.add("ring, r/R", |it| Some(significant(ring(it)?.relative_radius, 3)))
        .add("disks in the ring", |it| Some(count(ring(it)?.spectrum.disk_count)))
        .add("negative S(f), number of f", |it| {
            let [negative, all] = negative_powers(ring(it)?)?;
            Some(format!("{negative} of {all}"))
        })
        .add("G* = −G(π)", |it| {
            let value = ring(it)?.correlation.anticorrelation;
            value.is_finite().then(|| significant(value, 3))
        });
    for threshold in thresholds {
        rows.add(format!("θ*/π, G = {}", significant(threshold, 2)), |it| {
            let crossings = &ring(it)?.correlation.crossings;
            Some(match crossings.iter().find(|crossing| crossing.threshold == threshold)?.outcome {
                CrossingOutcome::At { angle } => significant(angle / PI, 3),
                CrossingOutcome::Never { .. } => "never".into(),
                CrossingOutcome::NoCorrelation => "no variance".into(),
                CrossingOutcome::OutOfRange { farthest } => format!("none: G {}", significant(farthest, 2)),
            })
        });
    }
    #[cfg(feature = "fit")]
    fitted(
        &mut rows,
        |it| ring(it)?.slope.as_ref()?.measured().copied(),
        |it| ring(it)?.crossover.as_ref()?.measured().map(|fit| fit.outcome),
        ["slope of S(f) ∝ f^(−s), s", "range of f fitted", "crossover, f†", "θ†/π = k/(π f†)"],
    );
    rows.section("Angular correlation of d_r")
}

fn shell_of(response: &Response) -> Option<&ShellResponse> {
    response.shell_correlation.as_ref()?.measured()
}

fn shell(responses: Vec<Option<&Response>>) -> Section {
    let mut thresholds: Vec<f64> = Vec::new();
    let shells = responses.iter().flatten().filter_map(|it| shell_of(it));
    for crossing in shells.flat_map(|shell| &shell.analysis.correlation.crossings) {
        if !thresholds.contains(&crossing.threshold) {
            thresholds.push(crossing.threshold);
        }
    }
    let mut rows = Rows::new(responses);
    rows.add("shell, r/R", |it| Some(significant(shell_of(it)?.analysis.relative_radius, 3)))
        .add("spheres in the shell", |it| Some(count(shell_of(it)?.analysis.disk_count)))
        .add("negative S(ℓ), number of ℓ", |it| {
            let spectrum = &shell_of(it)?.analysis.spectrum;
            (spectrum.negative_count > 0).then(|| format!("{} of {}", spectrum.negative_count, spectrum.degree_limit()))
        })
        .add("G* = −G(π)", |it| {
            let found = shell_of(it)?.analysis.correlation.anticorrelation?;
            Some(match found.standard_error {
                Some(error) => with_error(found.value, error),
                None => significant(found.value, 3),
            })
        });
    for threshold in thresholds {
        rows.add(format!("γ*/π, G = {}", significant(threshold, 2)), |it| {
            let crossings = &shell_of(it)?.analysis.correlation.crossings;
            let crossing = *crossings.iter().find(|crossing| crossing.threshold == threshold)?;
            Some(match (crossing.outcome, crossing.standard_error) {
                (CrossingOutcome::At { angle }, Some(error)) => with_error(angle / PI, error / PI),
                (CrossingOutcome::At { angle }, None) => significant(angle / PI, 3),
                (CrossingOutcome::Never { .. }, _) => "never".into(),
                (CrossingOutcome::NoCorrelation, _) => "no variance".into(),
                (CrossingOutcome::OutOfRange { farthest }, _) => format!("none: G {}", significant(farthest, 2)),
            })
        });
    }
    #[cfg(feature = "fit")]
    fitted(
        &mut rows,
        |it| shell_of(it)?.slope.as_ref()?.measured().copied(),
        |it| shell_of(it)?.crossover.as_ref()?.measured().map(|fit| fit.outcome),
        ["slope of S(ℓ) ∝ ℓ^(−s), s", "range of ℓ fitted", "crossover, ℓ†", "γ†/π = k/(π ℓ†)"],
    );
    rows.section("Correlation of d_r on a shell")
}

/// Rows of slope and crossover, with these labels.
#[cfg(feature = "fit")]
fn fitted(
    rows: &mut Rows<'_, Response>,
    slope: impl Fn(&Response) -> Option<SlopeFit>,
    crossover: impl Fn(&Response) -> Option<CrossoverOutcome>,
    [of_slope, of_window, of_crossover, of_angle]: [&str; 4],
) {
    let window = |[from, to]: [usize; 2]| format!("{from} … {to}");
    rows.add(of_slope, |it| {
        let fit = slope(it)?;
        let estimate = fit.exponent.estimate().map(|it| with_error(it.value, it.standard_error));
        Some(match fit.outcome {
            SlopeOutcome::Undetermined => "not determined".into(),
            _ => estimate.unwrap_or_else(|| significant(fit.exponent.best, 3)),
        })
    })
    .add(of_window, |it| slope(it).map(|fit| window(fit.window)))
    .add(of_crossover, |it| {
        Some(match crossover(it)? {
            CrossoverOutcome::Found { crossover, .. } => match crossover.estimate() {
                Some(estimate) => with_error(estimate.value, estimate.standard_error),
                None => significant(crossover.best, 3),
            },
            CrossoverOutcome::ScaleFree { largest, .. } => format!("scale-free, < {}", significant(largest, 2)),
            CrossoverOutcome::White { smallest, .. } => format!("flat, > {}", significant(smallest, 2)),
            CrossoverOutcome::Undetermined => "not determined".into(),
        })
    })
    .add(of_angle, |it| match crossover(it)? {
        CrossoverOutcome::Found { angle, .. } => Some(significant(angle.best / PI, 3)),
        _ => None,
    });
}

/// Modes of d_r in the ring nearest to half the outer radius.
fn half_way(response: &Response) -> Option<&ComponentModes> {
    let half = 0.5 * response.detail.radii()[1];
    let rings = response.multipoles.as_ref()?.measured()?.rings.iter();
    let fitted = rings.filter_map(|ring| match &ring.fit {
        MultipoleFit::Fitted { radial, .. } => Some((ring.radius, radial)),
        _ => None,
    });
    fitted.min_by(|a, b| (a.0 - half).abs().total_cmp(&(b.0 - half).abs())).map(|(_, modes)| modes)
}

fn multipoles(responses: Vec<Option<&Response>>) -> Section {
    let share = |it: &Response, place: usize| Some(significant(half_way(it)?.shares?[place], 3));
    let mut rows = Rows::new(responses);
    rows.add("share of d_r² in n = 0, r/R = 1/2", |it| share(it, 0))
        .add("share in n = 1, dipole", |it| share(it, 1))
        .add("share in n = 2, quadrupole", |it| share(it, 2))
        .add("share in all other modes", |it| share(it, 3));
    #[cfg(feature = "fit")]
    elastic_modes(&mut rows);
    rows.section("Angular modes")
}

#[cfg(feature = "fit")]
fn elastic_modes(rows: &mut Rows<'_, Response>) {
    let fit = |it: &Response| it.elastic_modes.as_ref()?.measured().cloned();
    for (mode, label) in ["n = 0, share described by elasticity", "n = 1, share described", "n = 2, share described"]
        .into_iter()
        .enumerate()
    {
        rows.add(label, |it| {
            let share = fit(it)?.modes.iter().find(|fit| fit.mode == mode)?.share_described?;
            Some(significant(share, 3))
        });
    }
    rows.add("Poisson's ratio of this fit, ν (2d)", |it| {
        let fit = fit(it)?;
        Some(match fit.poisson_estimate() {
            Some(estimate) => with_error(estimate.value, estimate.standard_error),
            None => "not determined".into(),
        })
    });
}

fn contacts(responses: Vec<Option<&Response>>) -> Section {
    let mut rows = Rows::new(responses);
    let summary = |it: &Response| it.contact_changes.as_ref().map(|summary| (summary.inflation, summary.deflation));
    rows.add("kept", |it| Some(count(summary(it)?.0.kept_count)))
        .add("made, broken", |it| {
            let (inflation, _) = summary(it)?;
            Some(format!("{}, {}", count(inflation.made_count), count(inflation.broken_count)))
        })
        .add("made, broken by the deflation", |it| {
            let changes = summary(it)?.1?.changes;
            Some(format!("{}, {}", count(changes.made_count), count(changes.broken_count)))
        })
        .add("share that returns on deflation", |it| Some(significant(summary(it)?.1?.returned_share?, 3)));
    rows.section("Contacts of the backbone")
}

fn isostatic(responses: Vec<Option<&Response>>) -> Section {
    let length = |it: &Response| it.isostatic_length.as_ref()?.measured().cloned();
    let product = |it: &Response, scale: Scale| match length(it)? {
        IsostaticLength { scale: found, outcome: IsostaticOutcome::Reached { product, .. }, .. } if found == scale => {
            Some(significant(product, 3))
        }
        _ => None,
    };
    let mut rows = Rows::new(responses);
    rows.add("ΔZ before", |it| Some(significant(length(it)?.excess?, 3)))
        .add("ℓ_iso [length]", |it| {
            Some(match length(it)?.outcome {
                IsostaticOutcome::Reached { length, .. } => significant(length, 3),
                IsostaticOutcome::AboveFromTheStart { innermost } => format!("≤ {}", significant(innermost, 2)),
                IsostaticOutcome::NeverReached { .. } => "not reached".into(),
                IsostaticOutcome::NoExcess { .. } => "ΔZ ≤ 0".into(),
                IsostaticOutcome::NoBackbone => return None,
                IsostaticOutcome::TooFewRings | IsostaticOutcome::NoPlateau | IsostaticOutcome::NoScale => {
                    "none".into()
                }
            })
        })
        .add("ℓ_iso ΔZ", |it| product(it, Scale::Excess))
        .add("ℓ_iso √ΔZ", |it| product(it, Scale::RootExcess));
    rows.section("Isostatic length")
}

#[cfg(feature = "fit")]
fn fit(responses: Vec<Option<&Response>>) -> Section {
    let mut rows = Rows::new(responses);
    // A κ without significance means the elastic solution.
    let screened = |it: &Response| {
        curve::fit_of(it)?.screened.filter(|fit| fit.wavenumber.standard_error < 10.0 * fit.wavenumber.value)
    };
    let first_pole = Response::first_pole;
    let rms = |chi_squared: f64, rings: usize| significant((chi_squared / rings as f64).sqrt(), 3);
    rows.add("described by", |it| match it.profile_fit.as_ref()? {
        Measurement::Measured(fit) => Some(decision_name(fit.decision).into()),
        Measurement::Refused(_) => Some("fit refused".into()),
    })
    .add("rings fitted", |it| curve::fit_of(it).map(|fit| count(fit.ring_count)))
    .add("elastic: d_0^eff [length]", |it| {
        curve::fit_of(it).map(|fit| with_error(fit.elastic.amplitude.value, fit.elastic.amplitude.standard_error))
    })
    .add("elastic: κ below (95 %) [1/length]", |it| {
        let bound = curve::fit_of(it)?.elastic.wavenumber_bound;
        Some(bound.map_or_else(|| "no bound".into(), |bound| significant(bound, 2)))
    })
    .add("elastic: κ/κ_1 below (95 %)", |it| {
        Some(significant(curve::fit_of(it)?.elastic.wavenumber_bound? / first_pole(it)?, 2))
    })
    .add("elastic: share described", |it| curve::fit_of(it).map(|fit| significant(fit.elastic.share_described, 3)))
    .add("elastic: rms residual / ring error", |it| {
        curve::fit_of(it).map(|fit| rms(fit.elastic.chi_squared, fit.ring_count))
    })
    .add("screened: d_0^eff [length]", |it| {
        screened(it).map(|fit| with_error(fit.amplitude.value, fit.amplitude.standard_error))
    })
    .add("screened: κ [1/length]", |it| {
        screened(it).map(|fit| with_error(fit.wavenumber.value, fit.wavenumber.standard_error))
    })
    .add("screened: κ/κ_1", |it| {
        let (kappa, first) = (screened(it)?.wavenumber, first_pole(it)?);
        Some(with_error(kappa.value / first, kappa.standard_error / first))
    })
    .add("screened: share described", |it| screened(it).map(|fit| significant(fit.share_described, 3)))
    .add("screened: rms residual / ring error", |it| {
        Some(rms(screened(it)?.chi_squared, curve::fit_of(it)?.ring_count))
    })
    .add("probability of this gain if κ = 0", |it| screened(it).map(|fit| significant(fit.chance_of_elastic, 2)));
    rows.section("Fit of the radial profile")
}

/// The solution that describes a profile, in a word.
#[cfg(feature = "fit")]
pub(crate) fn decision_name(decision: crate::fit::profile::Decision) -> &'static str {
    use crate::fit::profile::Decision;
    match decision {
        Decision::Elastic => "elastic",
        Decision::Screened => "screened",
        Decision::Neither => "neither",
    }
}

/// κ with its error, or its upper bound.
#[cfg(all(feature = "fit", feature = "plot"))]
pub(crate) fn wavenumber(fit: &crate::fit::profile::ProfileFit) -> Option<String> {
    use crate::fit::profile::Decision;
    use crate::report::number::with_error;
    match fit.decision {
        Decision::Elastic => Some(match fit.elastic.wavenumber_bound {
            Some(bound) => format!("< {} (95 %)", significant(bound, 2)),
            None => "no bound found".into(),
        }),
        Decision::Screened => fit.screened.map(|fit| with_error(fit.wavenumber.value, fit.wavenumber.standard_error)),
        Decision::Neither => None,
    }
}
