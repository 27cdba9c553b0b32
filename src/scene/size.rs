//! Whether what a scene asks for fits index types and memory: [`Scene::check_memory`].

use crate::memory::{Limit, Memory, TooLarge};
use crate::relax::RelaxerChoice;
use crate::scene::definition::Scene;

/// Memory of one disk while its packing is relaxed and measured \[bytes\]. Peak memory of `jamscope run` without observables at
/// φ = 0.5, where there is least of everything: 513 bytes a disk more from 10000 to 40000 disks, of which half is kept.
pub(super) const BYTES_A_DISK: f64 = 250.0;

/// Memory of one disk that is kept for the report, the packing and its states before and after \[bytes\]: 285 bytes more for each
/// further sample of 10000 disks.
const KEPT_BYTES_A_DISK: f64 = 250.0;

/// Two vectors of two components, for each step that L-BFGS remembers \[bytes\].
const REMEMBERED_BYTES_A_DISK: f64 = 32.0;

/// Indices of disks have 32 bits.
pub(super) const DISK_INDEX: Limit = Limit { largest: u32::MAX as u64, reason: "indices of disks have 32 bits" };

impl Scene {
    /// Whether the packings of this scene fit into memory, so many of them relaxed at once.
    ///
    /// The estimate is a lower bound: what is refused cannot work, what is not may still be too large.
    ///
    /// # Errors
    /// [`TooLarge`] names `disk_count`, the largest possible, and the memory it would take.
    pub fn check_memory(&self, memory: Memory, at_once: usize) -> Result<(), TooLarge> {
        let relaxers = self.sample.iter().map(|sample| &sample.relaxer).chain([&self.preparation.relaxer]);
        let remembered = relaxers.map(remembered_steps).max().unwrap_or(0) as f64;
        let samples = self.sample.len().max(1);
        let working = samples.min(at_once.max(1)) as f64 * (BYTES_A_DISK + remembered * REMEMBERED_BYTES_A_DISK);
        memory.check("disk_count", self.disk_count, working + samples as f64 * KEPT_BYTES_A_DISK)
    }
}

/// Steps that a relaxer remembers.
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
        // Three samples: 3 × 250 + 3 × 250 bytes a disk.
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
