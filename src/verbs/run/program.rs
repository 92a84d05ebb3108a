//! Runs external programs and converts their rows to records, which the measures read.

use super::plan::{Case, Plan};
use super::record::Record;
use crate::physics::{ParticleSystem, Power, State, System};
use crate::solvers::external::{Program, Recording, Task};
use crate::solvers::{Counts, Limits, Status};
use crate::trajectory::{Precision, Rows, Trajectory};
use crate::verbs::clock::spread;

/// Runs one case of a program and returns its record.
pub fn one(plan: &Plan, case: &Case, program: &dyn Program, limits: &Limits) -> Record {
    let task = Task {
        scene: plan.scene,
        system: &plan.system,
        timestep: case.label.timestep,
        steps: case.label.steps,
    };
    let answer = program.record(&task);
    match answer {
        Ok(recording) => record_of(recording, &task, limits),
        Err(failure) => Record::none(Status::Failed, failure.to_string()),
    }
}

/// The words for rows whose last one is left out.
const CUT: &str = "no line end follows its last number, which may be cut: its last row is left out";

/// Converts a recording to the record of a run.
fn record_of(recording: Recording, task: &Task, limits: &Limits) -> Record {
    let Recording { mut rows, seconds } = recording;
    let start = ParticleSystem::initial_state(task.scene);
    if let Some(wrong) = misfit(&rows, &start, task.timestep) {
        return Record::none(Status::Failed, wrong);
    }
    let mut remarks: Vec<String> = other_start(&rows, &start).into_iter().collect();
    if rows.cut {
        remarks.push(CUT.to_owned());
    }
    complete(&mut rows, &start, task.steps);
    if rows.v.is_none() {
        remarks.push(
            "gives no velocities (vx,vy,vz in text, v in arrays), so neither energy nor momentum is \
             stated"
                .to_owned(),
        );
    }
    let replay = Replay {
        rows: &rows,
        start: &start,
        system: task.system,
    };
    let (mut work, mut diverged, mut end) = (Vec::new(), false, None);
    let mut state = start.clone();
    for k in 0..rows.len() {
        replay.advance(k, &mut state);
        let finite = state.is_finite();
        // In an engine a bad position also spoils the next velocity; rows of a program need not be consistent.
        let lost = || (!finite).then(|| "a position is no longer finite".to_owned());
        if let Some(reason) = limits.exceeded(&state).or_else(lost) {
            diverged = finite;
            work.extend(finite.then_some(state.work));
            end = Some((rows.steps[k], reason));
            break;
        }
        work.push(state.work);
    }
    let last = rows.steps.last().copied().unwrap_or(0);
    let (status, reason, steps) = match end {
        Some((step, reason)) => (
            Status::Diverged,
            Some(format!("by step {step}: {reason}")),
            step,
        ),
        None if last < task.steps => (Status::Failed, Some(ended_early(&rows, task)), last),
        None => (Status::Completed, None, last),
    };
    if status == Status::Completed && seconds.is_some() {
        remarks.push("the time is of the whole program, taken once".to_owned());
    }
    Record {
        status,
        reason,
        steps,
        trajectory: Some(Trajectory::of_rows(&rows, &work, task.steps, diverged)),
        counts: Counts::default(),
        wall: seconds.map(|seconds| spread(vec![seconds])),
        remarks,
    }
}

/// The reason why rows are not states of this scene; None if they are. The reader of files has checked this; other
/// programs have not.
fn misfit(rows: &Rows, start: &State, timestep: f64) -> Option<String> {
    let numbers = rows.len() * start.x.len();
    let whole = rows.dim == start.x.len()
        && rows.x.len() == numbers
        && rows.v.as_ref().is_none_or(|v| v.len() == numbers);
    let message = if rows.is_empty() {
        "it gave no rows"
    } else if !whole {
        "its rows are not states of all particles of the scene"
    } else if rows.timestep != timestep {
        "its rows are counted in another timestep"
    } else if rows.steps.windows(2).any(|pair| pair[0] >= pair[1]) {
        "its rows are not in the order of time"
    } else {
        return None;
    };
    Some(message.to_owned())
}

/// The remark that the first row differs from the scene's start by more than its rounding; None if it does not.
fn other_start(rows: &Rows, start: &State) -> Option<String> {
    if rows.steps.first() != Some(&0) {
        return Some(format!(
            "rows begin at t = {:?} s; the scene's own start stands before them",
            rows.time(0)
        ));
    }
    let first = |given: &[f64], known: &[f64], precision: Precision| {
        // Twice, since the scene's own number is rounded too. NaN is not near.
        let near = |(g, k): (&f64, &f64)| (g - k).abs() <= 2.0 * precision.half_unit(*k);
        given.iter().zip(known).position(|pair| !near(pair))
    };
    let position = first(rows.x(0), &start.x, rows.precision).map(|at| (at, "position"));
    let velocity = || first(rows.v(0)?, &start.v, rows.precision_v).map(|at| (at, "velocity"));
    let (at, what) = position.or_else(velocity)?;
    Some(format!(
        "does not start as the scene does: the {what} of particle {} differs",
        at / 3
    ))
}

/// Puts the scene's start in front of rows that begin later, and drops rows after the last step.
fn complete(rows: &mut Rows, start: &State, last: u64) {
    let kept = rows.steps.partition_point(|step| *step <= last);
    rows.steps.truncate(kept);
    rows.x.truncate(kept * rows.dim);
    if let Some(v) = &mut rows.v {
        v.truncate(kept * rows.dim);
    }
    if rows.steps.first() != Some(&0) {
        begin_with(rows, start);
    }
}

/// Puts the scene's start as step 0 in front of rows that begin later.
pub fn begin_with(rows: &mut Rows, start: &State) {
    rows.steps.insert(0, 0);
    rows.x.splice(0..0, start.x.iter().copied());
    if let Some(v) = &mut rows.v {
        v.splice(0..0, start.v.iter().copied());
    }
}

/// The reason for a run that ended too early: where it ended, and where it should have ended.
fn ended_early(rows: &Rows, task: &Task) -> String {
    let last = rows.len().saturating_sub(1);
    let end = task.steps as f64 * task.timestep;
    let mut reason = format!(
        "its rows end at t = {:?} s (step {}): expected them up to t = {end:?} s (step {})",
        rows.time(last),
        rows.steps.get(last).copied().unwrap_or(0),
        task.steps
    );
    if rows.cut {
        reason += "; ";
        reason += CUT;
    } else if rows
        .steps
        .get(last)
        .is_some_and(|step| step + 1 == task.steps)
    {
        reason += "; a run takes ceil(duration / timestep) steps and gives its start and each end";
    }
    reason
}

/// Passes through rows as through a run, and integrates the work.
struct Replay<'a> {
    rows: &'a Rows,
    start: &'a State,
    system: &'a ParticleSystem,
}

impl Replay<'_> {
    /// Advances the state from the row before `k` (anything for row 0) to row `k`. The work follows by the
    /// trapezoidal rule from row to row, of second order in their distance; without velocities it is not
    /// integrated.
    fn advance(&self, k: usize, state: &mut State) {
        let known = self.rows.v.is_some() && k > 0;
        let before = known.then(|| self.power(state));
        let elapsed = self.rows.time(k) - state.t;
        state.t = self.rows.time(k);
        state.x.copy_from_slice(self.rows.x(k));
        match self.rows.v(k) {
            Some(v) => state.v.copy_from_slice(v),
            None => self.differences(k, &mut state.v),
        }
        if let Some(before) = before {
            state.work.advance(before, 0.5 * elapsed);
            state.work.advance(self.power(state), 0.5 * elapsed);
        }
    }

    fn power(&self, state: &State) -> Power {
        if self.system.kinds().does_work() {
            let mut forces = vec![0.0; state.x.len()];
            self.system.forces(state.t, &state.x, &state.v, &mut forces)
        } else {
            Power::default()
        }
    }

    /// Velocities from positions, m/s: the scene's at the start, then central differences of the rows on both sides,
    /// and backward differences at the end. They are accurate enough to detect a divergence.
    fn differences(&self, k: usize, v: &mut [f64]) {
        if k == 0 {
            v.copy_from_slice(&self.start.v);
            return;
        }
        let (low, high) = (k - 1, (k + 1).min(self.rows.len() - 1));
        let span = self.rows.time(high) - self.rows.time(low);
        let ends = self.rows.x(low).iter().zip(self.rows.x(high));
        for (v, (low, high)) in v.iter_mut().zip(ends) {
            *v = (high - low) / span;
        }
    }
}
