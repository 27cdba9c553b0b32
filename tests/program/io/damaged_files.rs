//! Files cut or altered at random: never a panic, never a packing that the whole file does not hold.

use std::fs;
use std::sync::LazyLock;

use crate::seeds::config;
use jamscope::io::{Column, Contents, Frame, ReadError, ReadWarning, read_contents, read_packing, write_packing};
use jamscope::packing::{Domain, Packing};
use proptest::prelude::*;

use super::{Scratch, fixture};

/// A packing with every column the writer knows.
fn written() -> String {
    let scratch = Scratch::new();
    let packing = Packing::<2>::new(Domain::cube(9.0), vec![[64.5, 2.0], [2.1, -0.25]], vec![0.5, 0.7])
        .and_then(|packing| packing.with_corrections(vec![[1e-16, 0.0], [0.0, 1e-18]]))
        .and_then(|packing| packing.with_held(vec![true, false]))
        .and_then(|packing| packing.with_labels(vec![11, 7]))
        .expect("valid packing");
    let column = Column { name: "displacement", width: 2, values: &[0.25, 1e-7, 0.125, 3.0] };
    write_packing(scratch.path(), &packing, &[column], &[("command", "a \"b\" c"), ("seed", "11")]).expect("writable");
    fs::read_to_string(scratch.path()).expect("text")
}

fn whole_files() -> &'static [String] {
    static FILES: LazyLock<Vec<String>> = LazyLock::new(|| {
        let names = ["disks.data", "disks_wrapped.dump", "disks_scaled.dump", "disks_two_frames.dump"];
        let read = |name| fs::read_to_string(fixture("formats").join(name)).expect("fixture");
        names.into_iter().map(read).chain([written()]).collect()
    });
    &FILES
}

/// What is read of a text.
fn contents(scratch: &Scratch, text: &str) -> Result<Contents<2>, ReadError> {
    fs::write(scratch.path(), text).expect("writable folder");
    read_contents(scratch.path(), Frame::Last)
}

/// Whether the reader warns that the last number may have been cut.
fn warns(contents: &Contents<2>) -> bool {
    contents.warnings.iter().any(|warning| matches!(warning, ReadWarning::LastLineOpen { .. }))
}

#[test]
fn a_file_with_one_frame_is_refused_wherever_it_is_cut_before_its_last_number() {
    let scratch = Scratch::new();
    for text in [written(), whole_files()[1].clone(), whole_files()[2].clone()] {
        let last = text.trim_end().rfind(' ').expect("several columns");
        for end in 0..text.len() {
            if let Ok(cut) = contents(&scratch, &text[..end]) {
                assert!(end > last && warns(&cut), "cut after {end} bytes: {:?}", &text[..end]);
            }
        }
        assert!(scratch.read::<2>(&text).is_ok());
    }
}

#[test]
fn a_data_file_is_read_whole_or_refused_wherever_it_is_cut() {
    let scratch = Scratch::new();
    let text = &whole_files()[0];
    let whole = scratch.read::<2>(text).expect("whole file");
    let velocities = text.find("\nVelocities").expect("a section after the disks");
    for end in 0..text.len() {
        let is_open = !text[..end].ends_with('\n');
        match contents(&scratch, &text[..end]) {
            Ok(cut) if is_open => assert!(warns(&cut), "cut after {end} bytes"),
            Ok(cut) => assert!(end >= velocities && cut.packing == whole, "cut after {end} bytes"),
            Err(error) => assert!(end <= velocities, "cut after {end}: {error}"),
        }
    }
}

/// Words that break what counts on numbers, keys or lines.
const WORDS: [&str; 22] = [
    "nan",
    "inf",
    "-1",
    "0",
    "1e999",
    "-1e308",
    "1e308",
    "18446744073709551616",
    "\"",
    "'",
    "[",
    "}",
    "=",
    "\\",
    "é",
    "#",
    ":",
    "\n",
    "\n\n",
    "ITEM:",
    "Atoms",
    "pbc=F",
];

#[derive(Debug, Clone)]
enum Damage {
    Cut(usize),
    Byte(usize, u8),
    Word(usize, usize),
    RemoveLine(usize),
    RepeatLine(usize),
}

fn damage() -> impl Strategy<Value = Damage> {
    let place = 0..10_000usize;
    prop_oneof![
        place.clone().prop_map(Damage::Cut),
        (place.clone(), any::<u8>()).prop_map(|(at, byte)| Damage::Byte(at, byte)),
        (place.clone(), 0..WORDS.len()).prop_map(|(at, word)| Damage::Word(at, word)),
        (place.clone(), 0..WORDS.len()).prop_map(|(at, word)| Damage::Word(at, word)),
        place.clone().prop_map(Damage::RemoveLine),
        place.prop_map(Damage::RepeatLine),
    ]
}

fn damaged(text: &[u8], damage: &Damage) -> Vec<u8> {
    let mut bytes = text.to_vec();
    let length = bytes.len().max(1);
    let mut lines: Vec<&[u8]> = text.split_inclusive(|&byte| byte == b'\n').collect();
    let count = lines.len().max(1);
    match *damage {
        Damage::Cut(at) => bytes.truncate(at % length),
        Damage::Byte(at, byte) => {
            if let Some(place) = bytes.get_mut(at % length) {
                *place = byte;
            }
        }
        Damage::Word(at, word) => {
            // In the place of the word that stands there.
            let start = text.iter().take(at % length).rposition(u8::is_ascii_whitespace).map_or(0, |place| place + 1);
            let end = text[start..].iter().position(u8::is_ascii_whitespace).map_or(text.len(), |to| start + to);
            bytes.splice(start..end, WORDS[word].bytes());
        }
        Damage::RemoveLine(at) => {
            if !lines.is_empty() {
                lines.remove(at % count);
            }
            bytes = lines.concat();
        }
        Damage::RepeatLine(at) => {
            if let Some(line) = lines.get(at % count).copied() {
                lines.insert(at % count, line);
            }
            bytes = lines.concat();
        }
    }
    bytes
}

fn check<const D: usize>(scratch: &Scratch) -> Result<(), TestCaseError> {
    match read_packing::<D>(scratch.path()) {
        Ok(packing) => {
            prop_assert!(packing.radii().iter().all(|&radius| radius > 0.0 && radius.is_finite()));
            let vectors = packing.positions().iter().chain(packing.corrections());
            prop_assert!(vectors.flatten().all(|value| value.is_finite()));
        }
        Err(error) => prop_assert!(error.to_string().contains("packing.txt"), "{error}"),
    }
    Ok(())
}

proptest! {
    #![proptest_config(config(3000, 21))]

    #[test]
    fn no_damage_makes_the_reader_panic(file in 0..5usize, damages in prop::collection::vec(damage(), 1..4)) {
        let scratch = Scratch::new();
        let mut bytes = whole_files()[file].clone().into_bytes();
        for damage in &damages {
            bytes = damaged(&bytes, damage);
        }
        fs::write(scratch.path(), &bytes).expect("writable folder");
        check::<2>(&scratch)?;
        check::<3>(&scratch)?;
    }
}
