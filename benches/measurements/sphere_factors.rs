//! Where conjugate gradients take over from a factor in packings of spheres: values, memory and time of factors by the three orders of elimination,
//! and of conjugate gradients with an incomplete factor, to the same backward error.
//!
//! ```sh
//! cargo run --release --features measurements --example sphere_factors                                     # 1000 to 8000 spheres
//! cargo run --release --features measurements --example sphere_factors -- [--keep FOLDER] PRESSURE COUNT[x8] ...
//! ```
//!
//! `COUNT` spheres are prepared at `PRESSURE`, to 20 %. `COUNTx8` is eight copies of them in a box of twice the side, displaced at random by up to
//! 0.3 radii and relaxed again: a packing of its own, in less time. With `--keep` packings are written to the folder and read from there by the next
//! run. One sphere is held, and every unknown carries a random load. Times are the least of three, from 10 000 spheres on of one. The memory of a factor
//! is the peak beyond the matrix itself, as Linux reports it (less if a smaller one reuses what an earlier one has left). From 20 000 spheres on nested
//! dissection is the only order. The last line of each packing is its finish by the staged relaxer, from 10⁻⁶ to 10⁻¹² of the mean contact force.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::Instant;

use jamscope::io::{read_packing, write_packing};
use jamscope::law::Hertzian;
use jamscope::linear::iterative::{IncompleteFactor, IterationLimits, conjugate_gradients};
use jamscope::linear::{Hessian, Members, Prestress};
use jamscope::network::ContactNetwork;
use jamscope::packing::{Domain, Mixture, Packing};
use jamscope::preparation::{Preparation, Target, prepare_with};
use jamscope::relax::{Fire, ForceLimit, Relaxer, Staged};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

#[path = "scenes/elimination.rs"]
mod elimination;
use elimination::{Clock, Elimination, ORDERS};

/// Spheres from which everything is measured once instead of three times.
const ONCE_FROM: usize = 10_000;

/// Spheres from which nested dissection is the only order: minimum degree takes three times as long and more.
const DISSECTION_FROM: usize = 20_000;

/// Largest displacement of a copy, per radius.
const DISPLACEMENT: f64 = 0.3;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (folder, arguments) = match arguments.as_slice() {
        [option, folder, rest @ ..] if option == "--keep" => (Some(PathBuf::from(folder)), rest),
        all => (None, all),
    };
    let standard = ["1000", "1000", "2000", "4000", "1000x8"].map(String::from);
    let (pressure, counts) = arguments.split_first().or_else(|| standard.split_first()).ok_or("no pressure")?;
    println!(
        "| spheres | p | method | values | memory [MiB] | order [ms] | analysis [ms] | factor [ms] | solution [ms] | backward error |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for count in counts {
        compare(&prepared(count, pressure.parse()?, folder.as_deref())?)?;
    }
    Ok(())
}

/// A packing from its file, or prepared and written there.
fn prepared(name: &str, pressure: f64, folder: Option<&Path>) -> Result<Packing<3>, Box<dyn Error>> {
    let file = folder.map(|folder| folder.join(format!("spheres_{name}_p{pressure}.xyz")));
    if let Some(file) = file.as_ref().filter(|file| file.exists()) {
        return Ok(read_packing::<3>(file)?);
    }
    let law = Hertzian::default();
    let clock = Instant::now();
    let fire = Fire { limit: ForceLimit::Relative(1e-6), ..Fire::default() };
    let packing = match name.strip_suffix("x8") {
        Some(base) => {
            let copies = eight_copies(&prepared(base, pressure, folder)?)?;
            let relaxed = fire.relax(copies, &law, &mut ())?.converged();
            relaxed.map_err(|outcome| format!("not at rest: {:?}", outcome.stop))?.get().clone()
        }
        None => {
            let (mixture, target) = (Mixture::default(), Target::Pressure(pressure));
            let preparation = Preparation {
                disk_count: name.parse()?,
                mixture,
                target,
                tolerance: 0.2,
                seed: 1,
                ..Preparation::default()
            };
            prepare_with::<3>(&preparation, &law, &fire, &mut ())?.packing.get().clone()
        }
    };
    eprintln!("{name} at p = {pressure}: {:.0} s", clock.elapsed().as_secs_f64());
    if let Some(file) = file {
        write_packing(file, &packing, &[], &[])?;
    }
    Ok(packing)
}

/// Eight boxes as one, every sphere displaced at random.
fn eight_copies(packing: &Packing<3>) -> Result<Packing<3>, Box<dyn Error>> {
    let lengths = packing.domain().lengths().ok_or("the packing is not periodic")?;
    let mut generator = Pcg64::seed_from_u64(1);
    let (mut positions, mut radii) = (Vec::new(), Vec::new());
    for copy in 0..8usize {
        for (position, radius) in packing.positions().iter().zip(packing.radii()) {
            positions.push(std::array::from_fn(|d| {
                let shift = if copy >> d & 1 == 1 { lengths[d] } else { 0.0 };
                position[d] + shift + DISPLACEMENT * radius * (2.0 * generator.random::<f64>() - 1.0)
            }));
            radii.push(*radius);
        }
    }
    Ok(Packing::new(Domain::rectangular([0.0; 3], lengths.map(|side| 2.0 * side)), positions, radii)?)
}

fn compare(packing: &Packing<3>) -> Result<(), Box<dyn Error>> {
    let law = Hertzian::default();
    let volume = packing.domain().volume().ok_or("the packing is not periodic")?;
    let pressure = ContactNetwork::new(packing, &law)?.pressure(volume);
    // One sphere held: nothing else keeps a periodic packing in place.
    let held = (0..packing.len()).map(|sphere| sphere == 0).collect();
    let (start, packing) = (packing.clone(), packing.clone().with_held(held)?);
    let hessian = Hessian::new(&packing, &law, Members::Backbone, Prestress::LeftOut)?;
    let matrix = hessian.matrix();
    let mut generator = Pcg64::seed_from_u64(2);
    let right: Vec<f64> = (0..matrix.dimension()).map(|_| 2.0 * generator.random::<f64>() - 1.0).collect();
    let mut solution = right.clone();
    let count = hessian.disks().len();
    let repeats = if count < ONCE_FROM { 3 } else { 1 };
    let row = |method: &str, values: usize, memory: f64, times: [f64; 4], error: f64| {
        let [ordered, analysed, factorised, solved] = times;
        println!(
            "| {count} | {pressure:.3} | {method} | {values} | {memory:.0} | {ordered:.1} | {analysed:.1} | {factorised:.1} | {solved:.1} | {error:.1e} |"
        );
    };
    for name in ORDERS {
        if count >= DISSECTION_FROM && name != "nested dissection" {
            continue;
        }
        let (mut least, mut values, mut memory, mut error) = ([f64::INFINITY; 4], 0, 0.0, 0.0);
        for _ in 0..repeats {
            let before = Peak::start();
            let found = Elimination::of(&hessian, &right, name)?;
            (values, error) = (found.value_count, found.backward_error);
            least.iter_mut().zip(found.laps).for_each(|(least, lap)| *least = least.min(lap));
            memory = before.mebibytes().max(memory);
        }
        row(name, values, memory, least, error);
    }
    // The incomplete factor has a value and a row for each entry, and its columns; four vectors. Too little to be measured beside what is free.
    let memory = (16 * matrix.stored_count() + 40 * matrix.dimension()) as f64 / 1048576.0;
    for target in [IterationLimits::default().backward_error, 1e-13] {
        let (mut prepared, mut solved, mut error, mut iterations) = (f64::INFINITY, f64::INFINITY, 0.0, 0);
        for _ in 0..repeats {
            let mut clock = Clock::start();
            let incomplete = IncompleteFactor::new(matrix)?;
            prepared = prepared.min(clock.lap());
            solution.fill(0.0);
            let limits = IterationLimits { backward_error: target, ..IterationLimits::default() };
            let found = conjugate_gradients(matrix, &incomplete, &right, &mut solution, &limits)?;
            solved = solved.min(clock.lap());
            (error, iterations) = (found.backward_error, found.iteration_count);
        }
        let method = format!("conjugate gradients, {iterations} iterations");
        row(&method, matrix.stored_count(), memory, [0.0, 0.0, prepared, solved], error);
    }
    let clock = Instant::now();
    let outcome = Staged { limit: ForceLimit::Relative(1e-12), ..Staged::default() }.relax(start, &law, &mut ())?;
    let (cost, seconds) = (outcome.cost, clock.elapsed().as_secs_f64());
    println!(
        "{count} spheres by FIRE, then Newton: {:?}, residual {:.1e}, {} evaluations, {} factorisations, {seconds:.1} s",
        outcome.stop,
        outcome.residual.relative(),
        cost.force_evaluation_count,
        cost.factorisation_count
    );
    Ok(())
}

/// Memory of this process beyond that at a start.
struct Peak(f64);

impl Peak {
    fn start() -> Self {
        // The peak is set back to the present memory; elsewhere than on Linux there is no such file, and no memory in the table.
        let _ = std::fs::write("/proc/self/clear_refs", "5");
        Peak(memory("VmRSS:"))
    }

    /// MiB of the peak since the start; NaN if unknown.
    fn mebibytes(&self) -> f64 {
        memory("VmHWM:") - self.0
    }
}

/// A number of the kernel's table of this process, in MiB; NaN where there is no such table.
fn memory(name: &str) -> f64 {
    let table = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let number = |line: &str| line.split_ascii_whitespace().nth(1)?.parse::<f64>().ok();
    table.lines().find(|line| line.starts_with(name)).and_then(number).map_or(f64::NAN, |kibibytes| kibibytes / 1024.0)
}
