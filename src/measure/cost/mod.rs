//! What a sweep of settings says: which reach an error, at what price, and how fast errors fall.
//!
//! Pure functions of [`CostPoint`](crate::outcome::CostPoint)s, coarse to fine.

mod pareto;
mod reach;
mod slope;
mod target;
#[cfg(test)]
mod tests;

pub use pareto::pareto;
pub use reach::{Misses, reach};
pub use slope::{Slope, slope};
pub use target::{Judged, target};
