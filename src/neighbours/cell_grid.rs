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
            Domain::Periodic { corner, edges } => (*corner, std::array::from_fn(|d| edges[d][d])),
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
    ///
    /// In a tilted box the images above and below the brick are displaced along the other axes. The cells next to a
    /// cell are then up to four along such an axis.
    pub fn neighbourhood<const D: usize>(&self, cell: usize, edges: Option<[Vector<D>; D]>, runs: &mut Vec<Run<D>>) {
        let mut rest = cell;
        let index = std::array::from_fn(|d| {
            let index = rest % self.counts[d];
            rest /= self.counts[d];
            index
        });
        runs.clear();
        self.add_neighbours(D, index, edges.as_ref(), (0, [0.0; D]), runs);
    }

    /// Adds the neighbours of the cell at `index`. Their index along the axes from `axis` on is in `number`; the image
    /// chosen there has this shift.
    fn add_neighbours<const D: usize>(
        &self,
        axis: usize,
        index: [usize; D],
        edges: Option<&[Vector<D>; D]>,
        (number, shift): (usize, Vector<D>),
        runs: &mut Vec<Run<D>>,
    ) {
        let Some(axis) = axis.checked_sub(1) else {
            match runs.last_mut() {
                Some(run) if run.cells.end == number && run.shift == shift => run.cells.end += 1,
                _ => runs.push(Run { cells: number..number + 1, shift }),
            }
            return;
        };
        let count = self.counts[axis];
        let middle = index[axis] as f64 - shift[axis] * self.scale[axis];
        for place in (middle - 1.0).floor() as i64..=(middle + 1.0).ceil() as i64 {
            // Most cells are not at a side, which avoids the division.
            let is_inside = (0..count as i64).contains(&place);
            let (boxes, within) =
                if is_inside { (0, place) } else { (place.div_euclid(count as i64), place.rem_euclid(count as i64)) };
            let mut shift = shift;
            match edges {
                Some(edges) if !is_inside => {
                    (0..=axis).for_each(|along| shift[along] += boxes as f64 * edges[axis][along]);
                }
                None if !is_inside => continue,
                _ => {}
            }
            self.add_neighbours(axis, index, edges, (number * count + within as usize, shift), runs);
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
