//! Steps that are too long for a few disks, repeated with shorter ones around those disks only.

mod local_steps;
pub(super) mod patch;
pub(super) mod shells;
