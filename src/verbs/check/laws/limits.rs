//! Steps inside their stability limit, and runs that reach their end.

use super::{Ran, Row, Subject};
use crate::measure::stability::{Limit, is_linear};
use crate::measure::{Behaviour, Check, CheckStatus};
use crate::solvers::{SolverKind, Status};

/// Amplitudes that grow by less than this part over a whole run do not show.
const VISIBLE: f64 = 0.01;

pub(super) const COMPLETES: Row = Row {
    id: "completes",
    requires: "the scene's own integrator, every program, and, where forces are linear, every method inside its stability limit run to the end",
    derivation: "a stable method does not diverge, and a program prints all of its rows",
    remedy: "the message says how it ended; for a program, try its command by hand",
    judge: Some(|ran| {
        let due = |subject: &Subject| {
            // Of other forces the limit is that of the start.
            let linear = is_linear(ran.scene());
            let inside = |method| linear && ran.inside(method, subject.case.label.timestep);
            let own = ran.report.header.is_own(&subject.outcome.engine);
            let external = subject.case.solver.kind == SolverKind::External;
            // A solve that fails is no divergence.
            let solves = subject.outcome.status == Status::Failed;
            let due = own || external || !solves && subject.method.is_some_and(inside);
            // What the scene itself expects of its end is judged there.
            let told = ran.gate.expects(&subject.outcome.engine, "status");
            due && !told
        };
        let check = |subject: Subject| {
            let outcome = subject.outcome;
            let holds = outcome.status == Status::Completed;
            let status = crate::report::words::id(outcome.status);
            let reason = outcome.reason.as_deref().map(|why| format!(": {why}"));
            let message = format!("{status}{}", reason.unwrap_or_default());
            Check {
                first_s: outcome.stopped_at_s.filter(|_| !holds),
                ..COMPLETES.of(&outcome.engine, holds, message)
            }
        };
        ran.subjects().filter(due).map(check).collect()
    }),
};

pub(super) const LIMIT: Row = Row {
    id: "limit",
    requires: "the timestep of the scene's own integrator lies inside its stability limit",
    derivation: "the method's stability region and the spectrum of the scene linearised about its start",
    remedy: "take a smaller step, or an integrator that is stable at this one; `stability` lists the limits",
    judge: Some(|ran| {
        let own = |s: &Subject| ran.report.header.is_own(&s.outcome.engine);
        let owns = ran.subjects().filter(own);
        owns.filter_map(|subject| limit(ran, &subject)).collect()
    }),
};

fn limit(ran: &Ran, subject: &Subject) -> Option<Check> {
    let h = subject.case.label.timestep;
    let prediction = ran.predicted(subject.method?, h)?;
    let engine = &subject.outcome.engine;
    let calm = is_calm(subject);
    let with = |status, limit: Option<f64>, message: String| {
        let key = Some("solver.timestep".to_owned());
        Some(Check {
            measured: Some(h),
            bound: limit,
            key,
            cause: (status == CheckStatus::Fail)
                .then(|| prediction.reason.clone())
                .flatten(),
            ..LIMIT.with(engine, status, message)
        })
    };
    // An author who says what energy does there knows.
    let told = [
        "status",
        "energy.class",
        "energy.relative_error_max",
        "energy.drift_per_s",
    ];
    let told = told.iter().any(|key| ran.gate.expects(engine, key));
    let beyond = |limit, message: String| {
        if told {
            let message = format!("{message}, which the scene's `expect` takes into account");
            with(CheckStatus::Skip, limit, message)
        } else {
            with(CheckStatus::Fail, limit, message)
        }
    };
    match prediction.limit {
        Limit::Unconditional => with(
            CheckStatus::Pass,
            None,
            "every step is stable here".to_owned(),
        ),
        // Exactly at the limit nothing grows.
        Limit::At(limit) | Limit::Between(limit, _) if h <= limit * (1.0 + 1e-9) => {
            let message = format!("h = {h} s is inside the limit {limit:.4} s");
            with(CheckStatus::Pass, Some(limit), message)
        }
        Limit::At(limit) | Limit::Between(limit, _) if calm => {
            let message = format!(
                "h = {h} s is beyond the limit {limit:.4} s of the scene linearised about its start, but this run \
                 stays stable"
            );
            with(CheckStatus::Skip, Some(limit), message)
        }
        Limit::At(limit) | Limit::Between(limit, _) => {
            let message = format!("h = {h} s is beyond the stability limit {limit:.4} s");
            beyond(Some(limit), message)
        }
        Limit::Never => {
            let rate = prediction.growth_per_s.unwrap_or(f64::INFINITY);
            let small = rate * subject.case.label.end() < VISIBLE;
            let message = format!("no step is stable here: motion grows by {rate:.3} 1/s");
            if small || calm {
                with(CheckStatus::Skip, None, message)
            } else {
                beyond(None, message)
            }
        }
        Limit::Unknown(_) => None,
    }
}

/// Whether a run shows itself stable.
fn is_calm(subject: &Subject) -> bool {
    let energy = subject.outcome.energy.as_ref();
    energy.is_some_and(|energy| {
        let grows = matches!(
            energy.behaviour(),
            None | Some(Behaviour::Growing | Behaviour::Drifting | Behaviour::Unsteady)
        );
        !grows && energy.relative_error_max.is_some_and(|error| error <= 1.0)
    })
}
