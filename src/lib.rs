//! The mechanics of jammed packings: prepare, inflate, relax, and compare the response with exact solutions.
//!
//! Soft frictionless disks push each other if they overlap, δ_ij = R_i + R_j − r_ij > 0. A packing is relaxed to a
//! minimum of its energy, one disk is inflated by d_0, and the packing is relaxed again. The radial part of the
//! displacements is compared with the solution of a continuum between the inflated disk, radius a, and a held rim,
//! radius R:
//!
//! ```text
//! E = Σ_(i<j) u(δ_ij)      −∂E/∂r_i = 0 for every mobile disk, before and after
//!
//! d_r'' + d_r'/r − d_r/r² + κ² d_r = 0      d_r(a) = d_0,  d_r(R) = 0
//! ```
//!
//! κ = 0 is the elastic medium; for κ > 0 plastic events screen the elastic field, as they do close to jamming.
//!
//! # Example
//!
//! 200 disks far from jamming respond as an elastic medium.
//!
//! ```
//! use jamscope::preparation::Target;
//! use jamscope::reference::{RadialSolution, elastic::Elastic};
//! use jamscope::{Annulus, DisplacementField, Inflation, Preparation, RadialProfile, inflate, prepare};
//!
//! let target = Target::Pressure(3000.0);
//! let prepared = prepare(&Preparation { disk_count: 200, target, ..Preparation::default() })?;
//! let inflated = inflate(&Inflation::default(), prepared.packing.get())?;
//! let field = DisplacementField::of_inflation(&inflated);
//! let profile = RadialProfile::of(&field, 1.0);
//!
//! // The amplitude d_0^eff of the elastic solution by least squares in r·d_r, and the described share of Σ (r·d_r)².
//! let medium = Elastic::<2>::new(Annulus::new(field.inner_radius, field.outer_radius)?, 1.0)?;
//! let sum = |f: &dyn Fn(f64, f64) -> f64| -> f64 {
//!     profile.rings.iter().map(|ring| ring.radius.powi(2) * f(ring.mean, medium.value(ring.radius))).sum()
//! };
//! let (both, ours, theirs) = (sum(&|d, e| d * e), sum(&|d, _| d * d), sum(&|_, e| e * e));
//! let (amplitude, share) = (both / theirs, both * both / (ours * theirs));
//! assert!(share > 0.9, "the elastic solution describes {share} of the profile");
//! assert!(amplitude > 0.05 && amplitude < 0.15, "d_0 = 0.1 acts as {amplitude}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`prepare`] and [`inflate`] take Hertzian disks and FIRE; [`prepare_with`](preparation::prepare_with) and
//! [`inflate_with`](inflation::inflate_with) take any law, relaxer and observer. Seven programs of at most 50 lines are in `examples/`.
//!
//! # Modules
//!
//! In the order in which they build on each other: a module imports only from modules above it.
//!
//! | module | content | start from |
//! |---|---|---|
//! | [`processor`] | the vector instructions that the kernels use | [`Processor`](processor::Processor) |
//! | [`vector`] | vectors of D = 2 or 3 components, error-free sums | [`Vector`](vector::Vector) |
//! | `sparse` (feature `linear`) | one triangle of a symmetric matrix in compressed columns | `sparse::SymmetricMatrix` |
//! | [`memory`] | the memory limit for a count | [`Memory`](memory::Memory) |
//! | [`packing`] | centres, radii, domain, which disks are held | [`Packing`] |
//! | [`io`] | packings in files | [`read_packing`] |
//! | [`law`] | force and energy of one contact, damping, sites | [`PairLaw`], [`Hertzian`] |
//! | [`neighbours`] | pairs that may touch: cells, Verlet lists | [`PairList`](neighbours::PairList) |
//! | [`forces`] | positions and forces of a moving packing; the loop over contacts | [`Assembly`](forces::Assembly) |
//! | [`network`] | contacts, rattlers, coordination, pressure | [`ContactNetwork`] |
//! | `linear` (feature `linear`) | Hessian, factorisations, the response to an infinitesimal inflation, elastic moduli, modes | `linear::LinearResponse`, `linear::ElasticModuli` |
//! | [`relax`] | relaxation of a packing to rest | [`Relaxer`](relax::Relaxer), [`Fire`] |
//! | [`certificate`] | verified properties of a state at rest | [`Certificate`](certificate::Certificate) |
//! | [`preparation`] | from random points to a packing at a packing fraction or a pressure | [`prepare`] |
//! | [`strain`] | quasistatic simple shear of a periodic packing | [`QuasistaticShear`](strain::QuasistaticShear) |
//! | [`inflation`] | inflation of one disk and relaxation of the others; deflation | [`inflate`] |
//! | [`lattice`] | lattices with known continuum response | [`Lattice`](lattice::Lattice) |
//! | [`displacement`] | displacements of all disks | [`DisplacementField`] |
//! | `plastic` (feature `linear`) | the part of a response beyond the linear one, and where it begins | `plastic::PlasticPart` |
//! | [`observe`] | radial and angular profile, angular modes, spectrum and correlation of a ring or a shell, contact forces and changes, penetration and isostatic length | [`RadialProfile`], [`AngularCorrelation`](observe::angular::AngularCorrelation) |
//! | [`reference`](mod@reference) | exact solutions, elastic and screened | [`Annulus`] |
//! | `fit` (feature `fit`) | a profile against both solutions, with errors and a decision; slope and crossover of an angular spectrum; crossings, powers and collapses of ensembles | `fit::profile::fit_radial_profile`, `fit::angular::fit_slope`, `fit::ensemble` |
//! | `protocol` (feature `linear`) | whether relaxers end in the same minimum | `protocol::ProtocolSensitivity` |
//! | [`verdict`] | whether states are at rest, so that a phase and fits may be reported | [`RestVerdict`](verdict::RestVerdict) |
//! | [`inspection`] | the properties of a packing file | [`inspect`](inspection::inspect()) |
//! | [`scene`] | all settings of a run as plain data | [`Scene`] |
//! | [`response`] | all observables of one inflation, and its phase | [`Response`](response::Response) |
//! | [`analysis`] | the same for states relaxed by other programs | [`Analysis`](analysis::Analysis) |
//! | [`run`] | from a scene to a report, one line per stage | [`run::run`] |
//! | [`study`] | an experiment over lists of parameters, resumable | [`study::execute`](study::execute()), [`study::merge`](study::merge()) |
//! | `transition` (feature `fit`) | p_c, its scaling and lengths from a study, with published values | `transition::Transition` |
//! | [`report`] | table, data files, figures, one page | [`report::write`] |
//! | `precision` (feature `linear`) | error against cost of relaxers and other numerical choices | `precision::measure` |
//!
//! The type of the result of a stage states what is known of it: only a converged relaxation makes a
//! [`Relaxed`](relax::Relaxed) packing, and only two of these make a displacement field.
//!
//! # Features
//!
//! | feature | adds | with |
//! |---|---|---|
//! | `fit` | fits of a measured profile, of a measured spectrum, of ensembles | argmin |
//! | `linear` | Newton, FIRE then Newton, implicit dynamics, gradient flow; Hessian, factorisations, linear response, plastic part, moduli, modes, stability, protocol sensitivity; `jamscope precision`, `inspect --modes` | faer |
//! | `parallel` | samples of a scene in parallel, or the tiles of one large packing; never changes a bit of a result | rayon |
//! | `plot` | figures and the HTML page of a report | plotters |
//! | `cli` | the program `jamscope`, scenes from TOML | clap, toml, indicatif |
//!
//! All are on by default; every subset compiles. Without `linear` the default
//! [protocol](scene::ProtocolChoice) is `fire`, `fire-newton` is `fire`, and `study` and `constant` take explicit
//! steps, so a scene may end in other minima. Without `fit` a phase rests on Δp and the changed contacts alone.
//!
//! # Further
//!
//! The book (`book/src`) has a chapter for each module that computes physics: the question, the equation, the method, its tests and its limits.
//! Its snippets are compiled and run by `cargo test --doc`.

// Results must not depend on elementary functions of the system (clippy.toml); tests may use them.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod analysis;
pub mod certificate;
pub mod displacement;
#[cfg(feature = "fit")]
pub mod fit;
pub mod forces;
pub mod inflation;
pub mod inspection;
pub mod io;
pub mod lattice;
pub mod law;
#[cfg(feature = "linear")]
pub mod linear;
pub mod memory;
pub mod neighbours;
pub mod network;
pub mod observe;
pub mod packing;
mod parallel;
#[cfg(feature = "linear")]
pub mod plastic;
#[cfg(feature = "linear")]
pub mod precision;
pub mod preparation;
pub mod processor;
#[cfg(feature = "linear")]
pub mod protocol;
pub mod reference;
pub mod relax;
pub mod report;
pub mod response;
pub mod run;
pub mod scene;
mod simd;
#[cfg(feature = "linear")]
pub mod sparse;
pub mod strain;
pub mod study;
#[cfg(feature = "fit")]
pub mod transition;
pub mod vector;
pub mod verdict;

pub use displacement::DisplacementField;
pub use inflation::{Inflation, inflate};
pub use io::read_packing;
pub use law::{Hertzian, Hookean, PairLaw};
pub use network::ContactNetwork;
pub use observe::RadialProfile;
pub use packing::{Mixture, Packing};
pub use preparation::{Preparation, prepare};
pub use reference::Annulus;
pub use relax::Fire;
pub use scene::Scene;

/// The README and the chapters of the book, so that `cargo test --doc` compiles and runs their snippets.
#[cfg(doctest)]
mod book {
    #[doc = include_str!("../README.md")]
    mod readme {}
    #[doc = include_str!("../book/src/introduction.md")]
    mod introduction {}
    #[doc = include_str!("../book/src/first_run.md")]
    mod first_run {}
    #[doc = include_str!("../book/src/experiment.md")]
    mod experiment {}
    #[doc = include_str!("../book/src/by_hand.md")]
    mod by_hand {}
    #[doc = include_str!("../book/src/screening.md")]
    mod screening {}
    #[doc = include_str!("../book/src/measuring.md")]
    mod measuring {}
    #[doc = include_str!("../book/src/units.md")]
    mod units {}
    #[doc = include_str!("../book/src/packing.md")]
    mod packing {}
    #[doc = include_str!("../book/src/io.md")]
    mod io {}
    #[doc = include_str!("../book/src/law.md")]
    mod contact_law {}
    #[doc = include_str!("../book/src/law/damping.md")]
    mod contact_damping {}
    #[doc = include_str!("../book/src/neighbours.md")]
    mod contact_neighbours {}
    #[doc = include_str!("../book/src/forces.md")]
    mod contact_forces {}
    #[doc = include_str!("../book/src/network.md")]
    mod contact_network {}
    #[doc = include_str!("../book/src/law/on_site.md")]
    mod contact_on_site {}
    #[cfg(feature = "linear")]
    #[doc = include_str!("../book/src/linear.md")]
    mod linear {}
    #[cfg(feature = "linear")]
    #[doc = include_str!("../book/src/linear/moduli.md")]
    mod linear_moduli {}
    #[cfg(feature = "linear")]
    #[doc = include_str!("../book/src/linear/modes.md")]
    mod linear_modes {}
    #[doc = include_str!("../book/src/certificate.md")]
    mod certificate {}
    #[doc = include_str!("../book/src/verdict.md")]
    mod verdict {}
    #[doc = include_str!("../book/src/relax/fire.md")]
    mod relax_fire {}
    #[doc = include_str!("../book/src/relax/damped.md")]
    mod relax_damped {}
    #[cfg(feature = "linear")]
    #[doc = include_str!("../book/src/relax/implicit.md")]
    mod relax_implicit {}
    #[cfg(feature = "linear")]
    #[doc = include_str!("../book/src/relax/stability.md")]
    mod relax_stability {}
    #[cfg(feature = "linear")]
    #[doc = include_str!("../book/src/relax/newton.md")]
    mod relax_newton {}
    #[doc = include_str!("../book/src/relax/others.md")]
    mod relax_others {}
    #[doc = include_str!("../book/src/relax/stopping.md")]
    mod relax_stopping {}
    #[doc = include_str!("../book/src/preparation.md")]
    mod preparation {}
    #[cfg(feature = "linear")]
    #[doc = include_str!("../book/src/drives.md")]
    mod drives {}
    #[doc = include_str!("../book/src/inflation.md")]
    mod inflation {}
    #[cfg(all(feature = "linear", feature = "fit"))]
    #[doc = include_str!("../book/src/lattice.md")]
    mod lattice {}
    #[doc = include_str!("../book/src/displacement.md")]
    mod displacement {}
    #[doc = include_str!("../book/src/observe/radial_profile.md")]
    mod observe_radial_profile {}
    #[doc = include_str!("../book/src/observe/angular_profile.md")]
    mod observe_angular_profile {}
    #[doc = include_str!("../book/src/observe/multipoles.md")]
    mod observe_multipoles {}
    #[doc = include_str!("../book/src/observe/penetration_length.md")]
    mod observe_penetration_length {}
    #[doc = include_str!("../book/src/observe/isostatic_length.md")]
    mod observe_isostatic_length {}
    #[doc = include_str!("../book/src/observe/contact_changes.md")]
    mod observe_contact_changes {}
    #[cfg(feature = "fit")]
    #[doc = include_str!("../book/src/observe/power_spectrum.md")]
    mod observe_power_spectrum {}
    #[doc = include_str!("../book/src/observe/angular_correlation.md")]
    mod observe_angular_correlation {}
    #[cfg(feature = "fit")]
    #[doc = include_str!("../book/src/observe/shell.md")]
    mod observe_shell {}
    #[doc = include_str!("../book/src/observe/angular_study.md")]
    mod observe_angular_study {}
    #[doc = include_str!("../book/src/reference.md")]
    mod reference {}
    #[doc = include_str!("../book/src/reference/spherical_modes.md")]
    mod reference_spherical_modes {}
    #[doc = include_str!("../book/src/reference/angular_modes.md")]
    mod reference_angular_modes {}
    #[doc = include_str!("../book/src/reference/lorentzian.md")]
    mod reference_lorentzian {}
    #[doc = include_str!("../book/src/reference/bessel.md")]
    mod reference_bessel {}
    #[doc = include_str!("../book/src/reference/wavenumber_derivative.md")]
    mod reference_wavenumber_derivative {}
    #[cfg(feature = "fit")]
    #[doc = include_str!("../book/src/fit.md")]
    mod fit {}
    #[cfg(feature = "fit")]
    #[doc = include_str!("../book/src/fit/ensemble.md")]
    mod fit_ensemble {}
    #[cfg(feature = "linear")]
    #[doc = include_str!("../book/src/protocol.md")]
    mod protocol {}
    #[doc = include_str!("../book/src/plastic_phase.md")]
    mod plastic_phase {}
    #[doc = include_str!("../book/src/ensembles.md")]
    mod ensembles {}
    #[doc = include_str!("../book/src/scene.md")]
    mod scene {}
    #[doc = include_str!("../book/src/response.md")]
    mod response {}
    #[cfg(feature = "fit")]
    #[doc = include_str!("../book/src/analysis.md")]
    mod analysis {}
    #[doc = include_str!("../book/src/own_packing.md")]
    mod own_packing {}
    #[doc = include_str!("../book/src/library.md")]
    mod library {}
    #[doc = include_str!("../book/src/exact.md")]
    mod exact {}
    #[doc = include_str!("../book/src/report.md")]
    mod report {}
    #[cfg(feature = "fit")]
    #[doc = include_str!("../book/src/transition.md")]
    mod transition {}
    #[doc = include_str!("../book/src/spheres.md")]
    mod spheres {}
    #[doc = include_str!("../book/src/study.md")]
    mod study {}
    #[doc = include_str!("../book/src/cluster.md")]
    mod cluster {}
    #[doc = include_str!("../book/src/outcomes.md")]
    mod outcomes {}
    #[doc = include_str!("../book/src/extremes.md")]
    mod extremes {}
    #[doc = include_str!("../book/src/slips.md")]
    mod slips {}
    #[doc = include_str!("../book/src/validation.md")]
    mod validation {}
    #[cfg(feature = "linear")]
    #[doc = include_str!("../book/src/precision.md")]
    mod precision {}
    #[doc = include_str!("../book/src/performance.md")]
    mod performance {}
    #[doc = include_str!("../book/src/processor.md")]
    mod processor {}
    #[doc = include_str!("../book/src/glossary.md")]
    mod glossary {}
    #[doc = include_str!("../book/src/references.md")]
    mod references {}
}
