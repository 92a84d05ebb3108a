//! Impacts at one time, several in one step, and what comes to rest: against closed forms.

use crate::contact::{G, balance, near, of_order, run};
use crate::testkit::scenes::parsed;
use springcheck::integrators::{Settings, StepError};
use springcheck::physics::{ParticleSystem, State};
use springcheck::scene::Scene;
use springcheck::solvers::advance;

/// Particles of 1 kg without extent, and obstacles.
fn points(gravity: f64, particles: &[String], colliders: &str) -> Scene {
    parsed(&format!(
        "solver: {{type: rk4, timestep: 0.01, gravity: {gravity}}}\nduration: 10\n\
         particles: [{}]\ncolliders: [{colliders}]\n",
        particles.join(", ")
    ))
}

fn point(pos: [f64; 3], vel: [f64; 3]) -> String {
    format!("{{pos: {pos:?}, vel: {vel:?}, mass: 1, radius: 0}}")
}

/// Walls around a cube of half a side of 1 m.
fn room(restitution: f64) -> String {
    let normals = [
        [1, 0, 0],
        [-1, 0, 0],
        [0, 1, 0],
        [0, -1, 0],
        [0, 0, 1],
        [0, 0, -1],
    ];
    let walls = normals
        .map(|n| format!("{{plane: {{normal: {n:?}, offset: -1}}, restitution: {restitution}}}"));
    walls.join(", ")
}

/// Where a ball is at t that is dropped from 1 m at rest, e = 1, after one impact.
fn bounced(t: f64) -> f64 {
    let since = t - (2.0 / G).sqrt();
    (2.0 * G).sqrt() * since - 0.5 * G * since * since
}

#[test]
fn what_falls_together_bounces_together() {
    // Side by side, and a last bit or a thousand of them higher, whose impacts are apart by less than is located.
    for higher in [0.0, f64::EPSILON, 1e-13, 1e-11] {
        for count in [2, 3, 6] {
            let at = |k: usize| point([k as f64, 0.0, 1.0 + higher * k as f64], [0.0; 3]);
            let particles: Vec<String> = (0..count).map(at).collect();
            let floor = "{plane: {normal: [0, 0, 1]}, restitution: 1}";
            let scene = points(-G, &particles, floor);
            let before = balance(&scene, &ParticleSystem::initial_state(&scene));
            for method in of_order(2, &scene) {
                let end = run(method.id, &scene, 0.01, 80);
                for k in 0..count {
                    // Located to 1e-14 s at 4.4 m/s, twice over; each 1e-11 m higher is as much lower after it.
                    let off = 2e-13 + 4.0 * higher * k as f64;
                    near(end.x[3 * k + 2], bounced(0.8), off, method.id);
                }
                near(balance(&scene, &end), before, 1e-11, method.id);
            }
        }
    }
}

#[test]
fn two_impacts_of_one_particle_in_a_step_are_both_taken() {
    // More than four particles, each at two walls within .01 s.
    let at = |k: usize| point([0.9, 0.9 + 0.01 * k as f64, 0.0], [20.0, 19.0, 0.0]);
    let particles: Vec<String> = (0..5).map(at).collect();
    let scene = points(0.0, &particles, &room(1.0));
    for method in of_order(1, &scene) {
        let end = run(method.id, &scene, 0.01, 2);
        for k in 0..5 {
            let y = 0.9 + 0.01 * k as f64;
            let right = [2.0 - (0.9 + 0.4), 2.0 - (y + 0.38)];
            for axis in 0..2 {
                near(end.x[3 * k + axis], right[axis], 1e-13, method.id);
                near(end.v[3 * k + axis], [-20.0, -19.0][axis], 1e-13, method.id);
            }
        }
    }
}

#[test]
fn many_fast_particles_stay_in_their_room_with_their_energy() {
    // Forty, of up to 50 m/s, in steps in which the fastest crosses the room ten times.
    let fast = |k: usize, by: usize| ((k * by) % 101) as f64 - 50.0;
    let at = |k: usize| {
        let place = [17, 29, 43].map(|by| 0.9 / 50.0 * fast(k + 3, by));
        point(place, [37, 53, 71].map(|by| fast(k + 1, by)))
    };
    let particles: Vec<String> = (0..40).map(at).collect();
    let scene = points(0.0, &particles, &room(1.0));
    let start = ParticleSystem::initial_state(&scene);
    for id in [
        "symplectic_euler",
        "rk4",
        "velocity_verlet",
        "implicit_midpoint",
    ] {
        let end = run(id, &scene, 0.4, 5);
        let outside = end.x.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        assert!(outside <= 1.0 + 1e-12, "{id}: {outside}");
        for (v, begun) in end.v.iter().zip(&start.v) {
            // Walls along axes turn signs alone.
            near(v.abs(), begun.abs(), 1e-12, id);
        }
        // Folded back into the room: the way of 2 s at 50 m/s, with a rounding for each of 50 walls.
        for (at, (x, v)) in start.x.iter().zip(&start.v).enumerate() {
            let way = (x + 1.0 + 2.0 * v).rem_euclid(4.0);
            let right = if way > 2.0 { 3.0 - way } else { way - 1.0 };
            near(end.x[at], right, 1e-11, id);
        }
    }
}

#[test]
fn many_that_bounce_to_an_end_lie_on_the_floor() {
    // At different heights up to 1 m, e = .5: the last is at rest after 3 sqrt(2/g) = 1.35 s.
    for count in [5, 40] {
        let at = |k: usize| point([k as f64, 0.0, 1.0 - 0.02 * k as f64], [0.0; 3]);
        let particles: Vec<String> = (0..count).map(at).collect();
        let floor = "{plane: {normal: [0, 0, 1]}, restitution: 0.5}";
        let scene = points(-G, &particles, floor);
        let before = balance(&scene, &ParticleSystem::initial_state(&scene));
        for method in of_order(2, &scene) {
            let end = run(method.id, &scene, 0.01, 150);
            for k in 0..count {
                near(end.x[3 * k + 2], 0.0, 1e-12, method.id);
                assert_eq!(end.v[3 * k + 2], 0.0, "{}", method.id);
            }
            // Second order in the step for impacts that are not located: (h/t)² of each ball's energy with t = .3 s.
            near(balance(&scene, &end), before, 1e-3 * before, method.id);
        }
    }
}

#[test]
fn nothing_thin_lets_anything_through() {
    let triangle = "{mesh: {vertices: [[0, 0, 0], [0, 1, 0], [0, 0, 1]], triangles: [[0, 1, 2]]}, restitution: 1}";
    let thin = |half: f64| {
        format!("{{box: {{center: [0, 0, 0], half_extents: [{half}, 1, 1]}}, restitution: 1}}")
    };
    // Speed, radius, obstacle: ways in a step of .1 s of up to 1e10 times the thickness.
    for (speed, radius, obstacle) in [
        (1e5, 1e-3, triangle.to_owned()),
        (100.0, 0.0, thin(1e-6)),
        (1e4, 0.0, thin(1e-4)),
        (1e6, 0.0, thin(1e-5)),
    ] {
        for offset in [0.0, 0.123, 0.876] {
            let from = -speed * 0.1 * (0.3 + offset);
            let particle = format!(
                "{{pos: [{from}, 0.2, 0.2], vel: [{speed}, 0, 0], mass: 1, radius: {radius}}}"
            );
            let scene = points(0.0, &[particle], &obstacle);
            for id in ["symplectic_euler", "rk4", "velocity_verlet"] {
                let end = run(id, &scene, 0.1, 3);
                near(end.v[0], -speed, 1e-9 * speed, &format!("{id} {obstacle}"));
            }
        }
    }
}

#[test]
fn a_graze_turns_by_as_much_as_it_goes_in() {
    // A point passes 1 m from the centre of a ball of 1 m but for d: it meets it at cos φ = 1 - d, with v sin φ inwards,
    // and goes on with twice that along the normal.
    for d in [1e-10_f64, 1e-9, 1e-6] {
        let particle = point([-2.0, 1.0 - d, 0.0], [1.0, 0.0, 0.0]);
        let ball = "{ball: {center: [0, 0, 0], radius: 1}, restitution: 1}";
        let scene = points(0.0, &[particle], ball);
        let inwards = (d * (2.0 - d)).sqrt();
        let right = 2.0 * inwards * (1.0 - d);
        for id in ["symplectic_euler", "rk4", "velocity_verlet"] {
            let end = run(id, &scene, 0.07, 60);
            // A gap is right to 4e-16 m, which moves sin φ by that over itself.
            near(end.v[1], right, 4e-15 / inwards, id);
        }
    }
}

#[test]
fn what_is_squeezed_is_a_failure() {
    // A piston at 1 m/s reaches the far wall's side of a ball after 2 - .2 = 1.8 s, whatever e is.
    for e in [0.0, 0.5, 1.0] {
        let ball = "{pos: [0.5, 0, 0], mass: 1, radius: 0.1}".to_owned();
        let walls = format!(
            "{{plane: {{normal: [1, 0, 0]}}, restitution: {e}, driven: {{velocity: [1, 0, 0]}}}}, \
             {{plane: {{normal: [-1, 0, 0], offset: -2}}, restitution: {e}}}"
        );
        let scene = points(0.0, &[ball], &walls);
        let system = ParticleSystem::new(&scene);
        for method in of_order(1, &scene) {
            let id = method.id;
            let mut state = ParticleSystem::initial_state(&scene);
            let mut integrator = method.build(&Settings::default());
            let failed = (1..=100).find_map(|n| {
                state.t = f64::from(n - 1) * 0.03;
                let end = f64::from(n) * 0.03;
                let step = advance(integrator.as_mut(), &system, 0.03, end, &mut state);
                step.err().map(|error| (n, error))
            });
            let (n, error) = failed.expect("squeezed");
            assert!((60..=61).contains(&n), "{id}, e = {e}: step {n}");
            let squeezed = matches!(error, StepError::Blows(_) | StepError::TooManyEvents { .. });
            assert!(squeezed, "{id}: {error}");
        }
    }
}

/// Two balls on a floor and a third in between and on top; on them and the floor acts this friction.
fn pyramid(friction: [f64; 2]) -> Scene {
    parsed(&format!(
        "solver: {{type: rk4, timestep: 0.01}}\nduration: 1\n\
         contact: {{particles: true, friction: {}}}\n\
         particles: [{{pos: [-0.1, 0, 0.1], mass: 1}}, {{pos: [0.1, 0, 0.1], mass: 1}}, \
         {{pos: [0, 0, 0.27320508075688776], mass: 1}}]\n\
         colliders: [{{plane: {{normal: [0, 0, 1]}}, friction: {}}}]\n",
        friction[0], friction[1]
    ))
}

/// The largest speed at any time.
fn fastest(scene: &Scene, id: &str, steps: u32) -> f64 {
    let mut most = 0.0_f64;
    crate::contact::see(id, scene, 0.01, steps, |state: &State| {
        most = state.v.iter().fold(most, |most, v| most.max(v.abs()));
    });
    most
}

#[test]
fn a_pyramid_of_rough_balls_stands() {
    // The upper ball presses each lower one with N and rubs with F: 2 (N cos 30° + F sin 30°) = m g, and a lower one stays if the
    // floor takes N sin 30° - F cos 30° of 3/2 m g. Balls that do not turn stand for F = µ N with tan 30° = .577 <= µ on the
    // floor's friction alone at .19.
    for friction in [[0.5, 0.5], [1.0, 1.0], [0.0, 1.0], [0.1, 1.0]] {
        let scene = pyramid(friction);
        for id in [
            "symplectic_euler",
            "rk4",
            "velocity_verlet",
            "implicit_midpoint",
        ] {
            let most = fastest(&scene, id, 20);
            assert!(most < 1e-12, "{friction:?} {id}: {most:e}");
        }
    }
    // On a smooth floor it does not, whatever the balls do: 1 rad of the contacts cannot hold 2 balls apart.
    assert!(fastest(&pyramid([0.0, 0.0]), "rk4", 20) > 0.1);
}

#[test]
fn the_last_bounce_takes_no_friction_that_the_bounces_would_not() {
    // Bounces at e slow what slides by as much as sliding does, but for what is left of them: the series in closed form. From
    // .1 m at 1 m/s, e = .8, µ = .02: the ith impact at V e^i takes µ (1 + e) V e^i, and from t1 (1 + e)/(1 - e) on it slides.
    let (e, mu) = (0.8_f64, 0.02);
    let speed = (2.0 * G * 0.1_f64).sqrt();
    let first = speed / G;
    let (mut x, mut v) = (first, 1.0);
    let mut up = speed;
    for _ in 0..200 {
        v -= mu * (1.0 + e) * up;
        up *= e;
        x += v * 2.0 * up / G;
    }
    let rest = first * (1.0 + e) / (1.0 - e);
    let left = 4.0 - rest;
    let right = x + v * left - 0.5 * mu * G * left * left;
    let floor = "{plane: {normal: [0, 0, 1]}, restitution: 0.8, friction: 0.02}";
    let particle = point([0.0, 0.0, 0.1], [1.0, 0.0, 0.0]);
    let scene = points(-G, &[particle], floor);
    for method in of_order(2, &scene) {
        let end = run(method.id, &scene, 0.01, 400);
        // Impacts are located to 1e-14 s each, and what is not seen rises by 4e-13 m.
        near(end.x[0], right, 1e-11, method.id);
    }
}

#[test]
fn bounces_end_in_steps_much_longer_than_the_scene_s_own() {
    // The scene has .01 s; `stability` tries others. All is at rest from 9 sqrt(2/g) = 4.06 s on.
    let floor = "{plane: {normal: [0, 0, 1]}, restitution: 0.8}";
    for speed in [0.0, 1e-6, 0.3] {
        let scene = points(-G, &[point([0.0, 0.0, 1.0], [speed, 0.0, 0.0])], floor);
        for method in of_order(2, &scene) {
            for h in [0.3, 1.0514, 1.06, 2.5, 40.0] {
                let end = run(method.id, &scene, h, 20);
                near(end.x[2], 0.0, 1e-12, method.id);
                assert_eq!(end.v[2], 0.0, "{}", method.id);
            }
        }
    }
}
