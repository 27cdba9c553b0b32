//! The tables of the book that rest on `fixtures/ensembles`, and the calibration of phases: both are written where they stand.
//!
//! ```text
//! cargo run --release --features measurements --example ensemble_tables
//! ```

#[path = "../../tests/program/ensembles/tables.rs"]
mod tables;

use std::error::Error;

use tables::{CHAPTERS, Ensemble, calibration, filled, tables};

fn main() -> Result<(), Box<dyn Error>> {
    let mut archives = Vec::new();
    for entry in std::fs::read_dir("fixtures/ensembles")? {
        let path = entry?.path();
        if path.to_string_lossy().ends_with(".jsonl.gz") {
            archives.push(path);
        }
    }
    archives.sort();
    let mut ensembles = Vec::new();
    for path in &archives {
        let folder = tempfile::tempdir()?;
        ensembles.push(Ensemble::read(path, folder.path()));
    }
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
