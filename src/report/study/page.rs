//! [`study_page`]: the report of a study on one self-contained page.

use std::fmt::Write as _;

use crate::fit::ensemble::{BootstrapInterval, DivergenceOutcome};
use crate::report::figures::{Figure, escaped};
use crate::report::number::{count, significant, with_error};
use crate::report::page::{head, pictures};
use crate::report::study::angular;
use crate::report::study::figure_data::Subject;
use crate::report::study::lengths;
use crate::report::study::order_parameters;
use crate::report::study::order_parameters::Abscissa;
use crate::report::study::radial;
use crate::report::study::scaling;
use crate::study::{CellStatistics, Merged, NumberStatistics, PhaseCounts};
use crate::transition::{
    CellSpectrum, Comparison, ExponentOutcome, LEAST_CELLS, LEAST_SAMPLES, Sampled, Series, Transition,
    TransitionPressure, Verdict, words,
};

/// The page of a study. Two merges of the same samples give the same bytes.
pub fn study_page(merged: &Merged, transition: &Transition) -> String {
    let subject = Subject { merged, transition };
    let mut html = head("jamscope: study", "Response to an inflation, statistics over samples", &introduction(merged));
    for (title, text, figures) in views(&subject) {
        if !figures.is_empty() {
            let _ = write!(
                html,
                "<section aria-label=\"{title}\">\n<h2>{title}</h2>\n<p class=\"facts\">{text}</p>\n{}</section>\n",
                pictures(figures)
            );
        }
    }
    html.push_str(&estimates(&subject));
    html.push_str(&slopes(transition));
    html.push_str(&divergences(transition));
    html.push_str(&exponents(&subject));
    html.push_str(&comparisons(transition));
    html.push_str(&cells(&subject));
    let _ = write!(
        html,
        "</main>\n<footer>\n<p>jamscope {}. Lengths in diameters of a small disk. Intervals are 95 % bootstrap intervals over the samples of every \
         cell. Data: <a href=\"summary.csv\">summary.csv</a>, <a href=\"summary.json\">summary.json</a>, \
         <a href=\"transition.csv\">transition.csv</a>, <a href=\"transition.json\">transition.json</a>, \
         <a href=\"records.jsonl\">records.jsonl</a>.</p>\n</footer>\n</body>\n</html>\n",
        env!("CARGO_PKG_VERSION")
    );
    html
}

/// All possible figures: heading, description, figures.
fn views(subject: &Subject<'_>) -> Vec<(&'static str, &'static str, Vec<Figure>)> {
    let mut order = order_parameters::against(subject, Abscissa::Reduced);
    order.extend(order_parameters::against(subject, Abscissa::Pressure));
    let hertzian = subject.transition.series.iter().all(|series| crate::transition::beta(&series.cell.law) == 3.0);
    let as_hertzian = if hertzian { Vec::new() } else { order_parameters::against(subject, Abscissa::AsHertzian) };
    let mut profiles = radial::singles(subject);
    profiles.extend(radial::means(subject));
    let thresholds =
        ["0.02", "0.05", "0.2"].into_iter().filter_map(|it| order_parameters::threshold(subject, it)).collect();
    let is_plane = subject.spreading_dimension() == 2;
    let mut scaled = if is_plane { scaling::with_inflation(subject) } else { Vec::new() };
    scaled.extend(if is_plane { scaling::phase_diagram(subject) } else { Vec::new() });
    vec![
        (
            "Radial profiles",
            "Single samples with the better of the two solutions, elastic or screened. Neither describes means over samples.",
            profiles,
        ),
        (
            "Screening and pressure change",
            "κ of the best screened solution over κ₁, its first pole, and the change of pressure. Every pale point is one sample.",
            order_parameters::by_sample(subject),
        ),
        (
            "Angular correlation and spectrum",
            if is_plane {
                "Means over samples. A spectrum ∼ f^(−1.5) has no scale; below the transition, Lorentzians are fitted."
            } else {
                "Means over samples: G(γ) over the angle between two spheres of the shell, and the power S(ℓ) of its spherical harmonics."
            },
            angular::functions(subject),
        ),
        (
            "Order parameter and correlation angle",
            if is_plane {
                "G* = −G(π), θ* where G = 0.1, and θ† = k/f† (hollow symbols). Series are named by their number of disks, and by law and d₀ if these differ."
            } else {
                "G* = −G(π) and γ* where G = 0.1. Series are named by their number of spheres, and by law, d₀ and relaxer if these differ."
            },
            order,
        ),
        (
            "Crossover",
            "θ† = k/f† of the fitted Lorentzians, and θ* with its exact value for a Lorentzian spectrum.",
            order_parameters::crossovers(subject),
        ),
        ("Against p N^(3/2)", "The scaling of Hertzian disks, which Hookean disks do not follow.", as_hertzian),
        ("Thresholds", "The correlation angle with other thresholds of G.", thresholds),
        (
            "Spectrum by distance",
            "For every series, in the cell whose slope is nearest to 1.5.",
            angular::by_radius(subject),
        ),
        (
            "Screening and isostatic length",
            "ℓ_s = 1/κ of the screened samples; ℓ_iso is the distance beyond which the fluctuation of bonds is that of a continuum.",
            lengths::matching(subject),
        ),
        (
            "Fluctuations",
            "Fluctuations of the stretching of bonds and of displacements at one distance, divided by their value next to the inflated disk or sphere.",
            lengths::fluctuations(subject),
        ),
        ("Inflations", "Axes rescaled with N, d₀ and the published exponents.", scaled),
        (
            "Contact changes",
            "Contacts made and broken by the inflation, and the share of them that return on deflation.",
            radial::contacts(subject),
        ),
        ("Periodic box", "No rim is held; the centre of mass stays.", radial::modes(subject)),
        ("Below jamming", "How far displacements extend from the inflated disk.", lengths::jamming(subject)),
    ]
}

fn introduction(merged: &Merged) -> String {
    let failed: usize = merged.cells.iter().flat_map(|cell| cell.failures.values()).sum();
    let left_out = match failed {
        0 => String::new(),
        failed => format!(" {failed} of them failed and are left out of the statistics; the table of cells says why."),
    };
    let missing = merged.sample_count - merged.record_count;
    let missing = match missing {
        0 => String::new(),
        missing => format!(" {} samples of the plan are missing.", count(missing)),
    };
    let mixed = merged.mixed_vectors().map_or(String::new(), |mixed| format!(" Note: {}.", escaped(&mixed)));
    format!("{} samples in {} cells.{left_out}{missing}{mixed}", count(merged.record_count), merged.cells.len())
}

/// A table with a header; the first column is left-aligned.
fn table(title: &str, text: &str, heads: &[&str], rows: &[Vec<String>]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let mut html = format!(
        "<section aria-label=\"{title}\">\n<h2>{title}</h2>\n<p class=\"facts\">{text}</p>\n<div class=\"table\">\n<table>\n<thead>\n<tr>"
    );
    for head in heads {
        let _ = write!(html, "<th scope=\"col\">{head}</th>");
    }
    html.push_str("</tr>\n</thead>\n<tbody>\n");
    for row in rows {
        let cells: String = row
            .iter()
            .enumerate()
            .map(|(place, text)| match place {
                0 => format!("<th scope=\"row\">{}</th>", escaped(text)),
                _ => format!("<td>{}</td>", escaped(text)),
            })
            .collect();
        let _ = writeln!(html, "<tr>{cells}</tr>");
    }
    html + "</tbody>\n</table>\n</div>\n</section>\n"
}

fn ends([low, high]: [f64; 2]) -> String {
    format!("{} to {}", significant(low, 3), significant(high, 3))
}

fn interval(found: &BootstrapInterval) -> String {
    let ends = found.interval.map_or("no interval".into(), ends);
    format!("{} ({ends})", significant(found.best, 3))
}

/// A transition pressure in words.
pub(super) fn pressure(found: TransitionPressure) -> String {
    match found {
        TransitionPressure::Found(found) => interval(&found),
        TransitionPressure::Between(between) => format!("between {}", ends(between).replace(" to ", " and ")),
        TransitionPressure::Above(highest) => format!("above {}", significant(highest, 2)),
        TransitionPressure::Below(lowest) => format!("below {}", significant(lowest, 2)),
        TransitionPressure::Unordered => "no single transition".into(),
        TransitionPressure::Uninformative { reason } => format!("cannot tell: {}", reason.words()),
    }
}

/// p̂_c of every series by every method.
fn estimates(subject: &Subject<'_>) -> String {
    let transition = subject.transition;
    let mut rows = Vec::new();
    for series in &transition.series {
        for estimate in &series.estimates {
            rows.push(vec![series.name(), estimate.method.name().into(), pressure(estimate.pressure)]);
        }
        if let Some(at) = &series.at_transition {
            let mut row = |name: &str, found: Option<Sampled>| {
                rows.extend(found.map(|it| vec![series.name(), name.into(), interval(&it.found)]));
            };
            row("G* at p̂_c by the slope", at.anticorrelation);
            row("θ* at p̂_c by the slope (rad)", at.angle);
        }
    }
    let by_angle = match subject.spreading_dimension() {
        2 => {
            " G*, θ*, slope: where the mean passes its value for S ∼ f^(−1.5). f†: where it falls below 0.1, so that S(f) is a power law from f = 1 on."
        }
        _ => "",
    };
    let text = format!(
        "κ and Δp: where half of the samples have κ above κ₁/2, or Δp below zero.{by_angle} A cell needs at least {LEAST_SAMPLES} samples."
    );
    table("Transition pressure p̂_c", &text, &["Series", "By", "p̂_c or value (interval)"], &rows)
}

/// Both slopes of the mean spectrum of every cell.
fn slopes(transition: &Transition) -> String {
    let or_none = |found: Option<BootstrapInterval>| found.map_or("none".into(), |found| interval(&found));
    let of_series = |series: &Series| {
        let row = |it: &CellSpectrum| {
            let (at, count) = (significant(it.point.reduced_pressure, 2), it.point.sample_count.to_string());
            vec![series.name(), at, count, or_none(it.slope), or_none(it.likelihood_slope)]
        };
        series.spectra.iter().map(row).collect::<Vec<_>>()
    };
    let rows: Vec<Vec<String>> = transition.series.iter().flat_map(of_series).collect();
    let text = "s of S ∼ f^(−s), f from 2 to 24, by least squares in logarithms and by maximum likelihood. Both give every f the same weight where the powers lie near the line. \
                A power far above the line, such as a strong f = 2, changes the likelihood estimate more. A power far below the line, such as at high f after the removal of leakage, changes least squares more. \
                If they differ by more than their intervals, the spectrum has no single slope.";
    table(
        "Slope of S(f)",
        text,
        &["Series", "p̂", "Samples", "Least squares (interval)", "Likelihood (interval)"],
        &rows,
    )
}

/// μ of θ† of every series, or the number of cells available and required.
fn divergences(transition: &Transition) -> String {
    let missing = |count: usize| format!("not fitted: {count} of {LEAST_CELLS} cells");
    let row = |series: &Series| {
        let found = &series.divergence;
        let given = match &found.at_transition {
            Some(fit) => with_error(fit.exponent.value, fit.exponent.standard_error),
            None if found.below_count < LEAST_CELLS => missing(found.below_count),
            None => "no fit".into(),
        };
        let free = match &found.free {
            Some(DivergenceOutcome::Found(fit)) => {
                let at = significant(fit.critical.best, 2);
                format!("{}, p̂_c = {at}", with_error(fit.exponent.value, fit.exponent.standard_error))
            }
            Some(DivergenceOutcome::Unbounded { .. }) => "p̂_c unbounded".into(),
            Some(DivergenceOutcome::AtLastPoint { .. }) => "p̂_c at the last cell".into(),
            None if found.point_count < LEAST_CELLS => missing(found.point_count),
            None => "no fit".into(),
        };
        vec![series.name(), found.point_count.to_string(), found.below_count.to_string(), given, free]
    };
    let with_spectra = transition.series.iter().filter(|series| !series.spectra.is_empty());
    let rows: Vec<Vec<String>> = with_spectra.map(row).collect();
    let text = format!(
        "μ of θ† ∼ (p̂_c − p̂)^(−μ), with p̂_c by the slope (least squares) or fitted. Three numbers are fitted, so {LEAST_CELLS} cells are needed."
    );
    let heads = ["Series", "Cells with θ†", "Below p̂_c", "μ, p̂_c given", "μ, p̂_c fitted"];
    table("Divergence of θ†", &text, &heads, &rows)
}

fn exponents(subject: &Subject<'_>) -> String {
    let transition = subject.transition;
    let outcome = |outcome: Option<ExponentOutcome>| match outcome {
        None => String::new(),
        Some(ExponentOutcome::Found(found)) => interval(&found),
        Some(ExponentOutcome::AtEdge(edge)) => format!("none up to {}", significant(edge, 2)),
        Some(ExponentOutcome::NoOverlap) => "no overlap".into(),
    };
    let quality = |found: Option<crate::fit::ensemble::CollapseQuality>| {
        found.map_or(String::new(), |it| {
            format!("{} ({} of {})", significant(it.quality, 2), it.point_count, it.of_count)
        })
    };
    let rows: Vec<Vec<String>> = transition
        .scaling
        .iter()
        .map(|one| {
            vec![
                format!("{}, {}, {} curves", one.law.name(), one.relaxer.description(), one.curve_count),
                words(one.observable, subject.angle()),
                outcome(one.size_exponent),
                outcome(one.inflation_exponent),
                quality(one.quality),
                quality(one.published_quality),
            ]
        })
        .collect();
    let text = "Exponents a and b with which the curves against p N^a d₀^(−b) collapse onto one curve. S is 1 if the curves agree within their errors; the number of points used is in brackets.";
    let heads = ["Law and relaxer", "Of", "a", "b", "S, best exponents", "S, exponents of the theory"];
    table("Collapse", text, &heads, &rows)
}

fn comparisons(transition: &Transition) -> String {
    let row = |one: &Comparison| {
        let value = match (one.value, one.verdict) {
            (Some(value), _) => significant(value, 3),
            (None, Verdict::Uninformative) => "none".into(),
            (None, _) => "only a bound".into(),
        };
        vec![
            one.quantity.clone(),
            one.of.clone(),
            value,
            one.interval.map_or(String::new(), ends),
            significant(one.published, 3),
            verdict(one),
        ]
    };
    let rows: Vec<Vec<String>> = transition.comparisons.iter().map(row).collect();
    let heads = ["Quantity", "Of", "Found", "Interval", "Published", ""];
    let text = format!(
        "A published value agrees if it lies in the interval; otherwise its distance is given in half widths of the interval. There is no verdict without an interval, from cells of fewer \
         than {LEAST_SAMPLES} samples, or if an interval that contains the value is too wide: for a pressure wider than a factor of 10, for any other number wider than the published value, or than 0.1 \
         if that is larger."
    );
    table("Comparison with the literature", &text, &heads, &rows)
}

fn verdict(one: &Comparison) -> String {
    match one.verdict {
        Verdict::Agrees => "agrees".into(),
        Verdict::Differs => match (one.value, one.interval) {
            (Some(value), Some([low, high])) if high > low => {
                format!(
                    "differs by {} half widths",
                    significant((one.published - value).abs() / (0.5 * (high - low)), 2)
                )
            }
            _ => "differs".into(),
        },
        Verdict::Beyond => "beyond the range measured".into(),
        Verdict::Excluded => "excluded by the range measured".into(),
        Verdict::Uninformative => match one.reason {
            Some(reason) => format!("cannot tell: {}", reason.words()),
            None => one.verdict.name().into(),
        },
    }
}

/// Numbers of samples by phase, in the order of the column header; those not at rest if there are any.
fn phase_counts(phases: &PhaseCounts) -> String {
    let mut text = format!("{}, {}, {}, {}", phases.unjammed, phases.plastic, phases.quasielastic, phases.undecided);
    if phases.not_at_rest > 0 {
        let _ = write!(text, ", not at rest {}", phases.not_at_rest);
    }
    text
}

/// Numbers of samples of every cell, failures, and some numbers.
fn cells(subject: &Subject<'_>) -> String {
    let (merged, angle) = (subject.merged, format!("{}* (rad)", subject.angle()));
    let row = |statistics: &CellStatistics| {
        let cell = &statistics.cell;
        let (name, value) = cell.target.name_and_value();
        let number = |name: &str| statistics.numbers.get(name).map_or(String::new(), mean);
        let failures: Vec<String> =
            statistics.failures.iter().map(|(kind, count)| format!("{count} {}", kind.name())).collect();
        let phases = &statistics.phases;
        vec![
            format!(
                "{} {} {}, d_0 = {}, {}",
                cell.law.name(),
                cell.disk_count,
                cell.particles(),
                cell.increase,
                cell.relaxer.description()
            ),
            format!("{} {}", name.replace('_', " "), significant(value, 3)),
            statistics.done_count.to_string(),
            failures.join(", "),
            phase_counts(phases),
            number("pressure"),
            number("scaled_pressure_change"),
            number("anticorrelation"),
            number("correlation_angle_at_0.1"),
        ]
    };
    let rows: Vec<Vec<String>> = merged.cells.iter().map(row).collect();
    let heads = [
        "Cell",
        "Target",
        "Samples",
        "Failed",
        "Unjammed, plastic, quasielastic, undecided",
        "p",
        "Δp scaled",
        "G*",
        &angle,
    ];
    table("Cells", "Means over the samples with a result, with standard errors.", &heads, &rows)
}

fn mean(found: &NumberStatistics) -> String {
    match found.standard_error {
        Some(error) => with_error(found.mean, error),
        None => significant(found.mean, 3),
    }
}
