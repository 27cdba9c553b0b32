//! The program itself, started with a file that was mutated.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

use super::subjects::nameless;
use super::{Fault, TIME_LIMIT, corpus};

/// `jamscope inspect FILE`.
pub fn inspect(path: &Path) -> Fault {
    started(&["inspect".as_ref(), path], path)
}

/// `jamscope analyse BEFORE FILE`, the state before as the run wrote it.
pub fn analyse(path: &Path) -> Fault {
    static BEFORE: std::sync::OnceLock<Vec<u8>> = std::sync::OnceLock::new();
    let before = path.with_file_name("case.before.xyz");
    std::fs::write(&before, BEFORE.get_or_init(|| corpus::run_files().swap_remove(0))).ok()?;
    let out = path.with_file_name("out");
    started(&["analyse".as_ref(), &before, path, "--out".as_ref(), &out], path)
}

/// `jamscope study FILE --dry-run`.
pub fn plan(path: &Path) -> Fault {
    let out = path.with_file_name("out");
    started(&["study".as_ref(), path, "--dry-run".as_ref(), "--out".as_ref(), &out], path)
}

/// Starts the program; a refusal has to name the file, and to end with an exit code of its own.
fn started(arguments: &[&Path], path: &Path) -> Fault {
    let errors = path.with_file_name("errors.txt");
    let file = std::fs::File::create(&errors).ok()?;
    let mut program = Command::new(env!("CARGO_BIN_EXE_jamscope"));
    let program = program.args(arguments).stdin(Stdio::null()).stdout(Stdio::null()).stderr(file);
    let mut child = program.spawn().ok()?;
    let start = Instant::now();
    let status = loop {
        match child.try_wait() {
            Ok(Some(status)) => break status,
            _ if start.elapsed() + std::time::Duration::from_millis(500) > TIME_LIMIT => {
                let _ = (child.kill(), child.wait());
                return Some(format!("nothing after {} s", start.elapsed().as_secs()));
            }
            _ => std::thread::sleep(std::time::Duration::from_millis(5)),
        }
    };
    let said = String::from_utf8_lossy(&std::fs::read(&errors).unwrap_or_default()).into_owned();
    match status.code() {
        Some(0) => None,
        // Not the one of a panic.
        Some(code) if code != 101 => nameless(&said, path, &[": "]),
        _ => Some(format!("{status}: {said}")),
    }
}
