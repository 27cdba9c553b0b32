//! The tables of the chapter *Which dynamics make the plastic phase* and the calibration of phases, from `fixtures/ensembles`.
//!
//! ```text
//! cargo run --release --example ensemble_tables                  # the tables
//! cargo run --release --example ensemble_tables -- --calibration > src/response/calibration.json
//! ```

#[path = "../tests/program/ensembles/tables.rs"]
mod tables;

use std::error::Error;

use tables::{Ensemble, calibration, tables};

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
    if std::env::args().any(|argument| argument == "--calibration") {
        println!("{}", serde_json::to_string(&calibration(&ensembles))?);
        return Ok(());
    }
    for (title, table) in tables(&ensembles) {
        println!("{title}\n\n{table}");
    }
    Ok(())
}
