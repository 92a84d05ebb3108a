//! rapier's contact as a step of our own: rigid while a gap is open, a soft spring once it is not, and restitution once a
//! step.
//!
//! It is no method of a registry row: it keeps the impulses of the last step, so that it is no map of a state, and it has no
//! order at impacts. rapier's step is Box2D's soft step (Catto 2024, <https://box2d.org/posts/2024/02/solver2d/>), without
//! Box2D's threshold of restitution; the rules are those of rapier's source, 0.36.

use super::newton::Newton;
use super::{Integrator, Settings, StepError, agree, axpy, refuse};
use crate::physics::constraints::contact::{Against, Obstacles};
use crate::physics::{ForceKinds, Linearization, Power, State, System};
use crate::space::{dot, three};
use std::f64::consts::TAU;

/// Gaps of more than this, m, are no contacts, whatever the speed.
const PREDICTION: f64 = 0.02;
/// The largest velocity at which what is inside is pushed out, m/s.
const PUSH_OUT: f64 = 3.0;
/// The damping ratio of every contact.
const DAMPING: f64 = 10.0;
/// A gap is not known to more than this part of the coordinates it comes from, or of a usual radius in metres.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
const RADIUS: f64 = 0.1;

/// A contact's spring at a substep: rest at N/(m w²) inside.
#[derive(Debug, Clone, Copy)]
pub struct Softness {
    /// w, rad/s.
    pub angular_frequency: f64,
    /// The velocity out of an obstacle per depth, 1/s.
    push: f64,
    /// The part of a rigid impulse that a soft row keeps, 0 to 1.
    pub share: f64,
}

impl Softness {
    /// Of an obstacle that moves (30 Hz) or does not (60 Hz), in substeps of `h` seconds.
    pub fn new(moves: bool, h: f64) -> Self {
        let w = TAU * if moves { 30.0 } else { 60.0 };
        let stiff = h * w + 2.0 * DAMPING;
        Self {
            angular_frequency: w,
            push: w / stiff,
            share: 1.0 / (1.0 + 1.0 / (h * w * stiff)),
        }
    }

    /// The time in which a depth comes within 1/e of its rest, s: 2 ζ/w + 1/(h w²) + h.
    pub fn settles_in(&self, h: f64) -> f64 {
        let w = self.angular_frequency;
        2.0 * DAMPING / w + 1.0 / (h * w * w) + h
    }
}

/// A particle near an obstacle, over one step.
#[derive(Debug, Clone)]
struct Row {
    particle: usize,
    obstacle: usize,
    /// From the obstacle to the particle, as at the start of the step.
    normal: [f64; 3],
    /// gap = normal · (x - there), with the obstacle as at the start of the step.
    there: [f64; 3],
    /// The obstacle's velocity over the step, m/s.
    surface: [f64; 3],
    soft: Softness,
    /// µ.
    friction: f64,
    /// 1/m, 1/kg.
    weight: f64,
    /// The normal velocity, m/s, that restitution gives back; 0 where it does not.
    seed: f64,
    /// Of the present substep, N s; the next begins with them.
    normal_impulse: f64,
    tangent_impulse: [f64; 3],
    /// The normal impulses of all substeps.
    total: f64,
}

/// What a step leaves of a contact that pressed in it: the impulses of its last substep, with which the next step begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Remembered {
    pub particle: usize,
    pub obstacle: usize,
    /// N s.
    pub normal: f64,
    /// N s.
    pub tangent: [f64; 3],
}

impl Row {
    /// The gap, m, `t` seconds into the step.
    fn gap(&self, x: &[f64], t: f64) -> f64 {
        let x = three(x, self.particle);
        let moved = |axis: usize| (x[axis] - self.there[axis]) - t * self.surface[axis];
        dot(self.normal, [0, 1, 2].map(moved))
    }

    /// How much of a gap is rounding, m.
    fn rounding(&self, x: &[f64]) -> f64 {
        let size = three(x, self.particle).map(f64::abs);
        ROUNDING * size.iter().fold(RADIUS, |most, c| c.max(most))
    }

    /// Relative to the obstacle, m/s.
    fn velocity(&self, v: &[f64]) -> [f64; 3] {
        let v = three(v, self.particle);
        [0, 1, 2].map(|axis| v[axis] - self.surface[axis])
    }

    /// Changes the velocity by an impulse along the normal, which then is `to`. Whether it changes.
    fn push(&mut self, to: f64, v: &mut [f64]) -> bool {
        let by = (to - self.normal_impulse) * self.weight;
        self.normal_impulse = to;
        add(v, self.particle, by, self.normal);
        by != 0.0
    }

    /// The row before a drift: velocities that close the gap and no more, or the spring of what is inside. Returns the
    /// impulse before it is softened, N s.
    fn press(&mut self, gap: f64, open: bool, h: f64, v: &mut [f64]) -> (f64, bool) {
        let parting = dot(self.normal, self.velocity(v));
        let (bias, share) = if open {
            (gap / h, 1.0)
        } else {
            ((gap * self.soft.push).max(-PUSH_OUT), self.soft.share)
        };
        let rigid = (self.normal_impulse - (parting + bias) / self.weight).max(0.0);
        (rigid, self.push(share * rigid, v))
    }

    /// The row after a drift: rigid, and with friction.
    fn relax(&mut self, gap: f64, h: f64, v: &mut [f64]) -> bool {
        let parting = dot(self.normal, self.velocity(v));
        let closing = parting + gap.max(0.0) / h;
        let pressed = self.push((self.normal_impulse - closing / self.weight).max(0.0), v);
        self.rub(v) || pressed
    }

    /// Friction: what stops the sliding, up to µ times the normal impulse.
    fn rub(&mut self, v: &mut [f64]) -> bool {
        let velocity = self.velocity(v);
        let parting = dot(self.normal, velocity);
        let old = self.tangent_impulse;
        let mut new = [0, 1, 2]
            .map(|axis| old[axis] - (velocity[axis] - parting * self.normal[axis]) / self.weight);
        let (size, most) = (dot(new, new).sqrt(), self.friction * self.normal_impulse);
        if size > most {
            new = new.map(|part| part * (most / size));
        }
        self.tangent_impulse = new;
        let change = [0, 1, 2].map(|axis| new[axis] - old[axis]);
        add(v, self.particle, self.weight, change);
        change != [0.0; 3]
    }
}

/// The stepper. Forces act by linearly implicit Euler with K = k n nᵀ, which one spring a particle is in rapier; several are
/// solved together here, as rapier's sweeps do where they converge.
///
/// Without obstacles a step is `linearized_implicit_material`, in substeps. Its energy books nothing of contact.
pub struct RapierContact {
    substeps: u32,
    sweeps: u32,
    relaxing: u32,
    newton: Newton,
    /// Of the last step, by obstacle and particle, and where it ended.
    kept: Vec<Remembered>,
    ended: Option<(Vec<f64>, Vec<f64>)>,
    closed: f64,
    ties: Ties,
}

/// Ties of a step, which rounding breaks: how far it alone may move what is in contact.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Ties {
    /// m: a gap that is 0 but for rounding counts as open or as closed, and a soft row gives up a part of its impulse in
    /// every substep.
    pub position: f64,
    /// m/s: an impulse of the size of rounding gives restitution, or there is none.
    pub velocity: f64,
}

impl RapierContact {
    /// With so many substeps a step, and in each so many sweeps before and after the drift; at least one of all.
    pub fn new(substeps: u32, sweeps: u32, relaxing: u32) -> Self {
        Self {
            substeps: substeps.max(1),
            sweeps: sweeps.max(1),
            relaxing: relaxing.max(1),
            newton: Newton::new(Settings::default()),
            kept: Vec::new(),
            ended: None,
            closed: 0.0,
            ties: Ties::default(),
        }
    }

    /// What rounding decided in the last step.
    pub fn ties(&self) -> Ties {
        self.ties
    }

    /// Takes a state as the end of the last step, whose impulses it keeps.
    pub fn resume(&mut self, state: &State) {
        self.ended = Some((state.x.clone(), state.v.clone()));
    }

    /// Takes a state as the end of a step that has left this.
    pub fn recall(&mut self, kept: &[Remembered], state: &State) {
        self.kept.clear();
        self.kept.extend_from_slice(kept);
        self.resume(state);
    }

    /// Takes a gap for closed up to so many of its roundings; 0 is rapier's.
    pub fn closes_at(&mut self, roundings: f64) {
        self.closed = roundings;
    }

    /// The contacts that had an impulse in the last step, by obstacle and particle.
    pub fn kept(&self) -> &[Remembered] {
        &self.kept
    }

    /// Whether something is so near that a step has a contact.
    pub fn is_near(obstacles: &Obstacles, state: &State) -> bool {
        let mut pairs = obstacles.pairs();
        pairs.any(|(particle, against)| obstacles.beside(particle, against, state).gap < PREDICTION)
    }

    /// The contacts of a step, with what is left of them from the last.
    fn rows(&self, obstacles: &Obstacles, h: f64, state: &State) -> Vec<Row> {
        let part = h / f64::from(self.substeps);
        let near = |(particle, against): (usize, Against)| {
            let Against::Obstacle(obstacle) = against else {
                return None;
            };
            let beside = obstacles.beside(particle, against, state);
            let [old, new] = [state.t, state.t + h].map(|t| obstacles.moved(against, t)[0]);
            let surface = [0, 1, 2].map(|axis| (new[axis] - old[axis]) / h);
            let x = three(&state.x, particle);
            let mut row = Row {
                particle,
                obstacle,
                normal: beside.normal,
                there: [0, 1, 2].map(|axis| x[axis] - beside.gap * beside.normal[axis]),
                surface,
                soft: Softness::new(obstacles.moves(against), part),
                friction: obstacles.surface(against).friction[0],
                weight: obstacles.weight(particle),
                seed: 0.0,
                normal_impulse: 0.0,
                tangent_impulse: [0.0; 3],
                total: 0.0,
            };
            if beside.gap >= PREDICTION {
                return None;
            }
            let key = (obstacle, particle);
            let found = (self.kept).binary_search_by_key(&key, |old| (old.obstacle, old.particle));
            let old = found.ok().map(|at| &self.kept[at]);
            let restitution = obstacles.surface(against).restitution;
            // What bore a load in the last step rests, unless it bounces for ever.
            if old.is_none() || restitution >= 1.0 {
                row.seed = restitution * dot(row.normal, row.velocity(&state.v));
            }
            if let Some(old) = old {
                row.normal_impulse = old.normal;
                let along = dot(old.tangent, row.normal);
                row.tangent_impulse =
                    [0, 1, 2].map(|axis| old.tangent[axis] - along * row.normal[axis]);
            }
            Some(row)
        };
        obstacles.pairs().filter_map(near).collect()
    }

    /// The velocities that forces leave after `h` seconds at frozen positions, beside the impulses of contacts.
    fn forced(
        &mut self,
        system: &dyn System,
        h: f64,
        start: &State,
        rows: &[Row],
    ) -> Result<(Vec<f64>, Power), StepError> {
        let mut begin = start.clone();
        for row in rows {
            let impulse =
                |axis: usize| row.normal_impulse * row.normal[axis] + row.tangent_impulse[axis];
            add(
                &mut begin.v,
                row.particle,
                row.weight,
                [0, 1, 2].map(impulse),
            );
        }
        let mut v = begin.v.clone();
        let material = Linearization::Material;
        let power = self
            .newton
            .single(system, start.t, h, material, &begin, &mut v)?;
        Ok((v, power))
    }

    fn substep(
        &mut self,
        system: &dyn System,
        [begin, h]: [f64; 2],
        rows: &mut [Row],
        state: &mut State,
    ) -> Result<(), StepError> {
        let start = state.clone();
        let (mut v, power) = self.forced(system, h, &start, rows)?;
        let mut changed = false;
        let mut lost = 0.0_f64;
        for sweep in 0..self.sweeps {
            if sweep > 0 {
                if !changed {
                    break;
                }
                (v, _) = self.forced(system, h, &start, rows)?;
            }
            changed = false;
            for row in &mut *rows {
                let gap = row.gap(&state.x, start.t - begin);
                let rounding = row.rounding(&state.x);
                let open = gap > self.closed * rounding;
                let (rigid, moved) = row.press(gap, open, h, &mut v);
                changed |= moved;
                if gap.abs() <= rounding {
                    lost = lost.max((1.0 - row.soft.share) * rigid * row.weight);
                }
            }
        }
        self.ties.position += lost * h * f64::from(self.substeps);
        axpy(&mut state.x, h, &v);
        state.t += h;
        system.place(state.t, &mut state.x, &mut v);
        // The forces are still those of before the drift.
        for _ in 0..self.relaxing {
            if changed {
                (v, _) = self.forced(system, h, &start, rows)?;
            }
            changed = false;
            for row in &mut *rows {
                let gap = row.gap(&state.x, state.t - begin);
                changed |= row.relax(gap, h, &mut v);
            }
        }
        for row in rows {
            row.total += row.normal_impulse;
        }
        state.v = v;
        state.work.advance(power, h);
        Ok(())
    }
}

impl Integrator for RapierContact {
    fn step(&mut self, system: &dyn System, h: f64, state: &mut State) -> Result<(), StepError> {
        refuse(self, system)?;
        let goes_on = |(x, v): &(Vec<f64>, Vec<f64>)| {
            agree(system, x, &state.x) && agree(system, v, &state.v)
        };
        if !self.ended.as_ref().is_some_and(goes_on) {
            self.kept.clear();
        }
        let obstacles = system.obstacles();
        let mut rows = obstacles.map_or(Vec::new(), |all| self.rows(all, h, state));
        let (begin, mut next) = (state.t, state.clone());
        self.ties = Ties::default();
        let part = h / f64::from(self.substeps);
        for n in 0..self.substeps {
            next.t = begin + f64::from(n) * part;
            self.substep(system, [begin, part], &mut rows, &mut next)?;
        }
        for row in rows.iter_mut().filter(|row| row.seed < 0.0) {
            // A particle that would just come to the surface in the next substep.
            let speed = dot(row.normal, row.velocity(&next.v));
            let rounding = ROUNDING * speed.abs() + 2.0 * row.rounding(&next.x) / part;
            let gap = row.gap(&next.x, h).max(0.0);
            if row.total * row.weight <= rounding && (speed + gap / part).abs() <= rounding {
                self.ties.velocity = self.ties.velocity.max((row.seed + speed).abs());
            }
            if row.total <= 0.0 {
                continue;
            }
            let wanted = dot(row.normal, row.velocity(&next.v)) + row.seed;
            let before = row.normal_impulse;
            row.push((before - wanted / row.weight).max(0.0), &mut next.v);
            row.total += row.normal_impulse - before;
        }
        next.t = begin + h;
        system.place(next.t, &mut next.x, &mut next.v);
        self.ended = Some((next.x.clone(), next.v.clone()));
        let pressed = rows.iter().filter(|row| row.total > 0.0);
        let kept = pressed.map(|row| Remembered {
            particle: row.particle,
            obstacle: row.obstacle,
            normal: row.normal_impulse,
            tangent: row.tangent_impulse,
        });
        self.kept = kept.collect();
        *state = next;
        Ok(())
    }

    fn takes(&self) -> ForceKinds {
        ForceKinds::ANY.without(ForceKinds::CONSTRAINED)
    }

    fn forget(&mut self) {
        self.kept.clear();
    }

    fn keeps_contact(&self) -> bool {
        true
    }

    fn linear_solves(&self) -> u64 {
        self.newton.solves
    }
}

fn add(all: &mut [f64], particle: usize, factor: f64, what: [f64; 3]) {
    for (axis, part) in what.iter().enumerate() {
        all[3 * particle + axis] += factor * part;
    }
}
