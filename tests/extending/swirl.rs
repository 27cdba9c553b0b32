use jamscope::displacement::DisplacementField;

/// The angle by which the disks of a ring turn about the inflated one, by least squares: ω = Σ r d_θ / Σ r² \[rad\].
/// None without a disk that counts.
pub fn swirl(field: &DisplacementField<2>, from: f64, to: f64) -> Option<f64> {
    let ring = || field.counted().filter(|disk| from <= disk.distance && disk.distance < to);
    let turned: f64 = ring().map(|disk| disk.distance * disk.transverse()).sum();
    let weight: f64 = ring().map(|disk| disk.distance.powi(2)).sum();
    (weight > 0.0).then(|| turned / weight)
}
