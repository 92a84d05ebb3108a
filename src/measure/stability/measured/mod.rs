//! Limits found by running a scene at many steps.

mod bench;
mod cell;
mod difference;
mod growth;
mod limit;
mod passive;
mod probe;
mod search;
mod shake;
mod smooth;

use super::Limit;

pub use cell::classify;
pub use limit::{Make, Measured, measure};
