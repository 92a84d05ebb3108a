//! What another program claims to be: it is held to that scheme, and to the facts of an integrator's row, its order
//! over three steps among them.

use super::Gate;
use super::laws::CLAIMED_ORDER;
use crate::measure::{Check, CheckStatus};
use crate::physics::ParticleSystem;
use crate::solvers::{Solver, Status};
use crate::trajectory::SaveError;
use crate::truth::TruthKind;
use crate::verbs::Report;
use crate::verbs::run::{Choice, Expectations, Orders, Plan};
use crate::verbs::scheme::Scheme;
use crate::verbs::session::Session;

/// A program, or an integrator of the caller's own, and the scheme that it claims to be.
#[derive(Debug, Clone)]
pub struct Claim {
    /// The solver's id.
    pub name: String,
    pub scheme: Scheme,
    /// Whether it can run again at other steps; a recorded trajectory cannot.
    pub repeats: bool,
}

/// Slopes of three errors may differ by this, and lie below the order by as much: they are not extrapolated.
const TOLERANCE: f64 = 0.3;
/// Slopes this small are of errors that do not depend on the step.
const SAME: f64 = 1e-3;

/// A check of the order that each claim shows over h, h/2 and h/4.
pub(super) fn orders(
    gate: &Gate,
    report: &Report,
    session: &dyn Session,
) -> Result<Vec<Check>, SaveError> {
    let h = gate.plan.scene.solver.timestep;
    let named = |name: &str| gate.plan.choice.solvers.iter().find(|s| s.id == name);
    let mut claims = Vec::new();
    for claim in gate.claims.iter().filter(|claim| claim.repeats) {
        claims.extend(named(&claim.name).map(|solver| (claim, solver.clone())));
    }
    if claims.is_empty() || report.header.truth.kind == TruthKind::None {
        return Ok(Vec::new());
    }
    let choice = Choice {
        solvers: claims
            .iter()
            .map(|(_, solver): &(&Claim, Solver)| solver.clone())
            .collect(),
        timesteps: vec![0.5 * h, 0.25 * h],
        order: Orders::Never,
        identify: false,
        prove: false,
        expectations: Expectations::Ignored,
        ..gate.plan.choice.clone()
    };
    let finer = Plan::new(gate.plan.scene, &choice).execute(session)?;
    let error = |name: &str, h: f64| {
        let mut all = report.outcomes().iter().chain(finer.outcomes());
        let outcome = all.find(|o| o.engine == name && o.timestep == h);
        let whole = outcome.filter(|o| o.status == Status::Completed)?;
        Some(whole.position_error_m.as_ref()?.max)
    };
    let bar = report.header.truth.error_bound_m.unwrap_or(0.0);
    let check = |(claim, _): &(&Claim, Solver)| {
        let errors = [h, 0.5 * h, 0.25 * h].map(|h| error(&claim.name, h));
        order(claim, errors, bar, &gate.plan.system)
    };
    Ok(claims.iter().map(check).collect())
}

fn order(claim: &Claim, errors: [Option<f64>; 3], bar: f64, system: &ParticleSystem) -> Check {
    let with = |status, message: String| CLAIMED_ORDER.with(&claim.name, status, message);
    let [Some(a), Some(b), Some(c)] = errors else {
        let message = "it did not run at h, h/2 and h/4".to_owned();
        return with(CheckStatus::Fail, message);
    };
    // Ten times the truth's error bar, below which errors are not its own.
    let floor = (10.0 * bar).max(f64::MIN_POSITIVE);
    if c <= floor {
        let message = format!("its error of {c:.1e} m is within the truth's own");
        return with(CheckStatus::Skip, message);
    }
    let slopes = [(a / b).log2(), (b / c).log2()];
    let settled = (slopes[0] - slopes[1]).abs() <= TOLERANCE;
    let errors = format!("errors of {a:.2e}, {b:.2e} and {c:.2e} m at h, h/2 and h/4");
    let label = &claim.scheme.label;
    let Some(method) = claim.scheme.method else {
        let message = format!(
            "{errors} fall as h^{:.2}; of {label} no order is stated",
            slopes[1]
        );
        return with(CheckStatus::Skip, message);
    };
    let stated = method.order_on(system);
    let least = f64::from(stated) - TOLERANCE;
    let holds = slopes[1] >= least;
    let message = format!(
        "{errors} fall as h^{:.2}; {label} states {stated}",
        slopes[1]
    );
    let status = match (holds, settled) {
        (true, _) => CheckStatus::Pass,
        (false, true) => CheckStatus::Fail,
        (false, false) => CheckStatus::Inconclusive,
    };
    let finite = |x: f64| Some(x).filter(|x| x.is_finite());
    // The same rows whatever the step: as close as two roundings of a number that is written in few digits.
    let same = slopes.iter().all(|slope| slope.abs() < SAME);
    let cause = "its errors are the same at every step: it does not take the timestep that it is given, \
                 {timestep} in the command or `timestep` in {scene_json}";
    Check {
        cause: Some(cause.to_owned()).filter(|_| !holds && same),
        measured: finite(slopes[1]),
        bound: Some(least),
        ..with(status, message)
    }
}
