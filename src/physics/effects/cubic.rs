//! The cubic part of springs that stiffen as they stretch.

use super::springs::{SHORTEST, difference, dot};
use super::{Effect, EffectRow, boxed};
use crate::physics::{ForceKinds, Jacobian, Linearization, Power};
use crate::scene::Scene;
use nalgebra::{Matrix3, Vector3};

pub(super) const ROW: EffectRow = EffectRow {
    id: "cubic_springs",
    summary: "the cubic part of springs with a `cubic` coefficient",
    source: "f = q (l - L)³ n; U = q (l - L)⁴ / 4",
    elastic: true,
    constant: false,
    build: |scene| CubicSprings::new(scene).map(boxed),
};

/// What springs with `cubic` q > 0 add to their linear pull: q s³ along the spring, s = l - L.
///
/// The linear part and the damper of the same spring are [`Springs`](super::Springs)'.
/// Coincident ends: no force, as there.
pub struct CubicSprings {
    springs: Vec<Cubic>,
}

struct Cubic {
    ends: [usize; 2],
    /// q, N/m³.
    cubic: f64,
    /// L, m.
    rest_length: f64,
}

impl CubicSprings {
    /// None when no spring that can move anything is cubic. A negative coefficient, which no scene
    /// file can state, softens.
    pub fn new(scene: &Scene) -> Option<Self> {
        let springs: Vec<_> = scene
            .springs
            .iter()
            .filter(|s| s.cubic != 0.0)
            .filter(|s| !s.ends.iter().all(|&end| scene.particles[end].fixed))
            .map(|s| Cubic {
                ends: s.ends,
                cubic: s.cubic,
                rest_length: s.rest_length,
            })
            .collect();
        (!springs.is_empty()).then_some(Self { springs })
    }
}

impl Effect for CubicSprings {
    fn members(&self) -> usize {
        self.springs.len()
    }

    fn kinds(&self) -> ForceKinds {
        ForceKinds::NONE
    }

    fn add_force(&self, _t: f64, x: &[f64], _v: &[f64], f: &mut [f64]) -> Power {
        for spring in &self.springs {
            let [i, j] = spring.ends.map(|end| 3 * end);
            let d = difference(x, i, j);
            let length = dot(d, d).sqrt().max(SHORTEST);
            let stretch = length - spring.rest_length;
            let along = spring.cubic * stretch * stretch * stretch / length;
            for axis in 0..3 {
                f[i + axis] += along * d[axis];
                f[j + axis] -= along * d[axis];
            }
        }
        Power::default()
    }

    fn potential(&self, _t: f64, x: &[f64]) -> f64 {
        let one = |spring: &Cubic| {
            let [i, j] = spring.ends.map(|end| 3 * end);
            let d = difference(x, i, j);
            let stretch = dot(d, d).sqrt() - spring.rest_length;
            0.25 * spring.cubic * stretch * stretch * stretch * stretch
        };
        self.springs.iter().map(one).sum()
    }

    fn add_jacobian(
        &self,
        _t: f64,
        x: &[f64],
        _v: &[f64],
        linearization: Linearization,
        out: &mut Jacobian,
    ) {
        for spring in &self.springs {
            let [i, j] = spring.ends.map(|end| 3 * end);
            let d = Vector3::from(difference(x, i, j));
            let length = d.norm();
            // At coincidence there is no direction; without rest length the slope there is 0, too.
            let block = if length <= SHORTEST {
                Matrix3::zeros()
            } else {
                let stretch = length - spring.rest_length;
                let squared = spring.cubic * stretch * stretch;
                let n = d / length;
                let axial = n * n.transpose();
                let material = axial * (3.0 * squared);
                let across = Matrix3::identity() - axial;
                let tension = squared * stretch / length;
                match linearization {
                    Linearization::Material => material,
                    Linearization::Exact => material + across * tension,
                    Linearization::Definite => material + across * tension.max(0.0),
                }
            };
            let [i, j] = spring.ends;
            out.add_pair(i, j, Some(&block), None);
        }
    }

    fn keeps_momentum(&self) -> bool {
        true
    }

    fn keeps_angular_momentum(&self) -> bool {
        true
    }
}
