//! The spring kernel: the bits of a plain loop, on any number of threads, and nothing that the scene
//! does not call for.

mod absent;
mod bits;
#[path = "../common/cloth.rs"]
mod cloth;
mod plain;
mod steps;
