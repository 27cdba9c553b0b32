//! [`VibrationalModes`]: the lowest vibrational modes of a packing at rest.
//!
//! ```text
//! K e = λ e        λ = ω² for masses 1        participation ratio (Σ_i |e_i|²)² / (N Σ_i |e_i|⁴)
//! ```
//!
//! K is the [Hessian](crate::linear::hessian) of the backbone. Its lowest eigenvalues are the largest of (K + s)⁻¹,
//! computed with one sparse factorisation. s is small compared with ‖K‖, but large enough for K + s to be positive
//! definite. At a saddle the negative eigenvalues therefore come first. Completeness is checked: the negative pivots of
//! K − μ count all eigenvalues below a bound μ (Sylvester), and the search continues until all of them are found.
//!
//! # Source
//! Ericsson, Ruhe (1980), Math. Comput. 35, 1251 (shift and invert, spectrum slicing). Participation ratio: Bell, Dean
//! (1970), Discuss. Faraday Soc. 50, 55.

use faer::{Mat, Side};

use crate::law::pair_law::PairLaw;
use crate::linear::error::LinearError;
use crate::linear::factorisation::Analysis;
use crate::linear::hessian::{Hessian, Members, Prestress};
use crate::linear::lanczos::{dot, largest, norm};
use crate::memory::Memory;
use crate::packing::Packing;
use crate::sparse::SymmetricMatrix;
use crate::vector::{Vector, larger};

/// First shift tried, over ‖K‖ \[1\]; multiplied by 16 until K + s is positive definite. Changes speed only.
const FIRST_SHIFT: f64 = 1e-9;

/// Largest residual of a mode over ‖K‖ \[1\]. The products with K alone have a rounding of about 10⁻¹⁶.
pub const TOLERANCE: f64 = 1e-13;

/// Smallest gap between two eigenvalues for a bound between them, over ‖K‖ \[1\]. It is far above the residuals, so the
/// order is certain.
const GAP: f64 = 1e-11;

/// If more than one in this many modes is requested, dense algebra computes all modes. Shift-and-invert loses digits of
/// modes far from the shift, and the vectors would take as much memory as the dense matrix.
const DENSE_SHARE: usize = 4;

/// Limit of the number of searches.
const SEARCH_LIMIT: usize = 40;

/// A vibrational mode.
#[derive(Debug, Clone, PartialEq)]
pub struct Mode<const D: usize> {
    /// λ = ω² for masses 1 \[force / length\].
    pub eigenvalue: f64,
    /// ‖K e − λ e‖ / ‖K‖ for ‖e‖ = 1. The error of λ is below this times ‖K‖ \[1\].
    pub residual: f64,
    /// From 1/N if a single disk moves to 1 if all N disks of the backbone move equally \[1\].
    pub participation_ratio: f64,
    /// e, one entry per disk, Σ |e_i|² = 1; 0 for held disks and those off the backbone \[1\].
    pub displacements: Vec<Vector<D>>,
}

/// The lowest modes of a packing, ascending.
///
/// # Example
/// ```
/// use jamscope::law::Hookean;
/// use jamscope::linear::Prestress;
/// use jamscope::lattice::Lattice;
/// use jamscope::linear::VibrationalModes;
///
/// // In a nearly square box the waves have multiplicities of six or twelve by symmetry.
/// let packing = Lattice::triangular(0.5, 0.01)?.periodic([8, 5])?;
/// let found = VibrationalModes::lowest(&packing, &Hookean { stiffness: 1.0 }, Prestress::Included, 4)?;
/// assert_eq!((found.modes.len(), found.translation_count), (4, 2));
/// assert!(found.modes[0].eigenvalue > 0.0 && found.modes.iter().all(|mode| mode.residual < 1e-13));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct VibrationalModes<const D: usize> {
    /// The modes, λ ascending.
    pub modes: Vec<Mode<D>>,
    /// Number of translations of the whole packing, which are excluded: D if nothing holds it, otherwise 0.
    pub translation_count: usize,
    /// Largest ‖K t‖ / ‖K‖ of a translation: the rounding of the matrix \[1\].
    pub translation_residual: f64,
    /// ‖K‖, the largest sum of absolute values in a row; an upper bound of all eigenvalues \[force / length\].
    pub norm: f64,
    /// Number of unknowns.
    pub unknown_count: usize,
    /// Number of factorisations: for the shift, and for every count.
    pub factorisation_count: usize,
    /// Number of linear systems solved.
    pub solution_count: usize,
}

impl<const D: usize> VibrationalModes<D> {
    /// The `count` lowest modes of the backbone; all modes if there are fewer.
    ///
    /// # Errors
    /// No backbone; a factorisation that fails; residuals above [`TOLERANCE`].
    ///
    /// # Accuracy
    /// Residuals are below [`TOLERANCE`] ‖K‖, so eigenvalues are exact to that. Against a dense eigensolver the error
    /// is below 7·10⁻¹⁶ ‖K‖ (up to 30 modes of the published packings). None of the lowest modes is missing, by their
    /// count.
    ///
    /// # Cost
    /// Ten modes of 1000 disks: 2 factorisations and 54 to 62 solutions, with as many vectors in memory (`cargo test
    /// modes:: -- --nocapture`). If a quarter of all modes or more is requested, dense algebra takes a time of third
    /// power.
    pub fn lowest(
        packing: &Packing<D>,
        law: &dyn PairLaw,
        prestress: Prestress,
        count: usize,
    ) -> Result<Self, LinearError> {
        let hessian = Hessian::new(packing, law, Members::Backbone, prestress)?;
        let matrix = hessian.matrix();
        if matrix.dimension() == 0 {
            return Err(LinearError::NoBackbone { disk_count: packing.len() });
        }
        let floating = !packing.held().contains(&true) && law.on_site_coupling() == 0.0;
        let translations = if floating { translations::<D>(matrix.dimension()) } else { Vec::new() };
        let count = count.min(matrix.dimension() - translations.len());
        check_memory(matrix.dimension(), count)?;
        let mut search = Search::new(matrix, translations);
        if DENSE_SHARE * count >= matrix.dimension() {
            search.all()?
        } else {
            search.until_found(count, || Analysis::of(&hessian))?
        }
        let mode = |pair: &Pair| {
            let displacements = hessian.scatter(&pair.vector);
            let fourth: f64 = displacements.iter().map(|e| dot(e, e).powi(2)).sum();
            let participation_ratio = 1.0 / (hessian.disks().len() as f64 * fourth);
            Mode { eigenvalue: pair.value, residual: pair.residual, participation_ratio, displacements }
        };
        let translation_residual =
            search.translations().iter().fold(0.0, |most, t| larger(residual(matrix, t).1, most)) / search.norm;
        Ok(VibrationalModes {
            modes: search.pairs.iter().take(count).map(mode).collect(),
            translation_count: search.translation_count,
            translation_residual,
            norm: search.norm,
            unknown_count: matrix.dimension(),
            factorisation_count: search.factorisation_count,
            solution_count: search.solution_count,
        })
    }
}

/// Checks the memory for `count` modes of `dimension` components. Dense algebra needs the matrix, its vectors and as
/// much workspace; otherwise two vectors per mode are a lower bound.
fn check_memory(dimension: usize, count: usize) -> Result<(), LinearError> {
    let column = 8.0 * dimension as f64;
    let bytes =
        if DENSE_SHARE * count >= dimension { 3.0 * dimension as f64 * column } else { 2.0 * count as f64 * column };
    // In terms of the count, since the packing sets all other sizes.
    Ok(Memory::of_machine().check("modes", count, bytes / count.max(1) as f64)?)
}

/// An eigenpair of K.
struct Pair {
    value: f64,
    residual: f64,
    vector: Vec<f64>,
}

/// The eigenpairs found so far.
struct Search<'a> {
    matrix: &'a SymmetricMatrix,
    norm: f64,
    /// Translations, then the eigenvectors in the order of their discovery.
    known: Vec<Vec<f64>>,
    translation_count: usize,
    /// Ascending.
    pairs: Vec<Pair>,
    factorisation_count: usize,
    solution_count: usize,
}

impl<'a> Search<'a> {
    fn new(matrix: &'a SymmetricMatrix, translations: Vec<Vec<f64>>) -> Self {
        let (norm, translation_count) = (matrix.norm(), translations.len());
        let (pairs, known) = (Vec::new(), translations);
        Search { matrix, norm, known, translation_count, pairs, factorisation_count: 0, solution_count: 0 }
    }

    /// Computes all pairs by dense algebra; translations are shifted above the spectrum.
    fn all(&mut self) -> Result<(), LinearError> {
        let dimension = self.matrix.dimension();
        let moved = |row: usize, column: usize| -> f64 {
            self.translations().iter().map(|t| 2.0 * self.norm * t[row] * t[column]).sum()
        };
        let mut dense = Mat::from_fn(dimension, dimension, moved);
        for (row, column, value) in self.matrix.entries() {
            if !value.is_finite() {
                return Err(LinearError::NotFinite { row, column, value });
            }
            dense[(row, column)] += value;
        }
        let asked = dimension - self.translation_count;
        let lost = |found| LinearError::ModesNotFound { found, asked, tolerance: TOLERANCE, factorisation_count: 0 };
        let eigen = dense.self_adjoint_eigen(Side::Lower).map_err(|_| lost(0))?;
        for k in 0..asked {
            self.take((0..dimension).map(|row| eigen.U()[(row, k)]).collect());
        }
        if self.pairs.len() == asked { Ok(()) } else { Err(lost(self.pairs.len())) }
    }

    fn translations(&self) -> &[Vec<f64>] {
        &self.known[..self.translation_count]
    }

    /// Continues until the lowest `count` pairs are proven to be the lowest.
    fn until_found(
        &mut self,
        count: usize,
        analysis: impl Fn() -> Result<Analysis, LinearError>,
    ) -> Result<(), LinearError> {
        if count == 0 {
            return Ok(());
        }
        let (mut inverse, mut counting) = (analysis()?, analysis()?);
        let shifted = self.definite(&mut inverse)?;
        let mut inverse = inverse.cholesky(&shifted)?;
        let available = self.matrix.dimension() - self.translation_count;
        let margin = 4.max(count / 4);
        let mut wanted = (count + margin).min(available);
        for search in 0..SEARCH_LIMIT {
            let more = wanted.saturating_sub(self.pairs.len()).max(1);
            let solution_count = &mut self.solution_count;
            let vectors = largest(self.matrix.dimension(), &self.known, more, search as u64, |right, solution| {
                *solution_count += 1;
                inverse.solve(right, solution).map(|_| ())
            })?;
            vectors.into_iter().for_each(|vector| self.take(vector));
            if self.pairs.len() == available {
                return Ok(());
            }
            match self.bound_above(count) {
                Some((below, bound)) => {
                    let all = self.count_below(&mut counting, bound)?;
                    if all == below {
                        return Ok(());
                    }
                    wanted = self.pairs.len() + all.saturating_sub(below).max(1);
                }
                None => wanted = self.pairs.len().max(count) + margin,
            }
            wanted = wanted.min(available);
        }
        let found = self.pairs.len().min(count);
        let factorisation_count = self.factorisation_count;
        Err(LinearError::ModesNotFound { found, asked: count, tolerance: TOLERANCE, factorisation_count })
    }

    /// K + s with s large enough to be positive definite.
    fn definite(&mut self, analysis: &mut Analysis) -> Result<SymmetricMatrix, LinearError> {
        let mut shift = FIRST_SHIFT * self.norm;
        loop {
            let shifted = self.matrix.shifted(shift);
            self.factorisation_count += 1;
            match analysis.cholesky(&shifted) {
                Ok(_) => return Ok(shifted),
                // No eigenvalue is below −‖K‖.
                Err(LinearError::NotPositiveDefinite { .. } | LinearError::Singular { .. }) if shift <= self.norm => {
                    shift *= 16.0;
                }
                Err(error) => return Err(error),
            }
        }
    }

    /// Adds a vector if it is an eigenvector to within [`TOLERANCE`].
    fn take(&mut self, vector: Vec<f64>) {
        let (value, residual) = residual(self.matrix, &vector);
        let residual = residual / self.norm;
        if residual <= TOLERANCE {
            let place = self.pairs.partition_point(|pair| pair.value <= value);
            self.known.push(vector.clone());
            self.pairs.insert(place, Pair { value, residual, vector });
        }
    }

    /// The first gap above the lowest `count` pairs: the number of pairs below it, and its midpoint.
    fn bound_above(&self, count: usize) -> Option<(usize, f64)> {
        (count..self.pairs.len()).find_map(|below| {
            let (low, high) = (self.pairs[below - 1].value, self.pairs[below].value);
            let middle = 0.5 * (low + high);
            // The translations must be on one side as well.
            let clear = high - low > GAP * self.norm && (self.translation_count == 0 || middle.abs() > GAP * self.norm);
            clear.then_some((below, middle))
        })
    }

    /// Number of eigenvalues below a bound, without translations.
    fn count_below(&mut self, analysis: &mut Analysis, bound: f64) -> Result<usize, LinearError> {
        let shifted = self.matrix.shifted(-bound);
        self.factorisation_count += 1;
        let negative = analysis.indefinite(&shifted)?.negative_eigenvalue_count();
        Ok(negative.saturating_sub(if bound > 0.0 { self.translation_count } else { 0 }))
    }
}

/// eᵀ K e and ‖K e − (eᵀ K e) e‖ of a unit vector.
fn residual(matrix: &SymmetricMatrix, vector: &[f64]) -> (f64, f64) {
    let mut product = vec![0.0; vector.len()];
    matrix.multiply(vector, &mut product);
    let value = dot(vector, &product);
    product.iter_mut().zip(vector).for_each(|(p, x)| *p -= value * x);
    (value, norm(&product))
}

/// Unit vectors of uniform translations of all disks.
fn translations<const D: usize>(dimension: usize) -> Vec<Vec<f64>> {
    let length = 1.0 / ((dimension / D) as f64).sqrt();
    (0..D).map(|axis| (0..dimension).map(|row| if row % D == axis { length } else { 0.0 }).collect()).collect()
}
