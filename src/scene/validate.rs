//! From the file's shape to its meaning: defaults, bounds, references. The first problem ends it.

use super::check::{quantity, quantity_or, required};
use super::expect::expectations;
use super::leaf::{Items, Text};
use super::limits;
use super::locate::Problem;
use super::members;
use super::model::{Axis, DampingModel, Scene, Solver};
use super::names::Names;
use super::path::At;
use super::raw::{RawScene, RawSolver};
use super::shown::shorten;
use super::suggest;
use super::times::check_times;
use std::path::Path;

const ROOT: At = At::Root;
const AXES: [(&str, Axis); 3] = [("z", Axis::Z), ("x", Axis::X), ("y", Axis::Y)];
const DAMPING_MODELS: [(&str, DampingModel); 2] = [
    ("axial", DampingModel::Axial),
    ("isotropic", DampingModel::Isotropic),
];

/// The scene `raw` describes.
pub(super) fn scene(raw: RawScene, file: &str, names: &Names) -> Result<Scene, Problem> {
    let name = name(raw.name, file)?;
    let description = raw.description.map(description).transpose()?;
    let solver = solver(raw.solver, &names.methods)?;
    let duration = quantity_or(raw.duration, 5.0, limits::DURATION, ROOT.key("duration"))?;
    check_times(solver.timestep, duration).map_err(|error| {
        let solver = ROOT.key("solver");
        Problem::new(solver.key("timestep"), error.message, error.help)
    })?;
    let (particles, weighed) = members::particles(raw.particles)?;
    let springs = each(raw.springs, "springs", |spring, at| {
        members::spring(spring, &particles, at)
    })?;
    let gravitational = each(raw.gravitational, "gravitational", |pair, at| {
        members::pair(pair, &particles, &weighed, at)
    })?;
    let plot = raw
        .plot
        .map(|p| members::plot(p, particles.len(), ROOT.key("plot")))
        .transpose()?;
    Ok(Scene {
        name,
        description,
        file: file.to_owned(),
        solver,
        duration,
        up: choice(raw.up, &AXES, ROOT.key("up"))?,
        damping_model: choice(
            raw.damping_model,
            &DAMPING_MODELS,
            ROOT.key("damping_model"),
        )?,
        plot,
        wind: raw
            .wind
            .map(|w| members::wind(w, ROOT.key("wind")))
            .transpose()?,
        expect: expectations(raw.expect, names, ROOT.key("expect"))?,
        particles,
        springs,
        gravitational,
    })
}

/// Every item of a list, which may be absent.
fn each<T, U>(
    items: Option<Items<T>>,
    key: &'static str,
    judge: impl Fn(T, At) -> Result<U, Problem>,
) -> Result<Vec<U>, Problem> {
    let items = items.map(|items| items.0).unwrap_or_default();
    let list = ROOT.key(key);
    items
        .into_iter()
        .enumerate()
        .map(|(i, item)| judge(item, list.index(i)))
        .collect()
}

fn name(name: Option<Text>, file: &str) -> Result<String, Problem> {
    let Some(Text(name)) = name else {
        let stem = Path::new(file).file_stem().map(|s| s.to_string_lossy());
        return Ok(stem.map_or("scene".into(), |s| s.replace(char::is_control, " ")));
    };
    let at = ROOT.key("name");
    if name.trim().is_empty() {
        return Err(Problem::new(
            at,
            "expected a name, found none",
            "without the key it is the file's",
        ));
    }
    if name.chars().count() > limits::NAME_CHARS {
        let message = format!("expected at most {} characters", limits::NAME_CHARS);
        return Err(Problem::new(
            at,
            message,
            "the rest may go into `description`",
        ));
    }
    if name.contains(char::is_control) {
        return Err(Problem::new(
            at,
            "expected one line without control characters",
            "",
        ));
    }
    Ok(name)
}

fn description(Text(text): Text) -> Result<String, Problem> {
    // Reports print it: an escape sequence would reach the terminal.
    if text.contains(|c: char| c.is_control() && !matches!(c, '\n' | '\t')) {
        let at = ROOT.key("description");
        return Err(Problem::new(
            at,
            "expected text without control characters",
            "",
        ));
    }
    Ok(text)
}

fn solver(raw: Option<RawSolver>, methods: &[&str]) -> Result<Solver, Problem> {
    let at = ROOT.key("solver");
    let raw = required(
        raw,
        at,
        "add `solver: {type: symplectic_euler, timestep: 0.0005}`",
    )?;
    let method = required(
        raw.method,
        at.key("type"),
        "name an integrator, as symplectic_euler",
    )?;
    let method = known(method, methods, "integrator", at.key("type"))?;
    let timestep = at.key("timestep");
    let gravity = at.key("gravity");
    Ok(Solver {
        method: methods[method].to_owned(),
        timestep: quantity(
            required(
                raw.timestep,
                timestep,
                "give the step in seconds, as 0.0005",
            )?,
            limits::TIMESTEP,
            timestep,
        )?,
        gravity: quantity_or(raw.gravity, -9.81, limits::GRAVITY, gravity)?,
        tolerance: raw
            .tolerance
            .map(|t| quantity(t, limits::TOLERANCE, at.key("tolerance")))
            .transpose()?,
    })
}

/// The row the text names; the first one without text.
fn choice<T: Copy>(text: Option<Text>, rows: &[(&str, T)], at: At) -> Result<T, Problem> {
    let names: Vec<&str> = rows.iter().map(|(name, _)| *name).collect();
    let index = text.map_or(Ok(0), |text| known(text, &names, "choice", at))?;
    Ok(rows[index].1)
}

/// The index of the word among those known.
fn known(Text(word): Text, words: &[&str], what: &str, at: At) -> Result<usize, Problem> {
    words.iter().position(|w| *w == word).ok_or_else(|| {
        let word = shorten(&word);
        let message = format!(
            "unknown {what} `{word}`: expected one of {}",
            words.join(", ")
        );
        let help = suggest::nearest(&word, words).map(|w| format!("did you mean `{w}`?"));
        Problem::new(at, message, help.unwrap_or_default())
    })
}
