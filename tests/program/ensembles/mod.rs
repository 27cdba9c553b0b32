//! Tables of the book and the calibration of phases against the records of the ensembles they come from.

mod tables;

use std::path::Path;

use tables::{CHAPTERS, calibration, ensembles, filled, tables};

#[test]
#[ignore = "half a minute: CI runs it"]
fn tables_of_the_book_are_those_of_the_records() {
    let ensembles = ensembles(&Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/ensembles"));
    let book = Path::new(env!("CARGO_MANIFEST_DIR")).join("book/src");
    let tables = tables(&ensembles);
    let mut missing: Vec<&String> = tables.iter().map(|(title, _)| title).collect();
    for chapter in CHAPTERS {
        let text = std::fs::read_to_string(book.join(chapter)).expect("a chapter");
        let (expected, found) = filled(&text, &tables);
        assert_eq!(
            text, expected,
            "{chapter}; cargo run --release --features measurements --example ensemble_tables writes its tables"
        );
        missing.retain(|title| !found.contains(title));
    }
    assert!(missing.is_empty(), "not in the book: {missing:?}");
    let expected = serde_json::to_string(&calibration(&ensembles)).expect("JSON") + "\n";
    let found = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("src/response/calibration.json"));
    assert_eq!(found.expect("there"), expected, "the calibration is not that of the records");
}
