//! The scenes built to break integrators: every engine does on them what their `expect` says, and no
//! expectation is so weak that a broken integrator meets it.
//!
//! All scenes together must take less than 3 minutes on 2 cores.

mod absent;
mod balance;
mod sabotage;
mod sweeps;
mod symmetry;
mod truths;

use crate::testkit::scenes::{all_shipped, files, shipped};
use rayon::prelude::*;
use springcheck::measure::CheckStatus;
use springcheck::report::json::Tool;
use springcheck::scene::Scene;
use springcheck::solvers::Status;
use springcheck::solvers::rapier;
use springcheck::verbs::Report;
use springcheck::verbs::run::Outcome;
use springcheck::verbs::run::{Choice, Plan, expect};
use springcheck::{integrators, report};
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};
use truths::remembering;

/// Every file of `scenes/hard`, by its stem.
fn scenes() -> Vec<(String, Scene)> {
    let stem = |path: &PathBuf| {
        path.file_stem()
            .expect("a name")
            .to_string_lossy()
            .into_owned()
    };
    let stems = files(&["hard"]).iter().map(stem).collect::<Vec<_>>();
    stems.into_iter().zip(all_shipped(&["hard"])).collect()
}

/// A scene of `scenes/hard`.
fn scene(name: &str) -> Scene {
    shipped(&format!("hard/{name}.yml"))
}

/// Panics with everything wrong with any scene. One test at a time: each uses all threads anyway, and
/// the next finds the truths that the one before has computed.
fn each_scene(judge: impl Fn(&str, &Scene) -> Vec<String> + Sync) {
    static TURN: Mutex<()> = Mutex::new(());
    let turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let wrong: Vec<String> = scenes()
        .par_iter()
        .flat_map_iter(|(stem, scene)| {
            let wrong = judge(stem, scene);
            wrong.into_iter().map(move |said| format!("{stem}: {said}"))
        })
        .collect();
    drop(turn);
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn every_engine_does_what_is_expected() {
    each_scene(|_, scene| {
        let plan = Plan::new(scene, &Choice::expected(scene));
        let report = plan.execute(remembering()).expect("no files");
        let checks = expect::check(scene, &report);
        let mut wrong: Vec<String> = report
            .header
            .checks
            .iter()
            .filter(|check| check.status == CheckStatus::Fail)
            .chain(
                checks
                    .iter()
                    .filter(|check| check.status != CheckStatus::Pass),
            )
            .map(|check| check.message.clone())
            .collect();
        wrong.extend(report.outcomes().iter().filter_map(unclear));
        wrong.extend(not_finite(&report));
        wrong
    });
}

/// A run ends as one of four, and one that ends early names step, particle or rod, and cause.
fn unclear(outcome: &Outcome) -> Option<String> {
    let reason = outcome.reason.as_deref().unwrap_or_default();
    let number_after = |word: &str| {
        let rest = reason.split(word).nth(1);
        rest.is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()))
    };
    let clear = match outcome.status {
        Status::Completed => outcome.reason.is_none(),
        Status::Diverged | Status::Failed => {
            let whose = number_after("particle ") || number_after("rod ");
            outcome.stopped_at_s.is_some() && number_after("in step ") && whose
        }
        Status::Unsupported => !reason.is_empty(),
    };
    let (engine, status) = (&outcome.engine, outcome.status);
    (!clear).then(|| format!("{engine} ends as {status:?} with the reason {reason:?}"))
}

/// Words for NaN and infinity, which the JSON would turn into null without a reason.
fn not_finite(report: &Report) -> Vec<String> {
    let data = (
        &report.header.scene,
        &report.header.truth,
        report.outcomes(),
        &report.header.checks,
    );
    let shown = format!("{data:?}");
    let words = shown.split(|c: char| !c.is_alphanumeric() && c != '_');
    let bad = words.filter(|word| ["NaN", "inf"].contains(word));
    let text = report::json::render(&Tool::this(), std::slice::from_ref(report));
    let read: Result<serde_json::Value, _> = serde_json::from_str(&text);
    let unread = read.err().map(|error| format!("its JSON: {error}"));
    bad.map(|word| format!("its report holds {word}"))
        .chain(unread)
        .collect()
}

/// Who would take too long on a scene, and the shorter one of the same particles and springs that speaks
/// of them: 18 and 45 s of a processor for a million steps.
const ELSEWHERE: &[(&str, &str, &[&str])] = &[(
    "million_steps",
    "hundred_thousand_steps",
    &[
        "implicit_euler",
        "linearized_implicit_predicted",
        "linearized_implicit_at_start",
        "linearized_implicit_material",
        "trapezoidal",
        "tr_bdf2",
        "rapier",
        "rapier-forces",
        "rapier-converged",
        "rapier-user-forces",
    ],
)];

#[test]
fn what_is_judged_elsewhere_is_judged_there() {
    for (long, short, ids) in ELSEWHERE {
        let (long, short) = (scene(long), scene(short));
        assert_eq!(long.particles, short.particles);
        assert_eq!(long.springs, short.springs);
        assert_eq!(long.solver, short.solver);
        for id in *ids {
            let integrator = integrators::find(id).is_some();
            let said = |scene: &Scene| !scene.expected_of(id, integrator).is_empty();
            assert!(said(&short) && !said(&long), "{id}");
        }
    }
}

#[test]
fn every_scene_speaks_of_every_engine() {
    each_scene(|stem, scene| {
        let elsewhere = |id: &str| {
            let row = ELSEWHERE.iter().find(|(long, ..)| *long == stem);
            row.is_some_and(|(_, _, ids)| ids.contains(&id))
        };
        let methods = integrators::ids(integrators::fixed())
            .into_iter()
            .map(|id| (id, true));
        // Without obstacles rapier's contact is unsupported.
        let touches = !scene.colliders.is_empty();
        let engines = rapier::IDS
            .into_iter()
            .filter(|id| touches || *id != "rapier_contact");
        let engines = engines.map(|id| (id, false));
        let silent = methods
            .chain(engines)
            .filter(|(id, integrator)| scene.expected_of(id, *integrator).is_empty())
            .filter(|(id, _)| !elsewhere(id))
            .map(|(id, _)| format!("nothing is expected of {id}"));
        let undescribed = scene.description.is_none();
        let undescribed = undescribed.then(|| "nothing says what makes it hard".to_owned());
        silent.chain(undescribed).collect()
    });
}
