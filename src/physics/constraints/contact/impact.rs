//! Impacts: Newton's restitution along the normal, Coulomb's friction across it.

use super::{Beside, Obstacles, dot, norm};
use crate::physics::State;

/// The most impulses of one particle that is pressed into several obstacles at once.
const SWEEPS: usize = 1000;

impl Obstacles {
    /// Gives a particle that strikes an obstacle the velocity after the impact, and books the energy that it takes. With
    /// V the speed of approach, the normal velocity becomes e V, and the sliding one falls by µ (1 + e) V, to 0 at most:
    /// Coulomb's law for the impulses. What touches another obstacle as well strikes that next, until nothing is left to
    /// strike. Returns whether something did.
    pub fn strike(&self, particle: usize, state: &mut State) -> bool {
        let mut struck = false;
        for _ in 0..SWEEPS {
            let all = (0..self.len()).map(|obstacle| self.beside(particle, obstacle, state));
            let due: Vec<Beside> = all.filter(Beside::strikes).collect();
            if due.is_empty() {
                break;
            }
            struck = true;
            for beside in due {
                self.apply(&beside, state);
            }
        }
        struck
    }

    /// One impulse.
    fn apply(&self, beside: &Beside, state: &mut State) {
        // An earlier impulse may have turned it away.
        let beside = self.beside(beside.particle, beside.obstacle, state);
        let speed = -beside.parting();
        if speed <= beside.slow {
            return;
        }
        let obstacle = &self.obstacles[beside.obstacle];
        let e = obstacle.restitution;
        let sliding = beside.sliding();
        let fast = norm(sliding);
        let slowed = (obstacle.friction[0] * (1.0 + e) * speed).min(fast);
        let mut change = [0, 1, 2].map(|axis| (1.0 + e) * speed * beside.normal[axis]);
        if slowed > 0.0 {
            for (change, along) in change.iter_mut().zip(sliding) {
                *change -= slowed / fast * along;
            }
        }
        self.kick(beside.particle, beside.obstacle, change, state);
    }

    /// Puts a particle that is inside an obstacle by rounding onto its surface.
    pub fn push_out(&self, beside: &Beside, state: &mut State) {
        for axis in 0..3 {
            state.x[3 * beside.particle + axis] -= beside.gap * beside.normal[axis];
        }
    }

    /// Takes the normal velocity of a particle that touches an obstacle away, and books the energy.
    pub fn rest(&self, beside: &Beside, state: &mut State) {
        let beside = self.beside(beside.particle, beside.obstacle, state);
        let parting = beside.parting();
        let change = beside.normal.map(|n| -parting * n);
        self.kick(beside.particle, beside.obstacle, change, state);
    }

    /// Changes a velocity by an impulse of an obstacle, and books what it takes and what the obstacle's motion does.
    fn kick(&self, particle: usize, obstacle: usize, change: [f64; 3], state: &mut State) {
        let mass = 1.0 / self.weights[particle];
        let along = self.obstacles[obstacle].moved(state.t)[1];
        let v = &mut state.v[3 * particle..3 * particle + 3];
        let before = dot([v[0], v[1], v[2]], [v[0], v[1], v[2]]);
        for (v, change) in v.iter_mut().zip(change) {
            *v += change;
        }
        let after = dot([v[0], v[1], v[2]], [v[0], v[1], v[2]]);
        let done = mass * dot(change, along);
        state.work.injected += done;
        state.work.impacts += 0.5 * mass * (before - after) + done;
    }
}
