//! The energy that tells whether runs are stable.
//!
//! Where the map is linear, it is the energy of the difference between two runs: gravity and wind move
//! both alike, so the difference obeys the method's homogeneous linear map exactly, wherever the
//! equilibrium is and whatever sign the energy has.
//!
//! Elsewhere it is the energy E of one run, which in truth falls by what is dissipated, and never rises. It is not the balance, which adds the dissipated energy back: near its limit
//! explicit Euler dissipates without bound what it made out of nothing, and its balance rises while the
//! motion decays.
//!
//! Where the scene is driven it is the lesser of E and of E less the work put in. A motion that sets in raises the first
//! and not the second, whose error in turn, at large steps, grows while the motion does not. What explodes raises both.

use super::perturbation::{Perturbation, Quadratic};
use super::probe::{EnergyLevel, Gauge, Probed, Runs};
use crate::measure::scale::free_fall;
use crate::physics::constraints::kinetic_on_rods;
use crate::physics::{ForceKinds, ParticleSystem, State, System};
use crate::scene::Scene;

/// The energy of the difference between two runs, against its start.
pub(super) struct DifferenceEnergy {
    quadratic: Quadratic,
    /// The energy at the start, J.
    start: f64,
    difference: Perturbation,
}

/// Energy of the difference, over its start, at which it has come down to nothing.
const GONE: f64 = 1e-22;
/// Growth of the energy that no transient and no swing near a limit reaches: at a relative distance
/// δ inside it Verlet's swings by 1/(2 δ).
const BLOWN_UP: f64 = 1e12;

impl DifferenceEnergy {
    /// The energy of two runs at their start.
    pub fn new(runs: &Runs, quadratic: Quadratic) -> Self {
        let mut gauge = Self {
            quadratic,
            start: 0.0,
            difference: Perturbation::default(),
        };
        gauge.start = gauge.energy(runs);
        gauge
    }

    fn energy(&mut self, runs: &Runs) -> f64 {
        self.difference.set_difference(runs.state(0), runs.state(1));
        self.quadratic.energy(&self.difference)
    }
}

impl Gauge for DifferenceEnergy {
    fn level(&mut self, runs: &Runs, step: u64) -> Result<EnergyLevel, Probed> {
        let energy = self.energy(runs) / self.start;
        if !energy.is_finite() {
            Err(Probed::not_finite(step))
        } else if energy < GONE {
            Err(Probed::decays())
        } else if energy > BLOWN_UP {
            Err(Probed::explodes(energy.ln(), step))
        } else {
            let (log, high) = (energy.ln(), false);
            Ok(EnergyLevel { log, high })
        }
    }

    /// Whether the difference has no more energy than roundings of the state alone.
    fn is_rounding(&mut self, runs: &Runs) -> bool {
        let now = self.energy(runs);
        now < self.quadratic.rounding(runs.state(1))
    }
}

/// The energy one run has beyond what is due to it, against the scene's energy scale.
pub(super) struct ExcessEnergy {
    system: ParticleSystem,
    /// S, J.
    scale: f64,
    start: f64,
    /// See [`free_fall`], J/s².
    fall: f64,
    /// Times the scale beyond which a run is lost whatever it does next.
    bound: f64,
    /// The time from which on the largest balance is kept, s, and that balance, J.
    late: (f64, f64),
}

/// An energy that stays above this many times the scale is instability too: a spring stretched far
/// enough turns so slowly that its method is stable again. Not less, since at a relative distance δ
/// inside its limit the energy of a stable method swings by about 1/δ.
const SATURATED: f64 = 1e3;
/// Rises below this fraction of the energy in motion are no growth: in a free fall a first-order
/// method errs by one part in the number of steps.
const NEGLIGIBLE: f64 = 1e-2;
/// Energy below this fraction of the scale is nothing.
const FLOOR: f64 = 1e-3;
/// Steps from which on what drives a scene may put in grows like the square of their number: a bounded force does no
/// more.
const SET_IN: f64 = 1e3;

impl ExcessEnergy {
    /// The energy of one run at its start. `scale` is in J and positive; the run is lost beyond `bound`
    /// times it. The largest balance is kept from `late` seconds on.
    pub fn new(
        runs: &Runs,
        system: ParticleSystem,
        scene: &Scene,
        scale: f64,
        bound: f64,
        late: f64,
    ) -> Self {
        Self {
            scale,
            start: energy(&system, runs.state(0)),
            system,
            fall: free_fall(scene),
            bound,
            late: (late, f64::NEG_INFINITY),
        }
    }

    /// The balance now, J.
    pub fn balance(&self, runs: &Runs) -> f64 {
        let state = runs.state(0);
        state.work.balance(energy(&self.system, state))
    }

    /// The largest balance since `late`, J.
    pub fn late_balance(&self) -> f64 {
        self.late.1
    }
}

/// E, J, on rods without that of velocities along them.
fn energy(system: &ParticleSystem, state: &State) -> f64 {
    kinetic_on_rods(system, &state.x, &state.v) + system.potential(state.t, &state.x)
}

impl Gauge for ExcessEnergy {
    fn level(&mut self, runs: &Runs, step: u64) -> Result<EnergyLevel, Probed> {
        let state = runs.state(0);
        let moving = self.system.kinetic(&state.v) + self.system.elastic(state.t, &state.x);
        let excess = energy(&self.system, state) - state.work.injected.max(0.0) - self.start;
        if !state.is_finite() || !excess.is_finite() || !moving.is_finite() {
            return Err(Probed::not_finite(step));
        }
        if state.t >= self.late.0 {
            self.late.1 = self.late.1.max(self.balance(runs));
        }
        let allowed = self.bound * self.scale + 1e3 * (self.fall * state.t * state.t);
        if moving > allowed {
            return Err(Probed::explodes((moving / self.scale).ln(), step));
        }
        let counted = if excess > 0.0 {
            (excess - NEGLIGIBLE * moving).max(0.0)
        } else {
            excess
        };
        if self.system.kinds().has(ForceKinds::DRIVEN) {
            // A motion that is driven wanders; what explodes passes any bound.
            let level = 1.0 + counted.max(0.0) / (SATURATED * self.scale);
            let put_in = 1.0 + (step as f64 / SET_IN).powi(2);
            let log = (level / put_in).ln();
            return Ok(EnergyLevel { log, high: false });
        }
        let level = 1.0 + counted / self.scale;
        Ok(EnergyLevel {
            log: level.max(FLOOR).ln(),
            high: counted > SATURATED * self.scale && counted > 0.1 * moving,
        })
    }
}
