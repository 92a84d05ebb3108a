//! The systems integrators are tested on: one coordinate in closed form, and small networks without
//! symmetries that could hide an error.

mod networks;
mod one;

pub use networks::{free_triangle, swinging_triangle};
pub use one::{Across, ConstantForce, Driven, Oscillator};
