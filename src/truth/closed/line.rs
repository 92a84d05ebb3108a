//! Whether all motion of a group stays on one line.

use super::problem::{Group, Problem};
use super::vector::{across, norm, unit};
use nalgebra::Vector3;

/// Rounding of numbers in a file: a point meant to be on a line lies this many eps off it.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// A line that may itself move sideways, if nothing holds it.
#[derive(Debug, Clone)]
pub(super) struct Line {
    /// Unit vector; exact along an axis.
    pub direction: Vector3<f64>,
    /// Motion across the line, common to all particles.
    pub drift: Drift,
    /// What the file's rounding leaves across the line.
    pub off: Off,
}

/// u'' = pull - rate u', from 0 at this velocity.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Drift {
    pub velocity: Vector3<f64>,
    pub pull: Vector3<f64>,
    /// Drag over mass, 1/s.
    pub rate: f64,
}

impl Drift {
    pub fn is_still(&self) -> bool {
        self.velocity == Vector3::zeros() && self.pull == Vector3::zeros()
    }
}

/// The largest position (m), velocity and acceleration across the line.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Off {
    pub position: f64,
    pub velocity: f64,
    pub pull: f64,
}

impl Off {
    /// Every particle is on the line to the last bit.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

impl Line {
    /// None if motion leaves the line by more than the rounding of the scene's numbers.
    pub fn of(problem: &Problem, group: &Group) -> Option<Self> {
        let velocities: Vec<_> = group.free.iter().map(|&i| problem.velocity(i)).collect();
        let pulls: Vec<_> = group.free.iter().map(|&i| problem.constant(i)).collect();
        let ends = group.links.iter().flat_map(|l| l.spring.ends);
        let points: Vec<_> = ends
            .chain(group.free.iter().copied())
            .map(|i| problem.position(i))
            .collect();
        let origin = *points.first()?;
        let apart: Vec<_> = points.iter().map(|p| p - origin).collect();
        let along = [&apart, &velocities, &pulls]
            .into_iter()
            .find_map(|vectors| longest(vectors))
            .unwrap_or(Vector3::x());
        let direction = unit(along)?;
        let extent = points.iter().map(|&p| norm(p)).fold(0.0, f64::max);
        let position = apart.iter().map(|&p| across(p, along)).fold(0.0, f64::max);
        if position > ROUNDING * extent {
            return None;
        }
        let anchored = group.is_anchored();
        let (velocity, off_velocity) = common(&velocities, along, direction, anchored)?;
        let (pull, off_pull) = common(&pulls, along, direction, anchored)?;
        let mut drift = Drift {
            velocity,
            pull,
            rate: 0.0,
        };
        let mut off = Off {
            position,
            velocity: off_velocity,
            pull: off_pull,
        };
        if !drift.is_still() {
            let particles = &problem.scene.particles;
            let rates: Vec<f64> = group
                .free
                .iter()
                .map(|&i| particles[i].drag / particles[i].mass)
                .collect();
            let high = rates.iter().copied().fold(0.0, f64::max);
            let low = rates.iter().copied().fold(high, f64::min);
            if high - low > ROUNDING * high {
                return None;
            }
            drift.rate = high;
            let gained = norm(pull) * problem.until.min(1.0 / high);
            off.pull += (high - low) * (norm(velocity) + gained);
        }
        Some(Self {
            direction,
            drift,
            off,
        })
    }
}

/// The longest of some vectors, unless all are 0.
fn longest(vectors: &[Vector3<f64>]) -> Option<Vector3<f64>> {
    let longest = vectors
        .iter()
        .copied()
        .max_by(|&a, &b| norm(a).total_cmp(&norm(b)));
    longest.filter(|&v| v != Vector3::zeros())
}

/// What these vectors have in common across the line, and how far they are from it at most: nothing
/// if they lie along it, the first one's part if nothing is anchored and all agree.
fn common(
    vectors: &[Vector3<f64>],
    along: Vector3<f64>,
    direction: Vector3<f64>,
    anchored: bool,
) -> Option<(Vector3<f64>, f64)> {
    let most = vectors.iter().map(|&v| norm(v)).fold(0.0, f64::max);
    let off = |from: Vector3<f64>| {
        let each = vectors.iter().map(|&v| across(v - from, along));
        each.fold(0.0, f64::max)
    };
    let alone = off(Vector3::zeros());
    if alone <= ROUNDING * most {
        return Some((Vector3::zeros(), alone));
    }
    let first = *vectors.first().filter(|_| !anchored)?;
    let together = off(first);
    (together <= ROUNDING * most).then(|| (first - direction * first.dot(&direction), together))
}
