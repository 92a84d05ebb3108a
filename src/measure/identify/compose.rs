//! Schemes that are composed of a method and a way to apply it, or of two steps' forces: right or not, they
//! are what people write, and none of them is a row of the registry.
//!
//! What they apply a method to is a [`System`] of its own: one particle among others that stand still, or
//! forces that are held over a step.

use super::Identity;
use super::altered::{Alone, Altered, Altering, Around, OneStep, acceleration, finish, plus};
use super::candidate::{Candidate, Factor, Forces, Map, ScaledAt, Scaling, Scheme, Step};
use super::channels;
use super::replay::FIT;
use crate::integrators::{
    self, Coefficients, DampingTreatment, Integrator, Method, Settings, Splitting, Stage,
    StepError, fixed,
};
use crate::physics::{ParticleSystem, State, System};
use crate::scene::Scene;
use crate::trajectory::Rows;
use std::sync::Arc;

type Stepped = Result<(), StepError>;

/// Substeps under held forces that are tried.
const MOST_SUBSTEPS: u32 = 16;
/// Newton iterations after which a solve may have been stopped.
const STOPPED: [u32; 4] = [2, 3, 4, 5];

/// Ways to apply a method: the id's form, what it does, and how.
const ORDERS: [(&str, &str, Around); 2] = [
    (
        "in_place",
        "particles move one after the other, and each sees those that have already moved",
        in_place,
    ),
    (
        "one_by_one",
        "each particle takes its whole step alone, with its neighbours frozen",
        one_by_one,
    ),
];

/// Treatments of drag beside the kick: the id's ending, what it does, and the factor by b/m and h.
const TREATMENTS: [(&str, &str, Factor); 4] = [
    (
        "exponential_damping",
        "velocities are multiplied by exp(-h b / m) instead of a drag force",
        |rate, h| (-h * rate).exp(),
    ),
    (
        "multiplied_damping",
        "velocities are multiplied by 1 - h b / m instead of a drag force",
        |rate, h| 1.0 - h * rate,
    ),
    (
        "implicit_damping",
        "velocities are divided by 1 + h b / m instead of a drag force",
        |rate, h| 1.0 / (1.0 + h * rate),
    ),
    (
        "power_damping",
        "velocities are multiplied by (1 - b / m)^h instead of a drag force",
        |rate, h| (1.0 - rate).powf(h),
    ),
];

/// What staggered velocities are.
const EARLY: &str = "the velocity of each row is half a step earlier than its position";
const LATE: &str = "the velocity of each row is half a step later than its position";

/// Maps of two steps, or with a first step of their own.
const MAPS: [(&str, &str, Map); 11] = [
    (
        "midpoint_kicked",
        "midpoint with its half step taken at the new velocity, x0 + h/2 (v0 + h/2 a0): of order 2 as well",
        midpoint_kicked,
    ),
    ("leapfrog_staggered", EARLY, |f, h, before, s| {
        staggered_early(f, h, before, s)
    }),
    ("leapfrog_staggered", LATE, |f, h, before, s| {
        staggered_late(f, h, before, s)
    }),
    (
        "ab2",
        "Adams and Bashforth's second-order method, begun with explicit Euler",
        |f, h, before, s| ab2("explicit_euler", f, h, before, s),
    ),
    (
        "ab2",
        "Adams and Bashforth's second-order method, begun with symplectic Euler",
        |f, h, before, s| ab2("symplectic_euler", f, h, before, s),
    ),
    (
        "ab2",
        "Adams and Bashforth's second-order method, begun with midpoint",
        |f, h, before, s| ab2("midpoint", f, h, before, s),
    ),
    (
        "ab2",
        "Adams and Bashforth's second-order method, begun with Heun's",
        |f, h, before, s| ab2("heun", f, h, before, s),
    ),
    (
        "ab2",
        "Adams and Bashforth's second-order method, begun with rk4",
        |f, h, before, s| ab2("rk4", f, h, before, s),
    ),
    (
        "beeman",
        "Beeman's method, begun with the first force as the one before it; dampers act at the velocity from the \
         start of the step",
        |f, h, before, s| beeman(&|v, _, _| v.to_vec(), f, h, before, s),
    ),
    (
        "beeman",
        "Beeman's method, begun with the first force as the one before it; dampers act at v0 + h a0",
        |f, h, before, s| beeman(&|v, now, _| plus(v, h, now), f, h, before, s),
    ),
    (
        "beeman",
        "Beeman's method, begun with the first force as the one before it; dampers act at the velocity that \
         Adams and Bashforth's method predicts",
        |f, h, before, s| {
            let predicted =
                |v: &[f64], now: &[f64], then: &[f64]| plus(&plus(v, 1.5 * h, now), -0.5 * h, then);
            beeman(&predicted, f, h, before, s)
        },
    ),
];

/// Treatments of dampers and drag in splitting methods that are not the exact flow: methods of their own where
/// there is damping. The id, the method without damping, what it does, and how.
const TREATED: [(&str, &str, &str, Map); 6] = [
    (
        "velocity_verlet_explicit_damping",
        "velocity_verlet",
        "each half kick takes the dampers at the velocity before it, which is of order 1",
        |f, h, _, s| splitting(Stage::VERLET, f, h, s),
    ),
    (
        "velocity_verlet_predicted_velocity",
        "velocity_verlet",
        "the second half kick takes the dampers at the predicted velocity v0 + h a0: of order 2, but stable for \
         smaller steps",
        |f, h, _, s| verlet(&|v, a, _| plus(v, h, a), f, h, s),
    ),
    (
        "velocity_verlet_old_velocity",
        "velocity_verlet",
        "the second half kick takes the dampers at the velocity from the start of the step, which is of order 1",
        |f, h, _, s| verlet(&|v, _, _| v.to_vec(), f, h, s),
    ),
    (
        "position_verlet_explicit_damping",
        "position_verlet",
        "the kick takes the dampers at the velocity before it, which is of order 1",
        |f, h, _, s| splitting(DRIFT_FIRST, f, h, s),
    ),
    (
        "yoshida4_explicit_damping",
        "yoshida4",
        "each kick takes the dampers at the velocity before it, which is of order 1",
        |f, h, _, s| splitting(Stage::YOSHIDA4, f, h, s),
    ),
    (
        "pefrl_explicit_damping",
        "pefrl",
        "each kick takes the dampers at the velocity before it, which is of order 1",
        |f, h, _, s| splitting(Stage::PEFRL, f, h, s),
    ),
];

/// Position Verlet.
pub(super) const DRIFT_FIRST: &[Stage] = &[Stage::Drift(0.5), Stage::Kick(1.0), Stage::Drift(0.5)];

/// The splitting methods with other treatments of damping; none where nothing is damped.
pub(super) fn treated(system: &ParticleSystem) -> Vec<Candidate> {
    if !system.kinds().depends_on_velocity() {
        return Vec::new();
    }
    let forces: Forces = Arc::new(system.clone());
    let treated = TREATED.map(|(id, meant, says, map)| {
        Candidate::new(&forces, Scheme::Map(map), meant).named(id, says)
    });
    treated.to_vec()
}

/// Every composed scheme in this scene, the likelier ones first.
pub fn composed(scene: &Scene, system: &ParticleSystem) -> Vec<Candidate> {
    let forces: Forces = Arc::new(system.clone());
    let mut all = treated(system);
    for (id, says, map) in MAPS {
        let map = Candidate::new(&forces, Scheme::Map(map), id);
        all.push(map.named(id, says).remembering(id != "midpoint_kicked"));
    }
    if let Some(newton) = one_newton_step() {
        all.extend(STOPPED.map(|n| {
            let says = "Newton's iteration is stopped before it has converged";
            let scheme = Scheme::Around(stopped, Step::Method(newton));
            let stopped = Candidate::new(&forces, scheme, "implicit_euler").in_substeps(n);
            stopped.named("stopped(implicit_euler)", says)
        }));
    }
    all.extend(damped(scene));
    if let (true, Some(newton)) = (system.kinds().depends_on_velocity(), one_newton_step()) {
        let says = "dampers and drag are solved implicitly, at the velocity after the kick";
        let scheme = Scheme::Around(implicit_damping, Step::Method(newton));
        let candidate = Candidate::new(&forces, scheme, "symplectic_euler");
        all.push(candidate.named("symplectic_euler+implicit_damping", says));
    }
    if let Some(euler) = integrators::find("symplectic_euler") {
        all.extend((2..=MOST_SUBSTEPS).map(|n| {
            let says = "forces are computed once a step and held over its substeps";
            let candidate =
                Candidate::new(&forces, Scheme::Around(held, Step::Method(euler)), euler.id);
            let candidate = candidate.in_substeps(n);
            candidate.named("forces_held(symplectic_euler)", says)
        }));
    }
    for (id, says, around) in ORDERS {
        let single = |step, name| {
            let candidate = Candidate::new(&forces, Scheme::Around(around, step), name);
            candidate.named(format!("{id}({name})"), says)
        };
        all.extend(explicit().map(|method| single(Step::Method(method), method.id)));
        all.push(single(Step::Map(midpoint_kicked), "midpoint"));
    }
    all
}

/// The ids of all composed schemes that a scene may have.
pub fn ids() -> Vec<String> {
    let treated = TREATED.iter().map(|(id, ..)| *id);
    let maps = MAPS.iter().map(|(id, ..)| *id).chain(treated);
    let maps = maps.map(str::to_owned);
    let orders = ORDERS
        .iter()
        .flat_map(|(id, ..)| explicit().map(move |method| format!("{id}({})", method.id)));
    let damped = TREATMENTS
        .iter()
        .flat_map(|(id, ..)| explicit().map(move |method| format!("{}+{id}", method.id)));
    let single = [
        "stopped(implicit_euler)",
        "symplectic_euler+implicit_damping",
        "forces_held(symplectic_euler)",
    ];
    let mut ids: Vec<String> = maps
        .chain(single.map(str::to_owned))
        .chain(orders)
        .chain(damped)
        .collect();
    ids.dedup();
    ids
}

/// Implicit Euler's first Newton iterate from v0.
fn one_newton_step() -> Option<&'static Method> {
    integrators::find("linearized_implicit_predicted")
}

/// The methods whose steps solve nothing.
fn explicit() -> impl Iterator<Item = &'static Method> {
    let solves = |method: &&Method| matches!(method.coefficients, Coefficients::Implicit(_));
    fixed().iter().filter(move |method| !solves(method))
}

/// Methods under all forces but drag, which multiplies velocities before the kick, after it or at the end.
fn damped(scene: &Scene) -> Vec<Candidate> {
    let Some(without) = channels::scaled(scene, &[("drag", 0.0)]) else {
        return Vec::new();
    };
    let forces: Forces = Arc::new(ParticleSystem::new(&without));
    let rate = |p: &crate::scene::Particle| if p.fixed { 0.0 } else { p.drag / p.mass };
    let rates: Arc<[f64]> = scene.particles.iter().flat_map(|p| [rate(p); 3]).collect();
    let mut all = Vec::new();
    for method in explicit() {
        for (id, says, factor) in TREATMENTS {
            for at in [ScaledAt::Start, ScaledAt::Kick, ScaledAt::End] {
                if at == ScaledAt::Kick && method.id != "symplectic_euler" {
                    continue;
                }
                let rates = Arc::clone(&rates);
                let candidate = Candidate::new(&forces, Scheme::Method(method), method.id);
                let candidate = candidate.scaled(Scaling { factor, rates, at });
                let says = format!("{says}, {}", at.words());
                all.push(candidate.named(format!("{}+{id}", method.id), says));
            }
        }
    }
    all
}

/// Steps each free particle alone: in place it sees the particles before it where they have moved to, else all
/// others where they were.
fn each_alone(
    step: &OneStep,
    system: &dyn System,
    h: f64,
    state: &mut State,
    in_place: bool,
) -> Stepped {
    let start = state.clone();
    for at in (0..system.dim()).step_by(3) {
        if system.inverse_mass()[at] == 0.0 {
            continue;
        }
        let others = if in_place {
            state.clone()
        } else {
            start.clone()
        };
        let mut own = State::new(start.x[at..at + 3].to_vec(), start.v[at..at + 3].to_vec());
        own.t = start.t;
        let alone = Alone {
            inner: system,
            others: &others,
            at,
        };
        step(&alone, h, &mut own)?;
        state.x[at..at + 3].copy_from_slice(&own.x);
        state.v[at..at + 3].copy_from_slice(&own.v);
    }
    state.t += h;
    Ok(())
}

fn in_place(step: &OneStep, system: &dyn System, h: f64, _: u32, state: &mut State) -> Stepped {
    each_alone(step, system, h, state, true)
}

fn one_by_one(step: &OneStep, system: &dyn System, h: f64, _: u32, state: &mut State) -> Stepped {
    each_alone(step, system, h, state, false)
}

/// The method's substeps under the acceleration at the start.
fn held(step: &OneStep, system: &dyn System, h: f64, substeps: u32, state: &mut State) -> Stepped {
    let a = acceleration(system, state.t, &state.x, &state.v);
    let held = Altered {
        inner: system,
        force: Altering::Held(a),
    };
    for _ in 0..substeps {
        step(&held, h / f64::from(substeps), state)?;
    }
    Ok(())
}

/// Implicit Euler's Newton iterates from v0, as many as there are substeps. An iterate from u is the first
/// iterate from u under forces that are less by (u - v0) / h.
fn stopped(
    step: &OneStep,
    system: &dyn System,
    h: f64,
    iterations: u32,
    state: &mut State,
) -> Stepped {
    let start = state.clone();
    for _ in 0..iterations {
        let gained = |(u, v0): (&f64, &f64)| (v0 - u) / h;
        let shift = state.v.iter().zip(&start.v).map(gained).collect();
        let shifted = Altered {
            inner: system,
            force: Altering::Shifted(shift),
        };
        let mut next = State {
            v: state.v.clone(),
            ..start.clone()
        };
        step(&shifted, h, &mut next)?;
        *state = next;
    }
    Ok(())
}

/// v1 = v0 + h a(x0, v1), x1 = x0 + h v1: implicit Euler with positions held. Its equation is linear, so one
/// Newton step solves it.
fn implicit_damping(
    step: &OneStep,
    system: &dyn System,
    h: f64,
    _: u32,
    state: &mut State,
) -> Stepped {
    let held = Altered {
        inner: system,
        force: Altering::PositionsHeld(state.x.clone()),
    };
    step(&held, h, state)
}

/// Rows that follow an Euler method of kicks and drifts, but begin half a kick before or after the scene's start,
/// are those of a leapfrog with staggered velocities.
pub(super) fn staggered(
    system: &ParticleSystem,
    scene: &Scene,
    rows: &Rows,
    identity: Identity,
) -> Identity {
    let (says, share) = match identity.method.as_str() {
        "symplectic_euler" => (EARLY, -0.5),
        "symplectic_euler_drift_first" => (LATE, 0.5),
        _ => return identity,
    };
    let start = ParticleSystem::initial_state(scene);
    let first = rows.v.as_ref().and_then(|_| rows.v(0));
    let Some(v) = first.filter(|_| rows.steps.first() == Some(&0) && identity.substeps == 1) else {
        return identity;
    };
    let a = acceleration(system, 0.0, &start.x, &start.v);
    let kicked = plus(&start.v, share * rows.timestep, &a);
    let near = |here: &[f64]| {
        let pairs = here.iter().zip(v).enumerate();
        pairs.into_iter().all(|(i, (a, b))| {
            let unit = rows.half_unit(rows.dim + i, *b) + 4.0 * f64::EPSILON * (a.abs() + b.abs());
            (a - b).abs() <= FIT * unit
        })
    };
    if near(&start.v) || !near(&kicked) {
        return identity;
    }
    Identity {
        method: "leapfrog_staggered".to_owned(),
        says: Some(says.into()),
        equivalent: Vec::new(),
        undecided: None,
        ..identity
    }
}

fn midpoint_kicked(f: &dyn System, h: f64, _: Option<&State>, s: &mut State) -> Stepped {
    let v = plus(&s.v, 0.5 * h, &acceleration(f, s.t, &s.x, &s.v));
    let a = acceleration(f, s.t + 0.5 * h, &plus(&s.x, 0.5 * h, &v), &v);
    finish(s, h, plus(&s.x, h, &v), plus(&s.v, h, &a))
}

fn staggered_early(f: &dyn System, h: f64, before: Option<&State>, s: &mut State) -> Stepped {
    let share = if before.is_none() { 0.5 } else { 1.0 };
    let v = plus(&s.v, share * h, &acceleration(f, s.t, &s.x, &s.v));
    finish(s, h, plus(&s.x, h, &v), v)
}

fn staggered_late(f: &dyn System, h: f64, before: Option<&State>, s: &mut State) -> Stepped {
    let v = match before {
        None => plus(&s.v, 0.5 * h, &acceleration(f, s.t, &s.x, &s.v)),
        Some(_) => s.v.clone(),
    };
    let x = plus(&s.x, h, &v);
    let a = acceleration(f, s.t + h, &x, &v);
    finish(s, h, x, plus(&v, h, &a))
}

fn ab2(first: &str, f: &dyn System, h: f64, before: Option<&State>, s: &mut State) -> Stepped {
    let Some(before) = before else {
        let Some(method) = integrators::find(first) else {
            return Err(StepError::NotFinite { particle: 0 });
        };
        return method.build(&Settings::default()).step(f, h, s);
    };
    let now = acceleration(f, s.t, &s.x, &s.v);
    let then = acceleration(f, s.t - h, &before.x, &before.v);
    let x = plus(&plus(&s.x, 1.5 * h, &s.v), -0.5 * h, &before.v);
    let v = plus(&plus(&s.v, 1.5 * h, &now), -0.5 * h, &then);
    finish(s, h, x, v)
}

/// The velocity at which a step's last force takes its dampers, from v0, a0 and the acceleration before.
type Predict<'a> = &'a dyn Fn(&[f64], &[f64], &[f64]) -> Vec<f64>;

/// Beeman 1976.
fn beeman(
    predict: Predict,
    f: &dyn System,
    h: f64,
    before: Option<&State>,
    s: &mut State,
) -> Stepped {
    let now = acceleration(f, s.t, &s.x, &s.v);
    let then = match before {
        Some(before) => acceleration(f, s.t - h, &before.x, &before.v),
        None => now.clone(),
    };
    let x = plus(&plus(&s.x, h, &s.v), h * h * 2.0 / 3.0, &now);
    let x = plus(&x, -h * h / 6.0, &then);
    let next = acceleration(f, s.t + h, &x, &predict(&s.v, &now, &then));
    let v = plus(&plus(&s.v, h / 3.0, &next), h * 5.0 / 6.0, &now);
    finish(s, h, x, plus(&v, -h / 6.0, &then))
}

/// x0 + h v0 + h²/2 a0, and the mean of a0 and the force there at a velocity from v0 and a0.
fn verlet(predict: Predict, f: &dyn System, h: f64, s: &mut State) -> Stepped {
    let a = acceleration(f, s.t, &s.x, &s.v);
    let half = plus(&s.v, 0.5 * h, &a);
    let x = plus(&s.x, h, &half);
    let next = acceleration(f, s.t + h, &x, &predict(&s.v, &a, &a));
    finish(s, h, x, plus(&half, 0.5 * h, &next))
}

/// Kicks that take dampers at the velocity before them.
fn splitting(stages: &'static [Stage], f: &dyn System, h: f64, s: &mut State) -> Stepped {
    Splitting::new(stages, DampingTreatment::Explicit).step(f, h, s)
}
