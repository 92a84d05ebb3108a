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
use path::{Path, crossing};
use root::Bracket;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Roots are located to this part of a step.
pub const LOCATED: f64 = 1e-12;
/// Cuts of no length after which no further event of a step is located.
const IDLE: u32 = 16;
/// The most cuts in a step.
const CUTS: usize = 2_000;
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

/// An event due within a sub-step: none at `clear`, and due at `due`, both in seconds from the start of the sub-step.
#[derive(Debug, Clone, Copy)]
struct Due {
    event: Event,
    clear: f64,
    due: f64,
    /// The gap at which an impact is due, m: 0, or the rounding of one for a particle that has not risen above that.
    level: f64,
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
    let begin = state.t;
    let mut walk = Walk {
        integrator,
        system,
        obstacles,
        h,
        impacts: 0,
        most: most_located(obstacles),
        involved: BTreeSet::new(),
        near: obstacles.near([state.t; 2], |particle| (three(&state.x, particle), 0.0)),
    };
    walk.settle(state)?;
    let mut done = 0.0;
    let mut idle = 0;
    for _ in 0..CUTS {
        let left = h - done;
        let taken = walk.advance(left, state)?;
        done += taken;
        idle += u32::from(taken <= LOCATED * h);
        if idle > IDLE {
            walk.most = 0;
        }
        state.t = begin + done;
        if taken >= left {
            return Ok(walk.impacts);
        }
    }
    Err(StepError::TooManyEvents { t: state.t })
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
    /// The most particles whose events are located on sub-steps.
    most: usize,
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
        let impacts = obstacles.strike(&self.near, rods, due, state)?;
        self.impacts += impacts.1;
        struck.extend(impacts.0);
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
            if let Some(held) = self.held(&touching, state)? {
                return Ok(held.whole(state));
            }
        }
        let mut a = vec![0.0; state.x.len()];
        self.system
            .acceleration(state.t, &state.x, &state.v, &mut a);
        Ok(a)
    }

    fn held(&self, touching: &[Beside], state: &State) -> Result<Option<Held<'_>>, StepError> {
        let taken = self.integrator.takes();
        Ok(Held::at(
            self.system,
            self.obstacles,
            touching,
            state,
            taken,
        )?)
    }

    /// One sub-step of at most `left` seconds, to the next event. Returns its length.
    fn advance(&mut self, left: f64, state: &mut State) -> Result<f64, StepError> {
        let start = state.clone();
        let (system, obstacles) = (self.system, self.obstacles);
        let touching = obstacles.touching(&self.near, &start);
        let taken = self.integrator.takes();
        let held = Held::at(system, obstacles, &touching, &start, taken)?;
        let held = held.as_ref();
        self.integrator.forget();
        let mut end = self.sub_step(held, left, &start)?;
        self.near = obstacles.near([start.t, start.t + left], |particle| {
            Path::new(particle, left, &start, &end).ball()
        });
        let a = held.map(|held| held.free(&end));
        let mut due = Self::changes(held, left, &end, a.as_deref());
        due.extend(self.impacts(held, left, &start, &end));
        self.involved
            .extend(due.iter().map(|due| due.event.particle()));
        let first = if self.involved.len() > self.most {
            None
        } else {
            self.first(held, &mut due, left, &start)?
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

    /// The first of these events within `left` seconds, its time and the state there; None where none is found.
    fn first(
        &mut self,
        held: Option<&Held>,
        all: &mut [Due],
        left: f64,
        start: &State,
    ) -> Result<Option<(f64, State, Event)>, StepError> {
        all.sort_by(|a, b| a.due.total_cmp(&b.due));
        let mut first: Option<(f64, State, Event)> = None;
        for due in all {
            let mut due = *due;
            // What is not due where another event was found comes later.
            if let Some((time, at, _)) = &first {
                if due.clear >= *time || sign(self.obstacles, held, &due, at) >= 0.0 {
                    continue;
                }
                due.due = due.due.min(*time);
            }
            if let Some((time, at)) = self.locate(held, &due, left, start)?
                && first.as_ref().is_none_or(|(bound, ..)| time < *bound)
            {
                first = Some((time, at, due.event));
            }
        }
        Ok(first)
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
    fn changes(held: Option<&Held>, h: f64, end: &State, a: Option<&[f64]>) -> Vec<Due> {
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
    fn impacts(&self, held: Option<&Held>, h: f64, start: &State, end: &State) -> Vec<Due> {
        let mut found = Vec::new();
        for (particle, against) in self.near.pairs() {
            if held.is_some_and(|held| held.holds(particle, against)) {
                continue;
            }
            let path = |particle| Path::new(particle, h, start, end);
            let (own, other) = (
                path(particle),
                match against {
                    Against::Particle(other) => Some((other, path(other))),
                    Against::Obstacle(_) => None,
                },
            );
            let gap = |s: f64| {
                let at = |which: usize| match &other {
                    Some((other, path)) if *other == which => path.at(s),
                    _ => own.at(s),
                };
                self.obstacles.gap(particle, against, start.t + s * h, at)
            };
            let reach = self.obstacles.reach(against, start.t, start.t + h);
            let others = other.as_ref().map_or(0.0, |(_, path)| path.length());
            let bound = own.length() + reach + others;
            let last = gap(1.0);
            if last > bound {
                continue;
            }
            let close = self.obstacles.close(own.at(0.0));
            if let Some(([clear, due], level)) = crossing(gap, bound, close) {
                found.push(Due {
                    event: Event::Impact { particle, against },
                    clear: clear * h,
                    due: due * h,
                    level,
                });
            }
        }
        found.sort_by(|a, b| a.due.total_cmp(&b.due));
        found
    }

    /// The time of an event and the state there, on sub-steps of at most `left` seconds from the start; None where it does
    /// not happen on them.
    fn locate(
        &mut self,
        held: Option<&Held>,
        due: &Due,
        left: f64,
        start: &State,
    ) -> Result<Option<(f64, State)>, StepError> {
        let bracket = Bracket {
            clear: due.clear,
            due: due.due,
            left,
            h: self.h,
        };
        let obstacles = self.obstacles;
        let sign = |state: &State| sign(obstacles, held, due, state);
        root::locate(&bracket, start, sign, |h| self.sub_step(held, h, start))
    }

    /// Many events in one step: each impact at its own time on its particle's path, which the change of velocity bends from
    /// there on; what has stopped is at rest at the end, and what leaves or slips does so from there on. Of second order
    /// for a bounded number of impacts.
    fn each_on_its_path(
        &mut self,
        held: Option<&Held>,
        due: &[Due],
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
                    let range = 3 * particle..3 * particle + 3;
                    there.x[range.clone()].copy_from_slice(&path.at(s));
                    there.v[range].copy_from_slice(&path.velocity(s));
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
                Against::Obstacle(_) => self
                    .obstacles
                    .strike_obstacles(&self.near, rods, particle, &mut there)?,
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
fn sign(obstacles: &Obstacles, held: Option<&Held>, due: &Due, state: &State) -> f64 {
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

fn three(all: &[f64], particle: usize) -> [f64; 3] {
    [0, 1, 2].map(|axis| all[3 * particle + axis])
}
