//! One run of a scene, and the energy it has no right to.
//!
//! E less the work of external forces falls in truth by what is dissipated, and never rises. Not the
//! balance, which adds the dissipated energy back: near its limit explicit Euler dissipates without
//! bound what it made out of nothing, and its balance rises while the motion decays.

use super::probe::{Level, Run, passes};
use crate::engines::Engine;
use crate::integrators::StepError;
use crate::scene::Scene;
use crate::system::{ParticleSystem, State, System};

/// Watches one run.
pub(super) struct Single {
    engine: Box<dyn Engine>,
    system: ParticleSystem,
    /// S, J.
    scale: f64,
    start: f64,
    fall: Fall,
    /// Times the scale beyond which a run is lost whatever it does next.
    bound: f64,
    /// From when on the largest balance is kept, s, and that balance, J.
    late: (f64, f64),
}

/// Times the scale that, where it stays, is instability too: a spring stretched far enough turns so
/// slowly that its method is stable again. Not less, since at a relative distance δ inside its limit
/// the energy of a stable method swings by about 1/δ.
const SATURATED: f64 = 1e3;
/// Rises below this share of the energy in motion are no growth: in a free fall a first-order
/// method errs by one part in the number of steps.
const SHARE: f64 = 1e-2;
/// Energy below this share of the scale is nothing.
const FLOOR: f64 = 1e-3;

impl Single {
    /// `scale` in J, positive; lost beyond `bound` of it.
    pub fn new(
        engine: Box<dyn Engine>,
        system: ParticleSystem,
        scene: &Scene,
        scale: f64,
        bound: f64,
    ) -> Self {
        let start = passive(&system, engine.state());
        Self {
            engine,
            system,
            scale,
            start,
            fall: Fall::of(scene),
            bound,
            late: (f64::INFINITY, f64::NEG_INFINITY),
        }
    }

    /// Keeps the largest balance from time `t` on.
    pub fn keep_from(&mut self, t: f64) {
        self.late.0 = t;
    }

    /// The balance now, E + dissipated - injected, J.
    pub fn balance(&self) -> f64 {
        let state = self.engine.state();
        passive(&self.system, state) + state.work.dissipated
    }

    /// The largest since then, J.
    pub fn kept(&self) -> f64 {
        self.late.1
    }

    /// How far the energy is above its start, and the energy in motion, J.
    pub fn excess(&self) -> (f64, f64) {
        let state = self.engine.state();
        let moving = self.system.kinetic(&state.v) + self.system.elastic(state.t, &state.x);
        (passive(&self.system, state) - self.start, moving)
    }
}

/// E less what was injected, J.
fn passive(system: &ParticleSystem, state: &State) -> f64 {
    system.kinetic(&state.v) + system.potential(state.t, &state.x) - state.work.injected
}

impl Run for Single {
    const ENGINES: u64 = 1;

    fn step(&mut self) -> Result<(), StepError> {
        self.engine.step()
    }

    fn level(&mut self) -> Level {
        let (excess, moving) = self.excess();
        if !self.engine.state().is_finite() || !excess.is_finite() || !moving.is_finite() {
            return Level::Failed("it left the range of finite numbers".to_owned());
        }
        if self.engine.state().t >= self.late.0 {
            self.late.1 = self.late.1.max(self.balance());
        }
        let allowed = self.bound * self.scale + 1e3 * self.fall.energy(self.engine.state().t);
        if moving > allowed {
            return Level::Exploded((moving / self.scale).ln());
        }
        let counted = if excess > 0.0 {
            (excess - SHARE * moving).max(0.0)
        } else {
            excess
        };
        if counted > SATURATED * self.scale && counted > 0.1 * moving {
            return Level::High((1.0 + counted / self.scale).ln());
        }
        Level::Log((1.0 + counted / self.scale).max(FLOOR).ln())
    }

    fn passes(&self) -> u64 {
        passes(self.engine.as_ref())
    }

    fn drowned(&mut self) -> bool {
        false
    }
}

/// What gravity and wind give a free fall.
#[derive(Debug, Clone, Copy)]
struct Fall {
    /// J/s²: the energy is this times t².
    rate: f64,
}

impl Fall {
    fn of(scene: &Scene) -> Self {
        let wind = scene.wind.as_ref().map_or(0.0, |wind| wind.strength.abs());
        let free = scene.particles.iter().filter(|p| !p.fixed);
        let rate = free.map(|p| {
            let a = scene.solver.gravity.abs() + wind / p.mass;
            0.5 * p.mass * a * a
        });
        Self { rate: rate.sum() }
    }

    fn energy(self, t: f64) -> f64 {
        self.rate * t * t
    }
}
