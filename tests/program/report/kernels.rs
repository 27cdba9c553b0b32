//! Whole runs, with all that is measured by default, with every kind of vectors that this processor has.

use jamscope::processor::Processor;

use super::*;

#[test]
fn other_kernels_write_the_same_bytes() {
    let mut all = Processor::all().into_iter().map(|processor| {
        let mut files = processor.run(|| written(&run(&scene(), &()).expect("the scene makes sense")));
        files.remove("timings.json").expect("written");
        (processor, files)
    });
    let (first, expected) = all.next().expect("without vectors");
    for (processor, files) in all {
        for (name, bytes) in &files {
            assert!(expected.get(name) == Some(bytes), "{name}: {processor:?} and {first:?} differ");
        }
        assert_eq!(files.len(), expected.len());
    }
    let report: serde_json::Value = serde_json::from_slice(&expected["report.json"]).expect("JSON");
    // The name is that of the processor, which factorisations go by, whatever the kernels were told.
    assert_eq!(report["vectors"], Processor::own().vectors().name());
}
