//! The slow twin of the angular modes: the equation of the displacement as it stands, second order, by Taylor series in
//! numbers of 160 bits, from the rim inward, without any scaling or orthogonalisation.
//!
//! ```text
//! r² times  Δu + (β−1) ∇(∇·u) + Γ u = 0        β = (λ+2μ)/μ = 2/(1−ν)
//! ```

use std::ops::{Add, Mul, Sub};

use dashu_float::{FBig, round::mode::HalfEven};
use jamscope::reference::Annulus;
use jamscope::reference::angular_modes::screened::Screening;
use jamscope::reference::angular_modes::{Complex, ModeAmplitudes, ModeState};

type Real = FBig<HalfEven, 2>;

/// Cancellation between the two solutions carried along costs (R/a)² = 2⁴⁷ at most, so 60 more bits are left than an
/// `f64` has.
const PRECISION: usize = 160;

/// A number, exactly.
fn real(x: f64) -> Real {
    Real::try_from(x).expect("finite").with_precision(PRECISION).value()
}

#[derive(Clone)]
struct Big {
    re: Real,
    im: Real,
}

impl Big {
    fn new(re: f64, im: f64) -> Self {
        Big { re: real(re), im: real(im) }
    }

    fn zero() -> Self {
        Big::new(0.0, 0.0)
    }

    fn scale(&self, factor: &Real) -> Self {
        Big { re: &self.re * factor, im: &self.im * factor }
    }

    fn times_i(&self) -> Self {
        Big { re: -self.im.clone(), im: self.re.clone() }
    }

    fn over(&self, other: &Big) -> Self {
        let norm = &other.re * &other.re + &other.im * &other.im;
        let conjugate = Big { re: other.re.clone(), im: -other.im.clone() };
        let product = self * &conjugate;
        Big { re: product.re / &norm, im: product.im / &norm }
    }

    fn rounded(&self) -> Complex<f64> {
        Complex::new(self.re.to_f64().value(), self.im.to_f64().value())
    }
}

impl Add for &Big {
    type Output = Big;
    fn add(self, other: &Big) -> Big {
        Big { re: &self.re + &other.re, im: &self.im + &other.im }
    }
}

impl Sub for &Big {
    type Output = Big;
    fn sub(self, other: &Big) -> Big {
        Big { re: &self.re - &other.re, im: &self.im - &other.im }
    }
}

impl Mul for &Big {
    type Output = Big;
    fn mul(self, other: &Big) -> Big {
        Big { re: &self.re * &other.re - &self.im * &other.im, im: &self.re * &other.im + &self.im * &other.re }
    }
}

/// `[U, V, rU', rV']`.
type Solution = [Big; 4];

/// A mode given by the same numbers as those of the crate.
pub struct Twin {
    pub annulus: Annulus,
    pub poisson_ratio: f64,
    pub screening: Screening,
    pub mode: u32,
}

impl Twin {
    /// For each of `boundaries`, the state at each of `radii`, which fall and lie within the annulus.
    pub fn at(&self, radii: &[f64], boundaries: &[ModeAmplitudes]) -> Vec<Vec<ModeState>> {
        let one = || Big::new(1.0, 0.0);
        let mut columns: [Solution; 2] =
            [[Big::zero(), Big::zero(), one(), Big::zero()], [Big::zero(), Big::zero(), Big::zero(), one()]];
        let mut radius = self.annulus.outer_radius();
        let mut kept = Vec::new();
        for &target in radii.iter().chain([&self.annulus.inner_radius()]) {
            while radius > target {
                let next = (radius - self.reach(radius) * radius).max(target);
                columns = columns.map(|column| self.advance(radius, next, &column));
                radius = next;
            }
            kept.push((target, columns.clone()));
        }
        let (_, edge) = kept.pop().expect("the inner radius was visited");
        boundaries.iter().map(|boundary| combine(boundary, &edge, &kept)).collect()
    }

    fn reach(&self, radius: f64) -> f64 {
        let wavenumber = self.screening.even.hypot(self.screening.odd).sqrt();
        f64::min(0.25, 2.0 / f64::from(self.mode).max(wavenumber * radius))
    }

    /// With r = ρ(1 + z), U = Σ u_k z^k and V = Σ v_k z^k, order k of the equation gives u_(k+2) and v_(k+2):
    ///
    /// ```text
    /// β r²U'' + β rU' − (n²+β) U + in[(β−1) rV' − (β+1) V] + r² (Γ_e U − Γ_o V) = 0
    ///   r²V'' +   rV' − (1+βn²) V + in[(β−1) rU' + (β+1) U] + r² (Γ_o U + Γ_e V) = 0
    /// ```
    fn advance(&self, from: f64, to: f64, start: &Solution) -> Solution {
        let n = real(f64::from(self.mode));
        let beta = real(2.0) / (real(1.0) - real(self.poisson_ratio));
        let square = &n * &n;
        let (sum, difference) = (&n * (&beta + real(1.0)), &n * (&beta - real(1.0)));
        let radius = real(from);
        let even = real(self.screening.even) * &radius * &radius;
        let odd = real(self.screening.odd) * &radius * &radius;
        let z = (real(to) - &radius) / &radius;

        let mut u = vec![start[0].clone(), start[2].clone()];
        let mut v = vec![start[1].clone(), start[3].clone()];
        let mut power = z.clone();
        let mut values = [&u[0] + &u[1].scale(&z), &v[0] + &v[1].scale(&z)];
        let mut slopes = [u[1].clone(), v[1].clone()];
        let mut small_terms = 0;
        for k in 0.. {
            let order = real(f64::from(k));
            let k = k as usize;
            // (1+z)² d²/dz² without the highest coefficient, (1+z) d/dz, and (1+z)², all at order k.
            let after = &order + real(1.0);
            let curved = |x: &[Big]| {
                &x[k + 1].scale(&(real(2.0) * &after * &order)) + &x[k].scale(&(&order * (&order - real(1.0))))
            };
            let sloped = |x: &[Big]| &x[k + 1].scale(&after) + &x[k].scale(&order);
            let wide = |x: &[Big]| {
                let mut total = x[k].clone();
                if k >= 1 {
                    total = &total + &x[k - 1].scale(&real(2.0));
                }
                if k >= 2 {
                    total = &total + &x[k - 2];
                }
                total
            };
            let radial = &(&(&(&curved(&u) + &sloped(&u)).scale(&beta) - &u[k].scale(&(&square + &beta)))
                + &(&sloped(&v).scale(&difference) - &v[k].scale(&sum)).times_i())
                + &(&wide(&u).scale(&even) - &wide(&v).scale(&odd));
            let transverse = &(&(&(&curved(&v) + &sloped(&v)) - &v[k].scale(&(real(1.0) + &square * &beta)))
                + &(&sloped(&u).scale(&difference) + &u[k].scale(&sum)).times_i())
                + &(&wide(&u).scale(&odd) + &wide(&v).scale(&even));
            let highest = real(-1.0) / (&after * (&after + real(1.0)));
            u.push(radial.scale(&(&highest / &beta)));
            v.push(transverse.scale(&highest));
            // The terms of the sums; slopes are d/dz.
            let last = &after + real(1.0);
            let slope_power = power.clone();
            power = &power * &z;
            let mut small = true;
            for (i, x) in [&u[k + 2], &v[k + 2]].into_iter().enumerate() {
                let (term, slope_term) = (x.scale(&power), x.scale(&(&last * &slope_power)));
                small = small && negligible(&term, &values) && negligible(&slope_term, &slopes);
                values[i] = &values[i] + &term;
                slopes[i] = &slopes[i] + &slope_term;
            }
            small_terms = if small { small_terms + 1 } else { 0 };
            if small_terms == 3 {
                break;
            }
        }
        // r d/dr = (1+z) d/dz.
        let stretch = real(1.0) + &z;
        let ([u, v], [du, dv]) = (values, slopes);
        [u, v, du.scale(&stretch), dv.scale(&stretch)]
    }
}

/// The combination of the two solutions that has the displacement `boundary` where they are `edge`.
fn combine(boundary: &ModeAmplitudes, edge: &[Solution; 2], kept: &[(f64, [Solution; 2])]) -> Vec<ModeState> {
    let [first, second] = edge;
    let [u, v] = [boundary.radial, boundary.transverse].map(|z| Big::new(z.re, z.im));
    let determinant = &(&first[0] * &second[1]) - &(&second[0] * &first[1]);
    let weights = [
        (&(&u * &second[1]) - &(&v * &second[0])).over(&determinant),
        (&(&v * &first[0]) - &(&u * &first[1])).over(&determinant),
    ];
    kept.iter()
        .map(|(radius, [first, second])| {
            let [u, v, du, dv]: Solution =
                std::array::from_fn(|i| &(&first[i] * &weights[0]) + &(&second[i] * &weights[1]));
            let inverse = real(1.0) / real(*radius);
            ModeState {
                value: ModeAmplitudes { radial: u.rounded(), transverse: v.rounded() },
                derivative: ModeAmplitudes {
                    radial: du.scale(&inverse).rounded(),
                    transverse: dv.scale(&inverse).rounded(),
                },
            }
        })
        .collect()
}

/// Whether a term is below 2^(−PRECISION) of the larger of the sums.
fn negligible(term: &Big, sums: &[Big; 2]) -> bool {
    let size = |z: &Big| {
        let part = |x: &Real| if *x < real(0.0) { -x.clone() } else { x.clone() };
        part(&z.re) + part(&z.im)
    };
    let grown = size(term) * real(f64::exp2(PRECISION as f64));
    grown <= size(&sums[0]) + size(&sums[1])
}
