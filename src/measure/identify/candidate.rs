//! A scheme that a trajectory may follow: a method under certain forces, whole or in substeps, or a map
//! that no method of the registry is.

use super::altered::{Around, Rounded};
use crate::integrators::{Integrator, Method, PerStep, Settings, Stable, StepError, fixed};
use crate::physics::{ParticleSystem, State, System};
use std::borrow::Cow;
use std::sync::Arc;

/// Forces that candidates share.
pub type Forces = Arc<dyn System + Send + Sync>;

/// A scheme to replay: known method, composed scheme, known mistake, or a guess at what went wrong.
#[derive(Clone)]
pub struct Candidate {
    /// As reports name it: `rk4`, `in_place(midpoint)`, `gravity_forgotten(rk4)`.
    pub id: String,
    /// Steps it takes inside one timestep.
    pub substeps: u32,
    /// Registry id of the method it is, or was meant to be.
    pub meant: &'static str,
    /// What it does, for people, where its name does not say it all.
    pub says: Option<Cow<'static, str>>,
    /// Whether it is a known mistake.
    pub mistake: bool,
    /// Its step depends on the state one step before: it can be replayed only from the first state
    /// and from states whose predecessor is known.
    pub remembers: bool,
    /// Length of the step it takes, in timesteps: 1, unless h itself is wrong.
    stretch: f64,
    /// The forces it really computes: the scene's, or altered ones.
    forces: Forces,
    scheme: Scheme,
    scaling: Option<Scaling>,
}

/// How a candidate steps.
#[derive(Clone, Copy)]
pub enum Scheme {
    Method(&'static Method),
    /// A map of its own.
    Map(Map),
    /// A step, applied in another way than to all particles at once.
    Around(Around, Step),
}

/// A step that something is built around.
#[derive(Clone, Copy)]
pub enum Step {
    Method(&'static Method),
    Map(Map),
}

/// A one-step map over h from a state in place, given the state one step (of the same h) before it,
/// if that is known.
pub type Map = fn(&dyn System, f64, Option<&State>, &mut State) -> Result<(), StepError>;

/// A factor on velocities, from a rate in 1/s and the length of a step in s.
pub type Factor = fn(f64, f64) -> f64;

/// A multiplication of velocities beside the step proper.
#[derive(Clone)]
pub struct Scaling {
    /// The factor, from the coordinate's `rate` and the length of the step in s.
    pub factor: Factor,
    /// A number of each coordinate: a rate in 1/s, or the factor itself.
    pub rates: Arc<[f64]>,
    pub at: ScaledAt,
}

/// When in a step velocities are multiplied.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ScaledAt {
    Start,
    /// After the kick of symplectic Euler, before its drift.
    Kick,
    End,
}

impl ScaledAt {
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::Start => "before the kick",
            Self::Kick => "after the kick",
            Self::End => "at the end of the step",
        }
    }
}

impl Candidate {
    /// A candidate under these forces, in one step.
    pub fn new(forces: &Forces, scheme: Scheme, meant: &'static str) -> Self {
        Self {
            id: meant.to_owned(),
            substeps: 1,
            meant,
            says: None,
            mistake: false,
            remembers: false,
            stretch: 1.0,
            forces: Arc::clone(forces),
            scheme,
            scaling: None,
        }
    }

    /// A registry method in this many substeps.
    pub fn method(system: &ParticleSystem, method: &'static Method, substeps: u32) -> Self {
        let forces: Forces = Arc::new(system.clone());
        Self::new(&forces, Scheme::Method(method), method.id).in_substeps(substeps)
    }

    /// Every registry method in this many substeps, in the registry's order.
    pub(super) fn plain(system: &ParticleSystem, substeps: u32) -> impl Iterator<Item = Self> {
        let methods = fixed().iter();
        methods.map(move |method| Self::method(system, method, substeps))
    }

    /// The same in this many substeps.
    pub fn in_substeps(self, substeps: u32) -> Self {
        Self { substeps, ..self }
    }

    /// The same under another name.
    pub fn named(self, id: impl Into<String>, says: impl Into<Cow<'static, str>>) -> Self {
        Self {
            id: id.into(),
            says: Some(says.into()),
            ..self
        }
    }

    /// The same, as a known mistake.
    pub fn mistaken(self) -> Self {
        Self {
            mistake: true,
            ..self
        }
    }

    /// The same scheme under other forces.
    pub fn under(&self, system: &ParticleSystem) -> Self {
        Self {
            forces: Arc::new(system.clone()),
            ..self.clone()
        }
    }

    /// The same scheme under another candidate's forces, in its steps.
    pub(super) fn forced_as(&self, other: &Self) -> Self {
        Self {
            forces: Arc::clone(&other.forces),
            stretch: other.stretch,
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

    /// The same with velocities multiplied beside it.
    pub fn scaled(self, scaling: Scaling) -> Self {
        Self {
            scaling: Some(scaling),
            ..self
        }
    }

    /// Marks a map that uses the state one step before.
    pub fn remembering(self, remembers: bool) -> Self {
        Self { remembers, ..self }
    }

    /// The method it applies, if it applies one.
    fn applied(&self) -> Option<&'static Method> {
        match self.scheme {
            Scheme::Method(method) | Scheme::Around(_, Step::Method(method)) => Some(method),
            Scheme::Map(_) | Scheme::Around(_, Step::Map(_)) => None,
        }
    }

    /// About how many roundings of positions or velocities one of its whole steps makes.
    pub fn roundings(&self) -> u32 {
        let stages = match self.applied() {
            // Force, matrix, factors and their solve; iterations before the last are corrected.
            Some(_) if self.solves() => 4,
            Some(method) => match method.evaluations {
                // The force, and what it is added to.
                PerStep::Exactly(n) => 2 * n.max(1),
                PerStep::PerIteration { plus } => 2 * (1 + plus),
            },
            // Taken as many as RK4's: more than any of the maps has.
            None => 8,
        };
        stages.saturating_mul(self.substeps.max(1))
    }

    /// Whether its steps solve linear systems, which costs as much as many that do not.
    pub fn solves(&self) -> bool {
        self.applied().is_some_and(|method| {
            matches!(
                method.oscillator.stable,
                Stable::Always | Stable::AlwaysAlong { .. }
            )
        })
    }

    /// Whether its steps end when a residual is small, not when a formula is through.
    pub fn iterates(&self) -> bool {
        let method = match self.scheme {
            Scheme::Method(method) => method,
            _ => return false,
        };
        matches!(method.evaluations, PerStep::PerIteration { .. })
    }

    /// Its name in the reports' `equivalent`: the id, and after a slash the substeps if there are several.
    pub fn label(&self) -> String {
        label(&self.id, self.substeps)
    }

    /// A replayer that takes its steps. Each thread has its own.
    pub fn replayer(&self, settings: &Settings) -> Replayer<'_> {
        Replayer {
            candidate: self,
            settings: *settings,
            pattern: None,
            integrator: match self.scheme {
                Scheme::Method(method) => Some(method.build(settings)),
                Scheme::Map(_) | Scheme::Around(..) => None,
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
    settings: Settings,
    integrator: Option<Box<dyn Integrator>>,
    pattern: Option<u64>,
}

impl<'a> Replayer<'a> {
    /// The candidate whose steps it takes.
    pub fn candidate(&self) -> &'a Candidate {
        self.candidate
    }

    /// From now on moves every force by its rounding in the direction of a pattern, or by nothing.
    pub(super) fn nudge(&mut self, pattern: Option<u64>) {
        self.pattern = pattern;
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
        let forces = self.candidate.forces.as_ref();
        // Substeps under forces that are held are the scheme's own.
        let n = match self.candidate.scheme {
            Scheme::Around(..) => 1,
            _ => self.candidate.substeps,
        };
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
                let start = state.clone();
                let rounded = self.pattern.map(|pattern| {
                    Rounded::new(
                        forces,
                        pattern,
                        at * u64::from(n) + u64::from(part),
                        self.candidate.solves(),
                    )
                });
                let system: &dyn System = match &rounded {
                    Some(rounded) => rounded,
                    None => forces,
                };
                self.scale(ScaledAt::Start, inner, &start.x, state);
                match (&mut self.integrator, self.candidate.scheme) {
                    (Some(integrator), _) => integrator.step(system, inner, state)?,
                    (None, Scheme::Map(map)) => map(system, inner, previous.as_ref(), state)?,
                    (None, Scheme::Around(around, step)) => {
                        let one = |system: &dyn System, h: f64, state: &mut State| match step {
                            Step::Method(method) => {
                                method.build(&self.settings).step(system, h, state)
                            }
                            Step::Map(map) => map(system, h, None, state),
                        };
                        around(&one, system, inner, self.candidate.substeps, state)?;
                    }
                    (None, Scheme::Method(_)) => {}
                }
                self.scale(ScaledAt::Kick, inner, &start.x, state);
                self.scale(ScaledAt::End, inner, &start.x, state);
                previous = Some(start);
            }
        }
        Ok(())
    }

    /// Multiplies the velocities, if this is when. `x` is where the step began.
    fn scale(&self, at: ScaledAt, h: f64, x: &[f64], state: &mut State) {
        let Some(scaling) = self.candidate.scaling.as_ref().filter(|s| s.at == at) else {
            return;
        };
        for (i, rate) in scaling.rates.iter().enumerate() {
            let factor = (scaling.factor)(*rate, h);
            state.v[i] *= factor;
            if at == ScaledAt::Kick {
                // The drift was h v.
                state.x[i] = x[i] + factor * (state.x[i] - x[i]);
            }
        }
    }
}
