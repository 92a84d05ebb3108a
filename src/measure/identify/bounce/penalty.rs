//! Contact by penalty: a spring and a damper while a particle is inside an obstacle.

use super::{Bounce, Way};
use crate::physics::constraints::contact::{Beside, Obstacles};
use crate::physics::effects::{Effect, EffectRow};
use crate::physics::{ForceKinds, Jacobian, Linearization, ParticleSystem, Power, State, System};
use crate::scene::Scene;

/// No scene has it yet.
static ROW: EffectRow = EffectRow {
    id: "penalty",
    summary: "a spring and a damper while a particle is inside an obstacle",
    source: "N = k d - c v_n, d the depth; µ N against the sliding velocity",
    elastic: false,
    constant: false,
    build: |_| None,
};

struct Penalty {
    obstacles: Obstacles,
    stiffness: f64,
    damping: f64,
    /// Whether N may be negative.
    pulls: bool,
    /// Whether there is friction.
    rubs: bool,
}

/// The scene with such forces in the place of impacts; None where the treatment has none.
pub(in super::super) fn pressed(
    scene: &Scene,
    system: &ParticleSystem,
    bounce: &Bounce,
) -> Option<ParticleSystem> {
    let Way::Force { pulls } = bounce.way.does else {
        return None;
    };
    let [stiffness, damping] = bounce.force;
    let penalty = Penalty {
        obstacles: system.obstacles()?.copied(),
        stiffness,
        damping,
        pulls,
        rubs: bounce.friction.id != "friction_forgotten",
    };
    Some(ParticleSystem::also(scene, &ROW, Box::new(penalty)))
}

impl Penalty {
    /// Every particle inside of an obstacle, the normal force, N, and µ.
    fn inside(&self, t: f64, x: &[f64], v: &[f64]) -> impl Iterator<Item = (Beside, f64, f64)> {
        let mut state = State::new(x.to_vec(), v.to_vec());
        state.t = t;
        let all = self.obstacles.pairs().map(move |(particle, obstacle)| {
            let beside = self.obstacles.beside(particle, obstacle, &state);
            (beside, self.obstacles.surface(obstacle).friction[0])
        });
        all.filter(|(beside, _)| beside.gap < 0.0)
            .map(|(beside, friction)| {
                let force = -self.stiffness * beside.gap - self.damping * beside.parting();
                let force = if self.pulls { force } else { force.max(0.0) };
                (beside, force, if self.rubs { friction } else { 0.0 })
            })
    }

    /// Whether its force is linear in the velocity, wherever obstacles are.
    fn is_linear(&self) -> bool {
        let rubs = self.rubs && self.obstacles.surfaces().any(|one| one.friction[0] > 0.0);
        let clipped = self.damping != 0.0 && !self.pulls;
        !clipped && !self.obstacles.any_moves() && !rubs
    }
}

impl Effect for Penalty {
    fn members(&self) -> usize {
        self.obstacles.particles().count()
    }

    fn kinds(&self) -> ForceKinds {
        if self.is_linear() {
            ForceKinds::of_damper(self.damping)
        } else {
            ForceKinds::NON_LINEAR
        }
    }

    fn add_force(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) -> Power {
        for (beside, force, friction) in self.inside(t, x, v) {
            let sliding = beside.sliding();
            let fast = sliding.iter().map(|c| c * c).sum::<f64>().sqrt();
            for axis in 0..3 {
                let mut own = force * beside.normal[axis];
                if fast > 0.0 {
                    own -= friction * force * sliding[axis] / fast;
                }
                f[3 * beside.particle + axis] += own;
            }
        }
        Power::default()
    }

    fn add_rounding(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        for (beside, force, _) in self.inside(t, x, v) {
            let own = 3 * beside.particle..3 * beside.particle + 3;
            let far = x[own.clone()]
                .iter()
                .fold(0.0_f64, |far, c| far.max(c.abs()));
            // A depth is a difference of coordinates.
            let off = 4.0 * f64::EPSILON * (self.stiffness.abs() * far + force.abs());
            f[own].iter_mut().for_each(|f| *f += off);
        }
    }

    fn add_damping(&self, x: &[f64], w: &[f64], f: &mut [f64]) {
        // Where obstacles move nobody asks for it.
        for (beside, ..) in self.inside(0.0, x, w) {
            for axis in 0..3 {
                f[3 * beside.particle + axis] -=
                    self.damping * beside.parting() * beside.normal[axis];
            }
        }
    }

    fn add_jacobian(&self, _: f64, _: &[f64], _: &[f64], _: Linearization, _: &mut Jacobian) {
        // Implicit methods are not tried with it.
    }
}
