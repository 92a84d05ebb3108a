//! Impacts: Newton's restitution along the normal, Coulomb's friction across it.

use super::{Beside, Obstacles, dot, norm};
use crate::physics::State;

/// What an impact starts from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// The speed at which the two approach, along the normal, m/s.
    pub approach: f64,
    /// The speed along the surface, m/s.
    pub sliding: f64,
    /// e.
    pub restitution: f64,
    /// µ.
    pub friction: f64,
    /// The step at whose end it is taken, s; 0 at the instant of an impact.
    pub h: f64,
}

/// What an impact does to velocities.
#[derive(Debug, Clone, Copy)]
pub struct ImpactLaw {
    /// What the normal velocity gains away from the obstacle, m/s.
    pub restitution: fn(&Hit) -> f64,
    /// What the sliding speed loses, m/s, where the normal velocity gains so much.
    pub friction: fn(&Hit, f64) -> f64,
}

impl ImpactLaw {
    /// v_n' = -e v_n (Newton).
    pub fn newton(hit: &Hit) -> f64 {
        (1.0 + hit.restitution) * hit.approach
    }

    /// Coulomb's law for the impulses.
    pub fn coulomb(hit: &Hit, gained: f64) -> f64 {
        (hit.friction * gained).min(hit.sliding)
    }

    /// The right one.
    pub const RIGHT: Self = Self {
        restitution: Self::newton,
        friction: Self::coulomb,
    };

    /// The change of velocity, m/s, of a particle beside an obstacle.
    pub fn change(&self, beside: &Beside, [restitution, friction]: [f64; 2], h: f64) -> [f64; 3] {
        let sliding = beside.sliding();
        let fast = norm(sliding);
        let hit = Hit {
            approach: -beside.parting(),
            sliding: fast,
            restitution,
            friction,
            h,
        };
        let gained = (self.restitution)(&hit);
        let slowed = (self.friction)(&hit, gained);
        let mut change = beside.normal.map(|n| gained * n);
        if slowed != 0.0 && fast > 0.0 {
            for (change, along) in change.iter_mut().zip(sliding) {
                *change -= slowed / fast * along;
            }
        }
        change
    }
}

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
        let change = self
            .law
            .change(&beside, self.coefficients(beside.obstacle), 0.0);
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
