//! `--save`: every step of every engine, in files beside the report.

use super::output::{Place, temporary};
use crate::physics::State;
use crate::trajectory::{CsvWriter, NpzWriter, Observer, SaveError};
use crate::verbs::host::{Label, Saver};
use std::fs::File;
use std::io::BufWriter;
use std::path::PathBuf;
use tempfile::NamedTempFile;

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum FileKind {
    /// `t,id,x,y,z,vx,vy,vz`, to look at.
    Csv,
    /// `t` (T), `x` (T,N,3), `v` (T,N,3), for NumPy.
    Npz,
}

/// Makes one file a case.
#[derive(Debug)]
pub struct Files {
    kind: FileKind,
    folder: PathBuf,
    every: u64,
}

impl Files {
    pub fn new(kind: FileKind, place: &Place, every: u64) -> Self {
        Self {
            kind,
            folder: place.folder().to_owned(),
            every,
        }
    }

    /// A writer into a temporary file that takes its name, `<engine>@<timestep>.csv`, at the end.
    pub fn saver(&self, case: &Label) -> Result<Box<dyn Saver>, SaveError> {
        let extension = match self.kind {
            FileKind::Csv => "csv",
            FileKind::Npz => "npz",
        };
        let path = self
            .folder
            .join(format!("{}@{}.{extension}", case.engine, case.timestep));
        let file = temporary(&self.folder)?;
        Ok(match self.kind {
            FileKind::Csv => {
                let out = BufWriter::new(file);
                let writer = CsvWriter::new(out, case.steps, self.every, case.timestep);
                Box::new(CsvFile { writer, path })
            }
            FileKind::Npz => {
                let scratch = [tempfile::tempfile()?, tempfile::tempfile()?];
                let writer = NpzWriter::new(
                    scratch,
                    case.particles,
                    case.steps,
                    self.every,
                    case.timestep,
                );
                Box::new(NpzFile { writer, file, path })
            }
        })
    }
}

struct CsvFile {
    writer: CsvWriter<BufWriter<NamedTempFile>>,
    path: PathBuf,
}

impl Observer for CsvFile {
    fn next(&self, from: u64) -> Option<u64> {
        self.writer.next(from)
    }
    fn observe(&mut self, step: u64, state: &State) {
        self.writer.observe(step, state);
    }
}

impl Saver for CsvFile {
    fn finish(self: Box<Self>) -> Result<(), SaveError> {
        let out = self.writer.finish()?;
        let file = out
            .into_inner()
            .map_err(std::io::IntoInnerError::into_error)?;
        persist(file, &self.path)
    }
}

struct NpzFile {
    writer: NpzWriter<File>,
    file: NamedTempFile,
    path: PathBuf,
}

impl Observer for NpzFile {
    fn next(&self, from: u64) -> Option<u64> {
        self.writer.next(from)
    }
    fn observe(&mut self, step: u64, state: &State) {
        self.writer.observe(step, state);
    }
}

impl Saver for NpzFile {
    fn finish(self: Box<Self>) -> Result<(), SaveError> {
        let NpzFile { writer, file, path } = *self;
        let file = writer.finish(file)?;
        persist(file, &path)
    }
}

fn persist(file: NamedTempFile, path: &std::path::Path) -> Result<(), SaveError> {
    file.persist(path)
        .map_err(|error| SaveError::Io(error.error))?;
    Ok(())
}
