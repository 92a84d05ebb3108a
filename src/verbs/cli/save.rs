//! `--save` writes every step of every engine to files beside the report.

use super::target::Target;
use super::temporary::Temporary;
use crate::measure::Statics;
use crate::physics::State;
use crate::trajectory::{CsvWriter, NpzWriter, Observer, SaveError, Values};
use crate::verbs::session::{Label, Saver};
use std::path::PathBuf;

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum FileKind {
    /// `t,id,x,y,z,vx,vy,vz`, to look at.
    Csv,
    /// `t` (T), `x` (T,N,3), `v` (T,N,3), for NumPy.
    Npz,
}

/// Static quantities that may be asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Column {
    /// What holds each fixed particle, N: `rx,ry,rz`, or `reaction` (T,N,3).
    Reaction,
    /// How much each spring pulls, N: a file `.tension.csv` of `t,id,tension`, or `tension` (T,M). Of rods, where there
    /// are some, `.rod_tension.csv` and `rod_tension` (T,R).
    Tension,
}

/// Settings of the files, one for each case.
pub struct Files {
    pub kind: FileKind,
    pub folder: PathBuf,
    /// The number of steps from one row to the next.
    pub every: u64,
    /// What is saved beside the states, and what computes it.
    pub columns: Vec<Column>,
    pub statics: Statics,
    /// The number of springs.
    pub springs: usize,
    /// The number of rods.
    pub rods: usize,
}

/// What one column stands for: springs, and rods.
#[derive(Debug, Clone, Copy)]
enum Quantity {
    Reaction,
    Spring,
    Rod,
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
        let asked = |column| self.columns.contains(&column);
        let rows = (*steps, self.every);
        match self.kind {
            FileKind::Csv => {
                let target = path("csv")?;
                let file = target.begin()?;
                let states = if asked(Column::Reaction) {
                    let reaction = self.values(Quantity::Reaction);
                    CsvWriter::with(file, ["rx", "ry", "rz"], reaction, rows, *timestep)
                } else {
                    CsvWriter::new(file, *steps, self.every, *timestep)
                };
                let mut files = vec![(states, target)];
                for (quantity, extension, members) in [
                    (Quantity::Spring, "tension.csv", self.springs),
                    (Quantity::Rod, "rod_tension.csv", self.rods),
                ] {
                    if !asked(Column::Tension) || self.leaves_out(quantity, members) {
                        continue;
                    }
                    let target = path(extension)?;
                    let (file, tension) = (target.begin()?, self.values(quantity));
                    let tensions = CsvWriter::alone(file, "tension", tension, rows, *timestep);
                    files.push((tensions, target));
                }
                let files = files.into_iter().map(|(writer, target)| Saving {
                    writer,
                    complete: CsvWriter::finish as fn(_) -> _,
                    target,
                });
                Ok(Box::new(Several(files.collect())))
            }
            FileKind::Npz => {
                let target = path("npz")?;
                let file = target.begin()?;
                let scratch = [tempfile::tempfile()?, tempfile::tempfile()?];
                let mut writer = NpzWriter::new(scratch, *particles, *steps, self.every, *timestep);
                let [springs, rods] = [self.springs, self.rods].map(|members| members as u64);
                for (column, quantity, name, shape) in [
                    (
                        Column::Reaction,
                        Quantity::Reaction,
                        "reaction",
                        vec![*particles as u64, 3],
                    ),
                    (Column::Tension, Quantity::Spring, "tension", vec![springs]),
                    (Column::Tension, Quantity::Rod, "rod_tension", vec![rods]),
                ] {
                    if asked(column) && !self.leaves_out(quantity, shape[0] as usize) {
                        let scratch = tempfile::tempfile()?;
                        writer = writer.with(name, shape, self.values(quantity), scratch);
                    }
                }
                Ok(Box::new(Saving {
                    writer,
                    complete: |writer: NpzWriter<_>| writer.finish(file),
                    target,
                }))
            }
        }
    }

    /// Whether a quantity of so many members is not written: rods are only where there are some.
    fn leaves_out(&self, quantity: Quantity, members: usize) -> bool {
        matches!(quantity, Quantity::Rod) && members == 0
    }

    fn values(&self, quantity: Quantity) -> Values {
        let statics = self.statics.clone();
        Box::new(move |state| match quantity {
            Quantity::Reaction => statics.reactions(state),
            Quantity::Spring => statics.tensions(state),
            Quantity::Rod => statics.rod_tensions(state),
        })
    }
}

/// Files of the same steps.
struct Several<S>(Vec<S>);

impl<S: Observer> Observer for Several<S> {
    fn next(&self, from: u64) -> Option<u64> {
        self.0.first()?.next(from)
    }

    fn observe(&mut self, step: u64, state: &State) {
        self.0.iter_mut().for_each(|file| file.observe(step, state));
    }
}

impl<S: Saver> Saver for Several<S> {
    fn finish(self: Box<Self>) -> Result<(), SaveError> {
        self.0
            .into_iter()
            .try_for_each(|file| Box::new(file).finish())
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
