//! The truth as a sweep needs it: errors of a run's instants, and what is too small to be told from it.

use crate::outcome::TruthKind;
use crate::scene::Scene;
use crate::system::{ParticleSystem, State, System, Work};
use crate::truth::{States, Truth};

/// Instants of a run that are looked at, at most.
const INSTANTS: u64 = 500;
/// And at most about this many numbers.
const NUMBERS: u64 = 1 << 21;
/// Roundings of the largest coordinate, a random walk over all steps, that may be in an error.
const ROUNDINGS: f64 = 4.0;

/// What is known of a scene's motion.
pub(super) struct Witness<'a> {
    pub truth: &'a Truth,
    system: &'a ParticleSystem,
    /// S, J.
    scale: Option<f64>,
    /// Largest coordinate of the truth, m.
    size: f64,
    /// Instants a run keeps at most.
    pub room: u64,
}

/// States of a run at some instants, the start and the end among them.
#[derive(Debug, Clone, Default)]
pub(super) struct Kept {
    pub dim: usize,
    /// Seconds, ascending.
    pub t: Vec<f64>,
    pub x: Vec<f64>,
    pub v: Vec<f64>,
    pub work: Vec<Work>,
}

impl Kept {
    pub fn push(&mut self, t: f64, state: &State) {
        self.dim = state.x.len();
        self.t.push(t);
        self.x.extend_from_slice(&state.x);
        self.v.extend_from_slice(&state.v);
        self.work.push(state.work);
    }

    /// Every other instant, beginning with the first.
    pub fn halve(&mut self) {
        let dim = self.dim;
        let kept = (0..self.t.len()).step_by(2);
        for (to, from) in kept.enumerate() {
            self.t[to] = self.t[from];
            self.work[to] = self.work[from];
            self.x.copy_within(from * dim..(from + 1) * dim, to * dim);
            self.v.copy_within(from * dim..(from + 1) * dim, to * dim);
        }
        let left = self.t.len().div_ceil(2);
        self.t.truncate(left);
        self.work.truncate(left);
        self.x.truncate(left * dim);
        self.v.truncate(left * dim);
    }

    pub fn x(&self, k: usize) -> &[f64] {
        &self.x[k * self.dim..(k + 1) * self.dim]
    }

    pub fn v(&self, k: usize) -> &[f64] {
        &self.v[k * self.dim..(k + 1) * self.dim]
    }
}

/// How far a run is from the truth.
#[derive(Debug, Clone, Copy)]
pub(super) struct Off {
    /// Over the horizon, m.
    pub max: f64,
    /// At its last instant, m.
    pub last: f64,
}

impl<'a> Witness<'a> {
    pub fn new(
        scene: &Scene,
        system: &'a ParticleSystem,
        truth: &'a Truth,
        scale: Option<f64>,
    ) -> Self {
        let positions = scene.particles.iter().flat_map(|p| p.position);
        let mut size = positions.fold(0.0, |most: f64, x| most.max(x.abs()));
        if let Some(motion) = truth.motion() {
            let states = motion.states(&motion.landmarks(truth.horizon));
            let largest = states.x.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            size = size.max(largest);
        }
        let each = 6 * scene.particles.len().max(1) as u64;
        Self {
            truth,
            system,
            scale,
            size,
            room: (NUMBERS / each).clamp(16, INSTANTS),
        }
    }

    /// Ten times the truth's own bar, m; None without a truth.
    pub fn floor(&self) -> Option<f64> {
        (self.truth.kind != TruthKind::None).then_some(10.0 * self.truth.error_bound)
    }

    /// Whether an error after so many steps may be the truth's own or rounding.
    pub fn at_floor(&self, error: f64, steps: u64) -> bool {
        let rounding = ROUNDINGS * f64::EPSILON * self.size * (steps as f64).sqrt();
        error <= self.floor().unwrap_or(0.0).max(rounding)
    }

    /// The times of a run at which it is held against the truth: within the horizon, the start left out.
    fn times(&self, kept: &Kept) -> Vec<f64> {
        // A run ends at n h, which may round to just past where the truth was asked for.
        let last = self.truth.horizon * (1.0 + 4.0 * f64::EPSILON);
        let within = kept.t.iter().skip(1).filter(|t| **t <= last);
        within.map(|t| t.min(self.truth.horizon)).collect()
    }

    /// The truth at the instants of a run within the horizon, the start left out.
    pub fn states(&self, kept: &Kept) -> Option<(Vec<f64>, States)> {
        let motion = self.truth.motion()?;
        let times = self.times(kept);
        let states = motion.states(&times);
        Some((times, states))
    }

    /// None without a truth, or where no instant lies within its horizon, or too far away for a number.
    pub fn errors(&self, kept: &Kept) -> Option<Off> {
        let (times, states) = self.states(kept)?;
        let mut off: Option<Off> = None;
        for k in 0..times.len() {
            let distance = crate::measure::farthest(kept.x(k + 1), states.x(k));
            let max = off.map_or(0.0, |off| off.max);
            off = Some(Off {
                // NaN stays.
                max: if distance <= max { max } else { distance },
                last: distance,
            });
        }
        off.filter(|off| off.max.is_finite() && off.last.is_finite())
    }

    /// max |B - B(0)| / S over the kept instants; None where the scene has no scale.
    pub fn energy_error(&self, kept: &Kept) -> Option<f64> {
        let scale = self.scale?;
        let balance = |k: usize| {
            let energy =
                self.system.kinetic(kept.v(k)) + self.system.potential(kept.t[k], kept.x(k));
            energy + kept.work[k].dissipated - kept.work[k].injected
        };
        let start = (!kept.t.is_empty()).then(|| balance(0))?;
        let errors = (1..kept.t.len()).map(|k| (balance(k) - start).abs());
        let worst = errors.fold(0.0, |worst, e| if e <= worst { worst } else { e });
        Some(worst / scale).filter(|error| error.is_finite())
    }
}
