//! Steps of which rounding decides what becomes: whether something is struck in this step, or in the next.

use super::super::candidate::Replayer;
use super::super::transition::Transition;
use super::{Replay, largest_ratio};
use crate::physics::{ParticleSystem, State, System};
use crate::space::three;
use crate::trajectory::Rows;

/// See [`jump`].
const JUMP: f64 = 1e-3;

/// What becomes of a step where rounding decides between several outcomes: one of them.
pub(super) struct Outcome {
    pub(super) state: State,
    /// How far away inputs that are moved by their rounding end, of those that come to it.
    pub(super) grown: Vec<f64>,
}

impl Outcome {
    pub(super) fn new(state: State, numbers: usize) -> Self {
        Self {
            state,
            grown: vec![0.0; numbers],
        }
    }
}

impl Replay<'_> {
    /// The defect where each particle has the outcome that is nearest to what is recorded, the differences and their units.
    pub(super) fn least(
        &self,
        replayer: &Replayer,
        transition: &Transition,
        outcomes: &[Outcome],
    ) -> (f64, Vec<f64>, Vec<f64>) {
        let dim = self.rows.dim;
        let each = outcomes.iter().map(|outcome| {
            let off: Vec<f64> = self.apart(transition, &outcome.state).collect();
            let units = self.with_own(replayer, transition, &outcome.state, &outcome.grown);
            (off, units)
        });
        let mut each = each.collect::<Vec<_>>().into_iter();
        let (mut off, mut units) = each.next().unwrap_or_default();
        let own = |particle: usize, numbers: usize| {
            let each = [0, dim].map(|from| from + 3 * particle);
            let each = each.into_iter().flat_map(|from| from..from + 3);
            each.filter(move |i| *i < numbers)
        };
        let worst = |particle: usize, off: &[f64], units: &[f64]| {
            let own = own(particle, off.len()).filter(|i| off[*i] > 0.0);
            own.fold(0.0, |most, i| f64::max(most, off[i] / units[i]))
        };
        for (others, other_units) in each {
            for particle in 0..dim / 3 {
                if worst(particle, &others, &other_units) < worst(particle, &off, &units) {
                    for i in own(particle, off.len()) {
                        (off[i], units[i]) = (others[i], other_units[i]);
                    }
                }
            }
        }
        (largest_ratio(&off, &units), off, units)
    }

    /// Whether two states have had other impacts.
    pub(super) fn jumps(&self, a: &State, b: &State) -> bool {
        let pairs = a.v.iter().zip(&b.v);
        self.jump.is_finite() && pairs.into_iter().any(|(a, b)| (a - b).abs() > self.jump)
    }

    /// Whether something touches at an end of a transition, so that rounding decides in which step it is struck.
    pub(super) fn touches(&self, replayer: &Replayer, transition: &Transition) -> bool {
        let Some(obstacles) = replayer
            .candidate()
            .meets()
            .filter(|_| self.jump.is_finite())
        else {
            return false;
        };
        let closed = obstacles.closed();
        [transition.from, transition.to].into_iter().any(|k| {
            let row = self.state(k, None);
            let at = |particle| three(&row.x, particle);
            let near = obstacles.near([row.t; 2], |particle| (at(particle), closed));
            let mut near = near.pairs();
            near.any(|(particle, against)| {
                obstacles.gap(particle, against, row.t, at).abs() <= closed
            })
        })
    }
}

/// Raises `grown` to how far apart two states are.
pub(super) fn grow(predicted: &State, nudged: &State, grown: &mut [f64]) {
    let here = predicted.x.iter().chain(&predicted.v);
    let there = nudged.x.iter().chain(&nudged.v);
    let apart: Vec<f64> = here.zip(there).map(|(a, b)| (a - b).abs()).collect();
    // By particle, since chance may leave one of its axes where it was.
    for (grown, apart) in grown.chunks_mut(3).zip(apart.chunks(3)) {
        let most = apart.iter().fold(0.0, |most: f64, d| most.max(*d));
        for grown in grown {
            *grown = grown.max(most);
        }
    }
}

/// A thousandth of the largest speed of all rows, m/s, where something collides: no rounding grows so far in a step that
/// tells anything.
pub(super) fn jump(system: &ParticleSystem, rows: &Rows) -> f64 {
    let collides = system.obstacles().is_some();
    let speeds = rows
        .v
        .iter()
        .flatten()
        .filter(|v| v.is_finite() && collides);
    let fastest = speeds.fold(0.0, |most: f64, v| most.max(v.abs()));
    if fastest > 0.0 {
        JUMP * fastest
    } else {
        f64::INFINITY
    }
}
