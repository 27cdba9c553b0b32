//! A packing and its twin that lies elsewhere, with its disks in reverse order.

use jamscope::packing::Packing;
use jamscope::vector::{Vector, difference, larger, norm, sum};

/// Where the twin lies: by a quarter turn, which rounds nothing, and an offset along both axes.
#[derive(Debug, Clone, Copy)]
pub struct Elsewhere {
    /// Whether it is turned.
    pub turned: bool,
    /// How far it is moved, a multiple of 2¹⁰.
    pub offset: f64,
}

impl Elsewhere {
    /// The twin.
    pub fn twin(&self, packing: &Packing<2>) -> Packing<2> {
        let count = packing.len();
        let reverse = |disk: usize| count - 1 - disk;
        // Centres are unevaluated sums: what the shift rounds off goes into the corrections.
        let split = |x: f64| {
            let high = x + self.offset;
            (high, x - (high - self.offset))
        };
        let places: Vec<(Vector<2>, Vector<2>)> = (0..count)
            .map(|disk| packing.centre(reverse(disk)))
            .map(|(x, rest)| (self.turn(x), self.turn(rest)))
            .collect();
        let positions = places.iter().map(|(x, _)| x.map(|x| split(x).0)).collect();
        let corrections = places.iter().map(|(x, rest)| sum(x.map(|x| split(x).1), *rest)).collect();
        let radii = (0..count).map(|disk| packing.radii()[reverse(disk)]).collect();
        Packing::new(*packing.domain(), positions, radii)
            .and_then(|twin| twin.with_corrections(corrections))
            .and_then(|twin| twin.with_held((0..count).map(|disk| packing.held()[reverse(disk)]).collect()))
            .expect("valid")
    }

    /// Largest distance of a disk that counts between a packing and a twin, seen from one place.
    pub fn apart(&self, one: &Packing<2>, twin: &Packing<2>, counts: &[bool]) -> f64 {
        let way = |disk: usize| {
            let ((a, a_rest), (b, b_rest)) = (one.centre(disk), twin.centre(one.len() - 1 - disk));
            let high = difference(self.turn(a), b.map(|x| x - self.offset));
            norm(sum(high, difference(self.turn(a_rest), b_rest)))
        };
        (0..one.len()).filter(|&disk| counts[disk]).map(way).fold(0.0, larger)
    }

    fn turn(&self, x: Vector<2>) -> Vector<2> {
        if self.turned { [-x[1], x[0]] } else { x }
    }
}
