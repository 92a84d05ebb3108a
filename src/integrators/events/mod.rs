//! Events within a step: impacts, and what leaves, stops or slips, are located on the method's own sub-steps. A step is cut
//! there, and goes on after the event.
//!
//! The time of an event is the root of a gap, or of a force or velocity that changes its sign, as a function of the length
//! of the sub-step that ends there. So every method keeps its order.

mod path;
mod pressed;
mod root;

use super::{Integrator, StepError};
use crate::physics::constraints::contact::{Against, Beside, Change, Held, Near, Obstacles};
use crate::physics::{State, System};
use crate::space::three;
use path::{Path, meeting};
use root::Due;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Roots are located to this part of a step.
pub const LOCATED: f64 = 1e-12;
/// Where more particles than these have events in one step, the rest of these are found each on its particle's own path.
const MANY: usize = 4;

/// With more particles than these one is enough: a sub-step costs as much as a step, and an event takes a dozen.
const LARGE: usize = 32;

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
    walk.settle(state)?;
    let advance = |left: f64, located: usize, state: &mut State| walk.advance(left, located, state);
    root::cut(h, most_located(obstacles), state, advance)?;
    Ok(walk.impacts)
}

/// The most particles whose events are located on sub-steps.
fn most_located(obstacles: &Obstacles) -> usize {
    if obstacles.particles().count() > LARGE {
        1
    } else {
        MANY
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
    /// Impacts that are due at once.
    fn settle(&mut self, state: &mut State) -> Result<(), StepError> {
        let touching = self.obstacles.touching(&self.near, state).into_iter();
        let due = touching
            .filter(Beside::strikes)
            .map(|beside| beside.particle);
        self.strike(due.collect(), state)
    }

    /// The impacts of these particles, after which what would come back at once stays.
    fn strike(&mut self, due: BTreeSet<usize>, state: &mut State) -> Result<(), StepError> {
        if due.is_empty() {
            return Ok(());
        }
        let (obstacles, rods) = (self.obstacles, self.system.rods());
        let mut struck = due.clone();
        let (more, impulses) = obstacles.strike(&self.near, rods, (due, true), state)?;
        self.impacts += impulses;
        struck.extend(more);
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
                if a.is_empty() {
                    a = self.acceleration(state)?;
                }
                // It would rise by less than is seen.
                let down = -obstacles.opening(&beside, state.t, &a);
                let high = parting * parting / (2.0 * down);
                if parting < beside.slow || (down > 0.0 && high < obstacles.lowest(&beside)) {
                    obstacles.rest(rods, &beside, state)?;
                    changed |= parting > beside.slow && obstacles.among_particles();
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
        let start = state.clone();
        let (system, obstacles) = (self.system, self.obstacles);
        let touching = obstacles.touching(&self.near, &start);
        let taken = self.integrator.takes();
        let held = Held::at(system, obstacles, &touching, &start, taken)?;
        let held = held.as_ref();
        self.integrator.forget();
        let mut end = self.sub_step(held, left, &start)?;
        self.near = path::near(obstacles, left, &start, &end);
        let a = held.map(|held| held.free(&end));
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
            self.each_on_its_path(held, &due, left, &start, state)?;
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
        let mut own = held.inward(&begin);
        self.integrator.step(held, h, &mut own)?;
        held.place(start.t + h, &mut own.x, &mut own.v);
        let mut end = held.outward(&own);
        held.slow_down(0.5 * h, &mut end);
        Ok(end)
    }

    /// What has changed in contacts at the end of a sub-step.
    fn changes(held: Option<&Held>, h: f64, end: &State, a: Option<&[f64]>) -> Vec<Due<Event>> {
        let changes = held.zip(a).map(|(held, a)| held.changes(end, a));
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
        let meets = |(particle, against): (usize, Against)| {
            let event = Event::Impact { particle, against };
            meeting(
                self.obstacles,
                (particle, against),
                (event, 1.0),
                h,
                [start, end],
            )
        };
        let mut found: Vec<Due<Event>> = free.filter_map(meets).collect();
        found.sort_by(|a, b| a.due.total_cmp(&b.due));
        found
    }

    /// Many events in one step: each impact at its own time on its particle's path, which the change of velocity bends from
    /// there on; what has stopped is at rest at the end, and what leaves or slips does so from there on. Of second order
    /// for a bounded number of impacts.
    fn each_on_its_path(
        &mut self,
        held: Option<&Held>,
        due: &[Due<Event>],
        h: f64,
        start: &State,
        end: &mut State,
    ) -> Result<(), StepError> {
        let before = end.clone();
        let mut there = before.clone();
        let rods = self.system.rods();
        for due in due {
            let (particle, against) = match due.event {
                Event::Contact { particle, change } => {
                    if let (Some(held), Change::Stops) = (held, change) {
                        held.stop(particle, end);
                    }
                    continue;
                }
                Event::Impact { particle, against } => (particle, against),
            };
            let ends = against.with(particle);
            let paths = ends
                .iter()
                .map(|end| (*end, Path::new(*end, h, start, &before)));
            let paths: Vec<(usize, Path)> = paths.collect();
            let move_to = |s: f64, there: &mut State| {
                there.t = start.t + s * h;
                for (particle, path) in &paths {
                    path.put(*particle, s, there);
                }
            };
            let (mut low, mut high) = (due.clear / h, due.due / h);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                move_to(middle, &mut there);
                if self.obstacles.beside(particle, against, &there).gap < 0.0 {
                    high = middle;
                } else {
                    low = middle;
                }
            }
            move_to(high, &mut there);
            let old: Vec<_> = ends.iter().map(|end| three(&there.v, *end)).collect();
            // Of its own place alone is it known when it is there.
            let work = std::mem::replace(&mut there.work, end.work);
            let impacts = match against {
                Against::Obstacle(_) => {
                    let alone = ([particle].into(), false);
                    self.obstacles
                        .strike(&self.near, rods, alone, &mut there)?
                        .1
                }
                Against::Particle(_) => {
                    let beside = self.obstacles.beside(particle, against, &there);
                    u64::from(self.obstacles.apply(rods, &beside, &mut there)?)
                }
            };
            self.impacts += impacts;
            end.work = std::mem::replace(&mut there.work, work);
            // Rods pass impulses on to all.
            let moved: Vec<usize> = match rods {
                Some(_) => (0..end.v.len() / 3).collect(),
                None => ends.clone(),
            };
            for moved in moved {
                let at = ends.iter().position(|end| *end == moved);
                let old = at.map_or_else(|| three(&before.v, moved), |at| old[at]);
                for (axis, old) in old.into_iter().enumerate() {
                    let place = 3 * moved + axis;
                    let change = there.v[place] - old;
                    end.v[place] += change;
                    end.x[place] += change * (1.0 - high) * h;
                    (there.x[place], there.v[place]) = (before.x[place], before.v[place]);
                }
            }
        }
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
            let changes = held.map(|held| held.changes(state, &held.free(state)));
            let changes = changes.unwrap_or_default();
            let own = changes.iter().filter(|c| c.0 == particle && c.1 == change);
            -own.map(|c| c.2).fold(f64::NEG_INFINITY, f64::max)
        }
    }
}
