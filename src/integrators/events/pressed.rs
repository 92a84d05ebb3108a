//! Contact by penalty: a step is cut where a particle enters what it collides with, and where it leaves it. Within a
//! sub-step the same contacts press, whatever stages look ahead: so the force is smooth there, and a method keeps its order.

use super::path::{self, Path, meeting};
use super::root::{self, Due};
use super::{MANY, most_located};
use crate::integrators::{Integrator, StepError};
use crate::physics::constraints::contact::{Against, Beside, Obstacles};
use crate::physics::constraints::{Rods, StrainLimiter};
use crate::physics::effects::{PenaltyLaw, Press};
use crate::physics::{
    Dampers, ForceKinds, Injected, Jacobian, Linearization, Power, State, Sweep, System,
};
use crate::space::three;
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
    let mut walk = Walk {
        integrator,
        h,
        entered: 0,
        involved: BTreeSet::new(),
        frozen: Frozen {
            system,
            obstacles,
            law: PenaltyLaw::new(law),
            pressed: pressed(system, obstacles, state),
        },
    };
    let advance = |left: f64, located: usize, state: &mut State| walk.advance(left, located, state);
    root::cut(h, MANY, state, advance)?;
    Ok(walk.entered)
}

/// The contacts that press at a state. On a surface it is what enters, or is about to.
fn pressed(system: &dyn System, obstacles: &Obstacles, state: &State) -> BTreeSet<Pair> {
    let touching = obstacles.touching(&obstacles.near_now(state), state);
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
    /// The particles with events so far.
    involved: BTreeSet<usize>,
    frozen: Frozen<'a>,
}

impl Walk<'_> {
    /// One sub-step of at most `left` seconds, to the next contact that begins or ends, if no more particles than `located`
    /// have some. Returns its length.
    fn advance(&mut self, left: f64, located: usize, state: &mut State) -> Result<f64, StepError> {
        let closed = self.frozen.pressed.len();
        let located = located.min(most_located(self.frozen.obstacles, closed));
        let start = state.clone();
        self.integrator.forget();
        let end = self.frozen.step(self.integrator, left, &start)?;
        let mut all = self.frozen.due(left, &start, &end);
        self.involved.extend(all.iter().map(|due| due.event.0));
        let first = if self.involved.len() > located {
            None
        } else {
            let frozen = &self.frozen;
            let sign = |due: &Due<Pair>, state: &State| frozen.sign(due, state);
            let to = |h| frozen.step(self.integrator, h, &start);
            root::first(&mut all, [left, self.h], &start, sign, to)?
        };
        let Some((time, at, pair)) = first else {
            let mut there = end.clone();
            *state = end.clone();
            for due in &all {
                let ends = [&start, &end];
                self.frozen.bend(due, left, ends, &mut there, state);
                self.turn(due.event);
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

    /// Of a contact that presses what comes to an end is its depth, of another its gap.
    fn side(&self, pair: Pair) -> f64 {
        if self.pressed.contains(&pair) {
            -1.0
        } else {
            1.0
        }
    }

    /// Positive before an event, negative after it.
    fn sign(&self, due: &Due<Pair>, state: &State) -> f64 {
        let (particle, against) = due.event;
        let at = |particle| three(&state.x, particle);
        let gap = self.obstacles.gap(particle, against, state.t, at);
        self.side(due.event) * gap - due.level
    }

    /// The contacts that begin or end, on the cubics through both ends of a sub-step of `h` seconds.
    fn due(&self, h: f64, start: &State, end: &State) -> Vec<Due<Pair>> {
        let near = path::near(self.obstacles, h, start, end);
        let pairs: BTreeSet<Pair> = near.pairs().chain(self.pressed.iter().copied()).collect();
        let path = |one: usize| Path::new(one, h, start, end);
        let meets = |pair: Pair| {
            let side = self.side(pair);
            meeting(self.obstacles, pair, (0.0, side), [start.t, h], path)
        };
        pairs.into_iter().filter_map(meets).collect()
    }

    /// Where there are too many events to cut at: what the damper of one does, or does no more, from its instant on its
    /// particles' paths to the end of the step. Of second order for a bounded number of them. `before` is the end as the
    /// step left it, and `there` any state.
    fn bend(
        &self,
        due: &Due<Pair>,
        h: f64,
        [start, before]: [&State; 2],
        there: &mut State,
        end: &mut State,
    ) {
        let (particle, against) = due.event;
        let ends = against.with(particle);
        there.t = start.t + due.due;
        for one in &ends {
            Path::new(*one, h, start, before).put(*one, due.due / h, there);
        }
        let beside = self.obstacles.beside(particle, against, there);
        let weight = self.obstacles.lightness(&beside);
        let (rest, u) = (h - due.due, beside.parting());
        // The flow of the damper alone, which turns nothing round however strong it is.
        let acted = u * (-self.law.damping * weight * rest).exp_m1();
        let gain = if self.pressed.contains(&due.event) {
            -acted
        } else {
            acted
        };
        for (all, by) in [(&mut end.v, gain), (&mut end.x, 0.5 * rest * gain)] {
            self.obstacles
                .push(&beside, beside.normal.map(|n| by * n), all);
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
