//! Uniform gravity.

use super::{Effect, EffectRow, boxed};
use crate::physics::{ForceKinds, Power};
use crate::scene::Scene;

pub(super) const ROW: EffectRow = EffectRow {
    id: "gravity",
    summary: "uniform gravity on every free particle: a number along `up`, or vectors that add up",
    source: "f = m g, U = -m g·x; zero at the origin",
    elastic: false,
    constant: true,
    build: |scene| Gravity::new(scene).map(boxed),
};

/// Weight of each free particle.
///
/// Not to be confused with `gravitational`, the attraction between two particles.
pub struct Gravity {
    /// Coordinate index 3 i + axis, and the force on it, N; none along an axis without gravity.
    weights: Vec<(usize, f64)>,
    /// Free particles.
    members: usize,
}

impl Gravity {
    /// None when the scene's gravity is 0, also where its vectors add up to that.
    pub fn new(scene: &Scene) -> Option<Self> {
        let g = scene.gravity();
        let free = || scene.particles.iter().enumerate().filter(|(_, p)| !p.fixed);
        let weight = |(i, axis): (usize, usize)| {
            let weight = scene.particles[i].mass * g[axis];
            (g[axis] != 0.0).then_some((3 * i + axis, weight))
        };
        let coordinates = free().flat_map(|(i, _)| [0, 1, 2].map(|axis| (i, axis)));
        (g != [0.0; 3]).then(|| Self {
            weights: coordinates.filter_map(weight).collect(),
            members: free().count(),
        })
    }
}

impl Effect for Gravity {
    fn members(&self) -> usize {
        self.members
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
