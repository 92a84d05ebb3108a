//! The common parts of the verbs' command lines. Only this folder touches files, the terminal and programs.

pub(in crate::verbs) mod cache;
pub mod external;
pub mod flags;
pub mod output;
pub mod save;
pub mod solvers;
pub mod terminal;
