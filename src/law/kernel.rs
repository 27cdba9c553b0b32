//! Kernels over contacts, compiled for each contact law and each vector width, and dispatched by law and processor.

use pulp::{Simd, WithSimd};

use crate::law::pair_law::{LawVisitor, PairLaw};
use crate::processor;

/// A kernel over contacts for any law.
pub(crate) trait LawKernel {
    /// Its result.
    type Output;

    /// Runs with vectors of a given width, for a given law.
    fn run<S: Simd, L: PairLaw>(self, simd: S, law: &L) -> Self::Output;
}

/// Runs a kernel for the given law, or for the law that it represents.
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
