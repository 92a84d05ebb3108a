//! One trajectory that somebody else computed: is it right, and which scheme is it really?

mod args;
mod plan;

pub use args::{Args, compare};
pub use plan::Comparison;
