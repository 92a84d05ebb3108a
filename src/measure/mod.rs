//! What a trajectory shows, as numbers: pure functions of recorded states.

pub mod cost;
mod deviation;
mod energy;
mod error;
pub mod identify;
mod momentum;
pub mod order;
mod scale;
pub mod stability;
mod trend;
pub mod twin;

pub use deviation::{TOLERANCE, deviation, reach};
pub use energy::{EnergySeries, judge};
pub use error::{Errors, Known, errors};
pub use momentum::momentum;
pub use scale::{divergence_limit, energy_scale};
pub use trend::{Trend, trend};
