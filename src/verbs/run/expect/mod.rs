//! Whether a scene's engines did what its `expect` says.

mod judge;
mod keys;

pub use keys::names;

use super::plan::{Choice, Expectations, Orders};
use crate::measure::{Check, CheckStatus};
use crate::report::{SceneFacts, TruthFacts};
use crate::scene::{Expectation, Scene};
use crate::solvers::Kind;
use crate::solvers::{Solver, catalogue};
use crate::truth::Demand;
use crate::verbs::Report;
use crate::verbs::run::Outcome;

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
/// `scene` is the scene as its file states it: runs of another duration are not judged. Where a key has
/// no value, the expectation fails.
pub fn check(scene: &Scene, report: &Report) -> Vec<Check> {
    Found {
        truth: &report.header.truth,
        scene: &report.header.scene,
        outcomes: report.outcomes(),
    }
    .check(scene)
}

/// What a scene's runs left, as far as expectations are about it.
pub struct Found<'a> {
    pub truth: &'a TruthFacts,
    pub scene: &'a SceneFacts,
    pub outcomes: &'a [Outcome],
}

impl Found<'_> {
    /// As [`check`].
    fn check(&self, scene: &Scene) -> Vec<Check> {
        if scene.expect.is_empty() {
            return Vec::new();
        }
        if self.scene.duration != scene.duration {
            return vec![not_judged(&format!(
                "they are about {:?} s, and {:?} s ran",
                scene.duration, self.scene.duration
            ))];
        }
        let timestep = scene.solver.timestep;
        let outcome = |id: &str| -> Option<&Outcome> {
            let of = |o: &&Outcome| o.engine == id && o.timestep == timestep;
            self.outcomes.iter().find(of)
        };
        let subjects: Vec<Solver> = subjects(scene).collect();
        if subjects
            .iter()
            .all(|subject| outcome(&subject.id).is_none())
        {
            return vec![not_judged(&format!(
                "none of the engines they are about ran at the scene's own timestep, {timestep:?} s; \
             --integrators all runs every integrator"
            ))];
        }
        let mut checks = Vec::new();
        for subject in subjects {
            let Some(outcome) = outcome(&subject.id) else {
                let why = "did not run at the scene's own timestep";
                checks.push(skipped(&subject.id, why.to_owned()));
                continue;
            };
            // Whatever an outcome holds has a JSON form.
            let value = serde_json::to_value(outcome).unwrap_or_default();
            let expected = expected_of(scene, &subject);
            let judged = expected
                .into_iter()
                .map(|expectation| judge::judge(expectation, outcome, &value, self));
            checks.extend(judged);
        }
        checks
    }
}

impl Expectations {
    /// The checks that say what came of them.
    pub fn checks(&self, scene: &Scene, found: &Found) -> Vec<Check> {
        match self {
            Self::Judged => found.check(scene),
            Self::Skipped(why) if !scene.expect.is_empty() => vec![not_judged(why)],
            Self::Ignored | Self::Skipped(_) => Vec::new(),
        }
    }
}

/// The one check that says why nothing was judged.
fn not_judged(why: &str) -> Check {
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

/// The solvers of fixed steps that something is expected of, in the catalogue's order.
fn subjects(scene: &Scene) -> impl Iterator<Item = Solver> {
    let fixed = catalogue().filter(|solver| solver.as_pair().is_none());
    fixed.filter(|solver| !expected_of(scene, solver).is_empty())
}

/// What is expected of a solver.
fn expected_of<'a>(scene: &'a Scene, solver: &Solver) -> Vec<&'a Expectation> {
    scene.expected_of(&solver.id, solver.kind == Kind::Integrator)
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
        let fixed = catalogue().filter(|solver| solver.as_pair().is_none());
        let referred = |solver: &Solver| {
            let prefix = format!("deviation_m.{}.", solver.id);
            solver.kind == Kind::Rapier && mentions(&[&prefix])
        };
        Self {
            solvers: fixed
                .filter(|solver| !expected_of(scene, solver).is_empty() || referred(solver))
                .collect(),
            timesteps: vec![scene.solver.timestep],
            truth: if mentions(OF_THE_TRUTH) {
                Demand::Auto
            } else {
                Demand::None
            },
            order: Orders::Never,
            identify: mentions(&["identified."]),
            prove: false,
            expectations: Expectations::Judged,
        }
    }
}
