//! `Contour`: Σ S(f) cos fθ as an integral along a ray in the complex plane, for many θ.
//!
//! For S analytic between the real axis and the ray `w = a + t e^(iα)`, a half-integer, and 0 ≤ θ ≤ 2π,
//!
//! ```text
//! Σ_(f > a) S(f) cos fθ = Re ∫ S(w) [e^(iwθ) + e^(iw(2π−θ))] / (1 − e^(2πiw)) dw
//! ```
//!
//! (the residues of 1/(e^(2πiw) − 1) at the integers; the lower half of the contour is the mirror image of the upper
//! one). On the ray nothing oscillates faster than it decays. Without the denominator and the second exponential, and
//! with a = 0, it is the integral ∫ S(u) cos uθ du.
//!
//! The poles of `S = A/(1 + (w/f†)^s)` begin at arg w = π/s. The ray has half that angle, so that seen from a all
//! singularities are at least an angle α away from it, for any f†.
//!
//! # Quadrature
//! One panel [0, t_0], then panels \[t, 2t\], each with the same Gauss–Legendre nodes. So the exponentials of one panel
//! are the squares of those of the previous panel. Panels that end below tθ = 0.4 are summed for all θ at once, as the
//! moments of a power series in θ. The cost for a θ depends neither on θ nor on f†.
//!
//! # Errors
//! Gauss–Legendre with p nodes on a panel of length L has an error of at most
//!
//! ```text
//! (32/15) L M ρ^(−2(p−1)) / (1 − ρ^(−2))        ρ + 1/ρ = 2 √(5 − 4 cos 2β)
//! ```
//!
//! where M bounds the integrand in the ellipse of that ρ around the panel (Trefethen (2008), SIAM Rev. 50, 67, theorem
//! 4.5). The ellipse of a panel \[t, 2t\] touches the rays at angle β from the contour. For β < α it contains no
//! singularity, and there `|1 + (w/f†)^s| ≥ cos(πβ/2α)`, `|1 − e^(2πiw)| ≥ 1 − exp(−π tan(α − β))`, `|e^(iwθ)| ≤ 1`. p
//! is chosen from this bound ([`node_count`]). A unit test sums it over the panels with the true maxima M and finds
//! less than 2⁻⁵⁹ Σ S for exponents from 1.01 to 100 and f† from 0 to 10⁶. The series of moments is truncated where the
//! next term is below 0.4^15/15! = 10⁻¹⁸, that of the exponentials below 0.8^18/18! = 3·10⁻¹⁸. Panels beyond tθ sin α =
//! 40 are left out, e^(−40) = 4·10⁻¹⁸.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::reference::lorentzian::complex::{Complex, exponential, polar, reciprocal};
use crate::reference::lorentzian::gauss::gauss_legendre;
use crate::reference::lorentzian::lanes::{
    INVERSE_FACTORIALS, LANES, Lanes, accumulate, exponentials, product, reciprocals,
};

/// Panels that end below this tθ are summed by moments.
const MOMENT_REACH: f64 = 0.4;

/// Number of moments: 0.4^15/15! = 8·10⁻¹⁹.
const MOMENT_COUNT: usize = 15;

/// Exponentials below e^(−40) = 4·10⁻¹⁸ are left out.
pub(super) const DECAY_LIMIT: f64 = 40.0;

/// β/α of the ellipses from which the number of nodes is derived.
const ELLIPSE_SHARE: f64 = 0.85;

/// Half the angle of the first pole.
pub(super) fn ray_angle(exponent: f64) -> f64 {
    FRAC_PI_2 / exponent
}

/// `β` and `ρ` of the ellipses.
fn ellipse(exponent: f64) -> (f64, f64) {
    let beta = ELLIPSE_SHARE * ray_angle(exponent);
    let half_sum = (5.0 - 4.0 * libm::cos(2.0 * beta)).sqrt();
    // ρ + 1/ρ = 2 half_sum; 2 half_sum ≥ 2, and half_sum² − 1 = 8 sin²β without cancellation.
    (beta, half_sum + 8.0_f64.sqrt() * libm::sin(beta))
}

/// Number of nodes per panel for which the bound of the module documentation, for the panels with the largest S, is
/// below 2⁻⁵⁴.
fn node_count(exponent: f64) -> usize {
    let (beta, rho) = ellipse(exponent);
    let spectrum = 1.0 / libm::cos(FRAC_PI_2 * ELLIPSE_SHARE);
    let kernel = 1.0 / -libm::expm1(-PI * libm::tan(ray_angle(exponent) - beta));
    // Two exponentials.
    let bound = 64.0 / 15.0 * 2.0 * spectrum * kernel / (1.0 - 1.0 / (rho * rho));
    let count = 1.0 + libm::log(bound * libm::exp2(54.0)) / (2.0 * libm::log(rho));
    (count.ceil() as usize).next_multiple_of(LANES)
}

/// `Σ weight (±τ/t_top)^n / n!`, τ = i e^(iα) t, over all panels up to one that ends at t_top, for both exponentials.
#[derive(Debug, Clone, Copy)]
struct Moments {
    direct: [Complex; MOMENT_COUNT],
    image: [Complex; MOMENT_COUNT],
}

/// Type of the integral.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// The sum over the integers above `start`, a half-integer.
    Sum {
        /// a.
        start: f64,
    },
    /// The integral from 0.
    Integral,
}

/// Nodes, weights and moments of one S.
#[derive(Debug, Clone)]
pub(super) struct Contour {
    /// a.
    start: f64,
    /// e^(iα).
    direction: Complex,
    /// t_0, the end of the first panel.
    first: f64,
    /// Nodes in [1, 2], in units of the start of a panel.
    units: Vec<[f64; LANES]>,
    /// Weights of e^(iwθ), panel after panel, except the first.
    direct: Vec<Lanes>,
    /// Weights of e^(iw(2π−θ)) e^(−2πiw), for the first panels of `direct`.
    image: Vec<Lanes>,
    /// One for every panel, including the first.
    moments: Vec<Moments>,
}

impl Contour {
    /// The contour of `spectrum`, whose poles begin at arg w = π/`exponent`, with a first panel up to `first` and
    /// further ones to at least `last`.
    pub(super) fn new(kind: Kind, exponent: f64, first: f64, last: f64, spectrum: impl Fn(Complex) -> Complex) -> Self {
        let angle = ray_angle(exponent);
        let direction = polar(1.0, angle);
        let start = match kind {
            Kind::Sum { start } => start,
            Kind::Integral => 0.0,
        };
        let (nodes, gauss_weights) = gauss_legendre(node_count(exponent));
        // Weights of both exponentials at the point t, for a quadrature weight dt.
        let weights = |t: f64, dt: f64| {
            let w = Complex::new(start, 0.0) + direction.scale(t);
            let plain = spectrum(w) * direction.scale(dt);
            match kind {
                Kind::Integral => (plain, Complex::default()),
                Kind::Sum { .. } => {
                    // e^(2πia) = −1.
                    let decay = 2.0 * PI * direction.im * t;
                    if decay > 2.0 * DECAY_LIMIT {
                        return (plain, Complex::default());
                    }
                    let turn = exponential(Complex::new(-decay, 2.0 * PI * direction.re * t));
                    let direct = plain * reciprocal(Complex::new(1.0, 0.0) + turn);
                    (direct, direct * turn.scale(-1.0))
                }
            }
        };
        let panel_count = libm::ceil(libm::log2(last / first)).max(1.0) as usize;
        // The second exponential is at most e^(−πt sin α) for θ ≤ π.
        let image_count = match kind {
            Kind::Integral => 0,
            Kind::Sum { .. } => {
                let reach = libm::ceil(libm::log2(DECAY_LIMIT / (PI * direction.im * first))) as usize;
                reach.clamp(1, panel_count)
            }
        };
        let turned = Complex::new(-direction.im, direction.re);
        let mut moments = Vec::with_capacity(panel_count + 1);
        let empty = Moments { direct: [Complex::default(); MOMENT_COUNT], image: [Complex::default(); MOMENT_COUNT] };
        let mut last_moments = empty; // without the powers of the direction
        for (x, weight) in nodes.iter().zip(&gauss_weights) {
            let share = 0.5 * (1.0 + x);
            let (direct, image) = weights(first * share, 0.5 * first * weight);
            last_moments.add(direct, image, share);
        }
        moments.push(last_moments.turned(turned));
        let chunk_count = nodes.len() / LANES;
        let units: Vec<[f64; LANES]> =
            (0..chunk_count).map(|chunk| std::array::from_fn(|lane| 1.5 + 0.5 * nodes[chunk * LANES + lane])).collect();
        let mut direct = Vec::with_capacity(panel_count * chunk_count);
        let mut image = Vec::with_capacity(image_count * chunk_count);
        let mut begin = first;
        for panel in 0..panel_count {
            last_moments.halve();
            for (chunk, unit) in units.iter().enumerate() {
                let (mut one, mut other) = (Lanes::default(), Lanes::default());
                for lane in 0..LANES {
                    let weight = 0.5 * begin * gauss_weights[chunk * LANES + lane];
                    let pair = weights(begin * unit[lane], weight);
                    (one.re[lane], one.im[lane]) = (pair.0.re, pair.0.im);
                    (other.re[lane], other.im[lane]) = (pair.1.re, pair.1.im);
                    last_moments.add(pair.0, pair.1, 0.5 * unit[lane]);
                }
                direct.push(one);
                if panel < image_count {
                    image.push(other);
                }
            }
            moments.push(last_moments.turned(turned));
            begin *= 2.0;
        }
        Contour { start, direction, first, units, direct, image, moments }
    }

    /// Twice the real part of ∫ S e^(2πiw)/(1 − e^(2πiw)) dw: the difference between the sum over S and the integral.
    pub(super) fn sum_minus_integral(&self) -> f64 {
        // Beyond the panels of `image` the exponential is below e^(−80).
        2.0 * self.moments.last().expect("there is a first panel").image[0].re
    }

    /// The largest θ for which the moments of the first panel are valid.
    pub(super) fn largest_angle(&self) -> f64 {
        MOMENT_REACH / self.first
    }

    /// The integral at 0 < θ ≤ π, at most [`largest_angle`](Self::largest_angle), and its derivative, 0 unless `SLOPE`.
    pub(super) fn evaluate<const SLOPE: bool>(&self, angle: f64) -> (f64, f64) {
        let doublings = libm::ilogb(self.largest_angle() / angle).clamp(0, self.moments.len() as i32 - 1) as usize;
        let top = self.first * libm::exp2(doublings as f64);
        let step = angle * top;
        let moments = &self.moments[doublings];
        let (mut direct, mut direct_slope) = polynomial::<SLOPE>(&moments.direct, step);
        let (mut image, mut image_slope) = polynomial::<SLOPE>(&moments.image, step);
        let far = self.beyond::<SLOPE>(doublings, step);
        direct += far.direct;
        image += far.image;
        let phase = polar(1.0, self.start * angle);
        let value = (phase * direct).re + (phase.conj() * image).re;
        if !SLOPE {
            return (value, 0.0);
        }
        // d/dθ e^(τθ) = τ e^(τθ), τ = i e^(iα) t, and −τ for the image.
        let turned = Complex::new(-self.direction.im, self.direction.re).scale(top);
        direct_slope = direct_slope.scale(top) + turned * far.direct_slope + Complex::new(0.0, self.start) * direct;
        image_slope =
            image_slope.scale(top) + turned.scale(-1.0) * far.image_slope + Complex::new(0.0, -self.start) * image;
        (value, (phase * direct_slope).re + (phase.conj() * image_slope).re)
    }

    /// The panels after number `doublings`, the first of which begins at tθ = `step`.
    fn beyond<const SLOPE: bool>(&self, doublings: usize, step: f64) -> Beyond {
        let left = self.moments.len() - 1 - doublings;
        let needed = libm::ceil(libm::log2(DECAY_LIMIT / (step * self.direction.im))).max(0.0) as usize;
        let panel_count = needed.min(left);
        let chunk_count = self.units.len();
        let (decay, turn) = (-step * self.direction.im, step * self.direction.re);
        let mut sums = [Lanes::default(); 4];
        for (chunk, unit) in self.units.iter().enumerate() {
            let mut exponential = exponentials(unit, decay, turn);
            let mut scale = 1.0;
            for panel in doublings..doublings + panel_count {
                let weight = &self.direct[panel * chunk_count + chunk];
                let distance: [f64; LANES] = std::array::from_fn(|lane| scale * unit[lane]);
                let weighted = product(weight, &exponential);
                accumulate::<SLOPE>(&mut sums, 0, &weighted, &distance);
                if let Some(weight) = self.image.get(panel * chunk_count + chunk) {
                    let weighted = product(weight, &reciprocals(&exponential));
                    accumulate::<SLOPE>(&mut sums, 2, &weighted, &distance);
                }
                exponential = product(&exponential, &exponential);
                scale *= 2.0;
            }
        }
        let [direct, direct_slope, image, image_slope] = sums.map(|lanes| {
            Complex::new((lanes.re[0] + lanes.re[1]) + (lanes.re[2] + lanes.re[3]), lanes.im.iter().sum::<f64>())
        });
        Beyond { direct, direct_slope, image, image_slope }
    }
}

/// The contribution of the panels beyond the moments.
struct Beyond {
    direct: Complex,
    direct_slope: Complex,
    image: Complex,
    image_slope: Complex,
}

impl Moments {
    /// Adds a node at t = `place` t_top, as if τ were t; [`turned`](Self::turned) corrects this.
    fn add(&mut self, direct: Complex, image: Complex, place: f64) {
        let mut power = 1.0;
        for n in 0..MOMENT_COUNT {
            self.direct[n] += direct.scale(power * INVERSE_FACTORIALS[n]);
            power *= place;
        }
        if image == Complex::default() {
            return;
        }
        let mut power = 1.0;
        for n in 0..MOMENT_COUNT {
            self.image[n] += image.scale(power * INVERSE_FACTORIALS[n]);
            power *= -place;
        }
    }

    /// The contribution for τ = `direction` t.
    fn turned(&self, direction: Complex) -> Self {
        let (mut moments, mut power) = (*self, Complex::new(1.0, 0.0));
        for n in 0..MOMENT_COUNT {
            moments.direct[n] *= power;
            moments.image[n] *= power;
            power *= direction;
        }
        moments
    }

    /// The same nodes in units of a t_top twice as large.
    fn halve(&mut self) {
        let mut factor = 1.0;
        for n in 0..MOMENT_COUNT {
            self.direct[n] = self.direct[n].scale(factor);
            self.image[n] = self.image[n].scale(factor);
            factor *= 0.5;
        }
    }
}

/// `Σ coefficient_n x^n` and its derivative.
fn polynomial<const SLOPE: bool>(coefficients: &[Complex; MOMENT_COUNT], x: f64) -> (Complex, Complex) {
    let (mut value, mut slope) = (Complex::default(), Complex::default());
    for &coefficient in coefficients.iter().rev() {
        if SLOPE {
            slope = slope.scale(x) + value;
        }
        value = value.scale(x) + coefficient;
    }
    (value, slope)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::lorentzian::complex::modulus;
    use crate::reference::lorentzian::continuum::last_panel;
    use crate::reference::lorentzian::{CONTOUR_START, FIRST_PANEL, Lorentzian, complex_spectrum};

    /// Largest modulus of the integrand, both exponentials, on the ellipse around a panel, θ = 0 or π.
    fn largest(crossover: f64, exponent: f64, from: f64, to: f64, rho: f64) -> f64 {
        let direction = polar(1.0, ray_angle(exponent));
        let (centre, half) = (0.5 * (from + to), 0.5 * (to - from));
        let mut largest = 0.0_f64;
        for step in 0..720 {
            let around = polar(1.0, PI * f64::from(step) / 360.0);
            let t = Complex::new(
                centre + half * 0.5 * (rho + 1.0 / rho) * around.re,
                half * 0.5 * (rho - 1.0 / rho) * around.im,
            );
            let w = Complex::new(CONTOUR_START, 0.0) + direction * t;
            let decay = |angle: f64| (-angle * w.im).exp();
            let both = (decay(0.0) + decay(2.0 * PI)).max(2.0 * decay(PI));
            let turn = exponential(Complex::new(-2.0 * PI * w.im, 2.0 * PI * w.re));
            let kernel = modulus(Complex::new(1.0, 0.0) + turn.scale(-1.0));
            let here = both * modulus(complex_spectrum(crossover, exponent, w)) / kernel;
            assert!(here.is_finite());
            largest = largest.max(here);
        }
        largest
    }

    #[test]
    fn what_the_quadrature_leaves_out_is_below_rounding() {
        // Chosen for 2⁻⁵⁴ if the bounds of S and of the denominator were reached at the same point, which never
        // happens.
        for exponent in [1.01, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0, 10.0, 30.0, 100.0] {
            let ((beta, rho), count) = (ellipse(exponent), node_count(exponent));
            let half_sum = (5.0 - 4.0 * (2.0 * beta).cos()).sqrt();
            assert!((rho + 1.0 / rho - 2.0 * half_sum).abs() < 8.0 * f64::EPSILON * rho);
            let share = rho.powi(-2 * (count as i32 - 1)) / (1.0 - 1.0 / (rho * rho));
            for crossover in [0.0, 0.4, 1.0, 1.5, 1.7, 3.0, 10.0, 1e3, 1e6] {
                let scale = f64::max(1.0, crossover);
                let mut bound = 32.0 / 15.0 * FIRST_PANEL * largest(crossover, exponent, 0.0, FIRST_PANEL, rho) * share;
                let mut from = FIRST_PANEL;
                while from < last_panel(exponent, scale) {
                    bound += 32.0 / 15.0 * from * largest(crossover, exponent, from, 2.0 * from, rho) * share;
                    from *= 2.0;
                }
                let total = Lorentzian::of(crossover, exponent).expect("valid").total();
                assert!(bound < libm::exp2(-59.0) * total, "s = {exponent}, f† = {crossover}: {:e}", bound / total);
            }
        }
    }

    #[test]
    fn weights_are_not_much_larger_than_what_they_sum_to() {
        // The factor of the rounding. The smallest angles use all panels.
        for exponent in [1.01, 1.2, 1.5, 2.0, 3.0, 4.0, 6.0, 10.0, 31.0, 100.0] {
            for crossover in [0.0, 0.4, 1.0, 1.5, 1.7, 3.0, 10.0, 1e3, 1e6] {
                let spectrum = |w| complex_spectrum(crossover, exponent, w);
                let last = last_panel(exponent, f64::max(1.0, crossover));
                let contour = Contour::new(Kind::Sum { start: CONTOUR_START }, exponent, FIRST_PANEL, last, spectrum);
                let panels = contour.direct.iter().chain(&contour.image);
                let sum: f64 = panels.flat_map(|lanes| lanes.re.iter().zip(&lanes.im)).map(|(x, y)| x.hypot(*y)).sum();
                let first = &contour.moments[0];
                let sum = sum + modulus(first.direct[0]) + modulus(first.image[0]);
                let total = Lorentzian::of(crossover, exponent).expect("valid").total();
                let most = 2.0 * total / libm::sin(ray_angle(exponent));
                assert!(sum < most, "s = {exponent}, f† = {crossover}: {} {}", sum / total, most / total);
                println!("{exponent} {crossover} {} {}", sum / total, sum / most);
            }
        }
    }

    #[test]
    fn panels_and_nodes_are_as_many_as_said() {
        assert_eq!((node_count(1.5), node_count(4.0)), (16, 28));
        for (crossover, panel_count) in [(0.0, 42), (1.0, 42), (1e6, 62)] {
            let last = last_panel(1.5, f64::max(1.0, crossover));
            let spectrum = |w| complex_spectrum(crossover, 1.5, w);
            let contour = Contour::new(Kind::Sum { start: CONTOUR_START }, 1.5, FIRST_PANEL, last, spectrum);
            assert_eq!(contour.direct.len() * LANES, panel_count * 16);
            assert_eq!(contour.moments.len(), panel_count + 1);
        }
        assert_eq!(16 / LANES * size_of::<Lanes>() + size_of::<Moments>(), 736);
    }
}
