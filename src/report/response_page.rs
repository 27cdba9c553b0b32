//! The figures of a response, in the order in which a page shows them.

use std::f64::consts::PI;

use crate::observe::isostatic::IsostaticOutcome;
use crate::observe::shell::ShellAnalysis;
use crate::report::figures::angular::angular_figure;
use crate::report::figures::bond_map::bond_map;
use crate::report::figures::contact_map::contact_map;
use crate::report::figures::correlation::{CorrelationCurve, correlation_figure};
use crate::report::figures::heat_map::heat_map;
use crate::report::figures::isostatic::isostatic_figure;
use crate::report::figures::map::MapFrame;
use crate::report::figures::multipoles::{Component, ModeCurve, multipole_figure};
use crate::report::figures::radial::radial_figure;
use crate::report::figures::radial_dependence::radial_dependence_figure;
use crate::report::figures::shell_map::shell_map;
use crate::report::figures::slice_map::slice_map;
use crate::report::figures::spectrum::{SpectrumCurve, SpectrumPoints, spectrum_figure};
use crate::report::figures::{Around, Figure, FigureError};
use crate::report::number::significant;
use crate::response::{Response, RingResponse, ShellResponse};

/// Highest mode drawn: isotropic, dipole, quadrupole, and one more.
const HIGHEST_MODE: usize = 3;

/// The shell of the map of spheres, r/R.
const SHELL: f64 = 0.5;

/// All figures of a response; `radii` are those of the packing before the inflation.
pub(crate) fn figures(
    name: &str,
    response: &Response,
    radii: &[f64],
    frame: &MapFrame,
    heat: bool,
) -> Result<Vec<Figure>, FigureError> {
    let mut figures = Vec::new();
    let plane = response.detail.plane();
    let around = if response.detail.spreading_dimension() == 1 { Around::Row } else { Around::Ring };
    if let Some(detail) = response.detail.space().filter(|_| heat) {
        figures.push(slice_map(name, &detail.field, radii, frame));
        figures.push(shell_map(name, &detail.field, radii, SHELL));
    }
    if let Some(detail) = plane.filter(|_| heat) {
        figures.push(heat_map(name, &detail.field, radii, frame));
    }
    if let Some(profile) = &response.radial_profile {
        figures.push(radial_figure(name, response, profile)?);
    }
    if let Some(profiles) = &response.angular_profiles {
        figures.push(angular_figure(name, around, profiles)?);
    }
    if let Some(ring) = response.angular_correlation.as_ref().and_then(|it| it.measured()) {
        figures.extend(of_ring(name, around, ring)?);
    }
    if let Some(shell) = response.shell_correlation.as_ref().and_then(|it| it.measured()) {
        figures.extend(of_shell(name, shell)?);
    }
    if let Some(rings) = response.radial_dependence.as_ref().and_then(|it| it.measured()) {
        // Without a measured ring there is nothing to draw.
        figures.extend(radial_dependence_figure(name, rings).ok());
    }
    if let Some(multipoles) = response.multipoles.as_ref().and_then(|it| it.measured()) {
        #[cfg(feature = "fit")]
        let fit = response.elastic_modes.as_ref().and_then(|it| it.measured());
        // The mean over the angle has the sign of its measured value.
        #[cfg(feature = "fit")]
        let elastic = |mode: usize, radius: f64| {
            let amplitude = fit?.at(mode, radius)?.radial;
            Some(if mode == 0 { amplitude.re } else { libm::hypot(amplitude.re, amplitude.im) })
        };
        #[cfg(feature = "fit")]
        let curve: Option<ModeCurve<'_>> = fit.is_some().then_some(&elastic);
        #[cfg(not(feature = "fit"))]
        let curve: Option<ModeCurve<'_>> = None;
        figures.extend(multipole_figure(name, multipoles, Component::Radial, HIGHEST_MODE, curve).ok());
    }
    let isostatic = response.isostatic_length.as_ref().and_then(|it| it.measured());
    let bonds = plane.and_then(|detail| detail.bond_changes.as_ref());
    if let Some(bonds) = bonds.filter(|changes| !changes.bonds.is_empty()) {
        let length = isostatic.and_then(|found| match found.outcome {
            IsostaticOutcome::Reached { length, .. } => Some(length),
            _ => None,
        });
        figures.push(bond_map(name, bonds, frame, length));
    }
    let changes = plane.and_then(|detail| detail.contact_changes.as_ref());
    if let Some(changes) = changes.filter(|changes| !(changes.made.is_empty() && changes.broken.is_empty())) {
        figures.push(contact_map(name, changes, frame));
    }
    if let Some(length) = isostatic.filter(|length| !length.curve.is_empty()) {
        figures.push(isostatic_figure(name, &[("this sample", length)])?);
    }
    Ok(figures)
}

/// G(θ) and S(f); empty if the ring has no variance.
fn of_ring(name: &str, around: Around, ring: &RingResponse) -> Result<Vec<Figure>, FigureError> {
    let correlation = &ring.correlation;
    if !correlation.anticorrelation.is_finite() {
        return Ok(Vec::new());
    }
    let threshold = correlation.crossings.first();
    let mut label =
        format!("r/R = {}, G* = {}", significant(ring.relative_radius, 3), significant(correlation.anticorrelation, 2));
    if let Some(angle) = threshold.and_then(|crossing| crossing.outcome.angle()) {
        label += &format!(", θ* = {}π", significant(angle / PI, 2));
    }
    let curve = CorrelationCurve {
        label,
        angles: &correlation.angles,
        values: correlation.values.clone(),
        standard_errors: Vec::new(),
    };
    let mut figures = vec![correlation_figure(name, around, &[curve], threshold.map(|crossing| crossing.threshold))?];
    if let Some(relative) = ring.spectrum.normalised() {
        let label = format!("r/R = {}, {} disks", significant(ring.relative_radius, 3), ring.spectrum.disk_count);
        let points = SpectrumPoints { label, values: relative[1..].to_vec(), standard_errors: Vec::new() };
        figures.extend(spectrum_figure(name, around, &[points], &fitted(ring, &relative)));
    }
    Ok(figures)
}

/// G(γ) and S(ℓ) of a shell of spheres.
fn of_shell(name: &str, shell: &ShellResponse) -> Result<Vec<Figure>, FigureError> {
    let ShellAnalysis { relative_radius, disk_count, spectrum, correlation, .. } = &shell.analysis;
    let at = format!("r/R = {}, {disk_count} spheres", significant(*relative_radius, 3));
    let threshold = correlation.crossings.first();
    let mut label = at.clone();
    if let Some(anticorrelation) = &correlation.anticorrelation {
        label += &format!(", G* = {}", significant(anticorrelation.value, 2));
    }
    if let Some(angle) = threshold.and_then(|crossing| crossing.outcome.angle()) {
        label += &format!(", γ* = {}π", significant(angle / PI, 2));
    }
    let curve = CorrelationCurve {
        label,
        angles: &correlation.angles,
        values: correlation.values.clone(),
        standard_errors: correlation.standard_errors.clone(),
    };
    let threshold = threshold.map(|crossing| crossing.threshold);
    let mut figures = vec![correlation_figure(name, Around::Shell, &[curve], threshold)?];
    if let Some(relative) = spectrum.normalised() {
        let scale = spectrum.power[1];
        let errors = spectrum.standard_errors[1..].iter().map(|error| error / scale).collect();
        let points = SpectrumPoints { label: at, values: relative[1..].to_vec(), standard_errors: errors };
        figures.extend(spectrum_figure(name, Around::Shell, &[points], &[]));
    }
    Ok(figures)
}

/// The fitted power law and Lorentzian; without fits the slope −1.5 through S(1).
#[cfg(feature = "fit")]
fn fitted<'a>(ring: &'a RingResponse, relative: &'a [f64]) -> Vec<SpectrumCurve<'a>> {
    use crate::fit::angular::CrossoverOutcome;

    // The amplitude for which the mean of S over the curve is 1, as in the fit for P over its expectation.
    let scaled = |label: String, window: [usize; 2], shape: Box<dyn Fn(f64) -> f64>| {
        let [from, to] = [window[0], window[1].min(relative.len() - 1)];
        let ratios = (from..=to).map(|f| relative[f] / shape(f as f64));
        let amplitude = ratios.sum::<f64>() / (to + 1 - from) as f64;
        SpectrumCurve { label, of: Box::new(move |f| amplitude * shape(f)), window: window.map(|f| f as f64) }
    };
    let mut curves = Vec::new();
    if let Some(fit) = ring.slope.as_ref().and_then(|it| it.measured()) {
        let exponent = fit.exponent.best;
        let label = format!("f^({}), fitted", significant(-exponent, 3));
        curves.push(scaled(label, fit.window, Box::new(move |f| libm::pow(f, -exponent))));
    }
    if let Some(fit) = ring.crossover.as_ref().and_then(|it| it.measured())
        && let CrossoverOutcome::Found { crossover, .. } = fit.outcome
    {
        let (middle, exponent) = (crossover.best, fit.exponent);
        let label = format!("Lorentzian, f† = {}", significant(middle, 2));
        curves.push(scaled(label, fit.window, Box::new(move |f| 1.0 / (1.0 + libm::pow(f / middle, exponent)))));
    }
    curves.push(critical(relative));
    curves
}

#[cfg(not(feature = "fit"))]
fn fitted<'a>(_ring: &'a RingResponse, relative: &'a [f64]) -> Vec<SpectrumCurve<'a>> {
    vec![critical(relative)]
}

/// f^(−3/2), the result of the study at the transition.
fn critical(relative: &[f64]) -> SpectrumCurve<'_> {
    let window = [1.0, (relative.len() - 1) as f64];
    SpectrumCurve { label: "f^(−1.5)".into(), of: Box::new(|f| libm::pow(f, -1.5)), window }
}

/// A paragraph on the content of the figures of these responses.
pub(crate) fn legend(responses: &[&Response], heat: bool) -> String {
    let any = |has: fn(&Response) -> bool| responses.iter().any(|it| has(it));
    let mut text = String::new();
    let is_space = responses.iter().any(|it| it.detail.space().is_some());
    if heat && is_space {
        text.push_str(
            "The slice shows r²·d<sub>r</sub> of the spheres that a plane through the inflated one cuts, the oval map d<sub>r</sub> of the spheres of \
             a shell in all directions. Orange spheres move outwards, purple spheres inwards; grey spheres are rattlers. ",
        );
    } else if heat && responses.iter().any(|it| it.detail.spreading_dimension() == 1) {
        text.push_str(
            "The map shows d<sub>r</sub>, the displacement of each disk away from the line through the row, divided by a value that 98 % of the disks do \
             not exceed. Orange disks move away, purple disks towards the line; grey disks are rattlers. An angle θ stands for the place x along \
             the strip of length L, θ = 2πx/L. ",
        );
    } else if heat {
        text.push_str(
            "The map shows r·d<sub>r</sub>, the radial displacement of each disk times its distance from the centre, \
             divided by a value that 98 % of the disks do not exceed. Orange disks move outwards, purple disks inwards; grey disks are rattlers. ",
        );
    }
    if any(|it| it.radial_profile.is_some()) {
        text.push_str("The radial profile is its mean over rings, with standard errors. ");
    }
    if any(|it| !crate::report::curve::curves(it).is_empty()) {
        text.push_str(
            "It is compared with the elastic solution and with the solution screened by plastic events with wavenumber κ. The solution \
             that describes it is a solid line, the other is dashed. ",
        );
    }
    if any(|it| it.angular_profiles.is_some()) {
        text.push_str("The angular profiles show single disks in narrow rings. They are smooth where the response is elastic, and noisy where it is not. ");
    }
    if any(|it| it.angular_correlation.is_some()) {
        text.push_str(
            "G(θ) and S(f) are the correlation and the power spectrum of d<sub>r</sub> around a ring; the correlation angle θ* \
             is where G crosses the dashed line. ",
        );
    }
    if any(|it| it.shell_correlation.is_some()) {
        text.push_str(
            "G(γ) and S(ℓ) are the correlation over the great-circle angle γ and the power of the spherical harmonics of degree ℓ of \
             d<sub>r</sub> on a shell, with standard errors. ",
        );
    }
    if any(|it| it.multipoles.is_some()) {
        text.push_str(
            "Angular modes: isotropic part n = 0, dipole 1, quadrupole 2; the dashed lines are the fitted elastic modes. ",
        );
    }
    if any(|it| it.detail.plane().is_some_and(|detail| detail.bond_changes.is_some())) {
        text.push_str("The map of r·d<sub>∥</sub> shows bonds, blue stretched, red compressed, with a circle at the isostatic length. ");
    }
    if any(|it| it.detail.plane().is_some_and(|detail| detail.contact_changes.is_some())) {
        text.push_str("New contacts are red, broken contacts blue. ");
    }
    text
}
