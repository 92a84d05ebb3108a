//! Trajectories other programs wrote: bytes in, checked [`Rows`] out, or one error that points at
//! its place.
//!
//! ```text
//! bytes -> table (csv | npz | npy): times, whole states, how they were written
//!       -> step numbers (times) -> how exactly they are given (precision) -> Rows
//! ```
//!
//! Text has a header and one row a particle and instant: `t,id,x,y,z`, and `vx,vy,vz` if wanted, in
//! any order of columns. Rows of one instant stand together, their ids in any order. Without `id`
//! rows are about the scene's only free particle, or, wide, about all: `t,x0,y0,z0,x1,...`. Lines that
//! begin with `#` are comments, but such a line above the numbers can be the header, as `np.savetxt`
//! writes it.
//!
//! Arrays are `t` of shape (T), `x` of shape (T, N, 3) and, if wanted, `v` of x's shape, in single
//! or double precision or whole numbers. An NPY file is `x` alone: its times are n timesteps. With
//! one free particle `x` may be (T, 3).
//!
//! Data of a [`Plane`] has two coordinates of each particle; the third is as the scene has it.
//!
//! A text whose last number may be cut loses its last row, which [`Rows::cut`] says. What is cut for
//! certain is refused.
//!
//! Fixed particles may be left out, all of them or none. Where the one free particle moves on one
//! axis ([`free_axis`]), text may be `t,x[,v]` and arrays (T): the coordinate on that axis, whichever
//! it is, and its velocity. What is left out is as the scene has it at the start.
//!
//! A column or array with any other name is an error, not ignored: it may be a misspelt velocity.

mod array;
mod csv;
mod digits;
mod error;
mod expected;
mod npz;
mod times;

pub use error::{ErrorPlace, ReadError};
pub use expected::{Expected, FreeAxis, Plane, free_axis};

use super::{Precision, Rows};
use error::Wrong;

/// How large a trajectory file may be.
///
/// Single numbers have no bound but finiteness: the last row of a run that diverged, which
/// `run --save` writes too, may hold any.
pub mod limits {
    /// The largest file read, in bytes: 2 GiB.
    pub const FILE_BYTES: usize = 2 << 30;

    /// The most numbers read from one file, in text, in arrays, or after unpacking: 2 GiB as doubles.
    pub const NUMBERS: usize = 1 << 28;

    /// The longest header of an array, in bytes. NumPy writes 118 for what is read here, and stops at
    /// 10,000 itself.
    pub const ARRAY_HEADER: usize = 10_000;
}

/// How a trajectory file is laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    /// Text: `t,id,x,y,z[,vx,vy,vz]`, or `t,x[,v]`.
    Csv,
    /// NumPy's archive of arrays `t`, `x` and, if wanted, `v`.
    Npz,
    /// One NumPy array: the positions.
    Npy,
}

impl Layout {
    /// Guesses by the first bytes, whatever the name says. Where they tell nothing the name's
    /// extension decides; where that tells nothing either, the file is text.
    pub fn guess(name: &str, bytes: &[u8]) -> Self {
        let extension = name.rsplit_once('.').map_or("", |(_, extension)| extension);
        if bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"PK\x05\x06") {
            Self::Npz
        } else if bytes.starts_with(b"\x93NUMPY") {
            Self::Npy
        } else if extension.eq_ignore_ascii_case("npz") {
            Self::Npz
        } else if extension.eq_ignore_ascii_case("npy") {
            Self::Npy
        } else {
            Self::Csv
        }
    }
}

/// The contents of a file, before its times are counted in steps.
struct Table {
    times: times::Times,
    /// Positions, m.
    x: Numbers,
    /// Velocities, m/s.
    v: Option<Numbers>,
    /// The driven particles that it says nothing of, as indices in [`Expected::drives`].
    left_out: Vec<usize>,
    /// The last row may be cut and is left out.
    cut: bool,
}

/// Whole states, one after the other.
struct Numbers {
    values: Vec<f64>,
    /// The precision that the form of the numbers alone tells.
    written: Precision,
}

/// With fewer different numbers, that they are short tells nothing.
const FEW: usize = 8;

impl Numbers {
    /// Whether the numbers take more than a few values after the first state.
    fn change_often(&self, dim: usize) -> bool {
        let pairs = self.values.iter().zip(self.values.iter().skip(dim));
        let changed = pairs.filter(|(a, b)| a != b && b.is_finite());
        let mut seen: Vec<u64> = Vec::new();
        for (_, value) in changed {
            let bits = value.abs().to_bits();
            if !seen.contains(&bits) {
                seen.push(bits);
            }
            if seen.len() > FEW {
                return true;
            }
        }
        false
    }

    /// The precision of states of `dim` numbers, and the numbers. Text of singles gives back the
    /// singles it was printed from.
    fn measured(mut self, dim: usize) -> (Precision, Vec<f64>) {
        let (precision, singles) = digits::detect(&self.values, dim, self.written);
        for value in &mut self.values {
            let single = f64::from(*value as f32);
            // In coarser text several singles look the same.
            let unique = |text: Precision| match text {
                Precision::Single => true,
                _ => 2.0 * text.half_unit(*value) <= Precision::Single.half_unit(*value),
            };
            if singles.is_some_and(unique) && single.is_finite() {
                *value = single;
            }
        }
        (precision, self.values)
    }
}

/// Reads a trajectory that fits a scene. `name` is the file's, for messages and, without a `layout`,
/// for [`Layout::guess`].
///
/// # Errors
/// The first thing wrong, with its place. No input panics.
pub fn read(
    bytes: &[u8],
    name: &str,
    layout: Option<Layout>,
    expected: &Expected,
) -> Result<Rows, ReadError> {
    let layout = layout.unwrap_or_else(|| Layout::guess(name, bytes));
    rows(bytes, layout, expected).map_err(|error| ReadError {
        file: name.to_owned(),
        ..error
    })
}

/// Reads the rows; errors do not name the file yet.
fn rows(bytes: &[u8], layout: Layout, expected: &Expected) -> Result<Rows, ReadError> {
    if bytes.len() > limits::FILE_BYTES {
        let cap = limits::FILE_BYTES >> 30;
        let help = "keep fewer instants";
        return Err(Wrong::new(format!("expected at most {cap} GiB"), help).at(ErrorPlace::File));
    }
    let table = match layout {
        Layout::Csv => csv::read(bytes, expected)?,
        Layout::Npz => npz::read(bytes, expected)?,
        Layout::Npy => npz::positions(bytes, expected)?,
    };
    let steps = table.times.steps(expected.timestep, bytes)?;
    let dim = 3 * expected.particles();
    let (precision, mut x) = table.x.measured(dim);
    // Velocities that few impacts change are short where these are, however many digits are given.
    let told = |v: &Numbers| v.written != Precision::Double || v.change_often(dim);
    let few = table.v.as_ref().is_some_and(|v| !told(v));
    let (precision_v, mut v) = table.v.map(|v| v.measured(dim)).unzip();
    let precision_v = precision_v.map(|own| if few { precision } else { own });
    for drive in table.left_out.iter().map(|at| &expected.drives[*at]) {
        for (row, step) in steps.iter().enumerate() {
            let [position, velocity, _] = drive.at(*step as f64 * expected.timestep);
            let at = row * dim + 3 * drive.particle;
            x[at..at + 3].copy_from_slice(&position);
            if let Some(v) = &mut v {
                v[at..at + 3].copy_from_slice(&velocity);
            }
        }
    }
    Ok(Rows {
        timestep: expected.timestep,
        dim,
        steps,
        x,
        v,
        precision,
        precision_v: precision_v.unwrap_or(precision),
        cut: table.cut,
    })
}
