//! [`Dimension`]: the number of dimensions of a fit, chosen at run time, so that the fit is compiled once.

use crate::reference::poles::pole_count_below;
use crate::reference::rim::RimSolution;
use crate::reference::{Annulus, RadialSolution, ReferenceError};

/// Number of dimensions of a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Dimension {
    /// Disks in a strip.
    One,
    /// Disks in an annulus.
    Two,
    /// Spheres in a shell.
    Three,
}

impl Dimension {
    /// `D` as a value.
    pub(crate) const fn of<const D: usize>() -> Self {
        const { assert!(D >= 1 && D <= 3, "a strip has D = 1, an annulus D = 2, a shell D = 3") };
        match D {
            1 => Dimension::One,
            2 => Dimension::Two,
            _ => Dimension::Three,
        }
    }

    /// `r^(D−1)`, the factor by which displacements are rescaled.
    pub(crate) fn rescaling(self, radius: f64) -> f64 {
        match self {
            Dimension::One => 1.0,
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
            Dimension::One => Box::new(RimSolution::<1>::new(annulus, wavenumber)?),
            Dimension::Two => Box::new(RimSolution::<2>::new(annulus, wavenumber)?),
            Dimension::Three => Box::new(RimSolution::<3>::new(annulus, wavenumber)?),
        })
    }

    /// [`pole_count_below`].
    pub(crate) fn pole_count_below(self, annulus: Annulus, wavenumber: f64) -> usize {
        match self {
            Dimension::One => pole_count_below::<1>(annulus, wavenumber),
            Dimension::Two => pole_count_below::<2>(annulus, wavenumber),
            Dimension::Three => pole_count_below::<3>(annulus, wavenumber),
        }
    }
}
