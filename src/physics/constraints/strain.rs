//! The strain limit: after a step, springs that are too long are shortened (Provot 1995, Graphics Interface).
//!
//! Springs are corrected one after the other, in the order of the scene, each by moving its ends along the line between
//! them: by their 1/m, so that the centre of mass stays, and the free one alone where the other is fixed. Of velocities
//! the part that goes on stretching is taken out, by an impulse along the line. A correction disturbs the neighbours, so
//! such sweeps are repeated. What comes out depends on the order, the number of sweeps and the timestep.
//!
//! Momentum is kept, up to the impulses on fixed ends. Angular momentum is not: moving the ends by s along n, while they
//! turn about each other with u, changes it by s n × u.

use super::ConstraintRow;
use super::{RodError, Rods};
use crate::scene::Scene;
use crate::space::dot;

/// Lengths within this part of a limit are at it.
const SLACK: f64 = 1e-9;

/// What was done to a state within and after steps.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Corrections {
    /// Springs corrected, each time counted.
    pub springs: u64,
    /// Sweeps that corrected any.
    pub sweeps: u64,
    /// The sum of the impulses that acted on fixed ends, N s.
    pub impulse: [f64; 3],
    /// Impacts on obstacles.
    pub impacts: u64,
}

impl std::ops::AddAssign for Corrections {
    fn add_assign(&mut self, other: Self) {
        self.springs += other.springs;
        self.sweeps += other.sweeps;
        self.impacts += other.impacts;
        for (sum, part) in self.impulse.iter_mut().zip(other.impulse) {
            *sum += part;
        }
    }
}

pub(super) const ROW: ConstraintRow = ConstraintRow {
    id: "strain_limit",
    summary: "shorten springs beyond a share of their rest length, after each step",
    source: "ends move along the spring by their share of 1/m, and what parts them of their velocities is taken out; Provot \
             1995, Graphics Interface",
};

/// The springs of a scene that have a strain limit, in the order of the scene.
#[derive(Debug, Clone, PartialEq)]
pub struct StrainLimiter {
    ends: Vec<[u32; 2]>,
    /// The squared lengths, m², at which a correction begins: below the first, above the second.
    allowed: Vec<[f64; 2]>,
    springs: Vec<Limited>,
    iterations: usize,
    /// Whether velocities are corrected, not positions alone.
    velocities: bool,
}

/// A spring with a limit.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Limited {
    /// The shortest and the longest length, m.
    lengths: [f64; 2],
    /// The part of a correction that each end moves by.
    shares: [f64; 2],
    /// 1 over the sum of the ends' 1/m, kg.
    mass: f64,
}

impl StrainLimiter {
    /// None where the scene has no limit, or no spring that it could act on: one with a rest length and a free end.
    pub fn new(scene: &Scene) -> Option<Self> {
        let limit = scene.strain_limit.as_ref()?;
        let mut limiter = Self {
            ends: Vec::new(),
            allowed: Vec::new(),
            springs: Vec::new(),
            iterations: limit.iterations,
            velocities: true,
        };
        let weights = scene.particles.iter();
        let weights: Vec<f64> = weights
            .map(|p| if p.fixed { 0.0 } else { 1.0 / p.mass })
            .collect();
        for spring in &scene.springs {
            let [a, b] = spring.ends.map(|end| weights[end]);
            let rest = spring.rest_length;
            if rest == 0.0 || a + b == 0.0 {
                continue;
            }
            let shortest = match limit.also_compression {
                true => (rest * (1.0 - limit.ratio)).max(0.0),
                false => 0.0,
            };
            let longest = rest * (1.0 + limit.ratio);
            limiter.ends.push(spring.ends.map(|end| end as u32));
            let (below, above) = (shortest * (1.0 - SLACK), longest * (1.0 + SLACK));
            limiter.allowed.push([below * below, above * above]);
            limiter.springs.push(Limited {
                lengths: [shortest, longest],
                shares: [a / (a + b), b / (a + b)],
                mass: 1.0 / (a + b),
            });
        }
        (!limiter.springs.is_empty()).then_some(limiter)
    }

    /// The same where every free mass is 1.
    pub fn with_unit_masses(&self) -> Self {
        let unit = |limited: &Limited| {
            let [a, b] = limited.shares.map(|share| f64::from(share > 0.0));
            Limited {
                shares: [a / (a + b), b / (a + b)],
                mass: 1.0 / (a + b),
                ..*limited
            }
        };
        Self {
            springs: self.springs.iter().map(unit).collect(),
            ..self.clone()
        }
    }

    /// The same of positions alone. What it holds at rest falls faster and faster.
    pub fn of_positions(&self) -> Self {
        Self {
            velocities: false,
            ..self.clone()
        }
    }

    /// Whether some spring is beyond its limit at positions `x`, m.
    pub fn is_exceeded(&self, x: &[f64]) -> bool {
        let x = x.as_chunks().0;
        let beyond = |(ends, allowed): (&[u32; 2], &[f64; 2])| {
            let square = square(apart(x, *ends));
            (square < allowed[0]) | (square > allowed[1])
        };
        // Blocks without a branch inside are faster.
        const BLOCK: usize = 64;
        let blocks = self.ends.chunks(BLOCK).zip(self.allowed.chunks(BLOCK));
        let mut blocks = blocks.map(|(ends, allowed)| ends.iter().zip(allowed));
        blocks.any(|block| block.map(beyond).fold(false, |any, one| any | one))
    }

    /// Sweeps until no spring is beyond its limit, or the iterations are used up. After each sweep the state is moved onto
    /// the rods, which hold at the end.
    ///
    /// # Errors
    /// [`RodError`] where it cannot be moved onto them; the state is then of no use.
    pub fn correct(
        &self,
        rods: Option<&Rods>,
        x: &mut [f64],
        v: &mut [f64],
    ) -> Result<Corrections, RodError> {
        let mut all = Corrections::default();
        for _ in 0..self.iterations {
            let before = all.springs;
            self.sweep(x, v, &mut all);
            if all.springs == before {
                break;
            }
            all.sweeps += 1;
            if let Some(rods) = rods {
                rods.project(x, v)?;
            }
        }
        Ok(all)
    }

    fn sweep(&self, x: &mut [f64], v: &mut [f64], done: &mut Corrections) {
        let (x, v) = (x.as_chunks_mut().0, v.as_chunks_mut().0);
        let springs = self.ends.iter().zip(&self.allowed).zip(&self.springs);
        for ((ends, allowed), limited) in springs {
            let d = apart(x, *ends);
            let square = square(d);
            let long = square > allowed[1];
            // Neither NaN nor ends in one place have a direction.
            if (long || square < allowed[0]) && square > 0.0 && square.is_finite() {
                let wanted = limited.lengths[usize::from(long)];
                let u = apart(v, *ends);
                let along = dot(u, d) / square;
                let outward = if long { along > 0.0 } else { along < 0.0 };
                let slow = if outward && self.velocities {
                    along
                } else {
                    0.0
                };
                limited.correct(*ends, d, 1.0 - wanted / square.sqrt(), slow, x, v);
                limited.book(d, slow, &mut done.impulse);
                done.springs += 1;
            }
        }
    }
}

impl Limited {
    /// Moves the ends, which are `d` apart, by this part of d in all, and takes so many times d out of their velocity.
    #[inline(always)]
    fn correct(
        &self,
        [i, j]: [u32; 2],
        d: [f64; 3],
        part: f64,
        slow: f64,
        x: &mut Vectors,
        v: &mut Vectors,
    ) {
        let [a, b] = self.shares;
        for axis in 0..3 {
            let (way, lost) = (part * d[axis], slow * d[axis]);
            x[i as usize][axis] += a * way;
            x[j as usize][axis] -= b * way;
            v[i as usize][axis] += a * lost;
            v[j as usize][axis] -= b * lost;
        }
    }

    /// Adds the impulse on the end that is fixed.
    #[inline(always)]
    fn book(&self, d: [f64; 3], slow: f64, impulse: &mut [f64; 3]) {
        let sign = match self.shares {
            [0.0, _] => 1.0,
            [_, 0.0] => -1.0,
            _ => return,
        };
        for (sum, d) in impulse.iter_mut().zip(d) {
            *sum += sign * self.mass * slow * d;
        }
    }
}

/// A flat vector of length 3n, particle by particle.
type Vectors = [[f64; 3]];

/// From the first end to the second.
#[inline(always)]
fn apart(y: &Vectors, [i, j]: [u32; 2]) -> [f64; 3] {
    let (one, other) = (y[i as usize], y[j as usize]);
    [other[0] - one[0], other[1] - one[1], other[2] - one[2]]
}

#[inline(always)]
fn square(d: [f64; 3]) -> f64 {
    dot(d, d)
}
