//! `--external NAME='COMMAND ...'` adds a row that another program computes.

mod process;

use super::flags::{self, Time};
use super::temporary;
use crate::integrators;
use crate::scene::Scene;
use crate::scene::limits::external;
use crate::solvers::external::{
    Command, CommandError, Failure, Flat, Placeholder, Program, Recording, Task,
};
use crate::solvers::{Solver, rapier};
use crate::trajectory::{self, Expected, Layout, Plane};
use anyhow::bail;
use std::ffi::OsString;
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;

/// The flag's value: the program's name in reports, and its command.
#[derive(Debug, Clone)]
pub struct External {
    name: String,
    command: Command,
}

impl FromStr for External {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, command) = text
            .split_once('=')
            .ok_or_else(|| format!("expected NAME=COMMAND, found `{text}`"))?;
        external(name).map_err(|refusal| refusal.to_string())?;
        Ok(Self {
            name: name.to_owned(),
            command: command.parse().map_err(|e: CommandError| e.to_string())?,
        })
    }
}

impl External {
    pub fn name(&self) -> &str {
        &self.name
    }
}

/// Refuses names that are taken or repeated, before any work is done.
pub fn distinct(externals: &[External]) -> anyhow::Result<()> {
    let methods = integrators::ids(integrators::fixed());
    let aliases = integrators::ALIASES.iter().map(|(short, _)| *short);
    let taken: Vec<&str> = (methods.into_iter().chain(aliases).chain(rapier::IDS)).collect();
    for (at, External { name, .. }) in externals.iter().enumerate() {
        // Some file systems ignore case, and names are part of file names.
        let same = |other: &str| other.eq_ignore_ascii_case(name);
        if taken.iter().any(|id| same(id)) {
            bail!("--external {name}: an integrator or engine has this name, choose another");
        }
        if externals[..at].iter().any(|other| same(&other.name)) {
            bail!("--external {name}: the name is given twice");
        }
    }
    Ok(())
}

/// How programs are run: what the flags beside `--external` say.
#[derive(Debug, Clone, Copy)]
pub struct Terms {
    pub timeout: Time,
    /// The axes that their rows have; None for all three.
    pub axes: Option<Plane>,
}

/// The programs, ready to run on this scene, read from that path.
///
/// # Errors
/// Fails where rows of these axes cannot be of the scene.
pub fn chosen(
    externals: &[External],
    scene: &Scene,
    path: &Path,
    terms: Terms,
) -> anyhow::Result<Vec<Solver>> {
    if !externals.is_empty() {
        flags::expected(scene, scene.solver.timestep, terms.axes)?;
    }
    let ready = |external: &External| {
        let program = CommandProgram {
            command: external.command.clone(),
            scene: std::path::absolute(path).unwrap_or_else(|_| path.to_owned()),
            terms,
        };
        Solver::program(&external.name, Arc::new(program))
    };
    Ok(externals.iter().map(ready).collect())
}

/// The largest output taken from a program, bytes.
const MAX_BYTES: usize = 1 << 30;

/// A program that is a command, started anew for each task.
struct CommandProgram {
    command: Command,
    /// The scene file, absolute.
    scene: PathBuf,
    terms: Terms,
}

impl Program for CommandProgram {
    fn record(&self, task: &Task) -> Result<Recording, Failure> {
        // The folder is removed with its contents when it goes out of scope.
        let folder = temporary::folder().map_err(Failure::io("make a temporary folder"))?;
        let json = folder.path().join("scene.json");
        let output = folder.path().join("trajectory.npz");
        if self.command.uses(Placeholder::SceneJson) {
            write(&json, task)?;
        }
        let words = self.command.words(|placeholder| match placeholder {
            Placeholder::Scene => self.scene.clone().into_os_string(),
            Placeholder::SceneJson => json.clone().into_os_string(),
            // The fewest digits that read back to the same bits.
            Placeholder::Timestep => OsString::from(format!("{:?}", task.timestep)),
            Placeholder::Duration => OsString::from(format!("{:?}", task.scene.duration)),
            Placeholder::Output => output.clone().into_os_string(),
        });
        let in_file = self.command.uses(Placeholder::Output);
        let ended = process::run(&words, self.terms.timeout.0, MAX_BYTES, !in_file)?;
        // Axes that do not fit were refused before.
        let expected = flags::expected(task.scene, task.timestep, self.terms.axes)
            .unwrap_or_else(|_| Expected::new(task.scene, task.timestep));
        let rows = if in_file {
            let bytes = ended.within("its {output}", move || read(&output))?;
            trajectory::read(&bytes, "{output}", Some(Layout::Npz), &expected)?
        } else if ended.stdout.is_empty() {
            return Err(Failure::Silent);
        } else {
            trajectory::read(&ended.stdout, "stdout", None, &expected)?
        };
        Ok(Recording {
            rows,
            seconds: Some(ended.seconds),
        })
    }
}

fn write(path: &Path, task: &Task) -> Result<(), Failure> {
    let doing = Failure::io("write {scene_json}");
    let bytes = serde_json::to_vec(&Flat(task)).map_err(std::io::Error::other);
    std::fs::write(path, bytes.map_err(&doing)?).map_err(doing)
}

fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    let doing = Failure::io("read {output}");
    let file = match File::open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == ErrorKind::NotFound => return Err(Failure::NoFile),
        Err(error) => return Err(doing(error)),
    };
    let mut bytes = Vec::new();
    let wanted = file.take(MAX_BYTES as u64 + 1).read_to_end(&mut bytes);
    if wanted.map_err(doing)? > MAX_BYTES {
        return Err(Failure::TooMuch { limit: MAX_BYTES });
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_short_plain_and_not_taken() {
        let flag = |name: &str| format!("{name}=./a {{scene}}").parse::<External>();
        for name in ["mine", "mine.py", "2nd-try", "größe", "a+b_c"] {
            assert!(flag(name).is_ok(), "{name}");
        }
        let long = "x".repeat(33);
        for name in [
            "",
            " ",
            ".hidden",
            "-x",
            "a b",
            "a/b",
            "a\nb",
            "rapier(x)",
            &long,
        ] {
            assert!(flag(name).is_err(), "{name:?}");
        }
        assert!("mine".parse::<External>().is_err());
        let both = |names: &[&str]| {
            let flags: Vec<_> = names.iter().map(|n| flag(n).expect("a flag")).collect();
            distinct(&flags).map_err(|e| e.to_string())
        };
        assert_eq!(both(&["mine", "yours"]), Ok(()));
        for names in [&["rk4"][..], &["Rapier"], &["mine", "yours", "MINE"]] {
            assert!(both(names).is_err(), "{names:?}");
        }
    }
}
