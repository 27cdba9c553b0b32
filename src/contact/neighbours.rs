//! Which pairs may touch: a cell grid, a list with a skin, and when the list must be made anew.
//!
//! The list holds every pair closer than `R_i + R_j + skin`, held–held pairs left out. It stays complete until some
//! disk has moved by half the skin. Each pair carries its separation at the anchors, so the box and its images are
//! looked at only while the list is built.

use crate::contact::amended::{Lacking, without};
use crate::contact::kinds::Classes;
use crate::contact::measured::Measured;
use crate::contact::pair_list::{BLOCK, PairList, Search, Source};
use crate::packing::{Domain, PackingError};
use crate::side_by_side::{self, PIECE};
use crate::vector::{Vector, difference, dot, extended_norm, extended_sum, sum, two_sum};

/// The disks as the list builder sees them: mobile ones first, then the held ones.
pub struct Disks<'a, const D: usize> {
    /// The domain.
    pub domain: &'a Domain<D>,
    /// Positions, rounded to one number a coordinate \[length\].
    pub anchors: &'a [Vector<D>],
    /// Centre minus position \[length\].
    pub displacements: &'a [Vector<D>],
    /// Radii \[length\].
    pub radii: &'a [f64],
    /// How many of them, from the front, are mobile.
    pub mobile_count: usize,
    /// Their classes, if pairs are to be packed.
    pub(super) classes: Option<&'a Classes>,
}

/// Cells no smaller than the range, and the disks in each, in ascending order.
#[derive(Debug, Clone, Default)]
struct CellGrid {
    /// Cells along each axis.
    counts: Vec<usize>,
    /// Where the first cell begins, and cells a length, along each axis.
    corner: Vec<f64>,
    scale: Vec<f64>,
    cell_of: Vec<u32>,
    starts: Vec<u32>,
    members: Vec<u32>,
}

/// A run of cells along the first axis next to a cell, and the shift that brings its disks next to those of the cell.
#[derive(Debug, Clone)]
struct Run<const D: usize> {
    cells: std::ops::Range<usize>,
    shift: Vector<D>,
}

impl CellGrid {
    /// Sorts the points into cells; whatever the grid held is overwritten, its room used again.
    fn fill<const D: usize>(&mut self, domain: &Domain<D>, points: &[Vector<D>], range: f64) {
        let (corner, lengths) = match domain {
            Domain::Periodic { corner, lengths } => (*corner, *lengths),
            Domain::Open => bounding_box(points),
        };
        // No more cells than disks: an open plane with one disk far away must not ask for the memory of its box.
        let most = (points.len() as f64).powf(1.0 / D as f64).ceil().max(1.0);
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
        side_by_side::each(self.cell_of.chunks_mut(PIECE).zip(points.chunks(PIECE)), |(cells, points)| {
            for (cell_of, &point) in cells.iter_mut().zip(points) {
                *cell_of = cell_at(point, (corner, scale, counts)) as u32;
            }
        });
        // Counted one cell further on, so that filling a cell moves its start to where it belongs.
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
    fn cell_at<const D: usize>(&self, point: Vector<D>) -> usize {
        let [corner, scale] = [&self.corner, &self.scale].map(|column| std::array::from_fn(|d| column[d]));
        cell_at(point, (corner, scale, std::array::from_fn(|d| self.counts[d])))
    }

    /// The last of the disks of a cell.
    fn last_of(&self, cell: usize) -> Option<usize> {
        let (start, end) = (self.starts[cell] as usize, self.starts[cell + 1] as usize);
        self.members[start..end].last().map(|&disk| disk as usize)
    }

    /// The cell and its neighbours as runs along the first axis, each cell once with each shift that can matter.
    fn neighbourhood<const D: usize>(&self, cell: usize, lengths: Option<Vector<D>>, runs: &mut Vec<Run<D>>) {
        // Along each axis the cell before, the cell and the cell after: where they begin, and their shift.
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
                    Some((start, way)) => {
                        neighbour += start;
                        shift[d] = way;
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

/// The cell of a point, or the nearest one.
#[inline(always)]
fn cell_at<const D: usize>(point: Vector<D>, (corner, scale, counts): (Vector<D>, Vector<D>, [usize; D])) -> usize {
    let mut cell = 0;
    for d in (0..D).rev() {
        let index = ((point[d] - corner[d]) * scale[d]).max(0.0) as usize;
        cell = cell * counts[d] + index.min(counts[d] - 1);
    }
    cell
}

/// Room for making a list, kept between two: only the first one asks for memory.
#[derive(Debug, Clone, Default)]
pub struct ListRoom<const D: usize> {
    grid: CellGrid,
    points: Vec<Vector<D>>,
    /// Centres and radii in the order of the cells, so that the disks of a run lie side by side.
    sorted: Vec<(Vector<D>, f64)>,
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
    let mut grid = CellGrid::default();
    grid.fill(domain, points, range);
    let (held, mobile): (Vec<u32>, Vec<u32>) = grid.members.iter().partition(|&&disk| held[disk as usize]);
    [mobile, held].concat()
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
    coefficient: impl Fn(f64, f64) -> f64 + Sync,
    room: &mut ListRoom<D>,
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
    let ListRoom { grid, points, sorted } = room;
    points.resize(disks.anchors.len(), [0.0; D]);
    let centres = disks.anchors.chunks(PIECE).zip(disks.displacements.chunks(PIECE));
    side_by_side::each(points.chunks_mut(PIECE).zip(centres), |(points, (anchors, displacements))| {
        for ((point, &anchor), &displacement) in points.iter_mut().zip(anchors).zip(displacements) {
            *point = disks.domain.wrapped(sum(anchor, displacement));
        }
    });
    grid.fill(disks.domain, points, 2.0 * largest + skin);
    sorted.resize(points.len(), ([0.0; D], 0.0));
    side_by_side::each(sorted.chunks_mut(PIECE).zip(grid.members.chunks(PIECE)), |(sorted, members)| {
        for (place, &disk) in sorted.iter_mut().zip(members) {
            *place = (points[disk as usize], disks.radii[disk as usize]);
        }
    });
    let (grid, points, sorted) = (&*grid, &*points, &*sorted);
    let nearby = Nearby { disks, skin, lengths, grid, points, sorted };
    let (counts, keeps_places) = ((points.len(), disks.mobile_count), PairList::<D>::keeps_places(points.len()));
    pairs.fill(counts, keeps_places, disks.classes.map(|classes| classes.kinds), || TileSearch {
        nearby,
        cell: usize::MAX,
        runs: Vec::new(),
        anchored: Anchored::new(disks, &coefficient),
    })
}

/// Adds the pairs that a list made by [`build_pairs`] lacks now that some disks were listed anew. Nothing is done, and false
/// returned, where there are not places enough.
///
/// # Shape
/// `listed` tells where each disk was listed last, from its anchor: `roaming` are the disks that were listed anew since the list was made,
/// those marked among them just now.
pub(super) fn amend_pairs<const D: usize>(
    (disks, listed): (&Disks<'_, D>, &[Vector<D>]),
    (roaming, marked): (&[u32], &[bool]),
    skin: f64,
    coefficient: impl Fn(f64, f64) -> f64 + Sync,
    room: &ListRoom<D>,
    pairs: &mut PairList<D>,
) -> bool {
    let lengths = disks.domain.lengths();
    let at = |disk: u32| sum(disks.anchors[disk as usize], listed[disk as usize]);
    let (mut lacking, mut runs) = (Vec::new(), Vec::new());
    for &disk in roaming.iter().filter(|&&disk| marked[disk as usize]) {
        let point = at(disk);
        let reach = disks.radii[disk as usize] + skin;
        let mut offer = |other: u32| {
            let mut apart = difference(point, at(other));
            if let Some(lengths) = lengths {
                for d in 0..D {
                    // Most are near as they are.
                    if 2.0 * apart[d].abs() > lengths[d] {
                        apart[d] -= (apart[d] / lengths[d]).round_ties_even() * lengths[d];
                    }
                }
            }
            let range = reach + disks.radii[other as usize];
            let (first, second) = (disk.min(other), disk.max(other));
            if disk != other && dot(apart, apart) < range * range && (first as usize) < disks.mobile_count {
                lacking.push(Lacking { first, second, name: second });
            }
        };
        // Others are in the cells they were in; those that were listed anew are not, and are looked at one by one.
        let cell = room.grid.cell_at(disks.domain.wrapped(point));
        room.grid.neighbourhood(cell, lengths, &mut runs);
        for Run { cells, .. } in &runs {
            let (start, end) = (room.grid.starts[cells.start] as usize, room.grid.starts[cells.end] as usize);
            room.grid.members[start..end].iter().for_each(|&other| offer(other));
        }
        roaming.iter().for_each(|&other| offer(other));
    }
    without(&mut lacking, &mut pairs.pairs_of(marked));
    pairs.amend(&lacking, &mut Anchored::new(disks, &coefficient))
}

/// What every tile is searched in.
#[derive(Clone, Copy)]
struct Nearby<'a, const D: usize> {
    disks: &'a Disks<'a, D>,
    skin: f64,
    lengths: Option<Vector<D>>,
    grid: &'a CellGrid,
    points: &'a [Vector<D>],
    sorted: &'a [(Vector<D>, f64)],
}

/// The search of one tile: the cell of the last disk looked at, and the cells around it.
struct TileSearch<'a, const D: usize, C> {
    nearby: Nearby<'a, D>,
    cell: usize,
    runs: Vec<Run<D>>,
    anchored: Anchored<'a, D, C>,
}

/// Pairs of disks as they are at their anchors.
struct Anchored<'a, const D: usize, C> {
    disks: &'a Disks<'a, D>,
    coefficient: &'a C,
    ends: Ends<D>,
}

impl<'a, const D: usize, C> Anchored<'a, D, C> {
    fn new(disks: &'a Disks<'a, D>, coefficient: &'a C) -> Self {
        let ends = Ends { anchors: [([1.0; D], [0.0; D]); BLOCK], radii: [(1.0, 1.0); BLOCK] };
        Anchored { disks, coefficient, ends }
    }
}

impl<const D: usize, C: Fn(f64, f64) -> f64> Search<D> for TileSearch<'_, D, C> {
    fn find(&mut self, first: usize, seconds: &mut Vec<u32>) {
        let Nearby { disks, skin, lengths, grid, points, sorted, .. } = self.nearby;
        let cell = grid.cell_of[first] as usize;
        if cell != self.cell {
            grid.neighbourhood(cell, lengths, &mut self.runs);
            self.cell = cell;
        }
        let (point, radius) = (points[first], disks.radii[first]);
        for run in &self.runs {
            let from: Vector<D> = difference(point, run.shift);
            let mut cells = run.cells.clone();
            // The disks of a cell are in ascending order: a cell with none after the first disk has no second one.
            while cells.start < cells.end && grid.last_of(cells.start).is_none_or(|last| last <= first) {
                cells.start += 1;
            }
            let (start, end) = (grid.starts[cells.start] as usize, grid.starts[cells.end] as usize);
            // Which of the disks of a run are near cannot be guessed: they are picked without a branch.
            let mut count = seconds.len();
            seconds.resize(count + end - start, 0);
            for (&second, &(other, other_radius)) in grid.members[start..end].iter().zip(&sorted[start..end]) {
                let range = radius + other_radius + skin;
                let apart = difference(from, other);
                seconds[count] = second;
                // Rounding of the coordinates moves this edge by far less than the skin can spare. NaN counts as near.
                let far = dot(apart, apart) >= range * range;
                count += usize::from((second as usize > first) & !far);
            }
            seconds.truncate(count);
        }
    }
}

impl<const D: usize, C: Fn(f64, f64) -> f64> Source<D> for TileSearch<'_, D, C> {
    fn second(&self, pair: u32) -> u32 {
        self.anchored.second(pair)
    }

    fn kind(&self, first: u32, pair: u32) -> u8 {
        self.anchored.kind(first, pair)
    }

    fn measure(&mut self, first: &[u32], second: &[u32], measured: &mut Measured<D>) {
        self.anchored.measure(first, second, measured);
    }
}

impl<const D: usize, C: Fn(f64, f64) -> f64> Source<D> for Anchored<'_, D, C> {
    /// A pair of a disk bears the number of the other one.
    fn second(&self, pair: u32) -> u32 {
        pair
    }

    fn kind(&self, first: u32, pair: u32) -> u8 {
        self.disks.classes.map_or(0, |classes| classes.kind(first as usize, pair as usize))
    }

    fn measure(&mut self, first: &[u32], second: &[u32], measured: &mut Measured<D>) {
        let Anchored { disks, coefficient, ends } = self;
        let lengths = disks.domain.lengths();
        for (place, (&first, &second)) in first.iter().zip(second).enumerate() {
            let (first, second) = (first as usize, second as usize);
            ends.anchors[place] = (disks.anchors[first], disks.anchors[second]);
            ends.radii[place] = (disks.radii[first], disks.radii[second]);
        }
        pulp::Arch::new().dispatch(Measure { ends, lengths, coefficient, measured });
        if let Some(classes) = disks.classes {
            // The numbers of a packed list, whether it is packed or not.
            for (place, (&first, &second)) in first.iter().zip(second).enumerate() {
                let kind = classes.kind(first as usize, second as usize);
                measured.distance[place] = classes.kinds.distance(kind, measured.overlap[place]);
            }
        }
    }
}

/// Anchors and radii of both disks of the pairs of a block; as long as one whatever it holds, so that no pair is left over for
/// a loop without vectors.
struct Ends<const D: usize> {
    anchors: [(Vector<D>, Vector<D>); BLOCK],
    radii: [(f64, f64); BLOCK],
}

/// Separations, distances and overlaps of a block to full accuracy, some eighty operations a pair, in vectors.
struct Measure<'a, const D: usize, C> {
    ends: &'a Ends<D>,
    /// Sides of a periodic box.
    lengths: Option<Vector<D>>,
    coefficient: &'a C,
    measured: &'a mut Measured<D>,
}

impl<const D: usize, C: Fn(f64, f64) -> f64> pulp::WithSimd for Measure<'_, D, C> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _simd: S) {
        let Measure { ends: Ends { anchors, radii }, lengths, coefficient, measured } = self;
        let Measured { separation, distance, overlap, coefficient: coefficients } = measured;
        for k in 0..BLOCK {
            coefficients[k] = coefficient(radii[k].0, radii[k].1);
        }
        let mut rest = [[0.0; BLOCK]; D];
        for k in 0..BLOCK {
            for d in 0..D {
                (separation[d][k], rest[d][k]) = two_sum(anchors[k].0[d], -anchors[k].1[d]);
            }
        }
        if let Some(lengths) = lengths {
            // Displacements within half a box keep the image; the caller re-anchors at every rebuild, so they are tiny here.
            for k in 0..BLOCK {
                for d in 0..D {
                    // The image is nowhere near halfway: pairs are closer than half a side.
                    let shift = -(separation[d][k] / lengths[d]).round_ties_even() * lengths[d];
                    (separation[d][k], rest[d][k]) = extended_sum((separation[d][k], rest[d][k]), shift);
                }
            }
        }
        for k in 0..BLOCK {
            let component = |column: &[[f64; BLOCK]; D]| -> Vector<D> { std::array::from_fn(|d| column[d][k]) };
            let (rounded, of_distance) = extended_norm(component(separation), component(&rest));
            let (gap, of_gap) = two_sum(radii[k].0 + radii[k].1, -rounded);
            distance[k] = rounded;
            overlap[k] = gap + (of_gap - of_distance);
        }
    }
}
