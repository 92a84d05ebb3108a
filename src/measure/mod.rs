//! What a trajectory shows, as numbers: pure functions of recorded states.

pub mod cost;
mod energy;
mod error;
pub mod identify;
mod momentum;
pub mod order;
mod scale;
pub mod stability;
mod trend;
pub mod twin;

pub use energy::{EnergySeries, judge};
pub use error::{Errors, Known, TOLERANCE, deviation, errors, reach};
pub use momentum::momentum;
pub use scale::{divergence_limit, energy_scale};
