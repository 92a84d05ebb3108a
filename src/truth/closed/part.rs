//! The motion of one group: its modes along one axis or three, and its error bar.

use super::line::Drift;
use super::mode::{Mode, Response};
use super::modes::Modes;
use super::sideways::Sideways;
use super::vector::norm;
use nalgebra::Vector3;

/// What the modes do along one axis.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    /// Unit vector.
    pub direction: Vector3<f64>,
    /// Initial velocity of each mode.
    pub velocity: Vec<f64>,
    /// Initial acceleration of each mode, without damping.
    pub pull: Vec<f64>,
}

/// One group's motion: x(t) = x(0) + axes times modes + drift.
#[derive(Debug, Clone)]
pub(super) struct Part {
    /// Scene ids of the free particles.
    pub particles: Vec<usize>,
    pub modes: Modes,
    pub axes: Vec<Axis>,
    pub drift: Drift,
    /// Growth of what rounding leaves across a line, if it leaves anything.
    pub sideways: Option<Sideways>,
    pub method: String,
    pub reason: String,
}

impl Part {
    /// Adds displacements and gained velocities at `t` to flat vectors of the scene.
    pub fn add(&self, t: f64, x: &mut [f64], v: &mut [f64]) {
        let n = self.particles.len();
        let responses: Vec<Response> = self.modes.modes.iter().map(|m| m.response(t)).collect();
        let (mut moved, mut gained) = (vec![0.0; n], vec![0.0; n]);
        for axis in &self.axes {
            moved.fill(0.0);
            gained.fill(0.0);
            for (j, response) in responses.iter().enumerate() {
                let (velocity, pull) = (axis.velocity[j], axis.pull[j]);
                let position = response.position(velocity, pull);
                let speed = response.gained(velocity, pull);
                for (i, shape) in self.modes.shape(j).iter().enumerate() {
                    moved[i] += shape * position;
                    gained[i] += shape * speed;
                }
            }
            for (i, particle) in self.particles.iter().enumerate() {
                for (c, along) in axis.direction.iter().enumerate() {
                    x[3 * particle + c] += along * moved[i];
                    v[3 * particle + c] += along * gained[i];
                }
            }
        }
        if !self.drift.is_still() {
            let response = drifting(&self.drift).response(t);
            for particle in &self.particles {
                for c in 0..3 {
                    let (velocity, pull) = (self.drift.velocity[c], self.drift.pull[c]);
                    x[3 * particle + c] += response.position(velocity, pull);
                    v[3 * particle + c] += response.gained(velocity, pull);
                }
            }
        }
    }

    /// No particle is farther from where it started in [0, t], m: all of it, and what swings or
    /// creeps back alone.
    fn reach(&self, t: f64) -> (f64, f64) {
        let n = self.particles.len();
        let (mut all, mut swing) = (vec![0.0_f64; n], vec![0.0_f64; n]);
        let drift = drifting(&self.drift);
        let drifted = self.drift.velocity * drift.impulse_bound(t);
        all.fill(norm(drifted) + norm(self.drift.pull) * drift.step_bound(t));
        for axis in &self.axes {
            let (mut each, mut swinging) = (vec![0.0; n], vec![0.0; n]);
            for (j, mode) in self.modes.modes.iter().enumerate() {
                let bound = mode.travel_bound(axis.velocity[j], axis.pull[j], t);
                for (i, shape) in self.modes.shape(j).iter().enumerate() {
                    each[i] += shape.abs() * bound;
                    if mode.w > 0.0 {
                        swinging[i] += shape.abs() * bound;
                    }
                }
            }
            for i in 0..n {
                all[i] = all[i].hypot(each[i]);
                swing[i] = swing[i].hypot(swinging[i]);
            }
        }
        let most = |values: Vec<f64>| values.into_iter().fold(0.0, f64::max);
        (most(all), most(swing))
    }

    /// Bound on the distance of any computed position in [0, t] from the exact one, m.
    ///
    /// 16 eps (1 + w t) times the scene's size or the distance travelled, where that is larger. The
    /// 1 covers each sum; w t covers the phase, which a rounded frequency moves at eps of the
    /// fastest w. Phase counts for what swings, and as long as it does: damped modes forget it.
    pub fn error_bar(&self, t: f64, size: f64) -> f64 {
        let (all, swing) = self.reach(t);
        let mut phase = 0.0_f64;
        let mut slowest = f64::INFINITY;
        let mut speed = 0.0_f64;
        for mode in &self.modes.modes {
            slowest = slowest.min(mode.fastest());
            if mode.w > 0.0 {
                phase = phase.max(t.min(1.0 / mode.g.min(mode.w)));
            }
        }
        for axis in &self.axes {
            for (j, mode) in self.modes.modes.iter().enumerate() {
                speed = speed.hypot(mode.speed_bound(axis.velocity[j], axis.pull[j], t));
            }
        }
        let fastest = self.modes.modes.iter().map(|m| m.w).fold(0.0, f64::max);
        let lightest = self
            .modes
            .masses()
            .iter()
            .copied()
            .fold(f64::INFINITY, f64::min);
        // Damping left between the modes pushes like leak times speed.
        let pushed = self.modes.leak * speed / lightest.sqrt() * t * t.min(1.0 / slowest);
        // A slow mode that stiff springs under tension push by their rounding may be off by more than
        // it swings, one mode alone may not.
        let swinging = if self.particles.len() == 1 {
            swing
        } else {
            size.max(swing)
        };
        let rate = 16.0 * f64::EPSILON * fastest + self.modes.spread;
        let sideways = self.sideways.as_ref().map_or(0.0, |s| s.bound(t));
        16.0 * f64::EPSILON * size.max(all) + rate * phase * swinging + pushed + sideways
    }
}

/// The sideways motion as a mode without stiffness.
fn drifting(drift: &Drift) -> Mode {
    Mode {
        w: 0.0,
        g: 0.5 * drift.rate,
    }
}
