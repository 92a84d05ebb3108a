//! The errors of a run, against the truth and of its energy, and what is too small to be told from either.

use super::sampler::Samples;
use crate::physics::{ParticleSystem, System};
use crate::scene::Scene;
use crate::truth::TruthKind;
use crate::truth::{States, Truth};

/// Instants of a run that are looked at, at most.
const INSTANTS: u64 = 500;
/// And at most about this many numbers.
const NUMBERS: u64 = 1 << 21;
/// Roundings of the largest coordinate, a random walk over all steps, that may be in an error.
const ROUNDINGS: f64 = 4.0;

/// What the runs of a scene are held against.
pub struct Errors<'a> {
    pub truth: &'a Truth,
    system: &'a ParticleSystem,
    /// S, J.
    scale: Option<f64>,
    /// Largest coordinate of the truth, m.
    size: f64,
    /// Instants a run keeps at most.
    pub room: u64,
}

/// How far a run is from the truth.
#[derive(Debug, Clone, Copy)]
pub struct Off {
    /// Over the horizon, m.
    pub max: f64,
    /// At its last instant, m.
    pub last: f64,
}

impl<'a> Errors<'a> {
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
    fn times(&self, kept: &Samples) -> Vec<f64> {
        // A run ends at n h, which may round to just past where the truth was asked for.
        let last = self.truth.horizon * (1.0 + 4.0 * f64::EPSILON);
        let within = kept.t.iter().skip(1).filter(|t| **t <= last);
        within.map(|t| t.min(self.truth.horizon)).collect()
    }

    /// The truth at the instants of a run within the horizon, the start left out.
    pub fn states(&self, kept: &Samples) -> Option<(Vec<f64>, States)> {
        let motion = self.truth.motion()?;
        let times = self.times(kept);
        let states = motion.states(&times);
        Some((times, states))
    }

    /// None without a truth, or where no instant lies within its horizon, or too far away for a number.
    pub fn errors(&self, kept: &Samples) -> Option<Off> {
        let (times, states) = self.states(kept)?;
        let mut off: Option<Off> = None;
        for k in 0..times.len() {
            let distance = crate::truth::farthest(kept.x(k + 1), states.x(k));
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
    pub fn energy_error(&self, kept: &Samples) -> Option<f64> {
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
