//! Cell grid: cells of equal size, and the disks in each.

use std::ops::Range;

use crate::packing::Domain;
use crate::parallel::{self, PIECE};
use crate::vector::Vector;

/// Cells no smaller than the range of the list, and the disks in each cell in ascending order.
#[derive(Debug, Clone, Default)]
pub(crate) struct CellGrid {
    /// Number of cells along each axis.
    counts: Vec<usize>,
    /// Lower corner of the first cell, and number of cells per length, along each axis.
    corner: Vec<f64>,
    scale: Vec<f64>,
    pub cell_of: Vec<u32>,
    pub starts: Vec<u32>,
    pub members: Vec<u32>,
}

/// Neighbouring cells that are consecutive along the first axis, and the shift that maps their disks next to the cell.
#[derive(Debug, Clone)]
pub(crate) struct Run<const D: usize> {
    pub cells: Range<usize>,
    pub shift: Vector<D>,
}

impl CellGrid {
    /// Sorts the points into cells. The previous content is overwritten; its memory is reused.
    pub fn fill<const D: usize>(&mut self, domain: &Domain<D>, points: &[Vector<D>], range: f64) {
        let (corner, lengths) = match domain {
            Domain::Periodic { corner, lengths } => (*corner, *lengths),
            Domain::Open => bounding_box(points),
        };
        // The cell count is bounded by the disk count, so one distant disk in an open plane does not exhaust the
        // memory.
        let most = libm::pow(points.len() as f64, 1.0 / D as f64).ceil().max(1.0);
        let counts: [usize; D] = std::array::from_fn(|d| (lengths[d] / range).floor().clamp(1.0, 4.0 * most) as usize);
        let cell_count: usize = counts.iter().product();
        let scale: Vector<D> = std::array::from_fn(|d| counts[d] as f64 / lengths[d]);
        for (column, values) in [(&mut self.corner, &corner), (&mut self.scale, &scale)] {
            column.clear();
            column.extend_from_slice(values);
        }
        self.counts.clear();
        self.counts.extend_from_slice(&counts);
        self.cell_of.resize(points.len(), 0);
        parallel::each(self.cell_of.chunks_mut(PIECE).zip(points.chunks(PIECE)), |(cells, points)| {
            for (cell_of, &point) in cells.iter_mut().zip(points) {
                *cell_of = cell_at(point, (corner, scale, counts)) as u32;
            }
        });
        // The counts are stored one cell further on. Filling a cell then moves its start to the right place.
        self.starts.clear();
        self.starts.resize(cell_count + 2, 0);
        for &cell in &self.cell_of {
            self.starts[cell as usize + 2] += 1;
        }
        for cell in 0..=cell_count {
            self.starts[cell + 1] += self.starts[cell];
        }
        self.members.clear();
        self.members.resize(points.len(), 0);
        for (disk, &cell) in self.cell_of.iter().enumerate() {
            let next = &mut self.starts[cell as usize + 1];
            self.members[*next as usize] = disk as u32;
            *next += 1;
        }
    }

    /// The cell of a point of the domain.
    pub fn cell_at<const D: usize>(&self, point: Vector<D>) -> usize {
        let [corner, scale] = [&self.corner, &self.scale].map(|column| std::array::from_fn(|d| column[d]));
        cell_at(point, (corner, scale, std::array::from_fn(|d| self.counts[d])))
    }

    /// The last disk of a cell.
    pub fn last_of(&self, cell: usize) -> Option<usize> {
        let (start, end) = (self.starts[cell] as usize, self.starts[cell + 1] as usize);
        self.members[start..end].last().map(|&disk| disk as usize)
    }

    /// The cell and its neighbours as runs along the first axis. Each cell occurs once for each shift that can matter.
    pub fn neighbourhood<const D: usize>(&self, cell: usize, lengths: Option<Vector<D>>, runs: &mut Vec<Run<D>>) {
        // The cell before, the cell itself and the cell after along each axis: start index and shift.
        let mut sides = [[None; 3]; D];
        let (mut rest, mut stride) = (cell, 1);
        for d in 0..D {
            let count = self.counts[d];
            let index = rest % count;
            rest /= count;
            let wrapped = |to: usize, shift: f64| lengths.map(|lengths| (stride * to, shift * lengths[d]));
            sides[d] = [
                if index > 0 { Some((stride * (index - 1), 0.0)) } else { wrapped(count - 1, -1.0) },
                Some((stride * index, 0.0)),
                if index + 1 < count { Some((stride * (index + 1), 0.0)) } else { wrapped(0, 1.0) },
            ];
            stride *= count;
        }
        runs.clear();
        for code in 0..3usize.pow(D as u32) {
            let mut digits = code;
            let (mut neighbour, mut shift, mut inside) = (0, [0.0; D], true);
            for d in 0..D {
                match sides[d][digits % 3] {
                    Some((start, offset)) => {
                        neighbour += start;
                        shift[d] = offset;
                    }
                    None => inside = false,
                }
                digits /= 3;
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

/// The cell of a point; for a point outside the grid, the nearest cell.
#[inline(always)]
fn cell_at<const D: usize>(point: Vector<D>, (corner, scale, counts): (Vector<D>, Vector<D>, [usize; D])) -> usize {
    let mut cell = 0;
    for d in (0..D).rev() {
        let index = ((point[d] - corner[d]) * scale[d]).max(0.0) as usize;
        cell = cell * counts[d] + index.min(counts[d] - 1);
    }
    cell
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
    // A box without extent (one disk, or all disks on a line) still needs a positive side length.
    (low, std::array::from_fn(|d| (high[d] - low[d]).max(f64::MIN_POSITIVE)))
}
