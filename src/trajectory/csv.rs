//! Every step as text: `t,id,x,y,z,vx,vy,vz`, one row a particle; or other values of a state, one row each.

use super::{Observer, SaveError, Selection};
use crate::physics::State;
use std::io::{self, BufWriter, Write};

/// Values of a state beside it, such as forces.
pub type Values = Box<dyn Fn(&State) -> Vec<f64> + Send>;

/// The columns of a text beside `t` and `id`.
enum Columns {
    State,
    /// Those, and three more for each particle.
    With(Values),
    /// One value in each row.
    Alone(Values),
}

/// Writes rows as a run goes on. Numbers have the fewest digits that read back to the same bits.
pub struct CsvWriter<W: Write> {
    out: BufWriter<W>,
    columns: Columns,
    selection: Selection,
    timestep: f64,
    /// The first failure, which `finish` returns; later rows are dropped.
    written: io::Result<()>,
}

impl<W: Write> CsvWriter<W> {
    /// Writes every `every`-th of `steps` steps (0 counts as 1), and the last.
    pub fn new(out: W, steps: u64, every: u64, timestep: f64) -> Self {
        let header = "t,id,x,y,z,vx,vy,vz";
        Self::begin(
            out,
            header,
            Columns::State,
            Selection::new(every, steps),
            timestep,
        )
    }

    /// The same with three more columns of these names: `values` are three numbers a particle.
    pub fn with(
        out: W,
        names: [&str; 3],
        values: Values,
        (steps, every): (u64, u64),
        timestep: f64,
    ) -> Self {
        let header = format!("t,id,x,y,z,vx,vy,vz,{}", names.join(","));
        let columns = Columns::With(values);
        Self::begin(
            out,
            &header,
            columns,
            Selection::new(every, steps),
            timestep,
        )
    }

    /// Other values of each state, one a row: `t,id,<name>`.
    pub fn alone(
        out: W,
        name: &str,
        values: Values,
        (steps, every): (u64, u64),
        timestep: f64,
    ) -> Self {
        let columns = Columns::Alone(values);
        let selection = Selection::new(every, steps);
        Self::begin(out, &format!("t,id,{name}"), columns, selection, timestep)
    }

    fn begin(out: W, header: &str, columns: Columns, selection: Selection, timestep: f64) -> Self {
        let mut out = BufWriter::new(out);
        Self {
            written: writeln!(out, "{header}"),
            out,
            columns,
            selection,
            timestep,
        }
    }

    /// Flushes and hands the stream back.
    ///
    /// # Errors
    /// The first failure of the stream, whenever it happened.
    pub fn finish(self) -> Result<W, SaveError> {
        self.written?;
        let mut out = self
            .out
            .into_inner()
            .map_err(io::IntoInnerError::into_error)?;
        out.flush()?;
        Ok(out)
    }

    fn write(&mut self, step: u64, state: &State) -> io::Result<()> {
        let t = step as f64 * self.timestep;
        let beside = match &self.columns {
            Columns::State => Vec::new(),
            Columns::With(values) | Columns::Alone(values) => values(state),
        };
        if let Columns::Alone(_) = self.columns {
            for (id, value) in beside.iter().enumerate() {
                writeln!(self.out, "{t:?},{id},{value:?}")?;
            }
            return Ok(());
        }
        let particles = state.x.chunks_exact(3).zip(state.v.chunks_exact(3));
        for (id, (x, v)) in particles.enumerate() {
            write!(self.out, "{t:?},{id}")?;
            let more = beside.get(3 * id..3 * id + 3).unwrap_or_default();
            for value in x.iter().chain(v).chain(more) {
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
