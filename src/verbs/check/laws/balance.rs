//! The balance of energy closes with the step, as fast as the method's order says.

use super::{Ran, Row, Subject};
use crate::integrators::{self, Method, Settings};
use crate::measure::order::{Observed, Point, RATIOS, TOLERANCE, Verdict, observed};
use crate::measure::{Check, CheckStatus, Sum};
use crate::physics::{State, System};
use crate::solvers::{Setting, Solver, SolverKind};
use rayon::prelude::*;

pub(super) const LAW: Row = Row {
    id: "balance",
    requires: "E + dissipated - injected closes to the order of the method as the step falls",
    derivation: "the slope of ln error over ln step over the first 64 steps, extrapolated from at least four that \
                 agree within 0.05; energy may converge faster than position, never slower",
    remedy: "work is booked at another velocity than forces act at, or a force has no potential that it belongs to",
    judge: Some(|ran| {
        let kinetic = |subject: &Subject| subject.case.solver.kind == SolverKind::Integrator;
        let subjects: Vec<Subject> = ran.subjects().filter(kinetic).collect();
        subjects
            .par_iter()
            .filter_map(|subject| balance(ran, subject))
            .collect()
    }),
};

/// Steps of the horizon at the scene's own timestep.
const STEPS: u64 = 64;
/// Steps of the coarsest level.
const COARSEST: u64 = 8;
/// Steps times coordinates that a study may take: a fraction of a second.
const BUDGET: u64 = 4_000_000;
/// The control, of order 4, and the least slope that shows its order.
const CONTROL: (&str, f64) = ("rk4", 3.5);

fn balance(ran: &Ran, subject: &Subject) -> Option<Check> {
    let method = subject.method?;
    let order = method.order_on(ran.system());
    let over = |part: f64| observed(&points(ran, &subject.case.solver, part), order);
    let mut seen = over(1.0);
    if seen.verdict == Verdict::Misses {
        // Slopes may only have seemed to settle, as where all energy is lost at every step: over a shorter time the
        // same steps are finer. An order misses where it does over both.
        let finer = over(1.0 / 16.0);
        if finer.verdict != Verdict::Misses {
            seen = finer;
        }
    }
    let engine = &subject.outcome.engine;
    let misses = seen.verdict == Verdict::Misses;
    if misses && !is_smooth(ran, &seen) {
        let message =
            "forces are not smooth here: classical Runge-Kutta falls short of its order, too";
        return Some(LAW.with(engine, CheckStatus::Skip, message.to_owned()));
    }
    Some(match seen.order {
        None => {
            let why = match seen.verdict {
                Verdict::Inconclusive(reason) => reason.to_string(),
                _ => String::new(),
            };
            LAW.with(
                engine,
                CheckStatus::Skip,
                format!("no order to be seen: {why}"),
            )
        }
        Some(found) => {
            let message =
                format!("the balance closes as h^{found:.2}, at least h^{order} is stated");
            Check {
                measured: Some(found),
                bound: Some(f64::from(order) - TOLERANCE),
                ..LAW.of(engine, !misses, message)
            }
        }
    })
}

/// The largest error of the balance over a part of the horizon, at smaller and smaller steps.
fn points(ran: &Ran, solver: &Solver, part: f64) -> Vec<Point> {
    let scene = ran.scene();
    let own = scene.solver.timestep;
    let horizon = part * (STEPS as f64 * own).min(scene.steps(own) as f64 * own);
    let dim = ran.system().dim() as u64;
    let mut left = BUDGET;
    let mut points: Vec<Point> = Vec::new();
    for level in 0..12 {
        let steps = COARSEST << level;
        let cost = steps * dim;
        if cost > left {
            break;
        }
        left -= cost;
        let Some((error, floor)) = error(ran, solver, horizon / steps as f64, steps) else {
            continue;
        };
        points.push(Point {
            h: horizon / steps as f64,
            error,
            floor,
        });
        if points.len() > RATIOS && error <= floor {
            break;
        }
    }
    points
}

/// The largest error of the balance at the coarsest level's instants, J, and what rounding explains of it.
fn error(ran: &Ran, solver: &Solver, timestep: f64, steps: u64) -> Option<(f64, f64)> {
    let (scene, system) = (ran.scene(), ran.system());
    let setting = Setting::Steps { timestep, steps };
    let mut run = solver.start(scene, system, &setting).ok()?;
    let energies = |state: &State| {
        let sum = Sum::new(system, state.t, &state.x, &state.v, state.work);
        (sum.balance, sum.largest)
    };
    let (start, mut largest) = energies(run.state());
    let mut off = 0.0_f64;
    for _ in 0..COARSEST {
        run.advance(steps / COARSEST).ok()?;
        let (now, terms) = energies(run.state());
        off = off.max((now - start).abs());
        largest = largest.max(terms);
    }
    let tolerance = Settings::stated(scene.solver.tolerance).tolerance;
    let solves = solver
        .as_method()
        .is_none_or(|m| matches!(m.coefficients, integrators::Coefficients::Implicit(_)));
    let each = f64::EPSILON * 8.0 + if solves { tolerance } else { 0.0 };
    let floor = 10.0 * each * largest * (steps as f64).sqrt();
    (off.is_finite() && largest.is_finite()).then_some((off, floor))
}

/// Whether classical Runge-Kutta shows its order at the same steps, or is exact there.
fn is_smooth(ran: &Ran, seen: &Observed) -> bool {
    let control: Option<&'static Method> = integrators::find(CONTROL.0);
    let Some(solver) = control.map(Solver::method) else {
        return true;
    };
    let finest = seen.used.last().map_or(0.0, |point| point.h);
    let points = points(ran, &solver, 1.0);
    let near: Vec<&Point> = points
        .iter()
        .filter(|p| p.h >= finest && p.error > p.floor)
        .collect();
    match near.as_slice() {
        [.., coarse, fine] => {
            (coarse.error / fine.error).ln() / (coarse.h / fine.h).ln() >= CONTROL.1
        }
        // At the floor, or nothing to see.
        _ => true,
    }
}
