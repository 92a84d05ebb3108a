//! What a run leaves behind: a thinned record in memory, and files of every step.

mod csv;
mod npz;
mod read;
mod record;
mod rows;

pub use csv::CsvWriter;
pub use npz::{NpzWriter, Scratch};
pub use read::{Expected, FreeAxis, Layout, Place, ReadError, free_axis, limits, read};
pub use record::{Recorder, RowRecorder, Trajectory, stride};
pub use rows::{Precision, Rows};

/// A trajectory file could not be written.
#[derive(Debug, thiserror::Error)]
pub enum SaveError {
    #[error("could not write the trajectory")]
    Io(#[from] std::io::Error),
    #[error("could not pack the trajectory")]
    Zip(#[from] zip::result::ZipError),
}

/// The steps a file of every `every`-th step holds: those, and the last.
#[derive(Debug, Clone, Copy)]
struct Selection {
    every: u64,
    steps: u64,
}

impl Selection {
    fn new(every: u64, steps: u64) -> Self {
        let every = every.max(1);
        Self { every, steps }
    }

    fn next(self, from: u64) -> Option<u64> {
        let due = from.div_ceil(self.every) * self.every;
        (from <= self.steps).then(|| due.min(self.steps))
    }
}
