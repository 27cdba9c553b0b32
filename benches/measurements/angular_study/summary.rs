//! Means and errors over the samples of one p̂.

use std::error::Error;
use std::f64::consts::PI;

use jamscope::fit::angular::{
    CrossoverFit, CrossoverOutcome, CrossoverSettings, SingleDiskNoise, SpectrumWindowSettings, fit_crossover,
    fit_slope,
};
use jamscope::observe::angular::{
    AngularCorrelation, CorrelationSettings, CorrelationStatistics, FrequencyLimit, Leakage, PowerSpectrum, RingSample,
    SpectrumEstimator, SpectrumSettings, SpectrumStatistics, Weights, correlation_statistics, spectrum_statistics,
};

use crate::sample::{Measured, Row};

/// f from which to which the slope of the mean spectrum is taken by least squares.
const LINE: [usize; 2] = [2, 24];

/// A mean or a fitted number and its standard error.
#[derive(Debug, Clone, Copy)]
pub struct Value {
    pub value: f64,
    pub error: f64,
}

/// What the samples of one p̂ say.
pub struct Summary {
    pub reduced_pressure: f64,
    pub sample_count: usize,
    pub failed_count: usize,
    /// Mean seconds of a sample.
    pub seconds: f64,
    pub pressure: f64,
    /// p N^(3/2) with the pressures and numbers there were.
    pub measured_reduced_pressure: f64,
    pub ring_disk_count: f64,
    /// s by maximum likelihood of all rings, error by leaving out one ring at a time; the window.
    pub slope: Value,
    pub window: [usize; 2],
    /// The standard error that the likelihood itself states: of a Gaussian field.
    pub stated_error: Option<f64>,
    /// Σ (P/E − 1)² per degree of freedom.
    pub dispersion: f64,
    /// The same with noise of single disks fitted.
    pub slope_noise: Value,
    /// Slope of ln S against ln f by least squares, f from [`LINE`], of the mean spectrum.
    pub line: Value,
    pub correlation: CorrelationStatistics,
    /// θ* of the mean G over π, error by leaving out one sample at a time.
    pub angle_of_mean: Value,
    pub spectrum: SpectrumStatistics,
    /// Powers at f = 1, 2, 3 and what is above f_max or of single disks, over the variance of the ring.
    pub powers: [Value; 4],
    pub crossover: CrossoverFit,
    pub shares: [Value; 4],
    pub pressure_change: Value,
    /// Contacts made and broken in a sample.
    pub changed: Value,
    /// Share of them that return on deflation, mean over the samples that have any.
    pub returned: Value,
    /// The same of the changed contacts of all samples together.
    pub returned_together: Value,
    /// Share of the samples in which all return.
    pub wholly_returned: Value,
}

impl Summary {
    pub fn of(rows: &[Row]) -> Result<Self, Box<dyn Error>> {
        let measured: Vec<&Measured> = rows.iter().filter_map(|row| row.outcome.as_ref().ok()).collect();
        for row in rows {
            if let Err(reason) = &row.outcome {
                println!("p̂ = {:e}, seed {}: {reason}", row.reduced_pressure, row.seed);
            }
        }
        let rings: Vec<RingSample> = measured.iter().map(|sample| sample.ring.clone()).collect();
        if rings.len() < 3 {
            return Err(format!("{} samples at p̂ = {:e}: too few", rings.len(), rows[0].reduced_pressure).into());
        }
        let over = |of: &dyn Fn(&Measured) -> f64| mean(&measured.iter().map(|sample| of(sample)).collect::<Vec<_>>());
        let correlations: Vec<AngularCorrelation> = rings
            .iter()
            .map(|ring| AngularCorrelation::of(ring, &CorrelationSettings::default()))
            .collect::<Result<_, _>>()?;
        let spectra = spectra(&rings)?;
        let window = SpectrumWindowSettings::default();
        let noisy = SpectrumWindowSettings { noise: SingleDiskNoise::Fitted, ..window };
        let slope =
            |rings: &[RingSample]| -> Result<f64, Box<dyn Error>> { Ok(fit_slope(rings, &window)?.exponent.best) };
        let slope_noise =
            |rings: &[RingSample]| -> Result<f64, Box<dyn Error>> { Ok(fit_slope(rings, &noisy)?.exponent.best) };
        let angle = |samples: &[AngularCorrelation]| -> Result<f64, Box<dyn Error>> {
            let statistics = correlation_statistics(samples)?;
            Ok(statistics.crossings[0].of_mean.angle().unwrap_or(f64::NAN) / PI)
        };
        let fit = fit_slope(&rings, &window)?;
        let contacts = |sample: &Measured| {
            let [_, made, broken, made_returned, broken_returned] = sample.contacts;
            [(made + broken) as f64, (made_returned + broken_returned) as f64]
        };
        let returned = |samples: &[&Measured]| -> Result<f64, Box<dyn Error>> {
            let [all, back] =
                samples.iter().map(|sample| contacts(sample)).fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
            Ok(back / all)
        };
        let own: Vec<f64> = measured
            .iter()
            .map(|sample| contacts(sample))
            .filter(|[all, _]| *all > 0.0)
            .map(|[all, back]| back / all)
            .collect();
        Ok(Summary {
            reduced_pressure: rows[0].reduced_pressure,
            sample_count: rings.len(),
            failed_count: rows.len() - rings.len(),
            seconds: mean(&rows.iter().map(|row| row.seconds).collect::<Vec<_>>()).value,
            pressure: over(&|sample| sample.pressure).value,
            measured_reduced_pressure: over(&|s| s.pressure * (s.mobile_count as f64).powf(1.5)).value,
            ring_disk_count: over(&|sample| sample.ring.disk_count() as f64).value,
            slope: jackknife(&rings, slope)?,
            window: fit.window,
            stated_error: fit.exponent.estimate().map(|estimate| estimate.standard_error),
            dispersion: fit.dispersion,
            slope_noise: jackknife(&rings, slope_noise)?,
            line: jackknife(&spectra, |spectra| line(&spectrum_statistics(spectra)?))?,
            correlation: correlation_statistics(&correlations)?,
            angle_of_mean: jackknife(&correlations, angle)?,
            spectrum: spectrum_statistics(&spectra)?,
            powers: std::array::from_fn(|place| {
                let of =
                    |spectrum: &PowerSpectrum| if place < 3 { spectrum.power[place + 1] } else { spectrum.unresolved };
                mean(&spectra.iter().map(|spectrum| of(spectrum) / spectrum.variance).collect::<Vec<_>>())
            }),
            crossover: fit_crossover(&rings, &CrossoverSettings::default())?,
            shares: std::array::from_fn(|mode| over(&|sample| sample.shares[mode])),
            pressure_change: over(&|sample| sample.pressure_change.unwrap_or(f64::NAN)),
            changed: over(&|sample| contacts(sample)[0]),
            returned: mean(&own),
            returned_together: jackknife(&measured, returned)?,
            wholly_returned: mean(&own.iter().map(|&share| f64::from(u8::from(share == 1.0))).collect::<Vec<_>>()),
        })
    }

    /// f† as found, in words.
    pub fn crossover_text(&self) -> String {
        match self.crossover.outcome {
            CrossoverOutcome::Found { crossover, .. } => match crossover.estimate() {
                Some(estimate) => format!("{:.2} ± {:.2}", estimate.value, estimate.standard_error),
                None => format!("{:.2}", crossover.best),
            },
            CrossoverOutcome::ScaleFree { largest, .. } => format!("< {largest:.2}"),
            CrossoverOutcome::White { smallest, .. } => format!("> {smallest:.2}"),
            CrossoverOutcome::Undetermined => "undetermined".into(),
        }
    }
}

/// Spectra of all rings, as far as the fits go and to f = 24 at least: gaps as weights, leakage removed.
fn spectra(rings: &[RingSample]) -> Result<Vec<PowerSpectrum>, Box<dyn Error>> {
    let least = rings.iter().map(RingSample::disk_count).min().unwrap_or(0);
    let estimator = SpectrumEstimator::Direct { weights: Weights::Gaps, leakage: Leakage::Removed };
    let frequency_limit = FrequencyLimit::Fixed((least / 8).max(LINE[1]).min(least / 2));
    let settings = SpectrumSettings { estimator, frequency_limit };
    Ok(rings.iter().map(|ring| PowerSpectrum::of(ring, &settings)).collect::<Result<_, _>>()?)
}

/// −slope of ln S against ln f, all f with one weight.
fn line(spectrum: &SpectrumStatistics) -> Result<f64, Box<dyn Error>> {
    let points: Vec<[f64; 2]> =
        (LINE[0]..=LINE[1]).map(|f| [(f as f64).ln(), spectrum.spectrum[f].value.ln()]).collect();
    let count = points.len() as f64;
    let middle: [f64; 2] = std::array::from_fn(|i| points.iter().map(|point| point[i]).sum::<f64>() / count);
    let width: f64 = points.iter().map(|point| (point[0] - middle[0]).powi(2)).sum();
    let joint: f64 = points.iter().map(|point| (point[0] - middle[0]) * (point[1] - middle[1])).sum();
    Ok(-joint / width)
}

fn mean(values: &[f64]) -> Value {
    let count = values.len() as f64;
    let value = values.iter().sum::<f64>() / count;
    let square: f64 = values.iter().map(|x| (x - value).powi(2)).sum();
    Value { value, error: (square / (count - 1.0) / count).sqrt() }
}

/// The estimate of all samples, and its error from leaving out one at a time.
fn jackknife<T: Clone>(
    samples: &[T],
    estimate: impl Fn(&[T]) -> Result<f64, Box<dyn Error>>,
) -> Result<Value, Box<dyn Error>> {
    let without = (0..samples.len()).map(|left_out| {
        let rest: Vec<T> = samples
            .iter()
            .enumerate()
            .filter(|&(index, _)| index != left_out)
            .map(|(_, sample)| sample.clone())
            .collect();
        estimate(&rest)
    });
    let without: Vec<f64> = without.collect::<Result<_, _>>()?;
    let count = samples.len() as f64;
    Ok(Value { value: estimate(samples)?, error: (count - 1.0) * mean(&without).error })
}

/// Names of the columns that have an error, and their values.
fn columns(summary: &Summary) -> [(&'static str, Value); 21] {
    let of = |mean: jamscope::observe::angular::Mean| Value {
        value: mean.value,
        error: mean.standard_error.unwrap_or(f64::NAN),
    };
    let over_pi = |value: Value| Value { value: value.value / PI, error: value.error / PI };
    let nothing = Value { value: f64::NAN, error: f64::NAN };
    let angle = summary.correlation.crossings[0].angle.map_or(nothing, |angle| over_pi(of(angle)));
    let [isotropic, dipole, quadrupole, rest] = summary.shares;
    [
        ("slope", summary.slope),
        ("slope_noise_fitted", summary.slope_noise),
        ("slope_line", summary.line),
        ("anticorrelation", of(summary.correlation.anticorrelation)),
        ("angle_over_pi", angle),
        ("angle_of_mean_over_pi", summary.angle_of_mean),
        ("power_1", summary.powers[0]),
        ("power_2", summary.powers[1]),
        ("power_3", summary.powers[2]),
        ("unresolved", summary.powers[3]),
        ("share_0", isotropic),
        ("share_1", dipole),
        ("share_2", quadrupole),
        ("share_rest", rest),
        // Of what is not isotropic.
        ("dipole_over_angular", ratio(dipole, isotropic)),
        ("pressure_change", summary.pressure_change),
        ("changed_contacts", summary.changed),
        ("returned_share", summary.returned),
        ("returned_together", summary.returned_together),
        ("wholly_returned", summary.wholly_returned),
        ("stated_slope_error", Value { value: summary.stated_error.unwrap_or(f64::NAN), error: f64::NAN }),
    ]
}

/// Mean share of mode 1 over that of all modes from 1 on.
fn ratio(dipole: Value, isotropic: Value) -> Value {
    Value { value: dipole.value / (1.0 - isotropic.value), error: dipole.error / (1.0 - isotropic.value) }
}

/// The table.
pub fn print(summaries: &[Summary]) {
    for summary in summaries {
        println!(
            "\np̂ = {:.3e} (p N^(3/2) = {:.3e}, p = {:.4}), {} samples, {} failed, {:.1} s a sample, {:.0} disks a ring",
            summary.reduced_pressure,
            summary.measured_reduced_pressure,
            summary.pressure,
            summary.sample_count,
            summary.failed_count,
            summary.seconds,
            summary.ring_disk_count,
        );
        let [from, to] = summary.window;
        println!(
            "  fits from f = {from} to {to}; dispersion {:.2}; f† {}",
            summary.dispersion,
            summary.crossover_text()
        );
        for (name, Value { value, error }) in columns(summary) {
            println!("  {name:<22} {value:>9.4} ± {error:.4}");
        }
    }
}

/// The same as a table of commas.
pub fn csv(summaries: &[Summary]) -> String {
    let mut text = String::new();
    for (index, summary) in summaries.iter().enumerate() {
        if index == 0 {
            let names: Vec<String> = columns(summary).iter().map(|(name, _)| format!("{name},{name}_error")).collect();
            text += &format!("reduced_pressure,pressure,samples,crossover,{}\n", names.join(","));
        }
        let values: Vec<String> =
            columns(summary).iter().map(|(_, value)| format!("{},{}", value.value, value.error)).collect();
        text += &format!(
            "{},{},{},{},{}\n",
            summary.reduced_pressure,
            summary.pressure,
            summary.sample_count,
            summary.crossover_text(),
            values.join(",")
        );
    }
    text
}
