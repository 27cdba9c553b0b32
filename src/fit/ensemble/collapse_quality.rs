//! [`collapse_quality`]: the distance of scaled curves from a common one, in units of their errors.

use serde::{Deserialize, Serialize};

use crate::fit::ensemble::error::EnsembleFitError;
use crate::fit::ensemble::measured_point::MeasuredPoint;

/// A curve y(x) measured at one set of K scale factors.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve<const K: usize> {
    /// Logarithms L_k of the scale factors of x, which have the exponents e_k: ln x + Σ e_k L_k. For x N^a d_0^(−b):
    /// \[ln N, −ln d_0\].
    pub scales: [f64; K],
    /// Its points, in any order; x positive, y of any sign.
    pub points: Vec<MeasuredPoint>,
}

/// Quality of a collapse.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CollapseQuality {
    /// S: about 1 if curves agree within their errors, otherwise much larger \[1\].
    pub quality: f64,
    /// Number of points compared with other curves.
    pub point_count: usize,
    /// Number of all points.
    pub of_count: usize,
    /// Whether all curves are connected through overlaps. Disconnected groups do not determine the exponents between
    /// them.
    pub connected: bool,
}

impl CollapseQuality {
    /// Share of points compared with other curves.
    pub fn share(&self) -> f64 {
        self.point_count as f64 / self.of_count as f64
    }
}

/// The quality S of the collapse for given exponents; none if no point lies between two points of another curve.
///
/// ```text
/// S = (1/𝒩) Σ (y − Y)²/(dy² + dY²)
/// Y(u), dY(u)    straight line in u = ln x + Σ e_k L_k, weights 1/dy²,
///                through the two points around u of every other curve with points on both sides
/// ```
///
/// The sum is over the 𝒩 points of all curves at which Y exists. A straight line between two points has the error h²
/// Y''/8, where h is their distance in u. Curves with smaller errors therefore appear different even if they are not.
///
/// # Errors
/// Fewer than two curves with points, or none with two; an x or error that is not positive, a number that is not
/// finite.
///
/// # Source
/// Houdayer, Hartmann (2004), Phys. Rev. B 70, 014418, appendix; based on Kawashima, Ito (1993), J. Phys. Soc. Jpn. 62,
/// 435.
///
/// # Cost
/// One binary search per point and curve.
pub fn collapse_quality<const K: usize>(
    curves: &[Curve<K>],
    exponents: [f64; K],
) -> Result<Option<CollapseQuality>, EnsembleFitError> {
    Ok(Curves::of(curves)?.quality(exponents))
}

/// A point: ln x, y, 1/dy².
#[derive(Clone, Copy)]
struct Row {
    at: f64,
    y: f64,
    weight: f64,
}

/// Checked curves with their points in ascending order.
pub(super) struct Curves<const K: usize> {
    curves: Vec<([f64; K], Vec<Row>)>,
    point_count: usize,
}

impl<const K: usize> Curves<K> {
    pub fn of(curves: &[Curve<K>]) -> Result<Self, EnsembleFitError> {
        let mut checked = Vec::with_capacity(curves.len());
        for (index, curve) in curves.iter().enumerate() {
            if let Some(&logarithm) = curve.scales.iter().find(|scale| !scale.is_finite()) {
                return Err(EnsembleFitError::ScaleUnusable { curve: index, logarithm });
            }
            let mut rows = Vec::with_capacity(curve.points.len());
            for (point, &MeasuredPoint { x, y, error }) in curve.points.iter().enumerate() {
                let weight = 1.0 / (error * error);
                if !(x > 0.0 && x.is_finite() && y.is_finite() && error > 0.0 && weight > 0.0 && weight.is_finite()) {
                    return Err(EnsembleFitError::PointUnusable { point, x, y, error });
                }
                rows.push(Row { at: libm::log(x), y, weight });
            }
            rows.sort_by(|a, b| a.at.total_cmp(&b.at));
            checked.push((curve.scales, rows));
        }
        let curve_count = checked.iter().filter(|(_, rows)| !rows.is_empty()).count();
        if curve_count < 2 || checked.iter().all(|(_, rows)| rows.len() < 2) {
            return Err(EnsembleFitError::TooFewCurves { curve_count });
        }
        let point_count = checked.iter().map(|(_, rows)| rows.len()).sum();
        Ok(Curves { curves: checked, point_count })
    }

    pub fn quality(&self, exponents: [f64; K]) -> Option<CollapseQuality> {
        let shifts: Vec<f64> =
            self.curves.iter().map(|(s, _)| s.iter().zip(exponents).map(|(s, e)| s * e).sum()).collect();
        let (mut sum, mut point_count) = (0.0, 0usize);
        // The group of every curve, labelled by its lowest index.
        let mut groups: Vec<usize> = (0..self.curves.len()).collect();
        for (own, (_, rows)) in self.curves.iter().enumerate() {
            for row in rows {
                if let Some((y, variance)) = self.master(own, row.at + shifts[own], &shifts, &mut groups) {
                    sum += (row.y - y) * (row.y - y) / (1.0 / row.weight + variance);
                    point_count += 1;
                }
            }
        }
        let mut groups =
            self.curves.iter().zip(groups).filter(|((_, rows), _)| !rows.is_empty()).map(|(_, group)| group);
        let first = groups.next();
        let connected = groups.all(|group| Some(group) == first);
        (point_count > 0).then_some(CollapseQuality {
            quality: sum / point_count as f64,
            point_count,
            of_count: self.point_count,
            connected,
        })
    }

    /// Y and dY² at u from all curves but one, whose group it merges with theirs.
    fn master(&self, own: usize, u: f64, shifts: &[f64], groups: &mut [usize]) -> Option<(f64, f64)> {
        // Relative to u, so that Y is the value of the line at 0: K, K_x, K_xx, K_y, K_xy of the source.
        let mut k = [0.0; 5];
        for (other, (_, rows)) in self.curves.iter().enumerate() {
            let above = rows.partition_point(|row| row.at + shifts[other] <= u);
            // A point exactly at u belongs to the pair above it; the last point of a curve belongs to the pair below.
            let above = if above == rows.len() && above > 0 && rows[above - 1].at + shifts[other] == u {
                above - 1
            } else {
                above
            };
            if other == own || above == 0 || above == rows.len() {
                continue;
            }
            if groups[own] != groups[other] {
                let (low, high) = (groups[own].min(groups[other]), groups[own].max(groups[other]));
                groups.iter_mut().filter(|group| **group == high).for_each(|group| *group = low);
            }
            for row in &rows[above - 1..=above] {
                let (x, w) = (row.at + shifts[other] - u, row.weight);
                k = [k[0] + w, k[1] + w * x, k[2] + w * x * x, k[3] + w * row.y, k[4] + w * x * row.y];
            }
        }
        let determinant = k[0] * k[2] - k[1] * k[1];
        // No pair, or only pairs with equal x.
        if determinant.is_nan() || determinant <= 0.0 {
            return None;
        }
        Some(((k[2] * k[3] - k[1] * k[4]) / determinant, k[2] / determinant))
    }
}
