//! One attempted step of a pair: its stages, its error, and its end.

use super::{ErrorEstimate, Pair, mixed};
use crate::integrators::agree;
use crate::integrators::nystrom::{LANES, NystromStage, Weight, stages, sums, weights};
use crate::integrators::{axpy, largest, worst_particle};
use crate::physics::{Power, State, System};

/// The scale of a tolerance: a length for errors in position, and a speed for errors in velocity. Both
/// scale with the units, so that a tolerance means the same in any.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scale {
    /// m.
    pub length: f64,
    /// m/s; grows with the largest speed so far.
    pub speed: f64,
}

impl Scale {
    /// The scale at the start of a run of `time` seconds with these velocities and accelerations. The length
    /// is the scene's `size` in metres; where that is 0, the distance a free particle would cover.
    ///
    /// The speed is the largest of: the speeds; sqrt(L a) with the largest acceleration a, which is the top
    /// speed of an oscillator from rest; and L / time, below which nothing moves by L.
    pub fn new(size: f64, time: f64, v: &[f64], a: &[f64]) -> Self {
        let (speed, acceleration) = (largest(v), largest(a));
        let flight = speed * time + 0.5 * acceleration * time * time;
        let length = [size, flight]
            .into_iter()
            .find(|l| *l > 0.0 && l.is_finite());
        let length = length.unwrap_or(1.0);
        let gained = length.sqrt() * acceleration.sqrt();
        let least = length / time;
        Self {
            length,
            speed: speed.max(gained).max(least),
        }
    }
}

/// The stages of the present step. Vectors are padded with zeros to a multiple of `LANES`.
pub(super) struct Trial {
    stages: Vec<NystromStage>,
    end: Vec<Weight>,
    /// The weights of the error estimate, and of the second one that DOP853 has.
    errors: Vec<Vec<Weight>>,
    b: &'static [f64],
    first_same_as_last: bool,
    accelerations: Vec<Vec<f64>>,
    powers: Vec<Power>,
    /// The number of coordinates.
    dim: usize,
    /// The step's start.
    from_x: Vec<f64>,
    from_v: Vec<f64>,
    /// The position and velocity of the stage, and at last of the end.
    x: Vec<f64>,
    v: Vec<f64>,
    /// The time of the start for which the first stage is known.
    known: Option<f64>,
}

impl Trial {
    pub fn new(pair: &Pair) -> Self {
        let tableau = &pair.tableau;
        let estimates: Vec<_> = match pair.estimate {
            ErrorEstimate::Embedded { weights, .. } => vec![weights],
            ErrorEstimate::Mixed53 { fifth, third } => vec![fifth, third],
        };
        let estimates = estimates.into_iter();
        Self {
            stages: stages(tableau),
            end: weights(tableau, tableau.b),
            errors: estimates.map(|row| weights(tableau, row)).collect(),
            b: tableau.b,
            first_same_as_last: pair.first_same_as_last,
            accelerations: vec![Vec::new(); tableau.b.len()],
            powers: vec![Power::default(); tableau.b.len()],
            dim: 0,
            from_x: Vec::new(),
            from_v: Vec::new(),
            x: Vec::new(),
            v: Vec::new(),
            known: None,
        }
    }

    /// Sets the start. The forces there are evaluated, unless they are known because it is the end of the last
    /// step.
    pub fn begin(&mut self, system: &dyn System, state: &State) {
        let dim = state.x.len();
        let known = self.known == Some(state.t) && self.dim == dim;
        let same = |a: &[f64], b: &[f64]| agree(system, &a[..dim], b);
        if known && same(&self.from_x, &state.x) && same(&self.from_v, &state.v) {
            return;
        }
        if self.dim != dim || self.from_x.is_empty() {
            self.dim = dim;
            let points = [&mut self.from_x, &mut self.from_v, &mut self.x, &mut self.v];
            for buffer in points.into_iter().chain(&mut self.accelerations) {
                *buffer = vec![0.0; dim.next_multiple_of(LANES)];
            }
        }
        self.from_x[..dim].copy_from_slice(&state.x);
        self.from_v[..dim].copy_from_slice(&state.v);
        let a = &mut self.accelerations[0][..dim];
        self.powers[0] = system.acceleration(state.t, &state.x, &state.v, a);
        self.known = Some(state.t);
    }

    /// Whether the first stage is finite.
    pub fn is_finite(&self) -> bool {
        self.accelerations[0].iter().all(|a| a.is_finite())
    }

    /// The scale of errors, for a run of `time` seconds from this start.
    pub fn scale(&self, size: f64, time: f64) -> Scale {
        Scale::new(size, time, &self.from_v, &self.accelerations[0])
    }

    /// The rate of change at the start, 1/s, from which the first step is chosen: the larger of the rate by
    /// the first derivative and that by the second, which takes one short Euler step.
    pub fn rate(&mut self, system: &dyn System, t: f64, most: f64, scale: &Scale) -> f64 {
        let dim = self.dim;
        let [a, beside, ..] = &mut self.accelerations[..] else {
            return 0.0;
        };
        let first = (largest(&self.from_v) / scale.length).max(largest(&*a) / scale.speed);
        let h = if first > 0.0 {
            0.01 / first
        } else {
            1e-3 * most
        }
        .min(most);
        for at in 0..dim {
            self.x[at] = self.from_x[at] + h * self.from_v[at];
            self.v[at] = self.from_v[at] + h * a[at];
        }
        system.acceleration(t + h, &self.x[..dim], &self.v[..dim], &mut beside[..dim]);
        let changes = a.iter().zip(beside.iter()).map(|(a, b)| (b - a).abs());
        let jerk = changes.fold(0.0, f64::max) / h;
        let second = (largest(&*a) / scale.length).max(jerk / scale.speed);
        // If the force beside the start is not finite, the attempt will find that.
        Some(second.sqrt())
            .filter(|second| second.is_finite())
            .map_or(first, |second| first.max(second))
    }

    /// Evaluates the stages after the first over `h`. Returns the largest error over all coordinates, in
    /// position or velocity, in units of the scale; NaN if anything is not finite.
    pub fn attempt(&mut self, system: &dyn System, t: f64, h: f64, scale: &Scale) -> f64 {
        let dim = self.dim;
        for stage in 1..self.stages.len() {
            let NystromStage { node, row } = &self.stages[stage];
            let from = [&self.from_x[..], &self.from_v];
            let to = [&mut self.x[..], &mut self.v];
            place(from, to, [node * h, h], row, &self.accelerations);
            let a = &mut self.accelerations[stage][..dim];
            self.powers[stage] =
                system.acceleration(t + node * h, &self.x[..dim], &self.v[..dim], a);
        }
        let sizes = [h * h / scale.length, h / scale.speed];
        match &self.errors[..] {
            [one] => self.largest_error(one, sizes),
            [fifth, third] => mixed(
                self.largest_error(fifth, sizes),
                self.largest_error(third, sizes),
            ),
            _ => 0.0,
        }
    }

    /// The largest error by one estimate, whose sums for positions and velocities are multiplied by `sizes`.
    fn largest_error(&self, weights: &[Weight], sizes: [f64; 2]) -> f64 {
        let mut most = [0.0_f64; LANES];
        let mut all = [0.0_f64; LANES];
        for start in (0..self.from_x.len()).step_by(LANES) {
            let (dx, dv) = sums(&self.accelerations, weights, start);
            for lane in 0..LANES {
                let (x, v) = (sizes[0] * dx[lane].abs(), sizes[1] * dv[lane].abs());
                let larger = if x > v { x } else { v };
                most[lane] = if larger > most[lane] {
                    larger
                } else {
                    most[lane]
                };
                // Comparisons ignore NaN, but sums keep it.
                all[lane] += x + v;
            }
        }
        if all.iter().sum::<f64>().is_finite() {
            most.into_iter().fold(0.0, f64::max)
        } else {
            f64::NAN
        }
    }

    /// Moves a state to the end of the attempted step, at time `t`. Returns the largest speed there; None, with
    /// the state unchanged, if the end is not finite.
    pub fn accept(&mut self, h: f64, t: f64, state: &mut State) -> Option<f64> {
        let dim = self.dim;
        if !self.first_same_as_last {
            let from = [&self.from_x[..], &self.from_v];
            let to = [&mut self.x[..], &mut self.v];
            place(from, to, [h, h], &self.end, &self.accelerations);
        }
        let mut fastest = 0.0;
        let mut all = 0.0;
        for (x, v) in self.x[..dim].iter().zip(&self.v[..dim]) {
            let speed = v.abs();
            fastest = if speed > fastest { speed } else { fastest };
            all += x.abs() + speed;
        }
        if !f64::is_finite(all) {
            return None;
        }
        state.x.copy_from_slice(&self.x[..dim]);
        state.v.copy_from_slice(&self.v[..dim]);
        state.t = t;
        for (&power, &weight) in self.powers.iter().zip(self.b) {
            if weight != 0.0 {
                state.work.advance(power, h * weight);
            }
        }
        self.known = None;
        if self.first_same_as_last {
            std::mem::swap(&mut self.from_x, &mut self.x);
            std::mem::swap(&mut self.from_v, &mut self.v);
            let last = self.stages.len() - 1;
            self.accelerations.swap(0, last);
            self.powers.swap(0, last);
            self.known = Some(t);
        }
        Some(fastest)
    }

    /// The first particle at which a value of the last attempt is not finite.
    pub fn not_finite(&self) -> Option<usize> {
        let mut values = self.accelerations.iter().chain([&self.x, &self.v]);
        let bad = values.find_map(|values| values.iter().position(|c| !c.is_finite()));
        bad.map(|at| at / 3)
    }

    /// The particle with the largest estimated error in velocity.
    pub fn worst(&self) -> usize {
        let mut errors = vec![0.0; self.from_x.len()];
        for weight in self.errors.first().into_iter().flatten() {
            axpy(
                &mut errors,
                weight.velocity,
                &self.accelerations[weight.stage],
            );
        }
        worst_particle(&errors)
    }
}

/// Computes a stage's position and velocity: the start, drifted over the time `drift`, plus the row's sums of
/// accelerations over the step `h`.
#[inline(always)]
fn place(
    [from_x, from_v]: [&[f64]; 2],
    [x, v]: [&mut [f64]; 2],
    [drift, h]: [f64; 2],
    row: &[Weight],
    accelerations: &[Vec<f64>],
) {
    let from = from_x.chunks_exact(LANES).zip(from_v.chunks_exact(LANES));
    let to = x.chunks_exact_mut(LANES).zip(v.chunks_exact_mut(LANES));
    for (block, ((x, v), (from_x, from_v))) in to.zip(from).enumerate() {
        let (dx, dv) = sums(accelerations, row, block * LANES);
        for lane in 0..LANES {
            x[lane] = from_x[lane] + (drift * from_v[lane] + h * h * dx[lane]);
            v[lane] = from_v[lane] + h * dv[lane];
        }
    }
}
