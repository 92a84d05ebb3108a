//! What a probe needs: the scene, the engine, how it is shaken and what is watched.

use super::difference::{Pair, Quadratic};
use super::limit::Make;
use super::passive::Single;
use super::probe::{Budget, Fate, Probed, Watch, probe};
use super::shake::Shake;
use crate::engines::{Engine, Unsupported};
use crate::measure::energy_scale;
use crate::scene::Scene;
use crate::system::{Jacobian, Linearization, ParticleSystem, System};

/// Times the energy scale at which a run is lost.
const LOST: f64 = 1e4;
/// Steps of a full probe, where patience allows.
pub(super) const STEPS: u64 = 20_000;
/// Rise of ln(energy) that is growth: where the map is linear a trend is clean, ...
const CLEAR_LINEAR: f64 = 1e-2;
/// ... elsewhere energy wanders between motions a method treats differently.
const CLEAR: f64 = 0.1;

/// One scene and engine.
pub(super) struct Bench<'a> {
    scene: &'a Scene,
    system: &'a ParticleSystem,
    make: &'a Make<'a>,
    /// Where differences of runs obey a linear map.
    quadratic: Option<Quadratic>,
    shake: Shake,
    scale: f64,
    /// Steps of a full probe.
    pub steps: u64,
}

/// The energy scale, in roundings, below which a kick would drown in them: of a scene that starts next
/// to equilibrium.
const SEEN: f64 = 1e8;

/// One rounding of the weights' potential energy, J.
fn rounding(scene: &Scene) -> f64 {
    let gravity = scene.solver.gravity.abs();
    let heights = scene.particles.iter().filter(|p| !p.fixed).map(|p| {
        let far = p.position.iter().fold(0.0, |m: f64, c| m.max(c.abs()));
        p.mass * far
    });
    f64::EPSILON * gravity * heights.sum::<f64>()
}

/// Full probes a search is meant to afford.
const PROBES: u64 = 24;
/// Steps a full probe takes at least.
const FEWEST: u64 = 500;

/// Steps over which a map is seen to be linear or not.
const LINEAR_STEPS: usize = 4;
/// Newton's residuals and rounding are far below this, a direction that turns far above.
const LINEAR: f64 = 1e-7;

impl<'a> Bench<'a> {
    /// `h`: a step well inside every limit, s. `patience` is in steps of the whole search.
    pub fn new(
        scene: &'a Scene,
        system: &'a ParticleSystem,
        make: &'a Make<'a>,
        h: f64,
        patience: u64,
    ) -> Result<Self, Unsupported> {
        let mut quadratic = Quadratic::new(system);
        let large = Shake::large(scene, system, &mut |dx| quadratic.potential(dx));
        let linear = linear(scene, make, &large, h)?;
        let scale = energy_scale(scene, system, None).unwrap_or(1.0);
        let scale = scale.max(SEEN * rounding(scene));
        Ok(Self {
            scene,
            system,
            make,
            quadratic: linear.then_some(quadratic),
            shake: if linear {
                large
            } else {
                Shake::slight(system, scale)
            },
            scale,
            // Two runs a probe where the map is linear.
            steps: (patience / PROBES / if linear { 2 } else { 1 }).clamp(FEWEST, STEPS),
        })
    }

    /// Whether differences of runs obey a linear map.
    pub fn is_linear(&self) -> bool {
        self.quadratic.is_some()
    }

    /// Rise of ln(energy) over the tail of a probe that is growth.
    pub fn clear(&self) -> f64 {
        if self.is_linear() {
            CLEAR_LINEAR
        } else {
            CLEAR
        }
    }

    /// Is `h` stable, over `steps`?
    pub fn probe(
        &self,
        h: f64,
        steps: u64,
        extensions: u32,
        budget: &mut Budget,
    ) -> Result<Probed, Unsupported> {
        let watch = Watch {
            steps,
            extensions,
            clear: self.clear(),
        };
        if let Some(mut pair) = self.pair(h, &self.shake)? {
            return Ok(probe(&mut pair, watch, budget));
        }
        let scene = self.shake.apply(self.scene);
        let engine = (self.make)(&scene, h)?;
        let mut single = Single::new(engine, self.system.clone(), &scene, self.scale, LOST);
        Ok(probe(&mut single, watch, budget))
    }

    /// Two runs, where that is linear.
    fn pair(&self, h: f64, shake: &Shake) -> Result<Option<Pair>, Unsupported> {
        let Some(quadratic) = &self.quadratic else {
            return Ok(None);
        };
        let from = (self.make)(self.scene, h)?;
        let shaken = (self.make)(&shake.apply(self.scene), h)?;
        Ok(Some(Pair::new(from, shaken, quadratic.clone())))
    }

    /// ln(amplitude) per second at `h`, once what grows fastest has outgrown the rest: that is
    /// brought about beforehand at `coarse`, where growth is steep. None where the map is not linear:
    /// what grows there changes its rate.
    pub fn growth(
        &self,
        h: f64,
        coarse: f64,
        budget: &mut Budget,
    ) -> Result<Option<f64>, Unsupported> {
        let Some(quadratic) = &self.quadratic else {
            return Ok(None);
        };
        let mut quadratic = quadratic.clone();
        let wanted = quadratic.energy(&self.shake.x, &self.shake.v);
        let mut shape = self.shake.clone();
        for _ in 0..ROUNDS {
            let Some(mut pair) = self.pair(coarse, &shape)? else {
                return Ok(None);
            };
            let watch = Watch {
                steps: self.steps,
                extensions: 0,
                clear: CLEAR_LINEAR,
            };
            let probed = probe(&mut pair, watch, budget);
            let grown = pair.shape();
            let energy = quadratic.energy(&grown.x, &grown.v);
            if !probed.unstable() || !energy.is_finite() || energy <= 0.0 {
                break;
            }
            shape = grown.scaled((wanted / energy).sqrt());
        }
        // A trace of everything else, in case something else grows here.
        let shape = shape.plus(&self.shake.scaled(TRACE));
        let Some(mut pair) = self.pair(h, &shape)? else {
            return Ok(None);
        };
        let watch = Watch {
            steps: STEPS,
            extensions: 2,
            clear: CLEAR_LINEAR,
        };
        let probed = probe(&mut pair, watch, budget);
        Ok((probed.fate != Fate::Impatient)
            .then_some(probed.rate)
            .flatten()
            .map(|rate| 0.5 * rate / h))
    }
}

/// Times what grows fastest is run at the coarse step; each multiplies it a millionfold.
const ROUNDS: usize = 6;
/// Share of the undirected disturbance beside it.
const TRACE: f64 = 1e-6;

/// Whether twice the disturbance makes twice the difference, to rounding. What the scene is made of
/// does not tell: some methods are not linear where the forces are.
fn linear(scene: &Scene, make: &Make, shake: &Shake, h: f64) -> Result<bool, Unsupported> {
    let mut engines: Vec<Box<dyn Engine>> = vec![
        make(scene, h)?,
        make(&shake.apply(scene), h)?,
        make(&shake.scaled(2.0).apply(scene), h)?,
    ];
    for _ in 0..LINEAR_STEPS {
        for engine in &mut engines {
            if engine.step().is_err() {
                return Ok(false);
            }
        }
    }
    let [a, b, c] = engines.as_slice() else {
        return Ok(false);
    };
    let (a, b, c) = (a.state(), b.state(), c.state());
    let proportional = |a: &[f64], b: &[f64], c: &[f64]| {
        let mut off = 0.0_f64;
        let mut most = 0.0_f64;
        for ((a, b), c) in a.iter().zip(b).zip(c) {
            let (once, twice) = (b - a, c - a);
            if !twice.is_finite() {
                return false;
            }
            off = off.max((twice - 2.0 * once).abs());
            most = most.max(once.abs());
        }
        off <= LINEAR * most
    };
    Ok(proportional(&a.x, &b.x, &c.x) && proportional(&a.v, &b.v, &c.v))
}

/// A time, s, no longer than the shortest time scale of the forces about the start: from the row sums
/// of the Jacobians (Gershgorin). None where no force depends on the state.
pub(super) fn shortest(scene: &Scene, system: &ParticleSystem) -> Option<f64> {
    let start = ParticleSystem::initial_state(scene);
    let mut jacobian = Jacobian::default();
    system.jacobian(0.0, &start.x, &start.v, Linearization::Exact, &mut jacobian);
    let largest = |triplets: &[(usize, usize, f64)]| {
        let mut entries = std::collections::BTreeMap::new();
        for (row, column, value) in triplets {
            *entries.entry((*row, *column)).or_insert(0.0) += *value;
        }
        let mut rows = vec![0.0; system.dim()];
        for ((row, column), value) in entries {
            let weights = system.inverse_mass();
            if let (Some(sum), Some(w), Some(other)) =
                (rows.get_mut(row), weights.get(row), weights.get(column))
            {
                // In mass-weighted coordinates the matrix is symmetric and its rows are alike.
                let value: f64 = value;
                *sum += value.abs() * (w * other).sqrt();
            }
        }
        rows.into_iter().fold(0.0, f64::max)
    };
    let rate = largest(&jacobian.position)
        .sqrt()
        .max(largest(&jacobian.velocity));
    (rate > 0.0 && rate.is_finite()).then(|| 1.0 / rate)
}
