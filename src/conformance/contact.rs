//! Contact: steps that are cut at an impact, and steps on a rough surface, keep the order.

use super::order::{DERIVATION, HORIZON, INSTANTS, judge, refined, rounding};
use super::subject::{Broken, Subject, distance, largest};
use super::systems::built;
use super::{Finding, Law};
use crate::physics::State;
use crate::scene::{Collider, Particle, Plane, Scene, SolverSpec, Spring};
use crate::solvers;

pub(super) const LAW: Law = Law {
    id: "contact",
    summary: "the order claimed where steps are cut: an oscillator that meets a wall, and one that turns on a rough floor",
    derivation: DERIVATION,
    judge: |subject| {
        let order = subject.claims.order;
        // Of higher order, where in its step an event is shows in all steps above rounding.
        if order > 4 {
            return Ok(Finding::skip("an order at contact that can be measured"));
        }
        // Whatever breaks the contract of a step does so without contact.
        let (system, mut start) = built(&oscillator(wall()));
        subject.advance(&system, 0.01, 1, &mut start)?;
        let mut findings = Vec::new();
        let cases: [(&str, Collider, Exact); 2] =
            [("impacts", wall(), bounced), ("friction", floor(), rubbed)];
        for (name, collider, exact) in cases {
            let mut finding = on(subject, &oscillator(collider), exact)?;
            finding.message = format!("{name}: {}", finding.message);
            findings.push(finding);
        }
        let worst = Finding::worst(findings, |found| (found - f64::from(order)).abs());
        Ok(worst.unwrap_or_else(|| Finding::skip("contact")))
    },
};

/// Position, m, and velocity, m/s, at a time, s, of a mass on a spring that starts at rest at 1 m.
type Exact = fn(f64) -> [f64; 2];

/// w, rad/s.
const W: f64 = 5.0;
/// Where the wall is, m, and the part of the speed that it gives back.
const WALL: (f64, f64) = (-0.3, 0.8);
/// Friction over the mass, m/s².
const FRICTION: f64 = 2.0;
const GRAVITY: f64 = 10.0;

fn wall() -> Collider {
    let plane = Plane {
        normal: [1.0, 0.0, 0.0],
        offset: WALL.0,
    };
    Collider {
        plane: Some(plane),
        restitution: WALL.1,
        ..Collider::default()
    }
}

fn floor() -> Collider {
    let friction = FRICTION / GRAVITY;
    Collider {
        plane: Some(Plane::default()),
        friction,
        static_friction: friction,
        ..Collider::default()
    }
}

fn oscillator(collider: Collider) -> Scene {
    let particle = |x: f64, fixed: bool| Particle {
        position: [x, 0.0, 0.0],
        mass: 1.0,
        radius: 0.0,
        fixed,
        ..Particle::default()
    };
    let gravity = if collider.friction > 0.0 {
        -GRAVITY
    } else {
        0.0
    };
    Scene {
        name: "oscillator in contact".into(),
        solver: SolverSpec {
            method: "rk4".into(),
            timestep: 0.01,
            gravity,
            ..SolverSpec::default()
        },
        duration: HORIZON,
        particles: vec![particle(0.0, true), particle(1.0, false)],
        springs: vec![Spring {
            ends: [0, 1],
            stiffness: W * W,
            ..Spring::default()
        }],
        colliders: vec![collider],
        ..Scene::default()
    }
}

/// Position and velocity `t` seconds after these, about a centre.
fn swung(center: f64, [x, v]: [f64; 2], t: f64) -> [f64; 2] {
    let ((sin, cos), x) = ((W * t).sin_cos(), x - center);
    [center + x * cos + v / W * sin, v * cos - W * x * sin]
}

/// After an impact at speed u it is back at the wall when wall cos w t + u/w sin w t = wall.
fn bounced(t: f64) -> [f64; 2] {
    let (wall, given) = WALL;
    let (mut from, mut state, mut lasts) = (0.0, [1.0, 0.0], wall.acos() / W);
    while t > from + lasts {
        let [_, v] = swung(0.0, state, lasts);
        from += lasts;
        state = [wall, -given * v];
        lasts = 2.0 * (state[1] / W).atan2(wall) / W;
    }
    swung(0.0, state, t - from)
}

/// Friction moves the centre of each half swing to the side that it comes from.
fn rubbed(t: f64) -> [f64; 2] {
    let aside = FRICTION / (W * W);
    let half = std::f64::consts::PI / W;
    let turns = (t / half).floor();
    let side = if turns % 2.0 == 0.0 { 1.0 } else { -1.0 };
    let turned = side * (1.0 - 2.0 * turns * aside);
    swung(side * aside, [turned, 0.0], t - turns * half)
}

fn on(subject: &Subject, scene: &Scene, exact: Exact) -> Result<Finding, Broken> {
    let (system, start) = built(scene);
    let scale = largest(&start).max(W);
    let observed = refined(subject, subject.claims.order, |steps| {
        let mut integrator = subject.fresh();
        let (mut state, mut error) = (start.clone(), 0.0_f64);
        let h = HORIZON / steps as f64;
        for n in 1..=steps {
            let end = HORIZON * n as f64 / steps as f64;
            solvers::advance(integrator.as_mut(), &system, h, end, &mut state)
                .map_err(|error| Broken::Step { h, error })?;
            if !state.is_finite() {
                return Err(Broken::NotFinite { h });
            }
            if n % (steps / INSTANTS) == 0 {
                let [x, v] = exact(end);
                let mut right = State::new(start.x.clone(), start.v.clone());
                (right.x[3], right.v[3]) = (x, v);
                error = error.max(distance(&state, &right));
            }
        }
        // The closed form rounds a dozen operations, and events are located to 1e-13 of a step or
        // so, where regula falsi stops below 1e-12.
        let floor = 160.0 * f64::EPSILON * scale + 1e-13 * h * scale;
        Ok((error, floor + rounding(steps, scale)))
    })?;
    Ok(judge(&observed, subject.claims.order))
}
