//! Newtonian attraction between chosen pairs.

use super::{Effect, EffectRow, boxed};
use crate::physics::{ForceKinds, Jacobian, Linearization, Power};
use crate::scene::Scene;
use nalgebra::{Matrix3, Vector3};

pub(super) const ROW: EffectRow = EffectRow {
    id: "gravitational",
    summary: "attraction G m1 m2 / r² between two particles",
    source: "Newton; U = -G m1 m2 / r; no softening, zero force at coincidence",
    elastic: false,
    constant: false,
    build: |scene| Gravitational::new(scene).map(boxed),
};

/// Closer than this, m, a pair has no direction and no force.
const COINCIDENT: f64 = 1e-100;

/// Pairwise attraction, singular at r = 0 and not softened.
///
/// Not to be confused with `gravity`, the uniform field.
pub struct Gravitational {
    pairs: Vec<Pair>,
}

struct Pair {
    ends: [usize; 2],
    /// G m1 m2, N m².
    strength: f64,
}

impl Pair {
    /// From the first end to the second, and its length.
    fn separation(&self, x: &[f64]) -> (Vector3<f64>, f64) {
        let [i, j] = self.ends;
        let d = Vector3::from_fn(|a, _| x[3 * j + a] - x[3 * i + a]);
        (d, d.norm())
    }
}

impl Gravitational {
    /// None without pairs of non-zero G.
    pub fn new(scene: &Scene) -> Option<Self> {
        let pairs: Vec<_> = scene
            .gravitational
            .iter()
            .filter(|pair| pair.g != 0.0)
            .filter(|pair| !pair.ends.iter().all(|&end| scene.particles[end].fixed))
            .map(|pair| Pair {
                ends: pair.ends,
                strength: pair.g
                    * scene.particles[pair.ends[0]].mass
                    * scene.particles[pair.ends[1]].mass,
            })
            .collect();
        (!pairs.is_empty()).then_some(Self { pairs })
    }
}

impl Effect for Gravitational {
    fn members(&self) -> usize {
        self.pairs.len()
    }

    fn kinds(&self) -> ForceKinds {
        ForceKinds::NONE
    }

    fn add_force(&self, _t: f64, x: &[f64], _v: &[f64], f: &mut [f64]) -> Power {
        for pair in &self.pairs {
            let (d, r) = pair.separation(x);
            if r < COINCIDENT {
                continue;
            }
            let [i, j] = pair.ends;
            // Divided one by one: r³ may leave the range of a double.
            let per_length = pair.strength / r / r / r;
            for axis in 0..3 {
                f[3 * i + axis] += per_length * d[axis];
                f[3 * j + axis] -= per_length * d[axis];
            }
        }
        Power::default()
    }

    fn potential(&self, _t: f64, x: &[f64]) -> f64 {
        let one = |pair: &Pair| -pair.strength / pair.separation(x).1.max(COINCIDENT);
        self.pairs.iter().map(one).sum()
    }

    fn add_jacobian(
        &self,
        _t: f64,
        x: &[f64],
        _v: &[f64],
        linearization: Linearization,
        out: &mut Jacobian,
    ) {
        // Attraction falls with distance: its stiffness along the pair is negative.
        let along = match linearization {
            Linearization::Definite => 1.0,
            Linearization::Exact | Linearization::Material => 3.0,
        };
        for pair in &self.pairs {
            let (d, r) = pair.separation(x);
            let block = if r < COINCIDENT {
                Matrix3::zeros()
            } else {
                let n = d / r;
                (Matrix3::identity() - along * n * n.transpose()) * (pair.strength / r / r / r)
            };
            out.add_pair(pair.ends[0], pair.ends[1], Some(&block), None);
        }
    }

    fn keeps_momentum(&self) -> bool {
        true
    }

    fn keeps_angular_momentum(&self) -> bool {
        true
    }
}
