//! Packings to files and back, and what is said about files that are no packings.

mod contradictions;
mod damaged_files;
mod lammps;
mod lammps_data_written;
mod npz;
mod other_programs;
mod refusals;
mod round_trip;
mod tilted;
mod writing;

use std::path::PathBuf;

use jamscope::io::{ReadError, read_packing};
use jamscope::packing::Packing;
use tempfile::TempDir;

/// A file of the repository.
fn fixture(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name)
}

/// A folder that is gone with the value, and one file in it.
struct Scratch {
    folder: TempDir,
}

impl Scratch {
    fn new() -> Self {
        Scratch { folder: tempfile::tempdir().expect("a folder for temporary files") }
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("packing.txt")
    }

    fn read<const D: usize>(&self, content: impl AsRef<[u8]>) -> Result<Packing<D>, ReadError> {
        std::fs::write(self.path(), content).expect("writable folder");
        read_packing(self.path())
    }

    fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.folder.path()).expect("readable folder");
        entries.map(|entry| entry.expect("entry").file_name().to_string_lossy().into_owned()).collect()
    }
}
