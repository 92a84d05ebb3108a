//! What steps keep from one to the next, found from the rows, which do not hold it: the impulses of rapier's contact.

use super::Replay;
use crate::integrators::{RapierContact, Remembered};
use crate::measure::identify::candidate::{Candidate, Replayer};
use crate::measure::identify::transition::Transition;
use crate::physics::constraints::contact::Obstacles;
use crate::space::{norm, three};
use std::sync::Arc;

/// Steps after which impulses are those of the rows, whatever they were taken to be before: one, of lone contacts, and one more.
/// Of a particle between two that rub they never are (tests/laws/rapier_contact.rs).
const SETTLED: usize = 2;

impl Replay<'_> {
    /// The candidate with what its steps keep at each row, where they keep something; else as it is.
    ///
    /// The rows are stepped through once, each from its own state, with the impulses of the step before; nothing is kept at
    /// the first. A step that is far off is of another program, and ends it.
    pub(in super::super) fn remembering(&self, candidate: Candidate) -> Candidate {
        if !candidate.is_soft() {
            return candidate;
        }
        let rows = self.rows;
        let mut kept: Vec<Vec<Remembered>> = vec![Vec::new()];
        let mut replayer = candidate.replayer(&self.settings);
        for k in 1..rows.len() {
            let (step, span) = (rows.steps[k - 1], rows.steps[k] - rows.steps[k - 1]);
            let mut state = self.state(k - 1, None);
            let near = |all: &Obstacles| span > 1 || RapierContact::is_near(all, &state);
            if !candidate.meets().is_some_and(near) {
                kept.push(Vec::new());
                continue;
            }
            let before = kept.last().map_or(&[][..], Vec::as_slice);
            replayer.recall(before);
            let taken = replayer.advance(step, span, rows.timestep, None, &mut state);
            if taken.is_err() || self.jumps(&state, &self.state(k, None)) {
                break;
            }
            kept.push(replayer.kept().to_vec());
        }
        candidate.remembering(Arc::new(kept))
    }

    /// How large the velocities are that each one is computed from where impulses that steps keep press, m/s: what they change
    /// it by in a substep, and the coordinates of gaps over that; empty where none press.
    pub(super) fn pressed(&self, replayer: &Replayer, transition: &Transition) -> Vec<f64> {
        let kept = replayer.kept();
        let mut all = vec![0.0; if kept.is_empty() { 0 } else { self.rows.dim }];
        let obstacles = replayer.candidate().meets();
        let part = self.rows.timestep / f64::from(replayer.candidate().substeps.max(1));
        for one in kept {
            let weight = obstacles.map_or(0.0, |all| all.weight(one.particle));
            let own = 3 * one.particle..3 * one.particle + 3;
            let x = three(self.rows.x(transition.to), one.particle);
            let change = weight * one.normal.hypot(norm(one.tangent)) + norm(x) / part;
            all[own].iter_mut().for_each(|sum| *sum += change);
        }
        all
    }

    /// Whether what a candidate's step keeps is known at row `k`. Rows that begin late may begin in contact.
    pub(in super::super) fn knows(&self, candidate: &Candidate, k: usize) -> bool {
        !candidate.is_soft() || k >= SETTLED || self.rows.steps.first() == Some(&0)
    }
}
