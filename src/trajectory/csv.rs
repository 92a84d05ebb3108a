//! Every step as text: `t,id,x,y,z,vx,vy,vz`, one row a particle.

use super::{SaveError, Selection};
use crate::physics::State;
use crate::solvers::Observer;
use std::io::Write;

/// Writes rows as a run goes on. Numbers have the fewest digits that read back to the same bits.
pub struct CsvWriter<W: Write> {
    rows: csv::Writer<W>,
    selection: Selection,
    timestep: f64,
    /// The first failure; what follows is dropped and `finish` tells.
    failed: Option<csv::Error>,
}

impl<W: Write> CsvWriter<W> {
    /// Every `every`-th of `steps` steps (0 counts as 1), and the last.
    pub fn new(out: W, steps: u64, every: u64, timestep: f64) -> Self {
        let mut rows = csv::Writer::from_writer(out);
        let header = ["t", "id", "x", "y", "z", "vx", "vy", "vz"];
        let failed = rows.write_record(header).err();
        Self {
            rows,
            selection: Selection::new(every, steps),
            timestep,
            failed,
        }
    }

    /// Flushes and hands the stream back.
    ///
    /// # Errors
    /// The first failure of the stream, whenever it happened.
    pub fn finish(self) -> Result<W, SaveError> {
        if let Some(error) = self.failed {
            return Err(std::io::Error::other(error).into());
        }
        let out = self.rows.into_inner();
        Ok(out.map_err(|e| std::io::Error::other(e.to_string()))?)
    }

    fn write(&mut self, step: u64, state: &State) -> Result<(), csv::Error> {
        let t = format!("{:?}", step as f64 * self.timestep);
        let particles = state.x.chunks_exact(3).zip(state.v.chunks_exact(3));
        for (id, (x, v)) in particles.enumerate() {
            self.rows.write_field(&t)?;
            self.rows.write_field(id.to_string())?;
            for value in x.iter().chain(v) {
                self.rows.write_field(format!("{value:?}"))?;
            }
            self.rows.write_record(None::<&[u8]>)?;
        }
        Ok(())
    }
}

impl<W: Write> Observer for CsvWriter<W> {
    fn next(&self, from: u64) -> Option<u64> {
        self.selection.next(from)
    }

    fn observe(&mut self, step: u64, state: &State) {
        if self.failed.is_none() {
            self.failed = self.write(step, state).err();
        }
    }
}
