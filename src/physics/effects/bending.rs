//! Hinges that resist bending: an energy of the angle by which three particles in a row turn.

use super::springs::SHORTEST;
use super::{Effect, EffectRow, FEW_OPERATIONS, boxed};
use crate::physics::{Derivative, ForceKinds, Jacobian, Linearization, Power, Sweep};
use crate::scene::{Bending, Scene};
use nalgebra::{Matrix2, Matrix3, SMatrix, SVector, Vector2, Vector3};

pub(super) const ROW: EffectRow = EffectRow {
    id: "bending",
    summary: "hinges with a bending stiffness at the middle of three particles",
    source: "U = kb (θ - θ0)² / 2, θ the turning angle at the middle particle, 0 where straight; damper -c θ' grad θ; \
             Bergou et al. 2008, Discrete elastic rods, with θ for 2 tan(θ/2)",
    elastic: true,
    constant: false,
    build: |scene| BendingForce::new(scene).map(boxed),
};

/// The moment -kb (θ - θ0) - c θ' at the middle of three particles, as forces on all three.
///
/// θ in [0, π] is the angle between the directions of the two links, 0 where they are in line. Where it has no
/// gradient no force acts: folded back (θ = π), a link of no length, and straight (θ = 0) if θ0 is not 0. Straight
/// with θ0 = 0 the force is 0 and its stiffness smooth; there the damper resists turning to any side, as it does at
/// the first instant of any such motion.
///
/// Not to be confused with a spring between every second particle, which has no linear stiffness against bending:
/// its energy k L² θ⁴ / 32 is of the fourth order.
pub struct BendingForce {
    hinges: Vec<Bending>,
    kinds: ForceKinds,
}

impl BendingForce {
    /// None when no hinge with a free particle has a stiffness or a damper.
    pub fn new(scene: &Scene) -> Option<Self> {
        let acts = |hinge: &&Bending| {
            let free = hinge.particles.iter().any(|&p| !scene.particles[p].fixed);
            free && (hinge.stiffness != 0.0 || hinge.damping != 0.0)
        };
        let hinges: Vec<_> = scene.bending.iter().filter(acts).cloned().collect();
        let kinds = ForceKinds::union(hinges.iter().map(|one| ForceKinds::of_damper(one.damping)));
        (!hinges.is_empty()).then_some(Self { hinges, kinds })
    }

    /// The first hinge of a scene that holds energy at the start and no force, since its angle has no direction: straight
    /// with a rest angle, or folded back. The least turn releases it.
    pub fn latent(scene: &Scene) -> Option<usize> {
        let x: Vec<f64> = scene.starts().into_iter().flatten().collect();
        scene.bending.iter().position(|hinge| {
            let shape = Shape::of(hinge, &x);
            hinge.stiffness != 0.0
                && shape.is_some_and(|s| s.normal.is_none() && s.angle != hinge.rest_angle)
        })
    }

    /// Each hinge with its shape, where it has one.
    fn shapes(&self, x: &[f64]) -> impl Iterator<Item = (&Bending, Option<Shape>)> {
        self.hinges.iter().map(|hinge| (hinge, Shape::of(hinge, x)))
    }
}

/// Vectors of three particles, and matrices over them.
type Nine = SVector<f64, 9>;
type Square = SMatrix<f64, 9, 9>;

/// The two links of a hinge, none of no length.
struct Shape {
    /// Their directions, from the first particle to the middle and on to the last.
    links: [Vector3<f64>; 2],
    /// Their lengths, m.
    lengths: [f64; 2],
    /// The turning angle, rad.
    angle: f64,
    sin: f64,
    cos: f64,
    /// Unit vector across the plane of the links; None where they are in line.
    normal: Option<Vector3<f64>>,
}

impl Shape {
    /// None where a link has no length.
    fn of(hinge: &Bending, x: &[f64]) -> Option<Self> {
        let at = |p: usize| Vector3::from_column_slice(&x[3 * p..3 * p + 3]);
        let [a, b, c] = hinge.particles.map(at);
        let links = [b - a, c - b];
        let lengths = links.map(|link| link.norm());
        if lengths.iter().any(|length| *length <= SHORTEST) {
            return None;
        }
        let links = [links[0] / lengths[0], links[1] / lengths[1]];
        let (cross, cos) = (links[0].cross(&links[1]), links[0].dot(&links[1]));
        let sin = cross.norm();
        Some(Self {
            links,
            lengths,
            angle: sin.atan2(cos),
            sin,
            cos,
            normal: (sin > 0.0).then(|| cross / sin),
        })
    }

    /// The gradient of the angle by the three positions, 1/m, where the links turn about this normal.
    fn gradient(&self, normal: &Vector3<f64>) -> Nine {
        let first = normal.cross(&self.links[0]) / self.lengths[0];
        let last = normal.cross(&self.links[1]) / self.lengths[1];
        let mut gradient = Nine::zeros();
        gradient.fixed_rows_mut::<3>(0).copy_from(&first);
        gradient.fixed_rows_mut::<3>(3).copy_from(&-(first + last));
        gradient.fixed_rows_mut::<3>(6).copy_from(&last);
        gradient
    }

    /// The gradients along which it turns: one, two where it is straight, none where it is folded.
    fn gradients(&self) -> impl Iterator<Item = Nine> {
        let normals = match self.normal {
            Some(normal) => [Some(normal), None],
            None if self.cos > 0.0 => {
                let side = across(&self.links[0]);
                [Some(side), Some(self.links[0].cross(&side))]
            }
            None => [None, None],
        };
        normals
            .into_iter()
            .flatten()
            .map(|normal| self.gradient(&normal))
    }

    /// The second derivatives of the angle, 1/m²: its parts in the plane of the links, and the matrix of two by two
    /// of the part across it. Zero where the links are in line.
    fn curvature(&self) -> (Square, Matrix2<f64>) {
        let Some(normal) = self.normal else {
            return (Square::zeros(), Matrix2::zeros());
        };
        let mut inside = Square::zeros();
        let towards = [normal.cross(&self.links[0]), -normal.cross(&self.links[1])];
        for link in 0..2 {
            let (u, p) = (self.links[link], towards[link]);
            let mixed =
                (u * p.transpose() + p * u.transpose()) / (self.lengths[link] * self.lengths[link]);
            add_blocks(&mut inside, link, link, &mixed);
        }
        let [l1, l2] = self.lengths;
        let (cot, csc) = (self.cos / self.sin, 1.0 / self.sin);
        let off = -csc / (l1 * l2);
        (
            inside,
            Matrix2::new(cot / (l1 * l1), off, off, cot / (l2 * l2)),
        )
    }

    /// The matrix over the particles of this one over the parts of the links across their plane.
    fn across_plane(&self, of_links: &Matrix2<f64>) -> Square {
        let mut whole = Square::zeros();
        if let Some(normal) = self.normal {
            let outer = normal * normal.transpose();
            for i in 0..2 {
                for j in 0..2 {
                    add_blocks(&mut whole, i, j, &(outer * of_links[(i, j)]));
                }
            }
        }
        whole
    }

    /// How far roundings of the coordinates turn a link, rad, both together.
    fn turned(&self, hinge: &Bending, x: &[f64]) -> f64 {
        let reach = |p: usize| {
            x[3 * p..3 * p + 3]
                .iter()
                .fold(0.0_f64, |m, c| m.max(c.abs()))
        };
        let [a, b, c] = hinge.particles.map(reach);
        let ends = [a + b, b + c].into_iter().zip(self.lengths);
        ends.map(|(reach, length)| f64::EPSILON * reach / length)
            .sum::<f64>()
            + 4.0 * f64::EPSILON
    }
}

/// Adds a block of the links i and j, which run from one particle to the next, to those of the particles.
fn add_blocks(whole: &mut Square, i: usize, j: usize, block: &Matrix3<f64>) {
    for (row, by_row) in [(i, -1.0), (i + 1, 1.0)] {
        for (column, by_column) in [(j, -1.0), (j + 1, 1.0)] {
            let mut at = whole.fixed_view_mut::<3, 3>(3 * row, 3 * column);
            at += block * (by_row * by_column);
        }
    }
}

/// Some unit vector across this one.
fn across(u: &Vector3<f64>) -> Vector3<f64> {
    let mut axis = Vector3::zeros();
    axis[u.iamin()] = 1.0;
    u.cross(&axis).normalize()
}

/// The part of a symmetric matrix that is positive semidefinite.
fn positive(matrix: &Matrix2<f64>) -> Matrix2<f64> {
    let half = 0.5 * (matrix[(0, 0)] - matrix[(1, 1)]);
    let (middle, split) = (0.5 * matrix.trace(), half.hypot(matrix[(0, 1)]));
    if middle >= split {
        return *matrix;
    }
    let most = middle + split;
    if most.is_nan() || most <= 0.0 {
        return Matrix2::zeros();
    }
    // An eigenvector of the larger eigenvalue, from the row that does not cancel.
    let vector = if half >= 0.0 {
        Vector2::new(half + split, matrix[(0, 1)])
    } else {
        Vector2::new(matrix[(0, 1)], split - half)
    };
    vector
        .try_normalize(0.0)
        .map_or_else(Matrix2::zeros, |v| v * v.transpose() * most)
}

/// The components of three particles.
fn gather(hinge: &Bending, values: &[f64]) -> Nine {
    Nine::from_fn(|i, _| values[3 * hinge.particles[i / 3] + i % 3])
}

fn scatter(hinge: &Bending, add: &Nine, values: &mut [f64]) {
    for (i, add) in add.iter().enumerate() {
        values[3 * hinge.particles[i / 3] + i % 3] += add;
    }
}

impl Effect for BendingForce {
    fn members(&self) -> usize {
        self.hinges.len()
    }

    fn kinds(&self) -> ForceKinds {
        self.kinds
    }

    fn add_force(&self, _t: f64, x: &[f64], v: &[f64], f: &mut [f64]) -> Power {
        let mut dissipated = 0.0;
        for (hinge, shape) in self.shapes(x) {
            let Some(shape) = shape else { continue };
            if let Some(normal) = shape.normal {
                let moment = hinge.stiffness * (shape.angle - hinge.rest_angle);
                scatter(hinge, &(shape.gradient(&normal) * -moment), f);
            }
            if hinge.damping != 0.0 {
                let v = gather(hinge, v);
                for gradient in shape.gradients() {
                    let rate = gradient.dot(&v);
                    dissipated += hinge.damping * rate * rate;
                    scatter(hinge, &(gradient * (-hinge.damping * rate)), f);
                }
            }
        }
        Power {
            dissipated,
            injected: 0.0,
        }
    }

    fn add_rounding(&self, _t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        for (hinge, shape) in self.shapes(x) {
            let Some(shape) = shape else { continue };
            let turned = shape.turned(hinge, x);
            let off = shape.angle - hinge.rest_angle;
            // The normal is a cross product of size sin θ. A program that takes the angle from its cosine knows it to
            // eps / sin θ, and to the root of eps at least.
            let sin = shape.sin.max(f64::MIN_POSITIVE);
            let by_cosine = (2.0 * f64::EPSILON / sin).min(2.0 * f64::EPSILON.sqrt());
            let direction = (turned / sin).min(2.0);
            let moment = hinge.stiffness
                * (turned
                    + by_cosine
                    + FEW_OPERATIONS * (shape.angle + hinge.rest_angle.abs())
                    + off.abs() * (direction + 2.0 * FEW_OPERATIONS));
            let sizes = [1.0 / shape.lengths[0], 0.0, 1.0 / shape.lengths[1]];
            let size = |p: usize| {
                if p == 1 {
                    sizes[0] + sizes[2]
                } else {
                    sizes[p]
                }
            };
            let speed: f64 = (0..3)
                .map(|p| {
                    let at = 3 * hinge.particles[p];
                    size(p) * v[at..at + 3].iter().map(|v| v.abs()).sum::<f64>()
                })
                .sum();
            let damper = hinge.damping.abs() * speed * (2.0 * direction + 4.0 * FEW_OPERATIONS);
            for p in 0..3 {
                let at = 3 * hinge.particles[p];
                f[at..at + 3]
                    .iter_mut()
                    .for_each(|f| *f += size(p) * (moment + damper));
            }
        }
    }

    fn potential(&self, _t: f64, x: &[f64]) -> f64 {
        let energy = |(hinge, shape): (&Bending, Option<Shape>)| {
            // Where a link has no length, the angle is taken for 0.
            let off = shape.map_or(0.0, |shape| shape.angle) - hinge.rest_angle;
            0.5 * hinge.stiffness * off * off
        };
        self.shapes(x).map(energy).sum()
    }

    fn add_damping(&self, x: &[f64], w: &[f64], f: &mut [f64]) {
        for hinge in self.hinges.iter().filter(|hinge| hinge.damping != 0.0) {
            let Some(shape) = Shape::of(hinge, x) else {
                continue;
            };
            let w = gather(hinge, w);
            for gradient in shape.gradients() {
                scatter(hinge, &(gradient * (-hinge.damping * gradient.dot(&w))), f);
            }
        }
    }

    fn count_dampers(&self, at: &mut [u32]) -> bool {
        let damped = self.hinges.iter().filter(|hinge| hinge.damping != 0.0);
        damped.for_each(|hinge| hinge.particles.iter().for_each(|&p| at[p] += 1));
        true
    }

    fn sweep(&self, sweep: &mut Sweep) {
        let backward = sweep.backward;
        let mut one = |hinge: &Bending| {
            if hinge.damping == 0.0 {
                return;
            }
            let Some(shape) = Shape::of(hinge, sweep.x()) else {
                return;
            };
            for gradient in shape.gradients() {
                let parts = [0, 3, 6].map(|at| gradient.fixed_rows::<3>(at).into_owned().into());
                sweep.bend(hinge.particles, hinge.damping, parts);
            }
        };
        if backward {
            self.hinges.iter().rev().for_each(&mut one);
        } else {
            self.hinges.iter().for_each(&mut one);
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
        for (hinge, shape) in self.shapes(x) {
            let (mut position, mut velocity) = (Square::zeros(), Square::zeros());
            if let Some(shape) = shape {
                let moment = hinge.stiffness * (shape.angle - hinge.rest_angle);
                let smooth = shape.normal.is_some() || hinge.rest_angle == 0.0;
                for gradient in shape.gradients() {
                    let outer = gradient * gradient.transpose();
                    position -= outer * if smooth { hinge.stiffness } else { 0.0 };
                    velocity -= outer * hinge.damping;
                }
                let (inside, beside) = shape.curvature();
                match linearization {
                    Linearization::Exact => {
                        let curvature = inside + shape.across_plane(&beside);
                        position -= curvature * moment;
                        if let Some(normal) = shape.normal.filter(|_| hinge.damping != 0.0) {
                            let (gradient, v) = (shape.gradient(&normal), gather(hinge, v));
                            let turning = curvature * v;
                            let turned =
                                gradient * turning.transpose() + curvature * gradient.dot(&v);
                            position -= turned * hinge.damping;
                        }
                    }
                    Linearization::Material => {}
                    Linearization::Definite => {
                        position -= shape.across_plane(&positive(&(beside * moment)));
                    }
                }
            }
            let mut emit = |by: Derivative, all: &Square| {
                for (i, from) in hinge.particles.into_iter().enumerate() {
                    for (j, to) in hinge.particles.into_iter().enumerate() {
                        let block = all.fixed_view::<3, 3>(3 * i, 3 * j).into_owned();
                        out.add_block(by, [from, to], &block);
                    }
                }
            };
            emit(Derivative::Position, &position);
            if hinge.damping != 0.0 {
                emit(Derivative::Velocity, &velocity);
            }
        }
    }

    fn keeps_momentum(&self) -> bool {
        true
    }

    fn keeps_angular_momentum(&self) -> bool {
        true
    }
}
