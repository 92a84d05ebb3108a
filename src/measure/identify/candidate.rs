//! The schemes a trajectory may follow: a method, whole or in substeps, or one of the common mistakes.

use crate::integrators::{Integrator, Method, PerStep, Settings, Stable, StepError};
use crate::physics::{ParticleSystem, State, System};
use crate::solvers::advance;

/// A scheme to replay: known method, known mistake, or a guess at what went wrong.
#[derive(Clone)]
pub struct Candidate {
    /// As reports name it: `rk4`, `midpoint_end_velocity`, `gravity_forgotten(rk4)`.
    pub id: String,
    /// Steps it takes inside one timestep.
    pub substeps: u32,
    /// Registry id of the method it is, or was meant to be.
    pub meant: &'static str,
    /// What is wrong with it, for people; None for a method as it should be.
    pub mistake: Option<&'static str>,
    /// Its step depends on the state one step before: it can be replayed only from the first state
    /// and from states whose predecessor is known.
    pub remembers: bool,
    /// Length of the step it takes, in timesteps: 1, unless h itself is wrong.
    stretch: f64,
    /// The forces it really computes: the scene's, or altered ones.
    system: ParticleSystem,
    scheme: Scheme,
}

/// How a candidate steps.
#[derive(Clone, Copy)]
pub enum Scheme {
    Method(&'static Method),
    /// A map of its own.
    Map(Map),
}

/// A one-step map over h from a state in place, given the state one step (of the same h) before it,
/// if that is known.
pub type Map = fn(&dyn System, f64, Option<&State>, &mut State) -> Result<(), StepError>;

impl Candidate {
    /// A registry method in this many substeps.
    pub fn method(system: &ParticleSystem, method: &'static Method, substeps: u32) -> Self {
        Self {
            id: method.id.to_owned(),
            substeps,
            meant: method.id,
            mistake: None,
            remembers: false,
            stretch: 1.0,
            system: system.clone(),
            scheme: Scheme::Method(method),
        }
    }

    /// A map that is no method of the registry.
    pub fn map(
        system: &ParticleSystem,
        id: &str,
        meant: &'static str,
        mistake: &'static str,
        map: Map,
    ) -> Self {
        Self {
            id: id.to_owned(),
            substeps: 1,
            meant,
            mistake: Some(mistake),
            remembers: false,
            stretch: 1.0,
            system: system.clone(),
            scheme: Scheme::Map(map),
        }
    }

    /// A method under other forces than the scene's, as `wrong(method)`.
    pub fn altered(
        system: &ParticleSystem,
        method: &'static Method,
        wrong: &str,
        mistake: &'static str,
    ) -> Self {
        Self {
            id: format!("{wrong}({})", method.id),
            mistake: Some(mistake),
            ..Self::method(system, method, 1)
        }
    }

    /// The same scheme under other forces.
    pub fn under(&self, system: &ParticleSystem) -> Self {
        Self {
            system: system.clone(),
            ..self.clone()
        }
    }

    /// The same with steps of `factor` h while rows stay h apart: not substeps, of which several
    /// make a whole step.
    pub fn stretched(&self, factor: f64) -> Self {
        Self {
            stretch: self.stretch * factor,
            ..self.clone()
        }
    }

    /// Marks a map that uses the state one step before.
    pub fn remembering(self, remembers: bool) -> Self {
        Self { remembers, ..self }
    }

    /// About how many roundings of positions or velocities one of its whole steps makes.
    pub fn roundings(&self) -> u32 {
        let stages = match self.scheme {
            // Force, matrix, factors and their solve; iterations before the last are corrected.
            Scheme::Method(_) if self.solves() => 4,
            Scheme::Method(method) => match method.evaluations {
                // The force, and what it is added to.
                PerStep::Exactly(n) => 2 * n.max(1),
                PerStep::PerIteration { plus } => 2 * (1 + plus),
            },
            // Taken as many as RK4's: more than any of the mistakes has.
            Scheme::Map(_) => 8,
        };
        stages.saturating_mul(self.substeps.max(1))
    }

    /// Whether its steps solve linear systems, which costs as much as many that do not.
    pub fn solves(&self) -> bool {
        match self.scheme {
            Scheme::Method(method) => matches!(
                method.oscillator.stable,
                Stable::Always | Stable::AlwaysAlong { .. }
            ),
            Scheme::Map(_) => false,
        }
    }

    /// Whether its steps end when a residual is small, not when a formula is through.
    pub fn iterates(&self) -> bool {
        match self.scheme {
            Scheme::Method(method) => matches!(method.evaluations, PerStep::PerIteration { .. }),
            Scheme::Map(_) => false,
        }
    }

    /// Its name in the reports' `equivalent`: the id, and after a slash the substeps if there are several.
    pub fn label(&self) -> String {
        label(&self.id, self.substeps)
    }

    /// A replayer that takes its steps. Each thread has its own.
    pub fn replayer(&self, settings: &Settings) -> Replayer<'_> {
        Replayer {
            candidate: self,
            integrator: match self.scheme {
                Scheme::Method(method) => Some(method.build(settings)),
                Scheme::Map(_) => None,
            },
        }
    }
}

/// An id, and after a slash the substeps if there are several.
pub(super) fn label(id: &str, substeps: u32) -> String {
    match substeps {
        0 | 1 => id.to_owned(),
        n => format!("{id}/{n}"),
    }
}

/// Takes a candidate's steps.
pub struct Replayer<'a> {
    candidate: &'a Candidate,
    integrator: Option<Box<dyn Integrator>>,
}

impl<'a> Replayer<'a> {
    /// The candidate whose steps it takes.
    pub fn candidate(&self) -> &'a Candidate {
        self.candidate
    }

    /// Advances `state`, which is at step `step`, by `span` steps of `h` seconds. `before` is the
    /// state one step earlier, where it is known.
    ///
    /// # Errors
    /// [`StepError`] as the integrator's; [`StepError::NotFinite`] where a candidate that remembers
    /// has no state before.
    pub fn advance(
        &mut self,
        step: u64,
        span: u64,
        h: f64,
        before: Option<&State>,
        state: &mut State,
    ) -> Result<(), StepError> {
        let n = self.candidate.substeps;
        let part_of_h = h / f64::from(n);
        let inner = part_of_h * self.candidate.stretch;
        let mut previous = before.cloned();
        if self.candidate.remembers && before.is_none() && step > 0 {
            // No particle is to blame for it.
            return Err(StepError::NotFinite { particle: 0 });
        }
        for at in step..step + span {
            for part in 0..n {
                // As solvers count time: n h, not a running sum.
                state.t = (at * u64::from(n) + u64::from(part)) as f64 * part_of_h;
                match (&mut self.integrator, self.candidate.scheme) {
                    (Some(integrator), _) => {
                        advance(integrator.as_mut(), &self.candidate.system, inner, state)?;
                    }
                    (None, Scheme::Map(map)) => {
                        let start = state.clone();
                        map(&self.candidate.system, inner, previous.as_ref(), state)?;
                        previous = Some(start);
                    }
                    (None, Scheme::Method(_)) => {}
                }
            }
        }
        Ok(())
    }
}
