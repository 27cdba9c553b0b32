//! In how many minima the relaxers end from one inflated start, and which of them share one.
//!
//! ```text
//! cargo run --release --features measurements --example protocol -- [NAME] ...          (stored Hertzian packings, four centres each)
//! ```
//!
//! The centre of each packing is inflated by 0.1 in a circle with a held rim. A row is a centre: how many protocols came to
//! rest and in how many minima, the minimum of each protocol (in the order of the header; `-` not at rest or without contacts),
//! the largest distance over the mean overlap, how many disks and contacts differ at most, the standard deviations of Δp and of
//! d_0^eff of the elastic solution over the endings with their means, and how clear minima are told apart: the farthest ending
//! within one, the nearest two minima, both over the mean overlap.

use std::error::Error;
use std::time::Instant;

use jamscope::inflation::{Inflation, inflate_with};
use jamscope::io::read_packing;
use jamscope::law::Hertzian;
use jamscope::protocol::{Compared, Protocol, ProtocolSettings, Spread};
use jamscope::relax::{RelaxerChoice, Staged};

/// Stored packings if none is named.
const STORED: [&str; 4] = ["hertz_N1000_p1", "hertz_N1000_p10", "hertz_N1000_p100", "hertz_N1000_p800"];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let names: Vec<&str> =
        if arguments.is_empty() { STORED.to_vec() } else { arguments.iter().map(String::as_str).collect() };
    let law = Hertzian::default();
    let inflation = Inflation::default();
    let staged = RelaxerChoice::Staged(Staged::default());
    let protocols = Protocol::all(&staged);
    let listed: Vec<&str> = protocols.iter().map(|protocol| protocol.name.as_str()).collect();
    println!("{}", listed.join(" | "));
    println!(
        "{:<17} {:>4} {:>7} {:>9} {:>8} {:>6} {:>6} {:>17} {:>17} {:>9} {:>9} {:>6}",
        "packing",
        "seed",
        "minima",
        "which",
        "apart/δ",
        "disks",
        "cont.",
        "Δp",
        "d_0^eff",
        "within/δ",
        "between/δ",
        "s"
    );
    for name in names {
        let packing = read_packing::<2>(format!("{}/fixtures/packings/{name}.xyz", env!("CARGO_MANIFEST_DIR")))?;
        for seed in 1..=4 {
            let clock = Instant::now();
            let inflated = inflate_with(&inflation, &packing, &law, &staged, seed, &mut ())?;
            let settings = ProtocolSettings::default();
            #[cfg_attr(not(feature = "fit"), allow(unused_mut, reason = "only fits are added"))]
            let mut compared = Compared::of_inflation(&inflated, &inflation, &law, &protocols, &settings, &mut ())?;
            #[cfg(feature = "fit")]
            compared.fit(&inflated, 1.0, &jamscope::fit::profile::ProfileFitSettings::default());
            let found = &compared.sensitivity;
            let which: String =
                found.endings.iter().map(|it| it.minimum.map_or("-".into(), |minimum| minimum.to_string())).collect();
            let most = |count: &dyn Fn(usize) -> usize| (0..found.endings.len()).map(count).max().unwrap_or(0);
            #[cfg(feature = "fit")]
            let amplitude = found.spreads.elastic_amplitude;
            #[cfg(not(feature = "fit"))]
            let amplitude = None;
            println!(
                "{name:<17} {seed:>4} {:>7} {which:>9} {:>8.1e} {:>6} {:>6} {:>17} {:>17} {:>9.0e} {:>9.0e} {:>6.1}",
                found.minimum_count,
                found.largest_distance / found.mean_overlap,
                most(&|index| found.endings[index].differing.len()),
                most(&|index| found.endings[index].contact_difference_count.unwrap_or(0)),
                cell(found.spreads.pressure_change),
                cell(amplitude),
                found.farthest_within,
                found.nearest_between.unwrap_or(f64::NAN),
                clock.elapsed().as_secs_f64(),
            );
            for ending in found.endings.iter().filter(|ending| !ending.at_rest()) {
                println!("{:>22} {}: {:?}, then {:?}", "", ending.relaxer, ending.stop, ending.finish);
            }
        }
    }
    Ok(())
}

fn cell(spread: Option<Spread>) -> String {
    spread.map_or("-".into(), |spread| format!("{:.3} ± {:.0e}", spread.mean, spread.standard_deviation))
}
