//! [`Digits`]: whether the coordinates of a packing were written with few decimal digits.
//!
//! The shortest decimal that reproduces a number equals the text it was read from, if that had at most 15 digits. A
//! computed number needs 15 to 17 digits. So rounded coordinates are distinguished reliably from full ones. Scaled
//! coordinates are recognised by their fraction of the box.

use serde::Serialize;

use crate::law::pair_law::PairLaw;
use crate::network::ContactNetwork;
use crate::packing::{Domain, Packing};
use crate::vector::{larger, norm};

/// Coordinates with more digits do not count as rounded: `%.8f`, the format of ASE, has 12 digits in a box of 9999.
const MOST: usize = 12;

/// Digits of a number in full precision.
const FULL: usize = 17;

/// The number of digits with which coordinates were written.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Digits {
    /// Significant digits of most coordinates.
    pub significant: usize,
    /// Largest spacing of the last digit \[length\].
    pub spacing: f64,
}

/// Significant digits of one coordinate, and the place value of the last \[length\].
#[derive(Debug, Clone, Copy, PartialEq)]
struct Decimal {
    digits: usize,
    place: f64,
}

impl Digits {
    /// The digits of a packing; none if its coordinates have full precision, or if there are no coordinates.
    pub fn of<const D: usize>(packing: &Packing<D>) -> Option<Self> {
        let mut all: Vec<Decimal> = Vec::new();
        for disk in 0..packing.len() {
            let (position, correction) = packing.centre(disk);
            for axis in (0..D).filter(|&axis| position[axis] != 0.0) {
                all.push(if correction[axis] == 0.0 {
                    decimal(packing.domain(), position[axis], axis)
                } else {
                    Decimal { digits: FULL, place: 0.0 }
                });
            }
        }
        let middle = all.len() / 2;
        if all.is_empty() {
            return None;
        }
        all.sort_unstable_by_key(|it| it.digits);
        let significant = all[middle].digits;
        // Trailing zeros are not written, so shorter numbers are known more precisely than their last digit suggests.
        // Longer numbers, after a shift by a side of the box, have a finer spacing.
        let spacing = all.iter().filter(|it| it.digits >= significant).fold(0.0, |most, it| larger(it.place, most));
        (significant <= MOST).then_some(Digits { significant, spacing })
    }

    /// Upper bound of the relative residual of a state at rest whose coordinates are rounded to these digits \[1\].
    ///
    /// ```text
    /// max_i Σ_j [F(δ_ij + e) − F(δ_ij)] / ⟨F⟩        e = √D times the spacing, the largest change of a distance
    /// ```
    ///
    /// Forces grow faster than overlaps, so no change by at most e changes a force by more. None if the disks cannot
    /// grow by e.
    pub fn residual_bound<const D: usize>(
        &self,
        packing: &Packing<D>,
        network: &ContactNetwork<D>,
        law: &dyn PairLaw,
    ) -> Option<f64> {
        let change = (D as f64).sqrt() * self.spacing;
        let mut grown = packing.clone();
        for disk in 0..packing.len() {
            grown = grown.with_radius(disk, packing.radii()[disk] + 0.5 * change).ok()?;
        }
        let mut rows = vec![0.0; packing.len()];
        for contact in &ContactNetwork::new(&grown, law).ok()?.contacts {
            let ends = [contact.first as usize, contact.second as usize];
            let [first, second] = ends.map(|disk| packing.radii()[disk]);
            let overlap = first + second - norm(contact.separation);
            let coefficient = law.coefficient(first, second);
            let force = |overlap: f64| if overlap > 0.0 { law.force(coefficient, overlap) } else { 0.0 };
            let more = force(overlap + change) - force(overlap);
            ends.into_iter().for_each(|disk| rows[disk] += more);
        }
        let mobile = rows.iter().zip(packing.held()).filter(|(_, held)| !**held);
        let most = mobile.fold(0.0, |most, (&row, _)| larger(row, most));
        Some(most / network.mean_contact_force())
    }
}

/// The decimal of a coordinate, or of its fraction of the box if that is shorter and reproduces the coordinate exactly.
fn decimal<const D: usize>(domain: &Domain<D>, value: f64, axis: usize) -> Decimal {
    let plain = shortest(value);
    let Domain::Periodic { corner, edges } = domain else { return plain };
    let (start, side) = (corner[axis], edges[axis][axis]);
    let scaled = (1..plain.digits.min(MOST + 1)).find_map(|digits| {
        let text = format!("{:.*e}", digits - 1, (value - start) / side);
        let share: f64 = text.parse().ok()?;
        (start + share * side == value).then(|| shortest(share))
    });
    scaled.map_or(plain, |it| Decimal { place: it.place * side, ..it })
}

/// The shortest decimal that reproduces `value`.
fn shortest(value: f64) -> Decimal {
    let text = format!("{:e}", value.abs());
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let digits = mantissa.bytes().filter(u8::is_ascii_digit).count();
    let exponent: i32 = exponent.parse().unwrap_or(0);
    Decimal { digits, place: libm::pow(10.0, f64::from(exponent) - (digits as f64 - 1.0)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn packing(values: [f64; 6]) -> Packing<2> {
        let positions = values.chunks(2).map(|pair| [pair[0], pair[1]]).collect();
        let domain = Domain::rectangular([-1.0, 0.1], [37.1, 41.3]);
        Packing::new(domain, positions, vec![0.5; 3]).expect("valid")
    }

    #[test]
    fn the_digits_of_a_text_are_those_of_the_number() {
        let cut = Digits::of(&packing([3.84989, 18.3665, 20.9528, 1.36484, 5.5, 33.489])).expect("cut");
        assert_eq!(cut.significant, 6);
        // 18.3665 is known to 10⁻⁴; 33.489 has lost its last zero. `pow` is exact to one unit in the last place.
        assert!((cut.spacing / 1e-4 - 1.0).abs() < 1e-15, "{}", cut.spacing);
        let third = 1.0 / 3.0;
        assert_eq!(Digits::of(&packing([third, 10.0 * third, 20.0 * third, 7.1 * third, 3.1 * third, 5.5])), None);
    }

    #[test]
    fn scaled_coordinates_are_told_by_their_share_of_the_box() {
        let shares = [0.103777, 0.444715, 0.564803, 0.0330476, 0.150664, 0.810866];
        let value = |axis: usize, share: f64| [-1.0, 0.1][axis] + share * [37.1, 41.3][axis];
        let values = std::array::from_fn(|place| value(place % 2, shares[place]));
        let cut = Digits::of(&packing(values)).expect("cut");
        assert_eq!(cut.significant, 6);
        assert!((cut.spacing / 41.3e-6 - 1.0).abs() < 1e-14, "{}", cut.spacing);
    }

    #[test]
    fn a_correction_makes_a_coordinate_full() {
        let corrected =
            packing([1.5, 2.5, 5.5, 6.5, 10.5, 11.5]).with_corrections(vec![[1e-17, -1e-17]; 3]).expect("valid");
        assert_eq!(Digits::of(&corrected), None);
    }
}
