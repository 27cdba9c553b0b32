//! [`Processor`]: the vector width of our kernels, chosen at run time from the features of the processor.
//!
//! ```text
//! vectors    none, NEON (128 bits), AVX2 (256 bits), AVX-512 (512 bits)
//! roots      by the instructions for roots and quotients, or, for 512 bits, by refined products
//! ```
//!
//! The choice changes the time but no bit of our results: the order of every sum is fixed, every operation is rounded
//! by IEEE 754, and elementary functions are from `libm`. [`Processor::run`] serves to test this.
//!
//! The matrix factorisations of faer choose their vector width by the same features, independently of
//! [`Processor::run`]. The order of their sums depends on the width, so results of a factorisation differ in their last
//! digits: see the chapter on validation.

use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Mutex, PoisonError};

use pulp::WithSimd;
use serde::{Deserialize, Serialize};

/// Vector instructions of the kernels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Vectors {
    /// The minimum of every processor of the architecture.
    None,
    /// 128 bits, AArch64.
    Neon,
    /// 256 bits, x86-64.
    Avx2,
    /// 512 bits, x86-64.
    Avx512,
}

impl Vectors {
    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Vectors::None => "none",
            Vectors::Neon => "neon",
            Vectors::Avx2 => "avx2",
            Vectors::Avx512 => "avx512",
        }
    }
}

/// Computation of roots and reciprocals with vectors of 512 bits. Changes no bit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Roots {
    /// Every second root, and all reciprocals, by products.
    Products,
    /// Every second root by products; reciprocals by the instruction.
    Quotients,
    /// All by the instructions.
    Instructions,
}

/// The choice of kernels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Processor {
    vectors: Vectors,
    roots: Roots,
}

/// The present choice as a number: 0 before the first one.
static CHOSEN: AtomicU8 = AtomicU8::new(UNKNOWN);
const UNKNOWN: u8 = 0;

/// Locked during a [`Processor::run`].
static RUNNING: Mutex<()> = Mutex::new(());

impl Processor {
    /// The choice in use: that of the processor, except within [`Processor::run`].
    #[inline(always)]
    pub fn here() -> Self {
        match CHOSEN.load(Ordering::Relaxed) {
            UNKNOWN => Self::found(),
            code => Self::of_code(code),
        }
    }

    /// All choices that this processor supports; its own is the last.
    pub fn all() -> Vec<Self> {
        let own = Self::own();
        let every = [Vectors::None, Vectors::Neon, Vectors::Avx2, Vectors::Avx512].into_iter().flat_map(|vectors| {
            let roots = [Roots::Products, Roots::Quotients, Roots::Instructions];
            roots.into_iter().map(move |roots| Processor { vectors, roots })
        });
        let runs = |it: &Processor| match it.vectors {
            Vectors::None => true,
            Vectors::Neon => own.vectors == Vectors::Neon,
            Vectors::Avx2 => own.vectors >= Vectors::Avx2,
            Vectors::Avx512 => own.vectors == Vectors::Avx512,
        };
        // Without vectors of 512 bits there is only one method for roots.
        let differs = |it: &Processor| it.vectors == Vectors::Avx512 || it.roots == own.roots;
        every.filter(|it| runs(it) && differs(it) && *it != own).chain([own]).collect()
    }

    /// The vector instructions.
    #[inline(always)]
    pub fn vectors(self) -> Vectors {
        self.vectors
    }

    /// The method for roots.
    #[inline(always)]
    pub fn roots(self) -> Roots {
        self.roots
    }

    /// Runs `work` with the kernels of this choice on all threads of the process, for tests and measurements.
    ///
    /// Only one call runs at a time in a process; others wait. `work` must not call it again. Other threads use this
    /// choice meanwhile, which does not change their results.
    pub fn run<T>(self, work: impl FnOnce() -> T) -> T {
        struct Back;
        impl Drop for Back {
            fn drop(&mut self) {
                CHOSEN.store(UNKNOWN, Ordering::Relaxed);
            }
        }
        // A test that failed while it held the lock has restored the choice.
        let _running = RUNNING.lock().unwrap_or_else(PoisonError::into_inner);
        let _back = Back;
        CHOSEN.store(self.code(), Ordering::Relaxed);
        work()
    }

    /// Detects the processor and stores the choice, unless another thread has set one meanwhile.
    #[cold]
    #[inline(never)]
    fn found() -> Self {
        let own = Self::own();
        match CHOSEN.compare_exchange(UNKNOWN, own.code(), Ordering::Relaxed, Ordering::Relaxed) {
            Ok(_) => own,
            Err(code) => Self::of_code(code),
        }
    }

    /// The choice for this processor, also the one named in reports, since it applies to factorisations too.
    pub fn own() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            let vectors = if pulp::x86::V4::try_new().is_some() {
                Vectors::Avx512
            } else if pulp::x86::V3::try_new().is_some() {
                Vectors::Avx2
            } else {
                Vectors::None
            };
            // By features that mark vendor and generation: AMD's fourth has SSE4a, its fifth also VP2INTERSECT.
            let roots = match std::arch::is_x86_feature_detected!("sse4a") {
                false => Roots::Products,
                true if std::arch::is_x86_feature_detected!("avx512vp2intersect") => Roots::Instructions,
                true => Roots::Quotients,
            };
            Processor { vectors, roots }
        }
        #[cfg(not(target_arch = "x86_64"))]
        {
            let vectors = if cfg!(target_arch = "aarch64") { Vectors::Neon } else { Vectors::None };
            Processor { vectors, roots: Roots::Products }
        }
    }

    /// Two bits for the roots, the vectors above them, and a bit that is always 1.
    fn code(self) -> u8 {
        let vectors = match self.vectors {
            Vectors::None => 0,
            Vectors::Neon => 1,
            Vectors::Avx2 => 2,
            Vectors::Avx512 => 3,
        };
        let roots = match self.roots {
            Roots::Products => 0,
            Roots::Quotients => 1,
            Roots::Instructions => 2,
        };
        0b1_0000 | vectors << 2 | roots
    }

    #[inline(always)]
    fn of_code(code: u8) -> Self {
        let vectors = match code >> 2 & 3 {
            0 => Vectors::None,
            1 => Vectors::Neon,
            2 => Vectors::Avx2,
            _ => Vectors::Avx512,
        };
        let roots = match code & 3 {
            0 => Roots::Products,
            1 => Roots::Quotients,
            _ => Roots::Instructions,
        };
        Processor { vectors, roots }
    }
}

/// Runs a kernel, compiled for each vector width, with the chosen one.
#[inline(always)]
pub(crate) fn dispatch<K: WithSimd>(kernel: K) -> K::Output {
    let vectors = Processor::here().vectors();
    #[cfg(target_arch = "x86_64")]
    {
        if vectors == Vectors::Avx512
            && let Some(simd) = pulp::x86::V4::try_new()
        {
            return pulp::Simd::vectorize(simd, kernel);
        }
        if vectors >= Vectors::Avx2
            && let Some(simd) = pulp::x86::V3::try_new()
        {
            return pulp::Simd::vectorize(simd, kernel);
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    if vectors != Vectors::None {
        return pulp::Arch::new().dispatch(kernel);
    }
    pulp::Simd::vectorize(pulp::Scalar::new(), kernel)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The number of lanes of the running kernel.
    struct Lanes;

    impl WithSimd for Lanes {
        type Output = usize;

        fn with_simd<S: pulp::Simd>(self, _simd: S) -> usize {
            S::F64_LANES
        }
    }

    #[test]
    fn a_kernel_has_the_vectors_that_are_named() {
        let all = Processor::all();
        assert!(all.contains(&Processor { vectors: Vectors::None, ..Processor::own() }));
        assert_eq!(all.last(), Some(&Processor::own()));
        for processor in all {
            assert_eq!(Processor::of_code(processor.code()), processor);
            let lanes = match processor.vectors() {
                Vectors::None => 1,
                Vectors::Neon => 2,
                Vectors::Avx2 => 4,
                Vectors::Avx512 => 8,
            };
            processor.run(|| {
                assert_eq!(Processor::here(), processor);
                assert_eq!(dispatch(Lanes), lanes, "{processor:?}");
            });
        }
        let _alone = RUNNING.lock().unwrap_or_else(PoisonError::into_inner);
        assert_eq!(Processor::here(), Processor::own());
    }

    #[test]
    fn a_run_that_fails_leaves_the_processor_as_it_was() {
        let none = Processor { vectors: Vectors::None, roots: Roots::Products };
        let failed = std::panic::catch_unwind(|| none.run(|| panic!("on purpose")));
        assert!(failed.is_err());
        let _alone = RUNNING.lock().unwrap_or_else(PoisonError::into_inner);
        assert_eq!(Processor::here(), Processor::own());
    }
}
