//! The plan of a sweep: the settings each solver is tried at, evenly spaced in ln h, from where it becomes stable
//! to where its share of the budget ends.

use super::CostChoice;
use crate::integrators::Stable;
use crate::measure::stability::{Effort, Limit, Linearised};
use crate::physics::{ParticleSystem, System};
use crate::scene::{Scene, limits};
use crate::solvers::{Kind, Setting, Solver};

/// A solver and the settings it is planned to run at: one line of the diagram.
pub struct Sweep {
    pub solver: Solver,
    /// Order on this scene; None where nothing is stated.
    pub order: Option<u32>,
    /// Coarse to fine.
    pub settings: Vec<Setting>,
    /// Nominal nanoseconds a step.
    each: f64,
}

impl Sweep {
    /// Nominal microseconds of the run that finds the error.
    pub fn of_error(&self, setting: &Setting) -> u64 {
        (1e-3 * self.run(setting)) as u64
    }

    /// Nominal microseconds of the runs that are timed.
    pub fn of_timing(&self, setting: &Setting) -> u64 {
        (1e-3 * (TIMED * self.run(setting)).max(TIMED_LEAST)) as u64
    }

    /// Nominal microseconds of all.
    pub fn work(&self) -> u64 {
        let each = |setting| self.of_error(setting) + self.of_timing(setting);
        self.settings.iter().map(each).sum()
    }

    /// Nanoseconds.
    fn run(&self, setting: &Setting) -> f64 {
        self.each * setting.steps() as f64
    }
}

/// The sweeps of all solvers, in the order of the curves.
pub fn plan(scene: &Scene, system: &ParticleSystem, choice: &CostChoice) -> Vec<Sweep> {
    // Pairs choose their own steps: with steps named there is nothing to sweep.
    let timesteps = choice.timesteps.as_deref();
    let swept = |solver: &&Solver| timesteps.is_none() || solver.as_pair().is_none();
    let solvers: Vec<&Solver> = choice.solvers.iter().filter(swept).collect();
    let share = choice.budget_s / solvers.len().max(1) as f64;
    let start = ParticleSystem::initial_state(scene);
    let linearised = Linearised::new(system, &start, Effort::BRIEF);
    let sweep = |solver: &Solver| {
        let coarsest = coarsest(scene, &linearised, solver);
        let each = price_of_step(scene, system, solver, &coarsest);
        let coarsest = afforded(scene, &linearised, solver, coarsest, each, share);
        let count = choice.settings;
        let settings = match (timesteps, solver.as_pair()) {
            (Some(timesteps), _) => named(scene, timesteps),
            (None, Some(pair)) => tolerances(scene, &linearised, pair.order, each, count, share),
            (None, None) => spaced(scene, &coarsest, each, count, share),
        };
        Sweep {
            order: solver.order(system.kinds().depends_on_velocity()),
            solver: solver.clone(),
            settings,
            each,
        }
    };
    solvers.into_iter().map(sweep).collect()
}

/// h w_max at which a method starts that is stable at no step, and one that is at every step.
const NEVER: f64 = 0.2;
const ALWAYS: f64 = 2.0;
/// Fewest steps of a run: fewer say nothing of a motion.
const FEWEST: f64 = 8.0;
/// Steps where nothing is known of the motion's speed.
const SLOW: f64 = 50.0;
/// Tolerances a pair is tried at.
const LOOSEST: f64 = 1e-2;
const TIGHTEST: f64 = 1e-14;
/// h w of a pair's steps at a tolerance of 1 is about one over this.
const EFFORT: f64 = 0.2;
/// Steps a pair may take however small its share.
const LEAST_STEPS: f64 = 1e4;
/// The finest run has at least this many times the steps of the coarsest, however small the budget.
const LEAST_RANGE: f64 = 4.0;
/// Where even that range is more than the share, fewer settings are tried of it, down to these.
const LEAST_SETTINGS: usize = 3;

/// Exactly these steps, coarse to fine.
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

/// Where an engine starts: just inside its limit, or at the loosest tolerance.
fn coarsest(scene: &Scene, linearised: &Linearised, solver: &Solver) -> Setting {
    if let Some(pair) = solver.as_pair() {
        return tolerance(scene, rate(linearised), pair.order, LOOSEST, 1);
    }
    let steps = (scene.duration / start(scene, linearised, solver)).max(FEWEST);
    Setting::divided(scene.duration, steps.min(limits::STEPS) as u64 + 1)
}

/// The same, coarser where three settings from there on would take more than the share: an engine that is
/// stable at every step can be tried at larger ones, one that is not cannot.
fn afforded(
    scene: &Scene,
    linearised: &Linearised,
    solver: &Solver,
    coarsest: Setting,
    each: f64,
    share_s: f64,
) -> Setting {
    let runs = (1.0 + TIMED) * least_runs(LEAST_SETTINGS);
    let most = (1e9 * share_s / each / runs).max(FEWEST);
    let always = match solver.follows {
        None => solver.kind == Kind::Rapier,
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

/// What all runs over the least range take, in units of the coarsest.
fn least_runs(settings: usize) -> f64 {
    let ratio = LEAST_RANGE.powf(1.0 / (settings - 1) as f64);
    (LEAST_RANGE * ratio - 1.0) / (ratio - 1.0)
}

/// `settings` of them from the coarsest on, or fewer where whole numbers of steps coincide or the least
/// range takes more than the share. `each` is what a step takes, nominal ns; `share_s` what all runs of this
/// engine may take, nominal seconds.
fn spaced(
    scene: &Scene,
    coarsest: &Setting,
    each: f64,
    settings: usize,
    share_s: f64,
) -> Vec<Setting> {
    let duration = scene.duration;
    let first = coarsest.steps() as f64;
    let step = 1e-9 * each;
    let at_most = limits::STEPS.max(first);
    let settings = affordable(settings.max(2), first * step, share_s);
    let share = share_s - 1e-9 * TIMED_LEAST * settings as f64;
    // Runs grow by a factor r from one to the next: together they are r / (r - 1) times the finest.
    let finest = |ratio: f64| {
        let all = (1.0 + TIMED) * ratio / (ratio - 1.0);
        (share.max(0.0) / all / step)
            .max(LEAST_RANGE * first)
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

/// How many settings over the least range fit into the share, s, if the coarsest run takes so many seconds;
/// no more than asked for, and not below the fewest.
fn affordable(asked: usize, coarsest: f64, share_s: f64) -> usize {
    let takes = |settings: usize| {
        let runs = least_runs(settings);
        (1.0 + TIMED) * coarsest * runs + 1e-9 * TIMED_LEAST * settings as f64
    };
    let fewer = (LEAST_SETTINGS..asked).rev();
    let fits = |settings: &usize| takes(*settings) <= share_s;
    if fits(&asked) {
        return asked;
    }
    fewer
        .into_iter()
        .find(fits)
        .unwrap_or(asked.min(LEAST_SETTINGS))
}

/// The fastest the scene moves, 1/s; 0 where nothing is known.
fn rate(linearised: &Linearised) -> f64 {
    let omega = linearised.omega_max().unwrap_or(0.0);
    omega.max(linearised.damping_max())
}

/// A pair's setting. It takes about as many steps as its error per unit step, (h w)^order, makes it.
fn tolerance(scene: &Scene, rate: f64, order: u32, tolerance: f64, most: u64) -> Setting {
    let rate = if rate > 0.0 {
        rate
    } else {
        SLOW / scene.duration
    };
    let steps = EFFORT * scene.duration * rate * tolerance.powf(-1.0 / f64::from(order));
    Setting::Tolerance {
        tolerance,
        duration: scene.duration,
        steps: steps.clamp(1.0, limits::STEPS) as u64,
        most,
    }
}

/// Tolerances evenly spaced in their logarithm, down to what the share allows. `each` and `share_s` as in
/// [`spaced`].
fn tolerances(
    scene: &Scene,
    linearised: &Linearised,
    order: u32,
    each: f64,
    settings: usize,
    share_s: f64,
) -> Vec<Setting> {
    let rate = rate(linearised);
    let settings = settings.max(2);
    let share = share_s - 1e-9 * TIMED_LEAST * settings as f64;
    // One run must not take all that was meant for a dozen and their timing.
    let most = (1e9 * share.max(0.0) / each / (1.0 + TIMED)).max(LEAST_STEPS) as u64;
    let at = |tightest: f64, k: usize| {
        let part = k as f64 / (settings - 1) as f64;
        let own = LOOSEST * (tightest / LOOSEST).powf(part);
        tolerance(scene, rate, order, own, most)
    };
    let takes = |tightest: f64| {
        let all = (0..settings).map(|k| at(tightest, k).steps() as f64);
        all.sum::<f64>() * each * 1e-9 * (1.0 + TIMED)
    };
    let mut tightest = TIGHTEST;
    while takes(tightest) > share && tightest < LOOSEST * 1e-2 {
        tightest *= 10.0;
    }
    (0..settings).map(|k| at(tightest, k)).collect()
}

/// The largest step worth trying, s.
fn start(scene: &Scene, linearised: &Linearised, solver: &Solver) -> f64 {
    let rate = rate(linearised);
    let over = |z: f64| {
        if rate > 0.0 {
            z / rate
        } else {
            scene.duration / SLOW
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

/// Nanoseconds on the nominal machine. A step beside its forces, and each particle in it:
const STEP: f64 = 30.0;
const PARTICLE: f64 = 4.0;
/// An evaluation beside its members, and each particle and spring in it:
const CALL: f64 = 35.0;
const EVALUATION: f64 = 4.0;
const SPRING: f64 = 10.0;
/// A linear solve of n free particles, n^1.5 of these while it is small and dense, n of the others:
const DENSE: f64 = 280.0;
const SPARSE: f64 = 2_500.0;
/// A step of rapier, each body and joint in it, and in each of its substeps:
const WORLD: f64 = 1_000.0;
const BODY: f64 = 250.0;
const SWEPT: f64 = 90.0;
/// Steps the counts are taken from.
const SAMPLE: u64 = 4;

/// Runs a timing takes, and the least time it takes, ns.
const TIMED: f64 = 3.5;
const TIMED_LEAST: f64 = 1.2e7;

/// What a step is expected to take on the nominal machine, ns, from what it counts: the same on every machine,
/// so that all sweep the same settings.
fn price_of_step(
    scene: &Scene,
    system: &ParticleSystem,
    solver: &Solver,
    setting: &Setting,
) -> f64 {
    let (particles, springs) = (scene.particles.len() as f64, scene.springs.len() as f64);
    if solver.kind == Kind::Rapier {
        let substeps = f64::from(solver.substeps);
        return WORLD + (particles + springs) * (BODY + SWEPT * substeps);
    }
    let Ok(mut run) = solver.start(scene, system, setting) else {
        return STEP;
    };
    // A step that fails ends the sample.
    let _ = run.advance(SAMPLE);
    let counts = run.counts();
    let each = |count: Option<u64>| count.unwrap_or(0) as f64 / run.taken().max(1) as f64;
    let pairs = scene.gravitational.len() as f64;
    let evaluation = CALL + EVALUATION * particles + SPRING * (springs + 2.0 * pairs);
    let free = scene.particles.iter().filter(|p| !p.fixed).count() as f64;
    let solve = (DENSE * free.powf(1.5)).min(SPARSE * free);
    STEP + PARTICLE * particles
        + evaluation * each(counts.all_force_passes())
        + solve * each(counts.linear_solves)
}
