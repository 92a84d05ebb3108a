//! Scenes built to break a solver: every implicit step ends solved, or in an error that names a
//! particle.

use super::{SOLVED, stage};
use crate::testkit::scenes::{fixed, free, shipped, spring};
use crate::testkit::{Random, built, method, own, swinging_triangle};
use springcheck::integrators::{Integrator, Settings, StepError};
use springcheck::physics::{Jacobian, Linearization, State, System};
use springcheck::scene::{DampingModel, Particle, Scene, Spring, Wind};

/// A particle of this mass at rest, fixed for a mass of 0.
fn particle(position: [f64; 3], mass: f64) -> Particle {
    if mass == 0.0 {
        fixed(position)
    } else {
        free(position, mass)
    }
}

fn scene(particles: Vec<Particle>, springs: Vec<Spring>) -> Scene {
    let mut scene = swinging_triangle(0.0, DampingModel::Axial);
    scene.particles = particles;
    scene.springs = springs;
    scene
}

/// A chain from a fixed end along x, links of length 1 that want to be `rest`, a little bent.
fn chain(
    links: usize,
    rest: f64,
    stiffness: impl Fn(usize) -> f64,
    mass: impl Fn(usize) -> f64,
) -> Scene {
    let mut random = Random(3);
    let bent =
        |i: usize, random: &mut Random| [i as f64, 1e-3 * random.next(), 1e-3 * random.next()];
    let particles = (0..=links).map(|i| {
        let mass = if i == 0 { 0.0 } else { mass(i) };
        particle(bent(i, &mut random), mass)
    });
    let springs = (0..links).map(|i| spring([i, i + 1], stiffness(i), rest));
    scene(particles.collect(), springs.collect())
}

/// A square cloth hung by two corners: structural, shear and flexion springs.
pub fn cloth(n: usize, stiffness: f64, mass: f64) -> Scene {
    let particles = (0..n * n).map(|p| {
        let held = p == 0 || p == n - 1;
        let at = [0.1 * (p / n) as f64, 0.1 * (p % n) as f64, 2.0];
        particle(at, if held { 0.0 } else { mass })
    });
    let mut springs = Vec::new();
    for (row, column) in (0..n * n).map(|p| (p / n, p % n)) {
        for (down, right) in [(0, 1), (1, 0), (1, 1), (1, -1), (0, 2), (2, 0)] {
            let (to_row, to) = (row + down, column as isize + right);
            if to_row < n && (0..n as isize).contains(&to) {
                let length = 0.1 * ((down * down) as f64 + (right * right) as f64).sqrt();
                let ends = [row * n + column, to_row * n + to as usize];
                springs.push(spring(ends, stiffness, length));
            }
        }
    }
    scene(particles.collect(), springs)
}

fn with(mut scene: Scene, change: impl FnOnce(&mut Scene)) -> Scene {
    change(&mut scene);
    scene
}

fn damped(scene: Scene, damping: f64, model: DampingModel) -> Scene {
    with(scene, |scene| {
        scene.damping_model = model;
        for spring in &mut scene.springs {
            spring.damping = damping;
        }
    })
}

/// Name and scene.
fn family() -> Vec<(&'static str, Scene)> {
    let one = |_| 1.0;
    let k = |_| 1e3;
    let weightless = |scene: Scene| with(scene, |scene| scene.solver.gravity = 0.0);
    let straight = |scene: Scene| {
        with(weightless(scene), |scene| {
            for particle in &mut scene.particles {
                particle.position[1] = 0.0;
                particle.position[2] = 0.0;
            }
        })
    };
    let through = |rest: f64| {
        let pair = vec![particle([0.0; 3], 1.0), particle([0.3, 0.0, 0.0], 1.0)];
        with(
            weightless(scene(pair, vec![spring([0, 1], 1e3, rest)])),
            |scene| {
                scene.particles[1].velocity = [-50.0, 0.01, 0.0];
            },
        )
    };
    let everything = |model| {
        with(damped(chain(30, 0.8, k, one), 3.0, model), |scene| {
            scene.particles[5].drag = 0.4;
            scene.wind = Some(Wind {
                direction: [0.6, 0.0, 0.8],
                strength: 1.5,
            });
        })
    };
    vec![
        ("compressed to a tenth", chain(3, 10.0, k, one)),
        ("compressed to a tenth, many", chain(40, 10.0, k, one)),
        (
            "compressed to a tenth, straight",
            straight(chain(3, 10.0, k, one)),
        ),
        ("compressed and stiff", chain(3, 10.0, |_| 1e8, one)),
        (
            "compressed and damped",
            damped(chain(3, 10.0, k, one), 30.0, DampingModel::Axial),
        ),
        (
            "coincident ends, L = 0",
            with(chain(3, 0.0, k, one), |scene| {
                scene.particles[2].position = scene.particles[1].position;
            }),
        ),
        ("through each other, L = 0", through(0.0)),
        ("through each other, L = 0.3", through(0.3)),
        ("stretched 1e3 times", chain(3, 1e-3, k, one)),
        ("stretched 1e3 times, many", chain(40, 1e-3, |_| 1e6, one)),
        ("soft, k = 1e-3", chain(5, 0.9, |_| 1e-3, one)),
        ("stiff, k = 1e8", chain(5, 0.999, |_| 1e8, one)),
        (
            "k ratio 1e8",
            chain(30, 0.9, |i| if i % 2 == 0 { 1.0 } else { 1e8 }, one),
        ),
        (
            "mass ratio 1e6",
            chain(4, 0.9, k, |i| if i % 2 == 0 { 1e-3 } else { 1e3 }),
        ),
        (
            "mass ratio 1e6, the other way",
            chain(4, 0.9, k, |i| if i < 4 { 1e-3 } else { 1e3 }),
        ),
        (
            "far from the origin",
            with(chain(30, 0.999, k, one), |scene| {
                for particle in &mut scene.particles {
                    particle.position = particle.position.map(|x| x + 1e6);
                }
            }),
        ),
        (
            "axial dampers far above critical",
            damped(chain(30, 0.8, k, one), 1e5, DampingModel::Axial),
        ),
        (
            "isotropic dampers",
            damped(chain(30, 0.8, k, one), 1e3, DampingModel::Isotropic),
        ),
        ("dampers, drag and wind", everything(DampingModel::Axial)),
        (
            "isotropic dampers, drag and wind",
            everything(DampingModel::Isotropic),
        ),
        ("cloth, k = 1e6", cloth(8, 1e6, 0.01)),
        (
            "all fixed but one",
            with(chain(4, 2.0, k, one), |scene| {
                for at in [1, 2, 4] {
                    scene.particles[at].fixed = true;
                }
            }),
        ),
    ]
}

const STEPS: [f64; 6] = [1e-4, 1e-3, 1e-2, 1.0 / 60.0, 0.1, 1.0];

/// Of one step from each scene: the ones left unsolved, and the ones refused.
fn hard_law(
    id: &str,
    build: &dyn Fn() -> Box<dyn Integrator>,
) -> (Vec<String>, Vec<(&'static str, f64, StepError)>) {
    let (mut wrong, mut refused) = (Vec::new(), Vec::new());
    for (name, scene) in family() {
        for h in STEPS {
            let (system, start) = built(&scene);
            let mut end = start.clone();
            match build().step(&system, h, &mut end) {
                Err(error) => refused.push((name, h, error)),
                Ok(()) => {
                    let (off, size) = stage(id, &system, &start, &end, h);
                    let floor = rounding(&system, &start, &end, h);
                    // What Newton's iteration promises: 1e-12, or 8 roundings; of midpoint's
                    // reconstructed velocities one more is lost.
                    let bar = (1e-12 * size).max(10.0 * floor);
                    if off.is_nan() || off > bar {
                        wrong.push(format!(
                            "{id}, {name}, h = {h}: {:.1e}, {:.1} roundings",
                            off / size,
                            off / floor
                        ));
                    }
                }
            }
        }
    }
    (wrong, refused)
}

/// eps (h |∂f/∂x| max(|x0|, |x1|) + M (|v0| + |v1|)): a rounding of positions and velocities in the residual.
fn rounding(system: &dyn System, start: &State, end: &State, h: f64) -> f64 {
    let mut jacobian = Jacobian::default();
    system.jacobian(0.0, &end.x, &end.v, Linearization::Exact, &mut jacobian);
    let mut size: Vec<f64> = vec![0.0; start.x.len()];
    for (row, column, value) in jacobian.position {
        let reach = start.x[column].abs().max(end.x[column].abs());
        size[row] += h * (value * reach).abs();
    }
    let mut squares = 0.0;
    for (i, w) in system.inverse_mass().iter().enumerate() {
        if *w > 0.0 {
            squares += (size[i] + (start.v[i].abs() + end.v[i].abs()) / w).powi(2);
        }
    }
    f64::EPSILON * f64::sqrt(squares)
}

/// Steps that end in [`StepError::NotConverged`] instead: scene, and from which h on. In all of them
/// stiff springs have to turn far within the step, and Φ's valley bends with them: every step along
/// it is short.
const BEYOND: &[(&str, f64)] = &[
    ("compressed and stiff", 1.0 / 60.0),
    ("axial dampers far above critical", 0.1),
];

#[test]
fn hard_steps_are_solved() {
    for id in SOLVED {
        let (wrong, refused) = hard_law(id, &own(method(id)));
        assert!(wrong.is_empty(), "{wrong:#?}");
        for (name, h, error) in refused {
            let beyond = BEYOND
                .iter()
                .any(|(scene, from)| *scene == name && h >= *from);
            assert!(beyond, "{id}, {name}, h = {h}: {error}");
            let StepError::NotConverged { particle, .. } = error else {
                panic!("{id}, {name}, h = {h}: {error}");
            };
            assert!(particle > 0, "the first one is fixed: {error}");
            assert!(
                error
                    .to_string()
                    .contains(&format!("at particle {particle}:"))
            );
        }
    }
}

#[test]
fn the_hard_law_kills_mutants() {
    for id in SOLVED {
        let loose = || method(id).build(&Settings::stated(Some(1e-9)));
        let (wrong, _) = hard_law(id, &loose);
        assert!(!wrong.is_empty(), "{id}");
        let (wrong, _) = hard_law(id, &own(method("linearized_implicit_at_start")));
        assert!(!wrong.is_empty(), "{id}");
    }
}

#[test]
fn a_refused_step_leaves_the_state() {
    let scene = chain(3, 10.0, |_| 1e8, |_| 1.0);
    for id in ["implicit_euler", "implicit_midpoint"] {
        let (system, start) = built(&scene);
        let mut state = start.clone();
        let error = own(method(id))().step(&system, 0.1, &mut state);
        assert!(
            matches!(error, Err(StepError::NotConverged { .. })),
            "{error:?}"
        );
        assert_eq!(state, start);
    }
    // A state that is not finite is refused by the particle's name.
    let (system, mut state) = built(&scene);
    state.x[7] = f64::NAN;
    let error = own(method("implicit_euler"))().step(&system, 0.1, &mut state);
    // The spring that ends at particle 2 begins at particle 1.
    assert_eq!(error, Err(StepError::NotFinite { particle: 1 }));
}

/// The most linear solves any of these steps takes.
fn most_solves(id: &str, name: &str, h: f64, steps: usize) -> u64 {
    let (system, mut state) = built(&shipped(&format!("hard/{name}.yml")));
    let mut integrator = own(method(id))();
    let mut most = 0;
    for _ in 0..steps {
        let before = integrator.linear_solves();
        integrator.step(&system, h, &mut state).expect("a step");
        most = most.max(integrator.linear_solves() - before);
    }
    most
}

/// The chain folds in its plane and would rather buckle sideways: a solution at which the matrix is
/// indefinite. Newton's own steps converge there quadratically: 202 solves, with the search for them. Of
/// directions of descent alone, which leave nine tenths of the residual each, it takes 253.
#[test]
fn saddles_are_met_quadratically() {
    let most = most_solves("implicit_midpoint", "chain_20", 1.0 / 60.0, 60);
    assert!(most < 225, "{most}");
}
