//! Events within a step: impacts, and what leaves, stops or slips, are located on the method's own sub-steps. A step is cut
//! there, and goes on after the event.
//!
//! The time of an event is the root of a gap, or of a force or velocity that changes its sign, as a function of the length
//! of the sub-step that ends there. So every method keeps its order.

mod path;

use super::{Integrator, StepError};
use crate::physics::constraints::contact::{Change, Held, Obstacles};
use crate::physics::{State, System};
use path::{Path, crossing};
use std::collections::BTreeSet;

/// Roots are located to this part of a step.
pub const LOCATED: f64 = 1e-12;
/// Halvings after which an event is not located but counts as one of the end.
const HALVES: u32 = 40;
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
    /// It meets an obstacle.
    Impact { particle: usize, obstacle: usize },
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
        Some(obstacles) => step(integrator, system, obstacles, h, state),
        None => integrator.step(system, h, state).map(|()| 0),
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
        most: if obstacles.particles().count() > LARGE {
            1
        } else {
            MANY
        },
        involved: BTreeSet::new(),
    };
    walk.settle(state);
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
}

impl Walk<'_> {
    /// Impacts that are due at once.
    fn settle(&mut self, state: &mut State) {
        let touching = self.obstacles.touching(state);
        let mut last = usize::MAX;
        for beside in touching.iter().filter(|beside| beside.strikes()) {
            if beside.particle != last {
                self.strike(beside.particle, state);
                last = beside.particle;
            }
        }
    }

    /// An impact, after which a particle that would come back at once stays.
    fn strike(&mut self, particle: usize, state: &mut State) {
        self.impacts += u64::from(self.obstacles.strike(particle, state));
        let mut a = Vec::new();
        for obstacle in 0..self.obstacles.len() {
            let beside = self.obstacles.beside(particle, obstacle, state);
            let parting = beside.parting();
            if !beside.touches() {
                continue;
            }
            if beside.gap < -beside.close {
                self.obstacles.push_out(&beside, state);
            }
            if a.is_empty() {
                a = vec![0.0; state.x.len()];
                self.system
                    .acceleration(state.t, &state.x, &state.v, &mut a);
            }
            // It would rise by less than is seen.
            let down = -self.obstacles.opening(&beside, state.t, &a);
            let high = parting * parting / (2.0 * down);
            if parting < beside.slow || (down > 0.0 && high < self.obstacles.lowest()) {
                self.obstacles.rest(&beside, state);
            }
        }
    }

    /// One sub-step of at most `left` seconds, to the next event. Returns its length.
    fn advance(&mut self, left: f64, state: &mut State) -> Result<f64, StepError> {
        let start = state.clone();
        let held = Held::at(self.system, self.obstacles, &start, self.integrator.takes());
        let held = held.as_ref();
        self.integrator.forget();
        let mut end = self.sub_step(held, left, &start)?;
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
            self.each_on_its_path(held, &due, left, &start, state);
            return Ok(left);
        };
        *state = at;
        if let Some(held) = held {
            let a = held.free(state);
            held.book(time, &start, state, &a);
        }
        match event {
            Event::Impact { particle, .. } => self.strike(particle, state),
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
        for obstacle in 0..self.obstacles.len() {
            let reach = self.obstacles.reach(obstacle, start.t, start.t + h);
            for particle in self.obstacles.particles() {
                if held.is_some_and(|held| held.holds(particle, obstacle)) {
                    continue;
                }
                let path = Path::new(particle, h, start, end);
                let gap = |s: f64| {
                    self.obstacles
                        .gap(particle, obstacle, start.t + s * h, path.at(s))
                };
                let bound = path.length() + reach;
                let last = gap(1.0);
                if last > bound {
                    continue;
                }
                let close = self.obstacles.close(path.at(0.0));
                if let Some(([clear, due], level)) = crossing(gap, bound, close) {
                    found.push(Due {
                        event: Event::Impact { particle, obstacle },
                        clear: clear * h,
                        due: due * h,
                        level,
                    });
                }
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
        let obstacles = self.obstacles;
        let sign = |state: &State| sign(obstacles, held, due, state);
        let mut high = due.due;
        let mut below = sign(&self.sub_step(held, high, start)?);
        // The cubic and the method's own path differ.
        for part in 1..=8 {
            if below < 0.0 || high >= left {
                break;
            }
            high = due.due + (left - due.due) * f64::from(part) / 8.0;
            below = sign(&self.sub_step(held, high, start)?);
        }
        if below >= 0.0 {
            return Ok(None);
        }
        let mut low = due.clear;
        let mut above = if low > 0.0 {
            sign(&self.sub_step(held, low, start)?)
        } else {
            sign(start)
        };
        // Just after a bounce the gap is 0, and grows; so does the speed of what begins to slide.
        for halves in 0.. {
            if above > 0.0 {
                break;
            }
            if halves > HALVES {
                return Ok(None);
            }
            low = if halves == 0 { 0.5 * high } else { 0.5 * low };
            above = sign(&self.sub_step(held, low, start)?);
            if above < 0.0 {
                (high, below) = (low, above);
            }
        }
        let tolerance = LOCATED * self.h;
        let mut found = None;
        let mut side = 0;
        for _ in 0..200 {
            if high - low <= tolerance {
                break;
            }
            // Regula falsi, which halves the value of an end that stays (Dowell, Jarratt 1971); else bisection.
            let mut next = (low * below - high * above) / (below - above);
            let inside = next > low && next < high;
            if !inside || !next.is_finite() {
                next = 0.5 * (low + high);
            }
            let at = self.sub_step(held, next, start)?;
            let value = sign(&at);
            if value == 0.0 {
                return Ok(Some((next, at)));
            }
            if value < 0.0 {
                if side == -1 {
                    above *= 0.5;
                }
                (high, below, side) = (next, value, -1);
                found = Some(at);
            } else {
                if side == 1 {
                    below *= 0.5;
                }
                (low, above, side) = (next, value, 1);
            }
        }
        let at = match found {
            Some(at) if at.t == start.t + high => at,
            _ => self.sub_step(held, high, start)?,
        };
        Ok(Some((high, at)))
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
    ) {
        let before = end.clone();
        for due in due {
            match due.event {
                Event::Contact { particle, change } => {
                    if let (Some(held), Change::Stops) = (held, change) {
                        held.stop(particle, end);
                    }
                }
                Event::Impact { particle, obstacle } => {
                    let path = Path::new(particle, h, start, &before);
                    let gap = |s: f64| {
                        self.obstacles
                            .gap(particle, obstacle, start.t + s * h, path.at(s))
                    };
                    let (mut low, mut high) = (due.clear / h, due.due / h);
                    for _ in 0..60 {
                        let middle = 0.5 * (low + high);
                        if gap(middle) < 0.0 {
                            high = middle;
                        } else {
                            low = middle;
                        }
                    }
                    let mut there = before.clone();
                    there.t = start.t + high * h;
                    there.work = end.work;
                    let range = 3 * particle..3 * particle + 3;
                    there.x[range.clone()].copy_from_slice(&path.at(high));
                    there.v[range.clone()].copy_from_slice(&path.velocity(high));
                    let old = path.velocity(high);
                    self.impacts += u64::from(self.obstacles.strike(particle, &mut there));
                    end.work = there.work;
                    for (axis, at) in range.enumerate() {
                        let change = there.v[at] - old[axis];
                        end.v[at] += change;
                        end.x[at] += change * (1.0 - high) * h;
                    }
                }
            }
        }
    }
}

/// Positive before an event, negative after it.
fn sign(obstacles: &Obstacles, held: Option<&Held>, due: &Due, state: &State) -> f64 {
    match due.event {
        Event::Impact { particle, obstacle } => {
            let at = [0, 1, 2].map(|axis| state.x[3 * particle + axis]);
            obstacles.gap(particle, obstacle, state.t, at) - due.level
        }
        Event::Contact { particle, change } => {
            let changes = held.map(|held| held.changes(state, &held.free(state)));
            let changes = changes.unwrap_or_default();
            let own = changes.iter().filter(|c| c.0 == particle && c.1 == change);
            -own.map(|c| c.2).fold(f64::NEG_INFINITY, f64::max)
        }
    }
}
