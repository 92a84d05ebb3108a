//! One solver over its settings: each run once, from coarse to fine, until it can get no better.

use super::CostChoice;
use super::errors::Errors;
use super::sampler::{Sampler, Samples};
use super::{price, settings};
use crate::measure::stability::{Effort, Linearised};
use crate::physics::{ParticleSystem, System};
use crate::scene::Scene;
use crate::solvers::{Counts, Ended, Limits, Run, Setting, Solver};
use crate::solvers::{Kind, Status};
use crate::verbs::cost::CostPoint;
use crate::verbs::host::Host;

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
        (1e-3 * (price::TIMED * self.run(setting)).max(price::TIMED_LEAST)) as u64
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
    let named = choice.timesteps.as_deref();
    let swept = |solver: &&Solver| named.is_none() || solver.as_pair().is_none();
    let solvers: Vec<&Solver> = choice.solvers.iter().filter(swept).collect();
    let share = choice.budget_s / solvers.len().max(1) as f64;
    let start = ParticleSystem::initial_state(scene);
    let linearised = Linearised::new(system, &start, Effort::BRIEF);
    let sweep = |solver: &Solver| {
        let coarsest = settings::coarsest(scene, &linearised, solver);
        let each = price::of_step(scene, system, solver, &coarsest);
        let coarsest = settings::afforded(scene, &linearised, solver, coarsest, each, share);
        let count = choice.settings;
        let settings = match (named, solver.as_pair()) {
            (Some(timesteps), _) => settings::named(scene, timesteps),
            (None, Some(pair)) => {
                settings::tolerances(scene, &linearised, pair.order, each, count, share)
            }
            (None, None) => settings::spaced(scene, &coarsest, each, count, share),
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

/// What all runs share.
pub struct Ground<'a> {
    pub scene: &'a Scene,
    pub system: &'a ParticleSystem,
    pub errors: &'a Errors<'a>,
    pub limits: &'a Limits,
    pub host: &'a dyn Host,
    /// Whether the runs' states are wanted later.
    pub panels: bool,
}

/// One solver's points, coarse to fine, and beside each its setting.
#[derive(Default)]
pub struct Swept {
    pub settings: Vec<Setting>,
    pub points: Vec<CostPoint>,
    /// Beside each point; empty unless wanted.
    pub kept: Vec<Samples>,
    /// Over all runs: full evaluations, passes over damping alone.
    counted: [u64; 2],
}

/// An error that is no less than this share of the best so far has stopped falling.
const FALLING: f64 = 0.7;
/// Errors below this share of the largest that stop falling do so because of rounding.
const SMALL: f64 = 1e-2;

impl Swept {
    /// Adds a point where its setting belongs.
    pub fn insert(
        &mut self,
        setting: Setting,
        (point, kept, counts): (CostPoint, Samples, Counts),
    ) {
        let at = self.settings.partition_point(|s| s.is_no_finer(&setting));
        self.settings.insert(at, setting);
        self.points.insert(at, point);
        if !kept.t.is_empty() {
            self.kept.insert(at.min(self.kept.len()), kept);
        }
        self.counted[0] += counts.force_evaluations.unwrap_or(0);
        self.counted[1] += counts.damping_evaluations.unwrap_or(0);
    }

    /// What hand-written integrators evaluated in all these runs: full, damping alone.
    pub fn evaluations(all: &[Swept], sweeps: &[Sweep]) -> [u64; 2] {
        let ours = all.iter().zip(sweeps);
        let ours = ours.filter(|(_, sweep)| sweep.solver.kind == Kind::Integrator);
        ours.fold([0, 0], |sum, (swept, _)| {
            [sum[0] + swept.counted[0], sum[1] + swept.counted[1]]
        })
    }

    /// Whether finer settings can only be worse: rounding or the truth's bar is all that is left.
    fn is_spent(&self) -> bool {
        let errors: Vec<f64> = self.points.iter().filter_map(|p| p.error_m).collect();
        let floored = self.points.iter().filter(|p| p.at_floor).count();
        let largest = errors.iter().copied().fold(0.0, f64::max);
        let [before @ .., one, two] = errors.as_slice() else {
            return floored > 1;
        };
        let best = before.iter().copied().fold(f64::INFINITY, f64::min);
        let stopped = one.min(*two) > FALLING * best && best < SMALL * largest;
        floored > 1 || stopped
    }
}

impl Ground<'_> {
    /// All settings of an engine, coarse to fine; `stop` leaves out those that can only be worse.
    pub fn sweep(&self, sweep: &Sweep, stop: bool) -> Swept {
        let mut swept = Swept::default();
        for setting in &sweep.settings {
            let left_out = stop && swept.is_spent();
            if !left_out {
                swept.insert(*setting, self.run(&sweep.solver, setting));
            }
            let work = sweep.of_error(setting);
            let timed = sweep.of_timing(setting);
            let ended = swept
                .points
                .last()
                .is_some_and(|p| p.status != Status::Completed);
            self.host
                .progress(work + if left_out || ended { timed } else { 0 });
        }
        swept
    }

    /// One run and what came of it.
    pub fn run(&self, solver: &Solver, setting: &Setting) -> (CostPoint, Samples, Counts) {
        let mut run = match solver.start(self.scene, self.system, setting) {
            Ok(run) => run,
            Err(unsupported) => {
                let point = point(setting, Status::Unsupported, Some(unsupported.reason));
                return (point, Samples::default(), Counts::default());
            }
        };
        let mut sampler = Sampler::new(setting, self.errors.room);
        let ended = run.finish(self.limits, &mut sampler, &|_| {});
        let counts = run.counts();
        let (status, reason) = match ended {
            Ended::Completed => (Status::Completed, None),
            Ended::Exhausted => (Status::Failed, Some(exhausted(&run))),
            Ended::Diverged { reason, .. } => {
                (Status::Diverged, Some(format!("diverged: {reason}")))
            }
            Ended::Failed { step, error } => (
                Status::Failed,
                Some(format!("failed in step {step}: {error}")),
            ),
        };
        let mut point = point(setting, status, reason);
        if setting.tolerance().is_some() && run.taken() > 0 {
            point.steps = run.taken();
            point.timestep = self.scene.duration / point.steps as f64;
        }
        point.force_evaluations = counts.all_force_passes();
        point.linear_solves = counts.linear_solves;
        point.newton_iterations = counts.newton_iterations;
        let samples = sampler.samples;
        if status == Status::Completed {
            if let Some(off) = self.errors.errors(&samples) {
                point.error_m = Some(off.max);
                point.error_final_m = Some(off.last);
                point.at_floor = self.errors.at_floor(off.max, point.steps);
            }
            point.energy_error = self.errors.energy_error(&samples);
        }
        let kept = if self.panels {
            samples
        } else {
            Samples::default()
        };
        (point, kept, counts)
    }
}

/// Why a pair was stopped.
fn exhausted(run: &Run) -> String {
    let (steps, t) = (run.taken(), run.state().t);
    format!(
        "stopped at {t:.3e} s after {steps} accepted steps, all its share of the budget allows: what \
         limits them is stability, not the tolerance"
    )
}

fn point(setting: &Setting, status: Status, reason: Option<String>) -> CostPoint {
    CostPoint {
        timestep: setting.timestep(),
        tolerance: setting.tolerance(),
        steps: setting.steps(),
        status,
        reason,
        error_m: None,
        error_final_m: None,
        energy_error: None,
        at_floor: false,
        wall_s: None,
        force_evaluations: None,
        linear_solves: None,
        newton_iterations: None,
    }
}
