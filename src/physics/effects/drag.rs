//! Linear drag against still air.

use super::{Effect, EffectRow, boxed};
use crate::physics::{ForceKinds, Jacobian, Linearization, Power, Sweep};
use crate::scene::Scene;

pub(super) const ROW: EffectRow = EffectRow {
    id: "drag",
    summary: "linear drag on particles with a `drag` coefficient",
    source: "f = -b v (Stokes), dissipates b v²",
    elastic: false,
    constant: false,
    build: |scene| Drag::new(scene).map(boxed),
};

/// f = -b v on each particle with b > 0.
///
/// Not to be confused with rapier's `linear_damping`, which scales the velocity once a step.
pub struct Drag {
    /// Particle and its b, N s/m.
    coefficients: Vec<(usize, f64)>,
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
        (!coefficients.is_empty()).then_some(Self { coefficients })
    }
}

impl Effect for Drag {
    fn members(&self) -> usize {
        self.coefficients.len()
    }

    fn kinds(&self) -> ForceKinds {
        ForceKinds::union(
            self.coefficients
                .iter()
                .map(|&(_, b)| ForceKinds::of_damper(b)),
        )
    }

    fn add_force(&self, _t: f64, _x: &[f64], v: &[f64], f: &mut [f64]) -> Power {
        let mut dissipated = 0.0;
        for &(i, b) in &self.coefficients {
            for at in 3 * i..3 * i + 3 {
                f[at] -= b * v[at];
                dissipated += b * v[at] * v[at];
            }
        }
        Power {
            dissipated,
            injected: 0.0,
        }
    }

    fn add_damping(&self, x: &[f64], w: &[f64], f: &mut [f64]) {
        self.add_force(0.0, x, w, f);
    }

    fn count_dampers(&self, at: &mut [u32]) -> bool {
        for (i, _) in &self.coefficients {
            at[*i] += 1;
        }
        true
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
