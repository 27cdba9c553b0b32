//! [`Spread`]: how much a quantity varies over the endings.

use serde::Serialize;

use crate::protocol::ending::Ending;

/// Mean and standard deviation of a quantity over some endings.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// Number of endings with the quantity.
    pub count: usize,
    /// Their mean \[unit of the quantity\].
    pub mean: f64,
    /// Standard deviation, √(Σ(x − mean)²/(n − 1)) \[unit of the quantity\]; 0 for one ending.
    pub standard_deviation: f64,
}

impl Spread {
    /// The spread of these values; none without values.
    pub fn of(values: impl Iterator<Item = f64>) -> Option<Self> {
        let values: Vec<f64> = values.collect();
        let count = values.len();
        if count == 0 {
            return None;
        }
        let mean = values.iter().sum::<f64>() / count as f64;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        Some(Spread { count, mean, standard_deviation: (squares / count.saturating_sub(1).max(1) as f64).sqrt() })
    }
}

/// Spreads of the results of an experiment over the endings at rest: the error bars for the choice of the minimum.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Spreads {
    /// Of the energy \[energy\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energy: Option<Spread>,
    /// Of Δp \[force / length^(D−1)\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure_change: Option<Spread>,
    /// Of G* \[1\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub anticorrelation: Option<Spread>,
    /// Of θ*, over the endings with a θ* \[rad\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub correlation_angle: Option<Spread>,
    /// Of the number of contacts made and broken.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact_change_count: Option<Spread>,
    /// Of d_0^eff of the elastic solution \[length\].
    #[cfg(feature = "fit")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub elastic_amplitude: Option<Spread>,
    /// Of d_0^eff of the screened solution, over the endings with such a fit \[length\].
    #[cfg(feature = "fit")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub screened_amplitude: Option<Spread>,
    /// Of κ, over the same endings \[1/length\].
    #[cfg(feature = "fit")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wavenumber: Option<Spread>,
}

impl Spreads {
    /// The spreads of these endings; those not at rest are left out.
    pub fn of(endings: &[Ending]) -> Self {
        let responses = || endings.iter().filter_map(|ending| ending.response);
        let at_rest = || endings.iter().filter(|ending| ending.at_rest());
        #[cfg(feature = "fit")]
        let screened = || at_rest().filter_map(|ending| ending.fit?.screened);
        Spreads {
            energy: Spread::of(at_rest().map(|ending| ending.energy)),
            pressure_change: Spread::of(at_rest().filter_map(|ending| ending.pressure_change)),
            anticorrelation: Spread::of(responses().filter_map(|response| response.anticorrelation)),
            correlation_angle: Spread::of(responses().filter_map(|response| response.correlation_angle)),
            contact_change_count: Spread::of(
                responses().map(|response| (response.made_count + response.broken_count) as f64),
            ),
            #[cfg(feature = "fit")]
            elastic_amplitude: Spread::of(at_rest().filter_map(|ending| Some(ending.fit?.elastic_amplitude))),
            #[cfg(feature = "fit")]
            screened_amplitude: Spread::of(screened().map(|screened| screened.amplitude)),
            #[cfg(feature = "fit")]
            wavenumber: Spread::of(screened().map(|screened| screened.wavenumber)),
        }
    }
}
