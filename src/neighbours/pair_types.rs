//! Kinds of pairs of a mixture of few radii: two numbers a kind in place of two a pair, for lists that are read from memory.
//!
//! ```text
//! class c_i = 0, 1, 3 of each radius       kind of a pair c_i + c_j = 0, 1, 2, 3, 4, 6, another one for any two radii
//! ```

use crate::law::pair_law::PairLaw;
use crate::simd::table;

/// Numbers a table of kinds has room for.
pub const KINDS: usize = table::LENGTH;

/// Classes of the smallest radius, the next one and the largest.
const CLASSES: [u8; 3] = [0, 1, 3];

/// What the pairs of a kind have in common.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Kinds {
    /// R_i + R_j \[length\].
    pub reach: [f64; KINDS],
    /// Coefficient of the contact law \[force / length^(α−1)\].
    pub coefficient: [f64; KINDS],
    /// Whether lists are packed: never changes a bit.
    pub packs: bool,
}

impl Kinds {
    /// Distance of the anchors of a pair of a kind with this overlap there.
    #[inline(always)]
    pub fn distance(&self, kind: u8, overlap: f64) -> f64 {
        self.reach[usize::from(kind) % KINDS] - overlap
    }
}

/// The class of each disk, and what is known of the kinds of its pairs.
#[derive(Debug, Clone)]
pub(crate) struct Classes {
    pub of_disk: Vec<u8>,
    pub kinds: Kinds,
}

impl Classes {
    /// Those of disks of these radii under a law; none if they have more than three.
    pub fn of<L: PairLaw>(radii: &[f64], law: &L) -> Option<Self> {
        let mut distinct: Vec<f64> = Vec::with_capacity(CLASSES.len());
        for &radius in radii {
            if !distinct.contains(&radius) {
                if distinct.len() == CLASSES.len() {
                    return None;
                }
                distinct.push(radius);
            }
        }
        distinct.sort_by(f64::total_cmp);
        let class =
            |radius: f64| distinct.iter().zip(CLASSES).find(|&(&other, _)| other == radius).map(|(_, class)| class);
        let of_disk = radii.iter().filter_map(|&radius| class(radius)).collect();
        let smallest = *distinct.first()?;
        let mut kinds = Kinds {
            reach: [2.0 * smallest; KINDS],
            coefficient: [law.coefficient(smallest, smallest); KINDS],
            packs: table::is_quick(),
        };
        for (&one, a) in distinct.iter().zip(CLASSES) {
            for (&other, b) in distinct.iter().zip(CLASSES) {
                let kind = usize::from(a + b);
                (kinds.reach[kind], kinds.coefficient[kind]) = (one + other, law.coefficient(one, other));
            }
        }
        Some(Classes { of_disk, kinds })
    }

    /// The kind of a pair of disks.
    #[inline(always)]
    pub fn kind(&self, first: usize, second: usize) -> u8 {
        self.of_disk[first] + self.of_disk[second]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::pair_law::Hertzian;

    #[test]
    fn any_two_radii_have_a_kind_of_their_own_with_their_numbers() {
        let law = Hertzian::default();
        for radii in [vec![0.5], vec![0.5, 0.7], vec![0.7, 0.5, 0.83, 0.5]] {
            let classes = Classes::of(&radii, &law).expect("three radii at most");
            let mut radii_of = [None; KINDS];
            for (i, &one) in radii.iter().enumerate() {
                for (j, &other) in radii.iter().enumerate() {
                    let kind = usize::from(classes.kind(i, j));
                    assert_eq!(classes.kinds.reach[kind], one + other);
                    assert_eq!(classes.kinds.coefficient[kind], law.coefficient(one, other));
                    let both = if one < other { (one, other) } else { (other, one) };
                    assert_eq!(*radii_of[kind].get_or_insert(both), both, "kind {kind}");
                }
            }
        }
        assert!(Classes::of(&[0.5, 0.7, 0.83, 0.9], &law).is_none(), "ten kinds");
    }
}
