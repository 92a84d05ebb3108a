//! Whether all motion of a group stays on one line, and how far rounding may push it off.

use super::group::Group;
use super::lengths::Bounds;
use super::mode::Mode;
use super::vector::{across, norm, unit};
use crate::scene::Drive;
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
    pub offset: Offset,
}

/// The same mode without stiffness in every direction, from 0 at this velocity.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Drift {
    pub mode: Mode,
    pub velocity: Vector3<f64>,
    pub pull: Vector3<f64>,
}

impl Drift {
    pub fn is_still(&self) -> bool {
        self.velocity == Vector3::zeros() && self.pull == Vector3::zeros()
    }
}

/// The largest position (m), velocity and acceleration across the line.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Offset {
    pub position: f64,
    pub velocity: f64,
    pub pull: f64,
}

impl Offset {
    /// Whether every particle is on the line to the last bit.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

impl Line {
    /// The line of a group; None if motion leaves it by more than the rounding of the scene's numbers.
    pub fn of(group: &Group) -> Option<Self> {
        let velocities: Vec<_> = group.bodies.iter().map(|b| b.velocity).collect();
        let pulls: Vec<_> = group.bodies.iter().map(|b| b.constant).collect();
        let ends = group.links.iter().flat_map(|link| link.at);
        let points: Vec<_> = ends
            .chain(group.bodies.iter().map(|b| b.position))
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
        let drives = group.links.iter().flat_map(|l| &l.drives).flatten();
        let aside = |drive: &Drive| {
            let swing = drive.sine().map(|sine| sine.amplitude).or(drive.steady());
            swing.is_none_or(|swing| across(Vector3::from(swing), along) != 0.0)
        };
        // A motion aside, by however little, may be in resonance across the line.
        if drives.into_iter().any(aside) {
            return None;
        }
        let anchored = group.links.iter().any(|l| l.ends.contains(&None));
        let (velocity, off_velocity) = common(&velocities, along, direction, anchored)?;
        let (pull, off_pull) = common(&pulls, along, direction, anchored)?;
        let mut line = Self {
            direction,
            drift: Drift {
                velocity,
                pull,
                ..Drift::default()
            },
            offset: Offset {
                position,
                velocity: off_velocity,
                pull: off_pull,
            },
        };
        if !line.drift.is_still() {
            let rates = || group.bodies.iter().map(|b| b.drag / b.mass);
            let high = rates().fold(0.0, f64::max);
            let low = rates().fold(high, f64::min);
            if high - low > ROUNDING * high {
                return None;
            }
            line.drift.mode.g = 0.5 * high;
            let gained = norm(pull) * group.until.min(1.0 / high);
            line.offset.pull += (high - low) * (norm(velocity) + gained);
        }
        Some(line)
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

/// The part across the line that these vectors share, and their largest distance from it. The part
/// is 0 if they lie along the line, and the first one's if nothing is anchored and all agree.
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

/// Growth of small offsets across a line of springs.
///
/// Across the line a spring under tension N acts like one of stiffness N / l, which changes as the
/// spring works, so that offsets may grow: by compression, or as the swing of a pendulum of springs
/// is pumped. With all stiffness over mass between `low` and `high`, and any reference c > 0,
/// |y'|² + c |y|² grows no faster than at twice max(high - c, c - low) / 2 √c.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sideways {
    offset: Offset,
    /// Largest over smallest mass norm of a unit offset.
    spread: f64,
    /// Bounds on the stiffness across the line over the mass, 1/s².
    low: f64,
    high: f64,
}

impl Sideways {
    /// None where a damper without a shortest length makes the stiffness unbounded. `lengths` are of the
    /// springs with a rest length, in order.
    pub fn new(group: &Group, offset: Offset, lengths: &[Bounds]) -> Option<Self> {
        let masses = || group.bodies.iter().map(|b| b.mass);
        // Bounds for each particle, by Gershgorin's rows.
        let (mut low, mut high) = (vec![0.0; masses().len()], vec![0.0; masses().len()]);
        let mut lengths = lengths.iter();
        for link in &group.links {
            let (spring, damping) = (link.spring, link.axial_damping);
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
                low[i] += free.len() as f64 * least.min(0.0) / group.bodies[i].mass;
                high[i] += free.len() as f64 * most.max(0.0) / group.bodies[i].mass;
            }
        }
        let lightest = masses().fold(f64::INFINITY, f64::min);
        Some(Self {
            offset,
            spread: (masses().sum::<f64>() / lightest).sqrt(),
            low: low.into_iter().fold(0.0, f64::min),
            high: high.into_iter().fold(0.0, f64::max),
        })
    }

    /// Bound on the distance of any particle from the line in [0, t], m.
    pub fn bound(&self, t: f64) -> f64 {
        let Self {
            low, high, offset, ..
        } = *self;
        if t == 0.0 {
            return self.spread * offset.position;
        }
        let c = (0.5 * (low + high)).max(-low).max(1.0 / (t * t));
        let rate = (high - c).max(c - low) / (2.0 * c.sqrt());
        let start = offset
            .position
            .hypot((offset.velocity + offset.pull * t) / c.sqrt());
        // Twice, for terms of second order in the offset.
        2.0 * self.spread * start * (rate * t).exp()
    }
}
