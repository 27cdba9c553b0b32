//! The plainest algorithms for what the library does in another way.

pub mod all_pairs;
pub mod naive_backbone;
