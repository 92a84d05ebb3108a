//! What a strain limit leaves of the strain.

use crate::physics::constraints::Corrections;
use crate::scene::{Scene, Spring, StrainLimit};
use crate::trajectory::Trajectory;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The strain of the springs that have a limit, after its sweeps: over the recorded instants but the start.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct Strain {
    /// The limit: the part of its rest length by which a spring may be longer.
    pub ratio: f64,
    /// The largest strain, (l - L)/L; where compression is limited too, the largest of either sign. Null where none is
    /// finite.
    pub largest: Option<f64>,
    /// The spring that has it.
    pub spring: usize,
    /// When, s.
    pub t_s: f64,
    /// Whether no strain was beyond the limit by more than a hundredth of it, or 1e-6, at these instants. Sweeps go on to
    /// 1e-9 of a length, as far as their number allows.
    pub met: bool,
    /// Springs corrected, each time counted; null where nobody counts them.
    pub corrections: Option<u64>,
    /// Sweeps that corrected any spring.
    pub sweeps: Option<u64>,
    /// The sum of the impulses of its corrections on fixed particles, N s. Reactions leave them out.
    pub impulse_n_s: Option<[f64; 3]>,
}

/// Strain beyond the limit, over the limit, at which it is not met; and the least that counts.
const PART: f64 = 0.01;
const LEAST: f64 = 1e-6;

impl Strain {
    /// Over a run, with what the limiter did. None where the scene has no strain limit, no spring that it could act on,
    /// or no instant after the start was recorded.
    pub fn of(scene: &Scene, run: &Trajectory, done: Option<Corrections>) -> Option<Self> {
        let states = (1..run.len()).map(|k| (run.time(k), run.x(k)));
        Some(Self {
            corrections: done.map(|done| done.springs),
            sweeps: done.map(|done| done.sweeps),
            impulse_n_s: done.map(|done| done.impulse),
            ..Self::over(scene, states)?
        })
    }

    /// At positions, m.
    pub fn at(scene: &Scene, x: &[f64]) -> Option<Self> {
        Self::over(scene, std::iter::once((0.0, x)))
    }

    fn over<'a>(scene: &Scene, states: impl Iterator<Item = (f64, &'a [f64])>) -> Option<Self> {
        let limit = scene.strain_limit.as_ref()?;
        let fixed = |end: &usize| scene.particles[*end].fixed;
        let limited = |spring: &Spring| spring.rest_length > 0.0 && !spring.ends.iter().all(fixed);
        let springs = scene.springs.iter().enumerate();
        let springs: Vec<(usize, &Spring)> = springs.filter(|(_, s)| limited(s)).collect();
        let mut strain = Self {
            ratio: limit.ratio,
            largest: None,
            spring: springs.first()?.0,
            t_s: 0.0,
            met: true,
            corrections: None,
            sweeps: None,
            impulse_n_s: None,
        };
        let mut any = false;
        for (t, x) in states {
            any = true;
            for (id, spring) in &springs {
                let [a, b] = spring.ends.map(|end| &x[3 * end..3 * end + 3]);
                let length = (b[0] - a[0]).hypot(b[1] - a[1]).hypot(b[2] - a[2]);
                let found = length / spring.rest_length - 1.0;
                let farther = |most| size(limit, found) > size(limit, most);
                if found.is_finite() && strain.largest.is_none_or(farther) {
                    (strain.largest, strain.spring, strain.t_s) = (Some(found), *id, t);
                }
            }
        }
        let beyond = strain.largest.map(|most| size(limit, most) - limit.ratio);
        strain.met = beyond.is_some_and(|beyond| beyond <= (PART * limit.ratio).max(LEAST));
        any.then_some(strain)
    }
}

/// The size of a strain, as far as it is limited.
fn size(limit: &StrainLimit, strain: f64) -> f64 {
    match limit.also_compression {
        true => strain.abs(),
        false => strain,
    }
}
