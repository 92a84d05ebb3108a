//! The scene file: bytes in, a checked [`Scene`] out, or one error that points at its place.
//!
//! ```text
//! bytes -> text (size, UTF-8, nesting) -> read (keys and values, by the table of the model)
//!       -> complete (what concerns several values) -> Scene
//! ```
//! Only [`Scene`] and what it is made of leaves this module, so nothing after it needs to doubt a
//! number: ids are valid, quantities are finite and within their bounds.

mod complete;
mod error;
mod expect;
mod expectation;
pub mod limits;
pub mod model;
mod place;
mod read;
mod table;
mod text;
mod values;
pub(crate) mod words;

pub use complete::check_times;
pub use error::{Refusal, SceneError};
pub use expectation::{Expectation, Key, KeyKind, Names, Scope, Wanted};
pub use model::{
    Axis, DampingModel, GravitationalPair, Particle, Plot, Scene, Solver, Spring, Wind, steps,
};
pub use table::Value;

use read::Reading;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Reads a scene from the bytes of a YAML file.
///
/// `file` names the source in errors and, without a `name` in the file, the scene. `names` are the
/// words of other stages it may use: [`verbs::names`](crate::verbs::names). A UTF-8 BOM and
/// CRLF line ends are fine.
///
/// # Errors
/// The first thing wrong, with its line and column. No input panics.
pub fn parse(bytes: &[u8], file: &str, names: &Names) -> Result<Scene, SceneError> {
    if bytes.len() > limits::FILE_BYTES {
        let cap = limits::FILE_BYTES >> 20;
        return Err(SceneError::of_file(
            file,
            format!("expected at most {cap} MiB"),
        ));
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let text = text::check(bytes)
        .map_err(|fault| SceneError::at(file, &String::from_utf8_lossy(bytes), fault))?;
    let located = |fault| SceneError::at(file, text, fault);
    let mut scene = Scene {
        file: file.to_owned(),
        ..Scene::default()
    };
    if let Some(stem) = Path::new(file).file_stem() {
        scene.name = stem.to_string_lossy().replace(char::is_control, " ");
    }
    let mut reading = Reading {
        scene,
        names,
        no_id: None,
        problem: None,
    };
    read::document(text, &mut reading).map_err(located)?;
    complete::scene(reading).map_err(|problem| located(problem.locate(text)))
}

/// Reads a scene file from disk.
///
/// # Errors
/// A missing or unreadable file, a directory and a file above [`limits::FILE_BYTES`] are errors
/// without a line; the others are those of [`parse`].
pub fn read(path: &Path, names: &Names) -> Result<Scene, SceneError> {
    let file = path.display().to_string();
    let refuse = |message: String| Err(SceneError::of_file(&file, message));
    if path.is_dir() {
        return refuse("this is a directory: name a scene file, such as scene.yml".into());
    }
    let mut bytes = Vec::new();
    // One byte beyond the cap is enough to know, even of a pipe or a device that never ends.
    let opened = File::open(path).and_then(|f| {
        f.take(limits::FILE_BYTES as u64 + 1)
            .read_to_end(&mut bytes)
    });
    match opened {
        Ok(_) => parse(&bytes, &file, names),
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => {
            refuse("there is no such file".into())
        }
        Err(e) => refuse(format!("cannot be read: {e}")),
    }
}
