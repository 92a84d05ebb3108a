//! A run that was accepted: the deterministic figures of every scene, to see what moved since.

use super::laws;
use crate::measure::{Check, CheckStatus};
use crate::scene::{self, Scene};
use crate::verbs::Report;
use crate::verbs::run::Outcome;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;

/// The layout of the file.
const SCHEMA_VERSION: u64 = 1;
/// Numbers this close, relative or in their unit, are the same: other machines have another sine.
const RELATIVE: f64 = 1e-6;
const ABSOLUTE: f64 = 1e-12;
/// The most changes of one engine that a message lists.
const LISTED: usize = 3;

/// Figures by scene, then by `engine@timestep`, then by key.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Baseline {
    schema_version: u64,
    scenes: BTreeMap<String, Engines>,
    /// What each scene was, as [`digest`].
    #[serde(default)]
    digests: BTreeMap<String, String>,
}

type Engines = BTreeMap<String, Figures>;
type Figures = BTreeMap<String, Value>;

/// Why a text is no baseline.
#[derive(Debug, thiserror::Error)]
pub enum BaselineError {
    #[error("expected a baseline, as `check --accept FILE` writes it: {0}")]
    NoBaseline(serde_json::Error),
    #[error("a baseline of layout {0}; this program reads {SCHEMA_VERSION}: accept it anew")]
    Other(u64),
}

impl Default for Baseline {
    fn default() -> Self {
        Self {
            schema_version: SCHEMA_VERSION,
            scenes: BTreeMap::new(),
            digests: BTreeMap::new(),
        }
    }
}

/// The keys that stand: what a run is, does and costs in counts. What only describes rounding is left out.
const KEPT: &[&str] = &[
    "status",
    "stopped_at_s",
    "position_error_m.",
    "velocity_error_m_s.",
    "energy.",
    "momentum.",
    "strain.largest",
    "strain.met",
    "work.",
    "identified.method",
    "identified.substeps",
];

/// The SHA-256 of all that decides a scene's runs, in hexadecimal digits: what it is called, shows and expects does not.
fn digest(scene: &Scene) -> String {
    let mut bare = Scene {
        name: String::new(),
        description: None,
        plot: None,
        externals: Vec::new(),
        expect: Vec::new(),
        skip: Vec::new(),
        ..scene.clone()
    };
    bare.file.clear();
    let digest = Sha256::digest(scene::yaml(&bare));
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn figures(outcome: &Outcome) -> Figures {
    let mut found = Figures::new();
    flatten(
        "",
        &serde_json::to_value(outcome).unwrap_or_default(),
        &mut found,
    );
    found.retain(|key, _| {
        KEPT.iter()
            .any(|kept| key == kept || kept.ends_with('.') && key.starts_with(kept))
    });
    found
}

fn flatten(path: &str, value: &Value, found: &mut Figures) {
    match value {
        Value::Object(keys) => {
            for (key, value) in keys {
                let path = if path.is_empty() {
                    key.clone()
                } else {
                    format!("{path}.{key}")
                };
                flatten(&path, value, found);
            }
        }
        Value::Number(_) | Value::String(_) | Value::Bool(_) => {
            found.insert(path.to_owned(), value.clone());
        }
        Value::Null | Value::Array(_) => {}
    }
}

fn engines(report: &Report) -> Engines {
    let named = |o: &Outcome| (format!("{}@{:?}", o.engine, o.timestep), figures(o));
    report.outcomes().iter().map(named).collect()
}

/// Whether two figures are the same: words and counts equal, other numbers near.
fn same(a: &Value, b: &Value) -> bool {
    match (a.as_f64(), b.as_f64()) {
        (Some(x), Some(y)) if !(a.is_u64() && b.is_u64()) => {
            (x - y).abs() <= RELATIVE * x.abs().max(y.abs()) + ABSOLUTE
        }
        _ => a == b,
    }
}

impl Baseline {
    /// Reads what [`text`](Self::text) wrote.
    ///
    /// # Errors
    /// [`BaselineError`] for every other text.
    pub fn read(text: &[u8]) -> Result<Self, BaselineError> {
        let baseline: Self = serde_json::from_slice(text).map_err(BaselineError::NoBaseline)?;
        match baseline.schema_version {
            SCHEMA_VERSION => Ok(baseline),
            other => Err(BaselineError::Other(other)),
        }
    }

    /// As JSON, in the order of the keys.
    pub fn text(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).unwrap_or_default();
        text.push('\n');
        text
    }

    /// Takes in the figures of these runs. Numbers that are the same stay as they were, digit for digit, and so do
    /// scenes that did not run.
    pub fn accept<'a>(&mut self, runs: impl Iterator<Item = (&'a Report, &'a Scene)>) {
        for (report, scene) in runs {
            let mut engines = engines(report);
            let before = self
                .scenes
                .remove(&report.header.scene.file)
                .unwrap_or_default();
            for (engine, figures) in &mut engines {
                let Some(before) = before.get(engine) else {
                    continue;
                };
                for (key, value) in figures {
                    if let Some(kept) = before.get(key).filter(|kept| same(kept, value)) {
                        *value = kept.clone();
                    }
                }
            }
            let file = &report.header.scene.file;
            self.scenes.insert(file.clone(), engines);
            self.digests.insert(file.clone(), digest(scene));
        }
    }

    /// A check for each engine of a scene: what moved, and by how much.
    pub fn check(&self, report: &Report, scene: &Scene) -> Vec<Check> {
        let Some(row) = laws::find("baseline") else {
            return Vec::new();
        };
        let Some(before) = self.scenes.get(&report.header.scene.file) else {
            let message = "the baseline has no such scene: --accept takes it in".to_owned();
            return vec![row.with("scene", CheckStatus::Inconclusive, message)];
        };
        let accepted = self.digests.get(&report.header.scene.file);
        if accepted.is_some_and(|accepted| *accepted != digest(scene)) {
            let message =
                "the scene has changed since the run was accepted: other runs are not comparable";
            return vec![row.of("scene", false, message.to_owned())];
        }
        let now = engines(report);
        let mut names: Vec<&String> = before.keys().chain(now.keys()).collect();
        names.sort();
        names.dedup();
        let check = |name: &&String| match (before.get(*name), now.get(*name)) {
            (Some(before), Some(now)) => {
                let moved = moved(before, now);
                let message = match moved.len() {
                    0 => format!("{} figures are as accepted", now.len()),
                    _ => told(&moved),
                };
                row.of(name, moved.is_empty(), message)
            }
            (Some(_), None) => row.of(
                name,
                false,
                "it was accepted, and did not run now".to_owned(),
            ),
            _ => row.with(
                name,
                CheckStatus::Inconclusive,
                "it was not accepted before".to_owned(),
            ),
        };
        names.iter().map(check).collect()
    }
}

/// Each figure that moved, in words.
fn moved(before: &Figures, now: &Figures) -> Vec<String> {
    let mut keys: Vec<&String> = before.keys().chain(now.keys()).collect();
    keys.sort();
    keys.dedup();
    // Words say more than numbers: what a run is, and whether it ended.
    let words = |key: &&String| {
        !now.get(*key)
            .or(before.get(*key))
            .is_some_and(Value::is_string)
    };
    keys.sort_by_key(words);
    let change = |key: &&String| match (before.get(*key), now.get(*key)) {
        (Some(before), Some(now)) if same(before, now) => None,
        (Some(before), Some(now)) => {
            let by = match (before.as_f64(), now.as_f64()) {
                (Some(a), Some(b)) if a != 0.0 => format!(" ({:+.3e} of it)", (b - a) / a.abs()),
                _ => String::new(),
            };
            Some(format!("{key} was {before}, is {now}{by}"))
        }
        (Some(before), None) => Some(format!("{key} was {before}, is missing")),
        (None, now) => Some(format!("{key} is new: {}", now.unwrap_or(&Value::Null))),
    };
    keys.iter().filter_map(change).collect()
}

fn told(moved: &[String]) -> String {
    let listed = moved
        .iter()
        .take(LISTED)
        .cloned()
        .collect::<Vec<_>>()
        .join("; ");
    match moved.len().saturating_sub(LISTED) {
        0 => listed,
        more => format!("{listed}; and {more} more"),
    }
}
