//! `jamscope strain`: interrupted and continued to the same bytes; nothing is replaced, nothing damaged is continued.

use std::process::{Command, Stdio};

use jamscope::io::read_packing;

use crate::packing_commands::{done, fixture, refused};

/// A shear that is killed and continued has the bytes of the whole one.
#[test]
fn a_shear_continues_where_it_was_interrupted() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let input = fixture("packings/hertz_N1000_p100.xyz");
    let arguments = |out: &'static str| {
        vec!["strain", input.as_str(), "--shear", "0.01", "--steps", "12", "--limit", "1e-6", "--out", out]
    };
    let printed = done(folder.path(), &arguments("whole.xyz"), b"");
    assert!(printed.contains("shear 0.01:") && printed.contains("in 12 steps"), "{printed}");
    let (state, table) = (path("cut.xyz"), path("cut.csv"));
    let mut child = Command::new(env!("CARGO_BIN_EXE_jamscope"))
        .args(arguments("cut.xyz"))
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .spawn()
        .expect("the program starts");
    let has_rows = || std::fs::read_to_string(&table).is_ok_and(|text| text.lines().count() > 2 + 3);
    for _ in 0..60_000 {
        if has_rows() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    child.kill().expect("it runs");
    let _ = child.wait();
    let text = std::fs::read_to_string(&state).expect("a state");
    assert!(text.contains("unfinished=\"shear by 0.01 in 12 steps"), "{}", text.lines().nth(1).unwrap_or(""));
    // Other settings do not continue it, and do not remove it.
    let mut other = arguments("cut.xyz");
    other[3] = "0.02";
    refused(
        folder.path(),
        &other,
        &["cut.xyz: holds the unfinished result of `shear by 0.01", "remove it, or give another"],
    );
    done(folder.path(), &arguments("cut.xyz"), b"");
    for name in ["xyz", "csv"] {
        let read = |stem: &str| std::fs::read(path(&format!("{stem}.{name}"))).expect("a file");
        assert!(read("whole") == read("cut"), "{name}");
    }
    // The table: step 0 to 12, and the box of the state has the tilt.
    let text = std::fs::read_to_string(&table).expect("a table");
    assert_eq!(text.lines().count(), 2 + 13);
    let [[_, _], [tilt, height]] = read_packing::<2>(&state).expect("a state").domain().edges().expect("a box");
    assert!((tilt / height - 0.01).abs() < 1e-15);
    refused(folder.path(), &["strain", &input, "--shear", "0", "--steps", "3"], &["shear is 0"]);
    refused(folder.path(), &["strain", &input, "--shear", "0.1", "--steps", "0"], &["steps is 0"]);
    refused(
        folder.path(),
        &["strain", &input, "--shear", "0.1", "--steps", "2", "--out", "a.npz"],
        &["a.npz: a shear writes a state after every step"],
    );
}

/// The table of steps replaces no file, and a damaged one is not continued.
#[test]
fn a_shear_replaces_no_table_and_continues_no_damaged_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    std::fs::copy(fixture("packings/hertz_N1000_p100.xyz"), path("in.csv")).expect("copied");
    let shear = ["--shear", "0.001", "--steps", "2", "--limit", "1e-6", "--out"];
    let strain = |input: &'static str, out: &'static str| [&["strain", input][..], &shear[..], &[out][..]].concat();
    let before = std::fs::read(path("in.csv")).expect("a file");
    refused(folder.path(), &strain("in.csv", "in.xyz"), &["in.csv: would be the table of steps"]);
    refused(folder.path(), &strain("in.csv", "a.csv"), &["a.csv: would be the table of steps"]);
    std::fs::write(path("b.csv"), "notes").expect("written");
    refused(folder.path(), &strain("in.csv", "b.xyz"), &["b.csv: exists"]);
    assert_eq!(std::fs::read(path("in.csv")).expect("a file"), before);
    assert_eq!(std::fs::read_to_string(path("b.csv")).expect("a file"), "notes");
    // A state made unfinished by hand, with its table as it is and damaged.
    done(folder.path(), &strain("in.csv", "c.xyz"), b"");
    let text = std::fs::read_to_string(path("c.xyz")).expect("a state");
    let key = "unfinished=\"shear by 0.001 in 2 steps, FIRE to 1e-6, Hertzian(Hertzian { stiffness: 200000.0 })\"";
    std::fs::write(path("c.xyz"), text.replacen("dimension=2", &format!("dimension=2 {key} unfinished_of=0"), 1))
        .expect("written");
    refused(folder.path(), &strain("in.csv", "c.xyz"), &["c.xyz: holds the unfinished result of another packing"]);
}
