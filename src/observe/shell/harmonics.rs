//! Sums of real spherical harmonics over the spheres of a shell.
//!
//! ```text
//! R_ℓ0 = P_ℓ(z)       R_ℓ±m = √(2 (ℓ−m)!/(ℓ+m)!) P_ℓ^m(z) {cos mφ, sin mφ}       Σ_m R_ℓm(n) R_ℓm(n') = P_ℓ(n·n')
//! ```
//!
//! So Σ_ij s_i s_j P_ℓ(n_i·n_j) = Σ_m (Σ_i s_i R_ℓm(n_i))²: 2ℓ+1 sums over spheres instead of one over pairs. For each m
//! the recursion rises in ℓ, which is stable; its start, sin^m θ, is a power of x + iy:
//!
//! ```text
//! √(ℓ²−m²) R_ℓ = (2ℓ−1) z R_(ℓ−1) − √((ℓ−1)²−m²) R_(ℓ−2)        R_mm = √((2m−1)/2m) sin θ R_(m−1,m−1),  R_11 = sin θ
//! ```
//!
//! The recursion leaves sin^m θ out, which could underflow. Up to ℓ = 1000 its values are below 10²⁰⁸.
//! Source: Holmes, Featherstone (2002), J. Geod. 76, 279 (the recursion and its range).

use crate::vector::Vector;

/// Spheres in a block. Fixed, so that sums have the same bits for vectors of any width.
const LANES: usize = 8;

/// One number for each sphere of a block.
pub(super) type Lanes = [f64; LANES];

/// Coefficients of the recursion up to a degree.
struct Recursion {
    limit: usize,
    /// (2ℓ−1)/√(ℓ²−m²) and √(((ℓ−1)²−m²)/(ℓ²−m²)), by m and ℓ.
    steps: Vec<[f64; 2]>,
    /// √((2m−1)/2m), m ≥ 2; 1 before.
    starts: Vec<f64>,
}

impl Recursion {
    fn new(limit: usize) -> Self {
        let mut steps = Vec::with_capacity((limit + 1) * (limit + 2) / 2);
        for m in 0..=limit {
            for degree in m..=limit {
                let square = |k: usize| (k * k - m * m) as f64;
                steps.push(if degree == m {
                    [0.0; 2]
                } else {
                    let below = if degree > m + 1 { square(degree - 1) } else { 0.0 };
                    [(2 * degree - 1) as f64 / square(degree).sqrt(), (below / square(degree)).sqrt()]
                });
            }
        }
        let start = |m: usize| if m < 2 { 1.0 } else { ((2 * m - 1) as f64 / (2 * m) as f64).sqrt() };
        Recursion { limit, steps, starts: (0..=limit).map(start).collect() }
    }

    /// Calls `visit` with the index of (m, ℓ), ℓ, and R_ℓ,m and R_ℓ,−m of the spheres of a block.
    #[inline(always)]
    fn for_each(&self, block: &[Lanes; 3], mut visit: impl FnMut(usize, usize, &Lanes, &Lanes)) {
        let [x, y, z] = block;
        let (mut cosine, mut sine) = ([1.0; LANES], [0.0; LANES]);
        let mut index = 0;
        for m in 0..=self.limit {
            if m > 0 {
                for k in 0..LANES {
                    let (c, s) = (cosine[k], sine[k]);
                    cosine[k] = self.starts[m] * (c * x[k] - s * y[k]);
                    sine[k] = self.starts[m] * (c * y[k] + s * x[k]);
                }
            }
            let (mut last, mut value) = ([0.0; LANES], [1.0; LANES]);
            for degree in m..=self.limit {
                if degree > m {
                    let [rise, fall] = self.steps[index];
                    for k in 0..LANES {
                        let next = rise * z[k] * value[k] - fall * last[k];
                        last[k] = value[k];
                        value[k] = next;
                    }
                }
                let (mut c, mut s) = ([0.0; LANES], [0.0; LANES]);
                for k in 0..LANES {
                    c[k] = value[k] * cosine[k];
                    s[k] = value[k] * sine[k];
                }
                visit(index, degree, &c, &s);
                index += 1;
            }
        }
    }
}

/// The spheres in blocks; the last one is filled up with the north pole.
fn blocks(directions: &[Vector<3>]) -> impl Iterator<Item = (usize, [Lanes; 3])> + '_ {
    directions.chunks(LANES).enumerate().map(|(number, chunk)| {
        let mut block = [[0.0; LANES], [0.0; LANES], [1.0; LANES]];
        for (k, direction) in chunk.iter().enumerate() {
            for d in 0..3 {
                block[d][k] = direction[d];
            }
        }
        (number * LANES, block)
    })
}

/// Σ_i s_i R_ℓm(n_i) for all ℓ up to a limit.
#[derive(Debug, Clone)]
pub(super) struct HarmonicSums {
    limit: usize,
    /// Sums of R_ℓ,m and R_ℓ,−m, by m and ℓ.
    sums: Vec<[f64; 2]>,
}

impl HarmonicSums {
    /// The sums of `strengths`, one for each direction.
    pub(super) fn of(directions: &[Vector<3>], strengths: &[f64], limit: usize) -> Self {
        let recursion = Recursion::new(limit);
        let mut lanes = vec![[[0.0; LANES]; 2]; recursion.steps.len()];
        for (first, block) in blocks(directions) {
            let mut strength = [0.0; LANES];
            for (k, value) in strengths[first..].iter().take(LANES).enumerate() {
                strength[k] = *value;
            }
            recursion.for_each(&block, |index, _, cosine, sine| {
                let [c, s] = &mut lanes[index];
                for k in 0..LANES {
                    c[k] += strength[k] * cosine[k];
                    s[k] += strength[k] * sine[k];
                }
            });
        }
        let sums = lanes.iter().map(|[c, s]| [c.iter().sum(), s.iter().sum()]);
        HarmonicSums { limit, sums: sums.collect() }
    }

    /// The same sums of independent amplitudes, for a field Σ amplitude R_ℓm; in the order of `sums`.
    pub(super) fn of_amplitudes(limit: usize, mut amplitude: impl FnMut(usize, usize) -> [f64; 2]) -> Self {
        let orders = (0..=limit).flat_map(|m| (m..=limit).map(move |degree| (degree, m)));
        HarmonicSums { limit, sums: orders.map(|(degree, m)| amplitude(degree, m)).collect() }
    }

    /// Σ_m (…)² at its index ℓ.
    pub(super) fn power(&self) -> Vec<f64> {
        let mut power = vec![0.0; self.limit + 1];
        let mut index = 0;
        for m in 0..=self.limit {
            for degree in m..=self.limit {
                let [c, s] = self.sums[index];
                power[degree] += c * c + s * s;
                index += 1;
            }
        }
        power
    }

    /// Calls `visit` for every block of up to eight spheres with Σ_m R_ℓm(n_i) (…)_ℓm at its index ℓ, their first index
    /// and their number. With strengths s this is Σ_j s_j P_ℓ(n_i·n_j).
    pub(super) fn for_each_block(&self, directions: &[Vector<3>], mut visit: impl FnMut(&[Lanes], usize, usize)) {
        let recursion = Recursion::new(self.limit);
        let mut parts = vec![[0.0; LANES]; self.limit + 1];
        for (first, block) in blocks(directions) {
            parts.fill([0.0; LANES]);
            recursion.for_each(&block, |index, degree, cosine, sine| {
                let ([c, s], part) = (self.sums[index], &mut parts[degree]);
                for k in 0..LANES {
                    part[k] += c * cosine[k] + s * sine[k];
                }
            });
            visit(&parts, first, (directions.len() - first).min(LANES));
        }
    }
}

/// P_0, …, P_limit at a cosine.
pub(super) fn legendre(cosine: f64, limit: usize) -> Vec<f64> {
    let mut values = Vec::with_capacity(limit + 1);
    let (mut last, mut value) = (0.0, 1.0);
    for degree in 0..=limit {
        values.push(value);
        let l = degree as f64;
        (last, value) = (value, ((2.0 * l + 1.0) * cosine * value - l * last) / (l + 1.0));
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_of_harmonics_are_sums_of_legendre_polynomials_over_pairs() {
        let place = |k: u32| {
            let (z, angle) = ((1.7 * f64::from(k)).sin(), 2.4 * f64::from(k));
            let sine = (1.0 - z * z).sqrt();
            [sine * angle.cos(), sine * angle.sin(), z]
        };
        let mut directions: Vec<Vector<3>> = (0..21).map(place).collect();
        // Both poles, and one near a pole.
        directions.extend([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1e-9, 0.0, 1.0]]);
        let strengths: Vec<f64> = (0..24).map(|k| (0.9 * f64::from(k)).cos()).collect();
        let limit = 60;
        let sums = HarmonicSums::of(&directions, &strengths, limit);
        let power = sums.power();
        let mut exact = vec![0.0; limit + 1];
        let mut potential = vec![vec![0.0; limit + 1]; 24];
        for i in 0..24 {
            for j in 0..24 {
                let cosine: f64 = (0..3).map(|d| directions[i][d] * directions[j][d]).sum();
                for (degree, value) in legendre(cosine, limit).iter().enumerate() {
                    exact[degree] += strengths[i] * strengths[j] * value;
                    potential[i][degree] += strengths[j] * value;
                }
            }
        }
        // |P_ℓ| ≤ 1 and P_ℓ' ≤ ℓ(ℓ+1)/2 = 1830: a cosine rounded by 2⁻⁵³ changes P_ℓ by 2·10⁻¹³, 576 products of at
        // most 1 their sum by 1.2·10⁻¹⁰; the recursions add some ℓ roundings to each.
        for degree in 0..=limit {
            assert!((power[degree] - exact[degree]).abs() < 1.2e-10, "{degree}: {} {}", power[degree], exact[degree]);
        }
        sums.for_each_block(&directions, |parts, first, count| {
            for k in 0..count {
                for degree in 0..=limit {
                    assert!((parts[degree][k] - potential[first + k][degree]).abs() < 5e-12);
                }
            }
        });
    }
}
