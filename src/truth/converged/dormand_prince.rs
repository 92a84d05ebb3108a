//! The explicit Runge-Kutta method of order 8 of Dormand and Prince, at fixed steps.

pub use crate::integrators::adaptive::DORMAND_PRINCE_8;

use super::stepper::{Precise, Stepper, fit};
use crate::integrators::Tableau;
use crate::integrators::adaptive::{ERROR_3, ERROR_5, mixed};
use crate::integrators::nystrom::{self, LANES, NystromStage, Weight, sums, weights};
use crate::physics::System;

/// An explicit tableau in Nyström form that steps compensated states.
///
/// The first weight is chosen so that the weights sum to 1, and to 1/2 for positions: rounded
/// coefficients would drift with time.
pub struct DormandPrince {
    stages: Vec<NystromStage>,
    /// Weights of the step's end, without the first stage's.
    end: Vec<Weight>,
    /// Weights of the error estimates of order 5 and 3.
    errors: [Vec<Weight>; 2],
    /// Stage accelerations, padded to whole lanes.
    accelerations: Vec<Vec<f64>>,
    /// Stage position and velocity.
    x: Vec<f64>,
    v: Vec<f64>,
}

impl Default for DormandPrince {
    fn default() -> Self {
        Self::with(&DORMAND_PRINCE_8)
    }
}

impl DormandPrince {
    /// A stepper with another explicit tableau, at least consistent. Its error estimates mean nothing.
    pub fn with(tableau: &Tableau) -> Self {
        let stages = tableau.b.len();
        let mut end = weights(tableau, tableau.b);
        end.retain(|weight| weight.stage > 0);
        Self {
            stages: nystrom::stages(tableau),
            end,
            errors: [weights(tableau, &ERROR_5), weights(tableau, &ERROR_3)],
            accelerations: vec![Vec::new(); stages],
            x: Vec::new(),
            v: Vec::new(),
        }
    }

    /// An estimate of the error of the step of `h` seconds just taken, largest over the coordinates: in
    /// position, m, and in velocity, m/s. It is of the order of the method's own error, and larger.
    pub(super) fn local_error(&self, h: f64) -> [f64; 2] {
        let [of_5, of_3] = [&self.errors[0], &self.errors[1]].map(|rows| self.largest_sums(rows));
        [h * h * mixed(of_5[0], of_3[0]), h * mixed(of_5[1], of_3[1])]
    }

    /// Largest magnitude over the coordinates of weighted sums of accelerations: as a position and
    /// as a velocity. NaN if one is.
    fn largest_sums(&self, weights: &[Weight]) -> [f64; 2] {
        let mut most = [0.0_f64; 2];
        let padded = self.accelerations.first().map_or(0, Vec::len);
        for start in (0..padded).step_by(LANES) {
            let (dx, dv) = sums(&self.accelerations, weights, start);
            for (most, sums) in most.iter_mut().zip([dx, dv]) {
                for sum in sums {
                    *most = if sum.is_nan() {
                        sum
                    } else {
                        most.max(sum.abs())
                    };
                }
            }
        }
        most
    }

    /// Overwrites the stage's position and velocity from the stages before it.
    fn prepare(&mut self, stage: usize, h: f64, state: &Precise) {
        let dim = state.x.len();
        let node = self.stages[stage].node;
        for start in (0..dim).step_by(LANES) {
            let (dx, dv) = sums(&self.accelerations, &self.stages[stage].row, start);
            for (lane, at) in (start..dim.min(start + LANES)).enumerate() {
                let drift = node * h * state.v[at] + h * h * dx[lane];
                self.x[at] = state.x[at] + (state.x_low[at] + drift);
                self.v[at] = state.v[at] + (state.v_low[at] + h * dv[lane]);
            }
        }
    }

    /// Adds the step to the state.
    fn finish(&self, h: f64, state: &mut Precise) {
        let Some(first) = self.accelerations.first() else {
            return;
        };
        let dim = state.x.len();
        for start in (0..dim).step_by(LANES) {
            let (mut dx, mut dv) = ([0.0; LANES], [0.0; LANES]);
            let first = &first[start..start + LANES];
            for weight in &self.end {
                let a = &self.accelerations[weight.stage][start..start + LANES];
                for (lane, (a, first)) in a.iter().zip(first).enumerate() {
                    dx[lane] += weight.position * (a - first);
                    dv[lane] += weight.velocity * (a - first);
                }
            }
            for (lane, at) in (start..dim.min(start + LANES)).enumerate() {
                let drift = h * (state.v[at] + state.v_low[at]);
                let dx = drift + h * h * (0.5 * first[lane] + dx[lane]);
                state.add(at, dx, h * (first[lane] + dv[lane]));
            }
        }
    }
}

impl Stepper for DormandPrince {
    fn step(&mut self, system: &dyn System, t: f64, h: f64, state: &mut Precise) {
        let dim = state.x.len();
        fit(&mut self.x, dim);
        fit(&mut self.v, dim);
        for a in &mut self.accelerations {
            fit(a, dim.next_multiple_of(LANES));
        }
        for stage in 0..self.stages.len() {
            self.prepare(stage, h, state);
            let t = t + self.stages[stage].node * h;
            let a = &mut self.accelerations[stage][..dim];
            system.acceleration(t, &self.x, &self.v, a);
        }
        self.finish(h, state);
    }

    fn evaluations(&self) -> u64 {
        self.stages.len() as u64
    }
}
