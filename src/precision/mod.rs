//! The cost of accuracy: [`measure`] relaxes one inflated packing by every relaxer at several settings and compares
//! each end state with one known to rounding.
//!
//! ```text
//! error of a run = |its state − its minimum|      against seconds, force evaluations, factorisations
//! ```
//!
//! The minimum is computed by two methods that have only the forces in common: implicit dynamics at a tight tolerance
//! (A) and FIRE (B), both followed by Newton's method. Their difference is reported. A run may end in another minimum,
//! which is not a lack of precision. Gradient flow therefore identifies the minimum of each end state. Errors are
//! relative to that minimum, A, B or another one; for another one its distance from the nearest reference is also
//! reported.
//!
//! The relaxations are timed one after the other, each on one thread.

pub mod csv;
#[cfg(feature = "plot")]
pub mod figure;
mod files;
pub mod ladder;
pub mod minima;
pub mod numerical_choices;
#[cfg(feature = "plot")]
pub mod page;
mod results;
mod sample;
mod settings;
pub mod state;
pub mod table;

use crate::law::pair_law::PairLaw;
use crate::memory::Memory;
use crate::packing::Packing;
use crate::run::{RunError, packing_of, thread_count};
use crate::scene::{Sample, Scene, SceneError};

pub use files::{write, write_into};
pub use results::{PrecisionReport, Run, SamplePrecision};
pub use settings::{PrecisionError, PrecisionSettings};

use sample::of_sample;

/// Progress of a measurement; `()` ignores it.
pub trait Progress: Sync {
    /// A sample with `run_count` runs begins; its packing is ready.
    fn sample(&self, name: &str, run_count: usize) {
        let _ = (name, run_count);
    }
    /// A task of that sample begins; `done` of its runs are complete.
    fn begins(&self, done: usize, what: &str) {
        let _ = (done, what);
    }
}

impl Progress for () {}

/// Measures every sample of a scene.
///
/// # Errors
/// An invalid scene or invalid settings; a sample whose packing or inflation fails. A run that does not converge is a
/// result.
///
/// # Cost
/// See the book.
pub fn measure(
    scene: &Scene,
    settings: &PrecisionSettings,
    progress: &dyn Progress,
) -> Result<PrecisionReport, PrecisionError> {
    scene.check()?;
    settings.check()?;
    scene.check_memory(Memory::of_machine(), thread_count()).map_err(SceneError::from)?;
    let samples = match scene.dimension {
        3 => of_scene::<3>(scene, &scene.law, settings, progress)?,
        _ => of_scene::<2>(scene, &scene.law, settings, progress)?,
    };
    let (scene, settings) = (scene.clone(), settings.clone());
    Ok(PrecisionReport { jamscope_version: env!("CARGO_PKG_VERSION"), scene, settings, samples })
}

fn of_scene<const D: usize>(
    scene: &Scene,
    law: &dyn PairLaw,
    settings: &PrecisionSettings,
    progress: &dyn Progress,
) -> Result<Vec<SamplePrecision>, PrecisionError> {
    let of_one = |(sample, packing): (&Sample, Result<Packing<D>, RunError>)| {
        let measured = packing.and_then(|packing| of_sample(scene, sample, &packing, law, settings, progress));
        measured.map_err(|source| PrecisionError::Sample { name: sample.name.clone(), source })
    };
    scene.sample.iter().zip(packings(scene, law)).map(of_one).collect()
}

/// The packings of all samples. Only this part is not timed, so it runs in parallel.
fn packings<const D: usize>(scene: &Scene, law: &dyn PairLaw) -> Vec<Result<Packing<D>, RunError>> {
    let one = |sample: &Sample| packing_of(scene, sample, law, &mut ()).map(|(packing, _)| packing);
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        scene.sample.par_iter().with_max_len(1).map(one).collect()
    }
    #[cfg(not(feature = "parallel"))]
    scene.sample.iter().map(one).collect()
}
