//! What the library says of trajectories: the numbers of a report by their definitions, identity and
//! first faults, stability limits, what accuracy costs, and what scenes expect.
//!
//! A new measure, explanation or expectation belongs here, as long as it is asked through the library.

mod contact_laws;
mod cost;
mod definitions;
mod distances;
mod expect;
mod fault;
mod gate;
mod identity;
mod plan;
mod stability;
mod statics;
#[path = "../testkit/mod.rs"]
mod testkit;
