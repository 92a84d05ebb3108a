//! The energy of methods whose velocities are off their rods, and the impulses of long steps.

use crate::testkit::method;
use crate::testkit::scenes::{empty, fixed, free};
use springcheck::integrators::Settings;
use springcheck::physics::constraints::kinetic_on_rods;
use springcheck::physics::{ParticleSystem, State, System};
use springcheck::scene::{Driven, Particle, Rod, Scene, Sine};
use springcheck::solvers::advance;

fn run(id: &str, scene: &Scene, h: f64, steps: u32) -> (ParticleSystem, State) {
    let system = ParticleSystem::new(scene);
    let mut state = ParticleSystem::initial_state(scene);
    let mut integrator = method(id).build(&Settings::default());
    for n in 1..=steps {
        let end = f64::from(n) * h;
        advance(integrator.as_mut(), &system, h, end, &mut state).expect("a step");
    }
    (system, state)
}

/// Six particles of half a kilogram on a circle of 1 m, joined by rods, that turn freely at `w`.
fn ring(w: f64) -> Scene {
    let at = |id: usize| {
        let (sin, cos) = (id as f64 * std::f64::consts::FRAC_PI_3).sin_cos();
        Particle {
            velocity: [-w * sin, w * cos, 0.0],
            ..free([cos, sin, 0.0], 0.5)
        }
    };
    let rod = |id: usize| Rod {
        ends: [id, (id + 1) % 6],
        length: 1.0,
    };
    Scene {
        particles: (0..6).map(at).collect(),
        rods: (0..6).map(rod).collect(),
        ..empty()
    }
}

/// A step turns the ring by θ with sin θ = h w, since its angular momentum is kept, and the velocity it ends with is along
/// the chord: w across the radius, and w tan(θ/2) along it, which is along rods.
#[test]
fn shake_has_the_velocity_of_a_chord_and_the_energy_of_the_arc() {
    let w = 2.0;
    for (h, steps) in [(0.002, 1), (0.002, 1500), (0.1, 300)] {
        let (system, State { x, v, .. }) = run("shake", &ring(w), h, steps);
        // 6 · ½ · 0.5 kg · (2 m/s)².
        let motion = kinetic_on_rods(&system, &x, &v) - 6.0;
        let chord = 6.0 * f64::tan(f64::asin(h * w) / 2.0).powi(2);
        let along = system.rods().expect("rods").energy_along(&x, &v) - chord;
        // A rounding of 1 m over h moves a velocity along the rods, of h w²/2, and so its energy by some 1e-15 J; that of
        // the motion walks, by a rounding of 6 J a step.
        let walk = 1e-15 * f64::from(steps).sqrt();
        assert!(along.abs() < 1e-14, "{h}, {steps}: {along:e}");
        assert!(
            motion.abs() < 1e-14 + 3.0 * walk,
            "{h}, {steps}: {motion:e}"
        );
    }
}

/// Both are the same map but for the last impulses (Hairer, Lubich, Wanner, Geometric Numerical Integration, VII.1.4),
/// whose work on a driven end is in E - injected of neither.
#[test]
fn shake_has_the_balance_of_rattle() {
    let mut scene = Scene {
        particles: vec![
            fixed([0.0; 3]),
            free([0.8, 0.0, -0.6], 0.5),
            free([0.8, 0.0, -1.6], 2.0),
        ],
        rods: vec![
            Rod {
                ends: [0, 1],
                length: 1.0,
            },
            Rod {
                ends: [1, 2],
                length: 1.0,
            },
        ],
        ..empty()
    };
    scene.solver.gravity = -9.81;
    scene.driven = vec![Driven {
        particle: 0,
        sine: Some(Sine {
            amplitude: [0.1, 0.05, 0.2],
            omega: 5.0,
            phase: 0.0,
        }),
        ..Driven::default()
    }];
    // The end sets out along the first rod; the particles go along with it.
    for particle in &mut scene.particles[1..] {
        particle.velocity = [0.5, 0.25, 1.0];
    }
    for steps in [1, 7, 400] {
        let [rattle, shake] = ["rattle", "shake"].map(|id| {
            let (system, state) = run(id, &scene, 0.005, steps);
            let kinetic = kinetic_on_rods(&system, &state.x, &state.v);
            kinetic + system.potential(state.t, &state.x) - state.work.injected
        });
        // Some hundred roundings of 20 J.
        assert!(
            (rattle - shake).abs() < 1e-12,
            "{steps}: {:e}",
            rattle - shake
        );
    }
}

/// A hanging pendulum falls in a free drift by h² g/2, more than its length, and its impulse has a root: across the rod it
/// goes by u h.
#[test]
fn impulses_of_long_steps_are_found() {
    for (h, sideways, id, roundings) in [
        (0.6, 0.0, "rattle", 1.0),
        (0.6, 0.0, "shake", 1.0),
        (0.6, 1.0, "rattle", 1.0),
        // Turned by 64°, where an iteration gains less than a half, it may end at 64 roundings.
        (3.0, 0.3, "rattle", 64.0),
    ] {
        let bob = Particle {
            velocity: [sideways, 0.0, 0.0],
            ..free([0.0, 0.0, -1.0], 2.0)
        };
        let mut scene = Scene {
            particles: vec![fixed([0.0; 3]), bob],
            rods: vec![Rod {
                ends: [0, 1],
                length: 1.0,
            }],
            ..empty()
        };
        scene.solver.gravity = -9.81;
        let (_, State { x, .. }) = run(id, &scene, h, 1);
        let across = sideways * h;
        let wanted = [across, 0.0, -f64::sqrt(1.0 - across * across)];
        for (found, wanted) in x[3..].iter().zip(wanted) {
            // A rounding of a length, 4.4e-16, is 1/cos as large along the old rod: up to 2.3.
            let off = (found - wanted).abs();
            assert!(off < roundings * 1.1e-15, "{h}: {off:e}");
        }
    }
    // At rest a step further changes nothing, whatever the step.
    for id in ["rattle", "shake"] {
        let mut scene = Scene {
            particles: vec![fixed([0.0; 3]), free([0.0, 0.0, -1.0], 2.0)],
            rods: vec![Rod {
                ends: [0, 1],
                length: 1.0,
            }],
            ..empty()
        };
        scene.solver.gravity = -9.81;
        let (_, State { x, .. }) = run(id, &scene, 0.6, 100);
        assert!((x[5] + 1.0).abs() < 1e-15, "{x:?}");
    }
}
