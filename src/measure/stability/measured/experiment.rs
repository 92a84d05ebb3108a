//! A scene and a solver, ready to be probed: its perturbation, the energy watched and the limits known
//! so far.

use super::perturbation::{Perturbation, Quadratic};
use super::probe::{Budget, Probed, Runs, Watch, probe};
use super::watched::{DifferenceEnergy, ExcessEnergy};
use super::{DIVERGED, MakeRun};
use crate::measure::energy_scale;
use crate::measure::scale::gravity;
use crate::measure::stability::{Effort, Limit, Linearised};
use crate::physics::{ForceKinds, ParticleSystem, State, System};
use crate::scene::Scene;
use crate::solvers::Unsupported;

/// A run is lost once its energy is this many times the energy scale, where nothing is put in.
const LOST: f64 = 1e4;
/// Steps of a full probe, where the budget allows.
pub(super) const STEPS: u64 = 20_000;
/// Rise of ln(energy) that counts as growth where the map is linear: a trend is clean there.
const CLEAR_LINEAR: f64 = 1e-2;
/// The same elsewhere, where energy wanders between motions a method treats differently.
const CLEAR: f64 = 0.1;
/// The least energy scale, in roundings. Below it, in a scene that starts next to equilibrium, a kick
/// would drown in them.
const SEEN: f64 = 1e8;
/// Full probes that the budget of a search should pay for.
const PROBES: u64 = 24;
/// Fewest steps of a full probe.
const FEWEST: u64 = 500;
/// Linear solves a step that a probe of [`STEPS`] is meant for: where Newton's iteration takes more, far out,
/// the probe is shorter. And the steps that are taken to see how many it takes.
const SOLVES: u64 = 4;
const SAMPLE: u64 = 64;
/// Force passes after which no more are taken: many bounces within a step take thousands.
const ENOUGH: u64 = 50_000;
/// Such a probe is not shorter than this: slow growth needs some thousand steps to show.
const LEAST: u64 = 4_000;
/// Acceleration that is left at a rest, against that without rods: rounding, and angles of 1e-12.
const STILL: f64 = 1e-12;
/// Steps over which a map is seen to be linear or not.
const LINEAR_STEPS: usize = 4;
/// Newton's residuals and rounding are far below this, a direction that turns far above.
const LINEAR: f64 = 1e-7;
/// Runs at the coarse step that bring out what grows fastest; each multiplies it a millionfold.
const ROUNDS: usize = 6;
/// Fraction of the undirected perturbation that is added to it.
const TRACE: f64 = 1e-6;

/// Why nothing is measured about an unstable rest.
const GROWS_IN_TRUTH: &str = "the scene rests where it is not stable in truth: what leaves such a rest grows, and that is no \
                              fault of a step";

/// One scene and one solver.
pub(super) struct Experiment<'a> {
    pub scene: &'a Scene,
    pub system: &'a ParticleSystem,
    make: &'a MakeRun<'a>,
    /// The energy of differences, where they obey a linear map.
    quadratic: Option<Quadratic>,
    pub perturbation: Perturbation,
    /// The energy scale, J.
    scale: f64,
    /// Steps of a full probe.
    pub steps: u64,
    /// Steps of the shortest full probe so far.
    pub shortest: u64,
    /// The shortest time scale, s.
    pub unit: f64,
    pub budget: Budget<'a>,
    /// The step found stable and the one found unstable, s, that a spent budget leaves behind.
    pub known: (Option<f64>, Option<f64>),
}

/// A limit, and in words how the first failing step fails, or how far the search went.
pub(super) type Found = (Limit, String);

/// Why a search ends before a limit is bracketed.
pub(super) enum Stop {
    /// There is no limit to bracket.
    Found(Found),
    Unsupported(Unsupported),
    /// The budget is spent.
    Spent,
}

impl From<Unsupported> for Stop {
    fn from(unsupported: Unsupported) -> Self {
        Self::Unsupported(unsupported)
    }
}

impl<'a> Experiment<'a> {
    /// `unit`: the shortest time scale, s. `budget` is in steps of the whole search; `tick` is called with
    /// steps taken.
    pub fn new(
        scene: &'a Scene,
        system: &'a ParticleSystem,
        make: &'a MakeRun<'a>,
        unit: f64,
        budget: u64,
        tick: &'a (dyn Fn(u64) + Sync),
    ) -> Result<Self, Unsupported> {
        let scale = energy_scale(scene, system, None).unwrap_or(1.0);
        let scale = scale.max(SEEN * rounding(scene));
        let start = ParticleSystem::initial_state(scene);
        let (quadratic, perturbation) = if system.rods().is_some() {
            if rests(system, &start) {
                if Linearised::new(system, &start, Effort::FULL).growing() > 0 {
                    return Err(Unsupported {
                        reason: GROWS_IN_TRUTH.to_owned(),
                    });
                }
                let about = Quadratic::about(system, start.x.clone());
                (Some(about), Perturbation::tiny(system, &start, scale))
            } else {
                (None, Perturbation::slight(system, &start, scale))
            }
        } else {
            let mut quadratic = Quadratic::new(system);
            let large = Perturbation::large(scene, system, &mut quadratic);
            // Before the first impact a step may look linear.
            if system.obstacles().is_none() && linear(scene, make, &large, 0.5 * unit)? {
                (Some(quadratic), large)
            } else {
                (None, Perturbation::slight(system, &start, scale))
            }
        };
        // A probe takes two runs where the map is linear.
        let runs = if quadratic.is_some() { 2 } else { 1 };
        let steps = (budget / PROBES / runs).clamp(FEWEST, STEPS);
        Ok(Self {
            scene,
            system,
            make,
            quadratic,
            perturbation,
            scale,
            steps,
            shortest: steps,
            unit,
            budget: Budget::new(budget, tick),
            known: (None, None),
        })
    }

    /// Whether differences of runs obey a linear map, everywhere or, on rods, near the rest they start from.
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

    /// Probes whether `h` is stable, over `steps` steps.
    pub fn probe(&mut self, h: f64, steps: u64, extensions: u32) -> Result<Probed, Stop> {
        let full = steps == self.steps;
        let steps = self.affordable(h, steps)?;
        if full {
            self.shortest = self.shortest.min(steps);
        }
        let watch = Watch {
            steps,
            extensions,
            clear: self.clear(),
        };
        let probed = if self.is_linear() {
            let mut runs = self.pair(h, &self.perturbation)?;
            self.watch_pair(&mut runs, watch)
        } else {
            let scene = self.perturbation.apply(self.scene);
            let mut runs = Runs::new(self.make, h, &[&scene])?;
            let system = self.system.clone();
            let never = f64::INFINITY;
            let driven = system.kinds().has(ForceKinds::DRIVEN);
            let lost = if driven { DIVERGED } else { LOST };
            let mut gauge = ExcessEnergy::new(&runs, system, &scene, self.scale, lost, never);
            probe(&mut runs, &mut gauge, watch, &mut self.budget)
        };
        probed.ok_or(Stop::Spent)
    }

    /// Of `steps` steps at `h` those that cost no more linear solves than as many steps nearby: Newton's
    /// iteration solves a step of a linear map at once.
    fn affordable(&mut self, h: f64, steps: u64) -> Result<u64, Stop> {
        if self.is_linear() {
            return Ok(steps);
        }
        let scene = self.perturbation.apply(self.scene);
        let mut runs = Runs::new(self.make, h, &[&scene])?;
        let sample = (0..SAMPLE).take_while(|_| runs.passes() < ENOUGH && runs.step().is_ok());
        let taken = sample.count() as u64;
        if !self.budget.spend(taken, runs.passes()) {
            return Err(Stop::Spent);
        }
        let most = SOLVES * steps * taken.max(1) / runs.solves().max(1);
        Ok(steps.min(most.max(LEAST)))
    }

    /// Probes two runs of a linear map.
    fn watch_pair(&mut self, runs: &mut Runs, watch: Watch) -> Option<Probed> {
        let mut gauge = DifferenceEnergy::new(runs, self.quadratic.clone()?);
        probe(runs, &mut gauge, watch, &mut self.budget)
    }

    /// Two runs at `h`, the second from a start perturbed by `shape`.
    pub fn pair(&self, h: f64, shape: &Perturbation) -> Result<Runs, Unsupported> {
        Runs::new(self.make, h, &[self.scene, &shape.apply(self.scene)])
    }

    /// Growth of ln(amplitude) per second at `h`, once what grows fastest has outgrown the rest. Runs at
    /// the shortest time scale, where growth is steep, bring that about beforehand. None where the map is
    /// not linear: the rate of growth changes there.
    pub fn growth(&mut self, h: f64) -> Option<f64> {
        let mut quadratic = self.quadratic.clone()?;
        let wanted = quadratic.energy(&self.perturbation);
        let mut shape = self.perturbation.clone();
        let mut watch = Watch {
            steps: self.steps,
            extensions: 0,
            clear: CLEAR_LINEAR,
        };
        for _ in 0..ROUNDS {
            let mut runs = self.pair(self.unit, &shape).ok()?;
            let probed = self.watch_pair(&mut runs, watch);
            let grown = runs.difference(1);
            let energy = quadratic.energy(&grown);
            let grew = probed.is_some_and(|probed| probed.unstable());
            if !grew || !energy.is_finite() || energy <= 0.0 {
                break;
            }
            shape = grown.scaled((wanted / energy).sqrt());
        }
        // A trace of everything else is added, in case something else grows here.
        let shape = shape.plus(&self.perturbation.scaled(TRACE));
        watch.steps = STEPS;
        watch.extensions = 2;
        let mut runs = self.pair(h, &shape).ok()?;
        let rate = self.watch_pair(&mut runs, watch)?.rate?;
        Some(0.5 * rate / h)
    }
}

/// One rounding of the weights' potential energy, J.
fn rounding(scene: &Scene) -> f64 {
    let gravity = gravity(scene);
    let heights = scene.particles.iter().filter(|p| !p.fixed).map(|p| {
        let far = p.position.iter().fold(0.0, |m: f64, c| m.max(c.abs()));
        p.mass * far
    });
    f64::EPSILON * gravity * heights.sum::<f64>()
}

/// Whether a scene starts from a rest on rods: without velocities, and with no more force left than rounding.
fn rests(system: &ParticleSystem, start: &State) -> bool {
    let [mut left, mut free] = [vec![0.0; start.x.len()], vec![0.0; start.x.len()]];
    system.acceleration(start.t, &start.x, &start.v, &mut left);
    system.free_acceleration(start.t, &start.x, &start.v, &mut free);
    let largest = |a: &[f64]| a.iter().fold(0.0, |most: f64, a| most.max(a.abs()));
    let still = start.v.iter().all(|v| *v == 0.0);
    let driven = system.kinds().has(ForceKinds::DRIVEN);
    still && !driven && largest(&left) <= STILL * largest(&free)
}

/// Whether twice the perturbation makes twice the difference, to rounding, at `h`, a step well inside every
/// limit. The scene's effects do not tell: some methods are not linear where the forces are.
fn linear(scene: &Scene, make: &MakeRun, by: &Perturbation, h: f64) -> Result<bool, Unsupported> {
    let starts = [scene, &by.apply(scene), &by.scaled(2.0).apply(scene)];
    let mut runs = Runs::new(make, h, &starts)?;
    if (0..LINEAR_STEPS).any(|_| runs.step().is_err()) {
        return Ok(false);
    }
    let (once, twice) = (runs.difference(1), runs.difference(2));
    let proportional = |once: &[f64], twice: &[f64]| {
        let pairs = || once.iter().zip(twice);
        let off = pairs().fold(0.0_f64, |off, (o, t)| off.max((t - 2.0 * o).abs()));
        let most = once.iter().fold(0.0_f64, |most, o| most.max(o.abs()));
        twice.iter().all(|t| t.is_finite()) && off <= LINEAR * most
    };
    Ok(proportional(&once.x, &twice.x) && proportional(&once.v, &twice.v))
}
