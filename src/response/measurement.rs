//! [`Measurement`]: a measured quantity, or the reason why there is none.

use std::fmt::Display;

use serde::Serialize;

/// A measured quantity, or the reason why there is none.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Measurement<T> {
    /// The quantity.
    Measured(T),
    /// The reason why there is none.
    Refused(String),
}

impl<T> Measurement<T> {
    /// The quantity, if it was measured.
    pub fn measured(&self) -> Option<&T> {
        match self {
            Measurement::Measured(value) => Some(value),
            Measurement::Refused(_) => None,
        }
    }

    /// The reason why there is none, if it was refused.
    pub fn refused(&self) -> Option<&str> {
        match self {
            Measurement::Measured(_) => None,
            Measurement::Refused(reason) => Some(reason),
        }
    }
}

impl<T, E: Display> From<Result<T, E>> for Measurement<T> {
    fn from(result: Result<T, E>) -> Self {
        result.map_or_else(|error| Measurement::Refused(error.to_string()), Measurement::Measured)
    }
}
