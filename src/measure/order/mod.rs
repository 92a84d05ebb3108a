//! The observed order: how fast a method's error falls as its step does.
//!
//! [`observed`] is the arithmetic, on errors from anywhere; [`Study`] runs a method at smaller and smaller
//! steps until its errors show an order; [`check`] is what a report says of them.

mod observed;
mod run;
#[cfg(test)]
mod tests;

pub use observed::{Observed, Point, RATIOS, Reason, TOLERANCE, Verdict, observed};
pub use run::MakeIntegrator;

use crate::integrators::{self, Method, Settings};
use crate::measure::{Check, CheckStatus};
use crate::physics::{ParticleSystem, State, System};
use crate::scene::Scene;
use crate::truth::Motion;
use rayon::prelude::*;
use run::{Grid, TestProblem, plain};

/// The default budget of a study, in steps times coordinates: a fraction of a second for explicit methods.
pub const BUDGET: u64 = 4_000_000;
/// The budget allows for at least this many runs at the scene's own step, however long.
const RUNS: u64 = 4;
/// A run follows the motion, roughly, if its error is below this fraction of the way the motion goes.
const FOLLOWS: f64 = 0.1;
/// A method farther off may have lost the motion: one that damps an oscillation away errs by its
/// amplitude, at least half the way it goes. As A (1 - exp(-y)) with y as h^p, which such an error is,
/// slopes settle far below p only from y = 4 on, within 2 % of A; this is half of that.
const LOST: f64 = 0.25;
/// A control this close shows that its steps resolve the motion.
const RESOLVED: f64 = 0.01;
/// The control, of order 4, and the least slope that shows its order: just above the floor, a tenth of
/// which may be in an error, that tenth changes a slope by at most ln 1.1 / ln 1.3 = 0.36.
const CONTROL: (&str, f64) = ("rk4", 3.5);

/// The scene's own steps to one of the coarsest level, and the most steps of that level: up to
/// order 4, and above it. High orders reach the floor at steps that look coarse, so they start
/// coarser.
const GRIDS: [(u64, u64); 2] = [(64, 511), (1024, 127)];

/// The horizons tried, as parts of the time there is: the longest first, then shorter ones, over which errors are
/// smaller against the motion and rounding has grown less.
const PARTS: [u64; 4] = [1, 4, 16, 64];
/// A horizon is at least this many of the scene's own steps long.
const SHORTEST: u64 = 16;

/// A convergence study on one motion: the refinement levels to measure orders with. Any number of methods
/// may use it, also at once.
///
/// Levels take N = M m steps over the same time, for whole m: 1, 2, 4, ..., or steps a factor 1.3 apart
/// above order 4. The error of each is the largest distance of any particle from the truth over the
/// same M instants, the steps of the coarsest level, so that two errors differ by the step alone.
pub struct Study<'a> {
    problem: TestProblem<'a>,
    /// The time there is, s.
    until: f64,
    /// Steps at the scene's own timestep.
    own: u64,
    budget: u64,
    settings: Settings,
    /// For each horizon, the longest first, the grids for levels a factor 2 and a factor 1.3 apart.
    grids: Vec<[Grid; 2]>,
}

/// The result of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredOrder {
    pub observed: Observed,
    /// The levels that gave an error, coarse to fine.
    pub points: Vec<Point>,
    /// The levels that gave none: their step, s, and why.
    pub left_out: Vec<(f64, String)>,
    /// The horizon: the end of the time errors were taken over, s.
    pub until: f64,
    /// Whether there is more time, over which no order was to be seen.
    pub shortened: bool,
}

impl<'a> Study<'a> {
    /// A study of any system and the motion that is its truth from `start` up to `until` seconds (not
    /// beyond the truth's horizon). Steps are chosen around `timestep`, s.
    ///
    /// Coordinates are taken in threes as particles; for a system without particles that is another
    /// norm of the same error, and the order is the same.
    pub fn new(
        system: &'a (dyn System + Sync),
        start: State,
        motion: &'a dyn Motion,
        timestep: f64,
        until: f64,
    ) -> Self {
        let own = (until / timestep).ceil();
        let own = if own >= 1.0 { own as u64 } else { 0 };
        let run = own.saturating_mul(system.dim() as u64);
        let problem = TestProblem {
            system,
            start,
            motion,
        };
        // All grids are made now, not on first use: the truth is computed in parallel, and a thread that
        // waits for it inside its own computation would wait for ever.
        let long = |part: &u64| *part == 1 || own / part >= SHORTEST;
        let parts = PARTS.into_iter().filter(long);
        let grids = parts.map(|horizon| {
            let until = until / horizon as f64;
            GRIDS.map(|(part, most)| Grid::new(&problem, until, own / horizon / part, most))
        });
        let grids = grids.collect();
        Self {
            problem,
            until,
            own,
            budget: BUDGET.max(RUNS.saturating_mul(run)),
            settings: Settings::default(),
            grids,
        }
    }

    /// A study of a scene and its truth, up to `until` or the scene's duration, whichever is less.
    pub fn of_scene(
        scene: &Scene,
        system: &'a ParticleSystem,
        motion: &'a dyn Motion,
        until: f64,
    ) -> Self {
        // Not `min`, which would take NaN for the whole duration.
        let until = if until >= scene.duration {
            scene.duration
        } else {
            until
        };
        let start = ParticleSystem::initial_state(scene);
        let mut study = Self::new(system, start, motion, scene.solver.timestep, until);
        study.settings = Settings::stated(scene.solver.tolerance);
        study
    }

    /// Sets another budget, in steps times coordinates over all horizons, their levels and the control. One coarse
    /// level of each horizon is run twice, to see how much rounding grows, also where nothing is left for it.
    pub fn budget(mut self, budget: u64) -> Self {
        self.budget = budget;
        self
    }

    /// Measures a method of the registry against its order [on this system](Method::order_on).
    pub fn method(&self, method: &Method) -> MeasuredOrder {
        let stated = method.order_on(self.problem.system);
        self.measure(stated, &|| method.build(&self.settings))
    }

    /// Measures any integrator against the order it states.
    ///
    /// Goes from coarse steps to the scene's own, then on until the verdict is conclusive, the errors
    /// reach the floor or the next run would pass the budget. An order that misses counts only if, at the finest steps
    /// it is read from,
    ///
    /// - the method is off by a quarter of the way the motion goes at most: one that damps the
    ///   motion away errs by its amplitude at every coarser step;
    /// - classical Runge-Kutta, run there as a control, is within a hundredth: an implicit method at
    ///   steps far beyond the motion's own errs by the same amount at each of them;
    /// - the control shows its own order or is at the floor: where forces jump or have a kink along the
    ///   motion, no method need be of the order it has on smooth ones.
    ///
    /// A method that does not converge at all and stays farther off than that is thus not told from
    /// steps too coarse.
    ///
    /// Where no order is to be seen over the whole time, since errors are not small against the motion or rounding
    /// covers them, a quarter of it is tried, and so on, each with half of the budget that is left. So it is where an
    /// order misses: over a shorter time the same steps are finer, and slopes that had only seemed to settle change.
    /// An order misses where it does so over the two longest times that show one, and is a whole number: others are
    /// slopes on their way.
    pub fn measure(&self, stated: u32, build: MakeIntegrator) -> MeasuredOrder {
        let mut left = self.budget;
        let mut whole: Option<MeasuredOrder> = None;
        let mut missed: Option<MeasuredOrder> = None;
        for (at, grids) in self.grids.iter().enumerate() {
            let share = if at + 1 < self.grids.len() {
                left / 2
            } else {
                left
            };
            let grid = &grids[usize::from(stated > 4)];
            let (measured, unspent) = self.over(grid, stated, build, share);
            left -= share - unspent;
            let unseen = matches!(
                measured.observed.verdict,
                Verdict::Inconclusive(Reason::TooFew | Reason::NotAsymptotic | Reason::AtFloor)
            );
            let shortened = at > 0;
            let measured = MeasuredOrder {
                shortened,
                ..measured
            };
            match measured.observed.verdict {
                Verdict::Misses if missed.is_none() => missed = Some(measured),
                Verdict::Misses => break,
                Verdict::Inconclusive(_) if unseen || missed.is_some() => {
                    whole.get_or_insert(measured);
                }
                _ => return measured,
            }
        }
        let missed = missed.map(|missed| missed.unless_on_its_way());
        missed.or(whole).unwrap_or_else(|| MeasuredOrder {
            observed: observed(&[], stated),
            points: Vec::new(),
            left_out: Vec::new(),
            until: 0.0,
            shortened: false,
        })
    }

    /// Measures over one horizon. Returns what is left of the budget, too.
    fn over(
        &self,
        grid: &Grid,
        stated: u32,
        build: MakeIntegrator,
        budget: u64,
    ) -> (MeasuredOrder, u64) {
        let own = (self.own as f64 * grid.until / self.until).round() as u64;
        let mut levels = multiples(stated)
            .take_while(|_| grid.instants > 0)
            .peekable();
        let mut runs = Runs {
            problem: &self.problem,
            grid,
            build,
            left: budget,
            points: Vec::new(),
            left_out: Vec::new(),
            amplification: None,
            controls: Vec::new(),
        };
        let mut first = Vec::new();
        while let Some(m) =
            levels.next_if(|&m| (first.len() <= RATIOS || grid.steps(m) <= own) && runs.spend(m))
        {
            first.push(m);
        }
        runs.run(&first);
        loop {
            let seen = observed(&runs.points, stated);
            let doubt = match seen.verdict {
                Verdict::Misses => runs.doubt(&seen, &self.settings),
                _ => None,
            };
            let finer_may_tell = doubt.is_some()
                || matches!(
                    seen.verdict,
                    Verdict::Inconclusive(Reason::TooFew | Reason::NotAsymptotic)
                );
            match levels.next().filter(|_| finer_may_tell) {
                Some(m) if runs.spend(m) => runs.run(&[m]),
                _ => {
                    let observed = match doubt {
                        Some(reason) => Observed {
                            order: None,
                            verdict: Verdict::Inconclusive(reason),
                            ..seen
                        },
                        None => seen,
                    };
                    let measured = MeasuredOrder {
                        observed,
                        points: runs.points,
                        left_out: runs.left_out,
                        until: grid.until,
                        shortened: false,
                    };
                    return (measured, runs.left);
                }
            }
        }
    }
}

impl MeasuredOrder {
    /// The same, inconclusive where the order is no whole number.
    fn unless_on_its_way(mut self) -> Self {
        let off = self
            .observed
            .order
            .map(|order| (order - order.round()).abs());
        if off.is_some_and(|off| off > TOLERANCE) {
            self.observed.order = None;
            self.observed.verdict = Verdict::Inconclusive(Reason::NotAsymptotic);
        }
        self
    }
}

/// Steps between two instants, coarse to fine: a factor 2 apart, or about 1.3 above order 4.
fn multiples(stated: u32) -> impl Iterator<Item = u64> {
    let (first, ratio, many) = match stated {
        ..=4 => (1.0, 2.0_f64, 40),
        _ => (4.0, 1.3, 100),
    };
    (0..many).map(move |j| (first * ratio.powi(j)).round() as u64)
}

/// The runs of one method.
struct Runs<'a> {
    problem: &'a TestProblem<'a>,
    grid: &'a Grid,
    build: MakeIntegrator<'a>,
    /// What is left of the budget.
    left: u64,
    points: Vec<Point>,
    left_out: Vec<(f64, String)>,
    /// See [`TestProblem::amplification`].
    amplification: Option<f64>,
    /// Levels the control has run, and its errors; None where it gave none.
    controls: Vec<(u64, Option<f64>)>,
}

impl Runs<'_> {
    /// Takes the cost of this level from the budget; false if the budget does not allow for it.
    fn spend(&mut self, m: u64) -> bool {
        let dim = self.problem.system.dim() as u64;
        let cost = self.grid.steps(m).saturating_mul(dim);
        let affordable = cost <= self.left;
        if affordable {
            self.left -= cost;
        }
        affordable
    }

    /// The reason why an order that misses need not be the method's fault, if the budget allows to
    /// find one; see [`Study::measure`].
    fn doubt(&mut self, seen: &Observed, settings: &Settings) -> Option<Reason> {
        let reach = self.grid.reach;
        let mut upward = self.points.clone().into_iter().rev();
        let finest = upward.find(|point| seen.used.last() == Some(point));
        let finest = finest.filter(|fine| !(reach > 0.0 && fine.error > LOST * reach));
        let control = finest.and_then(|fine| Some((fine, self.control(fine.h, settings)?)));
        let control = control.filter(|(_, error)| *error <= RESOLVED * reach);
        let Some((mut fine, mut error)) = control else {
            return Some(Reason::NotAsymptotic);
        };
        // The slope is taken where the control leaves the floor.
        for coarse in upward {
            let Some(before) = self.control(coarse.h, settings) else {
                break;
            };
            if error > fine.floor {
                let slope = (before.ln() - error.ln()) / (coarse.h / fine.h).ln();
                return (slope < CONTROL.1).then_some(Reason::NotSmooth);
            }
            (fine, error) = (coarse, before);
        }
        None
    }

    /// The control's error at a step, where it gives one and the budget allows.
    fn control(&mut self, h: f64, settings: &Settings) -> Option<f64> {
        let m = (self.grid.until / h / self.grid.instants as f64).round() as u64;
        if let Some((_, error)) = self.controls.iter().find(|(at, _)| *at == m) {
            return *error;
        }
        let control = integrators::find(CONTROL.0).filter(|_| self.spend(m))?;
        let build = || control.build(settings);
        let run = self.problem.run(self.grid, m, &build, None);
        let error = run.ok().map(|run| run.error);
        self.controls.push((m, error));
        error
    }

    fn run(&mut self, levels: &[u64]) {
        let runs: Vec<_> = levels
            .par_iter()
            .map(|&m| self.problem.run(self.grid, m, self.build, None))
            .collect();
        for (&m, run) in levels.iter().zip(runs) {
            let h = self.grid.step(m);
            match run {
                Ok(run) => {
                    // The coarsest that follows the motion is enough, and cheap.
                    if self.amplification.is_none() && run.error < FOLLOWS * self.grid.reach {
                        self.amplification =
                            self.problem.amplification(self.grid, m, self.build, &run);
                    }
                    self.points.push(Point {
                        h,
                        error: run.error,
                        floor: 0.0,
                    });
                }
                Err(why) => self.left_out.push((h, why)),
            }
        }
        let bar = self.problem.motion.error_bar(self.grid.until);
        let response = self.amplification.unwrap_or(0.0) + self.grid.size;
        for point in &mut self.points {
            let steps = (self.grid.until / point.h).round();
            // Each step rounds: at worst the same way each time, and a few dozen times at once.
            point.floor = 10.0 * bar + f64::EPSILON * (steps + 100.0) * response;
        }
    }
}

/// The check `order` of this method: passes at the stated order minus [`TOLERANCE`] or above.
pub fn check(subject: &str, measured: &MeasuredOrder) -> Check {
    let seen = &measured.observed;
    let stated = seen.stated;
    let range = match seen.used.as_slice() {
        [coarse, .., fine] => format!(
            "{} steps from {} to {} s",
            seen.used.len(),
            plain(coarse.h),
            plain(fine.h)
        ),
        _ => format!("{} steps", measured.points.len()),
    };
    let order = seen.order.unwrap_or(f64::NAN);
    let over = if measured.shortened {
        format!(" over the first {:.3} s", measured.until)
    } else {
        String::new()
    };
    let (status, message) = match seen.verdict {
        Verdict::Inconclusive(reason) => {
            let ended = measured.left_out.last();
            let ended = ended.map(|(h, why)| format!("; the run at h = {} s {why}", plain(*h)));
            let ended = ended.unwrap_or_default();
            (
                CheckStatus::Inconclusive,
                format!("{subject}: no order to be seen, {reason}{ended}"),
            )
        }
        Verdict::Misses => (
            CheckStatus::Fail,
            format!("{subject} is of order {order:.2}{over}, not {stated} as it states"),
        ),
        Verdict::Above => (
            CheckStatus::Pass,
            format!("{subject} shows order {order:.2} here{over}, above the {stated} it states"),
        ),
        Verdict::Meets => (
            CheckStatus::Pass,
            format!("{subject} is of order {order:.2}{over}, as stated"),
        ),
    };
    Check {
        id: "order".to_owned(),
        subject: subject.to_owned(),
        status,
        measured: seen.order,
        bound: Some(f64::from(stated) - TOLERANCE),
        derivation: format!(
            "the stated order {stated} less {TOLERANCE}; from the largest position error over {:.3} s at {range}",
            measured.until
        ),
        message,
        ..Check::default()
    }
}
