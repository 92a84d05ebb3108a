//! The observed order: how fast a method's error falls as its step does.
//!
//! [`observed`] is the arithmetic, on errors from anywhere; [`Ladder`] makes the runs; [`check`] is
//! what a report says of them.

mod check;
mod ladder;
mod observed;
mod rung;
#[cfg(test)]
mod tests;

pub use check::check;
pub use ladder::{BUDGET, Build, Ladder, Measured};
pub use observed::{Observed, Point, RATIOS, Reason, TOLERANCE, Verdict, observed};
