//! Files that are read: which are accepted as what, which are refused and where, and that nothing upsets
//! the readers.
//!
//! A new key of a scene file and a new format of a trajectory belong here, and what fuzzing finds.

mod scenes;
#[path = "../testkit/mod.rs"]
mod testkit;
mod trajectories;
