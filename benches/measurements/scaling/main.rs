//! Time and memory against the number of disks, beside the limits of the machine; the tables and the figure of the chapter on
//! performance.
//!
//! ```text
//! cargo run --release --features measurements --example scaling -- [--most DISKS] [--threads N] [--out FOLDER]
//! ```
//!
//! The packings are `hertz_N1000_p100` and `hertz_N5548_p100` of the fixtures, tiled to up to `--most` disks (10⁶), the
//! small disk nearest to the middle grown by 0.1 and held. Every time is the least of several turns. With `--threads` (all the machine
//! has), the loop and FIRE are timed on one thread and on all, and their bits compared. With `--out`, scaling.csv and roofline.svg
//! are written there.

mod machine;
mod roofline;
#[path = "../scenes/tiled.rs"]
mod tiled;

use std::error::Error;
use std::path::PathBuf;
use std::time::Instant;

use jamscope::displacement::DisplacementField;
use jamscope::forces::Assembly;
use jamscope::inflation::{Centre, Circle, choose_centre};
use jamscope::io::read_packing;
use jamscope::law::Hertzian;
use jamscope::law::damping::{ConstantDamping, ContactDamping};
use jamscope::linear::{Analysis, LinearResponse};
use jamscope::linear::{Hessian, Members, Prestress};
use jamscope::observe::{AngularProfile, RadialProfile};
use jamscope::packing::Packing;
use jamscope::relax::implicit::{ImplicitMotion, Inertia};
use jamscope::relax::{Fire, ForceLimit, Precision, Relaxer};

use tiled::tiled;

/// What may go wrong, on any thread.
type Failure = Box<dyn Error + Send + Sync>;

/// Copies along each axis of which packing.
const SIZES: [(&str, usize); 8] =
    [("N1000", 1), ("N1000", 2), ("N5548", 1), ("N5548", 2), ("N5548", 4), ("N5548", 6), ("N5548", 9), ("N5548", 14)];

/// Steps of FIRE before and while it is timed.
const FIRST_STEPS: usize = 200;
const STEPS: usize = 200;

/// Disks above which nothing is factorised: a factor of 10⁶ disks takes some GB.
const MOST_FACTORISED: usize = 500_000;

/// What one size took.
struct Row {
    disks: usize,
    pairs: usize,
    /// What the loop reads of a pair \[bytes\].
    pair_size: usize,
    contacts: usize,
    // ns a disk on one thread, then on all.
    list: f64,
    forces: f64,
    totals: f64,
    /// Of FIRE, in double precision and in mixed, far from rest.
    step: f64,
    mixed_step: f64,
    forces_on_all: f64,
    step_on_all: f64,
    mixed_step_on_all: f64,
    /// Lists made during the steps of FIRE that were timed.
    lists: usize,
    /// ns a disk: Hessian, order and analysis, factor, solution, implicit step, profiles of a field.
    linear: Option<[f64; 6]>,
    /// Largest memory of the process so far, bytes a disk.
    memory: Option<f64>,
}

fn main() -> Result<(), Failure> {
    let available = std::thread::available_parallelism().map_or(1, usize::from);
    let (mut most, mut threads, mut out) = (1_100_000usize, available, None);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let value = arguments.next().ok_or_else(|| format!("{argument} needs a value"))?;
        match argument.as_str() {
            "--most" => most = value.parse()?,
            "--threads" => threads = value.parse()?,
            "--out" => out = Some(PathBuf::from(value)),
            other => return Err(format!("unknown argument {other}").into()),
        }
    }
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;

    // Three columns: 192 KiB and 3 MiB stay in caches, 768 MiB do not.
    let places = [("near cache", 8192usize), ("far cache", 131_072), ("memory", 33_554_432)];
    let bandwidths = places.map(|(name, length)| (name, machine::triad(length, 1), machine::triad(length, threads)));
    for (name, of_one, of_all) in &bandwidths {
        println!("triad, {name:<10}: {:6.1} GB/s on one thread, {:6.1} on {threads}", of_one * 1e-9, of_all * 1e-9);
    }
    let (hertzian, hookean) = (machine::roots_and_division(2), machine::roots_and_division(1));
    println!(
        "roots and division of a pair: {:.2} ns (two roots, Hertzian), {:.2} ns (one, Hookean)\n",
        hertzian * 1e9,
        hookean * 1e9
    );

    println!("ns a disk; on all: {threads} threads, the same bits");
    println!(
        "{:>8} {:>6} {:>8} {:>7} {:>7} {:>7} {:>7} {:>7} {:>9} {:>9} {:>9} {:>5} | {:>8} {:>8} {:>8} {:>8} {:>9} {:>8} | {:>7}",
        "disks",
        "pairs",
        "contacts",
        "list",
        "loop",
        "totals",
        "step",
        "mixed",
        "loop all",
        "step all",
        "mixed all",
        "lists",
        "Hessian",
        "analysis",
        "factor",
        "solve",
        "impl.step",
        "profiles",
        "bytes"
    );
    let mut rows = Vec::new();
    for (name, copies) in SIZES {
        let base = read_packing::<2>(format!("fixtures/packings/hertz_{name}_p100.xyz"))?;
        if base.len() * copies * copies > most {
            continue;
        }
        let row = measured(&tiled(&base, copies).map_err(|error| error.to_string())?, &one)?;
        print_row(&row);
        rows.push(row);
    }
    print_exponents(&rows);
    if let Some(folder) = out {
        std::fs::create_dir_all(&folder)?;
        std::fs::write(folder.join("scaling.csv"), csv(&rows))?;
        roofline::draw(
            &folder.join("roofline.svg"),
            &rows,
            &bandwidths.map(|(name, of_one, _)| (name, of_one)),
            hertzian,
        )?;
    }
    Ok(())
}

fn measured(packing: &Packing<2>, one: &rayon::ThreadPool) -> Result<Row, Failure> {
    let law = Hertzian::default();
    let disks = packing.len();
    let per_disk = 1e9 / disks as f64;
    let chosen = choose_centre(packing, &law, Centre::Backbone, 1)?;
    let turns = (4_000_000 / disks).clamp(3, 2000);

    let mut assembly = Assembly::new(packing, &law)?;
    let list = least(5, || Ok(assembly.reanchor()?))?;
    let forces_on_all = least(5, || repeat(turns, || assembly.evaluate()))? / turns as f64;
    let of_all = assembly.forces.clone();
    let (forces, totals) = one.install(|| -> Result<_, Failure> {
        let forces = least(5, || repeat(turns, || assembly.evaluate()))?;
        assert!(assembly.forces == of_all, "the bits depend on the number of threads");
        Ok((forces / turns as f64, least(5, || repeat(turns, || _ = assembly.evaluate_totals()))? / turns as f64))
    })?;
    let (pairs, pair_size) = (assembly.pairs().len(), assembly.pairs().pair_size());
    let contacts = assembly.evaluate_totals().contact_count;
    drop((assembly, of_all));

    let radius = packing.radii()[chosen];
    let held = (0..disks).map(|disk| disk == chosen).collect();
    let start = packing.clone().with_radius(chosen, radius + 0.1)?.with_held(held)?;
    // What a step costs once the first lists are made, whatever the number of disks.
    let relax = |precision, step_limit| -> Result<_, Failure> {
        let fire = Fire { limit: ForceLimit::Relative(0.0), step_limit, precision, ..Fire::default() };
        let outcome = fire.relax(start.clone(), &law, &mut ())?;
        Ok((outcome.cost.seconds, outcome.cost.build_count, outcome.state))
    };
    let steps = |precision| -> Result<_, Failure> {
        let (mut least, mut lists, mut last) = ([f64::INFINITY; 2], 0, None);
        for _ in 0..(400_000 / disks).clamp(5, 40) {
            let ((early, before, _), (late, after, state)) =
                (relax(precision, FIRST_STEPS)?, relax(precision, FIRST_STEPS + STEPS)?);
            least = [least[0].min(early), least[1].min(late)];
            (lists, last) = (after - before, Some(state));
        }
        Ok(((least[1] - least[0]) / STEPS as f64, lists, last.ok_or("no turn")?))
    };
    let both = |precision| -> Result<_, Failure> {
        let (on_all, _, state_of_all) = steps(precision)?;
        let (on_one, lists, state) = one.install(|| steps(precision))?;
        assert!(state.positions() == state_of_all.positions(), "the bits depend on the number of threads");
        Ok((on_one, on_all, lists))
    };
    let (step, step_on_all, lists) = both(Precision::Double)?;
    let (mixed_step, mixed_step_on_all, _) = both(Precision::Mixed)?;
    drop(start);

    let linear =
        if disks <= MOST_FACTORISED { Some(linear(packing, chosen)?.map(|seconds| seconds * per_disk)) } else { None };
    Ok(Row {
        disks,
        pairs,
        pair_size,
        contacts,
        list: list * per_disk,
        forces: forces * per_disk,
        totals: totals * per_disk,
        step: step * per_disk,
        mixed_step: mixed_step * per_disk,
        forces_on_all: forces_on_all * per_disk,
        step_on_all: step_on_all * per_disk,
        mixed_step_on_all: mixed_step_on_all * per_disk,
        lists,
        linear,
        memory: peak_memory().map(|bytes| bytes / disks as f64),
    })
}

/// Seconds of Hessian, analysis, factor, solution, implicit step and profiles.
fn linear(packing: &Packing<2>, chosen: usize) -> Result<[f64; 6], Failure> {
    let law = Hertzian::default();
    let side = packing.domain().lengths().ok_or("the packing is not periodic")?[0];
    let circle = Circle::cut(packing, chosen, 0.49 * side)?;
    // Times are per disk of the packing, of which the circle has this part.
    let share = packing.len() as f64 / circle.mobile_count() as f64;
    let assembly = Assembly::new(&circle.packing, &law)?;
    let mut hessian = Hessian::of(&assembly, Members::Backbone, Prestress::Included);
    let update = least(3, || {
        assert!(hessian.update(&assembly), "no contact has changed");
        Ok(())
    })?;
    let mut analysis = Analysis::of(&hessian)?;
    let order = least(3, || {
        let _ = Analysis::of(&hessian)?;
        Ok(())
    })?;
    let factor = least(3, || {
        let _ = analysis.cholesky(hessian.matrix())?;
        Ok(())
    })?;
    let unknowns = hessian.matrix().dimension();
    let (right, mut solution) = (vec![1.0; unknowns], vec![0.0; unknowns]);
    let mut factorisation = analysis.cholesky(hessian.matrix())?;
    let solve = least(3, || factorisation.solve(&right, &mut solution).map(drop).map_err(Into::into))?;
    drop((analysis, hessian, assembly, right, solution));

    let response = LinearResponse::of_inflation(&circle.packing, circle.centre, &law, Prestress::Included)?;
    let profiles = least(3, || {
        let field = DisplacementField::of_linear_response(&response, &circle.packing, 0.1, 0.49 * side);
        std::hint::black_box((RadialProfile::of(&field, 1.0), AngularProfile::of(&field, 0.5)));
        Ok(())
    })?;
    let radius = circle.packing.radii()[circle.centre];
    let start = circle.packing.clone().with_radius(circle.centre, radius + 0.1)?;
    let mut motion = ImplicitMotion::new(
        &start,
        &law,
        &ContactDamping::Constant(ConstantDamping { rate: 500.0 }),
        Inertia::Massive,
    )?;
    let step = motion.longest_step(1e-3).min(1e-3);
    let _ = motion.step(step)?;
    let implicit = least(3, || motion.step(step).map(drop).map_err(Into::into))?;
    Ok([update, order, factor, solve, implicit, profiles].map(|seconds| seconds * share))
}

/// The least seconds of so many calls.
fn least(count: usize, mut call: impl FnMut() -> Result<(), Failure>) -> Result<f64, Failure> {
    let mut least = f64::INFINITY;
    for _ in 0..count {
        let begin = Instant::now();
        call()?;
        least = least.min(begin.elapsed().as_secs_f64());
    }
    Ok(least)
}

fn repeat(count: usize, mut call: impl FnMut()) -> Result<(), Failure> {
    (0..count).for_each(|_| call());
    Ok(())
}

/// Largest memory of the process so far, where the kernel tells it.
fn peak_memory() -> Option<f64> {
    let table = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = table.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(line.split_ascii_whitespace().nth(1)?.parse::<f64>().ok()? * 1024.0)
}

fn print_row(row: &Row) {
    let linear = row.linear.map_or_else(
        || format!("{:>8} {:>8} {:>8} {:>8} {:>9} {:>8}", "", "", "", "", "", ""),
        |[hessian, analysis, factor, solve, implicit, profiles]| {
            format!("{hessian:>8.0} {analysis:>8.0} {factor:>8.0} {solve:>8.0} {implicit:>9.0} {profiles:>8.0}")
        },
    );
    println!(
        "{:>8} {:>6.2} {:>8.2} {:>7.1} {:>7.2} {:>7.2} {:>7.2} {:>7.2} {:>9.2} {:>9.2} {:>9.2} {:>5} | {linear} | {:>7.0}",
        row.disks,
        row.pairs as f64 / row.disks as f64,
        row.contacts as f64 / row.disks as f64,
        row.list,
        row.forces,
        row.totals,
        row.step,
        row.mixed_step,
        row.forces_on_all,
        row.step_on_all,
        row.mixed_step_on_all,
        row.lists,
        row.memory.unwrap_or(f64::NAN),
    );
}

/// The exponents x of time ∼ N^x, least squares over all sizes on logarithmic axes.
fn print_exponents(rows: &[Row]) {
    type Column<'a> = (&'a str, &'a dyn Fn(&Row) -> Option<f64>);
    let columns: [Column<'_>; 9] = [
        ("list", &|row| Some(row.list)),
        ("loop", &|row| Some(row.forces)),
        ("FIRE step", &|row| Some(row.step)),
        ("mixed step", &|row| Some(row.mixed_step)),
        ("Hessian", &|row| row.linear.map(|of| of[0])),
        ("analysis", &|row| row.linear.map(|of| of[1])),
        ("factor", &|row| row.linear.map(|of| of[2])),
        ("solution", &|row| row.linear.map(|of| of[3])),
        ("implicit step", &|row| row.linear.map(|of| of[4])),
    ];
    println!("\nexponent x of time ~ N^x, and the largest time a disk over the least:");
    for (name, column) in columns {
        let points: Vec<(f64, f64)> =
            rows.iter().filter_map(|row| Some(((row.disks as f64).ln(), column(row)?.ln()))).collect();
        let count = points.len() as f64;
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
        let (x, y) = (mean(&|point| point.0), mean(&|point| point.1));
        let slope = mean(&|point| (point.0 - x) * (point.1 - y)) / mean(&|point| (point.0 - x).powi(2));
        let of = |pick: fn(f64, f64) -> f64, from: f64| points.iter().map(|point| point.1).fold(from, pick);
        let spread = (of(f64::max, f64::NEG_INFINITY) - of(f64::min, f64::INFINITY)).exp();
        println!("{name:<14} {:.3}  {spread:.2}", 1.0 + slope);
    }
}

fn csv(rows: &[Row]) -> String {
    let mut text = String::from(
        "disks,pairs,contacts,list,loop,loop_with_totals,fire_step,mixed_fire_step,loop_on_all,fire_step_on_all,mixed_fire_step_on_all,lists,hessian,analysis,factor,solution,implicit_step,profiles,memory\n\
         1,1,1,ns/disk,ns/disk,ns/disk,ns/disk,ns/disk,ns/disk,ns/disk,ns/disk,1,ns/disk,ns/disk,ns/disk,ns/disk,ns/disk,ns/disk,byte/disk\n",
    );
    for row in rows {
        let on_one = [row.list, row.forces, row.totals, row.step, row.mixed_step];
        let times = on_one.into_iter().chain([row.forces_on_all, row.step_on_all, row.mixed_step_on_all]);
        let linear = row.linear.map_or(vec![None; 6], |of| of.into_iter().map(Some).collect());
        let cells = times.chain([row.lists as f64]).map(Some).chain(linear).chain([row.memory]);
        let cells: Vec<String> = cells.map(|cell| cell.map_or(String::new(), |value| format!("{value:.3}"))).collect();
        text += &format!("{},{},{},{}\n", row.disks, row.pairs, row.contacts, cells.join(","));
    }
    text
}
