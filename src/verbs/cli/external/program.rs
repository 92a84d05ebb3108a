//! A command as the library's [`Program`].

use super::process;
use crate::solvers::external::{Command, Failure, Flat, Placeholder, Program, Recording, Task};
use crate::trajectory::{self, Expected, Layout};
use std::ffi::OsString;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// More than this is not taken from a program, bytes.
const LIMIT: usize = 1 << 30;

/// A command that is started anew for each task.
pub struct Started {
    pub command: Command,
    /// The scene file, absolute.
    pub scene: PathBuf,
    pub timeout: Duration,
}

impl Program for Started {
    fn record(&self, task: &Task) -> Result<Recording, Failure> {
        // Removed with everything in it when it goes out of scope.
        let folder = tempfile::Builder::new()
            .prefix("springcheck-")
            .tempdir()
            .map_err(Failure::io("make a temporary folder"))?;
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
        let ended = process::run(&words, self.timeout, LIMIT)?;
        let expected = Expected::new(task.scene, task.timestep);
        let rows = if self.command.uses(Placeholder::Output) {
            let bytes = read(&output)?;
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
    let file = match std::fs::File::open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Err(Failure::NoFile),
        Err(error) => return Err(doing(error)),
    };
    let mut bytes = Vec::new();
    let wanted = file.take(LIMIT as u64 + 1).read_to_end(&mut bytes);
    if wanted.map_err(doing)? > LIMIT {
        return Err(Failure::TooMuch { limit: LIMIT });
    }
    Ok(bytes)
}
