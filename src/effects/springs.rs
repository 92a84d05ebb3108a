//! Springs with dampers, fused in one loop.

use super::{Effect, EffectRow, boxed};
use crate::scene::{DampingModel, Scene};
use crate::system::{Jacobian, Linearization, Power};
use nalgebra::{Matrix3, Vector3};

pub(super) const ROW: EffectRow = EffectRow {
    id: "springs",
    summary: "linear springs with axial or isotropic dampers",
    source: "f = k (l - L) n + c (v·n) n (axial) or c v (isotropic); U = k (l - L)² / 2",
    elastic: true,
    constant: false,
    build: |scene| Springs::new(scene).map(boxed),
};

/// Lengths are not taken below this, m: at coincidence the direction d / l is then 0 and so is the
/// force, with no branch and no NaN. A rest length of 0 stays exactly linear through the point.
pub(super) const SHORTEST: f64 = 1e-150;

/// One spring: 40 bytes.
#[derive(Debug, Clone, Copy)]
pub struct Spring {
    /// Particle indices.
    pub ends: [u32; 2],
    /// k, N/m.
    pub stiffness: f64,
    /// c, N s/m.
    pub damping: f64,
    /// L, m.
    pub rest_length: f64,
}

/// All springs of a scene: their linear part, and their dampers. What `cubic` adds is
/// [`CubicSprings`](super::CubicSprings)'.
///
/// Coincident ends: no force from a spring or an axial damper, since neither has a direction there;
/// an isotropic damper still acts.
pub struct Springs {
    springs: Vec<Spring>,
    damping: Damping,
}

/// Which loop runs; chosen once, so no spring pays for a branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Damping {
    None,
    Axial,
    Isotropic,
}

const NONE: u8 = Damping::None as u8;
const AXIAL: u8 = Damping::Axial as u8;
const ISOTROPIC: u8 = Damping::Isotropic as u8;

impl Springs {
    /// None when the scene has no springs but purely cubic ones.
    pub fn new(scene: &Scene) -> Option<Self> {
        let springs: Vec<_> = scene
            .springs
            .iter()
            // Between two fixed particles a spring moves nothing, and what is fixed has no energy.
            .filter(|s| !s.ends.iter().all(|&end| scene.particles[end].fixed))
            // All that such a spring does is `cubic_springs`'.
            .filter(|s| s.stiffness != 0.0 || s.damping != 0.0 || s.cubic == 0.0)
            .map(|s| Spring {
                ends: s.ends.map(|end| end as u32),
                stiffness: s.stiffness,
                damping: s.damping,
                rest_length: s.rest_length,
            })
            .collect();
        let damping = match scene.damping_model {
            _ if springs.iter().all(|s| s.damping == 0.0) => Damping::None,
            DampingModel::Axial => Damping::Axial,
            DampingModel::Isotropic => Damping::Isotropic,
        };
        (!springs.is_empty()).then_some(Self { springs, damping })
    }

    /// Both parts of the force in one pass, so positions are loaded once.
    fn accumulate<const MODEL: u8>(&self, x: &[f64], v: &[f64], f: &mut [f64]) -> Power {
        let mut dissipated = 0.0;
        for spring in &self.springs {
            let (i, j) = (3 * spring.ends[0] as usize, 3 * spring.ends[1] as usize);
            let d = difference(x, i, j);
            let length = dot(d, d).sqrt().max(SHORTEST);
            let mut along = spring.stiffness * (length - spring.rest_length) / length;
            let mut force = [0.0; 3];
            if MODEL == AXIAL {
                let dv = difference(v, i, j);
                let rate = dot(dv, d) / length;
                along += spring.damping * rate / length;
                dissipated += spring.damping * rate * rate;
            }
            for axis in 0..3 {
                force[axis] = along * d[axis];
            }
            if MODEL == ISOTROPIC {
                let dv = difference(v, i, j);
                for axis in 0..3 {
                    force[axis] += spring.damping * dv[axis];
                }
                dissipated += spring.damping * dot(dv, dv);
            }
            for axis in 0..3 {
                f[i + axis] += force[axis];
                f[j + axis] -= force[axis];
            }
        }
        Power {
            dissipated,
            injected: 0.0,
        }
    }

    /// ∂f_i/∂(x_j - x_i) and ∂f_i/∂(v_j - v_i) of one spring.
    fn blocks(
        &self,
        spring: &Spring,
        x: &[f64],
        v: &[f64],
        linearization: Linearization,
    ) -> (Matrix3<f64>, Matrix3<f64>) {
        let (i, j) = (3 * spring.ends[0] as usize, 3 * spring.ends[1] as usize);
        let d = Vector3::from(difference(x, i, j));
        let length = d.norm();
        let (k, c) = (spring.stiffness, spring.damping);
        let identity = Matrix3::identity();
        if length <= SHORTEST {
            // Without a direction n there is no k n nᵀ, although the exact stiffness is k.
            let exact = linearization != Linearization::Material;
            let position = if exact && spring.rest_length == 0.0 {
                identity * k
            } else {
                Matrix3::zeros()
            };
            let isotropic = self.damping == Damping::Isotropic;
            return (position, identity * if isotropic { c } else { 0.0 });
        }
        let n = d / length;
        let axial = n * n.transpose();
        let velocity = match self.damping {
            Damping::None => Matrix3::zeros(),
            Damping::Axial => axial * c,
            Damping::Isotropic => identity * c,
        };
        let mut position = axial * k;
        if linearization != Linearization::Material {
            let definite = linearization == Linearization::Definite;
            let across = identity - axial;
            let tension = k * (length - spring.rest_length) / length;
            position += across * if definite { tension.max(0.0) } else { tension };
            if !definite && self.damping == Damping::Axial {
                let dv = Vector3::from(difference(v, i, j));
                let turned = n * (dv.transpose() * across) + across * dv.dot(&n);
                position += turned * (c / length);
            }
        }
        (position, velocity)
    }
}

impl Effect for Springs {
    fn members(&self) -> usize {
        self.springs.len()
    }

    fn add_force(&self, _t: f64, x: &[f64], v: &[f64], f: &mut [f64]) -> Power {
        match self.damping {
            Damping::None => self.accumulate::<NONE>(x, v, f),
            Damping::Axial => self.accumulate::<AXIAL>(x, v, f),
            Damping::Isotropic => self.accumulate::<ISOTROPIC>(x, v, f),
        }
    }

    fn potential(&self, _t: f64, x: &[f64]) -> f64 {
        let mut energy = 0.0;
        for spring in &self.springs {
            let (i, j) = (3 * spring.ends[0] as usize, 3 * spring.ends[1] as usize);
            let d = difference(x, i, j);
            let stretch = dot(d, d).sqrt() - spring.rest_length;
            energy += 0.5 * spring.stiffness * stretch * stretch;
        }
        energy
    }

    fn is_damped(&self) -> bool {
        self.damping != Damping::None
    }

    fn add_damping(&self, x: &[f64], w: &[f64], f: &mut [f64]) {
        for spring in &self.springs {
            let (i, j) = (3 * spring.ends[0] as usize, 3 * spring.ends[1] as usize);
            let mut force = difference(w, i, j).map(|dw| spring.damping * dw);
            if self.damping == Damping::Axial {
                let d = difference(x, i, j);
                let length = dot(d, d).sqrt().max(SHORTEST);
                let along = dot(force, d) / length / length;
                force = d.map(|d| along * d);
            }
            for axis in 0..3 {
                f[i + axis] += force[axis];
                f[j + axis] -= force[axis];
            }
        }
    }

    fn add_jacobian(
        &self,
        _t: f64,
        x: &[f64],
        v: &[f64],
        linearization: Linearization,
        out: &mut Jacobian,
    ) {
        for spring in &self.springs {
            let (position, velocity) = self.blocks(spring, x, v, linearization);
            let [i, j] = spring.ends.map(|end| end as usize);
            let velocity = self.is_damped().then_some(&velocity);
            out.add_pair(i, j, Some(&position), velocity);
        }
    }

    fn keeps_momentum(&self) -> bool {
        true
    }

    fn keeps_angular_momentum(&self) -> bool {
        self.damping != Damping::Isotropic
    }
}

/// From particle at offset `i` to the one at offset `j`.
#[inline(always)]
pub(super) fn difference(x: &[f64], i: usize, j: usize) -> [f64; 3] {
    let (from, to) = (&x[i..i + 3], &x[j..j + 3]);
    [to[0] - from[0], to[1] - from[1], to[2] - from[2]]
}

#[inline(always)]
pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
