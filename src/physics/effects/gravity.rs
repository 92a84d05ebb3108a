//! Uniform gravity.

use super::{Effect, EffectRow, boxed};
use crate::physics::{ForceKinds, Power};
use crate::scene::Scene;

pub(super) const ROW: EffectRow = EffectRow {
    id: "gravity",
    summary: "uniform gravity on every free particle, along `up`",
    source: "f = m g, U = -m g x_up; zero at the origin",
    elastic: false,
    constant: true,
    build: |scene| Gravity::new(scene).map(boxed),
};

/// Weight of each free particle along one axis.
///
/// Not to be confused with `gravitational`, the attraction between two particles.
pub struct Gravity {
    /// Coordinate index 3 i + axis, and the force on it, N.
    weights: Vec<(usize, f64)>,
}

impl Gravity {
    /// None when the scene's gravity is 0.
    pub fn new(scene: &Scene) -> Option<Self> {
        let g = scene.solver.gravity;
        (g != 0.0).then(|| Self {
            weights: scene
                .particles
                .iter()
                .enumerate()
                .filter(|(_, p)| !p.fixed)
                .map(|(i, p)| (3 * i + scene.up.index(), p.mass * g))
                .collect(),
        })
    }
}

impl Effect for Gravity {
    fn members(&self) -> usize {
        self.weights.len()
    }

    fn kinds(&self) -> ForceKinds {
        ForceKinds::NONE
    }

    fn add_force(&self, _t: f64, _x: &[f64], _v: &[f64], f: &mut [f64]) -> Power {
        for &(at, weight) in &self.weights {
            f[at] += weight;
        }
        Power::default()
    }

    fn potential(&self, _t: f64, x: &[f64]) -> f64 {
        -self.weights.iter().map(|&(at, w)| w * x[at]).sum::<f64>()
    }
}
