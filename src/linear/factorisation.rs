//! [`Analysis`] of the sparsity pattern of a matrix, and the [`Factorisation`]s that use it.
//!
//! ```text
//! definite     P A Pᵀ = L Lᵀ
//! indefinite   P A Pᵀ = L D Lᵀ,  D diagonal: as many negative pivots as negative eigenvalues (Sylvester)
//! ```
//!
//! P is an elimination order from [`ordering`]. The symbolic analysis and the buffers of factors are reused, so further
//! matrices with the same pattern cost only their numerical factorisation. L D Lᵀ is computed without pivoting and may
//! lose digits. Each solution is therefore refined until its backward error no longer falls, and refused if that is
//! above [`ACCURACY`].
//!
//! # Source
//! faer 0.24 (sparse simplicial and supernodal factorisations). Backward error: Rigal, Gaches (1967), J. ACM 14, 543;
//! refinement in fixed precision: Skeel (1980), Math. Comput. 35, 817.

use std::sync::OnceLock;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::LdltError;
use faer::linalg::cholesky::llt::factor::LltError;
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LdltRef, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{FaerError, SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

use crate::linear::error::LinearError;
use crate::linear::hessian::Hessian;
use crate::linear::ordering;
use crate::linear::solution::{ACCURACY, Solution};
use crate::memory::Memory;
use crate::sparse::SymmetricMatrix;
use crate::vector::larger;

/// Ratio of pivots below which a matrix counts as singular \[1\]. A pivot that should vanish has the rounding error of
/// the ten to a hundred products that form it.
const SINGULAR: f64 = 64.0 * f64::EPSILON;

/// Products per entry of the factor, over 40, above which factors are computed by dense panels (supernodes): half of
/// faer's default.
const BY_PANELS_FROM: SupernodalThreshold = SupernodalThreshold(0.5);

/// Largest share of the memory of the machine that a factor and its workspace may take \[1\]. Vibrational modes hold two
/// factors, and some memory is left for all else. Without a limit, a system that promises more memory than it has ends
/// the process.
const MEMORY_SHARE: f64 = 1.0 / 3.0;

/// Sparsity pattern of a matrix, its elimination order, and the buffers of its factors.
pub struct Analysis {
    symbolic: SymbolicCholesky<usize>,
    starts: Vec<usize>,
    rows: Vec<usize>,
    factor: Vec<f64>,
    memory: MemBuffer,
    pub(super) residual: Vec<f64>,
    pub(super) kept: Vec<f64>,
}

impl std::fmt::Debug for Analysis {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (dimension, factor_count) = (self.residual.len(), self.factor.len());
        write!(formatter, "Analysis {{ dimension: {dimension}, factor_count: {factor_count} }}")
    }
}

impl Analysis {
    /// Orders the matrix of a packing disk by disk, by [`best`](crate::linear::ordering::best), and allocates its
    /// factors. It serves every matrix with the same pattern of entries, such as one with another diagonal.
    ///
    /// # Errors
    /// Not enough memory: the factor would take more than a third of that of the machine.
    ///
    /// # Cost
    /// 50 % to 90 % of a factorisation, from 1 000 to 89 000 disks in two dimensions (`cargo bench --features measurements --bench linear`).
    pub fn of<const D: usize>(hessian: &Hessian<D>) -> Result<Self, LinearError> {
        Self::in_order(hessian.matrix(), &ordering::best(hessian)?)
    }

    /// Like [`Analysis::of`], for a general matrix, by approximate minimum degree on its rows.
    ///
    /// # Errors
    /// Not enough memory.
    pub fn new(matrix: &SymmetricMatrix) -> Result<Self, LinearError> {
        Self::with(matrix, SymmetricOrdering::Amd, largest_size())
    }

    /// Like [`Analysis::new`], with a given elimination order: the row to eliminate at each place. See [`ordering`].
    ///
    /// # Errors
    /// An order that does not contain every row once; not enough memory.
    pub fn in_order(matrix: &SymmetricMatrix, order: &[usize]) -> Result<Self, LinearError> {
        let dimension = matrix.dimension();
        let mut place = vec![usize::MAX; dimension];
        for (index, &row) in order.iter().enumerate() {
            match place.get_mut(row) {
                Some(place) if *place == usize::MAX => *place = index,
                _ => return Err(LinearError::NotAnOrder { dimension, place: index, row }),
            }
        }
        if order.len() != dimension {
            return Err(LinearError::NotAnOrder { dimension, place: order.len(), row: dimension });
        }
        let ordering = SymmetricOrdering::Custom(PermRef::new_checked(order, &place, dimension));
        Self::with(matrix, ordering, largest_size())
    }

    /// An analysis whose factor and workspace take at most `largest` bytes.
    fn with(
        matrix: &SymmetricMatrix,
        ordering: SymmetricOrdering<'_, usize>,
        largest: usize,
    ) -> Result<Self, LinearError> {
        let dimension = matrix.dimension();
        let out_of_memory = |_: FaerError| LinearError::OutOfMemory { dimension };
        let (starts, rows) = (matrix.starts.clone(), matrix.rows.clone());
        let pattern = SymbolicSparseColMatRef::new_checked(dimension, dimension, &starts, None, &rows);
        let parameters =
            CholeskySymbolicParams { supernodal_flop_ratio_threshold: BY_PANELS_FROM, ..Default::default() };
        let symbolic =
            factorize_symbolic_cholesky(pattern, Side::Lower, ordering, parameters).map_err(out_of_memory)?;
        let scratch = symbolic
            .factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default())
            .or(symbolic.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Default::default()))
            .or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        if scratch.unaligned_bytes_required().saturating_add(8 * symbolic.len_val()) > largest {
            return Err(LinearError::OutOfMemory { dimension });
        }
        let memory = MemBuffer::try_new(scratch).map_err(|_| LinearError::OutOfMemory { dimension })?;
        let mut factor = Vec::new();
        factor.try_reserve_exact(symbolic.len_val()).map_err(|_| LinearError::OutOfMemory { dimension })?;
        factor.resize(symbolic.len_val(), 0.0);
        Ok(Analysis {
            symbolic,
            starts,
            rows,
            factor,
            memory,
            residual: vec![0.0; dimension],
            kept: vec![0.0; dimension],
        })
    }

    /// Whether the matrix has the pattern of the analysed one.
    pub fn fits(&self, matrix: &SymmetricMatrix) -> bool {
        self.starts == matrix.starts && self.rows == matrix.rows
    }

    /// Number of values in a factor; each takes 8 bytes.
    pub fn factor_count(&self) -> usize {
        self.factor.len()
    }

    /// L Lᵀ.
    ///
    /// # Errors
    /// A matrix of another pattern, with an entry that is not finite, not positive definite, or singular to rounding.
    pub fn cholesky<'a>(&'a mut self, matrix: &'a SymmetricMatrix) -> Result<Factorisation<'a>, LinearError> {
        self.check(matrix)?;
        match self.factorise_definite(matrix) {
            Ok(()) => self.factorised(matrix, true),
            Err(()) => Err(LinearError::NotPositiveDefinite { dimension: matrix.dimension() }),
        }
    }

    /// L D Lᵀ.
    ///
    /// # Errors
    /// A matrix of another pattern, with an entry that is not finite, or singular to rounding.
    pub fn indefinite<'a>(&'a mut self, matrix: &'a SymmetricMatrix) -> Result<Factorisation<'a>, LinearError> {
        self.check(matrix)?;
        self.factorise_indefinite(matrix)?;
        self.factorised(matrix, false)
    }

    /// L Lᵀ if it exists, otherwise L D Lᵀ.
    ///
    /// # Errors
    /// A matrix of another pattern, with an entry that is not finite, or singular to rounding.
    pub fn factorise<'a>(&'a mut self, matrix: &'a SymmetricMatrix) -> Result<Factorisation<'a>, LinearError> {
        self.check(matrix)?;
        let definite = self.factorise_definite(matrix).is_ok();
        if !definite {
            self.factorise_indefinite(matrix)?;
        }
        self.factorised(matrix, definite)
    }

    fn check(&self, matrix: &SymmetricMatrix) -> Result<(), LinearError> {
        if !self.fits(matrix) {
            return Err(LinearError::PatternDiffers { dimension: matrix.dimension() });
        }
        if matrix.values.iter().all(|value| value.is_finite()) {
            return Ok(());
        }
        match matrix.entries().find(|(_, _, value)| !value.is_finite()) {
            Some((row, column, value)) => Err(LinearError::NotFinite { row, column, value }),
            None => Ok(()),
        }
    }

    /// Computes L Lᵀ in the buffer, if it exists.
    fn factorise_definite(&mut self, matrix: &SymmetricMatrix) -> Result<(), ()> {
        let stack = MemStack::new(&mut self.memory);
        let made = self.symbolic.factorize_numeric_llt(
            &mut self.factor,
            view(matrix),
            Side::Lower,
            Default::default(),
            Par::Seq,
            stack,
            Default::default(),
        );
        match made {
            Ok(_) => Ok(()),
            // The index is one of the permuted matrix, from 0 or from 1 depending on the type of factor, so it is not
            // reported.
            Err(LltError::NonPositivePivot { index: _ }) => Err(()),
        }
    }

    /// Computes L D Lᵀ in the buffer.
    fn factorise_indefinite(&mut self, matrix: &SymmetricMatrix) -> Result<(), LinearError> {
        let stack = MemStack::new(&mut self.memory);
        let made = self.symbolic.factorize_numeric_ldlt(
            &mut self.factor,
            view(matrix),
            Side::Lower,
            Default::default(),
            Par::Seq,
            stack,
            Default::default(),
        );
        match made {
            Ok(_) => Ok(()),
            Err(LdltError::ZeroPivot { .. }) => Err(LinearError::Singular { pivot_ratio: 0.0 }),
        }
    }

    fn factorised<'a>(
        &'a mut self,
        matrix: &'a SymmetricMatrix,
        definite: bool,
    ) -> Result<Factorisation<'a>, LinearError> {
        let (mut smallest, mut largest, mut negative_count) = (f64::INFINITY, 0.0, 0);
        self.for_each_pivot(|value| {
            let size = if definite { value * value } else { value.abs() };
            (smallest, largest) = (-larger(-size, -smallest), larger(size, largest));
            negative_count += usize::from(value < 0.0);
        });
        let pivot_ratio = smallest / largest;
        if pivot_ratio.is_nan() || pivot_ratio <= SINGULAR {
            return Err(LinearError::Singular { pivot_ratio });
        }
        let norm = matrix.norm();
        Ok(Factorisation { analysis: self, matrix, definite, negative_count, pivot_ratio, norm })
    }

    /// Solves once with the factor in the buffer.
    pub(super) fn solve_in_place(&mut self, definite: bool, x: &mut [f64]) {
        let dimension = x.len();
        let stack = MemStack::new(&mut self.memory);
        let (symbolic, factor) = (&self.symbolic, &self.factor);
        let x = MatMut::from_column_major_slice_mut(x, dimension, 1);
        if definite {
            LltRef::new(symbolic, factor).solve_in_place_with_conj(Conj::No, x, Par::Seq, stack);
        } else {
            LdltRef::new(symbolic, factor).solve_in_place_with_conj(Conj::No, x, Par::Seq, stack);
        }
    }

    /// The diagonal of L (L Lᵀ) or D (L D Lᵀ).
    fn for_each_pivot(&self, mut take: impl FnMut(f64)) {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(symbolic) => {
                let starts = symbolic.col_ptr();
                starts[..starts.len() - 1].iter().for_each(|&start| take(self.factor[start]));
            }
            SymbolicCholeskyRaw::Supernodal(symbolic) => {
                let (begins, ends, starts) =
                    (symbolic.supernode_begin(), symbolic.supernode_end(), symbolic.col_ptr_for_val());
                for (node, (&begin, &end)) in begins.iter().zip(ends).enumerate() {
                    let values = &self.factor[starts[node]..starts[node + 1]];
                    let column_count = end - begin;
                    let row_count = values.len() / column_count;
                    (0..column_count).for_each(|k| take(values[k * row_count + k]));
                }
            }
        }
    }
}

/// The largest size of a factor with its workspace on this machine \[bytes\].
fn largest_size() -> usize {
    static LARGEST: OnceLock<usize> = OnceLock::new();
    *LARGEST.get_or_init(|| (MEMORY_SHARE * Memory::of_machine().bytes as f64) as usize)
}

fn view(matrix: &SymmetricMatrix) -> SparseColMatRef<'_, usize, f64> {
    let dimension = matrix.dimension();
    let pattern = SymbolicSparseColMatRef::new_checked(dimension, dimension, &matrix.starts, None, &matrix.rows);
    SparseColMatRef::new(pattern, &matrix.values)
}

/// Limit of refinements. The first removes the error from element growth in L D Lᵀ; the second confirms convergence.
const REFINEMENT_LIMIT: usize = 5;

/// A factorised matrix.
#[derive(Debug)]
pub struct Factorisation<'a> {
    pub(super) analysis: &'a mut Analysis,
    pub(super) matrix: &'a SymmetricMatrix,
    pub(super) definite: bool,
    pub(super) negative_count: usize,
    pub(super) pivot_ratio: f64,
    pub(super) norm: f64,
}

impl Factorisation<'_> {
    /// Whether the matrix is positive definite, as shown by a Cholesky factor. [`Analysis::indefinite`] never computes
    /// one.
    pub fn is_cholesky(&self) -> bool {
        self.definite
    }

    /// Number of negative eigenvalues, equal to that of the negative pivots.
    pub fn negative_eigenvalue_count(&self) -> usize {
        self.negative_count
    }

    /// Smallest over largest absolute value of a pivot \[1\]; for a definite matrix, an upper bound of the inverse
    /// condition number.
    pub fn pivot_ratio(&self) -> f64 {
        self.pivot_ratio
    }

    /// Solves A x = b; overwrites `solution` with x.
    ///
    /// # Errors
    /// The backward error stays above [`ACCURACY`].
    ///
    /// # Panics
    /// If a length differs from the dimension.
    pub fn solve(&mut self, right_side: &[f64], solution: &mut [f64]) -> Result<Solution, LinearError> {
        let dimension = self.matrix.dimension();
        assert!(right_side.len() == dimension && solution.len() == dimension, "one number a row");
        solution.copy_from_slice(right_side);
        self.analysis.solve_in_place(self.definite, solution);
        let mut residual = std::mem::take(&mut self.analysis.residual);
        let mut kept = std::mem::take(&mut self.analysis.kept);
        let mut backward_error = self.residual(right_side, solution, &mut residual);
        let mut refinement_count = 0;
        while backward_error > f64::EPSILON && refinement_count < REFINEMENT_LIMIT {
            self.analysis.solve_in_place(self.definite, &mut residual);
            kept.clone_from_slice(solution);
            solution.iter_mut().zip(&residual).for_each(|(x, step)| *x += step);
            let refined = self.residual(right_side, solution, &mut residual);
            if refined.is_nan() || refined >= backward_error {
                solution.clone_from_slice(&kept);
                break;
            }
            // Reduced by less than half: the rest is rounding.
            let last = refined > 0.5 * backward_error;
            (backward_error, refinement_count) = (refined, refinement_count + 1);
            if last {
                break;
            }
        }
        self.analysis.kept = kept;
        self.analysis.residual = residual;
        // This form refuses NaN.
        if backward_error <= ACCURACY {
            Ok(Solution { backward_error, refinement_count })
        } else {
            Err(LinearError::NotAccurate { backward_error, refinement_count })
        }
    }

    /// Solves A x = b with the factor alone, without a backward error; that of a Cholesky factor is small.
    ///
    /// # Panics
    /// If a length differs from the dimension.
    pub(crate) fn solve_unrefined(&mut self, right_side: &[f64], solution: &mut [f64]) {
        solution.copy_from_slice(right_side);
        self.analysis.solve_in_place(self.definite, solution);
    }

    /// b − A x, and the backward error; 0 for x = b = 0.
    fn residual(&self, right_side: &[f64], solution: &[f64], residual: &mut [f64]) -> f64 {
        self.matrix.multiply(solution, residual);
        residual.iter_mut().zip(right_side).for_each(|(r, b)| *r = b - *r);
        let largest = |column: &[f64]| column.iter().fold(0.0, |most, value| larger(value.abs(), most));
        let scale = self.norm * largest(solution) + largest(right_side);
        if scale == 0.0 { 0.0 } else { largest(residual) / scale }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::Lattice;
    use crate::law::Hertzian;
    use crate::linear::hessian::{Members, Prestress};

    #[test]
    fn a_factor_beyond_the_memory_is_refused_before_it_is_allocated() {
        let circle = Lattice::triangular(0.5, 0.05).and_then(|lattice| lattice.circle(8.0)).expect("a lattice");
        let hessian = Hessian::new(&circle.packing, &Hertzian::default(), Members::Backbone, Prestress::Included)
            .expect("separate disks");
        let matrix = hessian.matrix();
        let bytes = 8 * Analysis::of(&hessian).expect("a small factor").factor_count();
        let within = |largest| Analysis::with(matrix, SymmetricOrdering::Amd, largest).map(drop);
        assert_eq!(within(bytes / 2), Err(LinearError::OutOfMemory { dimension: matrix.dimension() }));
        // The workspace of a factor is smaller than the factor; that of few disks is a few columns.
        assert_eq!(within(4 * bytes), Ok(()));
        let machine = Memory::of_machine().bytes as f64;
        assert!((largest_size() as f64 / machine - MEMORY_SHARE).abs() < 1e-6);
    }
}
