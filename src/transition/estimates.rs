//! The p̂_c of a series by every method whose observable was measured: [`estimates`].

use crate::study::CellSamples;
use crate::transition::crossing::{by_halves, by_level};
use crate::transition::evidence::{CannotTell, LEAST_SAMPLES};
use crate::transition::pressure::{
    Method, MethodEstimate, SCALE_FREE_ANGLE, SCALE_FREE_ANTICORRELATION, SCALE_FREE_SLOPE, TransitionPressure, poles,
};
use crate::transition::series_point::{ANGLE, ANTICORRELATION, SeriesPoint};
use crate::transition::spectra::{crossover_of, likelihood_slope_of, slope_of};

/// f† below which the spectrum is S ∼ f^(−1.5) from f = 1 on, within 0.1^1.5 = 3 %.
const VANISHED: f64 = 0.1;

/// One method, from all cells with its observable: p̂, number of samples, and the input of the method. None for fewer
/// than two cells.
fn estimate<T>(
    method: Method,
    mut cells: Vec<(f64, usize, T)>,
    find: impl Fn(&[f64], &[usize], &[T]) -> TransitionPressure,
) -> Option<MethodEstimate> {
    if cells.len() < 2 {
        return None;
    }
    let fewest = |cells: &[(f64, usize, T)]| cells.iter().map(|(_, count, _)| *count).min().unwrap_or(0);
    let of_all = fewest(&cells);
    cells.retain(|(_, count, _)| *count >= LEAST_SAMPLES);
    if cells.len() < 2 {
        let pressure = TransitionPressure::Uninformative { reason: CannotTell::FewSamples };
        return Some(MethodEstimate { method, pressure, measured: None, sample_count: of_all });
    }
    let sample_count = fewest(&cells);
    let at: Vec<f64> = cells.iter().map(|(at, ..)| *at).collect();
    let sizes: Vec<usize> = cells.iter().map(|(_, count, _)| *count).collect();
    let all: Vec<T> = cells.into_iter().map(|(.., own)| own).collect();
    let measured = Some([at[0], at[at.len() - 1]]);
    Some(MethodEstimate { method, pressure: find(&at, &sizes, &all), measured, sample_count })
}

/// p̂, the number of samples with a number, and the cell with their values.
type NumberCell<'a> = (f64, usize, (&'a CellSamples, &'a [f64]));

/// Every cell with a number.
fn numbers<'a>(points: &[SeriesPoint], samples: &[&'a CellSamples], name: &str) -> Vec<NumberCell<'a>> {
    let mut all = Vec::new();
    for (point, &samples) in points.iter().zip(samples) {
        if let Some(values) = samples.numbers.get(name) {
            all.push((point.reduced_pressure, values.len(), (samples, values.as_slice())));
        }
    }
    all
}

/// All methods whose observable was measured.
pub(super) fn estimates(points: &[SeriesPoint], samples: &[&CellSamples]) -> Vec<MethodEstimate> {
    let plastic = |method, name: &str, is_plastic: &dyn Fn(&CellSamples, f64) -> bool| {
        estimate(method, numbers(points, samples, name), |at, _, cells| {
            let group = |(at, &(samples, values)): (&f64, &(&CellSamples, &[f64]))| {
                (libm::log(*at), values.iter().map(|&value| is_plastic(samples, value)).collect())
            };
            by_halves(&at.iter().zip(cells).map(group).collect::<Vec<(f64, Vec<bool>)>>())
        })
    };
    let radius = |samples: &CellSamples| {
        let radii = samples.numbers.get("outer_radius")?;
        Some(radii.iter().sum::<f64>() / radii.len() as f64)
    };
    let screened = |samples: &CellSamples, wavenumber: f64| {
        radius(samples).is_some_and(|radius| wavenumber * radius >= 0.5 * poles(samples.cell.spreading_dimension())[0])
    };
    let mean = |method, name: &str, level: f64| {
        estimate(method, numbers(points, samples, name), |at, sizes, cells| {
            by_level(at, sizes, level, |cell, chosen| {
                let (_, values) = cells[cell];
                Some(chosen.iter().map(|&i| values[i]).sum::<f64>() / chosen.len() as f64)
            })
        })
    };
    let spectrum = |method, level: f64, of: fn(&[Vec<f64>], &[usize]) -> Option<f64>| {
        let with_powers = points.iter().zip(samples).filter(|(_, samples)| !samples.powers.is_empty());
        let cells: Vec<(f64, usize, &[Vec<f64>])> = with_powers
            .map(|(point, samples)| (point.reduced_pressure, samples.powers.len(), samples.powers.as_slice()))
            .collect();
        estimate(method, cells, |at, sizes, cells| by_level(at, sizes, level, |cell, chosen| of(cells[cell], chosen)))
    };
    let by_sample = [
        plastic(Method::Wavenumber, "wavenumber", &screened),
        plastic(Method::PressureChange, "pressure_change", &|_, change| change < 0.0),
    ];
    if samples.iter().any(|samples| samples.cell.spreading_dimension() != 2) {
        return by_sample.into_iter().flatten().collect();
    }
    let by_angle = [
        mean(Method::Anticorrelation, ANTICORRELATION, SCALE_FREE_ANTICORRELATION),
        mean(Method::Angle, ANGLE, SCALE_FREE_ANGLE),
        spectrum(Method::Spectrum, SCALE_FREE_SLOPE, slope_of),
        spectrum(Method::SpectrumLikelihood, SCALE_FREE_SLOPE, likelihood_slope_of),
        // A value that falls below a level has a negative that rises above minus the level.
        spectrum(Method::Crossover, -VANISHED, |powers, chosen| Some(-crossover_of(powers, chosen)?)),
    ];
    by_sample.into_iter().chain(by_angle).flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_of_fewer_than_eight_samples_do_not_count() {
        let of = |sizes: [usize; 3]| {
            let cells = [1e6, 1e7, 1e8].into_iter().zip(sizes).map(|(at, size)| (at, size, ())).collect();
            let found = estimate(Method::Angle, cells, |at, sizes, _| {
                assert!(sizes.iter().all(|&size| size >= LEAST_SAMPLES));
                TransitionPressure::Above(at[at.len() - 1])
            });
            found.expect("three cells")
        };
        let found = of([8, 30, 7]);
        assert_eq!((found.pressure, found.measured), (TransitionPressure::Above(1e7), Some([1e6, 1e7])));
        assert_eq!(found.sample_count, 8);
        let few = of([7, 30, 7]);
        assert_eq!(few.pressure, TransitionPressure::Uninformative { reason: CannotTell::FewSamples });
        assert_eq!((few.measured, few.sample_count), (None, 7));
    }
}
