//! What a bounce of rapier's loses, by its discrete law.

use crate::physics::State;
use crate::physics::constraints::contact::{Against, Obstacles};
use crate::trajectory::Trajectory;

/// A bounce turns the velocity to this part of it.
const TURNED: f64 = 1e-9;

/// A bounce of rapier's: a step at whose end a particle parts that came nearer at its start.
///
/// rapier's free fall is symplectic Euler in substeps of h, which conserves v²/2 + g z - g h v/2 exactly; its bounce turns
/// -V into e V within one step, from a gap d0 to a gap d1. So what is left of the height before it is e² of it, less
/// e (1 + e)/2 V h + e² d0 - d1; for e = 1, V h and the way of that step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounce {
    pub particle: usize,
    /// e of the obstacle.
    pub restitution: f64,
    /// Of the obstacle.
    pub normal: [f64; 3],
    /// The start of the step, s.
    pub t: f64,
    /// V, the speed towards the obstacle there, m/s.
    pub speed: f64,
    /// d0 and d1, m.
    pub gaps: [f64; 2],
    /// Substeps of this length, s.
    pub h: f64,
}

impl Bounce {
    /// The first in a run at substeps of `h` seconds on planes at rest; None where there is none that restitution alone
    /// turned.
    pub fn first(obstacles: &Obstacles, run: &Trajectory, h: f64) -> Option<Self> {
        let still = |(_, obstacle): &(usize, Against)| !obstacles.moves(*obstacle);
        let pairs: Vec<_> = obstacles.pairs().filter(still).collect();
        (0..run.len()).find_map(|k| {
            let (x, v) = run.following(k)?;
            if v.is_empty() {
                return None;
            }
            let state = |t: f64, x: &[f64], v: &[f64]| State {
                t,
                ..State::new(x.to_vec(), v.to_vec())
            };
            let [before, after] = [
                state(run.time(k), run.x(k), run.v(k)),
                state(run.time(k), x, v),
            ];
            pairs.iter().find_map(|&(particle, obstacle)| {
                let old = obstacles.beside(particle, obstacle, &before);
                let (speed, restitution) =
                    (-old.parting(), obstacles.surface(obstacle).restitution);
                if speed <= 0.0 {
                    return None;
                }
                let new = obstacles.beside(particle, obstacle, &after);
                let turned = (new.parting() - restitution * speed).abs() <= TURNED * speed;
                (restitution > 0.0 && turned).then_some(Self {
                    particle,
                    restitution,
                    normal: old.normal,
                    t: before.t,
                    speed,
                    gaps: [old.gap, new.gap],
                    h,
                })
            })
        })
    }

    /// How much less high it comes than e² of the height before it, m.
    pub fn lost(&self) -> f64 {
        let (e, [before, after]) = (self.restitution, self.gaps);
        0.5 * e * (1.0 + e) * self.speed * self.h + e * e * before - after
    }
}
