//! The observed order: how fast a method's error falls as its step does.
//!
//! [`observed`] is the arithmetic, on errors from anywhere; [`Study`] makes the runs; [`check`] is
//! what a report says of them.

mod check;
mod observed;
mod run;
mod study;
#[cfg(test)]
mod tests;

pub use check::check;
pub use observed::{Observed, Point, RATIOS, Reason, TOLERANCE, Verdict, observed};
pub use run::Build;
pub use study::{BUDGET, Measured, Study};
