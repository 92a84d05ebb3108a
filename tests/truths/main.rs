//! What measures hold trajectories against: closed forms and the converged reference with their error
//! bars, and numbers that others have published.
//!
//! A new closed form and a new published number belong here.

mod closed;
mod converged;
mod golden;
#[path = "../testkit/mod.rs"]
mod testkit;
