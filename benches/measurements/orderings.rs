//! Minimum degree, on rows and on disks, against nested dissection on jammed packings: values in a factor, and times as the least of three; and
//! conjugate gradients with an incomplete factor once.
//!
//! ```sh
//! cargo run --release --features measurements --example orderings                      # 5548 to 88768 disks, 2000 and 8000 balls
//! cargo run --release --features measurements --example orderings -- --write FOLDER    # the matrices as well, for benches/peers/cholmod
//! ```

use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};

use jamscope::io::read_packing;
use jamscope::law::Hertzian;
use jamscope::linear::iterative::{IncompleteFactor, IterationLimits, conjugate_gradients};
use jamscope::linear::{Hessian, Members, Prestress};
use jamscope::packing::{Domain, Mixture, Packing};
use jamscope::preparation::{Preparation, Target, prepare_with};
use jamscope::relax::{Fire, ForceLimit};
use jamscope::sparse::SymmetricMatrix;

#[path = "scenes/elimination.rs"]
mod elimination;
use elimination::{Clock, Elimination, ORDERS};

/// Repeats of every measurement.
const REPEATS: usize = 3;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let folder = match arguments.as_slice() {
        [] => None,
        [option, folder] if option == "--write" => Some(PathBuf::from(folder)),
        _ => return Err("usage: orderings [--write FOLDER]".into()),
    };
    let folder = folder.as_deref();
    println!(
        "| D | disks | order | values in a factor | order [ms] | analysis [ms] | L Lᵀ [ms] | solution, refined [ms] |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    let small = read_packing::<2>("fixtures/packings/hertz_N5548_p100.xyz")?;
    for copies in [1, 2, 4] {
        compare(&tiled(&small, copies)?, folder)?;
    }
    for disk_count in [2000, 8000] {
        let target = Target::PackingFraction(0.75);
        let preparation = Preparation {
            disk_count,
            mixture: Mixture::default(),
            target,
            tolerance: 0.01,
            seed: 1,
            ..Preparation::default()
        };
        let fire = Fire { limit: ForceLimit::Relative(1e-6), ..Fire::default() };
        compare(prepare_with::<3>(&preparation, &Hertzian::default(), &fire, &mut ())?.packing.get(), folder)?;
    }
    Ok(())
}

/// `copies` × `copies` boxes of a periodic packing as one.
fn tiled(packing: &Packing<2>, copies: usize) -> Result<Packing<2>, Box<dyn Error>> {
    let lengths = packing.domain().lengths().ok_or("the packing is not periodic")?;
    let (mut positions, mut radii) = (Vec::new(), Vec::new());
    for copy in 0..copies * copies {
        let shift = [(copy / copies) as f64 * lengths[0], (copy % copies) as f64 * lengths[1]];
        positions.extend(packing.positions().iter().map(|position| [position[0] + shift[0], position[1] + shift[1]]));
        radii.extend_from_slice(packing.radii());
    }
    let lengths = lengths.map(|side| side * copies as f64);
    Ok(Packing::new(Domain::rectangular([0.0; 2], lengths), positions, radii)?)
}

fn compare<const D: usize>(packing: &Packing<D>, folder: Option<&Path>) -> Result<(), Box<dyn Error>> {
    // One disk held: nothing else keeps a periodic packing in place.
    let held = (0..packing.len()).map(|disk| disk == 0).collect();
    let packing = packing.clone().with_held(held)?;
    let hessian = Hessian::new(&packing, &Hertzian::default(), Members::Backbone, Prestress::LeftOut)?;
    let matrix = hessian.matrix();
    if let Some(folder) = folder {
        write(matrix, &folder.join(format!("{D}d_{:06}.mtx", hessian.disks().len())))?;
    }
    let right = vec![1.0; matrix.dimension()];
    let mut solution = right.clone();
    for name in ORDERS {
        let mut least = [f64::INFINITY; 4];
        let mut value_count = 0;
        for _ in 0..REPEATS {
            let found = Elimination::of(&hessian, &right, name)?;
            assert!(found.backward_error < 1e-13, "{name}: {:e}", found.backward_error);
            value_count = found.value_count;
            least.iter_mut().zip(found.laps).for_each(|(least, lap)| *least = least.min(lap));
        }
        let [ordered, analysed, factorised, solved] = least;
        println!(
            "| {D} | {} | {name} | {value_count} | {ordered:.1} | {analysed:.1} | {factorised:.1} | {solved:.1} |",
            hessian.disks().len()
        );
    }
    let mut clock = Clock::start();
    let incomplete = IncompleteFactor::new(matrix)?;
    let prepared = clock.lap();
    solution.fill(0.0);
    let found = conjugate_gradients(matrix, &incomplete, &right, &mut solution, &IterationLimits::default())?;
    println!(
        "| {D} | {} | conjugate gradients, {} iterations | {} | - | - | {prepared:.1} | {:.1} |",
        hessian.disks().len(),
        found.iteration_count,
        matrix.stored_count(),
        clock.lap()
    );
    Ok(())
}

/// A Matrix Market file of the lower triangle.
fn write(matrix: &SymmetricMatrix, path: &Path) -> Result<(), Box<dyn Error>> {
    let mut file = std::io::BufWriter::new(std::fs::File::create(path)?);
    let dimension = matrix.dimension();
    writeln!(
        file,
        "%%MatrixMarket matrix coordinate real symmetric\n{dimension} {dimension} {}",
        matrix.stored_count()
    )?;
    for (row, column, value) in matrix.entries() {
        writeln!(file, "{} {} {value:e}", row + 1, column + 1)?;
    }
    Ok(file.flush()?)
}
