//! `springcheck init [DIR]`: the files of a solver that is held to its scheme in CI. They are those of
//! `examples/gate-python`, and the schema that the scene names.

use crate::scene::words::in_line;
use crate::verbs::cli::output;
use crate::verbs::cli::temporary::{self, Temporary};
use crate::verbs::schema;
use anyhow::{Context, bail};
use std::borrow::Cow;
use std::fs;
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
    write(&files)?;
    for (path, _) in &files {
        output::print(&format!("wrote {}\n", in_line(&path.display().to_string())))?;
    }
    if let Some(command) = command(folder) {
        output::print(&format!("next: {command}\n"))?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Writes all files, and the folders above them, or nothing. A file that is there, also since just now, stays as it is.
fn write(files: &[(PathBuf, Cow<str>)]) -> anyhow::Result<()> {
    let mut made = Made::default();
    let failed = |path: &Path| format!("nothing was written: cannot write {}", path.display());
    let mut contents = Vec::new();
    for (path, text) in files {
        let content = made.content(path, text);
        contents.push((path, content.with_context(|| failed(path))?));
    }
    for (path, content) in contents {
        content.become_new(path).with_context(|| failed(path))?;
        made.files.push(path.clone());
    }
    made.keep();
    Ok(())
}

/// What has been made so far. It is removed when this is dropped, unless it is kept.
#[derive(Default)]
struct Made {
    /// From the outermost.
    folders: Vec<PathBuf>,
    files: Vec<PathBuf>,
}

impl Made {
    /// A temporary file with this text, beside the path that it will have.
    fn content(&mut self, path: &Path, text: &str) -> std::io::Result<Temporary> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let above: Vec<&Path> = folder.ancestors().collect();
        let named = |above: &&Path| !above.as_os_str().is_empty();
        for folder in above
            .into_iter()
            .filter(named)
            .rev()
            .filter(|above| !above.exists())
        {
            fs::create_dir(folder)?;
            self.folders.push(folder.to_owned());
        }
        let here = folder.as_os_str().is_empty();
        let mut content = temporary::file(if here { Path::new(".") } else { folder })?;
        content.write_all(text.as_bytes())?;
        Ok(content)
    }

    fn keep(mut self) {
        self.files.clear();
        self.folders.clear();
    }
}

impl Drop for Made {
    fn drop(&mut self) {
        // What cannot be removed is left: the failure that is told is the first one.
        for file in &self.files {
            let _ = fs::remove_file(file);
        }
        for folder in self.folders.iter().rev() {
            let _ = fs::remove_dir(folder);
        }
    }
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
