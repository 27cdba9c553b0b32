//! Which pairs may touch: a cell grid, a list with a skin, and when the list must be made anew.
//!
//! The list holds every pair closer than `R_i + R_j + skin`, held–held pairs left out. It stays complete until some
//! disk has moved by half the skin. Each pair carries its separation at the anchors, so the box and its images are
//! looked at only while the list is built.

use crate::packing::{Domain, PackingError};
use crate::vector::{Vector, difference, dot, extended_norm, sum, two_sum};

/// Pairs that may touch, as parallel columns.
#[derive(Debug, Clone, Default)]
pub struct PairList<const D: usize> {
    /// First disk of each pair.
    pub first: Vec<u32>,
    /// Second disk of each pair.
    pub second: Vec<u32>,
    /// From the anchor of the second to that of the first along the nearest image, D \[length\].
    pub separation: Vec<Vector<D>>,
    /// Distance of the anchors, |D| \[length\].
    pub distance: Vec<f64>,
    /// Overlap at the anchors, R_i + R_j − |D|, rounded once only; negative for a pair apart \[length\].
    pub overlap: Vec<f64>,
    /// Coefficient of the contact law for this pair.
    pub coefficient: Vec<f64>,
}

impl<const D: usize> PairList<D> {
    /// Number of pairs.
    pub fn len(&self) -> usize {
        self.first.len()
    }

    /// Whether no pair may touch.
    pub fn is_empty(&self) -> bool {
        self.first.is_empty()
    }

    fn clear(&mut self) {
        self.first.clear();
        self.second.clear();
        self.separation.clear();
        self.distance.clear();
        self.overlap.clear();
        self.coefficient.clear();
    }
}

/// The disks as the list builder sees them: mobile ones first, then the held ones.
pub struct Disks<'a, const D: usize> {
    /// The domain.
    pub domain: &'a Domain<D>,
    /// Positions, rounded to one number a coordinate.
    pub anchors: &'a [Vector<D>],
    /// Centre minus position.
    pub displacements: &'a [Vector<D>],
    /// Radii.
    pub radii: &'a [f64],
    /// How many of them, from the front, are mobile.
    pub mobile_count: usize,
}

/// Cells no smaller than the range, and the disks in each, in ascending order.
struct CellGrid<const D: usize> {
    counts: [usize; D],
    cell_of: Vec<u32>,
    starts: Vec<u32>,
    members: Vec<u32>,
}

/// A run of cells along the first axis next to a cell, and the shift that brings its disks next to those of the cell.
struct Run<const D: usize> {
    cells: std::ops::Range<usize>,
    shift: Vector<D>,
}

impl<const D: usize> CellGrid<D> {
    fn new(domain: &Domain<D>, points: &[Vector<D>], range: f64) -> Self {
        let (corner, lengths) = match domain {
            Domain::Periodic { corner, lengths } => (*corner, *lengths),
            Domain::Open => bounding_box(points),
        };
        // No more cells than disks: an open plane with one disk far away must not ask for the memory of its box.
        let most = (points.len() as f64).powf(1.0 / D as f64).ceil().max(1.0);
        let counts: [usize; D] = std::array::from_fn(|d| (lengths[d] / range).floor().clamp(1.0, 4.0 * most) as usize);
        let cell_count: usize = counts.iter().product();
        let scale: Vector<D> = std::array::from_fn(|d| counts[d] as f64 / lengths[d]);
        let cell_of: Vec<u32> = points
            .iter()
            .map(|point| {
                let mut cell = 0;
                for d in (0..D).rev() {
                    cell =
                        cell * counts[d] + (((point[d] - corner[d]) * scale[d]).max(0.0) as usize).min(counts[d] - 1);
                }
                cell as u32
            })
            .collect();
        let mut starts = vec![0u32; cell_count + 1];
        for &cell in &cell_of {
            starts[cell as usize + 1] += 1;
        }
        for cell in 0..cell_count {
            starts[cell + 1] += starts[cell];
        }
        let mut next = starts.clone();
        let mut members = vec![0u32; points.len()];
        for (disk, &cell) in cell_of.iter().enumerate() {
            members[next[cell as usize] as usize] = disk as u32;
            next[cell as usize] += 1;
        }
        CellGrid { counts, cell_of, starts, members }
    }

    /// The cell and its neighbours as runs along the first axis, each cell once with each shift that can matter.
    fn neighbourhood(&self, cell: usize, lengths: Option<Vector<D>>, runs: &mut Vec<Run<D>>) {
        let mut index = [0usize; D];
        let mut rest = cell;
        for d in 0..D {
            index[d] = rest % self.counts[d];
            rest /= self.counts[d];
        }
        runs.clear();
        for code in 0..3usize.pow(D as u32) {
            let mut digits = code;
            let mut neighbour = 0;
            let mut stride = 1;
            let mut shift = [0.0; D];
            let mut inside = true;
            for d in 0..D {
                let step = digits % 3; // 0, 1, 2 for −1, 0, +1
                digits /= 3;
                let count = self.counts[d];
                let shifted = index[d] + step;
                let wraps = shifted == 0 || shifted > count;
                match lengths {
                    Some(lengths) if wraps => shift[d] = if shifted == 0 { -lengths[d] } else { lengths[d] },
                    None if wraps => inside = false,
                    _ => {}
                }
                neighbour += stride * ((shifted + count - 1) % count);
                stride *= count;
            }
            if !inside {
                continue;
            }
            match runs.last_mut() {
                Some(run) if run.cells.end == neighbour && run.shift == shift => run.cells.end += 1,
                _ => runs.push(Run { cells: neighbour..neighbour + 1, shift }),
            }
        }
    }
}

fn bounding_box<const D: usize>(points: &[Vector<D>]) -> (Vector<D>, Vector<D>) {
    let mut low = [f64::INFINITY; D];
    let mut high = [f64::NEG_INFINITY; D];
    for point in points {
        for d in 0..D {
            low[d] = low[d].min(point[d]);
            high[d] = high[d].max(point[d]);
        }
    }
    // A box of no extent (one disk, or all on a line) still needs a side to divide by.
    (low, std::array::from_fn(|d| (high[d] - low[d]).max(f64::MIN_POSITIVE)))
}

/// Order of the disks cell by cell in rows, mobile ones before held ones: neighbours in space are neighbours in memory.
pub fn spatial_order<const D: usize>(
    domain: &Domain<D>,
    points: &[Vector<D>],
    radii: &[f64],
    held: &[bool],
) -> Vec<u32> {
    let range = 2.0 * radii.iter().copied().fold(0.0, f64::max);
    let grid = CellGrid::new(domain, points, range);
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    order.sort_by_key(|&disk| (held[disk as usize], grid.cell_of[disk as usize]));
    order
}

/// Makes the list: every pair closer than reach + `skin`, ordered by the first disk.
///
/// # Errors
/// A box too small for one image a pair, or two disks with the same centre.
///
/// # Cost
/// Linear in the number of disks; about 25 steps of FIRE.
pub fn build_pairs<const D: usize>(
    disks: &Disks<'_, D>,
    skin: f64,
    coefficient: impl Fn(f64, f64) -> f64,
    pairs: &mut PairList<D>,
) -> Result<(), PackingError> {
    let largest = disks.radii.iter().copied().fold(0.0, f64::max);
    let lengths = disks.domain.lengths();
    if let Some(lengths) = lengths {
        // Two images of one disk are a side apart, so both can lie within the range only below this side.
        if let Some(axis) = lengths.iter().position(|&length| length < 4.0 * largest) {
            return Err(PackingError::BoxTooSmall { axis, length: lengths[axis], range: 2.0 * largest });
        }
    }
    let centres = disks.anchors.iter().zip(disks.displacements);
    let points: Vec<Vector<D>> = centres.map(|(&a, &u)| disks.domain.wrapped(sum(a, u))).collect();
    let grid = CellGrid::new(disks.domain, &points, 2.0 * largest + skin);
    // In the order of the cells, so that the disks of a run lie side by side.
    let sorted: Vec<(Vector<D>, f64)> =
        grid.members.iter().map(|&disk| (points[disk as usize], disks.radii[disk as usize])).collect();
    pairs.clear();
    let mut runs = Vec::new();
    let mut current = usize::MAX;
    for first in 0..disks.mobile_count {
        let cell = grid.cell_of[first] as usize;
        if cell != current {
            grid.neighbourhood(cell, lengths, &mut runs);
            current = cell;
        }
        let (point, radius) = (points[first], disks.radii[first]);
        for run in &runs {
            let from: Vector<D> = difference(point, run.shift);
            let (start, end) = (grid.starts[run.cells.start] as usize, grid.starts[run.cells.end] as usize);
            for (&second, &(other, other_radius)) in grid.members[start..end].iter().zip(&sorted[start..end]) {
                let range = radius + other_radius + skin;
                let apart = difference(from, other);
                // Rounding of the coordinates moves this edge by far less than the skin can spare.
                if dot(apart, apart) >= range * range || second as usize <= first {
                    continue;
                }
                let (separation, rest) = anchor_separation(disks, first, second as usize, apart);
                let (distance, distance_rest) = extended_norm(separation, rest);
                if distance == 0.0 {
                    return Err(PackingError::CoincidentCentres { first, second: second as usize });
                }
                let (gap, gap_rest) = two_sum(radius + other_radius, -distance);
                pairs.first.push(first as u32);
                pairs.second.push(second);
                pairs.separation.push(separation);
                pairs.distance.push(distance);
                pairs.overlap.push(gap + (gap_rest - distance_rest));
                pairs.coefficient.push(coefficient(radius, other_radius));
            }
        }
    }
    Ok(())
}

/// Separation of the anchors along the image that is nearest for the centres.
fn anchor_separation<const D: usize>(
    disks: &Disks<'_, D>,
    first: usize,
    second: usize,
    apart: Vector<D>,
) -> (Vector<D>, Vector<D>) {
    let zero = [0.0; D];
    let (anchors, rest) = disks.domain.separation_extended((disks.anchors[first], zero), (disks.anchors[second], zero));
    // Displacements within half a box keep the image; the caller re-anchors at every rebuild, so they are tiny here.
    debug_assert!({
        let moved = difference(disks.displacements[first], disks.displacements[second]);
        (0..D).all(|d| (anchors[d] + moved[d] - apart[d]).abs() < 1e-9 * (1.0 + apart[d].abs()))
    });
    (anchors, rest)
}
