//! [`Lanes`]: complex numbers side by side, and their exponentials by the power series.

/// Number of nodes processed together, for vector instructions.
pub(super) const LANES: usize = 4;

/// Terms of e^z for |z| ≤ 0.8 beyond the constant: 0.8^18/18! = 3·10⁻¹⁸.
pub(super) const EXPONENTIAL_DEGREE: usize = 17;

/// 1/n!.
pub(super) const INVERSE_FACTORIALS: [f64; EXPONENTIAL_DEGREE + 1] = {
    let mut values = [1.0; EXPONENTIAL_DEGREE + 1];
    let (mut n, mut factorial) = (1, 1.0);
    while n <= EXPONENTIAL_DEGREE {
        // Exact up to 18! < 2⁵³.
        factorial *= n as f64;
        values[n] = 1.0 / factorial;
        n += 1;
    }
    values
};

/// Real and imaginary parts of a few nodes.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Lanes {
    pub re: [f64; LANES],
    pub im: [f64; LANES],
}

/// `e^((decay + i turn) unit)`, by the power series.
#[inline(always)]
pub(super) fn exponentials(unit: &[f64; LANES], decay: f64, turn: f64) -> Lanes {
    let mut z = Lanes::default();
    let mut value = Lanes { re: [INVERSE_FACTORIALS[EXPONENTIAL_DEGREE]; LANES], im: [0.0; LANES] };
    for lane in 0..LANES {
        (z.re[lane], z.im[lane]) = (decay * unit[lane], turn * unit[lane]);
    }
    for n in (0..EXPONENTIAL_DEGREE).rev() {
        value = product(&value, &z);
        for lane in 0..LANES {
            value.re[lane] += INVERSE_FACTORIALS[n];
        }
    }
    value
}

#[inline(always)]
pub(super) fn product(a: &Lanes, b: &Lanes) -> Lanes {
    Lanes {
        re: std::array::from_fn(|lane| a.re[lane] * b.re[lane] - a.im[lane] * b.im[lane]),
        im: std::array::from_fn(|lane| a.re[lane] * b.im[lane] + a.im[lane] * b.re[lane]),
    }
}

#[inline(always)]
pub(super) fn reciprocals(a: &Lanes) -> Lanes {
    let inverse: [f64; LANES] = std::array::from_fn(|lane| 1.0 / (a.re[lane] * a.re[lane] + a.im[lane] * a.im[lane]));
    Lanes {
        re: std::array::from_fn(|lane| a.re[lane] * inverse[lane]),
        im: std::array::from_fn(|lane| -a.im[lane] * inverse[lane]),
    }
}

/// Adds a product to the sum with index `place`, and the product times the distance to the next sum.
#[inline(always)]
pub(super) fn accumulate<const SLOPE: bool>(
    sums: &mut [Lanes; 4],
    place: usize,
    product: &Lanes,
    distance: &[f64; LANES],
) {
    for lane in 0..LANES {
        sums[place].re[lane] += product.re[lane];
        sums[place].im[lane] += product.im[lane];
        if SLOPE {
            sums[place + 1].re[lane] += distance[lane] * product.re[lane];
            sums[place + 1].im[lane] += distance[lane] * product.im[lane];
        }
    }
}
