//! The scene file: read strictly, checked, complete.
mod model;
pub use model::*;
