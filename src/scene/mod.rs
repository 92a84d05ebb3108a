//! The scene file: bytes in, a checked [`Scene`] out, or one error that points at its place.
//!
//! ```text
//! bytes -> text (size, UTF-8, nesting) -> read (keys and values, by the table of the model)
//!       -> complete (checks across several values) -> Scene
//! ```
//! Only [`Scene`] and its parts leave this module, so later stages need not check numbers again: ids are
//! valid, quantities are finite and within their bounds.

mod colliders;
mod complete;
mod drive;
mod error;
mod expand;
mod expect;
mod expectation;
pub mod limits;
pub mod model;
mod number;
pub mod object;
mod place;
mod read;
mod remake;
mod rods;
mod table;
mod text;
mod values;
mod vectors;
pub(crate) mod words;
mod write;

pub use colliders::TOUCHING;
pub use complete::check_times;
pub use drive::Drive;
pub use error::{Refusal, SceneError};
pub(crate) use expectation::{ALL, REST, SKIP};
pub use expectation::{Expectation, KeyKind, Names, OutcomeKey, Scope, Skipped, Wanted};
pub use model::{
    Air, Axis, Bending, Collider, Constraints, Contact, DampingModel, Driven, GravitationalPair,
    Knots, Magnetic, Particle, Penalty, Plane, Plot, Rod, Scene, Sine, SolverSpec, Spring,
    Stabilisation, StrainLimit, Table, Triangle, Wind, steps,
};
pub use number::ObjectNumber;
pub use table::{Value, Vectors};
pub use write::yaml;

use place::Problem;
use read::Reading;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Reads a scene from the bytes of a YAML file.
///
/// `file` names the source in errors and, without a `name` in the file, the scene. `names` are the ids
/// and words of other modules it may use: [`verbs::names`](crate::verbs::names). A UTF-8 BOM and
/// CRLF line ends are accepted.
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
        named: Vec::new(),
        problem: None,
    };
    read::document(text, &mut reading).map_err(located)?;
    complete::scene(reading).map_err(|problem| located(problem.locate(text)))
}

/// The line and column, from 1, of a key in the text of a scene file, such as `expect.rk4.status`; None where it
/// does not stand there.
pub fn place(text: &str, key: &str) -> Option<(u32, u32)> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let (mapping, last) = key.rsplit_once('.').unwrap_or(("", key));
    // The keys of outcomes have dots of their own: `expect.rk4.energy.class`.
    let scope = key
        .strip_prefix("expect.")
        .and_then(|rest| rest.split_once('.'));
    let (mapping, last) = match scope {
        Some((scope, last)) => (format!("expect.{scope}"), last),
        None => (mapping.to_owned(), last),
    };
    let fault = Problem::of_key(&mapping, last, Refusal::new("", "")).locate(text);
    let found = text.get(fault.offset..)?.starts_with(last);
    let error = SceneError::at("", text, fault);
    found.then_some((error.line?, error.column?))
}

/// The same in a file on disk; None also where it cannot be read.
pub fn place_in(file: &str, key: &str) -> Option<(u32, u32)> {
    let mut text = String::new();
    let opened = File::open(file).ok()?;
    opened
        .take(limits::FILE_BYTES as u64)
        .read_to_string(&mut text)
        .ok()?;
    place(&text, key)
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
    // One byte beyond the limit shows that the input is too long, even if it is a device that never ends.
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
