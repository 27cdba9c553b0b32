//! Results of a study next to published values.

use std::fmt::Write as _;

use crate::transition::Comparison;

/// One row per number; a missing value, interval or reason is an empty field.
pub fn table(comparisons: &[Comparison]) -> String {
    let mut text = String::from("quantity,of,value,low,high,published,verdict,samples,reason\n");
    let or_empty = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
    for one in comparisons {
        let (low, high) = (one.interval.map(|it| it[0]), one.interval.map(|it| it[1]));
        let _ = writeln!(
            text,
            "\"{}\",\"{}\",{},{},{},{},{},{},{}",
            one.quantity,
            one.of,
            or_empty(one.value),
            or_empty(low),
            or_empty(high),
            one.published,
            one.verdict.name(),
            one.sample_count,
            one.reason.map_or("", |reason| reason.words())
        );
    }
    text
}
