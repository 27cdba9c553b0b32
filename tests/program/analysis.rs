//! Analyses of states: as a run has them, read from its files, shuffled, wrapped, and what does not fit together.

use std::path::Path;
use std::sync::OnceLock;

use jamscope::analysis::{Analysis, AnalysisError, Pair, PairSettings};
use jamscope::inflation::Boundary;
use jamscope::io::read_packing;
use jamscope::law::LawChoice;
use jamscope::packing::{Domain, Packing};
use jamscope::relax::RelaxerChoice;
use jamscope::report::write;
use jamscope::run::{Report, SampleOutcome, SampleResult, run};
use jamscope::scene::{Observables, Sample, Scene, Source};
use jamscope::vector::{larger, norm};
use jamscope::verdict::VerdictSettings;

/// Two jammed packings of 600 disks, one in a circle with a held rim and one in its periodic box, both deflated again.
fn report(boundary: Boundary) -> Report {
    let sample = |name: &str, seed| Sample {
        name: name.into(),
        seed,
        source: Source::Pressure(1000.0),
        relaxer: RelaxerChoice::default(),
    };
    let mut scene = Scene { disk_count: 600, sample: vec![sample("dense", 3)], ..Scene::default() };
    scene.inflation.deflate = true;
    scene.inflation.boundary = boundary;
    run(&scene, &()).expect("the scene makes sense")
}

fn circle() -> &'static Report {
    static REPORT: OnceLock<Report> = OnceLock::new();
    REPORT.get_or_init(|| report(Boundary::default()))
}

fn periodic() -> &'static Report {
    static REPORT: OnceLock<Report> = OnceLock::new();
    REPORT.get_or_init(|| report(Boundary::Periodic))
}

fn result(report: &Report) -> &SampleResult {
    match &report.samples[0].result {
        SampleOutcome::Done(result) => result,
        SampleOutcome::Failed(reason) => panic!("failed: {reason}"),
    }
}

fn read(folder: &Path, ending: &str) -> Packing<2> {
    read_packing(folder.join(format!("dense.{ending}.xyz"))).expect("readable")
}

fn analysed(pair: Pair) -> Analysis {
    let (law, observables, verdict) = (LawChoice::default(), Observables::default(), VerdictSettings::default());
    Analysis::of("dense", pair, &law, &observables, &verdict).expect("no coincidence")
}

/// States of a result, as packings.
fn states(result: &SampleResult) -> [Packing<2>; 3] {
    let inflated = &result.states.plane().expect("of the plane").inflated;
    let deflated = inflated.deflated.as_ref().expect("deflated");
    [&inflated.before, &inflated.after, deflated].map(|rest| rest.packing.get().clone())
}

/// What a run measured and what an analysis of its states measures, to the bit.
fn agree(analysis: &Analysis, result: &SampleResult) {
    let json = |response| serde_json::to_value(response).expect("serialisable");
    assert_eq!(json(&analysis.response), json(&result.response));
    assert_eq!(
        analysis.response.detail.plane().expect("of the plane").field,
        result.response.detail.plane().expect("of the plane").field
    );
    let (summary, inflation) = (&analysis.before, &result.inflation.before);
    assert_eq!((summary.pressure, summary.energy), (inflation.pressure, inflation.energy));
    assert_eq!((summary.contact_count, summary.rattler_count), (inflation.contact_count, inflation.rattler_count));
    assert_eq!(analysis.pressure_change, result.inflation.pressure_change);
    assert_eq!(analysis.scaled_pressure_change, result.inflation.scaled_pressure_change);
    assert_eq!(analysis.centre_label, result.inflation.centre_label);
    assert_eq!(analysis.mobile_count, result.inflation.mobile_count);
    let deflated = analysis.deflated.as_ref().zip(result.inflation.deflated.as_ref());
    let (ours, theirs) = deflated.expect("deflated");
    assert_eq!((ours.pressure, ours.energy), (theirs.pressure, theirs.energy));
}

#[test]
fn an_analysis_of_the_files_of_a_run_is_that_run() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    write(circle(), folder.path()).expect("written");
    let result = result(circle());
    let [before, after, deflated] = ["before", "displacement", "deflated"].map(|ending| read(folder.path(), ending));
    let settings = PairSettings { outer_radius: Some(result.inflation.outer_radius), ..PairSettings::default() };
    let pair = Pair::new(before, &after, Some(&deflated), &settings).expect("one experiment");
    agree(&analysed(pair), result);
}

#[test]
fn overlaps_of_rounding_are_no_contacts() {
    // Two unjammed packings: what their relaxation left of overlaps, 10⁻¹², looks like contacts, and some of it like a backbone.
    let sample = |seed| Sample {
        name: format!("loose-{seed}"),
        seed,
        source: Source::PackingFraction(0.82),
        relaxer: RelaxerChoice::default(),
    };
    let scene = Scene { disk_count: 600, sample: vec![sample(1), sample(2)], ..Scene::default() };
    for sample in run(&scene, &()).expect("the scene makes sense").samples {
        let SampleOutcome::Done(result) = &sample.result else { panic!("unjammed packings come to rest") };
        let [before, after] = [
            &result.states.plane().expect("of the plane").inflated.before,
            &result.states.plane().expect("of the plane").inflated.after,
        ]
        .map(|rest| rest.packing.get().clone());
        let settings = PairSettings { outer_radius: Some(result.inflation.outer_radius), ..PairSettings::default() };
        let analysis = analysed(Pair::new(before, &after, None, &settings).expect("one experiment"));
        assert_eq!((analysis.before.pressure, analysis.after.pressure, analysis.pressure_change), (0.0, 0.0, 0.0));
        let json = |response| serde_json::to_value(response).expect("serialisable");
        assert_eq!(json(&analysis.response), json(&result.response));
    }
}

#[test]
fn in_a_periodic_box_nothing_is_held() {
    let [before, after, deflated] = states(result(periodic()));
    let pair = Pair::new(before, &after, Some(&deflated), &PairSettings::default()).expect("one experiment");
    assert_eq!(pair.boundary, Boundary::Periodic);
    agree(&analysed(pair), result(periodic()));
}

/// The same disks in another order.
fn shuffled(packing: &Packing<2>) -> Packing<2> {
    // 7 and 600 have no common factor.
    let order: Vec<usize> = (0..packing.len()).map(|place| (7 * place + 3) % packing.len()).collect();
    let pick = |values: &[[f64; 2]]| order.iter().map(|&disk| values[disk]).collect::<Vec<_>>();
    let radii = order.iter().map(|&disk| packing.radii()[disk]).collect();
    Packing::new(*packing.domain(), pick(packing.positions()), radii)
        .and_then(|shuffled| shuffled.with_corrections(pick(packing.corrections())))
        .and_then(|shuffled| shuffled.with_labels(order.iter().map(|&disk| packing.labels()[disk]).collect()))
        .expect("the same disks")
}

#[test]
fn disks_are_matched_by_label_whatever_their_order() {
    let [before, after, deflated] = states(result(periodic()));
    let (after, deflated) = (shuffled(&after), shuffled(&deflated));
    let pair = Pair::new(before, &after, Some(&deflated), &PairSettings::default()).expect("one experiment");
    agree(&analysed(pair), result(periodic()));
}

#[test]
fn disks_that_left_the_box_are_where_they_went() {
    let [before, after, _] = states(result(periodic()));
    let lengths = before.domain().lengths().expect("periodic");
    let wrapped: Vec<[f64; 2]> = after
        .positions()
        .iter()
        .enumerate()
        .map(|(disk, &[x, y])| match disk % 3 {
            0 => [x + lengths[0], y],
            1 => [x, y - 2.0 * lengths[1]],
            _ => [x, y],
        })
        .collect();
    let wrapped = Packing::new(*after.domain(), wrapped, after.radii().to_vec())
        .and_then(|packing| packing.with_corrections(after.corrections().to_vec()))
        .expect("valid");
    let pair = Pair::new(before, &wrapped, None, &PairSettings::default()).expect("one experiment");
    let analysed = analysed(pair);
    let field = &analysed.response.detail.plane().expect("of the plane").field;
    // A coordinate up to three sides away is rounded to half an ulp of 2⁷, 7·10⁻¹⁵, on the way there; the way back is exact.
    for (ours, theirs) in
        field.disks.iter().zip(&result(periodic()).response.detail.plane().expect("of the plane").field.disks)
    {
        let away = [0, 1].map(|axis| ours.displacement[axis] - theirs.displacement[axis]);
        assert!(norm(away) < 2e-14, "disk {} is {:e} off", ours.disk, norm(away));
    }
}

#[test]
fn a_radius_holds_the_disks_beyond_it() {
    // The whole box with a rim by radius: disks beyond are held, so they and the centre are not in the field.
    let [before, after, _] = states(result(periodic()));
    let settings = PairSettings { outer_radius: Some(8.0), ..PairSettings::default() };
    let pair = Pair::new(before, &after, None, &settings).expect("one experiment");
    assert!(matches!(pair.boundary, Boundary::HeldRim { .. }) && pair.outer_radius == 8.0);
    let analysis = analysed(pair);
    let farthest = analysis
        .response
        .detail
        .plane()
        .expect("of the plane")
        .field
        .disks
        .iter()
        .map(|disk| disk.distance)
        .fold(0.0, larger);
    // 600 disks fill 26 × 26: a circle of radius 8 has π 64/26² = 0.3 of them.
    assert!(farthest < 8.0 && analysis.mobile_count > 130 && analysis.mobile_count < 230, "{}", analysis.mobile_count);
}

#[test]
fn what_does_not_fit_together_is_named() {
    let [before, after, _] = states(result(periodic()));
    let new = |before: &Packing<2>, after: &Packing<2>, settings: PairSettings| {
        Pair::new(before.clone(), after, None, &settings).map(|_| ()).expect_err("it does not fit")
    };
    let plain = PairSettings::default();
    let centre = result(periodic()).states.plane().expect("of the plane").inflated.centre;
    let label = before.labels()[centre];
    assert_eq!(new(&before, &before, plain), AnalysisError::NoCentre);
    let other = after.clone().with_radius((centre + 1) % 600, 0.61).expect("positive");
    assert!(matches!(new(&before, &other, plain), AnalysisError::SeveralCentres { count: 2, .. }));
    let settings = PairSettings { centre_label: Some(u64::MAX), ..plain };
    assert_eq!(new(&before, &after, settings), AnalysisError::CentreNotOne { label: u64::MAX, count: 0 });
    let other = before.labels()[(centre + 1) % 600];
    let settings = PairSettings { centre_label: Some(other), ..plain };
    let radius = before.radii()[(centre + 1) % 600];
    let unchanged = AnalysisError::CentreUnchanged { label: other, radius, grown: Some(label) };
    assert_eq!(new(&before, &after, settings), unchanged);
    let unchanged = AnalysisError::CentreUnchanged { label: other, radius, grown: None };
    assert_eq!(new(&before, &before, settings), unchanged);
    let settings = PairSettings { centre_label: Some(label), outer_radius: Some(0.1) };
    assert!(matches!(new(&before, &after, settings), AnalysisError::OuterRadiusOutOfRange { .. }));
    let settings = PairSettings { centre_label: Some(label), outer_radius: Some(0.51) };
    assert_eq!(new(&before, &after, settings), AnalysisError::NoMobileDisk { outer_radius: 0.51 });
    let fewer = Packing::new(*after.domain(), after.positions()[1..].to_vec(), after.radii()[1..].to_vec());
    let message = new(&before, &fewer.expect("valid"), plain).to_string();
    assert_eq!(message, "600 disks before, 599 after: both states must contain the same disks");
    let labels = |change: fn(&mut Vec<u64>)| {
        let mut labels = before.labels().to_vec();
        change(&mut labels);
        after.clone().with_labels(labels).expect("as many")
    };
    let renamed = labels(|labels| labels[5] = 9999);
    assert!(matches!(new(&before, &renamed, plain), AnalysisError::LabelMissing { .. }));
    let twice = labels(|labels| labels[5] = labels[6]);
    assert!(matches!(new(&before, &twice, plain), AnalysisError::LabelsAmbiguous { .. }));
    let elsewhere =
        Packing::new(Domain::cube(60.0), after.positions().to_vec(), after.radii().to_vec()).expect("valid");
    assert_eq!(new(&before, &elsewhere, plain), AnalysisError::DomainsDiffer { state: "after" });
    let open = |packing: &Packing<2>| {
        Packing::new(Domain::Open, packing.positions().to_vec(), packing.radii().to_vec()).expect("valid")
    };
    assert_eq!(new(&open(&before), &open(&after), plain), AnalysisError::NoBoundary);
}

#[test]
fn what_is_not_named_is_not_measured() {
    let [before, after, _] = states(result(periodic()));
    let pair = Pair::new(before, &after, None, &PairSettings::default()).expect("one experiment");
    let (law, observables, verdict) = (LawChoice::default(), Observables::none(), VerdictSettings::default());
    let analysis = Analysis::of("dense", pair, &law, &observables, &verdict).expect("no coincidence");
    let json = serde_json::to_value(&analysis.response).expect("serialisable");
    let names: Vec<&String> = json.as_object().expect("an object").keys().collect();
    assert_eq!(names, ["measured_on", "phase", "verdict"]);
}
