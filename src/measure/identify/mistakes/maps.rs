//! One step of each wrong method, written as people write it.

use crate::integrators::{
    DampingTreatment, Implicit, ImplicitScheme, Integrator, RungeKutta, Settings, Splitting, Stage,
    StepError, Tableau,
};
use crate::measure::identify::altered::{acceleration, finish, plus};
use crate::measure::identify::compose::DRIFT_FIRST;
use crate::physics::{State, System};

/// The result of a step.
type Stepped = Result<(), StepError>;

pub(super) fn tableau(tableau: Tableau, system: &dyn System, h: f64, state: &mut State) -> Stepped {
    RungeKutta::new(tableau).step(system, h, state)
}

pub(super) fn splitting(
    stages: &'static [Stage],
    damping: DampingTreatment,
    system: &dyn System,
    h: f64,
    state: &mut State,
) -> Stepped {
    Splitting::new(stages, damping).step(system, h, state)
}

pub(super) const MIDPOINT_HALF_LAST_STAGE: Tableau = Tableau {
    a: &[&[], &[0.5]],
    b: &[0.0, 0.5],
    c: &[0.0, 0.5],
};

pub(super) const MIDPOINT_FROM_THE_MIDDLE: Tableau = Tableau {
    a: &[&[], &[0.5]],
    b: &[0.5, 1.0],
    c: &[0.0, 0.5],
};

pub(super) const HEUN_NOT_HALVED: Tableau = Tableau {
    a: &[&[], &[1.0]],
    b: &[1.0, 1.0],
    c: &[0.0, 1.0],
};

pub(super) const RALSTON_SWAPPED_WEIGHTS: Tableau = Tableau {
    a: &[&[], &[2.0 / 3.0]],
    b: &[0.75, 0.25],
    c: &[0.0, 2.0 / 3.0],
};

pub(super) const RK4_EQUAL_WEIGHTS: Tableau = Tableau {
    a: &[&[], &[0.5], &[0.0, 0.5], &[0.0, 0.0, 1.0]],
    b: &[0.25, 0.25, 0.25, 0.25],
    c: &[0.0, 0.5, 0.5, 1.0],
};

pub(super) const RK4_HALF_LAST_STAGE: Tableau = Tableau {
    a: &[&[], &[0.5], &[0.0, 0.5], &[0.0, 0.0, 0.5]],
    b: &[1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0],
    c: &[0.0, 0.5, 0.5, 0.5],
};

pub(super) const RK4_STAGE_ON_STAGE: Tableau = Tableau {
    a: &[&[], &[0.5], &[0.5, 0.5], &[0.5, 0.5, 1.0]],
    b: &[1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0],
    c: &[0.0, 0.5, 0.5, 1.0],
};

pub(super) fn midpoint_end_velocity(
    system: &dyn System,
    h: f64,
    _: Option<&State>,
    s: &mut State,
) -> Stepped {
    let a = acceleration(system, s.t, &s.x, &s.v);
    let (x, v) = (plus(&s.x, 0.5 * h, &s.v), plus(&s.v, 0.5 * h, &a));
    let a = acceleration(system, s.t + 0.5 * h, &x, &v);
    let v = plus(&s.v, h, &a);
    finish(s, h, plus(&s.x, h, &v), v)
}

/// v1 = v0 + h (a0 + all accelerations before): their sum is what the last step added to v, over h.
/// The first step is right.
fn accumulated(system: &dyn System, h: f64, before: Option<&State>, s: &State) -> Vec<f64> {
    let a = acceleration(system, s.t, &s.x, &s.v);
    let mut v = plus(&s.v, h, &a);
    if let Some(before) = before {
        for ((v, now), then) in v.iter_mut().zip(&s.v).zip(&before.v) {
            *v += now - then;
        }
    }
    v
}

pub(super) fn explicit_euler_accumulating(
    system: &dyn System,
    h: f64,
    before: Option<&State>,
    s: &mut State,
) -> Stepped {
    let v = accumulated(system, h, before, s);
    finish(s, h, plus(&s.x, h, &s.v), v)
}

pub(super) fn symplectic_euler_accumulating(
    system: &dyn System,
    h: f64,
    before: Option<&State>,
    s: &mut State,
) -> Stepped {
    let v = accumulated(system, h, before, s);
    finish(s, h, plus(&s.x, h, &v), v)
}

/// v1 = v0 + h a(state before). The first step is right.
fn late(system: &dyn System, h: f64, before: Option<&State>, s: &State) -> Vec<f64> {
    let a = match before {
        Some(before) => acceleration(system, s.t - h, &before.x, &before.v),
        None => acceleration(system, s.t, &s.x, &s.v),
    };
    plus(&s.v, h, &a)
}

pub(super) fn explicit_euler_stale_force(
    system: &dyn System,
    h: f64,
    before: Option<&State>,
    s: &mut State,
) -> Stepped {
    let v = late(system, h, before, s);
    finish(s, h, plus(&s.x, h, &s.v), v)
}

pub(super) fn symplectic_euler_stale_force(
    system: &dyn System,
    h: f64,
    before: Option<&State>,
    s: &mut State,
) -> Stepped {
    let v = late(system, h, before, s);
    finish(s, h, plus(&s.x, h, &v), v)
}

/// v0 + h/2 (a0 + a(x1, v)).
fn mean_kick(system: &dyn System, h: f64, s: &State, a: &[f64], x: &[f64], v: &[f64]) -> Vec<f64> {
    let new = acceleration(system, s.t + h, x, v);
    plus(&plus(&s.v, 0.5 * h, a), 0.5 * h, &new)
}

pub(super) fn verlet_stale_force(
    system: &dyn System,
    h: f64,
    _: Option<&State>,
    s: &mut State,
) -> Stepped {
    let a = acceleration(system, s.t, &s.x, &s.v);
    let half = plus(&s.v, 0.5 * h, &a);
    finish(s, h, plus(&s.x, h, &half), plus(&half, 0.5 * h, &a))
}

pub(super) fn verlet_new_force_only(
    system: &dyn System,
    h: f64,
    _: Option<&State>,
    s: &mut State,
) -> Stepped {
    let a = acceleration(system, s.t, &s.x, &s.v);
    let x = plus(&s.x, h, &plus(&s.v, 0.5 * h, &a));
    let new = acceleration(system, s.t + h, &x, &s.v);
    let v = plus(&s.v, h, &new);
    finish(s, h, x, v)
}

pub(super) fn verlet_missing_half(
    system: &dyn System,
    h: f64,
    _: Option<&State>,
    s: &mut State,
) -> Stepped {
    let a = acceleration(system, s.t, &s.x, &s.v);
    let x = plus(&s.x, h, &plus(&s.v, h, &a));
    let v = mean_kick(system, h, s, &a, &x, &plus(&s.v, 0.5 * h, &a));
    finish(s, h, x, v)
}

pub(super) fn yoshida4_swapped_coefficients(
    system: &dyn System,
    h: f64,
    _: Option<&State>,
    s: &mut State,
) -> Stepped {
    const W1: f64 = 1.351_207_191_959_657_8;
    for w in [1.0 - 2.0 * W1, W1, W1] {
        splitting(DRIFT_FIRST, DampingTreatment::Sweeps, system, w * h, s)?;
    }
    Ok(())
}

pub(super) fn implicit_euler_old_velocity(
    system: &dyn System,
    h: f64,
    _: Option<&State>,
    s: &mut State,
) -> Stepped {
    let x = plus(&s.x, h, &s.v);
    Implicit::new(ImplicitScheme::Euler, &Settings::default()).step(system, h, s)?;
    s.x = x;
    Ok(())
}

pub(super) fn implicit_euler_one_pass(
    system: &dyn System,
    h: f64,
    _: Option<&State>,
    s: &mut State,
) -> Stepped {
    let a = acceleration(system, s.t, &s.x, &s.v);
    let (x, v) = (plus(&s.x, h, &s.v), plus(&s.v, h, &a));
    let a = acceleration(system, s.t + h, &x, &v);
    let v = plus(&s.v, h, &a);
    finish(s, h, plus(&s.x, h, &v), v)
}
