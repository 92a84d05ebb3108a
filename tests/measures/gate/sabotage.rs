//! Mutants of integrators, effects and rapier's mirror, each caught on a shipped scene and named.

use super::*;
use crate::testkit::mutants::{self, physics};
use crate::testkit::{is_its_own, part, pressed};
use springcheck::integrators::{Integrator, Settings, StepError};
use springcheck::physics::effects::{self, Effect, EffectRow};
use springcheck::physics::{ParticleSystem, State, System};
use springcheck::scene::{DampingModel, Driven, Sine};

/// A scene in which everything moves: a net that swings from two anchors.
fn net() -> Scene {
    let mut scene = shipped("pa1/scene03.yml");
    scene.duration = 400.0 * scene.solver.timestep;
    scene.expect.clear();
    scene
}

#[test]
fn a_wrong_integrator_fails_by_its_name() {
    let scene = net();
    let wrong: [(Step, &str); 8] = [
        (
            mutants::euler_drifting_with_the_new_velocity,
            "explicit_euler",
        ),
        (
            mutants::euler_drifting_with_the_old_velocity,
            "symplectic_euler",
        ),
        (mutants::midpoint_drifting_with_the_end_velocity, "midpoint"),
        (mutants::verlet_with_a_stale_force, "velocity_verlet"),
        (mutants::rk4_with_a_wrong_weight, "rk4"),
        (mutants::rk4_with_swapped_weights, "rk4"),
        (mutants::yoshida_with_swapped_coefficients, "yoshida4"),
        (
            mutants::symplectic_euler_at_half_the_step,
            "symplectic_euler",
        ),
    ];
    for (step, method) in part(&wrong, 2, 0) {
        let report = claiming(&scene, *step, method);
        let failed = failed(&report);
        assert!(!failed.is_empty(), "{method}");
        for check in failed {
            assert_eq!(check.subject, "mine", "{method}: {check:?}");
        }
    }
}

/// A small fault that any integrator may have: it is made of its step from the state before to the state after.
type Fault = fn(&State, &mut State);

/// Each well above rounding, and too small to be seen.
const FAULTS: [(&str, Fault); 3] = [
    ("a millionth of the velocity is lost", |_, after| {
        after.v.iter_mut().for_each(|v| *v *= 1.0 - 1e-6);
    }),
    ("a particle moves too far", |before, after| {
        for (x, from) in after.x.iter_mut().zip(&before.x) {
            *x += 1e-6 * (*x - from);
        }
    }),
    ("positions are of single precision", |_, after| {
        after.x.iter_mut().for_each(|x| *x = f64::from(*x as f32));
    }),
];

/// An integrator of the registry with such a fault.
struct Sabotaged {
    inner: Box<dyn Integrator>,
    fault: Fault,
}

impl Integrator for Sabotaged {
    fn step(&mut self, system: &dyn System, h: f64, state: &mut State) -> Result<(), StepError> {
        let before = state.clone();
        self.inner.step(system, h, state)?;
        (self.fault)(&before, state);
        Ok(())
    }
}

#[test]
fn every_integrator_of_the_registry_fails_by_its_name_once_it_is_sabotaged() {
    let scene = net();
    let cases: Vec<_> = integrators::fixed()
        .iter()
        .filter(|method| is_its_own(&scene, method))
        .flat_map(|method| FAULTS.map(|fault| (method, fault)))
        .collect();
    // Four is no multiple of three: a plain run meets every fault.
    for &(method, (what, fault)) in part(&cases, 4, 0) {
        let own = move || -> Box<dyn Integrator> {
            Box::new(Sabotaged {
                inner: method.build(&Settings::default()),
                fault,
            })
        };
        let choice = Choice {
            solvers: vec![Solver::own("mine", own)],
            ..Gate::choice(&scene)
        };
        let report = judged(&scene, &choice, method.id);
        let failed = failed(&report);
        let named = |check: &&&Check| check.id == "scheme" && check.subject == "mine";
        assert!(failed.iter().any(|c| named(&c)), "{}: {what}", method.id);
        // Without the fault nothing fails.
        let right = move || method.build(&Settings::default());
        let choice = Choice {
            solvers: vec![Solver::own("mine", right)],
            ..Gate::choice(&scene)
        };
        let report = judged(&scene, &choice, method.id);
        assert!(self::failed(&report).is_empty(), "{}", method.id);
    }
}

/// The same integrator without a fault passes under the same claim.
#[test]
fn a_right_integrator_of_ones_own_passes() {
    let scene = net();
    let report = claiming(&scene, physics::symplectic_euler, "symplectic_euler");
    assert!(failed(&report).is_empty(), "{:?}", failed(&report));
    let own = |check: &&Check| check.subject == "mine" && check.status == CheckStatus::Pass;
    let passed: Vec<&str> = report
        .header
        .checks
        .iter()
        .filter(own)
        .map(|c| c.id.as_str())
        .collect();
    for id in ["scheme", "same-bits", "balance", "claimed-order"] {
        assert!(passed.contains(&id), "{id}: {passed:?}");
    }
}

/// An effect whose force is a hundredth too strong for its own potential and power.
struct TooStrong(Box<dyn Effect>);

impl Effect for TooStrong {
    fn members(&self) -> usize {
        self.0.members()
    }
    fn kinds(&self) -> springcheck::physics::ForceKinds {
        self.0.kinds()
    }
    fn add_force(
        &self,
        t: f64,
        x: &[f64],
        v: &[f64],
        f: &mut [f64],
    ) -> springcheck::physics::Power {
        let mut own = vec![0.0; f.len()];
        let power = self.0.add_force(t, x, v, &mut own);
        for (f, own) in f.iter_mut().zip(own) {
            *f += 1.01 * own;
        }
        power
    }
    fn potential(&self, t: f64, x: &[f64]) -> f64 {
        self.0.potential(t, x)
    }
    fn add_damping(&self, x: &[f64], w: &[f64], f: &mut [f64]) {
        self.0.add_damping(x, w, f);
    }
}

#[test]
fn an_effect_whose_force_is_not_its_energys_fails_by_its_name() {
    let mut scene = pressed(DampingModel::Axial);
    scene.duration = 100.0 * scene.solver.timestep;
    // A motion that is given is no force.
    for row in effects::REGISTRY.iter().filter(|row| row.id != "driven") {
        let build = |other: &EffectRow| {
            let effect = (other.build)(&scene)?;
            Some(if other.id == row.id {
                Box::new(TooStrong(effect)) as _
            } else {
                effect
            })
        };
        let mut gate = Gate::new(&scene);
        gate.plan.system = ParticleSystem::with(&scene, &build);
        let report = gate.run(&Quiet).expect("nothing is written");
        let named = |check: &&Check| check.id == "forces" && check.subject == row.id;
        assert!(failed(&report).iter().any(named), "{}", row.id);
    }
}

/// Any number of the scene that is a hundredth off in one of the two worlds is seen by the twin proof.
#[test]
fn a_mirror_that_differs_fails() {
    type Change = fn(&mut Scene);
    let changes: [(&str, Change); 6] = [
        ("stiffness", |s| s.springs[0].stiffness *= 1.01),
        ("damping", |s| s.springs[0].damping *= 1.01),
        ("rest_length", |s| s.springs[0].rest_length *= 1.01),
        ("gravity", |s| s.solver.gravity *= 1.01),
        ("mass", |s| s.particles[2].mass *= 1.01),
        ("axis", |s| s.up = springcheck::scene::Axis::Y),
    ];
    let net = net();
    let mut swinging = net.clone();
    let anchor = swinging.particles.iter().position(|p| p.fixed).unwrap();
    swinging.driven.push(Driven {
        particle: anchor,
        sine: Some(Sine {
            amplitude: [0.05, 0.0, 0.02],
            omega: 8.0,
            phase: 0.5,
        }),
        ..Driven::default()
    });
    fn sine(s: &mut Scene, change: fn(&mut Sine)) {
        s.driven[0].sine.iter_mut().for_each(change);
    }
    let drives: [(&str, Change); 3] = [
        ("amplitude", |s| sine(s, |s| s.amplitude[0] *= 1.01)),
        ("omega", |s| sine(s, |s| s.omega *= 1.01)),
        ("phase", |s| sine(s, |s| s.phase *= 1.01)),
    ];
    let all = changes.into_iter().map(|change| (&net, change));
    for (scene, (what, change)) in all.chain(drives.into_iter().map(|d| (&swinging, d))) {
        let mut other = scene.clone();
        change(&mut other);
        let mut gate = Gate::new(scene);
        gate.twin = &other;
        let report = gate.run(&Quiet).expect("nothing is written");
        let twin = |check: &&Check| check.id.starts_with("twin-");
        assert!(failed(&report).iter().any(twin), "{what}");
    }
    for scene in [&net, &swinging] {
        assert!(failed(&Gate::new(scene).run(&Quiet).expect("nothing is written")).is_empty());
    }
}
