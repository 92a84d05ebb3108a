//! Every step as text: `t,id,x,y,z,vx,vy,vz`, one row a particle.

use super::{Observer, SaveError, Selection};
use crate::physics::State;
use std::io::{self, Write};

/// Writes rows as a run goes on. Numbers have the fewest digits that read back to the same bits.
pub struct CsvWriter<W: Write> {
    out: W,
    selection: Selection,
    timestep: f64,
    /// The first failure, which `finish` returns; later rows are dropped.
    written: io::Result<()>,
}

impl<W: Write> CsvWriter<W> {
    /// Writes every `every`-th of `steps` steps (0 counts as 1), and the last. `out` should be buffered.
    pub fn new(mut out: W, steps: u64, every: u64, timestep: f64) -> Self {
        Self {
            written: writeln!(out, "t,id,x,y,z,vx,vy,vz"),
            out,
            selection: Selection::new(every, steps),
            timestep,
        }
    }

    /// Flushes and hands the stream back.
    ///
    /// # Errors
    /// The first failure of the stream, whenever it happened.
    pub fn finish(mut self) -> Result<W, SaveError> {
        self.written?;
        self.out.flush()?;
        Ok(self.out)
    }

    fn write(&mut self, step: u64, state: &State) -> io::Result<()> {
        let t = step as f64 * self.timestep;
        let particles = state.x.chunks_exact(3).zip(state.v.chunks_exact(3));
        for (id, (x, v)) in particles.enumerate() {
            write!(self.out, "{t:?},{id}")?;
            for value in x.iter().chain(v) {
                write!(self.out, ",{value:?}")?;
            }
            writeln!(self.out)?;
        }
        Ok(())
    }
}

impl<W: Write> Observer for CsvWriter<W> {
    fn next(&self, from: u64) -> Option<u64> {
        self.selection.next(from)
    }

    fn observe(&mut self, step: u64, state: &State) {
        if self.written.is_ok() {
            self.written = self.write(step, state);
        }
    }
}
