//! [`StripState`]: a mode of a strip at one place, and [`StripModeError`]: why there is none.

use thiserror::Error;

/// Largest number of nodes of a screened solution: 16 MB, and some 60 MB during its computation.
pub const NODE_LIMIT: usize = 200_000;

/// The two amplitudes of a mode of the strip: of the displacement \[length\], or of its derivative along y \[1\].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StripAmplitudes {
    /// U of u_y = U cos qx, normal to the wall \[length\].
    pub normal: f64,
    /// V of u_x = V sin qx, along the wall \[length\].
    pub tangential: f64,
}

impl StripAmplitudes {
    pub(super) fn undefined() -> Self {
        StripAmplitudes { normal: f64::NAN, tangential: f64::NAN }
    }
}

/// The amplitudes at one place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StripState {
    /// U and V \[length\].
    pub value: StripAmplitudes,
    /// dU/dy and dV/dy \[1\].
    pub derivative: StripAmplitudes,
}

/// Why a mode of the strip could not be set up.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum StripModeError {
    /// Poisson's ratio of two dimensions is not between −1 and 1.
    #[error("Poisson's ratio in two dimensions must lie between -1 and 1, it is {poisson_ratio}")]
    PoissonRatioOutside {
        /// The ratio given.
        poisson_ratio: f64,
    },
    /// The wavenumber is negative or not finite, or qH is not finite.
    #[error("the wavenumber along the strip must be finite and not negative, it is {wavenumber}")]
    WavenumberNegative {
        /// q given \[1/length\].
        wavenumber: f64,
    },
    /// An amplitude is not finite.
    #[error("the amplitudes at the line must be finite, they are {normal} and {tangential}")]
    AmplitudeNotFinite {
        /// A given \[length\].
        normal: f64,
        /// B given \[length\].
        tangential: f64,
    },
    /// The screening is not finite, or √|Γ| H is not.
    #[error("the screening must be finite, it is {screening}")]
    ScreeningNotFinite {
        /// Γ given \[1/length²\].
        screening: f64,
    },
    /// (H−a) max(q, √|Γ|) is too large: the solution would need more nodes than allowed.
    #[error("the mode would need about {node_estimate:.0} nodes across the strip, more than {node_limit}")]
    TooManyNodes {
        /// The number needed.
        node_estimate: f64,
        /// The limit.
        node_limit: usize,
    },
    /// The screening is a pole of this mode to rounding: the displacement has no finite value.
    #[error(
        "the screening {screening} is a pole of the mode with wavenumber {wavenumber} within rounding: the condition number is {condition:.1e}"
    )]
    AtPole {
        /// q \[1/length\].
        wavenumber: f64,
        /// Γ given \[1/length²\].
        screening: f64,
        /// The value of [`StripMode::condition`](crate::reference::strip_modes::StripMode::condition), at which no digit is left.
        condition: f64,
    },
}
