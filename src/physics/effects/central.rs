//! Forces along the line between two particles that depend on their distance alone: the cubic part of
//! springs that stiffen as they stretch, and Newtonian attraction.

use super::springs::{Line, SHORTEST};
use super::{Effect, EffectRow, FEW_OPERATIONS, boxed, difference, dot};
use crate::physics::{Derivative, ForceKinds, Jacobian, Linearization, Power};
use crate::scene::Scene;
use nalgebra::{Matrix3, Vector3};

pub(super) const CUBIC: EffectRow = EffectRow {
    id: "cubic_springs",
    summary: "the cubic part of springs with a `cubic` coefficient",
    source: "f = q (l - L)³ n; U = q (l - L)⁴ / 4",
    elastic: true,
    constant: false,
    build: |scene| Central::cubic(scene).map(boxed),
};

pub(super) const GRAVITATIONAL: EffectRow = EffectRow {
    id: "gravitational",
    summary: "attraction G m1 m2 / r² between two particles",
    source: "Newton; U = -G m1 m2 / r; no softening, zero force at coincidence",
    elastic: false,
    constant: false,
    build: |scene| Central::gravitational(scene).map(boxed),
};

/// Attracting particles closer than this, m, have no direction and so no force.
const COINCIDENT: f64 = 1e-100;

/// Pairs of particles, each with its law of force.
pub struct Central {
    pairs: Vec<([usize; 2], Law)>,
}

enum Law {
    /// The cubic part of a spring's pull: q s³, s = l - L. [`Springs`](super::Springs) adds the linear part
    /// and the damper of the same spring.
    Cubic {
        /// q, N/m³.
        cubic: f64,
        /// L, m.
        rest_length: f64,
    },
    /// Attraction, singular at r = 0 and not softened. Not to be confused with `gravity`, the uniform field.
    Gravitational {
        /// G m1 m2, N m².
        strength: f64,
    },
}

impl Law {
    /// The pull divided by the distance, N/m, at a distance in m. None at coincidence, where there is no
    /// direction and no force.
    fn pull(&self, length: f64) -> Option<f64> {
        match *self {
            Self::Cubic { cubic, rest_length } if length > SHORTEST => {
                let stretch = length - rest_length;
                Some(cubic * stretch * stretch * stretch / length)
            }
            // Three divisions, since r³ may leave the range of a double.
            Self::Gravitational { strength } if length >= COINCIDENT => {
                Some(strength / length / length / length)
            }
            _ => None,
        }
    }

    /// The potential energy at a distance in m, J.
    fn potential(&self, length: f64) -> f64 {
        match *self {
            Self::Cubic { cubic, rest_length } => {
                let stretch = length - rest_length;
                0.25 * cubic * stretch * stretch * stretch * stretch
            }
            Self::Gravitational { strength } => -strength / length.max(COINCIDENT),
        }
    }

    /// ∂f_i/∂(x_j - x_i) for the separation d from i to j.
    fn block(&self, d: Vector3<f64>, kept: Linearization) -> Matrix3<f64> {
        let length = d.norm();
        let Some(pull) = self.pull(length) else {
            return Matrix3::zeros();
        };
        let (n, identity) = (d / length, Matrix3::identity());
        match *self {
            Self::Cubic { cubic, rest_length } => {
                let stretch = length - rest_length;
                let axial = n * n.transpose();
                let across = match kept {
                    Linearization::Exact => pull,
                    Linearization::Definite => pull.max(0.0),
                    Linearization::Material => 0.0,
                };
                axial * (3.0 * (cubic * stretch * stretch)) + (identity - axial) * across
            }
            // Attraction falls with distance, so its stiffness along the pair is negative.
            Self::Gravitational { .. } => {
                let along = if kept == Linearization::Definite {
                    1.0
                } else {
                    3.0
                };
                (identity - along * n * n.transpose()) * pull
            }
        }
    }
}

impl Central {
    /// None when no spring with a free end is cubic. A negative coefficient, which no scene file can state,
    /// softens the spring.
    fn cubic(scene: &Scene) -> Option<Self> {
        let cubic = scene.springs.iter().filter(|s| s.cubic != 0.0);
        let law = |s: &crate::scene::Spring| Law::Cubic {
            cubic: s.cubic,
            rest_length: s.rest_length,
        };
        Self::between(scene, cubic.map(|s| (s.ends, law(s))))
    }

    /// None without pairs of non-zero G.
    fn gravitational(scene: &Scene) -> Option<Self> {
        let pairs = scene.gravitational.iter().filter(|pair| pair.g != 0.0);
        let law = |pair: &crate::scene::GravitationalPair| {
            let [first, second] = pair.ends.map(|end| scene.particles[end].mass);
            Law::Gravitational {
                strength: pair.g * first * second,
            }
        };
        Self::between(scene, pairs.map(|pair| (pair.ends, law(pair))))
    }

    /// The pairs with a free end; None if there are none.
    fn between(scene: &Scene, pairs: impl Iterator<Item = ([usize; 2], Law)>) -> Option<Self> {
        let moves =
            |(ends, _): &([usize; 2], Law)| !ends.iter().all(|&end| scene.particles[end].fixed);
        let pairs: Vec<_> = pairs.filter(moves).collect();
        (!pairs.is_empty()).then_some(Self { pairs })
    }

    /// Each law with the offsets of its pair's ends and the vector between them.
    fn separations(&self, x: &[f64]) -> impl Iterator<Item = (&Law, [usize; 2], [f64; 3])> {
        self.pairs.iter().map(|(ends, law)| {
            let [i, j] = ends.map(|end| 3 * end);
            (law, [i, j], difference(x, i, j))
        })
    }
}

impl Effect for Central {
    fn members(&self) -> usize {
        self.pairs.len()
    }

    fn kinds(&self) -> ForceKinds {
        ForceKinds::NONE
    }

    fn add_force(&self, _t: f64, x: &[f64], _v: &[f64], f: &mut [f64]) -> Power {
        for (law, [i, j], d) in self.separations(x) {
            if let Some(pull) = law.pull(dot(d, d).sqrt()) {
                for axis in 0..3 {
                    f[i + axis] += pull * d[axis];
                    f[j + axis] -= pull * d[axis];
                }
            }
        }
        Power::default()
    }

    fn add_rounding(&self, _t: f64, x: &[f64], _v: &[f64], f: &mut [f64]) {
        for (law, [i, j], d) in self.separations(x) {
            let Some(pull) = law.pull(dot(d, d).sqrt()) else {
                continue;
            };
            let line = Line::new(x, i, j);
            // The force as a power of what it depends on: its relative rounding is so many times larger.
            let relative = match *law {
                Law::Cubic { rest_length, .. } => {
                    let stretch = (line.length - rest_length).abs();
                    3.0 * (line.off + 2.0 * f64::EPSILON * rest_length) / stretch.max(line.off)
                }
                Law::Gravitational { .. } => 3.0 * line.off / line.length,
            };
            for axis in 0..3 {
                let size = pull.abs() * line.length;
                let off = size
                    * (line.turned[axis]
                        + (relative + 2.0 * FEW_OPERATIONS) * line.direction[axis].abs());
                f[i + axis] += off;
                f[j + axis] += off;
            }
        }
    }

    fn potential(&self, _t: f64, x: &[f64]) -> f64 {
        let separations = self.separations(x);
        separations
            .map(|(law, _, d)| law.potential(dot(d, d).sqrt()))
            .sum()
    }

    fn add_jacobian(
        &self,
        _t: f64,
        x: &[f64],
        _v: &[f64],
        kept: Linearization,
        out: &mut Jacobian,
    ) {
        for (law, [i, j], d) in self.separations(x) {
            out.add_pair(
                Derivative::Position,
                [i / 3, j / 3],
                law.block(d.into(), kept),
            );
        }
    }

    fn keeps_momentum(&self) -> bool {
        true
    }

    fn keeps_angular_momentum(&self) -> bool {
        true
    }
}
