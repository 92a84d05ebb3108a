//! The verb `check`: the gate. It runs the solvers that a scene calls for and holds them to what the scene expects,
//! to the laws that follow from its effects and each method's facts, and to a run that was accepted before.
//!
//! [`Gate`] says what is judged; [`CHECKS`] are the checks, a row each; the result is a [`Report`] like that of every
//! other verb, so that it is printed, stored, shown and merged like those. Nothing in it depends on the clock.

mod args;
mod baseline;
mod claims;
mod laws;
mod select;
mod targets;
mod text;

pub use args::{Args, check, code};
pub use baseline::{Baseline, BaselineError};
pub use claims::Claim;
pub use laws::{CHECKS, Row, find};
pub use text::{closing, human};

use crate::measure::{Check, CheckStatus, twin};
use crate::scene::Scene;
use crate::solvers::{Solver, SolverKind};
use crate::trajectory::SaveError;
use crate::verbs::run::{self, Case, Choice, Expectations, Outcome, Plan};
use crate::verbs::scheme::Scheme;
use crate::verbs::session::Session;
use crate::verbs::{Body, Report, SeriesState};
use laws::Ran;

/// The ids of all checks.
pub fn ids() -> Vec<&'static str> {
    CHECKS.iter().map(|row| row.id).collect()
}

/// What is judged of one scene.
pub struct Gate<'a> {
    pub plan: Plan<'a>,
    /// What other programs and integrators of the caller's own claim to be.
    pub claims: Vec<Claim>,
    /// The scene that rapier's worlds are built from in the twin proof: the plan's own, but in tests of the proof.
    pub twin: &'a Scene,
    /// Whether a program fails that the scene expects something of and that does not run.
    pub require_all: bool,
}

impl<'a> Gate<'a> {
    /// The gate of a scene: its own integrator, the usual six, and every engine it expects something of.
    pub fn new(scene: &'a Scene) -> Self {
        Self::of(scene, &Self::choice(scene))
    }

    /// The gate of a scene with these solvers.
    pub fn of(scene: &'a Scene, choice: &Choice) -> Self {
        Self {
            plan: Plan::new(scene, choice),
            claims: Vec::new(),
            twin: scene,
            require_all: false,
        }
    }

    /// The solvers of [`new`](Self::new), and what is measured of them.
    pub fn choice(scene: &Scene) -> Choice {
        let mut choice = Choice {
            prove: false,
            expectations: Expectations::Judged,
            ..Choice::default_for(scene)
        };
        choice
            .solvers
            .retain(|solver| solver.kind == SolverKind::Integrator);
        for solver in Choice::expected(scene).solvers {
            if !choice.solvers.iter().any(|known| known.id == solver.id) {
                choice = choice.with(solver);
            }
        }
        choice
    }

    /// The scheme that a case is, or claims to be.
    fn scheme(&self, case: &Case) -> Option<Scheme> {
        let own = case.solver.as_method().map(Scheme::from);
        let is = |claim: &&Claim| claim.name == case.solver.id;
        own.or_else(|| Some(self.claims.iter().find(is)?.scheme.clone()))
    }

    /// Whether the scene expects something of an engine under this key.
    fn expects(&self, engine: &str, key: &str) -> bool {
        let kind = |solver: &Solver| solver.kind == SolverKind::Integrator && solver.id == engine;
        let integrator = self.plan.cases.iter().any(|case| kind(&case.solver));
        let expected = self.plan.scene.expected_of(engine, integrator);
        expected.iter().any(|expectation| expectation.key == key)
    }

    /// Runs and judges.
    ///
    /// # Errors
    /// Fails only where a session's file could not be written.
    pub fn run(&self, session: &dyn Session) -> Result<Report, SaveError> {
        let (mut report, records) = self.plan.recorded(session)?;
        let ran = Ran::new(self, &report, &records, run::linearised(&self.plan));
        let judged: Vec<fn(&Ran) -> Vec<Check>> =
            CHECKS.iter().filter_map(|row| row.judge).collect();
        let mut checks: Vec<Check> = judged.iter().flat_map(|judge| judge(&ran)).collect();
        checks.extend(self.proofs());
        checks.extend(claims::orders(self, &report, session)?);
        checks.append(&mut report.header.checks);
        for check in &mut checks {
            self.settle(check);
        }
        let place = |check: &Check| CHECKS.iter().position(|row| row.id == check.id);
        checks.sort_by_key(|check| place(check).unwrap_or(CHECKS.len()));
        report.header.checks = checks;
        Ok(without_times(report))
    }

    fn proofs(&self) -> Vec<Check> {
        let Plan { scene, .. } = self.plan;
        let timestep = scene.solver.timestep;
        let mut proofs = if std::ptr::eq(self.twin, scene) {
            twin::prove_within(scene, timestep, run::effort_of_proofs(&self.plan))
        } else {
            twin::prove_pair(scene, self.twin, timestep)
        };
        let user = |case: &Case| case.solver.id == "rapier-user-forces";
        if self.plan.cases.iter().any(user) {
            proofs.push(twin::prove_user_forces(scene, self.twin, timestep));
        }
        proofs
    }

    /// A check as the gate takes it: an order that this scene does not show, or a twin proof that it does not allow,
    /// fails nobody; a program that must run and does not fails; and what the scene does not want is skipped.
    fn settle(&self, check: &mut Check) {
        let unclaimed =
            |check: &Check| !self.claims.iter().any(|claim| claim.name == check.subject);
        let unshown = check.id == "order" && unclaimed(check) || check.id.starts_with("twin-");
        if unshown && check.status == CheckStatus::Inconclusive {
            check.status = CheckStatus::Skip;
        }
        let scene = self.plan.scene;
        let listed = |name: &String| check.subject == *name;
        let missing = check.id == run::expect::ID && check.status == CheckStatus::Skip;
        if missing && scene.externals.iter().any(listed) {
            let name = &check.subject;
            check.message = format!("it did not run: `--external {name}=COMMAND` says what it is");
            if self.require_all {
                check.status = CheckStatus::Fail;
            }
        }
        if let Some(skipped) = scene.skip.iter().find(|skipped| skipped.check == check.id)
            && check.status != CheckStatus::Pass
        {
            check.status = CheckStatus::Skip;
            check.message = format!(
                "skipped by the scene: {} ({})",
                skipped.reason, check.message
            );
            check.key = Some(format!("expect.skip.{}", skipped.check));
        }
    }
}

/// The report of the gate: no clock times, which differ from run to run, and no series.
fn without_times(mut report: Report) -> Report {
    for effect in &mut report.header.scene.effects {
        effect.wall_ns = None;
    }
    let mut outcomes: Vec<Outcome> = match report.body {
        Body::Run { outcomes } => outcomes,
        _ => Vec::new(),
    };
    for outcome in &mut outcomes {
        outcome.work.wall_s = None;
    }
    Report {
        body: Body::Check { outcomes },
        series: SeriesState::Nothing,
        ..report
    }
}

/// How a scene came out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    Passed,
    Failed,
    /// Nothing failed, but something could not be decided.
    Inconclusive,
    /// Nothing was judged.
    Skipped,
}

/// How the scene of a report came out.
pub fn verdict(report: &Report) -> Verdict {
    let has = |status| {
        report
            .header
            .checks
            .iter()
            .any(|check| check.status == status)
    };
    if has(CheckStatus::Fail) {
        Verdict::Failed
    } else if has(CheckStatus::Inconclusive) {
        Verdict::Inconclusive
    } else if has(CheckStatus::Pass) {
        Verdict::Passed
    } else {
        Verdict::Skipped
    }
}
