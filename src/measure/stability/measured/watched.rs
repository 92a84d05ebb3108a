//! Runs of a scene, and the energy that tells whether they are stable.
//!
//! Where the map is linear, it is the energy of the difference between two runs: gravity and wind move
//! both alike, so the difference obeys the method's homogeneous linear map exactly, wherever the
//! equilibrium is and whatever sign the energy has.
//!
//! Elsewhere it is E less the work of external forces of one run, which in truth falls by what is
//! dissipated, and never rises. It is not the balance, which adds the dissipated energy back: near its limit
//! explicit Euler dissipates without bound what it made out of nothing, and its balance rises while the
//! motion decays.

use super::Make;
use super::perturbation::Perturbation;
use super::probe::Probed;
use crate::integrators::StepError;
use crate::measure::scale::free_fall;
use crate::physics::{ParticleSystem, State, System};
use crate::scene::Scene;
use crate::solvers::{Run, Unsupported};

/// Runs at one timestep from different starts, advanced together.
pub(super) struct Runs(Vec<Run>);

/// What a linear solve counts as, in force passes.
const SOLVE: u64 = 3;

impl Runs {
    /// One from the start of each scene, at `h` seconds.
    pub fn new(make: &Make, h: f64, scenes: &[&Scene]) -> Result<Self, Unsupported> {
        let runs = scenes.iter().map(|scene| make(scene, h));
        Ok(Self(runs.collect::<Result<_, _>>()?))
    }

    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// A step of each.
    pub fn step(&mut self) -> Result<(), StepError> {
        self.0.iter_mut().try_for_each(|run| run.advance(1))
    }

    pub fn state(&self, run: usize) -> &State {
        self.0[run].state()
    }

    /// The state of one run less that of the first.
    pub fn difference(&self, run: usize) -> Perturbation {
        let mut difference = Perturbation::default();
        difference.set_difference(self.state(0), self.state(run));
        difference
    }

    /// Force passes so far, linear solves turned into such, where engines count them.
    pub fn passes(&self) -> u64 {
        let passes = self.0.iter().map(|run| {
            let counts = run.counts();
            counts.all_force_passes().unwrap_or(0) + SOLVE * counts.linear_solves.unwrap_or(0)
        });
        passes.sum()
    }
}

/// What is watched of runs.
pub(super) trait Gauge {
    /// Where the energy is after so many steps.
    ///
    /// # Errors
    /// What became of the runs, where the energy leaves no other answer.
    fn level(&mut self, runs: &Runs, step: u64) -> Result<Level, Probed>;

    /// Whether what is watched is no larger than rounding.
    fn is_rounding(&mut self, _runs: &Runs) -> bool {
        false
    }
}

/// An energy against its start or its scale.
pub(super) struct Level {
    /// Its logarithm.
    pub log: f64,
    /// Too high to stay there.
    pub high: bool,
}

/// K(dv) + the potential energy of dx under linear forces.
#[derive(Clone)]
pub(super) struct Quadratic {
    system: ParticleSystem,
    /// Forces at the origin, at rest: what does not depend on the state.
    constant: Vec<f64>,
    zero: Vec<f64>,
    force: Vec<f64>,
}

impl Quadratic {
    pub fn new(system: &ParticleSystem) -> Self {
        let zero = vec![0.0; system.dim()];
        let mut constant = zero.clone();
        system.forces(0.0, &zero, &zero, &mut constant);
        Self {
            system: system.clone(),
            constant,
            force: zero.clone(),
            zero,
        }
    }

    /// -½ dx · (f(dx) - f(0)), J. Free coordinates only: `dx` is 0 on fixed ones.
    pub fn potential(&mut self, dx: &[f64]) -> f64 {
        self.system.forces(0.0, dx, &self.zero, &mut self.force);
        let work = dx.iter().zip(self.force.iter().zip(&self.constant));
        -0.5 * work.map(|(dx, (f, f0))| dx * (f - f0)).sum::<f64>()
    }

    pub fn energy(&mut self, of: &Perturbation) -> f64 {
        self.potential(&of.x) + self.system.kinetic(&of.v)
    }
}

/// The energy of the difference between two runs, against its start.
pub(super) struct DifferenceEnergy {
    quadratic: Quadratic,
    /// J.
    start: f64,
    difference: Perturbation,
}

/// Energy of the difference, over its start, at which it has come down to nothing.
const GONE: f64 = 1e-22;
/// Growth of the energy that no transient and no swing near a limit reaches: at a relative distance
/// δ inside it Verlet's swings by 1/(2 δ).
const BLOWN_UP: f64 = 1e12;
/// What counts as rounding, in positions and velocities.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

impl DifferenceEnergy {
    /// Of two runs at their start.
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
    fn level(&mut self, runs: &Runs, step: u64) -> Result<Level, Probed> {
        let energy = self.energy(runs) / self.start;
        if !energy.is_finite() {
            Err(Probed::not_finite(step))
        } else if energy < GONE {
            Err(Probed::decays())
        } else if energy > BLOWN_UP {
            Err(Probed::explodes(energy.ln(), step))
        } else {
            let (log, high) = (energy.ln(), false);
            Ok(Level { log, high })
        }
    }

    /// Whether the difference has no more energy than roundings of the state alone.
    fn is_rounding(&mut self, runs: &Runs) -> bool {
        let now = self.energy(runs);
        // Every other coordinate the other way, so that no translation hides it.
        let signs = [ROUNDING, -ROUNDING].into_iter().cycle();
        let State { x, v, .. } = runs.state(1);
        let free = x.iter().zip(self.quadratic.system.inverse_mass());
        let x = free.zip(signs.clone());
        let rounding = Perturbation {
            x: x.map(|((x, w), s)| if *w > 0.0 { x * s } else { 0.0 })
                .collect(),
            v: v.iter().zip(signs).map(|(v, s)| v * s).collect(),
        };
        now < self.quadratic.energy(&rounding)
    }
}

/// The energy one run has no right to, against the scene's energy scale.
pub(super) struct ExcessEnergy {
    system: ParticleSystem,
    /// S, J.
    scale: f64,
    start: f64,
    /// See [`free_fall`], J/s².
    fall: f64,
    /// Times the scale beyond which a run is lost whatever it does next.
    bound: f64,
    /// From when on the largest balance is kept, s, and that balance, J.
    late: (f64, f64),
}

/// Times the scale that, where it stays, is instability too: a spring stretched far enough turns so
/// slowly that its method is stable again. Not less, since at a relative distance δ inside its limit
/// the energy of a stable method swings by about 1/δ.
const SATURATED: f64 = 1e3;
/// Rises below this fraction of the energy in motion are no growth: in a free fall a first-order
/// method errs by one part in the number of steps.
const NEGLIGIBLE: f64 = 1e-2;
/// Energy below this fraction of the scale is nothing.
const FLOOR: f64 = 1e-3;

impl ExcessEnergy {
    /// Of one run at its start; `scale` in J, positive; lost beyond `bound` of it. The largest balance is
    /// kept from `late` seconds on.
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
            start: energy_less_work(&system, runs.state(0)),
            system,
            fall: free_fall(scene),
            bound,
            late: (late, f64::NEG_INFINITY),
        }
    }

    /// The balance now, E + dissipated - injected, J.
    pub fn balance(&self, runs: &Runs) -> f64 {
        let state = runs.state(0);
        energy_less_work(&self.system, state) + state.work.dissipated
    }

    /// The largest balance since `late`, J.
    pub fn late_balance(&self) -> f64 {
        self.late.1
    }
}

/// E less what was injected, J.
fn energy_less_work(system: &ParticleSystem, state: &State) -> f64 {
    system.kinetic(&state.v) + system.potential(state.t, &state.x) - state.work.injected
}

impl Gauge for ExcessEnergy {
    fn level(&mut self, runs: &Runs, step: u64) -> Result<Level, Probed> {
        let state = runs.state(0);
        let moving = self.system.kinetic(&state.v) + self.system.elastic(state.t, &state.x);
        let excess = energy_less_work(&self.system, state) - self.start;
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
        Ok(Level {
            log: (1.0 + counted / self.scale).max(FLOOR).ln(),
            high: counted > SATURATED * self.scale && counted > 0.1 * moving,
        })
    }
}
