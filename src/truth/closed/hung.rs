//! A particle on a rod to a fixed point, in gravity alone: the plane pendulum.

use super::group::Group;
use super::pendulum::Pendulum;
use crate::truth::Motion;

pub(super) const METHOD: &str = "pendulum";
pub(super) const REASON: &str =
    "a particle on a rod to a fixed point, in one plane: Jacobi's elliptic functions";

/// The motion of one particle on a rod.
pub(super) struct Hung {
    /// Index in the scene.
    particle: usize,
    pendulum: Pendulum,
}

impl Hung {
    /// None unless the group is one particle on one rod, no other force than a constant one acts, and it stays in a
    /// plane.
    pub fn of(group: &Group) -> Option<Self> {
        let ([body], [rod], []) = (&group.bodies[..], &group.rods[..], &group.links[..]) else {
            return None;
        };
        let damped = body.drag != 0.0 || body.quadratic != 0.0;
        if damped || body.turning != nalgebra::Vector3::zeros() || rod.driven {
            return None;
        }
        let pivot = rod.at[usize::from(rod.ends[0].is_some())];
        let [pivot, position, velocity, gravity] =
            [pivot, body.position, body.velocity, body.constant].map(Into::into);
        Some(Self {
            particle: body.id,
            pendulum: Pendulum::hung(pivot, position, velocity, gravity)?,
        })
    }

    /// Overwrites the particle's position and velocity with those at `t`.
    pub fn put(&self, t: f64, x: &mut [f64], v: &mut [f64]) {
        let state = self.pendulum.states(&[t]);
        let own = 3 * self.particle..3 * self.particle + 3;
        x[own.clone()].copy_from_slice(&state.x);
        v[own].copy_from_slice(&state.v);
    }

    pub fn error_bar(&self, t: f64) -> f64 {
        self.pendulum.error_bar(t)
    }
}
