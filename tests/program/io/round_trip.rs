//! A packing written is read back to the same bits.

use crate::seeds::config;
use jamscope::io::{Column, read_packing, write_packing};
use jamscope::packing::{Domain, Packing};
use jamscope::vector::Vector;
use proptest::num::f64::{NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO};
use proptest::prelude::*;

use super::{Scratch, fixture};

/// Any finite number.
fn finite() -> impl Strategy<Value = f64> {
    POSITIVE | NEGATIVE | NORMAL | SUBNORMAL | ZERO
}

fn positive() -> impl Strategy<Value = f64> {
    POSITIVE | NORMAL | SUBNORMAL
}

fn domain<const D: usize>() -> impl Strategy<Value = Domain<D>> {
    let side = prop_oneof![positive(), 1.0..1e3];
    let corner = prop_oneof![Just(0.0), Just(-0.0), -1e5..1e5];
    let sides = (prop::array::uniform::<_, D>(corner), prop::array::uniform::<_, D>(side));
    // A corner in sides of the box, at most a million of them.
    let tilts = prop::array::uniform::<_, D>(prop_oneof![Just(0.0), -2.0..2.0f64]);
    let sides = (sides.0, sides.1, tilts);
    let periodic = |(corner, lengths, tilts): (Vector<D>, Vector<D>, Vector<D>)| Domain::Periodic {
        corner: std::array::from_fn(|axis| corner[axis] * lengths[axis].min(1e300)),
        edges: std::array::from_fn(|d| {
            std::array::from_fn(|axis| match axis.cmp(&d) {
                std::cmp::Ordering::Less => tilts[d] * lengths[axis].min(1e300),
                std::cmp::Ordering::Equal => lengths[d],
                std::cmp::Ordering::Greater => 0.0,
            })
        }),
    };
    prop_oneof![Just(Domain::Open), sides.prop_map(periodic)]
}

/// Position over 10⁶ radii, low part in units of 2⁻⁵⁴ of it, radius over the largest, held, label.
type Row<const D: usize> = (Vector<D>, Vector<D>, f64, bool, u64);

fn row<const D: usize>() -> impl Strategy<Value = Row<D>> {
    // Down to subnormal numbers, up to what a file may hold.
    let coordinate = prop_oneof![finite().prop_map(|x| if x.abs() < 1.0 { x } else { 1.0 / x }), -1e-3..1e-3];
    let low = prop_oneof![Just(0.0), -1.0..1.0];
    let label = prop_oneof![any::<u64>(), 0..4u64];
    (prop::array::uniform::<_, D>(coordinate), prop::array::uniform::<_, D>(low), 0.1..1.0, any::<bool>(), label)
}

fn packing<const D: usize>() -> impl Strategy<Value = Packing<D>> {
    let flags = (any::<bool>(), any::<bool>(), any::<bool>(), any::<bool>(), any::<bool>());
    let unit = prop_oneof![(-128.0..149.0f64).prop_map(|power| 10f64.powf(power)), 0.1..1.0];
    (domain(), prop::collection::vec(row::<D>(), 1..12), unit, flags).prop_map(
        |(domain, mut rows, unit, (corrected, held, labelled, tied, loaded))| {
            let largest = rows.iter().map(|row| row.2).fold(0.0, f64::max);
            for row in &mut rows {
                row.2 *= unit;
                row.0 = row.0.map(|x| x * 1e6 * (largest * unit));
            }
            let positions: Vec<_> = rows.iter().map(|row| row.0).collect();
            let radii = rows.iter().map(|row| row.2).collect();
            let mut packing = Packing::new(domain, positions, radii).expect("valid disks");
            if corrected {
                let low = |d: usize, row: &Row<D>| row.0[d] * (-54f64).exp2() * row.1[d];
                let corrections = rows.iter().map(|row| std::array::from_fn(|d| low(d, row))).collect();
                packing = packing.with_corrections(corrections).expect("finite corrections");
            }
            if held {
                packing = packing.with_held(rows.iter().map(|row| row.3).collect()).expect("a flag a disk");
            }
            if labelled {
                packing = packing.with_labels(rows.iter().map(|row| row.4).collect()).expect("a label a disk");
            }
            if tied {
                // Anywhere: away from the disks, with low parts of their own if those have some.
                let low = |d: usize, row: &Row<D>| if corrected { row.0[d] * (-60f64).exp2() * row.1[d] } else { 0.0 };
                let site = |row: &Row<D>| (row.0.map(|x| -0.5 * x), std::array::from_fn(|d| low(d, row)));
                packing = packing.with_sites(rows.iter().map(site).collect()).expect("a finite site a disk");
            }
            if loaded {
                packing = packing.with_loads(rows.iter().map(|row| row.1).collect()).expect("a finite load a disk");
            }
            packing
        },
    )
}

/// Everything there is in a packing, as bits (so that −0 differs from 0).
fn bits<const D: usize>(packing: &Packing<D>) -> Vec<u64> {
    let domain: Vec<f64> = match packing.domain() {
        Domain::Open => vec![],
        Domain::Periodic { corner, edges } => corner.iter().chain(edges.iter().flatten()).copied().collect(),
    };
    let vectors = packing.positions().iter().chain(packing.corrections()).flatten();
    let numbers = domain.iter().chain(vectors).chain(packing.radii()).map(|value| value.to_bits());
    let flags = packing.held().iter().map(|&held| held.into());
    let sites = packing.sites().into_iter().flatten().flat_map(|site| site.0.into_iter().chain(site.1));
    let sites = sites.map(f64::to_bits);
    let loads = packing.loads().into_iter().flatten().flatten().map(|value| value.to_bits());
    numbers.chain(flags).chain(packing.labels().iter().copied()).chain(sites).chain(loads).collect()
}

fn assert_round_trip<const D: usize>(packing: &Packing<D>) -> Result<(), TestCaseError> {
    let scratch = Scratch::new();
    write_packing(scratch.path(), packing, &[], &[]).expect("writable packing");
    let read = read_packing::<D>(scratch.path()).expect("what was written is read");
    prop_assert_eq!(bits(&read), bits(packing));
    prop_assert_eq!(read.domain(), packing.domain());
    Ok(())
}

proptest! {
    #![proptest_config(config(200, 20))]

    #[test]
    fn disks_come_back_to_the_same_bits(packing in packing::<2>()) {
        assert_round_trip(&packing)?;
    }

    #[test]
    fn balls_come_back_to_the_same_bits(packing in packing::<3>()) {
        assert_round_trip(&packing)?;
    }
}

#[test]
fn columns_and_properties_of_the_caller_do_not_disturb_the_packing() {
    let scratch = Scratch::new();
    let packing = Packing::<2>::new(Domain::cube(9.0), vec![[1.0, 2.0], [2.1, 2.0]], vec![0.5, 0.7]).expect("valid");
    let columns = [
        Column { name: "displacement", width: 2, values: &[0.1, -0.2, f64::NAN, 1e-300] },
        Column { name: "rattler", width: 1, values: &[0.0, 1.0] },
    ];
    let properties = [("law", "hertz"), ("command", r#"jamscope "a b" \ c=d"#), ("empty", ""), ("Z", "4.4")];
    write_packing(scratch.path(), &packing, &columns, &properties).expect("writable");
    assert_eq!(read_packing::<2>(scratch.path()).expect("readable"), packing);
    let text = std::fs::read_to_string(scratch.path()).expect("text");
    let expected = "2\n\
        Lattice=\"9.0 0.0 0.0 0.0 9.0 0.0 0.0 0.0 1.0\" Origin=\"0.0 0.0 0.0\" pbc=\"T T F\" \
        Properties=species:S:1:pos:R:3:radius:R:1:id:I:1:displacement:R:2:rattler:R:1 dimension=2 \
        law=hertz command=\"jamscope \\\"a b\\\" \\\\ c=d\" empty=\"\" Z=4.4\n\
        X 1.0 2.0 0.0 0.5 0 0.1 -0.2 0.0\n\
        X 2.1 2.0 0.0 0.7 1 NaN 1e-300 1.0\n";
    assert_eq!(text, expected);
}

#[test]
fn a_site_is_written_only_where_there_is_one_and_its_low_part_never_stands_alone() {
    let scratch = Scratch::new();
    let packing = Packing::<2>::new(Domain::cube(9.0), vec![[1.0, 2.0]], vec![0.5]).expect("valid");
    let with = packing.clone().with_sites(vec![([0.1, -2.0], [1e-18, 0.0])]).expect("finite");
    write_packing(scratch.path(), &with, &[], &[]).expect("writable");
    assert_eq!(read_packing::<2>(scratch.path()).expect("readable"), with);
    let text = std::fs::read_to_string(scratch.path()).expect("text");
    assert!(text.contains(":site:R:2:site_correction:R:2") && text.ends_with(" 0.1 -2.0 1e-18 0.0\n"), "{text}");
    let alone = "1\npbc=\"F F F\" Properties=pos:R:3:radius:R:1:site_correction:R:2\n0 0 0 0.5 0 0\n";
    let refused = scratch.read::<2>(alone).expect_err("no site").to_string();
    assert!(refused.contains("column site"), "{refused}");
    assert!(packing.with_sites(vec![([0.1, f64::NAN], [0.0; 2])]).is_err());
}

#[test]
fn columns_stand_in_any_order_and_unknown_ones_are_ignored() {
    let scratch = Scratch::new();
    let content = "2\n\
        PBC = [T, T, T] held_by=nobody Properties=held:L:1:id:I:1:force:R:2:radius:R:1:pos:R:2:species:S:1 \
        lattice='9 0 0 0 8 0 0 0 7' origin={-1 -2 0} converged\n\
        F 7 1 nan .5 1. 2e0 Small\n\
        T 3 3 nan 0.7 2.1 2 Large\n";
    let packing = scratch.read::<2>(content).expect("valid file");
    let domain = Domain::rectangular([-1.0, -2.0], [9.0, 8.0]);
    let expected = Packing::new(domain, vec![[1.0, 2.0], [2.1, 2.0]], vec![0.5, 0.7])
        .and_then(|packing| packing.with_labels(vec![7, 3]))
        .and_then(|packing| packing.with_held(vec![false, true]));
    assert_eq!(Ok(packing), expected);
}

#[test]
fn the_last_frame_is_taken_unless_another_is_asked_for() {
    use jamscope::io::{Frame, ReadError, read_frame};
    let scratch = Scratch::new();
    let frame = |x: &str| format!("1\npbc=\"F F F\" Properties=pos:R:3:radius:R:1\n{x} 0 0 0.5\n");
    let last = scratch.read::<2>(frame("1") + &frame("2") + "\n\n").expect("two frames");
    assert_eq!((last.positions(), last.domain()), (&[[2.0, 0.0]][..], &Domain::Open));
    let first = read_frame::<2>(scratch.path(), Frame::Index(0)).expect("first frame");
    assert_eq!(first.positions(), [[1.0, 0.0]]);
    let none = read_frame::<2>(scratch.path(), Frame::Index(2));
    assert!(matches!(none, Err(ReadError::NoSuchFrame { frame: 2, frame_count: 2, .. })));
}

#[test]
fn the_packings_of_the_repository_have_their_number_and_packing_fraction() {
    let text = std::fs::read_to_string(fixture("packings/expected.json")).expect("expected values");
    let expected: serde_json::Map<String, serde_json::Value> = serde_json::from_str(&text).expect("valid JSON");
    assert_eq!(expected.len(), 16);
    for (name, values) in expected {
        let packing = read_packing::<2>(fixture(&format!("packings/{name}.xyz"))).expect("valid packing");
        assert_eq!(values["N"].as_u64(), Some(packing.len() as u64), "{name}");
        assert_eq!(packing.domain(), &Domain::cube(values["L"].as_f64().expect("side")), "{name}");
        let fraction = packing.packing_fraction().expect("periodic");
        // A sum of N equal-sized terms, each rounded once: N · 2⁻⁵³ < 10⁻¹² for N = 5548.
        assert!((fraction - values["phi"].as_f64().expect("phi")).abs() < 1e-12, "{name}: {fraction}");
    }
}
