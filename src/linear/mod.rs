//! Linear algebra of packings at rest: sparse factorisations of the [`Hessian`], the response to an infinitesimal
//! inflation or strain, and vibrational modes.
//!
//! Start from [`LinearResponse`], [`ElasticModuli`] or [`VibrationalModes`], or from [`Analysis`] for any matrix. A
//! definite matrix is factorised by Cholesky, an indefinite one as L D Lᵀ, which gives the number of its negative
//! eigenvalues. Every solution is refined and includes its backward error.
//!
//! ```
//! use jamscope::law::Hertzian;
//! use jamscope::linear::{Hessian, Members, Prestress};
//! use jamscope::lattice::Lattice;
//! use jamscope::linear::Analysis;
//!
//! let circle = Lattice::triangular(0.5, 0.05)?.circle(8.0)?;
//! let hessian = Hessian::new(&circle.packing, &Hertzian::default(), Members::Backbone, Prestress::Included)?;
//! // One analysis serves all matrices with the same pattern of entries.
//! let mut analysis = Analysis::of(&hessian)?;
//! let mut factors = analysis.factorise(hessian.matrix())?;
//! assert!(factors.is_cholesky() && factors.negative_eigenvalue_count() == 0);
//! // A force along x on every disk.
//! let push = hessian.gather(&vec![[1.0, 0.0]; circle.packing.len()]);
//! let mut moved = vec![0.0; push.len()];
//! let told = factors.solve(&push, &mut moved)?;
//! assert!(told.backward_error < 1e-15);
//! assert!(hessian.scatter(&moved)[circle.centre] == [0.0, 0.0], "the centre is held");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod contact_changes;
mod dissection;
mod error;
pub mod factorisation;
pub mod hessian;
pub mod iterative;
mod lanczos;
pub mod modes;
pub mod moduli;
pub mod ordering;
pub(crate) mod pinned;
pub mod response;
pub mod solution;

pub use contact_changes::ContactChange;
pub use error::LinearError;
pub use factorisation::{Analysis, Factorisation};
pub use hessian::{Hessian, Members, Prestress};
pub use modes::VibrationalModes;
pub use moduli::ElasticModuli;
pub use response::LinearResponse;
pub use solution::Solution;
