//! The plan of a sweep: the settings of each solver, evenly spaced in ln h, from where it becomes stable to where
//! its part of the budget ends.

use super::CostChoice;
use crate::integrators::Stable;
use crate::measure::stability::{Effort, Limit, Linearised};
use crate::physics::ParticleSystem;
use crate::report::words;
use crate::scene::{Scene, limits};
use crate::solvers::{Setting, Solver, SolverKind};

/// A solver and its planned settings: one curve of the diagram.
pub struct Sweep {
    pub solver: Solver,
    /// The stated order on this scene; None where none is stated.
    pub order: Option<u32>,
    /// Coarse to fine.
    pub settings: Vec<Setting>,
    /// Nominal nanoseconds a step.
    each: f64,
    /// The part of the budget that is this solver's, nominal ns; None where the steps were given by name.
    share: Option<f64>,
}

impl Sweep {
    /// Why a setting is not run: it would take more than the solver's share of the budget. None for pairs,
    /// which stop when theirs is used up.
    pub fn too_long(&self, setting: &Setting) -> Option<String> {
        let share = self.share.filter(|_| setting.tolerance().is_none())?;
        let takes = (1.0 + TIMED_RUNS) * self.run(setting);
        (takes > share).then(|| {
            format!(
                "not run: it would take about {}, and its share of the budget is {}",
                words::seconds(1e-9 * takes),
                words::seconds(1e-9 * share)
            )
        })
    }

    /// Nominal microseconds of the run that finds the error.
    pub fn of_error(&self, setting: &Setting) -> u64 {
        match self.too_long(setting) {
            Some(_) => 0,
            None => (1e-3 * self.run(setting)) as u64,
        }
    }

    /// Nominal microseconds of the runs that are timed.
    pub fn of_timing(&self, setting: &Setting) -> u64 {
        match self.too_long(setting) {
            Some(_) => 0,
            None => (1e-3 * (TIMED_RUNS * self.run(setting)).max(MIN_TIMED_NS)) as u64,
        }
    }

    /// The setting one step coarser than this: twice the step, or ten times the tolerance; None beyond what
    /// says anything about a motion.
    pub fn coarser(&self, setting: &Setting) -> Option<Setting> {
        match *setting {
            Setting::Steps { timestep, steps } => {
                let fewer = steps.div_ceil(2);
                let duration = timestep * steps as f64;
                (fewer < steps && fewer as f64 >= MIN_STEPS)
                    .then(|| Setting::divided(duration, fewer))
            }
            Setting::Tolerance {
                tolerance,
                duration,
                steps,
                max_steps,
            } => (tolerance < 1.0).then_some(Setting::Tolerance {
                tolerance: 10.0 * tolerance,
                duration,
                steps,
                max_steps,
            }),
        }
    }

    /// Nominal microseconds of all runs.
    pub fn work(&self) -> u64 {
        let each = |setting| self.of_error(setting) + self.of_timing(setting);
        self.settings.iter().map(each).sum()
    }

    /// Nominal nanoseconds of one run.
    fn run(&self, setting: &Setting) -> f64 {
        let most = match setting {
            Setting::Steps { .. } => u64::MAX,
            Setting::Tolerance { max_steps, .. } => *max_steps,
        };
        self.each * setting.steps().min(most) as f64
    }
}

/// The sweeps of all solvers, in the order of the curves.
pub fn plan(scene: &Scene, system: &ParticleSystem, choice: &CostChoice) -> Vec<Sweep> {
    // Pairs choose their own steps: where timesteps are given there is nothing to sweep.
    let timesteps = choice.timesteps.as_deref();
    let is_swept = |solver: &&Solver| timesteps.is_none() || solver.as_pair().is_none();
    let solvers: Vec<&Solver> = choice.solvers.iter().filter(is_swept).collect();
    let own = Setting::step(scene.solver.timestep);
    let runs = |solver: &Solver| solver.start(scene, system, &own).is_ok();
    let running = solvers.iter().filter(|solver| runs(solver)).count();
    let budget = choice.budget_s / running.max(1) as f64;
    let start = ParticleSystem::initial_state(scene);
    let linearised = Linearised::new(system, &start, Effort::BRIEF);
    let sweep = |solver: &Solver| {
        let coarsest = coarsest(scene, &linearised, solver);
        if timesteps.is_none() && !runs(solver) {
            return Sweep {
                order: solver.order(system),
                solver: solver.clone(),
                settings: vec![coarsest],
                each: 0.0,
                share: None,
            };
        }
        let each = step_cost(scene, system, solver, &coarsest);
        let coarsest = afforded(scene, &linearised, solver, coarsest, each, budget);
        let count = choice.settings;
        let settings = match (timesteps, solver.as_pair()) {
            (Some(timesteps), _) => named(scene, timesteps),
            (None, Some(pair)) => tolerances(scene, &linearised, pair.order, each, count, budget),
            (None, None) => spaced(scene, &coarsest, each, count, budget),
        };
        Sweep {
            order: solver.order(system),
            solver: solver.clone(),
            settings,
            each,
            share: timesteps.is_none().then_some(1e9 * budget),
        }
    };
    solvers.into_iter().map(sweep).collect()
}

/// h w_max at which a method that is never stable starts, and one that is always stable.
const NEVER: f64 = 0.2;
const ALWAYS: f64 = 2.0;
/// The fewest steps of a run: fewer say nothing about a motion.
const MIN_STEPS: f64 = 8.0;
/// Steps of the coarsest run where the motion's speed is not known.
const DEFAULT_STEPS: f64 = 50.0;
/// The range of tolerances of a pair.
const LOOSEST: f64 = 1e-2;
const TIGHTEST: f64 = 1e-14;
/// A pair's steps at a tolerance of 1 have an h w of about one over this.
const EFFORT: f64 = 0.2;
/// Steps a pair may take, however small its budget.
const MIN_PAIR_STEPS: f64 = 1e4;
/// The finest run has at least this many times the steps of the coarsest, however small the budget.
const MIN_RANGE: f64 = 4.0;
/// Where even that range takes more than the budget, fewer settings are tried in it, down to this many.
const MIN_SETTINGS: usize = 3;

/// Exactly these timesteps, coarse to fine.
fn named(scene: &Scene, timesteps: &[f64]) -> Vec<Setting> {
    let mut timesteps = timesteps.to_vec();
    timesteps.sort_by(|a, b| b.total_cmp(a));
    timesteps.dedup();
    let setting = |&timestep: &f64| Setting::Steps {
        timestep,
        steps: scene.steps(timestep),
    };
    timesteps.iter().map(setting).collect()
}

/// The coarsest setting of an engine: just inside its stability limit, or at the loosest tolerance.
fn coarsest(scene: &Scene, linearised: &Linearised, solver: &Solver) -> Setting {
    if let Some(pair) = solver.as_pair() {
        return tolerance(scene, rate(linearised), pair.order, LOOSEST, 1);
    }
    let steps = (scene.duration / largest_step(scene, linearised, solver)).max(MIN_STEPS);
    Setting::divided(scene.duration, steps.min(limits::STEPS) as u64 + 1)
}

/// The coarsest setting, made coarser where three settings from there on would take more than the budget. Only
/// an engine that is stable at every step can start at a larger one.
fn afforded(
    scene: &Scene,
    linearised: &Linearised,
    solver: &Solver,
    coarsest: Setting,
    each: f64,
    budget_s: f64,
) -> Setting {
    let runs = (1.0 + TIMED_RUNS) * least_runs(MIN_SETTINGS);
    let most = (1e9 * budget_s / each / runs).max(MIN_STEPS);
    let always = match solver.follows {
        None => solver.kind == SolverKind::Rapier,
        Some(method) => {
            let prediction = linearised.predict(method, scene.solver.timestep);
            prediction.limit == Limit::Unconditional
        }
    };
    if always && coarsest.steps() as f64 > most {
        Setting::divided(scene.duration, most as u64)
    } else {
        coarsest
    }
}

/// The cost of all runs over the least range, in units of the coarsest run.
fn least_runs(settings: usize) -> f64 {
    let ratio = MIN_RANGE.powf(1.0 / (settings - 1) as f64);
    (MIN_RANGE * ratio - 1.0) / (ratio - 1.0)
}

/// Evenly spaced settings from the coarsest on: `settings` of them, or fewer where whole numbers of steps coincide
/// or the least range takes more than the budget. `each` is the cost of a step, nominal ns; `budget_s` that of all
/// runs of this engine, nominal seconds.
fn spaced(
    scene: &Scene,
    coarsest: &Setting,
    each: f64,
    settings: usize,
    budget_s: f64,
) -> Vec<Setting> {
    let duration = scene.duration;
    let first = coarsest.steps() as f64;
    let step = 1e-9 * each;
    let at_most = limits::STEPS.max(first);
    let settings = affordable(settings.max(2), first * step, budget_s);
    if (1.0 + TIMED_RUNS) * first * step * least_runs(MIN_SETTINGS) > budget_s {
        return few(duration, first, step, budget_s);
    }
    let budget = budget_s - 1e-9 * MIN_TIMED_NS * settings as f64;
    // Runs grow by a factor r from one to the next: together they are r / (r - 1) times the finest.
    let finest = |ratio: f64| {
        let all = (1.0 + TIMED_RUNS) * ratio / (ratio - 1.0);
        (budget.max(0.0) / all / step)
            .max(MIN_RANGE * first)
            .min(at_most)
    };
    // The factor depends on the range, which depends, a little, on the factor.
    let mut last = finest(2.0);
    for _ in 0..3 {
        last = finest((last / first).powf(1.0 / (settings - 1) as f64).max(1.01));
    }
    let steps = (0..settings).map(|k| {
        let part = k as f64 / (settings - 1) as f64;
        (first * (last / first).powf(part)).round().min(at_most) as u64
    });
    let mut steps: Vec<u64> = steps.collect();
    steps.dedup();
    steps
        .into_iter()
        .map(|n| Setting::divided(duration, n))
        .collect()
}

/// The settings of the least range that fit into the budget one after the other; the coarsest always is one,
/// also where it alone does not.
fn few(duration: f64, first: f64, step: f64, budget_s: f64) -> Vec<Setting> {
    let ratio = MIN_RANGE.powf(1.0 / (MIN_SETTINGS - 1) as f64);
    let mut left = budget_s;
    let steps = (0..MIN_SETTINGS as i32).map(|k| (first * ratio.powi(k)).round());
    let fits = |steps: &f64| {
        left -= (1.0 + TIMED_RUNS) * steps * step;
        *steps <= first || left >= 0.0
    };
    let steps = steps.take_while(fits);
    steps
        .map(|n| Setting::divided(duration, n as u64))
        .collect()
}

/// How many settings over the least range fit into the budget, s, if the coarsest run takes `coarsest` seconds;
/// no more than wanted, and no fewer than the minimum.
fn affordable(wanted: usize, coarsest: f64, budget_s: f64) -> usize {
    let takes = |settings: usize| {
        let runs = least_runs(settings);
        (1.0 + TIMED_RUNS) * coarsest * runs + 1e-9 * MIN_TIMED_NS * settings as f64
    };
    let fewer = (MIN_SETTINGS..wanted).rev();
    let fits = |settings: &usize| takes(*settings) <= budget_s;
    if fits(&wanted) {
        return wanted;
    }
    fewer
        .into_iter()
        .find(fits)
        .unwrap_or(wanted.min(MIN_SETTINGS))
}

/// The largest frequency or damping rate of the scene, 1/s; 0 where neither is known.
fn rate(linearised: &Linearised) -> f64 {
    let omega = linearised.omega_max().unwrap_or(0.0);
    omega.max(linearised.damping_max())
}

/// A pair's setting, with the steps estimated from its error per unit step, (h w)^order.
fn tolerance(scene: &Scene, rate: f64, order: u32, tolerance: f64, max_steps: u64) -> Setting {
    let rate = if rate > 0.0 {
        rate
    } else {
        DEFAULT_STEPS / scene.duration
    };
    let steps = EFFORT * scene.duration * rate * tolerance.powf(-1.0 / f64::from(order));
    Setting::Tolerance {
        tolerance,
        duration: scene.duration,
        steps: steps.clamp(1.0, limits::STEPS) as u64,
        max_steps,
    }
}

/// Tolerances evenly spaced in their logarithm, as tight as the budget allows. `each` and `budget_s` are as in
/// [`spaced`].
fn tolerances(
    scene: &Scene,
    linearised: &Linearised,
    order: u32,
    each: f64,
    settings: usize,
    budget_s: f64,
) -> Vec<Setting> {
    let rate = rate(linearised);
    let settings = settings.max(2);
    let budget = budget_s - 1e-9 * MIN_TIMED_NS * settings as f64;
    // One run must not take the budget of a dozen and their timing.
    let most = (1e9 * budget.max(0.0) / each / (1.0 + TIMED_RUNS)).max(MIN_PAIR_STEPS) as u64;
    let at = |tightest: f64, k: usize| {
        let part = k as f64 / (settings - 1) as f64;
        let own = LOOSEST * (tightest / LOOSEST).powf(part);
        tolerance(scene, rate, order, own, most)
    };
    let takes = |tightest: f64| {
        let all = (0..settings).map(|k| at(tightest, k).steps() as f64);
        all.sum::<f64>() * each * 1e-9 * (1.0 + TIMED_RUNS)
    };
    let mut tightest = TIGHTEST;
    while takes(tightest) > budget && tightest < LOOSEST * 1e-2 {
        tightest *= 10.0;
    }
    (0..settings).map(|k| at(tightest, k)).collect()
}

/// The largest step worth trying, s.
fn largest_step(scene: &Scene, linearised: &Linearised, solver: &Solver) -> f64 {
    let rate = rate(linearised);
    let over = |z: f64| {
        if rate > 0.0 {
            z / rate
        } else {
            scene.duration / DEFAULT_STEPS
        }
    };
    let Some(method) = solver.follows else {
        return over(ALWAYS);
    };
    let many = f64::from(solver.substeps);
    match linearised.predict(method, scene.solver.timestep).limit {
        Limit::At(limit) if limit > 0.0 => (limit * many).min(over(4.0 * ALWAYS) * many),
        Limit::Between(low, _) if low > 0.0 => low * many,
        Limit::Unconditional => over(ALWAYS) * many,
        Limit::Never => over(NEVER),
        _ if method.oscillator.stable == Stable::Always => over(ALWAYS) * many,
        _ => over(NEVER) * many,
    }
}

/// Nanoseconds on the nominal machine: a step without its forces, and each particle in it.
const STEP: f64 = 30.0;
const PARTICLE: f64 = 4.0;
/// An evaluation without its members, and each particle and spring in it.
const CALL: f64 = 35.0;
const EVALUATION: f64 = 4.0;
const SPRING: f64 = 10.0;
/// Each rod in an evaluation, and as much again for a step: a factor, a few solves.
const ROD: f64 = 300.0;
/// A linear solve of n free particles: n^1.5 of the first while it is small and dense, else n of the second.
const DENSE: f64 = 280.0;
const SPARSE: f64 = 2_500.0;
/// A step of rapier, each body and joint in it, and each of these again in every substep.
const WORLD: f64 = 1_000.0;
const BODY: f64 = 250.0;
const SUBSTEP: f64 = 90.0;
/// Steps that are run to take the counts.
const SAMPLE: u64 = 4;

/// A timing takes as long as this many runs, and at least this long, ns.
const TIMED_RUNS: f64 = 3.5;
const MIN_TIMED_NS: f64 = 1.2e7;

/// The expected cost of a step on the nominal machine, ns, from its counts. It is the same on every machine, so
/// that all try the same settings.
fn step_cost(scene: &Scene, system: &ParticleSystem, solver: &Solver, setting: &Setting) -> f64 {
    let (particles, springs) = (scene.particles.len() as f64, scene.springs.len() as f64);
    if solver.kind == SolverKind::Rapier {
        let substeps = f64::from(solver.substeps);
        return WORLD + (particles + springs) * (BODY + SUBSTEP * substeps);
    }
    let Ok(mut run) = solver.start(scene, system, setting) else {
        return STEP;
    };
    // A step that fails ends the sample.
    let _ = run.advance(SAMPLE);
    let counts = run.counts();
    let each = |count: Option<u64>| count.unwrap_or(0) as f64 / run.taken().max(1) as f64;
    let (pairs, hinges) = (scene.gravitational.len() as f64, scene.bending.len() as f64);
    let like_springs = springs + 2.0 * pairs + 8.0 * hinges;
    let rods = ROD * scene.rods.len() as f64;
    let evaluation = CALL + EVALUATION * particles + SPRING * like_springs + rods;
    let free = scene.particles.iter().filter(|p| !p.fixed).count() as f64;
    let solve = (DENSE * free.powf(1.5)).min(SPARSE * free);
    STEP + PARTICLE * particles
        + rods
        + evaluation * each(counts.all_force_passes())
        + solve * each(counts.linear_solves)
}
