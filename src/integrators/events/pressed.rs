//! Contact by penalty: a step is cut where a particle enters what it collides with, and where it leaves it. Within a
//! sub-step the same contacts press, whatever stages look ahead: so the force is smooth there, and a method keeps its order.

use super::path::{Path, crossing};
use super::root::{self, Bracket};
use super::{CUTS, IDLE, LOCATED, most_located, three};
use crate::integrators::{Integrator, StepError};
use crate::physics::constraints::contact::{Against, Beside, Obstacles};
use crate::physics::constraints::{Rods, StrainLimiter};
use crate::physics::effects::{PenaltyLaw, Press};
use crate::physics::{
    Dampers, ForceKinds, Injected, Jacobian, Linearization, Power, State, Sweep, System,
};
use std::collections::BTreeSet;

/// A particle, and what it is inside of.
type Pair = (usize, Against);

/// Advances a state by `h` seconds through all contacts; returns how many began.
pub(super) fn step(
    integrator: &mut dyn Integrator,
    system: &dyn System,
    obstacles: &Obstacles,
    law: [f64; 2],
    h: f64,
    state: &mut State,
) -> Result<u64, StepError> {
    let begin = state.t;
    let mut walk = Walk {
        integrator,
        h,
        entered: 0,
        most: most_located(obstacles),
        involved: BTreeSet::new(),
        frozen: Frozen {
            system,
            obstacles,
            law: PenaltyLaw::new(law),
            pressed: pressed(system, obstacles, state),
        },
    };
    let (mut done, mut idle) = (0.0, 0);
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
            return Ok(walk.entered);
        }
    }
    Err(StepError::TooManyEvents { t: state.t })
}

/// The contacts that press at a state. On a surface it is what enters, or is about to.
fn pressed(system: &dyn System, obstacles: &Obstacles, state: &State) -> BTreeSet<Pair> {
    let near = obstacles.near([state.t; 2], |particle| (three(&state.x, particle), 0.0));
    let touching = obstacles.touching(&near, state);
    let mut a = Vec::new();
    let mut enters = |beside: &Beside| {
        if beside.parting().abs() > beside.slow {
            return beside.parting() < 0.0;
        }
        if a.is_empty() {
            a = vec![0.0; state.x.len()];
            system.acceleration(state.t, &state.x, &state.v, &mut a);
        }
        obstacles.opening(beside, state.t, &a) < 0.0
    };
    let pressed = touching
        .iter()
        .filter(|beside| beside.gap < -beside.close || enters(beside));
    pressed
        .map(|beside| (beside.particle, beside.against))
        .collect()
}

struct Walk<'a> {
    integrator: &'a mut dyn Integrator,
    /// The whole step, s.
    h: f64,
    entered: u64,
    /// The most particles whose events are located on sub-steps.
    most: usize,
    /// The particles with events so far.
    involved: BTreeSet<usize>,
    frozen: Frozen<'a>,
}

/// A contact that begins or ends within a sub-step: not yet at `clear`, but at `due`, both in seconds from its start.
#[derive(Clone, Copy)]
struct Due {
    pair: Pair,
    clear: f64,
    due: f64,
    /// The depth or gap at which it does, m.
    level: f64,
}

impl Walk<'_> {
    /// One sub-step of at most `left` seconds, to the next event. Returns its length.
    fn advance(&mut self, left: f64, state: &mut State) -> Result<f64, StepError> {
        let start = state.clone();
        self.integrator.forget();
        let end = self.frozen.step(self.integrator, left, &start)?;
        let mut all = self.frozen.due(left, &start, &end);
        self.involved.extend(all.iter().map(|due| due.pair.0));
        let first = if self.involved.len() > self.most {
            None
        } else {
            self.first(&mut all, left, &start)?
        };
        let Some((time, at, pair)) = first else {
            let mut there = end.clone();
            *state = end.clone();
            for due in &all {
                let ends = [&start, &end];
                self.frozen.bend(due, left, ends, &mut there, state);
                self.turn(due.pair);
            }
            return Ok(left);
        };
        *state = at;
        self.turn(pair);
        Ok(time)
    }

    /// A contact begins, or ends.
    fn turn(&mut self, pair: Pair) {
        if !self.frozen.pressed.remove(&pair) {
            self.frozen.pressed.insert(pair);
            self.entered += 1;
        }
    }

    /// The first of these within `left` seconds, its time and the state there; None where none is found.
    fn first(
        &mut self,
        all: &mut [Due],
        left: f64,
        start: &State,
    ) -> Result<Option<(f64, State, Pair)>, StepError> {
        all.sort_by(|a, b| a.due.total_cmp(&b.due));
        let mut first: Option<(f64, State, Pair)> = None;
        let frozen = &self.frozen;
        for due in all {
            let sign = |state: &State| frozen.sign(due, state);
            let mut bracket = Bracket {
                clear: due.clear,
                due: due.due,
                left,
                h: self.h,
            };
            // What is not due where another event was found comes later.
            if let Some((time, at, _)) = &first {
                if due.clear >= *time || sign(at) >= 0.0 {
                    continue;
                }
                bracket.due = due.due.min(*time);
            }
            let to = |h| frozen.step(self.integrator, h, start);
            if let Some((time, at)) = root::locate(&bracket, start, sign, to)?
                && first.as_ref().is_none_or(|(bound, ..)| time < *bound)
            {
                first = Some((time, at, due.pair));
            }
        }
        Ok(first)
    }
}

/// A system within a sub-step, in which these contacts press and no others.
struct Frozen<'a> {
    system: &'a dyn System,
    obstacles: &'a Obstacles,
    law: PenaltyLaw,
    pressed: BTreeSet<Pair>,
}

impl Frozen<'_> {
    /// The state after a sub-step of `h` seconds.
    fn step(
        &self,
        integrator: &mut dyn Integrator,
        h: f64,
        start: &State,
    ) -> Result<State, StepError> {
        let mut end = start.clone();
        integrator.step(self, h, &mut end)?;
        self.system.place(start.t + h, &mut end.x, &mut end.v);
        Ok(end)
    }

    /// How far from its end a contact that presses is, m, and from its beginning another.
    fn left(&self, pair: Pair, gap: f64) -> f64 {
        if self.pressed.contains(&pair) {
            -gap
        } else {
            gap
        }
    }

    /// Positive before an event, negative after it.
    fn sign(&self, due: &Due, state: &State) -> f64 {
        let (particle, against) = due.pair;
        let at = |particle| three(&state.x, particle);
        let gap = self.obstacles.gap(particle, against, state.t, at);
        self.left(due.pair, gap) - due.level
    }

    /// The contacts that begin or end, on the cubics through both ends of a sub-step of `h` seconds.
    fn due(&self, h: f64, start: &State, end: &State) -> Vec<Due> {
        let path = |particle| Path::new(particle, h, start, end);
        let near = self
            .obstacles
            .near([start.t, start.t + h], |particle| path(particle).ball());
        let pairs: BTreeSet<Pair> = near.pairs().chain(self.pressed.iter().copied()).collect();
        let due = pairs.into_iter().filter_map(|pair| {
            let (particle, against) = pair;
            let own = path(particle);
            let other = match against {
                Against::Particle(other) => Some((other, path(other))),
                Against::Obstacle(_) => None,
            };
            let left = |s: f64| {
                let at = |which: usize| match &other {
                    Some((other, path)) if *other == which => path.at(s),
                    _ => own.at(s),
                };
                let gap = self.obstacles.gap(particle, against, start.t + s * h, at);
                self.left(pair, gap)
            };
            let others = other.as_ref().map_or(0.0, |(_, path)| path.length());
            let reach = self.obstacles.reach(against, start.t, start.t + h);
            let bound = own.length() + reach + others;
            if left(1.0) > bound {
                return None;
            }
            let ([clear, due], level) = crossing(left, bound, self.obstacles.close(own.at(0.0)))?;
            Some(Due {
                pair,
                clear: clear * h,
                due: due * h,
                level,
            })
        });
        due.collect()
    }

    /// Where there are too many events to cut at: what the damper of one does, or does no more, from its instant on its
    /// particles' paths to the end of the step. Of second order for a bounded number of them. `before` is the end as the
    /// step left it, and `there` any state.
    fn bend(
        &self,
        due: &Due,
        h: f64,
        [start, before]: [&State; 2],
        there: &mut State,
        end: &mut State,
    ) {
        let (particle, against) = due.pair;
        let ends = against.with(particle);
        there.t = start.t + due.due;
        for one in &ends {
            let path = Path::new(*one, h, start, before);
            let own = 3 * one..3 * one + 3;
            there.x[own.clone()].copy_from_slice(&path.at(due.due / h));
            there.v[own].copy_from_slice(&path.velocity(due.due / h));
        }
        let beside = self.obstacles.beside(particle, against, there);
        let weight: f64 = ends.iter().map(|one| self.obstacles.weight(*one)).sum();
        let (rest, u) = (h - due.due, beside.parting());
        // The flow of the damper alone, which turns nothing round however strong it is.
        let acted = u * (-self.law.damping * weight * rest).exp_m1();
        let gain = if self.pressed.contains(&due.pair) {
            -acted
        } else {
            acted
        };
        for (one, side) in ends.iter().zip([1.0, -1.0]) {
            let share = side * self.obstacles.weight(*one) / weight;
            for axis in 0..3 {
                let change = share * gain * beside.normal[axis];
                end.v[3 * one + axis] += change;
                end.x[3 * one + axis] += 0.5 * rest * change;
            }
        }
        end.work.dissipated -= gain * (u + 0.5 * gain) / weight;
    }

    /// The contacts whose force the system has and should not, or should have and has not.
    fn changes(&self, t: f64, x: &[f64], v: &[f64]) -> Vec<Press> {
        let mut state = State::new(x.to_vec(), v.to_vec());
        state.t = t;
        let inside = self.obstacles.inside(&state);
        let own = |beside: &Beside| (beside.particle, beside.against);
        let has: BTreeSet<Pair> = inside.iter().map(own).collect();
        let without = inside.iter().filter(|b| !self.pressed.contains(&own(b)));
        let missing = self.pressed.difference(&has);
        let missing = missing.map(|(one, other)| self.obstacles.beside(*one, *other, &state));
        let without = without.map(|beside| (*beside, -1.0));
        missing.map(|beside| (beside, 1.0)).chain(without).collect()
    }

    /// Adds what is changed to an acceleration without rods; returns its powers, W.
    fn change(&self, t: f64, changes: &[Press], a: &mut [f64]) -> Power {
        let mut f = vec![0.0; a.len()];
        let power = self.law.add_force(self.obstacles, t, changes, &mut f);
        self.add_over_mass(&f, a);
        power
    }

    fn add_over_mass(&self, f: &[f64], a: &mut [f64]) {
        for ((a, f), weight) in a.iter_mut().zip(f).zip(self.inverse_mass()) {
            *a += f * weight;
        }
    }
}

impl System for Frozen<'_> {
    fn inverse_mass(&self) -> &[f64] {
        self.system.inverse_mass()
    }

    fn acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        let changes = self.changes(t, x, v);
        let Some(rods) = self.rods().filter(|_| !changes.is_empty()) else {
            let mut power = self.system.acceleration(t, x, v, a);
            power += self.change(t, &changes, a);
            return power;
        };
        // Rods answer to all other forces.
        let power = self.free_acceleration(t, x, v, a);
        let over = |(a, w): (&f64, &f64)| if *w > 0.0 { a / w } else { 0.0 };
        let free: Vec<f64> = a.iter().zip(self.inverse_mass()).map(over).collect();
        let mut f = free.clone();
        if rods.add_forces(t, x, v, &mut f, &[]).is_err() {
            f.fill(f64::NAN);
        }
        for (f, free) in f.iter_mut().zip(&free) {
            *f -= free;
        }
        self.add_over_mass(&f, a);
        power
    }

    fn free_acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        let mut power = self.system.free_acceleration(t, x, v, a);
        power += self.change(t, &self.changes(t, x, v), a);
        power
    }

    fn rounding(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) {
        self.system.rounding(t, x, v, a);
    }

    fn kinds(&self) -> ForceKinds {
        self.system.kinds()
    }

    fn place(&self, t: f64, x: &mut [f64], v: &mut [f64]) {
        self.system.place(t, x, v);
    }

    fn jumps(&self) -> &[f64] {
        self.system.jumps()
    }

    fn damping(&self, t: f64, x: &[f64], w: &[f64], a: &mut [f64]) {
        self.system.damping(t, x, w, a);
        let mut f = vec![0.0; a.len()];
        self.law.add_damping(&self.changes(t, x, w), &mut f);
        self.add_over_mass(&f, a);
    }

    fn dampers(&self) -> Dampers {
        self.system.dampers()
    }

    fn sweep(&self, sweep: &mut Sweep) {
        self.system.sweep(sweep);
    }

    fn injected(&self, t: f64, x: &[f64], moved: &[f64], h: f64) -> Injected {
        self.system.injected(t, x, moved, h)
    }

    fn rods(&self) -> Option<&Rods> {
        self.system.rods()
    }

    fn strain_limiter(&self) -> Option<&StrainLimiter> {
        self.system.strain_limiter()
    }

    fn potential(&self, t: f64, x: &[f64]) -> f64 {
        let changes = self.changes(t, x, &vec![0.0; x.len()]);
        self.system.potential(t, x) + self.law.potential(&changes)
    }

    fn jacobian(
        &self,
        t: f64,
        x: &[f64],
        v: &[f64],
        linearization: Linearization,
        out: &mut Jacobian,
    ) {
        self.system.jacobian(t, x, v, linearization, out);
        self.law
            .add_jacobian(&self.changes(t, x, v), linearization, out);
    }
}
