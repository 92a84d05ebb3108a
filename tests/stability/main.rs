//! How large a step may be: predicted, measured, and as users see it.

#[path = "../common/mod.rs"]
mod common;

mod admissible;
mod measured;
mod predict;
mod vary;
mod verb;
