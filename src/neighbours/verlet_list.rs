//! Verlet list: a list of all pairs within a skin, built with a cell grid.
//!
//! The list holds every pair closer than `R_i + R_j + skin`, except pairs of two held disks. It stays complete until
//! some disk has moved by half the skin. Each pair stores its separation at the anchors, so the periodic box matters
//! only during the build.

use crate::neighbours::block::BLOCK;
use crate::neighbours::cell_grid::{CellGrid, Run};
use crate::neighbours::fast_disks::FastDisks;
use crate::neighbours::fast_disks::UpdatedDisks;
use crate::neighbours::pair_block::PairBlock;
use crate::neighbours::pair_list::{PairList, Search, Source};
use crate::packing::{Domain, PackingError};
use crate::parallel::{self, PIECE};
use crate::processor;
use crate::vector::{Vector, difference, dot, extended_norm, extended_sum, sum, two_sum, vector_at};

/// The disks as seen by the list builder: mobile disks first, then held disks.
pub struct Disks<'a, const D: usize> {
    /// The domain.
    pub domain: &'a Domain<D>,
    /// Positions, one double-precision number per coordinate \[length\].
    pub anchors: &'a [Vector<D>],
    /// Centre minus position \[length\].
    pub displacements: &'a [Vector<D>],
    /// Radii \[length\].
    pub radii: &'a [f64],
    /// Number of mobile disks; they come first.
    pub mobile_count: usize,
}

impl<const D: usize> Disks<'_, D> {
    /// Rounded position of a disk \[length\].
    pub(crate) fn centre(&self, disk: usize) -> Vector<D> {
        sum(self.anchors[disk], self.displacements[disk])
    }
}

/// Workspace for building a list. It is reused, so only the first build allocates memory.
#[derive(Debug, Clone, Default)]
pub struct ListWorkspace<const D: usize> {
    pub(crate) grid: CellGrid,
    points: Vec<Vector<D>>,
    /// Centres and radii in the order of the cells, so the disks of a run are contiguous in memory.
    sorted: Vec<(Vector<D>, f64)>,
    /// Disks updated since the last build.
    pub(crate) updated: UpdatedDisks,
    /// First disks of the pairs that are looked up.
    pub(crate) queried: FastDisks,
}

/// Order of the disks cell by cell, mobile disks before held ones. Neighbours in space are neighbours in memory.
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

/// Builds the list: every pair closer than R_i + R_j + `skin`, ordered by the first disk.
///
/// # Errors
/// A box too small for the minimum-image convention, or two disks with the same centre.
///
/// # Cost
/// Linear in the number of disks; 10 to 25 force evaluations.
pub fn build_pairs<const D: usize>(
    disks: &Disks<'_, D>,
    skin: f64,
    coefficient: impl Fn(f64, f64) -> f64 + Sync,
    workspace: &mut ListWorkspace<D>,
    pairs: &mut PairList<D>,
) -> Result<(), PackingError> {
    let largest = disks.radii.iter().copied().fold(0.0, f64::max);
    let edges = disks.domain.edges();
    if let Some(lengths) = disks.domain.lengths() {
        // Two images of a disk are one side apart. Both can be in range only if the side is shorter than this.
        if let Some(axis) = lengths.iter().position(|&length| length < 4.0 * largest) {
            return Err(PackingError::BoxTooSmall { axis, length: lengths[axis], range: 2.0 * largest });
        }
    }
    let ListWorkspace { grid, points, sorted, updated, .. } = workspace;
    updated.clear();
    points.resize(disks.anchors.len(), [0.0; D]);
    let centres = disks.anchors.chunks(PIECE).zip(disks.displacements.chunks(PIECE));
    parallel::each(points.chunks_mut(PIECE).zip(centres), |(points, (anchors, displacements))| {
        for ((point, &anchor), &displacement) in points.iter_mut().zip(anchors).zip(displacements) {
            *point = disks.domain.wrapped(sum(anchor, displacement));
        }
    });
    grid.fill(disks.domain, points, 2.0 * largest + skin);
    sorted.resize(points.len(), ([0.0; D], 0.0));
    parallel::each(sorted.chunks_mut(PIECE).zip(grid.members.chunks(PIECE)), |(sorted, members)| {
        for (place, &disk) in sorted.iter_mut().zip(members) {
            *place = (points[disk as usize], disks.radii[disk as usize]);
        }
    });
    let (grid, points, sorted) = (&*grid, &*points, &*sorted);
    let nearby = Nearby { disks, skin, edges, grid, points, sorted };
    let (counts, reserves_blocks) = ((points.len(), disks.mobile_count), PairList::<D>::reserves_blocks(points.len()));
    pairs.fill(counts, reserves_blocks, || TileSearch {
        nearby,
        cell: usize::MAX,
        runs: Vec::new(),
        anchored: Anchored::new(disks, &coefficient),
    })
}

/// Data shared by the searches of all tiles.
#[derive(Clone, Copy)]
struct Nearby<'a, const D: usize> {
    disks: &'a Disks<'a, D>,
    skin: f64,
    edges: Option<[Vector<D>; D]>,
    grid: &'a CellGrid,
    points: &'a [Vector<D>],
    sorted: &'a [(Vector<D>, f64)],
}

/// Search of one tile, with the cell of the last disk searched and the cells around it.
struct TileSearch<'a, const D: usize, C> {
    nearby: Nearby<'a, D>,
    cell: usize,
    runs: Vec<Run<D>>,
    anchored: Anchored<'a, D, C>,
}

/// Pairs of disks at their anchors.
pub(crate) struct Anchored<'a, const D: usize, C> {
    disks: &'a Disks<'a, D>,
    coefficient: &'a C,
    ends: Ends<D>,
}

impl<'a, const D: usize, C> Anchored<'a, D, C> {
    pub fn new(disks: &'a Disks<'a, D>, coefficient: &'a C) -> Self {
        let ends = Ends { anchors: [([1.0; D], [0.0; D]); BLOCK], radii: [(1.0, 1.0); BLOCK] };
        Anchored { disks, coefficient, ends }
    }
}

impl<const D: usize, C: Fn(f64, f64) -> f64> Search<D> for TileSearch<'_, D, C> {
    fn find(&mut self, first: usize, seconds: &mut Vec<u32>) {
        let Nearby { disks, skin, edges, grid, points, sorted, .. } = self.nearby;
        let cell = grid.cell_of[first] as usize;
        if cell != self.cell {
            grid.neighbourhood(cell, edges, &mut self.runs);
            self.cell = cell;
        }
        let (point, radius) = (points[first], disks.radii[first]);
        for run in &self.runs {
            let from: Vector<D> = difference(point, run.shift);
            let mut cells = run.cells.clone();
            // Disks of a cell are in ascending order. A cell whose last disk is not after the first disk has no second
            // disk.
            while cells.start < cells.end && grid.last_of(cells.start).is_none_or(|last| last <= first) {
                cells.start += 1;
            }
            let (start, end) = (grid.starts[cells.start] as usize, grid.starts[cells.end] as usize);
            // The outcome is unpredictable, so pairs are selected without a branch.
            let mut count = seconds.len();
            seconds.resize(count + end - start, 0);
            for (&second, &(other, other_radius)) in grid.members[start..end].iter().zip(&sorted[start..end]) {
                let range = radius + other_radius + skin;
                let apart = difference(from, other);
                seconds[count] = second;
                // Rounding of the coordinates moves this limit by far less than the tolerance of the skin. NaN counts
                // as near.
                let outside = dot(apart, apart) >= range * range;
                count += usize::from((second as usize > first) & !outside);
            }
            seconds.truncate(count);
        }
    }
}

impl<const D: usize, C: Fn(f64, f64) -> f64> Source<D> for TileSearch<'_, D, C> {
    fn second(&self, pair: u32) -> u32 {
        self.anchored.second(pair)
    }

    fn measure(&mut self, first: &[u32], second: &[u32], pair_block: &mut PairBlock<D>) {
        self.anchored.measure(first, second, pair_block);
    }
}

impl<const D: usize, C: Fn(f64, f64) -> f64> Source<D> for Anchored<'_, D, C> {
    /// The index of a pair of a given first disk is its second disk.
    fn second(&self, pair: u32) -> u32 {
        pair
    }

    fn measure(&mut self, first: &[u32], second: &[u32], pair_block: &mut PairBlock<D>) {
        let Anchored { disks, coefficient, ends } = self;
        let edges = disks.domain.edges();
        for (place, (&first, &second)) in first.iter().zip(second).enumerate() {
            let (first, second) = (first as usize, second as usize);
            ends.anchors[place] = (disks.anchors[first], disks.anchors[second]);
            ends.radii[place] = (disks.radii[first], disks.radii[second]);
        }
        processor::dispatch(Measure { ends, edges, coefficient, pair_block });
    }
}

/// Anchors and radii of both disks of the pairs of a block. The length is always BLOCK, so the vectorised loop has no
/// remainder.
struct Ends<const D: usize> {
    anchors: [(Vector<D>, Vector<D>); BLOCK],
    radii: [(f64, f64); BLOCK],
}

/// Computes separations, distances and overlaps of a block to full accuracy with vector instructions, some eighty
/// operations per pair.
struct Measure<'a, const D: usize, C> {
    ends: &'a Ends<D>,
    /// Edges of the periodic box.
    edges: Option<[Vector<D>; D]>,
    coefficient: &'a C,
    pair_block: &'a mut PairBlock<D>,
}

impl<const D: usize, C: Fn(f64, f64) -> f64> pulp::WithSimd for Measure<'_, D, C> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _simd: S) {
        let Measure { ends: Ends { anchors, radii }, edges, coefficient, pair_block } = self;
        let PairBlock { separation, distance, overlap, coefficient: coefficients } = pair_block;
        for k in 0..BLOCK {
            coefficients[k] = coefficient(radii[k].0, radii[k].1);
        }
        let mut rest = [[0.0; BLOCK]; D];
        for k in 0..BLOCK {
            for d in 0..D {
                (separation[d][k], rest[d][k]) = two_sum(anchors[k].0[d], -anchors[k].1[d]);
            }
        }
        // Displacements within half a box keep the image. The caller moves the anchors at every rebuild, so
        // displacements are small here.
        if let Some(edges) = edges {
            for d in (0..D).rev() {
                // The image is unambiguous: pairs are closer than half a side.
                let boxes: [f64; BLOCK] = std::array::from_fn(|k| -(separation[d][k] / edges[d][d]).round_ties_even());
                for axis in (0..=d).filter(|&axis| edges[d][axis] != 0.0) {
                    for k in 0..BLOCK {
                        let apart = (separation[axis][k], rest[axis][k]);
                        (separation[axis][k], rest[axis][k]) = extended_sum(apart, boxes[k] * edges[d][axis]);
                    }
                }
            }
        }
        for k in 0..BLOCK {
            let (rounded, of_distance) = extended_norm(vector_at(separation, k), vector_at(&rest, k));
            let (gap, of_gap) = two_sum(radii[k].0 + radii[k].1, -rounded);
            distance[k] = rounded;
            overlap[k] = gap + (of_gap - of_distance);
        }
    }
}
