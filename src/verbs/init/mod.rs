//! `springcheck init [DIR]`: the files of a solver that is held to its scheme in CI. They are those of
//! `examples/gate-python`, and the schema that the scene names.

use crate::scene::words::visible;
use crate::verbs::cli::output;
use crate::verbs::schema;
use anyhow::{Context, bail};
use std::borrow::Cow;
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// The folder to write to; it is made if it is not there.
    #[arg(value_name = "DIR", default_value = ".")]
    folder: PathBuf,
}

const SCENE: &str = "scene.yml";
const SOLVER: &str = "solver.py";

/// The name of each file and its text.
fn files() -> [(&'static str, Cow<'static, str>); 4] {
    macro_rules! example {
        ($name:literal) => {
            include_str!(concat!("../../../examples/gate-python/", $name)).into()
        };
    }
    [
        (SCENE, example!("scene.yml")),
        (SOLVER, example!("solver.py")),
        (
            ".github/workflows/springcheck.yml",
            example!(".github/workflows/springcheck.yml"),
        ),
        ("scene.schema.json", schema::scene_text().into()),
    ]
}

/// Writes the files, unless one of them is there.
pub fn init(args: &Args) -> anyhow::Result<ExitCode> {
    // `./scene.yml` is `scene.yml`.
    let folder = args.folder.strip_prefix(".").unwrap_or(&args.folder);
    let files = files().map(|(name, text)| (folder.join(name), text));
    // A link that leads nowhere is there too.
    let there = files
        .iter()
        .filter(|(path, _)| path.symlink_metadata().is_ok());
    let there: Vec<String> = there.map(|(path, _)| path.display().to_string()).collect();
    if !there.is_empty() {
        bail!(
            "nothing was written, since this is there: {}; name another folder",
            there.join(", ")
        );
    }
    for (path, text) in &files {
        write(path, text).with_context(|| format!("cannot write {}", path.display()))?;
        output::print(&format!("wrote {}\n", visible(&path.display().to_string())))?;
    }
    if let Some(command) = command(folder) {
        output::print(&format!("next: {command}\n"))?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Writes a new file, and the folders above it. A file that is there, also since just now, stays as it is.
fn write(path: &Path, text: &str) -> std::io::Result<()> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    File::create_new(path)?.write_all(text.as_bytes())
}

/// The command that holds the solver to its scheme, for a POSIX shell; None where a terminal cannot show its paths.
fn command(folder: &Path) -> Option<String> {
    let scene = output::quoted(&folder.join(SCENE))?;
    let solver = output::quoted(&folder.join(SOLVER))?;
    // Of the command of another program, braces are placeholders.
    let solver = solver.replace('{', "{{").replace('}', "}}");
    let external = format!("python3 {solver} {{scene_json}}").replace('\'', r"'\''");
    Some(format!(
        "springcheck check {scene} --external mine='{external}' --claims mine=symplectic_euler"
    ))
}
