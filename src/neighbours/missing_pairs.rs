//! Pairs missing from a Verlet list after a few fast disks have been updated.

use crate::neighbours::cell_grid::Run;
use crate::neighbours::fast_disks::{FastDisks, UpdatedDisks};
use crate::neighbours::pair_list::PairList;
use crate::neighbours::verlet_list::{Anchored, Disks, ListWorkspace};
use crate::vector::{Vector, difference, dot, sum};

/// Margin of the search over the skin \[1\]. A pair closer than the range by this margin is certainly in the list,
/// despite rounding.
const ROUNDING_MARGIN: f64 = 1e-3;

impl<const D: usize> ListWorkspace<D> {
    /// Records that these disks have been updated to their present positions. Returns false if more than `most` disks
    /// would be recorded.
    pub(crate) fn note_updated(&mut self, disks: &Disks<'_, D>, fast: &FastDisks, most: usize) -> bool {
        let UpdatedDisks { of_cells, disks: updated } = &mut self.updated;
        let others = fast.disks().iter().filter(|&disk| !updated.contains(disk)).count();
        if updated.len() + others > most {
            return false;
        }
        updated.extend(fast.disks());
        for &disk in fast.disks() {
            let cell = self.grid.cell_at(disks.domain.wrapped(disks.centre(disk as usize)));
            let of_cell = of_cells.entry(cell).or_default();
            if !of_cell.contains(&disk) {
                of_cell.push(disk);
            }
        }
        true
    }
}

/// Inserts the pairs that a list is missing after some fast disks have been updated to their present positions. Returns
/// false, without any change, if the reserved blocks have too little space.
///
/// # Shape
/// The list is complete for disks at anchor + `listed`, or is an inner list with a skin of its own. `fast` are the
/// disks to update. `workspace` holds all disks updated in the outer list, including those of this call.
pub(crate) fn insert_missing_pairs<const D: usize>(
    disks: &Disks<'_, D>,
    (listed, skin): (&[Vector<D>], f64),
    fast: &FastDisks,
    coefficient: impl Fn(f64, f64) -> f64 + Sync,
    workspace: &mut ListWorkspace<D>,
    pairs: &mut PairList<D>,
) -> bool {
    let edges = disks.domain.edges();
    let before = |disk: u32| sum(disks.anchors[disk as usize], listed[disk as usize]);
    let now = |disk: u32| if fast.contains(disk) { disks.centre(disk as usize) } else { before(disk) };
    let apart = |a, b| {
        let mut apart: Vector<D> = difference(a, b);
        if let Some(edges) = edges {
            for d in (0..D).rev() {
                // Most pairs need no periodic image.
                if 2.0 * apart[d].abs() > edges[d][d] {
                    let boxes = (apart[d] / edges[d][d]).round_ties_even();
                    (0..=d).for_each(|axis| apart[axis] -= boxes * edges[d][axis]);
                }
            }
        }
        dot(apart, apart)
    };
    let ListWorkspace { grid, updated, queried, .. } = workspace;
    let (mut missing, mut runs) = (Vec::new(), Vec::new());
    for &disk in fast.disks() {
        let (there, here) = (before(disk), disks.centre(disk as usize));
        let reach = disks.radii[disk as usize] + skin;
        let mut offer = |other: u32| {
            let range = reach + disks.radii[other as usize];
            let (first, second) = (disk.min(other), disk.max(other));
            if disk == other || apart(here, now(other)) >= range * range || first as usize >= disks.mobile_count {
                return;
            }
            // Pairs that were near before are in the list. Pairs within the rounding margin are looked up below.
            let surely = range - ROUNDING_MARGIN * skin;
            if apart(there, before(other)) >= surely * surely {
                missing.push((first, second));
            }
        };
        // Other disks are in their cells of the last build; updated disks are also in the cells of their updates.
        grid.neighbourhood(grid.cell_at(disks.domain.wrapped(here)), edges, &mut runs);
        for Run { cells, .. } in &runs {
            let (start, end) = (grid.starts[cells.start] as usize, grid.starts[cells.end] as usize);
            grid.members[start..end].iter().for_each(|&other| offer(other));
            cells.clone().flat_map(|cell| updated.of_cell(cell)).for_each(|&other| offer(other));
        }
    }
    missing.sort_unstable();
    missing.dedup();
    queried.set(missing.iter().map(|&(first, _)| first).collect(), disks.radii.len());
    let mut had = pairs.pairs_of(queried);
    had.sort_unstable();
    missing.retain(|pair| had.binary_search(pair).is_err());
    pairs.insert_pairs(&missing, &mut Anchored::new(disks, &coefficient))
}
