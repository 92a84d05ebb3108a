//! The table of keys holds what an outcome holds, no more and no less.

use super::run;
use crate::testkit::scenes::shipped;
use serde_json::Value;
use springcheck::conformance::systems::free_triangle;
use springcheck::measure::EnergyClass;
use springcheck::measure::identify::Undecided;
use springcheck::scene::{DampingModel, KeyKind, StrainLimit};
use springcheck::solvers;
use springcheck::solvers::Status;
use springcheck::verbs::names;
use springcheck::verbs::run::Choice;
use std::collections::BTreeMap;

/// Stated by the expectation itself, different in every run, or lists.
const LEFT_OUT: &[&str] = &[
    "engine",
    "kind",
    "timestep",
    "substep",
    "work.wall_s.min",
    "work.wall_s.median",
    "work.wall_s.mad",
    "energy.drift_per_s_ci",
    "energy.kinetic_final_j",
    "energy.potential_final_j.springs",
    "energy.potential_final_j.gravity",
    "rods.rod",
    "rods.t_s",
    "rods.velocity_growth.law",
    "rods.velocity_growth.exponent",
    "rods.tension_max.rod",
    "rods.tension_max.t_s",
    "rods.tension_min.rod",
    "rods.tension_min.t_s",
    "contact.differs",
    "strain.ratio",
    "strain.impulse_n_s",
    "identified.equivalent",
    "identified.says",
    "identified.left_out",
    "explained.scheme",
    "explained.residual",
    "explained.largest_at",
    "explained.deviations",
    "explained.equivalent",
    "remarks",
];

/// Every path to a value that is no mapping; a null only where nothing else was seen there.
fn leaves(path: &str, value: &Value, found: &mut BTreeMap<String, Value>) {
    match value {
        Value::Object(map) => {
            for (key, value) in map {
                let path = if path.is_empty() {
                    key.clone()
                } else {
                    format!("{path}.{key}")
                };
                leaves(&path, value, found);
            }
        }
        Value::Null => drop(found.entry(path.to_owned()).or_insert(Value::Null)),
        value => drop(found.insert(path.to_owned(), value.clone())),
    }
}

/// Momentum is kept, everybody is a reference, and there is a truth; once more with a strain limit, a pendulum whose rod
/// drifts, a ball that bounces, and a block on a belt.
fn everything() -> BTreeMap<String, Value> {
    let mut scene = free_triangle(0.0, DampingModel::Axial);
    scene.duration = 1.0;
    let mut choice = Choice::default_for(&scene);
    let references = ["rapier-converged", "rapier-user-forces"];
    choice
        .solvers
        .extend(references.into_iter().filter_map(solvers::find));
    let mut limited = scene.clone();
    limited.strain_limit = Some(StrainLimit::default());
    let drifting = shipped("rods/unstabilised.yml");
    let rods = Choice::default_for(&drifting);
    let bouncing = shipped("contact/bouncing.yml");
    let mut contact = Choice::default_for(&bouncing);
    contact.solvers.extend(solvers::find("rapier_contact"));
    let belt = shipped("contact/belt.yml");
    let sliding = Choice::default_for(&belt);
    let mut found = BTreeMap::new();
    for report in [
        run(&scene, &choice),
        run(&limited, &choice),
        run(&drifting, &rods),
        run(&bouncing, &contact),
        run(&belt, &sliding),
    ] {
        for outcome in report.outcomes() {
            let value = serde_json::to_value(outcome).expect("JSON");
            leaves("", &value, &mut found);
        }
    }
    // A mapping that is null in one outcome is a mapping in another.
    let inner: Vec<String> = found.keys().cloned().collect();
    found.retain(|path, value| {
        !value.is_null() || !inner.iter().any(|p| p.starts_with(&format!("{path}.")))
    });
    found
}

#[test]
fn the_table_is_what_an_outcome_holds() {
    let found = everything();
    let table: Vec<&str> = names().keys.iter().map(|key| key.path.as_str()).collect();
    for path in found.keys() {
        let known = table.contains(&path.as_str()) || LEFT_OUT.contains(&path.as_str());
        assert!(known, "an outcome holds {path}, which is not in the table");
    }
    for path in table.iter().chain(LEFT_OUT) {
        assert!(found.contains_key(*path), "no outcome holds {path}");
    }
    // Each once.
    for (at, path) in table.iter().enumerate() {
        assert!(!table[..at].contains(path) && !LEFT_OUT.contains(path));
    }
}

#[test]
fn each_kind_is_what_stands_there() {
    let found = everything();
    for key in &names().keys {
        let right = match (&key.kind, &found[&key.path]) {
            (_, Value::Null) => continue,
            (KeyKind::Number, value) => value.is_number(),
            (KeyKind::Text, value) => value.is_string(),
            (KeyKind::Word(words), Value::String(word)) => words.contains(&word.as_str()),
            (KeyKind::Word(words), value) => words.contains(&value.to_string().as_str()),
        };
        assert!(right, "{}: {:?}", key.path, found[&key.path]);
    }
}

/// The successor, so that a variant nobody lists does not compile; None after the last.
trait Listed: Copy + serde::Serialize {
    const FIRST: Self;
    fn next(self) -> Option<Self>;
}

impl Listed for Status {
    const FIRST: Self = Self::Completed;
    fn next(self) -> Option<Self> {
        match self {
            Self::Completed => Some(Self::Diverged),
            Self::Diverged => Some(Self::Failed),
            Self::Failed => Some(Self::Unsupported),
            Self::Unsupported => None,
        }
    }
}

impl Listed for EnergyClass {
    const FIRST: Self = Self::Bounded;
    fn next(self) -> Option<Self> {
        match self {
            Self::Bounded => Some(Self::Drifting),
            Self::Drifting => Some(Self::Dissipating),
            Self::Dissipating => Some(Self::Growing),
            Self::Growing => None,
        }
    }
}

impl Listed for Undecided {
    const FIRST: Self = Self::SameMap;
    fn next(self) -> Option<Self> {
        match self {
            Self::SameMap => Some(Self::DataTooCoarse),
            Self::DataTooCoarse => Some(Self::Near),
            Self::Near => None,
        }
    }
}

fn words<T: Listed>() -> Vec<String> {
    std::iter::successors(Some(T::FIRST), |word| word.next())
        .map(|word| serde_json::to_value(word).expect("a word"))
        .map(|word| word.as_str().expect("a word").to_owned())
        .collect()
}

#[test]
fn the_words_are_those_of_the_report() {
    let known = |path: &str| {
        let key = names().keys.iter().find(|key| key.path == path);
        match &key.expect("a key").kind {
            KeyKind::Word(words) => words.clone(),
            kind => panic!("{path}: {kind:?}"),
        }
    };
    assert_eq!(known("status"), words::<Status>());
    assert_eq!(known("energy.class"), words::<EnergyClass>());
    assert_eq!(known("identified.undecided"), words::<Undecided>());
}
