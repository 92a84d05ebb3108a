//! The numbers a trajectory shows: pure functions of recorded states.

mod bounce;
mod check;
mod constrained;
mod contact;
mod energy;
mod error;
pub mod identify;
mod laws;
mod momentum;
pub mod order;
pub mod rest;
mod scale;
pub mod stability;
mod statics;
mod strain;
mod trend;
pub mod twin;

pub use bounce::Bounce;
pub use check::{Check, CheckStatus};
pub use constrained::{Constrained, Growth, RodTension, constrained};
pub use contact::Contact;
pub(crate) use energy::Sum;
pub use energy::{Behaviour, Energy, EnergySeries, judge};
pub use error::{Deviation, ErrorSummary, Errors, TOLERANCE, TrueStates, deviation, errors, reach};
pub use laws::{CONTACT_LAWS, Laws, Residual};
pub(crate) use momentum::totals;
pub use momentum::{Momentum, momentum};
pub use scale::{divergence_limit, energy_scale};
pub use statics::{Loads, Reaction, Statics, Tension};
pub use strain::Strain;
pub use trend::EnergyClass;
