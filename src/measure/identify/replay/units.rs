//! The units of a replay: what rounding explains of each number that is recorded at the end of a transition.

use super::super::candidate::Replayer;
use super::super::transition::{Transition, beside};
use super::Replay;
use super::outcome::grow;
use crate::integrators::StepError;
use crate::integrators::events::LOCATED;
use crate::physics::State;

impl Replay<'_> {
    /// What rounding explains of each coordinate at `transition.to`: positions, then velocities
    /// (none where there are none). `predicted` is what [`predict`](Self::predict) gave.
    ///
    /// Half a unit of the recorded number; what half units of the inputs, the rounding of every force
    /// ([`System::rounding`](crate::physics::System::rounding)) and that of the step's sums become, measured by replays that are moved by as
    /// much in `nudges` random directions; and for iterative schemes the tolerance of their solve.
    ///
    /// # Errors
    /// As [`predict`](Self::predict).
    pub fn units(
        &self,
        replayer: &mut Replayer,
        transition: &Transition,
        predicted: &State,
        nudges: u64,
    ) -> Result<Vec<f64>, StepError> {
        let mut grown = vec![0.0; self.recorded(transition).count()];
        for pattern in 0..nudges {
            let nudged = self.predict_nudged(replayer, transition, Some(pattern))?;
            if !self.jumps(predicted, &nudged) {
                grow(predicted, &nudged, &mut grown);
            }
        }
        Ok(self.with_own(replayer, transition, predicted, &grown))
    }

    /// What inputs have grown to, plus the rounding of the recorded number and the solve's
    /// tolerance.
    pub(super) fn with_own(
        &self,
        replayer: &Replayer,
        transition: &Transition,
        predicted: &State,
        grown: &[f64],
    ) -> Vec<f64> {
        let seconds = transition.span(self.rows) as f64 * self.rows.timestep;
        let dim = self.rows.dim;
        let solve = if self.iterated || replayer.candidate().iterates() {
            let kick = |(i, v): (usize, &f64)| match self.rows.v(transition.from) {
                Some(from) => (v - from[i]).abs(),
                None => v.abs(),
            };
            let kicks = predicted.v.iter().enumerate().map(kick);
            self.settings.tolerance * kicks.fold(0.0, f64::max)
        } else {
            0.0
        };
        let late = self.late(replayer, transition);
        let substeps = f64::from(replayer.candidate().substeps.max(1));
        let differences = replayer.candidate().differences();
        let bits = self.bits(replayer, transition);
        let own = self.recorded(transition).zip(bits).enumerate();
        let own = own.map(|(i, (value, bit))| {
            let solve = if i < dim { seconds * solve } else { solve };
            let located = if i < dim { late.0 } else { late.1 };
            let bit = match i.checked_sub(dim).filter(|_| differences) {
                Some(at) => {
                    let x = self.rows.x(transition.to)[at].abs().max(self.length);
                    bit + f64::EPSILON * x * substeps / self.rows.timestep
                }
                None => bit,
            };
            self.half_unit(transition.to, i, value) + bit + solve + located
        });
        grown.iter().zip(own).map(|(g, own)| g + own).collect()
    }

    /// What an impact that is located a little off does to positions, m, and to velocities, m/s.
    fn late(&self, replayer: &Replayer, transition: &Transition) -> (f64, f64) {
        let rows = self.rows;
        let [Some(from), Some(to)] = [transition.from, transition.to].map(|k| rows.v(k)) else {
            return (0.0, 0.0);
        };
        let obstacles = replayer.candidate().locates();
        if obstacles.is_none_or(|all| beside(all, rows, transition).is_none()) {
            return (0.0, 0.0);
        }
        let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
        let fastest = largest(&mut from.iter().chain(to).map(|v| v.abs()));
        let turned = largest(&mut from.iter().zip(to).map(|(a, b)| (b - a).abs()));
        (LOCATED * rows.timestep * 2.0 * fastest, LOCATED * turned)
    }

    /// Half a unit of the last digit that a number of row `k` is given to, or computed to.
    pub(super) fn half_unit(&self, k: usize, i: usize, value: f64) -> f64 {
        let rows = self.rows;
        let half = rows.half_unit(i, value);
        match i.checked_sub(rows.dim).filter(|_| self.differenced) {
            Some(at) => half + f64::EPSILON * rows.x(k)[at].abs() / rows.timestep,
            None => half,
        }
    }

    /// The rounding of each recorded number, and of what it came from.
    pub(super) fn digits(&self, replayer: &Replayer, transition: &Transition) -> Vec<f64> {
        let bits = self.bits(replayer, transition);
        let pairs = self.recorded(transition).zip(bits).enumerate();
        let digits = pairs.map(|(i, (to, bit))| self.half_unit(transition.to, i, to) + bit);
        digits.collect()
    }

    /// The roundings of the numbers that it came from: what ends near 0 was larger in between, a velocity also in the
    /// substeps of a soft step.
    fn bits(&self, replayer: &Replayer, transition: &Transition) -> Vec<f64> {
        let pressed = self.pressed(replayer, transition);
        let from = self.from(transition).enumerate();
        let between = |i: usize| i.checked_sub(self.rows.dim).and_then(|at| pressed.get(at));
        from.map(|(i, from)| f64::EPSILON * (from.abs() + between(i).unwrap_or(&0.0)))
            .collect()
    }
}
