//! `jamscope exact` as its user meets it: tables to the last bit, and what it says of bad arguments.

use std::io::{BufRead, BufReader};
use std::process::{Command, Output, Stdio};

use jamscope::reference::amplitude::Amplitude;
use jamscope::reference::angular_modes::elastic::ElasticMode;
use jamscope::reference::angular_modes::screened::{ScreenedMode, Screening};
use jamscope::reference::angular_modes::{AngularSolution, Complex, ModeAmplitudes};
use jamscope::reference::antiscreened::Antiscreened;
use jamscope::reference::bessel::{cylinder, modified, spherical};
use jamscope::reference::lorentzian::{ContinuumLorentzian, Lorentzian};
use jamscope::reference::poles::pole;
use jamscope::reference::screened::Screened;
use jamscope::reference::{Annulus, RadialSolution};
use serde_json::Value;

fn exact(arguments: &str) -> Output {
    let words = arguments.split(' ').filter(|word| !word.is_empty());
    Command::new(env!("CARGO_BIN_EXE_jamscope")).arg("exact").args(words).output().expect("the program starts")
}

/// Names, units and numbers of a CSV table.
fn table(arguments: &str) -> (Vec<String>, Vec<String>, Vec<Vec<f64>>) {
    let output = exact(arguments);
    assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
    assert!(output.stderr.is_empty());
    let text = String::from_utf8(output.stdout).expect("Unicode");
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_string).collect::<Vec<_>>());
    let (names, units) = (lines.next().expect("names"), lines.next().expect("units"));
    let rows: Vec<Vec<f64>> =
        lines.map(|row| row.iter().map(|cell| cell.parse().expect("a number")).collect()).collect();
    assert!(rows.iter().all(|row| row.len() == names.len() && units.len() == names.len()));
    (names, units, rows)
}

fn bits(row: &[f64]) -> Vec<u64> {
    row.iter().map(|number| number.to_bits()).collect()
}

/// A row of `exact profile` by the library: d, d', ∂d/∂κ.
type Row<'a> = &'a dyn Fn(f64) -> [f64; 3];

#[test]
fn profiles_are_those_of_the_library_to_the_last_bit() {
    let annulus = Annulus::new(0.5, 42.0).expect("valid");
    let plane = Screened::<2>::new(annulus, 0.1, 0.02).expect("no pole");
    let space = Screened::<3>::new(annulus, -0.3, 0.0).expect("no pole");
    let foundation = Antiscreened::<2>::new(annulus, 0.1, 0.2).expect("valid");
    let solid_foundation = Antiscreened::<3>::new(annulus, 0.1, 0.2).expect("valid");
    let cases: [(&str, Row); 4] = [
        ("profile --outer 42 --wavenumber 0.02 --count 50", &|r| {
            [plane.value(r), plane.derivative(r), plane.wavenumber_derivative(r)]
        }),
        ("profile --outer 42 --amplitude -0.3 --dimension 3 --count 50", &|r| {
            [space.value(r), space.derivative(r), space.wavenumber_derivative(r)]
        }),
        ("profile --outer 42 --wavenumber 0.2 --antiscreened --count 50", &|r| {
            [foundation.value(r), foundation.derivative(r), foundation.wavenumber_derivative(r)]
        }),
        ("profile --outer 42 --wavenumber 0.2 --antiscreened --dimension 3 --count 50", &|r| {
            [solid_foundation.value(r), solid_foundation.derivative(r), solid_foundation.wavenumber_derivative(r)]
        }),
    ];
    for (arguments, expected) in cases {
        let (names, units, rows) = table(arguments);
        assert_eq!(names, ["radius", "radial_displacement", "derivative", "wavenumber_derivative"]);
        assert_eq!(units, ["length", "length", "1", "length^2"]);
        assert_eq!((rows.len(), rows[0][0], rows[49][0]), (50, 0.5, 42.0));
        for row in rows {
            assert_eq!(bits(&row[1..]), bits(&expected(row[0])), "{arguments}");
        }
    }
    // 0.3 + (0.9 − 0.3) is more than 0.9: a table ends at the rim itself.
    for (inner, outer) in [(0.3, 0.9), (0.1, 0.7), (0.7, 42.1)] {
        let (_, _, rows) = table(&format!("profile --inner {inner} --outer {outer} --count 7"));
        assert!(rows[0][0] == inner && rows[6][0] == outer && rows.iter().flatten().all(|number| number.is_finite()));
    }
    let (_, _, rows) = table("profile --outer 42 --radii 3,0.5,41.9");
    assert_eq!(rows.iter().map(|row| row[0]).collect::<Vec<_>>(), [3.0, 0.5, 41.9]);
}

#[test]
fn poles_and_their_residues_are_those_of_the_library_to_the_last_bit() {
    let annulus = Annulus::new(1.0, 20.0).expect("valid");
    let (plane, space) = (Amplitude::<2>::new(annulus), Amplitude::<3>::new(annulus));
    let of_plane = |n: usize| (pole::<2>(annulus, n), plane.residue(n));
    let of_space = |n: usize| (pole::<3>(annulus, n), space.residue(n));
    for (dimension, of) in [(2, &of_plane as &dyn Fn(usize) -> (f64, f64)), (3, &of_space)] {
        let (names, units, rows) = table(&format!("poles --inner 1 --outer 20 --count 7 --dimension {dimension}"));
        assert_eq!(names, ["pole", "wavenumber", "rim_argument", "amplitude_residue"]);
        assert_eq!(units, ["1", "1/length", "1", "1/length"]);
        assert_eq!(rows.len(), 7);
        for (index, row) in (1..).zip(rows) {
            let (wavenumber, residue) = of(index);
            assert_eq!(bits(&row), bits(&[index as f64, wavenumber, 20.0 * wavenumber, residue]));
        }
    }
    // 67352 disks, R/a = 340.
    let (_, _, rows) = table("poles --count 2");
    assert!((rows[0][2] - 3.831808108).abs() < 5e-10 && (rows[1][2] - 7.015923260).abs() < 5e-10);
}

#[test]
fn amplitudes_are_those_of_the_library_and_poles_are_rows_with_their_number() {
    let annulus = Annulus::new(0.5, 42.0).expect("valid");
    let (plane, space) = (Amplitude::<2>::new(annulus), Amplitude::<3>::new(annulus));
    let of_plane = |wavenumber: f64| plane.at(wavenumber).expect("no pole");
    let of_space = |wavenumber: f64| space.at(wavenumber).expect("no pole");
    for (dimension, of) in [(2, &of_plane as &dyn Fn(f64) -> f64), (3, &of_space)] {
        let (names, units, rows) = table(&format!("amplitude --outer 42 --dimension {dimension} --count 31"));
        assert_eq!(names, ["wavenumber", "pole", "amplitude"]);
        assert_eq!(units, ["1/length", "1", "1"]);
        assert_eq!((rows.len(), rows[0][2], rows[30][0]), (31, 1.0, 10.0 / 41.5));
        // The two poles below 10/(R − a) turn the sign.
        assert_eq!(rows.windows(2).filter(|pair| pair[0][2] * pair[1][2] < 0.0).count(), 2);
        for row in rows {
            assert_eq!(bits(&row), bits(&[row[0], 0.0, of(row[0])]));
        }
    }
    let second = pole::<2>(annulus, 2);
    let (_, _, rows) = table(&format!("amplitude --outer 42 --wavenumbers 0.3,{second:e},0"));
    assert_eq!(bits(&rows[0]), bits(&[0.3, 0.0, of_plane(0.3)]));
    assert!(rows[1][0] == second && rows[1][1] == 2.0 && rows[1][2].is_nan());
    assert_eq!(rows[2], [0.0, 0.0, 1.0]);
    let (_, _, rows) = table("amplitude --outer 42 --from 0.01 --to 0.05 --count 3");
    assert_eq!(bits(&[rows[0][0], rows[2][0]]), bits(&[0.01, 0.05]));
}

#[test]
fn angular_modes_are_those_of_the_library_to_the_last_bit() {
    let annulus = Annulus::new(0.5, 42.0).expect("valid");
    let ellipse = ModeAmplitudes { radial: Complex::new(0.1, 0.02), transverse: Complex::new(0.0, -0.3) };
    let inflation = ModeAmplitudes::in_phase(0.1, 0.0);
    let elastic = ElasticMode::new(annulus, 0.3, 2, ellipse).expect("valid");
    let screened = |screening, mode, boundary| ScreenedMode::new(annulus, -0.2, screening, mode, boundary);
    let both = screened(Screening { even: -0.01, odd: 0.02 }, 2, ellipse).expect("no pole");
    let odd = screened(Screening { even: 0.0, odd: 0.02 }, 0, inflation).expect("no pole");
    let wave = screened(Screening::from_wavenumber(0.03, -0.2), 0, inflation).expect("no pole");
    let amplitudes = "--radial 0.1+0.02i --transverse -0.3i";
    for (arguments, medium, condition) in [
        (format!("--mode 2 --poisson 0.3 {amplitudes}"), &elastic as &dyn AngularSolution, None),
        (format!("--mode 2 --poisson -0.2 {amplitudes} --even -0.01 --odd 0.02"), &both, Some(both.condition())),
        ("--mode 0 --poisson -0.2 --radial 0.1 --odd 0.02".into(), &odd, Some(odd.condition())),
        ("--mode 0 --poisson -0.2 --radial 0.1 --wavenumber 0.03".into(), &wave, Some(wave.condition())),
    ] {
        let (names, units, rows) = table(&format!("mode --outer 42 --count 9 {arguments}"));
        assert_eq!(
            names[..5],
            ["radius", "radial_real", "radial_imaginary", "transverse_real", "transverse_imaginary"]
        );
        assert!(names[5..9].iter().zip(&names[1..5]).all(|(slope, name)| {
            *slope == name.replace("_real", "_derivative_real").replace("_imaginary", "_derivative_imaginary")
        }));
        assert_eq!(units[..9], ["length", "length", "length", "length", "length", "1", "1", "1", "1"]);
        assert_eq!(names[9..], condition.map_or(vec![], |_| vec!["condition"]));
        assert_eq!((rows.len(), rows[0][0], rows[8][0]), (9, 0.5, 42.0));
        for row in rows {
            let state = medium.at(row[0]);
            let parts = |pair: ModeAmplitudes| [pair.radial.re, pair.radial.im, pair.transverse.re, pair.transverse.im];
            let expected = [&parts(state.value)[..], &parts(state.derivative), condition.as_slice()].concat();
            assert_eq!(bits(&row[1..]), bits(&expected), "{arguments}");
        }
    }
}

#[test]
fn bessel_functions_are_those_of_the_library_to_the_last_bit() {
    type Function = fn(f64) -> f64;
    let functions: [(&str, [Function; 2]); 12] = [
        ("--kind j", [cylinder::j0, cylinder::j1]),
        ("--kind y", [cylinder::y0, cylinder::y1]),
        ("--kind i", [modified::i0, modified::i1]),
        ("--kind k", [modified::k0, modified::k1]),
        ("--kind i --scaled", [modified::i0_scaled, modified::i1_scaled]),
        ("--kind k --scaled", [modified::k0_scaled, modified::k1_scaled]),
        ("--kind j --spherical", [spherical::j0, spherical::j1]),
        ("--kind y --spherical", [spherical::y0, spherical::y1]),
        ("--kind i --spherical", [spherical::i0, spherical::i1]),
        ("--kind k --spherical", [spherical::k0, spherical::k1]),
        ("--kind i --spherical --scaled", [spherical::i0_scaled, spherical::i1_scaled]),
        ("--kind k --spherical --scaled", [spherical::k0_scaled, spherical::k1_scaled]),
    ];
    for (kind, orders) in functions {
        for (order, function) in orders.into_iter().enumerate() {
            let (names, units, rows) = table(&format!("bessel {kind} --order {order} --arguments 0.3,7,1e3,0"));
            assert_eq!((names, units), (vec!["argument".into(), "value".into()], vec!["1".to_string(), "1".into()]));
            assert_eq!(rows.len(), 4);
            for (row, x) in rows.iter().zip([0.3, 7.0, 1e3, 0.0]) {
                assert_eq!(bits(row), bits(&[x, function(x)]), "{kind}, order {order}");
            }
        }
    }
    let (_, _, rows) = table("bessel --kind j --order 1 --arguments -0.3");
    assert_eq!(rows[0][1], -cylinder::j1(0.3));
}

#[test]
fn the_lorentzian_is_that_of_the_library_to_the_last_bit() {
    let medium = Lorentzian::new(5.0, 1.5).expect("valid");
    let (names, units, rows) = table("lorentzian --frequency 5 --count 9");
    assert_eq!(names, ["angle", "correlation", "derivative"]);
    assert_eq!(units, ["rad", "1", "1/rad"]);
    assert_eq!((rows.len(), rows[0][1], rows[8][0]), (9, 1.0, std::f64::consts::PI));
    // A cusp: NaN is printed, not dropped.
    assert!(rows[0][2].is_nan());
    for row in &rows[1..] {
        assert_eq!(bits(row), bits(&[row[0], medium.correlation(row[0]), medium.derivative(row[0])]));
    }
    let (_, _, rows) = table("lorentzian --frequency 5 --exponent 2.5 --angles -0.3,7");
    let steep = Lorentzian::new(5.0, 2.5).expect("valid");
    for (row, angle) in rows.iter().zip([-0.3, 7.0]) {
        assert_eq!(bits(row), bits(&[angle, steep.correlation(angle), steep.derivative(angle)]));
    }
    let (names, _, rows) = table("lorentzian --frequency 5 --spectrum 12");
    assert_eq!(names, ["frequency", "spectrum", "share"]);
    for (f, row) in (1..=12).zip(rows) {
        let value = medium.spectrum(f64::from(f));
        assert_eq!(bits(&row), bits(&[f64::from(f), value, value / medium.total()]));
    }
}

#[test]
fn threshold_angles_and_both_limits_are_printed() {
    let (names, _, rows) = table("lorentzian --frequency 0 --thresholds 0.1,-0.9");
    assert_eq!(names, ["threshold", "crosses", "angle"]);
    assert!((rows[0][2] / std::f64::consts::PI - 0.303004).abs() < 5e-7);
    assert!(rows[0][1] == 1.0 && rows[1][1] == 0.0 && rows[1][2].is_nan());
    let (names, _, rows) = table("lorentzian --frequency inf --thresholds 0.1");
    assert_eq!(names, ["threshold", "crosses", "reduced_angle"]);
    assert!((rows[0][2] - 1.681334).abs() < 5e-7);
    let limit = ContinuumLorentzian::new(1.5).expect("valid");
    let (_, units, rows) = table("lorentzian --frequency inf --angles 2.5");
    assert_eq!(units, ["1", "1", "1"]);
    assert_eq!(bits(&rows[0]), bits(&[2.5, limit.correlation(2.5), limit.derivative(2.5)]));
}

#[test]
fn numbers_have_seventeen_digits_and_json_has_the_same() {
    for arguments in [
        "profile --count 4",
        "poles --count 4",
        "amplitude --count 4",
        "mode --mode 1 --poisson 0.3 --radial 0.1 --wavenumber 0.01 --count 4",
        "bessel --kind k --order 0 --arguments 0,1,2",
        "lorentzian --frequency 5 --count 4",
    ] {
        let (names, units, rows) = table(arguments);
        let text = String::from_utf8(exact(arguments).stdout).expect("Unicode");
        for cell in text.lines().skip(2).flat_map(|line| line.split(',')) {
            // A count, NaN, inf, or d.dddddddddddddddde±d.
            let mantissa = cell.trim_start_matches('-').split('e').next().expect("a first part");
            assert!(cell == "NaN" || !cell.contains('.') || mantissa.len() == 18, "{cell}");
        }
        let output = exact(&format!("{arguments} --json"));
        let json: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        assert_eq!(json["solution"], arguments.split(' ').next().expect("a name"));
        for (column, (name, unit)) in json["columns"].as_array().expect("columns").iter().zip(names.iter().zip(&units))
        {
            assert_eq!((&column["name"], &column["unit"]), (&Value::from(name.as_str()), &Value::from(unit.as_str())));
        }
        let found = json["rows"].as_array().expect("rows");
        assert_eq!(found.len(), rows.len());
        for (one, other) in found.iter().zip(&rows) {
            for (a, b) in one.as_array().expect("a row").iter().zip(other) {
                assert!(if !b.is_finite() { a.is_null() } else { a.as_f64() == Some(*b) }, "{a}, {b}");
            }
        }
    }
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    for format in ["", "--json"] {
        let mut program = Command::new(env!("CARGO_BIN_EXE_jamscope"))
            .args(["exact", "profile", "--count", "10000000000000"])
            .args((!format.is_empty()).then_some(format))
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let mut line = String::new();
        let mut reader = BufReader::new(program.stdout.take().expect("a pipe"));
        reader.read_line(&mut line).expect("a line");
        drop(reader);
        // Ends at once although years of rows are left; says nothing.
        let output = program.wait_with_output().expect("the program ends");
        assert!(output.status.success() && output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn bad_arguments_are_refused_by_name_and_value_and_nothing_is_printed() {
    let second = pole::<2>(Annulus::new(0.5, 170.0).expect("valid"), 2);
    let at_pole = format!("profile --wavenumber {second}");
    let mode_at_pole = format!("mode --mode 0 --poisson 0.3 --radial 0.1 --wavenumber {second}");
    for (arguments, parts) in [
        ("profile --inner -1", vec!["--inner -1", "positive"]),
        ("profile --inner 3 --outer 2", vec!["--outer 2", "larger"]),
        ("profile --amplitude nan", vec!["--amplitude NaN", "finite"]),
        ("profile --wavenumber -0.1", vec!["--wavenumber -0.1", "negative"]),
        (&at_pole, vec!["--wavenumber 0.0412", "pole number 2"]),
        ("profile --radii 1,171", vec!["--radii 171", "0.5 to 170"]),
        ("profile --radii -1,1", vec!["--radii -1"]),
        ("profile --radii nan", vec!["--radii NaN"]),
        ("profile --count 1", vec!["--count 1", "two"]),
        ("poles --count 0", vec!["--count 0"]),
        ("poles --outer inf", vec!["--outer inf"]),
        ("profile --antiscreened --wavenumber -0.1", vec!["--wavenumber -0.1", "negative"]),
        ("amplitude --wavenumbers 0.1,-0.2", vec!["--wavenumbers -0.2", "negative"]),
        ("amplitude --from nan", vec!["--from NaN", "finite"]),
        ("amplitude --to inf", vec!["--to inf", "finite"]),
        ("amplitude --from 0.2 --to 0.1", vec!["--to 0.1", "--from 0.2"]),
        ("amplitude --count 1", vec!["--count 1", "two"]),
        ("mode --mode 1 --poisson 1", vec!["--poisson 1", "between"]),
        ("mode --mode 1 --poisson 1 --wavenumber 0.1", vec!["--poisson 1", "between"]),
        ("mode --mode 1 --poisson 0.3 --radial inf", vec!["--radial inf", "finite"]),
        ("mode --mode 1 --poisson 0.3 --transverse 1e999i", vec!["--transverse 0+infi", "finite"]),
        ("mode --mode 1 --poisson 0.3 --even nan --odd 1", vec!["--even NaN", "finite"]),
        ("mode --mode 1 --poisson 0.3 --odd inf", vec!["--odd inf", "finite"]),
        ("mode --mode 1 --poisson 0.3 --wavenumber -0.1", vec!["--wavenumber -0.1", "negative"]),
        ("mode --mode 1000000 --poisson 0.3 --even 1", vec!["--mode 1000000", "nodes"]),
        (&mode_at_pole, vec!["--wavenumber 0.0412", "pole of mode 0"]),
        ("mode --mode 1 --poisson 0.3 --radii 171", vec!["--radii 171", "0.5 to 170"]),
        ("bessel --order 0 --kind j --arguments 1,nan", vec!["--arguments NaN", "number"]),
        ("bessel --order 0 --kind y --arguments 1,-2", vec!["--arguments -2", "below 0"]),
        ("bessel --order 0 --kind j --scaled --arguments 1", vec!["--scaled", "i and k"]),
        ("lorentzian --frequency -5", vec!["--frequency -5", "positive"]),
        ("lorentzian --frequency nan", vec!["--frequency NaN"]),
        ("lorentzian --frequency 5 --exponent 1", vec!["--exponent 1", "above 1"]),
        ("lorentzian --frequency 5 --angles 1,inf", vec!["--angles inf"]),
        ("lorentzian --frequency 5 --count 1", vec!["--count 1"]),
        ("lorentzian --frequency 5 --spectrum 0", vec!["--spectrum 0"]),
        ("lorentzian --frequency inf --spectrum 5", vec!["--spectrum", "--frequency inf"]),
        ("lorentzian --frequency 5 --thresholds 0.1,1.5", vec!["--thresholds 1.5", "below 1"]),
    ] {
        let output = exact(arguments);
        assert_eq!(output.status.code(), Some(1), "{arguments}");
        assert!(output.stdout.is_empty(), "{arguments}");
        let said = String::from_utf8(output.stderr).expect("Unicode");
        for part in parts {
            assert!(said.contains(part), "{arguments}: no {part:?} in {said}");
        }
    }
    // What cannot be read at all ends as in every other command.
    for (arguments, part) in [
        ("profile --dimension 4", "'4'"),
        ("profile --radii 1,x", "'x'"),
        ("profile --radii 1 --count 5", "--count"),
        ("amplitude --wavenumbers 0.1 --to 5", "--to"),
        ("mode --mode 1", "--poisson"),
        ("mode --mode -1 --poisson 0.3", "-1"),
        ("mode --mode 1 --poisson 0.3 --radial x", "'x'"),
        ("mode --mode 1 --poisson 0.3 --even 1 --wavenumber 1", "--wavenumber"),
        ("bessel --order 2 --kind j --arguments 1", "'2'"),
        ("bessel --order 1 --kind q --arguments 1", "'q'"),
        ("bessel --order 1 --kind j", "--arguments"),
        ("lorentzian", "--frequency"),
        ("lorentzian --frequency 5 --spectrum 3 --thresholds 0.1", "--thresholds"),
        ("zeta", "zeta"),
    ] {
        let output = exact(arguments);
        let said = String::from_utf8(output.stderr).expect("Unicode");
        assert!(output.status.code() == Some(2) && said.contains(part), "{arguments}: {said}");
    }
}
