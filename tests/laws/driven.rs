//! Driven particles: every method keeps its order and closes its balance at that order under a motion that is given,
//! whatever dampers share; every proof of a twin in rapier holds; other scenes pay nothing.

use crate::testkit::scenes::{chain, empty, fixed, free, shipped, spring};
use crate::testkit::{distance, method, own};
use springcheck::integrators::{self, Integrator, Method};
use springcheck::measure::{CheckStatus, twin};
use springcheck::physics::{
    ForceKinds, Jacobian, Linearization, ParticleSystem, Power, State, System,
};
use springcheck::scene::{DampingModel, Driven, Scene, Sine, Table, Wind};
use springcheck::solvers::advance;
use springcheck::truth::{self, Demand, Motion, NoStore};
use std::cell::Cell;

const UNTIL: f64 = 0.8;
/// Instants at which errors are taken.
const INSTANTS: usize = 4;

fn sine(particle: usize, amplitude: [f64; 3], omega: f64, phase: f64) -> Driven {
    Driven {
        particle,
        sine: Some(Sine {
            amplitude,
            omega,
            phase,
        }),
        ..Driven::default()
    }
}

/// A damper each, dampers that share particles, drag and wind beside them, motion in space, and a table.
fn scenes() -> Vec<(&'static str, Scene)> {
    let one = shipped("effects/driven_below.yml");
    let mut shared = chain(4, 0.5, 0.3, 60.0);
    shared.particles[4].fixed = true;
    for (spring, damping) in shared.springs.iter_mut().zip([0.6, 0.2, 0.9, 0.5]) {
        spring.damping = damping;
    }
    shared.particles[2].drag = 0.2;
    shared.driven = vec![
        sine(0, [0.05, 0.1, 0.0], 6.0, 0.7),
        Driven {
            particle: 4,
            velocity: Some([0.1, 0.0, 0.2]),
            ..Driven::default()
        },
    ];
    let mut isotropic = shared.clone();
    isotropic.damping_model = DampingModel::Isotropic;
    isotropic.wind = Some(Wind {
        direction: [0.0, 0.6, 0.8],
        strength: 1.0,
    });
    isotropic.solver.gravity = -3.0;
    let mut undamped = shared.clone();
    for spring in &mut undamped.springs {
        spring.damping = 0.0;
    }
    undamped.particles[2].drag = 0.0;
    let table = Scene {
        particles: vec![fixed([0.0; 3]), free([0.8, 0.0, -0.6], 1.0)],
        springs: vec![spring([0, 1], 30.0, 1.0)],
        driven: vec![Driven {
            // Rows where every method's steps end.
            table: Some(Table(vec![
                [0.0, 0.0, 0.0, 0.0],
                [0.2, 0.1, 0.0, 0.05],
                [0.4, 0.3, -0.1, 0.0],
                [0.6, 0.2, 0.1, 0.0],
                [2.0, 0.0, 0.0, 0.0],
            ])),
            ..Driven::default()
        }],
        ..empty()
    };
    vec![
        ("one damper", one),
        ("shared dampers", shared),
        ("isotropic, wind", isotropic),
        ("undamped", undamped),
        ("table", table),
    ]
}

/// Largest errors of the positions, m, and of the balance, J, over the instants, in `n` steps.
fn errors(
    system: &dyn System,
    start: &State,
    motion: &dyn Motion,
    integrator: &mut dyn Integrator,
    n: usize,
    begin: &dyn Fn(f64),
) -> [f64; 2] {
    let balance = |s: &State| {
        system.kinetic(&s.v) + system.potential(s.t, &s.x) + s.work.dissipated - s.work.injected
    };
    let mut state = start.clone();
    let (first, mut off) = (balance(start), [0.0_f64; 2]);
    let h = UNTIL / n as f64;
    for step in 0..n {
        begin(step as f64 * h);
        state.t = step as f64 * h;
        advance(integrator, system, h, (step + 1) as f64 * h, &mut state).expect("a step");
        if (step + 1) % (n / INSTANTS) == 0 {
            let truth = motion.states(&[state.t]);
            off[0] = off[0].max(distance(&state.x, truth.x(0)));
            off[1] = off[1].max((balance(&state) - first).abs());
        }
    }
    off
}

/// The slopes of both errors, from three numbers of steps.
fn slopes(errors: impl Fn(usize) -> [f64; 2], order: u32) -> [f64; 2] {
    // rk4's balance has a small term of its order and a large one of the next, of the other sign: it takes small steps.
    let [coarse, middle, fine] = [384, 768, 1536].map(errors);
    [0, 1].map(|i| {
        // The implicit midpoint rule closes the balance of linear forces to rounding.
        if coarse[i] < 1e-12 {
            return f64::from(order);
        }
        let [first, second] = [coarse[i] / middle[i], middle[i] / fine[i]].map(f64::log2);
        // A slope is off by a part of h, which halves from one to the other. An error that passes through 0 at one of
        // the steps makes one slope small, and the other large.
        first.max(second).max(2.0 * second - first)
    })
}

fn stated(method: &Method, system: &ParticleSystem) -> u32 {
    if system.kinds().depends_on_velocity() {
        method.order_damped
    } else {
        method.order
    }
}

#[test]
fn every_method_keeps_its_order_and_its_balance() {
    for (name, scene) in scenes() {
        let system = ParticleSystem::new(&scene);
        let start = ParticleSystem::initial_state(&scene);
        let truth = truth::find(&scene, &system, Demand::Auto, UNTIL, &NoStore);
        let motion = truth.motion().expect("a truth");
        let mut least = [f64::INFINITY; 2];
        for method in integrators::fixed() {
            let order = stated(method, &system);
            let build = own(method);
            let run = |n| errors(&system, &start, motion, build().as_mut(), n, &|_| {});
            let found = slopes(run, order);
            for (found, least) in found.into_iter().zip(&mut least) {
                *least = least.min(found - f64::from(order));
            }
            // Errors converge as the order says, or faster; 0.2 for terms of the next order.
            let fits = found.iter().all(|slope| *slope > f64::from(order) - 0.2);
            assert!(fits, "{name}, {}: {found:?} of order {order}", method.id);
        }
    }
}

/// A system that is asked for forces at the wrong time: that of the start of each step.
struct Late<'a>(&'a ParticleSystem, Cell<f64>);

impl System for Late<'_> {
    fn inverse_mass(&self) -> &[f64] {
        self.0.inverse_mass()
    }
    fn acceleration(&self, _t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        self.0.acceleration(self.1.get(), x, v, a)
    }
    fn potential(&self, t: f64, x: &[f64]) -> f64 {
        self.0.potential(t, x)
    }
    fn place(&self, t: f64, x: &mut [f64], v: &mut [f64]) {
        self.0.place(t, x, v);
    }
    fn jacobian(&self, _t: f64, x: &[f64], v: &[f64], by: Linearization, out: &mut Jacobian) {
        self.0.jacobian(self.1.get(), x, v, by, out);
    }
}

#[test]
fn stages_at_the_wrong_time_are_seen() {
    let (_, scene) = scenes().swap_remove(0);
    let system = ParticleSystem::new(&scene);
    let start = ParticleSystem::initial_state(&scene);
    let truth = truth::find(&scene, &system, Demand::Auto, UNTIL, &NoStore);
    let motion = truth.motion().expect("a truth");
    let late = Late(&system, Cell::new(0.0));
    let build = own(method("rk4"));
    let run = |n| {
        errors(&late, &start, motion, build().as_mut(), n, &|t| {
            late.1.set(t)
        })
    };
    let found = slopes(run, 4);
    assert!(found.iter().all(|slope| *slope < 1.5), "{found:?}");
}

#[test]
fn every_twin_is_proven() {
    for (name, scene) in scenes() {
        for proof in twin::prove(&scene, 0.01) {
            assert_eq!(proof.status, CheckStatus::Pass, "{name}: {proof:?}");
        }
    }
}

/// The force that holds an anchor does the work that is injected: minus the other forces on it times its velocity.
#[test]
fn the_work_of_the_drive_is_injected() {
    let (_, scene) = scenes().swap_remove(1);
    let system = ParticleSystem::new(&scene);
    let start = ParticleSystem::initial_state(&scene);
    let mut forces = vec![0.0; start.x.len()];
    let t = 0.37;
    // Wherever a caller has them, driven particles are in their places.
    let power = system.forces(t, &start.x, &start.v, &mut forces);
    let mut work = 0.0;
    for drive in scene.drives() {
        let [_, velocity, _] = drive.at(t);
        let own = &forces[3 * drive.particle..3 * drive.particle + 3];
        work -= own.iter().zip(velocity).map(|(f, v)| f * v).sum::<f64>();
    }
    assert!(work.abs() > 0.01, "{work}");
    assert!((power.injected - work).abs() <= 4.0 * f64::EPSILON * work.abs());
    let mut placed = start.clone();
    system.place(t, &mut placed.x, &mut placed.v);
    let mut same = vec![0.0; forces.len()];
    system.forces(t, &placed.x, &placed.v, &mut same);
    assert_eq!(forces, same);
}

#[test]
fn other_scenes_have_no_drive() {
    let scene = chain(4, 0.5, 0.3, 60.0);
    let system = ParticleSystem::new(&scene);
    assert!(system.drives().is_empty() && system.jumps().is_empty());
    assert!(!system.kinds().has(ForceKinds::DRIVEN));
    let (mut x, mut v) = (vec![1.0; 15], vec![2.0; 15]);
    system.place(1.0, &mut x, &mut v);
    assert!(x.iter().all(|x| *x == 1.0) && v.iter().all(|v| *v == 2.0));
}
