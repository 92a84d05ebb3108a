//! Flags that several verbs have: the scene with its duration, `--truth`, lengths of time.

use super::target;
use crate::scene::{self, Names, Scene};
use crate::trajectory::{Expected, Plane};
use crate::truth::Demand;
use crate::verbs;
use anyhow::{Context, bail};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Duration;

/// The extensions of scene files, the usual one first.
pub const EXTENSIONS: [&str; 2] = ["yml", "yaml"];

/// The scene files that paths state, each once under its first name, which is without `./`: of a folder all in it and in
/// its folders, sorted. A link is a scene of its own.
///
/// # Errors
/// Fails where a folder cannot be read.
pub fn scenes(paths: &[PathBuf]) -> anyhow::Result<Vec<PathBuf>> {
    let mut seen = BTreeSet::new();
    let mut scenes = Vec::new();
    for path in paths {
        let found = match path.is_dir() {
            true => below(path)?,
            false => vec![path.clone()],
        };
        for scene in found {
            // Of a file that is not there, reading says so.
            let itself = target::without_aliases(&scene).unwrap_or_else(|_| scene.clone());
            if seen.insert(itself) {
                scenes.push(scene.strip_prefix(".").map(Path::to_owned).unwrap_or(scene));
            }
        }
    }
    Ok(scenes)
}

/// Refuses a folder without a scene.
///
/// # Errors
/// Fails where there is none, or a folder cannot be read.
pub fn refuse_empty(paths: &[PathBuf]) -> anyhow::Result<()> {
    for path in paths {
        if path.is_dir() && below(path)?.is_empty() {
            let what = EXTENSIONS.map(|extension| format!("*.{extension}"));
            bail!(
                "{}: there is no scene in this folder, expected files {}",
                path.display(),
                what.join(" or ")
            );
        }
    }
    Ok(())
}

/// The scene files of a folder and of its folders, sorted.
fn below(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    let read = collect(folder, &mut found);
    read.with_context(|| format!("cannot read {}", folder.display()))?;
    found.sort();
    Ok(found)
}

/// Collects the scene files of a folder. Hidden ones, and folders behind links, which may lead back, are
/// left out. What has the name of a scene and cannot be read is one: reading it says why.
fn collect(folder: &Path, found: &mut Vec<PathBuf>) -> std::io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let path = entry.path();
        let hidden = entry.file_name().as_encoded_bytes().starts_with(b".");
        let is_scene = || {
            EXTENSIONS
                .iter()
                .any(|e| path.extension().is_some_and(|own| own == *e))
        };
        if hidden {
            continue;
        } else if entry.file_type()?.is_dir() {
            collect(&path, found)?;
        } else if is_scene() && !path.is_dir() {
            // To read a pipe in a folder would wait for a writer for ever.
            if path.metadata().is_ok_and(|facts| !facts.is_file()) {
                let why = format!("{} is no regular file", path.display());
                return Err(std::io::Error::other(why));
            }
            found.push(path);
        }
    }
    Ok(())
}

/// The scene of a file, with another duration, s, where a flag states one.
///
/// # Errors
/// Fails where the file is no scene. Whether the duration fits a timestep,
/// [`check_times`](scene::check_times) checks.
pub fn scene(path: &Path, duration: Option<f64>) -> anyhow::Result<Scene> {
    let mut scene = scene_of(path, verbs::names())?;
    scene.duration = duration.unwrap_or(scene.duration);
    Ok(scene)
}

/// The scene of a file that may speak of these names.
///
/// # Errors
/// Fails where the file is no scene.
pub fn scene_of(path: &Path, names: &Names) -> anyhow::Result<Scene> {
    Ok(scene::read(path, names)?)
}

/// The parser of the values of `--truth`.
pub fn demand() -> impl TypedValueParser<Value = Demand> {
    PossibleValuesParser::new(["auto", "closed", "none"]).map(|kind| match kind.as_str() {
        "closed" => Demand::Closed,
        "none" => Demand::None,
        _ => Demand::Auto,
    })
}

/// The parser of the values of `--axes`.
pub fn plane() -> impl TypedValueParser<Value = Plane> {
    let names = Plane::ALL.map(Plane::name);
    PossibleValuesParser::new(names).map(|name| {
        let found = Plane::ALL.into_iter().find(|plane| plane.name() == name);
        // The parser lets no other name pass.
        found.unwrap_or(Plane::Xy)
    })
}

/// `60s`, `2m`, `1.5h`, `500ms`, or seconds without a unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Time(pub Duration);

impl FromStr for Time {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("expected a time such as 60s, 2m or 500ms, found `{text}`");
        let digits = text.trim_end_matches(char::is_alphabetic);
        let unit = match &text[digits.len()..] {
            "ms" => 1e-3,
            "" | "s" => 1.0,
            "m" | "min" => 60.0,
            "h" => 3600.0,
            _ => return Err(wrong()),
        };
        let seconds = digits.parse::<f64>().map_err(|_| wrong())? * unit;
        // Clocks can represent ten years, and no run takes longer.
        if !(seconds > 0.0 && seconds < 3e8) {
            return Err(wrong());
        }
        Duration::try_from_secs_f64(seconds).map_or_else(|_| Err(wrong()), |t| Ok(Self(t)))
    }
}

/// What the data of a program has to fit, of a plane where `--axes` says so.
///
/// # Errors
/// Fails where the scene moves particles along the third axis.
pub fn expected(scene: &Scene, timestep: f64, plane: Option<Plane>) -> anyhow::Result<Expected> {
    let expected = Expected::new(scene, timestep);
    let Some(plane) = plane else {
        return Ok(expected);
    };
    expected.in_plane(plane).map_err(|axis| {
        anyhow::anyhow!(
            "--axes {}: the scene moves particles along {axis} as well, so data of that plane alone \
             cannot be of it; gravity acts along the scene's `up`",
            plane.name()
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_with_and_without_units() {
        let ms = |text: &str| text.parse::<Time>().map(|t| t.0.as_millis()).ok();
        let good = [
            ("60s", 60_000),
            ("2m", 120_000),
            ("500ms", 500),
            ("1.5h", 5_400_000),
            ("7", 7_000),
            ("0.25", 250),
        ];
        for (text, wanted) in good {
            assert_eq!(ms(text), Some(wanted), "{text}");
        }
        for text in [
            "", "s", "0", "-1s", "inf", "NaN", "1e300", "5 s", "1d", "1m30s", "µs",
        ] {
            assert_eq!(ms(text), None, "{text}");
        }
    }
}
