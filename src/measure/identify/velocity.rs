//! The velocity that positions imply: the one with which a scheme leads from one row to the next.

use super::candidate::Replayer;
use crate::integrators::StepError;
use crate::physics::State;
use crate::vector::axpy;

/// From one row of positions to the next.
pub(super) struct Leg {
    /// Step number of the first.
    pub(super) step: u64,
    /// Steps between them.
    pub(super) span: u64,
    /// Seconds a step.
    pub(super) timestep: f64,
    /// The rounding of what forces are computed from, as a length, m.
    pub(super) roundings: f64,
}

/// Most steps of the iteration. It converges at once where a scheme drifts with a velocity that
/// positions fix, and else as fast as (w h)² is small; beyond w h = 1 Broyden's updates do the work.
const MOST: usize = 60;
/// After this many steps without progress, what is left is rounding.
const PATIENCE: usize = 4;

impl Leg {
    /// Sets the velocities of `from` so that the scheme leads to the positions of `to`, and those
    /// of `to` to what it arrives with.
    ///
    /// Broyden's good method (1965) on Φ_x(x0, v) = x1, started from the mean velocity and the
    /// slope span h, which is that of a free flight.
    ///
    /// # Errors
    /// [`StepError`] of the scheme, or where no such velocity is found.
    pub(super) fn find(
        &self,
        replayer: &mut Replayer,
        from: &mut State,
        to: &mut State,
    ) -> Result<(), StepError> {
        self.find_within(replayer, from, to, |_| 0.0)
    }

    /// Sets the velocities of `to` to the difference of positions over the leg; given ones stay.
    pub(super) fn difference(&self, from: &State, to: &mut State) {
        let seconds = self.span as f64 * self.timestep;
        for (v, mean) in to.v.iter_mut().zip(apart(&to.x, &from.x, seconds)) {
            if *v == 0.0 {
                *v = mean;
            }
        }
    }

    /// The same, to the last bits or, of a position of this value, to `enough` metres.
    pub(super) fn find_within(
        &self,
        replayer: &mut Replayer,
        from: &mut State,
        to: &mut State,
        enough: impl Fn(f64) -> f64,
    ) -> Result<(), StepError> {
        let seconds = self.span as f64 * self.timestep;
        let mut v = apart(&to.x, &from.x, seconds);
        let mut inverse = Inverse::default();
        let mut best: Option<(f64, Vec<f64>, Vec<f64>)> = None;
        let mut last: Option<(Vec<f64>, Vec<f64>)> = None;
        let (mut taken, mut idle) = (0, 0);
        while taken < MOST && idle < PATIENCE {
            let mut end = from.clone();
            end.v.clone_from(&v);
            replayer.still(&mut end)?;
            let left = end.v.clone();
            replayer.advance(self.step, self.span, self.timestep, None, &mut end)?;
            taken += 1;
            let miss = apart(&end.x, &to.x, seconds);
            let off = self.roundings_off(&miss, to, seconds, &enough);
            if !off.is_finite() {
                break;
            }
            if best.as_ref().is_none_or(|(least, ..)| off < 0.5 * least) {
                idle = 0;
            } else {
                idle += 1;
            }
            if best.as_ref().is_none_or(|(least, ..)| off < *least) {
                best = Some((off, left, end.v));
            }
            if off <= 0.5 {
                break;
            }
            if let Some((step, before)) = last.take() {
                inverse.learn(&step, &apart(&miss, &before, 1.0));
            }
            let step: Vec<f64> = inverse.times(&miss).iter().map(|s| -s).collect();
            axpy(&mut v, 1.0, &step);
            last = Some((step, miss));
        }
        match best {
            // A few roundings are as near as doubles come.
            Some((off, v, arrived)) if off <= 16.0 => {
                from.v = v;
                to.v = arrived;
                Ok(())
            }
            best => Err(StepError::NotConverged {
                iterations: taken as u32,
                residual: best.map_or(f64::MAX, |(off, ..)| off * f64::EPSILON),
                tolerance: f64::EPSILON,
                particle: 0,
            }),
        }
    }

    /// How many last bits of the positions the end misses them by, or how often `enough`.
    fn roundings_off(
        &self,
        miss: &[f64],
        to: &State,
        seconds: f64,
        enough: impl Fn(f64) -> f64,
    ) -> f64 {
        miss.iter().zip(&to.x).fold(0.0, |most, (miss, x)| {
            let off = (miss * seconds).abs();
            // NaN must not be lost in a maximum.
            if off == 0.0 {
                most
            } else if off.is_finite() {
                let bit = f64::EPSILON * x.abs() + self.roundings;
                f64::max(most, off / bit.max(enough(*x)))
            } else {
                f64::INFINITY
            }
        })
    }
}

/// The inverse Jacobian 1 + Σ a bᵀ.
#[derive(Default)]
struct Inverse {
    terms: Vec<(Vec<f64>, Vec<f64>)>,
}

impl Inverse {
    fn times(&self, y: &[f64]) -> Vec<f64> {
        let mut out = y.to_vec();
        for (a, b) in &self.terms {
            axpy(&mut out, dot(b, y), a);
        }
        out
    }

    fn transposed_times(&self, y: &[f64]) -> Vec<f64> {
        let mut out = y.to_vec();
        for (a, b) in &self.terms {
            axpy(&mut out, dot(a, y), b);
        }
        out
    }

    /// Makes it map `change` to `step`, by Sherman and Morrison's formula.
    fn learn(&mut self, step: &[f64], change: &[f64]) {
        let image = self.times(change);
        let scale = dot(step, &image);
        if scale == 0.0 || !scale.is_finite() {
            return;
        }
        let a = step.iter().zip(&image).map(|(s, i)| (s - i) / scale);
        let term = (a.collect(), self.transposed_times(step));
        self.terms.push(term);
    }
}

/// (a - b) / seconds.
fn apart(a: &[f64], b: &[f64], seconds: f64) -> Vec<f64> {
    let pairs = a.iter().zip(b);
    pairs.map(|(a, b)| (a - b) / seconds).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
