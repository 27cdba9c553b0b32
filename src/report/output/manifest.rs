//! [`Manifest`]: the files that a report wrote into its folder.

use std::io::Write as _;
use std::path::Path;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::io::{WriteError, write_atomically};
use crate::report::error::ReportError;

/// The files of a report.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Manifest {
    jamscope_version: String,
    files: Vec<Entry>,
}

/// One file.
#[derive(Debug, Serialize, Deserialize)]
struct Entry {
    name: String,
    /// SHA-256 of its content in hexadecimal. Absent for wall times, so that two lists of one scene do not differ.
    #[serde(skip_serializing_if = "Option::is_none")]
    checksum: Option<String>,
}

/// The only file of a run that differs between runs.
const WALL_TIMES: &str = "timings.json";

impl Manifest {
    /// The list of these files in a folder.
    pub(super) fn of(folder: &Path, names: &[String]) -> Result<Self, ReportError> {
        let entry = |name: &String| {
            let path = folder.join(name);
            let checksum = match name == WALL_TIMES {
                true => None,
                false => Some(checksum(&path).map_err(|source| WriteError::Io { path, source })?),
            };
            Ok(Entry { name: name.clone(), checksum })
        };
        let files = names.iter().map(entry).collect::<Result<_, ReportError>>()?;
        Ok(Manifest { jamscope_version: env!("CARGO_PKG_VERSION").into(), files })
    }

    /// The list of a folder; none if there is no readable list.
    pub(super) fn read(path: &Path) -> Option<Self> {
        let manifest: Manifest = serde_json::from_slice(&std::fs::read(path).ok()?).ok()?;
        // A name must not lead out of the folder.
        let plain = |entry: &Entry| Path::new(&entry.name).file_name().is_some_and(|name| name == entry.name.as_str());
        manifest.files.iter().all(plain).then_some(manifest)
    }

    /// Writes the list.
    pub(super) fn write(&self, path: &Path) -> Result<(), ReportError> {
        let text =
            serde_json::to_string_pretty(self).map_err(|source| ReportError::Json { path: path.into(), source })?;
        Ok(write_atomically(path, |writer| writer.write_all((text + "\n").as_bytes()))?)
    }

    /// Whether a file belongs to the report.
    pub(super) fn lists(&self, name: &str) -> bool {
        self.files.iter().any(|entry| entry.name == name)
    }

    /// Names of the files in a folder that have not changed since the report.
    pub(super) fn unchanged<'a>(&'a self, folder: &'a Path) -> impl Iterator<Item = &'a str> {
        let as_written = |entry: &&Entry| {
            let path = folder.join(&entry.name);
            path.symlink_metadata().is_ok_and(|it| it.is_file())
                && entry.checksum.as_ref().is_none_or(|it| checksum(&path).is_ok_and(|found| found == *it))
        };
        self.files.iter().filter(as_written).map(|entry| entry.name.as_str())
    }
}

/// SHA-256 of a file in hexadecimal.
fn checksum(path: &Path) -> std::io::Result<String> {
    let mut file = std::fs::File::open(path)?;
    let mut state = Sha256::new();
    let mut buffer = vec![0; 1 << 16];
    loop {
        match std::io::Read::read(&mut file, &mut buffer)? {
            0 => return Ok(state.finalize().iter().map(|byte| format!("{byte:02x}")).collect()),
            count => state.update(&buffer[..count]),
        }
    }
}
