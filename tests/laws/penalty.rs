//! Contact by penalty, against closed forms.

use crate::testkit::method;
use crate::testkit::scenes::parsed;
use springcheck::integrators::{self, Method, Settings};
use springcheck::physics::effects::{Effect, Penalty};
use springcheck::physics::{Derivative, ForceKinds, Jacobian, Linearization};
use springcheck::physics::{ParticleSystem, State, System};
use springcheck::scene::Scene;
use springcheck::solvers::advance;
use std::f64::consts::PI;

/// k, N/m: with 1 kg that is w = 100 rad/s.
const K: f64 = 1e4;
/// exp(-π ζ/sqrt(1 - ζ²)) for ζ = 0.1: what is left of the speed where it is released at zero depth.
const LEFT: f64 = 0.729_247_614_287_670_9;

/// Particles, a floor and more, without gravity unless said.
fn scene(particles: &str, damping: f64, gravity: f64, more: &str) -> Scene {
    parsed(&format!(
        "solver: {{type: rk4, timestep: 0.001, gravity: {gravity}}}\n\
         duration: 1\n\
         particles: [{particles}]\n\
         contact: {{particles: true, penalty: {{stiffness: {K}, damping: {damping}}}}}\n\
         {more}\n"
    ))
}

const FLOOR: &str = "colliders: [{plane: {normal: [0, 0, 1]}}]";

/// A point of 1 kg that falls on the floor at 2 m/s from this height.
fn falling(height: f64, damping: f64) -> Scene {
    let particle = format!("{{mass: 1, radius: 0, pos: [0, 0, {height}], vel: [0, 0, -2]}}");
    scene(&particle, damping, 0.0, FLOOR)
}

fn run(id: &str, scene: &Scene, h: f64, steps: u32) -> State {
    let system = ParticleSystem::new(scene);
    let mut state = ParticleSystem::initial_state(scene);
    let mut integrator = method(id).build(&Settings::default());
    for n in 1..=steps {
        state.t = f64::from(n - 1) * h;
        let end = f64::from(n) * h;
        advance(integrator.as_mut(), &system, h, end, &mut state).expect("a step");
    }
    state
}

fn balance(scene: &Scene, state: &State) -> f64 {
    let system = ParticleSystem::new(scene);
    let energy = system.kinetic(&state.v) + system.potential(state.t, &state.x);
    state.work.balance(energy)
}

fn taking(scene: &Scene) -> impl Iterator<Item = &'static Method> {
    let kinds = ParticleSystem::new(scene).kinds();
    let takes = move |m: &&Method| kinds.without(m.takes()) == ForceKinds::NONE;
    integrators::fixed().iter().filter(takes)
}

fn near(found: f64, right: f64, bound: f64, what: &str) {
    assert!(
        (found - right).abs() <= bound,
        "{what}: {found:e}, not {right:e}"
    );
}

#[test]
fn a_contact_is_half_a_swing() {
    // v/w deep after π/(2 w), out after π/w. Errors of rk4 are z⁴/120 of a radian per radian at z = h w = π/128: 1e-8 rad,
    // 2e-10 m of 2 cm, and 1e-8 of the speed.
    let (scene, h) = (falling(0.0, 0.0), PI / 200.0 / 64.0);
    let deepest = run("rk4", &scene, h, 64);
    near(deepest.x[2], -0.02, 2e-10, "depth");
    near(deepest.v[2], 0.0, 2e-8, "at rest");
    let out = run("rk4", &scene, h, 128);
    near(out.x[2], 0.0, 4e-10, "out");
    near(out.v[2], 2.0, 2e-8, "speed");
}

#[test]
fn a_damped_contact_ends_at_zero_depth() {
    for method in taking(&falling(0.0137, 20.0)).filter(|m| m.order >= 4) {
        let out = run(method.id, &falling(0.0137, 20.0), 2.5e-4, 240);
        // Released at zero force it would be 0.744079397722. The bound is of rk4 at z = 0.025: z⁴/120 over π rad is 1e-8.
        near(out.v[2], 2.0 * LEFT, 1e-7, method.id);
        near(
            out.work.dissipated,
            2.0 * (1.0 - LEFT * LEFT),
            2e-7,
            method.id,
        );
    }
}

/// The particle's place and velocity at 0.06 s, against the closed form: the worst of several starts, whose impacts fall
/// anywhere in a step.
fn off(method: &Method, steps: u32) -> f64 {
    let off = |n: u32| {
        let height = 0.0137 + 0.0011 * f64::from(n);
        let scene = falling(height, 20.0);
        let end = run(method.id, &scene, 0.06 / f64::from(steps), steps);
        let inside = PI / (100.0 * f64::sqrt(0.99));
        let right = 2.0 * LEFT * (0.06 - height / 2.0 - inside);
        let speed = (end.v[2] - 2.0 * LEFT).abs();
        speed.max(100.0 * (end.x[2] - right).abs())
    };
    (0..5).map(off).fold(0.0, f64::max)
}

#[test]
fn every_method_keeps_its_order() {
    let one = falling(0.01, 20.0);
    let system = ParticleSystem::new(&one);
    for method in taking(&one).filter(|m| m.order <= 4) {
        let order = method.order_on(&system);
        let steps = if order > 2 { 48 } else { 240 };
        let found = (off(method, steps) / off(method, 2 * steps)).log2();
        // Contacts begin and end anywhere in a step, which scatters the constant of the error.
        assert!(
            found > f64::from(order) - 0.4,
            "{}: order {found}, not {order}",
            method.id
        );
    }
}

#[test]
fn what_bounces_keeps_its_energy_or_books_it() {
    for damping in [0.0, 20.0] {
        let particle = "{mass: 1, radius: 0, pos: [0, 0, 0.3]}";
        let scene = scene(particle, damping, -9.81, FLOOR);
        let start = 9.81 * 0.3;
        // At z = h w = 0.05 rk4 loses z⁶/144 of the energy a step inside and z⁴/120 at the worst within a contact: 5e-8; of
        // order 2 it is z²/8 at the worst within a contact: 3e-4.
        for (id, bound) in [
            ("rk4", 1.2e-7),
            ("implicit_midpoint", 1e-3),
            ("velocity_verlet", 1e-3),
        ] {
            let end = run(id, &scene, 5e-4, 4000);
            near(balance(&scene, &end), start, bound * start, id);
        }
    }
}

#[test]
fn two_balls_press_each_other_unless_something_joins_them() {
    // The reduced mass is 2/3 kg, and ζ = 0.1.
    let damping = 0.2 * f64::sqrt(K * 2.0 / 3.0);
    let balls = "{mass: 1, radius: 0.1, pos: [0, 0, 0], vel: [2, 0, 0]}, \
                 {mass: 2, radius: 0.1, pos: [0.21, 0, 0], vel: [-1, 0, 0]}";
    let apart = scene(balls, damping, 0.0, "");
    let end = run("rk4", &apart, 2.5e-4, 240);
    near(end.v[3] - end.v[0], 3.0 * LEFT, 1e-7, "relative");
    near(end.v[0] + 2.0 * end.v[3], 0.0, 1e-13, "momentum");
    near(balance(&apart, &end), 3.0, 2e-7, "balance");
    let spring = "springs: [{particle_ids: [0, 1], stiffness: 1e-9, rest_length: 0.2}]";
    let joined = scene(balls, damping, 0.0, spring);
    let end = run("rk4", &joined, 2.5e-4, 240);
    near(end.v[0], 2.0, 1e-9, "through each other");
}

#[test]
fn a_moving_wall_puts_in_its_work() {
    let wall = "colliders: [{plane: {normal: [1, 0, 0]}, driven: {velocity: [1, 0, 0]}}]";
    let particle = "{mass: 1, radius: 0, pos: [0.05, 0, 0], vel: [-5, 0, 0]}";
    for (damping, left) in [(0.0, 1.0), (20.0, LEFT)] {
        let scene = scene(particle, damping, 0.0, wall);
        let end = run("rk4", &scene, 2.5e-4, 240);
        near(end.v[0], 1.0 + 6.0 * left, 3e-7, "speed");
        near(end.work.injected, 6.0 * (1.0 + left), 3e-6, "work");
        near(balance(&scene, &end), 12.5, 3e-6, "balance");
    }
}

#[test]
fn slopes_are_those_of_the_force() {
    let scene = scene(
        "{mass: 1, radius: 0.3, pos: [0.1, 0.2, 0.25]}, {mass: 2, radius: 0.3, pos: [0.3, -0.1, 0.2]}",
        20.0,
        0.0,
        "colliders: [{ball: {center: [0.2, 0, -0.9], radius: 1}}, {capsule: {a: [-1, 0.6, 0.2], b: [1, 0.6, 0.2], radius: 0.3}}]",
    );
    let penalty = Penalty::new(&scene).expect("a penalty");
    let x = ParticleSystem::initial_state(&scene).x;
    let v = [0.3, -0.7, 0.2, -0.4, 0.5, 0.9];
    let mut slopes = Jacobian::default();
    penalty.add_jacobian(0.0, &x, &v, Linearization::Exact, &mut slopes);
    let force = |x: &[f64], v: &[f64]| {
        let mut f = vec![0.0; 6];
        penalty.add_force(0.0, x, v, &mut f);
        f
    };
    let step = 1e-5;
    for by in [Derivative::Position, Derivative::Velocity] {
        let triplets = match by {
            Derivative::Position => &slopes.position,
            Derivative::Velocity => &slopes.velocity,
        };
        assert!(!triplets.is_empty());
        for column in 0..6 {
            let ends = [step, -step].map(|by_step| {
                let (mut x, mut v) = (x.clone(), v.to_vec());
                match by {
                    Derivative::Position => x[column] += by_step,
                    Derivative::Velocity => v[column] += by_step,
                }
                force(&x, &v)
            });
            for row in 0..6 {
                let own = triplets.iter().filter(|e| (e.0, e.1) == (row, column));
                let said: f64 = own.map(|e| e.2).sum();
                let found = (ends[0][row] - ends[1][row]) / (2.0 * step);
                // Rounding of 1e3 N over the step, and a third derivative of k/r².
                near(said, found, 1e-5, &format!("{by:?} {row} {column}"));
            }
        }
    }
}
