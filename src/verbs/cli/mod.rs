//! The common parts of the verbs' command lines. Only this folder touches files, the terminal and programs.

pub(in crate::verbs) mod cache;
pub mod external;
pub mod flags;
pub mod interrupt;
pub mod note;
pub mod output;
pub mod place;
pub mod save;
pub mod solvers;
pub(in crate::verbs) mod target;
pub(in crate::verbs) mod temporary;
pub mod terminal;
