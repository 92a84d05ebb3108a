//! Drag of the air at triangles: cloth in the wind.

use super::drag::moved_by;
use super::{Effect, EffectRow, boxed, difference, velocity};
use crate::physics::{Derivative, ForceKinds, Jacobian, Linearization, Power};
use crate::scene::Scene;
use nalgebra::{Matrix3, Vector3};

pub(super) const ROW: EffectRow = EffectRow {
    id: "air_drag",
    summary: "drag of the air at triangles, along their normals",
    source: "F = -density C A |u·n| (u·n) n / 2, u = mean velocity of the corners less the air's, a third to each \
             corner (pressure drag of a flat plate); nothing where the area A is 0",
    elastic: false,
    constant: false,
    build: |scene| AirDrag::new(scene).map(boxed),
};

/// F = -density C A |u·n| (u·n) n / 2 on each triangle, a third to each corner.
///
/// A and n are those of the moment, and neither side is the front: n and -n give the same force. Air along the triangle
/// does nothing. Not to be confused with `drag` on particles, which knows no area and no direction.
///
/// With N = 2 A n, the cross product of two edges, and q = u·N it is -density C / 4 |q| q N / N², without a root.
pub struct AirDrag {
    triangles: Vec<Triangle>,
    /// w, m/s.
    air: [f64; 3],
}

struct Triangle {
    corners: [usize; 3],
    /// density C / 4, kg/m³.
    strength: f64,
}

/// A triangle at one moment.
struct Moment {
    /// Edges from the first corner, m.
    edges: [Vector3<f64>; 2],
    /// N, m²: twice the area, along the normal.
    normal: Vector3<f64>,
    /// 1 / N², 1/m⁴; 0 for a triangle without area.
    inverse: f64,
    /// Mean velocity of the corners, m/s, and that less the air's.
    mean: Vector3<f64>,
    relative: Vector3<f64>,
}

impl Triangle {
    fn at(&self, x: &[f64], v: &[f64], air: [f64; 3]) -> Moment {
        let [a, b, c] = self.corners;
        let edges = [b, c].map(|end| Vector3::from(difference(x, 3 * a, 3 * end)));
        let normal = edges[0].cross(&edges[1]);
        let square = normal.norm_squared();
        let [u, v, w] = self.corners.map(|i| Vector3::from(velocity(v, i)));
        let mean = (u + v + w) / 3.0;
        Moment {
            edges,
            normal,
            inverse: if square >= f64::MIN_POSITIVE {
                1.0 / square
            } else {
                0.0
            },
            mean,
            relative: mean - Vector3::from(air),
        }
    }
}

impl AirDrag {
    /// None when no triangle with a free corner drags.
    pub fn new(scene: &Scene) -> Option<Self> {
        let density = scene.air().density;
        let free = |corners: [usize; 3]| corners.iter().any(|&i| !scene.particles[i].fixed);
        let drags = scene.triangles.iter();
        let drags = drags.filter(|t| density * t.air_drag != 0.0 && free(t.corners));
        let triangles: Vec<_> = drags
            .map(|t| Triangle {
                corners: t.corners,
                strength: 0.25 * density * t.air_drag,
            })
            .collect();
        (!triangles.is_empty()).then(|| Self {
            triangles,
            air: scene.air().velocity,
        })
    }
}

impl Effect for AirDrag {
    fn members(&self) -> usize {
        self.triangles.len()
    }

    fn kinds(&self) -> ForceKinds {
        ForceKinds::NON_LINEAR | moved_by(self.air)
    }

    fn add_force(&self, _t: f64, x: &[f64], v: &[f64], f: &mut [f64]) -> Power {
        let mut power = Power::default();
        for triangle in &self.triangles {
            let now = triangle.at(x, v, self.air);
            let scale = triangle.strength * now.inverse;
            let q = now.relative.dot(&now.normal);
            let third = now.normal * (-scale * q.abs() * q / 3.0);
            for i in triangle.corners {
                for axis in 0..3 {
                    f[3 * i + axis] += third[axis];
                }
            }
            // The air injects by its force on what is at rest, of q0 = -w·N. The rest, (|q| q - |q0| q0)(q - q0),
            // dissipates; it has no difference of squares.
            let (along, still) = (now.mean.dot(&now.normal), Vector3::from(self.air));
            let still = -still.dot(&now.normal);
            power.injected -= scale * still.abs() * still * along;
            power.dissipated += scale
                * if q * still >= 0.0 {
                    along * along * (q.abs() + still.abs())
                } else {
                    along.abs() * (q * q + still * still)
                };
        }
        power
    }

    fn add_rounding(&self, _t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        for triangle in &self.triangles {
            let now = triangle.at(x, v, self.air);
            if now.inverse == 0.0 {
                continue;
            }
            let sizes = |of: &[f64]| {
                let all = triangle.corners.map(|i| Vector3::from(velocity(of, i)));
                all.iter().map(Vector3::amax).fold(0.0, f64::max)
            };
            let [first, second] = now.edges.map(|edge| edge.norm());
            // Twice the rounding of a coordinate in each edge, and that of the product.
            let turned = 4.0 * sizes(x) * (first + second) + 4.0 * first * second;
            let drifted = 4.0 * (sizes(v) + Vector3::from(self.air).amax());
            let (speed, area) = (now.relative.norm(), now.normal.norm());
            // The force is quadratic in u, and of degree 1 in N.
            let off =
                speed * (4.0 * speed * turned + 2.0 * area * drifted) + 8.0 * speed * speed * area;
            for i in triangle.corners {
                for f in &mut f[3 * i..3 * i + 3] {
                    *f += f64::EPSILON * triangle.strength.abs() * off / 3.0;
                }
            }
        }
    }

    /// ∂F/∂u = -2 s |q| N Nᵀ / N² and ∂F/∂N = -s |q| (2 N uᵀ + q - 2 q N Nᵀ / N²) / N², s the strength.
    fn add_jacobian(
        &self,
        _t: f64,
        x: &[f64],
        v: &[f64],
        linearization: Linearization,
        out: &mut Jacobian,
    ) {
        for triangle in &self.triangles {
            let now = triangle.at(x, v, self.air);
            let (n, u) = (now.normal, now.relative);
            let q = u.dot(&n);
            let scale = triangle.strength * now.inverse * q.abs();
            let by_velocity = n * n.transpose() * (-2.0 * scale / 9.0);
            let by_normal = match linearization {
                // It is no symmetric matrix.
                Linearization::Definite => Matrix3::zeros(),
                _ => {
                    let across = Matrix3::identity() - n * n.transpose() * (2.0 * now.inverse);
                    (n * u.transpose() * 2.0 + across * q) * (-scale / 3.0)
                }
            };
            let [first, second] = now.edges.map(|edge| edge.cross_matrix());
            let turns = [second - first, -second, first].map(|turn| by_normal * turn);
            for i in triangle.corners {
                for (j, by_position) in triangle.corners.into_iter().zip(&turns) {
                    out.add_block(Derivative::Position, [i, j], by_position);
                    out.add_block(Derivative::Velocity, [i, j], &by_velocity);
                }
            }
        }
    }
}
