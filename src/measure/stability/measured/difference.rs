//! Two runs of one linear scene, and the energy of the difference between them.
//!
//! Gravity and wind move both alike, so the difference obeys the method's homogeneous linear map
//! exactly, wherever the equilibrium is and whatever sign the energy has.

use super::probe::{Level, Run, passes};
use super::shake::Shake;
use crate::engines::Engine;
use crate::integrators::StepError;
use crate::system::{ParticleSystem, State, System};

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

    pub fn energy(&mut self, dx: &[f64], dv: &[f64]) -> f64 {
        self.potential(dx) + self.system.kinetic(dv)
    }
}

/// The two runs.
pub(super) struct Pair {
    from: Box<dyn Engine>,
    shaken: Box<dyn Engine>,
    quadratic: Quadratic,
    /// Energy of the difference at the start, J.
    start: f64,
    dx: Vec<f64>,
    dv: Vec<f64>,
}

/// Energy of the difference, over its start, at which it has come down to nothing.
const GONE: f64 = 1e-22;
/// What counts as rounding, in last bits of positions and velocities.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

impl Pair {
    pub fn new(from: Box<dyn Engine>, shaken: Box<dyn Engine>, quadratic: Quadratic) -> Self {
        let mut pair = Self {
            from,
            shaken,
            quadratic,
            start: 0.0,
            dx: Vec::new(),
            dv: Vec::new(),
        };
        pair.start = pair.energy();
        pair
    }

    fn energy(&mut self) -> f64 {
        self.difference();
        self.quadratic.energy(&self.dx, &self.dv)
    }

    fn difference(&mut self) {
        let (a, b) = (self.from.state(), self.shaken.state());
        subtract(&b.x, &a.x, &mut self.dx);
        subtract(&b.v, &a.v, &mut self.dv);
    }

    /// The difference now.
    pub fn shape(&mut self) -> Shake {
        self.difference();
        Shake {
            x: self.dx.clone(),
            v: self.dv.clone(),
        }
    }

    /// Energy that roundings of the two states alone have.
    fn rounding(&mut self) -> f64 {
        // Every other coordinate the other way, so that no translation hides it.
        let noise = |values: &[f64]| -> Vec<f64> {
            let signs = [ROUNDING, -ROUNDING].into_iter().cycle();
            values.iter().zip(signs).map(|(c, s)| c * s).collect()
        };
        let State { x, v, .. } = self.shaken.state();
        let (x, v) = (noise(x), noise(v));
        let masked = x.iter().zip(self.quadratic.system.inverse_mass());
        let x: Vec<f64> = masked
            .map(|(x, w)| if *w > 0.0 { *x } else { 0.0 })
            .collect();
        self.quadratic.energy(&x, &v)
    }
}

impl Run for Pair {
    const ENGINES: u64 = 2;

    fn step(&mut self) -> Result<(), StepError> {
        self.from.step()?;
        self.shaken.step()
    }

    fn level(&mut self) -> Level {
        let energy = self.energy() / self.start;
        if !energy.is_finite() {
            Level::Failed("it left the range of finite numbers".to_owned())
        } else if energy < GONE {
            Level::Gone
        } else if energy > BLOWN_UP {
            Level::Exploded(energy.ln())
        } else {
            Level::Log(energy.ln())
        }
    }

    fn passes(&self) -> u64 {
        passes(self.from.as_ref()) + passes(self.shaken.as_ref())
    }

    fn drowned(&mut self) -> bool {
        self.difference();
        let now = self.quadratic.energy(&self.dx, &self.dv);
        now < self.rounding()
    }
}

/// Growth of the energy that no transient and no swing near a limit reaches: at a relative distance
/// δ inside it Verlet's swings by 1/(2 δ).
pub(super) const BLOWN_UP: f64 = 1e12;

/// `to` = a - b.
fn subtract(a: &[f64], b: &[f64], to: &mut Vec<f64>) {
    to.clear();
    to.extend(a.iter().zip(b).map(|(a, b)| a - b));
}
