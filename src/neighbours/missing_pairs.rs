//! The pairs that a list lacks once a few of its disks are listed where they are.

use std::collections::{HashMap, HashSet};

use crate::neighbours::cell_grid::Run;
use crate::neighbours::fast_disks::Far;
use crate::neighbours::pair_list::PairList;
use crate::neighbours::verlet_list::{Anchored, Disks, ListRoom};
use crate::vector::{Vector, difference, dot, sum};

/// A pair that is nearer than the range of a list by this share of the skin is in it, whatever the rounding of coordinates \[1\].
const UNSURE: f64 = 1e-3;

/// Disks that were listed anew, in the cells where they were then.
#[derive(Debug, Clone, Default)]
pub(crate) struct Roaming {
    of_cells: HashMap<usize, Vec<u32>>,
    disks: HashSet<u32>,
}

impl Roaming {
    /// None any more.
    pub fn clear(&mut self) {
        self.of_cells.clear();
        self.disks.clear();
    }

    fn of_cell(&self, cell: usize) -> &[u32] {
        self.of_cells.get(&cell).map_or(&[], Vec::as_slice)
    }
}

impl<const D: usize> ListRoom<D> {
    /// Takes note that these disks are listed anew where they are. False if they would be more than so many.
    pub(crate) fn roam(&mut self, disks: &Disks<'_, D>, far: &Far, most: usize) -> bool {
        let Roaming { of_cells, disks: roaming } = &mut self.roaming;
        let others = far.disks().iter().filter(|&disk| !roaming.contains(disk)).count();
        if roaming.len() + others > most {
            return false;
        }
        roaming.extend(far.disks());
        for &disk in far.disks() {
            let cell = self.grid.cell_at(disks.domain.wrapped(disks.centre(disk as usize)));
            let of_cell = of_cells.entry(cell).or_default();
            if !of_cell.contains(&disk) {
                of_cell.push(disk);
            }
        }
        true
    }
}

/// Adds the pairs that a list lacks once some disks are listed where they are. Nothing is done, and false returned, where there are
/// not places enough.
///
/// # Shape
/// The list is complete for where each disk was `listed`, from its anchor, or is the near pairs of such a list, with a skin of their own;
/// `far` are those to be listed anew. Disks that were listed anew in the list of all pairs before, and those that are now, are in `room`.
pub(crate) fn amend_pairs<const D: usize>(
    disks: &Disks<'_, D>,
    (listed, skin): (&[Vector<D>], f64),
    far: &Far,
    coefficient: impl Fn(f64, f64) -> f64 + Sync,
    room: &mut ListRoom<D>,
    pairs: &mut PairList<D>,
) -> bool {
    let lengths = disks.domain.lengths();
    let before = |disk: u32| sum(disks.anchors[disk as usize], listed[disk as usize]);
    let now = |disk: u32| if far.contains(disk) { disks.centre(disk as usize) } else { before(disk) };
    let apart = |a, b| {
        let mut apart: Vector<D> = difference(a, b);
        if let Some(lengths) = lengths {
            for d in 0..D {
                // Most are near as they are.
                if 2.0 * apart[d].abs() > lengths[d] {
                    apart[d] -= (apart[d] / lengths[d]).round_ties_even() * lengths[d];
                }
            }
        }
        dot(apart, apart)
    };
    let ListRoom { grid, roaming, asked, .. } = room;
    let (mut lacking, mut runs) = (Vec::new(), Vec::new());
    for &disk in far.disks() {
        let (there, here) = (before(disk), disks.centre(disk as usize));
        let reach = disks.radii[disk as usize] + skin;
        let mut offer = |other: u32| {
            let range = reach + disks.radii[other as usize];
            let (first, second) = (disk.min(other), disk.max(other));
            if disk == other || apart(here, now(other)) >= range * range || first as usize >= disks.mobile_count {
                return;
            }
            // Those that were near before are listed; where rounding might decide that is looked up.
            let surely = range - UNSURE * skin;
            if apart(there, before(other)) >= surely * surely {
                lacking.push((first, second));
            }
        };
        // Others are in the cells they were in; those that were listed anew are in others as well.
        grid.neighbourhood(grid.cell_at(disks.domain.wrapped(here)), lengths, &mut runs);
        for Run { cells, .. } in &runs {
            let (start, end) = (grid.starts[cells.start] as usize, grid.starts[cells.end] as usize);
            grid.members[start..end].iter().for_each(|&other| offer(other));
            cells.clone().flat_map(|cell| roaming.of_cell(cell)).for_each(|&other| offer(other));
        }
    }
    lacking.sort_unstable();
    lacking.dedup();
    asked.set(lacking.iter().map(|&(first, _)| first).collect(), disks.radii.len());
    let mut had = pairs.pairs_of(asked);
    had.sort_unstable();
    lacking.retain(|pair| had.binary_search(pair).is_err());
    pairs.amend(&lacking, &mut Anchored::new(disks, &coefficient))
}
