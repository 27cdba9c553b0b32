//! [`Shells`]: the surroundings of disks whose errors are too large, in shells of contacts.

use crate::forces::assembly::Assembly;
use crate::forces::elastic::geometry;
use crate::neighbours::pair_list::PairList;
use crate::relax::dynamics::implicit::multirate::patch::Patch;
use crate::vector::{Vector, larger, norm};

/// Largest displacement in a patch over the largest one of the long step there. The pair list must be complete for such
/// displacements.
pub(crate) const LONGEST_MOVE: f64 = 4.0;

/// The disk is in no patch.
const OUT: u32 = u32::MAX;

/// The disk is in a finished patch.
pub(crate) const DONE: u32 = u32::MAX - 1;

/// Buffers of all patches.
#[derive(Debug, Clone, Default)]
pub(crate) struct Shells<const D: usize> {
    /// Pairs of each disk, and the number of their list.
    starts: Vec<u32>,
    pairs: Vec<u32>,
    list: usize,
    /// Shell of each disk around those whose errors are too large; or `OUT`, or `DONE`.
    pub(crate) shell_of: Vec<u32>,
    /// Disks of all patches, shell by shell.
    inside: Vec<u32>,
    pub(crate) patch: Patch<D>,
    /// Pairs evaluated in patches that the count of evaluations does not include yet.
    pub(crate) pair_count: usize,
}

impl<const D: usize> Shells<D> {
    /// Updates the pairs of each disk if the list has changed.
    pub(crate) fn set_list(&mut self, pairs: &PairList<D>, disk_count: usize, list: usize) {
        if self.list == list && self.shell_of.len() == disk_count {
            return;
        }
        self.list = list;
        self.starts.clear();
        self.starts.resize(disk_count + 1, 0);
        for pair in pairs.numbers() {
            self.starts[pairs.first[pair] as usize + 1] += 1;
            self.starts[pairs.second[pair] as usize + 1] += 1;
        }
        for disk in 0..disk_count {
            self.starts[disk + 1] += self.starts[disk];
        }
        self.pairs.clear();
        self.pairs.resize(2 * pairs.len(), 0);
        for pair in pairs.numbers() {
            for disk in [pairs.first[pair], pairs.second[pair]] {
                self.pairs[self.starts[disk as usize] as usize] = pair as u32;
                self.starts[disk as usize] += 1;
            }
        }
        // Each start is now that of the next disk.
        self.starts.rotate_right(1);
        self.starts[0] = 0;
        self.shell_of.clear();
        self.shell_of.resize(disk_count, OUT);
        self.patch.set_disk_count(disk_count);
    }

    /// Pairs of a disk, each with the other disk.
    fn pairs_of<'a>(&'a self, pairs: &'a PairList<D>, disk: u32) -> impl Iterator<Item = (usize, u32)> + 'a {
        let places = self.starts[disk as usize] as usize..self.starts[disk as usize + 1] as usize;
        self.pairs[places].iter().map(move |&pair| {
            let pair = pair as usize;
            (pair, if pairs.first[pair] == disk { pairs.second[pair] } else { pairs.first[pair] })
        })
    }

    /// Finds the shells of mobile disks around some disks; gaps up to `margin` count as contacts. Returns whether they
    /// contain at most `most` disks.
    pub(crate) fn set_shells(
        &mut self,
        assembly: &Assembly<D>,
        (disks, last): (&[u32], u32),
        (margin, most): (f64, usize),
    ) -> bool {
        let (pairs, mobile) = (assembly.pairs(), assembly.mobile_count() as u32);
        self.inside.clear();
        self.inside.extend_from_slice(disks);
        for &disk in disks {
            self.shell_of[disk as usize] = 0;
        }
        let mut shells = std::mem::take(&mut self.shell_of);
        let mut inside = std::mem::take(&mut self.inside);
        let mut next = 0;
        while next < inside.len() && inside.len() <= most {
            let disk = inside[next];
            next += 1;
            let shell = shells[disk as usize];
            if shell == last {
                break;
            }
            for (pair, other) in self.pairs_of(pairs, disk) {
                let new = other < mobile && shells[other as usize] == OUT;
                if new && geometry(pairs, pair, &assembly.displacements).2 > -margin {
                    shells[other as usize] = shell + 1;
                    inside.push(other);
                }
            }
        }
        (self.shell_of, self.inside) = (shells, inside);
        self.inside.len() <= most
    }

    /// Sets the patch of a disk: all inner disks connected with it by pairs of the list, and the outer disks around
    /// them. Returns the largest displacement allowed in it \[length\]. Pairs that cannot touch then are omitted.
    pub(crate) fn set_patch(
        &mut self,
        (pairs, displacements): (&PairList<D>, &[Vector<D>]),
        moved: &[Vector<D>],
        (disk, last): (u32, u32),
    ) -> f64 {
        let mut patch = std::mem::take(&mut self.patch);
        patch.begin();
        patch.add(disk);
        let mut next = 0;
        while next < patch.disks.len() {
            for (_, other) in self.pairs_of(pairs, patch.disks[next]) {
                if self.shell_of[other as usize] < DONE && !patch.has(other) {
                    patch.add(other);
                }
            }
            next += 1;
        }
        patch.close_inside(|disk| self.shell_of[disk as usize] == last);
        let distance = |disk: u32| moved.get(disk as usize).map_or(0.0, |&moved| norm(moved));
        let around =
            patch.disks.iter().flat_map(|&disk| self.pairs_of(pairs, disk).map(|(_, other)| other).chain([disk]));
        let longest = LONGEST_MOVE * around.map(distance).fold(0.0, |most, distance| larger(distance, most));
        for inside in 0..patch.inside_count() {
            let disk = patch.disks[inside];
            for (pair, other) in self.pairs_of(pairs, disk) {
                // A pair of two inner disks is found from both of them.
                let met = patch.place(other).is_some_and(|place| place < inside);
                // Both disks may approach each other.
                if !met && geometry(pairs, pair, displacements).2 > -2.0 * longest {
                    patch.add(other);
                    patch.add_pair(pair, [pairs.first[pair], pairs.second[pair]]);
                }
            }
        }
        patch.close(pairs);
        self.patch = patch;
        longest
    }

    pub(crate) fn leave(&mut self) {
        for &disk in &self.inside {
            self.shell_of[disk as usize] = OUT;
        }
    }
}
