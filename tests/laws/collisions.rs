//! Collisions of particles with each other, what rests on what, and rods among obstacles, against closed forms.

use crate::contact::{G, balance, near, of_order, run, see};
use crate::testkit::method;
use crate::testkit::scenes::parsed;
use springcheck::integrators::{self, Settings};
use springcheck::physics::{ParticleSystem, State};
use springcheck::scene::Scene;
use springcheck::solvers::advance;

/// Balls of 0.1 m that collide with each other, and what else a file has.
fn balls(gravity: f64, contact: &str, particles: &str, more: &str) -> Scene {
    parsed(&format!(
        "solver: {{type: rk4, timestep: 0.01, gravity: {gravity}}}\n\
         duration: 10\n\
         contact: {{particles: true, {contact}}}\n\
         particles: [{particles}]\n{more}\n"
    ))
}

/// The methods of fixed steps that take a scene as it is.
fn takers(scene: &Scene, order: u32) -> impl Iterator<Item = &'static integrators::Method> {
    of_order(order, scene).filter(|method| method.id != "shake")
}

/// The impulses of a run, and its end.
fn counted(id: &str, scene: &Scene, h: f64, steps: u32) -> (u64, State) {
    let system = ParticleSystem::new(scene);
    let mut state = ParticleSystem::initial_state(scene);
    let mut integrator = method(id).build(&Settings::default());
    let mut impacts = 0;
    for n in 1..=steps {
        let end = f64::from(n) * h;
        state.t = f64::from(n - 1) * h;
        let done = advance(integrator.as_mut(), &system, h, end, &mut state).expect("a step");
        impacts += done.impacts;
    }
    (impacts, state)
}

#[test]
fn two_balls_part_by_newtons_law() {
    // m = 2, 1, v = 3, -1, e = .7: u = (m1 v1 + m2 v2 ± ...)/(m1 + m2), and ½ µ (1 - e²) u² = 2.72 J is lost.
    let scene = balls(
        0.0,
        "restitution: 0.7",
        "{pos: [-1, 0, 0], vel: [3, 0, 0], mass: 2}, {pos: [1, 0, 0], vel: [-1, 0, 0], mass: 1}",
        "",
    );
    for method in takers(&scene, 1) {
        let end = run(method.id, &scene, 0.1, 10);
        near(end.v[0], 0.733_333_333_333_333_3, 1e-14, method.id);
        near(end.v[3], 3.533_333_333_333_333, 1e-14, method.id);
        near(end.work.impacts, 2.72, 1e-13, method.id);
        // They meet after (2 - .2)/4 = .45 s, which is located to 1e-13 s.
        near(
            end.x[0],
            -1.0 + 3.0 * 0.45 + 0.733_333_333_333_333_3 * 0.55,
            1e-12,
            method.id,
        );
    }
}

#[test]
fn friction_of_two_balls_slows_both_by_coulombs_law() {
    // A glancing blow along x with a velocity across: V = 2, e = .5, µ = .2 takes µ (1 + e) V = .6 of the relative 1.
    let scene = balls(
        0.0,
        "restitution: 0.5, friction: 0.2",
        "{pos: [-0.6, 0, 0], vel: [2, 1, 0], mass: 1}, {pos: [0, 0.2, 0], mass: 3}",
        "",
    );
    // They meet after .2 s at rest across each other, so that the normal is x.
    let end = run("rk4", &scene, 0.1, 4);
    let [u, w] = [3.0, 0.6];
    near(end.v[0], 2.0 - 0.75 * u, 1e-11, "first along");
    near(end.v[3], 0.25 * u, 1e-11, "second along");
    near(end.v[1], 1.0 - 0.75 * w, 1e-11, "first across");
    near(end.v[4], 0.25 * w, 1e-11, "second across");
}

#[test]
fn galperins_blocks_count_the_digits_of_pi() {
    for (mass, digits) in [("1", 3), ("100", 31), ("10000", 314)] {
        let scene = balls(
            0.0,
            "restitution: 1",
            &format!(
                "{{pos: [1, 0, 0], mass: 1}}, {{pos: [2, 0, 0], vel: [-1, 0, 0], mass: {mass}}}"
            ),
            "colliders: [{plane: {normal: [1, 0, 0]}, restitution: 1}]",
        );
        for method in takers(&scene, 1) {
            let (impacts, end) = counted(method.id, &scene, 0.1, 100);
            assert_eq!(impacts, digits, "{} at a mass of {mass}", method.id);
            if digits == 31 {
                // Each impact rounds both velocities once: 31 of them, of up to 10.
                near(end.v[3], 0.998_857_595_563_118, 4e-14, method.id);
                near(end.v[0], 0.477_860_208_205_886, 4e-13, method.id);
            }
        }
    }
}

#[test]
fn a_cradle_passes_the_blow_on() {
    let row = |gap: f64| {
        let one = |n: usize| {
            let x = 0.5 + (0.2 + gap) * n as f64;
            format!("{{pos: [{x}, 0, 0], mass: 1}}")
        };
        let others: Vec<String> = (0..4).map(one).collect();
        format!(
            "{{pos: [0, 0, 0], vel: [1, 0, 0], mass: 1}}, {}",
            others.join(", ")
        )
    };
    for gap in [0.0, 0.001, 0.05] {
        let scene = balls(0.0, "restitution: 1", &row(gap), "");
        let end = run("velocity_verlet", &scene, 0.02, 50);
        for (ball, right) in [0.0, 0.0, 0.0, 0.0, 1.0].into_iter().enumerate() {
            near(end.v[3 * ball], right, 1e-14, "e = 1");
        }
        // The last ball has ((1 + e)/2)⁴, and nothing comes after it that is as fast.
        let scene = balls(0.0, "restitution: 0.9", &row(gap), "");
        let end = run("velocity_verlet", &scene, 0.02, 50);
        near(end.v[12], 0.814_506_25, 1e-14, "e = .9");
        let all: f64 = (0..5).map(|ball| end.v[3 * ball]).sum();
        near(all, 1.0, 1e-14, "momentum");
    }
}

/// Four balls of different masses above each other, the lowest on the floor or `up` above it, each as much above the next.
fn pile(up: f64, e: f64, floor: &str) -> Scene {
    let ball = |(n, mass): (usize, f64)| {
        let z = 0.1 + up + (0.2 + up) * n as f64;
        format!("{{pos: [0, 0, {z}], mass: {mass}}}")
    };
    let all: Vec<String> = [1.0, 2.0, 1.0, 4.0]
        .into_iter()
        .enumerate()
        .map(ball)
        .collect();
    balls(
        -G,
        &format!("restitution: {e}, friction: 0.3"),
        &all.join(", "),
        &format!(
            "colliders: [{{plane: {{normal: [0, 0, 1]}}, restitution: {e}, friction: 0.3{floor}}}]"
        ),
    )
}

#[test]
fn what_is_piled_up_stays() {
    let scene = pile(0.0, 0.5, "");
    for method in takers(&scene, 1) {
        let end = run(method.id, &scene, 0.01, 100);
        for ball in 0..4 {
            let right = 0.1 + 0.2 * ball as f64;
            near(end.x[3 * ball + 2], right, 1e-13, method.id);
            near(end.v[3 * ball + 2], 0.0, 1e-13, method.id);
        }
    }
}

#[test]
fn a_pile_goes_with_a_floor_that_moves() {
    // .01 sin 10 t: at most 1 m/s² less than g, so that nothing leaves.
    let scene = pile(
        0.0,
        0.5,
        ", driven: {sine: {amplitude: [0, 0, 0.01], omega: 10}}",
    );
    for id in [
        "symplectic_euler",
        "velocity_verlet",
        "rk4",
        "implicit_midpoint",
    ] {
        let end = run(id, &scene, 0.01, 100);
        let lifted = 0.01 * f64::sin(10.0);
        for ball in 0..4 {
            let right = 0.1 + 0.2 * ball as f64 + lifted;
            near(end.x[3 * ball + 2], right, 1e-12, id);
        }
    }
}

#[test]
fn what_falls_on_top_of_each_other_ends_as_a_pile() {
    let scene = pile(0.05, 0.5, "");
    let start = balance(&scene, &ParticleSystem::initial_state(&scene));
    for id in ["velocity_verlet", "rk4", "implicit_midpoint"] {
        let end = run(id, &scene, 0.01, 150);
        for ball in 0..4 {
            let right = 0.1 + 0.2 * ball as f64;
            // Contact is known to 1e-13 of the scene's size each.
            near(end.x[3 * ball + 2], right, 2e-12, id);
            near(end.v[3 * ball + 2], 0.0, 1e-12, id);
        }
        near(balance(&scene, &end), start, 1e-11, id);
    }
}

#[test]
fn a_ball_pushes_another_that_is_held_back() {
    // Down an incline of 30°, the lower ball in syrup: together (m1 + m2) v' = (m1 + m2) g sin 30° - c v.
    let (s, c) = (0.5, 0.75_f64.sqrt());
    let apart = 0.2;
    let mut scene = balls(
        0.0,
        "restitution: 0",
        &format!(
            "{{pos: [0, 0, 0.1], mass: 1, drag: 1.5}}, {{pos: [{}, 0, 0.1], mass: 2}}",
            -apart
        ),
        "colliders: [{plane: {normal: [0, 0, 1]}}]",
    );
    scene.solver.gravity = 0.0;
    scene.solver.gravities.0 = vec![[G * s, 0.0, -G * c]];
    let (rate, end) = (1.5 / 3.0, 1.0_f64);
    let limit = G * s / rate;
    let right = limit * (end - (1.0 - (-rate * end).exp()) / rate);
    for method in takers(&scene, 1) {
        let off = |steps: u32| {
            let state = run(method.id, &scene, end / f64::from(steps), steps);
            near(state.x[0] - state.x[3], apart, 1e-12, method.id);
            (state.x[0] - right).abs()
        };
        let (coarse, fine) = (off(20), off(40));
        let order = (coarse / fine).log2();
        let exact = fine < 1e-12;
        assert!(
            exact || order > f64::from(method.order) - 0.2,
            "{}: {coarse:e} and {fine:e}",
            method.id
        );
    }
}

/// Two balls of 1 kg on a rod of 1 m.
fn dumbbell(ends: [[f64; 3]; 2], more: &str) -> Scene {
    let [[x0, y0, z0], [x1, y1, z1]] = ends;
    parsed(&format!(
        "solver: {{type: rk4, timestep: 0.01}}\n\
         duration: 10\n\
         particles: [{{pos: [{x0}, {y0}, {z0}], mass: 1, radius: 0}}, {{pos: [{x1}, {y1}, {z1}], mass: 1, radius: 0}}]\n\
         rods: [{{particle_ids: [0, 1]}}]\n{more}\n"
    ))
}

#[test]
fn a_rod_passes_an_impact_on() {
    // At an angle θ above the floor an impulse at its lower end sees 1/K = (1 + cos² θ)/2 per kg (rigid body).
    let (c, s) = (0.6, 0.8);
    let e = 0.5;
    let scene = dumbbell(
        [[0.0, 0.0, 0.3], [c, 0.0, 0.3 + s]],
        "colliders: [{plane: {normal: [0, 0, 1]}, restitution: 0.5}]",
    );
    let speed = (2.0 * G * 0.3_f64).sqrt();
    let lightness = 0.5 * (1.0 + c * c);
    let impulse = (1.0 + e) * speed / lightness;
    // It turns about its middle: the inertia is 2 · ¼ kg m².
    let (middle, turning) = (-speed + 0.5 * impulse, 0.5 * c * impulse / 0.5);
    let hit = speed / G;
    for method in takers(&scene, 2) {
        let mut found = None;
        see(method.id, &scene, 0.01, 30, |state| {
            if state.t > hit && found.is_none() {
                found = Some(state.clone());
            }
        });
        let state = found.expect("an impact");
        let since = state.t - hit;
        let mean = 0.5 * (state.v[2] + state.v[5]);
        near(mean, middle - G * since, 1e-11, method.id);
        // |v1 - v0| = ω L, whatever the angle is by then; the rod turns freely.
        let parting: f64 = (0..3).map(|c| (state.v[3 + c] - state.v[c]).powi(2)).sum();
        near(parting.sqrt(), turning, 2e-6, method.id);
        let kinetic = middle * middle + 0.25 * turning * turning;
        near(
            state.work.impacts,
            speed * speed - kinetic,
            1e-11,
            method.id,
        );
    }
}

#[test]
fn a_ladder_leaves_the_wall_at_two_thirds_of_its_height() {
    // Energy gives θ'² = 2 g (cos θ0 - cos θ)/L, and the foot accelerates until cos θ = 2/3 cos θ0; from then on both drift
    // from the wall with the middle's velocity ½ L cos θ θ'.
    let (s, c) = (0.6, 0.8);
    let scene = dumbbell(
        [[s, 0.0, 0.0], [0.0, 0.0, c]],
        "colliders: [{plane: {normal: [0, 0, 1]}}, {plane: {normal: [1, 0, 0]}}]",
    );
    let right = c / 3.0 * (2.0 * G * c / 3.0).sqrt();
    let mut takers = takers(&scene, 2).peekable();
    assert!(takers.peek().is_some());
    for method in takers {
        let off = |h: f64| {
            let mut drift = None;
            see(method.id, &scene, h, (0.55 / h).round() as u32, |state| {
                if state.x[3] > 1e-3 && drift.is_none() {
                    drift = Some(0.5 * (state.v[0] + state.v[3]));
                }
            });
            (drift.expect("it leaves") - right).abs()
        };
        let (coarse, fine) = (off(0.01), off(0.005));
        assert!(fine < 2e-5, "{}: {fine:e} m/s", method.id);
        assert!(
            (coarse / fine).log2() > 1.95,
            "{}: {coarse:e} and {fine:e}",
            method.id
        );
    }
}

#[test]
fn particles_that_something_joins_pass_through_each_other() {
    let joined = balls(
        0.0,
        "restitution: 1",
        "{pos: [-0.05, 0, 0], vel: [1, 0, 0], mass: 1}, {pos: [0.05, 0, 0], mass: 1}",
        "springs: [{particle_ids: [0, 1], stiffness: 0, rest_length: 0.1}]",
    );
    let end = run("rk4", &joined, 0.1, 10);
    near(end.v[0], 1.0, 1e-15, "free");
}
