//! How large a step may be: predicted and measured.

mod admissible;
mod measured;
mod penalty;
mod predict;
mod rods;
mod vary;
