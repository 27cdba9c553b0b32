//! Rows in a file that outlives a killed run: the plan in the first line, one sample in each further one.

use std::error::Error;
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use crate::sample::{Plan, Row};

/// The file.
pub struct Store {
    path: PathBuf,
    file: Mutex<File>,
}

impl Store {
    /// Opens or makes `samples.jsonl` of a folder; refuses one of another plan.
    pub fn open(folder: &Path, plan: &Plan) -> Result<Self, Box<dyn Error>> {
        std::fs::create_dir_all(folder)?;
        let path = folder.join("samples.jsonl");
        let text = if path.exists() { std::fs::read_to_string(&path)? } else { String::new() };
        let mut file = OpenOptions::new().create(true).append(true).open(&path)?;
        match text.lines().next() {
            None => writeln!(file, "{}", serde_json::to_string(plan)?)?,
            Some(line) if serde_json::from_str::<Plan>(line)? == *plan => {
                // A row cut short by a kill: what follows begins a line of its own.
                if !text.ends_with('\n') {
                    writeln!(file)?;
                }
            }
            Some(_) => return Err(format!("{} has samples of another plan", path.display()).into()),
        }
        Ok(Store { path, file: Mutex::new(file) })
    }

    /// Adds a row, in one write.
    pub fn append(&self, row: &Row) -> Result<(), String> {
        let line = serde_json::to_string(row).map_err(|error| error.to_string())? + "\n";
        let mut file = self.file.lock().map_err(|error| error.to_string())?;
        file.write_all(line.as_bytes()).map_err(|error| error.to_string())
    }

    /// The rows so far; lines cut short are none.
    pub fn rows(&self) -> Result<Vec<Row>, Box<dyn Error>> {
        let text = std::fs::read_to_string(&self.path)?;
        Ok(text.lines().skip(1).filter_map(|line| serde_json::from_str(line).ok()).collect())
    }
}
