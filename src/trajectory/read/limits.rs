//! How large a trajectory file may be.
//!
//! Single numbers have no bound but finiteness: the last row of a run that diverged, which
//! `run --save` writes too, may hold any.

/// The largest file read, in bytes: 2 GiB.
pub const FILE_BYTES: usize = 2 << 30;

/// The most numbers read from one file, in text, in arrays, or after unpacking: 2 GiB as doubles.
pub const NUMBERS: usize = 1 << 28;

/// The longest header of an array, in bytes. NumPy writes 118 for what is read here, and stops at
/// 10,000 itself.
pub const ARRAY_HEADER: usize = 10_000;
