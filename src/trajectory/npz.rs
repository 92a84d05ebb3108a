//! Every step for NumPy: `t` (T), `x` (T, N, 3), `v` (T, N, 3) and other values of each state, doubles, in one NPZ.

use super::csv::Values;
use super::{Observer, SaveError, Selection};
use crate::physics::State;
use npyz::WriterBuilder;
use std::io::{BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use zip::write::SimpleFileOptions;

/// A stream that holds an array until its length is known.
pub trait Scratch: Read + Write + Seek {}
impl<T: Read + Write + Seek> Scratch for T {}

/// An array that grows by the values of each state.
struct Array<S: Scratch> {
    name: &'static str,
    /// What follows the number of instants.
    shape: Vec<u64>,
    values: Values,
    scratch: BufWriter<S>,
}

/// Collects rows in scratch files as a run goes on, since a run's length is known only at its end.
pub struct NpzWriter<S: Scratch> {
    arrays: Vec<Array<S>>,
    rows: u64,
    last_step: u64,
    selection: Selection,
    timestep: f64,
    /// The first failure, which `finish` returns; later rows are dropped.
    written: std::io::Result<()>,
}

impl<S: Scratch> NpzWriter<S> {
    /// Collects every `every`-th of `steps` steps (0 counts as 1) of `particles` particles, and the
    /// last. The scratch streams are empty.
    pub fn new(scratch: [S; 2], particles: usize, steps: u64, every: u64, timestep: f64) -> Self {
        let [x, v] = scratch;
        let shape = || vec![particles as u64, 3];
        let writer = Self {
            arrays: Vec::new(),
            rows: 0,
            last_step: 0,
            selection: Selection::new(every, steps),
            timestep,
            written: Ok(()),
        };
        writer
            .with("x", shape(), Box::new(|state| state.x.clone()), x)
            .with("v", shape(), Box::new(|state| state.v.clone()), v)
    }

    /// The same with one array more, of this shape at each instant.
    #[must_use]
    pub fn with(mut self, name: &'static str, shape: Vec<u64>, values: Values, scratch: S) -> Self {
        self.arrays.push(Array {
            name,
            shape,
            values,
            scratch: BufWriter::new(scratch),
        });
        self
    }

    /// Writes the archive to `out`.
    ///
    /// # Errors
    /// The first failure of any stream, whenever it happened.
    pub fn finish<W: Write + Seek>(self, out: W) -> Result<W, SaveError> {
        self.written?;
        let rows = self.rows;
        let time = |row| {
            let step = if row + 1 < rows {
                row * self.selection.every
            } else {
                self.last_step
            };
            Ok(step as f64 * self.timestep)
        };
        let mut archive = zip::ZipWriter::new(Stopping { out, failed: false });
        // The archive holds no date: two runs give the same bytes.
        let options = SimpleFileOptions::default()
            .compression_method(zip::CompressionMethod::Stored)
            .last_modified_time(zip::DateTime::default())
            .large_file(true);
        archive.start_file("t.npy", options)?;
        write_array(&mut archive, &[rows], (0..rows).map(time))?;
        for array in self.arrays {
            let mut scratch = array
                .scratch
                .into_inner()
                .map_err(std::io::IntoInnerError::into_error)?;
            scratch.seek(SeekFrom::Start(0))?;
            archive.start_file(format!("{}.npy", array.name), options)?;
            let shape = [&[rows], &array.shape[..]].concat();
            let count = shape.iter().product();
            write_array(
                &mut archive,
                &shape,
                doubles(BufReader::new(scratch), count),
            )?;
        }
        Ok(archive.finish()?.out)
    }
}

/// A stream that takes no more after its first failure, and says nothing of that. An archive that is given up still
/// completes itself, and prints it where that fails again.
struct Stopping<W> {
    out: W,
    failed: bool,
}

impl<W: Write> Write for Stopping<W> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        if self.failed {
            return Ok(bytes.len());
        }
        let written = self.out.write(bytes);
        let again = |error: &std::io::Error| error.kind() == std::io::ErrorKind::Interrupted;
        self.failed = written.as_ref().is_err_and(|error| !again(error));
        written
    }

    fn flush(&mut self) -> std::io::Result<()> {
        match self.failed {
            true => Ok(()),
            false => self.out.flush(),
        }
    }
}

impl<W: Seek> Seek for Stopping<W> {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        self.out.seek(to)
    }
}

/// One array in NPY format.
fn write_array(
    out: impl Write,
    shape: &[u64],
    values: impl Iterator<Item = std::io::Result<f64>>,
) -> std::io::Result<()> {
    let mut array = npyz::WriteOptions::<f64>::new()
        .default_dtype()
        .shape(shape)
        .writer(BufWriter::new(out))
        .begin_nd()?;
    for value in values {
        array.push(&value?)?;
    }
    array.finish()
}

fn doubles(mut from: impl Read, count: u64) -> impl Iterator<Item = std::io::Result<f64>> {
    (0..count).map(move |_| {
        let mut bytes = [0; 8];
        from.read_exact(&mut bytes)?;
        Ok(f64::from_le_bytes(bytes))
    })
}

fn append(out: &mut impl Write, values: &[f64]) -> std::io::Result<()> {
    values
        .iter()
        .try_for_each(|value| out.write_all(&value.to_le_bytes()))
}

impl<S: Scratch> Observer for NpzWriter<S> {
    fn next(&self, from: u64) -> Option<u64> {
        self.selection.next(from)
    }

    fn observe(&mut self, step: u64, state: &State) {
        if self.written.is_ok() {
            self.rows += 1;
            self.last_step = step;
            let mut arrays = self.arrays.iter_mut();
            self.written =
                arrays.try_for_each(|array| append(&mut array.scratch, &(array.values)(state)));
        }
    }
}
