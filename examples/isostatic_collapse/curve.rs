//! Means over centres, and the lengths they show.

use std::fmt;

use jamscope::observe::IsostaticLength;
use jamscope::observe::fluctuations::{FluctuationRing, Fluctuations};
use jamscope::observe::isostatic::{
    IsostaticError, IsostaticOutcome, IsostaticRule, IsostaticSettings, Normalisation, Tail,
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::sample::{Sample, radius_of};

/// The plateau: between these shares of L/2.
const PLATEAU: [f64; 2] = [0.3, 0.8];

/// Shares of it that end the disordered region.
pub const SHARES: [f64; 3] = [0.7, 0.8, 0.9];

/// Samples drawn anew for an error.
const DRAWN: usize = 200;

/// Where pressures are compared, from x to x.
const COMPARED: [f64; 2] = [3.0, 10.0];

/// Points of the comparison.
const POINTS: usize = 9;

/// What is looked at: h_∥ r² or h_r r.
#[derive(Clone, Copy)]
pub enum Field {
    Stretching,
    Radial,
}

impl Field {
    fn of(self, sample: &Sample) -> &[Option<f64>] {
        match self {
            Field::Stretching => &sample.stretching,
            Field::Radial => &sample.radial,
        }
    }

    fn tail(self) -> Tail {
        match self {
            Field::Stretching => Tail::InverseSquare,
            Field::Radial => Tail::InverseDistance,
        }
    }
}

impl fmt::Display for Field {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(match self {
            Field::Stretching => "h_∥ r²",
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

/// C at each share with its error, and the plateau over d_0.
pub struct Lengths {
    plateau: f64,
    products: [Option<(f64, f64)>; SHARES.len()],
}

impl Lengths {
    /// Of all samples of a pressure.
    pub fn of(samples: &[Sample], field: Field, average: Average) -> Result<Self, IsostaticError> {
        let all: Vec<&Sample> = samples.iter().collect();
        let (plateau, products) = read(&all, field, average)?;
        let mut generator = Pcg64::seed_from_u64(1);
        let mut drawn: [Vec<f64>; SHARES.len()] = Default::default();
        for _ in 0..DRAWN {
            let some: Vec<&Sample> =
                samples.iter().map(|_| &samples[generator.random_range(0..samples.len())]).collect();
            for (all, product) in drawn.iter_mut().zip(read(&some, field, average)?.1) {
                all.extend(product);
            }
        }
        let error = |values: &[f64]| {
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (values.len() as f64 - 1.0)).sqrt()
        };
        let products = std::array::from_fn(|place| Some((products[place]?, error(&drawn[place]))));
        Ok(Lengths { plateau, products })
    }
}

impl fmt::Display for Lengths {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "plateau {:.2} d_0; C =", self.plateau)?;
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

/// The plateau and C at every share of it.
fn read(
    samples: &[&Sample],
    field: Field,
    average: Average,
) -> Result<(f64, [Option<f64>; SHARES.len()]), IsostaticError> {
    let (excess, outer_radius) = (samples[0].excess, samples[0].outer_radius);
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
            rule: IsostaticRule::Plateau { from: PLATEAU[0], to: PLATEAU[1], share },
            ..IsostaticSettings::default()
        };
        let length = IsostaticLength::of(&rings, Some(excess), 1.0, outer_radius, &settings)?;
        plateau = length.threshold.unwrap_or(f64::NAN) / (share * excess.powi(power));
        if let IsostaticOutcome::Reached { product: found, .. } = length.outcome {
            *product = Some(found);
        }
    }
    Ok((plateau, products))
}

/// How far pressures lie apart as functions of x, over their plateaux: the standard deviation of the logarithm, rms over x.
pub fn spread(pressures: &[Vec<Sample>], field: Field, average: Average) -> f64 {
    let step = (COMPARED[1] / COMPARED[0]).powf(1.0 / (POINTS - 1) as f64);
    let curve = |samples: &Vec<Sample>| -> Vec<f64> {
        let (excess, outer_radius) = (samples[0].excess, samples[0].outer_radius);
        let curve = mean(&samples.iter().collect::<Vec<_>>(), field, average);
        let inside = |radius: f64| (PLATEAU[0]..=PLATEAU[1]).contains(&(radius / outer_radius));
        let mut level: Vec<f64> = curve.iter().filter(|point| inside(point.0)).map(|point| point.1).collect();
        level.sort_by(f64::total_cmp);
        let plateau = level[level.len() / 2];
        let radius = |point: usize| COMPARED[0] * step.powi(point as i32) / excess;
        (0..POINTS).map(|point| (at(&curve, radius(point)) / plateau).ln()).collect()
    };
    let curves: Vec<Vec<f64>> = pressures.iter().map(curve).collect();
    let count = curves.len() as f64;
    let variance = |point: usize| {
        let mean = curves.iter().map(|curve| curve[point]).sum::<f64>() / count;
        curves.iter().map(|curve| (curve[point] - mean).powi(2)).sum::<f64>() / (count - 1.0)
    };
    ((0..POINTS).map(variance).sum::<f64>() / POINTS as f64).sqrt()
}

/// A curve at a radius, linear between its points.
fn at(curve: &[(f64, f64)], radius: f64) -> f64 {
    let after = curve.iter().position(|point| point.0 >= radius).unwrap_or(curve.len() - 1).max(1);
    let ((r, low), (next, high)) = (curve[after - 1], curve[after]);
    low + (radius - r) / (next - r) * (high - low)
}
