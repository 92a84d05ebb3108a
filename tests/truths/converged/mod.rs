//! The converged reference: its methods' orders, the honesty of its error bar, its horizon, its
//! cache.

mod cache;
mod honesty;
mod horizon;
mod keys;
mod orders;
mod problems;
mod published;
