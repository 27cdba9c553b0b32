//! Pairs of disks that may touch: cell grid, Verlet list with a skin, and the storage of its pairs for the loop over
//! contacts.
//!
//! Start from [`PairList`], the list, and [`verlet_list`], which builds it. An inner list holds the nearest pairs of a
//! Verlet list. Pairs of a few fast disks are inserted without a rebuild.

pub mod block;
pub(crate) mod cell_grid;
pub(crate) mod concatenation;
pub(crate) mod displacement_bounds;
pub(crate) mod fast_disks;
pub mod for_each_pair;
pub(crate) mod inner_list;
pub(crate) mod inserted_pairs;
pub(crate) mod list_keeper;
pub(crate) mod missing_pairs;
pub(crate) mod pair_block;
pub mod pair_list;
pub(crate) mod rows;
pub(crate) mod single_precision;
#[cfg(feature = "linear")]
pub(crate) mod subset;
pub(crate) mod tile_schedule;
pub(crate) mod tiles;
pub mod verlet_list;

pub use pair_list::PairList;
