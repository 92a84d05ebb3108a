//! What a trajectory shows, as numbers: pure functions of recorded states.

mod deviation;
mod energy;
mod momentum;
pub mod order;
mod scale;
mod trend;
pub mod twin;

pub use deviation::{TOLERANCE, deviation, reach};
pub use energy::{EnergySeries, judge};
pub use momentum::momentum;
pub use scale::{divergence_limit, energy_scale};
pub use trend::{Trend, trend};
