//! Fast disks: the few disks that have moved far since a Verlet list was built.

use std::collections::{HashMap, HashSet};
use std::ops::Range;

/// A set of disks, searchable by disk number and by range of numbers.
#[derive(Debug, Clone, Default)]
pub(crate) struct FastDisks {
    /// In ascending order.
    disks: Vec<u32>,
    is_fast: Vec<bool>,
}

impl FastDisks {
    /// Replaces the set by `disks`, out of `disk_count` disks.
    ///
    /// # Shape
    /// `disks` are in ascending order.
    pub fn set(&mut self, disks: Vec<u32>, disk_count: usize) {
        debug_assert!(disks.is_sorted());
        self.disks.iter().for_each(|&disk| self.is_fast[disk as usize] = false);
        self.is_fast.resize(disk_count, false);
        disks.iter().for_each(|&disk| self.is_fast[disk as usize] = true);
        self.disks = disks;
    }

    /// All disks of the set.
    pub fn disks(&self) -> &[u32] {
        &self.disks
    }

    /// Whether the set contains this disk.
    pub fn contains(&self, disk: u32) -> bool {
        self.is_fast[disk as usize]
    }

    /// Whether the set contains any disk of this range.
    pub fn any_of(&self, disks: Range<usize>) -> bool {
        let at = self.disks.partition_point(|&disk| (disk as usize) < disks.start);
        self.disks.get(at).is_some_and(|&disk| (disk as usize) < disks.end)
    }
}

/// Disks that were updated since the list was built, sorted by the cells they were in at the update.
#[derive(Debug, Clone, Default)]
pub(crate) struct UpdatedDisks {
    pub(crate) of_cells: HashMap<usize, Vec<u32>>,
    pub(crate) disks: HashSet<u32>,
}

impl UpdatedDisks {
    /// Empties the set.
    pub fn clear(&mut self) {
        self.of_cells.clear();
        self.disks.clear();
    }

    pub fn of_cell(&self, cell: usize) -> &[u32] {
        self.of_cells.get(&cell).map_or(&[], Vec::as_slice)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chosen_disks_are_found_and_others_are_not() {
        let mut fast = FastDisks::default();
        for chosen in [vec![3, 4, 9], vec![], vec![0, 11], vec![4]] {
            fast.set(chosen.clone(), 12);
            assert!((0..12).all(|disk| fast.contains(disk) == chosen.contains(&disk)));
            for begin in 0..12 {
                for end in begin..12 {
                    assert_eq!(
                        fast.any_of(begin..end),
                        chosen.iter().any(|&disk| (begin..end).contains(&(disk as usize)))
                    );
                }
            }
            assert_eq!(fast.any_of(4..usize::MAX), chosen.iter().any(|&disk| disk >= 4));
        }
    }
}
