//! What a trajectory shows, as numbers: pure functions of recorded states.

mod check;
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

pub use check::{Check, CheckStatus};
pub use deviation::{Deviation, TOLERANCE, deviation, reach};
pub use energy::{Energy, EnergySeries, judge};
pub use error::{Errors, Known, Spread, errors};
pub(crate) use momentum::totals;
pub use momentum::{Momentum, momentum};
pub use scale::{divergence_limit, energy_scale};
pub use trend::{EnergyClass, Trend, trend};
