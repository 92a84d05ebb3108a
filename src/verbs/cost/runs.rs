//! The runs of a sweep: each setting once, from coarse to fine, until it can get no better, and where a target lies
//! between two settings one or two more. What completed is timed afterwards, when nothing else runs.

use super::rank::reach;
use super::samples::{Sampler, Samples};
use super::settings::Sweep;
use crate::physics::{ParticleSystem, System};
use crate::scene::Scene;
use crate::solvers::{Counts, Ended, Kind, Limits, Run, Setting, Solver, Status};
use crate::trajectory::Unwatched;
use crate::truth::{States, Truth, TruthKind, farthest};
use crate::verbs::clock::{WallTime, spread};
use crate::verbs::cost::CostPoint;
use crate::verbs::facts;
use crate::verbs::session::Session;
use std::time::Instant;

/// Instants of a run that are looked at, at most.
const INSTANTS: u64 = 500;
/// And at most about this many numbers.
const NUMBERS: u64 = 1 << 21;
/// Roundings of the largest coordinate, a random walk over all steps, that may be in an error.
const ROUNDINGS: f64 = 4.0;

/// An error that is no less than this share of the best so far has stopped falling.
const FALLING: f64 = 0.7;
/// Errors below this share of the largest that stop falling do so because of rounding.
const SMALL: f64 = 1e-2;

/// Attempts for each target.
const ATTEMPTS: usize = 2;
/// Settings closer than this are near enough.
const CLOSE: f64 = 1.06;
/// Aimed at, as a share of the target: the line between two points is not quite straight.
const AIM: f64 = 0.93;
/// Not worth another run: an error so close to the target.
const NEAR: f64 = 0.85;

/// A sample takes at least this, s, by repeating a short run: a thousand grains of the clock.
const SAMPLE: f64 = 1e-3;
/// Runs in a sample at most: their engines are built before the clock starts.
const MOST: usize = 1_000;
/// Samples of a short run, after its warm-up.
const SAMPLES: usize = 5;
/// A run longer than this, s, warms up within itself: it is run so often in all.
const LONG: f64 = 0.02;
const RUNS_OF_LONG: usize = 3;

/// What all runs of a scene share, and are held against.
pub struct Setup<'a> {
    pub scene: &'a Scene,
    pub system: &'a ParticleSystem,
    pub truth: &'a Truth,
    pub session: &'a dyn Session,
    limits: Limits,
    /// S, J.
    scale: Option<f64>,
    /// Largest coordinate of the truth, m.
    size: f64,
    /// Instants a run keeps at most.
    room: u64,
    /// Whether the settings were named: then all of them are run, and their states kept.
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
        let positions = scene.particles.iter().flat_map(|p| p.position);
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
            limits: facts::limits(scene, system).now_and_then(),
            scale,
            size,
            room: (NUMBERS / each).clamp(16, INSTANTS),
            named,
        }
    }

    /// Ten times the truth's own bar, m; None without a truth.
    pub fn floor(&self) -> Option<f64> {
        (self.truth.kind != TruthKind::None).then_some(10.0 * self.truth.error_bound)
    }

    /// Whether an error after so many steps may be the truth's own or rounding.
    fn at_floor(&self, error: f64, steps: u64) -> bool {
        let rounding = ROUNDINGS * f64::EPSILON * self.size * (steps as f64).sqrt();
        error <= self.floor().unwrap_or(0.0).max(rounding)
    }

    /// The truth at the instants of a run within the horizon, the start left out.
    pub fn truth_beside(&self, kept: &Samples) -> Option<(Vec<f64>, States)> {
        let motion = self.truth.motion()?;
        // A run ends at n h, which may round to just past where the truth was asked for.
        let last = self.truth.horizon * (1.0 + 4.0 * f64::EPSILON);
        let within = kept.t.iter().skip(1).filter(|t| **t <= last);
        let times: Vec<f64> = within.map(|t| t.min(self.truth.horizon)).collect();
        let states = motion.states(&times);
        Some((times, states))
    }

    /// How far a run is from the truth, m: over the horizon, and at its last instant within. None without a
    /// truth, or where no instant lies within its horizon, or too far away for a number.
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
            let energy = self.system.kinetic(v) + self.system.potential(t[k], x);
            energy + work[k].dissipated - work[k].injected
        };
        let start = (!t.is_empty()).then(|| balance(0))?;
        let errors = (1..t.len()).map(|k| (balance(k) - start).abs());
        let worst = errors.fold(0.0, |worst, e| if e <= worst { worst } else { e });
        Some(worst / scale).filter(|error| error.is_finite())
    }

    /// The settings of a solver, coarse to fine, and more where targets, m, lie between them. Those that can only
    /// be worse are left out, unless they were named.
    pub fn sweep(&self, sweep: &Sweep, targets: &[f64]) -> Curve {
        let mut curve = Curve::default();
        for setting in &sweep.settings {
            let left_out = !self.named && curve.is_spent();
            if !left_out {
                curve.insert(*setting, self.run(&sweep.solver, setting));
            }
            let last = curve.points.last();
            let timed = !left_out && last.is_none_or(|p| p.status == Status::Completed);
            let untimed = if timed { 0 } else { sweep.of_timing(setting) };
            self.session.progress(sweep.of_error(setting) + untimed);
        }
        let targets = if self.named { &[] } else { targets };
        for &target in targets {
            for _ in 0..ATTEMPTS {
                let Some(setting) = curve.toward(target) else {
                    break;
                };
                curve.insert(setting, self.run(&sweep.solver, &setting));
            }
        }
        curve
    }

    /// One run and what came of it.
    fn run(&self, solver: &Solver, setting: &Setting) -> (CostPoint, Samples, Counts) {
        let mut run = match solver.start(self.scene, self.system, setting) {
            Ok(run) => run,
            Err(unsupported) => {
                let point = point(setting, Status::Unsupported, Some(unsupported.reason));
                return (point, Samples::default(), Counts::default());
            }
        };
        let mut sampler = Sampler::new(setting, self.room);
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

    /// Times every point that completed, one run after the other: for when nothing else runs.
    pub fn time(&self, sweep: &Sweep, curve: &mut Curve) {
        for (setting, point) in curve.settings.iter().zip(&mut curve.points) {
            if point.status == Status::Completed {
                point.wall_s = self.wall(&sweep.solver, setting);
                self.session.progress(sweep.of_timing(setting));
            }
        }
    }

    fn wall(&self, solver: &Solver, setting: &Setting) -> Option<WallTime> {
        // Seconds of one run, of so many run one after the other.
        let sample = |batch: usize| {
            let make = |_| solver.start(self.scene, self.system, setting).ok();
            let mut runs: Vec<Run> = (0..batch).map(make).collect::<Option<_>>()?;
            let start = Instant::now();
            for run in &mut runs {
                run.finish(&self.limits, &mut Unwatched, &|_| {});
            }
            Some(start.elapsed().as_secs_f64() / batch as f64)
        };
        // The first is the warm-up, and says how many there are to a sample.
        let once = sample(1)?;
        let batch = ((SAMPLE / once.max(1e-9)).ceil() as usize).clamp(1, MOST);
        let (mut times, count) = if once > LONG {
            (vec![once], RUNS_OF_LONG)
        } else {
            (Vec::new(), SAMPLES)
        };
        while times.len() < count {
            times.push(sample(batch)?);
        }
        Some(spread(times))
    }
}

/// One solver's points, coarse to fine, and beside each its setting.
#[derive(Default)]
pub struct Curve {
    pub settings: Vec<Setting>,
    pub points: Vec<CostPoint>,
    /// Beside each point; empty unless the settings were named.
    pub kept: Vec<Samples>,
    /// Over all runs: full evaluations, passes over damping alone.
    counted: [u64; 2],
}

impl Curve {
    /// Adds a point where its setting belongs.
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

    /// What hand-written integrators evaluated in all these runs: full, damping alone.
    pub fn evaluations(all: &[Curve], sweeps: &[Sweep]) -> [u64; 2] {
        let ours = all.iter().zip(sweeps);
        let ours = ours.filter(|(_, sweep)| sweep.solver.kind == Kind::Integrator);
        ours.fold([0, 0], |[forces, damping], (curve, _)| {
            [forces + curve.counted[0], damping + curve.counted[1]]
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

    /// The setting at which the error should be just below the target; None where the target is reached
    /// nowhere, or at the coarsest setting, or to within a few percent.
    fn toward(&self, target: f64) -> Option<Setting> {
        let reached = reach(&self.points, target).ok()?;
        let before = reached.checked_sub(1)?;
        let (fine, coarse) = (&self.points[reached], &self.points[before]);
        let ratio = fine.steps as f64 / coarse.steps as f64;
        let near = fine.error_m.is_some_and(|error| error > NEAR * target);
        if ratio < CLOSE || near || (fine.at_floor && coarse.at_floor) {
            return None;
        }
        let part = match (coarse.error_m, fine.error_m) {
            // Within the ends, so that every attempt narrows.
            (Some(from), Some(to)) if from > target && to > 0.0 => {
                ((from / (AIM * target)).ln() / (from / to).ln()).clamp(0.1, 0.9)
            }
            // Unstable there: halfway.
            (None, _) => 0.5,
            _ => return None,
        };
        along(&self.settings[before], &self.settings[reached], part)
    }
}

/// So far from one setting to a finer one, both logarithmic.
fn along(coarse: &Setting, fine: &Setting, part: f64) -> Option<Setting> {
    let mean = |from: f64, to: f64| from * (to / from).powf(part);
    let steps = mean(coarse.steps() as f64, fine.steps() as f64).round() as u64;
    match (coarse, fine) {
        (
            Setting::Tolerance {
                tolerance: from,
                duration,
                most,
                ..
            },
            Setting::Tolerance { tolerance: to, .. },
        ) => Some(Setting::Tolerance {
            tolerance: mean(*from, *to),
            duration: *duration,
            steps,
            most: *most,
        }),
        _ => {
            let duration = coarse.timestep() * coarse.steps() as f64;
            let inside = steps > coarse.steps() && steps < fine.steps();
            inside.then(|| Setting::divided(duration, steps))
        }
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
