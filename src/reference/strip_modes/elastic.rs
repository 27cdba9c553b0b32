//! The elastic strip in closed form.
//!
//! With z = H − y, the combinations s = U + V and d = U − V of an elastic mode are, with P = ∇·u/ε and W the amplitude
//! of −∇×u,
//!
//! ```text
//! s' = q s − εP − W        P' = −q W        P = a e^(qz) + b e^(−qz)
//! d' = −q d − εP + W       W' = −q P        W = −a e^(qz) + b e^(−qz)
//! s = (1−ε) a z e^(qz) − (1+ε) b sinh(qz)/q        d = −(1+ε) a sinh(qz)/q + (1−ε) b z e^(−qz)
//! ```
//!
//! The displacement at z = h determines a and b: the formulas of [`StripMode`](super::StripMode).

use crate::reference::angular_modes::exponential_differences::{Gap, product_difference};
use crate::reference::rim_distance::RimDistance;

/// The factors of s_a and d_a in s and d, and in their derivatives by z.
pub(super) struct Factors {
    pub(super) value: [[f64; 2]; 2],
    pub(super) derivative: [[f64; 2]; 2],
}

impl Factors {
    /// At the place y of the strip between a and H, for ε and the wavenumber q.
    pub(super) fn new(epsilon: f64, wavenumber: f64, [inner, outer]: [f64; 2], place: f64) -> Self {
        let (h, z, from_inner) = (outer - inner, outer - place, place - inner);
        let (soft, stiff, mixed) = (4.0 * epsilon, (1.0 - epsilon).powi(2), (1.0 - epsilon) * (1.0 + epsilon));
        let double = 2.0 * wavenumber;
        // G(z) = (1 − e^(−2qz))/(2q), and z itself.
        let [whole, here, beyond] = [h, z, from_inner].map(|t| Gap::integral(double, t));
        let [whole_length, length, rest] = [h, z, from_inner].map(|t| Gap::integral(0.0, t));
        let whole_fading = whole_length.times_power(double, h);
        let fading = length.times_power(double, z);
        let [one, power] = [Gap::power(0.0, z), Gap::power(double, z)];
        let both = |a: [Gap; 2], b: [Gap; 2]| soft * a[0].value() * a[1].value() + stiff * product_difference(a, b);

        let determinant = both([whole, whole], [whole_length, whole_fading]);
        let scale = RimDistance::new(wavenumber, place, inner).decay() / determinant;
        // z G(h) − h G(z), of either sign, from the distances to both ends.
        let across = product_difference([rest, here], [beyond.times_power(double, z), length]);
        let value = [
            [scale * both([whole, here], [whole_fading, length]), scale * mixed * across],
            [
                scale * mixed * product_difference([whole_fading, here], [whole, fading]),
                scale * both([whole, here], [whole_length, fading]),
            ],
        ];
        // s ∝ e^(qz) B(z), so s' = q s + e^(qz) B'. d ∝ e^(−qz) C(z), with C the bracket times e^(2qz).
        let slope = [
            [
                scale * both([whole, power], [whole_fading, one]),
                scale * mixed * product_difference([whole_length, power], [whole, one]),
            ],
            [
                scale * mixed * product_difference([whole_fading, one], [whole, power]),
                scale * both([whole, one], [whole_length, power]),
            ],
        ];
        let derivative = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let sign = if i == 0 { wavenumber } else { -wavenumber };
                slope[i][j] + sign * value[i][j]
            })
        });
        Factors { value, derivative }
    }
}
