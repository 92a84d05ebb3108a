//! States along a trajectory, where limits are taken again.

use super::StabilityPlan;
use crate::integrators::Method;
use crate::measure::stability::{Linearised, LinearisedTrajectory};
use crate::physics::{ParticleSystem, State};
use crate::solvers::{Setting, Solver};
use crate::trajectory::Observer;
use crate::verbs::facts;

/// States kept of a path.
const STATES: u64 = 100;
/// Steps times particles the path may take; what a scene of a few particles needs many times over.
const REACH: u64 = 20_000_000;

/// A trajectory as far as it was followed.
pub struct Path {
    /// Linearised at some of its states, the start left out; None where every state has the same
    /// limits.
    pub along: Option<LinearisedTrajectory>,
    /// When it ends, s.
    pub until: f64,
    /// Whose trajectory it is.
    pub method: Option<&'static Method>,
}

/// The trajectory of the first method whose step is predicted to be stable, the scene's own coming
/// first: one that explodes would show limits of places nothing really gets to.
pub fn of(
    plan: &StabilityPlan,
    system: &ParticleSystem,
    linearised: &Linearised,
    linear: bool,
) -> Path {
    let scene = plan.scene;
    let h = scene.solver.timestep;
    let calm = |method: &&'static Method| linearised.predict(method, h).limit.allows(h);
    let candidates = crate::solvers::methods(&scene.solver.method);
    let candidates: Vec<&Method> = candidates.iter().filter_map(Solver::as_method).collect();
    let chosen = candidates.iter().find(|m| calm(m)).or(candidates.first());
    let nowhere = Path {
        along: None,
        until: scene.duration,
        method: None,
    };
    let (false, Some(&method)) = (linear, chosen) else {
        return nowhere;
    };
    let particles = scene.particles.len().max(1) as u64;
    let steps = scene.steps(h).min((REACH / particles).max(STATES));
    let setting = Setting::Steps { timestep: h, steps };
    let Ok(mut run) = Solver::method(method).start(scene, system, &setting) else {
        return nowhere;
    };
    let mut kept = Kept {
        every: steps.div_ceil(STATES).max(1),
        states: Vec::new(),
    };
    run.finish(&facts::limits(scene, system), &mut kept, &|_| {});
    // Where it ended early, what it ended in is no place to linearise about.
    kept.states.retain(State::is_finite);
    Path {
        until: run.state().t.min(scene.duration),
        along: Some(LinearisedTrajectory::new(system, &kept.states)),
        method: Some(method),
    }
}

struct Kept {
    every: u64,
    states: Vec<State>,
}

impl Observer for Kept {
    fn next(&self, from: u64) -> Option<u64> {
        Some(from.max(1).next_multiple_of(self.every))
    }

    fn observe(&mut self, _step: u64, state: &State) {
        self.states.push(state.clone());
    }

    fn observe_diverged(&mut self, _step: u64, _state: &State) {}
}
