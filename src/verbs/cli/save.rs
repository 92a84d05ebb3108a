//! `--save` writes every step of every engine to files beside the report.

use super::target::Target;
use super::temporary::Temporary;
use crate::physics::State;
use crate::trajectory::{CsvWriter, NpzWriter, Observer, SaveError};
use crate::verbs::session::{Label, Saver};
use std::path::PathBuf;

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum FileKind {
    /// `t,id,x,y,z,vx,vy,vz`, to look at.
    Csv,
    /// `t` (T), `x` (T,N,3), `v` (T,N,3), for NumPy.
    Npz,
}

/// Settings of the files, one for each case.
#[derive(Debug)]
pub struct Files {
    pub kind: FileKind,
    pub folder: PathBuf,
    /// The number of steps from one row to the next.
    pub every: u64,
}

impl Files {
    /// A writer to a temporary file, which takes its name, `<engine>@<timestep>.csv`, when it is complete.
    pub fn saver(&self, case: &Label) -> Result<Box<dyn Saver>, SaveError> {
        let Label {
            engine,
            timestep,
            steps,
            particles,
        } = case;
        let path = |extension| {
            let name = format!("{engine}@{timestep}.{extension}");
            Target::of(&self.folder.join(name))
        };
        Ok(match self.kind {
            FileKind::Csv => {
                let target = path("csv")?;
                let file = target.begin()?;
                Box::new(Saving {
                    writer: CsvWriter::new(file, *steps, self.every, *timestep),
                    complete: CsvWriter::finish,
                    target,
                })
            }
            FileKind::Npz => {
                let target = path("npz")?;
                let file = target.begin()?;
                let scratch = [tempfile::tempfile()?, tempfile::tempfile()?];
                Box::new(Saving {
                    writer: NpzWriter::new(scratch, *particles, *steps, self.every, *timestep),
                    complete: |writer: NpzWriter<_>| writer.finish(file),
                    target,
                })
            }
        })
    }
}

/// A file that is being written: its writer, the function that completes it, and where it goes.
struct Saving<W, F> {
    writer: W,
    complete: F,
    target: Target,
}

impl<W: Observer, F> Observer for Saving<W, F> {
    fn next(&self, from: u64) -> Option<u64> {
        self.writer.next(from)
    }

    fn observe(&mut self, step: u64, state: &State) {
        self.writer.observe(step, state);
    }
}

impl<W, F> Saver for Saving<W, F>
where
    W: Observer,
    F: FnOnce(W) -> Result<Temporary, SaveError>,
{
    fn finish(self: Box<Self>) -> Result<(), SaveError> {
        let file = (self.complete)(self.writer)?;
        Ok(self.target.complete(file)?)
    }
}
