//! The tables of the ensembles in the book, from the records in `fixtures/ensembles`.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::io::{BufRead, BufReader};
use std::path::Path;

use flate2::read::GzDecoder;
use jamscope::law::LawChoice;
use jamscope::response::{Calibration, WordCounts};
use jamscope::study::{CellSamples, Merged, NumberStatistics, Part, Study, Target, merge};
use jamscope::transition::{Comparison, Method, Series, Transition, TransitionPressure};

/// A study of `fixtures/ensembles`, merged.
pub struct Ensemble {
    pub name: String,
    pub merged: Merged,
    pub transition: Transition,
}

/// What stands in a place of a table.
type Quantity<'a> = &'a dyn Fn(&Series, &CellSamples) -> String;

/// Where the tables stand.
pub const CHAPTERS: [&str; 4] = ["ensembles.md", "plastic_phase.md", "response.md", "transition.md"];

/// First zero of J_1: κ_1 R.
const FIRST_ZERO: f64 = 3.831_705_970_207_512;

impl Ensemble {
    /// Unpacks an archive (see `archive.py` beside it) into a folder and merges that.
    pub fn read(archive: &Path, folder: &Path) -> Self {
        let study = unpack(archive, folder);
        let name = archive.file_name().expect("a name").to_string_lossy().replace(".jsonl.gz", "");
        Self::of(&name, &study, folder)
    }

    /// Several archives as one study of many parts: its series share power laws and collapses.
    pub fn united(name: &str, archives: &[&Path], folder: &Path) -> Self {
        let studies: Vec<Study> =
            archives.iter().map(|archive| serde_json::from_str(&unpack(archive, folder)).expect("a study")).collect();
        let parts = studies.iter().flat_map(parts_of).collect();
        let study = Study { parts, ..studies[0].clone() };
        Self::of(name, &serde_json::to_string(&study).expect("JSON"), folder)
    }

    fn of(name: &str, study: &str, folder: &Path) -> Self {
        std::fs::write(folder.join("study.json"), study).expect("written");
        let merged = merge(folder).expect("a study");
        assert!(merged.damaged.is_empty() && merged.foreign.is_empty(), "{:?} {:?}", merged.damaged, merged.foreign);
        let transition = Transition::of(&merged);
        Ensemble { name: name.into(), merged, transition }
    }

    /// The series with samples of one size: one a relaxer and an inflation.
    fn series(&self, disk_count: usize) -> Vec<&Series> {
        let has_samples = |one: &&Series| one.points.iter().any(|point| point.sample_count > 0);
        self.transition.series.iter().filter(|one| one.cell.disk_count == disk_count).filter(has_samples).collect()
    }

    /// Numbers of disks, ascending.
    fn disk_counts(&self) -> BTreeSet<usize> {
        self.transition.series.iter().map(|one| one.cell.disk_count).collect()
    }

    fn samples(&self, series: &Series, target: Target) -> Option<&CellSamples> {
        let own = |samples: &&CellSamples| {
            samples.cell.target == target && samples.cell.differs_in_target_alone(&series.cell)
        };
        self.merged.samples.iter().find(own)
    }

    /// Targets of a size with their p̂, ascending.
    fn targets(&self, disk_count: usize) -> Vec<(f64, Target)> {
        let mut all: Vec<(f64, Target)> = Vec::new();
        for samples in &self.merged.samples {
            let cell = &samples.cell;
            let reduced = match cell.target {
                Target::Pressure(pressure) => pressure * cell.mobile_count().powf(cell.law.exponent() - 1.0),
                target => target.name_and_value().1,
            };
            let known = all.iter().any(|(_, other)| *other == cell.target);
            if cell.disk_count == disk_count && !known && samples.done_count > 0 {
                all.push((reduced, cell.target));
            }
        }
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all
    }

    /// A row a p̂, a column a relaxer and quantity.
    fn by_pressure(&self, disk_count: usize, quantities: &[(&str, Quantity<'_>)]) -> String {
        let series = self.series(disk_count);
        let names = names(&series);
        let mut head = "| p̂ | samples |".to_string();
        for (name, _) in quantities {
            for column in &names {
                write!(head, " {name}, {column} |").expect("text");
            }
        }
        let mut table = head.clone() + "\n|" + &"---|".repeat(head.matches('|').count() - 1) + "\n";
        for (value, target) in self.targets(disk_count) {
            let counts: Vec<usize> =
                series.iter().filter_map(|one| Some(self.samples(one, target)?.done_count)).collect();
            let (least, most) = (counts.iter().min().unwrap_or(&0), counts.iter().max().unwrap_or(&0));
            let count = if least == most { least.to_string() } else { format!("{least} to {most}") };
            write!(table, "| {} | {count} |", power(value)).expect("text");
            for (_, of) in quantities {
                for one in &series {
                    let cell = self.samples(one, target).filter(|samples| samples.done_count > 0);
                    let text = cell.map_or("–".into(), |samples| of(one, samples));
                    write!(table, " {} |", text.replace('-', "−")).expect("text");
                }
            }
            table.push('\n');
        }
        table
    }

    /// Δp, κ and contacts.
    pub fn radial(&self, disk_count: usize) -> String {
        let pressure = |_: &Series, samples: &CellSamples| mean(samples, "scaled_pressure_change", 2);
        let screened =
            |_: &Series, samples: &CellSamples| share(samples, |kappa, radius| kappa * radius >= 0.5 * FIRST_ZERO);
        let made = |_: &Series, samples: &CellSamples| mean(samples, "contacts_made", 0);
        let name = if self.is_hookean() { "Δp" } else { "Δp/p^(1/3)" };
        self.by_pressure(disk_count, &[(name, &pressure), ("κ ≥ κ₁/2", &screened), ("contacts made", &made)])
    }

    /// Slope, G*, θ*.
    pub fn angular(&self, disk_count: usize) -> String {
        let slope = |one: &Series, samples: &CellSamples| {
            let index = self.merged.samples.iter().position(|other| std::ptr::eq(other, samples));
            let spectrum = one.spectra.iter().find(|spectrum| Some(spectrum.point.cell) == index);
            spectrum.and_then(|spectrum| spectrum.slope).map_or("–".into(), |slope| match slope.standard_error {
                Some(error) => format!("{:.2} ± {error:.2}", slope.best),
                None => format!("{:.2}", slope.best),
            })
        };
        let anticorrelation = |_: &Series, samples: &CellSamples| mean(samples, "anticorrelation", 2);
        let angle = |_: &Series, samples: &CellSamples| {
            let Some(values) = samples.numbers.get("correlation_angle_at_0.1") else { return "–".into() };
            let over_pi: Vec<f64> = values.iter().map(|value| value / std::f64::consts::PI).collect();
            with_error(&NumberStatistics::of(&over_pi), 2)
        };
        self.by_pressure(disk_count, &[("slope", &slope), ("G*", &anticorrelation), ("θ*/π", &angle)])
    }

    /// p̂_c by every method.
    pub fn critical(&self, disk_count: usize) -> String {
        let series = self.series(disk_count);
        let mut table = "| p̂_c by |".to_string();
        names(&series).iter().for_each(|name| write!(table, " {name} |").expect("text"));
        // Published values are those of Hertzian disks.
        let published = !self.is_hookean();
        table += if published { " published |" } else { "" };
        table += &format!("\n|{}\n", "---|".repeat(series.len() + 1 + usize::from(published)));
        let mut methods: Vec<Method> = Vec::new();
        for estimate in series.iter().flat_map(|one| &one.estimates) {
            if !methods.contains(&estimate.method) {
                methods.push(estimate.method);
            }
        }
        for method in methods {
            write!(table, "| {} |", method.name()).expect("text");
            for one in &series {
                let found = one.estimates.iter().find(|estimate| estimate.method == method);
                write!(table, " {} |", found.map_or("–".into(), |found| pressure(found.pressure))).expect("text");
            }
            if published {
                let value = if matches!(method, Method::Wavenumber | Method::PressureChange) { 3e8 } else { 1e8 };
                write!(table, " {} |", power(value)).expect("text");
            }
            table.push('\n');
        }
        table
    }

    /// Numbers beside published ones, but for the p̂_c: of the series of a relaxer, its collapses and power laws.
    pub fn comparison(&self, relaxer_name: &str) -> String {
        let mut table = "| what | of | found (95 %) | least samples a cell | published | |\n".to_string();
        table += &format!("|{}\n", "---|".repeat(6));
        let of_relaxer = |of: &str| of.split(", ").any(|word| word == relaxer_name);
        let all = self.transition.comparisons.iter();
        // p̂_c has tables of its own, and ℓ_iso around a held disk is a length of the circle.
        let elsewhere = |one: &Comparison| ["p̂_c by", "ℓ_iso ΔZ"].iter().any(|it| one.quantity.starts_with(it));
        let number = |value: f64| match value.abs() < 1e4 {
            true => format!("{value:.2}").replace('-', "−"),
            false => power(value),
        };
        for one in all.filter(|one| of_relaxer(&one.of) && !elsewhere(one)) {
            let ends = |[low, high]: [f64; 2]| format!(" ({} to {})", number(low), number(high));
            let interval = one.interval.map_or(String::new(), ends);
            let found = one.value.map_or("–".into(), |value| number(value) + &interval);
            let reason = one.reason.map_or(String::new(), |reason| format!(": {}", reason.words()));
            writeln!(
                table,
                "| {} | {} | {found} | {} | {} | {}{reason} |",
                one.quantity,
                one.of.replace(&format!(", {relaxer_name}"), ""),
                one.sample_count,
                number(one.published),
                one.verdict.name()
            )
            .expect("text");
        }
        table
    }

    /// ξ below jamming: a row a φ, a column a size and threshold.
    pub fn penetration(&self) -> String {
        let all = &self.transition.jamming;
        let mut fractions: Vec<f64> = all.iter().flat_map(|one| &one.points).map(|it| it.packing_fraction).collect();
        fractions.sort_by(f64::total_cmp);
        fractions.dedup();
        let mut table = "| φ |".to_string();
        for one in all {
            write!(table, " {} disks, d_th = {} |", one.cell.disk_count, one.threshold).expect("text");
        }
        table += &format!("\n|{}\n", "---|".repeat(all.len() + 1));
        for fraction in fractions {
            write!(table, "| {fraction} |").expect("text");
            for one in all {
                let point = one.points.iter().find(|it| it.packing_fraction == fraction);
                let text = point.map_or("–".into(), |it| match it.length.standard_error {
                    Some(error) => format!("{:.2} ± {error:.2}", it.length.mean),
                    None => format!("{:.2}", it.length.mean),
                });
                write!(table, " {text} |").expect("text");
            }
            table.push('\n');
        }
        table
    }

    fn is_hookean(&self) -> bool {
        self.transition.series.iter().any(|one| matches!(one.cell.law, LawChoice::Hookean(_)))
    }

    /// What each kind of evidence says of how many samples: plastic, quasielastic.
    pub fn evidence(&self, relaxer_name: &str) -> String {
        let mut table = "| p̂ | samples | phase | profile | Δp | spectrum | contacts |\n".to_string();
        table += &format!("|{}\n", "---|".repeat(7));
        let words = |counts: WordCounts| format!("{}, {}", counts.plastic, counts.quasielastic);
        for ensemble in self.transition.calibration.ensembles.iter().filter(|it| it.relaxer == relaxer_name) {
            for cell in &ensemble.cells {
                let counts = &cell.counts;
                writeln!(
                    table,
                    "| {} | {} | {} | {} | {} | {} | {} |",
                    power(cell.reduced_pressure),
                    counts.sample_count,
                    words(counts.phase),
                    words(counts.profile),
                    words(counts.pressure_change),
                    words(counts.spectrum),
                    words(counts.contact_changes)
                )
                .expect("text");
            }
        }
        table
    }
}

/// Writes the samples of an archive into a folder; its study is returned.
fn unpack(archive: &Path, folder: &Path) -> String {
    let file = std::fs::File::open(archive).expect("an archive");
    let lines = BufReader::new(GzDecoder::new(file)).lines().map(|line| line.expect("text"));
    let lines: Vec<String> = lines.collect();
    let samples = folder.join("samples");
    std::fs::create_dir_all(&samples).expect("a folder");
    for sample in lines[1..].chunks(3) {
        let header: serde_json::Value = serde_json::from_str(&sample[0]).expect("a header");
        let name = format!("{}.jsonl", &header["identity"].as_str().expect("an identity")[..24]);
        std::fs::write(samples.join(name), sample.join("\n") + "\n").expect("written");
    }
    lines[0].clone()
}

/// The parts of a study that name everything themselves.
fn parts_of(study: &Study) -> Vec<Part> {
    let whole = Part {
        disk_counts: vec![study.scene.disk_count],
        targets: study.targets.clone(),
        increases: study.increases.clone(),
        laws: vec![study.scene.law],
        relaxers: study.relaxers.clone(),
        seeds: Some(study.seeds),
        boundary: Some(study.scene.inflation.boundary),
    };
    let own = |part: &Part| {
        let mut all = whole.clone();
        let lists = |of: &Part| (of.disk_counts.clone(), of.targets.clone(), of.increases.clone(), of.relaxers.clone());
        let (disk_counts, targets, increases, relaxers) = lists(part);
        all.disk_counts = if disk_counts.is_empty() { all.disk_counts } else { disk_counts };
        all.targets = if targets.is_empty() { all.targets } else { targets };
        all.increases = if increases.is_empty() { all.increases } else { increases };
        all.relaxers = if relaxers.is_empty() { all.relaxers } else { relaxers };
        all.seeds = part.seeds.or(all.seeds);
        all.boundary = part.boundary.or(all.boundary);
        all
    };
    if study.parts.is_empty() { vec![whole] } else { study.parts.iter().map(own).collect() }
}

/// Every table of the chapters, with its title.
pub fn tables(ensembles: &[Ensemble]) -> Vec<(String, String)> {
    let mut all = Vec::new();
    for one in ensembles {
        if one.name == "all sizes" || one.name == "hookean" {
            for relaxer in ["FIRE and Newton", "viscoelastic 500"] {
                all.push((format!("{}: {relaxer}", one.name), one.comparison(relaxer)));
            }
            continue;
        }
        if one.name == "jamming" {
            all.push(("jamming: ξ".into(), one.penetration()));
            all.push(("jamming: ν".into(), one.comparison("FIRE")));
            continue;
        }
        for disk_count in one.disk_counts() {
            let title = |of: &str| format!("{}, {disk_count} disks: {of}", one.name);
            all.push((title("radial"), one.radial(disk_count)));
            all.push((title("angular"), one.angular(disk_count)));
            all.push((title("p̂_c"), one.critical(disk_count)));
        }
        if one.name.starts_with("damping") {
            all.push((format!("{}: evidence", one.name), one.evidence("viscoelastic 500")));
        }
    }
    all
}

/// All ensembles of `fixtures/ensembles`, and those of one law together.
pub fn ensembles(folder: &Path) -> Vec<Ensemble> {
    let entries = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let mut archives: Vec<_> = entries.filter(|path| path.to_string_lossy().ends_with(".jsonl.gz")).collect();
    archives.sort();
    assert!(!archives.is_empty());
    let of_law = |hookean: bool| -> Vec<&Path> {
        let is = |path: &&std::path::PathBuf| {
            let name = path.file_name().expect("a name").to_string_lossy();
            name.contains("hookean") == hookean && !name.contains("jamming")
        };
        archives.iter().filter(is).map(|path| path.as_path()).collect()
    };
    let (hertzian, hookean) = (of_law(false), of_law(true));
    let mut jobs: Vec<(Option<&str>, &[&Path])> = vec![(Some("all sizes"), &hertzian)];
    if hookean.len() > 1 {
        jobs.push((Some("hookean"), &hookean));
    }
    let single: Vec<[&Path; 1]> = archives.iter().map(|path| [path.as_path()]).collect();
    jobs.extend(single.iter().map(|path| (None, &path[..])));
    let read = |(name, paths): (Option<&str>, &[&Path])| {
        let folder = tempfile::tempdir().expect("a temporary folder");
        match name {
            Some(name) => Ensemble::united(name, paths, folder.path()),
            None => Ensemble::read(paths[0], folder.path()),
        }
    };
    std::thread::scope(|scope| {
        let all: Vec<_> = jobs.into_iter().map(|job| scope.spawn(move || read(job))).collect();
        all.into_iter().map(|one| one.join().expect("an archive that can be read")).collect()
    })
}

/// The calibration of the program: that of all ensembles.
pub fn calibration(ensembles: &[Ensemble]) -> Calibration {
    let own = ensembles.iter().filter(|one| one.name != "all sizes" && one.name != "hookean");
    let all = own.flat_map(|one| one.transition.calibration.ensembles.iter().cloned());
    Calibration { ensembles: all.collect() }
}

/// A text with every table that is marked in it by `<!-- TITLE -->` replaced by its table, and the titles that were found.
pub fn filled(text: &str, tables: &[(String, String)]) -> (String, Vec<String>) {
    let (mut out, mut found) = (String::new(), Vec::new());
    let mut lines = text.lines().peekable();
    while let Some(line) = lines.next() {
        writeln!(out, "{line}").expect("text");
        let marked = tables.iter().find(|(title, _)| line == format!("<!-- {title} -->"));
        if let Some((title, table)) = marked {
            while lines.next_if(|line| line.starts_with('|') || line.is_empty()).is_some() {}
            writeln!(out, "\n{table}").expect("text");
            found.push(title.clone());
        }
    }
    (out, found)
}

/// What tells the series of a table apart, in a word and a number: "FIRE", "viscoelastic 500", "d_0 = 0.01".
fn names(series: &[&Series]) -> Vec<String> {
    let relaxer = |one: &Series| one.cell.relaxer.description().replace(" and Newton", "").replace(" damping", "");
    let one_relaxer = series.iter().all(|one| one.cell.relaxer == series[0].cell.relaxer);
    let one_increase = series.iter().all(|one| one.cell.increase == series[0].cell.increase);
    let of = |one: &&Series| match (one_relaxer, one_increase) {
        (true, false) => format!("d_0 = {}", one.cell.increase),
        (_, true) => relaxer(one),
        (false, false) => format!("{}, d_0 = {}", relaxer(one), one.cell.increase),
    };
    series.iter().map(of).collect()
}

/// 3·10⁸, two digits.
fn power(value: f64) -> String {
    let written = format!("{value:.1e}");
    let (mantissa, exponent) = written.split_once('e').expect("an exponent");
    let raised = |digit: char| "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth(digit.to_digit(10).unwrap_or(0) as usize);
    let exponent: String = exponent.chars().filter_map(raised).collect();
    match mantissa.trim_end_matches(".0") {
        "1" => format!("10{exponent}"),
        mantissa => format!("{mantissa}·10{exponent}"),
    }
}

fn pressure(of: TransitionPressure) -> String {
    match of {
        TransitionPressure::Found(found) => {
            let ends =
                found.interval.map_or(String::new(), |[low, high]| format!(" ({} to {})", power(low), power(high)));
            power(found.best) + &ends
        }
        TransitionPressure::Between([low, high]) => format!("between {} and {}", power(low), power(high)),
        TransitionPressure::Above(highest) => format!("above {}", power(highest)),
        TransitionPressure::Below(lowest) => format!("below {}", power(lowest)),
        TransitionPressure::Unordered => "no single transition".into(),
        TransitionPressure::Uninformative { .. } => "cannot tell".into(),
    }
}

fn with_error(of: &NumberStatistics, digits: usize) -> String {
    match of.standard_error {
        Some(error) => format!("{:.digits$} ± {error:.digits$}", of.mean),
        None => format!("{:.digits$}", of.mean),
    }
}

fn mean(samples: &CellSamples, name: &str, digits: usize) -> String {
    samples.numbers.get(name).map_or("–".into(), |values| with_error(&NumberStatistics::of(values), digits))
}

/// Samples whose κ is so, of those fitted.
fn share(samples: &CellSamples, is: impl Fn(f64, f64) -> bool) -> String {
    let (Some(kappas), Some(radii)) = (samples.numbers.get("wavenumber"), samples.numbers.get("outer_radius")) else {
        return "–".into();
    };
    let radius = NumberStatistics::of(radii).mean;
    let count = kappas.iter().filter(|&&kappa| is(kappa, radius)).count();
    format!("{count} of {}", kappas.len())
}
