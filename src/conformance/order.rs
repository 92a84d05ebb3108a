//! Order: halve the step, and the error falls by 2 to the order.

use super::Law;
use super::finding::Verdict;
use super::reference::{Reference, largest};
use super::subject::{Broken, Subject, advance, distance};
use super::systems::{Driven, swinging_triangle};
use crate::measure::order::{
    Observed, Point, RATIOS, TOLERANCE, Verdict as OrderVerdict, observed,
};
use crate::outcome::CheckStatus;
use crate::physics::{ParticleSystem, State, System};
use crate::scene::{DampingModel, Scene};

const DERIVATION: &str = "the observed order is an extrapolation of at least four slopes that agree \
                          within 0.05 among themselves; these systems have no symmetry that could \
                          make an error vanish";

pub(super) const UNDAMPED: Law = Law {
    id: "order",
    summary: "the order claimed, on a network without damping",
    derivation: DERIVATION,
    judge: |subject| {
        let network = Network::new(&swinging_triangle(0.0, DampingModel::Axial));
        network.judge(subject, subject.claims.order)
    },
};

pub(super) const DAMPED: Law = Law {
    id: "order-damped",
    summary: "the order claimed with damping: axial and isotropic dampers, and drag",
    derivation: DERIVATION,
    judge: |subject| {
        let Some(order) = subject.claims.order_damped else {
            return Ok(Verdict::skip("the order with damping"));
        };
        let mut verdicts = Vec::new();
        for (name, scene) in damped() {
            let mut verdict = Network::new(&scene).judge(subject, order)?;
            verdict.message = format!("{name}: {}", verdict.message);
            verdicts.push(verdict);
        }
        let worst = Verdict::worst(verdicts, |found| (found - f64::from(order)).abs());
        Ok(worst.unwrap_or_else(|| Verdict::skip("any damping")))
    },
};

pub(super) const DRIVEN: Law = Law {
    id: "order-driven",
    summary: "the order claimed, under a force that depends on time: every stage has its own",
    derivation: DERIVATION,
    judge: |subject| {
        let truth: Vec<State> = instants().map(Driven::exact).collect();
        let scale = truth.iter().fold(0.0, |most: f64, s| most.max(largest(s)));
        // Sines, cosines and a dozen operations.
        let bar = 16.0 * f64::EPSILON * scale;
        let observed = ladder(subject, &Driven, &Driven::start(), &truth, bar)?;
        Ok(judge(&observed, subject.claims.order))
    },
};

/// Particles share dampers, so that their flows do not commute.
fn damped() -> [(&'static str, Scene); 3] {
    let mut dragged = swinging_triangle(0.4, DampingModel::Axial);
    for particle in dragged.particles.iter_mut().skip(2).take(1) {
        particle.drag = 0.5;
    }
    [
        ("axial dampers", swinging_triangle(0.8, DampingModel::Axial)),
        (
            "isotropic dampers",
            swinging_triangle(0.8, DampingModel::Isotropic),
        ),
        ("dampers and drag", dragged),
    ]
}

struct Network {
    system: ParticleSystem,
    start: State,
    reference: Reference,
}

impl Network {
    fn new(scene: &Scene) -> Self {
        let (system, start) = (
            ParticleSystem::new(scene),
            ParticleSystem::initial_state(scene),
        );
        let reference = Reference::new(&system, &start, HORIZON, INSTANTS);
        Self {
            system,
            start,
            reference,
        }
    }

    fn judge(&self, subject: &Subject, stated: u32) -> Result<Verdict, Broken> {
        let Reference { states, bar } = &self.reference;
        let observed = ladder(subject, &self.system, &self.start, states, *bar)?;
        Ok(judge(&observed, stated))
    }
}

/// About a period of the slowest mode, s; short enough that no error saturates.
pub(super) const HORIZON: f64 = 1.0;
/// Where errors are looked at: at a single moment two of opposite sign might cancel.
pub(super) const INSTANTS: usize = 10;

fn instants() -> impl Iterator<Item = f64> {
    (1..=INSTANTS).map(|at| HORIZON * at as f64 / INSTANTS as f64)
}

/// The largest error over the horizon at each step of a ladder.
fn ladder(
    subject: &Subject,
    system: &dyn System,
    start: &State,
    truth: &[State],
    bar: f64,
) -> Result<Observed, Broken> {
    let scale = truth
        .iter()
        .fold(largest(start), |most, s| most.max(largest(s)));
    climb(subject, subject.claims.order, |steps| {
        let mut integrator = subject.fresh();
        let (mut state, mut error) = (start.clone(), 0.0_f64);
        for exact in truth {
            let h = HORIZON / steps as f64;
            advance(integrator.as_mut(), system, h, steps / INSTANTS, &mut state)?;
            error = error.max(distance(&state, exact));
        }
        Ok((error, 10.0 * bar + rounding(steps, scale)))
    })
}

/// What rounding may have added up to after so many steps on values of this size: half a last bit in
/// each of a few sums a step, at random.
pub(super) fn rounding(steps: usize, scale: f64) -> f64 {
    4.0 * f64::EPSILON * scale * (steps as f64).sqrt()
}

/// Reads the order off errors and floors at ever more steps over the horizon, until there are
/// enough and an error is at its floor, or the steps are as small as a first order needs.
pub(super) fn climb(
    subject: &Subject,
    stated: u32,
    mut error: impl FnMut(usize) -> Result<(f64, f64), Broken>,
) -> Result<Observed, Broken> {
    let mut points = Vec::new();
    let mut broken = None;
    for steps in rungs(subject.claims.order) {
        match error(steps) {
            Ok((error, floor)) => {
                let floor = floor * sensitivity(subject.claims.order);
                let h = HORIZON / steps as f64;
                points.push(Point { h, error, floor });
                if error <= floor && points.len() > RATIOS {
                    break;
                }
            }
            // Too coarse a step may be one too many; a smaller one is another matter.
            Err(error) => broken = Some(error),
        }
    }
    match broken {
        Some(broken) if points.is_empty() => Err(broken),
        _ => Ok(observed(&points, stated)),
    }
}

/// Above this order a few halvings lead from too coarse to rounding, and steps lie closer.
const HALVED: u32 = 4;

/// How much more rounding shows in the slopes of steps 1.3 apart than in those of halved ones: an error
/// of e in a quotient is one of e / ln 1.3 instead of e / ln 2 in a slope, and five steps span a range
/// 5.6 times smaller, over which slopes have to agree so much better.
fn sensitivity(order: u32) -> f64 {
    if order > HALVED { 15.0 } else { 1.0 }
}

/// Numbers of steps, multiples of [`INSTANTS`]: doubled from 50 to 12,800, or from 20 on by factors
/// of about 1.3.
fn rungs(order: u32) -> Vec<usize> {
    if order <= HALVED {
        return (0..9).map(|doubled| 50 << doubled).collect();
    }
    let mut rungs: Vec<usize> = (0..16)
        .map(|rung| INSTANTS * (2.0 * 1.3_f64.powi(rung)).round() as usize)
        .collect();
    rungs.dedup();
    rungs
}

fn judge(observed: &Observed, stated: u32) -> Verdict {
    let Some(order) = observed.order else {
        let why = match observed.verdict {
            OrderVerdict::Inconclusive(reason) => reason.to_string(),
            _ => String::new(),
        };
        let message = format!("claims order {stated}: {why}");
        return Verdict::new(CheckStatus::Inconclusive, None, TOLERANCE, message);
    };
    let off = order - f64::from(stated);
    let status = if off.abs() <= TOLERANCE {
        CheckStatus::Pass
    } else {
        CheckStatus::Fail
    };
    let message = format!("claims order {stated}, observed {order:.3}");
    Verdict::new(status, order, f64::from(stated) - TOLERANCE, message)
}

/// As [`judge`], where a higher order is welcome: nothing was claimed of it.
pub(super) fn judge_at_least(observed: &Observed, stated: u32) -> Verdict {
    let verdict = judge(observed, stated);
    match observed.order {
        Some(order) if order > f64::from(stated) => Verdict {
            status: CheckStatus::Pass,
            ..verdict
        },
        _ => verdict,
    }
}
