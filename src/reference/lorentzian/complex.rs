//! `Complex`: the operations on complex numbers that the contour needs.

use std::ops::{Add, Mul};

/// A complex number.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Complex {
    pub(super) re: f64,
    pub(super) im: f64,
}

impl Complex {
    pub(super) const fn new(re: f64, im: f64) -> Self {
        Complex { re, im }
    }

    /// `modulus · e^(i angle)`.
    pub(super) fn polar(modulus: f64, angle: f64) -> Self {
        let (sine, cosine) = libm::sincos(angle);
        Complex::new(modulus * cosine, modulus * sine)
    }

    pub(super) fn modulus(self) -> f64 {
        libm::hypot(self.re, self.im)
    }

    /// Between −π and π.
    pub(super) fn angle(self) -> f64 {
        libm::atan2(self.im, self.re)
    }

    pub(super) fn conjugate(self) -> Self {
        Complex::new(self.re, -self.im)
    }

    pub(super) fn scaled(self, factor: f64) -> Self {
        Complex::new(factor * self.re, factor * self.im)
    }

    /// `1/z`, for |z|² neither overflowing nor underflowing.
    pub(super) fn reciprocal(self) -> Self {
        self.conjugate().scaled(1.0 / (self.re * self.re + self.im * self.im))
    }

    /// `e^z`.
    pub(super) fn exponential(self) -> Self {
        Complex::polar(libm::exp(self.re), self.im)
    }

    /// `z^exponent`, cut along the negative axis.
    pub(super) fn power(self, exponent: f64) -> Self {
        Complex::polar(libm::pow(self.modulus(), exponent), exponent * self.angle())
    }
}

impl Add for Complex {
    type Output = Complex;

    fn add(self, other: Complex) -> Complex {
        Complex::new(self.re + other.re, self.im + other.im)
    }
}

impl Mul for Complex {
    type Output = Complex;

    fn mul(self, other: Complex) -> Complex {
        Complex::new(self.re * other.re - self.im * other.im, self.re * other.im + self.im * other.re)
    }
}
