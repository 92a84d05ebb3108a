//! States along a trajectory at which limits are predicted again.

use super::StabilityPlan;
use crate::integrators::Method;
use crate::measure::stability::{Linearised, LinearisedTrajectory};
use crate::physics::constraints::contact::Obstacles;
use crate::physics::{ParticleSystem, State, System};
use crate::scene::Scene;
use crate::solvers::{Setting, Solver};
use crate::trajectory::Observer;
use crate::verbs::facts;

/// The most states kept of a path.
const STATES: u64 = 100;
/// The most steps times particles of the path: many times what a scene of a few particles needs.
const MAX_WORK: u64 = 20_000_000;

/// The most states at which it is seen whether a penalty presses.
const LOOKS: u64 = 20_000;

/// A trajectory, as far as it was followed.
pub struct Path {
    /// The scene linearised at some of its states, without the start; None where every state has the
    /// same limits.
    pub along: Option<LinearisedTrajectory>,
    /// When it ends, s.
    pub until: f64,
    /// The method that computed it.
    pub method: Option<&'static Method>,
    /// The state in which a penalty presses at most contacts, the first of these; None where none presses.
    pub pressed: Option<State>,
}

/// The trajectory of the first method whose step is predicted to be stable; the scene's own is tried
/// first. One that explodes would show limits at places the motion never reaches.
pub fn of(
    plan: &StabilityPlan,
    system: &ParticleSystem,
    linearised: &Linearised,
    linear: bool,
) -> Path {
    let scene = plan.scene;
    let h = scene.solver.timestep;
    let is_stable = |method: &&'static Method| linearised.predict(method, h).limit.allows(h);
    let candidates = crate::solvers::methods(&scene.solver.method);
    let candidates: Vec<&Method> = candidates.iter().filter_map(Solver::as_method).collect();
    let chosen = candidates
        .iter()
        .find(|m| is_stable(m))
        .or(candidates.first());
    let start_only = Path {
        along: None,
        until: scene.duration,
        method: None,
        pressed: None,
    };
    let (false, Some(&method)) = (linear, chosen) else {
        return start_only;
    };
    let steps = steps(scene);
    let setting = Setting::Steps { timestep: h, steps };
    let Ok(mut run) = Solver::method(method).start(scene, system, &setting) else {
        return start_only;
    };
    let presses = system.obstacles().filter(|all| all.penalty().is_some());
    let mut kept = KeptStates {
        every: steps.div_ceil(STATES).max(1),
        states: Vec::new(),
        look: steps.div_ceil(LOOKS).max(1),
        presses: presses.map(Obstacles::copied),
        pressed: None,
    };
    run.finish(&facts::limits(scene, system), &mut kept, &|_| {});
    // A run that ended early ends in states that cannot be linearised about.
    kept.states.retain(State::is_finite);
    Path {
        until: run.state().t.min(scene.duration),
        along: Some(LinearisedTrajectory::new(system, &kept.states)),
        method: Some(method),
        pressed: kept.pressed.map(|(_, state)| state),
    }
}

/// The steps it takes where forces are not linear.
pub fn steps(scene: &Scene) -> u64 {
    let particles = scene.particles.len().max(1) as u64;
    let affordable = (MAX_WORK / particles).max(STATES);
    scene.steps(scene.solver.timestep).min(affordable)
}

struct KeptStates {
    every: u64,
    states: Vec<State>,
    /// Steps from one look at the contacts to the next.
    look: u64,
    /// What presses by a penalty.
    presses: Option<Obstacles>,
    /// The most contacts that a penalty presses at, and the state.
    pressed: Option<(usize, State)>,
}

impl Observer for KeptStates {
    fn next(&self, from: u64) -> Option<u64> {
        let next = |every| from.max(1).next_multiple_of(every);
        let look = self.presses.as_ref().map_or(self.every, |_| self.look);
        Some(next(self.every).min(next(look)))
    }

    fn observe(&mut self, step: u64, state: &State) {
        if step.is_multiple_of(self.every) {
            self.states.push(state.clone());
        }
        if let Some(obstacles) = self.presses.as_ref().filter(|_| state.is_finite()) {
            let inside = obstacles.inside(state).len();
            if inside > self.pressed.as_ref().map_or(0, |(most, _)| *most) {
                self.pressed = Some((inside, state.clone()));
            }
        }
    }

    fn observe_diverged(&mut self, _step: u64, _state: &State) {}
}
