//! Schemes that are composed of a step and a way to apply it, or of two steps' forces: right or not, they
//! are what people write, and none of them is a row of the registry.
//!
//! What they apply a step to is a [`System`] of its own: one particle among others that stand still, or
//! forces that are held over a step.

use super::Identity;
use super::altered::{Alone, Altered, Altering, Around, OneStep};
use super::candidate::{Candidate, Factor, Forces, ScaledAt, Scaling};
use super::channels;
use super::replay::FIT;
use super::rods;
use super::step::{Step, acceleration, plus};
use super::treated::{explicit, said_of, treated};
use crate::integrators::{self, DampingTreatment::Explicit, Method, Stage, StepError};
use crate::physics::{ParticleSystem, State, System};
use crate::scene::{Magnetic, Particle, Scene};
use crate::trajectory::Rows;
use std::sync::{Arc, LazyLock};

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
        |step, f, h, _, s| each_alone(step, f, h, s, true),
    ),
    (
        "one_by_one",
        "each particle takes its whole step alone, with its neighbours frozen",
        |step, f, h, _, s| each_alone(step, f, h, s, false),
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

/// The half step at the new velocity.
const MIDPOINT_KICKED: Step = Step::formula(
    Some([&[0.5, 0.25], &[1.0, 0.5]]),
    [&[1.0, 0.5], &[1.0, 0.0, 1.0]],
);

/// The first steps that Adams and Bashforth's method is begun with.
const AB2_FIRST: [(&str, &str); 5] = [
    ("explicit_euler", "explicit Euler"),
    ("symplectic_euler", "symplectic Euler"),
    ("midpoint", "midpoint"),
    ("heun", "Heun's"),
    ("rk4", "rk4"),
];
const AB2: Step = Step::formula(None, [&[1.5, 0.0, 0.0, 0.0, -0.5], PREDICTED]);
const PREDICTED: &[f64] = &[1.0, 1.5, 0.0, -0.5];

/// Where Beeman's method takes its dampers.
const BEEMAN: [(&str, Step); 3] = [
    ("the velocity from the start of the step", beeman(&[1.0])),
    ("v0 + h a0", beeman(&[1.0, 1.0])),
    (
        "the velocity that Adams and Bashforth's method predicts",
        beeman(PREDICTED),
    ),
];

/// Beeman 1976, with the second force at this velocity.
const fn beeman(velocity: &'static [f64]) -> Step {
    const X: &[f64] = &[1.0, 2.0 / 3.0, 0.0, -1.0 / 6.0];
    const V: &[f64] = &[1.0, 5.0 / 6.0, 1.0 / 3.0, -1.0 / 6.0];
    Step::formula(Some([X, velocity]), [X, V])
}

/// Schemes of two steps, or with a first step of their own.
fn two_steps(forces: &Forces) -> Vec<Candidate> {
    let new = |id, step| Candidate::new(forces, step, id);
    let splitting = |stages| Step::splitting(stages, Explicit);
    let staggered = |says, first, then| {
        let then = new("leapfrog_staggered", splitting(then));
        then.begun(Some(splitting(first)))
            .named("leapfrog_staggered", says)
    };
    let mut all = vec![
        staggered(
            EARLY,
            &[Stage::Kick(0.5), Stage::Drift(1.0)],
            Stage::SYMPLECTIC_EULER,
        ),
        staggered(
            LATE,
            &[Stage::Kick(0.5), Stage::Drift(1.0), Stage::Kick(1.0)],
            Stage::SYMPLECTIC_EULER_DRIFT_FIRST,
        ),
    ];
    all.extend(AB2_FIRST.map(|(first, name)| {
        let says = format!("Adams and Bashforth's second-order method, begun with {name}");
        let first = integrators::find(first).map(Step::Method);
        new("ab2", AB2).begun(first).named("ab2", says)
    }));
    all.extend(BEEMAN.map(|(at, step)| {
        let says = format!(
            "Beeman's method, begun with the first force as the one before it; dampers act at {at}"
        );
        new("beeman", step).named("beeman", says)
    }));
    all
}

/// Every composed scheme in this scene, the likelier ones first.
pub fn composed(scene: &Scene, system: &ParticleSystem) -> Vec<Candidate> {
    let forces: Forces = Arc::new(system.clone());
    let around = |around, method: &'static Method, meant| {
        Candidate::new(&forces, Step::Method(method), meant).around(Some(around))
    };
    let mut all = treated(system);
    all.extend(rods::composed(system));
    all.push(Candidate::new(&forces, MIDPOINT_KICKED, "midpoint_kicked").named(
        "midpoint_kicked",
        "midpoint with its half step taken at the new velocity, x0 + h/2 (v0 + h/2 a0): of order 2 as well",
    ));
    all.extend(two_steps(&forces));
    // Implicit Euler's first Newton iterate from v0.
    let newton = integrators::find("linearized_implicit_predicted");
    if let Some(newton) = newton {
        all.extend(STOPPED.map(|n| {
            let says = "Newton's iteration is stopped before it has converged";
            let stopped = around(stopped, newton, "implicit_euler").in_substeps(n);
            stopped.named("stopped(implicit_euler)", says)
        }));
    }
    all.extend(damped(scene));
    if let Some(newton) = newton.filter(|_| system.kinds().depends_on_velocity()) {
        let says = "dampers and drag are solved implicitly, at the velocity after the kick";
        all.push(around(implicit_damping, newton, "symplectic_euler").named(
            "symplectic_euler+implicit_damping",
            said_of(system.kinds(), says),
        ));
    }
    if let Some(euler) = integrators::find("symplectic_euler") {
        all.extend((2..=MOST_SUBSTEPS).map(|n| {
            let says = "forces are computed once a step and held over its substeps";
            let held = around(held, euler, euler.id).in_substeps(n);
            held.named("forces_held(symplectic_euler)", says)
        }));
    }
    for (id, says, around) in ORDERS {
        let single = |step, name| {
            let candidate = Candidate::new(&forces, step, name).each_alone(around);
            candidate.named(format!("{id}({name})"), says)
        };
        let methods = explicit(system.kinds());
        all.extend(methods.map(|method| single(Step::Method(method), method.id)));
        all.push(single(MIDPOINT_KICKED, "midpoint"));
    }
    all
}

/// The composed schemes that a scene may have: id, and what it does.
pub fn composed_schemes() -> &'static [(String, String)] {
    static ALL: LazyLock<Vec<(String, String)>> = LazyLock::new(|| {
        // Drag and a magnetic field make room for all of them.
        let particle = Particle {
            drag: 1.0,
            charge: 1.0,
            ..Particle::default()
        };
        let scene = Scene {
            particles: vec![particle],
            magnetic: Some(Magnetic {
                field: [0.0, 0.0, 1.0],
            }),
            ..Scene::default()
        };
        let composed = |scene: &Scene| composed(scene, &ParticleSystem::new(scene));
        let all = composed(&scene).into_iter().chain(rods::every());
        let named = all.map(|scheme| (scheme.id, scheme.says.unwrap_or_default().into_owned()));
        let mut named: Vec<(String, String)> = named.collect();
        let mut seen = std::collections::HashSet::new();
        named.retain(|(id, _)| seen.insert(id.clone()));
        named
    });
    &ALL
}

/// Methods under all forces but drag, which multiplies velocities before the kick, after it or at the end.
fn damped(scene: &Scene) -> Vec<Candidate> {
    // Whoever multiplies velocities brings them to rest, and not to the velocity of the air.
    if scene.air().velocity != [0.0; 3] {
        return Vec::new();
    }
    let Some(without) = channels::scaled(scene, &[("drag", 0.0)]) else {
        return Vec::new();
    };
    let without = ParticleSystem::new(&without);
    let kinds = without.kinds();
    let forces: Forces = Arc::new(without);
    let rate = |p: &Particle| if p.fixed { 0.0 } else { p.drag / p.mass };
    let rates: Arc<[f64]> = scene.particles.iter().flat_map(|p| [rate(p); 3]).collect();
    let mut all = Vec::new();
    for method in explicit(kinds) {
        for (id, says, factor) in TREATMENTS {
            for at in [ScaledAt::Start, ScaledAt::Kick, ScaledAt::End] {
                if at == ScaledAt::Kick && method.id != "symplectic_euler" {
                    continue;
                }
                let rates = Arc::clone(&rates);
                let candidate = Candidate::new(&forces, Step::Method(method), method.id);
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

/// The method's substeps under the acceleration at the start.
fn held(step: &OneStep, system: &dyn System, h: f64, substeps: u32, state: &mut State) -> Stepped {
    let a = acceleration(system, state.t, &state.x, &state.v);
    let held = Altered::new(system, Altering::Held(a));
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
        let shifted = Altered::new(system, Altering::Shifted(shift));
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
    let held = Altered::new(system, Altering::PositionsHeld(state.x.clone()));
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
