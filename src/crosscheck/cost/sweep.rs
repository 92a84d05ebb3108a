//! One engine over its settings: each run once, from coarse to fine, until it can get no better.

use super::entrant::Entrant;
use super::lane::Lane;
use super::runner::{Eye, Runner};
use super::setting::Setting;
use super::witness::{Kept, Witness};
use crate::crosscheck::Host;
use crate::engines::{Counts, Ended, Limits};
use crate::outcome::{CostPoint, Kind, Status};
use crate::scene::Scene;
use crate::system::ParticleSystem;

/// What all runs share.
pub(super) struct Ground<'a> {
    pub scene: &'a Scene,
    pub system: &'a ParticleSystem,
    pub witness: &'a Witness<'a>,
    pub limits: &'a Limits,
    pub host: &'a dyn Host,
    /// Whether the runs' states are wanted later.
    pub panels: bool,
}

/// One engine's points, coarse to fine, and beside each its setting.
#[derive(Default)]
pub(super) struct Swept {
    pub settings: Vec<Setting>,
    pub points: Vec<CostPoint>,
    /// Beside each point; empty unless wanted.
    pub kept: Vec<Kept>,
    /// Over all runs: full evaluations, passes over damping alone.
    counted: [u64; 2],
}

/// An error that is no less than this share of the best so far has stopped falling.
const FALLING: f64 = 0.7;
/// Errors below this share of the largest that stop falling do so because of rounding.
const SMALL: f64 = 1e-2;

impl Swept {
    /// Adds a point where its setting belongs.
    pub fn insert(&mut self, setting: Setting, (point, kept, counts): (CostPoint, Kept, Counts)) {
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
    pub fn evaluations(all: &[Swept], lanes: &[Lane]) -> [u64; 2] {
        let ours = all.iter().zip(lanes);
        let ours = ours.filter(|(_, lane)| lane.entrant.kind == Kind::Integrator);
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
    pub fn sweep(&self, lane: &Lane, stop: bool) -> Swept {
        let mut swept = Swept::default();
        for setting in &lane.ladder {
            let left_out = stop && swept.is_spent();
            if !left_out {
                swept.insert(*setting, self.run(&lane.entrant, setting));
            }
            let work = lane.of_error(setting);
            let timed = lane.of_timing(setting);
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
    pub fn run(&self, entrant: &Entrant, setting: &Setting) -> (CostPoint, Kept, Counts) {
        let mut runner = match entrant.make(self.scene, self.system, setting) {
            Ok(runner) => runner,
            Err(unsupported) => {
                let point = point(setting, Status::Unsupported, Some(unsupported.reason));
                return (point, Kept::default(), Counts::default());
            }
        };
        let mut eye = Eye::new(setting, self.witness.room);
        let ended = runner.run(setting, self.limits, &mut eye);
        let counts = runner.engine().counts();
        let (status, reason) = match ended {
            None => (Status::Failed, Some(too_many(&mut runner))),
            Some(Ended::Completed) => (Status::Completed, None),
            Some(Ended::Diverged { reason, .. }) => {
                (Status::Diverged, Some(format!("diverged: {reason}")))
            }
            Some(Ended::Failed { step, error }) => (
                Status::Failed,
                Some(format!("failed in step {step}: {error}")),
            ),
        };
        let mut point = point(setting, status, reason);
        if let Some(steps) = runner.steps().filter(|steps| *steps > 0) {
            point.steps = steps;
            point.timestep = self.scene.duration / steps as f64;
        }
        point.force_evaluations = counts.all_force_passes();
        point.linear_solves = counts.linear_solves;
        point.newton_iterations = counts.newton_iterations;
        if status == Status::Completed {
            if let Some(off) = self.witness.errors(&eye.kept) {
                point.error_m = Some(off.max);
                point.error_final_m = Some(off.last);
                point.at_floor = self.witness.at_floor(off.max, point.steps);
            }
            point.energy_error = self.witness.energy_error(&eye.kept);
        }
        let kept = if self.panels {
            eye.kept
        } else {
            Kept::default()
        };
        (point, kept, counts)
    }
}

/// Why a pair was stopped.
fn too_many(runner: &mut Runner) -> String {
    let (steps, t) = (runner.steps().unwrap_or(0), runner.engine().state().t);
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
