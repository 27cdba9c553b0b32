//! The tables of a response, one file per table.

use crate::observe::angular::RingOutcome;
use crate::observe::bond_changes::BondChanges;
use crate::observe::contact_changes::ContactChanges;
use crate::observe::multipoles::MultipoleFit;
use crate::observe::shell::ShellAnalysis;
use crate::report::csv::{Table, angular_profiles, radial_profile};
use crate::response::{Detail, Response};

/// One file of a response.
pub(crate) struct ResponseFile {
    /// The part of its name after that of the sample.
    pub ending: &'static str,
    /// Its text; none if the response does not have it.
    pub text: fn(&Response) -> Option<String>,
    /// Whether the response has it.
    has: fn(&Response) -> bool,
}

/// The files of a response.
pub(crate) fn files(response: &Response) -> impl Iterator<Item = &'static ResponseFile> {
    ALL.iter().filter(|file| (file.has)(response))
}

/// All possible endings of these files.
pub(crate) fn every_ending() -> impl Iterator<Item = &'static str> {
    ALL.iter().map(|file| file.ending)
}

const ALL: [ResponseFile; 11] = [
    ResponseFile {
        ending: "radial_profile.csv",
        has: |it| it.radial_profile.is_some(),
        text: |it| it.radial_profile.as_ref().map(|profile| radial_profile(it, profile)),
    },
    ResponseFile {
        ending: "angular_profiles.csv",
        has: |it| it.angular_profiles.is_some(),
        text: |it| it.angular_profiles.as_deref().map(angular_profiles),
    },
    ResponseFile {
        ending: "angular_correlation.csv",
        has: |it| ring(it).is_some(),
        text: |it| ring(it).map(angular_correlation),
    },
    ResponseFile {
        ending: "power_spectrum.csv",
        has: |it| ring(it).is_some(),
        text: |it| ring(it).map(power_spectrum),
    },
    ResponseFile {
        ending: "shell_correlation.csv",
        has: |it| shell(it).is_some(),
        text: |it| shell(it).map(shell_correlation),
    },
    ResponseFile {
        ending: "shell_spectrum.csv",
        has: |it| shell(it).is_some(),
        text: |it| shell(it).map(shell_spectrum),
    },
    ResponseFile {
        ending: "radial_dependence.csv",
        has: |it| it.radial_dependence.as_ref().is_some_and(|it| it.measured().is_some()),
        text: radial_dependence,
    },
    ResponseFile {
        ending: "multipoles.csv",
        has: |it| it.multipoles.as_ref().is_some_and(|it| it.measured().is_some()),
        text: multipoles,
    },
    ResponseFile { ending: "contact_changes.csv", has: |it| it.contact_changes.is_some(), text: contact_changes },
    ResponseFile { ending: "bond_changes.csv", has: has_bonds, text: bond_changes },
    ResponseFile {
        ending: "isostatic_length.csv",
        has: |it| it.isostatic_length.as_ref().is_some_and(|it| it.measured().is_some()),
        text: isostatic_length,
    },
];

fn has_bonds(response: &Response) -> bool {
    match &response.detail {
        Detail::Plane(detail) => detail.bond_changes.is_some(),
        Detail::Space(detail) => detail.bond_changes.is_some(),
    }
}

fn ring(response: &Response) -> Option<&crate::response::RingResponse> {
    response.angular_correlation.as_ref()?.measured()
}

fn shell(response: &Response) -> Option<&ShellAnalysis> {
    Some(&response.shell_correlation.as_ref()?.measured()?.analysis)
}

/// G(γ) of spheres: one row per bin of angles.
fn shell_correlation(shell: &ShellAnalysis) -> String {
    let mut table = Table::new(&[("angle", "rad"), ("correlation", "1"), ("standard_error", "1"), ("pair_count", "1")]);
    let of = &shell.correlation;
    for (place, &angle) in of.angles.iter().enumerate() {
        table.row([angle, of.values[place], of.standard_errors[place], of.pair_counts[place] as f64]);
    }
    table.text()
}

/// S(ℓ) of spheres: one row per degree from 1.
fn shell_spectrum(shell: &ShellAnalysis) -> String {
    let mut table = Table::new(&[("degree", "1"), ("power", "length^2"), ("standard_error", "length^2")]);
    let of = &shell.spectrum;
    for degree in 1..of.power.len() {
        table.row([degree as f64, of.power[degree], of.standard_errors[degree]]);
    }
    table.text()
}

/// G(θ): one row per angle.
fn angular_correlation(ring: &crate::response::RingResponse) -> String {
    let mut table = Table::new(&[("angle", "rad"), ("correlation", "1")]);
    for (&angle, &value) in ring.correlation.angles.iter().zip(&ring.correlation.values) {
        table.row([angle, value]);
    }
    table.text()
}

/// S(f): one row per frequency; the relative power is absent if that of f = 1 is not positive.
fn power_spectrum(ring: &crate::response::RingResponse) -> String {
    let mut table = Table::new(&[("frequency", "1"), ("power", "length^2"), ("relative_power", "1")]);
    let relative = ring.spectrum.normalised();
    for (f, &power) in ring.spectrum.power.iter().enumerate().skip(1) {
        table.cells(vec![Some(f as f64), Some(power), relative.as_ref().map(|values| values[f])]);
    }
    table.text()
}

/// G*, θ* and the variance in every measured ring: one row per ring; θ* is absent if G does not fall to the threshold.
fn radial_dependence(response: &Response) -> Option<String> {
    let rings = response.radial_dependence.as_ref()?.measured()?;
    let mut table = Table::new(&[
        ("relative_radius", "1"),
        ("disk_count", "1"),
        ("variance", "length^2"),
        ("anticorrelation", "1"),
    ]);
    let measured = || {
        rings.iter().filter_map(|ring| match &ring.outcome {
            RingOutcome::Measured { spectrum, correlation } => Some((ring.relative_radius, spectrum, correlation)),
            _ => None,
        })
    };
    if let Some((_, _, correlation)) = measured().next() {
        for crossing in &correlation.crossings {
            table.column(&format!("correlation_angle_at_{}", crossing.threshold), "rad");
        }
    }
    for (relative_radius, spectrum, correlation) in measured() {
        let known = [relative_radius, spectrum.disk_count as f64, spectrum.variance, correlation.anticorrelation];
        let mut cells: Vec<Option<f64>> = known.map(Some).to_vec();
        cells.extend(correlation.crossings.iter().map(|crossing| crossing.outcome.angle()));
        table.cells(cells);
    }
    Some(table.text())
}

/// Angular modes: one row per ring and mode; rings without modes are left out.
fn multipoles(response: &Response) -> Option<String> {
    let mut table = Table::new(&[
        ("radius", "length"),
        ("disk_count", "1"),
        ("mode", "1"),
        ("radial_amplitude", "length"),
        ("radial_amplitude_error", "length"),
        ("radial_phase", "rad"),
        ("radial_phase_error", "rad"),
        ("transverse_amplitude", "length"),
        ("transverse_amplitude_error", "length"),
        ("transverse_phase", "rad"),
        ("transverse_phase_error", "rad"),
    ]);
    for ring in &response.multipoles.as_ref()?.measured()?.rings {
        let MultipoleFit::Fitted { radial, transverse } = &ring.fit else { continue };
        for (a, b) in radial.modes.iter().zip(&transverse.modes) {
            table.row([
                ring.radius,
                ring.disk_count as f64,
                a.mode as f64,
                a.amplitude,
                a.amplitude_error,
                a.phase,
                a.phase_error,
                b.amplitude,
                b.amplitude_error,
                b.phase,
                b.phase_error,
            ]);
        }
    }
    Some(table.text())
}

/// Names and units of the columns of a midpoint.
const MIDPOINT: [(&str, &str); 3] = [("x", "length"), ("y", "length"), ("z", "length")];

/// Contacts made (1) and broken (−1): one row per contact. Disks are given by their labels, the ids of the packing files; midpoints are
/// relative to the inflated disk.
fn contact_changes(response: &Response) -> Option<String> {
    fn text<const D: usize>(response: &Response, changes: &ContactChanges<D>) -> String {
        let mut columns = vec![("change", "1"), ("first", "1"), ("second", "1")];
        columns.extend(&MIDPOINT[..D]);
        columns.push(("distance", "length"));
        let mut table = Table::new(&columns);
        for (change, contacts) in [(1.0, &changes.made), (-1.0, &changes.broken)] {
            for contact in contacts {
                let [first, second] = response.labels_of([contact.first, contact.second]);
                let mut row: Vec<&dyn std::fmt::Display> = vec![&change, &first, &second];
                row.extend(contact.midpoint.iter().map(|value| value as &dyn std::fmt::Display));
                row.push(&contact.distance);
                table.mixed(&row);
            }
        }
        table.text()
    }
    match &response.detail {
        Detail::Plane(detail) => Some(text(response, detail.contact_changes.as_ref()?)),
        Detail::Space(detail) => Some(text(response, detail.contact_changes.as_ref()?)),
    }
}

/// Bonds: one row per contact, with disks and midpoints as for the contact changes.
fn bond_changes(response: &Response) -> Option<String> {
    fn text<const D: usize>(response: &Response, changes: &BondChanges<D>) -> String {
        let mut columns = vec![("first", "1"), ("second", "1")];
        columns.extend(&MIDPOINT[..D]);
        columns.extend([("distance", "length"), ("parallel_displacement", "length"), ("length_change", "length")]);
        let mut table = Table::new(&columns);
        for bond in &changes.bonds {
            let [first, second] = response.labels_of([bond.first, bond.second]);
            let mut row: Vec<&dyn std::fmt::Display> = vec![&first, &second];
            row.extend(bond.midpoint.iter().map(|value| value as &dyn std::fmt::Display));
            row.extend([&bond.distance, &bond.parallel, &bond.length_change].map(|it| it as &dyn std::fmt::Display));
            table.mixed(&row);
        }
        table.text()
    }
    match &response.detail {
        Detail::Plane(detail) => Some(text(response, detail.bond_changes.as_ref()?)),
        Detail::Space(detail) => Some(text(response, detail.bond_changes.as_ref()?)),
    }
}

/// The curve from which ℓ_iso is read: one row per ring.
fn isostatic_length(response: &Response) -> Option<String> {
    let mut table = Table::new(&[
        ("radius", "length"),
        ("scaled_radius", "1"),
        ("scaled_fluctuation", "1"),
        ("standard_error", "1"),
    ]);
    for point in &response.isostatic_length.as_ref()?.measured()?.curve {
        table.row([point.radius, point.scaled_radius, point.scaled_fluctuation, point.standard_error]);
    }
    Some(table.text())
}
