//! Events within a step: impacts, and what leaves, stops or slips, are located on the method's own sub-steps. A step is cut
//! there, and goes on after the event.
//!
//! The time of an event is the root of a gap, or of a force or velocity that changes its sign, as a function of the length
//! of the sub-step that ends there. So every method keeps its order.

mod many;
mod path;
mod pressed;
mod root;

use super::{Integrator, StepError};
use crate::physics::constraints::contact::{Against, Beside, Blows, Change, Held, Near, Obstacles};
use crate::physics::{State, System};
use crate::space::three;
use many::Many;
use path::{Path, meeting};
use root::Due;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Roots are located to this part of a step.
pub const LOCATED: f64 = 1e-12;
/// Where more particles than these have events in one step, the rest of these are found each on its particle's own path.
const MANY: usize = 4;

/// With more particles than these one event located in a step is enough, and none where more than four are in contact: a
/// sub-step costs as much as a step, and an event takes a dozen.
pub const LARGE: usize = 32;

/// What happens to a particle.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Event {
    /// It meets an obstacle, or another particle.
    Impact { particle: usize, against: Against },
    /// Its contact changes.
    Contact { particle: usize, change: Change },
}

impl Event {
    fn particle(&self) -> usize {
        match *self {
            Self::Impact { particle, .. } | Self::Contact { particle, .. } => particle,
        }
    }
}

/// Advances a state by `h` seconds from `state.t`, through all events where there are obstacles; returns the number of
/// impacts.
///
/// # Errors
/// The integrator's, and [`StepError::TooManyEvents`]; the state is then of no use where there are obstacles.
pub fn through(
    integrator: &mut dyn Integrator,
    system: &dyn System,
    h: f64,
    state: &mut State,
) -> Result<u64, StepError> {
    match system.obstacles() {
        Some(obstacles) if !integrator.keeps_contact() => match obstacles.penalty() {
            Some(law) => pressed::step(integrator, system, obstacles, law, h, state),
            None => step(integrator, system, obstacles, h, state),
        },
        _ => integrator.step(system, h, state).map(|()| 0),
    }
}

fn step(
    integrator: &mut dyn Integrator,
    system: &dyn System,
    obstacles: &Obstacles,
    h: f64,
    state: &mut State,
) -> Result<u64, StepError> {
    let mut walk = Walk {
        integrator,
        system,
        obstacles,
        h,
        impacts: 0,
        involved: BTreeSet::new(),
        near: obstacles.near_now(state),
    };
    let advance = |left: f64, located: usize, state: &mut State| walk.advance(left, located, state);
    root::cut(h, MANY, state, advance)?;
    Ok(walk.impacts)
}

/// The most particles whose events are located on sub-steps, where so many contacts are closed.
fn most_located(obstacles: &Obstacles, closed: usize) -> usize {
    match (obstacles.particles().count() > LARGE, closed > MANY) {
        (false, _) => MANY,
        (true, false) => 1,
        (true, true) => 0,
    }
}

struct Walk<'a> {
    integrator: &'a mut dyn Integrator,
    system: &'a dyn System,
    obstacles: &'a Obstacles,
    /// The whole step, s.
    h: f64,
    impacts: u64,
    /// The particles with events so far.
    involved: BTreeSet<usize>,
    /// What may touch where particles are now.
    near: Arc<Near>,
}

impl Walk<'_> {
    /// What touches, after the impacts that are due at once.
    fn settled(&mut self, state: &mut State) -> Result<Vec<Beside>, StepError> {
        let touching = self.obstacles.touching(&self.near, state);
        let due = touching.iter().filter(|beside| beside.strikes());
        let due: BTreeSet<usize> = due.map(|beside| beside.particle).collect();
        if due.is_empty() {
            return Ok(touching);
        }
        self.strike(due, state)?;
        Ok(self.obstacles.touching(&self.near, state))
    }

    /// The impacts of these particles, after which what would come back at once stays.
    fn strike(&mut self, due: BTreeSet<usize>, state: &mut State) -> Result<(), StepError> {
        if due.is_empty() {
            return Ok(());
        }
        let (obstacles, rods) = (self.obstacles, self.system.rods());
        let mut struck = due.clone();
        let blows = Blows {
            near: &self.near,
            rods,
            among: true,
            lands: false,
        };
        let more = obstacles.strike(&blows, due, state)?;
        self.impacts += more.impulses;
        struck.extend(more.particles);
        obstacles.push_out(&self.near, &mut struck, state);
        // What has come to rest holds up what lies on it.
        while self.rest(&struck, state)? {}
        Ok(())
    }

    /// Takes the normal velocities of these particles away where they would part for less than is seen. Returns whether
    /// that changes what they press.
    fn rest(&self, particles: &BTreeSet<usize>, state: &mut State) -> Result<bool, StepError> {
        let (obstacles, rods) = (self.obstacles, self.system.rods());
        let mut a = Vec::new();
        let mut changed = false;
        for particle in particles {
            for beside in obstacles.touched(&self.near, *particle, state) {
                let beside = obstacles.beside(beside.particle, beside.against, state);
                let parting = beside.parting();
                if parting < beside.slow {
                    obstacles.rest(rods, &beside, state)?;
                    continue;
                }
                if a.is_empty() {
                    a = self.acceleration(state)?;
                }
                // It would rise by less than is seen.
                let down = -obstacles.opening(&beside, state.t, &a);
                let high = parting * parting / (2.0 * down);
                if down > 0.0 && high < obstacles.lowest(&beside) {
                    obstacles.rest(rods, &beside, state)?;
                    changed |= obstacles.among_particles();
                }
            }
        }
        Ok(changed)
    }

    /// With the forces of what stays where particles press each other.
    fn acceleration(&self, state: &State) -> Result<Vec<f64>, StepError> {
        if self.obstacles.among_particles() || self.system.rods().is_some() {
            let touching = self.obstacles.touching(&self.near, state);
            let taken = self.integrator.takes();
            let (system, obstacles) = (self.system, self.obstacles);
            if let Some(held) = Held::at(system, obstacles, &touching, state, taken)? {
                return Ok(held.whole(state));
            }
        }
        let mut a = vec![0.0; state.x.len()];
        self.system
            .acceleration(state.t, &state.x, &state.v, &mut a);
        Ok(a)
    }

    /// One sub-step of at most `left` seconds, to the next event, if no more particles than `located` have some. Returns its
    /// length.
    fn advance(&mut self, left: f64, located: usize, state: &mut State) -> Result<f64, StepError> {
        let touching = self.settled(state)?;
        let start = state.clone();
        let (system, obstacles) = (self.system, self.obstacles);
        let located = located.min(most_located(obstacles, touching.len()));
        let taken = self.integrator.takes();
        let held = Held::at(system, obstacles, &touching, &start, taken)?;
        let held = held.as_ref();
        let mut end = self.sub_step(held, left, &start)?;
        self.near = path::near(obstacles, left, &start, &end);
        // Where nothing is located what leaves and slips does so with the next step.
        let a = held.filter(|held| located > 0 || held.books());
        let a = a.map(|held| held.free_at_end(&end));
        let mut due = Self::changes(held, left, &end, a.as_deref());
        due.extend(self.impacts(held, left, &start, &end));
        self.involved
            .extend(due.iter().map(|due| due.event.particle()));
        let first = if self.involved.len() > located {
            None
        } else {
            let sign = |due: &Due<Event>, state: &State| sign(obstacles, held, due, state);
            let within = [left, self.h];
            let to = |h| self.sub_step(held, h, &start);
            root::first(&mut due, within, &start, sign, to)?
        };
        let Some((time, at, event)) = first else {
            // Those of many particles, and those that were not found on sub-steps.
            if let (Some(held), Some(a)) = (held, &a) {
                held.book(left, &start, &mut end, a);
            }
            *state = end;
            self.take_many(held, due, left, &start, state)?;
            return Ok(left);
        };
        *state = at;
        if let Some(held) = held {
            let a = held.free(state);
            held.book(time, &start, state, &a);
        }
        match event {
            Event::Impact { particle, .. } => self.strike([particle].into(), state)?,
            Event::Contact { particle, change } => {
                if let (Some(held), Change::Stops) = (held, change) {
                    held.stop(particle, state);
                }
            }
        }
        Ok(time)
    }

    /// The state after a sub-step of `h` seconds, without the work of friction and of moving obstacles.
    fn sub_step(&mut self, held: Option<&Held>, h: f64, start: &State) -> Result<State, StepError> {
        let Some(held) = held else {
            let mut end = start.clone();
            self.integrator.step(self.system, h, &mut end)?;
            let end_time = start.t + h;
            self.system.place(end_time, &mut end.x, &mut end.v);
            return Ok(end);
        };
        let mut begin = start.clone();
        held.slow_down(0.5 * h, &mut begin);
        let mut own = held.inward(begin);
        // Its forces are those of these contacts, and of no step before or after.
        self.integrator.forget();
        self.integrator.step(held, h, &mut own)?;
        self.integrator.forget();
        held.place(start.t + h, &mut own.x, &mut own.v);
        let mut end = held.outward(own);
        held.slow_down(0.5 * h, &mut end);
        Ok(end)
    }

    /// What has changed in contacts at the end of a sub-step.
    fn changes(held: Option<&Held>, h: f64, end: &State, a: Option<&[f64]>) -> Vec<Due<Event>> {
        let changes = held.map(|held| held.changes(end, a));
        let changes = changes.unwrap_or_default();
        let due = changes.into_iter().filter(|(.., by)| *by > 0.0);
        due.map(|(particle, change, _)| Due {
            event: Event::Contact { particle, change },
            clear: 0.0,
            due: h,
            level: 0.0,
        })
        .collect()
    }

    /// The impacts of particles that do not stay in contact, on the cubic through both ends of their paths.
    fn impacts(&self, held: Option<&Held>, h: f64, start: &State, end: &State) -> Vec<Due<Event>> {
        let free = self.near.pairs().filter(|(particle, against)| {
            !held.is_some_and(|held| held.holds(*particle, *against))
        });
        let path = |one: usize| Path::new(one, h, start, end);
        let meets = |pair: (usize, Against)| {
            let due = meeting(self.obstacles, pair, (0.0, 1.0), [start.t, h], path)?;
            let (particle, against) = pair;
            Some(due.of(Event::Impact { particle, against }))
        };
        let mut found: Vec<Due<Event>> = free.filter_map(meets).collect();
        found.sort_by(|a, b| a.due.total_cmp(&b.due));
        found
    }

    /// Many events in one step: impacts along the paths of their particles; what has stopped is at rest at the end, and
    /// what leaves or slips does so from there on.
    fn take_many(
        &mut self,
        held: Option<&Held>,
        due: Vec<Due<Event>>,
        h: f64,
        start: &State,
        end: &mut State,
    ) -> Result<(), StepError> {
        let mut met = Vec::new();
        for due in due {
            match (due.event, held) {
                (Event::Impact { particle, against }, _) => met.push(due.of((particle, against))),
                (
                    Event::Contact {
                        particle,
                        change: Change::Stops,
                    },
                    Some(held),
                ) => {
                    held.stop(particle, end);
                }
                _ => {}
            }
        }
        if met.is_empty() {
            return Ok(());
        }
        let mut many = Many {
            system: self.system,
            obstacles: self.obstacles,
            held,
            near: Arc::clone(&self.near),
            h,
            start,
        };
        self.impacts += many.strike(met, end)?;
        self.near = many.near;
        Ok(())
    }
}

/// Positive before an event, negative after it.
fn sign(obstacles: &Obstacles, held: Option<&Held>, due: &Due<Event>, state: &State) -> f64 {
    match due.event {
        Event::Impact { particle, against } => {
            let at = |particle| three(&state.x, particle);
            obstacles.gap(particle, against, state.t, at) - due.level
        }
        Event::Contact { particle, change } => {
            let changes = held.map(|held| held.changes(state, Some(&held.free(state))));
            let changes = changes.unwrap_or_default();
            let own = changes.iter().filter(|c| c.0 == particle && c.1 == change);
            -own.map(|c| c.2).fold(f64::NEG_INFINITY, f64::max)
        }
    }
}
