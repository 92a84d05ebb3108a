//! Takes the steps of a candidate, one after the other.

use super::super::altered::{Altered, Altering};
use super::super::bounce::{Bounce, Touching};
use super::super::keeping::{Keeping, Kept, keep};
use super::{Candidate, ScaledAt};
use crate::integrators::{Integrator, RapierContact, Remembered, Settings, StepError, events};
use crate::physics::constraints::limit;
use crate::physics::{State, System};
use crate::scene::Stabilisation;

/// Sweeps of a soft step, most of which nothing is left for, and those after the drift.
const SWEEPS: [u32; 2] = [64, 1];

/// Takes a candidate's steps.
pub struct Replayer<'a> {
    candidate: &'a Candidate,
    settings: Settings,
    /// The integrator of steps that do not depend on those before.
    kept: Option<Box<dyn Integrator>>,
    /// The integrator of soft steps, and what the next of them begins with.
    soft: Option<RapierContact>,
    recalled: Vec<Remembered>,
    pattern: Option<u64>,
    /// Whether it passes through obstacles.
    passes: bool,
    /// What counts as inside, beside its step.
    touching: Touching,
}

impl<'a> Replayer<'a> {
    /// The candidate whose steps it takes.
    pub fn candidate(&self) -> &'a Candidate {
        self.candidate
    }

    /// From now on moves every force by its rounding in the direction of a pattern, or by nothing.
    pub(in super::super) fn nudge(&mut self, pattern: Option<u64>) {
        self.pattern = pattern;
    }

    /// Begins what is advanced next with what a step before it has kept.
    pub(in super::super) fn recall(&mut self, kept: &[Remembered]) {
        self.recalled.clear();
        self.recalled.extend_from_slice(kept);
    }

    /// What the last step keeps.
    pub(in super::super) fn kept(&self) -> &[Remembered] {
        self.soft.as_ref().map_or(&[], RapierContact::kept)
    }

    /// Does something in the other ways that rounding may decide where something touches: without the impact of a located
    /// one, else with what touches inside or not.
    pub(in super::super) fn otherwise<T>(
        &mut self,
        mut what: impl FnMut(&mut Self) -> T,
    ) -> Vec<T> {
        if self.candidate.bounce.is_none() {
            self.passes = true;
            let done = what(self);
            self.passes = false;
            return vec![done];
        }
        let mut with = |touching| {
            self.touching = touching;
            let done = what(self);
            self.touching = Touching::Exactly;
            done
        };
        vec![with(Touching::Inside), with(Touching::Near)]
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
        let candidate = self.candidate;
        // Substeps of a step that is applied in another way are the way's own, as those of a soft step are.
        let n = if candidate.around.is_some() || self.soft.is_some() {
            1
        } else {
            candidate.substeps
        };
        if let Some(soft) = &mut self.soft {
            soft.recall(&std::mem::take(&mut self.recalled), state);
            soft.closes_at(match self.touching {
                Touching::Inside => -1.0,
                Touching::Exactly => 0.0,
                Touching::Near => 1.0,
            });
        }
        let part_of_h = h / f64::from(n);
        let inner = part_of_h * candidate.stretch;
        let mut previous = before.cloned();
        if candidate.remembers() && before.is_none() && step > 0 {
            // No particle is to blame for it.
            return Err(StepError::NotFinite { particle: 0 });
        }
        for part in step * u64::from(n)..(step + span) * u64::from(n) {
            // As solvers count time: n h, not a running sum.
            state.t = part as f64 * part_of_h;
            let start = state.clone();
            let forces = candidate.forces.as_ref();
            let rounded = self.pattern.map(|pattern| {
                Altered::new(forces, Altering::rounded(pattern, part, candidate.solves()))
            });
            let system = rounded
                .as_ref()
                .map_or(forces as &dyn System, |rounded| rounded);
            candidate.scale(ScaledAt::Start, inner, &start.x, state);
            let first = candidate.first.as_deref().filter(|_| previous.is_none());
            let step = first.unwrap_or(&candidate.step);
            let before = previous.as_ref();
            let fresh = |before| step.build(&self.settings, before);
            let beside = candidate.beside(system);
            let passes = self.passes || beside.is_some();
            let taken = |by: &mut dyn Integrator, f: &dyn System, h, s: &mut State| match passes {
                true => by.step(f, h, s),
                false => events::through(by, f, h, s).map(|_| ()),
            };
            let mut free = |h: f64, state: &mut State| {
                let x = candidate.scaling.is_some().then(|| state.x.clone());
                match (&mut self.soft, candidate.around, &mut self.kept) {
                    (Some(soft), ..) => taken(soft, system, h, state)?,
                    (None, Some(around), _) => {
                        let one =
                            |f: &dyn System, h, s: &mut State| taken(fresh(None).as_mut(), f, h, s);
                        around(&one, system, h, candidate.substeps, state)?;
                    }
                    (None, None, Some(kept)) => taken(kept.as_mut(), system, h, state)?,
                    (None, None, None) => taken(fresh(before).as_mut(), system, h, state)?,
                }
                if let Some(x) = x {
                    candidate.scale(ScaledAt::Kick, h, &x, state);
                    candidate.scale(ScaledAt::End, h, &x, state);
                }
                Ok(())
            };
            match beside {
                Some((bounce, obstacles)) => {
                    let bounce = Bounce {
                        touching: self.touching,
                        ..*bounce
                    };
                    bounce.step(obstacles, inner, state, &mut free)?;
                }
                None => free(inner, state)?,
            }
            state.t = (part + 1) as f64 * part_of_h;
            system.place(state.t, &mut state.x, &mut state.v);
            self.keep(inner, part, &start, state)?;
            if let Some(limiter) = system.strain_limiter() {
                limit(system, limiter, state)?;
            }
            previous = Some(start);
        }
        Ok(())
    }

    /// Moves a state onto rods after a step of `h` seconds from `start`, as the candidate does.
    fn keep(&self, h: f64, part: u64, start: &State, state: &mut State) -> Result<(), StepError> {
        let candidate = self.candidate;
        let nudge = self.pattern.map(|pattern| (!part, pattern));
        match (&candidate.keeping, candidate.forces.rods()) {
            (Some(Keeping::By(kept, rods)), _) => keep(rods, *kept, h, start, state, nudge),
            (_, Some(rods)) if rods.stabilisation() == Stabilisation::Project => {
                if candidate.keeps_rods() {
                    return Ok(());
                }
                keep(rods, Kept::PROJECTED, h, start, state, nudge)
            }
            _ => Ok(()),
        }
    }

    /// Takes the velocity along rods out of a state whose velocities the candidate has without it.
    pub(in super::super) fn still(&self, state: &mut State) -> Result<(), StepError> {
        let candidate = self.candidate;
        let rods = match (&candidate.keeping, candidate.forces.rods()) {
            (Some(Keeping::By(kept, rods)), _) if kept.stills() => rods.as_ref(),
            (Some(Keeping::By(..)), _) => return Ok(()),
            (_, Some(rods)) if candidate.ends_still(rods.stabilisation()) => rods,
            _ => return Ok(()),
        };
        Ok(rods.still(&state.x, &mut state.v)?)
    }
}

impl Candidate {
    /// A replayer that takes its steps. Each thread has its own.
    pub fn replayer(&self, settings: &Settings) -> Replayer<'_> {
        let kept = self.around.is_none() && !self.remembers();
        let [sweeps, relaxing] = SWEEPS;
        let soft = || RapierContact::new(self.substeps, sweeps, relaxing);
        Replayer {
            candidate: self,
            settings: *settings,
            kept: kept.then(|| self.step.build(settings, None)),
            soft: self.is_soft().then(soft),
            recalled: Vec::new(),
            pattern: None,
            passes: false,
            touching: Touching::Exactly,
        }
    }
}
