//! [`Dimension`]: the number of dimensions of a fit, chosen at run time, so that the fit is compiled once.

use crate::reference::poles::pole_count_below;
use crate::reference::rim::RimSolution;
use crate::reference::{Annulus, RadialSolution, ReferenceError};

/// Number of dimensions of a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Dimension {
    /// Disks in an annulus.
    Two,
    /// Spheres in a shell.
    Three,
}

impl Dimension {
    /// `D` as a value.
    pub(crate) const fn of<const D: usize>() -> Self {
        const { assert!(D == 2 || D == 3, "an annulus has D = 2, a shell D = 3") };
        if D == 2 { Dimension::Two } else { Dimension::Three }
    }

    /// `r^(D−1)`, the factor by which displacements are rescaled.
    pub(crate) fn rescaling(self, radius: f64) -> f64 {
        match self {
            Dimension::Two => radius,
            Dimension::Three => radius * radius,
        }
    }

    /// [`RimSolution::new`].
    pub(crate) fn rim_solution(
        self,
        annulus: Annulus,
        wavenumber: f64,
    ) -> Result<Box<dyn RadialSolution>, ReferenceError> {
        Ok(match self {
            Dimension::Two => Box::new(RimSolution::<2>::new(annulus, wavenumber)?),
            Dimension::Three => Box::new(RimSolution::<3>::new(annulus, wavenumber)?),
        })
    }

    /// [`pole_count_below`].
    pub(crate) fn pole_count_below(self, annulus: Annulus, wavenumber: f64) -> usize {
        match self {
            Dimension::Two => pole_count_below::<2>(annulus, wavenumber),
            Dimension::Three => pole_count_below::<3>(annulus, wavenumber),
        }
    }
}
