//! Whether two candidates are the same map where a trajectory goes, or only look alike in its data.

use super::candidate::Candidate;
use super::replay::Replay;
use super::transition::{Transition, spread};
use crate::physics::{ParticleSystem, State};
use crate::scene::Scene;
use crate::trajectory::{Precision, Rows};

/// Steps longer than the data's by this much: schemes that differ at all differ more.
const LONGER: [f64; 5] = [1.0, 4.0, 16.0, 64.0, 256.0];
/// Number of states the motions start from.
const STATES: usize = 4;

/// Compares candidates on motions of their own, from a trajectory's states.
pub(super) struct Comparison<'a> {
    pub(super) scene: &'a Scene,
    pub(super) system: &'a ParticleSystem,
    pub(super) replay: &'a Replay<'a>,
    /// The region the motions may go to: lower and upper end of each coordinate.
    region: Vec<(f64, f64)>,
    starts: Vec<State>,
}

impl<'a> Comparison<'a> {
    /// `at`: the transitions whose states are started from.
    pub(super) fn new(
        scene: &'a Scene,
        system: &'a ParticleSystem,
        replay: &'a Replay<'a>,
        at: &[Transition],
    ) -> Self {
        let rows = replay.rows;
        let mut region = vec![(f64::INFINITY, f64::NEG_INFINITY); rows.dim];
        for k in 0..rows.len() {
            for ((low, high), x) in region.iter_mut().zip(rows.x(k)) {
                *low = low.min(*x);
                *high = high.max(*x);
            }
        }
        // A force that is linear where the data goes may not be elsewhere, behind an anchor say;
        // but data that hardly moves must not leave nothing to try.
        let least = 0.02 * scene.size();
        for (low, high) in &mut region {
            let margin = 0.5 * (*high - *low) + least;
            *low -= margin;
            *high += margin;
        }
        let starts = spread(at, STATES).iter().map(|t| start(rows, t)).collect();
        Self {
            scene,
            system,
            replay,
            region,
            starts,
        }
    }

    /// Whether the two are the same to rounding, in the data's steps and in longer ones.
    pub(super) fn same(&self, a: &Candidate, b: &Candidate) -> bool {
        let mut compared = false;
        for start in &self.starts {
            for longer in LONGER {
                let Some(rows) = self.motion(a, start, longer) else {
                    break;
                };
                match self.follows(b, &rows, a.iterates()) {
                    Some(true) => compared = true,
                    Some(false) => return false,
                    None => break,
                }
            }
        }
        compared
    }

    /// Rows that the candidate makes; None where it leaves the region or cannot step.
    fn motion(&self, candidate: &Candidate, start: &State, longer: f64) -> Option<Rows> {
        let data = self.replay.rows;
        let timestep = longer * data.timestep;
        let mut rows = Rows {
            timestep,
            dim: data.dim,
            steps: vec![0, 1, 2],
            x: start.x.clone(),
            v: Some(start.v.clone()),
            precision: Precision::Double,
            precision_v: Precision::Double,
            cut: false,
        };
        let mut replayer = candidate.replayer(&self.replay.settings);
        let mut state = start.clone();
        let mut before: Option<State> = None;
        for step in 0..2 {
            let here = state.clone();
            replayer
                .advance(step, 1, timestep, before.as_ref(), &mut state)
                .ok()?;
            before = Some(here);
            if !self.holds(&state) {
                return None;
            }
            rows.x.extend_from_slice(&state.x);
            rows.v.as_mut()?.extend_from_slice(&state.v);
        }
        if data.v.is_none() {
            rows.v = None;
        }
        Some(rows)
    }

    /// Whether the candidate makes the last of these rows from the earlier; None where it cannot.
    fn follows(&self, candidate: &Candidate, rows: &Rows, iterated: bool) -> Option<bool> {
        let mut replay = Replay::new(self.scene, self.system, rows, self.replay.settings)?;
        replay.iterated = iterated;
        let last = Transition {
            before: Some(0),
            from: 1,
            to: 2,
        };
        let mut replayer = candidate.replayer(&self.replay.settings);
        let predicted = replay.predict(&mut replayer, &last).ok()?;
        Some(self.holds(&predicted) && replay.defect(&mut replayer, &last).fits())
    }

    fn holds(&self, state: &State) -> bool {
        let inside = self.region.iter().zip(&state.x);
        let finite = state.v.iter().all(|v| v.is_finite());
        finite
            && inside
                .into_iter()
                .all(|((low, high), x)| (low..=high).contains(&x))
    }
}

/// The state at the start of a transition; of positions alone, with their mean velocity.
fn start(rows: &Rows, t: &Transition) -> State {
    let x = rows.x(t.from).to_vec();
    let v = match (rows.v(t.from), t.before) {
        (Some(v), _) => v.to_vec(),
        (None, Some(before)) => {
            let seconds = rows.time(t.from) - rows.time(before);
            let pairs = x.iter().zip(rows.x(before));
            pairs.map(|(x, earlier)| (x - earlier) / seconds).collect()
        }
        (None, None) => vec![0.0; x.len()],
    };
    State::new(x, v)
}
