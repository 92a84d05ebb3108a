//! The runs of a sweep. Each setting runs once, from coarse to fine, until finer ones can be no better; where a
//! target lies between two settings, one or two more run. Completed settings are timed afterwards, when nothing
//! else runs.

use super::rank::reach;
use super::samples::{Sampler, Samples};
use super::settings::Sweep;
use crate::physics::constraints::kinetic_on_rods;
use crate::physics::{ParticleSystem, System};
use crate::scene::Scene;
use crate::solvers::{Counts, Ended, Limits, Run, Setting, Solver, SolverKind, Status};
use crate::trajectory::Unwatched;
use crate::truth::{States, Truth, TruthKind, farthest};
use crate::verbs::clock::{WallTime, spread};
use crate::verbs::cost::CostPoint;
use crate::verbs::facts;
use crate::verbs::session::Session;
use std::time::Instant;

/// The most instants of a run that are compared.
const MAX_INSTANTS: u64 = 500;
/// About the most numbers a run keeps.
const MAX_NUMBERS: u64 = 1 << 21;
/// Rounding in an error is at most this many roundings of the largest coordinate, times the square root
/// of the steps: a random walk.
const ROUNDINGS: f64 = 4.0;

/// An error above this fraction of the best so far has stopped falling.
const STALLED: f64 = 0.7;
/// Errors below this fraction of the largest stop falling because of rounding.
const SMALL: f64 = 1e-2;

/// The most settings tried that are coarser than the range.
const MAX_COARSER: usize = 6;

/// The most extra runs for each target.
const MAX_ATTEMPTS: usize = 2;
/// Two settings whose steps differ by less than this factor need none between them.
const MIN_STEP_RATIO: f64 = 1.06;
/// The error aimed at, as a fraction of the target: the line between two points is not quite straight.
const AIM: f64 = 0.93;
/// An error above this fraction of the target is not worth another run.
const CLOSE_ENOUGH: f64 = 0.85;

/// A sample takes at least this, s: short runs are repeated until it is a thousand ticks of the clock.
const MIN_SAMPLE_S: f64 = 1e-3;
/// The most runs in a sample: their engines are built before the clock starts.
const MAX_BATCH: usize = 1_000;
/// Samples taken of a short run, after its warm-up.
const SHORT_SAMPLES: usize = 5;
/// A run longer than this, s, needs no warm-up of its own, and has this many samples in all.
const LONG_RUN_S: f64 = 0.02;
const LONG_RUNS: usize = 3;

/// The scene, truth and limits that all runs of a sweep have in common.
pub struct Setup<'a> {
    pub scene: &'a Scene,
    pub system: &'a ParticleSystem,
    pub truth: &'a Truth,
    pub session: &'a dyn Session,
    limits: Limits,
    /// The energy scale S, J.
    scale: Option<f64>,
    /// The largest coordinate of the truth, m.
    size: f64,
    /// The most instants a run keeps.
    max_instants: u64,
    /// Whether the timesteps were given by name: then all of them run, and their states are kept.
    named: bool,
}

impl<'a> Setup<'a> {
    pub fn new(
        scene: &'a Scene,
        system: &'a ParticleSystem,
        truth: &'a Truth,
        scale: Option<f64>,
        session: &'a dyn Session,
        named: bool,
    ) -> Self {
        let positions = scene.starts().into_iter().flatten();
        let mut size = positions.fold(0.0, |most: f64, x| most.max(x.abs()));
        if let Some(motion) = truth.motion() {
            let states = motion.states(&motion.landmarks(truth.horizon));
            size = states.x.iter().fold(size, |most, x| most.max(x.abs()));
        }
        let each = 6 * scene.particles.len().max(1) as u64;
        Self {
            scene,
            system,
            truth,
            session,
            limits: facts::limits(scene, system).coarse(),
            scale,
            size,
            max_instants: (MAX_NUMBERS / each).clamp(16, MAX_INSTANTS),
            named,
        }
    }

    /// Ten times the truth's own error bar, m; None without a truth.
    pub fn floor(&self) -> Option<f64> {
        (self.truth.kind != TruthKind::None).then_some(10.0 * self.truth.error_bound)
    }

    /// Whether the truth's own error or rounding over so many steps may explain an error, m.
    fn at_floor(&self, error: f64, steps: u64) -> bool {
        let rounding = ROUNDINGS * f64::EPSILON * self.size * (steps as f64).sqrt();
        error <= self.floor().unwrap_or(0.0).max(rounding)
    }

    /// The truth at the instants of a run within the horizon, without the start: times, s, and states.
    pub fn truth_beside(&self, kept: &Samples) -> Option<(Vec<f64>, States)> {
        let motion = self.truth.motion()?;
        // A run ends at n h, which may round to just past the end of the truth.
        let last = self.truth.horizon * (1.0 + 4.0 * f64::EPSILON);
        let within = kept.t.iter().skip(1).filter(|t| **t <= last);
        let times: Vec<f64> = within.map(|t| t.min(self.truth.horizon)).collect();
        let states = motion.states(&times);
        Some((times, states))
    }

    /// The distance of a run from the truth, m: the largest over the horizon, and that at the last instant
    /// within it. None without a truth, without an instant within its horizon, or where the distance is not
    /// finite.
    fn errors(&self, kept: &Samples) -> Option<(f64, f64)> {
        let (times, states) = self.truth_beside(kept)?;
        let distance = |k: usize| farthest(kept.states.x(k + 1), states.x(k));
        let distances: Vec<f64> = (0..times.len()).map(distance).collect();
        let max = distances.iter().copied().fold(0.0, f64::max);
        Some((max, *distances.last()?)).filter(|_| max.is_finite())
    }

    /// max |B - B(0)| / S over the kept instants; None where the scene has no scale.
    fn energy_error(&self, Samples { t, states, work }: &Samples) -> Option<f64> {
        let scale = self.scale?;
        let balance = |k: usize| {
            let (x, v) = (states.x(k), states.v(k));
            let energy = kinetic_on_rods(self.system, x, v) + self.system.potential(t[k], x);
            work[k].balance(energy)
        };
        let start = (!t.is_empty()).then(|| balance(0))?;
        let errors = (1..t.len()).map(|k| (balance(k) - start).abs());
        let worst = errors.fold(0.0, |worst, e| if e <= worst { worst } else { e });
        Some(worst / scale).filter(|error| error.is_finite())
    }

    /// Runs the settings of a solver, coarse to fine, and more where targets, m, lie between them. Settings that can
    /// only be worse are left out, unless they were given by name.
    pub fn sweep(&self, sweep: &Sweep, targets: &[f64]) -> Curve {
        let mut curve = Curve::default();
        for setting in &sweep.settings {
            let left_out = !self.named && curve.is_spent();
            if let Some(reason) = sweep.too_long(setting) {
                let none = (Samples::default(), Counts::default());
                curve.insert(
                    *setting,
                    (point(setting, Status::Failed, Some(reason)), none.0, none.1),
                );
            } else if !left_out {
                curve.insert(*setting, self.run(&sweep.solver, setting));
            }
            let last = curve.points.last();
            let timed = !left_out && last.is_none_or(|p| p.status == Status::Completed);
            let untimed = if timed { 0 } else { sweep.of_timing(setting) };
            self.session.progress(sweep.of_error(setting) + untimed);
        }
        let targets = if self.named { &[] } else { targets };
        // The edge of the range is no answer: as long as the coarsest setting reaches a target, coarser
        // ones are tried.
        let loosest = targets.iter().copied().fold(0.0, f64::max);
        for _ in 0..MAX_COARSER {
            let edge = curve.settings.first();
            let Some(setting) = edge.and_then(|edge| sweep.coarser(edge)) else {
                break;
            };
            if reach(&curve.points, loosest) != Ok(0) {
                break;
            }
            curve.insert(setting, self.run(&sweep.solver, &setting));
        }
        for &target in targets {
            for _ in 0..MAX_ATTEMPTS {
                let Some(setting) = curve.setting_near(target) else {
                    break;
                };
                curve.insert(setting, self.run(&sweep.solver, &setting));
            }
        }
        curve
    }

    /// Runs one setting: its point, its states and its counts.
    fn run(&self, solver: &Solver, setting: &Setting) -> (CostPoint, Samples, Counts) {
        let mut run = match solver.start(self.scene, self.system, setting) {
            Ok(run) => run,
            Err(unsupported) => {
                let point = point(setting, Status::Unsupported, Some(unsupported.reason));
                return (point, Samples::default(), Counts::default());
            }
        };
        let mut sampler = Sampler::new(setting, self.max_instants);
        let ended = run.finish(&self.limits, &mut sampler, &|_| {});
        let counts = run.counts();
        let (status, reason) = match ended {
            Ended::Completed => (Status::Completed, None),
            Ended::Exhausted => (Status::Failed, Some(exhausted(&run))),
            Ended::Diverged { reason, .. } => {
                (Status::Diverged, Some(format!("diverged: {reason}")))
            }
            Ended::Failed { step, error } => {
                let reason = format!("failed in step {step}: {error}");
                (Status::Failed, Some(reason))
            }
        };
        let mut point = point(setting, status, reason);
        if setting.tolerance().is_some() && run.taken() > 0 {
            point.steps = run.taken();
            point.timestep = self.scene.duration / point.steps as f64;
        }
        point.force_evaluations = counts.all_force_passes();
        point.linear_solves = counts.linear_solves;
        point.newton_iterations = counts.newton_iterations;
        let mut samples = sampler.samples;
        if status == Status::Completed {
            if let Some((max, last)) = self.errors(&samples) {
                point.error_m = Some(max);
                point.error_final_m = Some(last);
                point.at_floor = self.at_floor(max, point.steps);
            }
            point.energy_error = self.energy_error(&samples);
        }
        if !self.named {
            samples = Samples::default();
        }
        (point, samples, counts)
    }

    /// Times every point that completed, one run after the other. Nothing else may run meanwhile.
    pub fn time(&self, sweep: &Sweep, curve: &mut Curve) {
        for (setting, point) in curve.settings.iter().zip(&mut curve.points) {
            if point.status == Status::Completed {
                point.wall_s = self.wall(&sweep.solver, setting);
                self.session.progress(sweep.of_timing(setting));
            }
        }
    }

    fn wall(&self, solver: &Solver, setting: &Setting) -> Option<WallTime> {
        // Mean seconds of a run, over so many runs one after the other.
        let sample = |batch: usize| {
            let make = |_| solver.start(self.scene, self.system, setting).ok();
            let mut runs: Vec<Run> = (0..batch).map(make).collect::<Option<_>>()?;
            let start = Instant::now();
            for run in &mut runs {
                run.finish(&self.limits, &mut Unwatched, &|_| {});
            }
            Some(start.elapsed().as_secs_f64() / batch as f64)
        };
        // The first run is the warm-up, and decides how many runs make a sample.
        let once = sample(1)?;
        let batch = ((MIN_SAMPLE_S / once.max(1e-9)).ceil() as usize).clamp(1, MAX_BATCH);
        let (mut times, count) = if once > LONG_RUN_S {
            (vec![once], LONG_RUNS)
        } else {
            (Vec::new(), SHORT_SAMPLES)
        };
        while times.len() < count {
            times.push(sample(batch)?);
        }
        Some(spread(times))
    }
}

/// One solver's points, coarse to fine, and the setting of each.
#[derive(Default)]
pub struct Curve {
    pub settings: Vec<Setting>,
    pub points: Vec<CostPoint>,
    /// The states of each point's run; empty unless the settings were given by name.
    pub kept: Vec<Samples>,
    /// Full evaluations, and passes over damping alone, summed over all runs.
    counted: [u64; 2],
}

impl Curve {
    /// Adds a point at its setting's place in the order.
    fn insert(&mut self, setting: Setting, (point, kept, counts): (CostPoint, Samples, Counts)) {
        let at = self.settings.partition_point(|s| s.is_no_finer(&setting));
        self.settings.insert(at, setting);
        self.points.insert(at, point);
        if !kept.t.is_empty() {
            self.kept.insert(at.min(self.kept.len()), kept);
        }
        self.counted[0] += counts.force_evaluations.unwrap_or(0);
        self.counted[1] += counts.damping_evaluations.unwrap_or(0);
    }

    /// Evaluations of the hand-written integrators in all these runs: full ones, and those of damping alone.
    pub fn evaluations(all: &[Curve], sweeps: &[Sweep]) -> [u64; 2] {
        let ours = all.iter().zip(sweeps);
        let ours = ours.filter(|(_, sweep)| sweep.solver.kind == SolverKind::Integrator);
        ours.fold([0, 0], |[forces, damping], (curve, _)| {
            [forces + curve.counted[0], damping + curve.counted[1]]
        })
    }

    /// Whether finer settings can only be worse: rounding or the truth's error bar is all that is left.
    fn is_spent(&self) -> bool {
        let errors: Vec<f64> = self.points.iter().filter_map(|p| p.error_m).collect();
        let floored = self.points.iter().filter(|p| p.at_floor).count();
        let largest = errors.iter().copied().fold(0.0, f64::max);
        let [before @ .., one, two] = errors.as_slice() else {
            return floored > 1;
        };
        let best = before.iter().copied().fold(f64::INFINITY, f64::min);
        let stopped = one.min(*two) > STALLED * best && best < SMALL * largest;
        floored > 1 || stopped
    }

    /// The setting at which the error should be just below the target; None where the target is reached
    /// nowhere, or at the coarsest setting, or to within a few percent.
    fn setting_near(&self, target: f64) -> Option<Setting> {
        let reached = reach(&self.points, target).ok()?;
        let before = reached.checked_sub(1)?;
        let (fine, coarse) = (&self.points[reached], &self.points[before]);
        let ratio = fine.steps as f64 / coarse.steps as f64;
        let near = fine
            .error_m
            .is_some_and(|error| error > CLOSE_ENOUGH * target);
        if ratio < MIN_STEP_RATIO || near || (fine.at_floor && coarse.at_floor) {
            return None;
        }
        let part = match (coarse.error_m, fine.error_m) {
            // The part stays within the ends, so that every attempt narrows the interval.
            (Some(from), Some(to)) if from > target && to > 0.0 => {
                ((from / (AIM * target)).ln() / (from / to).ln()).clamp(0.1, 0.9)
            }
            // The coarse setting is unstable: the next one is halfway.
            (None, _) => 0.5,
            _ => return None,
        };
        between(&self.settings[before], &self.settings[reached], part)
    }
}

/// The setting at this part of the way from one to a finer one, on a logarithmic scale; None where no step
/// count lies between.
fn between(coarse: &Setting, fine: &Setting, part: f64) -> Option<Setting> {
    let mean = |from: f64, to: f64| from * (to / from).powf(part);
    let steps = mean(coarse.steps() as f64, fine.steps() as f64).round() as u64;
    match (coarse, fine) {
        (
            Setting::Tolerance {
                tolerance: from,
                duration,
                max_steps,
                ..
            },
            Setting::Tolerance { tolerance: to, .. },
        ) => Some(Setting::Tolerance {
            tolerance: mean(*from, *to),
            duration: *duration,
            steps,
            max_steps: *max_steps,
        }),
        _ => {
            let duration = coarse.timestep() * coarse.steps() as f64;
            let inside = steps > coarse.steps() && steps < fine.steps();
            inside.then(|| Setting::divided(duration, steps))
        }
    }
}

/// Why a pair was stopped early.
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
