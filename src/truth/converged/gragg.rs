//! Extrapolation of Gragg's explicit midpoint rule, at fixed steps.

use super::stepper::{Precise, Stepper, fit};
use crate::physics::System;

/// Numbers of substeps; the error of an even number has an expansion in h², so k of them give order
/// 2k (Gragg 1965; Hairer, Nørsett, Wanner, Solving ODEs I, II.9, with Deuflhard's harmonic
/// sequence).
pub const SUBSTEPS: [u32; 5] = [2, 4, 6, 8, 10];

/// The explicit midpoint rule extrapolated to order 2k, without the smoothing step.
///
/// Everything is kept as a difference from x + t v and from v, so that no sum loses the digits of a
/// small step. Not to be confused with the explicit midpoint method of Runge.
pub struct Gragg {
    substeps: Vec<u32>,
    /// Aitken and Neville's factors 1 / ((n_j / n_i)² - 1), row j over i = j - 1, j - 2, ..., 0.
    factors: Vec<Vec<f64>>,
    /// The start's acceleration, shared by all sequences.
    first: Vec<f64>,
    a: Vec<f64>,
    x: Vec<f64>,
    v: Vec<f64>,
    /// The sequence's last two points, as the differences of all positions (m), then velocities (m/s).
    before: Vec<f64>,
    now: Vec<f64>,
    /// The lowest diagonal of Neville's scheme, of such points.
    diagonal: Vec<Vec<f64>>,
}

impl Default for Gragg {
    fn default() -> Self {
        Self::with(&SUBSTEPS)
    }
}

impl Gragg {
    /// A stepper with other numbers of substeps, even and ascending.
    pub fn with(substeps: &[u32]) -> Self {
        let factor = |i: u32, j: u32| 1.0 / ((f64::from(j) / f64::from(i)).powi(2) - 1.0);
        let row = |(row, &j)| {
            let before = substeps[..row].iter().rev();
            before.map(|&i| factor(i, j)).collect()
        };
        Self {
            substeps: substeps.to_vec(),
            factors: substeps.iter().enumerate().map(row).collect(),
            first: Vec::new(),
            a: Vec::new(),
            x: Vec::new(),
            v: Vec::new(),
            before: Vec::new(),
            now: Vec::new(),
            diagonal: vec![Vec::new(); substeps.len()],
        }
    }

    /// Leaves the end of `n` substeps of `h / n` in `now`.
    fn midpoints(&mut self, system: &dyn System, t: f64, h: f64, n: u32, state: &Precise) {
        let h = h / f64::from(n);
        let dim = state.x.len();
        self.before.fill(0.0);
        self.now[..dim].fill(0.0);
        for (v, a) in self.now[dim..].iter_mut().zip(&self.first) {
            *v = h * a;
        }
        for m in 1..n {
            let elapsed = f64::from(m) * h;
            let (now_x, now_v) = self.now.split_at(dim);
            for at in 0..dim {
                let drift = elapsed * state.v[at] + now_x[at];
                self.x[at] = state.x[at] + (state.x_low[at] + drift);
                self.v[at] = state.v[at] + (state.v_low[at] + now_v[at]);
            }
            system.acceleration(t + elapsed, &self.x, &self.v, &mut self.a);
            let slopes = now_v.iter().chain(&self.a);
            for (before, slope) in self.before.iter_mut().zip(slopes) {
                *before += 2.0 * h * slope;
            }
            std::mem::swap(&mut self.before, &mut self.now);
        }
    }

    /// Puts `now` into row `row` of the scheme, which then extrapolates from rows 0 to `row`.
    fn extrapolate(&mut self, row: usize) {
        let (above, rest) = self.diagonal.split_at_mut(row);
        let Some(new) = rest.first_mut() else { return };
        new.copy_from_slice(&self.now);
        let mut better = new;
        for (older, factor) in above.iter_mut().rev().zip(&self.factors[row]) {
            for (old, new) in older.iter_mut().zip(&*better) {
                *old = new + factor * (new - *old);
            }
            better = older;
        }
    }
}

impl Stepper for Gragg {
    fn step(&mut self, system: &dyn System, t: f64, h: f64, state: &mut Precise) {
        let dim = state.x.len();
        for buffer in [&mut self.first, &mut self.a, &mut self.x, &mut self.v] {
            fit(buffer, dim);
        }
        let points = [&mut self.before, &mut self.now];
        for point in points.into_iter().chain(&mut self.diagonal) {
            fit(point, 2 * dim);
        }
        system.acceleration(t, &state.x, &state.v, &mut self.first);
        for row in 0..self.substeps.len() {
            self.midpoints(system, t, h, self.substeps[row], state);
            self.extrapolate(row);
        }
        // The scheme's corner has moved up to its first place.
        let Some(best) = self.diagonal.first() else {
            return;
        };
        for at in 0..dim {
            let drift = h * (state.v[at] + state.v_low[at]);
            state.add(at, drift + best[at], best[dim + at]);
        }
    }

    fn evaluations(&self) -> u64 {
        let midpoints = self.substeps.iter().map(|n| u64::from(n - 1));
        1 + midpoints.sum::<u64>()
    }
}
