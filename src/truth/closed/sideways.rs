//! How far rounding may push particles off a line they are meant to stay on.

use super::lengths::Bounds;
use super::line::Off;
use super::problem::{Group, Problem};
use crate::scene::DampingModel;

/// Growth of small offsets across a line of springs.
///
/// Across the line a spring under tension N acts like one of stiffness N / l, which changes as the
/// spring works, so that offsets may grow: by compression, or as the swing of a pendulum of springs
/// is pumped. With all stiffness over mass between `low` and `high`, and any reference c > 0,
/// |y'|² + c |y|² grows no faster than at twice max(high - c, c - low) / 2 √c.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sideways {
    off: Off,
    /// Largest over smallest mass norm of a unit offset.
    spread: f64,
    /// Bounds on the stiffness across the line over the mass, 1/s².
    low: f64,
    high: f64,
}

impl Sideways {
    /// None where a damper without a shortest length makes the stiffness unbounded. `lengths` are of the
    /// springs with a rest length, in order.
    pub fn new(problem: &Problem, group: &Group, off: Off, lengths: &[Bounds]) -> Option<Self> {
        let masses: Vec<f64> = group
            .free
            .iter()
            .map(|&i| problem.scene.particles[i].mass)
            .collect();
        // Of each particle, by Gershgorin's rows.
        let (mut low, mut high) = (vec![0.0; masses.len()], vec![0.0; masses.len()]);
        let isotropic = problem.scene.damping_model == DampingModel::Isotropic;
        let mut lengths = lengths.iter();
        for link in &group.links {
            let spring = link.spring;
            let damping = if isotropic { 0.0 } else { spring.damping };
            let own = link.has_rest_length().then(|| lengths.next()).flatten();
            let (least, most) = match own {
                Some(b) => {
                    let pull = |l: f64| spring.stiffness * (1.0 - spring.rest_length / l);
                    let damper = damping * b.fastest / b.shortest;
                    (pull(b.shortest) - damper, pull(b.longest) + damper)
                }
                None if damping > 0.0 => return None,
                None => (spring.stiffness, spring.stiffness),
            };
            // A row's diagonal, and as much beside it where the other end moves too.
            let free: Vec<usize> = link.ends.into_iter().flatten().collect();
            for &i in &free {
                low[i] += free.len() as f64 * least.min(0.0) / masses[i];
                high[i] += free.len() as f64 * most.max(0.0) / masses[i];
            }
        }
        let lightest = masses.iter().copied().fold(f64::INFINITY, f64::min);
        Some(Self {
            off,
            spread: (masses.iter().sum::<f64>() / lightest).sqrt(),
            low: low.into_iter().fold(0.0, f64::min),
            high: high.into_iter().fold(0.0, f64::max),
        })
    }

    /// No particle is farther off the line in [0, t], m.
    pub fn bound(&self, t: f64) -> f64 {
        let Self { low, high, off, .. } = *self;
        if t == 0.0 {
            return self.spread * off.position;
        }
        let c = (0.5 * (low + high)).max(-low).max(1.0 / (t * t));
        let rate = (high - c).max(c - low) / (2.0 * c.sqrt());
        let start = off.position.hypot((off.velocity + off.pull * t) / c.sqrt());
        // Twice, for terms of second order in the offset.
        2.0 * self.spread * start * (rate * t).exp()
    }
}
