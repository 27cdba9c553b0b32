//! Fourier sums against their plainest form.

use jamscope::observe::angular::{Route, fourier_sums, fourier_sums_by};

use super::random_angles;

#[test]
fn both_routes_give_the_sums() {
    for (count, limit) in [(5, 3), (60, 30), (1000, 400), (700, 2000)] {
        let angles = random_angles(count, 3);
        let strengths: Vec<f64> = random_angles(count, 4);
        let total: f64 = strengths.iter().map(|a| a.abs()).sum();
        let [direct, fast] =
            [Route::Direct, Route::Fast].map(|route| fourier_sums_by(route, &angles, &strengths, limit));
        assert_eq!((direct.len(), fast.len()), (limit + 1, limit + 1));
        for f in 0..=limit {
            let (mut re, mut im) = (0.0, 0.0);
            for (angle, a) in angles.iter().zip(&strengths) {
                re += a * (f as f64 * angle).cos();
                im -= a * (f as f64 * angle).sin();
            }
            // The phase fθ ≤ πf is rounded here and there; 64 rotations round twice each.
            let phase = (2.0 * std::f64::consts::PI * f as f64 + 128.0) * f64::EPSILON * total;
            let direct_error = (direct[f].re - re).hypot(direct[f].im - im);
            assert!(direct_error <= phase, "direct, n = {count}, f = {f}: {:e}", direct_error / total);
            // What the spreading leaves out, 50·5·10⁻¹⁶ in truncation and as much in aliases.
            let fast_error = (fast[f].re - re).hypot(fast[f].im - im);
            assert!(fast_error <= phase + 5e-14 * total, "fast, n = {count}, f = {f}: {:e}", fast_error / total);
        }
    }
}

#[test]
fn the_route_is_chosen_by_size_alone() {
    assert_eq!(Route::shorter(60, 30), Route::Direct);
    assert_eq!(Route::shorter(4000, 10), Route::Direct);
    assert_eq!(Route::shorter(4000, 250), Route::Fast);
    let (angles, strengths) = (random_angles(4000, 1), vec![1.0; 4000]);
    assert_eq!(fourier_sums(&angles, &strengths, 250), fourier_sums_by(Route::Fast, &angles, &strengths, 250));
}
