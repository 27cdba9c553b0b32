//! Whether h_∥(r) of different pressures is one function of r ΔZ, with ℓ_iso ΔZ = C; and that h_r(r) is not.
//!
//! ```text
//! cargo run --release --features measurements --example isostatic_collapse -- [damped] [DISK_COUNT [SAMPLE_COUNT [INCREASE [PRESSURE …]]]]      (5548 Hertzian disks, 10 samples, d_0 = 0.1)
//! ```
//!
//! Packings at p = 100, 300, 1000 and 3000 or the pressures given, everything relaxed by FIRE and Newton in turn, but for `damped` the
//! inflation by damped dynamics. h of a pressure is the root of the mean of h²
//! over samples, which one sample with a large plastic event rules, and the geometric mean, which none does: of bonds under the relaxed inflation, of bonds under the linear response to one, and of d_r. Printed for each: y/y_plateau
//! at some x = r ΔZ, and C by the plateau rule: ℓ_iso is where y has risen to a share of its plateau, the median of y between two
//! radii; the first such radius, and the one from which on y stays there up to the plateau's own radii (of rings next to the centre few
//! bonds say anything, and one of them is soon above). Where y comes down to its plateau, the radius from which on it is within 1.3 of it.
//! Then h r², which is level in an elastic medium (d_r ∼ 1/r), in bands of R/24: its plateau, the median between 0.3 R and 0.8 R, and x and r
//! where it has risen to shares of it. Then how far the pressures lie apart: the standard deviation of ln y between them, rms over x = 3 to 6, y as it is (h over d_0)
//! and y over h_0 near the centre.

use std::error::Error;

use jamscope::contact::{Hertzian, Prestress};
use jamscope::displacement::DisplacementField;
use jamscope::inflation::{Boundary, Inflation, inflate};
use jamscope::linear::LinearResponse;
use jamscope::observe::bond_changes::{BondChanges, BondSet};
use jamscope::observe::fluctuations::{BondMeasure, FluctuationRing, Fluctuations};
use jamscope::observe::isostatic::{
    IsostaticLength, IsostaticOutcome, IsostaticPoint, IsostaticRule, IsostaticSettings, Normalisation,
};
use jamscope::observe::{ExcessCoordination, State};
use jamscope::packing::Mixture;
use jamscope::preparation::{Preparation, Target, prepare};
use jamscope::relax::{ImplicitDynamics, Staged};
use rayon::prelude::*;

/// Pressures, unless others are given \[force / length\]: R is at least three times 75 p^(−1/3) at 5548 disks.
const PRESSURES: [f64; 4] = [100.0, 300.0, 1000.0, 3000.0];

/// Which of a sample's fluctuations are averaged, how, and their name.
const CURVES: [(usize, Average, &str); 6] = [
    (0, Average::Squares, "h_∥ relaxed, squares"),
    (0, Average::Logarithms, "h_∥ relaxed, logarithms"),
    (1, Average::Squares, "h_∥ linear, squares"),
    (1, Average::Logarithms, "h_∥ linear, logarithms"),
    (2, Average::Squares, "h_r relaxed, squares"),
    (2, Average::Logarithms, "h_r relaxed, logarithms"),
];

/// Where curves are compared.
const SCALED_RADII: [f64; 4] = [3.0, 4.0, 5.0, 6.0];

/// Where y is printed beside them.
const MORE_RADII: [f64; 8] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0];

/// The plateau: between these shares of R.
const PLATEAU: [f64; 2] = [0.3, 0.6];

/// Shares of the plateau that end the disordered region.
const SHARES: [f64; 3] = [0.8, 0.9, 1.0];

/// y over its plateau from which on it counts as there where it comes from above.
const NEAR_PLATEAU: f64 = 1.3;

/// Bands of h r² in a radius, and the shares of R between which its plateau lies.
const BANDS: usize = 24;
const ELASTIC_PLATEAU: [f64; 2] = [0.3, 0.8];

/// Shares of the plateau of h r².
const ELASTIC_SHARES: [f64; 3] = [0.5, 0.7, 0.9];

/// One sample: ΔZ, R, and h_∥ relaxed, h_∥ of the linear response, h_r relaxed.
struct Sample {
    excess: f64,
    outer_radius: f64,
    fluctuations: [Fluctuations; 3],
}

fn sample(
    (disk_count, pressure): (usize, f64),
    (increase, damped): (f64, bool),
    seed: u64,
) -> Result<Sample, Box<dyn Error>> {
    let (law, staged) = (Hertzian::default(), Staged::default());
    let (mixture, target) = (Mixture::default(), Target::Pressure(pressure));
    let preparation = Preparation { disk_count, mixture, target, tolerance: 0.01, seed };
    let packing = prepare::<2, _>(&preparation, &law, &staged, &mut ())?.packing.into_inner();
    // Of the study, for its 5548, 22184 and 88776 disks.
    let outer_radius_over_side =
        [0.480, 0.486, 0.491][usize::from(disk_count > 10_000) + usize::from(disk_count > 40_000)];
    let boundary = Boundary::HeldRim { outer_radius_over_side };
    let inflation = Inflation { increase, boundary, ..Inflation::default() };
    let inflated = if damped {
        inflate(&inflation, &packing, &law, &ImplicitDynamics::default(), seed, &mut ())?
    } else {
        inflate(&inflation, &packing, &law, &staged, seed, &mut ())?
    };
    let before = State::new(inflated.before.packing.get(), &law)?;
    let excess = ExcessCoordination::of(&before.network).ok_or("no backbone")?.value;
    let response = LinearResponse::of_inflation(before.packing, inflated.centre, &law, Prestress::Included)?;
    let relaxed = BondChanges::of_inflation(&inflated, &law, BondSet::Kept)?;
    let linear = BondChanges::of_linear_response(&before, &response, increase);
    let (outer_radius, width) = (inflated.outer_radius, IsostaticSettings::default().ring_width);
    let of_bonds = |bonds| Fluctuations::of_bonds(bonds, BondMeasure::Parallel, outer_radius, width);
    let radial = Fluctuations::of_radial(&DisplacementField::of_inflation(&inflated), width);
    Ok(Sample { excess, outer_radius, fluctuations: [of_bonds(&relaxed), of_bonds(&linear), radial] })
}

/// What is averaged over samples.
#[derive(Clone, Copy)]
enum Average {
    Squares,
    Logarithms,
}

/// Mean over samples, ring by ring; the error from the scatter of what is averaged.
fn mean_fluctuation(samples: &[Sample], kind: usize, average: Average) -> Fluctuations {
    let ring_of = |ring: &FluctuationRing| ring.radius.floor() as usize;
    let outermost = samples[0].outer_radius as usize;
    let rings = (0..outermost).filter_map(|place| {
        let here: Vec<FluctuationRing> = samples
            .iter()
            .filter_map(|sample| sample.fluctuations[kind].rings.iter().find(|ring| ring_of(ring) == place).copied())
            .collect();
        if here.len() < 2 {
            return None;
        }
        let count = here.len() as f64;
        let averaged = |ring: &FluctuationRing| match average {
            Average::Squares => ring.fluctuation.powi(2),
            Average::Logarithms => ring.fluctuation.ln(),
        };
        let mean = here.iter().map(averaged).sum::<f64>() / count;
        let scatter = here.iter().map(|ring| (averaged(ring) - mean).powi(2)).sum::<f64>() / (count - 1.0);
        let (fluctuation, slope) = match average {
            Average::Squares => (mean.sqrt(), 0.5 / mean.sqrt()),
            Average::Logarithms => (mean.exp(), mean.exp()),
        };
        Some(FluctuationRing {
            radius: here.iter().map(|ring| ring.radius).sum::<f64>() / count,
            count: here.iter().map(|ring| ring.count).sum(),
            mean: 0.0,
            fluctuation,
            standard_error: slope * (scatter / count).sqrt(),
        })
    });
    Fluctuations { rings: rings.collect() }
}

/// y at x, linear between rings.
fn at(length: &IsostaticLength, x: f64) -> f64 {
    let after = length.curve.iter().position(|point| point.scaled_radius >= x);
    let Some(after) = after.filter(|&index| index > 0) else { return f64::NAN };
    let (a, b) = (&length.curve[after - 1], &length.curve[after]);
    let share = (x - a.scaled_radius) / (b.scaled_radius - a.scaled_radius);
    a.scaled_fluctuation + share * (b.scaled_fluctuation - a.scaled_fluctuation)
}

/// x from which on y is no more below a threshold, up to a radius.
fn settled(length: &IsostaticLength, threshold: f64, until: f64) -> f64 {
    let below = |point: &IsostaticPoint| point.radius < until && point.scaled_fluctuation < threshold;
    last_crossing(length, threshold, below).unwrap_or(f64::NAN)
}

/// x from which on y is no more above a threshold, up to a radius.
fn fallen(length: &IsostaticLength, threshold: f64, until: f64) -> Option<f64> {
    let above = |point: &IsostaticPoint| point.radius < until && point.scaled_fluctuation > threshold;
    last_crossing(length, threshold, above)
}

/// x between the last point on one side of a threshold and the next.
fn last_crossing(length: &IsostaticLength, threshold: f64, side: impl Fn(&IsostaticPoint) -> bool) -> Option<f64> {
    let last = length.curve.iter().rposition(side)?;
    let (a, b) = (&length.curve[last], length.curve.get(last + 1)?);
    let share = (threshold - a.scaled_fluctuation) / (b.scaled_fluctuation - a.scaled_fluctuation);
    if !(0.0..=1.0).contains(&share) {
        // The next point, the first one past the radius, is on the same side.
        return None;
    }
    Some(a.scaled_radius + share * (b.scaled_radius - a.scaled_radius))
}

/// h r² of bands, geometric means over rings, with the mean radius.
fn squared(fluctuations: &Fluctuations, outer_radius: f64) -> Vec<[f64; 2]> {
    let mut bands = [[0.0; 3]; BANDS];
    for ring in fluctuations.rings.iter().filter(|ring| ring.radius >= IsostaticSettings::default().from) {
        let band = ((ring.radius / outer_radius * BANDS as f64) as usize).min(BANDS - 1);
        let value = ring.fluctuation * ring.radius * ring.radius;
        let [count, radius, logarithm] = &mut bands[band];
        (*count, *radius, *logarithm) = (*count + 1.0, *radius + ring.radius, *logarithm + value.ln());
    }
    let filled = bands.iter().filter(|[count, ..]| *count > 0.0);
    filled.map(|[count, radius, logarithm]| [radius / count, (logarithm / count).exp()]).collect()
}

/// The plateau of h r², and the radii where it has risen to shares of it.
fn elastic_tail(
    fluctuations: &Fluctuations,
    outer_radius: f64,
) -> Result<(f64, [f64; ELASTIC_SHARES.len()]), &'static str> {
    let bands = squared(fluctuations, outer_radius);
    let there = |radius: f64| (ELASTIC_PLATEAU[0]..=ELASTIC_PLATEAU[1]).contains(&(radius / outer_radius));
    let mut values: Vec<f64> = bands.iter().filter(|[radius, _]| there(*radius)).map(|[_, value]| *value).collect();
    values.sort_by(f64::total_cmp);
    let plateau = *values.get(values.len() / 2).ok_or("no plateau of h r²")?;
    let radii = ELASTIC_SHARES.map(|share| {
        let rise = bands.windows(2).find(|pair| pair[0][1] < share * plateau && pair[1][1] >= share * plateau);
        rise.map_or(f64::NAN, |pair| {
            let [[r, low], [next, high]] = [pair[0], pair[1]];
            r + (share * plateau - low) / (high - low) * (next - r)
        })
    });
    Ok((plateau, radii))
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let damped = arguments.first().is_some_and(|word| word == "damped");
    if damped {
        arguments.remove(0);
    }
    let number = |index: usize, default: f64| arguments.get(index).map_or(Ok(default), |text| text.parse::<f64>());
    let (disk_count, sample_count, increase) = (number(0, 5548.0)? as usize, number(1, 10.0)? as u64, number(2, 0.1)?);
    let given: Vec<f64> = arguments.iter().skip(3).map(|text| text.parse()).collect::<Result<_, _>>()?;
    let pressures = if given.is_empty() { PRESSURES.to_vec() } else { given };
    let how = if damped { ", damped dynamics" } else { "" };
    println!(
        "{disk_count} disks, {sample_count} samples, d_0 = {increase}{how}; y over its plateau at x = {MORE_RADII:?}"
    );
    // y at the x above of every pressure: over d_0, and over h_0.
    let mut curves: [[Vec<[f64; 4]>; 2]; CURVES.len()] = Default::default();
    for pressure in pressures {
        let samples: Vec<Sample> = (1..=sample_count)
            .into_par_iter()
            .map(|seed| sample((disk_count, pressure), (increase, damped), seed).map_err(|error| error.to_string()))
            .collect::<Result<_, _>>()?;
        let count = samples.len() as f64;
        let excess = samples.iter().map(|sample| sample.excess).sum::<f64>() / count;
        let outer_radius = samples.iter().map(|sample| sample.outer_radius).sum::<f64>() / count;
        println!("p = {pressure}: ΔZ = {excess:.4}, R = {outer_radius:.1}");
        for (curve, (kind, average, name)) in CURVES.into_iter().enumerate() {
            let fluctuations = mean_fluctuation(&samples, kind, average);
            let length = |normalisation, share| {
                let rule = IsostaticRule::Plateau { from: PLATEAU[0], to: PLATEAU[1], share };
                let settings = IsostaticSettings { normalisation, rule, ..IsostaticSettings::default() };
                IsostaticLength::of(&fluctuations, Some(excess), increase, outer_radius, &settings)
            };
            let plain = length(Normalisation::Increase, 1.0)?;
            let near = length(Normalisation::NearCentre { radius: 1.5 }, 1.0)?;
            for (which, found) in [&plain, &near].into_iter().enumerate() {
                curves[curve][which].push(SCALED_RADII.map(|x| at(found, x)));
            }
            let plateau = plain.threshold.ok_or("no plateau")?;
            print!("  {name:<23} plateau {plateau:.4} d_0 = {:.3} h_0;", near.threshold.unwrap_or(f64::NAN));
            MORE_RADII.iter().for_each(|&x| print!(" {:.2}", at(&plain, x) / plateau));
            print!("; C at shares {SHARES:?}:");
            for share in SHARES {
                match length(Normalisation::Increase, share)?.outcome {
                    IsostaticOutcome::Reached { product, .. } => print!(" {product:.2}"),
                    other => print!(" {other:?}"),
                }
            }
            print!("; for good:");
            SHARES
                .iter()
                .for_each(|share| print!(" {:.2}", settled(&plain, share * plateau, PLATEAU[0] * outer_radius)));
            match fallen(&plain, NEAR_PLATEAU * plateau, PLATEAU[0] * outer_radius) {
                Some(x) => println!("; down to {NEAR_PLATEAU}: {x:.2}"),
                None => println!("; never above {NEAR_PLATEAU}"),
            }
            let (plateau, radii) = elastic_tail(&fluctuations, outer_radius)?;
            print!("{:26}h r²: plateau {:.3} d_0; at shares {ELASTIC_SHARES:?}:", "", plateau / increase);
            radii.iter().for_each(|radius| print!(" x = {:.1} (r = {radius:.1})", radius * excess));
            println!();
        }
    }
    for ((_, _, name), [plain, near]) in CURVES.iter().zip(&curves) {
        println!(
            "{name:<23} pressures apart by {:.3} (over d_0), {:.3} (over h_0) in ln y",
            spread(plain),
            spread(near)
        );
    }
    Ok(())
}

/// Standard deviation of ln y between pressures, rms over the radii.
fn spread(curves: &[[f64; 4]]) -> f64 {
    let count = curves.len() as f64;
    let variances = (0..SCALED_RADII.len()).map(|place| {
        let logarithms: Vec<f64> = curves.iter().map(|curve| curve[place].ln()).collect();
        let mean = logarithms.iter().sum::<f64>() / count;
        logarithms.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0)
    });
    (variances.sum::<f64>() / SCALED_RADII.len() as f64).sqrt()
}
