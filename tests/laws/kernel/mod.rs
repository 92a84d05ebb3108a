//! The spring kernel: the bits of a plain loop, on any number of threads, and nothing that the scene
//! does not call for.

mod absent;
mod bits;
mod plain;
mod steps;
