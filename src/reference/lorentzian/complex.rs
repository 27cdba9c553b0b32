//! Complex numbers whose functions are those of libm: the same bits on every system.

/// A complex number.
pub(super) type Complex = num_complex::Complex<f64>;

/// `modulus · e^(i angle)`.
pub(super) fn polar(modulus: f64, angle: f64) -> Complex {
    let (sine, cosine) = libm::sincos(angle);
    Complex::new(modulus * cosine, modulus * sine)
}

/// |z|.
pub(super) fn modulus(z: Complex) -> f64 {
    libm::hypot(z.re, z.im)
}

/// `1/z`, for |z|² neither overflowing nor underflowing.
pub(super) fn reciprocal(z: Complex) -> Complex {
    z.conj().scale(1.0 / z.norm_sqr())
}

/// `e^z`.
pub(super) fn exponential(z: Complex) -> Complex {
    polar(libm::exp(z.re), z.im)
}

/// `z^exponent`, cut along the negative axis.
pub(super) fn power(z: Complex, exponent: f64) -> Complex {
    polar(libm::pow(modulus(z), exponent), exponent * libm::atan2(z.im, z.re))
}
