use jamscope::io::read_packing;
use jamscope::law::{Hertzian, Hookean};
use jamscope::network::ContactNetwork;
use jamscope::observe::ExcessCoordination;

use super::{lattice, lattice_positions};

fn expected() -> serde_json::Value {
    let text = std::fs::read_to_string("fixtures/packings/expected.json").expect("a fixture");
    serde_json::from_str(&text).expect("JSON")
}

#[test]
fn stored_packings_have_the_excess_their_source_says() {
    let expected = expected();
    let mut jammed = 0;
    for (name, values) in expected.as_object().expect("by name") {
        let packing = read_packing::<2>(format!("fixtures/packings/{name}.xyz")).expect("a fixture");
        let network = match values["model"].as_str() {
            Some("hertz") => ContactNetwork::new(&packing, &Hertzian::default()),
            _ => ContactNetwork::new(&packing, &Hookean::default()),
        };
        let network = network.expect("sound disks");
        let number = |key: &str| values[key].as_f64().expect("a number");
        if name.ends_with("phi082") {
            continue;
        }
        let excess = ExcessCoordination::of(&network).expect("jammed");
        assert_eq!(excess.disk_count as f64, number("N") - number("rattlers"));
        assert_eq!(excess.end_count as f64, 2.0 * number("contacts_backbone"));
        // One division and one difference.
        assert!((excess.value - (number("Z") - 4.0)).abs() < 2e-15, "{name}");
        jammed += 1;
    }
    assert_eq!(jammed, 14);
}

#[test]
fn hertzian_packings_follow_the_third_root_of_the_pressure() {
    // ΔZ/p^(1/3) of the stored packings from p = 1 to 800: within the range the chapter gives.
    let mut seen = 0;
    for (name, values) in expected().as_object().expect("by name") {
        let pressure = values["p"].as_f64().expect("p");
        if values["model"] != "hertz" || pressure < 0.5 {
            continue;
        }
        let prefactor = (values["Z"].as_f64().expect("Z") - 4.0) / pressure.cbrt();
        assert!((0.083..0.097).contains(&prefactor), "{name}: {prefactor}");
        seen += 1;
    }
    assert_eq!(seen, 7);
}

#[test]
fn a_lattice_has_two_to_spare_and_nothing_without_contacts() {
    let packing = lattice(lattice_positions());
    let network = ContactNetwork::new(&packing, &Hookean::default()).expect("sound disks");
    let excess = ExcessCoordination::of(&network).expect("rigid");
    assert_eq!(excess, ExcessCoordination { disk_count: 48, end_count: 288, value: 2.0 });
    // Row 0 held: 42 disks move, their ends are those of rows 1 to 7, six each.
    let held = (0..48).map(|disk| disk < 6).collect();
    let network = ContactNetwork::new(&packing.with_held(held).expect("one a disk"), &Hookean::default());
    let excess = ExcessCoordination::of(&network.expect("sound disks")).expect("rigid");
    assert_eq!(excess, ExcessCoordination { disk_count: 42, end_count: 252, value: 2.0 });
    let apart = lattice_positions().iter().map(|x| [0.5 * x[0], 0.5 * x[1]]).collect::<Vec<_>>();
    let loose = jamscope::packing::Packing::new(jamscope::packing::Domain::cube(20.0), apart, vec![0.1; 48]);
    let network = ContactNetwork::new(&loose.expect("sound disks"), &Hookean::default()).expect("sound disks");
    assert_eq!(ExcessCoordination::of(&network), None);
}
