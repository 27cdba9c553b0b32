//! The tables of the book that rest on `fixtures/ensembles`, and the calibration of phases: both are written where they stand.
//!
//! ```text
//! cargo run --release --features measurements --example ensemble_tables
//! ```

#[path = "../../tests/program/ensembles/tables.rs"]
mod tables;

use std::error::Error;
use std::path::Path;

use tables::{CHAPTERS, calibration, ensembles, filled, tables};

fn main() -> Result<(), Box<dyn Error>> {
    let ensembles = ensembles(Path::new("fixtures/ensembles"));
    let tables = tables(&ensembles);
    let mut missing: Vec<&String> = tables.iter().map(|(title, _)| title).collect();
    for chapter in CHAPTERS {
        let path = format!("book/src/{chapter}");
        let (text, found) = filled(&std::fs::read_to_string(&path)?, &tables);
        std::fs::write(&path, text)?;
        missing.retain(|title| !found.contains(title));
    }
    for title in missing {
        println!("has no place in the book: <!-- {title} -->");
    }
    std::fs::write("src/response/calibration.json", serde_json::to_string(&calibration(&ensembles))? + "\n")?;
    Ok(())
}
