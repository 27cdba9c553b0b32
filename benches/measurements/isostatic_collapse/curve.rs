//! Means over centres, and the lengths they show.

use std::fmt;

use jamscope::observe::IsostaticLength;
use jamscope::observe::fluctuations::{FluctuationRing, Fluctuations};
use jamscope::observe::isostatic::{
    IsostaticError, IsostaticOutcome, IsostaticRule, IsostaticSettings, Normalisation, Scale, Tail,
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::sample::{Sample, radius_of};

/// The plateau: from x to x, so that it is read at the same scaled distances at every pressure. The two agree at ΔZ = 0.64.
fn plateau(scale: Scale) -> [f64; 2] {
    match scale {
        Scale::Excess => [8.0, 16.0],
        Scale::RootExcess => [10.0, 20.0],
    }
}

/// C, as printed.
fn symbol(scale: Scale) -> &'static str {
    match scale {
        Scale::Excess => "ℓ ΔZ",
        Scale::RootExcess => "ℓ √ΔZ",
    }
}

/// x up to which figures go.
const DRAWN_TO: f64 = 24.0;

/// Share of L/2 within which it must end: farther out periodic images bend the field.
const WITHIN: f64 = 0.7;

/// Shares of it that end the disordered region.
pub const SHARES: [f64; 3] = [0.7, 0.8, 0.9];

/// Sets of packings drawn anew for an error.
const DRAWN: usize = 200;

/// What is looked at: h_∥ r², h_r r, or the same of changes of force −k d_∥.
#[derive(Clone, Copy)]
pub enum Field {
    Stretching,
    Force,
    Radial,
}

impl Field {
    fn of(self, sample: &Sample) -> &[Option<f64>] {
        match self {
            Field::Stretching => &sample.stretching,
            Field::Force => &sample.force,
            Field::Radial => &sample.radial,
        }
    }

    fn tail(self) -> Tail {
        match self {
            Field::Stretching | Field::Force => Tail::InverseSquare,
            Field::Radial => Tail::InverseDistance,
        }
    }
}

impl fmt::Display for Field {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(match self {
            Field::Stretching => "h_∥ r²",
            Field::Force => "h_F r²",
            Field::Radial => "h_r r",
        })
    }
}

/// What is averaged over centres.
#[derive(Clone, Copy)]
pub enum Average {
    Squares,
    Logarithms,
}

impl fmt::Display for Average {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(match self {
            Average::Squares => "root mean square",
            Average::Logarithms => "geometric mean",
        })
    }
}

impl Average {
    fn of(self, values: &[f64]) -> f64 {
        let mean = |of: fn(f64) -> f64| values.iter().map(|&value| of(value)).sum::<f64>() / values.len() as f64;
        match self {
            Average::Squares => mean(|value| value * value).sqrt(),
            Average::Logarithms => mean(f64::ln).exp(),
        }
    }
}

/// What is read from samples.
#[derive(Clone, Copy)]
pub struct Reading {
    pub field: Field,
    pub average: Average,
    pub scale: Scale,
}

impl fmt::Display for Reading {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{:<6}, {:<16}, {:<5}", self.field, self.average, symbol(self.scale))
    }
}

/// ℓ as x at each share with its error, and the plateau over d_0.
pub struct Lengths {
    scale: Scale,
    plateau: f64,
    products: [Option<(f64, f64)>; SHARES.len()],
}

impl Lengths {
    /// Of all samples of a pressure, packing by packing.
    pub fn of(packings: &[Vec<Sample>], reading: Reading) -> Result<Self, IsostaticError> {
        let all: Vec<&Sample> = packings.iter().flatten().collect();
        let (plateau, products) = read(&all, reading)?;
        let mut generator = Pcg64::seed_from_u64(1);
        let mut drawn: [Vec<f64>; SHARES.len()] = Default::default();
        for _ in 0..DRAWN {
            let some: Vec<&Sample> =
                packings.iter().flat_map(|_| &packings[generator.random_range(0..packings.len())]).collect();
            for (all, product) in drawn.iter_mut().zip(read(&some, reading)?.1) {
                all.extend(product);
            }
        }
        let error = |values: &[f64]| {
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (values.len() as f64 - 1.0)).sqrt()
        };
        let products = std::array::from_fn(|place| Some((products[place]?, error(&drawn[place]))));
        Ok(Lengths { scale: reading.scale, plateau, products })
    }
}

impl fmt::Display for Lengths {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.plateau.is_nan() {
            let [from, to] = plateau(self.scale);
            return write!(formatter, "the box is too small for a plateau at x = {from} to {to}");
        }
        write!(formatter, "plateau {:.2} d_0;", self.plateau)?;
        self.products.iter().try_for_each(|product| match product {
            Some((product, error)) => write!(formatter, " {product:.2} ± {error:.2}"),
            None => write!(formatter, " none"),
        })
    }
}

/// Means of what samples have in every ring, with its radius.
fn mean(samples: &[&Sample], field: Field, average: Average) -> Vec<(f64, f64)> {
    let rings = samples.iter().map(|sample| field.of(sample).len()).min().unwrap_or(0);
    let values = |ring: usize| -> Vec<f64> { samples.iter().filter_map(|sample| field.of(sample)[ring]).collect() };
    // Near the centre some have no bond in a ring.
    let all = (0..rings).map(|ring| (radius_of(ring), values(ring)));
    let enough = all.filter(|(_, values)| 2 * values.len() > samples.len());
    enough.map(|(radius, values)| (radius, average.of(&values))).collect()
}

/// The plateau and ℓ as x at every share of it.
fn read(samples: &[&Sample], reading: Reading) -> Result<(f64, [Option<f64>; SHARES.len()]), IsostaticError> {
    let Reading { field, average, scale } = reading;
    let outer_radius = samples[0].outer_radius;
    let excess = samples[0].excess;
    let [from, to] = self::plateau(scale).map(|x| x / (scale.of(excess) * outer_radius));
    if to > WITHIN {
        return Ok((f64::NAN, [None; SHARES.len()]));
    }
    let power = field.tail().power();
    let rings = mean(samples, field, average).into_iter().map(|(radius, value)| {
        let fluctuation = value / radius.powi(power);
        FluctuationRing { radius, count: samples.len(), mean: 0.0, fluctuation, standard_error: 0.0 }
    });
    let rings = Fluctuations { rings: rings.collect() };
    let mut plateau = f64::NAN;
    let mut products = [None; SHARES.len()];
    for (product, share) in products.iter_mut().zip(SHARES) {
        let settings = IsostaticSettings {
            normalisation: Normalisation::Length,
            tail: field.tail(),
            scale,
            rule: IsostaticRule::Plateau { from, to, share },
            ..IsostaticSettings::default()
        };
        let length = IsostaticLength::of(&rings, Some(excess), 1.0, outer_radius, &settings)?;
        plateau = length.threshold.unwrap_or(f64::NAN) / (share * scale.of(excess).powi(power));
        if let IsostaticOutcome::Reached { product: found, .. } = length.outcome {
            *product = Some(found);
        }
    }
    Ok((plateau, products))
}

/// y = h_∥ r² over its plateau against x, from the geometric mean, and C at the last of the shares: for a figure. None where the box
/// is too small for a plateau.
pub fn scaled(packings: &[Vec<Sample>], scale: Scale) -> Result<Option<IsostaticLength>, IsostaticError> {
    let all: Vec<&Sample> = packings.iter().flatten().collect();
    let (excess, outer_radius) = (all[0].excess, all[0].outer_radius);
    let reading = Reading { field: Field::Stretching, average: Average::Logarithms, scale };
    let (plateau, _) = read(&all, reading)?;
    if plateau.is_nan() {
        return Ok(None);
    }
    let rings = mean(&all, reading.field, reading.average).into_iter().map(|(radius, value)| FluctuationRing {
        radius,
        count: all.len(),
        mean: 0.0,
        fluctuation: value / plateau / (radius * scale.of(excess)).powi(2),
        standard_error: 0.0,
    });
    let rings = rings.filter(|ring| ring.radius * scale.of(excess) < DRAWN_TO);
    let settings = IsostaticSettings {
        normalisation: Normalisation::Length,
        tail: Tail::InverseSquare,
        scale,
        rule: IsostaticRule::Threshold(SHARES[SHARES.len() - 1]),
        ..IsostaticSettings::default()
    };
    IsostaticLength::of(&Fluctuations { rings: rings.collect() }, Some(excess), 1.0, outer_radius, &settings).map(Some)
}

/// The power of ΔZ that ℓ follows at every share, with its standard error, from pressures that have one: weighted least squares
/// of ln ℓ against ln ΔZ.
pub fn powers(pressures: &[(f64, Lengths)]) -> [Option<(f64, f64)>; SHARES.len()] {
    std::array::from_fn(|place| {
        let points: Vec<[f64; 3]> = pressures
            .iter()
            .filter_map(|(excess, lengths)| {
                let (product, error) = lengths.products[place]?;
                Some([excess.ln(), (product / lengths.scale.of(*excess)).ln(), (product / error).powi(2)])
            })
            .collect();
        let total: f64 = points.iter().map(|[_, _, weight]| weight).sum();
        let mean = |of: usize| points.iter().map(|point| point[2] * point[of]).sum::<f64>() / total;
        let (x, y) = (mean(0), mean(1));
        let square: f64 = points.iter().map(|point| point[2] * (point[0] - x).powi(2)).sum();
        let slope = points.iter().map(|point| point[2] * (point[0] - x) * (point[1] - y)).sum::<f64>() / square;
        (points.len() > 1).then(|| (slope, square.sqrt().recip()))
    })
}
