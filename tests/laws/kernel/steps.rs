//! Whole steps on several threads: the loops around the forces, too.

use super::bits::differs;
use super::plain::{self, Fault};
use crate::testkit::cloth::cloth;
use rayon::ThreadPoolBuilder;
use springcheck::integrators::{self, Settings};
use springcheck::physics::{ParticleSystem, State};
use springcheck::scene::{DampingModel, Scene};

const STEP: f64 = 1e-4;

/// Four steps on so many threads.
fn run(scene: &Scene, method: &str, threads: usize) -> State {
    let system = ParticleSystem::new(scene);
    let method = integrators::find(method).expect("a method");
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    pool.expect("threads").install(|| {
        let mut integrator = method.build(&Settings::default());
        let mut state = ParticleSystem::initial_state(scene);
        for _ in 0..4 {
            let done = integrator.step(&system, STEP, &mut state);
            done.expect("an explicit step");
        }
        state
    })
}

fn same(a: &State, b: &State) -> bool {
    differs(&a.x, &b.x).is_none()
        && differs(&a.v, &b.v).is_none()
        && a.work.dissipated.to_bits() == b.work.dissipated.to_bits()
}

#[test]
fn a_step_has_the_same_bits_on_every_number_of_threads() {
    // 110 x 110 x 3 coordinates: just long enough for vectors to be shared, too.
    let scene = cloth(110, 0.01, DampingModel::Axial);
    for method in ["symplectic_euler", "velocity_verlet", "rk4"] {
        let one = run(&scene, method, 1);
        for threads in [2, 3, 4] {
            assert!(
                same(&one, &run(&scene, method, threads)),
                "{method} on {threads}"
            );
        }
    }
}

/// Symplectic Euler in so many words. With `late`, the drift takes the velocity of before the kick.
fn symplectic_euler(scene: &Scene, steps: usize, late: bool) -> (Vec<f64>, Vec<f64>) {
    let State { mut x, mut v, .. } = ParticleSystem::initial_state(scene);
    for _ in 0..steps {
        let mut f = vec![0.0; x.len()];
        for (p, particle) in scene.particles.iter().enumerate() {
            if !particle.fixed {
                f[3 * p + 2] += particle.mass * scene.solver.gravity;
            }
        }
        plain::add(scene, &x, &v, &mut f, true, Fault::None);
        let old = v.clone();
        for (p, particle) in scene.particles.iter().enumerate() {
            let w = if particle.fixed {
                0.0
            } else {
                1.0 / particle.mass
            };
            for at in 3 * p..3 * p + 3 {
                v[at] += STEP * (f[at] * w);
            }
        }
        for at in 0..x.len() {
            x[at] += STEP * if late { old[at] } else { v[at] };
        }
    }
    (x, v)
}

#[test]
fn kick_and_drift_in_one_pass_are_the_kick_and_then_the_drift() {
    // Vectors in one piece and in several.
    for n in [6, 110] {
        let scene = cloth(n, 0.01, DampingModel::Axial);
        let own = run(&scene, "symplectic_euler", 4);
        let (x, v) = symplectic_euler(&scene, 4, false);
        assert_eq!(differs(&own.x, &x), None);
        assert_eq!(differs(&own.v, &v), None);
        let (x, _) = symplectic_euler(&scene, 4, true);
        assert!(differs(&own.x, &x).is_some(), "a late drift passes");
    }
}
