//! rapier-forces is symplectic Euler, bit for bit, and rapier-user-forces the same in four substeps under the
//! forces of the step's start.

use super::{apart, mutated, ours, scenes, theirs};
use springcheck::integrators::{self, StepError};
use springcheck::physics::{ParticleSystem, State, System};
use springcheck::scene::Scene;
use springcheck::solvers::rapier::RapierSettings;
use springcheck::solvers::{Counts, Engine, IntegratorEngine};

/// Both sides round v += h (f (1/m)) and x += h v, on forces from the same code: no tolerance.
fn law(ours_scene: &Scene, theirs: &mut dyn Engine) -> f64 {
    let h = ours_scene.solver.timestep;
    let steps = ours_scene.steps(h).min(400) as u32;
    apart(
        theirs,
        &mut *ours(ours_scene, "symplectic_euler", h),
        1,
        steps,
    )
}

/// Every scene, unstable ones (h w = 2.12), gravitation and cubic springs included.
#[test]
fn on_every_scene() {
    let ours_alone = [scenes::gravitational(), scenes::cubic()];
    for scene in scenes::mirrored().iter().chain(&ours_alone) {
        let mut engine = theirs(scene, "rapier-forces", scene.solver.timestep);
        assert_eq!(law(scene, &mut *engine), 0.0, "{}", scene.name);
    }
}

/// rapier takes the reciprocal of the mass as we do, whatever the mass.
#[test]
fn for_every_mass() {
    let mut mass = 1e-6;
    while mass < 1e6 {
        let scene = mutated(&scenes::drag_and_wind(), |s| {
            s.particles.iter_mut().for_each(|p| p.mass = mass);
            s.duration = 5.0 * s.solver.timestep;
        });
        let mut engine = theirs(&scene, "rapier-forces", scene.solver.timestep);
        assert_eq!(law(&scene, &mut *engine), 0.0, "{mass} kg");
        mass *= 1.0371;
    }
}

/// Symplectic Euler in substeps under held forces; and with a fault: what an engine that forgets to reset
/// rapier's forces, or to divide by the mass, would be.
struct Faulty {
    system: ParticleSystem,
    state: State,
    h: f64,
    substeps: u32,
    forces: Vec<f64>,
    accumulates: bool,
    ignores_mass: bool,
}

impl Faulty {
    /// Without a fault.
    fn held(scene: &Scene, h: f64, substeps: u32) -> Self {
        let state = ParticleSystem::initial_state(scene);
        Self {
            system: ParticleSystem::new(scene),
            forces: vec![0.0; state.x.len()],
            state,
            h,
            substeps,
            accumulates: false,
            ignores_mass: false,
        }
    }
}

impl Engine for Faulty {
    fn step(&mut self) -> Result<(), StepError> {
        let mut now = vec![0.0; self.forces.len()];
        let (x, v) = (&mut self.state.x, &mut self.state.v);
        self.system.forces(0.0, x, v, &mut now);
        for i in 0..now.len() {
            let kept = if self.accumulates {
                self.forces[i]
            } else {
                0.0
            };
            self.forces[i] = kept + now[i];
            let w = self.system.inverse_mass()[i];
            let w = if self.ignores_mass && w > 0.0 { 1.0 } else { w };
            let part = self.h / f64::from(self.substeps);
            for _ in 0..self.substeps {
                v[i] += part * (self.forces[i] * w);
                x[i] += part * v[i];
            }
        }
        Ok(())
    }
    fn state(&self) -> &State {
        &self.state
    }
    fn counts(&self) -> Counts {
        Counts::default()
    }
}

#[test]
fn mutants_fail() {
    let scene = scenes::drag_and_wind();
    let faulty = |accumulates, ignores_mass| {
        law(
            &scene,
            &mut Faulty {
                accumulates,
                ignores_mass,
                ..Faulty::held(&scene, scene.solver.timestep, 1)
            },
        )
    };
    assert_eq!(faulty(false, false), 0.0);
    assert!(faulty(true, false) > 0.1);
    assert!(faulty(false, true) > 0.1);
    let half = 0.5 * scene.solver.timestep;
    assert!(law(&scene, &mut *theirs(&scene, "rapier-forces", half)) > 0.01);
}

/// Both sides round the same operations: no tolerance.
#[test]
fn user_forces_are_held_over_four_substeps() {
    let ours_alone = [scenes::gravitational(), scenes::cubic()];
    for scene in scenes::mirrored().iter().chain(&ours_alone) {
        let h = scene.solver.timestep;
        let steps = scene.steps(h).min(400) as u32;
        let held = |substeps| {
            let mut engine = theirs(scene, "rapier-user-forces", h);
            apart(
                &mut *engine,
                &mut Faulty::held(scene, h, substeps),
                1,
                steps,
            )
        };
        assert_eq!(held(4), 0.0, "{}", scene.name);
        // Another number of substeps moves by another part of h² a.
        assert!(held(3) > 0.0 && held(1) > 0.0, "{}", scene.name);
    }
}

/// x1 = x0 + h v0 + 5/8 h² a and v1 = v0 + h a on x'' = -50 x, whose determinant is 1 + 3/8 z²: measured on rapier
/// itself, the energy is 4.6 times the initial one after 5 s at 1/60 s.
#[test]
fn user_forces_gain_three_eighths_of_z_squared_a_step() {
    let scene = crate::testkit::scenes::parsed(
        "solver: {type: symplectic_euler, timestep: 0.02, gravity: 0}\n\
         particles:\n\
         - {pos: [0, 0, 0], fixed: true}\n\
         - {pos: [0.5, 0, 0], mass: 1}\n\
         springs: [{particle_ids: [0, 1], stiffness: 50, rest_length: 0}]\n",
    );
    let h = 1.0 / 60.0;
    let mut engine = theirs(&scene, "rapier-user-forces", h);
    let (mut x, mut v, mut area) = ([0.5, 0.0], [0.0, 1.0], 0.5);
    for _ in 0..300 {
        engine.step().expect("a step");
        for (x, v) in x.iter_mut().zip(&mut v) {
            let a = -50.0 * *x;
            *x += h * *v + 0.625 * h * h * a;
            *v += h * a;
        }
        area *= 1.0 + 0.375 * 50.0 * h * h;
    }
    let state = engine.state();
    // 300 steps of a few last bits of numbers near 1 and 7, half of eps each.
    assert!((state.x[3] - x[0]).abs() < 1e-13 && (state.v[3] - v[0]).abs() < 7e-13);
    // The determinant: what two starts span grows by 1 + 3/8 z² a step.
    assert!(((x[0] * v[1] - x[1] * v[0]) / area - 1.0).abs() < 1e-12);
    let energy = |x: f64, v: f64| 25.0 * x * x + 0.5 * v * v;
    let gained = energy(state.x[3], state.v[3]) / energy(0.5, 0.0);
    assert!((gained - 4.6).abs() < 0.05, "{gained}");
}

/// rapier-forces is symplectic Euler in its work too: the powers where the kick is.
#[test]
fn work_under_our_forces_is_symplectic_eulers() {
    let scene = scenes::drag_and_wind();
    let h = scene.solver.timestep;
    let method = integrators::find("symplectic_euler").expect("a method");
    let system = ParticleSystem::new(&scene);
    let mut ours = IntegratorEngine::new(&scene, system, method, &Default::default(), h);
    let mut theirs = theirs(&scene, "rapier-forces", h);
    for _ in 0..100 {
        ours.step().expect("a step");
        theirs.step().expect("a step");
        assert_eq!(ours.state().work, theirs.state().work);
    }
    assert!(ours.state().work.dissipated > 0.0 && ours.state().work.injected != 0.0);
}

/// The work rapier's joints do is the trapezoid of the powers at their states.
#[test]
fn work_is_the_trapezoid_of_the_powers() {
    let scene = scenes::drag_and_wind();
    let system = ParticleSystem::new(&scene);
    let h = scene.solver.timestep;
    let mut scratch = vec![0.0; system.dim()];
    for id in ["rapier", "rapier-converged"] {
        let mut engine = theirs(&scene, id, h);
        let (mut trapezoid, mut rectangle) = (0.0, 0.0);
        for _ in 0..100 {
            let mut power = || {
                let s = engine.state();
                system.forces(s.t, &s.x, &s.v, &mut scratch)
            };
            let before = power();
            engine.step().expect("a step");
            let s = engine.state();
            let after = system.forces(s.t, &s.x, &s.v, &mut scratch);
            trapezoid += 0.5 * h * (before.dissipated + after.dissipated);
            rectangle += h * before.dissipated;
        }
        let work = engine.state().work;
        // A hundred additions of half a last bit, as a random walk: 5 eps, measured 3.
        assert!((work.dissipated / trapezoid - 1.0).abs() < 2e-15, "{id}");
        assert!((work.dissipated / rectangle - 1.0).abs() > 1e-5, "{id}");
        assert!(work.injected != 0.0, "{id}");
    }
}

/// rapier puts a body that overflowed back to where it was; the engine must not.
#[test]
fn what_left_the_numbers_stays_lost() {
    let scene = mutated(&scenes::course(1), |s| s.springs[0].stiffness = 1e200);
    let mut engine = theirs(&scene, "rapier-forces", 1.0);
    for _ in 0..10 {
        engine.step().expect("a step");
    }
    assert!(engine.state().x[5].is_nan());
    engine.step().expect("a step");
    assert!(engine.state().x[5].is_nan());
}

/// The recipe's cap is off: 400 m/s is rapier's default.
#[test]
fn fast_particles_stay_fast() {
    let mut scene = scenes::course(0);
    scene.particles[0].velocity = [5000.0, 0.0, 0.0];
    for id in ["rapier", "rapier-forces", "rapier-converged"] {
        let mut engine = theirs(&scene, id, 0.01);
        engine.step().expect("a step");
        assert_eq!(engine.state().v[0], 5000.0, "{id}");
    }
    // As rapier ships, where somebody asks for it.
    let capped = springcheck::solvers::Solver::rapier(RapierSettings {
        speed: Some(400.0),
        ..RapierSettings::DEFAULT
    });
    assert_eq!(capped.id, "rapier(speed=400)");
    let mut engine = super::build(&capped, &scene, 0.01);
    engine.step().expect("a step");
    let squares: f64 = engine.state().v.iter().map(|v| v * v).sum();
    // A few roundings of the scaling.
    assert!((squares.sqrt() - 400.0).abs() < 1e-12);
}

#[test]
fn evaluations_are_counted() {
    let mut engine = theirs(&scenes::drag(), "rapier-forces", 0.01);
    for _ in 0..7 {
        engine.step().expect("a step");
    }
    assert_eq!(engine.counts().force_evaluations, Some(7));
    assert_eq!(engine.counts().linear_solves, None);
}
