//! Limits from theory: the linearised scene's modes, and what a step of a method does to each.

mod along;
mod assembly;
mod composition;
mod coupled;
mod effort;
mod krylov;
mod linear;
mod matrix;
mod mode;
mod one_kick;
mod predict;
mod region;
mod spectrum;
mod verdict;

use super::Limit;

pub use along::{Along, Tightest, along};
pub use effort::Effort;
pub use linear::{Excluded, Linearised, Prediction, is_linear};
