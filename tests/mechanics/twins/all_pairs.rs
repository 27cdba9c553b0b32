//! The slow twin of cell grid, neighbour list and hot loop: every pair, every image, plain arithmetic.

use jamscope::law::PairLaw;
use jamscope::packing::{Domain, Packing};
use jamscope::vector::{Vector, norm};

/// A pair of disks near each other.
pub struct Pair<const D: usize> {
    pub first: usize,
    pub second: usize,
    /// From the second to the first.
    pub separation: Vector<D>,
    pub distance: f64,
    /// R_i + R_j − distance, of either sign.
    pub overlap: f64,
}

/// The images of a separation shifted along one edge, so that it is within two sides along the axis of that edge.
fn images<const D: usize>(
    apart: Vector<D>,
    (d, edge): (usize, &Vector<D>),
) -> impl Iterator<Item = Vector<D>> + use<'_, D> {
    let nearest = -(apart[d] / edge[d]).round() as i32;
    (nearest - 2..=nearest + 2)
        .map(move |boxes| std::array::from_fn(|axis| apart[axis] + f64::from(boxes) * edge[axis]))
}

/// All pairs, held–held ones left out, with a gap below `gap`; first < second.
pub fn pairs_within<const D: usize>(packing: &Packing<D>, gap: f64) -> Vec<Pair<D>> {
    let (positions, radii, held) = (packing.positions(), packing.radii(), packing.held());
    let mut pairs = Vec::new();
    for first in 0..packing.len() {
        for second in first + 1..packing.len() {
            if held[first] && held[second] {
                continue;
            }
            let mut separations = vec![std::array::from_fn(|d| positions[first][d] - positions[second][d])];
            if let Domain::Periodic { edges, .. } = packing.domain() {
                for edge in edges.iter().enumerate().rev() {
                    separations = separations.into_iter().flat_map(|apart| images(apart, edge)).collect();
                }
            }
            for separation in separations {
                let distance = norm(separation);
                let overlap = radii[first] + radii[second] - distance;
                if overlap > -gap {
                    pairs.push(Pair { first, second, separation, distance, overlap });
                }
            }
        }
    }
    pairs
}

/// Energy, virial and forces, one contact after the other.
pub struct Mechanics<const D: usize> {
    pub energy: f64,
    pub virial: [[f64; D]; D],
    pub contact_count: usize,
    pub force_sum: f64,
    pub forces: Vec<Vector<D>>,
}

/// The plainest evaluation of a packing under a law.
pub fn mechanics<const D: usize>(packing: &Packing<D>, law: &dyn PairLaw) -> Mechanics<D> {
    let mut total = Mechanics {
        energy: 0.0,
        virial: [[0.0; D]; D],
        contact_count: 0,
        force_sum: 0.0,
        forces: vec![[0.0; D]; packing.len()],
    };
    for pair in pairs_within(packing, 0.0) {
        let (a, b) = (packing.radii()[pair.first], packing.radii()[pair.second]);
        let force = law.force(law.coefficient(a, b), pair.overlap);
        total.energy += law.energy(force, pair.overlap);
        total.contact_count += 1;
        total.force_sum += force;
        for d in 0..D {
            let part = force * pair.separation[d] / pair.distance;
            total.forces[pair.first][d] += part;
            total.forces[pair.second][d] -= part;
            for e in 0..D {
                total.virial[d][e] += part * pair.separation[e];
            }
        }
    }
    total
}
