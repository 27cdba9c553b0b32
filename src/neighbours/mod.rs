//! Which pairs may touch: a grid of cells, a Verlet list with a skin, and how its pairs are stored for the loop over contacts.
//!
//! Start from [`PairList`], the list, and [`verlet_list`], which builds it. An inner list has the near pairs of a list; pairs of a few fast
//! disks are inserted without building it again.

pub mod block;
pub(crate) mod cell_grid;
pub(crate) mod concatenated;
pub(crate) mod displacement_bounds;
pub(crate) mod fast_disks;
pub mod for_each_pair;
pub(crate) mod inner_list;
pub(crate) mod inserted_pairs;
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
