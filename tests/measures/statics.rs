//! Static quantities: tensions of springs, and what holds fixed particles.

use crate::testkit::method;
use crate::testkit::scenes::{empty, fixed, free, shipped, spring};
use springcheck::measure::Statics;
use springcheck::physics::{ParticleSystem, State};
use springcheck::scene::{Air, DampingModel, Scene, Triangle, Wind};
use springcheck::solvers::{Setting, Solver};

const G: f64 = 9.81;

/// Golden number 20: a string of n masses and springs that hangs in its equilibrium. Spring j from the bottom carries
/// the j masses below it.
fn hanging(n: usize, mass: f64, stiffness: f64) -> Scene {
    let mut scene = Scene {
        particles: vec![fixed([0.0; 3])],
        ..empty()
    };
    scene.solver.gravity = -G;
    let mut z = 0.0;
    for i in 0..n {
        z -= 0.25 + (n - i) as f64 * mass * G / stiffness;
        scene.particles.push(free([0.0, 0.0, z], mass));
        scene.springs.push(spring([i, i + 1], stiffness, 0.25));
    }
    scene
}

fn start(scene: &Scene) -> (Statics, State) {
    (Statics::new(scene), ParticleSystem::initial_state(scene))
}

#[test]
fn a_hanging_string_carries_its_weight() {
    for (n, mass, stiffness, sag, elastic) in [
        (10, 0.1, 100.0, 0.53955, 1.852544925),
        (20, 0.05, 1000.0, 0.103005, 0.34524700875),
    ] {
        let scene = hanging(n, mass, stiffness);
        let (statics, state) = start(&scene);
        let weight = mass * G;
        // k times a few roundings of the depth, which is below 8 m.
        let rounding = stiffness * 8.0 * 2.0 * f64::EPSILON;
        for (at, tension) in statics.tensions(&state).into_iter().enumerate() {
            let below = (n - at) as f64;
            assert!(
                (tension - below * weight).abs() < rounding,
                "{at}: {tension}"
            );
        }
        let reactions = statics.reactions(&state);
        assert!((reactions[2] - n as f64 * weight).abs() < rounding);
        // What is free is not held.
        assert!(reactions[3..].iter().all(|f| *f == 0.0));
        // The published sag and energy are those of this state.
        let depth = -state.x[3 * n + 2] - 0.25 * n as f64;
        assert!((depth - sag).abs() < 8.0 * f64::EPSILON, "{depth}");
        let energy = ParticleSystem::new(&scene).elastic(0.0, &state.x);
        assert!((energy - elastic).abs() < rounding, "{energy}");
    }
}

/// A pendulum on a stiff spring that is let go at an angle a, in balance along the spring, pulls with m g (3 - 2 cos a)
/// as it passes the bottom: energy conservation.
#[test]
fn a_pendulum_pulls_most_at_the_bottom() {
    let (angle, stiffness, mass) = (60.0_f64.to_radians(), 1e5, 0.5);
    let length = 1.0 + mass * G * angle.cos() / stiffness;
    let mut scene = Scene {
        particles: vec![
            fixed([0.0; 3]),
            free([length * angle.sin(), 0.0, -length * angle.cos()], mass),
        ],
        springs: vec![spring([0, 1], stiffness, 1.0)],
        duration: 0.8,
        ..empty()
    };
    scene.solver.gravity = -G;
    let system = ParticleSystem::new(&scene);
    let statics = Statics::new(&scene);
    let setting = Setting::Steps {
        timestep: 1e-4,
        steps: 8000,
    };
    let solver = Solver::method(method("velocity_verlet"));
    let mut run = solver.start(&scene, &system, &setting).expect("it runs");
    let (mut most, mut held) = (0.0_f64, 0.0_f64);
    for _ in 0..8000 {
        run.advance(1).expect("a step");
        let tension = statics.tensions(run.state())[0];
        let reaction = statics.reactions(run.state());
        // What the spring pulls with is what holds the other end.
        let size = reaction[0].hypot(reaction[1]).hypot(reaction[2]);
        held = held.max((size - tension.abs()).abs());
        most = most.max(tension);
    }
    let wanted = mass * G * (3.0 - 2.0 * angle.cos());
    // The spring gives by m g / k of its length, 5e-5, and swings along itself by no more than that starts: parts of a
    // few m g / (k L). Measured 6e-5.
    assert!((most / wanted - 1.0).abs() < 2e-4, "{most} of {wanted}");
    assert!(held < 1e-12 * stiffness, "{held}");
}

#[test]
fn dampers_count_along_the_spring() {
    for model in [DampingModel::Axial, DampingModel::Isotropic] {
        let mut scene = Scene {
            damping_model: model,
            particles: vec![fixed([0.0; 3]), free([3.0, 4.0, 0.0], 1.0)],
            springs: vec![spring([0, 1], 2.0, 6.0)],
            ..empty()
        };
        scene.springs[0].damping = 0.5;
        scene.springs[0].cubic = 4.0;
        scene.particles[1].velocity = [1.0, 2.0, 7.0];
        let (statics, state) = start(&scene);
        // It is 1 m too short: -2 N, -4 N; it parts at (3 + 8) / 5 = 2.2 m/s: 1.1 N.
        let tension = statics.tensions(&state)[0];
        assert!((tension + 4.9).abs() < 16.0 * f64::EPSILON, "{tension}");
        // The anchor's reaction, along the spring, is the same.
        let reaction = statics.reactions(&state);
        let along = -(0.6 * reaction[0] + 0.8 * reaction[1]);
        assert!((along - tension).abs() < 16.0 * f64::EPSILON, "{along}");
    }
}

/// What holds a driven particle does the work that the drive puts in.
#[test]
fn the_reaction_of_an_anchor_is_the_force_of_its_drive() {
    let scene = shipped("effects/driven_below.yml");
    let system = ParticleSystem::new(&scene);
    let statics = Statics::new(&scene);
    let mut state = ParticleSystem::initial_state(&scene);
    state.x[3] = 1.3;
    state.v[3] = -0.4;
    let reaction = statics.reactions(&state);
    // At its start, speed 0.5 m/s: the spring's 15 N and the damper's 0.9 N pull to either side.
    assert!((reaction[0] - (-15.0 + 0.9)).abs() < 1e-13, "{reaction:?}");
    let mut f = vec![0.0; 6];
    let power = system.forces(state.t, &state.x, &state.v, &mut f);
    assert!((power.injected - reaction[0] * 0.5).abs() < 1e-13);
}

/// A plate of area 1/2 m² that three fixed corners hold in a wind of 10 m/s along its normal: 1/2 density C A u² = 30 N,
/// a third at each; a spring between two of them, stretched by 0.5 m, pulls them together.
#[test]
fn what_acts_between_fixed_particles_is_held_too() {
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let mut scene = Scene {
        particles: corners.map(fixed).into(),
        springs: vec![spring([0, 1], 8.0, 0.5)],
        triangles: vec![Triangle {
            corners: [0, 1, 2],
            air_drag: 1.0,
        }],
        air: Some(Air {
            velocity: [0.0, 0.0, 10.0],
            density: 1.2,
        }),
        wind: Some(Wind {
            direction: [1.0, 0.0, 0.0],
            strength: 7.0,
        }),
        ..empty()
    };
    scene.solver.gravity = -G;
    let (statics, state) = start(&scene);
    let reactions = statics.reactions(&state);
    let wanted = [-4.0, 0.0, -10.0, 4.0, 0.0, -10.0, 0.0, 0.0, -10.0];
    for (found, wanted) in reactions.iter().zip(wanted) {
        // Some roundings of 30 N.
        assert!((found - wanted).abs() < 1e-14, "{reactions:?}");
    }
}
