//! Linear drag against the air.

use super::{Effect, EffectRow, FEW_OPERATIONS, boxed, count_members, dot, velocity};
use crate::physics::{ForceKinds, Jacobian, Linearization, Power, Sweep};
use crate::scene::Scene;

pub(super) const ROW: EffectRow = EffectRow {
    id: "drag",
    summary: "linear drag on particles with a `drag` coefficient, relative to the air",
    source: "f = -b (v - w) (Stokes), w the velocity of the air; dissipates b v², injects b w·v",
    elastic: false,
    constant: false,
    build: |scene| Drag::new(scene).map(boxed),
};

/// f = -b (v - w) on each particle with b > 0, w the velocity of the air.
///
/// The force on what is at rest, b w, is what air that moves injects by; the rest, -b v, dissipates.
/// Not to be confused with rapier's `linear_damping`, which scales the velocity once a step.
pub struct Drag {
    /// Particle and its b, N s/m.
    coefficients: Vec<(usize, f64)>,
    /// w, m/s.
    air: [f64; 3],
    kinds: ForceKinds,
}

impl Drag {
    /// None when no free particle has drag. A negative coefficient, which no scene file can state, adds
    /// energy.
    pub fn new(scene: &Scene) -> Option<Self> {
        let coefficients: Vec<_> = scene
            .particles
            .iter()
            .enumerate()
            .filter(|(_, p)| !p.fixed && p.drag != 0.0)
            .map(|(i, p)| (i, p.drag))
            .collect();
        let air = scene.air().velocity;
        let dampers = coefficients.iter().map(|&(_, b)| ForceKinds::of_damper(b));
        let kinds = ForceKinds::union(dampers) | moved_by(air);
        (!coefficients.is_empty()).then_some(Self {
            coefficients,
            air,
            kinds,
        })
    }
}

impl Effect for Drag {
    fn members(&self) -> usize {
        self.coefficients.len()
    }

    fn kinds(&self) -> ForceKinds {
        self.kinds
    }

    fn add_force(&self, _t: f64, _x: &[f64], v: &[f64], f: &mut [f64]) -> Power {
        let mut power = Power::default();
        for &(i, b) in &self.coefficients {
            for (at, w) in (3 * i..3 * i + 3).zip(self.air) {
                f[at] -= b * (v[at] - w);
                power.dissipated += b * v[at] * v[at];
                power.injected += b * w * v[at];
            }
        }
        power
    }

    fn add_rounding(&self, _t: f64, _x: &[f64], v: &[f64], f: &mut [f64]) {
        for &(i, b) in &self.coefficients {
            for (at, w) in (3 * i..3 * i + 3).zip(self.air) {
                f[at] += FEW_OPERATIONS * b.abs() * (v[at].abs() + w.abs());
            }
        }
    }

    fn add_damping(&self, _x: &[f64], w: &[f64], f: &mut [f64]) {
        for &(i, b) in &self.coefficients {
            for at in 3 * i..3 * i + 3 {
                f[at] -= b * w[at];
            }
        }
    }

    fn injected_power(&self, _t: f64, v: &[f64]) -> f64 {
        let along = |&(i, b): &(usize, f64)| b * dot(self.air, velocity(v, i));
        self.coefficients.iter().map(along).sum()
    }

    fn count_dampers(&self, at: &mut [u32]) -> bool {
        count_members(&self.coefficients, at)
    }

    fn sweep(&self, sweep: &mut Sweep) {
        // One particle's drag leaves the others alone: the order does not matter.
        for &(i, b) in &self.coefficients {
            sweep.on(i, b);
        }
    }

    fn add_jacobian(
        &self,
        _t: f64,
        _x: &[f64],
        _v: &[f64],
        _linearization: Linearization,
        out: &mut Jacobian,
    ) {
        for &(i, b) in &self.coefficients {
            for at in 3 * i..3 * i + 3 {
                out.velocity.push((at, at, -b));
            }
        }
    }
}

/// The kind of a drag in air of this velocity, besides how it depends on velocity.
pub(super) fn moved_by(air: [f64; 3]) -> ForceKinds {
    if air == [0.0; 3] {
        ForceKinds::NONE
    } else {
        ForceKinds::DRIVEN
    }
}
