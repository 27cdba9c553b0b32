//! The Hessian against closed forms and differences of forces, factorisations against dense elimination, and the linear
//! response as the limit of relaxations.

mod factorisation;
mod hessian;
mod response;
mod symmetries;

use jamscope::io::read_packing;
use jamscope::packing::Packing;
use jamscope::relax::{Fire, ForceLimit};
use jamscope::sparse::SymmetricMatrix;

/// FIRE to a relative limit.
fn fire(limit: f64) -> Fire {
    Fire { limit: ForceLimit::Relative(limit), step_limit: 200_000, ..Fire::default() }
}

fn dense(matrix: &SymmetricMatrix) -> Vec<Vec<f64>> {
    let mut dense = vec![vec![0.0; matrix.dimension()]; matrix.dimension()];
    for (row, column, value) in matrix.entries() {
        dense[row][column] = value;
        dense[column][row] = value;
    }
    dense
}

fn fixture(name: &str) -> Packing<2> {
    read_packing(format!("{}/fixtures/packings/{name}.xyz", env!("CARGO_MANIFEST_DIR"))).expect("a fixture")
}
