//! One run at one step, held against the truth.

use crate::integrators::Integrator;
use crate::physics::{State, System};
use crate::solvers::advance;
use crate::truth::{Motion, States, farthest};

/// Makes a fresh integrator for each run.
pub type MakeIntegrator<'a> = &'a (dyn Fn() -> Box<dyn Integrator> + Sync);

/// A run has diverged once its error is this many times the way the motion goes: its energy is then
/// beyond 1e12 times the motion's.
const DIVERGED: f64 = 1e6;
/// Fewest instants; odd, so that no power of two of them falls on whole or half periods.
const FEWEST: u64 = 31;
/// Most numbers of the truth that are kept.
const MEMORY: u64 = 1 << 22;
/// A motion of so many times the truth's error bar and the rounding of coordinates is none.
const FLOOR: f64 = 100.0;
/// Relative size of the disturbance whose response tells how much rounding grows.
const DISTURBANCE: f64 = 1e-7;

/// A test problem: a system and a start, and the truth from there.
pub(super) struct TestProblem<'a> {
    pub system: &'a (dyn System + Sync),
    pub start: State,
    pub motion: &'a dyn Motion,
}

/// The instants errors are taken at, and the truth there.
pub(super) struct Grid {
    /// Number of instants, evenly spaced, the start not counted, the end included. 0 where there is no
    /// time to measure in.
    pub instants: u64,
    /// The last time, s.
    pub until: f64,
    truth: States,
    /// Largest way any particle gets from its start, m.
    way: f64,
    /// The same, where nothing is fixed beside the way they go together, in which no method that damps a motion errs;
    /// unless there is no more beside it than rounding and the truth's own error.
    pub reach: f64,
    /// Largest coordinate, m.
    pub size: f64,
}

/// Three digits, as people write them: `0`, `0.0323`, `6.3e-5`.
pub(super) fn plain(value: f64) -> String {
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    match rounded.abs() {
        v if v == 0.0 || (1e-3..1e4).contains(&v) => rounded.to_string(),
        _ => format!("{rounded:e}"),
    }
}

/// Subtracts what all particles have in common.
fn leave_common(way: &mut [f64]) {
    let count = (way.len() / 3) as f64;
    for axis in 0..3 {
        let mean = way.iter().skip(axis).step_by(3).sum::<f64>() / count;
        for way in way.iter_mut().skip(axis).step_by(3) {
            *way -= mean;
        }
    }
}

impl Grid {
    /// A grid of about `wanted` instants, at most `most`, up to `until` seconds.
    pub fn new(problem: &TestProblem, until: f64, wanted: u64, most: u64) -> Self {
        let dim = problem.system.dim();
        let room = (MEMORY / (dim.max(1) as u64)).min(most).max(FEWEST);
        let instants = (wanted.clamp(FEWEST, room) - 1) | 1;
        let usable = until > 0.0 && until.is_finite();
        let instants = if usable { instants } else { 0 };
        let times: Vec<f64> = (1..=instants)
            .map(|k| until * (k as f64 / instants as f64))
            .collect();
        let truth = problem.motion.states(&times);
        let each = || (0..times.len()).map(|k| truth.x(k));
        let start = &problem.start.x;
        let free = problem.system.inverse_mass().iter().all(|w| *w > 0.0);
        let together = free && dim > 3;
        let (mut way, mut beside) = (0.0_f64, 0.0_f64);
        for x in each() {
            let mut moved: Vec<f64> = x.iter().zip(start).map(|(x, start)| x - start).collect();
            way = way.max(farthest(&moved, &vec![0.0; dim]));
            leave_common(&mut moved);
            beside = beside.max(farthest(&moved, &vec![0.0; dim]));
        }
        let size = each().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
        let unknown = FLOOR * (problem.motion.error_bar(until) + f64::EPSILON * size);
        let reach = if together && beside > unknown {
            beside
        } else {
            way
        };
        Self {
            instants,
            until,
            way,
            reach,
            size,
            truth,
        }
    }

    /// Steps of a run that takes `m` between two instants.
    pub fn steps(&self, m: u64) -> u64 {
        self.instants.saturating_mul(m)
    }

    /// The size of these steps, s.
    pub fn step(&self, m: u64) -> f64 {
        self.until / self.steps(m) as f64
    }
}

/// The result of a run.
pub(super) struct LevelRun {
    /// Largest distance of any particle from the truth at any instant, m.
    pub error: f64,
    /// Positions at the instants.
    x: Vec<f64>,
}

impl TestProblem<'_> {
    /// Runs `m` steps from instant to instant, from the start or from one disturbed.
    ///
    /// # Errors
    /// Why the run gives no error: it diverged, or a step could not be taken.
    pub fn run(
        &self,
        grid: &Grid,
        m: u64,
        build: MakeIntegrator,
        disturbed: Option<State>,
    ) -> Result<LevelRun, String> {
        let h = grid.step(m);
        let mut integrator = build();
        let mut state = disturbed.unwrap_or_else(|| self.start.clone());
        let mut run = LevelRun {
            error: 0.0,
            x: Vec::new(),
        };
        for instant in 0..grid.instants {
            for step in instant * m..(instant + 1) * m {
                // n h, not a running sum, which would drift.
                state.t = step as f64 * h;
                let end = (step + 1) as f64 * h;
                advance(integrator.as_mut(), self.system, h, end, &mut state)
                    .map_err(|error| format!("failed at {} s: {error}", plain(step as f64 * h)))?;
            }
            let error = farthest(&state.x, grid.truth.x(instant as usize));
            if !error.is_finite() || (grid.way > 0.0 && error > DIVERGED * grid.way) {
                let t = (instant + 1) as f64 * m as f64 * h;
                return Err(format!("diverged by {} s", plain(t)));
            }
            run.error = run.error.max(error);
            run.x.extend_from_slice(&state.x);
        }
        Ok(run)
    }

    /// How far apart, m, a relative disturbance of the start as large as 1 would carry this run: what
    /// a rounding, which is a disturbance of eps, grows to. None where it cannot be told.
    pub fn amplification(
        &self,
        grid: &Grid,
        m: u64,
        build: MakeIntegrator,
        run: &LevelRun,
    ) -> Option<f64> {
        let each = self.system.dim().max(1);
        // The largest magnitude each coordinate reaches.
        let [x, v] = [&grid.truth.x, &grid.truth.v].map(|values| {
            let mut most = vec![0.0; each];
            for state in values.chunks_exact(each) {
                for (most, value) in most.iter_mut().zip(state) {
                    *most = f64::max(*most, value.abs());
                }
            }
            most
        });
        let mut start = self.start.clone();
        for (i, inverse_mass) in self.system.inverse_mass().iter().enumerate() {
            if *inverse_mass > 0.0 {
                // Neighbouring coordinates in different directions, so that no mode is missed.
                let sign = if (i + i / 3) % 2 == 0 { 1.0 } else { -1.0 };
                start.x[i] += sign * DISTURBANCE * x[i];
                start.v[i] -= sign * DISTURBANCE * v[i];
            }
        }
        let other = self.run(grid, m, build, Some(start)).ok()?;
        let states = run.x.chunks_exact(each).zip(other.x.chunks_exact(each));
        let apart = states.map(|(a, b)| farthest(a, b)).fold(0.0, f64::max);
        Some(apart / DISTURBANCE)
    }
}
