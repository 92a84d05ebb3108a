//! A constant force on every free particle.

use super::{Effect, EffectRow, boxed};
use crate::physics::{ForceKinds, Power};
use crate::scene::Scene;

pub(super) const ROW: EffectRow = EffectRow {
    id: "wind",
    summary: "a constant force in newtons on every free particle",
    source: "f = strength * direction; its work is counted as injected, it has no potential here",
    elastic: false,
    constant: true,
    build: |scene| WindForce::new(scene).map(boxed),
};

/// The same force on every free particle, independent of its mass.
///
/// Not to be confused with moving air, which drags in proportion to the relative velocity.
pub struct WindForce {
    force: [f64; 3],
    free: Vec<usize>,
}

impl WindForce {
    /// None without `wind`, or when its strength is 0.
    pub fn new(scene: &Scene) -> Option<Self> {
        let wind = scene.wind.as_ref().filter(|w| w.strength != 0.0)?;
        Some(Self {
            force: wind.direction.map(|d| wind.strength * d),
            free: (0..scene.particles.len())
                .filter(|&i| !scene.particles[i].fixed)
                .collect(),
        })
    }
}

impl Effect for WindForce {
    fn members(&self) -> usize {
        self.free.len()
    }

    fn kinds(&self) -> ForceKinds {
        ForceKinds::DRIVEN
    }

    fn add_force(&self, t: f64, _x: &[f64], v: &[f64], f: &mut [f64]) -> Power {
        for &i in &self.free {
            for axis in 0..3 {
                f[3 * i + axis] += self.force[axis];
            }
        }
        Power {
            dissipated: 0.0,
            injected: self.injected_power(t, v),
        }
    }

    fn injected_power(&self, _t: f64, v: &[f64]) -> f64 {
        let along = |i: &usize| (0..3).map(|a| self.force[a] * v[3 * i + a]).sum::<f64>();
        self.free.iter().map(along).sum()
    }
}
