//! The program itself, started with a file that was mutated.

use std::io::{Read, Seek};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

use super::subjects::{PACKING_FIELDS, nameless, nameless_scene};
use super::{Fault, TIME_LIMIT, corpus};

/// `jamscope inspect FILE`.
pub fn inspect(path: &Path) -> Fault {
    started(&["inspect".as_ref(), path], |said| nameless(said, path, &PACKING_FIELDS))
}

/// `jamscope analyse BEFORE FILE`, the state before as the run wrote it.
pub fn analyse(path: &Path) -> Fault {
    static BEFORE: std::sync::OnceLock<Vec<u8>> = std::sync::OnceLock::new();
    let before = path.with_file_name("case.before.xyz");
    let text = BEFORE.get_or_init(|| corpus::run_files().swap_remove(0));
    std::fs::write(&before, text).expect("a temporary file");
    let out = path.with_file_name("out");
    let fields = ["box ", "disk ", "disks ", "label", "radius", "law", "stiffness", "no known format", "empty"];
    started(&["analyse".as_ref(), &before, path, "--out".as_ref(), &out], |said| nameless(said, path, &fields))
}

/// `jamscope study FILE --dry-run`.
pub fn plan(path: &Path) -> Fault {
    let out = path.with_file_name("out");
    started(&["study".as_ref(), path, "--dry-run".as_ref(), "--out".as_ref(), &out], |said| nameless_scene(said, path))
}

/// Starts the program; `judge` tells what is wrong with a refusal.
fn started(arguments: &[&Path], judge: impl Fn(&str) -> Fault) -> Fault {
    let mut errors = tempfile::tempfile().expect("a temporary file");
    let mut program = Command::new(env!("CARGO_BIN_EXE_jamscope"));
    let program = program
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(errors.try_clone().expect("a file that is open"));
    let mut child = program.spawn().expect("the program starts");
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
    let mut said = Vec::new();
    errors.rewind().and_then(|()| errors.read_to_end(&mut said)).expect("a file that can be read");
    let said = String::from_utf8_lossy(&said);
    match status.code() {
        Some(1 | 2) => judge(&said),
        // A panic, or a signal.
        Some(101) | None => Some(format!("{status}: {said}")),
        // All is well, or an outcome that has a code of its own.
        Some(_) => None,
    }
}
