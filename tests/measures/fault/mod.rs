//! Mistakes are named, first faults are found and explained, and what is right is left alone.

mod anchors;
mod injected;
mod mistaken;
pub mod record;
mod shipped;
mod written;
