//! Whether a scene's engines did what its `expect` says.

mod judge;
mod keys;

pub use keys::names;

use super::plan::{Choice, ChosenEngine, Orders};
use crate::outcome::{Check, CheckStatus, Outcome, Report};
use crate::scene::Scene;
use crate::truth::Demand;
use crate::{engines, integrators};

/// The id of these checks.
pub const ID: &str = "expect";

/// What the truth moves: errors, and what is in units of the energy scale, which takes its peak in.
const OF_THE_TRUTH: &[&str] = &[
    "position_error_m.",
    "velocity_error_m_s.",
    "energy.relative_error_max",
    "energy.drift_per_s",
    "energy.fluctuation",
];

/// One check for each key expected of an engine, on its outcome at the scene's own timestep; one
/// that is skipped for each engine that did not run there, or one in all where none did.
///
/// `scene` is the scene as its file states it: a report of another duration is not judged. Where a
/// key has no value, the expectation fails.
pub fn check(scene: &Scene, report: &Report) -> Vec<Check> {
    if scene.expect.is_empty() {
        return Vec::new();
    }
    if report.scene.duration != scene.duration {
        return vec![not_judged(&format!(
            "they are about {:?} s, and {:?} s ran",
            scene.duration, report.scene.duration
        ))];
    }
    let timestep = scene.solver.timestep;
    let outcome = |id: &str| -> Option<&Outcome> {
        let of = |o: &&Outcome| o.engine == id && o.timestep == timestep;
        report.outcomes.iter().find(of)
    };
    let subjects = subjects(scene);
    if subjects.iter().all(|(id, _)| outcome(id).is_none()) {
        return vec![not_judged(&format!(
            "none of the engines they are about ran at the scene's own timestep, {timestep:?} s; \
             --integrators all runs every integrator"
        ))];
    }
    let mut checks = Vec::new();
    for (id, integrator) in subjects {
        let Some(outcome) = outcome(id) else {
            let why = "did not run at the scene's own timestep";
            checks.push(skipped(id, why.to_owned()));
            continue;
        };
        // Whatever an outcome holds has a JSON form.
        let value = serde_json::to_value(outcome).unwrap_or_default();
        let expected = scene.expected_of(id, integrator);
        checks.extend(
            expected
                .into_iter()
                .map(|expectation| judge::judge(expectation, outcome, &value, report)),
        );
    }
    checks
}

/// The one check that says why nothing was judged.
pub fn not_judged(why: &str) -> Check {
    skipped("scene", format!("expectations are not judged: {why}"))
}

fn skipped(subject: &str, message: String) -> Check {
    Check {
        id: ID.to_owned(),
        subject: subject.to_owned(),
        status: CheckStatus::Skip,
        measured: None,
        bound: None,
        derivation: "the scene's `expect`".to_owned(),
        message,
    }
}

/// Everybody something is expected of, in registry order, integrators (true) first.
fn subjects(scene: &Scene) -> Vec<(&'static str, bool)> {
    let methods = integrators::ids().into_iter().map(|id| (id, true));
    let engines = engines::ids().into_iter().map(|id| (id, false));
    methods
        .chain(engines)
        .filter(|(id, integrator)| !scene.expected_of(id, *integrator).is_empty())
        .collect()
}

impl Choice {
    /// Exactly what the scene expects something of, at its own timestep, and the engines those
    /// expectations name as references. What no expectation can depend on is not computed: orders, the
    /// twin proof, and, unless a key needs them, the truth and the identities.
    pub fn expected(scene: &Scene) -> Self {
        let mentions = |prefixes: &[&str]| {
            let about = |key: &str| prefixes.iter().any(|prefix| key.starts_with(prefix));
            scene.expect.iter().any(|e| about(&e.key))
        };
        let subjects = subjects(scene);
        let about = |id: &str| subjects.iter().any(|(subject, _)| *subject == id);
        let referred = |id: &str| {
            let prefix = format!("deviation_m.{id}.");
            mentions(&[&prefix])
        };
        Self {
            methods: integrators::REGISTRY
                .iter()
                .filter(|method| about(method.id))
                .collect(),
            engines: engines::REGISTRY
                .iter()
                .filter(|row| about(&row.id) || referred(&row.id))
                .map(ChosenEngine::from)
                .collect(),
            programs: Vec::new(),
            timesteps: vec![scene.solver.timestep],
            truth: if mentions(OF_THE_TRUTH) {
                Demand::Auto
            } else {
                Demand::None
            },
            order: Orders::Never,
            identify: mentions(&["identified."]),
            prove: false,
        }
    }
}
