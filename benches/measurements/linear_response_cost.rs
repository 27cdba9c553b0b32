//! What the linear response of the largest packing of the study costs: seconds of each stage, and memory.
//!
//! ```text
//! cargo run --release --features measurements --example linear_response_cost -- FILE
//! ```
//!
//! 88776 disks at p = 100, to 20 %, are read from FILE; if there is none they are prepared (some minutes) and written there first. The
//! packing is cut to a circle of 0.491 of its side, whose centre grows. Every stage is timed several times: least and median are
//! printed. One thread. Memory is told where `/proc/self/status` is; a run that has prepared the packing says nothing of it, since
//! that took more.

use std::error::Error;
use std::time::Instant;

use jamscope::forces::Assembly;
use jamscope::inflation::{Centre, Circle, choose_centre};
use jamscope::io::{read_packing, write_packing};
use jamscope::law::Hertzian;
use jamscope::linear::{Analysis, LinearResponse};
use jamscope::linear::{Hessian, Members, Prestress};
use jamscope::packing::{Mixture, Packing};
use jamscope::preparation::{Preparation, Target, prepare_with};
use jamscope::relax::{ForceLimit, Staged};

/// Times each stage is run.
const REPEATS: usize = 7;

fn main() -> Result<(), Box<dyn Error>> {
    let Some(file) = std::env::args().nth(1) else { return Err("usage: linear_response_cost FILE".into()) };
    let law = Hertzian::default();
    let stored = std::path::Path::new(&file).exists();
    let packing = if stored { read_packing::<2>(&file)? } else { prepared(&law)? };
    if !stored {
        write_packing(&file, &packing, &[], &[])?;
    }
    let side = packing.domain().lengths().ok_or("the packing is not periodic")?[0];
    let chosen = choose_centre(&packing, &law, Centre::Backbone, 1)?;
    let circle = Circle::cut(&packing, chosen, 0.491 * side)?;
    drop(packing);
    let mobile_count = circle.mobile_count();
    println!("{mobile_count} mobile disks in the circle, {} with the rim", circle.packing.len());

    // Memory first: nothing has been freed that a later stage could use again without being seen.
    let before = memory("VmRSS:");
    let response = LinearResponse::of_inflation(&circle.packing, circle.centre, &law, Prestress::Included)?;
    match (stored, before, memory("VmHWM:")) {
        (true, Some(before), Some(peak)) => {
            println!("memory: {before:.0} MiB with the packing, {peak:.0} MiB at the peak, {:.0} more", peak - before)
        }
        _ => println!("memory: not measured"),
    }
    println!(
        "{} unknowns, {} negative eigenvalues, backward error {:.1e}",
        response.unknown_count, response.negative_eigenvalue_count, response.backward_error
    );

    let mut times: [Vec<f64>; 7] = Default::default();
    for _ in 0..REPEATS {
        let mut clock = Instant::now();
        let mut lap = |stage: usize| {
            times[stage].push(1e3 * clock.elapsed().as_secs_f64());
            clock = Instant::now();
        };
        let assembly = Assembly::new(&circle.packing, &law)?;
        lap(0);
        let mut hessian = Hessian::of(&assembly, Members::Backbone, Prestress::Included);
        lap(1);
        let mut analysis = Analysis::of(&hessian)?;
        lap(2);
        let (right, mut solution) = (vec![1.0; response.unknown_count], vec![0.0; response.unknown_count]);
        let mut factorisation = analysis.cholesky(hessian.matrix())?;
        lap(3);
        let _ = factorisation.solve(&right, &mut solution)?;
        lap(4);
        assert!(hessian.update(&assembly), "no contact has changed");
        let _ = analysis.cholesky(hessian.matrix())?.solve(&right, &mut solution)?;
        lap(5);
        if times[0].len() == 1 {
            let (values, entries) = (analysis.factor_count(), hessian.matrix().stored_count());
            println!("{values} values in a factor, {:.0} MiB; {entries} in the matrix", values as f64 / 131072.0);
        }
        drop((analysis, hessian, assembly));
        let clock = Instant::now();
        let _ = LinearResponse::of_inflation(&circle.packing, circle.centre, &law, Prestress::Included)?;
        times[6].push(1e3 * clock.elapsed().as_secs_f64());
    }
    let stages = [
        "neighbour list",
        "Hessian",
        "order and analysis",
        "L Lᵀ",
        "solution, refined",
        "known pattern: Hessian, L Lᵀ, solution",
        "whole response",
    ];
    for (stage, times) in stages.iter().zip(&mut times) {
        times.sort_by(f64::total_cmp);
        println!("{stage:<40} least {:>6.0} ms, median {:>6.0} ms", times[0], times[REPEATS / 2]);
    }
    Ok(())
}

fn prepared(law: &Hertzian) -> Result<Packing<2>, Box<dyn Error>> {
    let (mixture, target) = (Mixture::default(), Target::Pressure(100.0));
    let preparation =
        Preparation { disk_count: 88_776, mixture, target, tolerance: 0.2, seed: 1, ..Preparation::default() };
    let staged = Staged { limit: ForceLimit::Relative(1e-6), ..Staged::default() };
    Ok(prepare_with::<2>(&preparation, law, &staged, &mut ())?.packing.get().clone())
}

/// A number of the kernel's table of this process, in MiB; none where there is no such table.
fn memory(name: &str) -> Option<f64> {
    let table = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = table.lines().find(|line| line.starts_with(name))?;
    Some(line.split_ascii_whitespace().nth(1)?.parse::<f64>().ok()? / 1024.0)
}
