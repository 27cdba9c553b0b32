//! [`Inputs`]: files given on the command line, which may be the standard input or a pipe, and their frames.

use std::fs::File;
use std::path::{Path, PathBuf};

use jamscope::io::{Frame, check_place, frame_count, try_name};
use tempfile::TempDir;

use crate::Failure;

/// Files given on the command line. A pipe can be read only once, so its content is copied to a temporary file, which
/// is removed at the end.
#[derive(Default)]
pub struct Inputs {
    /// The folder of a copy, the copy, and what it is a copy of.
    copies: Vec<(TempDir, PathBuf, PathBuf)>,
    has_standard: bool,
}

impl Inputs {
    /// The file itself, or a copy of the standard input (`-`) or of a pipe.
    pub fn file(&mut self, path: &Path) -> Result<PathBuf, Failure> {
        let is_standard = path == Path::new("-");
        if !is_standard && !is_pipe(path) {
            return Ok(path.to_path_buf());
        }
        if is_standard && std::mem::replace(&mut self.has_standard, true) {
            return Err("`-`, the standard input, is given twice".into());
        }
        let folder = tempfile::tempdir()?;
        let name = if is_standard { "standard-input" } else { "pipe" };
        let copy = folder.path().join(name);
        let failed = |error| format!("{}: {error}", path.display());
        let mut file = File::create(&copy)?;
        let copied = if is_standard {
            std::io::copy(&mut std::io::stdin().lock(), &mut file)
        } else {
            File::open(path).and_then(|mut pipe| std::io::copy(&mut pipe, &mut file))
        };
        copied.map_err(failed)?;
        self.copies.push((folder, copy.clone(), path.to_path_buf()));
        Ok(copy)
    }

    /// A text with the names that the user gave in place of those of the copies.
    pub fn with_given_names(&self, mut text: String) -> String {
        for (_, copy, given) in &self.copies {
            let shown = if given == Path::new("-") { "standard input".into() } else { given.display().to_string() };
            text = text.replace(&copy.display().to_string(), &shown);
        }
        text
    }

    /// The result, with the names that the user gave in its error.
    pub fn named<T>(&self, result: Result<T, Failure>) -> Result<T, Failure> {
        match result {
            Err(error) if !self.copies.is_empty() => Err(self.with_given_names(error.to_string()).into()),
            other => other,
        }
    }
}

/// Whether a path is neither a file nor a folder. A path that does not exist is left to its reader.
fn is_pipe(path: &Path) -> bool {
    path.metadata().is_ok_and(|it| !it.is_file() && !it.is_dir())
}

/// Frames of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Frames {
    /// One of them.
    One(Frame),
    /// All of them.
    All,
}

impl Frames {
    /// The frames of a file.
    pub fn of(self, path: &Path) -> Result<Vec<Frame>, Failure> {
        match self {
            Frames::One(frame) => Ok(vec![frame]),
            Frames::All => Ok((0..frame_count(path)?).map(Frame::Index).collect()),
        }
    }
}

/// `last`, or the number of a frame, from 0.
pub fn frame(text: &str) -> Result<Frame, String> {
    match text {
        "last" => Ok(Frame::Last),
        number => number.parse().map(Frame::Index).map_err(|_| "not `last` or the number of a frame, from 0".into()),
    }
}

/// `last`, `all`, or the number of a frame, from 0.
pub fn frames(text: &str) -> Result<Frames, String> {
    match text {
        "all" => Ok(Frames::All),
        one => frame(one).map(Frames::One).map_err(|_| "not `last`, `all` or the number of a frame, from 0".into()),
    }
}

/// Checks, before any work, whether a file can be written: in a folder that exists, and in place of no input.
pub fn check_output(out: &Path, input: &Path) -> Result<(), Failure> {
    let named = |reason: &dyn std::fmt::Display| format!("{}: {reason}", out.display());
    let folder = match out.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let name = out.file_name().ok_or_else(|| named(&"names no file"))?;
    check_place(out)?;
    try_name(folder, name).map_err(|error| named(&error))?;
    if let (Ok(out), Ok(input)) = (out.canonicalize(), input.canonicalize())
        && out == input
    {
        return Err(named(&"is the input; give another file with --out or --write").into());
    }
    Ok(())
}
