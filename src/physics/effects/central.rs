//! Forces along the line between two particles, by their distance alone: the cubic part of springs that
//! stiffen as they stretch, and Newtonian attraction.

use super::springs::{SHORTEST, difference, dot};
use super::{Effect, EffectRow, boxed};
use crate::physics::{ForceKinds, Jacobian, Linearization, Power, Slope};
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

/// Closer than this, m, masses have no direction and no force.
const COINCIDENT: f64 = 1e-100;

/// Pairs of particles and how each pulls.
pub struct Central {
    pairs: Vec<([usize; 2], Law)>,
}

enum Law {
    /// What a spring with `cubic` q > 0 adds to its linear pull: q s³, s = l - L. The linear part and the
    /// damper of the same spring are [`Springs`](super::Springs)'.
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
    /// At a distance in m: the pull over the distance, N/m. None at coincidence, where there is no
    /// direction and no force.
    fn pull(&self, length: f64) -> Option<f64> {
        match *self {
            Self::Cubic { cubic, rest_length } if length > SHORTEST => {
                let stretch = length - rest_length;
                Some(cubic * stretch * stretch * stretch / length)
            }
            // Divided one by one: r³ may leave the range of a double.
            Self::Gravitational { strength } if length >= COINCIDENT => {
                Some(strength / length / length / length)
            }
            _ => None,
        }
    }

    /// At a distance in m, J.
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
            // Attraction falls with distance: its stiffness along the pair is negative.
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
    /// None when no spring that can move anything is cubic. A negative coefficient, which no scene
    /// file can state, softens.
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

    /// Of those that can move anything, if there are any.
    fn between(scene: &Scene, pairs: impl Iterator<Item = ([usize; 2], Law)>) -> Option<Self> {
        let moves =
            |(ends, _): &([usize; 2], Law)| !ends.iter().all(|&end| scene.particles[end].fixed);
        let pairs: Vec<_> = pairs.filter(moves).collect();
        (!pairs.is_empty()).then_some(Self { pairs })
    }

    /// Each pair with the offsets of its ends and what is between them.
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
            out.add_pair(Slope::Position, [i / 3, j / 3], law.block(d.into(), kept));
        }
    }

    fn keeps_momentum(&self) -> bool {
        true
    }

    fn keeps_angular_momentum(&self) -> bool {
        true
    }
}
