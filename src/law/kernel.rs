//! Kernels over contacts, compiled for each contact law and each width of vectors, and started for the law and the processor there are.

use pulp::{Simd, WithSimd};

use crate::law::pair_law::{LawVisitor, PairLaw};
use crate::processor;

/// A kernel over contacts of a law, whatever that is.
pub(crate) trait LawKernel {
    /// What comes of it.
    type Output;

    /// Does the work with vectors of a width, under a law.
    fn run<S: Simd, L: PairLaw>(self, simd: S, law: &L) -> Self::Output;
}

/// Runs a kernel under the law that this one is or stands for.
#[inline(always)]
pub(crate) fn dispatch<K: LawKernel>(law: &impl PairLaw, kernel: K) -> K::Output {
    law.resolve(Resolving(kernel))
}

struct Resolving<K>(K);

impl<K: LawKernel> LawVisitor for Resolving<K> {
    type Output = K::Output;

    #[inline(always)]
    fn visit<L: PairLaw>(self, law: &L) -> K::Output {
        processor::dispatch(Resolved { law, kernel: self.0 })
    }
}

struct Resolved<'a, L, K> {
    law: &'a L,
    kernel: K,
}

impl<L: PairLaw, K: LawKernel> WithSimd for Resolved<'_, L, K> {
    type Output = K::Output;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> K::Output {
        self.kernel.run(simd, self.law)
    }
}
