//! Momentum, the centre of mass and angular momentum, where nothing is fixed and forces are internal or constant.

use super::subject::norm;
use super::{Instant, Ran, Row, Subject};
use crate::measure::{Check, totals};
use crate::physics::{ParticleSystem, System};
use crate::solvers::SolverKind;
use crate::trajectory::Trajectory;
use crate::truth::farthest;

pub(super) const MOMENTUM: Row = Row {
    id: "momentum",
    requires: "with nothing fixed, momentum changes by the constant forces alone: p(t) = p(0) + F t",
    derivation: "16 roundings (and the solver's tolerance) a step of the sum of m (|v| + h |a|)",
    remedy: "a force acts on one end of a spring only, particles see states of different times, or masses differ \
             between forces and steps",
    judge: Some(|ran| {
        each(ran, |subject, run| {
            let total = |k: usize| totals(ran.scene(), run.x(k), run.v(k)).0;
            let (start, force) = (total(0), constant(ran)?);
            let bounds = bounds(ran, subject, run);
            let instants = (0..run.len()).map(|k| {
                let expected = [0, 1, 2].map(|a| start[a] + force[a] * run.time(k));
                let found = farthest(&total(k), &expected);
                let grown = norm(&force) * run.time(k) * f64::EPSILON * 8.0;
                let bound = bounds[k] + grown;
                Instant {
                    t: run.time(k),
                    found,
                    bound,
                }
            });
            MOMENTUM.over_time(
                &subject.outcome.engine,
                "momentum is off by (kg m/s)",
                instants,
            )
        })
    }),
};

pub(super) const CENTER: Row = Row {
    id: "center",
    requires: "with nothing fixed, the centre of mass is at rest, moves straight, or falls freely",
    derivation: "a method of order 2 or more is exact there, one of order 1 off by at most |A| h t / 2; rounding as \
                 of momentum, over time",
    remedy: "positions move with a velocity of another time than the method says",
    judge: Some(|ran| {
        each(ran, |subject, run| {
            let method = subject.method?;
            let force = constant(ran)?;
            let mass: f64 = ran.scene().particles.iter().map(|p| p.mass).sum();
            let pull = force.map(|f| f / mass);
            let center = |k: usize| {
                let mut sum = [0.0; 3];
                for (p, x) in ran.scene().particles.iter().zip(run.x(k).chunks_exact(3)) {
                    for a in 0..3 {
                        sum[a] += p.mass * x[a] / mass;
                    }
                }
                sum
            };
            let (start, momentum) = (center(0), totals(ran.scene(), run.x(0), run.v(0)).0);
            let bounds = bounds(ran, subject, run);
            let rounding = ran.rounding(subject, run);
            let far = |k: usize| run.x(k).iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            let mut reach = 0.0_f64;
            let h = subject.case.label.timestep;
            let instants = (0..run.len()).map(|k| {
                let t = run.time(k);
                reach = reach.max(far(k));
                let expected =
                    [0, 1, 2].map(|a| start[a] + momentum[a] / mass * t + 0.5 * pull[a] * t * t);
                let half = run.rows().precision.half_unit(reach);
                let steps = run.step(k) as f64;
                let own = if method.exact {
                    0.0
                } else {
                    0.5 * norm(&pull) * h * t * (1.0 + 1e-9)
                };
                let fall = norm(&pull) * t * t * f64::EPSILON * 8.0;
                let bound =
                    own + fall + steps * rounding * reach + t * bounds[k] / mass + 3.0 * half;
                Instant {
                    t,
                    found: farthest(&center(k), &expected),
                    bound,
                }
            });
            CENTER.over_time(
                &subject.outcome.engine,
                "the centre of mass is off by (m)",
                instants,
            )
        })
    }),
};

pub(super) const ANGULAR: Row = Row {
    id: "angular-momentum",
    requires: "with nothing fixed and central forces, a symplectic method keeps the angular momentum",
    derivation: "rounding as of momentum, times the farthest distance from the origin",
    remedy: "a force is not along the line between its ends, or kicks and drifts see different positions",
    judge: Some(|ran| {
        let central = ran
            .system()
            .effects()
            .iter()
            .all(|(_, e)| e.keeps_angular_momentum());
        // A strain limit moves the ends of what turns.
        if !central || ran.system().strain_limiter().is_some() {
            return Vec::new();
        }
        each(ran, |subject, run| {
            subject.method.filter(|method| method.symplectic)?;
            let total = |k: usize| totals(ran.scene(), run.x(k), run.v(k)).1;
            let start = total(0);
            let bounds = bounds(ran, subject, run);
            let mut reach = 0.0_f64;
            let instants = (0..run.len()).map(|k| {
                let radii = run.x(k).chunks_exact(3).map(norm);
                reach = radii.fold(reach, f64::max);
                let half: f64 = 3.0 * run.rows().precision.half_unit(reach);
                let turned = half * ran.sizes(subject, run)[k];
                let bound = bounds[k] * reach + turned;
                Instant {
                    t: run.time(k),
                    found: farthest(&total(k), &start),
                    bound,
                }
            });
            ANGULAR.over_time(
                &subject.outcome.engine,
                "angular momentum is off by (kg m²/s)",
                instants,
            )
        })
    }),
};

/// A check of each run to its end of a free scene under internal and constant forces, but of rapier's: its solver
/// ends before it has converged.
fn each(ran: &Ran, judge: impl Fn(&Subject, &Trajectory) -> Option<Check>) -> Vec<Check> {
    if !ran.is_free() || constant(ran).is_none() {
        return Vec::new();
    }
    let ours = |subject: &Subject| subject.case.solver.kind != SolverKind::Rapier;
    let whole = ran.whole().filter(|(subject, ..)| ours(subject));
    whole
        .filter_map(|(subject, run, _)| judge(&subject, run))
        .collect()
}

/// The total of the constant forces, N; None where other forces change the momentum.
fn constant(ran: &Ran) -> Option<[f64; 3]> {
    let start = ParticleSystem::initial_state(ran.scene());
    let mut force = vec![0.0; start.x.len()];
    for (row, effect) in ran.system().effects() {
        if row.constant {
            effect.add_force(0.0, &start.x, &start.v, &mut force);
        } else if !effect.keeps_momentum() {
            return None;
        }
    }
    let sum = |axis: usize| force.iter().skip(axis).step_by(3).sum();
    Some([sum(0), sum(1), sum(2)])
}

/// What rounding may have done to the momentum by each instant, kg m/s.
fn bounds(ran: &Ran, subject: &Subject, run: &Trajectory) -> Vec<f64> {
    let rounding = ran.rounding(subject, run);
    let mut most = 0.0_f64;
    let bound = |(k, size): (usize, &f64)| {
        most = most.max(*size);
        run.step(k) as f64 * rounding * most + ran.recorded(run, 0) + ran.recorded(run, k)
    };
    ran.sizes(subject, run)
        .iter()
        .enumerate()
        .map(bound)
        .collect()
}
