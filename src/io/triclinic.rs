//! [`Triclinic`]: the box of a file, three edges in any direction, and the domain that it makes.
//!
//! The edges of a [`Domain`] are triangular: the first lies along x, the second in the plane of x and y. Edges that are
//! so in another order, or against an axis, describe the same packing and are taken in the right order. Otherwise short
//! edges of the same lattice are taken, and the packing is turned if these are not triangular either.

use crate::io::read_error::ReadError;
use crate::io::source::{AXES, Disk, Source};
use crate::packing::Domain;
use crate::vector::{Vector, difference, dot, norm};

/// Smallest component along its axis over the length of an edge: below it, edges do not span a box. Rounding changes
/// this share by 10⁻¹⁶.
const FLATTEST: f64 = 1e-10;

/// Largest number of rounds of a reduction; a few suffice.
const MOST_STEPS: usize = 1000;

/// The box of a file in three dimensions; that of a plane has a third edge along z.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Triclinic {
    pub corner: [f64; 3],
    pub edges: [[f64; 3]; 3],
}

/// Directions of the new axes, in the coordinates of the file; none if the packing is not turned.
pub(super) type Turn<const D: usize> = Option<[Vector<D>; D]>;

impl Triclinic {
    /// A box with edges along the axes.
    pub fn rectangular(corner: [f64; 3], lengths: [f64; 3]) -> Self {
        let edges = std::array::from_fn(|d| std::array::from_fn(|axis| if axis == d { lengths[d] } else { 0.0 }));
        Triclinic { corner, edges }
    }

    /// The point at a fraction of the box.
    pub fn point(&self, fraction: [f64; 3]) -> [f64; 3] {
        let along = |axis: usize| (0..3).map(|d| fraction[d] * self.edges[d][axis]).fold(0.0, |sum, part| sum + part);
        std::array::from_fn(|axis| self.corner[axis] + along(axis))
    }

    /// The domain, and the turn of the packing that it needs. `line` and `field` are for messages.
    pub fn domain<const D: usize>(
        &self,
        source: &Source,
        line: usize,
        field: &str,
    ) -> Result<(Domain<D>, Turn<D>), ReadError> {
        for (d, edge) in self.edges.iter().enumerate() {
            for (axis, component) in edge.iter().enumerate() {
                if (d < D) != (axis < D) && *component != 0.0 {
                    let field = format!("{field}, edge {} along {}", d + 1, AXES[axis]);
                    return Err(source.out_of_plane(line, &field, &component.to_string()));
                }
            }
        }
        let corner: Vector<D> = std::array::from_fn(|axis| self.corner[axis]);
        let given: [Vector<D>; D] = std::array::from_fn(|d| std::array::from_fn(|axis| self.edges[d][axis]));
        if let Some(edges) = in_order(&given) {
            for (d, edge) in edges.iter().enumerate() {
                for axis in 0..d {
                    source.check_corner(
                        line,
                        &format!("{field}, tilt of edge {}", d + 1),
                        edge[axis],
                        edges[axis][axis],
                    )?;
                }
            }
            return Ok((Domain::Periodic { corner, edges }, None));
        }
        let mut given = reduced(given);
        if let Some(edges) = in_order(&given) {
            return Ok((Domain::Periodic { corner, edges }, None));
        }
        let axes = directions(&mut given)
            .ok_or_else(|| source.bad(line, field, &format!("{:?}", self.edges), "edges that span a box"))?;
        let turned = |point: Vector<D>| -> Vector<D> { axes.map(|axis| dot(axis, point)) };
        let edges = std::array::from_fn(|d| {
            let edge = turned(given[d]);
            // The components beyond the diagonal are rounding.
            std::array::from_fn(|axis| if axis <= d { edge[axis] } else { 0.0 })
        });
        Ok((Domain::Periodic { corner: turned(corner), edges }, Some(axes)))
    }
}

/// Turns the disks of a file.
pub(super) fn turn<const D: usize>(axes: &Turn<D>, disks: &mut [Disk<D>]) {
    disks.iter_mut().for_each(|disk| disk.position = turned(axes, disk.position));
}

/// A vector of a file after the turn.
pub(super) fn turned<const D: usize>(axes: &Turn<D>, vector: Vector<D>) -> Vector<D> {
    axes.map_or(vector, |axes| axes.map(|axis| dot(axis, vector)))
}

/// The edges in the order and with the signs that make them triangular, if there is one. The lattice is the same.
fn in_order<const D: usize>(given: &[Vector<D>; D]) -> Option<[Vector<D>; D]> {
    let last = |edge: &Vector<D>| edge.iter().rposition(|&component| component != 0.0);
    let mut edges = *given;
    edges.sort_by_key(last);
    for (d, edge) in edges.iter_mut().enumerate() {
        if last(edge) != Some(d) {
            return None;
        }
        if edge[d] < 0.0 {
            *edge = edge.map(|component| if component == 0.0 { 0.0 } else { -component });
        }
    }
    Some(edges)
}

/// Short edges of the same lattice: no edge becomes shorter by a multiple of another. Then the box is wide in all
/// directions, however the file wrote it.
///
/// # Source
/// Lagrange's reduction of two vectors, for each pair: Cohen (1993), A Course in Computational Algebraic Number Theory,
/// section 1.3.
fn reduced<const D: usize>(mut edges: [Vector<D>; D]) -> [Vector<D>; D] {
    // Each step shortens an edge. Numbers that are too far apart end it early.
    for _ in 0..MOST_STEPS {
        let mut is_reduced = true;
        for (d, other) in (0..D).flat_map(|d| (0..D).map(move |other| (d, other))).filter(|(d, other)| d != other) {
            let boxes = (dot(edges[d], edges[other]) / dot(edges[other], edges[other])).round();
            let shorter = difference(edges[d], edges[other].map(|component| boxes * component));
            if norm(shorter) < (1.0 - FLATTEST) * norm(edges[d]) {
                (edges[d], is_reduced) = (shorter, false);
            }
        }
        if is_reduced {
            break;
        }
    }
    edges
}

/// Directions of the axes that make the edges triangular: the first edge lies along the first, and so on. The last edge
/// is reversed if the axes would be a mirror image otherwise.
fn directions<const D: usize>(given: &mut [Vector<D>; D]) -> Option<[Vector<D>; D]> {
    let mut axes = [[0.0; D]; D];
    for d in 0..D {
        let mut rest = given[d];
        // Twice: a second pass removes the rounding of the first.
        for earlier in axes[..d].iter().chain(&axes[..d]) {
            let along = dot(*earlier, rest);
            rest = difference(rest, earlier.map(|component| along * component));
        }
        let length = norm(rest);
        // False for NaN.
        let spans = length > FLATTEST * norm(given[d]);
        if !spans {
            return None;
        }
        axes[d] = rest.map(|component| component / length);
    }
    if determinant(&axes) < 0.0 {
        for vector in [&mut axes[D - 1], &mut given[D - 1]] {
            *vector = vector.map(|component| -component);
        }
    }
    Some(axes)
}

fn determinant<const D: usize>(rows: &[Vector<D>; D]) -> f64 {
    let minor = |a: usize, b: usize, p: usize, q: usize| rows[p][a] * rows[q][b] - rows[p][b] * rows[q][a];
    if D == 2 {
        return minor(0, 1, 0, 1);
    }
    rows[0][0] * minor(1, 2, 1, 2) - rows[0][1] * minor(0, 2, 1, 2) + rows[0][2] * minor(0, 1, 1, 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_order_of_edges_is_found_and_signs_are_mended() {
        assert_eq!(in_order(&[[0.0, 2.0], [3.0, 0.0]]), Some([[3.0, 0.0], [0.0, 2.0]]));
        assert_eq!(in_order(&[[-3.0, 0.0], [1.0, -2.0]]), Some([[3.0, 0.0], [-1.0, 2.0]]));
        assert_eq!(in_order(&[[3.0, 0.1], [0.0, 2.0]]), None);
    }

    #[test]
    fn axes_are_orthonormal_and_edges_become_triangular() {
        let mut given = [[3.0, 0.4, -0.2], [0.5, 2.0, 0.3], [-0.7, 0.1, 4.0]];
        let axes = directions(&mut given).expect("a box");
        for (d, axis) in axes.iter().enumerate() {
            for (other, second) in axes.iter().enumerate() {
                let one = if d == other { 1.0 } else { 0.0 };
                // Three products of numbers up to 1 and their rounding.
                assert!((dot(*axis, *second) - one).abs() < 4.0 * f64::EPSILON);
            }
            given[..d].iter().for_each(|edge| assert!(dot(*axis, *edge).abs() < 1e-15));
        }
        assert_eq!(directions(&mut [[1.0, 1.0], [2.0, 2.0]]), None);
    }

    #[test]
    fn a_left_handed_box_is_turned_and_not_mirrored() {
        for given in [[[1.0, 1.0], [3.0, -1.0]], [[1.0, 1.0], [-1.0, 3.0]]] {
            let mut edges = given;
            let axes = directions(&mut edges).expect("a box");
            assert!((determinant(&axes) - 1.0).abs() < 4.0 * f64::EPSILON, "{axes:?}");
            // The edge along its own axis stays positive.
            assert!(dot(axes[1], edges[1]) > 0.0);
        }
        let mirrored = [[0.0, 1.0, 1.0], [1.0, 0.0, 1.0], [3.0, -1.0, 0.0]];
        for mut edges in [mirrored, [mirrored[1], mirrored[0], mirrored[2]]] {
            let axes = directions(&mut edges).expect("a box");
            assert!((determinant(&axes) - 1.0).abs() < 8.0 * f64::EPSILON && dot(axes[2], edges[2]) > 0.0);
        }
    }

    #[test]
    fn a_poor_basis_becomes_a_short_one_of_the_same_lattice() {
        // Edges of a square lattice, twice its side and more.
        let square = reduced([[20.0, 10.0], [10.0, 10.0]]);
        assert_eq!(in_order(&square), Some([[10.0, 0.0], [0.0, 10.0]]));
        let long = reduced([[10.0, 200.0], [0.0, 10.0]]);
        assert_eq!(in_order(&long), Some([[10.0, 0.0], [0.0, 10.0]]));
        let cube = reduced([[7.0, 0.0, -14.0], [0.0, 7.0, 21.0], [35.0, 0.0, 7.0]]);
        assert!(determinant(&cube).abs() > 0.0 && cube.iter().all(|edge| norm(*edge) <= 28.0), "{cube:?}");
        let volume = determinant(&[[7.0, 0.0, -14.0], [0.0, 7.0, 21.0], [35.0, 0.0, 7.0]]);
        assert!((determinant(&cube).abs() / volume.abs() - 1.0).abs() < 1e-12);
    }
}
