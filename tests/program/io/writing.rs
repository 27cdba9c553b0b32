//! Files are there whole or not at all, and what cannot be written is named.

use std::fs;
use std::io::{self, Write};

use jamscope::io::{Column, WriteError, write_atomically, write_packing};
use jamscope::packing::{Domain, Packing};

use super::Scratch;

#[test]
fn a_writer_that_fails_leaves_the_old_file_and_nothing_else() {
    let scratch = Scratch::new();
    fs::write(scratch.path(), "old").expect("writable folder");
    let result = write_atomically(scratch.path(), |writer| {
        writer.write_all(b"half of the new")?;
        writer.flush()?;
        Err(io::Error::other("no more numbers"))
    });
    let message = result.expect_err("the writer failed").to_string();
    assert!(message.contains("packing.txt") && message.contains("no more numbers"), "{message}");
    assert_eq!(fs::read_to_string(scratch.path()).expect("old file"), "old");
    assert_eq!(scratch.names(), ["packing.txt"]);
}

#[test]
fn a_file_is_replaced_as_a_whole() {
    let scratch = Scratch::new();
    for content in ["a longer first content", "second"] {
        write_atomically(scratch.path(), |writer| writer.write_all(content.as_bytes())).expect("writable folder");
        assert_eq!(fs::read_to_string(scratch.path()).expect("new file"), content);
        assert_eq!(scratch.names(), ["packing.txt"]);
    }
}

#[test]
fn folders_are_named_when_they_cannot_be_written() {
    let scratch = Scratch::new();
    let absent = scratch.path().join("absent");
    let message = write_atomically(&absent, |_| Ok(())).expect_err("no such folder").to_string();
    assert!(message.contains(&absent.display().to_string()), "{message}");
    let folder = write_atomically(scratch.folder.path(), |_| Ok(()));
    assert!(matches!(folder, Err(WriteError::NotAFile { .. })));
}

#[cfg(unix)]
#[test]
fn what_is_no_file_is_not_replaced() {
    // A socket of our own stands for devices: no test may name a device of the machine, a failing one would replace it.
    let scratch = Scratch::new();
    let _socket = std::os::unix::net::UnixListener::bind(scratch.path()).expect("a socket in a folder of ours");
    assert!(matches!(write_atomically(scratch.path(), |_| Ok(())), Err(WriteError::NotAFile { .. })));
    assert!(!fs::metadata(scratch.path()).expect("still there").is_file());
}

#[cfg(unix)]
#[test]
fn permissions_are_those_of_a_new_file() {
    use std::os::unix::fs::PermissionsExt;
    let scratch = Scratch::new();
    let plain = scratch.folder.path().join("plain");
    fs::write(&plain, "").expect("writable folder");
    write_atomically(scratch.path(), |_| Ok(())).expect("writable folder");
    let mode = |path| fs::metadata(path).expect("file").permissions().mode();
    assert_eq!(mode(scratch.path()), mode(plain));
}

#[test]
fn columns_and_keys_that_cannot_be_read_back_are_refused() {
    let scratch = Scratch::new();
    let packing = Packing::<2>::new(Domain::Open, vec![[0.0; 2]; 3], vec![0.5; 3]).expect("valid");
    let refusal = |columns: &[Column], properties: &[(&str, &str)]| {
        let error = write_packing(scratch.path(), &packing, columns, properties).expect_err("refused").to_string();
        assert!(error.contains("packing.txt"), "{error}");
        assert!(scratch.names().is_empty());
        error
    };
    let column = |name, width| Column { name, width, values: &[0.0; 6] };
    assert!(refusal(&[column("force", 1)], &[]).contains("column force has 6 values, expected 3"));
    assert!(refusal(&[column("force", 0)], &[]).contains("column force has 6 values, expected 0"));
    for name in ["radius", "Pos", "a:b", "a b", "", "é"] {
        assert!(refusal(&[column(name, 2)], &[]).contains(&format!("name `{name}`")));
    }
    assert!(refusal(&[column("a", 2), column("A", 2)], &[]).contains("name `A`"));
    for key in ["pbc", "lattice", "a=b", ""] {
        assert!(refusal(&[], &[(key, "1")]).contains(&format!("name `{key}`")));
    }
    assert!(refusal(&[], &[("note", "two\nlines")]).contains("value of `note` has a line break"));
}
