//! Figures and the page of a report.

use super::*;
use jamscope::inflation::Boundary;
use jamscope::report::figures::map::MapFrame;
use jamscope::report::figures::{Around, Figure, angular::angular_figure, heat_map::heat_map, radial::radial_figure};
use jamscope::report::page::page;

/// Elements of HTML that are never closed.
const VOID: [&str; 1] = ["meta"];

/// Checks that elements nest, attributes are quoted and stand once, and entities are known; gives all tags.
///
/// A small part of XML: no comments, no processing instructions, no character data sections.
fn check_markup(text: &str) -> Vec<(String, BTreeMap<String, String>)> {
    let (mut open, mut tags, mut roots): (Vec<String>, Vec<_>, usize) = (Vec::new(), Vec::new(), 0);
    let mut rest = text.strip_prefix("<!DOCTYPE html>\n").unwrap_or(text);
    while let Some((before, after)) = rest.split_once('<') {
        check_text(before);
        assert!(!open.is_empty() || before.trim().is_empty(), "text outside the root: {before}");
        let (tag, after) = after.split_once('>').expect("a tag ends");
        rest = after;
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop().as_deref(), Some(name), "elements nest");
            continue;
        }
        let closed = tag.ends_with('/');
        let tag = tag.strip_suffix('/').unwrap_or(tag);
        let name = tag.split_whitespace().next().expect("an element has a name").to_string();
        assert!(name.bytes().all(|byte| byte.is_ascii_alphanumeric()), "element {name}");
        roots += usize::from(open.is_empty());
        tags.push((name.clone(), attributes(&tag[name.len()..])));
        if !closed && !VOID.contains(&name.as_str()) {
            open.push(name);
        }
    }
    assert!(rest.trim().is_empty() && open.is_empty() && roots == 1, "one root, closed: {open:?}");
    tags
}

fn attributes(mut text: &str) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    while !text.trim().is_empty() {
        assert!(text.starts_with(char::is_whitespace), "attributes stand apart: {text}");
        let (name, after) = text.trim_start().split_once("=\"").expect("an attribute has a quoted value");
        let (value, after) = after.split_once('"').expect("a quote ends");
        check_text(value);
        assert!(name.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"-:".contains(&byte)), "attribute {name}");
        assert_eq!(found.insert(name.to_string(), value.to_string()), None, "{name} stands twice");
        text = after;
    }
    found
}

fn check_text(text: &str) {
    for entity in text.split('&').skip(1) {
        let known = ["amp;", "lt;", "gt;", "quot;", "apos;"].iter().any(|known| entity.starts_with(known));
        assert!(known, "an entity in {text}");
    }
}

/// The map of a sample.
fn map(name: &str, result: &SampleResult, boundary: Boundary) -> Figure {
    let radii = result.states.plane().expect("of the plane").inflated.before.packing.get().radii();
    let frame = MapFrame::new(
        boundary,
        result.response.detail.plane().expect("of the plane").field.outer_radius,
        [result.packing.box_sides[0], result.packing.box_sides[1]],
        0.7,
    );
    heat_map(name, &result.response.detail.plane().expect("of the plane").field, radii, &frame)
}

#[test]
fn figures_are_well_formed_and_small() {
    for sample in ["loose", "dense"] {
        let result = result(sample);
        let profile = result.response.radial_profile.as_ref().expect("asked for");
        let profiles = result.response.angular_profiles.as_ref().expect("asked for");
        let figures = [
            map(sample, result, Boundary::default()),
            map(sample, result, Boundary::Periodic),
            radial_figure(sample, &result.response, profile).expect("finite"),
            angular_figure(sample, Around::Ring, profiles).expect("finite"),
        ];
        for figure in figures {
            let svg = figure.to_svg();
            let tags = check_markup(&svg);
            assert_eq!(tags[0].1["xmlns"], "http://www.w3.org/2000/svg");
            assert_eq!(tags[0].1["role"], "img");
            assert!(tags.iter().any(|(name, _)| name == "title"));
            assert!(svg.len() < 100_000, "{} bytes for 600 disks", svg.len());
            for (_, attributes) in tags {
                let size = attributes.get("font-size").map(|size| size.parse::<f64>().expect("a number"));
                // On the canvas of plotters ten pixels are one; indices alone are smaller than text.
                assert!(size.is_none_or(|size| size >= 120.0 || size == 13.0 || size == 10.0), "{size:?}");
            }
        }
    }
}

#[test]
fn the_map_shows_every_mobile_disk() {
    let result = result("dense");
    let svg = map("dense", result, Boundary::default()).to_svg();
    let disks = svg.matches("h0").count();
    assert_eq!(
        disks,
        result.response.detail.plane().expect("of the plane").field.disks.len() + 1,
        "one stroke a disk, and the inflated one"
    );
    let grey = svg.split("<path ").find(|path| path.starts_with("stroke=\"#c4c8cc\""));
    let rattlers =
        result.response.detail.plane().expect("of the plane").field.disks.iter().filter(|disk| !disk.counted).count();
    assert_eq!(grey.is_some(), rattlers > 0);
}

#[test]
fn numbers_that_are_none_are_not_drawn() {
    let result = result("dense");
    let mut profile = result.response.radial_profile.clone().expect("asked for");
    let count = |profile: &RadialProfile| {
        let svg = radial_figure("a < b & c", &result.response, profile).expect("axes around zero").to_svg();
        check_markup(&svg);
        assert!(svg.contains("<title>a &lt; b &amp; c"));
        svg.matches("<circle").count()
    };
    let before = count(&profile);
    profile.rings[4].mean = f64::NAN;
    assert_eq!(count(&profile), before - 1, "the ring that was fitted had one point");
}

#[test]
fn the_page_stands_alone_and_is_well_formed() {
    let html = page(report()).expect("finite numbers");
    let tags = check_markup(&html);
    assert!(!html.contains("http") && !html.contains("<script") && !html.contains("@import"));
    let files = written(report());
    let links: Vec<&String> = tags.iter().filter_map(|(_, attributes)| attributes.get("href")).collect();
    assert!(links.iter().all(|link| files.contains_key(*link)), "links lead to files written: {links:?}");
    for file in files.keys().filter(|name| *name != "report.html") {
        assert!(links.contains(&file), "{file} is linked");
    }
    assert!(tags.iter().filter(|(name, _)| name == "svg").all(|(_, a)| a.contains_key("aria-label")));
    assert!(!html.contains("[s]") && !html.contains("wall time ["), "no wall times on the page");
}

#[test]
fn failures_are_on_the_page_and_escaped() {
    let html = page(report()).expect("finite numbers");
    assert!(!html.contains("<b>such"));
    assert!(html.contains("no &lt;b&gt;such&lt;/b&gt; &amp; "), "the reason, escaped");
}
