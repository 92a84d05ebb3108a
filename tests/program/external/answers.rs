//! The library's side, without any process: what becomes of the rows a program gives.

use crate::testkit::scenes::parsed;
use springcheck::integrators::{self, Settings};
use springcheck::measure::EnergyClass;
use springcheck::measure::identify::{Identity, Undecided};
use springcheck::physics::ParticleSystem;
use springcheck::scene::Scene;
use springcheck::solvers::Solver;
use springcheck::solvers::external::{Failure, Program, Recording, Task};
use springcheck::solvers::{SolverKind, Status};
use springcheck::trajectory::{Precision, Rows};
use springcheck::verbs::run::Outcome;
use springcheck::verbs::run::{Choice, Plan};
use springcheck::verbs::session::Quiet;
use std::sync::Arc;

/// A program in this process.
struct Computed<F>(F);

impl<F: Fn(&Task) -> Rows + Send + Sync> Program for Computed<F> {
    fn record(&self, task: &Task) -> Result<Recording, Failure> {
        Ok(Recording {
            rows: (self.0)(task),
            seconds: Some(0.25),
        })
    }
}

/// Its outcome beside an integrator of ours.
fn outcome(scene: &Scene, solver: impl Fn(&Task) -> Rows + Send + Sync + 'static) -> Outcome {
    let mut choice = Choice::default_for(scene);
    let program = Arc::new(Computed(solver));
    choice.solvers.push(Solver::program("mine", program));
    let report = Plan::new(scene, &choice).execute(&Quiet).expect("no files");
    let mine = report.outcomes().last().expect("an outcome").clone();
    assert_eq!(
        (mine.engine.as_str(), mine.kind),
        ("mine", SolverKind::External)
    );
    mine
}

/// Every `every`-th step of one of our methods, and the last.
fn rows(task: &Task, method: &str, every: u64) -> Rows {
    let row = integrators::find(method).expect("a row");
    let mut integrator = row.build(&Settings::default());
    let mut state = ParticleSystem::initial_state(task.scene);
    let mut rows = Rows {
        timestep: task.timestep,
        dim: state.x.len(),
        steps: Vec::new(),
        x: Vec::new(),
        v: Some(Vec::new()),
        precision: Precision::Double,
        precision_v: Precision::Double,
        cut: false,
    };
    for step in 0..=task.steps {
        if step > 0 {
            let h = task.timestep;
            integrator.step(task.system, h, &mut state).expect("a step");
        }
        if step % every == 0 || step == task.steps {
            rows.steps.push(step);
            rows.x.extend_from_slice(&state.x);
            rows.v
                .as_mut()
                .expect("velocities")
                .extend_from_slice(&state.v);
        }
    }
    rows
}

/// A damped oscillator in the wind: k = 50 N/m, m = 1 kg, c = 1 N s/m, 5 s.
fn damped(h: f64) -> Scene {
    let yaml = format!(
        "solver: {{type: rk4, timestep: {h}, gravity: 0}}
particles:
- {{pos: [0, 0, 0], fixed: true}}
- {{pos: [0.5, 0, 0], mass: 1}}
springs: [{{particle_ids: [0, 1], stiffness: 50, damping: 1, rest_length: 0}}]
wind: {{direction: [1, 0, 0], strength: 2}}
"
    );
    parsed(&yaml)
}

fn balance_error(scene: &Scene, every: u64) -> f64 {
    let mine = outcome(scene, move |task| rows(task, "rk4", every));
    assert_eq!(mine.status, Status::Completed);
    let energy = mine.energy.expect("an energy");
    energy.relative_error_max.expect("a scale")
}

/// Work is taken from the rows by the trapezoidal rule: of second order in their distance Δ, whatever
/// the timestep, so at twice the distance the error is four times as large; a left-hand sum would
/// make it twice. The power swings with 2 ω, so the largest error of a grid may miss its peak by
/// 1 - cos(ω Δ) = 4 % at Δ = 0.04 s, ω = 7.07 rad/s. Measured: 3.948.
#[test]
fn the_balance_closes_by_the_trapezoidal_rule_of_the_rows() {
    let scene = damped(0.001);
    let ratio = balance_error(&scene, 40) / balance_error(&scene, 20);
    eprintln!("ratio {ratio}");
    assert!((ratio / 4.0 - 1.0).abs() < 0.04, "{ratio}");
}

#[test]
fn a_divergence_is_found_in_the_rows_as_it_would_be_in_a_run() {
    // Explicit Euler beyond its limit: at h ω = 2.1 the amplitude grows by sqrt(1 + z²) a step.
    let yaml = "solver: {type: explicit_euler, timestep: 0.3, gravity: 0}
duration: 60
particles:
- {pos: [0, 0, 0], fixed: true}
- {pos: [0.5, 0, 0], mass: 1}
springs: [{particle_ids: [0, 1], stiffness: 50, rest_length: 0}]
";
    let scene = parsed(yaml);
    let mine = outcome(&scene, |task| rows(task, "explicit_euler", 1));
    assert_eq!(mine.status, Status::Diverged);
    // E grows by 1 + z² = 5.5 a step from E(0) = S: past 1e12 S after ln 1e12 / ln 5.5 = 16.2 steps.
    assert_eq!(mine.work.steps, 17);
    assert_eq!(mine.stopped_at_s, Some(17.0 * 0.3));
    assert!(mine.reason.expect("a reason").starts_with("by step 17"));
    let class = mine.energy.expect("an energy").class;
    assert_eq!(class, Some(EnergyClass::Growing));
    // From positions alone too.
    let bare = outcome(&scene, |task| Rows {
        v: None,
        ..rows(task, "explicit_euler", 1)
    });
    assert_eq!(bare.status, Status::Diverged);
    // Numbers that are none.
    let lost = outcome(&scene, |task| {
        let mut rows = rows(task, "symplectic_euler", 1);
        rows.x[3 * 2 * 5 + 3] = f64::NAN;
        rows
    });
    assert_eq!((lost.status, lost.work.steps), (Status::Diverged, 5));
    assert!(lost.reason.expect("a reason").contains("no longer finite"));
}

#[test]
fn rows_that_are_no_states_of_the_scene_are_a_failure() {
    type Spoil = fn(&mut Rows);
    let spoils: [(Spoil, &str); 5] = [
        (|rows| rows.steps.clear(), "no rows"),
        (|rows| rows.steps[3] = 2, "order of time"),
        (|rows| rows.dim = 3, "all particles"),
        (|rows| rows.x.truncate(7), "all particles"),
        (|rows| rows.timestep *= 2.0, "timestep"),
    ];
    for (spoil, says) in spoils {
        let mine = outcome(&damped(0.01), move |task| {
            let mut rows = rows(task, "rk4", 1);
            spoil(&mut rows);
            rows
        });
        let reason = mine.reason.expect("a reason");
        assert_eq!(mine.status, Status::Failed, "{reason}");
        assert!(reason.contains(says), "{reason}");
    }
}

#[test]
fn the_start_is_the_scenes_or_its_difference_is_said() {
    let scene = damped(0.01);
    let said = |mine: &Outcome, what: &str| mine.remarks.iter().any(|r| r.contains(what));
    let same = outcome(&scene, |task| rows(task, "rk4", 1));
    assert!(!said(&same, "start"), "{:?}", same.remarks);
    assert!(said(&same, "the time is of the whole program"));
    assert_eq!(same.work.wall_s.as_ref().map(|wall| wall.min), Some(0.25));
    let other = outcome(&scene, |task| {
        let mut rows = rows(task, "rk4", 1);
        rows.x[3] = 0.5 + 1e-15;
        rows
    });
    assert!(
        said(&other, "position of particle 1"),
        "{:?}",
        other.remarks
    );
    // Written to six digits it may differ by half of the last, twice.
    let rounded = outcome(&scene, |task| {
        let mut rows = rows(task, "rk4", 1);
        rows.x[3] = 0.5 + 4e-7;
        rows.precision = Precision::Decimals(6);
        rows
    });
    assert!(!said(&rounded, "start"), "{:?}", rounded.remarks);
    // A program that gives only what it computed: the start is put in front.
    let later = outcome(&scene, |task| {
        let mut rows = rows(task, "rk4", 1);
        rows.steps.remove(0);
        rows.x.drain(..6);
        rows.v.as_mut().expect("velocities").drain(..6);
        rows
    });
    assert!(said(&later, "begin at t = 0.01 s"), "{:?}", later.remarks);
    let energies = [&same, &later].map(|o| o.energy.as_ref().and_then(|e| e.initial_j));
    assert_eq!(energies[0], energies[1]);
    assert_eq!(later.status, Status::Completed);
}

#[test]
fn a_programs_scheme_is_told_from_the_digits_it_gives() {
    let rounded = |precision: Precision| {
        outcome(&damped(0.01), move |task| {
            let mut rows = rows(task, "explicit_euler", 1);
            let digit = |c: &f64| (c * 1e6).round() / 1e6;
            rows.x = rows.x.iter().map(digit).collect();
            rows.v = rows.v.map(|v| v.iter().map(digit).collect());
            (rows.precision, rows.precision_v) = (precision, precision);
            rows
        })
    };
    let told = rounded(Precision::Decimals(6)).identified.expect("rows");
    assert_eq!(
        (told.method.as_str(), told.undecided),
        ("explicit_euler", None)
    );
    // Taken for doubles the same rows are nobody's.
    let untold = rounded(Precision::Double).identified;
    let near = |found: &Identity| found.undecided == Some(Undecided::Near);
    assert!(untold.as_ref().is_none_or(near), "{untold:?}");
}
