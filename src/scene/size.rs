//! Whether a scene fits index types and memory: [`Scene::check_memory`].

use crate::memory::{Limit, Memory, TooLarge};
use crate::relax::RelaxerChoice;
use crate::scene::definition::Scene;

/// Memory of one disk while its packing is relaxed and measured \[bytes\]. A lower bound from `jamscope run` without
/// observables at φ = 0.5, where data are smallest: the peak memory increases by 513 bytes per disk, of which half is
/// kept.
pub(super) const BYTES_A_DISK: f64 = 250.0;

/// Memory of one disk that is kept for the report: the packing and its states before and after \[bytes\]. A lower bound
/// from the increase by 285 bytes for each further sample.
const KEPT_BYTES_A_DISK: f64 = 250.0;

/// Memory of a disk for each stored step of L-BFGS: two vectors of two components \[bytes\].
const REMEMBERED_BYTES_A_DISK: f64 = 32.0;

/// Largest number of disks: indices have 32 bits.
pub(super) const DISK_INDEX: Limit = Limit { largest: u32::MAX as u64, reason: "indices of disks have 32 bits" };

impl Scene {
    /// Checks whether the packings of this scene fit into memory if `at_once` of them are relaxed in parallel.
    ///
    /// The estimate is a lower bound: a refused scene cannot work, an accepted one may still be too large.
    ///
    /// # Errors
    /// [`TooLarge`] with `disk_count`, the largest possible value and the memory needed.
    pub fn check_memory(&self, memory: Memory, at_once: usize) -> Result<(), TooLarge> {
        let relaxers = self.sample.iter().map(|sample| &sample.relaxer).chain([&self.preparation.relaxer]);
        let remembered = relaxers.map(remembered_steps).max().unwrap_or(0) as f64;
        let samples = self.sample.len().max(1);
        let working = samples.min(at_once.max(1)) as f64 * (BYTES_A_DISK + remembered * REMEMBERED_BYTES_A_DISK);
        memory.check("disk_count", self.disk_count, working + samples as f64 * KEPT_BYTES_A_DISK)
    }
}

/// Number of steps that a relaxer stores.
fn remembered_steps(relaxer: &RelaxerChoice) -> usize {
    match relaxer {
        RelaxerChoice::QuasiNewton(quasi_newton) => quasi_newton.memory,
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::relax::QuasiNewton;

    #[test]
    fn memory_is_that_of_all_samples_relaxed_at_once() {
        let scene = Scene { disk_count: 1_000_000, ..Scene::default() };
        // Three samples: 3 × 250 + 3 × 250 bytes per disk.
        let memory = |bytes| Memory { bytes, origin: "this test" };
        assert_eq!(scene.check_memory(memory(1_500_000_000), 8), Ok(()));
        let refused = scene.check_memory(memory(1_499_999_999), 8).expect_err("a byte too few");
        assert_eq!((refused.field.as_str(), refused.limit, refused.bytes), ("disk_count", 999_999, 1.5e9));
        assert_eq!(scene.check_memory(memory(1_000_000_000), 1), Ok(()));
        let mut long = scene.clone();
        long.sample[0].relaxer = RelaxerChoice::QuasiNewton(QuasiNewton { memory: 1000, ..QuasiNewton::default() });
        assert!(long.check_memory(memory(1_500_000_000), 1).is_err());
    }
}
