//! The converged reference: its methods' orders, the honesty of its error bar, its horizon, its
//! cache.

#[path = "../common/mod.rs"]
mod common;

mod cache;
mod honesty;
mod horizon;
mod keys;
mod orders;
mod problems;
