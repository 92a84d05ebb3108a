//! Springs with dampers, fused in one loop.

mod kernel;
mod network;

use super::{Effect, EffectRow, FEW_OPERATIONS, boxed, difference, dot};
use crate::physics::{Derivative, ForceKinds, Jacobian, Linearization, Power, Sweep};
use crate::scene::{DampingModel, Scene, Spring};
use kernel::Motion;
use nalgebra::{Matrix3, Vector3};
use network::{Network, Part};
use pulp::Arch;

pub(super) const ROW: EffectRow = EffectRow {
    id: "springs",
    summary: "linear springs with axial or isotropic dampers",
    source: "f = k (l - L) n + c (v·n) n (axial) or c v (isotropic); U = k (l - L)² / 2",
    elastic: true,
    constant: false,
    build: |scene| Springs::new(scene).map(boxed),
};

/// The least length that is used, m. At coincidence the direction d / l is then 0 and so is the force,
/// with no branch and no NaN. A spring of rest length 0 stays exactly linear through the point.
pub(super) const SHORTEST: f64 = 1e-150;

/// All springs of a scene: their linear part and their dampers. [`Central`](super::Central) adds the
/// cubic part.
///
/// At coincident ends springs and axial dampers exert no force, since they have no direction there; an
/// isotropic damper still acts.
///
/// Forces have the same bits on every machine and every number of threads: each particle sums its
/// forces in the order of the scene's springs.
pub struct Springs {
    network: Network,
    damping: Damping,
    kinds: ForceKinds,
    /// The machine's vector instructions, detected once.
    arch: Arch,
}

/// The kind of damping, which selects the loop. It is chosen once, so that no spring needs a branch.
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
            // A purely cubic spring belongs to `cubic_springs` alone.
            .filter(|s| s.stiffness != 0.0 || s.damping != 0.0 || s.cubic == 0.0)
            .collect();
        let damping = match scene.damping_model {
            _ if springs.iter().all(|s| s.damping == 0.0) => Damping::None,
            DampingModel::Axial => Damping::Axial,
            DampingModel::Isotropic => Damping::Isotropic,
        };
        (!springs.is_empty()).then(|| Self {
            network: Network::new(&springs, scene.particles.len(), damping != Damping::None),
            damping,
            kinds: ForceKinds::union(springs.iter().map(|s| ForceKinds::of_damper(s.damping))),
            arch: Arch::new(),
        })
    }

    /// The number of tasks that can compute the force in parallel: 1 for a small network, and for one
    /// whose neighbours are numbered far apart.
    pub fn parts(&self) -> usize {
        self.network.parts.len()
    }

    /// Adds the forces; without `ELASTIC` those of the dampers alone.
    #[inline(always)]
    fn add<const ELASTIC: bool>(&self, x: &[f64], v: &[f64], f: &mut [f64]) -> f64 {
        let (arch, parts, at) = (self.arch, &self.network.parts, Motion::new(x, v));
        match self.damping {
            Damping::None if !ELASTIC => 0.0,
            Damping::None => kernel::add::<NONE, true>(arch, parts, at, f),
            Damping::Axial => kernel::add::<AXIAL, ELASTIC>(arch, parts, at, f),
            Damping::Isotropic => kernel::add::<ISOTROPIC, ELASTIC>(arch, parts, at, f),
        }
    }

    /// Applies the dampers of one part, in this order. A spring between two parts belongs to that of its first end.
    fn sweep_part(&self, part: &Part, order: impl Iterator<Item = usize>, sweep: &mut Sweep) {
        let table = &part.table;
        for s in order {
            let (c, ends) = (table.damping[s], table.ends[s].map(|end| end as usize));
            if c == 0.0 || !part.particles.contains(&ends[0]) {
                continue;
            }
            if self.damping == Damping::Isotropic {
                sweep.between(ends, c);
                continue;
            }
            let [i, j] = ends.map(|end| 3 * end);
            sweep.along(ends, c, difference(sweep.x(), i, j));
        }
    }
}

impl Effect for Springs {
    fn members(&self) -> usize {
        self.network.members
    }

    fn kinds(&self) -> ForceKinds {
        self.kinds
    }

    fn add_force(&self, _t: f64, x: &[f64], v: &[f64], f: &mut [f64]) -> Power {
        let dissipated = self.add::<true>(x, v, f);
        Power {
            dissipated,
            injected: 0.0,
        }
    }

    fn add_rounding(&self, _t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        self.network.springs().for_each(|spring| {
            let [i, j] = spring.ends.map(|end| 3 * end);
            let off = rounding(&spring, self.damping, x, v);
            for axis in 0..3 {
                f[i + axis] += off[axis];
                f[j + axis] += off[axis];
            }
        });
    }

    fn potential(&self, _t: f64, x: &[f64]) -> f64 {
        let parts = self.network.parts.iter();
        parts.map(|part| kernel::energy(self.arch, part, x)).sum()
    }

    fn add_damping(&self, x: &[f64], w: &[f64], f: &mut [f64]) {
        self.add::<false>(x, w, f);
    }

    fn count_dampers(&self, at: &mut [u32]) -> bool {
        let damped = self
            .network
            .springs()
            .filter(|spring| spring.damping != 0.0);
        damped.for_each(|spring| spring.ends.iter().for_each(|end| at[*end] += 1));
        true
    }

    fn sweep(&self, sweep: &mut Sweep) {
        let parts = self.network.parts.iter();
        if sweep.backward {
            parts.rev().for_each(|part| {
                self.sweep_part(part, (0..part.table.damping.len()).rev(), sweep);
            });
        } else {
            parts.for_each(|part| self.sweep_part(part, 0..part.table.damping.len(), sweep));
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
        self.network.springs().for_each(|spring| {
            let (position, velocity) = blocks(&spring, self.damping, x, v, linearization);
            out.add_pair(Derivative::Position, spring.ends, position);
            if self.damping != Damping::None {
                out.add_pair(Derivative::Velocity, spring.ends, velocity);
            }
        });
    }

    fn keeps_momentum(&self) -> bool {
        true
    }

    fn keeps_angular_momentum(&self) -> bool {
        self.damping != Damping::Isotropic
    }
}

/// ∂f_i/∂(x_j - x_i) and ∂f_i/∂(v_j - v_i) of one spring.
#[inline]
fn blocks(
    spring: &Spring,
    damping: Damping,
    x: &[f64],
    v: &[f64],
    linearization: Linearization,
) -> (Matrix3<f64>, Matrix3<f64>) {
    let [i, j] = spring.ends.map(|end| 3 * end);
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
        let isotropic = damping == Damping::Isotropic;
        return (position, identity * if isotropic { c } else { 0.0 });
    }
    let n = d / length;
    let axial = n * n.transpose();
    let velocity = match damping {
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
        if !definite && damping == Damping::Axial {
            let dv = Vector3::from(difference(v, i, j));
            let turned = n * (dv.transpose() * across) + across * dv.dot(&n);
            position += turned * (c / length);
        }
    }
    (position, velocity)
}

/// The line from one particle to another, and how far rounding moves it: cancellation makes both large where
/// the particles lie close together and far from the origin.
pub(super) struct Line {
    pub(super) direction: [f64; 3],
    /// m; never below [`SHORTEST`].
    pub(super) length: f64,
    /// The rounding of the length, m.
    pub(super) off: f64,
    /// The rounding of each component of the direction.
    pub(super) turned: [f64; 3],
}

impl Line {
    pub(super) fn new(x: &[f64], i: usize, j: usize) -> Self {
        let d = difference(x, i, j);
        let length = dot(d, d).sqrt().max(SHORTEST);
        let direction = d.map(|d| d / length);
        let rounded = [0, 1, 2].map(|axis| f64::EPSILON * (x[i + axis].abs() + x[j + axis].abs()));
        let off = dot(direction.map(f64::abs), rounded) + 2.0 * f64::EPSILON * length;
        let turned = [0, 1, 2].map(|axis| {
            let across = rounded[axis] + direction[axis].abs() * off;
            (across / length).min(1.0) + FEW_OPERATIONS * direction[axis].abs()
        });
        Self {
            direction,
            length,
            off,
            turned,
        }
    }
}

/// The rounding of one spring's force, N: that of k (l - L), whose difference cancels near rest, and of the
/// damper's, whose relative velocity does where both ends move alike.
fn rounding(spring: &Spring, damping: Damping, x: &[f64], v: &[f64]) -> [f64; 3] {
    let [i, j] = spring.ends.map(|end| 3 * end);
    let line = Line::new(x, i, j);
    let (n, turned) = (line.direction.map(f64::abs), line.turned);
    let (k, c) = (spring.stiffness.abs(), spring.damping.abs());
    let stretch = (line.length - spring.rest_length).abs();
    let relative = difference(v, i, j).map(f64::abs);
    let rounded = [0, 1, 2].map(|axis| f64::EPSILON * (v[i + axis].abs() + v[j + axis].abs()));
    let mut along = k * (line.off + 2.0 * f64::EPSILON * spring.rest_length);
    let mut size = k * stretch;
    let mut off = [0.0; 3];
    match damping {
        Damping::None => {}
        Damping::Axial => {
            along += c * (dot(n, rounded) + dot(relative, turned));
            size += c * dot(n, relative);
        }
        Damping::Isotropic => {
            off = [0, 1, 2].map(|axis| c * (rounded[axis] + FEW_OPERATIONS * relative[axis]));
        }
    }
    for axis in 0..3 {
        off[axis] += along * n[axis] + size * (turned[axis] + FEW_OPERATIONS * n[axis]);
    }
    off
}
