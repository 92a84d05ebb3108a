//! Two solvers over the same few instants.

use crate::integrators::{self, Integrator, StepError};
use crate::physics::{ParticleSystem, State, System};
use crate::scene::Scene;
use crate::solvers::{Setting, Solver, Unsupported};
use crate::vector::axpy;

/// The states at the start and after each of a few world steps.
pub(super) struct Path {
    states: Vec<State>,
    failed: Option<StepError>,
}

impl Path {
    /// `steps` world steps of `substeps` steps of `h` seconds each, or fewer if a step fails. Within a world step of
    /// several what is driven moves straight, as a body of an engine does.
    pub(super) fn of(
        solver: &Solver,
        scene: &Scene,
        h: f64,
        substeps: u32,
        steps: u32,
    ) -> Result<Self, Unsupported> {
        let smooth = ParticleSystem::new(scene);
        let mut system = smooth.clone();
        if substeps > 1 {
            system = system.driven_as(|drive| drive.straight(f64::from(substeps) * h));
        }
        let mut run = solver.start(scene, &system, &Setting::step(h))?;
        let mut path = Self {
            states: vec![run.state().clone()],
            failed: None,
        };
        for _ in 0..steps {
            if let Err(error) = run.advance(substeps.into()) {
                path.failed = Some(error);
                break;
            }
            let mut state = run.state().clone();
            smooth.place(state.t, &mut state.x, &mut state.v);
            path.states.push(state);
        }
        Ok(path)
    }

    /// The path of our integrator of this id.
    pub(super) fn ours(
        scene: &Scene,
        method: &str,
        h: f64,
        substeps: u32,
        steps: u32,
    ) -> Result<Self, Unsupported> {
        // A missing row would be a fault of this program's; explicit Euler, the first, then fails the
        // proof instead of stopping the run.
        let method = integrators::find(method).unwrap_or(&integrators::fixed()[0]);
        Self::of(&Solver::method(method), scene, h, substeps, steps)
    }

    /// The reason why the path is not a whole one, if so.
    pub(super) fn ended(&self) -> Option<String> {
        if let Some(error) = &self.failed {
            return Some(error.to_string());
        }
        let finite = self.states.iter().all(State::is_finite);
        (!finite).then(|| "it leaves the finite numbers".to_owned())
    }
}

/// Symplectic Euler in `substeps` of a step, under the forces of its start: what rapier's bodies do.
pub(super) struct ForcesHeld {
    substeps: u32,
    a: Vec<f64>,
}

impl ForcesHeld {
    pub(super) fn new(substeps: u32) -> Self {
        Self {
            substeps,
            a: Vec::new(),
        }
    }
}

impl Integrator for ForcesHeld {
    fn step(&mut self, system: &dyn System, h: f64, state: &mut State) -> Result<(), StepError> {
        self.a.resize(state.x.len(), 0.0);
        let power = system.acceleration(state.t, &state.x, &state.v, &mut self.a);
        let part = h / f64::from(self.substeps);
        for _ in 0..self.substeps {
            axpy(&mut state.v, part, &self.a);
            axpy(&mut state.x, part, &state.v);
        }
        state.work.advance(power, h);
        state.t += h;
        Ok(())
    }
}

/// Largest distance over the instants both have: positions in units of the largest coordinate,
/// velocities in units of the largest speed. None if a number is not finite.
///
/// In units of the whole path's largest, so that a growing mode, which every scene set in motion contains,
/// grows in the unit as it does in the error.
pub(super) fn distance(a: &Path, b: &Path) -> Option<f64> {
    let over = |part: fn(&State) -> &[f64]| {
        let (mut apart, mut unit) = (0.0_f64, 0.0_f64);
        for (a, b) in a.states.iter().zip(&b.states) {
            for (a, b) in part(a).iter().zip(part(b)) {
                let (d, size) = ((a - b).abs(), a.abs().max(b.abs()));
                if !(d.is_finite() && size.is_finite()) {
                    return None;
                }
                apart = apart.max(d);
                unit = unit.max(size);
            }
        }
        Some(if apart > 0.0 { apart / unit } else { 0.0 })
    };
    let (x, v) = (over(|state| &state.x)?, over(|state| &state.v)?);
    Some(x.max(v))
}
