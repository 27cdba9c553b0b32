//! What accuracy costs: [`measure`] relaxes one inflated packing by every relaxer at a ladder of settings and holds each end
//! against a state known to rounding.
//!
//! ```text
//! error of a run = |its state − the minimum it belongs to|      against seconds, force evaluations, factorisations
//! ```
//!
//! The minimum is known by two methods that share nothing but the forces: implicit dynamics at a tight tolerance (A) and FIRE
//! (B), both finished by Newton; how far they disagree is stated. A run may have fallen into another minimum, which is no lack
//! of precision. So each end is followed by gradient flow to the minimum it belongs to. Where that is A or B, errors are those
//! against A or B; where it is another, they are against that one, and its distance from the nearest reference is told beside.
//!
//! The relaxations are timed one after the other, each on one thread.

pub mod choices;
pub mod csv;
#[cfg(feature = "plot")]
pub mod figure;
mod files;
pub mod ladder;
pub mod minima;
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

/// What a measurement tells while it works; `()` hears nothing.
pub trait Progress: Sync {
    /// A sample of so many runs begins; its packing is there.
    fn sample(&self, name: &str, run_count: usize) {
        let _ = (name, run_count);
    }
    /// A piece of work of that sample begins, `done` runs of it being over.
    fn begins(&self, done: usize, what: &str) {
        let _ = (done, what);
    }
}

impl Progress for () {}

/// Measures every sample of a scene.
///
/// # Errors
/// Scene or settings that make no sense; a sample whose packing or inflation cannot be had. A run that does not converge is a
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
    let samples = of_scene(scene, &scene.law, settings, progress)?;
    let (scene, settings) = (scene.clone(), settings.clone());
    Ok(PrecisionReport { jamscope_version: env!("CARGO_PKG_VERSION"), scene, settings, samples })
}

fn of_scene<L: PairLaw>(
    scene: &Scene,
    law: &L,
    settings: &PrecisionSettings,
    progress: &dyn Progress,
) -> Result<Vec<SamplePrecision>, PrecisionError> {
    let of_one = |(sample, packing): (&Sample, Result<Packing<2>, RunError>)| {
        let measured = packing.and_then(|packing| of_sample(scene, sample, &packing, law, settings, progress));
        measured.map_err(|source| PrecisionError::Sample { name: sample.name.clone(), source })
    };
    scene.sample.iter().zip(packings(scene, law)).map(of_one).collect()
}

/// The packings of all samples: the only part that is not timed, so they are made side by side.
fn packings<L: PairLaw>(scene: &Scene, law: &L) -> Vec<Result<Packing<2>, RunError>> {
    let one = |sample: &Sample| packing_of(scene, sample, law, &mut ()).map(|(packing, _)| packing);
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        scene.sample.par_iter().with_max_len(1).map(one).collect()
    }
    #[cfg(not(feature = "parallel"))]
    scene.sample.iter().map(one).collect()
}
