//! The first command of a user, as its chapter quotes it.

use super::*;

#[test]
#[ignore = "half a minute: CI runs it"]
fn the_first_run_prints_what_its_chapter_quotes() {
    use jamscope::processor::{Processor, Vectors};

    let chapter = Path::new(env!("CARGO_MANIFEST_DIR")).join("book/src/first_run.md");
    let chapter = std::fs::read_to_string(chapter).expect("a chapter of the book");
    let blocks = chapter.split("```");
    let quoted = blocks.skip(1).step_by(2).find(|block| block.contains("jamscope 0.1.0,")).expect("what it prints");
    let quoted: Vec<&str> = quoted.lines().skip(1).filter(|line| !line.is_empty() && *line != "…").collect();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output =
        Command::new(env!("CARGO_BIN_EXE_jamscope")).current_dir(&folder).output().expect("the program starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let printed = String::from_utf8(output.stdout).expect("Unicode");
    // What goes through a factorisation, and so the minimum near jamming, is that of processors with the vectors of the machine of the chapter; on
    // others the packings and their preparation are the same.
    let same = Processor::own().vectors() == Vectors::Avx512;
    let end = if same { quoted.len() } else { quoted.iter().position(|line| *line == "Phase").expect("a section") };
    // In their order, whatever stands between them.
    let mut lines = printed.lines();
    for line in &quoted[..end] {
        assert!(lines.any(|printed| printed == *line), "not printed, or not in this place: {line:?}\n{printed}");
    }
    assert!(quoted.len() > 20, "{quoted:?}");
    // The phases, as far as the processor does not decide them.
    let found = printed.lines().find(|line| line.trim_start().starts_with("phase ")).expect("a phase");
    let words: Vec<&str> = found.split_whitespace().skip(1).collect();
    assert_eq!((words[0], words.len()), ("unjammed", 3));
    assert!(!same || words[1..] == ["plastic", "quasielastic"], "{found}");
}
