//! One replay: the row a candidate makes from a row, and how far that is from the next row in units
//! of rounding.

mod memory;
mod outcome;
mod units;

use super::altered::sign;
use super::candidate::{Candidate, Replayer};
use super::transition::Transition;
use super::velocity;
use crate::integrators::{Settings, StepError};
use crate::physics::{ParticleSystem, State, System};
use crate::scene::{Drive, Scene};
use crate::trajectory::{Precision, Rows};
use outcome::{Outcome, grow, jump};

/// A transition follows a scheme if its defect is at most this many units.
///
/// A unit holds every rounding of the data once at its largest, and those of the forces and of the step; what
/// becomes of them in a step is measured in random directions, of which the unit takes the largest
/// result: one standard deviation or more, where the sum of many uniform roundings stays below 3 and
/// that of a few in the worst case below 4. The rest is for programs that take more operations.
pub const FIT: f64 = 10.0;

/// A defect so small needs no finer unit.
const CLEAR: f64 = 0.25 * FIT;
/// Nor does one so large after a few directions: more of them never raise a unit by as much. In a single one the
/// roundings of two forces may cancel at all axes of a particle.
const HOPELESS: f64 = 32.0 * FIT;
const FEW: u64 = 4;
/// Beyond this part of the motion one direction is enough.
const FAR: f64 = 1e-9;
/// Most directions in which inputs and forces are moved by their rounding.
const NUDGES: u64 = 16;

/// How far a replay ends from the data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Defect {
    /// Largest over the coordinates of |predicted - recorded|, in units of what rounding explains;
    /// infinite where the candidate cannot take the steps.
    pub units: f64,
    /// The same difference relative to what the transition moves.
    pub relative: f64,
}

impl Defect {
    /// The candidate cannot take these steps.
    pub(super) const IMPOSSIBLE: Self = Self {
        units: f64::INFINITY,
        relative: f64::INFINITY,
    };

    /// Whether rounding explains it.
    pub fn fits(&self) -> bool {
        self.units <= FIT
    }
}

/// The largest of `a / b`, with 0 / anything = 0.
fn largest_ratio(a: &[f64], b: &[f64]) -> f64 {
    let ratios = a.iter().zip(b).filter(|(a, _)| **a > 0.0);
    ratios.fold(0.0, |most, (a, b)| f64::max(most, a / b))
}

/// Rows that show whether velocities are differences.
const DIFFERENCED: usize = 8;
/// A velocity is found from positions in about this many tries.
const FIND: u64 = 8;
/// Newton's iterations that a replay may take. A wrong scheme, or one of altered forces, may have no solution near the
/// rows, and would take ten times what all right ones do.
const ITERATIONS: u32 = 100;
/// A step that solves costs as much as this many that do not: 20 to 100, on a chain of 20.
const SOLVE: u64 = 100;

/// What a step that solves costs a particle, in explicit steps: factors of a surface of n particles grow as n^1.5.
/// Measured on cloths: 330 of 10,000 and 1,100 of 100,000.
pub fn solve_effort(particles: u64) -> u64 {
    SOLVE.max(10 * particles.isqrt() / 3)
}

/// How the numbers of a row are moved by rounding.
#[derive(Clone, Copy)]
pub(super) struct Nudge {
    /// Which way each of them goes.
    pattern: u64,
    /// Roundings of a step's sums until the row `to`.
    roundings: f64,
    to: usize,
}

/// Replays the rows of a trajectory.
pub struct Replay<'a> {
    pub(super) rows: &'a Rows,
    pub(super) settings: Settings,
    /// Positions of the fixed coordinates, m; None for the free.
    fixed: Vec<Option<f64>>,
    /// The motions of those that are driven.
    drives: Vec<Drive>,
    /// The longest rest length or rod, m: what is computed from it is rounded as it is even where positions are small.
    length: f64,
    /// Whether velocities are differences of positions over the step, and round as those do.
    differenced: bool,
    /// Whether the rows themselves are known no better than an iterative solve's tolerance.
    pub(super) iterated: bool,
    /// Velocities that rounding parts by more are those of other impacts, m/s; infinite where nothing collides.
    jump: f64,
}

impl<'a> Replay<'a> {
    /// A replay of these rows; None if they are not of this scene: another number of coordinates,
    /// or columns of different lengths.
    pub fn new(
        scene: &Scene,
        system: &ParticleSystem,
        rows: &'a Rows,
        settings: Settings,
    ) -> Option<Self> {
        let values = rows.len().checked_mul(rows.dim)?;
        let shaped = rows.dim == system.dim()
            && rows.dim == 3 * scene.particles.len()
            && rows.x.len() == values
            && rows.v.as_ref().is_none_or(|v| v.len() == values)
            && rows.steps.windows(2).all(|pair| pair[0] < pair[1]);
        let start = ParticleSystem::initial_state(scene);
        let driven = |i: usize| scene.driven.iter().any(|d| d.particle == i / 3);
        let fixed = start.x.iter().zip(system.inverse_mass());
        let springs = scene.springs.iter().map(|s| s.rest_length);
        let lengths = springs.chain(scene.rods.iter().map(|rod| rod.length));
        shaped.then(|| Self {
            rows,
            settings: Settings {
                iterations: settings.iterations.min(ITERATIONS),
                ..settings
            },
            fixed: fixed
                .enumerate()
                .map(|(i, (x, w))| (*w == 0.0 && !driven(i)).then_some(*x))
                .collect(),
            drives: scene.drives(),
            length: lengths.fold(0.0, f64::max),
            differenced: is_differenced(rows),
            iterated: false,
            jump: jump(system, rows),
        })
    }

    /// The state at `transition.to` by the candidate, from the data up to `transition.from`.
    ///
    /// Without velocities it is the state whose position the scheme reaches from `before` through
    /// `from`.
    ///
    /// # Errors
    /// [`StepError`] where the candidate cannot take the steps or leaves the finite numbers.
    pub fn predict(
        &self,
        replayer: &mut Replayer,
        transition: &Transition,
    ) -> Result<State, StepError> {
        self.predict_nudged(replayer, transition, None)
    }

    /// The defect of a candidate at a transition.
    pub fn defect(&self, replayer: &mut Replayer, transition: &Transition) -> Defect {
        self.try_defect(replayer, transition)
            .unwrap_or(Defect::IMPOSSIBLE)
    }

    fn try_defect(
        &self,
        replayer: &mut Replayer,
        transition: &Transition,
    ) -> Result<Defect, StepError> {
        let predicted = self.predict(replayer, transition)?;
        let off: Vec<f64> = self.apart(transition, &predicted).collect();
        if off.iter().all(|d| *d == 0.0) {
            return Ok(Defect {
                units: 0.0,
                relative: 0.0,
            });
        }
        let most = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
        let moved: Vec<f64> = self.moved(transition).collect();
        let far = most(&off) > FAR * most(&moved);
        let numbers = off.len();
        let mut outcomes = vec![Outcome::new(predicted, numbers)];
        let soft = replayer.candidate().is_soft();
        if far && (soft || self.touches(replayer, transition)) {
            // What touches at a row may be struck in the step before it, or after it. A soft step meets it in every substep.
            let others = replayer.otherwise(|other| self.predict(other, transition));
            for other in others.into_iter().flatten() {
                let mut known = outcomes.iter_mut();
                match known.find(|one| !self.jumps(&one.state, &other)) {
                    Some(one) if soft => grow(&one.state, &other, &mut one.grown),
                    Some(_) => {}
                    None => outcomes.push(Outcome::new(other, numbers)),
                }
            }
        }
        let mut pattern = 0;
        loop {
            let nudged = self.predict_nudged(replayer, transition, Some(pattern))?;
            let mut known = outcomes.iter_mut();
            match known.find(|outcome| !self.jumps(&outcome.state, &nudged)) {
                Some(outcome) => grow(&outcome.state, &nudged, &mut outcome.grown),
                None => outcomes.push(Outcome::new(nudged, numbers)),
            }
            // Until one of its own is met, an outcome is as uncertain as the others.
            for k in 1..outcomes.len() {
                let grown = outcomes[0].grown.clone();
                let pairs = outcomes[k].grown.iter_mut().zip(grown);
                pairs.for_each(|(own, first)| *own = own.max(first));
            }
            pattern += 1;
            let (defect, off, units) = self.least(replayer, transition, &outcomes);
            let enough = if far { 1 } else { FEW };
            let clear = defect <= CLEAR || (defect > HOPELESS && pattern >= enough);
            if clear || pattern == NUDGES {
                let motion = largest_ratio(&moved, &units);
                let digits = self.digits(replayer, transition);
                if defect <= FIT && defect > motion && largest_ratio(&off, &digits) > FIT {
                    // Rounding would explain anything here.
                    return Ok(Defect::IMPOSSIBLE);
                }
                return Ok(Defect {
                    units: defect,
                    relative: if motion > 0.0 {
                        defect / motion
                    } else {
                        f64::INFINITY
                    },
                });
            }
        }
    }

    /// The distances of a state from what is recorded at the end; 0 of what no scheme computes.
    fn apart(&self, transition: &Transition, state: &State) -> impl Iterator<Item = f64> {
        let pairs = self
            .recorded(transition)
            .zip(state.x.iter().chain(&state.v));
        let pairs = pairs.enumerate();
        pairs.map(|(i, (recorded, predicted))| match self.is_driven(i) {
            true => 0.0,
            false => (predicted - recorded).abs(),
        })
    }

    /// The largest distance of a state from what is recorded at the end, in these units.
    pub(super) fn farthest(&self, transition: &Transition, state: &State, units: &[f64]) -> f64 {
        let off = self.off(transition, state, units);
        off.fold(0.0, |most, off| {
            let off = if off.is_nan() {
                f64::INFINITY
            } else {
                off.abs()
            };
            f64::max(most, off)
        })
    }

    /// A state minus what is recorded at the end, in these units: positions, then velocities where there are any.
    pub(super) fn off(
        &self,
        transition: &Transition,
        state: &State,
        units: &[f64],
    ) -> impl Iterator<Item = f64> {
        let numbers = state.x.iter().chain(&state.v).zip(units);
        let pairs = self.recorded(transition).zip(numbers).enumerate();
        pairs.map(|(i, (recorded, (state, unit)))| match state - recorded {
            0.0 => 0.0,
            _ if self.is_driven(i) => 0.0,
            off => off / unit,
        })
    }

    /// Whether a number of a state, positions then velocities, is given: no scheme computes it.
    pub(super) fn is_driven(&self, i: usize) -> bool {
        let particle = i % self.rows.dim / 3;
        self.drives.iter().any(|drive| drive.particle == particle)
    }

    /// What is recorded at the end: positions, then velocities where there are any.
    pub(super) fn recorded(&self, transition: &Transition) -> impl Iterator<Item = f64> + '_ {
        let v = self.rows.v(transition.to).unwrap_or(&[]);
        self.rows.x(transition.to).iter().chain(v).copied()
    }

    /// What is recorded at its start.
    fn from(&self, transition: &Transition) -> impl Iterator<Item = f64> + '_ {
        let v = self.rows.v(transition.from).unwrap_or(&[]);
        self.rows.x(transition.from).iter().chain(v).copied()
    }

    /// How far each recorded number moves.
    fn moved(&self, transition: &Transition) -> impl Iterator<Item = f64> + '_ {
        let pairs = self.from(transition).zip(self.recorded(transition));
        pairs.map(|(from, to)| (to - from).abs())
    }

    fn predict_nudged(
        &self,
        replayer: &mut Replayer,
        transition: &Transition,
        pattern: Option<u64>,
    ) -> Result<State, StepError> {
        let rows = self.rows;
        let span = transition.span(rows);
        let step = rows.steps[transition.from];
        let total = span.saturating_mul(u64::from(replayer.candidate().roundings()));
        let nudge = pattern.map(|pattern| Nudge {
            pattern,
            roundings: total as f64,
            to: transition.to,
        });
        // Beside the digits of coarser data, the rounding of a force in doubles is nothing.
        let doubles = rows.precision == Precision::Double;
        replayer.nudge(pattern.filter(|_| doubles));
        let mut state = self.state(transition.from, nudge);
        let mut before = transition.before.map(|k| (k, self.state(k, nudge)));
        if rows.v.is_none() {
            let Some((k, earlier)) = &mut before else {
                return Err(StepError::NotFinite { particle: 0 });
            };
            let leg = self.leg(*k, transition.from);
            if leg.span == 1 && replayer.candidate().moves_by_differences() {
                leg.difference(earlier, &mut state);
            } else {
                // A thousandth of what the data is rounded to is as good as exact.
                let enough = |x: f64| 1e-3 * rows.precision.half_unit(x);
                leg.find_within(replayer, earlier, &mut state, enough)?;
            }
        }
        let one_back = before
            .filter(|(k, _)| rows.steps[*k] + 1 == step)
            .map(|(_, state)| state);
        replayer.recall(replayer.candidate().remembered(transition.from));
        replayer.advance(step, span, rows.timestep, one_back.as_ref(), &mut state)?;
        let not_finite = |c: &f64| !c.is_finite();
        let lost = |values: &[f64]| values.iter().position(not_finite);
        match lost(&state.x).or_else(|| lost(&state.v)) {
            None => Ok(state),
            Some(at) => Err(StepError::NotFinite { particle: at / 3 }),
        }
    }

    /// About what replaying it costs, in steps of one particle under explicit forces.
    pub(super) fn effort(&self, candidate: &Candidate, transition: &Transition) -> u64 {
        let particles = (self.rows.dim / 3).max(1) as u64;
        let each = if candidate.solves() {
            solve_effort(particles)
        } else if candidate.steps_each_alone() {
            particles
        } else {
            1
        };
        let each =
            (each + candidate.keeping_effort()) * if self.rows.v.is_some() { 1 } else { FIND };
        let steps = transition.reach(self.rows);
        let substeps = u64::from(candidate.substeps.max(1));
        steps
            .saturating_mul(each * substeps)
            .saturating_mul(particles)
    }

    /// From row `k` of positions alone to row `from`.
    pub(super) fn leg(&self, k: usize, from: usize) -> velocity::Leg {
        let rows = self.rows;
        velocity::Leg {
            step: rows.steps[k],
            span: rows.steps[from].saturating_sub(rows.steps[k]),
            timestep: rows.timestep,
            roundings: f64::EPSILON * self.length,
        }
    }

    /// The state of row `k`, velocities 0 where they are unknown; each free number moved by its
    /// rounding and that of as many operations in the direction of the pattern.
    pub(super) fn state(&self, k: usize, nudge: Option<Nudge>) -> State {
        let rows = self.rows;
        let mut x = rows.x(k).to_vec();
        let mut v = rows
            .v(k)
            .map_or_else(|| vec![0.0; x.len()], <[f64]>::to_vec);
        let dim = rows.dim;
        let t = rows.time(k);
        for drive in &self.drives {
            let [position, velocity, _] = drive.at(t);
            let late = 2.0 * f64::EPSILON * t.abs();
            for axis in 0..3 {
                let at = 3 * drive.particle + axis;
                let off = late * velocity[axis].abs();
                know(
                    &mut x[at],
                    position[axis],
                    off + rows.half_unit(at, position[axis]),
                );
                if rows.v.is_none() {
                    v[at] = velocity[axis];
                }
            }
        }
        for (i, fixed) in self.fixed.iter().enumerate() {
            if let Some(place) = *fixed {
                know(&mut x[i], place, rows.half_unit(i, place));
            } else if let Some(nudge) = nudge {
                let Nudge {
                    pattern,
                    roundings,
                    to,
                } = nudge;
                let own = 0.5 * f64::EPSILON * roundings;
                let row = (k as u64, pattern);
                let round = [self.half_unit(k, i, x[i]), self.half_unit(k, dim + i, v[i])];
                // A number that grows on the way is rounded as what it grows to.
                let to_v = rows.v(to).map_or(0.0, |v| v[i].abs());
                let sizes = [x[i].abs().max(rows.x(to)[i].abs()), v[i].abs().max(to_v)];
                let finite = sizes.map(|size| if size.is_finite() { size } else { 0.0 });
                x[i] += sign(row, 2 * i) * (round[0] + own * finite[0]);
                v[i] += sign(row, 2 * i + 1) * (round[1] + own * finite[1]);
            }
        }
        let mut state = State::new(x, v);
        state.t = t;
        state
    }
}

/// What the scene says, where a file differs by its rounding alone: it is better known than that.
fn know(recorded: &mut f64, place: f64, half_unit: f64) {
    if (*recorded - place).abs() <= 1.01 * half_unit {
        *recorded = place;
    }
}

/// Whether the velocities of some rows are those that positions one or two steps apart give by a division, to
/// the last bits: a program that steps positions alone computes them so.
fn is_differenced(rows: &Rows) -> bool {
    let moving = (1..rows.len().saturating_sub(1)).filter(|&k| {
        rows.steps[k] == rows.steps[k - 1] + 1 && rows.steps[k + 1] == rows.steps[k] + 1
    });
    let moving: Vec<usize> = moving.take(DIFFERENCED).collect();
    let is = |back: usize, ahead: usize| {
        moving.iter().all(|&k| {
            let Some(v) = rows.v(k) else { return false };
            let (from, to) = (rows.x(k - back), rows.x(k + ahead));
            let seconds = (back + ahead) as f64 * rows.timestep;
            let pairs = v.iter().zip(to.iter().zip(from));
            pairs.into_iter().all(|(v, (to, from))| {
                (v - (to - from) / seconds).abs() <= 2.0 * f64::EPSILON * v.abs()
            })
        })
    };
    moving.len() == DIFFERENCED && (is(1, 0) || is(1, 1) || is(0, 1))
}
