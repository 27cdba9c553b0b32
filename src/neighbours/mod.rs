//! Pairs of disks that may touch: cell grid, Verlet list with a skin, and the storage of its pairs for the loop over
//! contacts.
//!
//! Start from [`PairList`], the list, and [`verlet_list`], which builds it. An inner list holds the nearest pairs of a
//! Verlet list. Pairs of a few fast disks are inserted without a rebuild. [`Assembly`](crate::forces::Assembly) calls
//! `ListKeeper` after every step; it checks, updates and rebuilds the lists.
//!
//! | word | meaning |
//! |---|---|
//! | row | up to 8 pairs with the same first disk |
//! | block | up to 128 pairs in rows of equal length, column by column in one piece of memory |
//! | tile | neighbouring disks, 8192 or more, whose data fit into a cache; one tile if there are fewer disks |
//! | portion | up to 1024 mobile disks of a tile, with one displacement bound |
//! | run | cells next to each other along the first axis; their disks are contiguous in memory |
//! | piece | 16 384 disks of a long array, processed by one thread |

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
