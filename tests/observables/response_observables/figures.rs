use jamscope::inflation::Boundary;
use jamscope::observe::bond_changes::{BondChange, BondChanges, BondSet};
use jamscope::observe::contact_changes::{ChangedContact, ContactChanges, RattlerContacts};
use jamscope::observe::fluctuations::{FluctuationRing, Fluctuations};
use jamscope::observe::isostatic::{IsostaticLength, IsostaticSettings, Scale, Tail};
use jamscope::observe::multipoles::{MultipoleSettings, Multipoles};
use jamscope::report::figures::bond_map::bond_map;
use jamscope::report::figures::contact_map::contact_map;
use jamscope::report::figures::isostatic::isostatic_figure;
use jamscope::report::figures::map::MapFrame;
use jamscope::report::figures::multipoles::{Component, multipole_figure};

use super::{field, generator, random_places};

fn frame() -> MapFrame {
    MapFrame::new(Boundary::default(), 40.0, [80.0; 2], 0.7)
}

/// Opening and closing tags pair up, text apart from tags has no bare `<` or `&`.
fn well_formed(svg: &str) {
    let mut open = Vec::new();
    for tag in svg.split('<').skip(1) {
        let (inner, text) = tag.split_once('>').expect("a tag ends");
        assert!(!text.replace("&amp;", "").replace("&lt;", "").replace("&gt;", "").contains('&'));
        match inner.strip_prefix('/') {
            Some(name) => assert_eq!(open.pop(), Some(name)),
            None if inner.ends_with('/') => {}
            None => open.push(inner.split_whitespace().next().expect("a name")),
        }
    }
    assert!(open.is_empty());
}

/// Bonds of one length along x, five a place, stretched by −2, −1, 0, 1, 2 times 0.1/r.
fn bonds(count: usize) -> BondChanges<2> {
    let mut generator = generator(9);
    let places = random_places(&[5.0, 15.0, 25.0, 35.0], count / 4, &mut generator);
    let bonds = places.iter().enumerate().map(|(index, &[distance, angle])| BondChange {
        first: index as u32,
        second: index as u32 + 1,
        midpoint: [distance * angle.cos(), distance * angle.sin()],
        distance,
        separation: [1.0, 0.0],
        parallel: 0.1 / distance * (index % 5) as f64 - 0.2 / distance,
        length_change: 0.0,
    });
    BondChanges { set: BondSet::Kept, bonds: bonds.collect() }
}

#[test]
fn the_bond_map_draws_every_bond_that_changes_in_few_letters() {
    let changes = bonds(20_000);
    let svg = bond_map("a <b> & c", &changes, &frame(), Some(12.0)).to_svg();
    well_formed(&svg);
    // One stroke a bond but for the fifth of them that does not change; four colours, weak ones first.
    let paths: Vec<&str> =
        svg.lines().filter(|line| line.starts_with("<path stroke=\"#") && line.contains(" d=\"m")).collect();
    assert_eq!(paths.len(), 4);
    assert_eq!(paths.iter().map(|path| path.matches('l').count()).sum::<usize>(), 16_000);
    // Half of full lies halfway between two classes of the scale: #d6604d and #f4a582.
    assert!(paths[0].contains("#e58368"), "half of full, red first");
    assert!(paths[2].contains("#67001f") && paths[3].contains("#053061"), "ends of the scale last");
    assert!(svg.contains("stroke-dasharray") && svg.contains("&lt;b&gt;"));
    // Thirteen letters a bond, and some 10 000 for the frame and the scale.
    assert!(svg.len() < 13 * 20_000 + 10_000, "{}", svg.len());
    assert_eq!(svg, bond_map("a <b> & c", &changes, &frame(), Some(12.0)).to_svg());
}

#[test]
fn a_map_of_very_many_bonds_is_one_image_within_its_axes() {
    let svg = bond_map("many", &bonds(100_000), &frame(), Some(12.0)).to_svg();
    well_formed(&svg);
    assert!(svg.contains("href=\"data:image/png;base64,") && !svg.contains(" d=\"m"));
    // 1104 × 1104 pixels of at most 4 bytes, uncompressed, in base 64; what stands around it stays vectors.
    assert!(svg.len() < 1104 * 1104 * 4 * 4 / 3, "{}", svg.len());
    assert!(svg.contains("stroke-dasharray") && svg.contains("diameters of a small disk"));
}

#[test]
fn the_contact_map_has_a_point_a_contact() {
    let at = |x: f64, y: f64| ChangedContact { first: 0, second: 1, midpoint: [x, y], distance: x.hypot(y) };
    let changes = ContactChanges {
        kept_count: 7,
        made: vec![at(1.0, 2.0), at(-3.0, 4.0)],
        broken: vec![at(10.0, -20.0)],
        rattlers: RattlerContacts::default(),
    };
    let svg = contact_map("cycle", &changes, &frame()).to_svg();
    well_formed(&svg);
    // Two made, one broken, the centre.
    assert_eq!(svg.matches("h0").count(), 4);
    // 5 · 368/40.7 tenths of a pixel to a length; up is minus.
    let zoom = 5.0 * 368.0 / 40.7;
    let (x, y) = ((10.0f64 * zoom).round(), (20.0f64 * zoom).round());
    assert!(svg.contains(&format!("m{x} {y}h0")) && svg.contains("2 made") && svg.contains("1 broken"));
}

#[test]
fn charts_of_modes_and_fluctuations_are_well_formed() {
    let mut generator = generator(10);
    let places = random_places(&[5.0, 15.0, 25.0, 35.0], 60, &mut generator);
    let field = field(&places, |r, angle| [0.1 / r + 0.02 * angle.cos(), 0.01 * (2.0 * angle).sin()]);
    let multipoles = Multipoles::of(&field, &MultipoleSettings::default()).expect("sound settings");
    for component in [Component::Radial, Component::Transverse] {
        let svg = multipole_figure("modes", &multipoles, component, 3, None).expect("finite").to_svg();
        well_formed(&svg);
        assert!(svg.contains("n = 3"));
    }
    let none = Multipoles { rings: Vec::new() };
    assert!(multipole_figure("modes", &none, Component::Radial, 3, None).is_err());

    let ring = |k: u32| FluctuationRing {
        radius: f64::from(k),
        count: 9,
        mean: 0.0,
        fluctuation: 1.0 / f64::from(k),
        standard_error: 0.01,
    };
    let fluctuations = Fluctuations { rings: (1..30).map(ring).collect() };
    let length = IsostaticLength::of(&fluctuations, Some(0.5), 0.1, 40.0, &IsostaticSettings::default());
    let length = length.expect("sound settings");
    let svg = isostatic_figure("h", &[("p = 1 & 2", &length), ("other", &length)]).expect("finite").to_svg();
    well_formed(&svg);
    assert!(svg.contains("p = 1 &amp; 2: not reached") && svg.contains(">r ΔZ"));
    let settings =
        IsostaticSettings { scale: Scale::RootExcess, tail: Tail::InverseSquare, ..IsostaticSettings::default() };
    let length = IsostaticLength::of(&fluctuations, Some(0.5), 0.1, 40.0, &settings).expect("sound settings");
    let svg = isostatic_figure("h", &[("one", &length)]).expect("finite").to_svg();
    well_formed(&svg);
    assert!(svg.contains(">r √ΔZ") && svg.contains(" r² ΔZ<"));
    assert!(isostatic_figure("h", &[]).is_err(), "no curve, no range");
}
